/* SPDX-License-Identifier: BSD-3-Clause */
/* Fourier transforms of EDA_LANES signals at once, one in each lane of a
   vector. A length n is factored into n1 * n2 of similar size, so that each
   part fits the first-level cache (D. H. Bailey, J. Supercomputing 4, 1990).
   Parts use Stockham's algorithm, which needs no reordering (C. Van Loan,
   Computational Frameworks for the FFT, 1.7). */
#include "imaging/lanes.h"

#include <eda/simd.h>

#include <glib.h>
#include <math.h>
#include <stdlib.h>

enum { MAX_STAGES = 16 };

typedef struct twiddle {
  float re, im;
} twiddle;

/* A transform of length n, one of the two factors of the whole length, in
   stages. radix[s] is the radix of stage s. The roots of a stage are exp(2 pi i
   p j / length) for p = 0 .. length / radix - 1 and j = 1 .. radix - 1;
   `length` is n divided by the radices of all earlier stages. */
typedef struct part {
  int n, stages;
  int radix[MAX_STAGES];
  twiddle *roots[MAX_STAGES];
} part;

struct eda_lanes_plan {
  int n;
  part first, second;
  twiddle *between; /* exp(2 pi i j k / n): [j][k], j < n2, k < n1 */
};

/* ---- plans ---- */

static twiddle root_of_unity(int64_t k, int64_t n) {
  double angle = 2 * M_PI * (double)(k % n) / (double)n;
  return (twiddle){(float)cos(angle), (float)sin(angle)};
}

static int radix_factors(int n, int radix[MAX_STAGES]) {
  static const int try[] = {8, 4, 5, 3, 2};
  int stages = 0;
  for (size_t i = 0; i < G_N_ELEMENTS(try); i++)
    for (; n % try[i] == 0 && stages < MAX_STAGES; n /= try[i])
      radix[stages++] = try[i];
  return stages;
}

static void make_part(part *p, int n) {
  p->n = n;
  p->stages = radix_factors(n, p->radix);
  for (int s = 0, length = n; s < p->stages; length /= p->radix[s++]) {
    int r = p->radix[s], m = length / r;
    twiddle *to = p->roots[s] = g_new(twiddle, (gsize)m * (gsize)(r - 1));
    for (int i = 0; i < m; i++)
      for (int j = 1; j < r; j++) *to++ = root_of_unity((int64_t)i * j, length);
  }
}

static eda_lanes_plan *make_plan(int n) {
  eda_lanes_plan *plan = g_new0(eda_lanes_plan, 1);
  int first = 1;
  for (int d = 1; (int64_t)d * d <= n; d++)
    if (n % d == 0) first = d;
  /* Short lines fit the cache without factoring. */
  if (n <= 128) first = 1;
  plan->n = n;
  make_part(&plan->first, first);
  make_part(&plan->second, n / first);
  if (first == 1) return plan;
  twiddle *to = plan->between = g_new(twiddle, (gsize)n);
  for (int j = 0; j < n / first; j++)
    for (int k = 0; k < first; k++) *to++ = root_of_unity((int64_t)j * k, n);
  return plan;
}

const eda_lanes_plan *eda_lanes_plan_for(int n) {
  static GMutex lock;
  static GHashTable *plans;
  g_mutex_lock(&lock);
  if (!plans) plans = g_hash_table_new(NULL, NULL);
  eda_lanes_plan *plan = g_hash_table_lookup(plans, GINT_TO_POINTER(n));
  if (!plan) {
    plan = make_plan(n);
    g_hash_table_insert(plans, GINT_TO_POINTER(n), plan);
  }
  g_mutex_unlock(&lock);
  return plan;
}

size_t eda_lanes_capacity(const eda_lanes_plan *plan) {
  size_t longer = (size_t)MAX(plan->first.n, plan->second.n);
  return (size_t)plan->n + 3 * longer;
}

/* ---- stages ---- */

