/* SPDX-License-Identifier: BSD-3-Clause */
/* Which part of the layout a subcircuit is. Where the layout has instances of
   the netlist's names and cells, each is matched for itself, and so needs no
   wires between them; where it has not, a subcircuit is matched flat. */
#include <math.h>
#include <string.h>
#include <strings.h>

#include "match.h"

/* ---- transforms, as flattening has them (layout.h) ---- */

static void turn(double angle, double *cosine, double *sine) {
  static const double right[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  double quarters = nearbyint(angle / 90);
  if (fabs(angle - 90 * quarters) < 1e-9) {
    int q = ((int)fmod(quarters, 4) + 4) % 4;
    *cosine = right[q][0];
    *sine = right[q][1];
  } else {
    double radians = fmod(angle, 360) * (acos(-1) / 180);
    *cosine = cos(radians);
    *sine = sin(radians);
  }
}

static transform compose(const transform *out, const opc_placement *p) {
  double c, s, flip = p->mirror ? -1 : 1;
  turn(p->angle, &c, &s);
  c *= p->magnification;
  s *= p->magnification;
  double x = p->origin.x, y = p->origin.y;
  return (transform){
      out->xx * c + out->xy * s,           (out->xy * c - out->xx * s) * flip,
      out->yx * c + out->yy * s,           (out->yy * c - out->yx * s) * flip,
      out->xx * x + out->xy * y + out->dx, out->yx * x + out->yy * y + out->dy};
}

/* ---- groups ---- */

enum { AMBIGUOUS = UINT32_MAX - 1 };

static int add_group(job *j, const region *g) {
  if (!pool_grow(&j->pool, &j->group, &j->room_groups, j->groups + 1,
                 sizeof *j->group))
    return match_no_memory(j);
  uint32_t *at = map_add(&j->group_of, g->path);
  if (!at) return match_no_memory(j);
  *at = (uint32_t)j->groups;
  j->group[j->groups++] = *g;
  return OPC_OK;
}

/* Names of the single instances of a cell. */
static int list_instances(job *j, int32_t cell, name_map *names) {
  const opc_layout_service *layout = j->host->layout;
  for (size_t i = 0; i < layout->instances(j->layout, cell); i++) {
    opc_placement p;
    int32_t child;
    const char *name = layout->instance(j->layout, cell, i, &child, &p);
    if (!name || (uint64_t)p.columns * p.rows != 1) continue;
    uint32_t *at = map_add(names, name);
    if (!at) return match_no_memory(j);
    *at = *at == UINT32_MAX ? (uint32_t)i : (uint32_t)AMBIGUOUS;
  }
  return OPC_OK;
}

/* The instance of the layout that an element is by its name, with or without
   its X; -1 if there is none. */
static int64_t by_name(const name_map *names, const element *e) {
  const char *name = e->name;
  uint32_t *at = map_find(names, name, strlen(name));
  if (!at && name[1]) at = map_find(names, name + 1, strlen(name + 1));
  return at && *at != (uint32_t)AMBIGUOUS ? (int64_t)*at : -1;
}

static const char *child_of(const job *j, int32_t cell, int64_t i,
                            int32_t *child, opc_placement *p) {
  j->host->layout->instance(j->layout, cell, (size_t)i, child, p);
  return j->host->layout->cell_name(j->layout, *child);
}

/* How many elements have their cell in the layout by name. */
static size_t count_pairs(const job *j, const region *g,
                          const name_map *names) {
  const subcircuit *s = g->scope->of;
  size_t pairs = 0;
  for (size_t i = 0; i < s->elements; i++) {
    const element *e = &s->element[i];
    int32_t child;
    opc_placement p;
    if (e->is_transistor) return 0;
    if (!j->netlist.subcircuit[e->child].devices) continue;
    int64_t at = by_name(names, e);
    pairs +=
        at >= 0 && same_name(child_of(j, g->cell, at, &child, &p), e->model);
  }
  return pairs;
}

static int pair(job *j, const region *g);

static int pair_element(job *j, const region *g, const element *e,
                        const name_map *names, uint64_t first) {
  char where[256];
  int64_t at = by_name(names, e);
  netlist_where(&j->netlist, e, where, sizeof where);
  if (at < 0)
    return j->host->fail(j->host, j->error, OPC_INVALID, "file",
                         "netlist instance '%.100s' (%s) is not in cell "
                         "'%.100s' of the layout",
                         e->name, where,
                         j->host->layout->cell_name(j->layout, g->cell));
  int32_t child;
  opc_placement p;
  const char *cell = child_of(j, g->cell, at, &child, &p);
  if (!same_name(cell, e->model))
    return j->host->fail(j->host, j->error, OPC_INVALID, "file",
                         "netlist instance '%.100s' (%s) is a '%.100s', and a "
                         "'%.100s' in the layout",
                         e->name, where, e->model, cell);
  const char *name =
      j->host->layout->instance(j->layout, g->cell, (size_t)at, &child, &p);
  scope *in = pool_alloc(&j->pool, 1, sizeof *in);
  region below = {in, child, pool_path(&j->pool, g->path, name),
                  compose(&g->at, &p), first};
  if (!in || !below.path) return match_no_memory(j);
  *in = (scope){g->scope, &j->netlist.subcircuit[e->child], e};
  return pair(j, &below);
}

static int pair(job *j, const region *g) {
  name_map names = {.pool = &j->pool};
  const subcircuit *s = g->scope->of;
  if (j->ignore_hierarchy) return add_group(j, g);
  if (list_instances(j, g->cell, &names)) return j->error->code;
  if (!count_pairs(j, g, &names)) return add_group(j, g);
  uint64_t first = g->first_device;
  for (size_t i = 0; i < s->elements; i++) {
    const element *e = &s->element[i];
    uint64_t devices = j->netlist.subcircuit[e->child].devices;
    if (devices && pair_element(j, g, e, &names, first)) return j->error->code;
    first += devices;
  }
  return OPC_OK;
}

/* The group of an instance of that path: the deepest one that it lies in. */
uint32_t match_group_of(const job *j, const char *path) {
  for (size_t n = strlen(path);;) {
    uint32_t *at = map_find(&j->group_of, n ? path : "", n);
    if (at) return *at;
    if (!n) return UINT32_MAX;
    while (n && path[n - 1] != '/') n--;
    if (n) n--;
  }
}

int match_pair(job *j, const scope *top) {
  j->group_of.pool = &j->pool;
  region whole = {top, j->top, "", {1, 0, 0, 1, 0, 0}, 0};
  if (pair(j, &whole)) return j->error->code;
  const opc_gates *g = j->gates;
  j->of_group = pool_alloc(&j->pool, g->count, sizeof *j->of_group);
  if (!j->of_group) return match_no_memory(j);
  for (size_t i = 0; i < g->count; i++)
    j->of_group[i] = i && g->instance[i] == g->instance[i - 1]
                         ? j->of_group[i - 1]
                         : match_group_of(j, g->instance[i]);
  return OPC_OK;
}
