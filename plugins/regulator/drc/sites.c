/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the search for sites at which each printed image is checked:
   contacts, lines outside of gates, and gaps between lines. */
#include <eda/memory.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drc.h"
#include "tuning.h"

/* Typical distance of a search by position, nm; sets the cells of the index. */
static const double around = 300;

static void site_add(drc *r, site one) {
  eda_grow(&r->sites, &r->sites_capacity, r->n_sites + 1, sizeof one);
  one.repair = -1;
  r->sites[r->n_sites++] = one;
}

/* ---- the nearest gate ---- */

static double interval_distance(int32_t a0, int32_t a1, int32_t b0,
                                int32_t b1) {
  return fmax(fmax((double)b0 - a1, (double)a0 - b1), 0);
}

/* Return the nearest gate, the first of several at equal distance; -1 if no
   gate is within tuned.near_gate. */
static int32_t nearest_gate(const drc *r, eda_box b) {
  int32_t reach = (int32_t)(tuned.near_gate / r->grid), found = INT32_MAX;
  double least = reach;
  eda_finder f = eda_index_find(r->boxes.index, eda_box_grown(b, reach));
  for (uint32_t i; eda_index_next(&f, &i);) {
    eda_box g = r->boxes.box[i];
    double d = hypot(interval_distance(g.x0, g.x1, b.x0, b.x1),
                     interval_distance(g.y0, g.y1, b.y0, b.y1));
    if (d > least || (d == least && found < (int32_t)i)) continue;
    least = d;
    found = (int32_t)i;
  }
  return found == INT32_MAX ? -1 : found;
}

/* ---- contacts ---- */

/* Positions of a contact relative to the shapes of a layer: outside, inside or
   partly inside. */
enum { OUTSIDE, PARTLY, WITHIN };

static uint8_t contact_position(const places *common, eda_box box) {
  uint8_t how = OUTSIDE;
  eda_finder f = eda_index_find(common->index, box);
  for (uint32_t i; eda_index_next(&f, &i);) {
    eda_box c = common->box[i];
    if (!memcmp(&c, &box, sizeof c))
      how = WITHIN;
    else if (how == OUTSIDE && eda_boxes_overlap(c, box))
      how = PARTLY;
  }
  return how;
}

static eda_box *shape_boxes(const eda_shapes *s) {
  eda_box *out = eda_alloc(s->count, sizeof *out);
  for (size_t i = 0; i < s->count; i++) out[i] = eda_shape_box(s, i);
  return out;
}

/* Compute the position of each contact relative to a layer, in `how`. */
static int sort_contacts(const drc *r, const eda_shapes *contacts,
                         const eda_box *box, size_t layer, uint8_t *how,
                         opc_error *error) {
  eda_shapes shapes = {0};
  places common;
  int code =
      eda_boolean(EDA_AND, contacts, &r->gates->drawn[layer], &shapes, error);
  if (code) return code;
  places_init(&common, shape_boxes(&shapes), shapes.count, around, r->grid);
  for (size_t i = 0; i < contacts->count; i++)
    how[i] = contact_position(&common, box[i]);
  places_clear(&common);
  eda_shapes_clear(&shapes);
  return OPC_OK;
}

/* Add the sites of a contact. Corrected poly or active drawn over the entire
   contact must cover the contact in print. If the contact is drawn outside of
   poly, no poly may print at the contact. A contact drawn partly on a layer is
   not checked on that layer. Layers after active have no enclosure sites,
   because the regulator's repair shapes would counteract the synthesizer that
   displaces the edges of these layers. */
static void add_contact(drc *r, eda_box box, const uint8_t *how, size_t n,
                        eda_box_list *apart_from_poly, eda_box_list *on_poly) {
  site one = {.box = box,
              .gate = nearest_gate(r, box),
              .kind = SITE_ENCLOSURE,
              .sides = (1 << SIDES) - 1};
  for (size_t layer = 0; layer < r->layers && layer <= EDA_ACTIVE; layer++) {
    one.layer = (uint16_t)layer;
    if (r->gates->corrected[layer] && how[layer * n] == WITHIN)
      site_add(r, one);
  }
  if (how[EDA_POLY * n] == WITHIN) eda_box_list_add(on_poly, box);
  if (how[EDA_POLY * n] != OUTSIDE) return;
  one.layer = EDA_POLY;
  one.kind = SITE_CONTACT;
  if (r->gates->corrected[EDA_POLY]) site_add(r, one);
  eda_box_list_add(apart_from_poly, box);
}

