/* SPDX-License-Identifier: BSD-3-Clause */
/* Kinds of plugins: three are the kernel's, the others are found as plugins
   "kind.NAME". */
#pragma once

#include "core/plugin/registry.h"

/* The kind of that name; NULL and *error if there is none. */
const opc_kind *opc_kind_of(opc_registry *registry, const char *name,
                            opc_error *error);

/* How plugins of that kind are tried out: the same, or of the kernel's own
   kinds what a plugin "kind.NAME" has. NULL if there is neither. */
const opc_kind *opc_kind_trials(opc_registry *registry, const char *name);

/* Give the copy of a descriptor (opc_plugin_copy) a copy of its functions, as
   long as its kind has them: functions that it lacks are NULL. Return why the
   kind cannot work with them (g_free), NULL if it can. */
char *opc_functions_adopt(opc_registry *registry, opc_plugin *plugin);

/* The names of all kinds there are, sorted (char *, freed with the array). */
GPtrArray *opc_kind_names(const opc_registry *registry);
