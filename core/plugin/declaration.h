/* SPDX-License-Identifier: BSD-3-Clause */
/* Reading a plugin's descriptor: its arrays, whose elements a later minor may
   have made larger, the names of kinds, and whether it is sound. */
#ifndef OPCFLOW_CORE_DECLARATION_H
#define OPCFLOW_CORE_DECLARATION_H

#include <glib.h>
#include <opcflow/opcflow.h>

const opc_parameter *opc_parameter_at(const opc_plugin *plugin, size_t i);
const opc_metric *opc_metric_at(const opc_plugin *plugin, size_t i);
/* The ports of a plugin of the kind step; none for the others. */
size_t opc_port_count(const opc_plugin *plugin);
const opc_port *opc_port_at(const opc_plugin *plugin, size_t i);

/* The number of the parameter of that name, -1 if there is none. */
int opc_parameter_find(const opc_plugin *plugin, const char *name);
const opc_metric *opc_metric_find(const opc_plugin *plugin, const char *name);

/* What an earlier version called its parameters (plugin.h). */
size_t opc_rename_count(const opc_plugin *plugin);
const opc_rename *opc_rename_at(const opc_plugin *plugin, size_t i);
/* The rename of that old name, NULL if there is none. */
const opc_rename *opc_rename_find(const opc_plugin *plugin, const char *from);

/* "litho" ... ; NULL for a number that is no kind; 0 for a name that is none */
const char *opc_kind_name(uint32_t kind);
uint32_t opc_kind_find(const char *name);

/* "real" ... ; NULL for a number that is no type */
const char *opc_type_name(uint32_t type);

/* The words of "a|b|c", in order (g_strfreev). */
char **opc_choice_list(const char *choices);

/* lower_case words with dots between them: "mask.dpb", "anchor.line" */
gboolean opc_is_id(const char *name);

/* Whether the host can work with a descriptor; `id` is what its file name
   says. NULL if so, else the first reason (g_free). Size and major are looked
   at before anything else. */
char *opc_plugin_fault(const opc_plugin *plugin, const char *id);

#endif
