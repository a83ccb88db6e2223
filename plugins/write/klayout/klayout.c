/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements write.klayout: a corrected mask as three files for KLayout. The
   files are an OASIS file with shapes and printed contours as layers, a layer
   style file, and a marker database of the places to inspect. */
#include "klayout.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Tuned settings. */
static const struct {
  double unit, step, nodes, coarsest, most;
} tuned = {
    /* Unit of contours, nm: a tenth of the usual mask grid. A finer mask grid
       replaces this unit. */
    .unit = 0.1,

    /* Distance between points of a contour, nm. The chord of an arc of 40 nm
       radius deviates by 0.3 nm; half the distance doubles the file. */
    .step = 10,

    /* Largest number of nodes of the contour grid, which limits the file size.
       The grid spacing increases for layouts above 20 x 20 um. */
    .nodes = 4e6,

    /* Largest grid spacing, nm. At twice the spacing, contours of 65 nm lines
       break into parts. */
    .coarsest = 30,

    /* Limit of nodes of eda_contours, reached above 240 x 240 um. */
    .most = 6.4e7,
};

static const char *const suffix[GROUPS] = {"drawn", "mask", "before", "after"};

/* ---- work: sheets ---- */

static const eda_field *print_of(const eda_mask *m, int group, size_t layer) {
  const eda_field *prints = group == AFTER ? m->print : m->drawn_print;
  return prints && prints[layer].coefficients ? &prints[layer] : NULL;
}

static int has_sheet(const eda_mask *m, int group, size_t layer) {
  if (group == DRAWN) return m->gates->drawn[layer].count > 0;
  if (group == MASK) return m->shapes[layer].count > 0;
  return print_of(m, group, layer) != NULL;
}

/* Make the name of a layer: printable characters without blanks (OASIS). */
static void name_sheet(const eda_gates *g, sheet *s) {
  snprintf(s->name, sizeof s->name, "%.40s.%s%s", g->layer[s->layer],
           suffix[s->group], s->holes ? ".holes" : "");
  for (char *c = s->name; *c; c++)
    if (*c <= ' ' || *c >= 0x7f) *c = '_';
}

/* Add a layer of the file. Drawn shapes and masks have the numbers of
   write.oasis; the numbers of printed contours follow in equal steps. */
void klayout_add_sheet(klayout *k, int group, size_t layer, int holes) {
  static const uint32_t step[GROUPS] = {1, 0, 2, 3};
  const eda_gates *g = k->mask->gates;
  sheet *s = &k->sheets[k->n_sheets++];
  uint32_t n = eda_gates_number(g, layer);
  if (g->corrected[layer]) n += step[group] * EDA_DRAWN_NUMBER;
  *s = (sheet){.group = group, .layer = layer, .holes = holes};
  (void)snprintf(s->number, sizeof s->number, "%u/%d", (unsigned)n, holes);
  name_sheet(g, s);
}

/* List the layers of the file: poly above active, and contacts above poly. */
static void list_sheets(klayout *k) {
  const eda_mask *m = k->mask;
  k->sheets = eda_alloc(GROUPS * 2 * m->gates->layers, sizeof *k->sheets);
  k->n_sheets = 0;
  for (int group = 0; group < GROUPS; group++)
    for (int only_drawn = 0; only_drawn < 2; only_drawn++)
      for (size_t i = m->gates->layers; i-- > 0;) {
        if (only_drawn == m->gates->corrected[i] || !has_sheet(m, group, i))
          continue;
        klayout_add_sheet(k, group, i, 0);
        if (group >= BEFORE) klayout_add_sheet(k, group, i, 1);
      }
}

/* ---- work: shapes ---- */

static int put_polygon(void *data, const eda_point *points, size_t n,
                       opc_error *error) {
  target *t = data;
  eda_grow(&t->points, &t->capacity, n, sizeof *t->points);
  for (size_t i = 0; i < n; i++)
    t->points[i] = (eda_point){t->times * points[i].x, t->times * points[i].y};
  return eda_layout_add_polygon(t->layout, t->cell, t->layer, t->points, n,
                                error);
}

