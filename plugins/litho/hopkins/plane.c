/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements kernels of any T from the source: T(f1, f2) = sum over source
   points s of w P(f1 + s) conj P(f2 + s). Every orthonormal mixture of the
   points has the same T; mixtures by the eigenvectors of the points' Gram
   matrix require the fewest kernels. Each kernel, a mixture of shifted pupils,
   is a function of the frequency and stored as a table over the plane. Each
   part of polarised light (vector.h) counts as a separate point.

   The edge of a pupil is spread over a cell of the source grid, because a
   source point represents its entire cell; sharp edges would make kernels
   discontinuous. One residual term, S(f1) S(f2) D(|f1 - f2|), approximates the
   truncated kernels and the loss by spread edges; it is exact for f1 = f2. */
#include <complex.h>
#include <eda/memory.h>
#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

#include "kernels.h"

/* ---- state ---- */

enum {
  POINTS = 400, /* approximate number of points into which the source is
                   divided */
  SPARE = 20,   /* additional vectors of the subspace iteration */
  CELLS = 128,  /* cells of the tables in each direction */
  THIN = 5,     /* D is fitted on every THIN-th node in each direction */
  SHIFTS = 64   /* intervals of the table of D, for shifts |h| of 0 to 2 */
};

typedef struct plane {
  kernels base;
  const optics *o;
  double defocus, spacing;
  double *points;         /* x, y, weight: [point][3] */
  size_t parts;           /* parts of polarised light per point */
  size_t n;               /* number of parts of all points */
  size_t available;       /* number of kernels computed, strongest first */
  int side;               /* nodes of the tables in each direction */
  double step, low;       /* spacing and first node of the tables */
  float complex *shifted; /* sqrt(w) P(f + s) times the factor of a part:
                             [node][part] */
  float complex *vectors; /* [kernel][part] */
  float complex *table;   /* [kernel][node] */
  double *weights;
  float *diagonal; /* T(f, f): [node] */
  float *s_table;  /* S: [node] */
  float d_table[SHIFTS + 2];
} plane;

/* ---- work ---- */

/* Return the mean of the pupil over a cell around (x, y). */
static float complex soft_pupil(const plane *p, double x, double y) {
  double r = hypot(x, y), half = p->spacing / 2;
  double inside =
      half > 0 ? fmin(1, fmax(0, (1 - r) / p->spacing + 0.5)) : r <= 1;
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
    for (size_t s = 0; s < p->n; s += p->parts) {
      const double *q = p->points + 3 * (s / p->parts);
      double u = x + q[0], v = y + q[1], factor[VECTOR_PARTS];
      float complex a = soft_pupil(p, u, v);
      if (a == 0) continue;
      double to = fmin(1, 1 / hypot(u, v));
      vector_factors(p->o, q, to * u, to * v, factor);
      for (size_t k = 0; k < p->parts; k++) {
        row[s + k] = (float)(sqrt(q[2]) * factor[k]) * a;
        /* The mean of |P|^2 over the cell is the fraction of the cell inside
           the pupil. */
        sum += q[2] * factor[k] * factor[k] * cabsf(a);
      }
    }
    p->diagonal[node] = (float)sum;
  }
}

/* Add conj(x) * y[i] to a[i], i < n, as re, im pairs. */
EDA_WIDE static void add_product(float *restrict a, float re, float im,
                                 const float *restrict y, size_t n) {
  for (size_t i = 0; i < n; i++) {
    a[2 * i] += re * y[2 * i] + im * y[2 * i + 1];
    a[2 * i + 1] += re * y[2 * i + 1] - im * y[2 * i];
  }
}

typedef struct gram {
  plane *p;
  float complex *matrix; /* [point][point] */
} gram;

enum { ROWS = 16 };

/* Compute ROWS rows of the Gram matrix: sum over nodes of conj(a_s) a_t. */
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

/* The Gram matrix and some vectors, [vector][point]. */
typedef struct block {
  const gram *g;
  const float complex *in;
  float complex *out;
} block;

