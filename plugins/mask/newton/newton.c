/* SPDX-License-Identifier: BSD-3-Clause */
/* mask.newton: all transistors at once by Newton's method. What each one's
   current, leakage and area do when its mask changes is first taken from the
   device curves, then from what the moves did (Broyden). A jog in the poly, one
   edge a grid step further out over part of the width, takes away the grid's
   quantum. */
#include "jog.h"
#include "response.h"
#include "wishes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

enum { WITHIN, GRID, BLOCKED, BIAS, NO_PRINT, WORSE, MOVING, VERDICTS };
static const char *const verdicts[VERDICTS] = {
    "within limit", "grid",  "bridging", "bias limit",
    "does not print", "no better", "not done"};

typedef struct biases {
  int32_t l, w, jog;
} biases;

typedef struct transistor {
  biases now, best;       /* measured last; with the least error so far */
  double x[MOVES], error[ERRORS];   /* of `now`; the errors as they will be once
                                       the line ends have moved */
  double size, best_size; /* of the errors, see size_of */
  double rest_size;       /* the least since its last move */
  response response, first;
  int32_t end[2];         /* the line ends of `now` */
  double surprise;        /* what line ends and neighbours may add to the next
                             print's log Ion */
  uint8_t disturbed;      /* its line ends have moved with the last print, or
                             something else has a hold on it */
  uint8_t worse;          /* times that a move was no better */
  uint8_t mended;         /* times that it changed at rest, or moved in vain */
  uint8_t verdict;
} transistor;

enum { JOG, WIDTH, NONE };

typedef struct newton {
  const opc_host *host;
  double weight[ERRORS];
  double tolerance;       /* as a part of 1 */
  double gain[MOVES];
  double max_bias, min_jog;   /* nm */
  int64_t fine;
  double limit;           /* the same */
  double mean;            /* of the sizes, of the print before or the least since
                             all rest */
  int rest;               /* nothing has been moved at the print before */
  uint32_t iterations;
  const char *wishes_path;
  wish *wish;             /* of each transistor */
  transistor *state;
  sides *sides;           /* of each transistor */
  size_t count;
} newton;

/* A response stays within this factor of the first estimate, which is good for
   W: what a change of W does is known. */
static const double trust[MOVES] = {4, 1.5};

/* The longest step of L and W at a time, nm: beyond, the response is another. */
static const double longest[MOVES] = {20, 60};

/* A line end that moves further, nm, changes the transistor. */
static const double still = 2;

/* So many transistors of a type tell a common trend from their own; and how
   well each one's response is known then. */
static const double many = 16, doubt_of_many = 0.15;

/* How far along an edge the print smooths a step of it, nm: some quarter of the
   resolution. */
static const double blur = 60;

/* What neighbours add to an error, as a part of what moves did to them; what a
   moved line end adds beyond what was foreseen, as a part of that; what one does
   that moves late; and what is never known. */
static const double coupling = 0.1, unforeseen = 0.15, late = 0.01,
                    noise_floor = 1e-4;

/* W makes good what jogs leave beyond so many times the tolerance. */
static const double coarse = 10;

/* A move is worth it if this part of the error is likely to be left at most. */
static const double worthwhile = 0.8;

/* So many moves that were no better are enough; and after so many odd prints the
   regulator is taken to mend the poly whatever it is, and W moves instead. */
enum { ENOUGH = 4, MENDED = 2 };

/* Before, neighbours move so much that odd prints mean nothing. */
static const uint32_t settling = 4;

/* ---- work ---- */

static int begin(void *self, const opc_feedback *f, opc_error *error) {
  newton *t = self;
  free(t->state);
  free(t->sides);
  free(t->wish);
  t->count = f->gates->count;
  t->rest = 0;
  t->state = calloc(t->count + 1, sizeof *t->state);
  t->sides = calloc(t->count + 1, sizeof *t->sides);
  t->wish = calloc(t->count + 1, sizeof *t->wish);
  if (!t->state || !t->sides || !t->wish)
    return t->host->fail(t->host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < t->count; i++) t->wish[i] = (wish){1, 1};
  int code = read_notes(t->host, f->gates, t->wish, error);
  if (code || !t->wishes_path) return code;
  return read_wishes(t->host, t->wishes_path, f->gates, t->wish, error);
}

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

