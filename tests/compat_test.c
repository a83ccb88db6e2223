/* SPDX-License-Identifier: BSD-3-Clause */
/* Plugins that were built once and kept as binaries (tests/compat) still load,
   and flows of them still give what they gave. There are none before interface
   1.0. */
#include <json-glib/json-glib.h>
#include <string.h>
#include <sys/utsname.h>
#include <sys/wait.h>

#include <store/files.h>
#include "core/plugin/registry.h"

/* Where those of this machine are kept, and the files there that end so. */
static char *kept;

static GPtrArray *files(const char *suffix) {
  GPtrArray *found = g_ptr_array_new_with_free_func(g_free);
  g_autoptr(GDir) dir = g_dir_open(kept, 0, NULL);
  for (const char *name; dir && (name = g_dir_read_name(dir));)
    if (g_str_has_suffix(name, suffix))
      g_ptr_array_add(found, g_strndup(name, strlen(name) - strlen(suffix)));
  g_test_message("%u of *%s are kept", found->len, suffix);
  return found;
}

static void test_load(void) {
  const char *folders[] = {kept, NULL};
  g_autoptr(opc_registry) registry = opc_registry_new(folders);
  g_autoptr(GPtrArray) ids = files(".so");
  for (guint i = 0; i < ids->len; i++) {
    opc_error error = {0};
    g_assert_nonnull(opc_registry_find(registry, ids->pdata[i], &error));
    g_assert_cmpstr(error.message, ==, "");
  }
}

static JsonNode *read_json(const char *folder, const char *name) {
  g_autofree char *path = g_build_filename(folder, name, NULL);
  g_autoptr(JsonParser) parser = json_parser_new();
  g_assert_true(json_parser_load_from_file(parser, path, NULL));
  return json_node_copy(json_parser_get_root(parser));
}

static void run_flow(const char *name) {
  g_autofree char *folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_autofree char *run = g_build_filename(folder, "run", NULL);
  g_autofree char *flow = g_strdup_printf("%s/%s.yaml", kept, name);
  g_autofree char *expected = g_strdup_printf("%s.json", name);
  g_autofree char *command =
      g_build_filename(g_getenv("OPCFLOW_BUILD"), "opcflow", NULL);
  const char *argv[] = {command, "run",      flow, "--plugin-path",
                        kept,    "--output", run,  NULL};
  g_autofree char *out = NULL, *err = NULL;
  int status;
  g_assert_true(g_spawn_sync(NULL, (char **)argv, NULL, G_SPAWN_DEFAULT, NULL,
                             NULL, &out, &err, &status, NULL));
  if (!WIFEXITED(status) || WEXITSTATUS(status)) g_error("%s: %s", flow, err);
  g_autoptr(JsonNode) wanted = read_json(kept, expected);
  g_autoptr(JsonNode) got = read_json(run, "metrics.json");
  g_assert_true(json_node_equal(wanted, got));
  opc_remove_tree(folder);
}

static void test_run(void) {
  g_autoptr(GPtrArray) flows = files(".yaml");
  for (guint i = 0; i < flows->len; i++) run_flow(flows->pdata[i]);
}

int main(int argc, char **argv) {
  struct utsname about;
  g_test_init(&argc, &argv, NULL);
  g_assert_false(uname(&about));
  kept = g_build_filename(g_getenv("OPCFLOW_SOURCE"), "tests", "compat",
                          about.machine, NULL);
  g_test_add_func("/compat/load", test_load);
  g_test_add_func("/compat/run", test_run);
  int failed = g_test_run();
  g_free(kept);
  return failed;
}
