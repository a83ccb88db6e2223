/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the update of the state of all transistors from a simulated mask:
   errors, responses, trust regions and best masks. */
#include "observe.h"

#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tuning.h"

/* ---- work: sizes ---- */

double newton_tolerance(const newton *t) { return t->tolerance / 100; }

double newton_ion_limit(const newton *t) { return t->ion_limit / 100; }

double newton_stop(const newton *t) {
  return tuned.worthwhile * newton_ion_limit(t);
}

int biases_equal(biases a, biases b) {
  return a.l == b.l && a.w == b.w && a.jog == b.jog && a.aside == b.aside &&
         !memcmp(&a.shape, &b.shape, sizeof a.shape);
}

double errors_size(const newton *t, const double error[ERRORS]) {
  double sum = 0;
  for (int k = 0; k < ERRORS; k++) sum += t->weight[k] * error[k] * error[k];
  return sqrt(sum);
}

parts mask_parts(const newton *t, size_t i, biases b) {
  double at = length_jog(&t->sides[i], (length){b.l, b.jog});
  return parts_beside(&t->parts[i], &t->sides[i], at,
                      ceil(t->min_jog / t->gates->grid), &b.shape);
}

double parts_length(const newton *t, size_t i, const parts *of, biases b) {
  return length_value(&t->sides[i], (length){b.l, b.jog}) +
         shape_value(of, &b.shape);
}

double mask_length(const newton *t, size_t i, biases b) {
  parts p = mask_parts(t, i, b);
  return parts_length(t, i, &p, b);
}

double length_gain(const transistor *s) {
  return s->first.by[ION][BY_L] / s->first.slope[ION];
}

int corrects_ioff(const newton *t) { return t->target != PLAIN && !t->settled; }

int newton_reshapes(const newton *t, const eda_feedback *f) {
  return f->iteration > 0 && f->iteration <= tuned.shapes[t->target];
}

void moves_free(const newton *t, int free[MOVES]) {
  free[BY_L] = 1;
  free[BY_W] =
      t->target == PLAIN && (t->weight[IOFF] > 0 || t->weight[AREA] > 0);
}

/* ---- work: one transistor ---- */

/* Changes of a transistor between two iterations. */
typedef struct change {
  double dx[MOVES], de[ERRORS];
} change;

int ends_moved(const eda_gates *g, const int32_t *a, const int32_t *b) {
  return abs(a[0] - b[0]) * g->grid > tuned.still ||
         abs(a[1] - b[1]) * g->grid > tuned.still;
}

/* Return the smallest significant change of log Ion of an uncertainty. */
static double least_change(const newton *t, double uncertainty) {
  return newton_ion_limit(t) * tuned.odd_limit +
         tuned.odd_surprise * uncertainty;
}

static double least_visible(const newton *t, const transistor *s) {
  return least_change(t, s->uncertainty);
}

/* Return whether log Ion changed by more than the transistor's own moves can
   cause at the largest allowed response, so that a regulator shape or a
   neighbour caused the change. */
static int is_foreign(const newton *t, const transistor *s, const change *c) {
  double most = least_visible(t, s);
  for (int m = 0; m < MOVES; m++)
    most += tuned.trust[m] * fabs(s->first.by[ION][m] * c->dx[m]);
  return fabs(c->de[ION]) > most;
}

/* Make the present mask the best mask if its error is smaller. Also do so if a
   neighbour or a line end changed the error: `best_size` is then no longer
   valid. */
static void keep_best(transistor *s, uint32_t flags, int first) {
  if (!first && !s->disturbed && s->size >= s->best_size &&
      !biases_equal(s->now, s->best))
    return;
  s->best_size = s->size;
  s->best = s->now;
  memcpy(s->best_error, s->error, sizeof s->best_error);
  s->outside = (flags & EDA_PRINT_OUTSIDE) != 0;
}

/* Return the pull: the error of Ion alone that would require the same move of L
   as all errors together. */
static double pull_of(const newton *t, const transistor *s) {
  int free[MOVES];
  double dx[MOVES];
  moves_free(t, free);
  response_solve(&s->response, s->error, t->steer, free, dx);
  return -dx[BY_L] * s->response.by[ION][BY_L];
}

/* Return d pull / d W; 0 if the weights let W move, too. */
static double pull_by_w(const newton *t, const transistor *s) {
  int free[MOVES];
  moves_free(t, free);
  return free[BY_W] ? 0 : s->response.by[ION][BY_W];
}

