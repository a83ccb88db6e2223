/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements synthesizer.newton: correction of all transistors at once by
   Newton's method. The response of Ion, Ioff and area to moves of the mask is
   estimated from the device curves and then updated from the results of the
   moves (Broyden). A jog in the poly corrects the rounding error of the grid:
   one edge moves by a further grid step over a part of the width. */
#include <eda/goals.h>
#include <eda/memory.h>
#include <math.h>
#include <opcflow/follow.h>
#include <stdlib.h>
#include <string.h>

#include "mask.h"
#include "tuning.h"

/* ---- state ---- */

static const char *const verdicts[VERDICTS] = {
    "within limit",    "grid",
    "bridging",        "bias limit",
    "does not print",  "outside the table",
    "not done",        "Ioff: uneven length",
    "Ioff: bias limit"};

static void newton_clear(void *self) {
  newton *t = self;
  free(t->state);
  free(t->sides);
  free(t->parts);
  free(t->goal);
}

static void newton_follow(newton *t, eda_scanner scanner);

static int newton_begin(void *self, const eda_feedback *f, opc_error *error) {
  newton *t = self;
  newton_follow(t, f->scanner);
  eda_follow_ion_limit(f, &t->ion_limit);
  newton_clear(t);
  t->count = f->gates->count;
  t->rest = t->settled = t->reported = 0;
  if (t->target != PLAIN) {
    t->weight[IOFF] = t->weight[AREA] = tuned.leak;
  }
  t->state = eda_alloc(t->count, sizeof *t->state);
  t->sides = eda_alloc(t->count, sizeof *t->sides);
  t->parts = eda_alloc(t->count, sizeof *t->parts);
  t->goal = eda_alloc(t->count, sizeof *t->goal);
  for (size_t i = 0; i < t->count; i++)
    t->goal[i] = eda_gates_goal(f->gates, i);
  if (!t->goals_path) return OPC_OK;
  return eda_goals_read(t->goals_path, f->gates, t->goal, error);
}

/* ---- work: the next mask of one transistor ---- */

/* Free moves of response_solve. */
static const int only_l[MOVES] = {1, 0}, only_w[MOVES] = {0, 1},
                 both[MOVES] = {1, 1};

/* Return a step dx limited by vetoes and by the bound `most`, the cause in
 *why. */
static double move_bounded(double x, double dx, double most, uint32_t veto_up,
                           uint32_t veto_down, uint8_t *why) {
  if ((dx > 0 && veto_up) || (dx < 0 && veto_down)) {
    *why = BLOCKED;
    return 0;
  }
  double to = fmin(fmax(x + dx, -most), most);
  if (to != x + dx) *why = BIAS;
  return to - x;
}

/* Return the allowed part of a step of W. */
static double width_bounded(const newton *t, const eda_feedback *f, size_t i,
                            uint32_t veto, double dx, uint8_t *why) {
  const transistor *s = &t->state[i];
  dx = move_bounded(s->x[BY_W], dx, width_most(t, f->gates, i),
                    veto & EDA_VETO_WIDER, veto & EDA_VETO_NARROWER, why);
  dx = fmin(dx, fmax(width_limit(s) - s->x[BY_W], 0));
  return fmax(dx, width_least(s) - s->x[BY_W]);
}

/* Compute the moves of W that corrects Ioff and of L that restores Ion. */
static void move_with_leakage(const newton *t, const eda_feedback *f, size_t i,
                              uint32_t veto, double dx[MOVES]) {
  const transistor *s = &t->state[i];
  double step[MOVES], rest[ERRORS], more[MOVES];
  double longest = tuned.longest / f->gates->grid;
  uint8_t why;
  response_solve(&s->response, s->error, t->weight, both, step);
  double w = fmin(fmax(step[BY_W], -longest), longest);
  w = fmin(w - s->given, width_limit(s) - s->x[BY_W]);
  dx[BY_W] = round(width_bounded(t, f, i, veto, w, &why));
  errors_after(s, s->x[BY_L], s->x[BY_W] + dx[BY_W], rest);
  for (int k = 0; k < ERRORS; k++) rest[k] -= s->error[k];
  response_solve(&s->response, rest, t->steer, only_l, more);
  dx[BY_L] += more[BY_L];
}

/* Return whether a move rounds to zero on the grid. */
static int is_no_step(double steps) { return lround(steps) == 0; }

