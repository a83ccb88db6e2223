/* SPDX-License-Identifier: BSD-3-Clause */
/* What is connected in the layout. Every layer becomes rectangles; those that
   touch are one net, active without its gates. Each group is for itself. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "match.h"

enum { UNKNOWN = UINT32_MAX - 1 };

typedef struct extractor {
  job *j;
  rectangles layer[LAYERS];
  bins bins[LAYERS];
  uint32_t first[LAYERS + 1]; /* number of the first rectangle of a layer */
  uint32_t *parent;           /* of all rectangles: a forest of nets */
  uint32_t *group_of;         /* of placements that were seen */
  size_t placements;
  rectangles gates;
  bins gate_bins;
} extractor;

/* ---- nets ---- */

static uint32_t root(const extractor *x, uint32_t i) {
  uint32_t *parent = x->parent;
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

static void join(extractor *x, uint32_t a, uint32_t b) {
  a = root(x, a);
  b = root(x, b);
  if (a < b)
    x->parent[b] = a;
  else
    x->parent[a] = b;
}

/* ---- loading ---- */

static uint32_t group_of_placement(extractor *x, uint32_t p) {
  job *j = x->j;
  if (p >= x->placements) {
    size_t room = x->placements;
    if (!pool_grow(&j->pool, &x->group_of, &room, (size_t)p + 1,
                   sizeof *x->group_of))
      return UNKNOWN;
    for (size_t i = x->placements; i < room; i++) x->group_of[i] = UNKNOWN;
    x->placements = room;
  }
  if (x->group_of[p] == UNKNOWN) {
    char path[4096];
    j->host->layout->path(j->layout, j->top, p, path, sizeof path);
    x->group_of[p] = match_group_of(j, path);
  }
  return x->group_of[p];
}

static int refuse_slanted(extractor *x, int layer, const opc_point *p, size_t n,
                          size_t at) {
  const job *j = x->j;
  double nm = j->gates->grid;
  opc_point a = p[at], b = p[(at + 1) % n];
  return j->host->fail(
      j->host, j->error, OPC_INVALID, NULL,
      "layer '%.100s' has a slanted edge from (%.10g, %.10g) to (%.10g, "
      "%.10g) nm; only edges along x and y can be followed",
      j->host->layout->layer_name(j->layout, j->layer[layer]), a.x * nm,
      a.y * nm, b.x * nm, b.y * nm);
}

static int load_shapes(extractor *x, int layer, const opc_flat *flat,
                       rectangles *out) {
  job *j = x->j;
  const opc_shapes *s = &flat->shapes;
  for (size_t i = 0; i < s->count; i++) {
    uint32_t group = group_of_placement(x, flat->placement[i]);
    if (group == UNKNOWN) return match_no_memory(j);
    if (group == UINT32_MAX) continue;
    size_t n = s->start[i + 1] - s->start[i], slanted = 0;
    const opc_point *p = s->points + s->start[i];
    int code = match_cut(j, p, n, group, out, &slanted);
    if (code < 0) return refuse_slanted(x, layer, p, n, slanted);
    if (code) return code;
  }
  return OPC_OK;
}

typedef struct collected {
  extractor *x;
  rectangle of;
  opc_box *box;
  size_t count, room;
  int failed;
} collected;

static void collect_gate(void *data, uint32_t i) {
  collected *c = data;
  if (c->x->gates.all[i].group != c->of.group) return;
  if (!pool_grow(&c->x->j->pool, &c->box, &c->room, c->count + 1,
                 sizeof *c->box))
    c->failed = 1;
  else
    c->box[c->count++] = c->x->gates.all[i].box;
}

/* Active without its gates. */
static int take_gates(extractor *x, const rectangles *active) {
  collected c = {.x = x};
  for (size_t i = 0; i < active->count; i++) {
    c.of = active->all[i];
    c.count = 0;
    match_query(&x->gate_bins, c.of.box, collect_gate, &c);
    if (c.failed) return match_no_memory(x->j);
    if (match_subtract(x->j, &c.of, c.box, c.count, &x->layer[ACTIVE]))
      return x->j->error->code;
  }
  return OPC_OK;
}

static int load_gates(extractor *x) {
  job *j = x->j;
  size_t n = j->gates->count;
  x->gates.all = pool_alloc(&j->pool, n, sizeof *x->gates.all);
  if (!x->gates.all) return match_no_memory(j);
  x->gates.count = n;
  for (size_t i = 0; i < n; i++)
    x->gates.all[i] = (rectangle){j->gates->box[i], j->of_group[i]};
  return match_bins(j, &x->gates, &x->gate_bins);
}

static int load(extractor *x) {
  job *j = x->j;
  size_t total = 0;
  if (load_gates(x)) return j->error->code;
  for (int k = 0; k < LAYERS; k++) {
    x->first[k] = (uint32_t)total;
    if (j->layer[k] >= 0) {
      opc_flat flat = {0};
      rectangles drawn = {0};
      int code =
          j->host->layout->flatten(j->host, j->layout, j->top, j->layer[k],
                                   j->gates->grid, &flat, j->error);
      if (!code)
        code = load_shapes(x, k, &flat, k == ACTIVE ? &drawn : &x->layer[k]);
      if (!code && k == ACTIVE) code = take_gates(x, &drawn);
      j->host->layout->release(&flat);
      if (!code) code = match_bins(j, &x->layer[k], &x->bins[k]);
      if (code) return code;
    }
    total += x->layer[k].count;
  }
  x->first[LAYERS] = (uint32_t)total;
  if (total >= UNKNOWN) return match_no_memory(j);
  x->parent = pool_alloc(&j->pool, total, sizeof *x->parent);
  if (!x->parent) return match_no_memory(j);
  for (size_t i = 0; i < total; i++) x->parent[i] = (uint32_t)i;
  return OPC_OK;
}

/* ---- connecting ---- */

typedef struct seeker {
  extractor *x;
  rectangle of;
  uint32_t number;
  int layer;  /* that is looked into */
  int inside; /* they must share area, not only an edge */
} seeker;

/* Shapes that only meet in a corner are not connected. */
static void connect(void *data, uint32_t i) {
  seeker *s = data;
  const rectangle *r = &s->x->layer[s->layer].all[i];
  int64_t dx, dy;
  if (r->group != s->of.group) return;
  match_overlap(r->box, s->of.box, &dx, &dy);
  if (s->inside ? dx > 0 && dy > 0 : dx > 0 || dy > 0)
    join(s->x, s->number, s->x->first[s->layer] + i);
}

static void connect_layers(extractor *x, int from, int to) {
  for (size_t i = 0; i < x->layer[from].count; i++) {
    seeker s = {x, x->layer[from].all[i], x->first[from] + (uint32_t)i, to,
                from != to};
    match_query(&x->bins[to], s.of.box, connect, &s);
  }
}

static void connect_all(extractor *x) {
  for (int k = 0; k < LAYERS; k++) connect_layers(x, k, k);
  connect_layers(x, CONTACT, POLY);
  for (int k = CONTACT; k < LAYERS; k += 2) {
    connect_layers(x, k, k - 1); /* of a contact: active */
    connect_layers(x, k, k + 1);
  }
}

/* ---- terminals of gates ---- */

typedef struct finder {
  extractor *x;
  opc_box box;
  uint32_t group;
  int axis;
  terminals found;
} finder;

static void find_poly(void *data, uint32_t i) {
  finder *f = data;
  const rectangle *r = &f->x->layer[POLY].all[i];
  int64_t dx, dy;
  match_overlap(r->box, f->box, &dx, &dy);
  if (r->group == f->group && dx > 0 && dy > 0)
    f->found.gate = f->x->first[POLY] + i;
}

static void find_side(void *data, uint32_t i) {
  finder *f = data;
  const rectangle *r = &f->x->layer[ACTIVE].all[i];
  int64_t dx, dy;
  match_overlap(r->box, f->box, &dx, &dy);
  if (r->group != f->group || (f->axis == OPC_X ? dy : dx) <= 0) return;
  uint32_t number = f->x->first[ACTIVE] + i;
  int low = f->axis == OPC_X ? r->box.x1 == f->box.x0 : r->box.y1 == f->box.y0;
  int high = f->axis == OPC_X ? r->box.x0 == f->box.x1 : r->box.y0 == f->box.y1;
  if (low) f->found.low = number;
  if (high) f->found.high = number;
}

static int find_terminals(extractor *x) {
  job *j = x->j;
  const opc_gates *g = j->gates;
  j->terminals = pool_alloc(&j->pool, g->count, sizeof *j->terminals);
  if (!j->terminals) return match_no_memory(j);
  for (size_t i = 0; i < g->count; i++) {
    terminals none = {UINT32_MAX, UINT32_MAX, UINT32_MAX};
    finder f = {x, g->box[i], j->of_group[i], g->axis[i], none};
    j->terminals[i] = none;
    if (f.group == UINT32_MAX) continue;
    match_query(&x->bins[POLY], f.box, find_poly, &f);
    match_query(&x->bins[ACTIVE], f.box, find_side, &f);
    char name[256];
    if (f.found.gate == UINT32_MAX || f.found.low == UINT32_MAX ||
        f.found.high == UINT32_MAX)
      return j->host->fail(
          j->host, j->error, OPC_INVALID, NULL,
          "transistor '%s' has no %s in its own instance; "
          "set 'flat' to match across instances",
          match_gate_name(j, i, name, sizeof name),
          f.found.gate == UINT32_MAX ? "poly" : "source or drain");
    j->terminals[i] = f.found;
  }
  return OPC_OK;
}

/* ---- labels ---- */

static void find_label(void *data, uint32_t i) {
  finder *f = data;
  if (f->x->layer[f->axis].all[i].group == f->group)
    f->found.gate = f->x->first[f->axis] + i;
}

/* The rectangle below a text; UINT32_MAX: none. */
static uint32_t below(extractor *x, uint32_t group, opc_point at,
                      int32_t layer) {
  const job *j = x->j;
  const transform *t = &j->group[group].at;
  double unit = j->host->layout->unit(j->layout) / j->gates->grid;
  double px = floor((t->xx * at.x + t->xy * at.y + t->dx) * unit + 0.5);
  double py = floor((t->yx * at.x + t->yy * at.y + t->dy) * unit + 0.5);
  if (!(fabs(px) < 1 << 30) || !(fabs(py) < 1 << 30)) return UINT32_MAX;
  opc_point p = {(int32_t)px, (int32_t)py};
  for (int k = 0; k < LAYERS; k++) {
    if (j->text_layer[k] != layer || layer < 0) continue;
    finder f = {.x = x, .group = group, .axis = k, .found = {UINT32_MAX, 0, 0}};
    match_query(&x->bins[k], (opc_box){p.x, p.y, p.x, p.y}, find_label, &f);
    if (f.found.gate != UINT32_MAX) return f.found.gate;
  }
  return UINT32_MAX;
}

static int is_text_layer(const job *j, int32_t layer) {
  for (int k = 0; k < LAYERS; k++)
    if (j->text_layer[k] == layer) return 1;
  return 0;
}

/* Nets of a group with the same label are one. */
static int label_group(extractor *x, uint32_t group) {
  job *j = x->j;
  const opc_layout_service *layout = j->host->layout;
  int32_t cell = j->group[group].cell;
  name_map first = {.pool = &j->pool};
  for (size_t i = 0; i < layout->texts(j->layout, cell); i++) {
    opc_point at;
    int32_t layer;
    const char *text = layout->text(j->layout, cell, i, &at, &layer);
    if (!is_text_layer(j, layer)) continue;
    uint32_t on = below(x, group, at, layer);
    if (on == UINT32_MAX) {
      j->loose++;
      continue;
    }
    uint32_t *before = map_add(&first, text);
    if (!before || !pool_grow(&j->pool, &j->label, &j->room_labels,
                              j->labels + 1, sizeof *j->label))
      return match_no_memory(j);
    if (*before == UINT32_MAX)
      *before = on;
    else
      join(x, on, *before);
    j->label[j->labels++] = (label){on, group, text};
  }
  return OPC_OK;
}

/* ---- the order of the work ---- */

/* Nets get numbers in the order of the gates. */
static int number_nets(extractor *x) {
  job *j = x->j;
  uint32_t *net = pool_alloc(&j->pool, x->first[LAYERS], sizeof *net);
  if (!net) return match_no_memory(j);
  for (size_t i = 0; i < x->first[LAYERS]; i++) net[i] = UINT32_MAX;
  for (size_t i = 0; i < j->gates->count; i++) {
    terminals *t = &j->terminals[i];
    if (t->gate == UINT32_MAX) continue;
    uint32_t *each[3] = {&t->gate, &t->low, &t->high};
    for (int k = 0; k < 3; k++) {
      uint32_t at = root(x, *each[k]);
      if (net[at] == UINT32_MAX) net[at] = (uint32_t)j->nets++;
      *each[k] = net[at];
    }
  }
  for (size_t i = 0; i < j->labels; i++)
    j->label[i].net = net[root(x, j->label[i].net)];
  return OPC_OK;
}

int match_extract(job *j) {
  extractor x = {.j = j};
  if (load(&x)) return j->error->code;
  connect_all(&x);
  if (find_terminals(&x)) return j->error->code;
  for (size_t g = 0; g < j->groups; g++)
    if (label_group(&x, (uint32_t)g)) return j->error->code;
  return number_nets(&x);
}
