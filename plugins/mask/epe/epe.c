/* SPDX-License-Identifier: BSD-3-Clause */
/* mask.epe: OPC by edge placement errors (thesis 1.2 and 3.3.1; N. Cobb,
   "Fast Optical and Process Proximity Correction Algorithms for Integrated
   Circuit Manufacturing", 1998). Edges are cut into fragments; each moves until
   the print meets its drawn edge. */
#include "epe.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

enum { LAYERS_BOTH, LAYERS_POLY, LAYERS_ACTIVE };
enum { BEST_EPE, BEST_ION };

/* Why a transistor is left with its deviation. */
enum { WITHIN, GRID, LIMIT, RULE, LOST, UNMOVED, VERDICTS };
static const char *const verdicts[VERDICTS] = {
    "within 1 nm", "epe", "shift limit", "mask rule", "no edge", NULL};

typedef struct epe {
  const opc_host *host;
  const opc_value *values;
  epe_rules rules;
  epe_assist assist;
  epe_layer layers[OPC_MASKS];
  int given[OPC_MASKS];    /* layers that have fragments */
  double grid;
  size_t count;            /* transistors */
  uint8_t *verdict;
  double best;             /* the least cost, INFINITY: none yet */
  size_t dropped;          /* bars that printed */
  int still;               /* iterations since a fragment moved last */
} epe;

/* The print has come to rest. */
enum { STILL = 4 };

/* The cost of a site without an edge: how far the loop looks for one. */
static const double lost_nm = 100;

enum { FRAGMENT, CONCAVE_CORNER, CORNER_EDGE, LINE_END, RIPPLE, RIPPLE_REACH,
       MIN_EDGE, TANGENCY, MIN_WIDTH, MIN_SPACE, MIN_JOG, MAX_SHIFT, STEP,
       DAMPING, STIFFNESS, BLUR, ITERATIONS, LAYERS, BEST, ASSIST, ASSIST_WIDTH,
       ASSIST_DISTANCE, ASSIST_SPACE, ASSIST_MIN_LENGTH, ASSIST_OVERHANG,
       ASSIST_MARGIN, WINDOW, WINDOW_WEIGHT, PARAMETERS };

/* ---- work: begin and cut ---- */

static void clear(epe *d) {
  for (int k = 0; k < OPC_MASKS; k++) {
    epe_clear(&d->layers[k]);
    d->given[k] = 0;
  }
  free(d->verdict);
  d->verdict = NULL;
}

static int no_memory(const epe *d, opc_error *error) {
  return d->host->fail(d->host, error, OPC_FAILED, NULL, "out of memory");
}

static int32_t steps(const epe *d, int parameter, double otherwise) {
  const opc_value *v = &d->values[parameter];
  double nm = v->type == OPC_ABSENT ? otherwise : v->real;
  return (int32_t)lround(fmin(nm / d->grid, 1 << 20));
}

static int32_t at_least_one(int32_t n) { return n > 0 ? n : 1; }

static void set_rules(epe *d) {
  double fragment = d->values[FRAGMENT].real;
  epe_rules *r = &d->rules;
  r->fragment = at_least_one(steps(d, FRAGMENT, 0));
  r->min_edge = at_least_one(steps(d, MIN_EDGE, fragment / 2));
  r->concave_corner = steps(d, CONCAVE_CORNER, fragment);
  r->corner_edge = steps(d, CORNER_EDGE, fragment);
  r->ripple = steps(d, RIPPLE, fragment);
  int32_t *lengths[] = {&r->concave_corner, &r->corner_edge, &r->ripple};
  for (int k = 0; k < 3; k++)
    if (*lengths[k] < r->min_edge) *lengths[k] = r->min_edge;
  r->line_end = steps(d, LINE_END, 0);
  r->ripple_reach = steps(d, RIPPLE_REACH, 0);
  r->tangency = steps(d, TANGENCY, 0);
  r->min_width = steps(d, MIN_WIDTH, 0);
  r->min_space = steps(d, MIN_SPACE, 0);
  r->min_jog = steps(d, MIN_JOG, 0);
  r->max_shift = steps(d, MAX_SHIFT, 0);
  r->blur = d->values[BLUR].real / d->grid;
  d->assist = (epe_assist){
      .rows = (int32_t)d->values[ASSIST].integer,
      .width = at_least_one(steps(d, ASSIST_WIDTH, 0)),
      .distance = steps(d, ASSIST_DISTANCE, 0),
      .space = steps(d, ASSIST_SPACE, 0),
      .min_length = at_least_one(steps(d, ASSIST_MIN_LENGTH, 0)),
      .overhang = steps(d, ASSIST_OVERHANG, 0)};
}

