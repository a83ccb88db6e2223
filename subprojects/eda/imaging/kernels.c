/* SPDX-License-Identifier: BSD-3-Clause */
/* Images as sums of coherent kernels (SOCS).

   Each kernel has a complex field (amplitude), whose spectrum is the mask
   spectrum times the transfer function of the kernel. The spectrum of the field
   is transformed back along y, one strip of columns k and -k at a time, then
   along x, EDA_LANES (lanes.h) rows at a time. The squared magnitude of the
   field is added to the sum of all kernels while the rows are in the cache.
   Finally the sum is transformed forward, converted to B-spline coefficients,
   and transformed back to the grid of the result.

   Kernels are processed in groups, so that the sum is read and written once for
   each group. Work units are strips and blocks of rows. The terms of a sum and
   their order do not depend on the threads. */
#include <eda/simd.h>
#include "imaging/fft.h"
#include "imaging/lanes.h"
#include "imaging/spline.h"
#include "imaging/values.h"

#include <complex.h>
#include <eda/imaging.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
  STRIP = 32, /* number of columns k >= 0 in a strip */
  BLOCKS = STRIP / EDA_LANES,
  TOGETHER = 4,            /* largest number of kernels in a group */
  FIELDS_BYTES = 64 << 20, /* memory for the fields of a group, bytes */
  SUMS = 1 + EDA_RESIDUALS
};

static const double default_step = 32; /* largest grid step, nm */

/* A two-dimensional array that is transformed along one direction. Blocks of
   EDA_LANES adjacent lines are stored together: at[b * n + i] is point i of
   block b. */
typedef struct lines {
  size_t n;
  eda_lanes *at;
} lines;

typedef struct sum_task {
  const opc_context *context;
  const eda_spectrum *mask;
  eda_kernels kernels;
  float complex offset, scale; /* transmission: offset + scale * spectrum */
  int nx, ny;                  /* numbers of nodes of the fields */
  int half, reach; /* fields have frequencies |l| <= half, |k| <= reach */
  size_t kernel, together; /* first kernel and size of the current group */
  size_t group_most;       /* largest group */
  lines field[TOGETHER];   /* blocks of rows y; k < 0 is at point left - k */
  size_t left;             /* number of points for k >= 0, and for k < 0 */
  size_t rows, columns; /* numbers of blocks of rows y, and of blocks of columns
                           k >= 0 of `spectrum` */
  eda_vector *sum[SUMS]; /* [row block][x]; sum[0]: of all kernels; sum[1 + i]:
                            of residual i */

  int top_x, top_y;     /* highest frequencies k and |l| of the intensity */
  lines spectrum[SUMS]; /* spectra of the sums: blocks of columns k */
  int fine_x, fine_y;   /* numbers of nodes of the result */
  float *by_x, *by_y;   /* ratios of spline coefficients to samples, at k, l */
  lines fine;           /* blocks of rows before the transform along x */
  float *out;

  size_t capacity; /* size of a scratch array, points */
  GMutex lock;
  GPtrArray *scratch; /* idle scratch arrays */
} sum_task;

static size_t blocks(int n) { return (size_t)(n + EDA_LANES - 1) / EDA_LANES; }

/* Return an idle scratch array, or a new array if none is idle. */
static eda_lanes *lanes_borrow(sum_task *j) {
  g_mutex_lock(&j->lock);
  eda_lanes *a = j->scratch->len ? g_ptr_array_steal_index_fast(
                                       j->scratch, j->scratch->len - 1)
                                 : NULL;
  g_mutex_unlock(&j->lock);
  return a ? a : eda_fft_alloc(j->capacity * sizeof *a);
}

static void give_back(sum_task *j, eda_lanes *a) {
  g_mutex_lock(&j->lock);
  g_ptr_array_add(j->scratch, a);
  g_mutex_unlock(&j->lock);
}

/* ---- a field ---- */

/* A strip of a field spectrum: columns k = first .. first + n - 1 and -k. */
typedef struct strip {
  size_t kernel;
  int first, n;
  int last; /* last column within the band in the current row */
} strip;

static size_t strips(const sum_task *j) {
  return (size_t)(j->reach + STRIP) / STRIP;
}

