/* SPDX-License-Identifier: BSD-3-Clause */
/* Extracts the connectivity of the layout. Each layer is divided into
   rectangles; touching rectangles form a net. Gates are removed from active.
   Rectangles of different groups (match.h) are not connected. */
#include <eda/index.h>
#include <stdlib.h>
#include <string.h>

#include "match.h"

enum { UNKNOWN = UINT32_MAX - 1 }; /* the group is not yet looked up */

/* Rectangles of a layer. */
typedef struct conductor {
  size_t count, capacity;
  eda_box *box;
  size_t capacity_groups;
  uint32_t *group;
  eda_index *index;
} conductor;

typedef struct extractor {
  match_task *j;
  conductor layer[LAYERS];
  uint32_t first[LAYERS + 1]; /* first rectangle of each layer, in numbers over
                                 all layers */
  uint32_t *parent;           /* union-find forest of all rectangles */
  uint32_t *group_of; /* group of each placement, UNKNOWN until needed */
  size_t placements;
} extractor;

/* ---- loading ---- */

/* Polygons of a group to be divided into rectangles. */
typedef struct pieces {
  eda_shapes shapes;
  size_t capacity_start, capacity_points;
} pieces;

static void add_polygon(pieces *p, const eda_point *points, size_t n) {
  eda_shapes *s = &p->shapes;
  eda_grow(&s->start, &p->capacity_start, s->count + 2, sizeof *s->start);
  if (!s->count) s->start[0] = 0;
  size_t at = s->start[s->count];
  eda_grow(&s->points, &p->capacity_points, at + n, sizeof *s->points);
  memcpy(s->points + at, points, n * sizeof *points);
  s->start[++s->count] = (uint32_t)(at + n);
}

static uint32_t group_of_placement(extractor *x, uint32_t p) {
  match_task *j = x->j;
  size_t capacity = x->placements;
  eda_pool_grow(&j->pool, &x->group_of, &capacity, (size_t)p + 1,
                sizeof *x->group_of);
  for (; x->placements < capacity; x->placements++)
    x->group_of[x->placements] = UNKNOWN;
  if (x->group_of[p] == UNKNOWN) {
    char path[4096];
    eda_layout_path(j->layout, j->top, p, path, sizeof path);
    x->group_of[p] = match_group_of(j, path);
  }
  return x->group_of[p];
}

static int refuse_slanted(const match_task *j, int layer, const eda_point *p,
                          size_t n) {
  double nm = j->gates->grid;
  for (size_t i = 0; i < n; i++) {
    eda_point a = p[i], b = p[i + 1 < n ? i + 1 : 0];
    if (a.x != b.x && a.y != b.y)
      return opc_fail(j->error, OPC_INVALID, NULL,
                      "layer '%.100s' has a slanted edge from (%.10g, %.10g) "
                      "to (%.10g, %.10g) nm; only edges along x and y can be "
                      "followed",
                      eda_layout_layer_name(j->layout, j->layer[layer]),
                      a.x * nm, a.y * nm, b.x * nm, b.y * nm);
  }
  return OPC_OK;
}

static eda_shapes gates_of(const match_task *j, const region *group) {
  pieces p = {0};
  for (size_t i = 0; i < group->gates; i++) {
    const eda_box *b = &j->gates->box[group->gate[i]];
    const eda_point corner[4] = {
        {b->x0, b->y0}, {b->x1, b->y0}, {b->x1, b->y1}, {b->x0, b->y1}};
    add_polygon(&p, corner, 4);
  }
  return p.shapes;
}

/* Return 1 if a polygon without slanted edges is a rectangle. */
static int is_box(const eda_point *p, size_t n) {
  return n == 4 && p[0].x != p[2].x && p[0].y != p[2].y && p[1].x != p[3].x;
}