static int begin(void *self, const opc_feedback *f, opc_error *error) {
  epe *d = self;
  clear(d);
  d->grid = f->gates->grid;
  d->count = f->gates->count;
  d->best = INFINITY;
  d->still = 0;
  d->dropped = 0;
  set_rules(d);
  d->verdict = calloc(d->count ? d->count : 1, 1);
  if (!d->verdict) return no_memory(d, error);
  if (d->values[BEST].integer == BEST_ION && !d->count)
    return d->host->fail(d->host, error, OPC_INVALID, "best",
                         "'ion' needs transistors, there are none");
  return OPC_OK;
}

static int wants(const epe *d, int layer) {
  int64_t layers = d->values[LAYERS].integer;
  return layers == LAYERS_BOTH ||
         layers == (layer == OPC_POLY ? LAYERS_POLY : LAYERS_ACTIVE);
}

static int cut(void *self, const opc_gates *gates, int layer, opc_cuts *cuts,
               opc_error *error) {
  epe *d = self;
  if (!wants(d, layer) || !gates->drawn[layer].count) return OPC_OK;
  epe_layer *l = &d->layers[layer];
  l->host = d->host;
  l->rules = &d->rules;
  if (!epe_cut(l, gates, layer) || !epe_find_pairs(l) ||
      !epe_couple(l, d->grid))
    return no_memory(d, error);
  int code = epe_place_bars(l, &d->assist, &gates->drawn[layer], error);
  if (code) return code;
  d->given[layer] = 1;
  cuts->assists = l->bars;
  cuts->assist_count = l->bar_count;
  cuts->polygons = l->polygons;
  cuts->start = l->start;
  cuts->from = l->from;
  cuts->site = l->site;
  return OPC_OK;
}

/* ---- work: update ---- */

/* Take in what was measured of a layer. */
static void take(epe_layer *l, const double *nm, const int32_t *shift,
                 const opc_field *print, double grid) {
  for (size_t i = 0; i < l->count; i++) {
    l->before[i] = l->error[i];
    l->last[i] = l->shift[i];
    l->error[i] = nm[i] / grid;
    l->cost[i] = isnan(nm[i]) ? lost_nm : fabs(nm[i]);
    l->shift[i] = shift[i];
    if (print && isnan(nm[i]))
      l->host->imaging->sample(print, &l->site[2 * i], &l->site[2 * i + 1], 1,
                               &l->side[i]);
  }
}

/* The level sets of the print; NULL if there are none. */
static const opc_field *print_of(const opc_feedback *f, int layer) {
  int has = f->size > offsetof(opc_feedback, print) && f->print;
  return has ? &f->print[layer] : NULL;
}

/* Mean of what errors cost along the edges, nm. */
static double mean_epe(const epe *d) {
  double sum = 0, length = 0;
  for (int k = 0; k < OPC_MASKS; k++) {
    const epe_layer *l = &d->layers[k];
    for (size_t i = 0; i < l->count; i++) {
      const epe_piece *p = &l->pieces[i];
      double along = abs(p->to.x - p->from.x) + abs(p->to.y - p->from.y);
      sum += along * l->cost[i];
      length += along;
    }
  }
  return length > 0 ? sum / length : 0;
}

/* Is every edge as near as the grid can bring it? */
static int solved(const epe *d) {
  for (int k = 0; k < OPC_MASKS; k++)
    for (size_t i = 0; i < d->layers[k].count; i++)
      if (!(fabs(d->layers[k].error[i]) <= 0.5)) return 0;
  return 1;
}

static double mean_ion(const opc_feedback *f) {
  double sum = 0;
  for (size_t i = 0; i < f->gates->count; i++)
    sum += fabs(f->printed->ion[i] / f->design->ion[i] - 1);
  return sum / (double)f->gates->count;
}

static void judge_gate(epe *d, const epe_layer *l, size_t i) {
  int32_t gate = l->pieces[i].gate;
  if (gate < 0 || (size_t)gate >= d->count) return;
  int32_t shift = l->shift[i];
  int why = isnan(l->error[i])                         ? LOST
            : fabs(l->error[i]) * d->grid <= 1         ? WITHIN
            : abs(shift) >= d->rules.max_shift         ? LIMIT
            : shift == l->low[i] || shift == l->high[i] ? RULE
                                                       : GRID;
  if (d->verdict[gate] == UNMOVED || why > d->verdict[gate])
    d->verdict[gate] = (uint8_t)why;
}

/* The state is the best so far: keep it, and how the gates fare. */
static void keep(epe *d) {
  memset(d->verdict, UNMOVED, d->count);
  for (int k = 0; k < OPC_MASKS; k++) {
    epe_layer *l = &d->layers[k];
    if (l->count) memcpy(l->best, l->shift, l->count * sizeof *l->best);
    for (size_t i = 0; i < l->count; i++) judge_gate(d, l, i);
  }
}

