/* SPDX-License-Identifier: BSD-3-Clause */
/* The systems of a rotationally symmetric T: the strongest of its
   eigenfunctions.

   What the kernels that are left out would add is a slowly varying offset. It
   is put back by one incoherent system: the rest of T is taken as
   S(f1) S(f2) D(|f1 - f2|), exact for f1 = f2, and D its mean otherwise. */
#include <eda/memory.h>
#include <math.h>
#include <string.h>

#include "disks.h"
#include "radial.h"

enum { CHUNK = 32 }; /* frequencies at a time */

/* ---- work: the kept kernels ---- */

static void tabulate(const radial *r, const double *f, double scale,
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
    free(r->systems[s].re);
    free(r->systems[s].im);
  }
  r->base.count = 0;
}

/* Of a pair of nodes (every other node, counted from 0): a little further on
   for each pair, so that together they take all shifts evenly. */
static double angle_of(int i, int j, int a) {
  double turn = 0.6180339887 * i + 0.7548776662 * j;
  return M_PI * (a + turn - floor(turn)) / ANGLES;
}

/* A sum over orders at all angles of a pair. */
static void sum_orders(const double term[ORDERS], int i, int j,
                       double out[ANGLES]) {
  for (int a = 0; a < ANGLES; a++) {
    double c = cos(angle_of(i, j, a)), before = 1, now = c, sum = term[0];
    for (int m = 1; m < ORDERS; m++) {
      sum += 2 * term[m] * now;
      double next = 2 * c * now - before;
      before = now;
      now = next;
    }
    out[a] = sum;
  }
}

/* What the first `kept` eigenfunctions leave of T at a pair of nodes, all
   angles: of T itself where it is known, as its orders do not end. */
static void rest_of(const radial *r, size_t kept, int i, int j,
                    double rest[ANGLES]) {
  size_t n = (size_t)r->n, at = (size_t)i * n + (size_t)j;
  size_t pair = (size_t)(i / 2) * (size_t)(i / 2 + 1) / 2 + (size_t)(j / 2);
  double term[ORDERS];
  for (size_t m = 0; m < ORDERS; m++)
    term[m] = r->real ? 0 : r->t[0][m * n * n + at];
  for (size_t k = 0; k < kept; k++) {
    const eigen *e = &r->sorted[k];
    for (int part = 0; part < (r->real ? 1 : 2); part++) {
      const double *f = radial_function(r, e, part);
      term[e->order] -= e->value * f[i] * f[j];
    }
  }
  sum_orders(term, i / 2, j / 2, rest);
  for (int a = 0; r->real && a < ANGLES; a++)
    rest[a] += r->pairs[pair * ANGLES + (size_t)a];
}

double radial_cross(const radial *r, double a, double b, double angle) {
  double area = opc_common_area(r->sigma, a, b, angle);
  if (r->sigma_in > 0) area -= opc_common_area(r->sigma_in, a, b, angle);
  return area / (M_PI * (r->sigma * r->sigma - r->sigma_in * r->sigma_in));
}

void radial_evaluate_pairs(void *self, size_t i) {
  radial *r = self;
  double *to = r->pairs + i * (i + 1) / 2 * ANGLES;
  for (size_t j = 0; j <= i; j++)
    for (int a = 0; a < ANGLES; a++)
      *to++ = radial_cross(r, r->node[2 * i], r->node[2 * j],
                           angle_of((int)i, (int)j, a));
}

/* S and D of what is left when the first `kept` eigenfunctions are used. D is
   the best one in the sense of least squares for masks whose spectrum falls
   off. */
