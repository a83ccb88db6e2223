/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements kernels of rotationally symmetric transmission cross coefficients
   T, which depend only on |f1|, |f2| and the angle between f1 and f2. The
   eigenfunctions R(|f|) exp(i m angle) are computed for each order m from a
   small matrix over the radius, and apply to frames of every size.

   The pupil shifted by f, as a function on a circle of radius q in the source,
   depends on the angle between f and the source point. With the Fourier
   coefficients g_m(r, q) of this function, T_m(r1, r2) is the integral of
   g_m(r1, q) g_m(r2, q)* q dq over the source. In focus g_m has a closed form,
   because the pupil is an arc. Polarised light has one such integral per part
   (vector.h); each part is an even or odd function of the angle. */
#include "radial.h"

#include <eda/memory.h>
#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Model of the spectrum of masks: (1 + (f / corner)^2)^(-steepness / 2). Errors
   of kernels count less where the spectrum is weak. */
static const double corner = 0.5, steepness = 1;

/* ---- work: nodes ---- */

/* Compute n Gauss-Legendre nodes and weights for an interval. */
static void gauss_legendre(double from, double to, int n, double *node,
                           double *weight) {
  gsl_integration_glfixed_table *t =
      gsl_integration_glfixed_table_alloc((size_t)n);
  for (int i = 0; i < n; i++)
    gsl_integration_glfixed_point(from, to, (size_t)i, &node[i], &weight[i], t);
  gsl_integration_glfixed_table_free(t);
}

static double spectrum_falling(double r) {
  return pow(1 + r * r / (corner * corner), -0.5 * steepness);
}

/* Return the parameter t of radius r in a panel, with r = from + (to - from) (3
   t^2 - 2 t^3). Panels are bounded by the radii where disks begin to touch.
   There R behaves like a root of the distance; as a function of t, R is nearly
   a polynomial. */
static double panel_place(const panel *p, double r) {
  double y = (r - p->from) / (p->to - p->from);
  return 0.5 - sin(asin(fmin(fmax(1 - 2 * y, -1), 1)) / 3);
}

static void place_nodes(radial *r) {
  double breaks[PANELS + 1] = {0, 1 - r->sigma, 1 - r->sigma_in,
                               1 + r->sigma_in, 1 + r->sigma};
  for (int p = 0; p < PANELS; p++) {
    panel *q = &r->panels[p];
    *q = (panel){breaks[p], breaks[p + 1], r->n, p ? r->other : FIRST};
    if (!(q->to > q->from + 1e-9)) q->n = 0;
    double *t = r->place + r->n, *w = r->weight + r->n;
    if (q->n) gauss_legendre(0, 1, q->n, t, w);
    for (int i = 0; i < q->n; i++) {
      r->node[r->n + i] =
          q->from + (q->to - q->from) * t[i] * t[i] * (3 - 2 * t[i]);
      r->bary[r->n + i] = (i % 2 ? -1 : 1) * sqrt(w[i] * t[i] * (1 - t[i]));
      w[i] *= (q->to - q->from) * 6 * t[i] * (1 - t[i]);
    }
    r->n += q->n;
  }
  for (int i = 0; i < r->n; i++)
    r->root[i] = sqrt(r->weight[i] * r->node[i]) * spectrum_falling(r->node[i]);
}

/* Compute the nodes of the source's radius. Breaks are the radii where the
   border of a shifted pupil enters the source. At a break, g_m behaves like a
   square root; nodes placed in the square of a variable integrate such
   functions accurately. */
static void place_rings(radial *r) {
  double breaks[NODES + 2], unit[RINGS], weight[RINGS];
  int n = 0;
  breaks[n++] = r->sigma_in;
  breaks[n++] = r->sigma;
  for (int i = 0; i < r->n; i++) {
    double b = fabs(1 - r->node[i]);
    if (b > r->sigma_in && b < r->sigma) breaks[n++] = b;
  }
  qsort(breaks, (size_t)n, sizeof *breaks, eda_doubles_rise);
  gauss_legendre(0, 1, RINGS, unit, weight);
  for (int b = 0; b + 1 < n; b++) {
    double width = breaks[b + 1] - breaks[b];
    if (width < 1e-9) continue;
    for (int k = 0; k < RINGS; k++, r->rings++) {
      double q = breaks[b] + width * unit[k] * unit[k];
      r->ring[r->rings] = q;
      r->ring_weight[r->rings] = 2 * width * unit[k] * weight[k] * q;
    }
  }
  gauss_legendre(0, 1, ARC, r->arc, r->arc_weight);
}

