/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the layout file of a mask by classes: drawn shapes and mask as
   cells and arrays, and the printed contours around the worst classes. */
#include <eda/chip.h>
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "klayout.h"

/* Margin of the simulated window around a transistor, and distance of the
   points of a contour, nm. */
static const double around = 400, step = 10;

void klayout_list_classes(klayout *k) {
  const eda_mask *m = k->mask;
  k->sheets = eda_alloc(GROUPS * 2 * m->layers, sizeof *k->sheets);
  k->n_sheets = 0;
  for (int group = 0; group < GROUPS; group++)
    for (size_t i = m->layers; i-- > 0;) {
      if (group != DRAWN && !m->gates->corrected[i]) continue;
      klayout_add_sheet(k, group, i, 0);
      if (group >= BEFORE) klayout_add_sheet(k, group, i, 1);
    }
}

static sheet *find_sheet(klayout *k, int group, size_t layer, int holes) {
  for (size_t i = 0; i < k->n_sheets; i++) {
    sheet *s = &k->sheets[i];
    if (s->group == group && s->layer == layer && s->holes == holes) return s;
  }
  return NULL;
}

/* ---- cells ---- */

/* Layout whose cells are appended to another one. */
typedef struct source {
  const eda_layout *from;
  int32_t top;
  int32_t *layer;     /* target layer of each layer of `from`; -1: omitted */
  int32_t *cell;      /* target cell of each cell of `from` */
  const char *suffix; /* of the names of the appended cells */
} source;

static int32_t cell_new(const source *s, int32_t i, target *t,
                        opc_error *error) {
  if (i == s->top) return t->cell;
  g_autofree char *name =
      g_strconcat(eda_layout_cell_name(s->from, i), s->suffix, NULL);
  for (int n = 2; eda_layout_find_cell(t->layout, name) >= 0; n++) {
    g_free(name);
    name = g_strdup_printf("%s%s%d", eda_layout_cell_name(s->from, i),
                           s->suffix, n);
  }
  return eda_layout_cell(t->layout, name, error);
}

static int cell_copy(const source *s, int32_t i, target *t, opc_error *error) {
  int code = OPC_OK;
  for (size_t p = 0; p < eda_layout_polygons(s->from, i) && !code; p++) {
    size_t n;
    int32_t layer;
    const eda_point *points = eda_layout_polygon(s->from, i, p, &n, &layer);
    if (s->layer[layer] >= 0)
      code = eda_layout_add_polygon(t->layout, s->cell[i], s->layer[layer],
                                    points, n, error);
  }
  for (size_t p = 0; p < eda_layout_instances(s->from, i) && !code; p++) {
    int32_t child;
    eda_placement at;
    eda_layout_instance(s->from, i, p, &child, &at);
    code = eda_layout_add_instance(t->layout, s->cell[i], s->cell[child], &at,
                                   NULL, error);
  }
  return code;
}

static int cells_append(source *s, target *t, opc_error *error) {
  int32_t n = (int32_t)eda_layout_cells(s->from);
  int code = OPC_OK;
  s->top = eda_layout_top(s->from, error);
  if (s->top < 0) return error->code;
  s->cell = eda_alloc((size_t)n, sizeof *s->cell);
  for (int32_t i = 0; i < n && !code; i++) {
    s->cell[i] = cell_new(s, i, t, error);
    if (s->cell[i] < 0) code = error->code;
  }
  for (int32_t i = 0; i < n && !code; i++) code = cell_copy(s, i, t, error);
  free(s->cell);
  return code;
}

/* Append the drawn shapes or the mask. */
static int put_group(klayout *k, int group, target *t, opc_error *error) {
  static const char *const suffixes[] = {"_DRAWN", ""};
  const eda_mask *m = k->mask;
  const eda_layout *part = NULL;
  int code = m->access->layout(m, group == DRAWN, &part, error);
  if (code) return code;
  source s = {.from = part, .suffix = suffixes[group]};
  s.layer = eda_alloc(eda_layout_layers(part), sizeof *s.layer);
  memset(s.layer, 0xff, eda_layout_layers(part) * sizeof *s.layer);
  for (size_t i = 0; i < m->layers; i++) {
    const sheet *of = find_sheet(k, group, i, 0);
    int32_t from = eda_layout_find_layer(part, m->gates->layer[i]);
    if (of && from >= 0)
      s.layer[from] = eda_layout_layer(t->layout, of->number, error);
  }
  code = cells_append(&s, t, error);
  free(s.layer);
  return code;
}

