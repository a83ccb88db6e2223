/* SPDX-License-Identifier: BSD-3-Clause */
/* synthesizer.newton: corrects all transistors at once by Newton's method. What
   current, leakage and area of each do when its mask changes is first taken
   from the device curves, then learnt from what the moves did (Broyden). A jog
   in the poly, one edge a grid step further out over part of the width, takes
   away the grid's quantum. */
#include <eda/memory.h>
#include <math.h>
#include <opcflow/plugin.h>
#include <stdlib.h>
#include <string.h>

#include "jog.h"
#include "response.h"
#include "tuning.h"
#include "wishes.h"

/* ---- state ---- */

enum { WITHIN, GRID, BLOCKED, BIAS, NO_PRINT, WORSE, MOVING, VERDICTS };
static const char *const verdicts[VERDICTS] = {
    "within limit",   "grid",      "bridging", "bias limit",
    "does not print", "no better", "not done"};

typedef struct biases {
  int32_t l, w, jog;
} biases;

/* An error is the logarithm of what is printed over what is wanted; the size of
   a transistor's errors is one figure for all three of them (size_of). */
typedef struct transistor {
  biases now;           /* of the mask that was measured last */
  double x[MOVES];      /* its moves in grid steps, the jog as a part of one */
  double error[ERRORS]; /* its errors; at first as they will be once the line
                           ends have moved */
  double size;          /* of them; INFINITY if it did not print */
  biases best;          /* of the mask with the least size so far */
  double best_size;
  double rest_size;         /* the least size since its last move */
  response response, first; /* as learnt, and as estimated at first */
  int32_t end[2];           /* its line ends in the mask measured last */
  double surprise;   /* by how much the next print's log Ion may differ from
                        what the response says, as its line ends and its
                        neighbours have moved */
  uint8_t disturbed; /* the last print changed for reasons other than its
                        own moves */
  uint8_t worse;     /* prints in a row that were no better than the best */
  uint8_t odd;       /* prints that contradicted its moves */
  uint8_t verdict;
} transistor;

enum { JOG, WIDTH, NONE };

typedef struct newton {
  const opc_host *host;
  double weight[ERRORS];
  double tolerance, limit; /* % */
  double gain[MOVES];
  double max_bias, min_jog; /* nm */
  int fine;
  int64_t iterations;
  const char *wishes_path;
  double mean; /* of all sizes at the print before; while all rest, the
                  least so far */
  int rest;    /* nothing was moved at the print before */
  wish *wish;  /* of each transistor */
  transistor *state;
  sides *sides;
  size_t count;
} newton;

/* ---- work: sizes ---- */

static double tolerance(const newton *t) { return t->tolerance / 100; }
static double limit(const newton *t) { return t->limit / 100; }

static int same(biases a, biases b) {
  return a.l == b.l && a.w == b.w && a.jog == b.jog;
}

/* The weighted errors as one figure; it is |error| of one that weighs 1. */
static double size_of(const newton *t, const double error[ERRORS]) {
  double sum = 0;
  for (int k = 0; k < ERRORS; k++) sum += t->weight[k] * error[k] * error[k];
  return sqrt(sum);
}

static double length_in_steps(const newton *t, size_t i, biases b) {
  return length_value(&t->sides[i], (length){b.l, b.jog});
}

static void clear(void *self) {
  newton *t = self;
  free(t->state);
  free(t->sides);
  free(t->wish);
}

static int begin(void *self, const eda_feedback *f, opc_error *error) {
  newton *t = self;
  clear(t);
  t->count = f->gates->count;
  t->rest = 0;
  t->state = eda_alloc(t->count, sizeof *t->state);
  t->sides = eda_alloc(t->count, sizeof *t->sides);
  t->wish = eda_alloc(t->count, sizeof *t->wish);
  for (size_t i = 0; i < t->count; i++) t->wish[i] = (wish){1, 1};
  int code = read_notes(f->gates, t->wish, error);
  if (code || !t->wishes_path) return code;
  return read_wishes(t->wishes_path, f->gates, t->wish, error);
}

/* ---- work: taking in a print ---- */

/* What changed from one print to the next. */
typedef struct change {
  double dx[MOVES], de[ERRORS];
} change;

/* Whether the line ends a and b, [2] each, differ so much that it matters. */
static int ends_moved(const eda_gates *g, const int32_t *a, const int32_t *b) {
  return abs(a[0] - b[0]) * g->grid > tuned.still ||
         abs(a[1] - b[1]) * g->grid > tuned.still;
}

