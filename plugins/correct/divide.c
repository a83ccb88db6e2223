/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the division of a layout: as a whole, or by classes of transistors
   in equivalent optical environments. */
#include "divide.h"

#include <glib.h>
#include <math.h>
#include <stdlib.h>

#include <correct/findings.h>

/* Constants of the decision. */
static const struct {
  double least, searched, repeated, most;
} tuned = {
    /* Smallest number of polygons of poly for which environments are compared.
       Below, correcting the whole layout takes less than a second. */
    .least = 1000,

    /* Largest number of polygons of poly for which `opcflow check` finds the
       environments, in at most about a second, and for which the forecast of
       `auto` is that of the whole, up to `most`. For more polygons, the
       forecast uses a sample of the environments. */
    .searched = 20000,

    /* Largest number of classes per transistor for which classes take less time
       than the whole. */
    .repeated = 0.25,

    /* Largest forecast of memory of a whole layout, bytes. The limit, and so
       the result, is the same on all machines. */
    .most = 4e9,
};

/* ---- settings ---- */

static int conflict(const char *parameter, const char *why, opc_error *error) {
  return opc_fail(error, OPC_INVALID, parameter, "'%s' %s", parameter, why);
}

int divide_check_settings(const correct *c, opc_error *error) {
  if (c->gates_given && c->layout_given)
    return conflict("gates", "and 'layout' exclude each other", error);
  if (c->gates_given && c->divide >= DIVIDE_ENVIRONMENTS)
    return conflict("divide", "of a layout requires 'layout'", error);
  if (c->gates_given && c->top)
    return conflict("top", "requires 'layout'", error);
  if (c->gates_given && c->flavours.count)
    return conflict("flavours", "requires 'layout'", error);
  if (c->gates_given && c->also.count)
    return conflict("also", "requires 'layout'", error);
  if (c->gates_given && !isnan(c->overhang))
    return conflict("overhang", "requires 'layout'", error);
  if (c->gates_given && !isnan(c->line_end))
    return conflict("line_end", "requires 'layout'", error);
  if (!c->verify && c->divide != DIVIDE_CELLS)
    return conflict("verify", "of 'false' requires 'divide: cells'", error);
  if (c->radius > c->window)
    return opc_fail(error, OPC_INVALID, "radius",
                    "'radius' is %.4g nm, expected at most 'window', %.4g nm",
                    c->radius, c->window);
  eda_segment_settings settings = EDA_SEGMENT_SETTINGS(c);
  return eda_segment_check(&settings, error);
}

/* Return why the layout cannot be corrected by classes; NULL: it can. */
static const char *divide_obstacle(const correct *c) {
  const eda_synthesizer *s = c->with.synthesizer->functions;
  if (c->also.count) return "'also': layers without transistors";
  if (s->cut) return "a synthesizer that dissects edges";
  if (c->edges) return "'edges'";
  if (c->start.mask) return "'start'";
  if (c->assists.rows || c->search.most) return "assist features";
  if (correct_corners_count(&c->corners)) return "'corners'";
  return c->trace ? "'trace'" : NULL;
}

int divide_check(const correct *c, opc_error *error) {
  const char *obstacle = divide_obstacle(c);
  if (c->divide >= DIVIDE_ENVIRONMENTS && obstacle)
    return opc_fail(error, OPC_INVALID, "divide",
                    "'%s' does not support %s: set 'divide: whole'",
                    c->divide == DIVIDE_CELLS ? "cells" : "environments",
                    obstacle);
  if (!isnan(c->max_diff) && c->divide != DIVIDE_CELLS)
    return conflict("max_diff", "requires 'divide: cells'", error);
  if (!c->layout == !c->gates)
    return opc_fail(error, OPC_INVALID, "layout",
                    "set either 'layout' or 'gates'");
  return OPC_OK;
}

/* Return 1 if the layout is corrected as a whole without a search for
   environments. `polygons`: number of polygons of poly. */
static int divide_is_whole(const correct *c, double polygons) {
  if (c->divide != DIVIDE_AUTO) return c->divide == DIVIDE_WHOLE;
  return polygons < tuned.least || divide_obstacle(c);
}

