/* SPDX-License-Identifier: BSD-3-Clause */
/* Images as sums of coherent systems.

   A field is transformed back along x, only in the rows that the band reaches,
   and then along y, a few columns at a time in the cache, where its square is
   added up at once: no field is ever written. The sum is taken on a grid fine
   enough that nothing folds into the band of the intensity. Last, the sum goes
   forth and, as coefficients of a B-spline, back on the grid of the result;
   again only along lines that the band reaches. */
#include "core/imaging/fft.h"
#include "core/imaging/imaging.h"
#include "core/imaging/simd.h"
#include "core/imaging/spline.h"
#include "core/plugin/host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
  /* Systems are added up in this many sums, each in order, and the sums in
     order: the result does not know how many threads there were. */
  SUMS = 4,
  LINES = 16           /* columns at a time: a cache line each way */
};

static const double default_step = 32;   /* nm */

typedef struct job {
  const opc_host *host;
  const opc_spectrum *mask;
  const opc_systems *systems;
  float complex offset, scale;   /* of the mask's transmission */
  int nx, ny;              /* the grid of the fields */
  int half;                /* rows l = -half .. half are not zero */
  size_t sums;
  float *sum[SUMS + 1];    /* [x][y]; the last one of the residual system */
  int failed;              /* atomic */

  int top;                 /* rows l = 0 .. top of the intensity are kept */
  float complex *by_row[2];   /* sum and residual after y: [l][x], l >= 0 */
  int fine_x, fine_y;      /* the grid of the result */
  float complex *fine;     /* the result before y: [l][x], l >= 0 */
  float *out;
} job;

static int least(int a, int b) { return a < b ? a : b; }

static void *room(job *j, size_t count, size_t size) {
  void *memory = opc_fft_alloc(count * size);
  if (!memory) __atomic_store_n(&j->failed, 1, __ATOMIC_RELAXED);
  return memory;
}

/* ---- a field ---- */

/* to[k] = t[k] * a[k]; both as re, im. */
OPC_WIDE static void multiply(const float *restrict t, const float *restrict a,
                              float sign, int n, float *restrict to) {
  for (int k = 0; k < n; k++) {
    float x = a[2 * k], y = sign * a[2 * k + 1];
    to[2 * k] = t[2 * k] * x - t[2 * k + 1] * y;
    to[2 * k + 1] = t[2 * k] * y + t[2 * k + 1] * x;
  }
}

/* Row l of the field's spectrum, in the order of the transform. `transfer` is
   filled for k = 0 .. reach and then for k = -1 .. -reach. */
static void fill_row(const job *j, size_t s, int l, double *fx,
                     float *transfer, float complex *row) {
  const opc_spectrum *m = j->mask;
  double band = fmin(j->systems->band, m->band), fy = l / m->frame.height;
  int reach = (int)floor(m->frame.width * sqrt(fmax(0, band * band - fy * fy)));
  int n = 2 * reach + 1;
  for (int k = 0; k <= reach; k++) fx[k] = k / m->frame.width;
  for (int k = 1; k <= reach; k++) fx[reach + k] = -fx[k];
  j->systems->transfer(j->systems->self, s, fx, fy, (size_t)n, transfer);

  /* The mask's row, from the half that is stored: a[-k, l] is the conjugate of
     a[k, -l]. */
  const float complex *a = (const float complex *)m->data;
  const float complex *right = a + (size_t)((l + m->rows) % m->rows) * m->columns;
  const float complex *left =
      a + (size_t)((m->rows - l) % m->rows) * m->columns;
  memset(row, 0, sizeof *row * (size_t)j->nx);
  multiply(transfer, (const float *)right, 1, reach + 1, (float *)row);
  float complex *back = row + j->nx;
  const float complex *t = (const float complex *)transfer + reach;
  for (int k = 1; k <= reach; k++) back[-k] = t[k] * conjf(left[k]);
  if (j->scale != 1)
    for (int k = 0; k < j->nx; k++) row[k] *= j->scale;
  if (l == 0) row[0] += j->offset * *(const float complex *)transfer;
}

OPC_WIDE static void add_square(const float *restrict field, float weight,
                                size_t n, float *restrict sum) {
  for (size_t i = 0; i < n; i++)
    sum[i] += weight * (field[2 * i] * field[2 * i] +
                        field[2 * i + 1] * field[2 * i + 1]);
}

/* From rows [l + half][x] to columns [x][l mod ny], with zeros between. */
static void gather(const job *j, const float complex *rows, int x, int lines,
                   float complex *columns) {
  for (int c = 0; c < lines; c++)
    memset(columns + (size_t)c * j->ny + j->half + 1, 0,
           sizeof *columns * (size_t)(j->ny - 2 * j->half - 1));
  for (int l = -j->half; l <= j->half; l++) {
    const float complex *row = rows + (size_t)(l + j->half) * j->nx + x;
    float complex *to = columns + (l < 0 ? l + j->ny : l);
    for (int c = 0; c < lines; c++) to[(size_t)c * j->ny] = row[c];
  }
}

typedef struct buffers {
  double *fx;
  float *transfer;
  float complex *rows, *columns;
} buffers;

