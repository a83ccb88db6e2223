/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernels of a rotationally symmetric T: it depends on |f1|, |f2| and the angle
   between them only, so that its eigenfunctions are R(|f|) exp(i m angle), found
   for each order m from a small symmetric matrix over the radius. They serve
   fields of every size.

   What the kernels that are left out would add is a slowly varying offset. It
   is put back by one incoherent system: the rest of T is taken as
   S(f1) S(f2) D(|f1 - f2|), exact for f1 = f2, and D its mean otherwise. */
#include "disks.h"
#include "kernels.h"

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

enum {
  PANELS = 4,
  FIRST = 8,        /* nodes where the whole source passes the pupil */
  OTHER = 24,       /* nodes of each panel beyond */
  NODES = FIRST + (PANELS - 1) * OTHER,
  ANGLES = 192,     /* of the integral over half a turn */
  ORDERS = 32,      /* angular orders */
  TABLE = 1024,     /* intervals of a radial function's table */
  SHIFTS = 64,      /* intervals of D's table, over shifts of 0 to 2 */
  SKIP = 4,         /* D is a mean: every so manieth angle will do */
  CHUNK = 64
};

typedef struct panel {
  double from, to;
  int first, n;     /* nodes */
} panel;

typedef struct eigen {
  double value;
  int order, index;
} eigen;

/* A coherent system: the orders +m and -m of one radial function, or two
   radial functions of order 0 in real and imaginary part. Both halves have
   the same square since the mask is real. */
typedef struct coherent {
  int order;
  float *re, *im;    /* TABLE + 2 values each; im may be `zero` */
} coherent;

typedef struct radial {
  kernels base;
  double sigma, sigma_in;
  panel panels[PANELS];
  int n;                                /* nodes in all */
  double node[NODES], weight[NODES];    /* radius, in units of the cutoff */
  double cosine[ANGLES][ORDERS];
  double *cross;        /* T at [i][j][angle], j <= i */
  double *vectors;      /* [order][node][index]: sqrt(w r) R; see solve */
  eigen *sorted;        /* strongest first */
  size_t n_sorted;
  coherent *systems;
  double *weights;
  float s_table[TABLE + 2], d_table[SHIFTS + 2];
} radial;

static float zero[TABLE + 2];

/* ---- work: expansion ---- */

static double angle_of(int a) { return M_PI * (a + 0.5) / ANGLES; }

/* T of the two annuli, normalised to T(0, 0) = 1. */
static double cross_coefficient(const radial *r, double a, double b,
                                double angle) {
  double area = opc_common_area(r->sigma, a, b, angle);
  double whole = r->sigma * r->sigma;
  if (r->sigma_in > 0) {
    area -= opc_common_area(r->sigma_in, a, b, angle);
    whole -= r->sigma_in * r->sigma_in;
  }
  return area / (M_PI * whole);
}

/* Gauss-Legendre nodes between the radii where disks begin to touch. */
static int place_nodes(radial *r) {
  double breaks[PANELS + 1] = {0, 1 - r->sigma, 1 - r->sigma_in,
                               1 + r->sigma_in, 1 + r->sigma};
  for (int p = 0; p < PANELS; p++) {
    panel *q = &r->panels[p];
    *q = (panel){breaks[p], breaks[p + 1], r->n, p ? OTHER : FIRST};
    if (!(q->to > q->from + 1e-9)) {
      q->n = 0;
      continue;
    }
    gsl_integration_glfixed_table *t =
        gsl_integration_glfixed_table_alloc((size_t)q->n);
    if (!t) return 0;
    for (int i = 0; i < q->n; i++, r->n++)
      gsl_integration_glfixed_point(q->from, q->to, (size_t)i, &r->node[r->n],
                                    &r->weight[r->n], t);
    gsl_integration_glfixed_table_free(t);
  }
  return 1;
}

static double *cross_of(const radial *r, size_t i, size_t j) {
  return r->cross + (i * (i + 1) / 2 + j) * ANGLES;
}