/* ---- requests ---- */

static classes_request divide_request(correct *c) {
  c->source = (classes_source){c->host, &c->with, c->margin};
  return (classes_request){.host = c->host,
                           .layout = c->layout,
                           .top = c->top,
                           .segment = EDA_SEGMENT_SETTINGS(c),
                           .with = &c->with,
                           .radius = c->radius,
                           .margin = c->margin,
                           .window = c->window,
                           .rounds = c->rounds,
                           .cells = {.used = c->divide == DIVIDE_CELLS,
                                     .verify = c->verify,
                                     .boundary = c->neighbours,
                                     .max_diff = c->max_diff}};
}

/* Return a low estimate of the number of transistors: the polygons of poly. */
static double divide_polygons(const correct *c, int32_t top) {
  const double box = 4 * sizeof(eda_point) + 2 * sizeof(uint32_t);
  int32_t layer = eda_layout_find_layer(c->layout, "poly");
  return layer < 0 ? 0 : eda_layout_flat_bytes(c->layout, top, layer) / box;
}

static void divide_log(void *data, int warning, const char *message) {
  const opc_host *host = data;
  host->log(host, warning ? OPC_LOG_WARNING : OPC_LOG_INFO, "correct: %s",
            message);
}

/* Segment the whole layout into c->gates. */
static int divide_segment(correct *c, opc_error *error) {
  eda_segment_settings settings = EDA_SEGMENT_SETTINGS(c);
  eda_segment_report report;
  settings.log = divide_log;
  settings.data = (void *)c->host;
  int32_t top = eda_segment_top(c->layout, c->top, error);
  if (top < 0) return error->code;
  if (c->own) return OPC_OK;
  int code = eda_segment(c->host->context, c->layout, top, &settings, &c->own,
                         &report, error);
  c->gates = c->own;
  return code;
}

eda_gates *divide_take_gates(correct *c) {
  eda_gates *g = c->own;
  c->own = NULL;
  return g;
}

/* ---- forecast ---- */

/* Set `out` to gates without shapes, with the extent and the estimated number
   of transistors of the layout. */
static int divide_outline(correct *c, int32_t top, double transistors,
                          eda_gates *out, opc_error *error) {
  static uint8_t corrected[] = {1, 1};
  static const char *const names[] = {"poly", "active"};
  *out = (eda_gates){.grid = c->grid,
                     .layers = 2,
                     .corrected = corrected,
                     .count = (size_t)transistors,
                     .extent = EDA_BOX_EMPTY};
  for (int k = 0; k < 2; k++) {
    eda_box b;
    int32_t layer = eda_layout_find_layer(c->layout, names[k]);
    if (layer < 0) continue;
    int code = eda_layout_bounds(c->layout, top, layer, c->grid, &b, error);
    if (code) return code;
    eda_box_join(&out->extent, b);
  }
  return OPC_OK;
}

/* Measured memory of a correction by classes, bytes. `start`, `start_fine`:
   libraries, kernels and the fields of a sheet of a repetitive layout, without
   and with accurate simulations, two threads. `class`: a class. `record`: the
   record of a transistor, in a file. `transistors`: number of transistors of a
   memory per polygon of poly. */
static const struct {
  double start, start_fine, class, record, transistors;
} memory = {130e6, 175e6, 1900, sizeof(eda_chip_gate), 0.5};

static int is_accurate(const correct *c) {
  const eda_litho *litho = c->with.litho->functions;
  return c->with.fine > 0 && litho->image_fine;
}

/* Return the side of a clip with its margins, grid steps. `side`: of the
   layout, which is bisected until the parts fit into a window. */
static double divide_clip(const correct *c, double side) {
  double whole = side * c->grid;
  while (side * c->grid > c->window) side /= 2;
  return side + (side * c->grid < whole ? 3 * c->margin / c->grid : 0);
}

/* Return the memory of a sheet, bytes. `all`: outline of the layout;
   `repeated`: 1: environments repeat, so that sheets contain few clips. A
   layout that fits on a sheet is simulated as a whole. */