/* Return the mask after Newton's step of one transistor. W moves if the weights
   require moves of W, or if L is vetoed or at its bound. Unless W corrects
   Ioff, it also moves if the regulator undoes moves of L (trust radius below a
   grid step). If W cannot move either, L moves. */
static biases newton_step(const newton *t, const eda_feedback *f, size_t i,
                          double enough, int leakage, uint8_t *why, int *cut) {
  const transistor *s = &t->state[i];
  /* Vetoes of `valid`, where the step after a failure starts, are unknown. */
  uint32_t veto = s->failed ? 0 : f->vetoes[i];
  int free[MOVES], repaired;
  double dx[MOVES], by_w[MOVES], wanted;
  moves_free(t, free);
  repaired = !free[BY_W] && !corrects_ioff(t) && is_no_step(s->trust.radius);
  response_solve(&s->response, s->error, t->steer, free, dx);
  response_solve(&s->response, s->error, t->weight, only_w, by_w);
  wanted = dx[BY_L];
  dx[BY_L] = trust_step(&s->trust, s->x[BY_L], wanted);
  if (repaired &&
      is_no_step(width_bounded(t, f, i, veto, by_w[BY_W], &(uint8_t){0}))) {
    repaired = 0;
    dx[BY_L] = fmin(fmax(wanted, -1), 1);
  }
  *cut = dx[BY_L] != wanted;
  if (leakage) move_with_leakage(t, f, i, veto, dx);
  dx[BY_L] = move_bounded(s->x[BY_L], dx[BY_L], t->max_bias / f->gates->grid,
                          veto & EDA_VETO_LONGER, veto & EDA_VETO_SHORTER, why);
  if (repaired || (*why != MOVING && is_no_step(dx[BY_L])))
    memcpy(dx, by_w, sizeof dx);
  dx[BY_W] = width_bounded(t, f, i, veto, dx[BY_W], why);
  biases next = s->valid;
  if (repaired)
    next.w += (int32_t)lround(dx[BY_W]);
  else
    next = mask_on_grid(t, f, i, dx, enough, *cut && !free[BY_W]);
  next.aside = t->settled ? s->valid.aside : width_aside(s, next.w);
  return next;
}

/* Return the next mask of a transistor that has never printed: longer for an
   open line, shorter for a merged one. A known bracket is bisected. */
static biases mask_search(const newton *t, const eda_feedback *f, size_t i) {
  const transistor *s = &t->state[i];
  double grid = f->gates->grid, step = ceil(tuned.longest / 4 / grid);
  int longer = (f->flags[i] & EDA_PRINT_OPEN) != 0;
  if (!longer && !(f->flags[i] & EDA_PRINT_MERGED)) return s->now;
  uint32_t veto = longer ? EDA_VETO_LONGER : EDA_VETO_SHORTER;
  double l = s->now.l + trust_step(&s->trust, s->now.l, longer ? step : -step);
  if (f->vetoes[i] & veto || fabs(l) > t->max_bias / grid) return s->now;
  return (biases){(int32_t)lround(l), s->now.w, 0, s->now.shape, s->now.aside};
}

/* Choose moves of edge parts for a uniform length. Return 1 if they change. */
static int edges_flatten(newton *t, const eda_feedback *f, size_t i) {
  transistor *s = &t->state[i];
  if (!newton_reshapes(t, f)) return 0;
  const eda_gates *g = f->gates;
  const curve *c = &t->curve[g->type[i] == EDA_PMOS];
  s->next.shape = shape_flat(
      &t->parts[i], &s->ripple, &s->now.shape, c->slope[IOFF], length_gain(s),
      tuned.smooth / g->grid, t->price / 100 / ripple_cost(g->length[i], c),
      (f->vetoes[i] & EDA_VETO_LONGER) != 0);
  if (!memcmp(&s->next.shape, &s->now.shape, sizeof s->next.shape)) return 0;
  newton_foresee(t, i, s->next);
  return 1;
}

/* Return the mask after Newton's step and the size of its predicted errors in
   *hope. The step changes the ripple, and the ripple the errors that the step
   corrects, so the better of two steps is chosen. If neither reduces the
   errors, W stays and L alone corrects Ion. */