static int put_shapes(target *t, const eda_shapes *shapes, opc_error *error) {
  const eda_polygon_taker take = {put_polygon, t, oasis_stream.most_points};
  return eda_polygons_without_holes(shapes, &take, error);
}

static void find_contours(void *data, size_t i) {
  contours *c = (contours *)data + i;
  if (!c->print) return;
  eda_frame f = c->print->frame;
  double area = f.width * f.height;
  double step = fmax(tuned.step, sqrt(area / tuned.nodes));
  step = fmax(fmin(step, tuned.coarsest), sqrt(area / tuned.most));
  eda_contours(c->context, c->print, f, step, &c->points, &c->start, &c->count,
               &c->error);
}

/* Write contours: outlines are counter-clockwise, holes clockwise. */
int klayout_put_contours(target *t, const contours *c, int holes,
                         opc_error *error) {
  for (size_t i = 0; i < c->count; i++) {
    const double *p = c->points + 2 * (size_t)c->start[i];
    size_t n = c->start[i + 1] - c->start[i], used = 0;
    double area = 0;
    eda_grow(&t->points, &t->capacity, n, sizeof *t->points);
    for (size_t k = 0; k < n; k++) {
      const double *q = p + 2 * ((k + 1) % n);
      eda_point at = {(int32_t)lround(p[2 * k] / t->unit),
                      (int32_t)lround(p[2 * k + 1] / t->unit)};
      area += p[2 * k] * q[1] - q[0] * p[2 * k + 1];
      if (used && t->points[used - 1].x == at.x &&
          t->points[used - 1].y == at.y)
        continue;
      t->points[used++] = at;
    }
    if (used < 3 || (area < 0) != holes) continue;
    int code = eda_layout_add_polygon(t->layout, t->cell, t->layer, t->points,
                                      used, error);
    if (code) return code;
  }
  return OPC_OK;
}

/* Compute the contours of all printed layers in parallel. A layer and the layer
   of its holes share the contours. */
static contours *find_all_contours(const klayout *k) {
  contours *all = eda_alloc(k->n_sheets, sizeof *all);
  for (size_t i = 0; i < k->n_sheets; i++) {
    const sheet *s = &k->sheets[i];
    all[i].context = k->file.w.host->context;
    if (s->group >= BEFORE && !s->holes)
      all[i].print = print_of(k->mask, s->group, s->layer);
  }
  opc_parallel(k->file.w.host->context, k->n_sheets, find_contours, all);
  return all;
}

static int put_sheet(klayout *k, size_t i, const contours *found, target *t,
                     opc_error *error) {
  sheet *s = &k->sheets[i];
  const eda_mask *m = k->mask;
  const contours *c = &found[i - (size_t)s->holes];
  if (c->error.code) return *error = c->error, error->code;
  t->layer = eda_layout_layer(t->layout, s->number, error);
  if (t->layer < 0) return error->code;
  size_t before = eda_layout_polygons(t->layout, t->cell);
  int code = s->group == DRAWN
                 ? put_shapes(t, &m->gates->drawn[s->layer], error)
             : s->group == MASK ? put_shapes(t, &m->shapes[s->layer], error)
                                : klayout_put_contours(t, c, s->holes, error);
  s->empty = eda_layout_polygons(t->layout, t->cell) == before;
  return code;
}

/* Return the units of the file per step of the mask's grid, within the range of
   coordinates. */
static int32_t grid_fineness(const eda_gates *g) {
  const double most = 1 << 29;
  const eda_box *e = &g->extent;
  double far = fmax(fmax(fabs((double)e->x0), fabs((double)e->x1)),
                    fmax(fabs((double)e->y0), fabs((double)e->y1)));
  double times = fmin(ceil(g->grid / tuned.unit - 1e-6), floor(most / far));
  return (int32_t)fmax(1, times);
}