static void find_residual(radial *r, size_t kept) {
  double s[NODES], above[SHIFTS + 1] = {0}, below[SHIFTS + 1] = {0};
  for (int i = 0; i < r->n; i++) {
    double sum = radial_cross(r, r->node[i], r->node[i], 0);
    for (size_t k = 0; k < kept; k++)
      for (int part = 0; part < (r->real ? 1 : 2); part++) {
        double f = radial_function(r, &r->sorted[k], part)[i];
        sum -= (r->sorted[k].order ? 2 : 1) * r->sorted[k].value * f * f;
      }
    s[i] = sqrt(fmax(sum, 0));
  }
  /* A mean: every other node will do. */
  for (int i = 0; i < r->n; i += 2)
    for (int j = 0; j <= i; j += 2) {
      double rest[ANGLES], x = r->node[i], y = r->node[j];
      double area = r->root[i] * r->root[i] * r->root[j] * r->root[j];
      rest_of(r, kept, i, j, rest);
      for (int a = 0; a < ANGLES; a++) {
        double c = cos(angle_of(i / 2, j / 2, a));
        double shift = sqrt(fmax(0, x * x + y * y - 2 * x * y * c));
        int bin = (int)(shift * SHIFTS / 2 + 0.5);
        if (bin > SHIFTS) continue;
        above[bin] += area * rest[a] * s[i] * s[j];
        below[bin] += area * s[i] * s[i] * s[j] * s[j];
      }
    }
  for (int b = 0; b < SHIFTS + 2; b++)
    r->base.d_table[b] =
        b <= SHIFTS && below[b] > 0 ? (float)(above[b] / below[b]) : 0;
  r->base.d_table[0] = 1;
  for (int i = 0; i < TABLE + 2; i++) {
    double sum = r->diagonal[i];
    for (size_t k = 0; k < r->base.count; k++) {
      const coherent *c = &r->systems[k];
      double re = c->re[i], im = c->im ? c->im[i] : 0;
      sum -= r->weights[k] * (re * re + im * im);
    }
    r->s_table[i] = (float)sqrt(fmax(sum, 0));
  }
}

static float *new_table(const radial *r, const eigen *e, int part,
                        double scale) {
  float *table = eda_alloc(TABLE + 2, sizeof *table);
  tabulate(r, radial_function(r, e, part), scale, table);
  return table;
}

/* A system for order m or -m of an eigenfunction. */
static void add_system(radial *r, const eigen *e, int order) {
  size_t s = r->base.count++;
  coherent *c = &r->systems[s];
  int pair = r->real && order;
  *c = (coherent){.order = order};
  r->weights[s] = r->real && !order ? 1 : (pair ? 2 : 1) * e->value;
  c->re = new_table(r, e, 0, r->real && !order ? sqrt(e->value) : 1);
  if (!r->real) c->im = new_table(r, e, 1, 1);
}

void radial_keep(kernels *base, size_t n) {
  radial *r = (radial *)base;
  size_t kept = radial_solve(r, n), open = SIZE_MAX;
  radial_drop(r);
  for (size_t k = 0; k < kept; k++) {
    const eigen *e = &r->sorted[k];
    if (r->real && !e->order && open != SIZE_MAX) {
      r->systems[open].im = new_table(r, e, 0, sqrt(e->value));
      open = SIZE_MAX;
      continue;
    }
    if (!e->order) open = base->count;
    add_system(r, e, e->order);
    if (!r->real && e->order) add_system(r, e, -e->order);
  }
  base->weight = r->weights;
  base->all = kept == r->n_sorted;
  find_residual(r, kept);
}

/* ---- work: transfer functions ---- */

/* The values of a table at CHUNK places. */
EDA_WIDE static void look_up(const float *restrict table,
                             const float *restrict place, float *restrict out) {
  for (int i = 0; i < CHUNK; i++) {
    int k = (int)place[i];
    out[i] = table[k] + (place[i] - (float)k) * (table[k + 1] - table[k]);
  }
}

/* R(|f|) exp(i order angle) at CHUNK frequencies (fx[i], fy). */
EDA_WIDE static void chunk(const coherent *c, float scale,
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
  look_up(c->re, place, re);
  if (c->im) look_up(c->im, place, im);
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
  const coherent rest = {.re = (float *)r->s_table};
  const coherent *c = s < r->base.count ? &r->systems[s] : &rest;
  float scale = (float)(TABLE / (r->base.radius * r->base.cutoff)),
        y = (float)fy;
  size_t i = 0;
  for (; i + CHUNK <= n; i += CHUNK) chunk(c, scale, fx + i, y, out + 2 * i);
  if (i == n) return;
  double last[CHUNK] = {0};
  float values[2 * CHUNK];
  memcpy(last, fx + i, (n - i) * sizeof *last);
  chunk(c, scale, last, y, values);
  memcpy(out + 2 * i, values, 2 * (n - i) * sizeof *values);
}

/* R exp(i m angle) is turned round to R exp(-i m angle), times -1 if m is odd.
 */
eda_mirrored radial_mirror(const void *self, size_t s) {
  const radial *r = self;
  int order = s < r->base.count ? r->systems[s].order : 0;
  eda_mirrored m = {.system = s, .odd = order % 2 != 0};
  if (r->real)
    m.conjugate = order != 0;
  else if (order)
    m.system = order > 0 ? s + 1 : s - 1; /* that of -order */
  return m;
}