static biases mask_after_step(newton *t, const eda_feedback *f, size_t i,
                              double enough, int shaped, double *hope,
                              uint8_t *why, int *cut) {
  transistor *s = &t->state[i];
  biases best = {0};
  int leakage = corrects_ioff(t) && f->iteration > 0;
  int steps = leakage && !s->failed && !shaped ? 3 : 1;
  *hope = INFINITY;
  *why = MOVING;
  *cut = 0;
  for (int k = 0; k < steps && (k < 2 || *hope >= s->size); k++) {
    uint8_t reason = MOVING;
    int is_cut;
    biases next =
        newton_step(t, f, i, enough, leakage && k < 2, &reason, &is_cut);
    if (steps > 1) newton_foresee(t, i, next);
    double size = mask_expected_size(t, i, next);
    if (!(size < *hope)) continue;
    best = next;
    *hope = size;
    *why = reason;
    *cut = is_cut;
  }
  return best;
}

/* Return the next mask to try for one transistor. */
static biases mask_propose(newton *t, const eda_feedback *f, size_t i) {
  transistor *s = &t->state[i];
  double enough = newton_tolerance(t) / t->goal[i].weight, hope;
  const biases stay = s->failed ? s->now : s->valid;
  s->verdict = WITHIN;
  s->next = stay;
  int is_short = width_is_short(t, s);
  if (t->goal[i].weight == 0 || (!s->failed && !is_short && s->size <= enough))
    return stay;
  s->verdict = NO_PRINT;
  if (s->failed && (isinf(s->size) || biases_equal(s->now, s->valid)))
    return mask_search(t, f, i);
  if (corrects_ioff(t) && !s->failed) s->ripple = ripple_of(f, i, &t->parts[i]);
  uint8_t why;
  int cut, shaped = !s->failed && edges_flatten(t, f, i);
  biases next = mask_after_step(t, f, i, enough, shaped, &hope, &why, &cut);
  if (s->failed || shaped) return next;
  s->verdict = MOVING;
  int held = cut && s->size > newton_ion_limit(t) &&
             trust_holds(&s->trust, s->x[BY_L]);
  if ((held || is_short) && !biases_equal(next, stay)) return next;
  /* A line end that moves next changes the errors. Until all settle, an earlier
     mask is then no alternative: its parts may not move again. */
  int late = !t->settled && ends_moved(f->gates, s->end, f->next_end + 2 * i);
  if (!late && s->best_size <= hope && !biases_equal(s->best, stay))
    return s->best;
  double least_gain =
      corrects_ioff(t) || s->size > newton_ion_limit(t) ? 1 : tuned.worthwhile;
  if (!biases_equal(next, stay) && hope <= least_gain * s->size) return next;
  s->verdict = why == MOVING ? GRID : why;
  return stay;
}

/* ---- work: termination ---- */

/* Return whether transistors within the limit stop moving: their further moves
   hardly change their currents, but disturb neighbours and the regulator. */
static int newton_is_late(const newton *t, int64_t print) {
  return t->settled && print > tuned.settled;
}

static int is_within(const newton *t, size_t i) {
  const transistor *s = &t->state[i];
  return !s->failed && s->size * fmin(t->goal[i].weight, 1) <= newton_stop(t);
}

/* Return whether the error has increased since the transistor last moved. */
static int has_drifted(const newton *t, const transistor *s, double weight) {
  return s->size * weight > newton_ion_limit(t) * tuned.odd_limit &&
         s->settled_size < tuned.worthwhile * s->size;
}

/* Return whether to stop: all transistors are within the limit, the error of
   none has increased, and the mean error is small or decreased by less than the
   factor `worthwhile`. After a stop, resume only if the mean error increases by
   that factor. */
static int newton_is_done(newton *t, int64_t print) {
  double worst = 0, mean = 0, before = print ? t->mean : INFINITY;
  int drifted = 0;
  for (size_t i = 0; i < t->count; i++) {
    const transistor *s = &t->state[i];
    double weight = fmin(t->goal[i].weight, 1);
    int bad = s->failed || width_is_short(t, s);
    double size = weight > 0 && bad ? INFINITY : s->size * weight;
    worst = fmax(worst, size);
    mean += size / (double)t->count;
    drifted |= has_drifted(t, s, weight);
  }
  int unchanged = t->rest ? tuned.worthwhile * mean < before
                          : mean > tuned.worthwhile * before;
  t->mean = t->rest ? fmin(mean, before) : mean;
  if (newton_is_late(t, print)) return worst <= newton_stop(t);
  return t->rest = worst <= newton_stop(t) && !drifted &&
                   (mean <= newton_tolerance(t) || unchanged);
}

/* Return each transistor to its best mask and end the correction of Ioff. From
   now on only L moves, and corrects Ion. */