/* Bits of a quadrant's number. LEFT: columns -k; BELOW: rows -l (k, l >= 0). */
enum { LEFT = 1, BELOW = 2, QUADRANTS = 4 };

/* Transfer function in a row of a quadrant. At point i, the real part is re *
   at[2 * i] and the imaginary part im * at[2 * i + 1]. */
typedef struct factor {
  float re, im; /* 1 or -1 */
  float value[2 * STRIP];
  const float *at; /* `value` of this or another quadrant */
} factor;

static void strip_transfer(const sum_task *j, size_t kernel, const strip *p,
                           int quadrant, int l, factor *out) {
  const eda_kernels *y = &j->kernels;
  double step = (quadrant & LEFT ? -1 : 1) / j->mask->frame.width;
  double fy = (quadrant & BELOW ? -l : l) / j->mask->frame.height, fx[STRIP];
  int n = p->last - p->first + 1;
  for (int i = 0; i < n; i++) fx[i] = (p->first + i) * step;
  y->transfer(y->self, kernel, fx, fy, (size_t)n, out->value);
  out->re = out->im = 1;
  out->at = out->value;
}

/* Derive the factors of all quadrants from quadrant 0 of the kernel and of its
   mirrored kernel (eda_mirrored). */
static void factors_mirror(const sum_task *j, const strip *p, int l,
                           factor t[QUADRANTS]) {
  eda_mirrored m = j->kernels.mirror(j->kernels.self, p->kernel);
  float sign = m.odd ? -1 : 1;
  int from = m.kernel == p->kernel ? 0 : BELOW;
  strip_transfer(j, p->kernel, p, 0, l, &t[0]);
  if (from) strip_transfer(j, m.kernel, p, 0, l, &t[from]);
  t[BELOW].at = t[LEFT].at = t[from].value;
  t[LEFT | BELOW].at = t[0].value;
  t[BELOW].re = 1;
  t[BELOW].im = m.conjugate ? -1 : 1;
  t[LEFT].re = sign;
  t[LEFT].im = sign * t[BELOW].im;
  t[LEFT | BELOW].re = t[LEFT | BELOW].im = sign;
}

static void factors_scale(float complex by, int n, factor *t) {
  for (int i = 0; i < n; i++) {
    float complex c =
        (t->re * t->at[2 * i] + t->im * t->at[2 * i + 1] * I) * by;
    t->value[2 * i] = crealf(c);
    t->value[2 * i + 1] = cimagf(c);
  }
  t->re = t->im = 1;
  t->at = t->value;
}

static void find_factors(const sum_task *j, const strip *p, int l,
                         factor t[QUADRANTS]) {
  int n = p->last - p->first + 1;
  if (j->kernels.mirror)
    factors_mirror(j, p, l, t);
  else
    for (int q = 0; q < QUADRANTS; q++)
      strip_transfer(j, p->kernel, p, q, l, &t[q]);
  /* In this order, each value is used before it is overwritten. */
  static const int order[QUADRANTS] = {LEFT | BELOW, LEFT, BELOW, 0};
  for (int i = 0; i < QUADRANTS && j->scale != 1; i++)
    factors_scale(j->scale, n, &t[order[i]]);
}

/* Compute transfer function `t` * mask spectrum `a` for n blocks of columns,
   and write block b to to[b * apart]. sign -1: conjugate `a`; by_re, by_im:
   signs of the real and imaginary parts of `t`. The signs multiply whole sums,
   so that rounding is equal in all quadrants. */
EDA_WIDE static void lanes_multiply(const float *restrict t, float by_re,
                                    float by_im, const float *restrict a,
                                    float sign, int n, eda_lanes *restrict to,
                                    size_t apart) {
  sign *= by_re * by_im;
  for (int b = 0; b < n; b++, to += apart) {
    float *re = (float *)&to->re, *im = (float *)&to->im;
    for (int i = 0; i < EDA_LANES; i++, t += 2, a += 2) {
      float x = a[0], y = sign * a[1];
      re[i] = by_re * (t[0] * x - t[1] * y);
      im[i] = by_im * (t[0] * y + t[1] * x);
    }
  }
}

/* Write row l (or -l) of the columns k (or -k) of a strip. Block b of columns
   is written to to[b * apart]. */