/* Bars that print go for good. What was best had them: look anew. */
static int drop(epe *d, const opc_feedback *f) {
  size_t all = 0;
  for (int k = 0; k < OPC_MASKS; k++) {
    if (!d->given[k]) continue;
    size_t n = epe_drop_bars(&d->layers[k], print_of(f, k), d->grid,
                             d->values[ASSIST_MARGIN].real);
    if (n == SIZE_MAX) return 0;
    all += n;
  }
  if (all) d->best = INFINITY;
  d->dropped += all;
  return 1;
}

/* How many bars the mask has, and how many were dropped. */
static int tell_of_bars(const epe *d, opc_error *error) {
  if (!d->assist.rows) return OPC_OK;
  size_t n = 0;
  for (int k = 0; k < OPC_MASKS; k++) n += d->layers[k].bar_count;
  int code = d->host->metric(d->host, "assists", (double)n, error);
  if (code) return code;
  return d->host->metric(d->host, "assists_dropped", (double)d->dropped, error);
}

static int update(void *self, const opc_feedback *f, opc_moves *moves,
                  int *done, opc_error *error) {
  epe *d = self;
  const epe_window window = {d->values[WINDOW_WEIGHT].real,
                             d->values[WINDOW].real};
  if (!drop(d, f)) return no_memory(d, error);
  for (int k = 0; k < OPC_MASKS; k++)
    if (d->given[k]) {
      const opc_field *print = print_of(f, k);
      take(&d->layers[k], f->epe[k], moves->shift[k], print, d->grid);
      epe_weigh(&d->layers[k], print, &window, d->grid);
    }
  double cost = d->values[BEST].integer == BEST_ION ? mean_ion(f) : mean_epe(d);
  if (cost < d->best) {
    d->best = cost;
    keep(d);
  }
  const epe_steering steering = {.step = d->values[STEP].real / d->grid,
                                 .damping = d->values[DAMPING].real,
                                 .stiffness = d->values[STIFFNESS].real};
  int moved = 0;
  *done = f->iteration >= d->values[ITERATIONS].integer || d->still >= STILL ||
          solved(d);
  for (int k = 0; k < OPC_MASKS; k++) {
    epe_layer *l = &d->layers[k];
    if (!d->given[k]) continue;
    moves->assists[k] = l->bars;
    moves->assist_count[k] = l->bar_count;
    if (*done) {
      memcpy(moves->shift[k], l->best, l->count * sizeof *l->best);
      continue;
    }
    epe_steer(l, &steering);
    epe_settle(l, moves->shift[k]);
    moved |= memcmp(moves->shift[k], l->shift, l->count * sizeof *l->shift);
  }
  d->still = moved ? 0 : d->still + 1;
  return tell_of_bars(d, error);
}

static const char *verdict(const void *self, size_t gate) {
  const epe *d = self;
  return gate < d->count ? verdicts[d->verdict[gate]] : NULL;
}

/* ---- parameters ---- */

#define LENGTH(NAME, FLAG, PRESET, SUMMARY)                               \
  {.name = (NAME), .type = OPC_REAL, .flags = (FLAG), .unit = "nm",       \
   .preset = (PRESET), .min = 0, .summary = (SUMMARY)}