static void transistor_init(transistor *s, biases drawn) {
  s->valid = s->best = drawn;
  s->size = s->best_size = INFINITY;
  s->point = (point){{NAN, NAN}, {NAN, NAN}};
}

/* Compute the outward moves of both ends of the width, grid steps. */
static void ends_of(biases b, int32_t at[2]) {
  at[0] = (b.w >> 1) - b.aside; /* divided as in eda_moves */
  at[1] = b.w - at[0];
}

/* Limit the ends of the width after a wider mask did not print: each end may
   move half as far. The active merged with a neighbour or extends beyond the
   line end. `by_l`: move of L. Return whether an end moved further than L. */
static int width_limit_ends(transistor *s, double by_l) {
  int32_t good[2], now[2];
  int wider = 0;
  ends_of(s->valid, good);
  ends_of(s->now, now);
  for (int high = 0; high < 2; high++) {
    int32_t out = now[high] - good[high];
    if (out <= fabs(by_l)) continue;
    wider = 1;
    s->print_limit[high] = good[high] + out / 2;
    s->outward_limit[high] = MIN(s->outward_limit[high], s->print_limit[high]);
  }
  return wider;
}

/* Update the state after a mask that does not print: reduce the limit of the
   move that caused the failure, or make L an end of the bracket. */
static void transistor_fail(transistor *s, const double x[MOVES],
                            uint32_t flags) {
  double dx = x[BY_L] - s->x[BY_L];
  int open = flags & EDA_PRINT_OPEN || (!(flags & EDA_PRINT_MERGED) && dx < 0);
  s->failed = 1;
  if (biases_equal(s->now, s->best)) s->best_size = INFINITY;
  if (isfinite(s->size) && width_limit_ends(s, dx)) return;
  if (isfinite(s->size) && dx != 0) s->trust.radius = fabs(dx) / 2;
  trust_see(&s->trust, x[BY_L], open ? INFINITY : -INFINITY);
}

/* Update the trust region. `foreseen`: pull that was predicted before the
   simulation. */
static void trust_update(const newton *t, transistor *s, const change *c,
                         double foreseen) {
  double before = s->pull, due = foreseen - before;
  s->pull = pull_of(t, s);
  int against = !(due * (s->pull - before) > 0);
  double drift = s->disturbed && against ? INFINITY : least_change(t, s->noise);
  s->trust.slow = 0;
  trust_drift(&s->trust, pull_by_w(t, s) * c->dx[BY_W], drift);
  /* The result of a move of W for Ioff does not show whether L moved too far.
   */
  int by_l = !corrects_ioff(t) || c->dx[BY_W] == 0;
  if (by_l && !s->disturbed && before * s->pull > 0 &&
      fabs(before) - fabs(foreseen) > least_visible(t, s))
    trust_judge(&s->trust, c->dx[BY_L], fabs(before), fabs(foreseen),
                fabs(s->pull));
  trust_see(&s->trust, s->x[BY_L], s->pull);
  /* W moved because L had no effect: allow one step of L again. */
  if (!corrects_ioff(t) && c->dx[BY_W] != 0)
    s->trust.radius = fmax(s->trust.radius, 1);
}

double width_limit(const transistor *s) {
  return s->outward_limit[0] + s->outward_limit[1];
}

double width_least(const transistor *s) {
  return s->inward_limit[0] + s->inward_limit[1];
}

int32_t width_aside(const transistor *s, int32_t w) {
  int32_t half = w >> 1; /* divided as in eda_moves */
  int32_t least = MAX(s->inward_limit[0], w - s->outward_limit[1]);
  int32_t most = MIN(s->outward_limit[0], w - s->inward_limit[1]);
  return half - MIN(MAX(half, least), most);
}

int width_is_short(const newton *t, const transistor *s) {
  int32_t at[2];
  ends_of(s->valid, at);
  return !t->settled &&
         (at[0] < s->inward_limit[0] || at[1] < s->inward_limit[1]);
}

/* Hold the ends of the width after the regulator has vetoed a narrower gate,
   because an end moved inwards too far. Half of the move since the last mask
   without the veto remains. The present mask is not the best one. */
static void width_hold_ends(transistor *s, uint32_t veto) {
  int32_t at[2];
  ends_of(s->now, at);
  if (!(veto & EDA_VETO_NARROWER)) {
    memcpy(s->free_end, at, sizeof at);
    return;
  }
  for (int high = 0; high < 2; high++)
    if (at[high] < s->free_end[high])
      s->inward_limit[high] = at[high] + (s->free_end[high] - at[high] + 1) / 2;
  if (biases_equal(s->now, s->best)) s->best_size = INFINITY;
}