/* Compute out = matrix * in for one vector; the matrix is Hermitian. */
static void gram_multiply(void *data, size_t k) {
  const block *b = data;
  size_t n = b->g->p->n;
  const float complex *x = b->in + k * n;
  float complex *y = b->out + k * n;
  memset(y, 0, n * sizeof *y);
  for (size_t t = 0; t < n; t++)
    add_product((float *)y, crealf(x[t]), cimagf(x[t]),
                (const float *)(b->g->matrix + t * n), n);
  for (size_t s = 0; s < n; s++) y[s] = conjf(y[s]);
}

static double complex vectors_dot(const float complex *a,
                                  const float complex *b, size_t n) {
  double complex sum = 0;
  for (size_t i = 0; i < n; i++) sum += conj((double complex)a[i]) * b[i];
  return sum;
}

/* Orthonormalise vectors by two passes of Gram-Schmidt. */
static void vectors_orthonormalise(float complex *q, size_t count, size_t n) {
  for (size_t k = 0; k < count; k++) {
    float complex *v = q + k * n;
    for (int pass = 0; pass < 2; pass++)
      for (size_t i = 0; i < k; i++) {
        float complex c = (float complex)vectors_dot(q + i * n, v, n);
        for (size_t s = 0; s < n; s++) v[s] -= c * q[i * n + s];
      }
    double length = sqrt(creal(vectors_dot(v, v, n)));
    float by = length > 0 ? (float)(1 / length) : 0;
    for (size_t s = 0; s < n; s++) v[s] *= by;
  }
}

/* Compute the eigenvectors of the matrix in the span of q, strongest first, and
   store them in p->vectors. `z` contains matrix * q. */
static void plane_mix_span(plane *p, const float complex *q,
                           const float complex *z, size_t count, size_t most) {
  size_t n = p->n;
  gsl_matrix_complex *a = gsl_matrix_complex_alloc(count, count);
  gsl_matrix_complex *v = gsl_matrix_complex_alloc(count, count);
  gsl_vector *value = gsl_vector_alloc(count);
  gsl_eigen_hermv_workspace *work = gsl_eigen_hermv_alloc(count);
  for (size_t i = 0; i < count; i++)
    for (size_t j = 0; j <= i; j++) {
      double complex c = vectors_dot(q + i * n, z + j * n, n);
      gsl_matrix_complex_set(a, i, j, gsl_complex_rect(creal(c), cimag(c)));
      gsl_matrix_complex_set(a, j, i, gsl_complex_rect(creal(c), -cimag(c)));
    }
  gsl_eigen_hermv(a, value, v, work);
  gsl_eigen_hermv_sort(value, v, GSL_EIGEN_SORT_VAL_DESC);
  for (size_t k = 0; k < most; k++)
    for (size_t i = 0; i < count; i++) {
      gsl_complex c = gsl_matrix_complex_get(v, i, k);
      float complex by = (float)GSL_REAL(c) + (float)GSL_IMAG(c) * I;
      for (size_t s = 0; s < n; s++) p->vectors[k * n + s] += by * q[i * n + s];
    }
  double strongest = gsl_vector_get(value, 0);
  while (p->available < most &&
         gsl_vector_get(value, p->available) > 1e-6 * strongest)
    p->available++;
  gsl_eigen_hermv_free(work);
  gsl_vector_free(value);
  gsl_matrix_complex_free(v);
  gsl_matrix_complex_free(a);
}

/* Find the strongest eigenvectors of the Gram matrix in the span of the fourth
   power of the matrix times random vectors (Halko, Martinsson, Tropp, SIAM
   Review 53, 2011). The random vectors are the same in every run. */
static void plane_solve(plane *p) {
  size_t n = p->n, most = n < PLANE_MOST ? n : PLANE_MOST;
  size_t count = n < PLANE_MOST + SPARE ? n : PLANE_MOST + SPARE;
  gram g = {p, eda_alloc(n * n, sizeof *g.matrix)};
  float complex *q = eda_alloc(count * n, sizeof *q);
  float complex *z = eda_alloc(count * n, sizeof *z);
  const opc_context *context = p->base.context;
  opc_parallel(context, (n + ROWS - 1) / ROWS, gram_rows, &g);
  uint32_t state = 1;
  for (size_t i = 0; i < count * n; i++) {
    state = state * 1664525u + 1013904223u;
    q[i] = (float)(state >> 8) / (1 << 23) - 1;
  }
  block forth = {&g, q, z}, back = {&g, z, q};
  for (int power = 0; power < 2; power++) {
    opc_parallel(context, count, gram_multiply, &forth);
    vectors_orthonormalise(z, count, n);
    opc_parallel(context, count, gram_multiply, &back);
    vectors_orthonormalise(q, count, n);
  }
  opc_parallel(context, count, gram_multiply, &forth);
  plane_mix_span(p, q, z, count, most);
  free(g.matrix);
  free(q);
  free(z);
}

