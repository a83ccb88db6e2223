/* SPDX-License-Identifier: BSD-3-Clause */
/* mask.newton: all transistors at once by Newton's method. What each one's
   current, leakage and area do when its mask changes is first taken from the
   device curves, then from what the moves did (Broyden). A jog in the poly, one
   edge a grid step further out over part of the width, takes away the grid's
   quantum. */
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
  double x[MOVES], error[ERRORS];   /* of `now` */
  double size, best_size; /* of the errors, see size_of */
  response response, first;
  int32_t end[2];         /* the line ends of `now` */
  int32_t from[2], to[2]; /* the poly's LOW and HIGH side, along W from the
                             gate's box, grid steps */
  uint8_t moved;          /* `now` is not the first */
  uint8_t disturbed;      /* its line ends have moved with the last print */
  uint8_t worse;          /* times in a row that a move was no better */
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
  uint32_t iterations, last;   /* last: of the run */
  const char *wishes_path;
  wish *wish;             /* of each transistor */
  transistor *state;
  size_t count;
} newton;

/* A response stays within this factor of the first estimate, which is good for
   W: what a change of W does is known. */
static const double trust[MOVES] = {4, 1.5};

/* The longest step of L and W at a time, nm: beyond, the response is another. */
static const double longest[MOVES] = {20, 60};

/* A line end that moved further, nm, spoils the lesson. */
static const double still = 2;

/* So many transistors of a type tell a common trend from their own. */
static const double many = 16;

/* How far beyond the active, nm, a poly edge still matters to the gate: some
   quarter of the resolution. */
static const double reach = 30;

/* A smaller move of the mask (grid steps) teaches more of the neighbours' than
   of its own. */
static const double least_lesson = 0.02;

/* ---- work ---- */

/* Where the poly's sides that move with each gate begin and end along W, in
   grid steps from its box. */
static void find_sides(const newton *t, const opc_gates *g) {
  const opc_edges *e = &g->edges[OPC_POLY];
  for (size_t p = 0; p < e->polygons; p++)
    for (uint32_t i = e->start[p]; i < e->start[p + 1]; i++) {
      const opc_fragment *f = &e->fragments[i];
      if (f->role != OPC_L_LOW && f->role != OPC_L_HIGH) continue;
      const opc_fragment *next =
          &e->fragments[i + 1 < e->start[p + 1] ? i + 1 : e->start[p]];
      int upright = g->axis[f->gate] == OPC_X, side = f->role == OPC_L_HIGH;
      opc_box box = g->box[f->gate];
      int32_t a = upright ? f->from.y - box.y0 : f->from.x - box.x0;
      int32_t b = upright ? next->from.y - box.y0 : next->from.x - box.x0;
      t->state[f->gate].from[side] = a < b ? a : b;
      t->state[f->gate].to[side] = a < b ? b : a;
    }
}

static int begin(void *self, const opc_feedback *f, opc_error *error) {
  newton *t = self;
  free(t->state);
  free(t->wish);
  t->count = f->gates->count;
  t->state = calloc(t->count + 1, sizeof *t->state);
  t->wish = calloc(t->count + 1, sizeof *t->wish);
  if (!t->state || !t->wish)
    return t->host->fail(t->host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < t->count; i++) t->wish[i] = (wish){1, 1};
  t->last = t->iterations;
  find_sides(t, f->gates);
  if (!t->wishes_path) return OPC_OK;
  return read_wishes(t->host, t->wishes_path, f->gates, t->wish, error);
}

static int same(biases a, biases b) {
  return a.l == b.l && a.w == b.w && a.jog == b.jog;
}

static int32_t box_width(const opc_gates *g, size_t i) {
  opc_box b = g->box[i];
  return g->axis[i] == OPC_X ? b.y1 - b.y0 : b.x1 - b.x0;
}