/* Limit the ends of the width to the region where the printed length does not
   leak. A gate that leaks twice as much as drawn is narrowed by the leaking
   strips at its ends (tuned.thin_end). */
static void bound_ends(const newton *t, transistor *s, const eda_feedback *f,
                       size_t i) {
  double grid = f->gates->grid;
  double leak = t->curve[f->gates->type[i] == EDA_PMOS].slope[IOFF];
  int32_t range = (int32_t)(tuned.longest / grid);
  int32_t at[2];
  ends_of(s->now, at);
  int leaks = s->error[IOFF] > tuned.thin_end[0];
  s->given = 0;
  for (int high = 0; high < 2; high++) {
    int32_t far = at[high] + range, *to = &s->outward_limit[high];
    int32_t thin =
        width_thin_end(f, i, high, far, range, tuned.thin_end[1] / leak);
    *to = thin ? MIN(far - thin, s->print_limit[high]) : s->print_limit[high];
    thin = leaks ? width_thin_end(f, i, high, at[high], range,
                                  tuned.thin_end[0] / leak)
                 : 0;
    /* Keep an end without a thin strip, and an end that is thin all over. */
    if (thin && thin < range) *to = at[high] - thin;
    *to = MAX(*to, s->inward_limit[high]);
    if (thin && thin < range) s->given += MAX(at[high] - *to, 0);
  }
  /* The narrower gate is expected to leak as drawn. */
  if (s->given) s->error[IOFF] = 0;
}

/* Update the state of a transistor from the simulation of mask `now`. `common`:
   change of log Ion common to all transistors of the type. */
static void transistor_update(const newton *t, transistor *s,
                              const eda_feedback *f, size_t i, biases now,
                              double common) {
  const double *target = t->goal[i].target;
  const double x[MOVES] = {mask_length(t, i, now), now.w};
  double error[ERRORS];
  change c;
  int first = f->iteration == 0, moved = !biases_equal(now, s->valid);
  int reshaped = now.aside != s->valid.aside ||
                 memcmp(&now.shape, &s->valid.shape, sizeof now.shape) != 0;
  int prints = errors_of(f, i, target, error);
  int printed = !first && isfinite(s->size);
  int ends = !first && ends_moved(f->gates, s->end, f->end + 2 * i);
  memcpy(s->end, f->end + 2 * i, sizeof s->end);
  s->now = now;
  s->disturbed = (uint8_t)ends;
  if (ends) trust_forget_lost(&s->trust);
  if (first) transistor_init(s, now);
  if (!prints) {
    transistor_fail(s, x, f->flags[i]);
    return;
  }
  for (int m = 0; m < MOVES; m++) c.dx[m] = x[m] - s->x[m];
  for (int k = 0; k < ERRORS; k++) c.de[k] = error[k] - s->error[k];
  c.de[ION] -= common;
  int foreign = f->iteration > 1 && printed && is_foreign(t, s, &c);
  double by_w = pull_by_w(t, s) * c.dx[BY_W];
  double foreseen = s->pull + s->response.by[ION][BY_L] * c.dx[BY_L] + by_w;
  if (foreign)
    s->response = s->first;
  else if (printed && moved && !reshaped)
    response_learn(&s->response, &s->first, c.dx, c.de, s->uncertainty);
  /* A move may have an effect that the response does not predict, so a
     transistor that moved is not disturbed. */
  s->disturbed |= (uint8_t)(foreign && !moved);
  s->failed = 0;
  s->valid = now;
  memcpy(s->x, x, sizeof x);
  memcpy(s->error, error, sizeof error);
  memset(s->excess, 0, sizeof s->excess);
  s->size = errors_size(t, error);
  s->settled_size = first || moved ? s->size : fmin(s->settled_size, s->size);
  s->point = point_of(f->printed, i);
  s->ripple.count = 0;
  response_bend(&s->response, &s->first, s->point, point_of(f->design, i),
                f->gates->grid);
  if (reshaped) trust_forget(&s->trust);
  if (!first) trust_update(t, s, &c, f->iteration > 1 ? foreseen : NAN);
  /* The error of the best mask has increased: the size is no longer valid. */
  int stale =
      biases_equal(now, s->best) && s->best_size < tuned.worthwhile * s->size;
  if (!t->settled || s->disturbed || stale ||
      s->size < tuned.worthwhile * s->best_size)
    s->tries = 0;
  else
    s->tries += (uint8_t)moved;
  keep_best(s, f->flags[i], first);
  width_hold_ends(s, f->vetoes[i]);
  if (corrects_ioff(t) && f->iteration >= tuned.shapes[BALANCED])
    bound_ends(t, s, f, i);
}