/* Whether line ends moved from a to b, [2] each. */
static int ends_moved(const opc_gates *g, const int32_t *a, const int32_t *b) {
  return abs(a[0] - b[0]) * g->grid > still || abs(a[1] - b[1]) * g->grid > still;
}

/* Whether something else than the moves has a hold on a transistor: half the
   limit and more came from nowhere, or was to come and did not. */
static int is_odd(const newton *t, const transistor *s, const double dx[MOVES],
                  double did) {
  const double *by = s->response.by[ION];
  double due = fabs(by[BY_L] * dx[BY_L] + by[BY_W] * dx[BY_W]);
  if (due == 0) return fabs(did) > fmax(t->limit / 2, 2 * s->surprise);
  return due > t->limit / 2 && fabs(did) < due / 10;
}

/* Whether more has come to a transistor than its moves can explain by whatever
   response: a patch or a neighbour has changed it. */
static int is_foreign(const newton *t, const transistor *s,
                      const double dx[MOVES], double did) {
  double most = t->limit / 2 + 2 * s->surprise;
  for (int m = 0; m < MOVES; m++)
    most += trust[m] * fabs(s->first.by[ION][m] * dx[m]);
  return fabs(did) > most;
}

/* Take in the measurement of the moves that were made. `common` is what
   happened to the log Ion of all transistors alike. */
static void observe(const newton *t, transistor *s, const opc_feedback *f,
                    size_t i, biases now, double common) {
  double error[ERRORS], x[MOVES], dx[MOVES], de[ERRORS];
  const double target[ERRORS] = {t->wish[i].ion, 1, 1};
  int prints = errors_of(f, i, target, error), first = f->iteration == 0;
  x[BY_L] = length_in_steps(t, i, now);
  x[BY_W] = now.w;
  for (int m = 0; m < MOVES; m++) dx[m] = x[m] - s->x[m];
  for (int k = 0; k < ERRORS; k++) de[k] = error[k] - s->error[k];
  de[ION] -= common;
  s->disturbed = !first && ends_moved(f->gates, s->end, f->end + 2 * i);
  memcpy(s->end, f->end + 2 * i, sizeof s->end);
  s->mended += f->iteration > settling && !s->disturbed &&
               is_odd(t, s, dx, de[ION]);
  int foreign = f->iteration > 1 && isfinite(s->size) &&
                is_foreign(t, s, dx, de[ION]);
  int moved = !same(now, s->now);
  if (foreign) s->response = s->first;
  else if (!first && prints && isfinite(s->size) && moved)
    learn(&s->response, &s->first, trust, dx, de, s->surprise);
  s->disturbed |= (uint8_t)foreign;
  memcpy(s->x, x, sizeof x);
  memcpy(s->error, error, sizeof error);
  s->now = now;
  s->size = prints ? size_of(t, error) : INFINITY;
  s->rest_size = first || moved ? s->size : fmin(s->rest_size, s->size);
  /* A state that was the best is so no more if something else has changed it;
     and if neighbours have, the moves were not to blame. */
  if (first || s->disturbed || s->size < s->best_size || same(now, s->best)) {
    if (!same(now, s->best) || s->size > s->best_size + t->tolerance)
      s->worse = 0;
    s->best_size = s->size;
    s->best = now;
  } else {
    s->worse++;
  }
}

/* What of a step the regulator and the bounds leave; *why if it is less. */
static double bounded(double x, double dx, double longest_step, double limit,
                      uint32_t veto_up, uint32_t veto_down, uint8_t *why) {
  dx = fmin(fmax(dx, -longest_step), longest_step);
  if ((dx > 0 && veto_up) || (dx < 0 && veto_down)) {
    *why = BLOCKED;
    return 0;
  }
  double to = fmin(fmax(x + dx, -limit), limit);
  if (to != x + dx) *why = BIAS;
  return to - x;
}

/* The errors that are left after a move, by the response. */
static void left_after(const transistor *s, double l, double w,
                       double rest[ERRORS]) {
  for (int k = 0; k < ERRORS; k++)
    rest[k] = s->error[k] + s->response.by[k][BY_L] * (l - s->x[BY_L]) +
              s->response.by[k][BY_W] * (w - s->x[BY_W]);
}

