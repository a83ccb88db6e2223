/* SPDX-License-Identifier: BSD-3-Clause */
/* What plugins may ask for a key of what they keep themselves. */
#include "core/run/identity.h"

#include <string.h>

#include "core/plugin/declaration.h"
#include "core/run/key.h"
#include "core/run/run.h"

/* What a step itself takes is its own to put into a key. What the plugins in
   its slots take it does not see. */
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
               "what is kept beyond a run cannot depend on '%s'",
               in->values[i].reference);
      return FALSE;
    }
  }
  return TRUE;
}

static const char *identity(const opc_host *host, opc_store *store,
                            const char *slot, opc_error *error) {
  const opc_binding *b = host->data;
  int i = slot ? opc_parameter_find(b->plugin, slot) : 0;
  if (i < 0 || (slot && b->plugin->parameters[i].type != OPC_SLOT)) {
    opc_fail(error, OPC_INVALID, NULL, "%s has no slot '%s'", b->plugin->id,
             slot);
    return NULL;
  }
  const opc_binding *of = slot ? b->slots[i] : b;
  if (of && !takes_nothing(b, of, error)) return NULL;
  char *text = of ? opc_binding_key(of, store, error) : g_strdup("");
  if (text) g_ptr_array_add(b->owned, text);
  return text;
}

const char *opc_identity(const opc_host *host, const char *slot,
                         opc_error *error) {
  const opc_run *run = ((const opc_binding *)host->data)->run;
  return identity(host, run->options->store, slot, error);
}

const char *opc_identity_alone(const opc_host *host, const char *slot,
                               opc_error *error) {
  return identity(host, NULL, slot, error);
}
