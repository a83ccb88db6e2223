/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds plugins in folders and loads each at the first use. */
#include "core/plugin/registry.h"

#include <base/file.h>
#include <base/suggest.h>
#include <dlfcn.h>
#include <guard/guard.h>
#include <string.h>
#include <sys/stat.h>

#include "core/plugin/declaration.h"
#include "core/plugin/kind.h"

/* Result of the first request for an id. */
typedef struct loaded {
  const opc_plugin *plugin;
  char *path, *reason;
} loaded;

struct opc_registry {
  GPtrArray *folders; /* char * */
  GPtrArray *endings; /* char *: of plugin files, ".so" first */
  GHashTable *seen;   /* id -> loaded */
};

/* ---- folders ---- */

static gboolean same_folder(const char *a, const char *b) {
  struct stat s, t;
  if (!strcmp(a, b)) return TRUE;
  return !stat(a, &s) && !stat(b, &t) && s.st_dev == t.st_dev &&
         s.st_ino == t.st_ino;
}

/* Add a folder unless already known; takes ownership of the name. */
static void add_folder(opc_registry *registry, char *folder) {
  gboolean known = !*folder;
  for (guint i = 0; !known && i < registry->folders->len; i++)
    known = same_folder(registry->folders->pdata[i], folder);
  if (known)
    g_free(folder);
  else
    g_ptr_array_add(registry->folders, folder);
}

static const char *const places[] = {"/" OPC_BINDIR,
                                     "/" OPC_LIBEXECDIR "/opcflow", NULL};

char *opc_find_installed(const char *in, const char *name) {
  g_autofree char *folder = opc_executable_folder();
  char *path = folder ? g_build_filename(folder, name, NULL) : NULL;
  for (int i = 0; path; i++) {
    if (g_file_test(path, G_FILE_TEST_EXISTS)) return path;
    g_free(path);
    path = i ? NULL : opc_installed(places, in, name);
  }
  return NULL;
}

static void add_standard_folders(opc_registry *registry) {
  gboolean system = !g_getenv("OPCFLOW_NO_SYSTEM_PLUGINS");
  g_autofree char *folder = opc_executable_folder();
  if (folder) add_folder(registry, g_build_filename(folder, "plugins", NULL));
  if (!system) return;
  /* Ignore a relative folder, as the XDG specification requires; plugins in the
     working folder would otherwise be loaded without a request. */
  const char *data = g_get_user_data_dir();
  if (g_path_is_absolute(data))
    add_folder(registry, g_build_filename(data, "opcflow", "plugins", NULL));
  char *own = opc_installed(places, OPC_LIBDIR, "plugins");
  if (own) add_folder(registry, own);
}

/* Add the ending ".EXT" for each file loader.EXT.so of a folder. */
static void add_endings(opc_registry *registry, const char *folder) {
  g_autoptr(GPtrArray) names = opc_folder_names(folder);
  for (guint i = 0; names && i < names->len; i++) {
    const char *name = names->pdata[i];
    if (g_str_has_prefix(name, OPC_KIND_LOADER ".") &&
        g_str_has_suffix(name, ".so"))
      g_ptr_array_add(registry->endings,
                      g_strndup(name + strlen(OPC_KIND_LOADER),
                                strlen(name) - strlen(OPC_KIND_LOADER ".so")));
  }
}

static void loaded_free(gpointer item) {
  loaded *l = item;
  g_free(l->path);
  g_free(l->reason);
  g_free(l);
}

opc_registry *opc_registry_new(const char *const *folders) {
  opc_registry *registry = g_new0(opc_registry, 1);
  registry->folders = g_ptr_array_new_with_free_func(g_free);
  registry->endings = g_ptr_array_new_with_free_func(g_free);
  g_ptr_array_add(registry->endings, g_strdup(".so"));
  registry->seen =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, loaded_free);
  for (; folders && *folders; folders++)
    add_folder(registry, g_strdup(*folders));
  const char *list = g_getenv("OPCFLOW_PLUGIN_PATH");
  g_auto(GStrv) parts = g_strsplit(list ? list : "", ":", -1);
  for (guint i = 0; parts[i]; i++) add_folder(registry, g_strdup(parts[i]));
  add_standard_folders(registry);
  for (guint i = 0; i < registry->folders->len; i++)
    add_endings(registry, registry->folders->pdata[i]);
  return registry;
}

void opc_registry_free(opc_registry *registry) {
  if (!registry) return;
  g_ptr_array_free(registry->folders, TRUE);
  g_ptr_array_free(registry->endings, TRUE);
  g_hash_table_destroy(registry->seen);
  g_free(registry);
}

