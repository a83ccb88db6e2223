/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the feedback: changes of shifts that correct the errors. The
   change of errors is modelled as gain * coupling * change of shifts, with a
   measured gain for each site. The changes are the solution of damped least
   squares (Gauss-Newton, Levenberg; N. Cobb, Y. Granik, "Model-based OPC using
   the MEEF matrix", SPIE 4889, 2002). */
#include "epe.h"

#include <math.h>
#include <string.h>

#include "tuning.h"

enum { PUSH, RESIDUAL, DIRECTION, IMAGE, SEEN };

/* ---- sums ---- */

/* Number of independent partial sums, so that additions run in parallel. */
enum { SUMS = 4 };

static double vector_dot(const double *a, const double *b, size_t n) {
  double sum[SUMS] = {0};
  size_t i = 0;
  for (; i + SUMS <= n; i += SUMS)
    for (size_t s = 0; s < SUMS; s++) sum[s] += a[i + s] * b[i + s];
  for (; i < n; i++) sum[0] += a[i] * b[i];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* ---- products with the coupling ---- */

typedef struct product {
  const epe_coupling *matrix;
  const double *in;
  const double *gain; /* factor of each element of the result; if NULL, the
                         factors are 1 */
  double *out;
} product;

static double coupling_row_times(const epe_coupling *m, size_t i,
                                 const double *in) {
  const uint32_t *index = m->index;
  const float *weight = m->weight;
  uint32_t k = m->start[i], end = m->start[i + 1];
  double sum[SUMS] = {0};
  for (; k + SUMS <= end; k += SUMS)
    for (uint32_t s = 0; s < SUMS; s++)
      sum[s] += (double)weight[k + s] * in[index[k + s]];
  for (; k < end; k++) sum[0] += (double)weight[k] * in[index[k]];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

static void coupling_multiply_row(void *data, size_t i) {
  const product *p = data;
  double sum = coupling_row_times(p->matrix, i, p->in);
  p->out[i] = p->gain ? p->gain[i] * sum : sum;
}

static void coupling_multiply(const epe_layer *l, const epe_coupling *m,
                              const double *in, const double *gain,
                              double *out) {
  product p = {m, in, gain, out};
  opc_parallel(l->context, l->count, coupling_multiply_row, &p);
}

/* ---- gains ---- */

/* Return the gain of a site by least squares over the site and the adjacent
   sites. If the shifts hardly changed, return the previous gain. */
static double site_gain(const epe_layer *l, uint32_t i) {
  double along = 0, square = 0;
  uint32_t k = i;
  for (int n = 0; n < tuned.neighbours; n++) k = l->fragments[k].previous;
  for (int n = -tuned.neighbours; n <= tuned.neighbours;
       n++, k = l->fragments[k].next) {
    double ds = l->work[IMAGE][k], de = l->error[k] - l->before[k];
    double weight = tuned.neighbours + 1 - (n < 0 ? -n : n);
    if (isnan(de)) continue;
    along += weight * ds * de;
    square += weight * ds * ds;
  }
  if (square < tuned.neighbours + 1) return l->gain[i];
  return epe_within(along / square, tuned.least_gain, tuned.most_gain);
}

static void sites_measure_gains(epe_layer *l) {
  for (uint32_t i = 0; i < l->count; i++)
    l->work[PUSH][i] = l->shift[i] - l->last[i];
  coupling_multiply(l, &l->coupling, l->work[PUSH], NULL, l->work[IMAGE]);
  for (uint32_t i = 0; i < l->count; i++)
    l->gain[i] = (l->gain[i] + site_gain(l, i)) / 2;
}

/* ---- changes of shifts ---- */

/* Compute the changes x of shifts that correct `errors`, and store x in
   work[PUSH]. Conjugate gradients solve (J'J + stiffness) x = -J' errors, with
   J = gain * coupling. */
static void moves_solve(epe_layer *l, double stiffness, const double *errors) {
  double *x = l->work[PUSH], *r = l->work[RESIDUAL], *d = l->work[DIRECTION];
  double *image = l->work[IMAGE], *seen = l->work[SEEN];
  size_t n = l->count;
  for (size_t i = 0; i < n; i++) seen[i] = -l->gain[i] * errors[i];
  coupling_multiply(l, &l->transposed, seen, NULL, r);
  memset(x, 0, n * sizeof *x);
  memcpy(d, r, n * sizeof *d);
  double rr = vector_dot(r, r, n), first = rr;
  for (int k = 0; k < tuned.descents && rr > tuned.enough * first; k++) {
    coupling_multiply(l, &l->coupling, d, l->gain, seen);
    double bend = vector_dot(seen, seen, n) + stiffness * vector_dot(d, d, n);
    for (size_t i = 0; i < n; i++) seen[i] *= l->gain[i];
    coupling_multiply(l, &l->transposed, seen, NULL, image);
    double a = rr / bend;
    for (size_t i = 0; i < n; i++) {
      x[i] += a * d[i];
      r[i] -= a * (image[i] + stiffness * d[i]);
    }
    double next = vector_dot(r, r, n);
    for (size_t i = 0; i < n; i++) d[i] = r[i] + next / rr * d[i];
    rr = next;
  }
}

/* Return the next bound of the change of a fragment's shift. The bound shrinks
   if the error changed its sign (overshoot), and grows otherwise. */
static double fragment_next_step(const epe_layer *l, uint32_t i, double most) {
  double e = l->error[i], before = l->before[i];
  double step = epe_min(l->step[i], most);
  if (e * before < 0 && fabs(e) > tuned.ignored)
    return epe_max(step / 2, tuned.least_step);
  return epe_min(step * tuned.growth, most);
}

void epe_steer(epe_layer *l, const epe_steering *by) {
  int32_t slack = l->rules->min_jog > 1 ? l->rules->min_jog : 1;
  sites_measure_gains(l);
  for (uint32_t i = 0; i < l->count; i++) {
    double e = l->error[i];
    l->step[i] = fragment_next_step(l, i, by->step);
    /* No edge nearby: a feature that did not print must grow, and a feature
       that merged with another feature must shrink. */
    if (isnan(e)) e = by->step * (l->side[i] > 0 ? tuned.lost : -tuned.lost);
    l->side[i] = e;
  }
  moves_solve(l, by->stiffness, l->side);
  for (uint32_t i = 0; i < l->count; i++) {
    double move =
        epe_within(by->damping * l->work[PUSH][i], -l->step[i], l->step[i]);
    /* Start near the present shift, so that changes that the mask rules forbid
       do not accumulate. */
    double from =
        epe_within(l->wanted[i], l->shift[i] - slack, l->shift[i] + slack);
    l->wanted[i] = from + move;
  }
}