static void fill_row(const sum_task *j, const strip *p, int quadrant, int l,
                     const factor *f, eda_lanes *to, size_t apart) {
  const eda_spectrum *m = j->mask;
  int left = quadrant & LEFT, n = MAX(0, p->last - p->first + 1);
  int whole = n / EDA_LANES, rest = n % EDA_LANES;
  float sign = left ? -1 : 1;
  /* The spectrum stores only k >= 0: a[-k, l] is the conjugate of a[k, -l]. */
  int down = (quadrant == LEFT || quadrant == BELOW) && l;
  size_t row = (size_t)(down ? m->rows - l : l);
  const float *a = m->data + 2 * (row * (size_t)m->columns + (size_t)p->first);
  ptrdiff_t next = (down ? -2 : 2) * (ptrdiff_t)m->columns;
  for (int i = 0; i < n && !left && l && l < j->half; i += EDA_LANES / 2)
    __builtin_prefetch(a + next + 2 * (ptrdiff_t)i);
  if (whole) lanes_multiply(f->at, f->re, f->im, a, sign, whole, to, apart);
  if (rest) {
    float t[2 * EDA_LANES] = {0}, end[2 * EDA_LANES] = {0};
    size_t done = (size_t)whole * 2 * EDA_LANES;
    memcpy(t, f->at + done, sizeof *t * 2 * (size_t)rest);
    memcpy(end, a + done, sizeof *end * 2 * (size_t)rest);
    lanes_multiply(t, f->re, f->im, end, sign, 1, to + (size_t)whole * apart,
                   apart);
  }
  for (int b = whole + (rest > 0); b < BLOCKS; b++)
    to[(size_t)b * apart] = (eda_lanes){0};
  if (l || left || p->first) return;
  float complex c = (f->at[0] + f->at[1] * I) / j->scale * j->offset;
  to->re[0] += crealf(c);
  to->im[0] += cimagf(c);
}

/* Write rows l and -l of a strip: first the blocks of columns k, then the
   blocks of columns -k. */
static void fill_rows(const sum_task *j, strip *p, int l, eda_lanes *to,
                      size_t apart) {
  const eda_spectrum *m = j->mask;
  double band = fmin(j->kernels.band, m->band), fy = l / m->frame.height;
  double left = band * band - fy * fy;
  int last = left < 0 ? -1 : (int)floor(m->frame.width * sqrt(left));
  factor t[QUADRANTS];
  p->last = MIN(last, p->first + p->n - 1);
  if (p->last >= p->first) find_factors(j, p, l, t);
  for (int q = 0; q < QUADRANTS; q++) {
    int y = q & BELOW ? j->ny - l : l;
    if (q & BELOW && !l) continue;
    fill_row(j, p, q, l, &t[q], to + (q & LEFT ? BLOCKS * apart : 0) + y,
             apart);
  }
}

/* Transpose a block of EDA_LANES columns of n rows to blocks of rows. The first
   column becomes point number `column` of each block. Rows that pad the last
   block are set to 0. */
static void turn_lines(eda_lanes *from, int n, lines *to, size_t column) {
  memset(from + n, 0, sizeof *from * (blocks(n) * EDA_LANES - (size_t)n));
  for (size_t b = 0; b < blocks(n); b++) {
    const eda_lanes *tile = from + b * EDA_LANES;
    eda_lanes *out = to->at + b * to->n + column;
    for (size_t i = 0; i < EDA_LANES && b + 1 < blocks(n); i++) {
      __builtin_prefetch(&out[to->n + i].re, 1);
      __builtin_prefetch(&out[to->n + i].im, 1);
    }
    eda_lanes_turn(&tile->re, 2, &out->re, 2);
    eda_lanes_turn(&tile->im, 2, &out->im, 2);
  }
}

