/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the residual of truncated kernels by two incoherent terms.

   With a1 and a2 the angles of f1 and f2, and h = f1 - f2, the residual of T is
   approximated by

   S(f1) S(f2) [cos a1 cos a2 D(h) + sin a1 sin a2 D(h turned by 90 degrees)].

   The approximation is exact for h = 0. D depends on length and direction of h:
   the residual is caused by source points at the borders of the shifted pupils
   and extends further along f than across f. If D depended on |h| only, an
   error of 1e-4 for long gratings would require five times the kernels. */
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "radial.h"

/* Weight of the smoothness of D in its fit. The smoothness determines values
   without samples from their neighbours. A weight of ten times this value
   changes errors by 3 %. */
static const double stiffness = 1e-4;

/* Smallest |h| in the weight 1 / |h| of pairs. Long lines have pairs along one
   direction only, so that small and large |h| have equal weight. */
static const double least_shift = 0.02;

/* ---- work: pairs ---- */

/* Return the square root of angle a, in units of 180 degrees, for the pair (2
   i, 2 j) of nodes. Angles differ between pairs, so that all pairs together
   sample all directions of h evenly. The square makes samples denser where h is
   small. */
static double pair_part(int i, int j, int a) {
  double turn = 0.6180339887 * i + 0.7548776662 * j;
  return (a + turn - floor(turn)) / ANGLES;
}

/* Return angle a between the two frequencies of a pair. */
static double pair_angle(int i, int j, int a) {
  double part = pair_part(i, j, a);
  return M_PI * part * part;
}

/* Return the angle of the first frequency of a pair. */
static double pair_first_angle(int i, int j, int a) {
  double turn = 0.5698402910 * (i + 31.7 * j) + 0.6180339887 * a;
  return M_PI * (turn - floor(turn));
}

/* Compute the sum over angular orders at all angles of a pair. */
static void pair_sum_orders(const double term[ORDERS], int i, int j,
                            double out[ANGLES]) {
  for (int a = 0; a < ANGLES; a++) {
    double c = cos(pair_angle(i, j, a)), before = 1, now = c, sum = term[0];
    for (int m = 1; m < ORDERS; m++) {
      sum += 2 * term[m] * now;
      double next = 2 * c * now - before;
      before = now;
      now = next;
    }
    out[a] = sum;
  }
}

/* Compute the residual of T without the first `kept` eigenfunctions at a pair
   of nodes, for all angles. If T is known in closed form, use that form instead
   of the truncated sum of orders. */
static void residual_of_pair(const radial *r, size_t kept, int i, int j,
                             double residual[ANGLES]) {
  size_t n = (size_t)r->n, at = (size_t)i * n + (size_t)j;
  size_t pair = (size_t)(i / 2) * (size_t)(i / 2 + 1) / 2 + (size_t)(j / 2);
  double term[ORDERS];
  for (size_t m = 0; m < ORDERS; m++)
    term[m] = r->pairs ? 0 : r->t[0][m * n * n + at];
  for (size_t k = 0; k < kept; k++) {
    const eigen *e = &r->sorted[k];
    for (int part = 0; part < (r->real ? 1 : 2); part++) {
      const double *f = radial_function(r, e, part);
      term[e->order] -= e->value * f[i] * f[j];
    }
  }
  pair_sum_orders(term, i / 2, j / 2, residual);
  for (int a = 0; r->pairs && a < ANGLES; a++)
    residual[a] += r->pairs[pair * ANGLES + (size_t)a];
}

void radial_evaluate_pairs(void *self, size_t i) {
  radial *r = self;
  double *to = r->pairs + i * (i + 1) / 2 * ANGLES;
  for (size_t j = 0; j <= i; j++)
    for (int a = 0; a < ANGLES; a++)
      *to++ = radial_cross(r, r->node[2 * i], r->node[2 * j],
                           pair_angle((int)i, (int)j, a));
}

/* ---- work: D ---- */