const GPtrArray *opc_registry_folders(const opc_registry *registry) {
  return registry->folders;
}

/* ---- loading ---- */

/* Set the text that a crash report prints during loading. Returns the value for
   end_loading. */
static const char *start_loading(const char *path, const char *id) {
  g_autofree char *where =
      g_strdup_printf("error: '%s': cannot use '%s'", id, path);
  guard_where(where, GUARD_CRASH_LOADING);
  return guard_enter(id);
}

static void end_loading(const char *before) {
  guard_leave(before);
  guard_where(NULL, 0);
}

/* Append both interface versions to the reason if the plugin was built for a
   later interface. */
static void explain_version(const opc_plugin *plugin, char **reason) {
  if (!plugin || plugin->abi_minor <= OPC_ABI_MINOR) return;
  g_autofree char *first = *reason;
  *reason = g_strdup_printf(
      "%s (built for plugin interface %u.%u, this is "
      "%u.%u)",
      first, plugin->abi_major, plugin->abi_minor, OPC_ABI_MAJOR,
      OPC_ABI_MINOR);
}

static GHashTable *loaders; /* address of a plugin's id -> loader */

static const opc_plugin *ask_loader(opc_registry *registry, const char *path,
                                    const char *id, char **reason) {
  opc_error error = {0};
  g_autofree char *name =
      g_strconcat(OPC_KIND_LOADER, strrchr(path, '.'), NULL);
  const opc_plugin *loader = opc_registry_find(registry, name, &error);
  const opc_loader *functions = loader ? loader->functions : NULL;
  const opc_plugin *plugin =
      functions ? functions->load(path, id, &error) : NULL;
  if (!plugin) *reason = g_strdup(error.message);
  if (!loaders) loaders = g_hash_table_new(NULL, NULL);
  if (plugin)
    g_hash_table_insert(loaders, (gpointer)plugin->id, (gpointer)loader);
  return plugin;
}

const opc_plugin *opc_plugin_loader(const opc_plugin *plugin) {
  return loaders ? g_hash_table_lookup(loaders, plugin->id) : NULL;
}

/* Return the descriptor of a shared object, opened as *object; NULL and *reason
   on failure. */
static const opc_plugin *read_object(const char *path, const char *id,
                                     void **object, char **reason) {
  g_autofree char *whole = g_canonicalize_filename(path, NULL);
  const char *before = start_loading(path, id);
  *object = dlopen(whole, RTLD_NOW | RTLD_LOCAL);
  end_loading(before);
  if (!*object) {
    *reason = g_strdup(dlerror());
    return NULL;
  }
  opc_plugin_entry entry;
  void *symbol = dlsym(*object, OPC_ENTRY_NAME);
  if (!symbol) {
    *reason = g_strdup("missing function " OPC_ENTRY_NAME "()");
    return NULL;
  }
  memcpy(&entry, &symbol, sizeof entry);
  before = start_loading(path, id);
  const opc_plugin *plugin = entry();
  end_loading(before);
  return plugin;
}

const opc_plugin *opc_plugin_load(opc_registry *registry, const char *path,
                                  const char *id, char **reason) {
  void *object = NULL;
  *reason = NULL;
  const opc_plugin *theirs = g_str_has_suffix(path, ".so")
                                 ? read_object(path, id, &object, reason)
                                 : ask_loader(registry, path, id, reason);
  const char *before = start_loading(path, id);
  opc_plugin *plugin = *reason ? NULL : opc_plugin_copy(theirs, reason);
  if (!*reason) *reason = opc_plugin_fault(plugin, id);
  end_loading(before);
  if (!*reason) *reason = opc_functions_adopt(registry, plugin);
  if (!*reason) return opc_timeout_add(plugin);
  explain_version(plugin, reason);
  if (object) dlclose(object);
  return NULL;
}

static loaded *look_for(opc_registry *registry, const char *id) {
  loaded *l = g_new0(loaded, 1);
  if (!opc_is_id(id)) return l;
  guint n = registry->endings->len;
  for (guint i = 0; i < registry->folders->len * n && !l->path; i++) {
    l->path = g_strconcat(registry->folders->pdata[i / n], "/", id,
                          registry->endings->pdata[i % n], NULL);
    if ((i % n && !strchr(id, '.')) ||
        !g_file_test(l->path, G_FILE_TEST_EXISTS))
      g_clear_pointer(&l->path, g_free);
  }
  if (l->path) l->plugin = opc_plugin_load(registry, l->path, id, &l->reason);
  return l;
}

