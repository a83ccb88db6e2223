/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `correct`: runs the correction loop
   (subprojects/correct/loop.c) for a whole layout and reports the result, or
   corrects the layout by classes (divide.c). */
#include <eda/memory.h>
#include <glib.h>
#include <inttypes.h>
#include <math.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdlib.h>

#include <correct/findings.h>
#include <correct/fine.h>
#include <correct/loop.h>
#include <correct/rules.h>
#include "divide.h"

/* ---- state: divide.h ---- */

/* ---- work ---- */

static void correct_log_overlaps(const loop *l) {
  for (size_t k = 0; k < l->gates->layers; k++)
    if (!l->base && !l->now.added[k].count && !l->now.cutouts[k].count &&
        !l->now.assists[k].count &&
        eda_area2(&l->polygons[k]) != eda_area2(&l->mask[k])) {
      l->host->log(l->host, OPC_LOG_WARNING,
                   "\"displaced edges of the mask of a layer overlap: their "
                   "polygons are merged\"");
      return;
    }
}

/* Move the shapes, images and figures of the loop into the result. */
static void hand_over(loop *l, eda_mask *out) {
  for (size_t k = 0; k < l->gates->layers; k++) {
    out->shapes[k] = l->mask[k];
    out->print[k] = l->printer.print[k];
    out->drawn_print[k] = l->drawn_print[k];
    l->mask[k] = (eda_shapes){0};
    l->printer.print[k] = l->drawn_print[k] = (eda_field){0};
  }
  corners *c = &l->corners; /* the result contains the nominal figures */
  eda_performance *after = c->count ? &c->nominal : &l->measured.performance;
  out->design = l->design;
  out->before = l->before;
  out->after = *after;
  l->design = l->before = *after = (eda_performance){0};
  out->flags = l->measured.flags;
  l->measured.flags = NULL;
  out->iterations = l->iterations;
  out->simulations = l->printer.simulations;
  out->fine_simulations = l->printer.fine_simulations;
  out->moved = correct_moved_of(l);
}

static int correct_report_found(loop *l, eda_mask *out, opc_error *error) {
  eda_printed p = correct_loop_printed(l);
  return correct_report_rules(l->host, l->regulator, &p, out, error);
}

static int correct_report_guard(const loop *l, opc_error *error) {
  const guard *g = &l->guard;
  if (!l->gates->count) return OPC_OK;
  correct_findings_of_print(l->host, l->gates, NULL, l->measured.flags,
                            g->flags);
  correct_findings_of_guard(l->host, g, l->hold);
  const opc_metric_value values[] = {{"went_back", (double)g->back},
                                     {"worse", (double)g->worse},
                                     {"lost", (double)g->lost}};
  return opc_put_metrics(l->host, OPC_ARRAY(values), error);
}

/* Write all tables, metrics and findings. Call after hand_over. */
static int correct_report(const correct *c, loop *l, eda_mask *mask,
                          opc_error *error) {
  size_t n = c->gates->count;
  char **held = eda_alloc(n, sizeof *held);
  for (size_t i = 0; i < n; i++) held[i] = correct_guard_verdict(&l->guard, i);
  const report content = {.mask = mask,
                          .extension = l->measured.extension,
                          .sites = l->sites,
                          .biases = &l->now.biases,
                          .synthesizer = l->drivers[MAIN].module,
                          .held = held,
                          .flags_before = l->guard.flags};
  int code = correct_report_mask(c->host, &content, error);
  for (size_t i = 0; i < n; i++) g_free(held[i]);
  free(held);
  if (!code) code = correct_history_report(&l->history, c->host, error);
  if (!code && l->traced) code = correct_trace_report(&l->trace, l, error);
  return code;
}

static int correct_put_settings(const correct *c, opc_error *error);

/* Correct the whole layout. outputs[0] is the mask of c->gates. */
static int whole_run(const correct *c, void **outputs, opc_error *error) {
  eda_mask *mask = outputs[0];
  loop l;
  correct_loop_init(&l, c->host, c->gates, &c->with);
  l.start = c->start;
  l.prepared = c->prepared;
  l.traced = c->trace;
  l.drivers[EDGES].module = c->edges;
  l.corners.request = c->corners;
  l.assists = c->assists;
  l.search = c->search;
  int code = correct_loop_run(&l, error);
  if (!code) {
    correct_log_overlaps(&l);
    code = correct_report_found(&l, mask, error);
  }
  if (!code) code = correct_corners_report(&l, error);
  if (!code) code = correct_assists_report(&l, error);
  if (!code)
    code =
        correct_rules_report(c->host, c->gates, l.mask, c->with.rules, error);
  if (!code) code = correct_report_guard(&l, error);
  if (!code) {
    hand_over(&l, mask);
    code = correct_findings_of_slices(c->host, mask, c->with.extractor, error);
  }
  if (!code) code = correct_report(c, &l, mask, error);
  correct_loop_clear(&l);
  return code;
}

