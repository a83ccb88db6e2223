/* SPDX-License-Identifier: BSD-3-Clause */
/* Findings and requirements of runs; variants and sweeps. */
#include <json-glib/json-glib.h>
#include <string.h>

#include "tests/command.h"

/* ---- findings ---- */

static JsonArray *list_of(const char *text, const char *name, JsonNode **root) {
  *root = json_from_string(text, NULL);
  g_assert_nonnull(*root);
  return json_object_get_array_member(json_node_get_object(*root), name);
}

static void expect_finding(JsonArray *list, guint i, const char *step,
                           const char *text) {
  g_assert_cmpuint(json_array_get_length(list), >, i);
  JsonObject *o = json_array_get_object_element(list, i);
  g_assert_cmpstr(json_object_get_string_member(o, "step"), ==, step);
  g_assert_cmpstr(json_object_get_string_member(o, "text"), ==, text);
}

/* A finding is printed at once and again at the end, once each time, even if
   the step logs the finding repeatedly. */
static void test_findings(void) {
  g_autoptr(JsonNode) file = NULL, json = NULL, none = NULL;
  g_assert_cmpint(
      opcflow_call("run two.yaml --quiet --output found --set b.behave=find"),
      ==, 0);
  g_assert_true(g_str_has_suffix(err, "\nfinding: b: 2 nm is odd\n"));
  g_assert_true(g_str_has_prefix(err, "warning: b: 2 nm is odd\n"));
  g_autofree char *metrics = read_text("found/metrics.json");
  expect_finding(list_of(metrics, "findings", &file), 0, "b", "2 nm is odd");
  g_assert_cmpint(opcflow_call("run two.yaml --json --output found-json --set "
                               "b.behave=find"),
                  ==, 0);
  JsonArray *list = list_of(out, "findings", &json);
  expect_finding(list, 0, "b", "2 nm is odd");
  g_assert_cmpuint(json_array_get_length(list), ==, 1);
  g_assert_cmpint(opcflow_call("run two.yaml --json --output found-none"), ==,
                  0);
  g_assert_cmpuint(json_array_get_length(list_of(out, "findings", &none)), ==,
                   0);
  g_assert_null(strstr(err, "finding"));
}

/* Findings and violated requirements are the last lines, also if both streams
   are joined. */
static void test_last_lines(void) {
  g_autofree char *line = g_strdup_printf(
      "'%s' run two.yaml --output last --set b.behave=find "
      "--set 'require.b.sum=70 nm' 2>&1",
      command);
  const char *argv[] = {"sh", "-c", line, NULL};
  g_autofree char *all = NULL;
  g_assert_true(g_spawn_sync(NULL, (char **)argv, NULL, G_SPAWN_SEARCH_PATH,
                             NULL, NULL, &all, NULL, NULL, NULL));
  g_assert_true(g_str_has_suffix(
      all,
      " s\nfinding: b: 2 nm is odd\n"
      "--set require.b.sum: 'b.sum' is 75 nm, expected at most 70 nm\n"));
}

/* Many findings from all threads, and from a step that then fails. */
static void test_many_findings(void) {
  g_autoptr(JsonNode) file = NULL;
  g_assert_cmpint(
      opcflow_call("run two.yaml --output many --set a.behave=many --set "
                   "b.behave=fail"),
      ==, 4);
  g_assert_nonnull(strstr(err, "\nfinding: and 150 more findings\nnote: "));
  g_autofree char *metrics = read_text("many.failed/metrics.json");
  JsonArray *list = list_of(metrics, "findings", &file);
  g_assert_cmpuint(json_array_get_length(list), ==, 100);
  JsonObject *root = json_node_get_object(file);
  g_assert_cmpint(json_object_get_int_member(root, "more_findings"), ==, 150);
}

/* Findings of each point, also in the folder of the point. */
static void test_findings_of_points(void) {
  g_autoptr(JsonNode) file = NULL, one = NULL;
  g_assert_cmpint(opcflow_call("run two.yaml --keep --output points --sweep "
                               "b.size=[3~nm,4~nm] --set b.behave=find --set "
                               "a.behave=find"),
                  ==, 0);
  g_assert_true(g_str_has_suffix(err,
                                 "\nfinding: a: 65 nm is odd\n"
                                 "finding: point 1: b: 3 nm is odd\n"
                                 "finding: point 2: b: 4 nm is odd\n"));
  g_autofree char *all = read_text("points/metrics.json");
  JsonArray *list = list_of(all, "findings", &file);
  expect_finding(list, 2, "b", "4 nm is odd");
  g_assert_cmpint(json_object_get_int_member(
                      json_array_get_object_element(list, 2), "point"),
                  ==, 2);
  g_autofree char *point = read_text("points/0002/metrics.json");
  expect_finding(list_of(point, "findings", &one), 0, "b", "4 nm is odd");
}