static double divide_sheet(const correct *c, const eda_gates *all, int repeated,
                           divide_whole *whole) {
  eda_gates g = *all;
  opc_forecast one = {0};
  eda_box *e = &g.extent;
  double wide = (double)e->x1 - e->x0, high = (double)e->y1 - e->y0,
         clip_wide = divide_clip(c, wide), clip_high = divide_clip(c, high),
         part = clip_wide / wide * (clip_high / high);
  e->x1 = e->x0 + (int32_t)clip_wide;
  e->y1 = e->y0 + (int32_t)clip_high;
  g.count = (size_t)((double)g.count * part);
  whole(c, &g, &one);
  if (part >= 1 || !repeated) return one.memory;
  return fmin(one.memory, is_accurate(c) ? memory.start_fine : memory.start);
}

/* Estimate the number of classes per transistor from a sample of windows; 0
   if the sample has no transistors. */
static int divide_sample(correct *c, double *share, opc_error *error) {
  classes_request r = divide_request(c);
  division *d;
  size_t n;
  r.sample = 1;
  int code = correct_classes_find(&r, &d, error);
  size_t classes = correct_classes_count(d, &n);
  *share = n ? (double)classes / (double)n : 0;
  correct_classes_free(d);
  return code;
}

/* Return OPC_OK, or an error if the layout lacks the layers of transistors. */
static int divide_check_layers(const correct *c, int32_t top,
                               opc_error *error) {
  static const eda_box nowhere = {0, 0, 1, 1};
  eda_segment_settings settings = EDA_SEGMENT_SETTINGS(c);
  eda_gates *none = NULL;
  int code =
      eda_segment_window(c->layout, top, &settings, &nowhere, &none, error);
  eda_gates_free(none);
  return code;
}

/* Forecast the correction of the whole layout. */
static void forecast_whole(const correct *c, int32_t top, opc_forecast *out) {
  eda_segment_settings settings = EDA_SEGMENT_SETTINGS(c);
  const char *obstacle = divide_obstacle(c);
  out->memory += eda_segment_bytes(c->layout, top, &settings);
  if (obstacle)
    (void)snprintf(out->help, sizeof out->help,
                   "part of the layout, or no %s, for 'divide: environments'",
                   obstacle);
}

/* Forecast the correction by classes. `share`: classes per transistor. */
static void forecast_classes(const correct *c, const eda_gates *all,
                             double share, divide_whole *whole,
                             opc_forecast *out) {
  int repeated = share <= tuned.repeated;
  double n = (double)all->count * (repeated ? memory.transistors : 1);
  out->memory = divide_sheet(c, all, repeated, whole) +
                (memory.record + memory.class * share) * n;
  (void)snprintf(out->work, sizeof out->work,
                 "about %.0f transistors in windows of %g um", n,
                 c->window / 1000);
  (void)snprintf(out->help, sizeof out->help,
                 "a smaller 'window', or part of the layout");
}

int divide_forecast(correct *c, divide_whole *whole, opc_forecast *out,
                    opc_error *error) {
  eda_gates g;
  double share = 1;
  int32_t top = eda_segment_top(c->layout, c->top, error);
  if (top < 0) return error->code;
  double polygons = divide_polygons(c, top);
  int code = divide_check_layers(c, top, error);
  if (!code) code = divide_outline(c, top, polygons, &g, error);
  if (code) return code;
  whole(c, &g, out);
  int is_whole = divide_is_whole(c, polygons),
      is_open = c->divide == DIVIDE_AUTO && out->memory <= tuned.most;
  if (!is_whole && (!is_open || polygons > tuned.searched))
    code = divide_sample(c, &share, error);
  if (code) return code;
  if (is_whole || (is_open && share > tuned.repeated))
    forecast_whole(c, top, out);
  else
    forecast_classes(c, &g, share, whole, out);
  return OPC_OK;
}