static void whole_forecast(const correct *c, const eda_gates *gates,
                           opc_forecast *out) {
  char fast[48], both[80];
  (void)snprintf(fast, sizeof fast, "at most %" PRId64 " simulations",
                 c->with.max_iterations + 1);
  (void)snprintf(both, sizeof both, "%s and %d accurate simulations", fast,
                 VERIFICATIONS + 1);
  correct_forecast(&c->with, c->host, gates, fast, both, out);
  out->memory *= (double)correct_corners_images(&c->corners);
}

static int correct_mask(correct *c, void **outputs, opc_error *error) {
  int by_classes = 0;
  int code = divide_check(c, error);
  if (!code) code = correct_put_settings(c, error);
  if (!code && c->layout)
    code = divide_run(c, whole_forecast, outputs, &by_classes, error);
  if (code || by_classes) return code;
  code = correct_start_check(&c->start, c->gates, error);
  if (code) return code;
  eda_mask *mask = eda_mask_new(c->gates);
  outputs[0] = mask; /* released by the host on failure */
  if (c->layout) mask->own = divide_take_gates(c);
  return whole_run(c, outputs, error);
}

static int correct_run(void *self, void **outputs, opc_error *error) {
  correct *c = self;
  int code = correct_mask(c, outputs, error);
  return code ? code
              : correct_report_transistors(c->host, outputs[0], c->transistors,
                                           error);
}

static int correct_step_forecast(void *self, opc_forecast *out,
                                 opc_error *error) {
  correct *c = self;
  int code = divide_check(c, error);
  if (code) return code;
  if (c->layout) return divide_forecast(c, whole_forecast, out, error);
  whole_forecast(c, c->gates, out);
  code = eda_extractor_prepare(c->host->context, c->with.extractor, error);
  if (code) return code;
  c->prepared = 1;
  correct_findings_of_drawing(c->host, c->gates, c->with.extractor);
  return OPC_OK;
}

static int correct_step_sketch(void *self, void **outputs, opc_error *error) {
  correct *c = self;
  return c->layout ? divide_sketch(c, whole_forecast, outputs, error)
                   : correct_sketch_mask(c->gates, outputs);
}

/* ---- restoring ---- */

