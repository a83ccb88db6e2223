/* SPDX-License-Identifier: BSD-3-Clause */
/* Kinds of plugins: three are the kernel's, the others are found as plugins
   "kind.NAME". */
#ifndef OPCFLOW_CORE_KIND_H
#define OPCFLOW_CORE_KIND_H

#include "core/plugin/registry.h"

/* The kind of that name; NULL and *error if there is none. */
const opc_kind *opc_kind_of(opc_registry *registry, const char *name,
                            opc_error *error);

/* How plugins of that kind are tried out: the same, or of the kernel's own
   kinds what a plugin "kind.NAME" has. NULL if there is neither. */
const opc_kind *opc_kind_trials(opc_registry *registry, const char *name);

/* Whether a plugin has the functions that its kind wants. NULL if so, else the
   reason (g_free). */
char *opc_functions_fault(opc_registry *registry, const opc_plugin *plugin);

/* The names of all kinds there are, sorted (char *, freed with the array). */
GPtrArray *opc_kind_names(const opc_registry *registry);

#endif
