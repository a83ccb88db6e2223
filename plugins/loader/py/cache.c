/* SPDX-License-Identifier: BSD-3-Clause */
/* Keeps the descriptions of plugins in the folder of kept results, so that a
   plugin is described without a process. A description is valid while all files
   that determine the plugin are unchanged. */
#include <glib/gstdio.h>
#include <string.h>

#include "py.h"

/* Files above this size (interpreters) are compared by size and time, bytes. */
enum { HASHED = 1 << 20 };

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
  GChecksum *sum = g_checksum_new(G_CHECKSUM_SHA256);
  g_autofree char *whole = g_canonicalize_filename(plugin->path, NULL);
  g_checksum_update(sum, (const guchar *)whole, -1);
  for (size_t i = 0; i < G_N_ELEMENTS(variables); i++) {
    const char *value = g_getenv(variables[i]);
    g_checksum_update(sum, (const guchar *)"\n", 1);
    if (value) g_checksum_update(sum, (const guchar *)value, -1);
  }
  char *path = g_strconcat(folder, "/", g_checksum_get_string(sum), NULL);
  g_checksum_free(sum);
  return path;
}

/* Return a text that changes with the files of a description (g_free); NULL if
   a file is missing. */
static char *files_sum(JsonObject *about) {
  JsonArray *files = json_object_get_array_member(about, "files");
  GChecksum *sum = g_checksum_new(G_CHECKSUM_SHA256);
  guint n = json_array_get_length(files), i = 0;
  for (; i < n; i++) {
    const char *path = json_array_get_string_element(files, i);
    GStatBuf s;
    g_autofree char *text = NULL;
    gsize size = 0;
    if (g_stat(path, &s)) break;
    if (s.st_size > HASHED)
      size = strlen(text = g_strdup_printf(
                        "%lld %lld.%09ld", (long long)s.st_size,
                        (long long)s.st_mtim.tv_sec, s.st_mtim.tv_nsec));
    else if (!g_file_get_contents(path, &text, &size, NULL))
      break;
    g_checksum_update(sum, (const guchar *)path, (gssize)strlen(path) + 1);
    g_checksum_update(sum, (const guchar *)text, (gssize)size);
  }
  char *result = i == n ? g_strdup(g_checksum_get_string(sum)) : NULL;
  g_checksum_free(sum);
  return result;
}

JsonNode *py_cache_get(const py_plugin *plugin) {
  g_autofree char *path = cache_path(plugin), *text = NULL;
  if (!path || !g_file_get_contents(path, &text, NULL, NULL)) return NULL;
  g_autoptr(JsonNode) about = json_from_string(text, NULL);
  if (!about || !JSON_NODE_HOLDS_OBJECT(about)) return NULL;
  JsonObject *o = json_node_get_object(about);
  g_autofree char *sum = files_sum(o);
  return sum && !strcmp(sum, json_object_get_string_member_with_default(
                                 o, "sum", ""))
             ? g_steal_pointer(&about)
             : NULL;
}

void py_cache_put(const py_plugin *plugin) {
  JsonObject *o = json_node_get_object(plugin->about);
  g_autofree char *path = cache_path(plugin), *sum = files_sum(o);
  if (!path || !sum) return;
  json_object_set_string_member(o, "sum", sum);
  g_autofree char *text = json_to_string(plugin->about, FALSE);
  /* A folder that is not writable keeps no descriptions. */
  (void)g_file_set_contents(path, text, -1, NULL);
}
