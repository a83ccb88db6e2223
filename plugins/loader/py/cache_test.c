/* SPDX-License-Identifier: BSD-3-Clause */
/* Kept descriptions of plugins: valid while the files of the plugin and the
   variables of the interpreter are unchanged. */
#include <glib/gstdio.h>
#include <string.h>

#include "py.h"

/* The functions of call.c that are used. */
const char *py_text(JsonObject *o, const char *name) {
  return json_object_get_string_member_with_default(o, name, NULL);
}

JsonArray *py_list(JsonObject *o, const char *name) {
  return json_object_get_array_member(o, name);
}

static char *store, *source;

static void source_put(const char *text) {
  g_assert_true(g_file_set_contents(source, text, -1, NULL));
}

static py_plugin plugin_new(void) {
  py_plugin p = {.path = source};
  g_autofree char *text = g_strdup_printf(
      "{ \"summary\" : \"a\", \"files\" : [ \"%s\" ] }", source);
  p.about = json_from_string(text, NULL);
  g_assert_nonnull(p.about);
  return p;
}

/* Return whether the description of the plugin is kept and equal. */
static int is_kept(const char *path) {
  py_plugin p = {.path = (char *)path};
  g_autoptr(JsonNode) about = py_cache_get(&p);
  if (about)
    g_assert_cmpstr(py_text(json_node_get_object(about), "summary"), ==, "a");
  return about != NULL;
}

static void test_kept(void) {
  py_plugin p = plugin_new();
  g_autofree char *mark = g_build_filename(store, "opcflow-store", NULL);
  g_autofree char *dotted = g_strconcat(store, "/./../", NULL);
  g_autofree char *name = g_path_get_basename(store);
  g_autofree char *other = g_strconcat(dotted, name, "/a.py", NULL);
  /* The folder is no store without its mark. */
  g_assert_null(py_cache_folder());
  py_cache_put(&p);
  g_assert_false(is_kept(source));
  g_assert_true(g_file_set_contents(mark, "", -1, NULL));
  g_autofree char *folder = py_cache_folder();
  g_assert_true(g_str_has_suffix(folder, "/python"));
  g_assert_true(g_file_test(folder, G_FILE_TEST_IS_DIR));
  g_assert_false(is_kept(source));
  py_cache_put(&p);
  g_assert_true(is_kept(source));
  g_assert_true(is_kept(other)); /* another name of the same file */
  g_assert_false(is_kept("/nowhere.py"));
  /* Another interpreter. */
  g_setenv("OPCFLOW_PYTHON", "/other", TRUE);
  g_assert_false(is_kept(source));
  g_unsetenv("OPCFLOW_PYTHON");
  g_assert_true(is_kept(source));
  /* A file of equal size that was replaced, and one that is missing. */
  source_put("y");
  g_assert_false(is_kept(source));
  py_cache_put(&p);
  g_assert_true(is_kept(source));
  g_unlink(source);
  g_assert_false(is_kept(source));
  py_cache_put(&p);
  source_put("y");
  g_assert_false(is_kept(source));
  /* A damaged description. */
  py_cache_put(&p);
  g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
  for (const char *file; (file = g_dir_read_name(dir));) {
    g_autofree char *path = g_build_filename(folder, file, NULL);
    g_assert_true(g_file_set_contents(path, "[1]", -1, NULL));
    g_assert_false(is_kept(source));
    g_unlink(path);
  }
  g_setenv("OPCFLOW_STORE", "", TRUE);
  g_assert_null(py_cache_folder());
  g_setenv("OPCFLOW_STORE", store, TRUE);
  json_node_unref(p.about);
  g_rmdir(folder);
  g_unlink(mark);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  store = g_dir_make_tmp("py-cache-XXXXXX", NULL);
  source = g_build_filename(store, "a.py", NULL);
  source_put("x");
  g_setenv("OPCFLOW_STORE", store, TRUE);
  g_unsetenv("OPCFLOW_PYTHON");
  g_test_add_func("/loader.py/cache", test_kept);
  int code = g_test_run();
  g_unlink(source);
  g_rmdir(store);
  g_free(source);
  g_free(store);
  return code;
}