static void evaluate_row(void *data, size_t i) {
  const radial *r = data;
  for (size_t j = 0; j <= i; j++)
    for (int a = 0; a < ANGLES; a++)
      cross_of(r, i, j)[a] =
          cross_coefficient(r, r->node[i], r->node[j], angle_of(a));
}

/* Order m: the eigenvectors of sqrt(w_i r_i) T_m(r_i, r_j) sqrt(w_j r_j), T_m the
   Fourier coefficients of T over the angle, are sqrt(w r) R. */
static void solve(void *data, size_t m) {
  radial *r = data;
  size_t n = (size_t)r->n;
  gsl_matrix *a = gsl_matrix_alloc(n, n);
  gsl_vector *value = gsl_vector_alloc(n);
  gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(n);
  gsl_matrix_view vectors =
      gsl_matrix_view_array(r->vectors + m * n * n, n, n);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j <= i; j++) {
      const double *t = cross_of(r, i, j);
      double sum = 0;
      for (int k = 0; k < ANGLES; k++) sum += t[k] * r->cosine[k][m];
      sum *= sqrt(r->weight[i] * r->node[i] * r->weight[j] * r->node[j]) / ANGLES;
      gsl_matrix_set(a, i, j, sum);
      gsl_matrix_set(a, j, i, sum);
    }
  gsl_eigen_symmv(a, value, &vectors.matrix, work);
  for (size_t i = 0; i < n; i++)
    r->sorted[m * n + i] =
        (eigen){gsl_vector_get(value, i), (int)m, (int)i};
  gsl_eigen_symmv_free(work);
  gsl_vector_free(value);
  gsl_matrix_free(a);
}

static int by_value(const void *a, const void *b) {
  const eigen *x = a, *y = b;
  if (x->value != y->value) return x->value < y->value ? 1 : -1;
  return x->order - y->order;
}

/* ---- work: the kept kernels ---- */

/* R of an eigenfunction at the nodes. */
static void at_nodes(const radial *r, const eigen *e, double *f) {
  const double *v = r->vectors + (size_t)e->order * r->n * r->n + e->index;
  for (int i = 0; i < r->n; i++)
    f[i] = v[(size_t)i * r->n] / sqrt(r->weight[i] * r->node[i]);
}

/* The value at x of the polynomial through f at the nodes of x's panel
   (barycentric Lagrange, Berrut and Trefethen 2004). */
static double interpolate(const radial *r, const double *f, double x) {
  int p = 0;
  while (p + 1 < PANELS && (x > r->panels[p].to || !r->panels[p].n)) p++;
  while (!r->panels[p].n) p--;
  const panel *q = &r->panels[p];
  double above = 0, below = 0;
  for (int k = 0; k < q->n; k++) {
    double node = r->node[q->first + k], w = r->weight[q->first + k];
    if (x == node) return f[q->first + k];
    double c = (k % 2 ? -1 : 1) *
               sqrt(w * (node - q->from) * (q->to - node)) / (x - node);
    above += c * f[q->first + k];
    below += c;
  }
  return above / below;
}

static float *tabulate(const radial *r, const double *f, double scale,
                       float *table) {
  for (int i = 0; table && i < TABLE + 2; i++)
    table[i] = (float)(scale * interpolate(r, f, fmin(r->base.radius * i / TABLE,
                                                      r->base.radius)));
  return table;
}

static void forget_systems(radial *r) {
  for (size_t s = 0; s < r->base.count; s++) {
    free(r->systems[s].re);
    if (r->systems[s].im != zero) free(r->systems[s].im);
  }
  r->base.count = 0;
}

