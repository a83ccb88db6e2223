/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the search for the cells of transistors. A transistor is matched
   by its position in the placed cell, because the rounding of the cell to the
   grid may differ between its placements. */
#include "cells.h"

#include <eda/index.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "outline.h"

/* Largest difference between the doubled centres of equal transistors, grid
   steps. Each edge may be rounded by half a step in the cell and in the layout,
   as may the corner of the cell. */
enum { NEAR = 4 };

/* Name of the instance that is not a copy. No name of a layout begins so. */
static const char own_name[] = "/own";

typedef struct finder {
  const opc_context *context;
  const eda_chip *chip;
  const uint32_t *number, *kind;
  const char *boundary; /* layer of abutment boxes; NULL: no copies */
  int orientations;
  eda_layout *outline;
  eda_index *index;  /* boxes of the transistors */
  uint8_t *matched;  /* [n] */
  int32_t *index_of; /* [cells of the layout], index in out->cell; -1: none */
  cells *out;
} finder;

/* ---- checksums ---- */

static void sum_add(GChecksum *sum, const void *data, size_t size) {
  if (size) g_checksum_update(sum, data, (gssize)size);
}

static void add_layer(GChecksum *sum, const eda_gates *g, size_t k) {
  const eda_shapes *d = &g->drawn[k];
  const eda_edges *e = &g->edges[k];
  const uint64_t counts[] = {g->corrected[k], d->count,
                             e->polygons ? e->start[e->polygons] : 0};
  sum_add(sum, g->layer[k], strlen(g->layer[k]) + 1);
  sum_add(sum, counts, sizeof counts);
  if (d->count) {
    sum_add(sum, d->start, (d->count + 1) * sizeof *d->start);
    sum_add(sum, d->points, d->start[d->count] * sizeof *d->points);
  }
  for (uint64_t i = 0; i < counts[2]; i++) {
    const eda_fragment *f = &e->fragments[i];
    const int32_t item[] = {f->from.x, f->from.y, f->gate, f->role};
    sum_add(sum, item, sizeof item);
  }
}

static void add_gate(GChecksum *sum, const eda_gates *g, size_t i) {
  eda_goal goal = eda_gates_goal(g, i);
  const int64_t head[] = {llround(g->length[i] * 1000),
                          llround(g->width[i] * 1000), goal.given};
  const char *flavour = eda_gates_flavour(g, i);
  sum_add(sum, head, sizeof head);
  if (goal.given) sum_add(sum, &goal, offsetof(eda_goal, given));
  sum_add(sum, flavour, strlen(flavour) + 1);
}

char *cells_sum(const eda_gates *g) {
  g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
  sum_add(sum, &g->grid, sizeof g->grid);
  for (size_t k = 0; k < g->layers; k++) add_layer(sum, g, k);
  for (size_t i = 0; i < g->count; i++) {
    sum_add(sum, &g->type[i], 1);
    sum_add(sum, &g->axis[i], 1);
    sum_add(sum, &g->space[2 * i], 2 * sizeof *g->space);
    sum_add(sum, &g->extension[2 * i], 2 * sizeof *g->extension);
    add_gate(sum, g, i);
  }
  return g_strdup(g_checksum_get_string(sum));
}

uint32_t cells_kind(const eda_gates *g, size_t i) {
  g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_MD5);
  uint8_t all[16];
  gsize size = sizeof all;
  uint32_t kind;
  add_gate(sum, g, i);
  g_checksum_get_digest(sum, all, &size);
  memcpy(&kind, all, sizeof kind);
  return kind;
}

/* ---- orientations ---- */

/* Return the number of equivalent orientations that a placement requires. */
static int orientations_for(int orientation) {
  return orientation & 1 ? 8 : orientation ? 4 : 1;
}

/* Return 1 if a placement reverses the direction along `axis` of the cell. */
static int is_reversed(int orientation, int axis) {
  int turns = orientation % 4, x = axis == EDA_X, y = axis == EDA_Y;
  if (orientation & 4) y = -y;
  for (int k = 0; k < turns; k++) {
    int was = x;
    x = -y;
    y = was;
  }
  return x + y < 0;
}

