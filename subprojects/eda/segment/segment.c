/* SPDX-License-Identifier: BSD-3-Clause */
/* Segmentation of a whole layout: the transistors, the mask edges that control
   them (thesis 2.2.5 and 3.2.2), and further layers, whose edges belong to no
   transistor. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "segment/windows.h"

/* Layer names in the layout and in the gates. */
static const char *const dopings[DOPINGS] = {"nwell", "pwell", "nimplant",
                                             "pimplant"};
enum { CONTACT = 2, KNOWN = 3 };
static const char *const known[KNOWN] = {"poly", "active", "contact"};

void segment_log(const segment *s, int warning, const char *format, ...) {
  if (!s->settings->log || s->window) return;
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  (void)vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  s->settings->log(s->settings->data, warning, text);
}

/* ---- settings ---- */

static void get_sources(segment *s) {
  const eda_segment_settings *from = s->settings;
  s->sources = KNOWN + from->also_count;
  s->source = eda_alloc(s->sources, sizeof *s->source);
  for (size_t k = 0; k < KNOWN; k++)
    s->source[k].name = s->source[k].from = known[k];
  for (size_t i = 0; i < from->also_count; i++) {
    s->source[KNOWN + i].name = from->also[2 * i];
    s->source[KNOWN + i].from = from->also[2 * i + 1];
  }
}

/* Set the parameter of the error to a key of `also`. */
static int error_set_key(opc_error *error, const char *name) {
  (void)snprintf(error->parameter, sizeof error->parameter, "also.%.58s", name);
  return error->code;
}

/* Return whether a further layer may have this name: a word of letters, digits
   and '_' that does not end in "_drawn". Writers use NAME_drawn for the drawn
   shapes of layer NAME. */
