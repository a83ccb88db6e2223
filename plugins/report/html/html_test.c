/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests pages of an experiment and of the present run. Folders are made by
   hand, and the data in the page must equal their content. */
#include <eda/experiment.h>
#include <eda/gates.h>
#include <eda/memory.h>
#include <glib/gstdio.h>

#include "tests/run_folder.h"
#include "tools/devel/testing.h"

/* Run report.html. Returns its code. */
static int write_page(const char *mapping, const char *input, void *object,
                      opc_error *error) {
  void *none[1];
  opc_test_forget();
  g_autoptr(opc_module) m = opc_test_module("report.html", mapping, error);
  if (!m) return error->code;
  if (input) opc_test_input(m, input, object);
  return opc_test_run(m, none, error);
}

static char *in_folder(const char *name) {
  return g_build_filename(opc_test_folder(), name, NULL);
}

static JsonObject *run_of(JsonNode *root, guint i, guint n) {
  JsonArray *runs =
      json_object_get_array_member(json_node_get_object(root), "runs");
  g_assert_cmpuint(json_array_get_length(runs), ==, n);
  return json_array_get_object_element(runs, i);
}

static double ion_of(JsonObject *run) {
  JsonObject *metrics = json_object_get_object_member(run, "metrics");
  return json_object_get_double_member(
      json_object_get_object_member(metrics, "mask.ion"), "value");
}

static gboolean page_lacks(JsonNode *root, const char *text) {
  JsonArray *missing =
      json_object_get_array_member(json_node_get_object(root), "missing");
  for (guint i = 0; i < json_array_get_length(missing); i++)
    if (!strcmp(json_array_get_string_element(missing, i), text)) return TRUE;
  return FALSE;
}

/* Each run has its case and method, in the order of the experiment. A failed
   run is listed as missing. */
static void test_experiment(void) {
  static const char *const cases[] = {"A", "B"}, *const methods[] = {"x", "y"};
  static const char *const metrics[] = {RUN_ION("1.5"), RUN_ION("2.5"),
                                        RUN_ION("3.5")};
  char *folders[4] = {NULL};
  for (int i = 0; i < 3; i++) {
    g_autofree char *name = g_strdup_printf("run-%d", i);
    folders[i] = in_folder(name);
    make_run(&(made_run){.folder = folders[i], .metrics = metrics[i]});
  }
  eda_experiment *e =
      eda_experiment_new(2, cases, 2, methods, (const char *const *)folders);
  opc_error error;
  if (write_page("{ file: all.html, title: All }", "experiment", e, &error))
    g_error("%s", error.message);
  g_autofree char *path = in_folder("all.html");
  g_autoptr(JsonNode) root = NULL;
  g_autofree char *page = read_page(path, &root);
  for (guint i = 0; i < 3; i++) {
    JsonObject *run = run_of(root, i, 3);
    g_assert_cmpstr(json_object_get_string_member(run, "case"), ==,
                    cases[i / 2]);
    g_assert_cmpstr(json_object_get_string_member(run, "method"), ==,
                    methods[i % 2]);
    g_assert_cmpstr(json_object_get_string_member(run, "folder"), ==,
                    folders[i]);
    g_assert_true(ion_of(run) == 1.5 + i);
  }
  g_assert_true(page_lacks(root, "B, y: the run failed"));
  g_assert_false(page_lacks(root, "B, x: the run failed"));
  eda_experiment_free(e);
  for (int i = 0; i < 3; i++) g_free(folders[i]);
}

/* Return the sample's transistors with a drawn mask that is not simulated. */
static eda_mask *mask_of(const eda_gates *gates) {
  opc_error error;
  eda_mask *m = eda_mask_new(gates);
  for (size_t k = 0; k < 2; k++)
    if (eda_shapes_grow(&gates->drawn[k], 7, &m->shapes[k], &error))
      g_error("%s", error.message);
  eda_performance_init(&m->design, gates->count);
  eda_performance_init(&m->before, gates->count);
  eda_performance_init(&m->after, gates->count);
  m->flags = eda_alloc(gates->count, sizeof *m->flags);
  for (size_t i = 0; i < gates->count; i++)
    m->design.ion[i] = m->before.ion[i] = m->after.ion[i] = 1e-3;
  return m;
}

/* Inside another run there is no manifest, and only the pictures are written;
   otherwise the page contains the run and these pictures. */
static void test_mask(void) {
  opc_error error;
  g_autofree char *path = in_folder("one.html"), *view = in_folder("v.json");
  g_autofree char *manifest = in_folder("manifest.json");
  eda_mask *m = mask_of(eda_gates_sample());
  const char *mapping = "{ file: one.html, view: v.json }";
  if (write_page(mapping, "mask", m, &error)) g_error("%s", error.message);
  g_assert_false(g_file_test(path, G_FILE_TEST_EXISTS));
  g_assert_true(g_file_test(view, G_FILE_TEST_EXISTS));
  g_assert_nonnull(strstr(opc_test_log(), "'v.json' is kept for the page"));
  make_run(&(made_run){.folder = opc_test_folder(),
                       .variant = "plain",
                       .metrics = RUN_ION("4.5")});
  if (write_page("{ file: one.html }", "mask", m, &error))
    g_error("%s", error.message);
  g_autoptr(JsonNode) root = NULL;
  g_autofree char *page = read_page(path, &root);
  JsonObject *run = run_of(root, 0, 1);
  g_assert_cmpstr(json_object_get_string_member(run, "label"), ==,
                  "demo-plain");
  g_assert_true(json_object_get_boolean_member(run, "running"));
  g_assert_true(json_object_get_null_member(run, "folder"));
  g_assert_true(ion_of(run) == 4.5);
  g_autofree char *kept = in_folder("view.json"), *text = NULL;
  g_assert_true(g_file_get_contents(kept, &text, NULL, NULL));
  g_autoptr(JsonNode) alone = json_from_string(text, NULL);
  g_assert_true(json_node_equal(alone, json_object_get_member(run, "view")));
  g_remove(manifest);
  eda_mask_free(m);
}

static void test_refused(void) {
  opc_error error = {0};
  g_assert_cmpint(write_page("{}", NULL, NULL, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "mask");
  g_assert_cmpint(write_page("{ file: ../page.html }", NULL, NULL, &error), !=,
                  OPC_OK);
  const char *const name[] = {"A"}, *const gone[] = {"/nowhere/at/all"};
  eda_experiment *e = eda_experiment_new(1, name, 1, name, gone);
  g_assert_cmpint(write_page("{}", "experiment", e, &error), ==, OPC_IO);
  g_assert_nonnull(strstr(error.message, "/nowhere/at/all"));
  eda_experiment_free(e);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/report.html/experiment", test_experiment);
  g_test_add_func("/report.html/mask", test_mask);
  g_test_add_func("/report.html/refused", test_refused);
  return g_test_run();
}