/* Whether a print contradicts the moves. A transistor that was not moved has
   changed by more than could be expected; or a move that should have changed it
   visibly has changed next to nothing. Something else has a hold on it then,
   such as the regulator's mending of its poly. */
static int is_odd(const newton *t, const transistor *s, const change *c) {
  const double *by = s->response.by[ION];
  double visible = limit(t) * tuned.odd_limit, did = fabs(c->de[ION]);
  double due = fabs(by[BY_L] * c->dx[BY_L] + by[BY_W] * c->dx[BY_W]);
  if (due == 0) return did > fmax(visible, tuned.odd_surprise * s->surprise);
  return due > visible && did < due / tuned.unanswered;
}

/* Whether a transistor has changed by more than its moves explain even with the
   largest response that is believed: a patch or a neighbour has changed it. */
static int is_foreign(const newton *t, const transistor *s, const change *c) {
  double most = limit(t) * tuned.odd_limit + tuned.odd_surprise * s->surprise;
  for (int m = 0; m < MOVES; m++)
    most += tuned.trust[m] * fabs(s->first.by[ION][m] * c->dx[m]);
  return fabs(c->de[ION]) > most;
}

/* Keep the best mask. What was the best is so no more if something else has
   changed the transistor since; and if neighbours have made the best one worse,
   the moves away from it were not to blame. */
static void keep_best(const newton *t, transistor *s, int first) {
  if (!first && !s->disturbed && s->size >= s->best_size &&
      !same(s->now, s->best)) {
    s->worse++;
    return;
  }
  if (!same(s->now, s->best) || s->size > s->best_size + tolerance(t))
    s->worse = 0;
  s->best_size = s->size;
  s->best = s->now;
}

/* Take in what the moves to `now` have printed. `common` is by how much the log
   Ion of all transistors of its type changed alike. */
static void observe(const newton *t, transistor *s, const eda_feedback *f,
                    size_t i, biases now, double common) {
  const double target[ERRORS] = {t->wish[i].ion, 1, 1};
  const double x[MOVES] = {length_in_steps(t, i, now), now.w};
  double error[ERRORS];
  change c;
  int first = f->iteration == 0, moved = !same(now, s->now);
  int prints = errors_of(f, i, target, error), printed = isfinite(s->size);
  for (int m = 0; m < MOVES; m++) c.dx[m] = x[m] - s->x[m];
  for (int k = 0; k < ERRORS; k++) c.de[k] = error[k] - s->error[k];
  c.de[ION] -= common;
  int ends = !first && ends_moved(f->gates, s->end, f->end + 2 * i);
  s->odd += f->iteration > tuned.settling && !ends && is_odd(t, s, &c);
  int foreign = f->iteration > 1 && printed && is_foreign(t, s, &c);
  if (foreign)
    s->response = s->first;
  else if (!first && prints && printed && moved)
    learn(&s->response, &s->first, c.dx, c.de, s->surprise);
  s->disturbed = (uint8_t)(ends | foreign);
  memcpy(s->end, f->end + 2 * i, sizeof s->end);
  memcpy(s->x, x, sizeof x);
  memcpy(s->error, error, sizeof error);
  s->now = now;
  s->size = prints ? size_of(t, error) : INFINITY;
  s->rest_size = first || moved ? s->size : fmin(s->rest_size, s->size);
  keep_best(t, s, first);
}

/* ---- work: the next mask of one transistor ---- */

/* What the regulator and the bounds leave of a step; *why if that is less. */
static double bounded(double x, double dx, double longest, double most,
                      uint32_t veto_up, uint32_t veto_down, uint8_t *why) {
  dx = fmin(fmax(dx, -longest), longest);
  if ((dx > 0 && veto_up) || (dx < 0 && veto_down)) {
    *why = BLOCKED;
    return 0;
  }
  double to = fmin(fmax(x + dx, -most), most);
  if (to != x + dx) *why = BIAS;
  return to - x;
}

/* The errors that are left with L and W of the mask, by the response. */
static void left_after(const transistor *s, double l, double w,
                       double rest[ERRORS]) {
  for (int k = 0; k < ERRORS; k++)
    rest[k] = s->error[k] + s->response.by[k][BY_L] * (l - s->x[BY_L]) +
              s->response.by[k][BY_W] * (w - s->x[BY_W]);
}

