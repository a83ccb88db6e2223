/* SPDX-License-Identifier: BSD-3-Clause */
/* Reading device tables; docs/devices.md tells the format. */
#include <math.h>
#include <string.h>

#include "core/flow/node.h"
#include "core/flow/value.h"
#include "core/plugin/host.h"
#include "core/plugin/suggest.h"

/* An opc_devices and what it points to. */
typedef struct table {
  opc_devices devices; /* first: what the plugin gets */
  GPtrArray *owned;
} table;

typedef struct reader {
  table *table;
  opc_problems *problems;
} reader;

/* ---- pieces of the file ---- */

/* Complain about what `known` (NULL-terminated) does not have. */
static void check_keys(const reader *r, const opc_node *map,
                       const char *const *known) {
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (guint i = 0; known[i]; i++) g_ptr_array_add(names, (char *)known[i]);
  for (guint i = 0; i < map->keys->len; i++) {
    const opc_node *key = map->keys->pdata[i];
    if (g_strv_contains(known, key->text)) continue;
    g_autofree char *suggestion = opc_suggestion(key->text, names);
    opc_problem_add(r->problems, OPC_INVALID, &key->at, "unknown key '%s'%s",
                    key->text, suggestion);
  }
}

/* The map `key` of `parent` with the keys `known`, NULL and a problem. */
static const opc_node *get_map(const reader *r, const opc_node *parent,
                               const char *key, const char *const *known) {
  const opc_node *node = opc_node_get(parent, key);
  if (!node || node->type != OPC_NODE_MAP) {
    opc_problem_add(r->problems, OPC_INVALID, node ? &node->at : &parent->at,
                    node ? "'%s' needs a map" : "missing '%s'", key);
    return NULL;
  }
  check_keys(r, node, known);
  return node;
}

/* A value of a map, as a parameter of that name; FALSE if it is missing or
   wrong. */
static gboolean get(const reader *r, const opc_node *map,
                    const opc_parameter *p, opc_value *value) {
  const opc_node *node = opc_node_get(map, p->name);
  memset(value, 0, sizeof *value);
  if (node)
    return opc_value_convert(p, node, FALSE, r->table->owned, r->problems,
                             value);
  if (p->flags & OPC_REQUIRED)
    opc_problem_add(r->problems, OPC_INVALID, &map->at, "missing '%s'",
                    p->name);
  return FALSE;
}

/* `{ unit: nm, values: [...] }` in `unit`, each above 0; NULL and a problem.
   The numbers get the unit of the column before they are read. */
static double *get_column(const reader *r, const opc_node *parent,
                          const char *key, const char *unit, size_t *count) {
  static const char *const known[] = {"unit", "values", NULL};
  const opc_node *map = get_map(r, parent, key, known);
  const opc_node *given = opc_node_get(map, "unit");
  const opc_node *list = opc_node_get(map, "values");
  if (!map) return NULL;
  if (!given || given->type != OPC_NODE_TEXT || !list ||
      list->type != OPC_NODE_LIST) {
    opc_problem_add(r->problems, OPC_INVALID, &map->at,
                    "'%s' needs '{ unit: %s, values: [...] }'", key, unit);
    return NULL;
  }
  const opc_parameter p = {key, OPC_REAL, OPC_ABOVE, unit, NULL,
                           0,   0,        NULL,      NULL};
  *count = list->items->len;
  double *column = g_new0(double, MAX(*count, 1));
  g_ptr_array_add(r->table->owned, column);
  gboolean good = TRUE;
  for (size_t i = 0; i < *count; i++) {
    const opc_node *item = list->items->pdata[i];
    opc_node with_unit = *item;
    g_autofree char *text =
        item->type == OPC_NODE_TEXT
            ? g_strdup_printf("%s %s", item->text, given->text)
            : NULL;
    with_unit.text = text;
    opc_value value = {0};
    good &= opc_value_convert(&p, &with_unit, FALSE, r->table->owned,
                              r->problems, &value);
    column[i] = value.real;
  }
  return good ? column : NULL;
}

static void read_lengths(const reader *r, const opc_node *root) {
  opc_devices *d = &r->table->devices;
  double *length = get_column(r, root, "length", "nm", &d->count);
  if (!length) return;
  const opc_node *list = opc_node_get(opc_node_get(root, "length"), "values");
  if (d->count < 2)
    opc_problem_add(r->problems, OPC_INVALID, &list->at,
                    "'length' needs two values or more");
  for (size_t i = 1; i < d->count; i++) {
    const opc_node *item = list->items->pdata[i];
    if (length[i] <= length[i - 1])
      opc_problem_add(r->problems, OPC_INVALID, &item->at,
                      "lengths must increase: '%s'", item->text);
  }
  d->length = length;
}