static int correct_restore(void *self, const char *folder, void **outputs,
                           opc_error *error) {
  correct *c = self;
  return c->layout ? divide_restore(c, folder, outputs, error)
                   : eda_mask_restore(c->gates, folder, &outputs[0], error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(correct, layout, .type = OPC_INPUT, .choices = "layout",
                  .given = offsetof(correct, layout_given),
                  .summary = "Layout to correct, with the layers required by "
                             "segment.transistors"),
    OPC_PARAMETER(correct, gates, .type = OPC_INPUT, .choices = "gates",
                  .given = offsetof(correct, gates_given),
                  .summary = "Transistors to correct as a whole, instead of "
                             "'layout'"),
    OPC_PARAMETER(
        correct, divide, .type = OPC_CHOICE, .preset = "auto",
        .choices = "auto|whole|environments|cells",
        .summary = "Division of the layout: whole, classes of transistors in "
                   "equivalent environments, or these classes with masks of "
                   "cells; auto: by size and repetition, without cells"),
    DIVIDE_PARAMETERS(correct),
    OPC_PARAMETER_NAMED(
        "start", correct, start.mask, .type = OPC_INPUT, .choices = "mask",
        .summary =
            "Mask of the same gates to start from (default: the drawn one)"),
    OPC_PARAMETER(
        correct, max_diff, .type = OPC_REAL, .flags = OPC_AT_LEAST, .unit = "%",
        .min = 0,
        .summary = "Largest increase of |Ion deviation| from the cell to the "
                   "layout for which a transistor keeps its mask"),
    CORRECT_PRINT_SLOTS(correct),
    CORRECT_MOVE_SLOTS(correct),
    OPC_PARAMETER(
        correct, edges, .type = OPC_SLOT, .choices = "synthesizer",
        .summary =
            "Algorithm that displaces edges of layers without transistors"),
    CORRECT_MAX_ITERATIONS(correct, "Largest number of iterations"),
    OPC_PARAMETER_NAMED(
        "margin", correct, with.margin, .type = OPC_REAL, .flags = OPC_AT_LEAST,
        .unit = "nm", .follows = FINE_MARGIN, .min = 0,
        .summary = "Width of the clear field around the layout; a third of "
                   "this default without accurate simulations"),
    CORRECT_FINE(correct),
    CORNERS_PARAMETERS(correct),
    ASSISTS_PARAMETERS(correct),
    SEARCH_PARAMETERS(correct),
    CORRECT_GUARD(correct),
    CORRECT_ION_LIMIT(
        correct,
        "Largest allowed |Ion deviation|; the guard reverts a transistor above "
        "the limit if its deviation is smaller with the drawn mask"),
    RULES_PARAMETERS(correct),
    OPC_PARAMETER(
        correct, trace, .type = OPC_BOOL, .preset = "false",
        .summary =
            "Write trace.csv with a row for each transistor and simulation"),
    REPORT_TRANSISTORS(correct),
};

static const opc_metric metrics[] = {
    {"transistors", NULL, OPC_NEUTRAL, 0, "number of corrected transistors"},
    DIVIDE_METRICS,
    REPORT_METRICS,
    REPORT_DRAWN_METRICS,
    {.name = "epe_mean",
     .unit = "nm",
     .better = OPC_LOWER,
     .tolerance = 0.01,
     .summary =
         "mean of |edge placement error| of the synthesizer's fragments"},
    {"epe_max", "nm", OPC_LOWER, 0.01, "largest |edge placement error|"},
    {"epe_lost", NULL, OPC_LOWER, 0,
     "fragments without a printed edge within 0.389 lambda/NA"},
    {"refined", NULL, OPC_NEUTRAL, 0,
     "transistors that were corrected again because they deviate"},
    {"iterations", NULL, OPC_LOWER, 0, "number of iterations"},
    {"simulations", NULL, OPC_LOWER, 0, "litho simulations of one layer each"},
    {"fine_simulations", NULL, OPC_LOWER, 0,
     "additional simulations of the accurate model"},
    REPORT_PRINT_METRICS,
    {"went_back", NULL, OPC_LOWER, 0,
     "transistors reverted towards the drawn mask by the guard"},
    REPORT_JUDGED_METRICS,
    CORNERS_METRICS,
    {"assists", NULL, OPC_NEUTRAL, 0, "scatter bars of the mask"},
    {"assists_dropped", NULL, OPC_LOWER, 0,
     "scatter bars removed because they printed"},
    RULES_METRICS,
};

/* Set the lengths of features that are switched off. 0: do not derive the
   length from the optics. NAN: do not publish the length. */
static void set_unused(correct *c, double value) {
  gate_srafs *a = &c->assists;
  sraf_search_state *s = &c->search;
  double *const srafs[] = {&a->width, &a->distance, &a->space, &a->min_length,
                           &a->overhang};
  double *const searched[] = {&s->min_gain,   &s->defocus,  &s->least_width,
                              &s->width,      &s->distance, &s->space,
                              &s->min_length, &s->length};
  for (size_t i = 0; i < G_N_ELEMENTS(srafs) && !a->rows; i++)
    *srafs[i] = value;
  for (size_t i = 0; i < G_N_ELEMENTS(searched) && !s->most; i++)
    *searched[i] = value;
}

static void correct_follow(correct *c) {
  set_unused(c, 0);
  EDA_FOLLOW(c->host, "correct", c, parameters, eda_scanner_of(c->with.litho));
  set_unused(c, NAN);
}

static int correct_put_settings(const correct *c, opc_error *error) {
  return opc_put_followed(c->host, c, OPC_ARRAY(parameters), error);
}

static int correct_check(void *self, opc_error *error) {
  correct *c = self;
  double margin = c->with.margin;
  int code = correct_settings_check(&c->with, c->host, error);
  correct_follow(c);
  c->margin = correct_classes_margin(&c->with, margin);
  if (!code) code = divide_check_settings(c, error);
  return code ? code : correct_corners_check(&c->corners, error);
}

static void correct_clear(void *self) {
  correct *c = self;
  eda_gates_free(c->own);
}

/* ---- entry ---- */

static const opc_port outputs[] = {EDA_PORT_MASK("mask")};
static const opc_step functions = {OPC_OUTPUTS(outputs),
                                   .run = correct_run,
                                   .forecast = correct_step_forecast,
                                   .sketch = correct_step_sketch,
                                   .save = correct_save_mask,
                                   .restore = correct_restore,
                                   .flags = OPC_STEP_PIECES};

OPC_PLUGIN(
    correct, .id = "correct", .kind = "step", .version = OPC_VERSION,
    .licence = "BSD-3-Clause",
    .summary = "displace mask edges until every transistor performs as drawn",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics), .check = correct_check, .clear = correct_clear,
    OPC_FUNCTIONS(functions));