static void field_along_y(void *data, size_t index) {
  sum_task *j = data;
  if (opc_cancelled(j->context)) return;
  lines *field = &j->field[index / strips(j)];
  strip s = {.kernel = j->kernel + index / strips(j),
             .first = (int)(index % strips(j)) * STRIP};
  s.n = MIN(STRIP, j->reach + 1 - s.first);
  size_t apart = j->rows * EDA_LANES;
  eda_lanes *a = lanes_borrow(j), *work = a + 2 * BLOCKS * apart;
  const eda_lanes_plan *plan = eda_lanes_plan_for(j->ny);
  for (int l = 0; l <= j->half; l++) fill_rows(j, &s, l, a, apart);
  for (size_t b = 0; b < 2 * blocks(s.n); b++) {
    size_t left = b >= blocks(s.n), block = left ? b - blocks(s.n) : b;
    eda_lanes *column = a + (left * BLOCKS + block) * apart;
    memset(column + j->half + 1, 0,
           sizeof *a * (size_t)(j->ny - 2 * j->half - 1));
    eda_lanes_backward(plan, column, work);
    turn_lines(column, j->ny, field,
               left * j->left + (size_t)s.first + block * EDA_LANES);
  }
  give_back(j, a);
}

EDA_WIDE static void add_square(const eda_lanes *restrict field, float weight,
                                int n, eda_vector *restrict sum) {
  for (int i = 0; i < n; i++)
    sum[i] += weight * (field[i].re * field[i].re + field[i].im * field[i].im);
}

/* Transform a block of rows of all fields of the group along x, and add the
   squared magnitudes to the sums. A sum is set to 0 before its first field is
   added. */
static void square_along_x(void *data, size_t block) {
  sum_task *j = data;
  if (opc_cancelled(j->context)) return;
  eda_lanes *a = lanes_borrow(j);
  size_t reach = (size_t)j->reach, n = (size_t)j->nx;
  for (size_t i = 0; i < j->together; i++) {
    const eda_lanes *row = j->field[i].at + block * j->field[i].n;
    size_t kernel = j->kernel + i;
    memcpy(a, row, sizeof *a * (reach + 1));
    memset(a + reach + 1, 0, sizeof *a * (n - 2 * reach - 1));
    for (size_t k = 1; k <= reach; k++) a[n - k] = row[j->left + k];
    eda_lanes_backward(eda_lanes_plan_for(j->nx), a, a + n);
    size_t count = j->kernels.count;
    float weight = kernel < count ? (float)j->kernels.weight[kernel] : 1;
    eda_vector *sum =
        j->sum[kernel < count ? 0 : kernel - count + 1] + block * n;
    if (kernel == 0 || kernel >= count) memset(sum, 0, n * sizeof *sum);
    add_square(a, weight, j->nx, sum);
  }
  give_back(j, a);
}

/* Allocate the sums and the fields of one group of kernels. */
static void make_fields(sum_task *j, size_t count) {
  size_t n = j->rows * (size_t)j->nx;
  j->left = strips(j) * STRIP;
  size_t each = j->rows * 2 * j->left * sizeof *j->field->at;
  size_t most = MIN(count, MAX(1, FIELDS_BYTES / each));
  for (j->group_most = 0; j->group_most < MIN(most, TOGETHER);
       j->group_most++) {
    lines *field = &j->field[j->group_most];
    field->n = 2 * j->left;
    field->at = eda_fft_alloc(each);
  }
  for (size_t i = 0; i <= j->kernels.residuals; i++)
    j->sum[i] = eda_fft_alloc(n * sizeof *j->sum[i]);
}

static void add_kernels(sum_task *j) {
  size_t count = j->kernels.count + j->kernels.residuals;
  make_fields(j, count);
  for (j->kernel = 0; j->kernel < count && !opc_cancelled(j->context);
       j->kernel += j->together) {
    j->together = MIN(j->group_most, count - j->kernel);
    opc_parallel(j->context, j->together * strips(j), field_along_y, j);
    opc_parallel(j->context, j->rows, square_along_x, j);
  }
  for (size_t i = 0; i < j->group_most; i++) eda_fft_free(j->field[i].at);
}

/* ---- result from the sums ---- */

/* Compute coefficient k of two blocks of real rows from the transform `a` of
   the complex block whose real and imaginary parts are the two blocks. In a,
   *first and *second, real and imaginary parts are exchanged: this turns the
   backward transform into a forward transform. */
EDA_WIDE static void lanes_split(const eda_lanes *a, int n, int k,
                                 eda_lanes *first, eda_lanes *second) {
  const eda_lanes *p = a + k, *q = a + (k ? n - k : 0);
  first->re = 0.5f * (p->re - q->re);
  first->im = 0.5f * (p->im + q->im);
  second->re = 0.5f * (q->im - p->im);
  second->im = 0.5f * (p->re + q->re);
}