static void add_system(const job *j, size_t s, float weight, const buffers *b,
                       float *sum) {
  const opc_fft *along_x = opc_fft_plan(OPC_FFT_BACKWARD, j->nx, 1);
  for (int l = -j->half; l <= j->half; l++) {
    float complex *row = b->rows + (size_t)(l + j->half) * j->nx;
    fill_row(j, s, l, b->fx, b->transfer, row);
    opc_fft_run(along_x, row, NULL);
  }
  for (int x = 0; x < j->nx; x += LINES) {
    int lines = least(LINES, j->nx - x);
    gather(j, b->rows, x, lines, b->columns);
    opc_fft_run(opc_fft_plan(OPC_FFT_BACKWARD, j->ny, lines), b->columns, NULL);
    add_square((const float *)b->columns, weight, (size_t)lines * j->ny,
               sum + (size_t)x * j->ny);
  }
}

/* Sum g: every SUMS-th system, or the residual one. */
static void add_systems(void *data, size_t g) {
  job *j = data;
  size_t n = (size_t)j->nx * j->ny;
  buffers b = {.fx = room(j, (size_t)j->nx + 2, sizeof *b.fx),
               .transfer = room(j, (size_t)j->nx + 2, sizeof(float complex)),
               .rows = room(j, (size_t)(2 * j->half + 1) * j->nx, sizeof *b.rows),
               .columns = room(j, (size_t)LINES * j->ny, sizeof *b.columns)};
  j->sum[g] = room(j, n, sizeof(float));
  if (b.fx && b.transfer && b.rows && b.columns && j->sum[g]) {
    memset(j->sum[g], 0, n * sizeof(float));
    size_t count = j->systems->count;
    if (g == j->sums)
      add_system(j, count, 1, &b, j->sum[g]);
    else
      for (size_t s = g; s < count; s += j->sums)
        add_system(j, s, (float)j->systems->weight[s], &b, j->sum[g]);
  }
  opc_fft_free(b.fx);
  opc_fft_free(b.transfer);
  opc_fft_free(b.rows);
  opc_fft_free(b.columns);
}

/* ---- from the sums to the result ---- */

OPC_WIDE static void add(float *restrict to, const float *restrict from,
                         size_t n) {
  for (size_t i = 0; i < n; i++) to[i] += from[i];
}

/* Transform LINES columns of the sums along y; keep rows 0 .. top. */
static void forth_along_y(void *data, size_t block) {
  job *j = data;
  int x = (int)block * LINES, lines = least(LINES, j->nx - x);
  int width = j->ny / 2 + 1;
  size_t at = (size_t)x * j->ny, n = (size_t)lines * j->ny;
  const opc_fft *plan = opc_fft_plan(OPC_FFT_REAL_FORWARD, j->ny, lines);
  float *in = room(j, n, sizeof *in);
  float complex *half = room(j, (size_t)lines * width, sizeof *half);
  for (int part = 0; part < 2 && in && half; part++) {
    size_t first = part ? j->sums : 0;
    if (!j->by_row[part]) continue;
    memcpy(in, j->sum[first] + at, n * sizeof *in);
    for (size_t g = 1; g < j->sums && !part; g++) add(in, j->sum[g] + at, n);
    opc_fft_run(plan, in, half);
    for (int l = 0; l <= j->top; l++)
      for (int c = 0; c < lines; c++)
        j->by_row[part][(size_t)l * j->nx + x + c] = half[(size_t)c * width + l];
  }
  opc_fft_free(in);
  opc_fft_free(half);
}

/* Row l: forth along x, in the band only, less what the B-spline does to
   samples, and back along x on the grid of the result. */
static void row_to_fine(void *data, size_t row) {
  job *j = data;
  const opc_frame *f = &j->mask->frame;
  double band = j->systems->intensity_band, fy = (double)row / f->height;
  int l = (int)row, reach = (int)floor(f->width * sqrt(fmax(0, band * band - fy * fy)));
  const opc_fft *forth = opc_fft_plan(OPC_FFT_FORWARD, j->nx, 1);
  float complex *sum = j->by_row[0] + row * (size_t)j->nx;
  opc_fft_run(forth, sum, NULL);
  if (j->by_row[1]) {
    float complex *rest = j->by_row[1] + row * (size_t)j->nx;
    size_t n = (size_t)reach + 1;
    double *fx = room(j, n, sizeof *fx);
    float *filter = room(j, n, sizeof *filter);
    opc_fft_run(forth, rest, NULL);
    if (fx && filter) {
      for (size_t k = 0; k < n; k++) fx[k] = (double)k / f->width;
      /* A filter of a real system: the same at k and -k. */
      j->systems->residual(j->systems->self, fx, fy, n, filter);
      sum[0] += filter[0] * rest[0];
      for (int k = 1; k <= reach; k++) {
        sum[k] += filter[k] * rest[k];
        sum[j->nx - k] += filter[k] * rest[j->nx - k];
      }
    }
    opc_fft_free(fx);
    opc_fft_free(filter);
  }
  float complex *to = j->fine + row * (size_t)j->fine_x;
  double scale = 1.0 / ((double)j->nx * j->ny) /
                 opc_spline_sampled((double)l / j->fine_y);
  memset(to, 0, sizeof *to * (size_t)j->fine_x);
  for (int k = 0; k <= reach; k++) {
    float by = (float)(scale / opc_spline_sampled((double)k / j->fine_x));
    to[k] = by * sum[k];
    if (k) to[j->fine_x - k] = by * sum[j->nx - k];
  }
  opc_fft_run(opc_fft_plan(OPC_FFT_BACKWARD, j->fine_x, 1), to, NULL);
}