static int is_layer_name(const char *name) {
  size_t n = strlen(name);
  static const char drawn[] = "_drawn";
  size_t end = sizeof drawn - 1;
  return n &&
         strspn(name,
                "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                "0123456789_") == n &&
         (n < end || strcmp(name + n - end, drawn) != 0);
}

static int check_pair(const source *a, const source *b, opc_error *error) {
  if (!strcmp(a->name, b->name))
    return opc_fail(error, OPC_INVALID, NULL,
                    "'%.200s': a layer of this name exists already", a->name);
  if (!strcmp(a->from, b->from))
    return opc_fail(error, OPC_INVALID, NULL,
                    "'%.200s': layer %.200s is '%.200s' already", a->name,
                    a->from, b->name);
  return OPC_OK;
}

int eda_segment_check(const eda_segment_settings *settings, opc_error *error) {
  segment s = {.settings = settings};
  get_sources(&s);
  int code = OPC_OK;
  for (size_t i = KNOWN; !code && i < s.sources; i++) {
    if (!is_layer_name(s.source[i].name))
      code = opc_fail(error, OPC_INVALID, NULL,
                      "'%.200s' cannot be the name of a layer: expected "
                      "letters, digits and '_', not ending in '_drawn'",
                      s.source[i].name);
    for (size_t j = 0; !code && j < i; j++)
      code = check_pair(&s.source[i], &s.source[j], error);
    if (code) error_set_key(error, s.source[i].name);
  }
  free(s.source);
  return code ? code : segment_check_flavours(settings, error);
}

/* ---- layers ---- */

/* Report a missing layer and list the existing ones as far as they fit. */
static int no_layer(segment *s, const char *name) {
  char all[512] = "none";
  size_t n = eda_layout_layers(s->layout), used = 0;
  for (size_t k = 0; k < n && used + 80 < sizeof all; k++)
    used += (size_t)snprintf(all + used, sizeof all - used, "%s%.60s",
                             used ? ", " : "",
                             eda_layout_layer_name(s->layout, (int32_t)k));
  return opc_fail(s->error, OPC_INVALID, NULL,
                  "no transistors: the layout has no layer '%s', but %s; name "
                  "the layer in 'layers' of the reader",
                  name, all);
}

/* Check that all layers exist, except contacts, and that further layers have
   shapes. */
static int check_layers(segment *s) {
  for (size_t k = 0; k < s->sources; k++) {
    const char *from = s->source[k].from;
    if (k == CONTACT || eda_layout_find_layer(s->layout, from) >= 0) continue;
    if (k < KNOWN) return no_layer(s, from);
    (void)eda_layout_select(s->layout, from, s->error);
    return error_set_key(s->error, s->source[k].name);
  }
  return OPC_OK;
}

/* Compute which layers have shapes, and their common bounds. */
static int find_bounds(segment *s) {
  s->bounds = (eda_box)EDA_BOX_EMPTY;
  for (size_t k = 0; k < s->sources; k++) {
    source *from = &s->source[k];
    int32_t layer = eda_layout_find_layer(s->layout, from->from);
    eda_box b = {0, 0, -1, -1};
    if (layer >= 0 &&
        eda_layout_bounds(s->layout, s->top, layer, s->grid, &b, s->error))
      return s->error->code;
    from->drawn_at_all = b.x0 <= b.x1;
    if (from->drawn_at_all)
      eda_box_join(&s->bounds, b);
    else if (k >= KNOWN) {
      opc_fail(s->error, OPC_INVALID, NULL, "layer '%.200s' is empty",
               from->from);
      return error_set_key(s->error, from->name);
    }
  }
  return OPC_OK;
}

/* A layer to flatten, one of several in parallel. */
typedef struct task {
  const segment *s;
  const char *name;
  eda_flat *flat;
  eda_shapes *merged;
  int code;
  opc_error error;
} task;

/* Flatten a layer; empty if the layout lacks it. */
static void get_layer(void *data, size_t i) {
  task *t = (task *)data + i;
  const segment *s = t->s;
  int32_t layer = eda_layout_find_layer(s->layout, t->name);
  if (layer >= 0)
    t->code = segment_flatten(s->layout, s->top, layer, s->grid, s->window,
                              t->flat, t->merged, &t->error);
}

/* Count the vertices of a layer displaced by the grid. */
static void count_moved(segment *s, size_t k, const eda_flat *flat) {
  s->report.moved += flat->moved;
  s->report.worst = fmax(s->report.worst, flat->worst);
  if (k <= EDA_ACTIVE) s->moved += flat->moved;
  if (flat->moved)
    segment_log(s, 0,
                "the grid of %g nm moved %zu of %zu vertices of layer '%s', by "
                "%.3g nm at most",
                s->grid, flat->moved, flat->vertices, s->source[k].from,
                flat->worst);
}

int segment_layers(segment *s) {
  size_t n = s->sources + DOPINGS;
  task *tasks = eda_alloc(n, sizeof *tasks);
  eda_flat *flat = eda_alloc(n, sizeof *flat);
  for (size_t k = 0; k < n; k++) {
    size_t d = k - s->sources;
    tasks[k] =
        (task){.s = s,
               .name = k < s->sources ? s->source[k].from : dopings[d],
               .flat = &flat[k],
               .merged = k < s->sources ? &s->source[k].drawn : &s->doping[d]};
  }
  opc_parallel(s->context, n, get_layer, tasks);
  int code = OPC_OK;
  for (size_t k = 0; k < n; k++) {
    if (!code && tasks[k].code) {
      *s->error = tasks[k].error;
      code = tasks[k].code;
    }
    if (k >= s->sources)
      s->has_doping[k - s->sources] =
          eda_layout_find_layer(s->layout, tasks[k].name) >= 0;
    else if (!code)
      count_moved(s, k, &flat[k]);
    if (k == EDA_ACTIVE)
      s->active = flat[k];
    else
      eda_flat_clear(&flat[k]);
  }
  free(tasks);
  free(flat);
  return code;
}

/* ---- gates ---- */

int segment_regions(segment *s) {
  return eda_boolean(EDA_AND, &s->source[EDA_POLY].drawn,
                     &s->source[EDA_ACTIVE].drawn, &s->regions, s->error);
}

static int want_regions(segment *s) {
  if (s->window || s->regions.count) return OPC_OK;
  return opc_fail(s->error, OPC_INVALID, NULL,
                  "no transistors: layers 'poly' and 'active' do not overlap");
}

/* Create the gates with all their layers, except contacts if none are drawn. */
static int make_gates(segment *s) {
  int contacts = s->source[CONTACT].drawn_at_all;
  size_t layers = s->sources - !contacts, n = 0;
  eda_gates *g = s->gates = eda_gates_new(layers, s->regions.count);
  g->name = eda_gates_text(g, eda_layout_cell_name(s->layout, s->top));
  g->grid = s->grid;
  for (size_t k = 0; k < s->sources; k++) {
    source *from = &s->source[k];
    if (k == CONTACT && !contacts) continue;
    segment_set_layer(g, n, from->name, k != CONTACT, &from->drawn);
    if (k >= KNOWN) segment_cut_plain(g, n);
    n++;
  }
  if (s->window && g->extent.x0 > g->extent.x1) g->extent = *s->window;
  return OPC_OK;
}

static int find_gates(segment *s) {
  segment_locate(s);
  segment_index(s);
  if (segment_recognise(s) || segment_flavours(s) || segment_drawn(s))
    return s->error->code;
  segment_cut(s);
  segment_space(s);
  segment_name(s);
  return segment_notes(s);
}

static int segment_run_steps(segment *s, int (*const *steps)(segment *),
                             size_t n) {
  int code = OPC_OK;
  for (size_t k = 0; !code && k < n; k++) {
    code = steps[k](s);
    if (!code && opc_cancelled(s->context))
      code = opc_fail(s->error, OPC_CANCELLED, NULL, "cancelled");
  }
  return code;
}

int segment_begin(segment *s) {
  static int (*const steps[])(segment *) = {check_layers, find_bounds};
  return segment_run_steps(s, steps, 2);
}

int segment_finish(segment *s) {
  static int (*const steps[])(segment *) = {want_regions, make_gates,
                                            find_gates};
  return segment_run_steps(s, steps, 3);
}

/* Return a length in grid units, limited to the range of coordinates. */
static int32_t in_units(double nm, double grid) {
  return (int32_t)fmin(floor(nm / grid + 0.5), 1073741824.0);
}

static int32_t length_of(double nm, double grid) {
  return isnan(nm) ? NOT_GIVEN : in_units(nm, grid);
}

segment segment_new(const opc_context *context, const eda_layout *layout,
                    int32_t top, const eda_segment_settings *settings,
                    opc_error *error) {
  double grid = settings->grid;
  segment s = {.context = context,
               .error = error,
               .layout = layout,
               .top = top,
               .settings = settings,
               .grid = grid,
               .overhang = length_of(settings->overhang, grid),
               .line_end = length_of(settings->line_end, grid),
               .reach = in_units(EDA_SEGMENT_REACH, grid)};
  get_sources(&s);
  return s;
}

void segment_clear_layers(segment *s) {
  for (size_t k = 0; k < s->sources; k++) eda_shapes_clear(&s->source[k].drawn);
  eda_flat_clear(&s->active);
  for (int k = 0; k < DOPINGS; k++) eda_shapes_clear(&s->doping[k]);
  eda_shapes_clear(&s->regions);
  s->moved = 0;
}

eda_gates *segment_end(segment *s, int code) {
  segment_clear_layers(s);
  free(s->source);
  for (int k = 0; k < 2; k++) free(s->index[k].edges);
  free(s->placement);
  if (!code) return s->gates;
  eda_gates_free(s->gates);
  return NULL;
}

/* ---- a whole layout ---- */

int eda_segment(const opc_context *context, const eda_layout *layout,
                int32_t top, const eda_segment_settings *settings,
                eda_gates **gates, eda_segment_report *report,
                opc_error *error) {
  static int (*const steps[])(segment *) = {segment_begin, segment_layers,
                                            segment_regions, segment_finish};
  segment s = segment_new(context, layout, top, settings, error);
  int code = segment_run_steps(&s, steps, 4);
  *report = s.report;
  *gates = segment_end(&s, code);
  return code;
}

/* All flat layers exist at the same time; their merged shapes need about as
   much memory again. */
double eda_segment_bytes(const eda_layout *layout, int32_t top,
                         const eda_segment_settings *settings) {
  segment s = {.settings = settings};
  double sum = 0;
  get_sources(&s);
  for (size_t k = 0; k < s.sources + DOPINGS; k++) {
    const char *name =
        k < s.sources ? s.source[k].from : dopings[k - s.sources];
    int32_t layer = eda_layout_find_layer(layout, name);
    if (layer >= 0) sum += 2 * eda_layout_flat_bytes(layout, top, layer);
  }
  free(s.source);
  return sum;
}