/* Transform two blocks of rows of each sum along x, and store columns 0 ..
   top_x. */
static void forth_along_x(void *data, size_t pair) {
  sum_task *j = data;
  if (opc_cancelled(j->context)) return;
  eda_lanes *a = lanes_borrow(j), *tile = a + j->nx;
  size_t n = (size_t)j->nx, one = 2 * pair, other = MIN(one + 1, j->rows - 1);
  for (size_t part = 0; part <= j->kernels.residuals; part++) {
    const eda_vector *re = j->sum[part] + one * n,
                     *im = j->sum[part] + other * n;
    for (size_t x = 0; x < n; x++) a[x] = (eda_lanes){im[x], re[x]};
    eda_lanes_backward(eda_lanes_plan_for(j->nx), a, a + n);
    lines *to = &j->spectrum[part];
    for (size_t b = 0; b < j->columns; b++) {
      int first = (int)b * EDA_LANES,
          there = MIN(EDA_LANES, j->top_x + 1 - first);
      memset(tile, 0, 2 * EDA_LANES * sizeof *tile);
      for (int k = 0; k < there; k++)
        lanes_split(a, j->nx, first + k, tile + k, tile + EDA_LANES + k);
      for (size_t i = 0; i < 2; i++) {
        const eda_lanes *from = tile + i * EDA_LANES;
        eda_lanes *out = to->at + b * to->n + (i ? other : one) * EDA_LANES;
        eda_lanes_turn(&from->re, 2, &out->re, 2);
        eda_lanes_turn(&from->im, 2, &out->im, 2);
      }
    }
  }
  give_back(j, a);
}

/* Compute row l of a block of columns of the spline coefficients' spectrum,
   from the sum and the filtered residuals. Real and imaginary parts of
   sums[k][at] are exchanged. */
static void spline_coefficients(const sum_task *j, int first, int l,
                                const eda_lanes *const *sums, size_t at,
                                eda_lanes *to) {
  const eda_kernels *s = &j->kernels;
  const eda_frame *f = &j->mask->frame;
  double band = s->intensity_band, fy = l / f->height;
  double left = band * band - fy * fy, fx[EDA_LANES];
  int last = left < 0 ? -1 : (int)floor(f->width * sqrt(left));
  int n = MIN(EDA_LANES, last - first + 1);
  float by[EDA_LANES] = {0};
  for (int i = 0; i < n; i++) {
    fx[i] = (first + i) / f->width;
    by[i] = j->by_x[first + i] * j->by_y[abs(l)];
  }
  eda_vector b;
  eda_lanes sum = sums[0][at];
  memcpy(&b, by, sizeof b);
  for (size_t k = 0; k < s->residuals && n > 0; k++) {
    float filter[EDA_LANES] = {0};
    eda_vector r;
    s->residual(s->self, k, fx, fy, (size_t)n, filter);
    memcpy(&r, filter, sizeof r);
    sum.re += r * sums[k + 1][at].re;
    sum.im += r * sums[k + 1][at].im;
  }
  to->re = b * sum.im;
  to->im = b * sum.re;
}

/* Transform a block of columns forward along y, and backward on the grid of the
   result. */
static void columns_to_fine(void *data, size_t block) {
  sum_task *j = data;
  if (opc_cancelled(j->context)) return;
  size_t n = (size_t)j->ny;
  eda_lanes *fine = lanes_borrow(j);
  const eda_lanes *sums[SUMS];
  eda_lanes *work = fine + blocks(j->fine_y) * EDA_LANES;
  const eda_lanes_plan *plan = eda_lanes_plan_for(j->ny);
  for (size_t k = 0; k <= j->kernels.residuals; k++) {
    eda_lanes *sum = j->spectrum[k].at + block * j->spectrum[k].n;
    eda_lanes_backward(plan, sum, work);
    sums[k] = sum;
  }
  memset(fine, 0, sizeof *fine * (size_t)j->fine_y);
  for (int l = -j->top_y; l <= j->top_y; l++) {
    size_t at = l < 0 ? n - (size_t)-l : (size_t)l;
    spline_coefficients(j, (int)block * EDA_LANES, l, sums, at,
                        fine + (l < 0 ? l + j->fine_y : l));
  }
  eda_lanes_backward(eda_lanes_plan_for(j->fine_y), fine, work);
  turn_lines(fine, j->fine_y, &j->fine, block * EDA_LANES);
  give_back(j, fine);
}