/* Position of a shift in the table of D, with bilinear weights: |h| = 2 (i /
   SHIFTS)^2, cos^2 of the direction = k / (TURNS - 1). */
typedef struct place {
  int at; /* first of four nodes: at, + 1, + TURNS, + TURNS + 1 */
  float weight[4];
} place;

static inline place place_of(float x, float y) {
  float square = x * x + y * y, root = sqrtf(sqrtf(square) / 2) * SHIFTS;
  float turn = square > 0 ? x * x / square * (TURNS - 1) : 0;
  int i = root < SHIFTS - 1 ? (int)root : SHIFTS - 1;
  int k = turn < TURNS - 2 ? (int)turn : TURNS - 2;
  float u = root - (float)i, v = turn - (float)k;
  return (place){i * TURNS + k,
                 {(1 - u) * (1 - v), (1 - u) * v, u * (1 - v), u * v}};
}

/* Normal equations for D, whose first TURNS values are 1. */
enum { VALUES = (SHIFTS + 1) * TURNS, FREE = VALUES - TURNS };
typedef struct fit {
  gsl_matrix *a;
  gsl_vector *b;
} fit;

static const int corners[4] = {0, 1, TURNS, TURNS + 1};

/* Add the sample that the sum of by[k] D[at[k]] over k < n equals `value`. Only
   the lower triangle of the matrix is computed; the factorisation does not read
   the upper triangle. */
static void fit_add_sample(fit *f, size_t n, const int *at, const double *by,
                           double value, double weight) {
  for (size_t k = 0; k < n; k++)
    if (at[k] < TURNS) value -= by[k];
  for (size_t k = 0; k < n; k++) {
    if (at[k] < TURNS) continue;
    size_t row = (size_t)(at[k] - TURNS);
    double *a = f->a->data + row * f->a->tda;
    f->b->data[row * f->b->stride] += weight * by[k] * value;
    for (size_t q = 0; q < n; q++)
      if (at[q] >= TURNS && at[q] <= at[k])
        a[at[q] - TURNS] += weight * by[k] * by[q];
  }
}

/* Add a pair of frequencies with radii x and y, angles p and q; `residual`: the
   residual of T divided by S S. */
static void fit_add_pair(fit *f, double x, double p, double y, double q,
                         double residual, double weight) {
  double c[2] = {cos(p) * cos(q), sin(p) * sin(q)};
  double hx = x * cos(p) - y * cos(q), hy = x * sin(p) - y * sin(q);
  double shift = hypot(hx, hy), by[8];
  int at[8];
  if (shift >= 2) return;
  for (int s = 0; s < 2; s++) {
    place to = place_of((float)(s ? hy : hx), (float)(s ? hx : hy));
    for (int k = 0; k < 4; k++) {
      at[4 * s + k] = to.at + corners[k];
      by[4 * s + k] = c[s] * (double)to.weight[k];
    }
  }
  fit_add_sample(f, 8, at, by, residual, weight / fmax(shift, least_shift));
}

/* Add smoothness: second differences are zero. */
static void fit_add_stiffness(fit *f) {
  static const double by[3] = {-1, 2, -1};
  double sum = 0;
  for (size_t i = 0; i < FREE; i++) sum += gsl_matrix_get(f->a, i, i);
  double weight = stiffness * sum / FREE;
  for (int i = 0; i <= SHIFTS; i++)
    for (int k = 0; k < TURNS; k++) {
      int v = i * TURNS + k;
      const int along[3] = {v - TURNS, v, v + TURNS},
                round[3] = {v - 1, v, v + 1};
      if (i && i < SHIFTS) fit_add_sample(f, 3, along, by, 0, weight);
      if (k && k < TURNS - 1) fit_add_sample(f, 3, round, by, 0, weight);
    }
}

