/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements means of the intensity and its slope over Gaussian windows, which
   are applied along x, then along y. */
#include "local.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 16 }; /* rows per task */

/* A window along one axis: weights that sum to 1. */
typedef struct window {
  int reach;
  float *weight; /* [2 * reach + 1], weights */
} window;

typedef struct work {
  const eda_field *image;
  int nx, ny;
  float *maximum, *slope; /* I^8 and |grad I|^2, later M and S */
  const float *from;      /* input of a pass of a window */
  float *to;
  const window *window;
} work;

static void window_init(window *w, double radius, double step) {
  double deviation = radius / 2, sum = 0;
  w->reach = (int)ceil(4 * deviation / step);
  w->weight = eda_alloc(2 * (size_t)w->reach + 1, sizeof *w->weight);
  for (int pass = 0; pass < 2; pass++)
    for (int i = -w->reach; i <= w->reach; i++) {
      double t = deviation > 0 ? i * step / deviation : 0;
      double g = fabs(t) <= 4 ? exp(-t * t / 2) : 0;
      if (pass)
        w->weight[i + w->reach] = (float)(g / sum);
      else
        sum += g;
    }
}

/* Return the index after the last row of a task. */
static int rows_end(const work *w, size_t block) {
  int end = (int)(block + 1) * ROWS;
  return end < w->ny ? end : w->ny;
}

/* ---- values at the nodes ---- */

/* The quintic B-spline and its derivative at -2 .. 2. */
static const double value5[5] = {1 / 120.0, 26 / 120.0, 66 / 120.0, 26 / 120.0,
                                 1 / 120.0};
static const double slope5[5] = {1 / 24.0, 10 / 24.0, 0, -10 / 24.0, -1 / 24.0};

static void evaluate_row(const work *w, int j, double *across, double *along) {
  const eda_field *f = w->image;
  double dx = f->frame.width / f->nx, dy = f->frame.height / f->ny;
  size_t at = (size_t)j * (size_t)w->nx;
  memset(across, 0, sizeof *across * (size_t)w->nx);
  memset(along, 0, sizeof *along * (size_t)w->nx);
  /* At node j, the B-spline of coefficient j + k has the argument -k. */
  for (int k = -2; k <= 2; k++) {
    const float *c =
        f->coefficients + (size_t)eda_wrap(j + k, w->ny) * (size_t)w->nx;
    for (int i = 0; i < w->nx; i++) {
      across[i] += value5[2 - k] * c[i];
      along[i] += slope5[2 - k] * c[i];
    }
  }
  for (int i = 0; i < w->nx; i++) {
    double value = 0, gx = 0, gy = 0;
    for (int k = -2; k <= 2; k++) {
      int n = eda_wrap(i + k, w->nx);
      value += value5[2 - k] * across[n];
      gx += slope5[2 - k] * across[n];
      gy += value5[2 - k] * along[n];
    }
    gx /= dx;
    gy /= dy;
    double square = value > 0 ? value * value : 0;
    w->maximum[at + (size_t)i] = (float)(square * square * square * square);
    w->slope[at + (size_t)i] = (float)(gx * gx + gy * gy);
  }
}

static void work_evaluate(void *data, size_t block) {
  const work *w = data;
  double *across = eda_alloc(2 * (size_t)w->nx, sizeof *across);
  for (int j = (int)block * ROWS; j < rows_end(w, block); j++)
    evaluate_row(w, j, across, across + w->nx);
  free(across);
}

/* ---- windows ---- */

static void along_x(void *data, size_t block) {
  const work *w = data;
  int reach = w->window->reach;
  for (int j = (int)block * ROWS; j < rows_end(w, block); j++) {
    const float *from = w->from + (size_t)j * (size_t)w->nx;
    float *to = w->to + (size_t)j * (size_t)w->nx;
    memset(to, 0, sizeof *to * (size_t)w->nx);
    for (int k = -reach; k <= reach; k++) {
      float weight = w->window->weight[k + reach];
      int shift = eda_wrap(k, w->nx), left = w->nx - shift;
      for (int i = 0; i < left; i++) to[i] += weight * from[i + shift];
      for (int i = left; i < w->nx; i++) to[i] += weight * from[i - left];
    }
  }
}

static void along_y(void *data, size_t block) {
  const work *w = data;
  int reach = w->window->reach;
  for (int j = (int)block * ROWS; j < rows_end(w, block); j++) {
    float *to = w->to + (size_t)j * (size_t)w->nx;
    memset(to, 0, sizeof *to * (size_t)w->nx);
    for (int k = -reach; k <= reach; k++) {
      float weight = w->window->weight[k + reach];
      const float *from =
          w->from + (size_t)eda_wrap(j + k, w->ny) * (size_t)w->nx;
      for (int i = 0; i < w->nx; i++) to[i] += weight * from[i];
    }
  }
}

/* Replace a field by its mean over the window; `spare` is overwritten. */
static void window_mean(const opc_context *context, work *w, float *field,
                        float *spare, double radius) {
  size_t blocks = (size_t)(w->ny + ROWS - 1) / ROWS;
  const eda_frame *f = &w->image->frame;
  window x, y;
  window_init(&x, radius, f->width / w->nx);
  window_init(&y, radius, f->height / w->ny);
  w->from = field;
  w->to = spare;
  w->window = &x;
  opc_parallel(context, blocks, along_x, w);
  w->from = spare;
  w->to = field;
  w->window = &y;
  opc_parallel(context, blocks, along_y, w);
  free(x.weight);
  free(y.weight);
}

/* ---- the field ---- */

int local_field(const opc_context *context, const local_settings *settings,
                const double a[4], eda_field *image, eda_field *out,
                opc_error *error) {
  int maximum = a[1] != 0 || a[3] != 0, slope = a[2] != 0 || a[3] != 0;
  memset(out, 0, sizeof *out);
  int code = eda_field_resample(context, image, settings->step, error);
  if (code) return code;
  size_t n = (size_t)image->nx * (size_t)image->ny;
  work w = {.image = image,
            .nx = image->nx,
            .ny = image->ny,
            .maximum = eda_alloc(n, sizeof(float)),
            .slope = eda_alloc(n, sizeof(float))};
  *out = *image;
  out->coefficients = eda_alloc(n, sizeof(float));
  opc_parallel(context, (size_t)(w.ny + ROWS - 1) / ROWS, work_evaluate, &w);
  float *spare = out->coefficients;
  if (maximum) window_mean(context, &w, w.maximum, spare, settings->radius);
  if (slope) window_mean(context, &w, w.slope, spare, settings->slope_radius);
  for (size_t i = 0; i < n; i++) {
    double m = sqrt(sqrt(sqrt((double)w.maximum[i])));
    double s = sqrt((double)w.slope[i]);
    out->coefficients[i] = (float)(a[1] * m + a[2] * s + a[3] * m * s);
  }
  free(w.maximum);
  free(w.slope);
  eda_field_from_samples(context, out);
  return OPC_OK;
}
