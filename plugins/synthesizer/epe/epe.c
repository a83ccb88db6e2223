/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements synthesizer.epe: OPC by edge placement errors (thesis 1.2 and
   3.3.1; N. Cobb, "Fast Optical and Process Proximity Correction Algorithms for
   Integrated Circuit Manufacturing", 1998). Edges are dissected into fragments;
   each fragment is shifted until the simulated contour is on the drawn edge. */
#include "epe.h"

#include <eda/memory.h>
#include <eda/rules.h>
#include <math.h>
#include <opcflow/follow.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tuning.h"

/* ---- state ---- */

enum { LAYERS_BOTH, LAYERS_POLY, LAYERS_ACTIVE };
enum { BEST_AUTO, BEST_EPE, BEST_ION };

/* Verdicts of transistors. */
enum { WITHIN, GRID, LIMIT, RULE, NO_EDGE, UNMOVED, VERDICTS };
static const char *const verdicts[VERDICTS] = {
    "within 1 nm", "epe", "shift limit", "mask rule", "no edge", NULL};

typedef struct epe {
  const opc_host *host;
  /* Parameters, nm. A length at corners that is NAN equals `fragment`. */
  double fragment, concave_corner, corner_edge, line_end, ripple, ripple_reach;
  double min_edge, tangency, min_width, min_space, min_jog, max_shift, blur;
  double step, damping, stiffness;
  int64_t iterations;
  int which_layers, which_best;
  int64_t sraf_rows;
  double sraf_width, sraf_distance, sraf_space, sraf_min_length, sraf_overhang;
  double sraf_margin, window_level, window_weight;

  epe_rules rules;
  eda_sraf_rule assist;
  epe_layer *layers;
  size_t n_layers;
  double grid;
  size_t count; /* number of transistors */
  uint8_t *verdict;
  double best; /* smallest cost so far; INFINITY before the first iteration */
  double milestone; /* cost after the last decrease by the fraction
                       tuned.progress */
  int64_t reached;  /* iteration of `milestone` */
  int reported;     /* 1: missing convergence was logged */
  size_t dropped;   /* number of assist features removed because they print */
  int still;        /* number of iterations since a fragment last moved */
} epe;

/* ---- work: begin and cut ---- */

static void epe_clear_all(void *self) {
  epe *d = self;
  for (size_t k = 0; k < d->n_layers; k++) epe_clear(&d->layers[k]);
  free(d->layers);
  free(d->verdict);
}

/* Return a length in grid steps. */
static int32_t grid_steps(const epe *d, double nm) {
  return (int32_t)lround(fmin(nm / d->grid, 1 << 20));
}

static int32_t at_least(int32_t n, int32_t least) {
  return n > least ? n : least;
}

/* Return the length of a fragment beside a corner, grid steps: `nm`, or
   `fragment` if `nm` is NAN. */
static int32_t corner_length(const epe *d, double nm) {
  return at_least(grid_steps(d, isnan(nm) ? d->fragment : nm),
                  d->rules.min_edge);
}

static void rules_set(epe *d) {
  d->rules.min_edge = at_least(grid_steps(d, d->min_edge), 1);
  d->rules = (epe_rules){.fragment = at_least(grid_steps(d, d->fragment), 1),
                         .min_edge = d->rules.min_edge,
                         .concave_corner = corner_length(d, d->concave_corner),
                         .corner_edge = corner_length(d, d->corner_edge),
                         .ripple = corner_length(d, d->ripple),
                         .line_end = grid_steps(d, d->line_end),
                         .ripple_reach = grid_steps(d, d->ripple_reach),
                         .tangency = grid_steps(d, d->tangency),
                         .min_width = grid_steps(d, d->min_width),
                         .min_space = grid_steps(d, d->min_space),
                         .min_jog = grid_steps(d, d->min_jog),
                         .max_shift = grid_steps(d, d->max_shift),
                         .blur = d->blur / d->grid};
  d->assist = (eda_sraf_rule){
      .rows = (int32_t)d->sraf_rows,
      .width = at_least(grid_steps(d, d->sraf_width), 1),
      .distance = grid_steps(d, d->sraf_distance),
      .space = grid_steps(d, d->sraf_space),
      .min_length = at_least(grid_steps(d, d->sraf_min_length), 1),
      .overhang = grid_steps(d, d->sraf_overhang)};
}

/* Restart the search for the best mask. */
static void best_forget(epe *d) { d->best = d->milestone = INFINITY; }

static void epe_follow(epe *d, const eda_feedback *f);
static int epe_check(void *self, opc_error *error);

static int epe_begin_run(void *self, const eda_feedback *f, opc_error *error) {
  epe *d = self;
  epe_follow(d, f);
  epe_clear_all(d);
  d->grid = f->gates->grid;
  d->count = f->gates->count;
  d->n_layers = f->gates->layers;
  d->layers = eda_alloc(d->n_layers, sizeof *d->layers);
  d->verdict = eda_alloc(d->count, 1);
  best_forget(d);
  d->still = 0;
  d->dropped = 0;
  d->reported = 0;
  if (epe_check(d, error)) return error->code;
  rules_set(d);
  if (d->which_best == BEST_ION && !d->count)
    return opc_fail(error, OPC_INVALID, "best",
                    "'best: ion' requires transistors, the layout has none");
  return OPC_OK;
}

/* Return 1 if a layer is corrected. The choice `poly` includes the layers after
   active. */
static int is_corrected(const epe *d, int layer) {
  return d->which_layers == LAYERS_BOTH ||
         d->which_layers == (layer == EDA_ACTIVE ? LAYERS_ACTIVE : LAYERS_POLY);
}

static int epe_cut_layer(void *self, const eda_gates *gates, int layer,
                         eda_cuts *cuts, opc_error *error) {
  epe *d = self;
  if (!is_corrected(d, layer) || !gates->drawn[layer].count) return OPC_OK;
  epe_layer *l = &d->layers[layer];
  l->context = d->host->context;
  l->rules = &d->rules;
  epe_cut(l, gates, layer);
  epe_find_pairs(l);
  epe_couple(l, d->grid);
  int code = epe_place_srafs(l, &d->assist, &gates->drawn[layer], error);
  if (code) return code;
  *cuts = (eda_cuts){.polygons = l->polygons,
                     .start = l->start,
                     .from = l->from,
                     .site = l->site,
                     .assists = {l->srafs.box, l->srafs.count}};
  return OPC_OK;
}

/* ---- work: update ---- */

/* Store the measured errors and shifts of a layer. */
static void layer_store(epe_layer *l, const double *nm, const int32_t *shift,
                        const eda_field *print, double grid) {
  for (size_t i = 0; i < l->count; i++) {
    l->before[i] = l->error[i];
    l->last[i] = l->shift[i];
    l->error[i] = nm[i] / grid;
    l->cost[i] = isnan(nm[i]) ? tuned.lost_cost : fabs(nm[i]);
    l->shift[i] = shift[i];
    if (print && isnan(nm[i]))
      eda_field_sample(print, &l->site[2 * i], &l->site[2 * i + 1], 1,
                       &l->side[i]);
  }
}

/* Return the mean cost along the edges, nm. */
static double mean_epe(const epe *d) {
  double sum = 0, length = 0;
  for (size_t k = 0; k < d->n_layers; k++) {
    const epe_layer *l = &d->layers[k];
    for (size_t i = 0; i < l->count; i++) {
      double along = epe_length(&l->fragments[i]);
      sum += along * l->cost[i];
      length += along;
    }
  }
  return length > 0 ? sum / length : 0;
}

/* Return 1 if the error of every fragment is at most half a grid step. */
static int is_solved(const epe *d) {
  for (size_t k = 0; k < d->n_layers; k++)
    for (size_t i = 0; i < d->layers[k].count; i++)
      if (!(fabs(d->layers[k].error[i]) <= 0.5)) return 0;
  return 1;
}

static double mean_ion(const eda_feedback *f) {
  double sum = 0;
  for (size_t i = 0; i < f->gates->count; i++)
    sum += fabs(f->printed->ion[i] / f->design->ion[i] - 1);
  return sum / (double)f->gates->count;
}

/* Return 1 if Ion selects the best iteration. If only layers without
   transistors are corrected, Ion does not change. */
static int best_is_by_ion(const epe *d) {
  if (d->which_best != BEST_AUTO) return d->which_best == BEST_ION;
  return d->count > 0 && d->n_layers > EDA_ACTIVE &&
         (d->layers[EDA_POLY].count || d->layers[EDA_ACTIVE].count);
}

static void verdict_add(epe *d, const epe_layer *l, size_t i) {
  int32_t gate = l->fragments[i].gate;
  if (gate < 0 || (size_t)gate >= d->count) return;
  int32_t shift = l->shift[i];
  int why = isnan(l->error[i])                          ? NO_EDGE
            : fabs(l->error[i]) * d->grid <= 1          ? WITHIN
            : abs(shift) >= d->rules.max_shift          ? LIMIT
            : shift == l->low[i] || shift == l->high[i] ? RULE
                                                        : GRID;
  if (d->verdict[gate] == UNMOVED || why > d->verdict[gate])
    d->verdict[gate] = (uint8_t)why;
}

/* Store the present shifts as the best, with the verdicts of the gates. */
static void best_keep(epe *d) {
  memset(d->verdict, UNMOVED, d->count);
  for (size_t k = 0; k < d->n_layers; k++) {
    epe_layer *l = &d->layers[k];
    if (l->count) memcpy(l->best, l->shift, l->count * sizeof *l->best);
    for (size_t i = 0; i < l->count; i++) verdict_add(d, l, i);
  }
}

/* Return the level set of the printed image of a layer, or NULL if the feedback
   contains no printed images. */
static const eda_field *print_of(const eda_feedback *f, size_t layer) {
  return f->print ? &f->print[layer] : NULL;
}

/* Remove printed assist features permanently. The best mask contains these
   features, so restart the search for the best mask. */
static void assists_drop(epe *d, const eda_feedback *f) {
  size_t all = 0;
  for (size_t k = 0; k < d->n_layers && f->print; k++)
    all += eda_srafs_drop(d->host->context, &d->layers[k].srafs, print_of(f, k),
                          d->grid, d->sraf_margin);
  if (all) best_forget(d);
  d->dropped += all;
}

/* Store the assist features that the loop placed. If they differ from those of
   the best mask, restart the search for the best mask. */
static void assists_take(epe *d, const eda_moves *moves) {
  int other = 0;
  for (size_t k = 0; k < d->n_layers && !d->assist.rows; k++)
    if (d->layers[k].count)
      other |= epe_replace_srafs(&d->layers[k], moves->assists[k]);
  if (other) best_forget(d);
}

/* Write the metrics: numbers of assist features on the mask and of removed
   assist features. */
static int assists_write_metrics(const epe *d, opc_error *error) {
  if (!d->assist.rows) return OPC_OK;
  size_t n = 0;
  for (size_t k = 0; k < d->n_layers; k++) n += d->layers[k].srafs.count;
  const opc_metric_value values[] = {{"assists", (double)n},
                                     {"assists_dropped", (double)d->dropped}};
  return opc_put_metrics(d->host, OPC_ARRAY(values), error);
}

/* Store the measured mask as the best if its cost is the smallest so far. */
static void cost_take(epe *d, const eda_feedback *f) {
  double cost = best_is_by_ion(d) ? mean_ion(f) : mean_epe(d);
  if (cost < (1 - tuned.progress) * d->milestone) {
    d->milestone = cost;
    d->reached = f->iteration;
  }
  if (!(cost < d->best)) return;
  d->best = cost;
  best_keep(d);
}

static int has_converged(const epe *d, int64_t iteration) {
  return d->still >= tuned.still || is_solved(d) ||
         (isfinite(d->milestone) && iteration - d->reached >= tuned.patience);
}

static void epe_log_unconverged(epe *d) {
  int ion = best_is_by_ion(d);
  char state[80] = "the fragments still move";
  if (isfinite(d->best))
    (void)snprintf(state, sizeof state,
                   "the mean |%s| still decreases, %.3g %s",
                   ion ? "Ion deviation" : "EPE", ion ? 100 * d->best : d->best,
                   ion ? "%" : "nm");
  if (!d->reported && d->iterations > 0)
    d->host->log(d->host, OPC_LOG_FINDING,
                 "synthesizer.epe: not converged after %d iterations "
                 "('iterations'): %s",
                 (int)d->iterations, state);
  d->reported = 1;
}

static int epe_update(void *self, const eda_feedback *f, eda_moves *moves,
                      int *done, opc_error *error) {
  epe *d = self;
  assists_drop(d, f);
  for (size_t k = 0; k < d->n_layers; k++) {
    epe_layer *l = &d->layers[k];
    if (!l->count) continue;
    layer_store(l, f->epe[k], moves->shift[k], print_of(f, k), d->grid);
    epe_weigh(l, print_of(f, k), d->window_weight, d->window_level, d->grid);
  }
  cost_take(d, f);
  assists_take(d, moves);
  const epe_steering steering = {.step = d->step / d->grid,
                                 .damping = d->damping,
                                 .stiffness = d->stiffness};
  int moved = 0;
  int converged = has_converged(d, f->iteration);
  *done = converged || f->iteration >= d->iterations;
  if (*done && !converged) epe_log_unconverged(d);
  for (size_t k = 0; k < d->n_layers; k++) {
    epe_layer *l = &d->layers[k];
    if (!l->count) continue;
    moves->assists[k] = (eda_boxes){l->srafs.box, l->srafs.count};
    if (*done) {
      memcpy(moves->shift[k], l->best, l->count * sizeof *l->best);
      continue;
    }
    epe_steer(l, &steering);
    epe_settle(l, moves->shift[k]);
    moved |= memcmp(moves->shift[k], l->shift, l->count * sizeof *l->shift);
  }
  d->still = moved ? 0 : d->still + 1;
  return assists_write_metrics(d, error);
}

static const char *epe_verdict(const void *self, size_t gate) {
  const epe *d = self;
  return gate < d->count ? verdicts[d->verdict[gate]] : NULL;
}

/* ---- parameters ---- */

#define LENGTH(NAME, MEMBER, FLAG, FOLLOWS, SUMMARY)                        \
  OPC_PARAMETER_NAMED(NAME, epe, MEMBER, .type = OPC_REAL, .flags = (FLAG), \
                      .unit = "nm", .follows = (FOLLOWS),                   \
                      .summary = (SUMMARY))
#define FROM_0(NAME, SUMMARY)                                       \
  OPC_PARAMETER(epe, NAME, .type = OPC_REAL, .flags = OPC_AT_LEAST, \
                .unit = "nm", .preset = "0 nm", .summary = (SUMMARY))
#define NUMBER(NAME, MEMBER, FLAG, MAX, PRESET, SUMMARY)                    \
  OPC_PARAMETER_NAMED(NAME, epe, MEMBER, .type = OPC_REAL, .flags = (FLAG), \
                      .max = (MAX), .preset = (PRESET), .summary = (SUMMARY))

static const opc_parameter parameters[] = {
    LENGTH("fragment", fragment, OPC_ABOVE, "0.233 lambda/NA",
           "length of the fragments of an edge"),
    LENGTH("concave_corner", concave_corner, OPC_ABOVE, "fragment",
           "length of a fragment beside a concave corner"),
    LENGTH("corner_edge", corner_edge, OPC_ABOVE, "fragment",
           "length of a fragment beside a convex corner"),
    LENGTH("line_end", line_end, OPC_AT_LEAST, "0.389 lambda/NA",
           "largest length of a line end, an edge between two convex corners "
           "that is one fragment"),
    LENGTH("ripple", ripple, OPC_ABOVE, "fragment",
           "length of the fragments beside the projection of a corner of "
           "another edge"),
    FROM_0(ripple_reach,
           "largest distance of a corner of another edge for 'ripple'; 0: no "
           "such fragments"),
    LENGTH("min_edge", min_edge, OPC_ABOVE, "min_edge of the step",
           "smallest length of a part of an edge between two jogs"),
    LENGTH("tangency", tangency, OPC_AT_LEAST, "0.155 lambda/NA",
           "distance of measurement sites from corners, where the contour is "
           "round"),
    LENGTH("min_width", min_width, OPC_AT_LEAST, "min_mask_width of the step",
           "smallest width of the mask, including bumps of edges"),
    LENGTH("min_space", min_space, OPC_AT_LEAST, "min_space of the step",
           "smallest space of the mask, including notches of edges"),
    FROM_0(min_jog,
           "smallest jog; adjacent fragments whose shifts differ by less "
           "receive one shift"),
    LENGTH("max_shift", max_shift, OPC_ABOVE, "0.233 lambda/NA",
           "largest shift of a fragment"),
    LENGTH("step", step, OPC_ABOVE, "0.031 lambda/NA",
           "largest change of a fragment's shift per iteration"),
    NUMBER("damping", damping, OPC_ABOVE | OPC_AT_MOST, 1, "0.7",
           "fraction of the computed change of shift that is applied in an "
           "iteration"),
    NUMBER("stiffness", stiffness, OPC_ABOVE, 0, "1",
           "weight of squared changes of shifts relative to squared errors: a "
           "larger value converges more slowly and reliably; 2 if features "
           "hardly print"),
    LENGTH("blur", blur, OPC_ABOVE, "0.155 lambda/NA",
           "standard deviation of the Gaussian that describes the effect of a "
           "shift on the contour nearby"),
    OPC_PARAMETER(
        epe, iterations, .type = OPC_INT, .flags = OPC_AT_LEAST, .preset = "80",
        .summary = "largest number of iterations; the synthesizer stops "
                   "earlier if the best iteration hardly improves"),
    OPC_PARAMETER_NAMED("layers", epe, which_layers, .type = OPC_CHOICE,
                        .preset = "both", .choices = "both|poly|active",
                        .summary = "corrected layers"),
    OPC_PARAMETER_NAMED("best", epe, which_best, .type = OPC_CHOICE,
                        .preset = "auto", .choices = "auto|epe|ion",
                        .summary = "criterion of the best iteration: smallest "
                                   "mean |EPE| or mean |Ion deviation|; "
                                   "auto: ion if transistors are corrected"),
    OPC_PARAMETER_NAMED("assist", epe, sraf_rows, .type = OPC_INT,
                        .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "0",
                        .max = 4,
                        .summary = "number of rows of assist features beside "
                                   "each edge, where the space permits"),
    LENGTH("assist_width", sraf_width, OPC_ABOVE, "0.194 lambda/NA",
           "width of an assist feature"),
    LENGTH("assist_distance", sraf_distance, OPC_ABOVE, "0.583 lambda/NA",
           "distance of the first row from drawn shapes"),
    LENGTH("assist_space", sraf_space, OPC_ABOVE, "0.311 lambda/NA",
           "space between assist features"),
    LENGTH("assist_min_length", sraf_min_length, OPC_ABOVE, "0.311 lambda/NA",
           "smallest length of an assist feature"),
    LENGTH("assist_overhang", sraf_overhang, OPC_AT_LEAST, "0.389 lambda/NA",
           "extension of an assist feature past the ends of its edge"),
    NUMBER("assist_margin", sraf_margin, OPC_AT_LEAST, 0, "0.02",
           "intensity margin to printing below which an assist feature is "
           "removed; relative to the clear field"),
    NUMBER(
        "window.level", window_level, OPC_ABOVE, 0, "0.01",
        "difference between the contour level of the nominal dose and of each "
        "of the two other doses, as an intensity relative to the clear field"),
    NUMBER("window.weight", window_weight, OPC_AT_LEAST | OPC_AT_MOST, 1, "0",
           "weight of the errors at other doses in the feedback"),
};

/* Set a mask rule that is NAN to the rule of the step or to `otherwise`. */
static void rule_follow(const eda_feedback *f, int rule, const char *otherwise,
                        double *nm) {
  if (!isnan(*nm)) return;
  *nm = f->rules && f->rules[rule] > 0 ? f->rules[rule]
                                       : eda_natural(&f->scanner, otherwise);
}

/* Compute the defaults of parameters that are not set. */
static void epe_follow(epe *d, const eda_feedback *f) {
  rule_follow(f, EDA_RULE_WIDTH, "0.155 lambda/NA", &d->min_width);
  rule_follow(f, EDA_RULE_SPACE, "0.155 lambda/NA", &d->min_space);
  int given = !isnan(d->min_edge);
  rule_follow(f, EDA_RULE_EDGE, "0.078 lambda/NA", &d->min_edge);
  EDA_FOLLOW(d->host, "synthesizer.epe", d, parameters, f->scanner);
  if (!given) d->min_edge = fmin(d->min_edge, d->fragment);
}

static const opc_metric metrics[] = {
    {"assists", NULL, OPC_NEUTRAL, 0, "number of assist features on the mask"},
    {"assists_dropped", NULL, OPC_LOWER, 0,
     "number of assist features removed because they print"},
};

static int epe_check(void *self, opc_error *error) {
  const epe *d = self;
  if (!(d->min_edge > d->fragment))
    return OPC_OK; /* also if one of the lengths is unknown (NAN) */
  return opc_fail(error, OPC_INVALID, "min_edge",
                  "'min_edge' is %g nm, expected at most 'fragment', %g nm",
                  d->min_edge, d->fragment);
}

/* ---- entry ---- */

static const eda_synthesizer functions = {.begin = epe_begin_run,
                                          .update = epe_update,
                                          .verdict = epe_verdict,
                                          .cut = epe_cut_layer};

OPC_PLUGIN(epe, .id = "synthesizer.epe", .kind = "synthesizer",
           .version = "0.2.0", .licence = "BSD-3-Clause",
           .summary =
               "edge placement error OPC: fragments move until the contour "
               "is on the drawn edge",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics), .check = epe_check,
           .clear = epe_clear_all, OPC_FUNCTIONS(functions));
