/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernels of a rotationally symmetric T: it depends on |f1|, |f2| and the angle
   between them only, so that its eigenfunctions are R(|f|) exp(i m angle), found
   for each order m from a small matrix over the radius. They serve fields of
   every size.

   The pupil seen from a source point at the radius q is a function of the angle
   between f and that point; with its Fourier coefficients g_m(r, q),
   T_m(r1, r2) = integral of g_m(r1, q) g_m(r2, q)* q dq over the source. In
   focus they are closed forms, as the pupil is an arc.

   What the kernels that are left out would add is a slowly varying offset. It
   is put back by one incoherent system: the rest of T is taken as
   S(f1) S(f2) D(|f1 - f2|), exact for f1 = f2, and D its mean otherwise. */
#include "disks.h"
#include "kernels.h"

#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

enum {
  PANELS = 4,
  FIRST = 8,        /* nodes where the whole source passes the pupil */
  OTHER = 56,       /* nodes of each panel beyond, at most */
  NODES = FIRST + (PANELS - 1) * OTHER,
  RINGS = 4,        /* nodes of the source's radius between two breaks */
  SOURCE = (NODES + 1) * RINGS,
  ARC = 48,         /* nodes of an arc of a pupil that is not real */
  ANGLES = 48,      /* of D's mean over half a turn */
  ORDERS = 32,      /* angular orders */
  TABLE = 1024,     /* intervals of a radial function's table */
  SHIFTS = 64,      /* intervals of D's table, over shifts of 0 to 2 */
  CHUNK = 64
};

/* The spectrum of a mask is taken to be like (1 + (f / corner)^2)^(-steepness / 2):
   what kernels lose where it is weak counts less. */
static const double corner = 0.5, steepness = 1;

typedef struct panel {
  double from, to;
  int first, n;     /* nodes */
} panel;

typedef struct eigen {
  double value;
  int order, index;
} eigen;

/* A coherent system. For a real mask and pupil, the orders m and -m of one
   radial function (both have the same square), or two radial functions of order
   0 in real and imaginary part; else one function of one order. */
typedef struct coherent {
  int order;
  float *re, *im;    /* TABLE + 2 values each; NULL: 0 */
} coherent;

typedef struct radial {
  kernels base;
  const optics *o;
  double defocus;
  double sigma, sigma_in;
  int real;             /* mask and pupil: systems come in pairs */
  panel panels[PANELS];
  int other;            /* nodes of the panels but the first */
  int n, rings;         /* nodes in all */
  double node[NODES], weight[NODES];   /* radius, in units of the cutoff */
  double place[NODES], bary[NODES];    /* t of panel_place; see place_table */
  double root[NODES];   /* eigenvectors are R times this */
  double ring[SOURCE], ring_weight[SOURCE];   /* of the source's radius */
  double arc[ARC], arc_weight[ARC];    /* on 0 .. 1 */
  double *g[2], *t[2];  /* re and, unless real, im of g_m: [order][node][ring]
                           and T_m: [order][node][node] */
  double *functions[2]; /* R: [order][index][node] */
  double *blend;        /* from values at nodes to a table: [TABLE + 2][OTHER] */
  int begin[TABLE + 2]; /* the first of these nodes */
  double diagonal[TABLE + 2];   /* T(f, f) */
  double *pairs;        /* T of every other node: [pair][angle]; if `real` */
  double bound[ORDERS]; /* no eigenvalue of the order is larger */
  int solved;           /* orders whose R are there */
  int failed;           /* atomic: out of memory */
  eigen *sorted;        /* of these orders, strongest first */
  size_t n_sorted;
  coherent *systems;
  double *weights;
  float s_table[TABLE + 2], d_table[SHIFTS + 2];
} radial;

/* ---- work: nodes ---- */

/* n Gauss-Legendre nodes between two places; 0 if there is no memory. */
static int place(double from, double to, int n, double *node, double *weight) {
  gsl_integration_glfixed_table *t = gsl_integration_glfixed_table_alloc((size_t)n);
  if (!t) return 0;
  for (int i = 0; i < n; i++)
    gsl_integration_glfixed_point(from, to, (size_t)i, &node[i], &weight[i], t);
  gsl_integration_glfixed_table_free(t);
  return 1;
}

static double falling(double r) {
  return pow(1 + r * r / (corner * corner), -0.5 * steepness);
}

/* Panels lie between the radii where disks begin to touch. There R goes like
   roots of the distance: as a function of t, r = from + (to - from) (3 t^2 - 2
   t^3), it is a polynomial nearly. */
