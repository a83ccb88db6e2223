/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the eigenvalues of the transmission cross coefficient T, computed
   from the kernels, against two independent methods. */
#include <glib.h>
#include <math.h>

#include "kernels.h"

enum { VALUES = 7, SPAN = 14 };

static const double sigma = 0.75;

/* A symmetric operator on vectors of n numbers. */
typedef struct operator{
  size_t n;
  void (*apply)(const struct operator* self, const double *x, double *out);
  double *data;
  size_t count;
}
operator;

static double dot(const double *a, const double *b, size_t n) {
  double sum = 0;
  for (size_t i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* Orthonormalise vectors by Gram-Schmidt; length[k] is the norm of vector k
   after projection. */
static void orthonormalise(double *q, size_t n, double *length) {
  for (size_t k = 0; k < SPAN; k++) {
    double *v = q + k * n;
    for (size_t i = 0; i < k; i++) {
      double c = dot(q + i * n, v, n);
      for (size_t s = 0; s < n; s++) v[s] -= c * q[i * n + s];
    }
    length[k] = sqrt(dot(v, v, n));
    for (size_t s = 0; s < n; s++) v[s] /= length[k];
  }
}

/* Compute the largest eigenvalues by subspace iteration. */
static void eigenvalues(const operator* o, double value[SPAN]) {
  double *q = g_new(double, SPAN * o->n), *next = g_new(double, o->n);
  GRand *random = g_rand_new_with_seed(7);
  for (size_t i = 0; i < SPAN * o->n; i++) q[i] = g_rand_double(random) - 0.5;
  g_rand_free(random);
  orthonormalise(q, o->n, value);
  for (int turn = 0; turn < 26; turn++) {
    for (size_t k = 0; k < SPAN; k++) {
      o->apply(o, q + k * o->n, next);
      for (size_t i = 0; i < o->n; i++) q[k * o->n + i] = next[i];
    }
    orthonormalise(q, o->n, value);
  }
  g_free(q);
  g_free(next);
}

/* ---- kernels ---- */

/* Apply T = the sum of w (re re' + im im') over all kernels. */
static void apply_kernels(const operator* o, const double *x, double *out) {
  for (size_t i = 0; i < o->n; i++) out[i] = 0;
  for (size_t k = 0; k < o->count; k++) {
    const double *f = o->data + k * o->n;
    double c = dot(f, x, o->n);
    for (size_t i = 0; i < o->n; i++) out[i] += c * f[i];
  }
}

/* Return the operator of the kernels at the frequencies of a grid, each times
   the root of the cell's area. */
static operator kernels_operator(double error, size_t count) {
  enum { CELLS = 61 };
  static const optics o = {.wavelength = 193,
                           .na = 0.75,
                           .index = 1,
                           .cutoff = 0.75 / 193,
                           .source = OPTICS_CIRCULAR,
                           .sigma = 0.75};
  kernels *k = radial_new(NULL, &o, 0, 1, error);
  g_assert_nonnull(k);
  k->keep(k, count);
  g_assert_cmpuint(k->count, ==, count);
  operator p = {
      .n = (size_t)CELLS * CELLS, .apply = apply_kernels, .count = 2 * count};
  p.data = g_new(double, p.count *p.n);
  double step = 2 * k->radius / CELLS, fx[CELLS];
  for (int i = 0; i < CELLS; i++)
    fx[i] = (-k->radius + (i + 0.5) * step) * k->cutoff;
  for (size_t s = 0; s < count; s++)
    for (int j = 0; j < CELLS; j++) {
      float value[2 * CELLS];
      k->transfer(k, s, fx, fx[j], CELLS, value);
      for (int i = 0; i < CELLS; i++)
        for (int part = 0; part < 2; part++) {
          double f = hypot(fx[i], fx[j]) < k->radius * k->cutoff;
          p.data[((2 * s + (size_t)part) * CELLS + (size_t)j) * CELLS +
                 (size_t)i] =
              f * sqrt(k->weight[s]) * step * (double)value[2 * i + part];
        }
    }
  k->free(k);
  return p;
}

/* ---- pupils ---- */

static void apply_matrix(const operator* o, const double *x, double *out) {
  for (size_t i = 0; i < o->n; i++) out[i] = dot(o->data + i * o->n, x, o->n);
}

/* Return the operator of shifted pupils. T is the sum of the shifted pupils, so
   the matrix of their common areas has the same eigenvalues. A common area is
   that of two unit disks shifted by two source points. */
static operator pupils_operator(void) {
  enum { CELLS = 34 };
  static double x[CELLS * CELLS], y[CELLS * CELLS];
  operator o = {.apply = apply_matrix};
  double step = 2 * sigma / CELLS;
  for (int j = 0; j < CELLS; j++)
    for (int i = 0; i < CELLS; i++) {
      x[o.n] = -sigma + (i + 0.5) * step;
      y[o.n] = -sigma + (j + 0.5) * step;
      o.n += hypot(x[o.n], y[o.n]) < sigma;
    }
  o.data = g_new(double, o.n *o.n);
  for (size_t i = 0; i < o.n; i++)
    for (size_t j = 0; j < o.n; j++) {
      double d = hypot(x[i] - x[j], y[i] - y[j]) / 2;
      double area = 2 * acos(d) - 2 * d * sqrt(1 - d * d);
      o.data[i * o.n + j] = area / (double)o.n; /* the source has o.n cells and
                                                   the area 1 */
    }
  return o;
}

static void test_pupils(void) {
  double got[SPAN], want[SPAN];
  const struct {
    double error;
    size_t count;
  } cases[] = {{1e-4, 40}, {1e-3, 40}};
  operator pupils = pupils_operator();
  eigenvalues(&pupils, want);
  for (size_t c = 0; c < G_N_ELEMENTS(cases); c++) {
    operator all = kernels_operator(cases[c].error, cases[c].count);
    eigenvalues(&all, got);
    for (int i = 0; i < VALUES; i++) {
      g_test_message("eigenvalue %d: %.5f, by pupils %.5f", i, got[i], want[i]);
      g_assert_cmpfloat(fabs(got[i] / want[i] - 1), <, 0.005);
    }
    g_free(all.data);
  }
  g_free(pupils.data);
}

/* Test against ratios for the same optics from another program, whose pixelated
   source makes the ratios 1 to 3 % smaller. */
static void test_reference(void) {
  static const double reference[VALUES] = {118.129, 22.6488, 22.6488, 4.54326,
                                           4.51376, 3.43913, 1.63783};
  double got[SPAN];
  operator all = kernels_operator(1e-4, 40);
  eigenvalues(&all, got);
  for (int i = 1; i < VALUES; i++) {
    double ratio = got[i] / got[0], want = reference[i] / reference[0];
    g_test_message("ratio %d: %.5f, by pixels %.5f", i, ratio, want);
    g_assert_cmpfloat(fabs(ratio / want - 1), <, 0.03);
  }
  g_free(all.data);
}

/* Test the declared symmetries of kernels against transfer functions, in focus
   and out of focus. */
static void test_mirror(void) {
  static const optics o = {.wavelength = 193,
                           .na = 0.75,
                           .index = 1,
                           .cutoff = 0.75 / 193,
                           .source = OPTICS_CIRCULAR,
                           .sigma = 0.75};
  for (int real = 0; real < 2; real++) {
    kernels *k = radial_new(NULL, &o, real ? 0 : 120, real, 1e-3);
    g_assert_nonnull(k);
    k->keep(k, 30);
    const double fx = 0.0021, fy = 0.0013;
    for (size_t s = 0; s < k->count + k->residuals; s++) {
      eda_mirrored m = k->mirror(k, s);
      float want[2], got[2];
      k->transfer(k, m.kernel, &fx, fy, 1, want);
      if (m.conjugate) want[1] = -want[1];
      k->transfer(k, s, &fx, -fy, 1, got);
      for (int i = 0; i < 2; i++) g_assert_cmpfloat(got[i], ==, want[i]);
      const double left = -fx;
      k->transfer(k, s, &left, fy, 1, got);
      for (int i = 0; i < 2; i++)
        g_assert_cmpfloat(got[i], ==, m.odd ? -want[i] : want[i]);
    }
    k->free(k);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/radial/pupils", test_pupils);
  g_test_add_func("/radial/reference", test_reference);
  g_test_add_func("/radial/mirror", test_mirror);
  return g_test_run();
}