static uint8_t flip_of(const territory *t, uint8_t axis) {
  return (uint8_t)((is_reversed(t->orientation, axis) ? EDA_FLIP_L : 0) |
                   (is_reversed(t->orientation, !axis) ? EDA_FLIP_W : 0));
}

/* ---- cells ---- */

/* Place the cell and, with a box, copies on all sides as in rows of cells. The
   copies to the left and right are unchanged, those above and below mirrored,
   so that supply lines coincide. */
static int put_copies(eda_layout *out, int32_t top, int32_t child,
                      const eda_box *box, opc_error *error) {
  eda_placement p = {.magnification = 1, .columns = 1, .rows = 1};
  int code = eda_layout_add_instance(out, top, child, &p, own_name, error);
  if (!box) return code;
  int32_t wide = box->x1 - box->x0;
  for (int side = -1; side <= 1 && !code; side += 2) {
    p.origin = (eda_point){side * wide, 0};
    code = eda_layout_add_instance(out, top, child, &p, NULL, error);
  }
  p.mirror = 1;
  p.columns = 3;
  p.column_step = (eda_point){wide, 0};
  for (int side = 0; side <= 1 && !code; side++) {
    p.origin = (eda_point){-wide, 2 * (side ? box->y1 : box->y0)};
    code = eda_layout_add_instance(out, top, child, &p, NULL, error);
  }
  return code;
}

/* Make a layout of a cell, among copies if s->boundary is set. */
static int make_layout(const finder *s, int32_t number, eda_layout **out,
                       int32_t *top, opc_error *error) {
  const eda_layout *from = s->chip->layout;
  eda_box box = EDA_BOX_EMPTY;
  *out = eda_layout_new(eda_layout_unit(from), error);
  if (!*out) return error->code;
  int32_t child = eda_layout_import(*out, from, number, error);
  if (child >= 0) *top = eda_layout_cell(*out, "a cell and its copies", error);
  if (child < 0 || *top < 0) return error->code;
  if (!s->boundary) return put_copies(*out, *top, child, NULL, error);
  int32_t layer = eda_layout_select(*out, s->boundary, error);
  if (layer < 0 ||
      eda_layout_bounds(*out, child, layer, eda_layout_unit(from), &box, error))
    return error->code;
  if (box.x0 < box.x1 && box.y0 < box.y1)
    return put_copies(*out, *top, child, &box, error);
  return opc_fail(error, OPC_INVALID, "neighbours",
                  "cell '%.200s' has no shape on layer '%.200s', expected its "
                  "abutment box",
                  eda_layout_cell_name(from, number), s->boundary);
}

static int add_cell(finder *s, int32_t number, opc_error *error) {
  const eda_chip *c = s->chip;
  cells *out = s->out;
  eda_segment_report report;
  eda_layout *layout = NULL;
  eda_box b;
  int32_t top = -1;
  cell one = {.number = number};
  int code = make_layout(s, number, &layout, &top, error);
  if (!code)
    code = eda_layout_bounds(s->outline, number, 0, c->grid, &b, error);
  if (!code)
    code = eda_segment(s->context, layout, top, &c->segment, &one.gates,
                       &report, error);
  eda_layout_free(layout);
  if (code) return code;
  one.corner = (eda_point){b.x0, b.y0};
  s->index_of[number] = (int32_t)out->count;
  EDA_PUSH(out->cell, out->count, out->capacity, one);
  return OPC_OK;
}

int cells_is_own(const eda_gates *g, size_t i) {
  return !strncmp(g->instance[i], own_name, strlen(own_name));
}

/* ---- matches ---- */

