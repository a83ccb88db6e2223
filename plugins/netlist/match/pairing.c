/* SPDX-License-Identifier: BSD-3-Clause */
/* Assigns subcircuits to parts of the layout. An instance that the layout has
   with the same name and cell is matched separately, without the wires between
   instances; other subcircuits are matched flat. */
#include <glib.h>
#include <string.h>

#include "match.h"

/* ---- groups ---- */

enum { AMBIGUOUS = UINT32_MAX - 1 }; /* several instances have this name */

static void add_group(match_task *j, const region *g) {
  eda_pool_grow(&j->pool, &j->group, &j->capacity_groups, j->groups + 1,
                sizeof *j->group);
  *eda_names_add(&j->group_of, g->path) = (uint32_t)j->groups;
  j->group[j->groups++] = *g;
}

/* List the names of the instances of a cell, except arrays. */
static void list_instances(match_task *j, int32_t cell, eda_names *names) {
  for (size_t i = 0; i < eda_layout_instances(j->layout, cell); i++) {
    eda_placement p;
    int32_t child;
    const char *name = eda_layout_instance(j->layout, cell, i, &child, &p);
    if (!name || (uint64_t)p.columns * p.rows != 1) continue;
    uint32_t *at = eda_names_add(names, name);
    *at = *at == UINT32_MAX ? (uint32_t)i : (uint32_t)AMBIGUOUS;
  }
}

/* Return the instance of the layout with the name of an element, or -1. The
   first letter of the element's name (X) may be missing in the layout. */
static int64_t by_name(const eda_names *names, const eda_element *e) {
  const char *name = e->name;
  uint32_t *at = eda_names_find(names, name);
  if (!at && name[1]) at = eda_names_find(names, name + 1);
  return at && *at != (uint32_t)AMBIGUOUS ? (int64_t)*at : -1;
}

/* Return the name of an instance, and set its cell. */
static const char *instance_name(const match_task *j, int32_t cell, int64_t i,
                                 int32_t *child) {
  eda_placement p;
  return eda_layout_instance(j->layout, cell, (size_t)i, child, &p);
}

static int is_cell(const match_task *j, int32_t cell, const char *name) {
  return eda_same_name(eda_layout_cell_name(j->layout, cell), name);
}

/* Return the number of elements for which the layout has an instance of the
   same name and cell. */
static size_t count_pairs(const match_task *j, const region *g,
                          const eda_names *names) {
  const eda_subcircuit *s = g->scope->of;
  size_t pairs = 0;
  for (size_t i = 0; i < s->elements; i++) {
    const eda_element *e = &s->element[i];
    if (e->is_transistor) return 0;
    if (!j->netlist.subcircuit[e->child].devices) continue;
    int64_t at = by_name(names, e);
    int32_t child;
    pairs += at >= 0 && instance_name(j, g->cell, at, &child) &&
             is_cell(j, child, e->model);
  }
  return pairs;
}

static int pair_region(match_task *j, const region *g);

static int pair_element(match_task *j, const region *g, const eda_element *e,
                        const eda_names *names, uint64_t first) {
  char where[256];
  int64_t at = by_name(names, e);
  eda_netlist_where(&j->netlist, e, where, sizeof where);
  if (at < 0)
    return opc_fail(j->error, OPC_INVALID, "file",
                    "netlist instance '%.100s' (%s) is not in cell "
                    "'%.100s' of the layout",
                    e->name, where, eda_layout_cell_name(j->layout, g->cell));
  int32_t child;
  const char *name = instance_name(j, g->cell, at, &child);
  if (!is_cell(j, child, e->model))
    return opc_fail(j->error, OPC_INVALID, "file",
                    "netlist instance '%.100s' (%s) is a '%.100s', and a "
                    "'%.100s' in the layout",
                    e->name, where, e->model,
                    eda_layout_cell_name(j->layout, child));
  eda_scope *in = eda_pool_alloc(&j->pool, 1, sizeof *in);
  *in = (eda_scope){g->scope, &j->netlist.subcircuit[e->child], e};
  region below = {.scope = in,
                  .cell = child,
                  .path = eda_pool_path(&j->pool, g->path, name),
                  .first_device = first};
  return pair_region(j, &below);
}

static int pair_region(match_task *j, const region *g) {
  eda_names names = {.pool = &j->pool};
  const eda_subcircuit *s = g->scope->of;
  if (!j->ignore_hierarchy) list_instances(j, g->cell, &names);
  if (!count_pairs(j, g, &names)) {
    add_group(j, g);
    return OPC_OK;
  }
  uint64_t first = g->first_device;
  for (size_t i = 0; i < s->elements; i++) {
    const eda_element *e = &s->element[i];
    uint64_t devices = j->netlist.subcircuit[e->child].devices;
    if (devices && pair_element(j, g, e, &names, first)) return j->error->code;
    first += devices;
  }
  return OPC_OK;
}

uint32_t match_group_of(const match_task *j, const char *path) {
  g_autofree char *part = g_strdup(path);
  for (;;) {
    uint32_t *at = eda_names_find(&j->group_of, part);
    if (at || !*part) return at ? *at : UINT32_MAX;
    char *slash = strrchr(part, '/');
    *(slash ? slash : part) = 0;
  }
}

/* List the gates of each group, in increasing order. */
static void list_gates(match_task *j) {
  const eda_gates *g = j->gates;
  uint32_t *list = eda_pool_alloc(&j->pool, g->count, sizeof *list);
  j->of_group = eda_pool_alloc(&j->pool, g->count, sizeof *j->of_group);
  for (size_t i = 0; i < g->count; i++) {
    j->of_group[i] = i && g->instance[i] == g->instance[i - 1]
                         ? j->of_group[i - 1]
                         : match_group_of(j, g->instance[i]);
    if (j->of_group[i] != UINT32_MAX) j->group[j->of_group[i]].gates++;
  }
  uint32_t **end = eda_pool_alloc(&j->pool, j->groups, sizeof *end);
  for (size_t k = 0; k < j->groups; k++) {
    j->group[k].gate = end[k] = list;
    list += j->group[k].gates;
  }
  for (size_t i = 0; i < g->count; i++)
    if (j->of_group[i] != UINT32_MAX) *end[j->of_group[i]]++ = (uint32_t)i;
}

int match_pair(match_task *j, const eda_scope *top) {
  j->group_of.pool = &j->pool;
  region whole = {.scope = top, .cell = j->top, .path = ""};
  int code = pair_region(j, &whole);
  if (!code) list_gates(j);
  return code;
}