/* ---- contours ---- */

static int put_print(klayout *k, int group, size_t layer,
                     const eda_field *print, eda_frame window, target *t,
                     opc_error *error) {
  contours c = {.print = print};
  const opc_context *context = k->file.w.host->context;
  if (!print->coefficients) return OPC_OK;
  int code = eda_contours(context, print, window, step, &c.points, &c.start,
                          &c.count, error);
  for (int holes = 0; holes < 2 && !code; holes++) {
    const sheet *s = find_sheet(k, group, layer, holes);
    t->layer = eda_layout_layer(t->layout, s->number, error);
    code = klayout_put_contours(t, &c, holes, error);
  }
  free(c.points);
  free(c.start);
  return code;
}

static int put_class(klayout *k, size_t class, target *t, opc_error *error) {
  const eda_gates *g = k->mask->gates;
  eda_mask *near = NULL;
  eda_box b = g->box[class];
  const eda_frame window = {b.x0 * g->grid - around, b.y0 * g->grid - around,
                            (b.x1 - b.x0) * g->grid + 2 * around,
                            (b.y1 - b.y0) * g->grid + 2 * around};
  int code =
      k->mask->access->simulate(k->mask, &class, 1, around, &near, error);
  for (size_t i = 0; i < g->layers && !code; i++) {
    if (!g->corrected[i]) continue;
    code = put_print(k, BEFORE, i, &near->drawn_print[i], window, t, error);
    if (!code) code = put_print(k, AFTER, i, &near->print[i], window, t, error);
  }
  eda_mask_free(near);
  return code;
}

typedef struct ranked {
  double off; /* |deviation|, % */
  size_t class;
} ranked;

EDA_COMPARE_FALLING(by_rank, ranked, off, class);

static int put_worst(klayout *k, target *t, opc_error *error) {
  const eda_mask *m = k->mask;
  size_t n = m->gates->count;
  ranked *all = eda_alloc(n, sizeof *all);
  for (size_t i = 0; i < n; i++) {
    double off = fabs(eda_deviation(m->after.ion[i], m->design.ion[i]));
    int fails = eda_print_failed(m->flags[i]) || !isfinite(off);
    all[i] = (ranked){fails ? INFINITY : off, i};
  }
  if (n) qsort(all, n, sizeof *all, by_rank);
  int code = OPC_OK;
  for (size_t i = 0; i < n && (int64_t)i < k->worst && !code; i++)
    code = put_class(k, all[i].class, t, error);
  free(all);
  return code;
}

/* ---- the layout ---- */

/* Mark the layers without shapes. */
static void mark_empty(klayout *k, const target *t) {
  for (size_t i = 0; i < k->n_sheets; i++)
    k->sheets[i].empty =
        eda_layout_find_layer(t->layout, k->sheets[i].number) < 0;
}

eda_layout *klayout_build_classes(klayout *k, opc_error *error) {
  const eda_gates *g = k->mask->gates;
  target t = {.times = 1, .unit = g->grid};
  t.layout = eda_layout_new(g->grid, error);
  if (!t.layout) return NULL;
  t.cell = eda_layout_cell(t.layout, g->name, error);
  int code = t.cell < 0 ? error->code : OPC_OK;
  if (!code) code = put_group(k, DRAWN, &t, error);
  if (!code) code = put_group(k, MASK, &t, error);
  if (!code) code = put_worst(k, &t, error);
  free(t.points);
  mark_empty(k, &t);
  if (!code) return t.layout;
  eda_layout_free(t.layout);
  return NULL;
}