/* Combine the spectra (k = 0 .. top) of two blocks of real rows to the spectrum
   of the complex block whose real and imaginary parts are the two blocks. */
EDA_WIDE static void lanes_join(const eda_lanes *first, const eda_lanes *second,
                                int top, int n, eda_lanes *a) {
  memset(a + top + 1, 0, sizeof *a * (size_t)(n - 2 * top - 1));
  for (int k = top; k >= 0; k--) {
    const eda_lanes *p = first + k, *q = second + k;
    a[k ? n - k : 0] = (eda_lanes){p->re + q->im, q->re - p->im};
    a[k] = (eda_lanes){p->re - q->im, p->im + q->re};
  }
}

/* Write a block of rows of the result. points[2 * x] is column x. */
static void write_rows(const sum_task *j, const eda_vector *points,
                       size_t block) {
  size_t n = (size_t)j->fine_x, first = block * EDA_LANES;
  size_t rows = MIN((size_t)EDA_LANES, (size_t)j->fine_y - first);
  for (size_t x = 0; x < n; x += EDA_LANES) {
    eda_vector tile[EDA_LANES];
    size_t there = MIN((size_t)EDA_LANES, n - x);
    eda_lanes_turn(points + 2 * x, 2, tile, 1);
    for (size_t y = 0; y < rows; y++)
      memcpy(j->out + (first + y) * n + x, &tile[y], there * sizeof(float));
  }
}

static void back_along_x(void *data, size_t pair) {
  sum_task *j = data;
  if (opc_cancelled(j->context)) return;
  eda_lanes *a = lanes_borrow(j);
  size_t all = blocks(j->fine_y), one = 2 * pair, other = MIN(one + 1, all - 1);
  lanes_join(j->fine.at + one * j->fine.n, j->fine.at + other * j->fine.n,
             j->top_x, j->fine_x, a);
  eda_lanes_backward(eda_lanes_plan_for(j->fine_x), a,
                     a + blocks(j->fine_x) * EDA_LANES);
  write_rows(j, &a->re, one);
  if (other != one) write_rows(j, &a->im, other);
  give_back(j, a);
}

/* Return `scale` times the ratio of spline coefficients to samples at
   frequencies 0 .. top (free()). */
static float *over_samples(int top, int n, double scale) {
  float *a = eda_alloc((size_t)top + 1, sizeof *a);
  for (int k = 0; k <= top; k++)
    a[k] = (float)(scale / eda_spline_sampled((double)k / n));
  return a;
}

/* Compute the spline coefficients of the intensity from the sums. */
static void to_spline(sum_task *j) {
  size_t fine = blocks(j->fine_y);
  j->by_x = over_samples(j->top_x, j->fine_x, 1.0 / j->nx);
  j->by_y = over_samples(j->top_y, j->fine_y, 1.0 / j->ny);
  for (size_t i = 0; i <= j->kernels.residuals; i++) {
    lines *s = &j->spectrum[i];
    s->n = j->rows * EDA_LANES;
    s->at = eda_fft_alloc(j->columns * s->n * sizeof *s->at);
  }
  j->fine.n = j->columns * EDA_LANES;
  j->fine.at = eda_fft_alloc(fine * j->fine.n * sizeof *j->fine.at);
  opc_parallel(j->context, (j->rows + 1) / 2, forth_along_x, j);
  opc_parallel(j->context, j->columns, columns_to_fine, j);
  opc_parallel(j->context, (fine + 1) / 2, back_along_x, j);
  for (int i = 0; i < SUMS; i++) eda_fft_free(j->spectrum[i].at);
  eda_fft_free(j->fine.at);
  free(j->by_x);
  free(j->by_y);
}

/* ---- grids ---- */

/* Estimate the memory of eda_mask_spectrum, add_kernels and to_spline. Assume
   groups of TOGETHER kernels, and a partial coherence factor (sigma) of 0.75:
   the band of the intensity is then 2 / (1 + 0.75) times the band of the
   mask. */
