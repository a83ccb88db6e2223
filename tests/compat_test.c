/* SPDX-License-Identifier: BSD-3-Clause */
/* Plugins that were built once and kept as binaries (tests/compat) still load,
   and a flow of them still gives what it gave. */
#include <glib.h>
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>
#include <sys/wait.h>

#include "core/flow/files.h"
#include "core/plugin/declaration.h"
#include "core/plugin/registry.h"

static const char *const kept[] = {
    "compat.draw", "compat.litho", "compat.resist", "compat.extract",
    "compat.mask", "compat.drc",   "compat.tell"};

static char *source(const char *name) {
  return g_build_filename(g_getenv("OPCFLOW_SOURCE"), "tests", "compat", name,
                          NULL);
}

/* FALSE, and the test is skipped, where the binaries cannot run. */
static gboolean can_run(void) {
#ifdef __x86_64__
  return TRUE;
#else
  g_test_skip("the kept plugins are for x86-64");
  return FALSE;
#endif
}

static void test_load(void) {
  if (!can_run()) return;
  g_autofree char *folder = source("x86_64");
  const char *folders[] = {folder, NULL};
  g_autoptr(opc_registry) registry = opc_registry_new(folders);
  for (size_t i = 0; i < G_N_ELEMENTS(kept); i++) {
    opc_error error = {0};
    const opc_plugin *plugin = opc_registry_find(registry, kept[i], &error);
    g_assert_cmpstr(error.message, ==, "");
    g_assert_cmpuint(plugin->abi_major, ==, 1);
    g_assert_cmpuint(plugin->abi_minor, ==, 0);
    g_assert_cmpstr(plugin->summary, ==, "built once and kept");
  }
}

static double metric(JsonObject *all, const char *step, const char *name) {
  JsonObject *o = json_object_get_object_member(all, step);
  return json_object_get_double_member(json_object_get_object_member(o, name),
                                       "value");
}

static void expect_results(const char *run) {
  g_autofree char *path = g_build_filename(run, "metrics.json", NULL);
  g_autoptr(JsonParser) parser = json_parser_new();
  g_assert_true(json_parser_load_from_file(parser, path, NULL));
  JsonObject *all = json_node_get_object(json_parser_get_root(parser));
  g_assert_true(metric(all, "mask", "transistors") == 2);
  g_assert_true(metric(all, "mask", "failed") == 0);
  g_assert_true(metric(all, "mask", "violations") == 0);
  g_assert_true(metric(all, "mask", "iterations") == 7);
  g_assert_cmpfloat(metric(all, "mask", "ion_max"), <, 1.2);
  g_assert_cmpfloat(fabs(metric(all, "tell", "ion") - 1), <, 0.012);
  g_assert_cmpfloat(fabs(metric(all, "tell", "length") - 65), <, 1);
  /* Both lines are 800 nm high, 65 nm wide and got 6 nm wider; each of their
     ends got END longer. */
  enum { END = 1 };
  g_assert_true(metric(all, "tell", "area") == 2 * (6 * 800 + 2 * END * 71));
  g_autofree char *file = g_build_filename(run, "kept.txt", NULL);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(file, &text, NULL, NULL));
  g_assert_cmpstr(text, ==, "kept\n");
  g_autofree char *table = g_build_filename(run, "kept.csv", NULL);
  g_assert_true(g_file_test(table, G_FILE_TEST_EXISTS));
}

static void test_run(void) {
  if (!can_run()) return;
  g_autofree char *folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_autofree char *run = g_build_filename(folder, "run", NULL);
  g_autofree char *plugins = source("x86_64"), *flow = source("flow.yaml");
  g_autofree char *command =
      g_build_filename(g_getenv("OPCFLOW_BUILD"), "opcflow", NULL);
  const char *argv[] = {command,         "run",   flow,
                        "--plugin-path", plugins, "--json",
                        "--output",      run,     NULL};
  g_autofree char *out = NULL, *err = NULL;
  int status;
  g_assert_true(g_spawn_sync(NULL, (char **)argv, NULL, G_SPAWN_DEFAULT, NULL,
                             NULL, &out, &err, &status, NULL));
  g_assert_cmpstr(err, ==, "tell: 2 transistors\n");
  g_assert_true(WIFEXITED(status) && !WEXITSTATUS(status));
  expect_results(run);
  opc_remove_tree(folder);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/compat/load", test_load);
  g_test_add_func("/compat/run", test_run);
  return g_test_run();
}
