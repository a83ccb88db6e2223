/* SPDX-License-Identifier: BSD-3-Clause */
/* List of the files of a run, and comparison of a folder with such a list. */
#include <store/contents.h>

#include <base/file.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <store/files.h>

static const char manifest_name[] = "manifest.json";

/* Nesting limit that protects the recursive parser; a manifest has three
   levels. */
enum { MOST_DEPTH = 100 };

/* ---- listing ---- */

static int list_entry(void *data, const char *path, const char *name,
                      const struct stat *about, opc_error *error) {
  if (S_ISDIR(about->st_mode)) (void)rmdir(path); /* fails unless empty */
  if (!S_ISREG(about->st_mode) || !strcmp(name, manifest_name)) return OPC_OK;
  g_autofree char *sum = opc_file_sha256(path, NULL, error);
  if (!sum) return error->code;
  JsonObject *o = json_object_new();
  json_object_set_string_member(o, "path", name);
  json_object_set_int_member(o, "bytes", about->st_size);
  json_object_set_string_member(o, "sha256", sum);
  json_array_add_object_element(data, o);
  return OPC_OK;
}

JsonArray *opc_contents_json(const char *folder, opc_error *error) {
  JsonArray *list = json_array_new();
  if (!opc_traverse(folder, list_entry, list, error)) return list;
  json_array_unref(list);
  return NULL;
}

/* ---- reading a list ---- */

static JsonNode *node_member(JsonNode *node, const char *name, GType type) {
  if (!node || !JSON_NODE_HOLDS_OBJECT(node)) return NULL;
  JsonNode *found = json_object_get_member(json_node_get_object(node), name);
  return found && json_node_get_value_type(found) == type ? found : NULL;
}

static const char *text_member(JsonNode *node, const char *name) {
  JsonNode *found = node_member(node, name, G_TYPE_STRING);
  return found ? json_node_get_string(found) : NULL;
}

JsonNode *opc_contents_parse(const char *text) {
  int depth = 0;
  for (const char *c = text; *c; c++) {
    depth += (*c == '[' || *c == '{') - (*c == ']' || *c == '}');
    if (depth > MOST_DEPTH) return NULL;
  }
  return json_from_string(text, NULL);
}

/* Return a table of the paths in a manifest: files with their checksums,
   folders with NULL. NULL if the manifest is invalid. */
static GHashTable *read_list(JsonNode *manifest) {
  JsonNode *files = node_member(manifest, "files", JSON_TYPE_ARRAY);
  if (!text_member(manifest, "opcflow") || !files) return NULL;
  GHashTable *known =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
  JsonArray *list = json_node_get_array(files);
  for (guint i = 0; i < json_array_get_length(list); i++) {
    JsonNode *entry = json_array_get_element(list, i);
    const char *path = text_member(entry, "path");
    const char *sum = text_member(entry, "sha256");
    if (!path || !sum || !opc_name_is_inside(path)) {
      g_hash_table_destroy(known);
      return NULL;
    }
    for (const char *c = path; (c = strchr(c, '/')); c++)
      g_hash_table_insert(known, g_strndup(path, (gsize)(c - path)), NULL);
    g_hash_table_insert(known, g_strdup(path), g_strdup(sum));
  }
  return known;
}

/* ---- comparing ---- */

typedef struct comparison {
  const char *folder;
  GHashTable *known;
} comparison;

static int compare_entry(void *data, const char *path, const char *name,
                         const struct stat *about, opc_error *error) {
  const comparison *c = data;
  const char *sum = NULL;
  gboolean listed =
      g_hash_table_lookup_extended(c->known, name, NULL, (gpointer *)&sum);
  if (S_ISREG(about->st_mode) && !strcmp(name, manifest_name)) return OPC_OK;
  if (!listed || (sum ? !S_ISREG(about->st_mode) : !S_ISDIR(about->st_mode)))
    return opc_fail(error, OPC_IO, NULL,
                    "'%s' is not replaced, because the folder has the %s '%s', "
                    "which the run did not write",
                    c->folder,
                    S_ISDIR(about->st_mode)   ? "folder"
                    : S_ISLNK(about->st_mode) ? "symbolic link"
                                              : "file",
                    name);
  if (!sum) return OPC_OK;
  g_autofree char *now = opc_file_sha256(path, NULL, error);
  if (!now) return error->code;
  if (!strcmp(now, sum)) return OPC_OK;
  return opc_fail(
      error, OPC_IO, NULL,
      "'%s' is not replaced, because the file '%s' has changed since the run",
      c->folder, name);
}

static gboolean is_empty(const char *folder) {
  GDir *dir = g_dir_open(folder, 0, NULL);
  gboolean empty = dir && !g_dir_read_name(dir);
  if (dir) g_dir_close(dir);
  return empty;
}

int opc_contents_check(const char *folder, opc_error *error) {
  g_autofree char *path = g_build_filename(folder, manifest_name, NULL);
  g_autofree char *text = NULL;
  struct stat about;
  if (is_empty(folder)) return OPC_OK;
  if (lstat(path, &about) || !S_ISREG(about.st_mode) ||
      !g_file_get_contents(path, &text, NULL, NULL))
    return opc_fail(error, OPC_IO, NULL,
                    "'%s' is not replaced, because the folder has no readable "
                    "manifest.json of a run",
                    folder);
  g_autoptr(JsonNode) manifest = opc_contents_parse(text);
  g_autoptr(GHashTable) known = read_list(manifest);
  comparison c = {folder, known};
  if (known) return opc_traverse(folder, compare_entry, &c, error);
  return opc_fail(error, OPC_IO, NULL,
                  "'%s' is not replaced, because manifest.json does not list "
                  "the files of a run",
                  folder);
}