/* A stage of the transform: `step` interleaved transforms of `length` numbers
   each. Number p + i * length / radix (input) becomes number radix * p + j
   (output). */
typedef struct stage {
  int length, step;
  const twiddle *roots;
  const eda_lanes *in;
  eda_lanes *out;
  size_t in_stride, out_stride;
} stage;

#define TIMES(to, w, x_re, x_im)                  \
  do {                                            \
    (to)->re = (x_re) * (w).re - (x_im) * (w).im; \
    (to)->im = (x_re) * (w).im + (x_im) * (w).re; \
  } while (0)

/* Begin the loops over all butterflies of a stage. x[i * apart]: inputs; y[j *
   next]: outputs; w: roots. */
#define BUTTERFLIES(r)                                                       \
  int m = g->length / (r);                                                   \
  for (int p = 0; p < m; p++) {                                              \
    const twiddle *w = g->roots + (size_t)p * ((r)-1);                       \
    for (int q = 0; q < g->step; q++) {                                      \
      const eda_lanes *x = g->in + g->in_stride * (size_t)(q + g->step * p); \
      size_t apart = g->in_stride * (size_t)g->step * (size_t)m;             \
      eda_lanes *y = g->out + g->out_stride * (size_t)(q + g->step * (r)*p); \
      size_t next = g->out_stride * (size_t)g->step;
#define END_BUTTERFLIES \
  }                     \
  }

EDA_WIDE static void radix2(const stage *g) {
  BUTTERFLIES(2)
  eda_lanes a = x[0], b = x[apart];
  y[0].re = a.re + b.re;
  y[0].im = a.im + b.im;
  TIMES(&y[next], w[0], a.re - b.re, a.im - b.im);
  END_BUTTERFLIES
}

EDA_WIDE static void radix3(const stage *g) {
  static const float s = 0.86602540378443865f;
  BUTTERFLIES(3)
  eda_lanes a = x[0], b = x[apart], c = x[2 * apart];
  eda_vector sum_re = b.re + c.re, sum_im = b.im + c.im;
  eda_vector middle_re = a.re - 0.5f * sum_re, middle_im = a.im - 0.5f * sum_im;
  eda_vector turn_re = -s * (b.im - c.im), turn_im = s * (b.re - c.re);
  y[0].re = a.re + sum_re;
  y[0].im = a.im + sum_im;
  TIMES(&y[next], w[0], middle_re + turn_re, middle_im + turn_im);
  TIMES(&y[2 * next], w[1], middle_re - turn_re, middle_im - turn_im);
  END_BUTTERFLIES
}

EDA_WIDE static void radix4(const stage *g) {
  BUTTERFLIES(4)
  eda_lanes a = x[0], b = x[apart], c = x[2 * apart], d = x[3 * apart];
  eda_vector even_re = a.re + c.re, even_im = a.im + c.im;
  eda_vector over_re = a.re - c.re, over_im = a.im - c.im;
  eda_vector odd_re = b.re + d.re, odd_im = b.im + d.im;
  eda_vector turn_re = d.im - b.im, turn_im = b.re - d.re;
  y[0].re = even_re + odd_re;
  y[0].im = even_im + odd_im;
  TIMES(&y[next], w[0], over_re + turn_re, over_im + turn_im);
  TIMES(&y[2 * next], w[1], even_re - odd_re, even_im - odd_im);
  TIMES(&y[3 * next], w[2], over_re - turn_re, over_im - turn_im);
  END_BUTTERFLIES
}