static eda_layout *sheet_build(klayout *k, opc_error *error) {
  const eda_gates *g = k->mask->gates;
  target t = {.times = grid_fineness(g)};
  t.unit = g->grid / t.times;
  t.layout = eda_layout_new(t.unit, error);
  if (!t.layout) return NULL;
  t.cell = eda_layout_cell(t.layout, g->name, error);
  contours *found = find_all_contours(k);
  int code = t.cell < 0 ? error->code : OPC_OK;
  for (size_t i = 0; i < k->n_sheets && !code; i++)
    code = put_sheet(k, i, found, &t, error);
  for (size_t i = 0; i < k->n_sheets; i++) {
    free(found[i].points);
    free(found[i].start);
  }
  free(found);
  free(t.points);
  if (!code) return t.layout;
  eda_layout_free(t.layout);
  return NULL;
}

/* ---- work: the files ---- */

int klayout_put_text(const klayout *k, const char *name, const GString *text,
                     opc_error *error) {
  const opc_host *host = k->file.w.host;
  const char *path = host->output_path(host, name, error);
  g_autoptr(GError) failed = NULL;
  if (!path) return error->code;
  if (g_file_set_contents(path, text->str, (gssize)text->len, &failed))
    return OPC_OK;
  return opc_fail(error, OPC_IO, NULL, "%s", failed->message);
}

static int put_shapes_file(klayout *k, opc_error *error) {
  const char **names = eda_alloc(k->n_sheets, sizeof *names);
  eda_layout *layout =
      k->mask->chip ? klayout_build_classes(k, error) : sheet_build(k, error);
  for (size_t i = 0; i < k->n_sheets; i++)
    names[i] = k->sheets[i].empty ? NULL : k->sheets[i].name;
  k->file.w.layout = layout;
  k->file.layer_names = names;
  int code = layout ? writer_run(k, NULL, error) : error->code;
  k->file.w.layout = NULL;
  k->file.layer_names = NULL;
  eda_layout_free(layout);
  free(names);
  return code;
}

static int klayout_run(void *self, void **outputs, opc_error *error) {
  klayout *k = self;
  (void)outputs;
  if (k->mask->chip)
    klayout_list_classes(k);
  else
    list_sheets(k);
  int code = put_shapes_file(k, error);
  if (!code) code = klayout_put_style(k, error);
  if (!code) code = klayout_put_markers(k, error);
  free(k->sheets);
  k->sheets = NULL;
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(klayout, mask, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "mask", .summary = "Mask to inspect"),
    OPC_PARAMETER_NAMED("file", klayout, file.w.name, .type = OPC_OUTPUT,
                        .preset = "run.oas",
                        .summary = "OASIS file of shapes and printed contours"),
    OPC_PARAMETER_NAMED("style", klayout, style_name, .type = OPC_OUTPUT,
                        .preset = "run.lyp", .summary = "File of layer styles"),
    OPC_PARAMETER_NAMED("markers", klayout, markers_name, .type = OPC_OUTPUT,
                        .preset = "run.lyrdb",
                        .summary = "File of markers at the places to inspect"),
    OPC_PARAMETER(klayout, worst, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "20", .min = 0,
                  .max = 10000,
                  .summary = "Number of marked transistors for each figure, "
                             "those with the largest deviations"),
};

static int klayout_check(void *self, opc_error *error) {
  return writer_check(self, &oasis_stream, error);
}

/* ---- entry ---- */

static const opc_step functions = {.run = klayout_run};

OPC_PLUGIN(
    klayout, .id = "write.klayout", .kind = "step", .version = "0.2.0",
    .licence = "BSD-3-Clause",
    .summary = "Write a mask with simulated contours and faults for KLayout",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    .check = klayout_check, OPC_FUNCTIONS(functions));
