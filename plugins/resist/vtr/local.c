/* SPDX-License-Identifier: BSD-3-Clause */
#include "local.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 16 }; /* of a task */

/* A window along one axis: weights that sum to 1. */
typedef struct window {
  int reach;
  float *weight; /* 2 * reach + 1 */
} window;

typedef struct work {
  const opc_field *image;
  int nx, ny;
  float *maximum, *slope; /* I^8 and |grad I|^2, then M and S */
  const float *from;      /* of a pass of a window */
  float *to;
  const window *window;
} work;

static int window_make(window *w, double radius, double step) {
  double deviation = radius / 2, sum = 0;
  w->reach = (int)ceil(4 * deviation / step);
  w->weight = malloc(sizeof *w->weight * (size_t)(2 * w->reach + 1));
  if (!w->weight) return 0;
  for (int pass = 0; pass < 2; pass++)
    for (int i = -w->reach; i <= w->reach; i++) {
      double t = deviation > 0 ? i * step / deviation : 0;
      double g = fabs(t) <= 4 ? exp(-t * t / 2) : 0;
      if (pass)
        w->weight[i + w->reach] = (float)(g / sum);
      else
        sum += g;
    }
  return 1;
}

static int wrap(int i, int n) {
  i %= n;
  return i < 0 ? i + n : i;
}

/* The rows of a task. */
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
  const opc_field *f = w->image;
  double dx = f->frame.width / f->nx, dy = f->frame.height / f->ny;
  size_t at = (size_t)j * (size_t)w->nx;
  memset(across, 0, sizeof *across * (size_t)w->nx);
  memset(along, 0, sizeof *along * (size_t)w->nx);
  /* Coefficient j + k has the B-spline at -k. */
  for (int k = -2; k <= 2; k++) {
    const float *c =
        f->coefficients + (size_t)wrap(j + k, w->ny) * (size_t)w->nx;
    for (int i = 0; i < w->nx; i++) {
      across[i] += value5[2 - k] * c[i];
      along[i] += slope5[2 - k] * c[i];
    }
  }
  for (int i = 0; i < w->nx; i++) {
    double value = 0, gx = 0, gy = 0;
    for (int k = -2; k <= 2; k++) {
      int n = wrap(i + k, w->nx);
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

/* Rows that no memory was there for are NaN, which reaches the result. */
static void evaluate(void *data, size_t block) {
  const work *w = data;
  double *across = malloc(2 * sizeof *across * (size_t)w->nx);
  for (int j = (int)block * ROWS; j < rows_end(w, block); j++) {
    if (across) {
      evaluate_row(w, j, across, across + w->nx);
      continue;
    }
    for (int i = 0; i < w->nx; i++)
      w->maximum[(size_t)j * (size_t)w->nx + (size_t)i] = NAN;
  }
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
      int shift = wrap(k, w->nx), left = w->nx - shift;
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
      const float *from = w->from + (size_t)wrap(j + k, w->ny) * (size_t)w->nx;
      for (int i = 0; i < w->nx; i++) to[i] += weight * from[i];
    }
  }
}

/* The mean over the neighbourhood, in place; `spare` is lost. */
static int mean(const opc_host *host, work *w, float *field, float *spare,
                double radius) {
  size_t blocks = (size_t)(w->ny + ROWS - 1) / ROWS;
  const opc_frame *f = &w->image->frame;
  window x = {0}, y = {0};
  int ok = window_make(&x, radius, f->width / w->nx) &&
           window_make(&y, radius, f->height / w->ny);
  if (ok) {
    w->from = field;
    w->to = spare;
    w->window = &x;
    host->parallel(host, blocks, along_x, w);
    w->from = spare;
    w->to = field;
    w->window = &y;
    host->parallel(host, blocks, along_y, w);
  }
  free(x.weight);
  free(y.weight);
  return ok;
}

/* ---- the field ---- */

static int means(const opc_host *host, work *w, const local_settings *s,
                 const double a[4], float *spare) {
  int maximum = a[1] != 0 || a[3] != 0, slope = a[2] != 0 || a[3] != 0;
  size_t blocks = (size_t)(w->ny + ROWS - 1) / ROWS;
  host->parallel(host, blocks, evaluate, w);
  return (!maximum || mean(host, w, w->maximum, spare, s->radius)) &&
         (!slope || mean(host, w, w->slope, spare, s->slope_radius));
}

int local_field(const opc_host *host, const local_settings *settings,
                const double a[4], opc_field *image, opc_field *out,
                opc_error *error) {
  memset(out, 0, sizeof *out);
  int code = host->imaging->resample(host, image, settings->step, error);
  if (code) return code;
  size_t n = (size_t)image->nx * (size_t)image->ny;
  work w = {.image = image,
            .nx = image->nx,
            .ny = image->ny,
            .maximum = malloc(n * sizeof(float)),
            .slope = malloc(n * sizeof(float))};
  *out = *image;
  out->coefficients = host->alloc(host, n, sizeof(float));
  int ok = w.maximum && w.slope && out->coefficients &&
           means(host, &w, settings, a, out->coefficients);
  for (size_t i = 0; ok && i < n; i++) {
    double m = sqrt(sqrt(sqrt((double)w.maximum[i])));
    double s = sqrt((double)w.slope[i]);
    ok = !isnan(m);
    out->coefficients[i] = (float)(a[1] * m + a[2] * s + a[3] * m * s);
  }
  free(w.maximum);
  free(w.slope);
  code = ok ? host->imaging->from_samples(host, out, error)
            : host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  if (code) host->imaging->release_field(host, out);
  return code;
}