/* The nearest mask with a jog, for a wanted L. */
static biases with_jog(const newton *t, const opc_gates *g, size_t i, double l,
                       int32_t w) {
  length x = length_nearest(&t->sides[i], l, (int32_t)ceil(t->min_jog / g->grid));
  return (biases){x.l, w, x.jog};
}

/* Where jogs may not lie, nothing may be near enough but with another W. */
static biases with_width(const newton *t, const opc_feedback *f, size_t i,
                         biases best) {
  static const int only_l[MOVES] = {1, 0};
  const transistor *s = &t->state[i];
  double rest[ERRORS], more[MOVES];
  double most = fmin(t->max_bias, f->gates->width[i] / 2) / f->gates->grid;
  biases found = best;
  left_after(s, length_in_steps(t, i, best), best.w, rest);
  double least = size_of(t, rest);
  if (least <= fmax(t->limit, coarse * t->tolerance) / t->wish[i].weight)
    return best;
  for (int step = -1; step <= 1; step += 2) {
    uint32_t veto = step > 0 ? OPC_VETO_WIDER : OPC_VETO_NARROWER;
    int32_t w = best.w + step;
    if (f->vetoes[i] & veto || abs(w) > most) continue;
    left_after(s, s->x[BY_L], w, rest);
    solve(&s->response, rest, t->weight, only_l, more);
    if (f->vetoes[i] & (more[BY_L] > 0 ? OPC_VETO_LONGER : OPC_VETO_SHORTER) ||
        fabs(s->x[BY_L] + more[BY_L]) > t->max_bias / f->gates->grid)
      continue;
    biases next = with_jog(t, f->gates, i, s->x[BY_L] + more[BY_L], w);
    left_after(s, length_in_steps(t, i, next), w, rest);
    if (size_of(t, rest) >= least) continue;
    least = size_of(t, rest);
    found = next;
  }
  return found;
}

/* The mask to try next for a wanted move of L and W: on the grid. */
static biases on_grid(const newton *t, const opc_feedback *f, size_t i,
                      const double dx[MOVES], double tolerance) {
  static const int only_l[MOVES] = {1, 0}, only_w[MOVES] = {0, 1};
  const opc_gates *g = f->gates;
  const transistor *s = &t->state[i];
  double rest[ERRORS], more[MOVES];
  int32_t w = (int32_t)lround(s->x[BY_W] + dx[BY_W]);
  double l = s->x[BY_L] + dx[BY_L];
  /* W's rounding is made good by L, and L's by what the flow asks for. */
  left_after(s, l, w, rest);
  solve(&s->response, rest, t->weight, only_l, more);
  if (dx[BY_L] != 0) l += fmin(fmax(more[BY_L], -1), 1);
  int32_t whole = (int32_t)lround(l);
  left_after(s, whole, w, rest);
  if (t->fine == NONE || (t->fine == JOG && size_of(t, rest) <= tolerance))
    return (biases){whole, w, 0};
  if (t->fine == JOG) return with_width(t, f, i, with_jog(t, g, i, l, w));
  solve(&s->response, rest, t->weight, only_w, more);
  return (biases){whole, w + (int32_t)lround(more[BY_W]), 0};
}

/* The size of the errors to be expected of a mask: what the response leaves,
   and what it may be wrong by. */
static double expected(const newton *t, size_t i, biases next) {
  const transistor *s = &t->state[i];
  double rest[ERRORS], wrong[ERRORS];
  double l = length_in_steps(t, i, next);
  left_after(s, l, next.w, rest);
  for (int k = 0; k < ERRORS; k++)
    wrong[k] = hypot(s->response.doubt[BY_L] * s->response.by[k][BY_L] *
                         (l - s->x[BY_L]),
                     s->response.doubt[BY_W] * s->response.by[k][BY_W] *
                         (next.w - s->x[BY_W]));
  return hypot(size_of(t, rest), size_of(t, wrong));
}