/* Compute the weights that interpolate a table from the values at the nodes of
   a panel (barycentric Lagrange, Berrut and Trefethen 2004). */
static void place_table(radial *r) {
  for (int i = 0; i < TABLE + 2; i++) {
    double x = fmin(r->base.radius * i / TABLE, r->base.radius), sum = 0;
    double *blend = r->blend + (size_t)i * OTHER;
    int p = 0;
    while (p + 1 < PANELS && (x > r->panels[p].to || !r->panels[p].n)) p++;
    while (!r->panels[p].n) p--;
    const panel *q = &r->panels[p];
    r->begin[i] = q->first;
    double t = panel_place(q, x);
    for (int k = 0; k < q->n; k++) {
      double d = t - r->place[q->first + k];
      blend[k] = r->bary[q->first + k] / (fabs(d) < 1e-12 ? 1e-12 : d);
      sum += blend[k];
    }
    for (int k = 0; k < q->n; k++) blend[k] /= sum;
  }
}

/* ---- work: expansion ---- */

/* Compute g_m of a pupil without phase in all orders: the shifted pupil is 1 on
   the arc from `begin` to pi. */
static void expand_arc(double begin, double *g, size_t stride) {
  double c = 2 * cos(begin), before = 0, now = sin(begin);
  g[0] = 1 - begin / M_PI;
  for (int m = 1; m < ORDERS; m++) {
    g[(size_t)m * stride] = -now / (M_PI * m);
    double next = c * now - before;
    before = now;
    now = next;
  }
}

/* Add g_m of a pupil with a phase, or of a part of polarised light, for node
   radius a and source radius q. Return the mean square of the factor of the
   part. */
static double expand_phase(const radial *r, double a, double q, double begin,
                           double *re, double *im, size_t stride) {
  int odd = !r->scalar && vector_is_odd(r->o, r->part);
  double square = 0;
  for (int k = 0; k < ARC; k++) {
    double angle = begin + (M_PI - begin) * r->arc[k], p[2];
    double w = r->arc_weight[k] * (1 - begin / M_PI), c = cos(angle);
    double u = sqrt(fmax(0, a * a + q * q + 2 * a * q * c));
    double factor[VECTOR_PARTS], s = sin(angle);
    optics_pupil(r->o, r->defocus, fmin(u, 1), 0, &p[0], &p[1]);
    vector_factors(r->o, (const double[]){q, 0}, q + a * c, a * s, factor);
    square += w * pow(factor[r->part], 2);
    w *= factor[r->part];
    double before = odd ? -s : c, now = odd ? 0 : 1;
    for (int m = 0; m < ORDERS; m++) {
      re[(size_t)m * stride] += w * p[0] * now;
      if (im) im[(size_t)m * stride] += w * p[1] * now;
      double next = 2 * c * now - before;
      before = now;
      now = next;
    }
  }
  return square;
}

static void expand_node(void *data, size_t i) {
  radial *r = data;
  double a = r->node[i];
  size_t rings = (size_t)r->rings, stride = (size_t)r->n * rings;
  for (size_t k = 0; k < rings; k++) {
    double q = r->ring[k], c = (1 - a * a - q * q) / (2 * a * q);
    size_t at = i * rings + k;
    if (c <= -1) continue; /* outside the pupil */
    double begin = c < 1 ? acos(c) : 0;
    if (r->real && r->scalar) {
      expand_arc(begin, r->g[0] + at, stride);
      continue;
    }
    double *im = r->real ? NULL : r->g[1] + at;
    double square = expand_phase(r, a, q, begin, r->g[0] + at, im, stride);
    if (!r->scalar) r->at_node[i] += 2 / r->whole * r->ring_weight[k] * square;
  }
}