/* The nearest mask with a jog, for a wanted L. */
static biases with_jog(const newton *t, const eda_gates *g, size_t i, double l,
                       int32_t w) {
  int32_t least = (int32_t)ceil(t->min_jog / g->grid);
  length x = length_nearest(&t->sides[i], l, least);
  return (biases){x.l, w, x.jog};
}

/* A gate may be so narrow that its nearest jog leaves too much. `best` is the
   mask with it; look whether one with a W of a step more or less, and the jog
   that goes with it, leaves less. */
static biases with_width(const newton *t, const eda_feedback *f, size_t i,
                         biases best) {
  static const int only_l[MOVES] = {1, 0};
  const transistor *s = &t->state[i];
  double rest[ERRORS], more[MOVES], grid = f->gates->grid;
  double most = fmin(t->max_bias, f->gates->width[i] / 2) / grid;
  double enough = fmax(limit(t), tuned.coarse * tolerance(t));
  biases found = best;
  left_after(s, length_in_steps(t, i, best), best.w, rest);
  double least = size_of(t, rest);
  if (least <= enough / t->wish[i].weight) return best;
  for (int step = -1; step <= 1; step += 2) {
    uint32_t veto = step > 0 ? EDA_VETO_WIDER : EDA_VETO_NARROWER;
    int32_t w = best.w + step;
    if (f->vetoes[i] & veto || abs(w) > most) continue;
    left_after(s, s->x[BY_L], w, rest);
    solve(&s->response, rest, t->weight, only_l, more);
    veto = more[BY_L] > 0 ? EDA_VETO_LONGER : EDA_VETO_SHORTER;
    double l = s->x[BY_L] + more[BY_L];
    if (f->vetoes[i] & veto || fabs(l) > t->max_bias / grid) continue;
    biases next = with_jog(t, f->gates, i, l, w);
    left_after(s, length_in_steps(t, i, next), w, rest);
    if (size_of(t, rest) >= least) continue;
    least = size_of(t, rest);
    found = next;
  }
  return found;
}

/* The mask on the grid for a wanted move of L and W. L makes good what rounding
   W leaves; a jog or W makes good what rounding L leaves, as `fine` says. */
static biases on_grid(const newton *t, const eda_feedback *f, size_t i,
                      const double dx[MOVES], double enough) {
  static const int only_l[MOVES] = {1, 0}, only_w[MOVES] = {0, 1};
  const transistor *s = &t->state[i];
  double rest[ERRORS], more[MOVES];
  int32_t w = (int32_t)lround(s->x[BY_W] + dx[BY_W]);
  double l = s->x[BY_L] + dx[BY_L];
  left_after(s, l, w, rest);
  solve(&s->response, rest, t->weight, only_l, more);
  if (dx[BY_L] != 0) l += fmin(fmax(more[BY_L], -1), 1);
  int32_t whole = (int32_t)lround(l);
  left_after(s, whole, w, rest);
  if (t->fine == NONE || (t->fine == JOG && size_of(t, rest) <= enough))
    return (biases){whole, w, 0};
  if (t->fine == JOG)
    return with_width(t, f, i, with_jog(t, f->gates, i, l, w));
  solve(&s->response, rest, t->weight, only_w, more);
  return (biases){whole, w + (int32_t)lround(more[BY_W]), 0};
}

/* The size of the errors that a mask is expected to have: what the response
   says, and how wrong that may be. */
static double expected(const newton *t, size_t i, biases next) {
  const transistor *s = &t->state[i];
  const response *r = &s->response;
  double rest[ERRORS], wrong[ERRORS], l = length_in_steps(t, i, next);
  left_after(s, l, next.w, rest);
  for (int k = 0; k < ERRORS; k++)
    wrong[k] = hypot(r->doubt[BY_L] * r->by[k][BY_L] * (l - s->x[BY_L]),
                     r->doubt[BY_W] * r->by[k][BY_W] * (next.w - s->x[BY_W]));
  return hypot(size_of(t, rest), size_of(t, wrong));
}

/* Newton's step of one transistor. W moves if its weights ask for it, and else
   only where L is of no use: forbidden, at its bound, or mended by the
   regulator whatever it is. */