/* Newton's step of one transistor. */
static biases newton_step(const newton *t, const opc_feedback *f, size_t i,
                          double tolerance, uint8_t *why) {
  static const int only_w[MOVES] = {0, 1};
  const transistor *s = &t->state[i];
  const opc_gates *g = f->gates;
  uint32_t veto = f->vetoes[i];
  double limit[MOVES] = {t->max_bias / g->grid,
                         fmin(t->max_bias, g->width[i] / 2) / g->grid};
  int free[MOVES] = {1, t->weight[IOFF] > 0 || t->weight[AREA] > 0};
  double dx[MOVES];
  solve(&s->response, s->error, t->weight, free, dx);
  dx[BY_L] = bounded(s->x[BY_L], dx[BY_L], longest[BY_L] / g->grid, limit[BY_L],
                     veto & OPC_VETO_LONGER, veto & OPC_VETO_SHORTER, why);
  int mended = s->mended >= MENDED;
  if (mended || (*why != MOVING && fabs(dx[BY_L]) < 0.5))   /* W alone */
    solve(&s->response, s->error, t->weight, only_w, dx);
  dx[BY_W] = bounded(s->x[BY_W], dx[BY_W], longest[BY_W] / g->grid, limit[BY_W],
                     veto & OPC_VETO_WIDER, veto & OPC_VETO_NARROWER, why);
  if (mended)
    return (biases){s->now.l, s->now.w + (int32_t)lround(dx[BY_W]), s->now.jog};
  return on_grid(t, f, i, dx, tolerance);
}

/* What to try next of one transistor. */
static biases propose(const newton *t, const opc_feedback *f, size_t i) {
  transistor *s = &t->state[i];
  double tolerance = t->tolerance / t->wish[i].weight;
  s->verdict = WITHIN;
  if (s->size <= tolerance || t->wish[i].weight == 0) return s->now;
  if (isinf(s->size)) {   /* open: a wider line, and look again */
    s->verdict = NO_PRINT;
    int32_t step = (int32_t)ceil(5 / f->gates->grid);
    if (!(f->flags[i] & OPC_PRINT_OPEN) ||
        s->now.l + step > t->max_bias / f->gates->grid)
      return s->now;
    return (biases){s->now.l + step, s->now.w, 0};
  }
  s->verdict = WORSE;
  if (s->worse >= ENOUGH) return s->best;
  uint8_t why = MOVING;
  biases next = newton_step(t, f, i, tolerance, &why);
  double hope = expected(t, i, next);
  s->verdict = MOVING;
  if (s->best_size <= hope && !same(s->best, s->now)) return s->best;
  if (hope <= worthwhile * s->size) return next;
  s->verdict = why == MOVING ? GRID : why;
  return s->now;
}

static void start(newton *t, const opc_feedback *f) {
  curve curves[2];
  curves_from(f, curves);
  for (size_t i = 0; i < t->count; i++) {
    transistor *s = &t->state[i];
    const curve *c = &curves[f->gates->type[i] == OPC_PMOS];
    s->first = first_response(f->gates, i, c, t->gain);
    s->response = s->first;
    if (!OPC_HAS(f, next_end) ||
        !ends_moved(f->gates, s->end, f->next_end + 2 * i))
      continue;
    double before = s->error[ION];
    with_line_ends(f, i, c, s->error);
    s->size = size_of(t, s->error);
    s->surprise = unforeseen * fabs(s->error[ION] - before);
  }
}

/* What the first moves did to the currents of each type, against what was
   foreseen: a common factor on the response to L. common[type] becomes what
   happened to all alike. */
static void learn_together(newton *t, const opc_feedback *f,
                           const opc_moves *moves, double common[2]) {
  double xx[2] = {0}, xy[2] = {0}, x1[2] = {0}, y1[2] = {0}, n[2] = {0};
  for (size_t i = 0; i < t->count; i++) {
    const transistor *s = &t->state[i];
    const double target[ERRORS] = {t->wish[i].ion, 1, 1};
    const biases next = {moves->l[i], moves->w[i], moves->jog[i]};
    double error[ERRORS];
    if (!errors_of(f, i, target, error) || isinf(s->size)) continue;
    int type = f->gates->type[i] == OPC_PMOS;
    double by_l = s->response.by[ION][BY_L] *
                  (length_in_steps(t, i, next) - s->x[BY_L]);
    double by_w = s->response.by[ION][BY_W] * (moves->w[i] - s->x[BY_W]);
    double did = error[ION] - s->error[ION] - by_w;
    xx[type] += by_l * by_l, xy[type] += by_l * did;
    x1[type] += by_l, y1[type] += did, n[type]++;
  }
  for (int type = 0; type < 2; type++) {
    if (n[type] < many) continue;
    xx[type] -= x1[type] * x1[type] / n[type];
    xy[type] -= x1[type] * y1[type] / n[type];
    double factor = xx[type] > 0 ? xy[type] / xx[type] : 1;
    factor = fmin(fmax(factor, 0.4), 2.5);
    common[type] = (y1[type] - factor * x1[type]) / n[type];
    for (size_t i = 0; i < t->count; i++) {
      if ((f->gates->type[i] == OPC_PMOS) != type) continue;
      response *r = &t->state[i].response;
      for (int k = 0; k < ERRORS; k++) r->by[k][BY_L] *= factor;
      r->doubt[BY_L] = doubt_of_many;
    }
  }
  for (size_t i = 0; i < t->count; i++) t->state[i].first = t->state[i].response;
}

