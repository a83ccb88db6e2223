/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the files that a flow reads and computes their checksums. */
#include "core/run/inputs.h"

#include "core/binding/inner.h"
#include "core/binding/lookup.h"

/* Return the context of the first step; all contexts report the same stop
   request. */
static const opc_context *run_context(const opc_run *run) {
  const opc_flow_step *first = run->flow->order->pdata[0];
  return first->binding->host ? first->binding->host->context : NULL;
}

static void add_input(opc_run *run, const char *file, const opc_place *at,
                      opc_problems *problems) {
  g_autofree char *path = g_canonicalize_filename(file, NULL);
  if (g_hash_table_contains(run->sums.summed, path)) return;
  opc_error error;
  char *sum = run->sums.known
                  ? g_strdup(g_hash_table_lookup(run->sums.known, path))
                  : NULL;
  if (!sum)
    sum = opc_store_sum(run->options->store, path, run_context(run), &error);
  g_hash_table_insert(run->sums.summed, g_strdup(path), sum);
  if (!sum) {
    opc_problem_add(problems, error.code, at, "%s", error.message);
    return;
  }
  g_ptr_array_add(run->out.inputs, g_steal_pointer(&path));
  g_ptr_array_add(run->out.inputs, sum);
}

gboolean opc_inputs_sum(opc_run *run, const opc_flow *flow,
                        opc_problems *problems) {
  guint before = problems->list->len;
  const GPtrArray *files = flow->recipe->sources;
  g_autoptr(GPtrArray) all = opc_flow_bindings(flow);
  for (guint i = 0; i < files->len; i++)
    add_input(run, ((const opc_source *)files->pdata[i])->name, NULL, problems);
  for (guint k = 0; k < all->len; k++) {
    const opc_binding *b = all->pdata[k];
    for (size_t i = 0; i < b->plugin->n_parameters; i++)
      if (b->plugin->parameters[i].type == OPC_FILE && b->values[i].field.text)
        add_input(run, b->values[i].field.text, opc_binding_origin(b, i),
                  problems);
    if (b->inner) opc_inputs_sum(run, opc_inner_flow(b->inner), problems);
  }
  return problems->list->len == before;
}

void opc_inputs_take(opc_run *run, const opc_run *from,
                     opc_problems *problems) {
  run->sums.known = from->sums.summed;
  opc_inputs_sum(run, run->flow, problems);
}