static void newton_settle(newton *t) {
  t->settled = 1;
  t->weight[IOFF] = t->weight[AREA] = 0;
  for (size_t i = 0; i < t->count; i++) {
    transistor *s = &t->state[i];
    int reverted = s->best_size < tuned.worthwhile * s->size &&
                   !biases_equal(s->now, s->best);
    if (reverted) {
      s->failed = 0;
      s->valid = s->best;
      s->x[BY_L] = mask_length(t, i, s->best);
      s->x[BY_W] = s->best.w;
      memcpy(s->error, s->best_error, sizeof s->error);
    }
    /* The ends of the bracket may be of another W. */
    trust_forget(&s->trust);
    s->size = s->settled_size = errors_size(t, s->error);
    s->best_size = reverted ? INFINITY : s->size;
  }
}

/* ---- work: all transistors ---- */

/* Arguments of transistor_decide, common to all transistors. */
typedef struct decision {
  newton *t;
  const eda_feedback *f;
  int done; /* result of newton_is_done */
} decision;

/* Choose the next mask of transistor i. */
static void transistor_decide(void *data, size_t i) {
  const decision *j = data;
  newton *t = j->t;
  transistor *s = &t->state[i];
  int64_t k = j->f->iteration, last = t->iterations;
  biases next = mask_propose(t, j->f, i);
  if (k > last || j->done || (newton_is_late(t, k) && is_within(t, i)))
    s->next = s->now;
  else
    s->next = k == last || s->tries >= tuned.tries ? s->best : next;
  if (corrects_ioff(t)) newton_foresee(t, i, s->next);
}

static int newton_update(void *self, const eda_feedback *f, eda_moves *moves,
                         int *done, opc_error *error) {
  newton *t = self;
  (void)error;
  t->gates = f->gates;
  if (f->iteration == 0) {
    sides_find(f->gates, t->sides);
    for (size_t i = 0; i < t->count; i++)
      t->parts[i] = parts_of(f->gates, i, &t->sides[i], t->min_jog);
  }
  newton_observe(t, f, moves);
  int settles = corrects_ioff(t) && f->iteration == tuned.settled;
  if (settles) newton_settle(t);
  decision j = {t, f, newton_is_done(t, f->iteration) && !settles};
  opc_parallel(t->host->context, t->count, transistor_decide, &j);
  *done = 1;
  for (size_t i = 0; i < t->count; i++) {
    biases next = t->state[i].next;
    if (f->iteration < t->iterations && !biases_equal(next, t->state[i].now))
      *done = 0;
    moves->l[i] = next.l;
    moves->w[i] = next.w;
    moves->jog[i] = next.jog;
    if (moves->aside) moves->aside[i] = next.aside;
    if (!moves->part) continue;
    parts p = mask_parts(t, i, next);
    shape_write(&p, &next.shape, moves->part + EDA_PARTS * i);
  }
  newton_predict(t, f);
  newton_log_unconverged(t, f->iteration);
  return OPC_OK;
}

static const char *newton_verdict(const void *self, size_t gate) {
  const newton *t = self;
  if (gate >= t->count) return NULL;
  const transistor *s = &t->state[gate];
  if (s->outside && isfinite(s->best_size)) return verdicts[OUTSIDE];
  if (!(s->best_size <= newton_ion_limit(t))) return verdicts[s->verdict];
  if (t->target == PLAIN || fabs(s->error[IOFF]) <= tuned.leaks)
    return verdicts[WITHIN];
  double most = fmin(t->max_bias, t->gates->width[gate] / 2);
  int bound = fabs(s->x[BY_W]) * t->gates->grid >= most - t->gates->grid;
  return verdicts[bound ? LEAKS_AT_BOUND : LEAKS];
}

