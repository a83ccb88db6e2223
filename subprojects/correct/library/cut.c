/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the extraction of cells from a sheet. */
#include <correct/cut.h>

#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* State of an extraction: window on the sheet, origin of the cell, and new
   indices of the gates. */
typedef struct cutter {
  const eda_gates *sheet;
  eda_box window;
  eda_point origin;
  int32_t *number; /* [gates of the sheet], index; -1: not extracted */
  eda_gates *out;
} cutter;

static int is_within(const cutter *c, eda_box b) {
  eda_box w = c->window;
  return b.x0 >= w.x0 && b.y0 >= w.y0 && b.x1 <= w.x1 && b.y1 <= w.y1;
}

static eda_point cutter_point(const cutter *c, eda_point p) {
  return (eda_point){p.x - c->origin.x, p.y - c->origin.y};
}

static eda_box moved_box(const cutter *c, eda_box b) {
  return (eda_box){b.x0 - c->origin.x, b.y0 - c->origin.y, b.x1 - c->origin.x,
                   b.y1 - c->origin.y};
}

/* ---- shapes ---- */

static void cut_fragments(cutter *c, size_t layer, const uint32_t *polygon,
                          size_t n) {
  const eda_edges *from = &c->sheet->edges[layer];
  eda_edges *to = &c->out->edges[layer];
  size_t count = 0;
  for (size_t k = 0; k < n; k++)
    count += from->start[polygon[k] + 1] - from->start[polygon[k]];
  to->polygons = n;
  to->start = eda_alloc(n + 1, sizeof *to->start);
  to->fragments = eda_alloc(count, sizeof *to->fragments);
  uint32_t at = 0;
  for (size_t k = 0; k < n; k++) {
    for (uint32_t i = from->start[polygon[k]]; i < from->start[polygon[k] + 1];
         i++, at++) {
      eda_fragment f = from->fragments[i];
      f.from = cutter_point(c, f.from);
      if (f.gate >= 0) f.gate = c->number[f.gate];
      if (f.gate < 0) f.role = EDA_FIXED;
      to->fragments[at] = f;
    }
    to->start[k + 1] = at;
  }
}

static void cut_layer(cutter *c, size_t layer) {
  const eda_shapes *from = &c->sheet->drawn[layer];
  eda_shapes *to = &c->out->drawn[layer];
  uint32_t *polygon = eda_alloc(from->count, sizeof *polygon);
  size_t n = 0, points = 0;
  for (size_t i = 0; i < from->count; i++) {
    size_t corners = from->start[i + 1] - from->start[i];
    if (!is_within(c, eda_bounds(from->points + from->start[i], corners)))
      continue;
    polygon[n++] = (uint32_t)i;
    points += corners;
  }
  *to = (eda_shapes){.count = n};
  if (n) {
    to->start = eda_alloc(n + 1, sizeof *to->start);
    to->points = eda_alloc(points, sizeof *to->points);
    if (from->hole) to->hole = eda_alloc(n, 1);
  }
  for (size_t k = 0; k < n; k++) {
    uint32_t at = to->start[k], first = from->start[polygon[k]];
    uint32_t corners = from->start[polygon[k] + 1] - first;
    for (uint32_t i = 0; i < corners; i++)
      to->points[at + i] = cutter_point(c, from->points[first + i]);
    to->start[k + 1] = at + corners;
    if (to->hole) to->hole[k] = from->hole[polygon[k]];
  }
  if (c->sheet->edges[layer].polygons == from->count)
    cut_fragments(c, layer, polygon, n);
  free(polygon);
}

/* ---- gates ---- */

static void cut_gate(cutter *c, size_t i) {
  const eda_gates *from = c->sheet;
  eda_gates *to = c->out;
  size_t k = (size_t)c->number[i];
  to->box[k] = moved_box(c, from->box[i]);
  eda_gates_copy(to, k, from, i);
  to->instance[k] = eda_gates_text(to, "");
  to->cell[k] = eda_gates_text(to, to->name);
  to->number[k] = from->number[i];
}

static eda_gates *cutter_run(cutter *c, const char *name, size_t count) {
  const eda_gates *from = c->sheet;
  eda_gates *to = c->out = eda_gates_new(from->layers, count);
  to->name = eda_gates_text(to, name);
  to->grid = from->grid;
  to->extent = (eda_box)EDA_BOX_EMPTY;
  for (size_t k = 0; k < from->layers; k++) {
    to->layer[k] = eda_gates_text(to, from->layer[k]);
    to->corrected[k] = from->corrected[k];
    cut_layer(c, k);
    const eda_shapes *s = &to->drawn[k];
    if (s->count)
      eda_box_join(&to->extent, eda_bounds(s->points, s->start[s->count]));
  }
  for (size_t i = 0; i < from->count; i++)
    if (c->number[i] >= 0) cut_gate(c, i);
  return to;
}

/* ---- positions ---- */

static eda_box bounds_of(const eda_layout *layout, int32_t cell) {
  eda_box all = EDA_BOX_EMPTY;
  size_t n, count = eda_layout_polygons(layout, cell);
  int32_t layer;
  for (size_t i = 0; i < count; i++) {
    const eda_point *p = eda_layout_polygon(layout, cell, i, &n, &layer);
    eda_box_join(&all, eda_bounds(p, n));
  }
  return all;
}