/* What the moves to come will do to neighbours. */
static void foresee(newton *t, const opc_feedback *f, const opc_moves *moves) {
  double sum = 0;
  for (size_t i = 0; i < t->count; i++) {
    const transistor *s = &t->state[i];
    const biases next = {moves->l[i], moves->w[i], moves->jog[i]};
    double d = s->response.by[ION][BY_L] *
                   (length_in_steps(t, i, next) - s->x[BY_L]) +
               s->response.by[ION][BY_W] * (next.w - s->x[BY_W]);
    sum += d * d;
  }
  double noise = coupling * sqrt(sum / fmax((double)t->count, 1)) + noise_floor;
  for (size_t i = 0; i < t->count; i++) {
    transistor *s = &t->state[i];
    if (f->iteration > 0)
      s->surprise = OPC_HAS(f, next_end) &&
                            ends_moved(f->gates, s->end, f->next_end + 2 * i)
                        ? late : 0;
    s->surprise += noise;
  }
}

/* Whether something else has moved a transistor at rest. */
static int has_drifted(const newton *t, const transistor *s, double weight) {
  return s->size * weight > t->limit / 2 && s->rest_size < worthwhile * s->size;
}

/* Whether all are as near as the flow wants them, or will hardly get nearer. */
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
  int still_near = t->rest ? worthwhile * mean < before
                           : mean > worthwhile * before;
  t->mean = t->rest ? fmin(mean, before) : mean;
  return t->rest = worst <= t->limit && !drifted &&
                   (mean <= t->limit / 10 || still_near);
}

