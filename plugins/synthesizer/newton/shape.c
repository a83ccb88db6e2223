/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements parts, ripple and shapes. Least squares with a linear model of the
   optical smoothing yield the real-valued moves of parts that minimize the
   ripple. Dynamic programming (Potts functional) then chooses whole steps with
   few jogs. */
#include "shape.h"

#include <math.h>
#include <string.h>

#include "tuning.h"

/* ---- parts ---- */

parts parts_of(const eda_gates *g, size_t i, const sides *s, double min_jog) {
  eda_box b = g->box[i];
  int32_t width = g->axis[i] == EDA_X ? b.y1 - b.y0 : b.x1 - b.x0;
  double step = tuned.blur / g->grid, least = min_jog / g->grid;
  double low = fmin(s->from[0], s->from[1]);
  double high = fmax(s->to[0], s->to[1]);
  int n = (int)fmin(floor(width / step), EDA_PARTS - 2), m = 0;
  parts p = {0};
  if (n < 1) return p;
  int all = n < EDA_PARTS - 2; /* beyond EDA_PARTS - 2 parts, the middle parts
                                  are wider */
  if (all) step = (double)width / n;
  if (low <= -least) p.edge[m++] = low;
  p.first = m;
  for (int k = 0; k <= n; k++)
    p.edge[m++] = floor(!all && 2 * k == n ? width / 2.0
                        : 2 * k <= n       ? k * step
                                           : width - (n - k) * step);
  p.last = m - 1;
  if (high >= width + least) p.edge[m++] = high;
  p.count = m - 1;
  for (int k = 1; k < p.count; k++) p.share[k] = length_share(s, p.edge[k]);
  p.share[p.count] = 1;
  return p;
}

/* Return whether shape s has a step at the LOW end of part k. */
static int has_step(const shape *s, int k) { return s->by[k - 1] != s->by[k]; }

/* Return the end of a part that is nearest to position `at`. */
static int end_nearest(const parts *p, double at) {
  int nearest = 1;
  for (int k = 2; k < p->count; k++)
    if (fabs(p->edge[k] - at) < fabs(p->edge[nearest] - at)) nearest = k;
  return nearest;
}

parts parts_beside(const parts *p, const sides *s, double at, double least,
                   const shape *of) {
  parts out = *p;
  for (int k = 1; k < p->count; k++) {
    if (!has_step(of, k) || !(fabs(p->edge[k] - at) < least)) continue;
    int nearest = end_nearest(p, at);
    out.edge[k] = k == nearest ? at : at + (k > nearest ? least : -least);
    out.share[k] = length_share(s, out.edge[k]);
  }
  return out;
}

void shape_write(const parts *p, const shape *s, eda_part out[EDA_PARTS]) {
  int m = 0;
  memset(out, 0, EDA_PARTS * sizeof *out);
  for (int k = 0; k < p->count; k++) {
    if (!s->by[k]) continue;
    int32_t from = k ? (int32_t)p->edge[k] : -EDA_PART_END;
    int32_t to = k + 1 < p->count ? (int32_t)p->edge[k + 1] : EDA_PART_END;
    if (m && out[m - 1].to == from && out[m - 1].by == s->by[k])
      out[m - 1].to = to;
    else
      out[m++] = (eda_part){from, to, s->by[k]};
  }
}

double shape_value(const parts *p, const shape *s) {
  double sum = p->count ? s->by[p->count - 1] : 0;
  for (int k = 1; k < p->count; k++)
    if (has_step(s, k)) sum += p->share[k] * (s->by[k - 1] - s->by[k]);
  return sum;
}

int shape_is_straight(const parts *p, const shape *s) {
  int straight = 1;
  for (int k = 1; k < p->count; k++) straight &= !has_step(s, k);
  return straight;
}

double shape_shift(const parts *from, const parts *to, const shape *s) {
  double sum = 0;
  for (int k = 1; k < to->count; k++)
    if (has_step(s, k))
      sum += fabs((to->share[k] - from->share[k]) * (s->by[k - 1] - s->by[k]));
  return sum;
}

/* ---- the ripple ---- */