/* Add the contribution of one part to T_m at all pairs of nodes. */
static void radial_multiply(void *data, size_t m) {
  radial *r = data;
  size_t n = (size_t)r->n, rings = (size_t)r->rings;
  double square = 0;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j <= i; j++) {
      size_t a = (m * n + i) * rings, b = (m * n + j) * rings;
      double re = 0, im = 0;
      for (size_t k = 0; k < rings; k++)
        re += r->ring_weight[k] * r->g[0][a + k] * r->g[0][b + k];
      for (size_t k = 0; k < rings && !r->real; k++) {
        double w = r->ring_weight[k];
        re += w * r->g[1][a + k] * r->g[1][b + k];
        im += w * (r->g[1][a + k] * r->g[0][b + k] -
                   r->g[0][a + k] * r->g[1][b + k]);
      }
      size_t ij = (m * n + i) * n + j, ji = (m * n + j) * n + i;
      re = r->t[0][ij] + 2 / r->whole * re;
      im = (r->real ? 0 : r->t[1][ij]) + 2 / r->whole * im;
      r->t[0][ij] = r->t[0][ji] = re;
      if (!r->real) {
        r->t[1][ij] = im;
        r->t[1][ji] = -im;
      }
      double scaled = hypot(re, im) * r->root[i] * r->root[j];
      square += (i == j ? 1 : 2) * scaled * scaled;
    }
  r->bound[m] = sqrt(square);
}

/* Workspace for the eigenvectors of one order. */
typedef struct solver {
  gsl_vector *value, *below; /* diagonal and subdiagonal */
  gsl_matrix *a, *v;
  gsl_eigen_symmv_workspace *work;
  gsl_matrix_complex *c, *u; /* for a complex matrix */
  gsl_vector_complex *tau;
  double *turned[2]; /* u transposed: re, im */
} solver;

static void solver_clear(solver *s) {
  gsl_vector_free(s->value);
  gsl_vector_free(s->below);
  gsl_matrix_free(s->a);
  gsl_matrix_free(s->v);
  gsl_eigen_symmv_free(s->work);
  gsl_matrix_complex_free(s->c);
  gsl_matrix_complex_free(s->u);
  gsl_vector_complex_free(s->tau);
  free(s->turned[0]);
  free(s->turned[1]);
}

static void solver_init(solver *s, size_t n, int real) {
  *s = (solver){.value = gsl_vector_alloc(n),
                .a = gsl_matrix_calloc(n, n),
                .v = gsl_matrix_alloc(n, n),
                .work = gsl_eigen_symmv_alloc(n)};
  if (real) return;
  s->below = gsl_vector_alloc(n - 1);
  s->c = gsl_matrix_complex_alloc(n, n);
  s->u = gsl_matrix_complex_alloc(n, n);
  s->tau = gsl_vector_complex_alloc(n - 1);
  for (int part = 0; part < 2; part++)
    s->turned[part] = eda_alloc(n * n, sizeof *s->turned[part]);
}

EDA_WIDE static void add_times(double by, const double *restrict x, size_t n,
                               double *restrict to) {
  for (size_t i = 0; i < n; i++) to[i] += by * x[i];
}

/* Transform the complex matrix of order m to a real tridiagonal matrix s->a in
   the basis s->turned. The corresponding GSL function takes three times as
   long. */
static void solver_make_real(const radial *r, size_t m, solver *s) {
  size_t n = (size_t)r->n;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) {
      size_t at = (m * n + i) * n + j;
      double by = r->root[i] * r->root[j];
      gsl_matrix_complex_set(
          s->c, i, j, gsl_complex_rect(by * r->t[0][at], by * r->t[1][at]));
    }
  gsl_linalg_hermtd_decomp(s->c, s->tau);
  gsl_linalg_hermtd_unpack(s->c, s->tau, s->u, s->value, s->below);
  for (size_t i = 0; i < n; i++) {
    gsl_matrix_set(s->a, i, i, gsl_vector_get(s->value, i));
    if (i) {
      gsl_matrix_set(s->a, i, i - 1, gsl_vector_get(s->below, i - 1));
      gsl_matrix_set(s->a, i - 1, i, gsl_vector_get(s->below, i - 1));
    }
    for (size_t j = 0; j < n; j++) {
      gsl_complex c = gsl_matrix_complex_get(s->u, i, j);
      s->turned[0][j * n + i] = GSL_REAL(c);
      s->turned[1][j * n + i] = GSL_IMAG(c);
    }
  }
}