static void add_box(extractor *x, conductor *c, eda_box box, uint32_t group) {
  eda_pool *pool = &x->j->pool;
  eda_pool_grow(pool, &c->box, &c->capacity, c->count + 1, sizeof *c->box);
  eda_pool_grow(pool, &c->group, &c->capacity_groups, c->count + 1,
                sizeof *c->group);
  c->box[c->count] = box;
  c->group[c->count++] = group;
}

/* Add the rectangles of a group on a layer. Gates are removed from active. */
static int load_group(extractor *x, int layer, uint32_t group,
                      const eda_shapes *own) {
  match_task *j = x->j;
  eda_shapes gates = {0}, merged = {0};
  eda_box *box = NULL;
  size_t boxes = 0;
  if (layer == ACTIVE) gates = gates_of(j, &j->group[group]);
  int code = eda_boolean(EDA_NOT, own, &gates, &merged, j->error);
  if (!code) code = eda_fracture(&merged, &box, &boxes, j->error);
  for (size_t i = 0; i < boxes; i++)
    add_box(x, &x->layer[layer], box[i], group);
  free(box);
  eda_shapes_clear(&gates);
  eda_shapes_clear(&merged);
  return code;
}

static int load_shapes(extractor *x, int layer, const eda_flat *flat) {
  const eda_shapes *s = &flat->shapes;
  size_t groups = x->j->groups;
  pieces *of = eda_alloc(groups, sizeof *of);
  int code = OPC_OK;
  for (size_t i = 0; i < s->count && !code; i++) {
    const eda_point *p = s->points + s->start[i];
    size_t n = s->start[i + 1] - s->start[i];
    uint32_t group = group_of_placement(x, flat->placement[i]);
    if (group == UINT32_MAX) continue;
    code = refuse_slanted(x->j, layer, p, n);
    if (layer != ACTIVE && is_box(p, n)) /* typical for contacts */
      add_box(x, &x->layer[layer], eda_bounds(p, n), group);
    else
      add_polygon(&of[group], p, n);
  }
  for (uint32_t k = 0; k < groups; k++) {
    if (of[k].shapes.count && !code)
      code = load_group(x, layer, k, &of[k].shapes);
    eda_shapes_clear(&of[k].shapes);
  }
  free(of);
  return code;
}

static int load_layer(extractor *x, int layer) {
  match_task *j = x->j;
  conductor *c = &x->layer[layer];
  eda_flat flat = {0};
  int code = eda_layout_flatten(j->layout, j->top, j->layer[layer],
                                j->gates->grid, &flat, j->error);
  if (!code) code = load_shapes(x, layer, &flat);
  eda_flat_clear(&flat);
  if (!code) c->index = eda_index_new(c->box, c->count, 0);
  return code;
}

static int layers_load(extractor *x) {
  match_task *j = x->j;
  size_t total = 0;
  for (int k = 0; k < LAYERS; k++) {
    x->first[k] = (uint32_t)total;
    if (j->layer[k] >= 0 && load_layer(x, k)) return j->error->code;
    total += x->layer[k].count;
    if (total >= UNKNOWN)
      return opc_fail(j->error, OPC_FAILED, NULL, "too many rectangles");
  }
  x->first[LAYERS] = (uint32_t)total;
  x->parent = eda_pool_alloc(&j->pool, total, sizeof *x->parent);
  for (size_t i = 0; i < total; i++) x->parent[i] = (uint32_t)i;
  return OPC_OK;
}

/* ---- connecting ---- */

/* Search for rectangles of a group near a box on a layer. */
typedef struct search {
  const conductor *in;
  eda_finder finder;
  eda_box box;
  uint32_t group;
  int64_t dx, dy; /* overlap of the last result with the box */
} search;

static search search_begin(const extractor *x, int layer, eda_box box,
                           uint32_t group) {
  search s = {.in = &x->layer[layer], .box = box, .group = group};
  if (s.in->index) s.finder = eda_index_find(s.in->index, box);
  return s;
}

