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

/* A search for the mask of transistor i with length l, grid steps. */
typedef struct search {
  const newton *t;
  size_t i;
  double l;
  int32_t least; /* distance of a jog from the ends of its edge, grid steps */
  parts valid;   /* of the last mask that printed */
} search;

/* Return by how much mask `b` may miss the length: the effect of moved ends of
   parts is uncertain. Add a step if `b` is predicted beyond the stop, or
   outside of the bracket. *by: difference of length. */
static double search_miss(const search *k, biases b, double *by) {
  const transistor *s = &k->t->state[k->i];
  parts p = mask_parts(k->t, k->i, b);
  double x = parts_length(k->t, k->i, &p, b), off = fabs(x - k->l);
  int far = off * fabs(s->response.by[ION][BY_L]) > newton_stop(k->t) ||
            !trust_permits(&s->trust, x);
  *by = x - k->l;
  return off + tuned.least_doubt * shape_shift(&k->valid, &p, &b.shape) + far;
}

/* Return the jog between jogs from and to of mask b at which the length is
   that of the search; from and to have lengths on both sides of it. `low`: the
   mask with jog `from` is too short. */
static int32_t search_bisect(const search *k, biases b, int32_t from,
                             int32_t to, int low) {
  while (to - from > 1) {
    b.jog = from + (to - from) / 2;
    if ((mask_length(k->t, k->i, b) < k->l) == low)
      from = b.jog;
    else
      to = b.jog;
  }
  return b.jog;
}

/* Return mask `b` of length_nearest, or a mask whose jog makes the length
   nearer to that of the search, if the length of `b` is not near. The length is
   not monotonic in the position of the jog, because a jog near the end of a
   part moves that end. With straight edges `b` is the nearest. */
static biases search_jog(const search *k, biases b) {
  const sides *s = &k->t->sides[k->i];
  double by, off = search_miss(k, b, &by);
  biases found = b;
  if (shape_is_straight(&k->t->parts[k->i], &b.shape) &&
      trust_permits(&k->t->state[k->i].trust, k->l + by))
    return b;
  for (int32_t more = -1; more <= 1 && off > tuned.near_jog; more++) {
    biases next = {.l = b.l + more, .w = b.w, .shape = b.shape};
    int side = length_side(next.l);
    int32_t most = s->to[side] - s->from[side] - k->least, last = 0;
    double before = NAN;
    for (int32_t at = k->least; at <= most; at += k->least / 2 + 1) {
      next.jog = at;
      double miss = search_miss(k, next, &by);
      if (by * before < 0) {
        next.jog = search_bisect(k, next, last, at, before < 0);
        miss = search_miss(k, next, &(double){0});
      }
      before = by;
      last = at;
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
  search k = {t, i, l, (int32_t)ceil(t->min_jog / g->grid),
              mask_parts(t, i, t->state[i].valid)};
  biases b = {.w = w, .shape = t->state[i].next.shape};
  double shaped = shape_value(&t->parts[i], &b.shape), before = NAN;
  for (int n = 0; n < 3 && shaped != before; n++) {
    length x = length_nearest(&t->sides[i], l - shaped, k.least);
    b.l = x.l;
    b.jog = x.jog;
    parts p = mask_parts(t, i, b);
    before = shaped;
    shaped = shape_value(&p, &b.shape);
  }
  return search_jog(&k, b);
}

/* Return the least size to which L can reduce the errors. */
static double least_after_l(const newton *t, const transistor *s,
                            const double error[ERRORS]) {
  double more[MOVES], rest[ERRORS];
  response_solve(&s->response, error, t->weight, only_l, more);
  for (int k = 0; k < ERRORS; k++)
    rest[k] = error[k] + s->response.by[k][BY_L] * more[BY_L];
  return errors_size(t, rest);
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
        w > fmax(width_limit(s), best.w) || w < width_least(s))
      continue;
    errors_after(s, s->x[BY_L], w, rest);
    if (least_after_l(t, s, rest) >= least) continue;
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
