/* SPDX-License-Identifier: BSD-3-Clause */
/* FFTW plans, and memory for the arrays of transforms. */
#include "imaging/fft.h"

#include <fftw3.h>
#include <glib.h>
#include <stdlib.h>
#include <sys/mman.h>

enum {
  ALIGNMENT = 64, /* alignment of the widest vectors */
  HUGE_PAGE = 1 << 21
};

struct eda_fft {
  int what, n, lines;
  fftwf_plan plan;
};

static GMutex lock; /* FFTW can create plans in only one thread at a time */
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

/* ---- memory ---- */

/* A large array, in use or idle. Images of a layout repeatedly need arrays of
   equal size. Without reuse, clearing pages takes a fifth of the time of a
   chip's simulation. */
typedef struct block {
  void *at;
  size_t size;
  int busy;
} block;

/* The total size of all blocks may exceed the largest size in use by 1 / SPARE.
   Sizes vary during a simulation. Without spare memory, reallocation of blocks
   takes 5 % of the time of a chip's simulation; more spare memory has no
   effect. */
enum { SPARE = 2 };

static GMutex blocks_lock;
static GArray *blocks;
static size_t busy, idle, most_busy; /* bytes */

static block *block_at(guint i) { return &g_array_index(blocks, block, i); }

/* Return the smallest idle block of `size` to 5/4 `size` bytes; NULL if there
   is none. */
static block *find_idle(size_t size) {
  block *best = NULL;
  for (guint i = 0; blocks && i < blocks->len; i++) {
    block *b = block_at(i);
    if (b->busy || b->size < size || b->size - size > size / 4) continue;
    if (!best || b->size < best->size) best = b;
  }
  return best;
}

/* Free idle blocks until the total is within `limit` bytes. */
static void drop_idle(size_t limit) {
  for (guint i = blocks ? blocks->len : 0; i-- > 0 && busy + idle > limit;) {
    if (block_at(i)->busy) continue;
    idle -= block_at(i)->size;
    free(block_at(i)->at);
    g_array_remove_index_fast(blocks, i);
  }
}

static void *fft_allocate(size_t unit, size_t size) {
  void *memory = aligned_alloc(unit, size);
  if (!memory) g_error("%s: failed to allocate %zu bytes", G_STRLOC, size);
  return memory;
}

/* Allocate a block on large pages. With small pages, the first access of each
   page and address translation take much time. */
static block *new_block(size_t size) {
  size_t most = MAX(most_busy, busy + size);
  drop_idle(most + most / SPARE - size);
  block b = {.at = fft_allocate(HUGE_PAGE, size), .size = size};
  madvise(b.at, size, MADV_HUGEPAGE);
  if (!blocks) blocks = g_array_new(FALSE, FALSE, sizeof b);
  g_array_append_val(blocks, b);
  idle += size;
  return block_at(blocks->len - 1);
}

void *eda_fft_alloc(size_t n) {
  size_t unit = n < 2 * HUGE_PAGE ? ALIGNMENT : HUGE_PAGE;
  size_t size = (n + unit) & ~(unit - 1);
  if (unit == ALIGNMENT) return fft_allocate(unit, size);
  g_mutex_lock(&blocks_lock);
  block *b = find_idle(size);
  if (!b) b = new_block(size);
  b->busy = 1;
  idle -= b->size;
  busy += b->size;
  most_busy = MAX(most_busy, busy);
  void *memory = b->at;
  g_mutex_unlock(&blocks_lock);
  return memory;
}

void eda_fft_free(void *memory) {
  block *found = NULL;
  g_mutex_lock(&blocks_lock);
  for (guint i = 0; blocks && i < blocks->len && !found; i++)
    if (block_at(i)->at == memory) found = block_at(i);
  if (found) {
    found->busy = 0;
    busy -= found->size;
    idle += found->size;
  }
  g_mutex_unlock(&blocks_lock);
  if (!found) free(memory);
}

void eda_fft_trim(void) {
  g_mutex_lock(&blocks_lock);
  drop_idle(busy);
  most_busy = busy;
  g_mutex_unlock(&blocks_lock);
}

/* ---- plans ---- */

static fftwf_plan plan_make(int what, int n, int lines) {
  /* FFTW_ESTIMATE does not access the arrays, but the plan depends on their
     alignment. */
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
    *found = (eda_fft){what, n, lines, plan_make(what, n, lines)};
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
