/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the JSON of a run: metrics, findings, verdicts and the manifest. */
#include "core/report/outcome.h"

#include <glib/gstdio.h>
#include <math.h>

static const opc_metric sum = {"sum", "nm", OPC_LOWER, 0.5, "a sum"},
                        count = {"count", NULL, OPC_NEUTRAL, 0, "a number"};

static void add_metric(opc_outcome *out, const char *path,
                       const opc_metric *metric, double value) {
  const opc_inner_metric entry = {path, metric, value};
  g_array_append_val(out->metrics, entry);
}

static JsonObject *member(JsonObject *o, const char *name) {
  g_assert_true(json_object_has_member(o, name));
  return json_object_get_object_member(o, name);
}

/* Metrics are grouped by instance; infinite bounds and missing values are
   null. */
static void test_metrics(void) {
  opc_outcome out;
  opc_outcome_init(&out, 2);
  add_metric(&out, "a", &sum, 2.5);
  add_metric(&out, "a.slot", &count, 3);
  add_metric(&out, "a", &count, 4);
  opc_findings_add(&out.findings, 0, "a", "is odd");
  opc_findings_add(&out.findings, 7, "b", "is even");
  out.findings.more = 5;
  opc_verdict *v = g_new0(opc_verdict, 1);
  *v = (opc_verdict){.path = g_strdup("a.sum"),
                     .required = g_strdup("at most 2 nm"),
                     .unit = g_strdup("nm"),
                     .least = -INFINITY,
                     .most = 2,
                     .value = NAN};
  g_ptr_array_add(out.verdicts, v);
  g_autofree char *text = opc_outcome_metrics_text(&out);
  g_autoptr(JsonNode) root = json_from_string(text, NULL);
  JsonObject *o = json_node_get_object(root), *a = member(o, "a");
  JsonObject *one = member(a, "sum");
  g_assert_cmpfloat(json_object_get_double_member(one, "value"), ==, 2.5);
  g_assert_cmpstr(json_object_get_string_member(one, "unit"), ==, "nm");
  g_assert_cmpstr(json_object_get_string_member(one, "better"), ==, "lower");
  g_assert_cmpfloat(json_object_get_double_member(one, "tolerance"), ==, 0.5);
  one = member(a, "count");
  g_assert_cmpfloat(json_object_get_double_member(one, "value"), ==, 4);
  one = member(member(o, "a.slot"), "count");
  g_assert_cmpfloat(json_object_get_double_member(one, "value"), ==, 3);
  JsonArray *list = json_object_get_array_member(o, "findings");
  g_assert_cmpuint(json_array_get_length(list), ==, 2);
  one = json_array_get_object_element(list, 0);
  g_assert_false(json_object_has_member(one, "point"));
  g_assert_cmpstr(json_object_get_string_member(one, "step"), ==, "a");
  one = json_array_get_object_element(list, 1);
  g_assert_cmpint(json_object_get_int_member(one, "point"), ==, 7);
  g_assert_cmpstr(json_object_get_string_member(one, "text"), ==, "is even");
  g_assert_cmpint(json_object_get_int_member(o, "more_findings"), ==, 5);
  list = json_object_get_array_member(o, "require");
  one = json_array_get_object_element(list, 0);
  g_assert_true(json_object_get_null_member(one, "least"));
  g_assert_true(json_object_get_null_member(one, "value"));
  g_assert_cmpfloat(json_object_get_double_member(one, "most"), ==, 2);
  g_assert_cmpstr(json_object_get_string_member(one, "metric"), ==, "a.sum");
  g_assert_false(json_object_get_boolean_member(one, "kept"));
  opc_outcome_clear(&out);
}

/* The code of all failed points, or OPC_FAILED if the codes differ. */
static void test_failed_points(void) {
  static const struct {
    int codes[3], expected;
  } cases[] = {{{OPC_LIMIT, OPC_LIMIT, OPC_LIMIT}, OPC_LIMIT},
               {{OPC_LIMIT, OPC_IO, OPC_LIMIT}, OPC_FAILED},
               {{OPC_IO, OPC_LIMIT, OPC_LIMIT}, OPC_FAILED}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_outcome out;
    opc_outcome_init(&out, 1);
    g_assert_cmpint(out.points_code, ==, OPC_OK);
    for (int k = 0; k < 3; k++) opc_outcome_fail_point(&out, cases[i].codes[k]);
    g_assert_cmpuint(out.failed_points, ==, 3);
    g_assert_cmpint(out.points_code, ==, cases[i].expected);
    opc_outcome_clear(&out);
  }
}

