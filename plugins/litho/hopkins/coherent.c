/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the coherent kernels of a rotationally symmetric T from its
   strongest eigenfunctions. */
#include <eda/memory.h>
#include <math.h>
#include <string.h>

#include "disks.h"
#include "radial.h"

enum { CHUNK = 32 }; /* number of frequencies computed at a time */

/* ---- work: kernels in use ---- */

static void table_fill(const radial *r, const double *f, double scale,
                       float *table) {
  for (int i = 0; i < TABLE + 2; i++) {
    const double *blend = r->blend + (size_t)i * OTHER, *from = f + r->begin[i];
    double sum = 0;
    for (int k = 0; k < OTHER && r->begin[i] + k < r->n; k++)
      sum += blend[k] * from[k];
    table[i] = (float)(scale * sum);
  }
}

void radial_drop(radial *r) {
  for (size_t s = 0; s < r->base.count; s++) {
    free(r->kernels[s].re);
    free(r->kernels[s].im);
  }
  r->base.count = 0;
}

double radial_cross(const radial *r, double a, double b, double angle) {
  double area = opc_common_area(r->sigma, a, b, angle);
  if (r->sigma_in > 0) area -= opc_common_area(r->sigma_in, a, b, angle);
  return area / (M_PI * (r->sigma * r->sigma - r->sigma_in * r->sigma_in));
}

static float *table_new(const radial *r, const eigen *e, int part,
                        double scale) {
  float *table = eda_alloc(TABLE + 2, sizeof *table);
  table_fill(r, radial_function(r, e, part), scale, table);
  return table;
}

/* Add a kernel for an eigenfunction. If mask and pupil are real, one kernel
   represents the orders m and -m, with twice the weight; otherwise `order` is m
   or -m. */
static void coherent_add(radial *r, const eigen *e, int order) {
  size_t s = r->base.count++;
  coherent *c = &r->kernels[s];
  int pair = r->real && order;
  *c = (coherent){.order = order};
  r->weights[s] = r->real && !order ? 1 : (pair ? 2 : 1) * e->value;
  c->re = table_new(r, e, 0, r->real && !order ? sqrt(e->value) : 1);
  if (!r->real) c->im = table_new(r, e, 1, 1);
}

void radial_keep(kernels *base, size_t n) {
  radial *r = (radial *)base;
  size_t kept = radial_solve(r, n), open = SIZE_MAX;
  radial_drop(r);
  for (size_t k = 0; k < kept; k++) {
    const eigen *e = &r->sorted[k];
    if (r->real && !e->order && open != SIZE_MAX) {
      r->kernels[open].im = table_new(r, e, 0, sqrt(e->value));
      open = SIZE_MAX;
      continue;
    }
    if (!e->order) open = base->count;
    coherent_add(r, e, e->order);
    if (!r->real && e->order) coherent_add(r, e, -e->order);
  }
  base->weight = r->weights;
  base->all = kept == r->n_sorted;
  radial_find_residual(r, kept);
}

/* ---- work: transfer functions ---- */

/* Interpolate a table linearly at CHUNK positions. */
EDA_WIDE static void table_look_up(const float *restrict table,
                                   const float *restrict place,
                                   float *restrict out) {
  for (int i = 0; i < CHUNK; i++) {
    int k = (int)place[i];
    out[i] = table[k] + (place[i] - (float)k) * (table[k + 1] - table[k]);
  }
}

/* Compute R(|f|) exp(i order angle) at CHUNK frequencies (fx[i], fy). */
EDA_WIDE static void coherent_chunk(const coherent *c, float scale,
                                    const double *restrict fx, float fy,
                                    float *restrict out) {
  float re[CHUNK], im[CHUNK] = {0}, zx[CHUNK], zy[CHUNK], place[CHUNK];
  float side = c->order < 0 ? -1 : 1;
  for (int i = 0; i < CHUNK; i++) {
    float x = (float)fx[i], f = sqrtf(x * x + fy * fy);
    float inverse = f > 0 ? 1 / f : 0;
    place[i] = f * scale < (float)TABLE ? f * scale : (float)TABLE;
    zx[i] = x * inverse;
    zy[i] = side * fy * inverse;
  }
  table_look_up(c->re, place, re);
  if (c->im) table_look_up(c->im, place, im);
  for (int m = abs(c->order); m > 0; m /= 2)
    for (int i = 0; i < CHUNK; i++) {
      float zr = zx[i], zi = zy[i], x = re[i], y = im[i];
      if (m % 2) {
        re[i] = x * zr - y * zi;
        im[i] = x * zi + y * zr;
      }
      zx[i] = zr * zr - zi * zi;
      zy[i] = 2 * zr * zi;
    }
  for (int i = 0; i < CHUNK; i++) {
    out[2 * i] = re[i];
    out[2 * i + 1] = im[i];
  }
}

void radial_transfer(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out) {
  const radial *r = self;
  if (s >= r->base.count) {
    radial_residual(r, s - r->base.count, fx, fy, n, out);
    return;
  }
  const coherent *c = &r->kernels[s];
  float scale = (float)(TABLE / (r->base.radius * r->base.cutoff)),
        y = (float)fy;
  size_t i = 0;
  for (; i + CHUNK <= n; i += CHUNK)
    coherent_chunk(c, scale, fx + i, y, out + 2 * i);
  if (i == n) return;
  double last[CHUNK] = {0};
  float values[2 * CHUNK];
  memcpy(last, fx + i, (n - i) * sizeof *last);
  coherent_chunk(c, scale, last, y, values);
  memcpy(out + 2 * i, values, 2 * (n - i) * sizeof *values);
}

/* The mirror image of R exp(i m angle) is R exp(-i m angle), times -1 if m is
   odd. The same applies to S cos(angle) and i S sin(angle), for residual
   terms. */
eda_mirrored radial_mirror(const void *self, size_t s) {
  const radial *r = self;
  if (s >= r->base.count)
    return (eda_mirrored){
        .kernel = s, .conjugate = s > r->base.count, .odd = 1};
  int order = r->kernels[s].order;
  eda_mirrored m = {.kernel = s, .odd = order % 2 != 0};
  if (r->real)
    m.conjugate = order != 0;
  else if (order)
    m.kernel = order > 0 ? s + 1 : s - 1; /* the kernel of -order */
  return m;
}
