/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks the output files named by parameters: no two steps write the same
   file, and none writes a file of the run itself. */
#include <string.h>

#include "core/binding/lookup.h"
#include "core/binding/outputs.h"

const char *const opc_reserved[OPC_RESERVED] = {"flow.yaml", "manifest.json",
                                                "metrics.json", "sweep.csv"};

/* Return whether the names are equal, or one is a folder with the other. */
static gboolean names_overlap(const char *a, const char *b) {
  size_t n = MIN(strlen(a), strlen(b));
  return !strncmp(a, b, n) && strchr("/", a[n]) && strchr("/", b[n]);
}

static const char *find_overlap(GHashTable *outputs, const char *name) {
  GHashTableIter all;
  gpointer taken;
  g_hash_table_iter_init(&all, outputs);
  while (g_hash_table_iter_next(&all, &taken, NULL))
    if (names_overlap(taken, name)) return taken;
  return NULL;
}

static const char *find_reserved(const char *name) {
  for (size_t i = 0; i < OPC_RESERVED; i++)
    if (names_overlap(opc_reserved[i], name)) return opc_reserved[i];
  return NULL;
}

static void add_output(GHashTable *outputs, const opc_binding *b, size_t i,
                       opc_problems *problems) {
  const char *name = b->values[i].field.text;
  const char *parameter = b->plugin->parameters[i].name;
  const opc_place *at = opc_binding_origin(b, i);
  const char *reserved = find_reserved(name);
  const char *taken = find_overlap(outputs, name);
  g_autofree char *label = opc_binding_label(b);
  if (reserved && problems)
    opc_problem_add(problems, OPC_INVALID, at,
                    "%s: '%s' is '%s', but the run writes '%s'", label,
                    parameter, name, reserved);
  else if (taken && problems)
    opc_problem_add(problems, OPC_INVALID, at,
                    "%s: '%s' is '%s', but '%s' already writes '%s'", label,
                    parameter, name,
                    (const char *)g_hash_table_lookup(outputs, taken), taken);
  if (!taken) g_hash_table_insert(outputs, g_strdup(name), g_strdup(b->path));
}

GHashTable *opc_flow_outputs(const opc_flow *flow, opc_problems *problems) {
  g_autoptr(GPtrArray) all = opc_flow_bindings(flow);
  GHashTable *outputs =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
  for (guint k = 0; k < all->len; k++) {
    const opc_binding *b = all->pdata[k];
    for (size_t i = 0; i < b->plugin->n_parameters; i++)
      if (b->plugin->parameters[i].type == OPC_OUTPUT &&
          b->values[i].field.text)
        add_output(outputs, b, i, problems);
  }
  return outputs;
}
