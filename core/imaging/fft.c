/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/imaging/fft.h"

#include <fftw3.h>
#include <glib.h>

enum { BACKWARD, FORWARD_REAL, BACKWARD_REAL };

/* Plans by what they do and to what size; the key is (what, nx, ny). */
typedef struct plan {
  int what, nx, ny;
  fftwf_plan plan;
} plan;

static GMutex lock;   /* FFTW plans in one thread at a time */
static GArray *plans;

int opc_fft_size(double minimum) {
  for (int n = minimum <= 16 ? 16 : ((int)(minimum + 1) & ~1);; n += 2) {
    if (n < minimum) continue;
    int rest = n;
    for (int p = 2; p <= 7; p++)
      while (rest % p == 0) rest /= p;
    if (rest == 1) return n;
  }
}

void *opc_fft_alloc(size_t n) { return fftwf_malloc(n); }
void opc_fft_free(void *memory) { fftwf_free(memory); }

static fftwf_plan make(int what, int nx, int ny, void *in, void *out) {
  /* Estimated plans do not touch the arrays. */
  unsigned flags = FFTW_ESTIMATE | FFTW_DESTROY_INPUT;
  switch (what) {
    case BACKWARD:
      return fftwf_plan_dft_2d(ny, nx, in, out, FFTW_BACKWARD, flags);
    case FORWARD_REAL:
      return fftwf_plan_dft_r2c_2d(ny, nx, in, out, flags);
    default:
      return fftwf_plan_dft_c2r_2d(ny, nx, in, out, flags);
  }
}

static fftwf_plan find(int what, int nx, int ny, void *in, void *out) {
  fftwf_plan found = NULL;
  g_mutex_lock(&lock);
  if (!plans) plans = g_array_new(FALSE, FALSE, sizeof(plan));
  for (guint i = 0; i < plans->len && !found; i++) {
    plan *p = &g_array_index(plans, plan, i);
    if (p->what == what && p->nx == nx && p->ny == ny) found = p->plan;
  }
  if (!found) {
    found = make(what, nx, ny, in, out);
    plan p = {what, nx, ny, found};
    g_array_append_val(plans, p);
  }
  g_mutex_unlock(&lock);
  return found;
}

void opc_fft_backward(int nx, int ny, float complex *data) {
  fftwf_execute_dft(find(BACKWARD, nx, ny, data, data), (fftwf_complex *)data,
                    (fftwf_complex *)data);
}

void opc_fft_forward_real(int nx, int ny, float *in, float complex *out) {
  fftwf_execute_dft_r2c(find(FORWARD_REAL, nx, ny, in, out), in,
                        (fftwf_complex *)out);
}

void opc_fft_backward_real(int nx, int ny, float complex *in, float *out) {
  fftwf_execute_dft_c2r(find(BACKWARD_REAL, nx, ny, in, out),
                        (fftwf_complex *)in, out);
}
