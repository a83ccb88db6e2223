/* SPDX-License-Identifier: BSD-3-Clause */
/* Queries, copies and checks of plugin descriptors. */
#pragma once

#include <glib.h>
#include <opcflow/choices.h>
#include <opcflow/opcflow.h>

/* Kinds built into the host; kind.h finds all kinds. */
#define OPC_KIND_STEP "step"
#define OPC_KIND_COMMAND "command"
#define OPC_KIND_KIND "kind"
#define OPC_KIND_LOADER "loader"

/* Return the number of outputs of a plugin, 0 if it is no step; output i. */
size_t opc_port_count(const opc_plugin *plugin);
const opc_port *opc_port_at(const opc_plugin *plugin, size_t i);

/* Return the index of a parameter by name, or -1; a metric by name, or NULL. */
int opc_parameter_find(const opc_plugin *plugin, const char *name);
const opc_metric *opc_metric_find(const opc_plugin *plugin, const char *name);
/* Return the metric `name` that the plugin declares. NULL and *error if the
   plugin declares no such metric or `value` is not finite. */
const opc_metric *opc_metric_check(const opc_plugin *plugin, const char *name,
                                   double value, opc_error *error);

/* opc_timeout_add: append the parameter `timeout` (time limit, s) to the
   parameters of a step, unless the plugin itself has a parameter of this name;
   return `plugin`. The field follows the plugin's part of the instance.
   opc_timeout_find: return the index of the appended parameter; -1 if there is
   none. */
const opc_plugin *opc_timeout_add(opc_plugin *plugin);
int opc_timeout_find(const opc_plugin *plugin);

/* Return the plugin's OPC_CHOICES extension; NULL if missing. */
const opc_choices *opc_choices_of(const opc_plugin *plugin);

/* Copy n structs of a plugin, `theirs` bytes each, into structs of the host,
   `ours` bytes each, truncated or padded with zeros; a struct of zeros follows.
   Returns NULL if the array is missing or `theirs` is less than `oldest`.
   Copies are never freed. [main]: see opcflow/plugin.h. */
gconstpointer opc_declared_copy(gconstpointer from, size_t n, size_t theirs,
                                size_t oldest, size_t ours);

/* Copy an array; `last` is the last field of `type` in interface 0.8. */
#define OPC_DECLARED_COPY(type, last, from, n, theirs)                   \
  ((const type *)opc_declared_copy(                                      \
      from, n, theirs, offsetof(type, last) + sizeof(((type *)0)->last), \
      sizeof(type)))

/* Copy a descriptor with its parameters and metrics, after a check of the
   interface version. Returns NULL and the reason in *fault (g_free). */
opc_plugin *opc_plugin_copy(const opc_plugin *theirs, char **fault);

/* Return the reason why a descriptor is not valid (g_free), NULL if valid. `id`
   is the id expected from the file name. Functions are checked by
   opc_functions_adopt. */
char *opc_plugin_fault(const opc_plugin *plugin, const char *id);