static double panel_place(const panel *p, double r) {
  double y = (r - p->from) / (p->to - p->from);
  return 0.5 - sin(asin(fmin(fmax(1 - 2 * y, -1), 1)) / 3);
}

static int place_nodes(radial *r) {
  double breaks[PANELS + 1] = {0, 1 - r->sigma, 1 - r->sigma_in,
                               1 + r->sigma_in, 1 + r->sigma};
  for (int p = 0; p < PANELS; p++) {
    panel *q = &r->panels[p];
    *q = (panel){breaks[p], breaks[p + 1], r->n, p ? r->other : FIRST};
    if (!(q->to > q->from + 1e-9)) q->n = 0;
    double *t = r->place + r->n, *w = r->weight + r->n;
    if (q->n && !place(0, 1, q->n, t, w)) return 0;
    for (int i = 0; i < q->n; i++) {
      r->node[r->n + i] =
          q->from + (q->to - q->from) * t[i] * t[i] * (3 - 2 * t[i]);
      r->bary[r->n + i] = (i % 2 ? -1 : 1) * sqrt(w[i] * t[i] * (1 - t[i]));
      w[i] *= (q->to - q->from) * 6 * t[i] * (1 - t[i]);
    }
    r->n += q->n;
  }
  for (int i = 0; i < r->n; i++)
    r->root[i] = sqrt(r->weight[i] * r->node[i]) * falling(r->node[i]);
  return 1;
}

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The source's radius, between the places where the rim of the pupil begins to
   cut what a node sees: there g_m goes like a square root, which nodes in the
   square of a variable take as it is. */
static int place_rings(radial *r) {
  double breaks[NODES + 2], unit[RINGS], weight[RINGS];
  int n = 0;
  breaks[n++] = r->sigma_in;
  breaks[n++] = r->sigma;
  for (int i = 0; i < r->n; i++) {
    double b = fabs(1 - r->node[i]);
    if (b > r->sigma_in && b < r->sigma) breaks[n++] = b;
  }
  qsort(breaks, (size_t)n, sizeof *breaks, ascending);
  if (!place(0, 1, RINGS, unit, weight)) return 0;
  for (int b = 0; b + 1 < n; b++) {
    double width = breaks[b + 1] - breaks[b];
    if (width < 1e-9) continue;
    for (int k = 0; k < RINGS; k++, r->rings++) {
      double q = breaks[b] + width * unit[k] * unit[k];
      r->ring[r->rings] = q;
      r->ring_weight[r->rings] = 2 * width * unit[k] * weight[k] * q;
    }
  }
  return place(0, 1, ARC, r->arc, r->arc_weight);
}

/* The values of a table as polynomials through those at the nodes of their
   panel (barycentric Lagrange, Berrut and Trefethen 2004). */
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

/* g_m of the pupil that f at radius a sees from a source point at radius q, in
   all orders; the pupil is 1 on the arc from `begin` to pi. */
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

/* The same for a pupil with a phase. */
static void expand_phase(const radial *r, double a, double q, double begin,
                         double *re, double *im, size_t stride) {
  for (int k = 0; k < ARC; k++) {
    double angle = begin + (M_PI - begin) * r->arc[k], p[2];
    double w = r->arc_weight[k] * (1 - begin / M_PI), c = cos(angle);
    double u = sqrt(fmax(0, a * a + q * q + 2 * a * q * c));
    optics_pupil(r->o, r->defocus, fmin(u, 1), 0, &p[0], &p[1]);
    double before = c, now = 1;
    for (int m = 0; m < ORDERS; m++) {
      re[(size_t)m * stride] += w * p[0] * now;
      im[(size_t)m * stride] += w * p[1] * now;
      double next = 2 * c * now - before;
      before = now;
      now = next;
    }
  }
}

static void expand_node(void *data, size_t i) {
  const radial *r = data;
  double a = r->node[i];
  size_t rings = (size_t)r->rings, stride = (size_t)r->n * rings;
  for (size_t k = 0; k < rings; k++) {
    double q = r->ring[k], c = (1 - a * a - q * q) / (2 * a * q);
    size_t at = i * rings + k;
    if (c <= -1) continue;   /* nothing of the pupil */
    double begin = c < 1 ? acos(c) : 0;
    if (r->real)
      expand_arc(begin, r->g[0] + at, stride);
    else
      expand_phase(r, a, q, begin, r->g[0] + at, r->g[1] + at, stride);
  }
}

