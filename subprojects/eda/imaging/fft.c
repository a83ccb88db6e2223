/* SPDX-License-Identifier: BSD-3-Clause */
/* Plans of FFTW, and memory for what they work on. */
#include "imaging/fft.h"

#include <fftw3.h>
#include <glib.h>
#include <stdlib.h>
#include <sys/mman.h>

enum {
  ALIGNMENT = 64, /* of the widest vectors */
  HUGE_PAGE = 1 << 21
};

struct eda_fft {
  int what, n, lines;
  fftwf_plan plan;
};

static GMutex lock; /* FFTW plans in one thread at a time */
static GPtrArray *plans;

int eda_fft_size(double minimum) {
  for (int n = minimum <= 16 ? 16 : ((int)(minimum + 1) & ~1);; n += 2) {
    if (n < minimum) continue;
    int rest = n;
    for (int p = 2; p <= 7; p++)
      while (rest % p == 0) rest /= p;
    if (rest == 1) return n;
  }
}

/* Large arrays on large pages: with small ones, much of the time would go into
   the first touch of each, and into finding them. */
void *eda_fft_alloc(size_t n) {
  size_t unit = n < 2 * HUGE_PAGE ? ALIGNMENT : HUGE_PAGE;
  size_t size = (n + unit) & ~(unit - 1);
  void *memory = aligned_alloc(unit, size);
  if (!memory) g_error("%s: failed to allocate %zu bytes", G_STRLOC, size);
  if (unit == HUGE_PAGE) madvise(memory, size, MADV_HUGEPAGE);
  return memory;
}

void eda_fft_free(void *memory) { free(memory); }

static fftwf_plan make(int what, int n, int lines) {
  /* Estimated plans do not touch the arrays, but want their alignment. */
  unsigned flags = FFTW_ESTIMATE | FFTW_DESTROY_INPUT;
  int half = n / 2 + 1;
  size_t size = (size_t)lines * (size_t)(n + 2) * sizeof(fftwf_complex);
  void *a = eda_fft_alloc(size), *b = eda_fft_alloc(size);
  fftwf_plan plan = NULL;
  switch (what) {
    case EDA_FFT_BACKWARD:
    case EDA_FFT_FORWARD:
      plan = fftwf_plan_many_dft(
          1, &n, lines, a, NULL, 1, n, a, NULL, 1, n,
          what == EDA_FFT_FORWARD ? FFTW_FORWARD : FFTW_BACKWARD, flags);
      break;
    case EDA_FFT_REAL_FORWARD:
      plan = fftwf_plan_many_dft_r2c(1, &n, lines, a, NULL, 1, n, b, NULL, 1,
                                     half, flags);
      break;
    default:
      plan = fftwf_plan_many_dft_c2r(1, &n, lines, a, NULL, 1, half, b, NULL, 1,
                                     n, flags);
  }
  eda_fft_free(a);
  eda_fft_free(b);
  return plan;
}

const eda_fft *eda_fft_plan(int what, int n, int lines) {
  eda_fft *found = NULL;
  g_mutex_lock(&lock);
  if (!plans) plans = g_ptr_array_new();
  for (guint i = 0; i < plans->len && !found; i++) {
    eda_fft *p = plans->pdata[i];
    if (p->what == what && p->n == n && p->lines == lines) found = p;
  }
  if (!found) {
    found = g_new(eda_fft, 1);
    *found = (eda_fft){what, n, lines, make(what, n, lines)};
    g_ptr_array_add(plans, found);
  }
  g_mutex_unlock(&lock);
  return found;
}

void eda_fft_run(const eda_fft *p, void *in, void *out) {
  switch (p->what) {
    case EDA_FFT_BACKWARD:
    case EDA_FFT_FORWARD:
      fftwf_execute_dft(p->plan, in, in);
      break;
    case EDA_FFT_REAL_FORWARD:
      fftwf_execute_dft_r2c(p->plan, in, out);
      break;
    default:
      fftwf_execute_dft_c2r(p->plan, in, out);
  }
}