/* The larger of the weighted errors. */
static double size_of(const newton *t, const double error[ERRORS]) {
  double size = 0;
  for (int k = 0; k < ERRORS; k++)
    size = fmax(size, sqrt(t->weight[k]) * fabs(error[k]));
  return size;
}

/* The part of the gate that a side's edge from its LOW end on for `jog` steps
   has to do with, and back. The edge matters within the gate and `margin`
   beyond. */
static double part_of(const transistor *s, int side, int32_t jog,
                      int32_t width, double margin) {
  if (jog <= 0) return 0;
  double low = fmax(s->from[side], -margin);
  double high = fmin(s->to[side], width + margin);
  double at = s->from[side] + jog;
  return fmin(fmax((at - low) / (high - low), 0), 1);
}

static int32_t jog_of(const transistor *s, int side, double part,
                      int32_t width, double margin) {
  double low = fmax(s->from[side], -margin);
  double high = fmin(s->to[side], width + margin);
  return (int32_t)lround(low + part * (high - low)) - s->from[side];
}

static double length_in_steps(const newton *t, const opc_feedback *f, size_t i,
                              const opc_moves *m) {
  return m->l[i] + part_of(&t->state[i], !(m->l[i] & 1), m->jog[i],
                           box_width(f->gates, i), reach / f->gates->grid);
}

