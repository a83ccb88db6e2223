/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernels of any T, from the source: T(f1, f2) = sum over source points s of
   w P(f1 + s) conj P(f2 + s). Any orthonormal mixture of the points gives the
   same T; the eigenvectors of their Gram matrix give it with the fewest. Each
   kernel, the mixture of shifted pupils, is a function of the frequency itself
   and kept as a table over the plane.

   A pupil's edge is spread over a cell of the source grid, as a source point
   stands for its whole cell; its middle alone would make kernels jump. What
   kernels that are left out and the spread edges lack of T is put back by one
   incoherent system, S(f1) S(f2) D(|f1 - f2|): exact for f1 = f2. */
#include "kernels.h"

#include <complex.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

enum {
  POINTS = 400,     /* about so many of the source */
  MOST = 120,       /* kernels */
  CELLS = 128,      /* of the tables, each way */
  SHIFTS = 64,      /* intervals of D's table, over shifts of 0 to 2 */
  THIN = 5          /* D is taken from every so manieth node each way */
};

typedef struct plane {
  kernels base;
  const optics *o;
  double defocus, spacing;
  double *points;          /* x, y, weight of each source point */
  size_t n;
  int side;                /* of the tables: nodes each way */
  double step, low;        /* their step and first node */
  float complex *shifted;  /* sqrt(w) P(f + s): [node][point] */
  float complex *vectors;  /* [kernel][point] */
  float complex *table;    /* [kernel][node] */
  double *weights;
  float *diagonal;         /* T(f, f): [node] */
  float *s_table;          /* S: [node] */
  float d_table[SHIFTS + 2];
  int failed;              /* atomic */
} plane;

/* ---- work ---- */

/* The pupil over a cell around (x, y). */
static float complex soft_pupil(const plane *p, double x, double y) {
  double r = hypot(x, y), half = p->spacing / 2;
  double inside = half > 0 ? fmin(1, fmax(0, (1 - r) / p->spacing + 0.5)) : r <= 1;
  if (inside <= 0) return 0;
  double to = r > 1 - 1e-12 ? (1 - 1e-12) / r : 1, re, im;
  optics_pupil(p->o, p->defocus, x * to, y * to, &re, &im);
  return (float)(inside * re) + (float)(inside * im) * I;
}

static void fill_node_row(void *data, size_t j) {
  plane *p = data;
  double y = p->low + p->step * (double)j;
  for (int i = 0; i < p->side; i++) {
    double x = p->low + p->step * i, sum = 0;
    size_t node = j * (size_t)p->side + (size_t)i;
    float complex *row = p->shifted + node * p->n;
    for (size_t s = 0; s < p->n; s++) {
      const double *q = p->points + 3 * s;
      float complex a = soft_pupil(p, x + q[0], y + q[1]);
      row[s] = (float)sqrt(q[2]) * a;
      sum += q[2] * cabsf(a);   /* the part of the cell within the pupil */
    }
    p->diagonal[node] = (float)sum;
  }
}

/* a[0 .. n] += conj(x) * y[0 .. n] as re, im pairs. */
WIDE static void add_product(float *restrict a, float re, float im,
                             const float *restrict y, size_t n) {
  for (size_t i = 0; i < n; i++) {
    a[2 * i] += re * y[2 * i] + im * y[2 * i + 1];
    a[2 * i + 1] += re * y[2 * i + 1] - im * y[2 * i];
  }
}

typedef struct gram {
  plane *p;
  float complex *matrix;   /* [point][point] */
} gram;

enum { ROWS = 16 };

/* Some rows of the Gram matrix: sum over nodes of conj(a_s) a_t. */
static void gram_rows(void *data, size_t block) {
  gram *g = data;
  const plane *p = g->p;
  size_t first = block * ROWS, last = first + ROWS < p->n ? first + ROWS : p->n;
  size_t nodes = (size_t)p->side * (size_t)p->side;
  for (size_t k = 0; k < nodes; k++) {
    const float complex *row = p->shifted + k * p->n;
    for (size_t s = first; s < last; s++)
      if (row[s] != 0)
        add_product((float *)(g->matrix + s * p->n), crealf(row[s]),
                    cimagf(row[s]), (const float *)row, p->n);
  }
}

/* The strongest eigenvectors; weights are the eigenvalues' part of the
   trace. */