EDA_WIDE static void radix5(const stage *g) {
  static const float c1 = 0.30901699437494742f, c2 = -0.80901699437494742f;
  static const float s1 = 0.95105651629515357f, s2 = 0.58778525229247313f;
  BUTTERFLIES(5)
  eda_lanes a = x[0], b = x[apart], c = x[2 * apart], d = x[3 * apart],
            e = x[4 * apart];
  eda_vector o_re = b.re + e.re,
             o_im = b.im + e.im; /* o: sum of b and e; i: sum of c and d */
  eda_vector i_re = c.re + d.re, i_im = c.im + d.im;
  eda_vector p_re = b.re - e.re, p_im = b.im - e.im;
  eda_vector q_re = c.re - d.re, q_im = c.im - d.im;
  eda_vector f_re = a.re + c1 * o_re + c2 * i_re;
  eda_vector f_im = a.im + c1 * o_im + c2 * i_im;
  eda_vector h_re = a.re + c2 * o_re + c1 * i_re;
  eda_vector h_im = a.im + c2 * o_im + c1 * i_im;
  eda_vector u_re = s1 * p_re + s2 * q_re, u_im = s1 * p_im + s2 * q_im;
  eda_vector v_re = s2 * p_re - s1 * q_re, v_im = s2 * p_im - s1 * q_im;
  y[0].re = a.re + o_re + i_re;
  y[0].im = a.im + o_im + i_im;
  TIMES(&y[next], w[0], f_re - u_im, f_im + u_re);
  TIMES(&y[2 * next], w[1], h_re - v_im, h_im + v_re);
  TIMES(&y[3 * next], w[2], h_re + v_im, h_im - v_re);
  TIMES(&y[4 * next], w[3], f_re + u_im, f_im - u_re);
  END_BUTTERFLIES
}

/* Form the sums and the differences of opposite inputs, and transform both as
   in radix4. */
EDA_WIDE static void radix8(const stage *g) {
  static const float h = 0.70710678118654752f;
  BUTTERFLIES(8)
  eda_lanes s[4], d[4];
  for (int i = 0; i < 4; i++) {
    eda_lanes a = x[(size_t)i * apart], b = x[(size_t)(i + 4) * apart];
    s[i].re = a.re + b.re;
    s[i].im = a.im + b.im;
    d[i].re = a.re - b.re;
    d[i].im = a.im - b.im;
  }
  eda_vector even_re = s[0].re + s[2].re, even_im = s[0].im + s[2].im;
  eda_vector over_re = s[0].re - s[2].re, over_im = s[0].im - s[2].im;
  eda_vector odd_re = s[1].re + s[3].re, odd_im = s[1].im + s[3].im;
  eda_vector turn_re = s[3].im - s[1].im, turn_im = s[1].re - s[3].re;
  y[0].re = even_re + odd_re;
  y[0].im = even_im + odd_im;
  TIMES(&y[2 * next], w[1], over_re + turn_re, over_im + turn_im);
  TIMES(&y[4 * next], w[3], even_re - odd_re, even_im - odd_im);
  TIMES(&y[6 * next], w[5], over_re - turn_re, over_im - turn_im);
  /* Multiply the differences by exp(2 pi i k / 8). */
  eda_vector a_re = h * (d[1].re - d[1].im), a_im = h * (d[1].re + d[1].im);
  eda_vector b_re = h * (-d[3].re - d[3].im), b_im = h * (d[3].re - d[3].im);
  even_re = d[0].re - d[2].im;
  even_im = d[0].im + d[2].re;
  over_re = d[0].re + d[2].im;
  over_im = d[0].im - d[2].re;
  odd_re = a_re + b_re;
  odd_im = a_im + b_im;
  turn_re = b_im - a_im;
  turn_im = a_re - b_re;
  TIMES(&y[next], w[0], even_re + odd_re, even_im + odd_im);
  TIMES(&y[3 * next], w[2], over_re + turn_re, over_im + turn_im);
  TIMES(&y[5 * next], w[4], even_re - odd_re, even_im - odd_im);
  TIMES(&y[7 * next], w[6], over_re - turn_re, over_im - turn_im);
  END_BUTTERFLIES
}

/* ---- lines ---- */

/* Transform p->n points, in_stride apart, from `in` to `out`; `work` has
   capacity for 2 * p->n points. */
