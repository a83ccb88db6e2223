/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the search for plugins and of the messages about unusable
   plugins. */
#include "core/plugin/registry.h"

#include <base/file.h>
#include <base/suggest.h>
#include <stdio.h>
#include <string.h>

#include "core/plugin/declaration.h"

/* Return the folder of the test plugins, beside the test programs. */
static char *plugin_folder(void) {
  return g_build_filename(g_getenv("OPCFLOW_BUILD"), "tests", NULL);
}

static opc_registry *test_registry(void) {
  g_autofree char *folder = plugin_folder();
  const char *folders[] = {folder, NULL};
  return opc_registry_new(folders);
}

/* Expected reason for each of tests/badplugins. */
static const struct {
  const char *id, *reason;
} faults[] = {
    {"bad.crash", "crashed while loading"},
    {"bad.default",
     "default of parameter 'size': 'size' must be at most 65 nm, found '66 "
     "nm'"},
    {"bad.entry", "missing function opcflow_plugin()"},
    {"bad.exit", "the process ended while loading"},
    {"bad.field", "parameter 'size': the field is outside of the instance"},
    {"bad.follows",
     "parameter 'size' follows from other values, and must be a number, not "
     "required and without a default"},
    {"bad.function", "the function 'violations' is missing"},
    {"bad.functions", "the function 'violations' is missing"},
    {"bad.hang", "did not load within 0.5 s"},
    {"bad.instance", "the instance is too small for the pointer to the host"},
    {"bad.kind",
     "the kind 'nothing' is unknown: unknown plugin 'kind.nothing'"},
    {"bad.licence", "the descriptor has no licence"},
    {"bad.major", "built for plugin interface 9.8, this is 0.8"},
    {"bad.minor", "built for plugin interface 0.7, this is 0.8"},
    {"bad.name", "the id is 'bad.other', but the file name is 'bad.name'"},
    {"bad.null", "opcflow_plugin() returned nothing"},
    {"bad.summary", "the descriptor has no summary"},
    {"bad.twice", "parameter 'size' is declared twice"},
    {"bad.unit", "parameter 'size' has the unknown unit 'parsec'"},
    {"bad.version", "the descriptor has no version"},
    {"bad.width",
     "parameter 'size': the field has 4 bytes, expected for the type 'real' 8"},
};

static const opc_candidate *candidate_find(const GPtrArray *list,
                                           const char *id) {
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    if (!strcmp(c->id, id)) return c;
  }
  return NULL;
}

static void test_scan(void) {
  g_autoptr(opc_registry) registry = test_registry();
  g_autoptr(GPtrArray) list = opc_registry_scan(registry, "", 0.5);
  for (size_t i = 0; i < G_N_ELEMENTS(faults); i++) {
    const opc_candidate *c = candidate_find(list, faults[i].id);
    g_assert_nonnull(c);
    g_assert_nonnull(c->reason);
    if (!strstr(c->reason, faults[i].reason))
      g_assert_cmpstr(c->reason, ==, faults[i].reason);
  }
  const opc_candidate *good = candidate_find(list, "bad.none");
  g_assert_cmpstr(good->reason, ==, NULL);
  g_assert_cmpstr(good->kind, ==, "regulator");
  g_assert_cmpstr(good->summary, ==, "A plugin with a fault");
}

static void test_find(void) {
  g_autoptr(opc_registry) registry = test_registry();
  opc_error error;
  const opc_plugin *plugin =
      opc_registry_find(registry, "test.numbers", &error);
  g_assert_nonnull(plugin);
  g_assert_true(plugin == opc_registry_find(registry, "test.numbers", &error));
  g_assert_true(g_str_has_suffix(opc_registry_path(registry, plugin),
                                 "tests/test.numbers.so"));
  g_assert_cmpint(opc_parameter_find(plugin, "anchor.pitch"), ==, 12);
  g_assert_cmpint(opc_parameter_find(plugin, "anchor"), ==, -1);
}

static void test_refused(void) {
  g_autoptr(opc_registry) registry = test_registry();
  g_autofree char *folder = plugin_folder();
  g_autofree char *text = g_strdup_printf(
      "'bad.major': cannot use '%s/bad.major.so': built for "
      "plugin interface 9.8, this is 0.8 (oldest: 0.8)",
      folder);
  opc_error error;
  for (int i = 0; i < 2; i++) {
    memset(&error, 0, sizeof error);
    g_assert_null(opc_registry_find(registry, "bad.major", &error));
    g_assert_cmpint(error.code, ==, OPC_NO_PLUGIN);
    g_assert_cmpstr(error.message, ==, text);
  }
  g_assert_null(opc_registry_find(registry, "test.nubmers", &error));
  g_assert_cmpstr(
      error.message, ==,
      "unknown plugin 'test.nubmers', did you mean 'test.numbers'?");
  g_assert_null(opc_registry_find(registry, "nubmers", &error));
  g_assert_cmpstr(error.message, ==,
                  "unknown plugin 'nubmers', did you mean 'test.numbers'?");
  g_assert_null(opc_registry_find(registry, "../evil", &error));
  g_assert_cmpstr(error.message, ==, "unknown plugin '../evil'");
}

