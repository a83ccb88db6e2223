/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of flow files: reading, messages with places, values, the order of
   steps, the resolved flow. */
#include "core/binding/flow.h"

#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include <store/files.h>
#include "core/binding/resolve.h"
#include "core/plugin/declaration.h"

/* ---- help ---- */

static char *folder;

static opc_registry *registry(void) {
  static opc_registry *all;
  if (!all) {
    g_autofree char *plugins =
        g_build_filename(g_getenv("OPCFLOW_BUILD"), "tests", NULL);
    const char *folders[] = {plugins, NULL};
    all = opc_registry_new(folders);
  }
  return all;
}

static opc_flow *load_with(const char *text, gssize length,
                           const char *const *sets, opc_problems *problems) {
  g_assert_true(g_file_set_contents("flow.yaml", text, length, NULL));
  return opc_flow_load("flow.yaml", sets, registry(), problems);
}

/* Check all problems of a flow. */
static void check_faults(const char *text, const char *expected) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow = load_with(text, -1, NULL, problems);
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpstr(found, ==, expected);
}

/* Check all problems of one step after the head. */
static void check_step(const char *step, const char *expected) {
  g_autofree char *text =
      g_strdup_printf("opcflow: 1\nsteps:\n  a: %s\n", step);
  check_faults(text, expected);
}

static opc_flow *load_good(const char *text, const char *const *sets) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_flow *flow = load_with(text, -1, sets, problems);
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpstr(found, ==, "");
  return flow;
}

static const opc_setting *value_of(const opc_flow *flow, guint step,
                                   const char *name) {
  const opc_binding *b =
      ((const opc_flow_step *)flow->steps->pdata[step])->binding;
  int i = opc_parameter_find(b->plugin, name);
  g_assert_cmpint(i, >=, 0);
  return &b->values[i];
}

/* ---- the file as such ---- */

static void test_not_yaml(void) {
  check_faults("", "flow.yaml:1:1: the file is empty");
  check_faults("- a\n", "flow.yaml:1:1: a flow must be a map, found a list");
  check_faults("opcflow: 1\nsteps:\n  a: { use: x }\n  a: { use: y, use: z }\n",
               "flow.yaml:4:3: duplicate key 'a', first given in line 3\n"
               "flow.yaml:4:16: duplicate key 'use', first given in line 4");
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_assert_null(load_with("a: \0b\n", 6, NULL, problems));
  g_assert_null(opc_flow_load("none.yaml", NULL, registry(), problems));
  g_assert_null(opc_flow_load(".", NULL, registry(), problems));
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpstr(
      found, ==,
      "flow.yaml:1:4: not YAML: a NUL byte\n"
      "'none.yaml': no such file\n'.': is a folder, not a regular file");
}

static void test_head(void) {
  check_faults(
      "stesp: {}\n"
      "name: 3 / 4\n"
      "description: [a]\n",
      "flow.yaml:1:1: unknown key 'stesp', did you mean "
      "'steps'?\n"
      "flow.yaml:1:1: 'opcflow: 1', the version of the format, is "
      "missing\n"
      "flow.yaml:1:1: missing 'steps'\n"
      "flow.yaml:2:7: 'name' must "
      "consist of letters, digits, '.', '_' and '-'\n"
      "flow.yaml:3:14: "
      "'description' must be a text, found a list");
  check_faults("opcflow: 2\nsteps: {}\n",
               "flow.yaml:1:10: 'opcflow' must be 1, the version of the "
               "format\n"
               "flow.yaml:2:8: 'steps' must be a map of steps");
}

/* ---- steps and parameters ---- */