/* The manifest has the steps that ran, the plugins with their checksums, each
   once, and the files read. */
static void test_manifest(void) {
  g_autofree char *folder =
      g_build_filename(g_getenv("OPCFLOW_BUILD"), "tests", NULL);
  const char *folders[] = {folder, NULL};
  g_autoptr(opc_registry) registry = opc_registry_new(folders);
  g_autofree char *path = g_build_filename(g_get_tmp_dir(), "XXXXXX", NULL);
  int file = g_mkstemp(path);
  g_assert_cmpint(file, >=, 0);
  g_assert_true(g_close(file, NULL));
  g_assert_true(
      g_file_set_contents(path,
                          "opcflow: 1\nsteps:\n  a: { use: test.kept }\n"
                          "  b: { use: test.kept, add: ${a} }\n",
                          -1, NULL));
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow = opc_flow_load(path, NULL, registry, problems);
  g_assert_cmpuint(problems->list->len, ==, 0);
  opc_outcome out;
  opc_outcome_init(&out, 2);
  out.seconds[0] = 1.5;
  out.processor[0] = 0.5;
  out.total = 2;
  out.failure = g_strdup("is too dark");
  g_ptr_array_add(out.inputs, g_strdup("/in/x"));
  g_ptr_array_add(out.inputs, g_strdup("abc"));
  const char *const command[] = {"opcflow", "run", NULL};
  const opc_manifest about = {&out, flow, registry, NULL, command};
  g_autoptr(JsonNode) root = opc_manifest_json(&about);
  JsonObject *o = json_node_get_object(root), *steps = member(o, "steps");
  g_assert_cmpstr(json_object_get_string_member(o, "flow"), ==, path);
  g_assert_cmpstr(json_object_get_string_member(o, "result"), ==, "failed");
  g_assert_cmpstr(json_object_get_string_member(o, "failure"), ==,
                  "is too dark");
  g_assert_false(json_object_has_member(o, "store"));
  g_assert_false(json_object_has_member(o, "points"));
  g_assert_cmpfloat(json_object_get_double_member(o, "seconds"), ==, 2);
  g_assert_cmpfloat(json_object_get_double_member(steps, "a"), ==, 1.5);
  g_assert_false(json_object_has_member(steps, "b"));
  g_assert_cmpfloat(json_object_get_double_member(member(o, "processor"), "a"),
                    ==, 0.5);
  JsonArray *list = json_object_get_array_member(o, "command");
  g_assert_cmpstr(json_array_get_string_element(list, 1), ==, "run");
  list = json_object_get_array_member(o, "inputs");
  JsonObject *one = json_array_get_object_element(list, 0);
  g_assert_cmpstr(json_object_get_string_member(one, "path"), ==, "/in/x");
  g_assert_cmpstr(json_object_get_string_member(one, "sha256"), ==, "abc");
  list = json_object_get_array_member(o, "plugins");
  g_assert_cmpuint(json_array_get_length(list), ==, 1);
  one = json_array_get_object_element(list, 0);
  g_autofree char *plugin = g_build_filename(folder, "test.kept.so", NULL);
  g_autofree char *bytes = NULL;
  gsize n;
  g_assert_true(g_file_get_contents(plugin, &bytes, &n, NULL));
  g_autofree char *its =
      g_compute_checksum_for_string(G_CHECKSUM_SHA256, bytes, (gssize)n);
  g_assert_cmpstr(json_object_get_string_member(one, "id"), ==, "test.kept");
  g_assert_cmpstr(json_object_get_string_member(one, "sha256"), ==, its);
  opc_outcome_clear(&out);
  g_assert_cmpint(remove(path), ==, 0);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/outcome/metrics", test_metrics);
  g_test_add_func("/outcome/failed-points", test_failed_points);
  g_test_add_func("/outcome/manifest", test_manifest);
  return g_test_run();
}