/* If two files have the same id, the first one is used; the second is reported
   as hidden. */
static void test_duplicate(void) {
  g_autofree char *folder = plugin_folder();
  g_autofree char *copy = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_autofree char *from = g_build_filename(folder, "test.numbers.so", NULL);
  g_autofree char *to = g_build_filename(copy, "test.numbers.so", NULL);
  g_autofree char *bytes = NULL;
  gsize length;
  g_assert_true(g_file_get_contents(from, &bytes, &length, NULL));
  g_assert_true(g_file_set_contents(to, bytes, (gssize)length, NULL));
  /* The same folder given twice counts once. */
  const char *folders[] = {copy, folder, copy, NULL};
  g_autoptr(opc_registry) registry = opc_registry_new(folders);
  g_autoptr(GPtrArray) list = opc_registry_scan(registry, "", 0.5);
  guint n = 0;
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    if (strcmp(c->id, "test.numbers")) continue;
    g_assert_cmpstr(c->path, ==, n ? from : to);
    g_assert_cmpstr(c->hidden_by, ==, n ? to : NULL);
    n++;
  }
  g_assert_cmpuint(n, ==, 2);
  remove(to);
  remove(copy);
}

static void test_folders(void) {
  g_setenv("OPCFLOW_PLUGIN_PATH", "/nowhere/b::/nowhere/c", TRUE);
  const char *given[] = {"/nowhere/a", "/nowhere/a", NULL};
  g_autoptr(opc_registry) registry = opc_registry_new(given);
  const GPtrArray *folders = opc_registry_folders(registry);
  g_assert_cmpstr(folders->pdata[0], ==, "/nowhere/a");
  g_assert_cmpstr(folders->pdata[1], ==, "/nowhere/b");
  g_assert_cmpstr(folders->pdata[2], ==, "/nowhere/c");
  /* no system folders, because the tests set OPCFLOW_NO_SYSTEM_PLUGINS */
  g_assert_cmpuint(folders->len, ==, 4);
}

/* Distances computed by hand from the definition. */
static void test_distance(void) {
  g_assert_cmpuint(opc_edit_distance("", ""), ==, 0);
  g_assert_cmpuint(opc_edit_distance("", "abc"), ==, 3);
  g_assert_cmpuint(opc_edit_distance("kitten", "sitting"), ==, 3);
  g_assert_cmpuint(opc_edit_distance("sigma_otu", "sigma_out"), ==, 1);
  g_assert_cmpuint(opc_edit_distance("ca", "abc"), ==, 3);
}

static void test_ids(void) {
  g_assert_true(opc_is_id("litho.abbe"));
  g_assert_true(opc_is_id("a.b_2.c"));
  g_assert_false(opc_is_id(""));
  g_assert_false(opc_is_id("."));
  g_assert_false(opc_is_id("a."));
  g_assert_false(opc_is_id("a..b"));
  g_assert_false(opc_is_id("Mask"));
  g_assert_false(opc_is_id("../x"));
  g_assert_false(opc_is_id("2d"));
}

/* Suggestions for former ids and for mistyped ids. */
static void test_former_ids(void) {
  static const char *const ids[] = {
      "draw.mask", "extractor.plain", "kind.regulator",  "litho.hopkins",
      "read.cif",  "regulator.drc",   "synthesizer.dpb", "write.cif"};
  static const char *const cases[][2] = {
      {"mask.dpb", ", did you mean 'synthesizer.dpb'?"},
      {"drc.regulator", ", did you mean 'regulator.drc'?"},
      {"extract.plain", ", did you mean 'extractor.plain'?"},
      {"wrte.cif", ", did you mean 'write.cif'?"},
      {"litho.hopkin", ", did you mean 'litho.hopkins'?"},
      {"litho", ""},
      {"nothing.like", ""}};
  g_autoptr(GPtrArray) list = g_ptr_array_new();
  for (size_t i = 0; i < G_N_ELEMENTS(ids); i++)
    g_ptr_array_add(list, (char *)ids[i]);
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *text = opc_suggestion_of_id(cases[i][0], list);
    g_assert_cmpstr(text, ==, cases[i][1]);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/registry/former-ids", test_former_ids);
  g_test_add_func("/registry/scan", test_scan);
  g_test_add_func("/registry/find", test_find);
  g_test_add_func("/registry/refused", test_refused);
  g_test_add_func("/registry/duplicate", test_duplicate);
  g_test_add_func("/registry/folders", test_folders);
  g_test_add_func("/registry/distance", test_distance);
  g_test_add_func("/registry/ids", test_ids);
  return g_test_run();
}