static void test_steps(void) {
  check_faults(
      "opcflow: 1\nsteps:\n  a.b: { use: test.numbers, size: 1 nm }\n"
      "  b: test.numbers\n  c: { size: 1 nm }\n  d: { use: test.numbres }\n"
      "  e: { use: bad.none }\n",
      "flow.yaml:3:3: the name of step 'a.b' must consist of letters, digits, "
      "'_' and '-'\n"
      "flow.yaml:4:6: step 'b' must be a map, as in '{ use: "
      "PLUGIN }'\n"
      "flow.yaml:5:3: 'use' is missing: name the plugin of "
      "'c'\n"
      "flow.yaml:6:13: unknown plugin 'test.numbres', did you mean "
      "'test.numbers'?\n"
      "flow.yaml:7:13: 'bad.none' is a plugin of the kind "
      "'regulator', expected 'step'");
}

static void test_parameters(void) {
  check_step(
      "{ use: test.numbers }",
      "flow.yaml:3:3: required parameter 'size' of 'test.numbers' is missing");
  check_step("{ use: test.numbers, size: 1 nm, shaer: 1 % }",
             "flow.yaml:3:39: unknown parameter 'shaer' of 'test.numbers', did "
             "you mean 'share'?");
  check_step("{ use: test.numbers, size: 1 nm, anchor: { lime: 1 nm } }",
             "flow.yaml:3:49: unknown parameter 'anchor.lime' of "
             "'test.numbers', did you mean 'anchor.line'?");
  check_step("{ use: test.numbers, size: 1 nm, anchor: 1 nm }",
             "flow.yaml:3:47: 'anchor' is a group of parameters, expected a "
             "map as in 'anchor: { ... }'");
  check_step("{ use: test.numbers, size: 1 nm, note: }",
             "flow.yaml:3:45: 'note' has no value");
  check_step("{ use: test.numbers, size: 1 nm, word: thrid, flag: yes }",
             "flow.yaml:3:45: 'word' cannot be 'thrid', did you mean "
             "'third'?\n"
             "flow.yaml:3:58: 'flag' must be 'true' or 'false', "
             "found 'yes'");
  check_step("{ use: test.numbers, size: 1 nm, word: other }",
             "flow.yaml:3:45: 'word' must be one of 'first', 'second', "
             "'third', found 'other'");
  check_step("{ use: test.numbers, size: 1 nm, names: { poli: 9/0 } }",
             "flow.yaml:3:48: unknown key 'poli' in 'names', did you mean "
             "'poly'?");
  check_step("{ use: test.numbers, size: 1 nm, input: none.txt }",
             "flow.yaml:3:46: 'none.txt': no such file");
  check_step("{ use: test.numbers, size: 1 nm, output: ../x }",
             "flow.yaml:3:47: 'output' must name a file inside the run folder, "
             "found '../x'");
}

static void test_numbers(void) {
  check_step(
      "{ use: test.numbers, size: 3 }",
      "flow.yaml:3:33: 'size' requires a length with a unit, e.g. '3 nm'");
  check_step("{ use: test.numbers, size: 3 V }",
             "flow.yaml:3:33: 'size' requires a length, found '3 V'");
  check_step("{ use: test.numbers, size: 3 NM }",
             "flow.yaml:3:33: unknown unit 'NM' in '3 NM', did you mean 'nm'?");
  check_step("{ use: test.numbers, size: 3 nn }",
             "flow.yaml:3:33: unknown unit 'nn' in '3 nn', did you mean "
             "'nm'?");
  check_step(
      "{ use: test.numbers, size: wide }",
      "flow.yaml:3:33: 'size' requires a length with a unit, found 'wide'");
  check_step(
      "{ use: test.numbers, size: [1 nm] }",
      "flow.yaml:3:33: 'size' requires a length with a unit, found a list");
  check_step("{ use: test.numbers, size: 0 nm }",
             "flow.yaml:3:33: 'size' must be above 0 nm, found '0 nm'");
  check_step("{ use: test.numbers, size: 0 }",
             "flow.yaml:3:33: 'size' must be above 0 nm, found '0'");
  check_step("{ use: test.numbers, size: 1 um }",
             "flow.yaml:3:33: 'size' must be below 1000 nm, found '1 um'");
  check_step("{ use: test.numbers, size: 1e999 nm }",
             "flow.yaml:3:33: 'size' is too large: '1e999 nm'");
  check_step(
      "{ use: test.numbers, size: 1 nm, plain: 3 nm }",
      "flow.yaml:3:46: 'plain' must be a number without a unit, found '3 nm'");
  check_step("{ use: test.numbers, size: 1 nm, whole: 1.5, share: -1 % }",
             "flow.yaml:3:46: 'whole' must be a whole number, found "
             "'1.5'\n"
             "flow.yaml:3:58: 'share' must be at least 0 %, found '-1 %'");
  check_step("{ use: test.numbers, size: 1 nm, whole: 101 }",
             "flow.yaml:3:46: 'whole' must be at most 100, found '101'");
  check_step(
      "{ use: test.numbers, size: 1 nm, list: [1 nm, 0, 2] }",
      "flow.yaml:3:55: 'list' requires a length with a unit, e.g. '2 nm'");
}