/* LINES columns of the result, back along y. */
static void back_along_y(void *data, size_t block) {
  job *j = data;
  int x = (int)block * LINES, lines = least(LINES, j->fine_x - x);
  int width = j->fine_y / 2 + 1;
  float complex *half = room(j, (size_t)lines * width, sizeof *half);
  float *columns = room(j, (size_t)lines * j->fine_y, sizeof *columns);
  if (half && columns) {
    memset(half, 0, sizeof *half * (size_t)lines * width);
    for (int l = 0; l <= j->top; l++)
      for (int c = 0; c < lines; c++)
        half[(size_t)c * width + l] = j->fine[(size_t)l * j->fine_x + x + c];
    opc_fft_run(opc_fft_plan(OPC_FFT_REAL_BACKWARD, j->fine_y, lines), half,
                columns);
    for (int y = 0; y < j->fine_y; y++)
      for (int c = 0; c < lines; c++)
        j->out[(size_t)y * j->fine_x + x + c] = columns[(size_t)c * j->fine_y + y];
  }
  opc_fft_free(half);
  opc_fft_free(columns);
}

static size_t blocks(int n) { return (size_t)(n + LINES - 1) / LINES; }

/* Coefficients of the spline that goes through the band-limited samples. */
static void to_spline(job *j, double step, opc_field *out) {
  const opc_frame *f = &out->frame;
  double band = j->systems->intensity_band;
  /* The finer grid holds at least the band. */
  out->nx = j->fine_x = opc_fft_size(fmax(f->width / step, 2 * f->width * band + 2));
  out->ny = j->fine_y =
      opc_fft_size(fmax(f->height / step, 2 * f->height * band + 2));
  j->top = (int)floor(f->height * band);
  size_t rows = (size_t)j->top + 1;
  j->by_row[0] = room(j, rows * (size_t)j->nx, sizeof(float complex));
  if (j->systems->residual)
    j->by_row[1] = room(j, rows * (size_t)j->nx, sizeof(float complex));
  j->fine = room(j, rows * (size_t)j->fine_x, sizeof(float complex));
  out->coefficients = j->out = j->host->alloc(
      j->host, (size_t)j->fine_x * j->fine_y, sizeof(float));
  if (!j->out) j->failed = 1;
  if (!j->failed) {
    j->host->parallel(j->host, blocks(j->nx), forth_along_y, j);
    j->host->parallel(j->host, rows, row_to_fine, j);
    j->host->parallel(j->host, blocks(j->fine_x), back_along_y, j);
  }
  opc_fft_free(j->by_row[0]);
  opc_fft_free(j->by_row[1]);
  opc_fft_free(j->fine);
}

int opc_coherent_sum(const opc_host *host, const opc_spectrum *mask,
                     const opc_systems *systems, double step, opc_field *out,
                     opc_error *error) {
  memset(out, 0, sizeof *out);
  if (!systems->count || !(systems->band > 0 && systems->intensity_band > 0))
    return opc_fail(error, OPC_INVALID, NULL, "an image needs a system");
  /* What a square has beyond the band of the intensity must not fold into it;
     the outermost part of the square is so weak that folding it costs less than
     1e-5 of the clear field, and saves a quarter of the time. */
  double samples = 0.85 * (2 * systems->band + systems->intensity_band);
  double whole = 2 * systems->intensity_band; /* all of its band is there */
  const double *scale = systems->scale, *offset = systems->offset;
  job j = {.host = host, .mask = mask, .systems = systems,
           .offset = (float)offset[0] + (float)offset[1] * I,
           .scale = scale[0] == 0 && scale[1] == 0
                        ? 1
                        : (float)scale[0] + (float)scale[1] * I,
           .nx = opc_fft_size(fmax(mask->frame.width * samples,
                                   mask->frame.width * whole + 2)),
           .ny = opc_fft_size(fmax(mask->frame.height * samples,
                                   mask->frame.height * whole + 2)),
           .half = (int)floor(mask->frame.height * fmin(systems->band, mask->band)),
           .sums = systems->count < SUMS ? systems->count : SUMS};
  out->frame = mask->frame;
  host->parallel(host, j.sums + (systems->residual != NULL), add_systems, &j);
  if (!j.failed) to_spline(&j, step > 0 ? step : default_step, out);
  for (size_t g = 0; g <= SUMS; g++) opc_fft_free(j.sum[g]);
  if (!j.failed) return OPC_OK;
  host->free(host, out->coefficients);
  memset(out, 0, sizeof *out);
  return opc_fail(error, OPC_FAILED, NULL, "out of memory");
}