/* S and D of what is left when the first `kept` eigenfunctions are used. */
static int find_residual(radial *r, size_t kept) {
  double s2[NODES], s[NODES], above[SHIFTS + 1] = {0}, below[SHIFTS + 1] = {0};
  double *f = malloc((kept + 1) * (size_t)r->n * sizeof *f);
  if (!f) return 0;
  for (size_t k = 0; k < kept; k++)
    at_nodes(r, &r->sorted[k], f + k * (size_t)r->n);
  for (int i = 0; i < r->n; i++) {
    s2[i] = cross_coefficient(r, r->node[i], r->node[i], 0);
    for (size_t k = 0; k < kept; k++) {
      double x = f[k * (size_t)r->n + i];
      s2[i] -= (r->sorted[k].order ? 2 : 1) * r->sorted[k].value * x * x;
    }
    s[i] = sqrt(fmax(s2[i], 0));
  }
  for (int i = 0; i < r->n; i++)
    for (int j = 0; j <= i; j++) {
      double product[ORDERS] = {0};   /* of each order, at angle 0 */
      for (size_t k = 0; k < kept; k++)
        product[r->sorted[k].order] += (r->sorted[k].order ? 2 : 1) *
                                       r->sorted[k].value *
                                       f[k * (size_t)r->n + i] *
                                       f[k * (size_t)r->n + j];
      double area = r->weight[i] * r->node[i] * r->weight[j] * r->node[j];
      for (int a = 0; a < ANGLES; a += SKIP) {
        double rest = cross_of(r, (size_t)i, (size_t)j)[a];
        for (int m = 0; m < ORDERS; m++) rest -= product[m] * r->cosine[a][m];
        double x = r->node[i], y = r->node[j];
        double shift = sqrt(fmax(0, x * x + y * y - 2 * x * y * cos(angle_of(a))));
        int bin = (int)(shift * SHIFTS / 2 + 0.5);
        if (bin > SHIFTS) continue;
        above[bin] += area * rest * s[i] * s[j];
        below[bin] += area * s[i] * s[i] * s[j] * s[j];
      }
    }
  for (int b = 0; b < SHIFTS + 2; b++)
    r->d_table[b] = b <= SHIFTS && below[b] > 0 ? (float)(above[b] / below[b]) : 0;
  r->d_table[0] = 1;
  tabulate(r, s, 1, r->s_table);
  free(f);
  return 1;
}

static int keep(kernels *base, size_t n) {
  radial *r = (radial *)base;
  double f[NODES];
  forget_systems(r);
  coherent *open = NULL;   /* of order 0, with room for another one */
  size_t kept = 0;
  for (; kept < r->n_sorted; kept++) {
    const eigen *e = &r->sorted[kept];
    if (base->count == n && (e->order || !open)) break;
    at_nodes(r, e, f);
    float *table = tabulate(r, f, e->order ? 1 : sqrt(e->value),
                            malloc((TABLE + 2) * sizeof *table));
    if (!table) return 0;
    if (!e->order && open) {
      open->im = table;
      open = NULL;
      continue;
    }
    coherent *s = &r->systems[base->count];
    *s = (coherent){e->order, table, zero};
    r->weights[base->count++] = e->order ? 2 * e->value : 1;
    if (!e->order) open = s;
  }
  base->weight = r->weights;
  return find_residual(r, kept);
}

/* ---- work: transfer functions ---- */

/* R(|f|) exp(i order angle) at CHUNK frequencies (fx[i], fy), or both radial
   functions of order 0. */
WIDE static void chunk(const float *restrict re_table,
                       const float *restrict im_table, int order, float scale,
                       const double *restrict fx, float fy,
                       float *restrict out) {
  float re[CHUNK], im[CHUNK], zx[CHUNK], zy[CHUNK];
  for (int i = 0; i < CHUNK; i++) {
    float x = (float)fx[i], f = sqrtf(x * x + fy * fy);
    float place = fminf(f * scale, TABLE), inverse = f > 0 ? 1 / f : 0;
    int k = (int)place;
    float t = place - (float)k;
    re[i] = re_table[k] + t * (re_table[k + 1] - re_table[k]);
    im[i] = im_table[k] + t * (im_table[k + 1] - im_table[k]);
    zx[i] = x * inverse;
    zy[i] = fy * inverse;
  }
  for (int m = 0; m < order; m++)
    for (int i = 0; i < CHUNK; i++) {
      float x = re[i] * zx[i] - im[i] * zy[i];
      im[i] = re[i] * zy[i] + im[i] * zx[i];
      re[i] = x;
    }
  for (int i = 0; i < CHUNK; i++) {
    out[2 * i] = re[i];
    out[2 * i + 1] = im[i];
  }
}