static size_t nodes_of(const plane *p) {
  return (size_t)p->side * (size_t)p->side;
}

/* The vectors of all kernels, [part][kernel]. */
typedef struct mixture {
  plane *p;
  float *re, *im;
} mixture;

/* Add (re + i im) v[k] to a[k], k < n. The loop is over the kernels, so that
   the compiler vectorises it without changing the order of any sum. */
static void mix_add(float *restrict a_re, float *restrict a_im, float re,
                    float im, const float *restrict v_re,
                    const float *restrict v_im, size_t n) {
  for (size_t k = 0; k < n; k++) {
    a_re[k] += re * v_re[k] - im * v_im[k];
    a_im[k] += re * v_im[k] + im * v_re[k];
  }
}

/* Compute a row of nodes of all kernel tables. */
static void mix_row(void *data, size_t j) {
  const mixture *m = data;
  const plane *p = m->p;
  size_t nodes = nodes_of(p), n = p->available, side = (size_t)p->side;
  for (size_t node = j * side; node < (j + 1) * side; node++) {
    const float complex *a = p->shifted + node * p->n;
    float re[PLANE_MOST] = {0}, im[PLANE_MOST] = {0};
    for (size_t s = 0; s < p->n; s++)
      mix_add(re, im, crealf(a[s]), cimagf(a[s]), m->re + s * n, m->im + s * n,
              n);
    for (size_t k = 0; k < n; k++)
      p->table[k * nodes + node] = re[k] + im[k] * I;
  }
}

/* Compute the tables of all kernels. */
static void plane_mix(plane *p, const opc_context *context) {
  size_t n = p->available;
  mixture m = {p, eda_alloc(n * p->n, sizeof *m.re),
               eda_alloc(n * p->n, sizeof *m.im)};
  for (size_t k = 0; k < n; k++)
    for (size_t s = 0; s < p->n; s++) {
      m.re[s * n + k] = crealf(p->vectors[k * p->n + s]);
      m.im[s * n + k] = cimagf(p->vectors[k * p->n + s]);
    }
  opc_parallel(context, (size_t)p->side, mix_row, &m);
  free(m.re);
  free(m.im);
}

/* Fit D at each shift by least squares over pairs of nodes, so that S S D
   approximates the truncated kernels. */
static void plane_fit_shifts(plane *p) {
  double above[SHIFTS + 1] = {0}, below[SHIFTS + 1] = {0};
  size_t nodes = nodes_of(p), side = (size_t)p->side;
  for (size_t a = 0; a < nodes; a++) {
    if (a % side % THIN || a / side % THIN || p->s_table[a] == 0) continue;
    for (size_t b = 0; b <= a; b++) {
      if (b % side % THIN || b / side % THIN || p->s_table[b] == 0) continue;
      double dx = (double)(a % side) - (double)(b % side);
      size_t rows = a / side - b / side; /* b <= a */
      double dy = (double)rows;
      int bin = (int)(hypot(dx, dy) * p->step * SHIFTS / 2 + 0.5);
      if (bin > SHIFTS) continue;
      double residual = 0, product = (double)p->s_table[a] * p->s_table[b];
      for (size_t k = p->base.count; k < p->available; k++)
        residual +=
            crealf(p->table[k * nodes + a] * conjf(p->table[k * nodes + b]));
      above[bin] += residual * product;
      below[bin] += product * product;
    }
  }
  for (int i = 0; i < SHIFTS + 2; i++)
    p->d_table[i] =
        i <= SHIFTS && below[i] > 0 ? (float)(above[i] / below[i]) : 0;
  p->d_table[0] = 1;
}