/* Return the box of an instance on the sheet, in grid steps, enlarged by at
   least one step. */
static eda_box on_sheet(eda_box b, const eda_placement *p, double steps) {
  double low = p->mirror ? -(double)b.y1 : b.y0,
         high = p->mirror ? -(double)b.y0 : b.y1;
  return (eda_box){(int32_t)floor((p->origin.x + (double)b.x0) * steps) - 1,
                   (int32_t)floor((p->origin.y + low) * steps) - 1,
                   (int32_t)ceil((p->origin.x + (double)b.x1) * steps) + 1,
                   (int32_t)ceil((p->origin.y + high) * steps) + 1};
}

/* Return 1 if an instance name belongs to a neighbour: NAME~1. */
static int is_neighbour(const char *name) { return strchr(name, '~') != NULL; }

static void cut_window(cutter *c, const eda_layout *layout, int32_t top,
                       const char *name, cut_out *out) {
  eda_box all = c->window;
  for (size_t i = 0; i < eda_layout_instances(layout, top); i++) {
    int32_t cell;
    eda_placement p;
    const char *other = eda_layout_instance(layout, top, i, &cell, &p);
    if (cell != out->cell || !other || !is_neighbour(other)) continue;
    eda_box_join(&all, on_sheet(bounds_of(layout, cell), &p,
                                eda_layout_unit(layout) / c->sheet->grid));
  }
  c->window = all;
  size_t count = 0, own = 0;
  c->number = eda_alloc(c->sheet->count, sizeof *c->number);
  for (size_t k = 0; k < c->sheet->count; k++) {
    int is_own = !strcmp(c->sheet->instance[k], name);
    int is_in = is_own || is_within(c, c->sheet->box[k]);
    c->number[k] = is_in ? (int32_t)count++ : -1;
    own += (size_t)is_own;
  }
  if (!own) return;
  out->gates = cutter_run(c, eda_layout_cell_name(layout, out->cell), count);
  out->own = eda_alloc(count, 1);
  for (size_t k = 0; k < c->sheet->count; k++)
    if (c->number[k] >= 0)
      out->own[c->number[k]] = !strcmp(c->sheet->instance[k], name);
}

int correct_cut_cell(const eda_gates *sheet, const eda_layout *layout,
                     int32_t top, size_t i, cut_out *out, opc_error *error) {
  eda_placement p;
  *out = (cut_out){0};
  const char *name = eda_layout_instance(layout, top, i, &out->cell, &p);
  double steps = eda_layout_unit(layout) / sheet->grid;
  double x = p.origin.x * steps, y = p.origin.y * steps;
  if (name && is_neighbour(name)) return OPC_OK;
  if (!name || p.mirror || p.angle != 0 || fabs(x - round(x)) > 1e-3 ||
      fabs(y - round(y)) > 1e-3)
    return opc_fail(error, OPC_INVALID, "sheet",
                    "\"cell '%s' is not on the mask grid: expected the layout "
                    "of library.sheet as 'sheet'\"",
                    eda_layout_cell_name(layout, out->cell));
  cutter c = {.sheet = sheet,
              .origin = {(int32_t)lround(x), (int32_t)lround(y)},
              .window = on_sheet(bounds_of(layout, out->cell), &p, steps)};
  out->box = moved_box(&c, c.window);
  cut_window(&c, layout, top, name, out);
  free(c.number);
  return OPC_OK;
}

void correct_cut_clear(cut_out *out) {
  eda_gates_free(out->gates);
  free(out->own);
  *out = (cut_out){0};
}

char *correct_cut_sum(const eda_gates *g) {
  g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
  for (size_t k = 0; k < g->layers; k++) {
    const eda_edges *e = &g->edges[k];
    size_t n = e->polygons ? e->start[e->polygons] : 0;
    g_autofree char *head =
        g_strdup_printf("%s %d %zu\n", g->layer[k], g->corrected[k], n);
    g_checksum_update(sum, (const guchar *)head, -1);
    for (size_t i = 0; i < n; i++) {
      const eda_fragment *f = &e->fragments[i];
      const int32_t item[] = {f->from.x, f->from.y, f->gate, f->role};
      g_checksum_update(sum, (const guchar *)item, sizeof item);
    }
  }
  for (size_t i = 0; i < g->count; i++) {
    g_autofree char *one = g_strdup_printf(
        "%d %d %a %a ", g->type[i], g->axis[i], g->length[i], g->width[i]);
    eda_goal goal = eda_gates_goal(g, i);
    const char *flavour = eda_gates_flavour(g, i);
    g_checksum_update(sum, (const guchar *)one, -1);
    if (goal.given)
      g_checksum_update(sum, (const guchar *)&goal, offsetof(eda_goal, given));
    g_checksum_update(sum, (const guchar *)flavour, -1);
    g_checksum_update(sum, (const guchar *)"\n", 1);
  }
  return g_strdup(g_checksum_get_string(sum));
}