static biases newton_step(const newton *t, const eda_feedback *f, size_t i,
                          double enough, uint8_t *why) {
  static const int only_w[MOVES] = {0, 1};
  const transistor *s = &t->state[i];
  const eda_gates *g = f->gates;
  uint32_t veto = f->vetoes[i];
  double most_w = fmin(t->max_bias, g->width[i] / 2) / g->grid;
  int free[MOVES] = {1, t->weight[IOFF] > 0 || t->weight[AREA] > 0};
  int mended = s->odd >= tuned.most_odd;
  double dx[MOVES];
  solve(&s->response, s->error, t->weight, free, dx);
  dx[BY_L] = bounded(s->x[BY_L], dx[BY_L], tuned.longest[BY_L] / g->grid,
                     t->max_bias / g->grid, veto & EDA_VETO_LONGER,
                     veto & EDA_VETO_SHORTER, why);
  if (mended || (*why != MOVING && fabs(dx[BY_L]) < tuned.w_alone))
    solve(&s->response, s->error, t->weight, only_w, dx);
  dx[BY_W] =
      bounded(s->x[BY_W], dx[BY_W], tuned.longest[BY_W] / g->grid, most_w,
              veto & EDA_VETO_WIDER, veto & EDA_VETO_NARROWER, why);
  if (mended)
    return (biases){s->now.l, s->now.w + (int32_t)lround(dx[BY_W]), s->now.jog};
  return on_grid(t, f, i, dx, enough);
}

/* The next mask of a transistor that does not print: a wider line, if it is the
   poly that is open. */
static biases widen(const newton *t, const eda_feedback *f, size_t i) {
  const transistor *s = &t->state[i];
  double grid = f->gates->grid;
  int32_t step = (int32_t)ceil(tuned.open_step / grid);
  if (!(f->flags[i] & EDA_PRINT_OPEN) || s->now.l + step > t->max_bias / grid)
    return s->now;
  return (biases){s->now.l + step, s->now.w, 0};
}

/* What to try next of one transistor. */
static biases propose(const newton *t, const eda_feedback *f, size_t i) {
  transistor *s = &t->state[i];
  double enough = tolerance(t) / t->wish[i].weight;
  s->verdict = WITHIN;
  if (s->size <= enough || t->wish[i].weight == 0) return s->now;
  s->verdict = NO_PRINT;
  if (isinf(s->size)) return widen(t, f, i);
  s->verdict = WORSE;
  if (s->worse >= tuned.most_worse) return s->best;
  uint8_t why = MOVING;
  biases next = newton_step(t, f, i, enough, &why);
  double hope = expected(t, i, next);
  s->verdict = MOVING;
  if (s->best_size <= hope && !same(s->best, s->now)) return s->best;
  if (hope <= tuned.worthwhile * s->size) return next;
  s->verdict = why == MOVING ? GRID : why;
  return s->now;
}

/* ---- work: all transistors ---- */

/* The first responses, and the errors as they will be once the line ends have
   moved: the regulator moves them together with the first moves. */
static void start(newton *t, const eda_feedback *f) {
  curve curves[2];
  curves_from(f, curves);
  for (size_t i = 0; i < t->count; i++) {
    transistor *s = &t->state[i];
    const curve *c = &curves[f->gates->type[i] == EDA_PMOS];
    s->first = first_response(f->gates, i, c, t->gain);
    s->response = s->first;
    if (!ends_moved(f->gates, s->end, f->next_end + 2 * i)) continue;
    double before = s->error[ION];
    with_line_ends(f, i, c, s->error);
    s->size = size_of(t, s->error);
    s->surprise = tuned.unforeseen * fabs(s->error[ION] - before);
  }
}

/* A straight line through what the first moves should have done to log Ion by
   the response to L (x) and what they did (y), of one type. */
typedef struct line {
  double n, x, y, xx, xy;
} line;

static void fit(const newton *t, const eda_feedback *f, const eda_moves *moves,
                line of[2]) {
  for (size_t i = 0; i < t->count; i++) {
    const transistor *s = &t->state[i];
    const double target[ERRORS] = {t->wish[i].ion, 1, 1};
    const biases next = {moves->l[i], moves->w[i], moves->jog[i]};
    double error[ERRORS];
    if (!errors_of(f, i, target, error) || isinf(s->size)) continue;
    line *k = &of[f->gates->type[i] == EDA_PMOS];
    double x =
        s->response.by[ION][BY_L] * (length_in_steps(t, i, next) - s->x[BY_L]);
    double by_w = s->response.by[ION][BY_W] * (moves->w[i] - s->x[BY_W]);
    double y = error[ION] - s->error[ION] - by_w;
    k->xx += x * x, k->xy += x * y, k->x += x, k->y += y, k->n++;
  }
}