static int add_contacts(drc *r, opc_error *error) {
  const eda_gates *g = r->gates;
  int layer_of = eda_gates_layer(g, "contact"), code = OPC_OK;
  eda_box_list apart_from_poly = {0}, on_poly = {0};
  if (layer_of >= 0) {
    const eda_shapes *contacts = &g->drawn[layer_of];
    size_t n = contacts->count;
    eda_box *box = shape_boxes(contacts);
    uint8_t *how = eda_alloc(r->layers * n, 1);
    for (size_t layer = 0; layer < r->layers && !code; layer++)
      if (g->corrected[layer] || layer == EDA_POLY)
        code = sort_contacts(r, contacts, box, layer, how + layer * n, error);
    for (size_t i = 0; i < n && !code; i++)
      add_contact(r, box[i], how + i, n, &apart_from_poly, &on_poly);
    free(box);
    free(how);
  }
  places_init(&r->contacts, apart_from_poly.box, apart_from_poly.count, around,
              r->grid);
  places_init(&r->pads, on_poly.box, on_poly.count, around, r->grid);
  return code;
}

/* ---- lines and gaps ---- */

/* A drawn edge and its direction. */
typedef struct wall {
  eda_point a, b;
  int inwards;   /* direction from the edge to the inside of the polygon */
  int convex[2]; /* 1 for each convex corner */
} wall;

static int64_t corner_turn(eda_point a, eda_point b, eda_point c) {
  return ((int64_t)b.x - a.x) * ((int64_t)c.y - b.y) -
         ((int64_t)b.y - a.y) * ((int64_t)c.x - b.x);
}

static wall wall_of(const eda_shapes *s, size_t p, uint32_t i) {
  uint32_t from = s->start[p], n = s->start[p + 1] - from, k = i - from;
  eda_point before = s->points[from + (k + n - 1) % n];
  eda_point a = s->points[i], b = s->points[from + (k + 1) % n];
  eda_point after = s->points[from + (k + 2) % n];
  return (wall){
      .a = a,
      .b = b,
      .inwards = b.x > a.x   ? ABOVE
                 : b.x < a.x ? BELOW
                 : b.y > a.y ? LEFT
                             : RIGHT,
      .convex = {corner_turn(before, a, b) > 0, corner_turn(a, b, after) > 0}};
}

static eda_point wall_point(const wall *w, double t, double length) {
  return (eda_point){
      w->a.x + (int32_t)lround(((double)w->b.x - w->a.x) * t / length),
      w->a.y + (int32_t)lround(((double)w->b.y - w->a.y) * t / length)};
}

/* Return the point at the distance `d` from p towards `side`, ABOVE or RIGHT.
 */
static eda_point point_beyond(eda_point p, int side, int32_t d) {
  return side == ABOVE ? (eda_point){p.x, p.y + d} : (eda_point){p.x + d, p.y};
}

/* Return 1 if the point is within a gate, where no sites are needed, because
   gates are measured separately. */
static int in_gate(const drc *r, eda_point p) {
  eda_finder f = eda_index_find(r->boxes.index, (eda_box){p.x, p.y, p.x, p.y});
  for (uint32_t i; eda_index_next(&f, &i);) {
    eda_box b = r->boxes.box[i];
    if (p.x > b.x0 && p.x < b.x1 && p.y > b.y0 && p.y < b.y1) return 1;
  }
  return 0;
}

static void add_line(drc *r, size_t layer, eda_point middle, int side) {
  int32_t half = (int32_t)(r->min_width / 2 / r->grid);
  eda_box box = {middle.x, middle.y, middle.x, middle.y};
  if (layer == EDA_POLY && in_gate(r, middle)) return;
  if (side == ABOVE)
    box.y0 -= half, box.y1 += half;
  else
    box.x0 -= half, box.x1 += half;
  site_add(r, (site){.box = box,
                     .gate = nearest_gate(r, box),
                     .kind = SITE_LINE,
                     .layer = (uint16_t)layer,
                     .sides = side == ABOVE ? 1 << BELOW | 1 << ABOVE
                                            : 1 << LEFT | 1 << RIGHT});
}

static void add_gap(drc *r, size_t layer, eda_point middle, int side) {
  eda_box box = {middle.x, middle.y, middle.x, middle.y};
  site_add(r, (site){.box = box,
                     .gate = nearest_gate(r, box),
                     .kind = SITE_GAP,
                     .layer = (uint16_t)layer,
                     .sides = side == ABOVE ? 1 << BELOW : 1 << LEFT});
}