eda_image_size eda_image_forecast(eda_frame f, double band) {
  double x = f.width * band, y = f.height * band; /* frequencies k, l >= 0 */
  double nx = 2.67 * x, ny = 2.67 * y;            /* field_size */
  double fine_x = fmax(2.29 * x, f.width / default_step);
  double fine_y = fmax(2.29 * y, f.height / default_step);
  double raster = 3.15 * x * 3.15 * y * sizeof(double); /* malloc keeps it */
  double spectrum = x * 2 * y * sizeof(float complex);
  double sum = nx * ny * sizeof(float);
  double field = 2 * (x + STRIP) * ny * sizeof(float complex);
  double group = fmin(TOGETHER * field, fmax(field, FIELDS_BYTES));
  double out = fine_x * fine_y * sizeof(float);
  double bytes = raster + spectrum + sum + group + out;
  return (eda_image_size){nx, ny, bytes, out};
}

/* Return the number of field nodes along a side of `side` nm. */
static int field_size(const eda_kernels *s, double side) {
  /* The squared field has twice the band of the field. Frequencies beyond the
     intensity band must not alias into the intensity band. The factor 0.85
     allows the outermost frequencies to do so: they change the intensity by
     1e-5 of the clear field, and the smaller grid saves a quarter of the time.
     The fields must not alias at all. */
  double squared = 0.85 * (2 * s->band + s->intensity_band);
  double fields = 2 * fmax(s->intensity_band, s->band);
  return eda_lanes_size(fmax(side * squared, side * fields + 2));
}

static int fine_size(const eda_kernels *s, double side, double step) {
  return eda_lanes_size(fmax(side / step, 2 * side * s->intensity_band + 2));
}

static void choose_grids(sum_task *j, double step) {
  const eda_frame *f = &j->mask->frame;
  const eda_kernels *s = &j->kernels;
  double band = fmin(s->band, j->mask->band);
  j->nx = field_size(s, f->width);
  j->ny = field_size(s, f->height);
  j->reach = (int)floor(f->width * band);
  j->half = (int)floor(f->height * band);
  j->rows = blocks(j->ny);
  j->top_x = (int)floor(f->width * s->intensity_band);
  j->top_y = (int)floor(f->height * s->intensity_band);
  j->columns = blocks(j->top_x + 1);
  j->fine_x = fine_size(s, f->width, step);
  j->fine_y = fine_size(s, f->height, step);
  size_t work = 0, n[4] = {(size_t)j->nx, (size_t)j->ny, (size_t)j->fine_x,
                           (size_t)j->fine_y};
  for (int i = 0; i < 4; i++)
    work =
        MAX(work, MAX(n[i], eda_lanes_capacity(eda_lanes_plan_for((int)n[i]))));
  j->capacity = work + 2 * BLOCKS * EDA_LANES * j->rows +
                MAX(n[0], MAX(n[2], n[3]) + EDA_LANES) + 2 * EDA_LANES;
}

int eda_coherent_sum(const opc_context *context, const eda_spectrum *mask,
                     const eda_kernels *kernels, double step, eda_field *out,
                     opc_error *error) {
  sum_task j = {.context = context, .mask = mask, .kernels = *kernels};
  memset(out, 0, sizeof *out);
  if (!kernels->count || kernels->residuals > EDA_RESIDUALS ||
      !(kernels->band > 0 && kernels->intensity_band > 0))
    return opc_fail(error, OPC_INVALID, NULL,
                    "an image needs a kernel, bands, and at most %d residuals",
                    EDA_RESIDUALS);
  j.offset = eda_complex_of(j.kernels.offset);
  j.scale = eda_scale_of(&j.kernels);
  choose_grids(&j, step > 0 ? step : default_step);
  j.scratch = g_ptr_array_new_with_free_func(eda_fft_free);
  g_mutex_init(&j.lock);
  j.out = eda_values_new((size_t)j.fine_x * (size_t)j.fine_y);
  add_kernels(&j);
  to_spline(&j);
  for (int i = 0; i < SUMS; i++) eda_fft_free(j.sum[i]);
  g_ptr_array_free(j.scratch, TRUE);
  g_mutex_clear(&j.lock);
  *out = (eda_field){mask->frame, j.fine_x, j.fine_y, j.out};
  if (!opc_cancelled(context)) return OPC_OK;
  eda_field_clear(out);
  return opc_fail(error, OPC_CANCELLED, NULL, "cancelled");
}