/* After the first moves all transistors of a type learn together: the slope of
   their line becomes a factor on all responses to L, and what it says of no
   move, common[type], is what happened to all of them alike. */
static void learn_together(newton *t, const eda_feedback *f,
                           const eda_moves *moves, double common[2]) {
  line of[2] = {{0}};
  fit(t, f, moves, of);
  for (int type = 0; type < 2; type++) {
    line *k = &of[type];
    if (k->n < tuned.many) continue;
    k->xx -= k->x * k->x / k->n;
    k->xy -= k->x * k->y / k->n;
    double factor = k->xx > 0 ? k->xy / k->xx : 1;
    factor = fmin(fmax(factor, 1 / tuned.gain_bound), tuned.gain_bound);
    common[type] = (k->y - factor * k->x) / k->n;
    for (size_t i = 0; i < t->count; i++) {
      if ((f->gates->type[i] == EDA_PMOS) != type) continue;
      response *r = &t->state[i].response;
      for (int e = 0; e < ERRORS; e++) r->by[e][BY_L] *= factor;
      r->doubt[BY_L] = tuned.doubt_of_many;
    }
  }
  for (size_t i = 0; i < t->count; i++)
    t->state[i].first = t->state[i].response;
}

/* How much the moves to come may surprise: neighbours share a part of the mean
   change of log Ion that they make, and line ends may move. */
static void foresee(newton *t, const eda_feedback *f, const eda_moves *moves) {
  double sum = 0;
  for (size_t i = 0; i < t->count; i++) {
    const transistor *s = &t->state[i];
    const biases next = {moves->l[i], moves->w[i], moves->jog[i]};
    double d =
        s->response.by[ION][BY_L] * (length_in_steps(t, i, next) - s->x[BY_L]) +
        s->response.by[ION][BY_W] * (next.w - s->x[BY_W]);
    sum += d * d;
  }
  double mean = sqrt(sum / fmax((double)t->count, 1));
  double noise = tuned.coupling * mean + tuned.noise_floor;
  for (size_t i = 0; i < t->count; i++) {
    transistor *s = &t->state[i];
    int late = ends_moved(f->gates, s->end, f->next_end + 2 * i);
    if (f->iteration > 0) s->surprise = late ? tuned.late : 0;
    s->surprise += noise;
  }
}

/* Whether something else has made a transistor worse while it was at rest. */
static int has_drifted(const newton *t, const transistor *s, double weight) {
  return s->size * weight > limit(t) * tuned.odd_limit &&
         s->rest_size < tuned.worthwhile * s->size;
}

/* Whether to rest: all transistors are within the limit, none has drifted off,
   and their mean is good or has hardly fallen since the print before. Once they
   rest they go on resting unless the mean has risen as much. */
static int is_good(newton *t, int first) {
  double worst = 0, mean = 0, before = first ? INFINITY : t->mean;
  int drifted = 0;
  for (size_t i = 0; i < t->count; i++) {
    const transistor *s = &t->state[i];
    double weight = fmin(t->wish[i].weight, 1), size = s->size * weight;
    worst = fmax(worst, size);
    mean += size / (double)t->count;
    drifted |= has_drifted(t, s, weight);
  }
  int stands = t->rest ? tuned.worthwhile * mean < before
                       : mean > tuned.worthwhile * before;
  t->mean = t->rest ? fmin(mean, before) : mean;
  return t->rest = worst <= limit(t) && !drifted &&
                   (mean <= limit(t) / tuned.mean_part || stands);
}

/* What becomes of transistor i, `good` being what is_good says. *done = 0 if it
   is not settled. */
static biases decide(const newton *t, const eda_feedback *f, size_t i, int good,
                     int *done) {
  const transistor *s = &t->state[i];
  biases next = propose(t, f, i);
  int64_t k = f->iteration;
  if (good) return s->now;
  if (k == t->iterations) return s->best;
  if (k > t->iterations) {
    /* The regulator is not done: those that it moved follow, for a while. */
    double most = tuned.patience * (double)t->iterations;
    return s->disturbed && (double)k <= most ? next : s->now;
  }
  if (!same(next, s->now)) *done = 0;
  return next;
}