static void transfer(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out) {
  const radial *r = self;
  coherent rest_of_it = {0, (float *)r->s_table, zero};
  const coherent *c = s < r->base.count ? &r->systems[s] : &rest_of_it;
  float scale = (float)(TABLE / (r->base.radius * r->base.cutoff)), y = (float)fy;
  size_t i = 0;
  for (; i + CHUNK <= n; i += CHUNK)
    chunk(c->re, c->im, c->order, scale, fx + i, y, out + 2 * i);
  double rest[CHUNK] = {0};
  float last[2 * CHUNK];
  memcpy(rest, fx + i, (n - i) * sizeof *rest);
  chunk(c->re, c->im, c->order, scale, rest, y, last);
  memcpy(out + 2 * i, last, 2 * (n - i) * sizeof *last);
}

static void residual(const void *self, const double *fx, double fy, size_t n,
                     float *out) {
  const radial *r = self;
  for (size_t i = 0; i < n; i++) {
    double place = sqrt(fx[i] * fx[i] + fy * fy) / r->base.cutoff * SHIFTS / 2;
    int k = place < SHIFTS ? (int)place : SHIFTS;
    float t = (float)(place - k);
    out[i] = r->d_table[k] + t * (r->d_table[k + 1] - r->d_table[k]);
  }
}

/* ---- entry ---- */

static void destroy(kernels *base) {
  radial *r = (radial *)base;
  forget_systems(r);
  free(r->systems);
  free(r->weights);
  free(r->cross);
  free(r->vectors);
  free(r->sorted);
  free(r);
}

kernels *radial_kernels(const opc_host *host, double cutoff, double sigma,
                        double sigma_in) {
  gsl_set_error_handler_off();   /* its default aborts */
  radial *r = calloc(1, sizeof *r);
  if (!r) return NULL;
  r->base = (kernels){.host = host, .cutoff = cutoff, .radius = 1 + sigma,
                      .has_residual = 1, .keep = keep, .transfer = transfer,
                      .residual = residual, .free = destroy};
  r->sigma = sigma;
  r->sigma_in = sigma_in;
  for (int a = 0; a < ANGLES; a++)
    for (int m = 0; m < ORDERS; m++) r->cosine[a][m] = cos(m * angle_of(a));
  if (!place_nodes(r)) goto fail;
  size_t n = (size_t)r->n;
  r->cross = malloc(n * (n + 1) / 2 * ANGLES * sizeof *r->cross);
  r->vectors = malloc(ORDERS * n * n * sizeof *r->vectors);
  r->sorted = malloc(ORDERS * n * sizeof *r->sorted);
  r->systems = calloc(ORDERS * n, sizeof *r->systems);
  r->weights = calloc(ORDERS * n, sizeof *r->weights);
  if (!r->cross || !r->vectors || !r->sorted || !r->systems || !r->weights)
    goto fail;
  host->parallel(host, n, evaluate_row, r);
  host->parallel(host, ORDERS, solve, r);
  qsort(r->sorted, ORDERS * n, sizeof *r->sorted, by_value);
  size_t zeros = 0;   /* of order 0: two fill a system */
  while (r->n_sorted < ORDERS * n &&
         r->sorted[r->n_sorted].value > 1e-7 * r->sorted[0].value)
    zeros += !r->sorted[r->n_sorted++].order;
  r->base.available = r->n_sorted - zeros / 2;
  return &r->base;
fail:
  destroy(&r->base);
  return NULL;
}
