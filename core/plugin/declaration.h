/* SPDX-License-Identifier: BSD-3-Clause */
/* What a plugin's descriptor says, and whether it is sound. */
#ifndef OPCFLOW_CORE_DECLARATION_H
#define OPCFLOW_CORE_DECLARATION_H

#include <glib.h>
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

/* lower_case words with dots between them: "model.wide", "anchor.line" */
gboolean opc_is_id(const char *name);

/* Whether the host can work with a descriptor, but for its functions (kind.h);
   `id` is what its file name says. NULL if so, else the first reason (g_free).
   The interface's number is looked at before anything else. */
char *opc_plugin_fault(const opc_plugin *plugin, const char *id);

#endif