/* ---- required bounds ---- */

/* a.sum is 69 nm and b.sum is 75 nm. Bounds on both metrics are tested. */
static void test_bounds(void) {
  static const struct {
    const char *bound, *text; /* text of a violated bound; NULL if the bound is
                                 met */
  } cases[] = {{"75~nm", NULL},
               {"0.075~um", NULL},
               {"74.9~nm", "at most 74.9 nm"},
               {"<=75~nm", NULL},
               {"<75~nm", "less than 75 nm"},
               {">=75~nm", NULL},
               {">75~nm", "more than 75 nm"},
               {">=76~nm", "at least 76 nm"},
               {"=75.05~nm", NULL}, /* the tolerance is 0.1 nm */
               {"=75.2~nm", "75.2 nm"},
               {"[75~nm,75~nm]", NULL},
               {"[75.1~nm,80~nm]", "from 75.1 nm to 80 nm"},
               {"[60~nm,74~nm]", "from 60 nm to 74 nm"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *list = NULL, *quoted = NULL, *line = NULL;
    quoted = *cases[i].bound == '[' ? g_strdup(cases[i].bound)
                                    : g_strdup_printf("'%s'", cases[i].bound);
    line = g_strdup_printf(
        "run two.yaml --quiet --output bounds-%zu --set require.b.sum=%s", i,
        quoted);
    g_assert_cmpint(opcflow_call(line), ==, cases[i].text ? 1 : 0);
    list = cases[i].text ? g_strdup_printf(
                               "--set require.b.sum: 'b.sum' is 75 nm, "
                               "expected %s\n",
                               cases[i].text)
                         : g_strdup("");
    g_assert_cmpstr(err, ==, list);
  }
}

/* All files are written under their names. The last line reports the
   violation. */
static void test_require(void) {
  write_text("must.yaml",
             "opcflow: 1\nextends: two.yaml\nrequire:\n  b.sum: 70 nm\n"
             "  a: { sum: '>= 0.069 um' }\n"
             "variants: { less: { b.size: 0.5 nm, require.b.sum: 74 nm }, "
             "none: { require: ~ } }\n");
  g_assert_cmpint(opcflow_call("check must.yaml"), ==, 0);
  g_assert_cmpint(opcflow_call("run must.yaml --output must"), ==, 1);
  g_assert_cmpstr(err, ==,
                  "must.yaml:4:3: 'b.sum' is 75 nm, expected at most 70 "
                  "nm\n");
  g_assert_nonnull(strstr(out, "\nmust: "));
  g_assert_false(is_there("must.failed"));
  g_autoptr(JsonNode) file = NULL, json = NULL;
  g_autofree char *text = read_text("must/metrics.json");
  JsonArray *list = list_of(text, "require", &file);
  g_assert_cmpuint(json_array_get_length(list), ==, 2);
  JsonObject *first = json_array_get_object_element(list, 0);
  g_assert_cmpstr(json_object_get_string_member(first, "metric"), ==, "b.sum");
  g_assert_cmpfloat(json_object_get_double_member(first, "value"), ==, 75);
  g_assert_cmpfloat(json_object_get_double_member(first, "most"), ==, 70);
  g_assert_false(json_object_get_boolean_member(first, "kept"));
  g_assert_true(json_object_get_boolean_member(
      json_array_get_object_element(list, 1), "kept"));
  /* The resolved flow has the same requirement. */
  g_assert_cmpint(opcflow_call("run must/flow.yaml --json --output must-again"),
                  ==, 1);
  JsonArray *problems = list_of(out, "problems", &json);
  g_assert_cmpint(json_object_get_int_member(
                      json_array_get_object_element(problems, 0), "exit"),
                  ==, 1);
  /* One variant changes the requirement, another variant removes the
     requirement. */
  g_assert_cmpint(
      opcflow_call("run must.yaml --variant less --output must-less"), ==, 0);
  g_assert_cmpint(
      opcflow_call("run must.yaml --variant none --output must-none"), ==, 0);
  g_assert_cmpint(
      opcflow_call("run must.yaml --output must-set --set require.b=null"), ==,
      0);
}

static void test_require_faults(void) {
  write_text("musty.yaml",
             "opcflow: 1\nextends: two.yaml\nrequire:\n  c.sum: 1 nm\n"
             "  a.smu: 1 nm\n  b.sum: 1\n  a.sum: 1 V\n  sum: 3\n");
  g_assert_cmpint(opcflow_call("check musty.yaml"), ==, 2);
  g_assert_cmpstr(
      err, ==,
      "musty.yaml:4:3: 'c' does not exist in 'musty.yaml'\n"
      "musty.yaml:5:3: 'a' "
      "(test.numbers) has no metric 'smu', did you mean "
      "'sum'?\n"
      "musty.yaml:6:10: 'b.sum' requires a length with a unit, e.g. '1 "
      "nm'\n"
      "musty.yaml:7:10: 'a.sum' requires a length, found '1 "
      "V'\n"
      "musty.yaml:8:3: 'sum' does not name a metric, expected "
      "'step.metric'\n");
  write_text("musty.yaml",
             "opcflow: 1\nextends: two.yaml\nrequire:\n  a.sum: 1 nm\n"
             "  a: { sum: 2 nm }\n");
  g_assert_cmpint(opcflow_call("check musty.yaml"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "musty.yaml:5:8: 'sum' is given here and at "
                  "musty.yaml:4:3\n");
  write_text("musty.yaml",
             "opcflow: 1\nextends: two.yaml\nrequire: { .a.sum: 1 nm }\n");
  g_assert_cmpint(opcflow_call("check musty.yaml"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "musty.yaml:3:12: '.a' does not exist in 'musty.yaml'\n");
  g_assert_cmpint(
      opcflow_call("check two.yaml --set require.a.sum=[2~nm,1~nm]"), ==, 2);
  g_assert_cmpint(opcflow_call("check two.yaml --set require.a.sum=[2~nm]"), ==,
                  2);
  g_assert_cmpint(opcflow_call("check two.yaml --set require=~"), ==, 2);
  write_text("musty.yaml",
             "opcflow: 1\nsteps: { require: { use: test.numbers, size: 1 nm } "
             "}\n");
  g_assert_cmpint(opcflow_call("check musty.yaml"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "musty.yaml:2:10: 'require' cannot be the name of a step\n");
}

/* A requirement on a missing metric is violated. */
static void test_not_measured(void) {
  g_assert_cmpint(opcflow_call("run two.yaml --output unmeasured --set "
                               "b.behave=quiet --set require.b.sum=100~nm"),
                  ==, 1);
  g_assert_cmpstr(
      err, ==,
      "--set require.b.sum: 'b.sum' has no value, expected at most 100 nm\n");
}

/* Requirements are checked at each point; requirements on shared steps are
   checked once. */
static void test_require_of_points(void) {
  g_autoptr(JsonNode) file = NULL;
  g_assert_cmpint(
      opcflow_call("run two.yaml --output judged --sweep "
                   "b.size=[3~nm,4~nm,5~nm] --set require.b.sum=77~nm "
                   "--set require.a.sum=68~nm"),
      ==, 1);
  g_assert_true(g_str_has_suffix(
      err,
      "error: 1 of 3 points failed\n"
      "--set require.b.sum: point 3: 'b.sum' is 78 nm, expected at most 77 "
      "nm\n"
      "--set require.a.sum: 'a.sum' is 69 nm, expected at most 68 nm\n"));
  g_autofree char *csv = read_text("judged/sweep.csv");
  g_assert_nonnull(strstr(csv, "--set require.b.sum: 'b.sum' is 78 nm"));
  g_autofree char *text = read_text("judged/metrics.json");
  g_assert_cmpuint(json_array_get_length(list_of(text, "require", &file)), ==,
                   2);
}

/* ---- variants and sweeps ---- */

static void test_variants(void) {
  write_text("var.yaml",
             "opcflow: 1\nextends: two.yaml\nvariants:\n"
             "  big: { b.size: 20 nm }\n  bad: { b.behave: fail }\n"
             "  less: { b.add: ~ }\n");
  g_assert_cmpint(opcflow_call("check var.yaml"), ==, 0);
  g_assert_cmpint(opcflow_call("run var.yaml --variant bgi"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "var.yaml: unknown variant 'bgi', did you mean 'big'?\n");
  g_assert_cmpint(opcflow_call("run var.yaml --variant big"), ==, 0);
  g_autofree char *big = read_text("runs/var-big/b.numbers.csv");
  g_assert_nonnull(strstr(big, "plain,93.00,1\r\n"));
  /* If a variant fails, the other variants still run. */
  g_assert_cmpint(opcflow_call("run var.yaml --variant all --output v"), ==, 4);
  g_assert_true(is_there("v/big/flow.yaml"));
  g_assert_true(is_there("v/bad.failed/flow.yaml"));
  g_assert_nonnull(strstr(err, " (variant 'bad')\n"));
  g_assert_true(is_there("v/less/flow.yaml"));
  g_autofree char *less = read_text("v/less/numbers.csv");
  g_assert_nonnull(strstr(less, "plain,6.00,1\r\n"));
  g_assert_cmpint(opcflow_call("run v/big/flow.yaml --output v/again"), ==, 0);
  g_autofree char *again = read_text("v/again/b.numbers.csv");
  g_assert_cmpstr(big, ==, again);
  g_assert_cmpint(
      opcflow_call("run var.yaml --variant base --variant big --json"), ==, 0);
  g_autoptr(JsonNode) node = json_from_string(out, NULL);
  g_assert_cmpuint(json_array_get_length(json_node_get_array(node)), ==, 2);
  write_text("wrong.yaml",
             "opcflow: 1\nextends: two.yaml\nvariants: { x: { b.size: 1 V } "
             "}\n");
  g_assert_cmpint(opcflow_call("check wrong.yaml"), ==, 2);
  g_assert_cmpstr(
      err, ==,
      "wrong.yaml:3:26: 'size' requires a length, found '1 V' (variant 'x')\n");
  g_assert_cmpint(opcflow_call("run wrong.yaml"), ==, 0);
  /* A parameter in both forms (dotted and nested) is an error in one file.
     Across two files, the forms are merged. */
  write_text("wrong.yaml",
             "opcflow: 1\nextends: two.yaml\nvariants:\n"
             "  x: { b.size: 1 nm, b: { size: 2 nm } }\n");
  g_assert_cmpint(opcflow_call("check wrong.yaml"), ==, 2);
  g_assert_cmpstr(
      err, ==, "wrong.yaml:4:27: 'size' is given here and at wrong.yaml:4:8\n");
  write_text("over.yaml",
             "opcflow: 1\nextends: var.yaml\nvariants:\n"
             "  big: { b: { size: 2 nm } }\n");
  g_assert_cmpint(opcflow_call("check over.yaml"), ==, 0);
}

/* b depends on a. The axis does not change a, so a runs once. */
static void test_sweep(void) {
  write_text("sweep.yaml",
             "opcflow: 1\nextends: two.yaml\nsweep:\n"
             "  b.size: [1 nm, 2 nm]\n"
             "  b.whole: { from: 10, to: 30, step: 10 }\n");
  g_assert_cmpint(opcflow_call("check sweep.yaml"), ==, 0);
  g_assert_cmpint(opcflow_call("run sweep.yaml --output s"), ==, 0);
  g_assert_cmpstr(err, ==, "");
  g_autofree char *table = read_text("s/sweep.csv");
  g_auto(GStrv) lines = g_strsplit(table, "\r\n", -1);
  g_assert_cmpuint(g_strv_length(lines), ==, 8);
  g_assert_cmpstr(
      lines[0], ==,
      "point,b.size (nm),b.whole,a.sum (nm),b.sum (nm),seconds,result");
  g_assert_true(g_str_has_prefix(lines[1], "1,1,10,69,83,"));
  g_assert_true(g_str_has_prefix(lines[3], "3,1,30,69,103,"));
  g_assert_true(g_str_has_prefix(lines[6], "6,2,30,69,104,"));
  g_assert_true(g_str_has_suffix(lines[6], ",good"));
  /* a.sum is constant, so the table does not show a.sum. */
  g_assert_nonnull(strstr(out, "point  b.size (nm)  b.whole  b.sum (nm)\n"));
  /* Files of the shared step a exist once. Points have only tables. */
  g_assert_true(is_there("s/deep/er/out.txt"));
  g_assert_true(is_there("s/numbers.csv"));
  g_assert_cmpuint(entries("s"), ==, 6);
  /* The resolved flow repeats the sweep. */
  g_autofree char *resolved = read_text("s/flow.yaml");
  g_assert_nonnull(strstr(resolved, "\nsweep:\n  b.size: [1 nm, 2 nm]"));
  g_assert_cmpint(opcflow_call("run s/flow.yaml --output s2 --keep"), ==, 0);
  g_assert_cmpuint(entries("s2"), ==, 12);
  g_autofree char *second = read_text("s2/sweep.csv");
  g_auto(GStrv) others = g_strsplit(second, "\r\n", -1);
  g_assert_cmpstr(others[0], ==, lines[0]);
  g_assert_true(g_str_has_prefix(others[6], "6,2,30,69,104,"));
  /* The resolved flow of a point runs alone. */
  g_assert_cmpint(opcflow_call("run s2/0006/flow.yaml --output s3"), ==, 0);
  g_autofree char *csv = read_text("s3/b.numbers.csv");
  g_assert_nonnull(strstr(csv, "plain,104.00,1\r\n"));
  g_assert_cmpuint(entries("s3"), ==, 6);
}

/* A failed point is reported; the other points run. */
static void test_failing_points(void) {
  g_assert_cmpint(opcflow_call("run two.yaml --output p --sweep "
                               "b.behave=[well,fail,well]"),
                  ==, 4);
  g_assert_cmpstr(err, ==, "error: 1 of 3 points failed\n");
  g_autofree char *table = read_text("p/sweep.csv");
  g_auto(GStrv) lines = g_strsplit(table, "\r\n", -1);
  g_assert_true(g_str_has_prefix(lines[1], "1,well,69,"));
  g_assert_true(g_str_has_prefix(lines[2], "2,fail,69,,"));
  g_assert_nonnull(strstr(lines[2],
                          "step 'b' (test.numbers): 2 nm is not "
                          "possible"));
  g_assert_true(g_str_has_suffix(lines[3], ",good"));
  g_assert_cmpint(opcflow_call("run two.yaml --output q --sweep "
                               "b.behave=[well,limit]"),
                  ==, 1);
  /* The failure of a shared step is reported as without a sweep. */
  g_assert_cmpint(
      opcflow_call("run two.yaml --output p2 --set a.behave=fail --sweep "
                   "b.whole=[1,2]"),
      ==, 4);
  g_assert_false(is_there("p2"));
  g_assert_cmpint(
      opcflow_call("run two.yaml --output p3 --sweep b.whole=[1,x]"), ==, 2);
  g_assert_cmpstr(
      err, ==, "--sweep b.whole: 'whole' must be a whole number, found 'x'\n");
  g_assert_false(is_there("p3"));
  g_assert_cmpint(opcflow_call("run two.yaml --output p3 --sweep b.whole=[1,2] "
                               "--sweep b.size=[]"),
                  ==, 2);
  g_assert_true(
      g_str_has_prefix(err, "--sweep b.size: a sweep must be a list"));
}

/* A step that exceeds its time limit fails, also at a point of a sweep. The
   limit does not affect steps that end earlier. */
static void test_timeout(void) {
  g_assert_cmpint(opcflow_call("run two.yaml --output late --set b.behave=wait "
                               "--set b.timeout=200~ms"),
                  ==, 4);
  g_assert_cmpstr(err, ==,
                  "--set b.timeout: step 'b' (test.numbers): exceeded the time "
                  "limit of 0.2 s\nnote: files written so far are in "
                  "'late.failed'\n");
  g_assert_cmpint(
      opcflow_call("run two.yaml --output early --set b.timeout=2~min"), ==, 0);
  g_autofree char *flow = read_text("early/flow.yaml");
  g_assert_nonnull(strstr(flow, "timeout: 2 min "));
  g_assert_cmpint(
      opcflow_call("run two.yaml --output late-points --set b.timeout=0.2~s "
                   "--sweep b.behave=[well,wait,well]"),
      ==, 4);
  g_assert_cmpstr(err, ==, "error: 1 of 3 points failed\n");
  g_assert_cmpint(opcflow_call("check two.yaml --set b.timeout=0"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "--set b.timeout: 'timeout' must be above 0 s, found '0'\n");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  set_up(FALSE);
  write_two();
  g_test_add_func("/runs/findings", test_findings);
  g_test_add_func("/runs/last-lines", test_last_lines);
  g_test_add_func("/runs/many-findings", test_many_findings);
  g_test_add_func("/runs/findings-of-points", test_findings_of_points);
  g_test_add_func("/runs/bounds", test_bounds);
  g_test_add_func("/runs/require", test_require);
  g_test_add_func("/runs/require-faults", test_require_faults);
  g_test_add_func("/runs/not-measured", test_not_measured);
  g_test_add_func("/runs/require-of-points", test_require_of_points);
  g_test_add_func("/runs/variants", test_variants);
  g_test_add_func("/runs/sweep", test_sweep);
  g_test_add_func("/runs/failing-points", test_failing_points);
  g_test_add_func("/runs/timeout", test_timeout);
  return run_all();
}