static const opc_parameter parameters[PARAMETERS] = {
    [FRAGMENT] = LENGTH("fragment", OPC_ABOVE, "40 nm",
                        "length of the fragments of an edge"),
    [CONCAVE_CORNER] =
        LENGTH("concave_corner", OPC_ABOVE, NULL,
               "length of a fragment beside a concave corner; as fragment"),
    [CORNER_EDGE] =
        LENGTH("corner_edge", OPC_ABOVE, NULL,
               "length of a fragment beside a convex corner; as fragment"),
    [LINE_END] = LENGTH("line_end", OPC_AT_LEAST, "100 nm",
                        "an edge between two convex corners that is at most so "
                        "long is a line end, one fragment"),
    [RIPPLE] = LENGTH("ripple", OPC_ABOVE, NULL,
                      "length of the fragments beside what lies opposite to a "
                      "corner of another edge; as fragment"),
    [RIPPLE_REACH] = LENGTH("ripple_reach", OPC_AT_LEAST, "0 nm",
                            "how far away such a corner may be; 0: none"),
    [MIN_EDGE] = LENGTH("min_edge", OPC_ABOVE, NULL,
                        "no piece of an edge is shorter; half of fragment"),
    [TANGENCY] = LENGTH("tangency", OPC_AT_LEAST, "40 nm",
                        "how far off corners, where the print is round, errors "
                        "are measured"),
    [MIN_WIDTH] = LENGTH("min_width", OPC_AT_LEAST, "40 nm",
                         "least width of the mask, also of a nub of an edge"),
    [MIN_SPACE] = LENGTH("min_space", OPC_AT_LEAST, "40 nm",
                         "least space of the mask, also of a notch of an edge"),
    [MIN_JOG] = LENGTH("min_jog", OPC_AT_LEAST, "0 nm",
                       "neighbours whose shifts differ by less get the same"),
    [MAX_SHIFT] = LENGTH("max_shift", OPC_ABOVE, "60 nm",
                         "how far a fragment may move in all"),
    [STEP] = LENGTH("step", OPC_ABOVE, "8 nm",
                    "how far a fragment may move in an iteration"),
    [DAMPING] = {.name = "damping", .type = OPC_REAL,
                 .flags = OPC_ABOVE | OPC_AT_MOST, .preset = "0.7", .min = 0,
                 .max = 1,
                 .summary = "the part of an error that one move is to correct"},
    [STIFFNESS] = {.name = "stiffness", .type = OPC_REAL, .flags = OPC_ABOVE,
                   .preset = "0.1", .min = 0,
                   .summary = "what a move costs against an error: more is "
                              "slower and surer, 2 where features hardly print"},
    [BLUR] = LENGTH("blur", OPC_ABOVE, "40 nm",
                    "how far a move spreads in the print, as the standard "
                    "deviation of a Gaussian; about a fifth of wavelength / NA"),
    [ITERATIONS] = {.name = "iterations", .type = OPC_INT,
                    .flags = OPC_AT_LEAST, .preset = "20", .min = 0,
                    .summary = "moves at most"},
    [LAYERS] = {.name = "layers", .type = OPC_CHOICE, .preset = "both",
                .choices = "both|poly|active", .summary = "what to correct"},
    [BEST] = {.name = "best", .type = OPC_CHOICE, .preset = "epe",
              .choices = "epe|ion",
              .summary = "the iteration to keep: that of the least mean |EPE|, "
                         "or of the least mean |Ion deviation|"},
    [ASSIST] = {.name = "assist", .type = OPC_INT,
                .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "0", .min = 0,
                .max = 4, .summary = "rows of assist bars beside open edges"},
    [ASSIST_WIDTH] = LENGTH("assist_width", OPC_ABOVE, "50 nm",
                            "width of an assist bar"),
    [ASSIST_DISTANCE] = LENGTH("assist_distance", OPC_ABOVE, "150 nm",
                               "from drawn shapes to the first row"),
    [ASSIST_SPACE] = LENGTH("assist_space", OPC_ABOVE, "80 nm",
                            "between assist bars"),
    [ASSIST_MIN_LENGTH] = LENGTH("assist_min_length", OPC_ABOVE, "80 nm",
                                 "of an assist bar"),
    [ASSIST_OVERHANG] = LENGTH("assist_overhang", OPC_AT_LEAST, "100 nm",
                               "how far a bar goes past the ends of its edge"),
    [ASSIST_MARGIN] = {.name = "assist_margin", .type = OPC_REAL,
                       .flags = OPC_AT_LEAST, .preset = "0.02", .min = 0,
                       .summary = "a bar is dropped where it comes so near to "
                                  "printing, intensity; clear field 1"},
    [WINDOW] = {.name = "window.level", .type = OPC_REAL,
                .flags = OPC_ABOVE, .preset = "0.01", .min = 0,
                .summary = "other doses: the intensity at the edge, more and "
                           "less; clear field 1"},
    [WINDOW_WEIGHT] = {.name = "window.weight", .type = OPC_REAL,
                       .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "0",
                       .min = 0, .max = 1,
                       .summary = "of the errors at other doses in the feedback"},
};

static const opc_metric metrics[] = {
    {.name = "assists", .summary = "assist bars of the mask"},
    {.name = "assists_dropped", .better = OPC_LOWER,
     .summary = "assist bars that were taken away as they printed"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  epe *d = calloc(1, sizeof *d);
  if (!d) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  d->host = host;
  d->values = values;
  const opc_value *least = &values[MIN_EDGE];
  if (least->type != OPC_ABSENT && least->real > values[FRAGMENT].real) {
    host->fail(host, error, OPC_INVALID, "min_edge",
               "%g nm is more than a fragment of %g nm", least->real,
               values[FRAGMENT].real);
    free(d);
    return NULL;
  }
  return d;
}

static void destroy(void *self) {
  clear(self);
  free(self);
}

/* ---- entry ---- */

static const opc_synthesizer operations = {.size = sizeof operations,
                                           .begin = begin,
                                           .update = update,
                                           .verdict = verdict,
                                           .cut = cut};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "mask.epe",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary = "edge placement error OPC: fragments that move until the print "
                 "meets the drawn edge",
      .kind = OPC_KIND_MASK,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      OPC_METRICS(metrics),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
