/* SPDX-License-Identifier: BSD-3-Clause */
/* What a plugin's descriptor says, and whether it is sound. */
#pragma once

#include <glib.h>
#include <opcflow/choices.h>
#include <opcflow/opcflow.h>

/* The kinds that the kernel itself knows; kind.h finds the others. */
#define OPC_KIND_STEP "step"
#define OPC_KIND_COMMAND "command"
#define OPC_KIND_KIND "kind"

/* The ports of a plugin of the kind step; none for the others. */
size_t opc_port_count(const opc_plugin *plugin);
const opc_port *opc_port_at(const opc_plugin *plugin, size_t i);

/* The number of the parameter of that name, -1 if there is none. */
int opc_parameter_find(const opc_plugin *plugin, const char *name);
const opc_metric *opc_metric_find(const opc_plugin *plugin, const char *name);
/* The metric that a plugin gives a value of; NULL and *error if it declares
   none of that name or the value is no number. */
const opc_metric *opc_metric_check(const opc_plugin *plugin, const char *name,
                                   double value, opc_error *error);

/* The extension of that name; NULL if the plugin has none. */
const opc_choices *opc_choices_of(const opc_plugin *plugin);

/* Copy n structs of `theirs` bytes, as a plugin declares them, into structs of
   `ours` bytes, cut or followed by zeros, so that the kernel can read its own
   structs. NULL if it is no array of structs that have `oldest` bytes at least.
   Copies live as long as the process. [main] */
gconstpointer opc_declared_copy(gconstpointer from, size_t n, size_t theirs,
                                size_t oldest, size_t ours);

/* The same for an array of a type, whose last field in interface 0.8 is `last`.
 */
#define OPC_DECLARED_COPY(type, last, from, n, theirs)                   \
  ((const type *)opc_declared_copy(                                      \
      from, n, theirs, offsetof(type, last) + sizeof(((type *)0)->last), \
      sizeof(type)))

/* Copy a descriptor with its parameters and metrics, after a look at the
   interface that it was built for. NULL and the reason (g_free). */
opc_plugin *opc_plugin_copy(const opc_plugin *theirs, char **fault);

/* Return why the host cannot work with a descriptor (g_free), NULL if it can.
   `id` is what its file name says. kind.h looks at the functions. */
char *opc_plugin_fault(const opc_plugin *plugin, const char *id);