static int solve(plane *p, opc_error *error) {
  size_t n = p->n, most = n < MOST ? n : MOST;
  gram g = {p, calloc(n * n, sizeof *g.matrix)};
  float *value = malloc(n * sizeof *value);
  float complex *z = malloc(n * most * sizeof *z);
  lapack_int *support = malloc(2 * n * sizeof *support), found = 0;
  int code = OPC_OK;
  if (!g.matrix || !value || !z || !support) {
    code = p->base.host->fail(p->base.host, error, OPC_FAILED, NULL,
                              "out of memory");
    goto done;
  }
  p->base.host->parallel(p->base.host, (n + ROWS - 1) / ROWS, gram_rows, &g);
  /* Row s, column t of the matrix is conj(a_s) a_t; as LAPACK's columns, its
     transpose: eigenvectors come conjugated. */
  if (LAPACKE_cheevr(LAPACK_COL_MAJOR, 'V', 'I', 'U', (lapack_int)n, g.matrix,
                     (lapack_int)n, 0, 0, (lapack_int)(n - most + 1),
                     (lapack_int)n, 0, &found, value, z, (lapack_int)n,
                     support) ||
      found != (lapack_int)most) {
    code = p->base.host->fail(p->base.host, error, OPC_FAILED, NULL,
                              "no eigenvalues of the source's %zu points", n);
    goto done;
  }
  for (size_t k = 0; k < most; k++)   /* from the strongest */
    for (size_t s = 0; s < n; s++)
      p->vectors[k * n + s] = conjf(z[(most - 1 - k) * n + s]);
  p->base.available = 0;
  while (p->base.available < most &&
         value[most - 1 - p->base.available] > 1e-6F * value[most - 1])
    p->base.available++;
done:
  free(g.matrix);
  free(value);
  free(z);
  free(support);
  return code;
}

/* A row of nodes of all tables: the kernels there. */
static void mix_row(void *data, size_t j) {
  plane *p = data;
  size_t nodes = (size_t)p->side * (size_t)p->side;
  for (size_t node = j * (size_t)p->side; node < (j + 1) * (size_t)p->side;
       node++)
    for (size_t k = 0; k < p->base.available; k++) {
      const float complex *a = p->shifted + node * p->n;
      const float complex *v = p->vectors + k * p->n;
      float re = 0, im = 0;
      for (size_t s = 0; s < p->n; s++) {
        re += crealf(a[s]) * crealf(v[s]) - cimagf(a[s]) * cimagf(v[s]);
        im += crealf(a[s]) * cimagf(v[s]) + cimagf(a[s]) * crealf(v[s]);
      }
      p->table[k * nodes + node] = re + im * I;
    }
}

static size_t nodes_of(const plane *p) {
  return (size_t)p->side * (size_t)p->side;
}

/* D from pairs of nodes: the mean of the kernels left out over S S. */
static void find_shifts(plane *p) {
  double above[SHIFTS + 1] = {0}, below[SHIFTS + 1] = {0};
  size_t nodes = nodes_of(p), side = (size_t)p->side;
  for (size_t a = 0; a < nodes; a++) {
    if (a % side % THIN || a / side % THIN || p->s_table[a] == 0) continue;
    for (size_t b = 0; b <= a; b++) {
      if (b % side % THIN || b / side % THIN || p->s_table[b] == 0) continue;
      double dx = (double)(a % side) - (double)(b % side);
      double dy = (double)(a / side) - (double)(b / side);
      int bin = (int)(hypot(dx, dy) * p->step * SHIFTS / 2 + 0.5);
      if (bin > SHIFTS) continue;
      double rest = 0, product = (double)p->s_table[a] * p->s_table[b];
      for (size_t k = p->base.count; k < p->base.available; k++)
        rest += crealf(p->table[k * nodes + a] *
                       conjf(p->table[k * nodes + b]));
      above[bin] += rest * product;
      below[bin] += product * product;
    }
  }
  for (int i = 0; i < SHIFTS + 2; i++)
    p->d_table[i] =
        i <= SHIFTS && below[i] > 0 ? (float)(above[i] / below[i]) : 0;
  p->d_table[0] = 1;
}

static int keep(kernels *base, size_t n) {
  plane *p = (plane *)base;
  size_t nodes = nodes_of(p);
  base->count = n < base->available ? n : base->available;
  for (size_t i = 0; i < nodes; i++) {
    float rest = p->diagonal[i];
    for (size_t k = 0; k < base->count; k++) {
      float complex a = p->table[k * nodes + i];
      rest -= crealf(a * conjf(a));
    }
    p->s_table[i] = sqrtf(fmaxf(rest, 0));
  }
  find_shifts(p);
  return 1;
}