/* ---- work: all transistors ---- */

/* Compute the initial responses and the errors. The errors are those expected
   after the next moves of line ends, which the regulator makes in the same
   iteration. */
static void newton_start(newton *t, const eda_feedback *f) {
  curve *curves = t->curve;
  curves_measure(f, curves);
  for (size_t i = 0; i < t->count; i++) {
    transistor *s = &t->state[i];
    const curve *c = &curves[f->gates->type[i] == EDA_PMOS];
    s->first = response_first(f->gates, i, c, t->gain);
    s->response = s->first;
    s->trust.radius = tuned.longest / f->gates->grid;
    s->print_limit[0] = s->print_limit[1] = s->outward_limit[0] =
        s->outward_limit[1] = (int32_t)ceil(t->max_bias / 2 / f->gates->grid);
    s->inward_limit[0] = s->inward_limit[1] = -INT32_MAX / 4;
    if (s->failed) continue;
    if (ends_moved(f->gates, s->end, f->next_end + 2 * i)) {
      double before = s->error[ION];
      errors_with_line_ends(f, i, c, s->error);
      s->size = errors_size(t, s->error);
      s->uncertainty = tuned.least_doubt * fabs(s->error[ION] - before);
    }
    s->pull = pull_of(t, s);
    trust_see(&s->trust, s->x[BY_L], s->pull);
  }
}

/* Sums of a linear fit for one transistor type. x: change of log Ion that the
   response to L predicts for the first moves; y: observed change. */
typedef struct line {
  double n, x, y, xx, xy;
} line;

static void line_fit(const newton *t, const eda_feedback *f,
                     const eda_moves *moves, line of[2]) {
  for (size_t i = 0; i < t->count; i++) {
    const transistor *s = &t->state[i];
    const double *target = t->goal[i].target;
    const biases next = t->state[i].next;
    double error[ERRORS];
    if (!errors_of(f, i, target, error) || isinf(s->size)) continue;
    line *k = &of[f->gates->type[i] == EDA_PMOS];
    double x =
        s->response.by[ION][BY_L] * (mask_length(t, i, next) - s->x[BY_L]);
    double by_w = s->response.by[ION][BY_W] * (moves->w[i] - s->x[BY_W]);
    double y = error[ION] - s->error[ION] - by_w;
    k->xx += x * x, k->xy += x * y, k->x += x, k->y += y, k->n++;
  }
}

/* Update the responses of all transistors of a type after the first moves by a
   linear fit. The slope is a common factor of the responses to L. The
   intercept, common[type], is the change of log Ion common to all. */
static void responses_learn_common(newton *t, const eda_feedback *f,
                                   const eda_moves *moves, double common[2]) {
  line of[2] = {{0}};
  line_fit(t, f, moves, of);
  for (int type = 0; type < 2; type++) {
    line *k = &of[type];
    if (k->n < tuned.many) continue;
    k->xx -= k->x * k->x / k->n;
    k->xy -= k->x * k->y / k->n;
    double factor = k->xx > 0 ? k->xy / k->xx : 1;
    factor = fmin(fmax(factor, 1 / tuned.trust[BY_L]), tuned.trust[BY_L]);
    common[type] = (k->y - factor * k->x) / k->n;
    for (size_t i = 0; i < t->count; i++) {
      if ((f->gates->type[i] == EDA_PMOS) != type) continue;
      response *r = &t->state[i].response;
      for (int e = 0; e < ERRORS; e++) r->by[e][BY_L] *= factor;
      r->doubt[BY_L] = tuned.least_doubt;
    }
  }
  for (size_t i = 0; i < t->count; i++)
    t->state[i].first = t->state[i].response;
}

/* Return the simulated mask of a transistor, which the loop may have changed
   since the request. */
static biases mask_simulated(const newton *t, const eda_moves *moves,
                             size_t i) {
  biases b = {moves->l[i], moves->w[i], moves->jog[i], t->state[i].next.shape,
              moves->aside ? moves->aside[i] : 0};
  return b;
}

/* Arguments of the update, common to all transistors. */
typedef struct update_all {
  newton *t;
  const eda_feedback *f;
  const eda_moves *moves;
  double common[2]; /* by type */
} update_all;