/* Add all pairs, weighted by the model spectrum of masks. */
static void fit_add_pairs(const radial *r, size_t kept, const double *s,
                          fit *f) {
  for (int i = 0; i < r->n; i += 2)
    for (int j = 0; j <= i; j += 2) {
      double residual[ANGLES], product = s[i] * s[j];
      double area = r->root[i] * r->root[i] * r->root[j] * r->root[j];
      if (!(product > 0)) continue;
      residual_of_pair(r, kept, i, j, residual);
      for (int a = 0; a < ANGLES; a++) {
        double p = pair_first_angle(i / 2, j / 2, a);
        double q = p + pair_angle(i / 2, j / 2, a);
        fit_add_pair(f, r->node[i], p, r->node[j], q, residual[a] / product,
                     area * pair_part(i / 2, j / 2, a) * product * product);
      }
    }
}

/* Compute S at the nodes. */
static void radial_find_s(const radial *r, size_t kept, double *s) {
  for (int i = 0; i < r->n; i++) {
    double sum = r->at_node[i];
    for (size_t k = 0; k < kept; k++)
      for (int part = 0; part < (r->real ? 1 : 2); part++) {
        double f = radial_function(r, &r->sorted[k], part)[i];
        sum -= (r->sorted[k].order ? 2 : 1) * r->sorted[k].value * f * f;
      }
    s[i] = sqrt(fmax(sum, 0));
  }
}

void radial_find_residual(radial *r, size_t kept) {
  double s[NODES];
  fit f = {gsl_matrix_calloc(FREE, FREE), gsl_vector_calloc(FREE)};
  radial_find_s(r, kept, s);
  fit_add_pairs(r, kept, s, &f);
  fit_add_stiffness(&f);
  /* If all of T is kept, there are no pairs: S is 0 and D has no effect. */
  if (!gsl_linalg_cholesky_decomp1(f.a))
    (void)gsl_linalg_cholesky_svx(f.a, f.b);
  for (size_t i = 0; i < VALUES; i++)
    r->d_table[i] = i < TURNS ? 1 : (float)gsl_vector_get(f.b, i - TURNS);
  gsl_matrix_free(f.a);
  gsl_vector_free(f.b);
  for (int i = 0; i < TABLE + 2; i++) {
    double sum = r->diagonal[i];
    for (size_t k = 0; k < r->base.count; k++) {
      const coherent *c = &r->kernels[k];
      double re = c->re[i], im = c->im ? c->im[i] : 0;
      sum -= r->weights[k] * (re * re + im * im);
    }
    r->s_table[i] = (float)sqrt(fmax(sum, 0));
  }
}

/* ---- work: transfer functions and filters ---- */

/* Compute S cos(angle), or i S sin(angle) for residual term 1. The factor i
   makes the term equal to its mirror image. */
void radial_residual(const radial *r, size_t residual, const double *fx,
                     double fy, size_t n, float *out) {
  double scale = TABLE / (r->base.radius * r->base.cutoff);
  for (size_t i = 0; i < n; i++) {
    double f = sqrt(fx[i] * fx[i] + fy * fy), at = fmin(f * scale, TABLE);
    int k = (int)at;
    float t = (float)(at - k);
    float s = r->s_table[k] + t * (r->s_table[k + 1] - r->s_table[k]);
    out[2 * i] = residual ? 0 : s * (float)(f > 0 ? fx[i] / f : 1);
    out[2 * i + 1] = residual ? s * (float)(f > 0 ? fy / f : 0) : 0;
  }
}

void radial_filter(const void *self, size_t residual, const double *fx,
                   double fy, size_t n, float *out) {
  const radial *r = self;
  float scale = (float)(1 / r->base.cutoff), y = (float)fy * scale;
  for (size_t i = 0; i < n; i++) {
    float x = (float)fx[i] * scale;
    place p = residual ? place_of(y, x) : place_of(x, y);
    const float *d = r->d_table + p.at;
    out[i] = p.weight[0] * d[0] + p.weight[1] * d[1] + p.weight[2] * d[TURNS] +
             p.weight[3] * d[TURNS + 1];
  }
}
