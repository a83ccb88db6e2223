/* SPDX-License-Identifier: BSD-3-Clause */
/* Where plugins are found and how they are loaded. The plugin ID is the file
   ID.so in one of the folders; the first one wins. */
#pragma once

#include <glib.h>
#include <opcflow/opcflow.h>

/* A plugin that is in a folder, good or not. */
typedef struct opc_candidate {
  char *id; /* what its file is called */
  char *path;
  char *reason;          /* why it cannot be used; NULL if it can */
  const char *hidden_by; /* path of the earlier one of that id, or NULL */
  char *kind, *version, *licence, *summary; /* of those that can be used */
} opc_candidate;

typedef struct opc_registry opc_registry;

/* `folders`: those of --plugin-path, NULL-terminated, or NULL. Then follow
   OPCFLOW_PLUGIN_PATH, `plugins` beside the executable, and, unless
   OPCFLOW_NO_SYSTEM_PLUGINS is set, the user's data folder and the installed
   one. No folder is read yet. */
opc_registry *opc_registry_new(const char *const *folders);

/* Loaded plugins stay: their threads and tables may still be in use. */
void opc_registry_free(opc_registry *registry);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_registry, opc_registry_free)

/* The folders in the order of search, const char *. */
const GPtrArray *opc_registry_folders(const opc_registry *registry);

/* The path of a file that belongs to the command: beside the executable or,
   installed, in opcflow/ of `in`, which is OPC_LIBDIR or OPC_LIBEXECDIR
   (g_free); NULL if it is in neither. */
char *opc_find_installed(const char *in, const char *name);

/* The plugin, loaded at its first use; NULL and *error (OPC_NO_PLUGIN) with
   the reason. */
const opc_plugin *opc_registry_find(opc_registry *registry, const char *id,
                                    opc_error *error);

/* Where it was loaded from. */
const char *opc_registry_path(const opc_registry *registry,
                              const opc_plugin *plugin);

/* Look at all there is whose id begins with `prefix`: opc_candidate *, by id,
   then in the order of search. Each is loaded in a process of its own, so that
   one that crashes or hangs (`seconds` are granted) is only reported. */
GPtrArray *opc_registry_scan(opc_registry *registry, const char *prefix,
                             double seconds);

/* Return those of them that can be used. */
GPtrArray *opc_registry_usable(opc_registry *registry, const char *prefix,
                               double seconds);

/* The ids that begin with `prefix` of all files there are, sorted, each once;
   none is loaded (char *, freed with the array). */
GPtrArray *opc_registry_ids(const opc_registry *registry, const char *prefix);

/* Load a shared object and check it; NULL and *reason (g_free). */
const opc_plugin *opc_plugin_load(opc_registry *registry, const char *path,
                                  const char *id, char **reason);

/* opc_plugin_load in a child process, into the candidate's last fields. */
void opc_candidate_try(opc_registry *registry, opc_candidate *candidate,
                       double seconds);
