/* SPDX-License-Identifier: BSD-3-Clause */
/* `opcflow new`: every kind of plugin compiles without a warning as it comes,
   loads, and its flow runs with it. */
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <string.h>
#include <sys/wait.h>

#include "core/flow/files.h"

static char *folder, *command;
static char *out, *err;

/* Run a program; its exit code. */
static int call(const char *const *argv) {
  int status;
  g_autoptr(GError) error = NULL;
  g_clear_pointer(&out, g_free);
  g_clear_pointer(&err, g_free);
  g_spawn_sync(folder, (char **)argv, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL,
               &out, &err, &status, &error);
  g_assert_no_error(error);
  g_assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

#define CALL(...) call((const char *const[]){__VA_ARGS__, NULL})

static void compile(const char *source, const char *object) {
  g_autofree char *include =
      g_strconcat("-I", g_getenv("OPCFLOW_SOURCE"), "/include", NULL);
  int code = CALL("cc", "-std=c99", "-Wall", "-Wextra", "-Wshadow",
                  "-Wmissing-prototypes", "-Werror", "-fPIC", "-shared",
                  include, source, "-o", object, "-lm");
  if (code) g_error("%s", err);
}

static void test_plugin(gconstpointer data) {
  const char *kind = data;
  g_autofree char *id = g_strdup_printf("%s.mine_%s", kind, kind);
  g_autofree char *name = g_strdup_printf("mine_%s", kind);
  g_autofree char *source = g_strdup_printf("%s/%s.c", kind, name);
  g_autofree char *object = g_strdup_printf("%s/%s.so", kind, id);
  g_autofree char *flow = g_strdup_printf("%s/flow.yaml", kind);
  g_autofree char *output = g_strdup_printf("%s/run", kind);
  g_assert_cmpint(CALL(command, "new", "plugin", "--kind", kind, name, kind),
                  ==, 0);
  g_assert_nonnull(strstr(out, source));
  compile(source, object);
  g_assert_cmpint(CALL(command, "inspect", id, "--plugin-path", kind), ==, 0);
  if (CALL(command, "run", flow, "--plugin-path", kind, "--output", output,
           "--json"))
    g_error("%s", err);
  g_autoptr(JsonNode) json = json_from_string(out, NULL);
  g_assert_nonnull(json);
  /* The plugin did the work: the run's manifest has it. */
  g_autofree char *manifest =
      g_build_filename(folder, output, "manifest.json", NULL);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(manifest, &text, NULL, NULL));
  g_assert_nonnull(strstr(text, object));
  g_autofree char *build = g_build_filename(folder, kind, "meson.build", NULL);
  g_autofree char *recipe = NULL;
  g_assert_true(g_file_get_contents(build, &recipe, NULL, NULL));
  g_assert_null(strchr(recipe, '@'));
  g_assert_nonnull(strstr(recipe, id));
}

/* The worst deviation of a run's drive currents, %. */
static double worst(const char *run) {
  g_autofree char *path = g_build_filename(folder, run, "metrics.json", NULL);
  g_autoptr(JsonParser) parser = json_parser_new();
  g_assert_true(json_parser_load_from_file(parser, path, NULL));
  g_autoptr(JsonNode) found = json_path_query(
      "$.mask.ion_max.value", json_parser_get_root(parser), NULL);
  return json_array_get_double_element(json_node_get_array(found), 0);
}

/* The synthesizer corrects: as drawn, the worst transistor is 18 % off. */
static void test_synthesizer(void) {
  g_assert_cmpfloat(worst("mask/run"), <, 2.5);
}

static void test_flow(void) {
  g_assert_cmpint(CALL(command, "new", "flow", "first.yaml", "--json"), ==, 0);
  g_autoptr(JsonNode) json = json_from_string(out, NULL);
  JsonArray *files =
      json_object_get_array_member(json_node_get_object(json), "files");
  g_assert_cmpuint(json_array_get_length(files), ==, 3);
  if (CALL(command, "run", "first.yaml", "--output", "first"))
    g_error("%s", err);
  g_assert_cmpfloat(worst("first"), <, 0.5);
  g_assert_cmpint(CALL(command, "new", "flow", "first.yaml"), ==, 5);
  g_assert_cmpstr(err, ==, "error: './first.yaml' exists\n");
  g_assert_cmpint(CALL(command, "new", "flow", "second.yaml"), ==, 0);
  g_assert_cmpstr(out, ==, "./second.yaml\n");
}

static void test_refusals(void) {
  g_assert_cmpint(CALL(command, "new", "circle"), ==, 2);
  g_assert_cmpint(CALL(command, "new", "plugin"), ==, 2);
  g_assert_cmpint(CALL(command, "new", "plugin", "mine"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "error: 'new plugin' needs --kind, see 'opcflow help new'\n");
  g_assert_cmpint(CALL(command, "new", "plugin", "--kind", "masks", "mine"), ==,
                  2);
  g_assert_cmpint(CALL(command, "new", "plugin", "mask.Mine"), ==, 2);
  g_assert_cmpint(CALL(command, "new", "plugin", "mask.mine", "mask"), ==, 5);
  g_assert_cmpstr(err, ==, "error: 'mask' exists\n");
}

int main(int argc, char **argv) {
  static const char *const kinds[] = {"litho", "resist", "extract",
                                      "mask",  "drc",    "step"};
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  command = g_build_filename(g_getenv("OPCFLOW_BUILD"), "opcflow", NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++) {
    g_autofree char *path = g_strconcat("/new/", kinds[i], NULL);
    g_test_add_data_func(path, kinds[i], test_plugin);
  }
  g_test_add_func("/new/synthesizer", test_synthesizer);
  g_test_add_func("/new/flow", test_flow);
  g_test_add_func("/new/refusals", test_refusals);
  int code = g_test_run();
  opc_remove_tree(folder);
  return code;
}
