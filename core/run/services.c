/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements services of the host: the dispatch by name, and results that
   plugins store. */
#include "core/run/services.h"

#include <guard/guard.h>
#include <opcflow/results.h>
#include <stdlib.h>
#include <string.h>

#include "core/plugin/declaration.h"
#include "core/run/inner_run.h"
#include "core/run/key.h"
#include "core/run/pieces.h"
#include "core/run/run.h"

/* Return the store of a host; NULL if nothing is stored. */
static opc_store *results_store(const opc_host *host) {
  const opc_binding *b = host->data;
  return host->service == opc_run_service
             ? ((const opc_run *)b->run)->options->store
             : b->store;
}

/* Return FALSE and *error if a plugin instance below `of`, except `b`, refers
   to an output of another step. A step can include the identities of its own
   inputs in the key of a result, but does not know the inputs of the plugins in
   its slots. */
static gboolean takes_nothing(const opc_binding *b, const opc_binding *of,
                              opc_error *error) {
  g_autoptr(GPtrArray) all = g_ptr_array_new();
  opc_binding_list(of, all);
  for (guint k = 0; k < all->len; k++) {
    const opc_binding *in = all->pdata[k];
    for (size_t i = 0; i < in->plugin->n_parameters && in != b; i++) {
      if (!in->values[i].reference) continue;
      const char *name = in->plugin->parameters[i].name;
      g_autofree char *path =
          g_strdup_printf("%s.%s", in->path + strlen(b->path) + 1, name);
      opc_fail(error, OPC_INVALID, path,
               "results kept beyond a run cannot depend on '%s'",
               in->values[i].reference);
      return FALSE;
    }
  }
  return TRUE;
}

static const char *results_identity(const opc_host *host, const char *slot,
                                    opc_error *error) {
  const opc_binding *b = host->data;
  int i = slot ? opc_parameter_find(b->plugin, slot) : 0;
  if (i < 0 || (slot && b->plugin->parameters[i].type != OPC_SLOT)) {
    opc_fail(error, OPC_INVALID, NULL, "%s has no slot '%s'", b->plugin->id,
             slot);
    return NULL;
  }
  const opc_binding *of = slot ? b->slots[i] : b;
  if (of && !takes_nothing(b, of, error)) return NULL;
  char *text =
      of ? opc_binding_key(of, results_store(host), error) : g_strdup("");
  if (text) g_ptr_array_add(b->owned, text);
  return text;
}

/* Return the name under which the result `key` is stored (g_free); NULL if the
   build of the plugin is unknown. */
static char *results_name(const opc_host *host, const char *key) {
  const opc_plugin *plugin = ((const opc_binding *)host->data)->plugin;
  const char *build = opc_store_build(results_store(host), plugin->id);
  if (!build) return NULL;
  g_autofree char *all = g_strdup_printf("%s\n%s\n%s", plugin->id, build, key);
  g_autofree char *sum =
      g_compute_checksum_for_string(G_CHECKSUM_SHA256, all, -1);
  return g_strconcat(sum, ".kept", NULL);
}

static void *results_find(const opc_host *host, const char *key, size_t *size) {
  opc_store *store = results_store(host);
  const char *before = guard_enter(NULL);
  g_autofree char *name = store ? results_name(host, key) : NULL;
  g_autoptr(GVariant) kept =
      name ? opc_store_get(store, name, G_VARIANT_TYPE_BYTESTRING) : NULL;
  void *copy = NULL;
  if (kept) {
    *size = g_variant_get_size(kept);
    copy = malloc(*size + 1);
    if (copy) memcpy(copy, g_variant_get_data(kept), *size);
  }
  guard_leave(before);
  return copy;
}

static void results_keep(const opc_host *host, const char *key,
                         const void *bytes, size_t size) {
  opc_store *store = results_store(host);
  GVariant *copy = g_variant_ref_sink(
      g_variant_new_fixed_array(G_VARIANT_TYPE_BYTE, bytes, size, 1));
  const char *before = guard_enter(NULL);
  g_autofree char *name = store ? results_name(host, key) : NULL;
  if (name) (void)opc_store_put(store, name, copy);
  guard_leave(before);
  g_variant_unref(copy);
}

static const opc_results results = {.size = sizeof results,
                                    .identity = results_identity,
                                    .find = results_find,
                                    .keep = results_keep};

const void *opc_results_service(const opc_host *host, const char *name) {
  return !strcmp(name, OPC_RESULTS) && host->data
             ? &results
             : opc_binding_service(host, name);
}

const void *opc_run_service(const opc_host *host, const char *name) {
  const opc_binding *b = host->data;
  if (!strcmp(name, OPC_PIECES)) return &opc_pieces_of_run;
  if (!strcmp(name, OPC_INNER)) return b->inner ? &opc_inner_functions : NULL;
  return opc_results_service(host, name);
}