/* Take in the measurement of the moves that were made. */
static void observe(const newton *t, transistor *s, const opc_feedback *f,
                    size_t i, const opc_moves *moves) {
  const biases now = {moves->l[i], moves->w[i], moves->jog[i]};
  double error[ERRORS], x[MOVES], dx[MOVES], de[ERRORS];
  const double target[ERRORS] = {t->wish[i].ion, 1, 1};
  int prints = errors_of(f, i, target, error);
  x[BY_L] = length_in_steps(t, f, i, moves);
  x[BY_W] = now.w;
  for (int m = 0; m < MOVES; m++) dx[m] = x[m] - s->x[m];
  for (int k = 0; k < ERRORS; k++) de[k] = error[k] - s->error[k];
  int disturbed = f->iteration < 2;
  for (int side = 0; side < 2; side++) {
    int32_t end = f->end[2 * i + (size_t)side];
    disturbed |= abs(end - s->end[side]) * f->gates->grid > still;
    s->end[side] = end;
  }
  if (s->moved && prints && !disturbed && hypot(dx[0], dx[1]) > least_lesson)
    learn(&s->response, &s->first, trust, dx, de);
  memcpy(s->x, x, sizeof x);
  memcpy(s->error, error, sizeof error);
  s->now = now;
  s->size = prints ? size_of(t, error) : INFINITY;
  /* A state that was the best is so no more if the line ends or neighbours
     have changed it. */
  if (disturbed || s->size < s->best_size || same(now, s->best)) {
    s->best_size = s->size;
    s->best = now;
    s->worse = 0;
  } else {
    s->worse++;
  }
  s->moved = 1;
  s->disturbed = (uint8_t)disturbed;
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

/* L as whole steps and a jog over part of the width, which keeps away from both
   ends of its side. */
static biases with_jog(const newton *t, const transistor *s, double l,
                       int32_t w, int32_t width, double grid) {
  biases b = {.l = (int32_t)floor(l), .w = w};
  int side = !(b.l & 1);
  int32_t whole = s->to[side] - s->from[side];
  int32_t least = (int32_t)ceil(fmin(t->min_jog / grid, whole / 2.0));
  int32_t jog = jog_of(s, side, l - b.l, width, reach / grid);
  if (jog < least / 2) return b;
  if (whole - jog < least / 2) return (biases){b.l + 1, w, 0};
  b.jog = jog < least ? least : jog > whole - least ? whole - least : jog;
  return b;
}

/* The mask to try next for a wanted move of L and W: on the grid. */
static biases on_grid(const newton *t, const transistor *s,
                      const double dx[MOVES], double tolerance, int32_t width,
                      double grid) {
  static const int only_l[MOVES] = {1, 0}, only_w[MOVES] = {0, 1};
  double rest[ERRORS], more[MOVES];
  int32_t w = (int32_t)lround(s->x[BY_W] + dx[BY_W]);
  double l = s->x[BY_L] + dx[BY_L];
  /* W's rounding is made good by L, and L's by what the flow asks for. */
  for (int k = 0; k < ERRORS; k++)
    rest[k] = s->error[k] + s->response.by[k][BY_L] * dx[BY_L] +
              s->response.by[k][BY_W] * (w - s->x[BY_W]);
  solve(&s->response, rest, t->weight, only_l, more);
  if (dx[BY_L] != 0) l += fmin(fmax(more[BY_L], -1), 1);
  int32_t whole = (int32_t)lround(l);
  for (int k = 0; k < ERRORS; k++)
    rest[k] = s->error[k] + s->response.by[k][BY_L] * (whole - s->x[BY_L]) +
              s->response.by[k][BY_W] * (w - s->x[BY_W]);
  if (t->fine == NONE || (t->fine == JOG && size_of(t, rest) <= tolerance))
    return (biases){whole, w, 0};
  if (t->fine == JOG) return with_jog(t, s, l, w, width, grid);
  solve(&s->response, rest, t->weight, only_w, more);
  return (biases){whole, w + (int32_t)lround(more[BY_W]), 0};
}

/* Newton's step of one transistor. */
static biases propose(const newton *t, transistor *s, const opc_feedback *f,
                      size_t i) {
  const opc_gates *g = f->gates;
  uint32_t veto = f->vetoes[i];
  int32_t width = box_width(g, i);
  double grid = g->grid, tolerance = t->tolerance / t->wish[i].weight;
  double limit[MOVES] = {t->max_bias / grid,
                         fmin(t->max_bias, g->width[i] / 2) / grid};
  int both = t->weight[IOFF] > 0 || t->weight[AREA] > 0;
  int free[MOVES] = {1, both};
  double dx[MOVES];
  s->verdict = MOVING;
  if (s->size <= tolerance || t->wish[i].weight == 0) {
    s->verdict = WITHIN;
    return s->now;
  }
  if (isinf(s->size)) {   /* open: a wider line, and look again */
    s->verdict = NO_PRINT;
    int32_t step = (int32_t)ceil(5 / grid);
    if (!(f->flags[i] & OPC_PRINT_OPEN) || s->now.l + step > limit[BY_L])
      return s->now;
    return (biases){s->now.l + step, s->now.w, 0};
  }
  if (s->worse >= 2) {
    s->verdict = WORSE;
    return s->best;
  }
  uint8_t why = MOVING;
  solve(&s->response, s->error, t->weight, free, dx);
  dx[BY_L] = bounded(s->x[BY_L], dx[BY_L], longest[BY_L] / grid, limit[BY_L],
                     veto & OPC_VETO_LONGER, veto & OPC_VETO_SHORTER, &why);
  if (why != MOVING && fabs(dx[BY_L]) < 0.5) {   /* L cannot: W alone */
    static const int only_w[MOVES] = {0, 1};
    solve(&s->response, s->error, t->weight, only_w, dx);
  }
  dx[BY_W] = bounded(s->x[BY_W], dx[BY_W], longest[BY_W] / grid, limit[BY_W],
                     veto & OPC_VETO_WIDER, veto & OPC_VETO_NARROWER, &why);
  biases next = on_grid(t, s, dx, tolerance, width, grid);
  if (same(next, s->now))
    s->verdict = why == MOVING ? GRID : why;
  return next;
}

static void start(newton *t, const opc_feedback *f) {
  curve curves[2];
  curves_from(f, curves);
  for (size_t i = 0; i < t->count; i++) {
    transistor *s = &t->state[i];
    s->first = first_response(f->gates, i,
                              &curves[f->gates->type[i] == OPC_PMOS], t->gain);
    s->response = s->first;
  }
}

/* What the first moves did to the currents of each type, against what was
   foreseen: a common factor on the response to L. Each transistor by itself
   would take for its own what line ends that grew in the same print did. */
static void learn_together(newton *t, const opc_feedback *f,
                           const opc_moves *moves) {
  double xx[2] = {0}, xy[2] = {0}, x1[2] = {0}, y1[2] = {0}, n[2] = {0};
  for (size_t i = 0; i < t->count; i++) {
    const transistor *s = &t->state[i];
    const double target[ERRORS] = {t->wish[i].ion, 1, 1};
    double error[ERRORS];
    if (!errors_of(f, i, target, error)) continue;
    int type = f->gates->type[i] == OPC_PMOS;
    double by_l = s->response.by[ION][BY_L] *
                  (length_in_steps(t, f, i, moves) - s->x[BY_L]);
    double by_w = s->response.by[ION][BY_W] * (moves->w[i] - s->x[BY_W]);
    double did = error[ION] - s->error[ION] - by_w;
    xx[type] += by_l * by_l, xy[type] += by_l * did;
    x1[type] += by_l, y1[type] += did, n[type]++;
  }
  for (int type = 0; type < 2; type++) {
    /* With many, what happened to all alike is left out of it. */
    if (n[type] >= many) {
      xx[type] -= x1[type] * x1[type] / n[type];
      xy[type] -= x1[type] * y1[type] / n[type];
    }
    double factor = xx[type] > 0 ? xy[type] / xx[type] : 1;
    factor = fmin(fmax(factor, 0.4), 2.5);
    for (size_t i = 0; i < t->count; i++)
      for (int k = 0; k < ERRORS; k++)
        if ((f->gates->type[i] == OPC_PMOS) == type)
          t->state[i].response.by[k][BY_L] *= factor;
  }
  for (size_t i = 0; i < t->count; i++) t->state[i].first = t->state[i].response;
}

static int update(void *self, const opc_feedback *f, opc_moves *moves,
                  int *done, opc_error *error) {
  newton *t = self;
  (void)error;
  if (f->iteration == 0) start(t, f);
  if (f->iteration == 1) learn_together(t, f, moves);
  double worst = 0;
  for (size_t i = 0; i < t->count; i++) {
    observe(t, &t->state[i], f, i, moves);
    worst = fmax(worst, t->state[i].size * fmin(t->wish[i].weight, 1));
  }
  if (worst <= t->limit && f->iteration < t->last) t->last = f->iteration;
  *done = 1;
  for (size_t i = 0; i < t->count; i++) {
    transistor *s = &t->state[i];
    biases next = propose(t, s, f, i);
    if (f->iteration == t->last) {
      /* A best state that is no better than a transistor needs is not worth a
         print more. */
      next = s->verdict == WITHIN ? s->now : s->best;
    } else if (f->iteration > t->last) {
      /* The regulator is not done: those that it moved follow. */
      if (!s->disturbed || f->iteration > 2 * t->iterations) next = s->now;
    } else if (!same(next, s->now)) {
      *done = 0;
    }
    moves->l[i] = next.l;
    moves->w[i] = next.w;
    moves->jog[i] = next.jog;
  }
  return OPC_OK;
}

static const char *verdict(const void *self, size_t gate) {
  const newton *t = self;
  return gate < t->count ? verdicts[t->state[gate].verdict] : NULL;
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
                 .unit = "nm", .preset = "20 nm",
                 .summary = "a jog stays this far from both ends of its edge"},
    [ITERATIONS] = {.name = "iterations", .type = OPC_INT,
                    .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "10",
                    .min = 1, .max = 1000, .summary = "moves at most"},
    [MAX_BIAS] = {.name = "max_bias", .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "nm", .preset = "80 nm",
                  .summary = "largest correction of L or of W, and no more than "
                             "half of W"},
    [GAIN_L] = {.name = "gain.l", .type = OPC_REAL, .flags = OPC_ABOVE,
                .preset = "2",
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