static void test_slots(void) {
  check_step(
      "{ use: test.numbers, size: 1 nm, model: litho.x }",
      "flow.yaml:3:46: 'model' needs a plugin, as in '{ use: litho.NAME }'");
  check_step("{ use: test.numbers, size: 1 nm, model: { use: test.numbers } }",
             "flow.yaml:3:53: 'test.numbers' is a plugin of the kind 'step', "
             "expected 'litho'");
}

/* ---- references ---- */

static void test_references(void) {
  check_faults(
      "opcflow: 1\nsteps:\n"
      "  first: { use: test.numbers, size: 1 nm }\n"
      "  b: { use: test.numbers, size: 1 nm, add: ${frist} }\n"
      "  c: { use: test.numbers, size: 1 nm, add: first }\n"
      "  d: { use: test.numbers, size: 1 nm, add: ${first.smu} }\n"
      "  e: { use: test.numbers, size: 1 nm, add: \"${a b}\" }\n",
      "flow.yaml:4:44: unknown step 'frist' in '${frist}', did you mean "
      "'first'?\n"
      "flow.yaml:5:44: 'add' must be a reference to a step, as in "
      "'${first}'\n"
      "flow.yaml:6:44: step 'first' (test.numbers) has no output "
      "'smu', did you mean 'sum'?\n"
      "flow.yaml:7:44: unknown step 'a b' in '${a "
      "b}'");
}

static void test_circles(void) {
  check_faults(
      "opcflow: 1\nsteps:\n"
      "  a: { use: test.numbers, size: 1 nm, add: ${b} }\n"
      "  b: { use: test.numbers, size: 1 nm, add: ${c} }\n"
      "  c: { use: test.numbers, size: 1 nm, add: ${b} }\n",
      "flow.yaml:4:3: steps depend on each other in a cycle: b -> c -> b");
  check_step("{ use: test.numbers, size: 1 nm, add: ${a} }",
             "flow.yaml:3:3: steps depend on each other in a cycle: a -> a");
}

static void test_order(void) {
  g_autoptr(opc_flow) flow = load_good(
      "opcflow: 1\nsteps:\n"
      "  c: { use: test.numbers, size: 1 nm, add: ${a} }\n"
      "  x: { use: test.numbers, size: 1 nm }\n"
      "  b: { use: test.numbers, size: 1 nm, add: ${c.sum} }\n"
      "  a: { use: test.numbers, size: 1 nm }\n",
      NULL);
  GString *order = g_string_new(NULL);
  for (guint i = 0; i < flow->order->len; i++)
    g_string_append(order, ((opc_flow_step *)flow->order->pdata[i])->name);
  g_assert_cmpstr(order->str, ==, "xacb");
  g_string_free(order, TRUE);
}

/* ---- values ---- */

