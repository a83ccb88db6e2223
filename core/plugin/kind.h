/* SPDX-License-Identifier: BSD-3-Clause */
/* Kinds of plugins: three are built into the kernel, the others are plugins
   "kind.NAME". */
#pragma once

#include "core/plugin/registry.h"

/* Return the kind of that name; NULL and *error if there is none. */
const opc_kind *opc_kind_of(opc_registry *registry, const char *name,
                            opc_error *error);

/* Return the declaration used to test plugins of that kind: that of the plugin
   "kind.NAME", else of the kernel's kind of that name. NULL if there is
   neither. */
const opc_kind *opc_kind_trials(opc_registry *registry, const char *name);

/* Replace the functions in the copy of a descriptor (opc_plugin_copy) by a copy
   of at least the size of the kind's struct; missing functions are NULL.
   Returns why the functions do not fit the kind (g_free), NULL if they do. */
char *opc_functions_adopt(opc_registry *registry, opc_plugin *plugin);

/* Return the names of all kinds, sorted (char *, freed with the array). */
GPtrArray *opc_kind_names(const opc_registry *registry);
