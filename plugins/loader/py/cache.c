/* SPDX-License-Identifier: BSD-3-Clause */
/* Keeps the descriptions of plugins in the folder of kept results, so that a
   plugin is described without a process. A description is valid while all files
   that determine the plugin are unchanged. */
#include <glib/gstdio.h>
#include <string.h>

#include "py.h"

/* Variables that select the interpreter and its modules. */
static const char *const variables[] = {"PATH",          "PYTHONPATH",
                                        "PYTHONHOME",    "VIRTUAL_ENV",
                                        "PYENV_VERSION", "OPCFLOW_PYTHON"};

char *py_cache_folder(void) {
  const char *own = g_getenv("OPCFLOW_STORE");
  g_autofree char *store =
      own ? g_strdup(own)
          : g_build_filename(g_get_user_cache_dir(), "opcflow", NULL);
  g_autofree char *mark = g_build_filename(store, "opcflow-store", NULL);
  g_autofree char *folder = g_build_filename(store, "python", NULL);
  return *store && g_file_test(mark, G_FILE_TEST_EXISTS) &&
                 !g_mkdir_with_parents(folder, 0700)
             ? g_steal_pointer(&folder)
             : NULL;
}

/* Return the path of the description of a plugin (g_free); NULL: none is
   kept. */
static char *cache_path(const py_plugin *plugin) {
  g_autofree char *folder = py_cache_folder();
  if (!folder) return NULL;
  g_autofree char *whole = g_canonicalize_filename(plugin->path, NULL);
  g_autoptr(GString) key = g_string_new(whole);
  for (size_t i = 0; i < G_N_ELEMENTS(variables); i++) {
    const char *value = g_getenv(variables[i]);
    g_string_append_printf(key, "\n%s", value ? value : "");
  }
  g_autofree char *name =
      g_compute_checksum_for_string(G_CHECKSUM_SHA256, key->str, -1);
  return g_build_filename(folder, name, NULL);
}

/* Return size, time of change and inode of all files of a description (g_free);
   NULL if a file is missing. */
static char *files_state(JsonObject *about) {
  JsonArray *files = py_list(about, "files");
  GString *all = g_string_new(NULL);
  for (guint i = 0; i < json_array_get_length(files); i++) {
    GStatBuf s;
    if (g_stat(json_array_get_string_element(files, i), &s))
      return g_string_free(all, TRUE);
    g_string_append_printf(all, "%lld %lld.%09ld %llu\n", (long long)s.st_size,
                           (long long)s.st_ctim.tv_sec, s.st_ctim.tv_nsec,
                           (unsigned long long)s.st_ino);
  }
  return g_string_free(all, FALSE);
}

JsonNode *py_cache_get(const py_plugin *plugin) {
  g_autofree char *path = cache_path(plugin), *text = NULL;
  if (!path || !g_file_get_contents(path, &text, NULL, NULL)) return NULL;
  g_autoptr(JsonNode) about = json_from_string(text, NULL);
  if (!about || !JSON_NODE_HOLDS_OBJECT(about)) return NULL;
  JsonObject *o = json_node_get_object(about);
  g_autofree char *state = files_state(o);
  return state && !g_strcmp0(state, py_text(o, "state"))
             ? g_steal_pointer(&about)
             : NULL;
}

void py_cache_put(const py_plugin *plugin) {
  JsonObject *o = json_node_get_object(plugin->about);
  g_autofree char *path = cache_path(plugin), *state = files_state(o);
  if (!path || !state) return;
  json_object_set_string_member(o, "state", state);
  g_autofree char *text = json_to_string(plugin->about, FALSE);
  /* A folder that is not writable keeps no descriptions. */
  (void)g_file_set_contents(path, text, -1, NULL);
}