static void less_mean(ripple *r) {
  double sum = 0;
  for (int j = 0; j < r->count; j++) sum += r->off[j];
  double mean = sum / r->count;
  for (int j = 0; j < r->count; j++) r->off[j] -= mean;
}

/* Return the position of sample j, grid steps from the LOW end. */
static double sample_position(const parts *p, int j) {
  const double *edge = p->edge + p->first + j / SAMPLES;
  double part = (j % SAMPLES + 0.5) / SAMPLES;
  return edge[0] + part * (edge[1] - edge[0]);
}

/* Return printed minus drawn length, nm, at the position `from_middle` along W,
   nm. -INFINITY: no poly prints at this position; NAN: no edge nearby. */
static double length_off(const eda_feedback *f, size_t i, double from_middle) {
  const eda_gates *g = f->gates;
  eda_box b = g->box[i];
  int upright = g->axis[i] == EDA_X;
  double middle = (upright ? b.x0 + b.x1 : b.y0 + b.y1) / 2.0 * g->grid;
  double along = (upright ? b.y0 + b.y1 : b.x0 + b.x1) / 2.0 * g->grid;
  double half = g->length[i] / 2, sum = 0;
  along += from_middle;
  double x = upright ? middle : along, y = upright ? along : middle, inside;
  eda_field_sample(&f->print[EDA_POLY], &x, &y, 1, &inside);
  if (inside < 0) return -INFINITY;
  for (int out = -1; out <= 1; out += 2) {
    double at = middle + out * half;
    sum += eda_field_epe(&f->print[EDA_POLY], upright ? EDA_X : EDA_Y, out,
                         upright ? at : along, upright ? along : at, half);
  }
  return sum;
}

int32_t width_thin_end(const eda_feedback *f, size_t i, int high, int32_t from,
                       int32_t most, double least) {
  const eda_gates *g = f->gates;
  int32_t k = 0;
  if (!f->print) return 0;
  for (; k < most; k++) {
    double at = g->width[i] / 2 + (from - k) * g->grid;
    if (!(length_off(f, i, high ? at : -at) < least)) break;
  }
  return k;
}

ripple ripple_of(const eda_feedback *f, size_t i, const parts *p) {
  ripple r = {.count = f->print ? SAMPLES * (p->last - p->first) : 0};
  double grid = f->gates->grid, width = f->gates->width[i];
  for (int j = 0; j < r.count; j++) {
    double at = sample_position(p, j) * grid - width / 2;
    r.off[j] = length_off(f, i, f->printed->weq[i] / width * at);
    if (!isfinite(r.off[j])) return (ripple){0};
  }
  if (r.count) less_mean(&r);
  return r;
}

/* Return the change of length, nm, at sample j by a step of an edge from `from`
   to `to`. */
static double step_effect(const parts *p, double from, double to, int j,
                          double gain, double blur) {
  double at = sample_position(p, j);
  return gain * (normal_distribution((to - at) / blur) -
                 normal_distribution((from - at) / blur));
}

static double part_effect(const parts *p, int k, int j, double gain,
                          double blur) {
  return step_effect(p, p->edge[k], p->edge[k + 1], j, gain, blur);
}

void ripple_add(const parts *p, ripple *r, double from, double to, double gain,
                double blur) {
  for (int j = 0; j < r->count; j++)
    r->off[j] += step_effect(p, from, to, j, gain, blur);
  if (r->count) less_mean(r);
}

ripple ripple_after(const parts *p, const ripple *now, const shape *from,
                    const shape *to, double gain, double blur) {
  ripple r = *now;
  for (int k = 0; k < p->count; k++) {
    int by = to->by[k] - from->by[k];
    for (int j = 0; by && j < r.count; j++)
      r.off[j] += by * part_effect(p, k, j, gain, blur);
  }
  less_mean(&r);
  return r;
}

double ripple_excess(const ripple *r, double slope) {
  double sum = 0;
  if (!r->count) return 0;
  for (int j = 0; j < r->count; j++) sum += exp(slope * r->off[j]);
  return log(sum / r->count);
}

/* A ripple r increases a current by the fraction slope^2 r^2 / 2; changes of L
   and W compensate for both currents. */