int divide_restore(correct *c, const char *folder, void **outputs,
                   opc_error *error) {
  classes_request r = divide_request(c);
  g_autofree char *path = g_build_filename(folder, "classes", NULL);
  if (g_file_test(path, G_FILE_TEST_EXISTS))
    return correct_classes_restore(&r, &c->source, folder, &outputs[0], error);
  int code = divide_segment(c, error);
  if (!code) code = eda_mask_restore(c->gates, folder, &outputs[0], error);
  if (outputs[0]) ((eda_mask *)outputs[0])->own = divide_take_gates(c);
  return code;
}

/* ---- decision ---- */

/* Return 1 if the layout is corrected by classes, given the forecast of memory
   of the whole. */
static int divide_decide(const correct *c, const division *d, double memory_all,
                         char **why) {
  size_t n, classes = correct_classes_count(d, &n);
  double ratio = n ? (double)classes / (double)n : 1;
  *why = g_strdup_printf(
      "%zu of %zu environments differ, and the whole takes "
      "about %.2g GB of memory",
      classes, n, memory_all / 1e9);
  if (c->divide != DIVIDE_AUTO) return c->divide >= DIVIDE_ENVIRONMENTS;
  return ratio <= tuned.repeated || memory_all > tuned.most;
}

/* Find the environments, if a decision needs them. *d remains NULL for the
   whole. */
static int divide_find(correct *c, divide_whole *whole, division **d,
                       opc_error *error) {
  eda_gates g;
  opc_forecast all = {0};
  size_t n = 0;
  *d = NULL;
  int32_t top = eda_segment_top(c->layout, c->top, error);
  if (top < 0) return error->code;
  double polygons = divide_polygons(c, top);
  if (divide_is_whole(c, polygons)) return OPC_OK;
  classes_request r = divide_request(c);
  int code = correct_classes_find(&r, d, error);
  if (!code) {
    (void)correct_classes_count(*d, &n);
    code = divide_outline(c, top, (double)n, &g, error);
  }
  if (code) return code;
  whole(c, &g, &all);
  g_autofree char *why = NULL;
  int by_classes = divide_decide(c, *d, all.memory, &why);
  if (c->divide == DIVIDE_AUTO)
    c->host->log(c->host, OPC_LOG_INFO, "divide: %s, because %s",
                 by_classes ? "environments" : "whole", why);
  if (by_classes) return OPC_OK;
  correct_classes_free(*d);
  *d = NULL;
  return OPC_OK;
}

int divide_run(correct *c, divide_whole *whole, void **outputs, int *by_classes,
               opc_error *error) {
  /* Not an error: comparisons of 'divide' have one setting for all. */
  if (c->neighbours && c->divide != DIVIDE_CELLS)
    c->host->log(c->host, OPC_LOG_FINDING,
                 "'neighbours' has no effect without 'divide: cells'");
  division *d;
  int code = divide_find(c, whole, &d, error);
  *by_classes = d != NULL;
  if (!code && d)
    code = correct_classes_correct(d, &c->source, &outputs[0], error);
  correct_classes_free(d);
  if (code || *by_classes) return code;
  code = divide_segment(c, error);
  if (!code)
    code = eda_extractor_prepare(c->host->context, c->with.extractor, error);
  if (code) return code;
  c->prepared = 1;
  correct_findings_of_drawing(c->host, c->gates, c->with.extractor);
  return OPC_OK;
}

int divide_sketch(correct *c, divide_whole *whole, void **outputs,
                  opc_error *error) {
  division *d = NULL;
  int32_t top = eda_segment_top(c->layout, c->top, error);
  if (top < 0) return error->code;
  double polygons = divide_polygons(c, top);
  int by_classes = polygons > tuned.searched && !divide_is_whole(c, polygons);
  int code = by_classes ? OPC_OK : divide_find(c, whole, &d, error);
  by_classes |= d != NULL;
  correct_classes_free(d);
  if (code) return code;
  classes_request r = divide_request(c);
  if (by_classes)
    return correct_classes_sketch(&r, &c->source, &outputs[0], error);
  code = divide_segment(c, error);
  if (!code) code = correct_sketch_mask(c->gates, outputs);
  if (outputs[0]) ((eda_mask *)outputs[0])->own = divide_take_gates(c);
  return code;
}