static void test_values(void) {
  g_assert_true(g_file_set_contents("in.txt", "x", 1, NULL));
  g_autoptr(opc_flow) flow = load_good(
      "opcflow: 1\nname: some-flow\nsteps:\n  a:\n    use: test.numbers\n"
      "    size: 0.065 um\n    whole: 7\n    plain: -2.5e1\n"
      "    list: [1 nm, 0.003 um]\n    names: { poly: 9/0, active: 1 }\n"
      "    note: '${a}: # \"x\"'\n    word: third\n    input: in.txt\n"
      "    output: a/b.gds\n    flag: true\n    anchor: { pitch: 300 nm }\n",
      NULL);
  g_assert_cmpstr(flow->name, ==, "some-flow");
  g_assert_true(value_of(flow, 0, "size")->field.real == 65);
  g_assert_cmpint(value_of(flow, 0, "whole")->field.integer, ==, 7);
  g_assert_true(value_of(flow, 0, "plain")->field.real == -25);
  const opc_setting *list = value_of(flow, 0, "list");
  g_assert_cmpuint(list->field.reals.count, ==, 2);
  g_assert_true(list->field.reals.values[0] == 1 &&
                list->field.reals.values[1] == 3);
  const opc_setting *names = value_of(flow, 0, "names");
  g_assert_cmpuint(names->field.map.count, ==, 2);
  g_assert_cmpstr(names->field.map.pairs[0].key, ==, "poly");
  g_assert_cmpstr(names->field.map.pairs[0].value, ==, "9/0");
  g_assert_cmpstr(value_of(flow, 0, "note")->field.text, ==, "${a}: # \"x\"");
  g_assert_cmpint(value_of(flow, 0, "word")->field.flag, ==, 2);
  g_assert_cmpstr(value_of(flow, 0, "input")->field.text, ==, "in.txt");
  g_assert_cmpint(value_of(flow, 0, "flag")->field.flag, ==, 1);
  g_assert_true(value_of(flow, 0, "anchor.pitch")->field.real == 300);
  g_assert_true(value_of(flow, 0, "anchor.line")->field.real == 65);
  g_assert_cmpuint(value_of(flow, 0, "anchor.pitch")->given, ==, 1);
  g_assert_cmpuint(value_of(flow, 0, "anchor.line")->given, ==, 0);
  g_assert_cmpuint(value_of(flow, 0, "model")->present, ==, FALSE);
}

static const char simple[] =
    "opcflow: 1\nsteps:\n  abc: { use: test.numbers, size: 1 nm }\n";

static void test_sets(void) {
  const char *const sets[] = {"abc.size=2 nm", "abc.anchor.line=70 nm",
                              "abc.size=3 nm", "abc.names={ poly: 1 }", NULL};
  g_autoptr(opc_flow) flow = load_good(simple, sets);
  g_assert_true(value_of(flow, 0, "size")->field.real == 3);
  g_assert_true(value_of(flow, 0, "anchor.line")->field.real == 70);
  g_assert_true(value_of(flow, 0, "anchor.pitch")->field.real == 250);
  g_assert_cmpuint(value_of(flow, 0, "names")->field.map.count, ==, 1);
}

static void test_wrong_sets(void) {
  const char *const sets[] = {"acb.size=2 nm", "abc.siez=2 nm",
                              "abc.word=",     "abc=1",
                              "abc.size",      "abc.size=2",
                              "abc.list=[",    "abc.plain.x=1",
                              "abc.\xe7=1",    NULL};
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow = load_with(simple, -1, sets, problems);
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpstr(
      found, ==,
      "--set acb.size: unknown step 'acb', did you mean 'abc'?\n--set "
      "abc.word: has no value\n"
      "--set abc: expected the form "
      "'step.parameter=value'\n"
      "--set abc.size: expected the form "
      "'step.parameter=value'\n"
      "--set abc.size: 'size' requires a length with a "
      "unit, e.g. '2 nm'\n"
      "--set abc.list: not YAML: did not find expected node "
      "content while parsing a flow node\n"
      "--set abc.\\xe7: the name is not "
      "UTF-8 text\n"
      "--set abc.siez: unknown parameter 'siez' of 'test.numbers', "
      "did you mean 'size'?\n"
      "--set abc.plain.x: 'plain' requires a number, found a "
      "map");
}