/* ---- all plugins ---- */

static void candidate_free(gpointer item) {
  opc_candidate *c = item;
  g_free(c->id);
  g_free(c->path);
  g_free(c->reason);
  g_free(c->kind);
  g_free(c->version);
  g_free(c->licence);
  g_free(c->summary);
  g_free(c);
}

static gint compare_candidates(gconstpointer a, gconstpointer b) {
  return strcmp((*(opc_candidate *const *)a)->id,
                (*(opc_candidate *const *)b)->id);
}

char *opc_registry_id(const opc_registry *registry, const char *path) {
  char *id = g_path_get_basename(path);
  for (guint i = 0; i < registry->endings->len; i++) {
    char *end = g_strrstr(id, registry->endings->pdata[i]);
    if (!end || strcmp(end, registry->endings->pdata[i])) continue;
    if (!i || memchr(id, '.', (size_t)(end - id))) *end = 0;
    break;
  }
  return id;
}

/* Return all plugin files whose ids begin with `prefix`; none is loaded. */
static GPtrArray *list_candidates(const opc_registry *registry,
                                  const char *prefix) {
  GPtrArray *list = g_ptr_array_new_with_free_func(candidate_free);
  for (guint i = 0; i < registry->folders->len; i++) {
    const char *folder = registry->folders->pdata[i];
    g_autoptr(GPtrArray) names = opc_folder_names(folder);
    for (guint j = 0; names && j < names->len; j++) {
      const char *name = names->pdata[j];
      g_autofree char *id = opc_registry_id(registry, name);
      if (!g_str_has_prefix(name, prefix) || *name == '.' || !strcmp(id, name))
        continue;
      opc_candidate *c = g_new0(opc_candidate, 1);
      c->id = g_steal_pointer(&id);
      c->path = g_build_filename(folder, name, NULL);
      g_ptr_array_add(list, c);
    }
  }
  g_ptr_array_sort(list, compare_candidates); /* stable sort */
  for (guint i = 1; i < list->len; i++) {
    opc_candidate *c = list->pdata[i], *last = list->pdata[i - 1];
    if (!strcmp(c->id, last->id))
      c->hidden_by = last->hidden_by ? last->hidden_by : last->path;
  }
  return list;
}

GPtrArray *opc_registry_scan(opc_registry *registry, const char *prefix,
                             double seconds) {
  GPtrArray *list = list_candidates(registry, prefix);
  for (guint i = 0; i < list->len; i++)
    opc_candidate_try(registry, list->pdata[i], seconds);
  return list;
}

GPtrArray *opc_registry_usable(opc_registry *registry, const char *prefix,
                               double seconds) {
  GPtrArray *list = opc_registry_scan(registry, prefix, seconds);
  for (guint i = list->len; i-- > 0;) {
    const opc_candidate *c = list->pdata[i];
    if (c->reason || c->hidden_by) g_ptr_array_remove_index(list, i);
  }
  return list;
}

GPtrArray *opc_registry_ids(const opc_registry *registry, const char *prefix) {
  g_autoptr(GPtrArray) list = list_candidates(registry, prefix);
  GPtrArray *ids = g_ptr_array_new_with_free_func(g_free);
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    if (!c->hidden_by) g_ptr_array_add(ids, g_strdup(c->id));
  }
  return ids;
}

/* ---- loading by id ---- */

static void explain_missing(const opc_registry *registry, const char *id,
                            opc_error *error) {
  g_autoptr(GPtrArray) ids = opc_registry_ids(registry, "");
  g_autofree char *suggestion = opc_suggestion_of_id(id, ids);
  opc_fail(error, OPC_NO_PLUGIN, NULL, "unknown plugin '%s'%s", id, suggestion);
}

const opc_plugin *opc_registry_find(opc_registry *registry, const char *id,
                                    opc_error *error) {
  loaded *l = g_hash_table_lookup(registry->seen, id);
  if (!l) {
    l = look_for(registry, id);
    g_hash_table_replace(registry->seen, g_strdup(id), l);
  }
  if (l->plugin && !l->reason) return l->plugin;
  if (l->path)
    opc_fail(error, OPC_NO_PLUGIN, NULL, "'%s': cannot use '%s': %s", id,
             l->path, l->reason);
  else
    explain_missing(registry, id, error);
  return NULL;
}

const char *opc_registry_path(const opc_registry *registry,
                              const opc_plugin *plugin) {
  const loaded *l = g_hash_table_lookup(registry->seen, plugin->id);
  return l ? l->path : NULL;
}
