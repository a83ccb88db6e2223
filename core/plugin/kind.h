/* SPDX-License-Identifier: BSD-3-Clause */
/* Kinds of plugins: step, command, kind and loader are built in; plugins
   "kind.NAME" declare all other kinds (opcflow/kind.h). */
#pragma once

#include "core/plugin/registry.h"

/* Return a kind by name; NULL and *error if unknown. */
const opc_kind *opc_kind_of(opc_registry *registry, const char *name,
                            opc_error *error);

/* Return the declaration of a kind that contains the tests of its plugins. For
   the built-in kinds, this is the plugin "kind.NAME" if present, else the
   built-in declaration. NULL if the kind is unknown. */
const opc_kind *opc_kind_trials(opc_registry *registry, const char *name);

/* Replace the functions in the copy of a descriptor (opc_plugin_copy) by a copy
   of at least the size of the kind's struct; missing functions are NULL.
   Returns NULL, or the reason why the functions do not fit the kind
   (g_free). */
char *opc_functions_adopt(opc_registry *registry, opc_plugin *plugin);

/* Return the names of all kinds, sorted (char *, freed with the array). */
GPtrArray *opc_kind_names(const opc_registry *registry);