/* ---- the resolved flow ---- */

static void test_resolved(void) {
  g_assert_true(g_file_set_contents("in.txt", "x", 1, NULL));
  const char *const sets[] = {"a.share=1%", NULL};
  g_autoptr(opc_flow) flow = load_good(
      "opcflow: 1\nname: some-flow\ndescription: \"a: \\t\xC3\xA9 # b\"\n"
      "steps:\n"
      "  b: { use: test.numbers, size: 2 nm, add: ${a} }\n"
      "  a:\n    use: test.numbers\n    size: 0.065 um\n"
      "    list: [1 nm, 0.003 um]\n    names: { poly: '9: x' }\n"
      "    note: \"line\\nbreak \\\\ ~ [\"\n    input: in.txt\n",
      sets);
  g_autofree char *text = opc_flow_resolved(flow, NULL);
  g_assert_nonnull(strstr(
      text, "    share: 1%                               # --set a.share\n"));
  g_assert_nonnull(strstr(
      text, "    size: 0.065 um                          # flow.yaml:8:11\n"));
  g_assert_nonnull(
      strstr(text, "    whole: 1                                # default\n"));
  /* The resolved flow is read from another folder: the values are equal, and so
     is the text except for places. */
  g_assert_cmpint(g_mkdir("other", 0777), ==, 0);
  g_assert_true(g_file_set_contents("other/flow.yaml", text, -1, NULL));
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) again =
      opc_flow_load("other/flow.yaml", NULL, registry(), problems);
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpstr(found, ==, "");
  g_assert_cmpstr(again->recipe->description, ==, flow->recipe->description);
  g_assert_cmpstr(value_of(again, 1, "note")->field.text, ==,
                  "line\nbreak \\ ~ [");
  g_assert_cmpstr(value_of(again, 1, "names")->field.map.pairs[0].value, ==,
                  "9: x");
  g_assert_true(value_of(again, 1, "list")->field.reals.values[1] == 3);
  g_autofree char *second = opc_flow_resolved(again, NULL);
  g_autoptr(GRegex) comment = g_regex_new(" +#.*", 0, 0, NULL);
  g_autofree char *bare =
      g_regex_replace_literal(comment, text, -1, 0, "", 0, NULL);
  g_autofree char *bare_second =
      g_regex_replace_literal(comment, second, -1, 0, "", 0, NULL);
  g_assert_cmpstr(bare, ==, bare_second);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_assert_cmpint(g_chdir(folder), ==, 0);
  g_test_add_func("/flow/not-yaml", test_not_yaml);
  g_test_add_func("/flow/head", test_head);
  g_test_add_func("/flow/steps", test_steps);
  g_test_add_func("/flow/parameters", test_parameters);
  g_test_add_func("/flow/numbers", test_numbers);
  g_test_add_func("/flow/slots", test_slots);
  g_test_add_func("/flow/references", test_references);
  g_test_add_func("/flow/circles", test_circles);
  g_test_add_func("/flow/order", test_order);
  g_test_add_func("/flow/values", test_values);
  g_test_add_func("/flow/sets", test_sets);
  g_test_add_func("/flow/wrong-sets", test_wrong_sets);
  g_test_add_func("/flow/resolved", test_resolved);
  int failed = g_test_run();
  g_assert_cmpint(g_chdir("/"), ==, 0);
  opc_remove_tree(folder);
  g_free(folder);
  opc_registry_free(registry());
  return failed;
}