/* Bilinear between the nodes. */
static void transfer(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out) {
  const plane *p = self;
  size_t side = (size_t)p->side;
  double y = (fy / p->base.cutoff - p->low) / p->step;
  int j = (int)y;
  float v = (float)(y - j);
  for (size_t i = 0; i < n; i++) {
    double x = (fx[i] / p->base.cutoff - p->low) / p->step;
    int k = (int)x;
    float u = (float)(x - k);
    size_t a = (size_t)j * side + (size_t)k, b = a + side;
    float complex value;
    if (s < p->base.count) {
      const float complex *t = p->table + s * nodes_of(p);
      value = (1 - v) * ((1 - u) * t[a] + u * t[a + 1]) +
              v * ((1 - u) * t[b] + u * t[b + 1]);
    } else {
      const float *t = p->s_table;
      value = (1 - v) * ((1 - u) * t[a] + u * t[a + 1]) +
              v * ((1 - u) * t[b] + u * t[b + 1]);
    }
    out[2 * i] = crealf(value);
    out[2 * i + 1] = cimagf(value);
  }
}

static void residual(const void *self, const double *fx, double fy, size_t n,
                     float *out) {
  const plane *p = self;
  for (size_t i = 0; i < n; i++) {
    double place = hypot(fx[i], fy) / p->base.cutoff * SHIFTS / 2;
    int k = place < SHIFTS ? (int)place : SHIFTS;
    float t = (float)(place - k);
    out[i] = p->d_table[k] + t * (p->d_table[k + 1] - p->d_table[k]);
  }
}

/* ---- entry ---- */

static void destroy(kernels *base) {
  plane *p = (plane *)base;
  free(p->points);
  free(p->shifted);
  free(p->vectors);
  free(p->table);
  free(p->weights);
  free(p->diagonal);
  free(p->s_table);
  free(p);
}

/* The spacing that cuts a source into about POINTS cells. */
static int cut_source(plane *p) {
  double r = optics_source_radius(p->o);
  p->spacing = 2 * r / 12;
  for (int i = 0; i < 12; i++) {
    free(p->points);
    p->points = optics_source_points(p->o, p->spacing, &p->n);
    if (!p->points || p->n > POINTS * 3 / 4 || p->o->source == OPTICS_LIST) break;
    p->spacing *= sqrt((double)p->n / POINTS);
  }
  if (p->o->source == OPTICS_LIST) p->spacing = 0;
  return p->points != NULL;
}

kernels *plane_kernels(const opc_host *host, const optics *o, double defocus,
                       opc_error *error) {
  plane *p = calloc(1, sizeof *p);
  if (!p) goto memory;
  p->base = (kernels){.host = host, .cutoff = o->cutoff,
                      .radius = 1 + optics_source_radius(o),
                      .has_residual = 1, .keep = keep, .transfer = transfer,
                      .residual = residual, .free = destroy};
  p->o = o;
  p->defocus = defocus;
  if (!cut_source(p)) goto memory;
  /* Two nodes of margin, for the interpolation at the border. */
  p->side = CELLS + 5;
  p->step = 2 * p->base.radius / CELLS;
  p->low = -p->base.radius - 2 * p->step;
  size_t nodes = nodes_of(p), most = p->n < MOST ? p->n : MOST;
  p->diagonal = malloc(nodes * sizeof *p->diagonal);
  p->s_table = malloc(nodes * sizeof *p->s_table);
  p->shifted = malloc(nodes * p->n * sizeof *p->shifted);
  p->vectors = malloc(most * p->n * sizeof *p->vectors);
  p->table = malloc(most * nodes * sizeof *p->table);
  p->weights = malloc(most * sizeof *p->weights);
  if (!p->shifted || !p->vectors || !p->table || !p->weights || !p->diagonal ||
      !p->s_table)
    goto memory;
  for (size_t k = 0; k < most; k++) p->weights[k] = 1;
  p->base.weight = p->weights;
  host->parallel(host, (size_t)p->side, fill_node_row, p);
  if (solve(p, error)) {
    destroy(&p->base);
    return NULL;
  }
  host->parallel(host, (size_t)p->side, mix_row, p);
  free(p->shifted);
  p->shifted = NULL;
  return &p->base;
memory:
  host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  if (p) destroy(&p->base);
  return NULL;
}