static void plane_keep(kernels *base, size_t n) {
  plane *p = (plane *)base;
  size_t nodes = nodes_of(p);
  base->count = n < p->available ? n : p->available;
  base->all = base->count == p->available;
  for (size_t i = 0; i < nodes; i++) {
    float residual = p->diagonal[i];
    for (size_t k = 0; k < base->count; k++) {
      float complex a = p->table[k * nodes + i];
      residual -= crealf(a * conjf(a));
    }
    p->s_table[i] = sqrtf(fmaxf(residual, 0));
  }
  plane_fit_shifts(p);
}

/* Interpolate a kernel table bilinearly. */
static void plane_transfer(const void *self, size_t s, const double *fx,
                           double fy, size_t n, float *out) {
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

static void plane_filter(const void *self, size_t residual, const double *fx,
                         double fy, size_t n, float *out) {
  const plane *p = self;
  (void)residual; /* only one residual term exists */
  for (size_t i = 0; i < n; i++) {
    double shift = sqrt(fx[i] * fx[i] + fy * fy) / p->base.cutoff;
    double place = shift * SHIFTS / 2;
    int k = place < SHIFTS ? (int)place : SHIFTS;
    const float *d = p->d_table + k;
    out[i] = d[0] + (float)(place - k) * (d[1] - d[0]);
  }
}

/* ---- entry ---- */

static void plane_free(kernels *base) {
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

/* Find the spacing that divides a source into about POINTS cells, or half as
   many for polarised light. Return 0 if the source is too thin. */
static int plane_sample_source(plane *p) {
  double r = optics_source_radius(p->o);
  double most = p->parts > 1 ? POINTS / 2 : POINTS;
  p->spacing = 2 * r / 12;
  for (int i = 0; i < 12; i++) {
    free(p->points);
    p->points = optics_source_points(p->o, p->spacing, &p->n);
    if (!p->points || p->n > most * 3 / 4 || p->o->source == OPTICS_LIST) break;
    p->spacing *= sqrt((double)p->n / most);
  }
  if (p->o->source == OPTICS_LIST) p->spacing = 0;
  if (!p->points) return 0;
  vector_normalise(p->o, p->points, p->n);
  p->n *= p->parts;
  return 1;
}

kernels *plane_new(const opc_context *context, const optics *o, double defocus,
                   opc_error *error) {
  gsl_set_error_handler_off(); /* the default handler aborts */
  plane *p = eda_alloc(1, sizeof *p);
  p->base = (kernels){.context = context,
                      .cutoff = o->cutoff,
                      .radius = 1 + optics_source_radius(o),
                      .keep = plane_keep,
                      .residuals = 1,
                      .transfer = plane_transfer,
                      .filter = plane_filter,
                      .free = plane_free};
  p->o = o;
  p->parts = vector_parts(o);
  p->defocus = defocus;
  if (!plane_sample_source(p)) {
    opc_fail(error, OPC_FAILED, NULL,
             "the source is too thin for sampling by points");
    plane_free(&p->base);
    return NULL;
  }
  /* Add two nodes of margin, for the interpolation at the border. */
  p->side = CELLS + 5;
  p->step = 2 * p->base.radius / CELLS;
  p->low = -p->base.radius - 2 * p->step;
  size_t nodes = nodes_of(p), most = p->n < PLANE_MOST ? p->n : PLANE_MOST;
  p->diagonal = eda_alloc(nodes, sizeof *p->diagonal);
  p->s_table = eda_alloc(nodes, sizeof *p->s_table);
  p->shifted = eda_alloc(nodes * p->n, sizeof *p->shifted);
  p->vectors = eda_alloc(most * p->n, sizeof *p->vectors);
  p->table = eda_alloc(most * nodes, sizeof *p->table);
  p->weights = eda_alloc(most, sizeof *p->weights);
  for (size_t k = 0; k < most; k++) p->weights[k] = 1;
  p->base.weight = p->weights;
  opc_parallel(context, (size_t)p->side, fill_node_row, p);
  plane_solve(p);
  plane_mix(p, context);
  free(p->shifted);
  p->shifted = NULL;
  return &p->base;
}