/* Return the gate of a cell at the place of transistor k; -1: none. */
static int64_t find_gate(const finder *s, const cell *in, const territory *t,
                         uint32_t k) {
  const eda_chip_gate *g = &s->chip->gate[s->number[k]];
  const eda_gates *of = in->gates;
  eda_box own = territory_own(t, g->box);
  int axis = t->orientation & 1 ? !g->axis : g->axis;
  int64_t x = (int64_t)own.x0 + own.x1 + 2 * (int64_t)in->corner.x,
          y = (int64_t)own.y0 + own.y1 + 2 * (int64_t)in->corner.y;
  for (size_t i = 0; i < of->count; i++) {
    eda_box b = of->box[i];
    if (cells_is_own(of, i) && llabs(x - b.x0 - b.x1) <= NEAR &&
        llabs(y - b.y0 - b.y1) <= NEAR && of->axis[i] == axis &&
        of->type[i] == g->type && cells_kind(of, i) == s->kind[k])
      return (int64_t)i;
  }
  return -1;
}

/* Match the transistors in a placed cell. */
static int match_one(finder *s, const territory *t, opc_error *error) {
  cells *out = s->out;
  int32_t number = -1;
  eda_finder f = eda_index_find(s->index, t->box);
  for (uint32_t k; eda_index_next(&f, &k);) {
    char path[2];
    if (s->matched[k]) continue;
    if (number < 0)
      number = eda_layout_path(s->outline, s->chip->top, t->number, path,
                               sizeof path);
    if (number < 0) return OPC_OK;
    if (s->index_of[number] < 0) {
      int code = add_cell(s, number, error);
      if (code) return code;
    }
    uint32_t i = (uint32_t)s->index_of[number];
    int64_t gate = find_gate(s, &out->cell[i], t, k);
    if (gate < 0) continue;
    const cell_match m = {k, (uint32_t)gate, i,
                          flip_of(t, out->cell[i].gates->axis[gate])};
    EDA_PUSH(out->match, out->matches, out->match_capacity, m);
    s->matched[k] = 1;
  }
  return OPC_OK;
}

static int by_cell(const void *a, const void *b) {
  const cell_match *p = a, *q = b;
  if (p->cell != q->cell) return p->cell < q->cell ? -1 : 1;
  return (p->place > q->place) - (p->place < q->place);
}

static void sort_matches(cells *out) {
  if (out->matches)
    qsort(out->match, out->matches, sizeof *out->match, by_cell);
  for (size_t i = out->matches; i-- > 0;) {
    cell *c = &out->cell[out->match[i].cell];
    c->used++;
    c->first = i;
  }
}

/* ---- run ---- */

static int find_all(finder *s, opc_error *error) {
  const eda_chip *c = s->chip;
  const int32_t layers[] = {eda_layout_find_layer(c->layout, "poly"),
                            eda_layout_find_layer(c->layout, "active")};
  territory *all;
  size_t n;
  s->outline = outline_new(c->layout, c->top, layers, 2, INFINITY, 0, error);
  if (!s->outline) return error->code;
  int code = outline_find(s->outline, c->top, c->grid, NULL, &all, &n, error);
  for (size_t i = 0; i < n && !code; i++)
    if (orientations_for(all[i].orientation) <= s->orientations)
      code = match_one(s, &all[i], error);
  free(all);
  return code;
}

int cells_find(const opc_context *context, const eda_chip *chip,
               const uint32_t *number, const uint32_t *kind, size_t n,
               int orientations, const char *boundary, cells *out,
               opc_error *error) {
  size_t cells_of = eda_layout_cells(chip->layout);
  eda_box *box = eda_alloc(n, sizeof *box);
  finder s = {.context = context,
              .chip = chip,
              .number = number,
              .kind = kind,
              .boundary = boundary,
              .orientations = orientations,
              .matched = eda_alloc(n, 1),
              .index_of = eda_alloc(cells_of, sizeof *s.index_of),
              .out = out};
  *out = (cells){0};
  for (size_t i = 0; i < cells_of; i++) s.index_of[i] = -1;
  for (size_t i = 0; i < n; i++) box[i] = chip->gate[number[i]].box;
  s.index = eda_index_new(box, n, 0);
  free(box);
  int code = find_all(&s, error);
  sort_matches(out);
  eda_index_free(s.index);
  eda_layout_free(s.outline);
  free(s.matched);
  free(s.index_of);
  return code;
}

void cells_clear(cells *c) {
  for (size_t i = 0; i < c->count; i++) eda_gates_free(c->cell[i].gates);
  free(c->cell);
  free(c->match);
  *c = (cells){0};
}