static int update(void *self, const eda_feedback *f, eda_moves *moves,
                  int *done, opc_error *error) {
  newton *t = self;
  double common[2] = {0};
  (void)error;
  if (f->iteration == 0) sides_find(f->gates, t->sides);
  if (f->iteration == 1) learn_together(t, f, moves, common);
  for (size_t i = 0; i < t->count; i++)
    observe(t, &t->state[i], f, i,
            (biases){moves->l[i], moves->w[i], moves->jog[i]},
            common[f->gates->type[i] == EDA_PMOS]);
  if (f->iteration == 0) start(t, f);
  *done = 1;
  int good = is_good(t, f->iteration == 0);
  for (size_t i = 0; i < t->count; i++) {
    biases next = decide(t, f, i, good, done);
    moves->l[i] = next.l;
    moves->w[i] = next.w;
    moves->jog[i] = next.jog;
  }
  foresee(t, f, moves);
  return OPC_OK;
}

static const char *verdict(const void *self, size_t gate) {
  const newton *t = self;
  if (gate >= t->count) return NULL;
  const transistor *s = &t->state[gate];
  return verdicts[s->best_size <= limit(t) ? WITHIN : s->verdict];
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER_NAMED("weight.ion", newton, weight[ION], .type = OPC_REAL,
                        .flags = OPC_AT_LEAST, .preset = "1",
                        .summary = "weight of the squared deviation of Ion"),
    OPC_PARAMETER_NAMED(
        "weight.ioff", newton, weight[IOFF], .type = OPC_REAL,
        .flags = OPC_AT_LEAST, .preset = "0",
        .summary = "weight of that of Ioff; W moves, too, if it is not 0"),
    OPC_PARAMETER_NAMED("weight.area", newton, weight[AREA], .type = OPC_REAL,
                        .flags = OPC_AT_LEAST, .preset = "0",
                        .summary = "weight of that of the gate area, its "
                                   "capacitance; W moves, too, if it is not 0"),
    OPC_PARAMETER(newton, tolerance, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "%", .preset = "0.05 %",
                  .summary = "a transistor whose weighted deviations are at "
                             "most this is left alone"),
    OPC_PARAMETER(newton, limit, .type = OPC_REAL, .flags = OPC_AT_LEAST,
                  .unit = "%", .preset = "0.5 %",
                  .summary = "the end, once no transistor deviates by more"),
    OPC_PARAMETER(newton, fine, .type = OPC_CHOICE, .preset = "jog",
                  .choices = "jog|width|none",
                  .summary = "what takes away the grid's quantum of L: a jog "
                             "in the poly, the width of the active, nothing"),
    OPC_PARAMETER(newton, min_jog, .type = OPC_REAL, .flags = OPC_AT_LEAST,
                  .unit = "nm", .preset = "40 nm",
                  .summary = "a jog stays this far from both ends of its edge"),
    OPC_PARAMETER(newton, iterations, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "10", .min = 1,
                  .max = 1000, .summary = "moves at most"),
    OPC_PARAMETER(
        newton, max_bias, .type = OPC_REAL, .flags = OPC_ABOVE, .unit = "nm",
        .preset = "80 nm",
        .summary =
            "largest correction of L or of W, and no more than half of W"),
    OPC_PARAMETER_NAMED(
        "gain.l", newton, gain[BY_L], .type = OPC_REAL, .flags = OPC_ABOVE,
        .preset = "2.6",
        .summary = "printed change of L for a change of the mask's, as a first "
                   "guess (the mask error factor)"),
    OPC_PARAMETER_NAMED(
        "gain.w", newton, gain[BY_W], .type = OPC_REAL, .flags = OPC_ABOVE,
        .preset = "1.2",
        .summary =
            "printed change of W for a change of the mask's, as a first guess"),
    OPC_PARAMETER_NAMED(
        "wishes", newton, wishes_path, .type = OPC_FILE,
        .summary =
            "what single transistors want: CSV of transistor, weight, ion"),
};

static int check(void *self, opc_error *error) {
  const newton *t = self;
  if (t->weight[ION] + t->weight[IOFF] + t->weight[AREA] > 0) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "weight.ion", "all weights are 0");
}

/* ---- entry ---- */

static const eda_synthesizer functions = {
    .begin = begin,
    .update = update,
    .verdict = verdict,
    .flags = EDA_SYNTHESIZER_ENDS_ANYTIME};

OPC_PLUGIN(newton, .id = "synthesizer.newton", .kind = "synthesizer",
           .version = "0.2.0", .licence = "BSD-3-Clause",
           .summary = "Newton's method on all transistors at once, with jogs",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = check, .clear = clear,
           OPC_FUNCTIONS(functions));
