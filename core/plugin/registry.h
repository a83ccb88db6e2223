/* SPDX-License-Identifier: BSD-3-Clause */
/* Search and loading of plugins. The plugin with the id ID is the file ID.so,
   or ID.EXT if a plugin loader.EXT exists. The first folder of the search order
   with such a file is used. A file ID.EXT without a dot in ID is not a
   plugin. */
#pragma once

#include <glib.h>
#include <opcflow/loader.h>
#include <opcflow/opcflow.h>

/* A plugin file in a folder, usable or not. */
typedef struct opc_candidate {
  char *id; /* id from the file name */
  char *path;
  char *reason;          /* reason why not usable; NULL if usable */
  const char *hidden_by; /* path of a file of the same id in an earlier folder,
                            or NULL */
  char *kind, *version, *licence,
      *summary; /* texts of the descriptor; NULL if not usable */
} opc_candidate;

/* The plugin folders, and the plugins loaded so far. */
typedef struct opc_registry opc_registry;

/* Return a registry (opc_registry_free). The search order is: `folders` (of
   --plugin-path, NULL-terminated, or NULL), OPCFLOW_PLUGIN_PATH, `plugins`
   beside the executable, the user's data folder, the installed folder. The last
   two are skipped if OPCFLOW_NO_SYSTEM_PLUGINS is set. Reads the names in the
   folders, to find loaders, but loads no plugin. */
opc_registry *opc_registry_new(const char *const *folders);

/* Free the registry. Loaded plugins stay loaded: their threads and tables may
   still be in use. */
void opc_registry_free(opc_registry *registry);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_registry, opc_registry_free)

/* Return the folders in search order (const char *). */
const GPtrArray *opc_registry_folders(const opc_registry *registry);

/* Return the path of a file of the command (g_free): beside the executable or,
   if installed, in opcflow/ of the folder `in` (OPC_LIBDIR, OPC_LIBEXECDIR).
   NULL if missing. */
char *opc_find_installed(const char *in, const char *name);

/* Return a plugin by id, loaded at the first call. NULL and *error
   (OPC_NO_PLUGIN) with the reason on failure. */
const opc_plugin *opc_registry_find(opc_registry *registry, const char *id,
                                    opc_error *error);

/* Return the id of the plugin in a file: the file name without the ending of
   plugin files (g_free). */
char *opc_registry_id(const opc_registry *registry, const char *path);

/* Return the loader of a plugin; NULL for a plugin in a shared object. */
const opc_plugin *opc_plugin_loader(const opc_plugin *plugin);

/* Return the path of the file that a plugin was loaded from. */
const char *opc_registry_path(const opc_registry *registry,
                              const opc_plugin *plugin);

/* Return all plugin files whose id begins with `prefix` (opc_candidate *), by
   id, then in search order. Each is loaded in a child process, so that a crash
   or a time above `seconds` is only reported. */
GPtrArray *opc_registry_scan(opc_registry *registry, const char *prefix,
                             double seconds);

/* Return the usable candidates of opc_registry_scan. */
GPtrArray *opc_registry_usable(opc_registry *registry, const char *prefix,
                               double seconds);

/* Return the distinct ids of all plugin files that begin with `prefix`, sorted
   (char *, freed with the array). No plugin is loaded. */
GPtrArray *opc_registry_ids(const opc_registry *registry, const char *prefix);

/* Load a plugin file and check the descriptor. Returns NULL and *reason
   (g_free) on failure. */
const opc_plugin *opc_plugin_load(opc_registry *registry, const char *path,
                                  const char *id, char **reason);

/* Call opc_plugin_load in a child process and complete the candidate. */
void opc_candidate_try(opc_registry *registry, opc_candidate *candidate,
                       double seconds);