/* The currents of one type, per width. */
static void read_type(const reader *r, const opc_node *root, const char *key,
                      int type) {
  static const char *const known[] = {"ion", "ioff", NULL};
  opc_devices *d = &r->table->devices;
  const opc_node *map = get_map(r, root, key, known);
  for (int i = 0; map && i < 2; i++) {
    size_t count = 0;
    double *current = get_column(r, map, known[i], "A", &count);
    if (!current) continue;
    if (d->length && count != d->count)
      opc_problem_add(
          r->problems, OPC_INVALID, &opc_node_get(map, known[i])->at,
          "'%s' has %zu values, 'length' has %zu", known[i], count, d->count);
    for (size_t j = 0; d->width > 0 && j < count; j++) current[j] /= d->width;
    (i ? d->ioff : d->ion)[type] = current;
  }
}

static void read_head(const reader *r, const opc_node *root) {
  const uint32_t positive = OPC_REQUIRED | OPC_ABOVE;
  const opc_parameter version = {"opcflow-devices",
                                 OPC_INT,
                                 OPC_REQUIRED | OPC_AT_LEAST | OPC_AT_MOST,
                                 NULL,
                                 NULL,
                                 1,
                                 1,
                                 NULL,
                                 NULL};
  const opc_parameter name = {"name", OPC_TEXT, OPC_REQUIRED, NULL, NULL,
                              0,      0,        NULL,         NULL};
  const opc_parameter supply = {"supply", OPC_REAL, positive, "V", NULL,
                                0,        0,        NULL,     NULL};
  const opc_parameter width = {"width", OPC_REAL, positive, "nm", NULL,
                               0,       0,        NULL,     NULL};
  const opc_parameter temperature = {
      "temperature", OPC_REAL, 0, "C", NULL, 0, 0, NULL, NULL};
  static const char *const notes[] = {"source", "ion", "ioff"};
  opc_devices *d = &r->table->devices;
  opc_value value;
  get(r, root, &version, &value);
  if (get(r, root, &name, &value)) d->name = value.text;
  if (get(r, root, &supply, &value)) d->supply = value.real;
  if (get(r, root, &width, &value)) d->width = value.real;
  get(r, root, &temperature, &value);
  for (size_t i = 0; i < G_N_ELEMENTS(notes); i++) {
    const opc_parameter note = {notes[i], OPC_TEXT, 0,    NULL, NULL,
                                0,        0,        NULL, NULL};
    get(r, root, &note, &value);
  }
}

static void read_table(const reader *r, const opc_node *root) {
  static const char *const known[] = {
      "opcflow-devices", "name",  "source", "supply",
      "temperature",     "width", "ion",    "ioff",
      "length",          "nmos",  "pmos",   NULL};
  if (root->type != OPC_NODE_MAP) {
    opc_problem_add(r->problems, OPC_INVALID, &root->at,
                    "a device table is a map, not %s", opc_node_noun(root));
    return;
  }
  check_keys(r, root, known);
  read_head(r, root);
  read_lengths(r, root);
  read_type(r, root, "nmos", OPC_NMOS);
  read_type(r, root, "pmos", OPC_PMOS);
}

/* ---- the service ---- */

static void release(opc_devices *devices) {
  if (!devices) return;
  table *t = (table *)devices;
  g_ptr_array_free(t->owned, TRUE);
  g_free(t);
}

static opc_devices *load(const opc_host *host, const char *path,
                         opc_error *error) {
  (void)host;
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_source *source = opc_source_new(path, NULL);
  table *t = g_new0(table, 1);
  t->owned = g_ptr_array_new_with_free_func(g_free);
  t->devices.size = sizeof t->devices;
  reader r = {t, problems};
  opc_node *root = opc_node_read(source, path, problems);
  if (root) read_table(&r, root);
  opc_node_free(root);
  opc_source_free(source);
  if (!problems->list->len) return &t->devices;
  opc_problems_error(problems, error);
  release(&t->devices);
  return NULL;
}

const opc_device_service opc_device_functions = {
    .size = sizeof(opc_device_service),
    .load = load,
    .release = release,
};
