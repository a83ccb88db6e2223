/* SPDX-License-Identifier: BSD-3-Clause */
/* What plugins may ask for a key of what they keep themselves. */
#include "core/flow/identity.h"

#include "core/flow/key.h"
#include "core/flow/run.h"
#include "core/plugin/declaration.h"

const char *opc_identity(const opc_host *host, const char *slot,
                         opc_error *error) {
  const opc_binding *b = host->data;
  const opc_run *run = b->run;
  int i = slot ? opc_parameter_find(b->plugin, slot) : 0;
  if (i < 0 || (slot && b->plugin->parameters[i].type != OPC_SLOT)) {
    opc_fail(error, OPC_INVALID, NULL, "%s has no slot '%s'", b->plugin->id,
             slot);
    return NULL;
  }
  const opc_binding *of = slot ? b->slots[i] : b;
  char *text = of ? opc_binding_key(of, run ? run->options->store : NULL, error)
                  : g_strdup("");
  if (text) g_ptr_array_add(b->owned, text);
  return text;
}
