/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the choice of a mask on the grid for a wanted length and width,
   and the prediction of the errors of a mask. */
#include "mask.h"

#include <math.h>
#include <stdlib.h>

#include "tuning.h"

static const int only_l[MOVES] = {1, 0}, only_w[MOVES] = {0, 1};

double width_most(const newton *t, const eda_gates *g, size_t i) {
  return fmin(t->max_bias, g->width[i] / 2) / g->grid;
}

void errors_after(const transistor *s, double l, double w,
                  double rest[ERRORS]) {
  for (int k = 0; k < ERRORS; k++)
    rest[k] = s->error[k] + s->response.by[k][BY_L] * (l - s->x[BY_L]) +
              s->response.by[k][BY_W] * (w - s->x[BY_W]);
}

/* Return by how much mask `b` may miss length l, grid steps: the effect of
   moved ends of parts is uncertain. Add a step if `b` is predicted beyond the
   stop, or outside of the bracket. */
static double mask_miss(const newton *t, size_t i, double l, biases b) {
  const transistor *s = &t->state[i];
  double x = mask_length(t, i, b), off = fabs(x - l);
  int far = off * fabs(s->response.by[ION][BY_L]) > newton_stop(t) ||
            !trust_permits(&s->trust, x);
  return off + tuned.least_doubt * mask_shift(t, i, s->valid, b) + far;
}

/* Return the jog between jogs from and to of mask b at which the length is l;
   from and to have lengths on both sides of l. */
static int32_t mask_bisect_jog(const newton *t, size_t i, double l, biases b,
                               int32_t from, int32_t to) {
  b.jog = from;
  int low = mask_length(t, i, b) < l;
  while (to - from > 1) {
    b.jog = from + (to - from) / 2;
    if ((mask_length(t, i, b) < l) == low)
      from = b.jog;
    else
      to = b.jog;
  }
  return b.jog;
}

/* Return mask `b`, or a mask whose jog makes the length nearer to l, if the
   length of `b` is not near l. The length is not monotonic in the position of
   the jog, because a jog near the end of a part moves that end. */
static biases mask_clear_jog(const newton *t, size_t i, double l, int32_t least,
                             biases b) {
  const sides *s = &t->sides[i];
  double off = mask_miss(t, i, l, b);
  biases found = b;
  for (int32_t k = -1; k <= 1 && off > tuned.near_jog; k++) {
    biases next = {.l = b.l + k, .w = b.w, .shape = b.shape};
    int side = length_side(next.l);
    int32_t most = s->to[side] - s->from[side] - least, last = 0;
    double before = NAN;
    for (int32_t at = least; at <= most; at += least / 2 + 1) {
      next.jog = at;
      double by = mask_length(t, i, next) - l;
      if (by * before < 0) next.jog = mask_bisect_jog(t, i, l, next, last, at);
      before = by;
      last = at;
      double miss = mask_miss(t, i, l, next);
      if (miss >= off) continue;
      off = miss;
      found = next;
    }
  }
  return found;
}

/* Return the mask with the jog whose effective length is nearest to l. The
   search iterates, because a jog moves ends of parts and so changes the
   length. */
static biases mask_with_jog(const newton *t, const eda_gates *g, size_t i,
                            double l, int32_t w) {
  int32_t least = (int32_t)ceil(t->min_jog / g->grid);
  biases b = {.w = w, .shape = t->state[i].next.shape};
  double shaped = shape_value(&t->parts[i], &b.shape);
  for (int k = 0; k < 3; k++) {
    length x = length_nearest(&t->sides[i], l - shaped, least);
    b.l = x.l;
    b.jog = x.jog;
    shaped = mask_length(t, i, b) - length_value(&t->sides[i], x);
  }
  return mask_clear_jog(t, i, l, least, b);
}

/* Return `best` or, if its predicted errors are smaller, a mask whose W differs
   by up to two steps (for narrow gates, whose jogs have a large effect). */
static biases mask_with_width(const newton *t, const eda_feedback *f, size_t i,
                              biases best) {
  const transistor *s = &t->state[i];
  double rest[ERRORS], more[MOVES], grid = f->gates->grid;
  double most = width_most(t, f->gates, i);
  int any = corrects_ioff(t); /* W moves for Ioff */
  double enough =
      any ? newton_tolerance(t)
          : fmax(newton_ion_limit(t), tuned.coarse * newton_tolerance(t));
  biases found = best;
  errors_after(s, mask_length(t, i, best), best.w, rest);
  double least =
      !t->settled || trust_permits(&s->trust, mask_length(t, i, best))
          ? errors_size(t, rest)
          : INFINITY;
  if (least <= enough / t->goal[i].weight) return best;
  for (int step = any ? -2 : -1; step <= (any ? 2 : 1); step++) {
    uint32_t veto = step > 0 ? EDA_VETO_WIDER : EDA_VETO_NARROWER;
    int32_t w = best.w + step;
    if (!step || f->vetoes[i] & veto || abs(w) > most ||
        w > fmax(width_limit(s), best.w))
      continue;
    errors_after(s, s->x[BY_L], w, rest);
    response_solve(&s->response, rest, t->steer, only_l, more);
    veto = more[BY_L] > 0 ? EDA_VETO_LONGER : EDA_VETO_SHORTER;
    double l = s->x[BY_L] + more[BY_L];
    if (f->vetoes[i] & veto || fabs(l) > t->max_bias / grid) continue;
    biases next = mask_with_jog(t, f->gates, i, l, w);
    errors_after(s, mask_length(t, i, next), w, rest);
    if (errors_size(t, rest) >= least) continue;
    least = errors_size(t, rest);
    found = next;
  }
  return found;
}

biases mask_on_grid(const newton *t, const eda_feedback *f, size_t i,
                    const double dx[MOVES], double enough, int cut) {
  const transistor *s = &t->state[i];
  double rest[ERRORS], more[MOVES];
  int32_t w = (int32_t)lround(s->x[BY_W] + dx[BY_W]);
  double l = s->x[BY_L] + dx[BY_L];
  errors_after(s, l, w, rest);
  response_solve(&s->response, rest, t->steer, only_l, more);
  if (dx[BY_L] != 0 && !cut) l += fmin(fmax(more[BY_L], -1), 1);
  const shape *edges = &s->next.shape;
  double shaped = shape_value(&t->parts[i], edges);
  int32_t whole = (int32_t)lround(l - shaped);
  errors_after(s, whole + shaped, w, rest);
  if (t->fine == NONE || (t->fine == JOG && errors_size(t, rest) <= enough))
    return (biases){.l = whole, .w = w, .shape = *edges};
  biases near = mask_with_jog(t, f->gates, i, l, w);
  if (t->fine == JOG) return cut ? near : mask_with_width(t, f, i, near);
  response_solve(&s->response, rest, t->weight, only_w, more);
  return (biases){
      .l = whole, .w = w + (int32_t)lround(more[BY_W]), .shape = *edges};
}

double mask_expected_size(const newton *t, size_t i, biases next) {
  const transistor *s = &t->state[i];
  const response *r = &s->response;
  double rest[ERRORS], wrong[ERRORS], l = mask_length(t, i, next);
  errors_after(s, l, next.w, rest);
  if (fabs(s->error[ION]) > newton_ion_limit(t)) return errors_size(t, rest);
  for (int k = 0; k < ERRORS; k++)
    wrong[k] = hypot(r->doubt[BY_L] * r->by[k][BY_L] * (l - s->x[BY_L]),
                     r->doubt[BY_W] * r->by[k][BY_W] * (next.w - s->x[BY_W]));
  return hypot(errors_size(t, rest), errors_size(t, wrong));
}