/* Add the sites of the line or gap to the right of or above an edge, so that
   each line and gap is found once. Active lines are wide and not checked. */
static void add_wall(drc *r, double step, size_t layer, const wall *w) {
  int line = w->inwards == ABOVE || w->inwards == RIGHT;
  if (line && layer == EDA_ACTIVE) return;
  int side = side_upright(w->inwards) ? RIGHT : ABOVE;
  double length = fabs((double)w->b.x - w->a.x) + fabs((double)w->b.y - w->a.y);
  double corner = tuned.rounding / r->grid, skip[2];
  for (int i = 0; i < 2; i++) skip[i] = w->convex[i] == line ? corner : 0;
  double seen = length - skip[0] - skip[1];
  if (!(seen > 0)) return;
  int32_t range = (int32_t)(tuned.wide / r->grid);
  int32_t n = (int32_t)ceil(seen / step);
  for (int32_t i = 0; i < n; i++) {
    eda_point p = wall_point(w, skip[0] + (i + 0.5) * seen / n, length);
    eda_box window =
        box_window((eda_box){p.x, p.y, p.x, p.y}, side, 1, range, 1);
    int32_t across =
        places_nearest(&r->edges[layer], window, side, range, NULL) + 1;
    if (across >= range) continue;
    eda_point middle = point_beyond(p, side, across / 2);
    if (line)
      add_line(r, layer, middle, side);
    else
      add_gap(r, layer, middle, side);
  }
}

static void add_walls(drc *r, size_t layer) {
  const eda_shapes *drawn = &r->gates->drawn[layer];
  double total = 0;
  for (size_t i = 0; i < r->edges[layer].n; i++) {
    eda_box e = r->edges[layer].box[i];
    total += (double)e.x1 - e.x0 + ((double)e.y1 - e.y0);
  }
  double step = fmax(tuned.pitch / r->grid, total / tuned.most_sites);
  for (size_t p = 0; p < drawn->count; p++)
    for (uint32_t i = drawn->start[p]; i < drawn->start[p + 1]; i++) {
      wall w = wall_of(drawn, p, i);
      add_wall(r, step, layer, &w);
    }
}

/* ---- all ---- */

static void find_widths(drc *r) {
  static const eda_edges none = {0};
  const eda_edges *e =
      r->layers > EDA_ACTIVE ? &r->gates->edges[EDA_ACTIVE] : &none;
  size_t all = e->polygons ? e->start[e->polygons] : 0, n = 0;
  eda_box *box = eda_alloc(all, sizeof *box);
  r->width = eda_alloc(all, sizeof(const eda_fragment *));
  for (size_t p = 0; p < e->polygons; p++)
    for (uint32_t i = e->start[p]; i < e->start[p + 1]; i++) {
      const eda_fragment *f = &e->fragments[i];
      if (f->role != EDA_W_LOW && f->role != EDA_W_HIGH) continue;
      uint32_t next = i + 1 < e->start[p + 1] ? i + 1 : e->start[p];
      box[n] = box_between(f->from, e->fragments[next].from);
      r->width[n++] = f;
    }
  places_init(&r->widths, box, n, around, r->grid);
}

int sites_find(drc *r, opc_error *error) {
  const eda_gates *g = r->gates;
  r->edges = eda_alloc(r->layers, sizeof *r->edges);
  r->bridging = eda_alloc(r->layers, sizeof(char *));
  for (size_t layer = 0; layer < r->layers; layer++) {
    size_t n, capacity = strlen(g->layer[layer]) + sizeof "bridging: ";
    eda_box *edges = shapes_edges(&g->drawn[layer], &n);
    places_init(&r->edges[layer], edges, n, around, r->grid);
    r->bridging[layer] = eda_alloc(capacity, 1);
    snprintf(r->bridging[layer], capacity, "bridging: %s", g->layer[layer]);
  }
  eda_box *boxes = eda_alloc(g->count, sizeof *boxes);
  for (size_t i = 0; i < g->count; i++) boxes[i] = g->box[i];
  places_init(&r->boxes, boxes, g->count, around, r->grid);
  find_widths(r);
  int code = add_contacts(r, error);
  for (size_t layer = 0; layer < r->layers && !code; layer++)
    if (g->corrected[layer]) add_walls(r, layer);
  return code;
}