/* Find the next rectangle of the group that touches the box; 0 at the end. */
static int search_next(search *s, uint32_t *number) {
  while (s->in->index && eda_index_next(&s->finder, number)) {
    const eda_box *a = &s->box, *b = &s->in->box[*number];
    if (s->in->group[*number] != s->group) continue;
    s->dx = (int64_t)(a->x1 < b->x1 ? a->x1 : b->x1) -
            (a->x0 > b->x0 ? a->x0 : b->x0);
    s->dy = (int64_t)(a->y1 < b->y1 ? a->y1 : b->y1) -
            (a->y0 > b->y0 ? a->y0 : b->y0);
    return 1;
  }
  return 0;
}

/* Connect rectangles. Within a layer, shapes that touch only at a corner are
   not connected. Shapes of two layers are connected if they overlap. */
static void connect_layers(extractor *x, int from, int to) {
  const conductor *c = &x->layer[from];
  for (size_t i = 0; i < c->count; i++) {
    search s = search_begin(x, to, c->box[i], c->group[i]);
    for (uint32_t k; search_next(&s, &k);)
      if (from == to ? s.dx > 0 || s.dy > 0 : s.dx > 0 && s.dy > 0)
        eda_sets_join(x->parent, x->first[from] + (uint32_t)i,
                      x->first[to] + k);
  }
}

static void connect_all(extractor *x) {
  for (int k = 0; k < LAYERS; k++) connect_layers(x, k, k);
  connect_layers(x, CONTACT, POLY);
  for (int k = CONTACT; k < LAYERS; k += 2) {
    connect_layers(x, k, k - 1); /* contact to active */
    connect_layers(x, k, k + 1);
  }
}

/* ---- terminals of gates ---- */

static terminals terminals_of(const extractor *x, size_t gate) {
  const eda_gates *g = x->j->gates;
  eda_box box = g->box[gate];
  terminals found = {UINT32_MAX, UINT32_MAX, UINT32_MAX};
  search poly = search_begin(x, POLY, box, x->j->of_group[gate]);
  search active = search_begin(x, ACTIVE, box, x->j->of_group[gate]);
  int along_x = g->axis[gate] == EDA_X;
  for (uint32_t i; search_next(&poly, &i);)
    if (poly.dx > 0 && poly.dy > 0) found.gate = x->first[POLY] + i;
  for (uint32_t i; search_next(&active, &i);) {
    const eda_box *b = &x->layer[ACTIVE].box[i];
    uint32_t number = x->first[ACTIVE] + i;
    if ((along_x ? active.dy : active.dx) <= 0) continue;
    if (along_x ? b->x1 == box.x0 : b->y1 == box.y0) found.low = number;
    if (along_x ? b->x0 == box.x1 : b->y0 == box.y1) found.high = number;
  }
  return found;
}

static int find_terminals(extractor *x) {
  match_task *j = x->j;
  size_t n = j->gates->count;
  j->terminals = eda_pool_alloc(&j->pool, n, sizeof *j->terminals);
  for (size_t i = 0; i < n; i++) {
    terminals *t = &j->terminals[i];
    char name[256];
    *t = (terminals){UINT32_MAX, UINT32_MAX, UINT32_MAX};
    if (j->of_group[i] == UINT32_MAX) continue;
    *t = terminals_of(x, i);
    if (t->gate == UINT32_MAX || t->low == UINT32_MAX || t->high == UINT32_MAX)
      return opc_fail(j->error, OPC_INVALID, NULL,
                      "transistor '%s' has no %s in the same instance; set "
                      "'flat' to match across instances",
                      match_gate_name(j, i, name, sizeof name),
                      t->gate == UINT32_MAX ? "poly" : "source or drain");
  }
  return OPC_OK;
}

/* ---- labels ---- */

/* Return the rectangle at the point of a text, or UINT32_MAX if there is none.
 */