static void transistor_update_one(void *data, size_t i) {
  const update_all *p = data;
  transistor_update(p->t, &p->t->state[i], p->f, i,
                    mask_simulated(p->t, p->moves, i),
                    p->common[p->f->gates->type[i] == EDA_PMOS]);
}

void newton_observe(newton *t, const eda_feedback *f, const eda_moves *moves) {
  update_all p = {.t = t, .f = f, .moves = moves};
  for (size_t i = 0; f->iteration > 0 && i < t->count; i++)
    response_bend(&t->state[i].response, &t->state[i].first, t->state[i].point,
                  point_of(f->printed, i), f->gates->grid);
  if (f->iteration == 1) responses_learn_common(t, f, moves, p.common);
  opc_parallel(t->host->context, t->count, transistor_update_one, &p);
  if (f->iteration == 0) newton_start(t, f);
}

static ripple ripple_next(const newton *t, size_t i, biases to) {
  const transistor *s = &t->state[i];
  const parts *p = &t->parts[i];
  double gain = length_gain(s), blur = tuned.smooth / t->gates->grid;
  ripple r =
      ripple_after(p, &s->ripple, &s->valid.shape, &to.shape, gain, blur);
  const biases of[] = {s->valid, to};
  for (int k = 0; k < 2; k++) {
    double at = length_jog(&t->sides[i], (length){of[k].l, of[k].jog});
    double from = t->sides[i].from[length_side(of[k].l)];
    if (isfinite(at)) ripple_add(p, &r, from, at, k ? gain : -gain, blur);
  }
  return r;
}

void newton_foresee(newton *t, size_t i, biases to) {
  transistor *s = &t->state[i];
  const double *slope = s->response.slope;
  if (!s->ripple.count || s->failed) return;
  ripple after = ripple_next(t, i, to);
  for (int k = ION; k <= IOFF; k++) {
    double excess =
        ripple_excess(&after, slope[k]) - ripple_excess(&s->ripple, slope[k]);
    s->error[k] += excess - s->excess[k];
    s->excess[k] = excess;
  }
  double before = s->pull;
  s->pull = pull_of(t, s);
  s->uncertainty += tuned.least_doubt * fabs(s->pull - before);
  trust_drift(&s->trust, s->pull - before, s->uncertainty);
}

/* The uncertainty is the sum of parts caused by neighbours, line ends and
   shapes. A move of a line end after the first iteration may change Ion by the
   limit. */
void newton_predict(newton *t, const eda_feedback *f) {
  double sum = 0;
  for (size_t i = 0; i < t->count; i++) {
    const transistor *s = &t->state[i];
    const biases next = s->next;
    double d =
        s->response.by[ION][BY_L] * (mask_length(t, i, next) - s->x[BY_L]) +
        s->response.by[ION][BY_W] * (next.w - s->x[BY_W]);
    sum += d * d;
  }
  double mean = sqrt(sum / fmax((double)t->count, 1));
  double noise = tuned.coupling * mean + tuned.noise_floor;
  for (size_t i = 0; i < t->count; i++) {
    transistor *s = &t->state[i];
    const biases next = s->next;
    int late = ends_moved(f->gates, s->end, f->next_end + 2 * i);
    if (f->iteration > 0) s->uncertainty = late ? newton_ion_limit(t) : 0;
    s->uncertainty += noise;
    s->noise = s->uncertainty;
    parts from = mask_parts(t, i, s->valid), to = mask_parts(t, i, next);
    s->uncertainty +=
        tuned.least_doubt *
        fabs(s->response.by[ION][BY_L] * shape_shift(&from, &to, &next.shape));
  }
}

/* ---- work: messages ---- */

void newton_log_unconverged(newton *t, int64_t print) {
  const eda_gates *g = t->gates;
  size_t open = 0, worst = 0;
  if (t->reported || print < t->iterations) return;
  t->reported = 1;
  for (size_t i = 0; i < t->count; i++) {
    const transistor *s = &t->state[i];
    if (s->verdict != MOVING || !(t->goal[i].weight > 0) ||
        s->best_size <= newton_ion_limit(t))
      continue;
    if (!open || s->best_size > t->state[worst].best_size) worst = i;
    open++;
  }
  if (!open) return;
  t->host->log(t->host, OPC_LOG_FINDING,
               "synthesizer.newton: not converged after %d iterations: %zu of "
               "%zu transistors could move further, the worst is %s:%u",
               (int)t->iterations, open, t->count,
               *g->instance[worst] ? g->instance[worst] : g->cell[worst],
               g->number[worst]);
}