static void run_part(const part *p, const eda_lanes *in, size_t in_stride,
                     eda_lanes *out, size_t out_stride, eda_lanes *work) {
  void (*const stages[])(const stage *) = {
      [2] = radix2, [3] = radix3, [4] = radix4, [5] = radix5, [8] = radix8};
  stage g = {.length = p->n, .step = 1, .in = in, .in_stride = in_stride};
  for (int s = 0; s < p->stages; s++) {
    int last = s + 1 == p->stages;
    g.roots = p->roots[s];
    g.out = last ? out : work + (s % 2 ? p->n : 0);
    g.out_stride = last ? out_stride : 1;
    stages[p->radix[s]](&g);
    g.in = g.out;
    g.in_stride = 1;
    g.length /= p->radix[s];
    g.step *= p->radix[s];
  }
}

/* Compute to[k * stride] = from[k] * root[k]. */
EDA_WIDE static void turn_back(const eda_lanes *from, const twiddle *roots,
                               int n, eda_lanes *to, size_t stride) {
  for (int k = 0; k < n; k++) {
    eda_vector re = from[k].re, im = from[k].im;
    TIMES(&to[(size_t)k * stride], roots[k], re, im);
  }
}

void eda_lanes_backward(const eda_lanes_plan *plan, eda_lanes *a,
                        eda_lanes *work) {
  int n1 = plan->first.n, n2 = plan->second.n;
  size_t s1 = (size_t)n1, s2 = (size_t)n2;
  eda_lanes *line = work + plan->n, *small = line + MAX(n1, n2);
  if (n1 == 1) {
    for (int i = 0; i < n2; i++) work[i] = a[i];
  } else {
    for (int j = 0; j < n2; j++) {
      run_part(&plan->first, a + j, s2, line, 1, small);
      turn_back(line, plan->between + (size_t)j * s1, n1, work + j, s2);
    }
  }
  for (int k = 0; k < n1; k++)
    run_part(&plan->second, work + (size_t)k * s2, 1, a + k, s1, small);
}

/* ---- tiles ---- */

/* One step of the transposition of a tile: exchange blocks of d lanes between
   the vectors i and i + d. KEEP and TAKE: source lanes of both results, in the
   numbering of __builtin_shufflevector. */
#define KEEP(l, d) ((l) & (d) ? (l) - (d) + EDA_LANES : (l))
#define TAKE(l, d) ((l) & (d) ? (l) + EDA_LANES : (l) + (d))
#define SIXTEEN(f, d)                                                     \
  f(0, d), f(1, d), f(2, d), f(3, d), f(4, d), f(5, d), f(6, d), f(7, d), \
      f(8, d), f(9, d), f(10, d), f(11, d), f(12, d), f(13, d), f(14, d), \
      f(15, d)
#define EXCHANGE(d)                                               \
  for (int i = 0; i < EDA_LANES; i++) {                           \
    if (i & (d)) continue;                                        \
    eda_vector a = v[i], b = v[i + (d)];                          \
    v[i] = __builtin_shufflevector(a, b, SIXTEEN(KEEP, d));       \
    v[i + (d)] = __builtin_shufflevector(a, b, SIXTEEN(TAKE, d)); \
  }
_Static_assert(EDA_LANES == 16, "a tile is transposed in four steps");

EDA_WIDE void eda_lanes_turn(const eda_vector *from, size_t from_stride,
                             eda_vector *to, size_t to_stride) {
  eda_vector v[EDA_LANES];
  for (int i = 0; i < EDA_LANES; i++) v[i] = from[(size_t)i * from_stride];
  EXCHANGE(8)
  EXCHANGE(4)
  EXCHANGE(2)
  EXCHANGE(1)
  for (int i = 0; i < EDA_LANES; i++) to[(size_t)i * to_stride] = v[i];
}

int eda_lanes_size(double minimum) {
  for (int n = minimum <= 16 ? 16 : ((int)ceil(minimum) + 1) & ~1;; n += 2) {
    int rest = n;
    for (int p = 2; p <= 5; p++)
      while (rest % p == 0) rest /= p;
    if (rest == 1) return n;
  }
}