/* Store eigenvector k of order m at the nodes. */
static void solver_store_vector(radial *r, size_t m, size_t k,
                                const solver *s) {
  size_t n = (size_t)r->n;
  for (int part = 0; part < (r->real ? 1 : 2); part++) {
    double *f = r->functions[part] + (m * n + k) * n;
    memset(f, 0, n * sizeof *f);
    for (size_t i = 0; i < n; i++) {
      double v = gsl_matrix_get(s->v, i, k);
      if (r->real)
        f[i] = v;
      else
        add_times(v, s->turned[part] + i * n, n, f);
    }
    for (size_t i = 0; i < n; i++) f[i] /= r->root[i];
  }
}

/* Compute the eigenvectors of root_i T_m(r_i, r_j) root_j for one order m. The
   elements of an eigenvector are root_i R(r_i). */
static void radial_solve_order(void *data, size_t task) {
  radial *r = data;
  size_t n = (size_t)r->n, m = task + (size_t)r->solved;
  solver s;
  solver_init(&s, n, r->real);
  for (size_t i = 0; i < n && r->real; i++)
    for (size_t j = 0; j < n; j++)
      gsl_matrix_set(s.a, i, j,
                     r->t[0][(m * n + i) * n + j] * r->root[i] * r->root[j]);
  if (!r->real) solver_make_real(r, m, &s);
  gsl_eigen_symmv(s.a, s.value, s.v, s.work);
  for (size_t k = 0; k < n; k++) {
    solver_store_vector(r, m, k, &s);
    r->sorted[m * n + k] = (eigen){gsl_vector_get(s.value, k), (int)m, (int)k};
  }
  solver_clear(&s);
}

static int by_value(const void *a, const void *b) {
  const eigen *x = a, *y = b;
  if (x->value != y->value) return x->value < y->value ? 1 : -1;
  return x->order != y->order ? x->order - y->order : x->index - y->index;
}

/* Return the number of eigenfunctions in the first n kernels. *count receives
   the number of kernels, which is less than n if no more kernels exist. */
static size_t count_eigenfunctions(const radial *r, size_t n, size_t *count) {
  int open = 0; /* 1: the last kernel of order 0 has one function and can take a
                   second one */
  size_t kept = 0;
  for (*count = 0; kept < r->n_sorted; kept++) {
    int order = r->sorted[kept].order;
    if (r->real && !order && open) {
      open = 0;
      continue;
    }
    size_t more = r->real || !order ? 1 : 2;
    if (*count + more > n) break;
    *count += more;
    if (!order) open = 1;
  }
  return kept;
}

size_t radial_solve(radial *r, size_t n) {
  enum { BATCH = 4 };
  for (;;) {
    double most = 0;
    for (int m = r->solved; m < ORDERS; m++) most = fmax(most, r->bound[m]);
    size_t count, kept = count_eigenfunctions(r, n, &count);
    if (r->solved == ORDERS) return kept;
    if (kept < r->n_sorted && r->sorted[kept].value > most) return kept;
    opc_parallel(r->base.context, BATCH, radial_solve_order, r);
    r->solved += BATCH;
    size_t all = (size_t)r->solved * (size_t)r->n;
    qsort(r->sorted, all, sizeof *r->sorted, by_value);
    r->n_sorted = 0;
    while (r->n_sorted < all &&
           r->sorted[r->n_sorted].value > 1e-7 * r->sorted[0].value)
      r->n_sorted++;
  }
}

/* ---- entry ---- */

static double radial_cross_at(const kernels *base, double x1, double y1,
                              double x2, double y2) {
  double angle = atan2(x1 * y2 - x2 * y1, x1 * x2 + y1 * y2);
  return radial_cross((const radial *)base, hypot(x1, y1), hypot(x2, y2),
                      angle);
}

static void array_drop(double **array) {
  free(*array);
  *array = NULL;
}

/* Implement kernels.settle. */
static void radial_settle(kernels *base) {
  radial *r = (radial *)base;
  for (int part = 0; part < 2; part++) {
    array_drop(&r->g[part]);
    array_drop(&r->t[part]);
    array_drop(&r->functions[part]);
  }
  array_drop(&r->pairs);
  array_drop(&r->blend);
  free(r->sorted);
  r->sorted = NULL;
  r->o = NULL;
  base->context = NULL;
}

static void radial_free(kernels *base) {
  radial *r = (radial *)base;
  radial_drop(r);
  radial_settle(base);
  free(r->kernels);
  free(r->weights);
  free(r);
}