static int update(void *self, const opc_feedback *f, opc_moves *moves,
                  int *done, opc_error *error) {
  newton *t = self;
  double common[2] = {0};
  (void)error;
  if (f->iteration == 0) sides_find(f->gates, blur, t->sides);
  if (f->iteration == 1) learn_together(t, f, moves, common);
  for (size_t i = 0; i < t->count; i++)
    observe(t, &t->state[i], f, i,
            (biases){moves->l[i], moves->w[i], moves->jog[i]},
            common[f->gates->type[i] == OPC_PMOS]);
  if (f->iteration == 0) start(t, f);
  *done = 1;
  int good = is_good(t, f->iteration == 0);
  for (size_t i = 0; i < t->count; i++) {
    transistor *s = &t->state[i];
    biases next = propose(t, f, i);
    if (good) {
      next = s->now;
    } else if (f->iteration == t->iterations) {
      next = s->best;
    } else if (f->iteration > t->iterations) {
      /* The regulator is not done: those that it moved follow. */
      if (!s->disturbed || f->iteration > 2 * t->iterations) next = s->now;
    } else if (!same(next, s->now)) {
      *done = 0;
    }
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
  return verdicts[s->best_size <= t->limit ? WITHIN : s->verdict];
}

/* ---- parameters ---- */

enum { WEIGHT_ION, WEIGHT_IOFF, WEIGHT_AREA, TOLERANCE, LIMIT, FINE, MIN_JOG,
       ITERATIONS, MAX_BIAS, GAIN_L, GAIN_W, WISHES, PARAMETERS };

static const opc_parameter parameters[PARAMETERS] = {
    [WEIGHT_ION] = {.name = "weight.ion", .type = OPC_REAL,
                    .flags = OPC_AT_LEAST, .preset = "1",
                    .summary = "weight of the squared deviation of Ion"},
    [WEIGHT_IOFF] = {.name = "weight.ioff", .type = OPC_REAL,
                     .flags = OPC_AT_LEAST, .preset = "0",
                     .summary = "weight of that of Ioff; W moves, too, if it is "
                                "not 0"},
    [WEIGHT_AREA] = {.name = "weight.area", .type = OPC_REAL,
                     .flags = OPC_AT_LEAST, .preset = "0",
                     .summary = "weight of that of the gate area, its "
                                "capacitance; W moves, too, if it is not 0"},
    [TOLERANCE] = {.name = "tolerance", .type = OPC_REAL, .flags = OPC_ABOVE,
                   .unit = "%", .preset = "0.05 %",
                   .summary = "a transistor whose weighted deviations are at "
                              "most this is left alone"},
    [LIMIT] = {.name = "limit", .type = OPC_REAL, .flags = OPC_AT_LEAST,
               .unit = "%", .preset = "0.5 %",
               .summary = "the end, once no transistor deviates by more"},
    [FINE] = {.name = "fine", .type = OPC_CHOICE, .preset = "jog",
              .choices = "jog|width|none",
              .summary = "what takes away the grid's quantum of L: a jog in the "
                         "poly, the width of the active, nothing"},
    [MIN_JOG] = {.name = "min_jog", .type = OPC_REAL, .flags = OPC_AT_LEAST,
                 .unit = "nm", .preset = "40 nm",
                 .summary = "a jog stays this far from both ends of its edge"},
    [ITERATIONS] = {.name = "iterations", .type = OPC_INT,
                    .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "10",
                    .min = 1, .max = 1000, .summary = "moves at most"},
    [MAX_BIAS] = {.name = "max_bias", .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "nm", .preset = "80 nm",
                  .summary = "largest correction of L or of W, and no more than "
                             "half of W"},
    [GAIN_L] = {.name = "gain.l", .type = OPC_REAL, .flags = OPC_ABOVE,
                .preset = "2.6",
                .summary = "printed change of L for a change of the mask's, as a "
                           "first guess (the mask error factor)"},
    [GAIN_W] = {.name = "gain.w", .type = OPC_REAL, .flags = OPC_ABOVE,
                .preset = "1.2",
                .summary = "printed change of W for a change of the mask's, as a "
                           "first guess"},
    [WISHES] = {.name = "wishes", .type = OPC_FILE,
                .summary = "what single transistors want: CSV of transistor, "
                           "weight, ion"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  if (host->abi_minor < 1) {
    host->fail(host, error, OPC_NO_PLUGIN, NULL,
               "jogs need plugin interface 1.1, this is 1.%u", host->abi_minor);
    return NULL;
  }
  newton *t = calloc(1, sizeof *t);
  if (!t) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  t->host = host;
  t->weight[ION] = values[WEIGHT_ION].real;
  t->weight[IOFF] = values[WEIGHT_IOFF].real;
  t->weight[AREA] = values[WEIGHT_AREA].real;
  t->tolerance = values[TOLERANCE].real / 100;
  t->limit = values[LIMIT].real / 100;
  t->gain[BY_L] = values[GAIN_L].real;
  t->gain[BY_W] = values[GAIN_W].real;
  t->max_bias = values[MAX_BIAS].real;
  t->min_jog = values[MIN_JOG].real;
  t->fine = values[FINE].integer;
  t->iterations = (uint32_t)values[ITERATIONS].integer;
  t->wishes_path = values[WISHES].text;
  if (t->weight[ION] + t->weight[IOFF] + t->weight[AREA] > 0) return t;
  host->fail(host, error, OPC_INVALID, "weight.ion", "all weights are 0");
  free(t);
  return NULL;
}

static void destroy(void *self) {
  newton *t = self;
  free(t->state);
  free(t->sides);
  free(t->wish);
  free(t);
}

/* ---- entry ---- */

static const opc_synthesizer operations = {
    .size = sizeof operations, .begin = begin, .update = update,
    .verdict = verdict, .flags = OPC_SYNTHESIZER_ENDS_ANYTIME};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "mask.newton",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "Newton's method on all transistors at once, with jogs",
      .kind = OPC_KIND_MASK,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