static uint32_t rectangle_below(const extractor *x, uint32_t group, eda_point p,
                                int32_t layer) {
  for (int k = 0; k < LAYERS; k++) {
    if (x->j->text_layer[k] != layer) continue;
    search s = search_begin(x, k, (eda_box){p.x, p.y, p.x, p.y}, group);
    uint32_t i;
    if (search_next(&s, &i)) return x->first[k] + i;
  }
  return UINT32_MAX;
}

/* Read the texts of a layer that are in the top cell of a group, as labels of
   the rectangles at their points. */
static int load_texts(extractor *x, int32_t layer) {
  match_task *j = x->j;
  eda_flat_texts texts;
  int code = eda_layout_flatten_texts(j->layout, j->top, layer, j->gates->grid,
                                      &texts, j->error);
  for (size_t i = 0; i < texts.at.shapes.count; i++) {
    char path[4096];
    eda_layout_path(j->layout, j->top, texts.at.placement[i], path,
                    sizeof path);
    const uint32_t *group = eda_names_find(&j->group_of, path);
    if (!group) continue;
    uint32_t on = rectangle_below(x, *group, texts.at.shapes.points[i], layer);
    if (on == UINT32_MAX) {
      j->loose++;
      continue;
    }
    eda_pool_grow(&j->pool, &j->label, &j->capacity_labels, j->labels + 1,
                  sizeof *j->label);
    j->label[j->labels] = (label){on, *group, j->labels, texts.text[i]};
    j->labels++;
  }
  eda_flat_texts_clear(&texts);
  return code;
}

EDA_COMPARE_RISING(by_group_of_label, label, group, number);

/* Sort the labels by group, and join nets of a group that have equal labels. */
static int load_labels(extractor *x) {
  match_task *j = x->j;
  for (int k = 0; k < LAYERS; k++) {
    int done = j->text_layer[k] < 0;
    for (int i = 0; i < k; i++) done |= j->text_layer[i] == j->text_layer[k];
    if (!done && load_texts(x, j->text_layer[k])) return j->error->code;
  }
  if (j->labels)
    qsort(j->label, j->labels, sizeof *j->label, by_group_of_label);
  eda_names first = {0};
  for (size_t i = 0; i < j->labels; i++) {
    const label *l = &j->label[i];
    region *group = &j->group[l->group];
    if (!group->labels++) {
      group->label = l;
      first = (eda_names){.pool = &j->pool};
    }
    uint32_t *before = eda_names_add(&first, l->text);
    if (*before == UINT32_MAX)
      *before = l->net;
    else
      eda_sets_join(x->parent, l->net, *before);
  }
  return OPC_OK;
}

/* ---- all steps ---- */

/* Number the nets in the order of the gates. */
static void number_nets(extractor *x) {
  match_task *j = x->j;
  uint32_t *net = match_unknown(j, x->first[LAYERS]);
  for (size_t i = 0; i < j->gates->count; i++) {
    terminals *t = &j->terminals[i];
    if (t->gate == UINT32_MAX) continue;
    uint32_t *each[3] = {&t->gate, &t->low, &t->high};
    for (int k = 0; k < 3; k++) {
      uint32_t at = eda_set_root(x->parent, *each[k]);
      if (net[at] == UINT32_MAX) net[at] = (uint32_t)j->nets++;
      *each[k] = net[at];
    }
  }
  for (size_t i = 0; i < j->labels; i++)
    j->label[i].net = net[eda_set_root(x->parent, j->label[i].net)];
}

int match_extract(match_task *j) {
  extractor x = {.j = j};
  int code = layers_load(&x);
  if (!code) {
    connect_all(&x);
    code = find_terminals(&x);
  }
  if (!code) code = load_labels(&x);
  if (!code) number_nets(&x);
  for (int k = 0; k < LAYERS; k++) eda_index_free(x.layer[k].index);
  return code;
}