double ripple_cost(double drawn, const curve *c) {
  double ion = -c->slope[ION], ioff = -c->slope[IOFF];
  return (ion + ioff) / 2 / drawn + ion * ioff / 2;
}

/* ---- flat edges ---- */

/* Solve a x = b for a symmetric positive definite a; overwrites a and b. */
static void cholesky(int n, double a[EDA_PARTS][EDA_PARTS],
                     double x[EDA_PARTS]) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j <= i; j++) {
      double sum = a[i][j];
      for (int k = 0; k < j; k++) sum -= a[i][k] * a[j][k];
      a[i][j] = i == j ? sqrt(sum) : sum / a[j][j];
    }
  for (int i = 0; i < n; i++) {
    for (int k = 0; k < i; k++) x[i] -= a[i][k] * x[k];
    x[i] /= a[i][i];
  }
  for (int i = n - 1; i >= 0; i--) {
    for (int k = i + 1; k < n; k++) x[i] -= a[k][i] * x[k];
    x[i] /= a[i][i];
  }
}

/* Compute the real-valued moves of parts that minimize the ripple, weighted by
   leakage. A Tikhonov term limits moves that have little effect. */
static void least_squares(const parts *p, const ripple *r, double leak,
                          double gain, double blur, double x[EDA_PARTS]) {
  double a[EDA_PARTS][EDA_PARTS] = {{0}}, row[EDA_PARTS];
  int n = p->count;
  memset(x, 0, EDA_PARTS * sizeof *x);
  for (int j = 0; j < r->count; j++) {
    double weight = fmin(fmax(exp(leak * r->off[j]), 0.1), 4);
    for (int k = 0; k < n; k++) row[k] = part_effect(p, k, j, gain, blur);
    for (int k = 0; k < n; k++) {
      x[k] -= weight * row[k] * r->off[j];
      for (int m = 0; m <= k; m++) a[k][m] += weight * row[k] * row[m];
    }
  }
  for (int k = 0; k < n; k++)
    a[k][k] += SAMPLES * tuned.firm * tuned.firm * gain * gain;
  cholesky(n, a, x);
}

enum { MOST = 12, VALUES = 2 * MOST + 1 };

/* Compute the whole steps v[k] up to high[k] that minimize the sum of (x[k] -
   v[k])^2 plus `jump` for each position at which v changes. */
static void potts_steps(int n, const double *x, const int *high, double jump,
                        int16_t *v) {
  double cost[EDA_PARTS][VALUES];
  int best[EDA_PARTS] = {0}, which[EDA_PARTS][VALUES];
  for (int k = 0; k < n; k++) {
    for (int s = 0; s < VALUES; s++) {
      double off = x[k] - (s - MOST), stay = 0, change = 0;
      if (k) {
        stay = cost[k - 1][s];
        change = cost[k - 1][best[k - 1]] + jump;
      }
      which[k][s] = k && change < stay ? best[k - 1] : s;
      cost[k][s] =
          s - MOST > high[k] ? INFINITY : off * off + fmin(stay, change);
      if (cost[k][s] < cost[k][best[k]] || isinf(cost[k][best[k]])) best[k] = s;
    }
  }
  for (int k = n - 1, s = n ? best[n - 1] : 0; k >= 0; k--) {
    v[k] = (int16_t)(s - MOST);
    s = which[k][s];
  }
}

shape shape_flat(const parts *p, const ripple *now, const shape *from,
                 double leak, double gain, double blur, double price,
                 int blocked) {
  double x[EDA_PARTS], sum = 0;
  int high[EDA_PARTS], n = p->last - p->first;
  shape s = *from;
  if (!now->count) return s;
  least_squares(p, now, leak, gain, blur, x);
  for (int k = 0; k < p->count; k++) {
    high[k] = blocked ? from->by[k] : MOST;
    x[k] += from->by[k];
    if (p->first <= k && k < p->last) sum += x[k];
  }
  for (int k = 0; k < p->count; k++) x[k] -= sum / n; /* L moves by the mean */
  double nm = gain * tuned.local;
  potts_steps(p->count, x, high, price * n / (nm * nm), s.by);
  return s;
}