static double newton_target(const void *self, size_t gate) {
  const newton *t = self;
  if (gate >= t->count || t->goal[gate].weight == 0) return NAN;
  return t->goal[gate].target[ION];
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(
        newton, target, .type = OPC_CHOICE, .preset = "balanced",
        .choices = "plain|balanced|full",
        .summary = "corrected quantities. plain: by `weight`, by default Ion; "
                   "balanced: Ion and Ioff; full: Ion, Ioff and the gate area"),
    OPC_PARAMETER(
        newton, price, .type = OPC_REAL, .flags = OPC_AT_LEAST, .unit = "%",
        .summary = "least reduction of the gate area deviation, %, that "
                   "justifies a jog for a uniform length; default: by target"),
    OPC_PARAMETER_NAMED(
        "weight.ion", newton, weight[ION], .type = OPC_REAL,
        .flags = OPC_AT_LEAST,
        .summary = "weight of the squared deviation of Ion; default: 1"),
    OPC_PARAMETER_NAMED(
        "weight.ioff", newton, weight[IOFF], .type = OPC_REAL,
        .flags = OPC_AT_LEAST,
        .summary =
            "weight of the squared deviation of Ioff; above 0, W moves too"),
    OPC_PARAMETER_NAMED("weight.area", newton, weight[AREA], .type = OPC_REAL,
                        .flags = OPC_AT_LEAST,
                        .summary =
                            "weight of the squared deviation of the gate area "
                            "(capacitance); above 0, W moves too"),
    OPC_PARAMETER(
        newton, tolerance, .type = OPC_REAL, .flags = OPC_ABOVE, .unit = "%",
        .preset = "0.05 %",
        .summary =
            "largest weighted deviation at which a transistor is not changed"),
    OPC_PARAMETER(newton, ion_limit, .type = OPC_REAL, .flags = OPC_AT_LEAST,
                  .unit = "%", .follows = "ion_limit of the step",
                  .former = "limit",
                  .summary = "largest allowed |Ion deviation|; the synthesizer "
                             "stops when every transistor is within the limit"),
    OPC_PARAMETER(newton, fine, .type = OPC_CHOICE, .preset = "jog",
                  .choices = "jog|width|none",
                  .summary =
                      "correction of the rounding error of L: by a jog in the "
                      "poly, by the width of the active, or none"),
    OPC_PARAMETER(
        newton, min_jog, .type = OPC_REAL, .flags = OPC_AT_LEAST, .unit = "nm",
        .follows = "0.155 lambda/NA",
        .summary = "least distance of a jog from both ends of the edge"),
    OPC_PARAMETER(newton, iterations, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "16", .min = 1,
                  .max = 1000, .summary = "largest number of moves"),
    EDA_MAX_BIAS(newton),
    OPC_PARAMETER_NAMED("gain.l", newton, gain[BY_L], .type = OPC_REAL,
                        .flags = OPC_ABOVE, .preset = "2.6",
                        .summary = "initial estimate of d printed L / d mask L "
                                   "(mask error enhancement factor)"),
    OPC_PARAMETER_NAMED(
        "gain.w", newton, gain[BY_W], .type = OPC_REAL, .flags = OPC_ABOVE,
        .preset = "1.2",
        .summary = "initial estimate of d printed W / d mask W"),
    OPC_PARAMETER_NAMED("wishes", newton, goals_path, .type = OPC_FILE,
                        .summary =
                            "CSV table of goals of single transistors: columns "
                            "transistor, weight, ion, ioff, area"),
};

/* Compute the defaults of parameters that are not set. */
static void newton_follow(newton *t, eda_scanner scanner) {
  EDA_FOLLOW(t->host, "synthesizer.newton", t, parameters, scanner);
}

/* Weights belong to the plain target; the other targets set their own. */
static int newton_check(void *self, opc_error *error) {
  static const double prices[TARGETS] = {INFINITY, 1, 0.02};
  static const double weights[ERRORS] = {1, 0, 0};
  newton *t = self;
  double sum = 0;
  if (isnan(t->price)) t->price = prices[t->target];
  for (int k = 0; k < ERRORS; k++) {
    if (t->target != PLAIN && !isnan(t->weight[k]))
      return opc_fail(error, OPC_INVALID, "target",
                      "weights require 'target: plain', or { weight: ~ }");
    if (isnan(t->weight[k])) t->weight[k] = weights[k];
    t->steer[k] = t->weight[k];
    sum += t->weight[k];
  }
  if (sum > 0) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "weight.ion", "all weights are 0");
}

/* ---- entry ---- */

static const eda_synthesizer functions = {.begin = newton_begin,
                                          .update = newton_update,
                                          .verdict = newton_verdict,
                                          .flags = EDA_SYNTHESIZER_ENDS_ANYTIME,
                                          .target = newton_target};

OPC_PLUGIN(newton, .id = "synthesizer.newton", .kind = "synthesizer",
           .version = "0.2.0", .licence = "BSD-3-Clause",
           .summary = "Newton's method on all transistors at once, with jogs",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = newton_check,
           .clear = newton_clear, OPC_FUNCTIONS(functions));