/* T_m at all pairs of nodes. */
static void multiply(void *data, size_t m) {
  radial *r = data;
  size_t n = (size_t)r->n, rings = (size_t)r->rings;
  double whole = r->sigma * r->sigma - r->sigma_in * r->sigma_in, square = 0;
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
      re *= 2 / whole;
      im *= 2 / whole;
      size_t ij = (m * n + i) * n + j, ji = (m * n + j) * n + i;
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

/* What the eigenvectors of an order are found with. */
typedef struct solver {
  gsl_vector *value, *below;    /* a diagonal and the one below it */
  gsl_matrix *a, *v;
  gsl_eigen_symmv_workspace *work;
  gsl_matrix_complex *c, *u;    /* if the matrix is complex */
  gsl_vector_complex *tau;
  double *turned[2];            /* u, transposed: re, im */
} solver;

static void end_solver(solver *s) {
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

static int begin_solver(solver *s, size_t n, int real) {
  *s = (solver){.value = gsl_vector_alloc(n), .a = gsl_matrix_calloc(n, n),
                .v = gsl_matrix_alloc(n, n), .work = gsl_eigen_symmv_alloc(n)};
  if (!s->value || !s->a || !s->v || !s->work) return 0;
  if (real) return 1;
  s->below = gsl_vector_alloc(n - 1);
  s->c = gsl_matrix_complex_alloc(n, n);
  s->u = gsl_matrix_complex_alloc(n, n);
  s->tau = gsl_vector_complex_alloc(n - 1);
  for (int part = 0; part < 2; part++)
    s->turned[part] = malloc(n * n * sizeof *s->turned[part]);
  return s->below && s->c && s->u && s->tau && s->turned[0] && s->turned[1];
}

WIDE static void add_times(double by, const double *restrict x, size_t n,
                           double *restrict to) {
  for (size_t i = 0; i < n; i++) to[i] += by * x[i];
}

/* The complex matrix of order m becomes a real one of two diagonals, s->a,
   seen from s->turned. (That by GSL's own way takes three times as long.) */
static void make_real(const radial *r, size_t m, solver *s) {
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

/* Eigenvector k of order m at the nodes. */
static void take_vector(radial *r, size_t m, size_t k, const solver *s) {
  size_t n = (size_t)r->n;
  for (int part = 0; part < (r->real ? 1 : 2); part++) {
    double *f = r->functions[part] + (m * n + k) * n;
    memset(f, 0, n * sizeof *f);
    for (size_t i = 0; i < n; i++) {
      double v = gsl_matrix_get(s->v, i, k);
      if (r->real) f[i] = v;
      else add_times(v, s->turned[part] + i * n, n, f);
    }
    for (size_t i = 0; i < n; i++) f[i] /= r->root[i];
  }
}

/* Order m: the eigenvectors of root_i T_m(r_i, r_j) root_j are root R. */
static void solve(void *data, size_t task) {
  radial *r = data;
  size_t n = (size_t)r->n, m = task + (size_t)r->solved;
  solver s;
  if (begin_solver(&s, n, r->real)) {
    for (size_t i = 0; i < n && r->real; i++)
      for (size_t j = 0; j < n; j++)
        gsl_matrix_set(s.a, i, j,
                       r->t[0][(m * n + i) * n + j] * r->root[i] * r->root[j]);
    if (!r->real) make_real(r, m, &s);
    gsl_eigen_symmv(s.a, s.value, s.v, s.work);
    for (size_t k = 0; k < n; k++) {
      take_vector(r, m, k, &s);
      r->sorted[m * n + k] = (eigen){gsl_vector_get(s.value, k), (int)m, (int)k};
    }
  } else {
    __atomic_store_n(&r->failed, 1, __ATOMIC_RELAXED);
  }
  end_solver(&s);
}

static int by_value(const void *a, const void *b) {
  const eigen *x = a, *y = b;
  if (x->value != y->value) return x->value < y->value ? 1 : -1;
  return x->order != y->order ? x->order - y->order : x->index - y->index;
}

/* How many eigenfunctions the first n systems hold; and how many systems there
   are, if fewer. */
static size_t cut(const radial *r, size_t n, size_t *count) {
  int open = 0;   /* a system of order 0 has room for another function */
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

/* Solve orders until no other one can be among the first n systems; the number
   of functions in these. */
static size_t solve_for(radial *r, size_t n) {
  enum { BATCH = 4 };
  const opc_host *host = r->base.host;
  for (;;) {
    double most = 0;
    for (int m = r->solved; m < ORDERS; m++) most = fmax(most, r->bound[m]);
    size_t count, kept = cut(r, n, &count);
    if (r->solved == ORDERS) return kept;
    if (kept < r->n_sorted && r->sorted[kept].value > most) return kept;
    host->parallel(host, BATCH, solve, r);
    if (r->failed) return 0;
    r->solved += BATCH;
    size_t all = (size_t)r->solved * (size_t)r->n;
    qsort(r->sorted, all, sizeof *r->sorted, by_value);
    r->n_sorted = 0;
    while (r->n_sorted < all &&
           r->sorted[r->n_sorted].value > 1e-7 * r->sorted[0].value)
      r->n_sorted++;
  }
}

/* ---- work: the kept kernels ---- */

static const double *function(const radial *r, const eigen *e, int part) {
  return r->functions[part] +
         ((size_t)e->order * (size_t)r->n + (size_t)e->index) * (size_t)r->n;
}

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

static void forget_systems(radial *r) {
  for (size_t s = 0; s < r->base.count; s++) {
    free(r->systems[s].re);
    free(r->systems[s].im);
  }
  r->base.count = 0;
}

/* Of a pair of nodes (every other node, counted from 0): a little further on for
   each pair, so that together they take all shifts evenly. */
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
      const double *f = function(r, e, part);
      term[e->order] -= e->value * f[i] * f[j];
    }
  }
  sum_orders(term, i / 2, j / 2, rest);
  for (int a = 0; r->real && a < ANGLES; a++)
    rest[a] += r->pairs[pair * ANGLES + (size_t)a];
}

/* T in closed form: in focus. */
static double cross_coefficient(const radial *r, double a, double b,
                                double angle) {
  double area = opc_common_area(r->sigma, a, b, angle);
  if (r->sigma_in > 0) area -= opc_common_area(r->sigma_in, a, b, angle);
  return area / (M_PI * (r->sigma * r->sigma - r->sigma_in * r->sigma_in));
}

static void evaluate_pairs(void *data, size_t i) {
  radial *r = data;
  double *to = r->pairs + i * (i + 1) / 2 * ANGLES;
  for (size_t j = 0; j <= i; j++)
    for (int a = 0; a < ANGLES; a++)
      *to++ = cross_coefficient(r, r->node[2 * i], r->node[2 * j],
                                angle_of((int)i, (int)j, a));
}

/* S and D of what is left when the first `kept` eigenfunctions are used. D is
   the best one in the sense of least squares for masks whose spectrum falls
   off. */
static void find_residual(radial *r, size_t kept) {
  double s[NODES], above[SHIFTS + 1] = {0}, below[SHIFTS + 1] = {0};
  for (int i = 0; i < r->n; i++) {
    double sum = cross_coefficient(r, r->node[i], r->node[i], 0);
    for (size_t k = 0; k < kept; k++)
      for (int part = 0; part < (r->real ? 1 : 2); part++) {
        double f = function(r, &r->sorted[k], part)[i];
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
    r->d_table[b] = b <= SHIFTS && below[b] > 0 ? (float)(above[b] / below[b]) : 0;
  r->d_table[0] = 1;
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

static float *new_table(const radial *r, const eigen *e, int part, double scale) {
  float *table = malloc((TABLE + 2) * sizeof *table);
  if (table) tabulate(r, function(r, e, part), scale, table);
  return table;
}

/* A system for order m or -m of an eigenfunction; 0 if there is no memory. */
static int add_system(radial *r, const eigen *e, int order) {
  size_t s = r->base.count++;
  coherent *c = &r->systems[s];
  int pair = r->real && order;
  *c = (coherent){.order = order};
  r->weights[s] = r->real && !order ? 1 : (pair ? 2 : 1) * e->value;
  c->re = new_table(r, e, 0, r->real && !order ? sqrt(e->value) : 1);
  if (!r->real) c->im = new_table(r, e, 1, 1);
  return c->re && (r->real || c->im);
}

static int keep(kernels *base, size_t n) {
  radial *r = (radial *)base;
  size_t kept = solve_for(r, n), open = SIZE_MAX;
  forget_systems(r);
  if (r->failed) return 0;
  for (size_t k = 0; k < kept; k++) {
    const eigen *e = &r->sorted[k];
    if (r->real && !e->order && open != SIZE_MAX) {
      float *table = new_table(r, e, 0, sqrt(e->value));
      r->systems[open].im = table;
      open = SIZE_MAX;
      if (!table) return 0;
      continue;
    }
    if (!e->order) open = base->count;
    if (!add_system(r, e, e->order)) return 0;
    if (!r->real && e->order && !add_system(r, e, -e->order)) return 0;
  }
  base->weight = r->weights;
  base->all = kept == r->n_sorted;
  find_residual(r, kept);
  return 1;
}

static double cross(const kernels *base, double x1, double y1, double x2,
                    double y2) {
  double angle = atan2(x1 * y2 - x2 * y1, x1 * x2 + y1 * y2);
  return cross_coefficient((const radial *)base, hypot(x1, y1), hypot(x2, y2),
                           angle);
}

/* ---- work: transfer functions ---- */

/* The values of a table at CHUNK places. */
WIDE static void look_up(const float *restrict table, const float *restrict place,
                         float *restrict out) {
  for (int i = 0; i < CHUNK; i++) {
    int k = (int)place[i];
    out[i] = table[k] + (place[i] - (float)k) * (table[k + 1] - table[k]);
  }
}

/* R(|f|) exp(i order angle) at CHUNK frequencies (fx[i], fy). */
WIDE static void chunk(const coherent *c, float scale, const double *restrict fx,
                       float fy, float *restrict out) {
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

static void transfer(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out) {
  const radial *r = self;
  const coherent rest = {.re = (float *)r->s_table};
  const coherent *c = s < r->base.count ? &r->systems[s] : &rest;
  float scale = (float)(TABLE / (r->base.radius * r->base.cutoff)), y = (float)fy;
  size_t i = 0;
  for (; i + CHUNK <= n; i += CHUNK) chunk(c, scale, fx + i, y, out + 2 * i);
  if (i == n) return;
  double last[CHUNK] = {0};
  float values[2 * CHUNK];
  memcpy(last, fx + i, (n - i) * sizeof *last);
  chunk(c, scale, last, y, values);
  memcpy(out + 2 * i, values, 2 * (n - i) * sizeof *values);
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
  for (int part = 0; part < 2; part++) {
    free(r->g[part]);
    free(r->t[part]);
    free(r->functions[part]);
  }
  free(r->pairs);
  free(r->blend);
  free(r->systems);
  free(r->weights);
  free(r->sorted);
  free(r);
}

static int allocate(radial *r) {
  size_t n = (size_t)r->n, all = ORDERS * n, rings = (size_t)r->rings;
  for (int part = 0; part < (r->real ? 1 : 2); part++) {
    r->g[part] = calloc(all * rings, sizeof *r->g[part]);
    r->t[part] = malloc(all * n * sizeof *r->t[part]);
    r->functions[part] = malloc(all * n * sizeof *r->functions[part]);
    if (!r->g[part] || !r->t[part] || !r->functions[part]) return 0;
  }
  size_t half = (n + 1) / 2;
  if (r->real) r->pairs = malloc(half * (half + 1) / 2 * ANGLES * sizeof *r->pairs);
  r->blend = calloc((size_t)(TABLE + 2) * OTHER, sizeof *r->blend);
  r->sorted = malloc(all * sizeof *r->sorted);
  r->systems = calloc(2 * all, sizeof *r->systems);
  r->weights = calloc(2 * all, sizeof *r->weights);
  return (r->pairs || !r->real) && r->blend && r->sorted && r->systems && r->weights;
}

kernels *radial_kernels(const opc_host *host, const optics *o, double defocus,
                        int real, double error) {
  gsl_set_error_handler_off();   /* its default aborts */
  radial *r = calloc(1, sizeof *r);
  if (!r) return NULL;
  r->base = (kernels){.host = host, .cutoff = o->cutoff, .radius = 1 + o->sigma,
                      .has_residual = 1, .keep = keep, .transfer = transfer,
                      .residual = residual, .cross = real ? cross : NULL,
                      .free = destroy};
  r->o = o;
  r->defocus = defocus;
  r->real = real;
  /* Measured: fewer leave larger errors, however many kernels are kept. */
  r->other = error < 2e-4 && real ? OTHER : error < 6e-4 ? 40 : 24;
  r->sigma = o->sigma;
  r->sigma_in = o->source == OPTICS_ANNULAR ? o->sigma_in : 0;
  if (!place_nodes(r) || !place_rings(r) || !allocate(r)) {
    destroy(&r->base);
    return NULL;
  }
  place_table(r);
  for (int i = 0; i < TABLE + 2; i++) {
    double x = fmin(r->base.radius * i / TABLE, r->base.radius);
    r->diagonal[i] = cross_coefficient(r, x, x, 0);
  }
  host->parallel(host, (size_t)r->n, expand_node, r);
  host->parallel(host, ORDERS, multiply, r);
  if (real) host->parallel(host, (size_t)(r->n + 1) / 2, evaluate_pairs, r);
  return &r->base;
}
