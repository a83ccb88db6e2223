/* SPDX-License-Identifier: BSD-3-Clause */
/* Gradient of a weighted integral over an image with respect to the mask: the
   adjoint of a sum of coherent kernels. One kernel contributes the spectrum of
   (weight * field) times the conjugated transfer function, in a small rectangle
   of frequencies. Contributions are stored separately and added in order, so
   that results do not depend on the number of threads. */
#include "imaging/fft.h"
#include "imaging/values.h"

#include <complex.h>
#include <eda/imaging.h>
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

typedef float complex number;

typedef struct gradient_task {
  const eda_spectrum *mask;
  const eda_kernels *kernels;
  const eda_field *weight;
  int nx, ny;
  int half, reach; /* coefficients (k, l) may be non-zero for |l| <= half and
                      |k| <= reach */
  size_t columns, rows;
  number *sums; /* [kernel][row l][column k] */
} gradient_task;

static size_t modulo(int i, int n) { return (size_t)(i < 0 ? i + n : i); }

/* ---- between frequencies and nodes ---- */

/* Copy square[row l][column k] to values[y][x] and transform to nodes. */
static void to_nodes(const gradient_task *j, const number *square,
                     number *values) {
  size_t nx = (size_t)j->nx, ny = (size_t)j->ny;
  number *lines = eda_fft_alloc(j->columns * ny * sizeof *lines);
  memset(lines, 0, j->columns * ny * sizeof *lines);
  for (int l = -j->half; l <= j->half; l++)
    for (size_t c = 0; c < j->columns; c++)
      lines[c * ny + modulo(l, j->ny)] =
          square[(size_t)(l + j->half) * j->columns + c];
  eda_fft_run(eda_fft_plan(EDA_FFT_BACKWARD, j->ny, (int)j->columns), lines,
              NULL);
  memset(values, 0, nx * ny * sizeof *values);
  for (size_t c = 0; c < j->columns; c++) {
    size_t x = modulo((int)c - j->reach, j->nx);
    for (size_t y = 0; y < ny; y++) values[y * nx + x] = lines[c * ny + y];
  }
  eda_fft_run(eda_fft_plan(EDA_FFT_BACKWARD, j->nx, j->ny), values, NULL);
  eda_fft_free(lines);
}

/* Transform values[y][x] to the Fourier coefficients square[row l][column k].
   Destroys `values`. */
static void to_square(const gradient_task *j, number *values, number *square) {
  size_t nx = (size_t)j->nx, ny = (size_t)j->ny;
  float scale = 1 / ((float)j->nx * (float)j->ny);
  number *lines = eda_fft_alloc(j->columns * ny * sizeof *lines);
  eda_fft_run(eda_fft_plan(EDA_FFT_FORWARD, j->nx, j->ny), values, NULL);
  for (size_t c = 0; c < j->columns; c++) {
    size_t x = modulo((int)c - j->reach, j->nx);
    for (size_t y = 0; y < ny; y++) lines[c * ny + y] = values[y * nx + x];
  }
  eda_fft_run(eda_fft_plan(EDA_FFT_FORWARD, j->ny, (int)j->columns), lines,
              NULL);
  for (int l = -j->half; l <= j->half; l++)
    for (size_t c = 0; c < j->columns; c++)
      square[(size_t)(l + j->half) * j->columns + c] =
          scale * lines[c * ny + modulo(l, j->ny)];
  eda_fft_free(lines);
}

/* ---- one kernel ---- */

/* Return coefficient (k, l) of the mask spectrum, which stores only k >= 0. */
static number mask_at(const eda_spectrum *m, int k, int l) {
  int flip = k < 0;
  if (flip) k = -k, l = -l;
  size_t row = modulo(l, m->rows);
  const float *a = m->data + 2 * (row * (size_t)m->columns + (size_t)k);
  return a[0] + (flip ? -a[1] : a[1]) * I;
}