static void radial_allocate(radial *r) {
  size_t n = (size_t)r->n, all = ORDERS * n, rings = (size_t)r->rings;
  for (int part = 0; part < (r->real ? 1 : 2); part++) {
    r->g[part] = eda_alloc(all * rings, sizeof *r->g[part]);
    r->t[part] = eda_alloc(all * n, sizeof *r->t[part]);
    r->functions[part] = eda_alloc(all * n, sizeof *r->functions[part]);
  }
  size_t half = (n + 1) / 2;
  if (r->real && r->scalar)
    r->pairs = eda_alloc(half * (half + 1) / 2 * ANGLES, sizeof *r->pairs);
  r->blend = eda_alloc((size_t)(TABLE + 2) * OTHER, sizeof *r->blend);
  r->sorted = eda_alloc(all, sizeof *r->sorted);
  r->kernels = eda_alloc(2 * all, sizeof *r->kernels);
  r->weights = eda_alloc(2 * all, sizeof *r->weights);
}

/* Compute T(f, f) of scalar light at the nodes and in the table. For polarised
   light, interpolate the table from the values at the nodes. */
static void radial_find_diagonal(radial *r) {
  for (int i = 0; i < r->n && r->scalar; i++)
    r->at_node[i] = radial_cross(r, r->node[i], r->node[i], 0);
  for (int i = 0; i < TABLE + 2; i++) {
    double x = fmin(r->base.radius * i / TABLE, r->base.radius), sum = 0;
    const double *blend = r->blend + (size_t)i * OTHER;
    for (int k = 0; k < OTHER && r->begin[i] + k < r->n; k++)
      sum += blend[k] * r->at_node[r->begin[i] + k];
    r->diagonal[i] = r->scalar ? radial_cross(r, x, x, 0) : sum;
  }
}

/* Return T(0, 0) before normalisation: the area of the source or, for polarised
   light, the sum of the contributions of rings to the clear field. */
static double radial_find_whole(const radial *r) {
  double whole = r->sigma * r->sigma - r->sigma_in * r->sigma_in, sum = 0;
  for (int k = 0; k < r->rings; k++)
    sum += 2 * r->ring_weight[k] *
           vector_clear(r->o, (const double[]){r->ring[k], 0});
  return r->scalar ? whole : sum;
}

static void radial_expand(radial *r) {
  size_t n = (size_t)r->n, all = ORDERS * n * (size_t)r->rings;
  for (r->part = 0; r->part < vector_parts(r->o); r->part++) {
    for (int part = 0; r->part && part < (r->real ? 1 : 2); part++)
      memset(r->g[part], 0, all * sizeof *r->g[part]);
    opc_parallel(r->base.context, n, expand_node, r);
    opc_parallel(r->base.context, ORDERS, radial_multiply, r);
  }
}

kernels *radial_new(const opc_context *context, const optics *o, double defocus,
                    int real, double error) {
  gsl_set_error_handler_off(); /* the default handler aborts */
  radial *r = eda_alloc(1, sizeof *r);
  r->base = (kernels){.context = context,
                      .cutoff = o->cutoff,
                      .radius = 1 + o->sigma,
                      .keep = radial_keep,
                      .settle = radial_settle,
                      .residuals = 2,
                      .transfer = radial_transfer,
                      .filter = radial_filter,
                      .cross = real && o->polarisation == OPTICS_SCALAR
                                   ? radial_cross_at
                                   : NULL,
                      .mirror = radial_mirror,
                      .free = radial_free};
  r->o = o;
  r->defocus = defocus;
  r->real = real;
  r->scalar = o->polarisation == OPTICS_SCALAR;
  /* The number of nodes was measured: with fewer nodes, errors are larger for
     any number of kernels. With 40 nodes, 1e-4 is reached, but the error is
     2e-4 if 6e-5 is requested. */
  r->other = error < 1e-4 && real ? OTHER : error < 1e-3 ? 40 : 24;
  r->sigma = o->sigma;
  r->sigma_in = o->source == OPTICS_ANNULAR ? o->sigma_in : 0;
  place_nodes(r);
  place_rings(r);
  radial_allocate(r);
  place_table(r);
  r->whole = radial_find_whole(r);
  radial_expand(r);
  radial_find_diagonal(r);
  if (r->pairs)
    opc_parallel(context, (size_t)(r->n + 1) / 2, radial_evaluate_pairs, r);
  return &r->base;
}