static void gradient_transfer(const gradient_task *j, size_t kernel,
                              number *out) {
  const eda_kernels *s = j->kernels;
  double *fx = eda_alloc(j->columns, sizeof *fx);
  for (size_t c = 0; c < j->columns; c++)
    fx[c] = ((int)c - j->reach) / j->mask->frame.width;
  for (int l = -j->half; l <= j->half; l++)
    s->transfer(s->self, kernel, fx, l / j->mask->frame.height, j->columns,
                (float *)(out + (size_t)(l + j->half) * j->columns));
  free(fx);
}

static void add_kernel(void *data, size_t i) {
  const gradient_task *j = data;
  size_t n = j->rows * j->columns, nodes = (size_t)j->nx * (size_t)j->ny;
  number *sum = j->sums + i * n, scale = eda_scale_of(j->kernels);
  number *through = eda_alloc(n, sizeof *through);
  number *field = eda_fft_alloc(nodes * sizeof *field);
  gradient_transfer(j, i, through);
  for (size_t a = 0; a < n; a++) {
    int l = (int)(a / j->columns) - j->half;
    int k = (int)(a % j->columns) - j->reach;
    number light = scale * mask_at(j->mask, k, l);
    if (!k && !l) light += eda_complex_of(j->kernels->offset);
    sum[a] = through[a] * light;
  }
  to_nodes(j, sum, field);
  for (size_t a = 0; a < nodes; a++) field[a] *= j->weight->coefficients[a];
  to_square(j, field, sum);
  float weight = (float)j->kernels->weight[i];
  for (size_t a = 0; a < n; a++) sum[a] *= weight * conjf(through[a]);
  eda_fft_free(field);
  free(through);
}

/* ---- sum of kernels ---- */

int eda_coherent_gradient(const opc_context *context, const eda_spectrum *mask,
                          const eda_kernels *kernels, const eda_field *weight,
                          eda_field *out, opc_error *error) {
  double band = kernels->band < mask->band ? kernels->band : mask->band;
  gradient_task j = {.mask = mask,
                     .kernels = kernels,
                     .weight = weight,
                     .nx = weight->nx,
                     .ny = weight->ny,
                     .half = (int)(mask->frame.height * band),
                     .reach = (int)(mask->frame.width * band)};
  memset(out, 0, sizeof *out);
  if (kernels->mirror || j.nx % 2 || j.ny % 2 || j.nx <= 2 * j.reach ||
      j.ny <= 2 * j.half)
    return opc_fail(
        error, OPC_INVALID, NULL,
        "a gradient needs kernels without mirror symmetry, and even "
        "numbers of nodes above the numbers of frequencies; found "
        "%d x %d nodes and %d x %d frequencies",
        j.nx, j.ny, 2 * j.reach + 1, 2 * j.half + 1);
  j.columns = 2 * (size_t)j.reach + 1;
  j.rows = 2 * (size_t)j.half + 1;
  size_t n = j.rows * j.columns, nodes = (size_t)j.nx * (size_t)j.ny;
  j.sums = eda_alloc(kernels->count * n, sizeof *j.sums);
  opc_parallel(context, kernels->count, add_kernel, &j);
  for (size_t i = 1; i < kernels->count; i++)
    for (size_t a = 0; a < n; a++) j.sums[a] += j.sums[i * n + a];
  number *values = eda_fft_alloc(nodes * sizeof *values);
  to_nodes(&j, j.sums, values);
  *out = (eda_field){weight->frame, j.nx, j.ny,
                     eda_alloc(nodes, sizeof *out->coefficients)};
  /* Shapes are opaque, so the amplitude decreases with coverage: factor
     -scale. */
  number scale = -2 * conjf(eda_scale_of(kernels));
  for (size_t a = 0; a < nodes; a++)
    out->coefficients[a] = crealf(scale * values[a]);
  eda_fft_free(values);
  free(j.sums);
  if (!opc_cancelled(context)) return OPC_OK;
  eda_field_clear(out);
  return opc_fail(error, OPC_CANCELLED, NULL, "cancelled");
}
