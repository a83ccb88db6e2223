/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the step `experiment` by the command: comparison of each run with a
   separate run, expansion of lists, patterns and files, and rejected flows. */
#include <string.h>

#include "tests/flow.h"

/* ---- help ---- */

/* Copy a cell under another name. */
static void copy_cell(const char *cell, const char *name) {
  g_autofree char *path = g_strdup_printf("%s/data/cells65/%s.cif",
                                          g_getenv("OPCFLOW_SOURCE"), cell);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  write_file(name, text);
}

/* The inner flow: light steps, one of which writes a file. */
static const char inner[] =
    "opcflow: 1\nname: inner\nsteps:\n"
    "  layout: { use: read.cif, file: cells/nand2.cif, layers: { poly: CP, "
    "active: CA, nwell: CW } }\n"
    "  gates: { use: segment.transistors, layout: ${layout}, grid: 1 nm }\n"
    "  cif: { use: write.cif, layout: ${layout}, file: out.cif }\n"
    "variants:\n  coarse: { gates.grid: 5 nm }\n";

#define HEAD                                                     \
  "opcflow: 1\nname: outer\nsteps:\n  e:\n    use: experiment\n" \
  "    flow: inner.yaml\n"
#define METHODS "    methods: { fine: base, coarse: coarse }\n"
#define CASES \
  "    cases: [{ layout.file: [cells/nand2.cif, cells/nor2.cif] }]\n"

/* Check a flow: the exit code must be an error, and the messages must contain
   all of `words`. */
static void assert_flow(const char *flow, const char *words) {
  g_autofree char *errors = NULL;
  write_file("bad.yaml", flow);
  g_assert_cmpint(opcflow(&errors, "check", "--quick", "bad.yaml", NULL), !=,
                  0);
  if (!strstr(errors, words)) g_error("'%s' does not say '%s'", errors, words);
}

/* Run a flow and check the names of the cases, in the order of the table. */
static void expect_cases(const char *cases, const char *names) {
  g_autofree char *errors = NULL;
  g_autofree char *flow = g_strconcat(HEAD METHODS, cases, NULL);
  write_file("good.yaml", flow);
  int code =
      opcflow(&errors, "run", "good.yaml", "--output", "good", "--force", NULL);
  if (code) g_error("exit code %d: %s", code, errors);
  g_autofree char *csv = read_file("good", "experiment.csv");
  g_auto(GStrv) lines = g_strsplit(csv, "\r\n", -1);
  g_autoptr(GString) found = g_string_new(NULL);
  for (guint i = 1; lines[i] && *lines[i]; i += 2) {
    g_autofree char *name = g_strndup(lines[i], strcspn(lines[i], ","));
    g_string_append_printf(found, "%s ", name);
  }
  g_assert_cmpstr(found->str, ==, names);
}

static JsonObject *read_json(const char *run, const char *name,
                             JsonParser *parser) {
  g_autofree char *text = read_file(run, name);
  g_assert_true(json_parser_load_from_data(parser, text, -1, NULL));
  return json_node_get_object(json_parser_get_root(parser));
}

/* ---- runs ---- */

static void run_outer(void) {
  static gboolean done;
  g_autofree char *errors = NULL;
  if (done) return;
  write_file("outer.yaml", HEAD METHODS CASES);
  int code = opcflow(&errors, "run", "outer.yaml", "--output", "outer", NULL);
  if (code) g_error("exit code %d: %s", code, errors);
  done = TRUE;
}

/* Each run is byte-identical to a separate run of the resolved flow of that
   run. */
static void test_alone(void) {
  static const char *const runs[] = {"nand2/fine", "nand2/coarse", "nor2/fine",
                                     "nor2/coarse"};
  run_outer();
  for (guint i = 0; i < G_N_ELEMENTS(runs); i++) {
    g_autofree char *errors = NULL;
    g_autofree char *run = g_strdup_printf("outer/e/%s", runs[i]);
    g_autofree char *flow = g_strdup_printf("%s/flow.yaml", run);
    g_assert_cmpint(
        opcflow(&errors, "run", flow, "--output", "alone", "--force", NULL), ==,
        0);
    expect_equal(run, "alone", "metrics.json");
    expect_equal(run, "alone", "out.cif");
    g_autoptr(JsonParser) parser = json_parser_new();
    JsonObject *o = read_json(run, "manifest.json", parser);
    g_assert_cmpstr(json_object_get_string_member(o, "result"), ==, "complete");
    g_assert_cmpuint(
        json_array_get_length(json_object_get_array_member(o, "inputs")), ==,
        2);
    g_assert_cmpuint(
        json_array_get_length(json_object_get_array_member(o, "plugins")), ==,
        3);
  }
}

static void test_table(void) {
  run_outer();
  g_autofree char *csv = read_file("outer", "experiment.csv");
  g_auto(GStrv) lines = g_strsplit(csv, "\r\n", -1);
  g_assert_true(
      g_str_has_prefix(lines[0], "case,method,folder,result,seconds,"));
  g_assert_true(strstr(lines[0], "gates.snapped_worst (nm)"));
  g_assert_true(g_str_has_prefix(lines[1], "nand2,fine,e/nand2/fine,good,"));
  g_assert_true(g_str_has_prefix(lines[4], "nor2,coarse,e/nor2/coarse,good,"));
  g_assert_cmpuint(g_strv_length(lines), ==, 6);
}

/* Steps that depend only on the case run once for all methods, so that the run
   times are equal. */
static void test_sharing(void) {
  static const char *const cases[] = {"nand2", "nor2"};
  run_outer();
  for (guint i = 0; i < 2; i++) {
    double seconds[2][2];
    for (guint k = 0; k < 2; k++) {
      g_autoptr(JsonParser) parser = json_parser_new();
      g_autofree char *run =
          g_strdup_printf("outer/e/%s/%s", cases[i], k ? "coarse" : "fine");
      JsonObject *o = read_json(run, "manifest.json", parser);
      o = json_object_get_object_member(o, "steps");
      seconds[k][0] = json_object_get_double_member(o, "layout");
      seconds[k][1] = json_object_get_double_member(o, "cif");
    }
    g_assert_cmpfloat(seconds[0][0], ==, seconds[1][0]);
    g_assert_cmpfloat(seconds[0][1], ==, seconds[1][1]);
  }
}

/* A failed run is reported once with the reason, and counted in the summary.
   The other runs continue. The exit code is that of a sweep with a failed
   point. */
static void test_failing(void) {
  g_autofree char *errors = NULL;
  write_file(
      "fails.yaml", HEAD METHODS
      "    cases: [{ layout.file: [cells/nmos.cif, cells/nor2.cif] }]\n");
  g_assert_cmpint(
      opcflow(&errors, "run", "fails.yaml", "--output", "fails", NULL), ==, 4);
  g_assert_true(strstr(errors, "warning: e: nmos by coarse failed: "));
  const char *reported = strstr(errors, "nmos by coarse failed");
  g_assert_null(strstr(reported + 1, "nmos by coarse failed"));
  g_assert_true(strstr(errors, "no layer CW for 'nwell'"));
  g_assert_true(
      strstr(errors, "finding: e: 2 of 4 runs failed: see 'result' in "));
  g_autofree char *csv = read_file("fails", "experiment.csv");
  g_assert_true(strstr(csv, "nmos,fine,,"));
  g_assert_true(strstr(csv, "nor2,fine,e/nor2/fine,good,"));
  g_autofree char *gone = g_build_filename(folder, "fails/e/nmos", NULL);
  g_autoptr(GDir) left = g_dir_open(gone, 0, NULL);
  g_assert_true(!left || !g_dir_read_name(left));
}

/* Violated requirements of the inner flow are reported by run, with exit code
   1. */
static void test_requirements(void) {
  g_autofree char *errors = NULL;
  write_file("strict.yaml",
             HEAD METHODS CASES "    set: { require.gates.transistors: 5 }\n");
  g_assert_cmpint(
      opcflow(&errors, "run", "strict.yaml", "--output", "strict", NULL), ==,
      1);
  g_assert_true(strstr(errors, "'e/nand2/fine: gates.transistors' is 4"));
  g_autofree char *metrics = read_file("strict/e/nor2/fine", "metrics.json");
  g_assert_true(strstr(metrics, "\"kept\" : false"));
}

/* ---- layers ---- */

static void test_files(void) {
  expect_cases("    cases: [{ layout.file: 'cells/n*2.cif' }]\n",
               "nand2 nor2 ");
  expect_cases("    cases: [{ layout.file: ['cells/n*.cif', '!nm*'] }]\n",
               "nand2 nor2 ");
  expect_cases(
      "    cases: [{ layout.file: cells/nand2.cif, layout.scale: [1, 2] }, { "
      "name: other, layout.file: cells/nor2.cif }]\n",
      "1 2 other ");
  /* Cases are all combinations of the lists; the last list varies fastest. */
  expect_cases(
      "    cases: [{ layout.file: 'cells/n*2.cif', layout.scale: [1, 2] }]\n",
      "nand2-1 nand2-2 nor2-1 nor2-2 ");
  /* The first text among the values is the name of the case; without a text,
     the plugin is the name. */
#define OTHER "gates: { use: segment.transistors, grid: 2 nm }"
  expect_cases("    cases: [{ " OTHER " }, { " OTHER
               ", layout.file: cells/nor2.cif }]\n",
               "transistors nor2 ");
  assert_flow(HEAD METHODS "    cases: [{ layout.file: 'cells/x*.cif' }]\n",
              "bad.yaml:8:28: no file matches 'cells/x*.cif'");
}

/* Two files per case: the text that matches the star is equal in both file
   names. */
static void test_pairs(void) {
  write_file("plain.yaml", inner);
  write_file("inner.yaml",
             "opcflow: 1\nname: inner\nextends: plain.yaml\nsteps:\n"
             "  other: { use: read.cif, file: cells/nand2.cif }\n");
  expect_cases(
      "    cases: [{ layout.file: 'cells/n*2.cif', other.file: 'more/n*2.CIF' "
      "}]\n",
      "nand2 nor2 ");
  g_autofree char *resolved = read_file("good/e/nor2/fine", "flow.yaml");
  g_assert_true(strstr(resolved, "more/nor2.CIF"));
  assert_flow(HEAD METHODS
              "    cases: [{ layout.file: 'cells/n*2.cif', other.file: "
              "'none/n*2.cif' }]\n",
              "bad.yaml:8:57: 'none/nand2.cif': no such file");
  write_file("inner.yaml", inner);
}

/* Cells of a file, as listed by the reader. */
static void test_cells(void) {
  g_autofree char *errors = NULL;
  write_file("two.cif",
             "DS 1 1 10;\n9 ALPHA;\nL CP;\nB 100 100 0 0;\nDF;\n"
             "DS 2 1 10;\n9 ALSO;\nL CP;\nB 100 100 0 0;\nDF;\n"
             "DS 3 1 10;\n9 BETA;\nL CP;\nB 100 100 0 0;\nDF;\n"
             "C 1; C 2 T 1000 0; C 3 T 2000 0;\nE\n");
  write_file("cells.yaml",
             "opcflow: 1\nname: cells\nsteps:\n"
             "  layout: { use: read.cif, file: two.cif }\n"
             "  cif: { use: write.cif, layout: ${layout}, file: out.cif }\n");
  write_file("tops.yaml",
             "opcflow: 1\nname: outer\nsteps:\n  e:\n    use: experiment\n"
             "    flow: cells.yaml\n    methods: [base]\n"
             "    cases: [{ layout.top: ['AL*', 'B*', '!ALSO'] }]\n");
  int code = opcflow(&errors, "run", "tops.yaml", "--output", "tops", NULL);
  if (code) g_error("exit code %d: %s", code, errors);
  g_autofree char *csv = read_file("tops", "experiment.csv");
  g_assert_true(strstr(csv, "\nALPHA,base,e/ALPHA/base,good,"));
  g_assert_true(strstr(csv, "\nBETA,base,"));
  g_assert_false(strstr(csv, "ALSO"));
  assert_flow(
      "opcflow: 1\nname: outer\nsteps:\n  e:\n    use: experiment\n"
      "    flow: cells.yaml\n    methods: [base]\n"
      "    cases: [{ layout.top: 'GAM*' }]\n",
      "bad.yaml:8:27: none of ");
}

static void test_lists(void) {
  write_file("lists/cases.csv",
             "name,layout.file,layout.scale\r\n"
             "\"first\",../cells/nand2.cif,1\nsecond,../cells/nor2.cif,\n");
  expect_cases("    cases: [{ list: lists/cases.csv }]\n", "first second ");
  write_file("lists/cases.yaml",
             "a: { layout.file: ../cells/nand2.cif }\n"
             "b: { layout.file: ../cells/nor2.cif }\n");
  expect_cases("    cases: [{ list: lists/cases.yaml, layout.scale: 1.0 }]\n",
               "a b ");
  assert_flow(HEAD METHODS "    cases: [{ list: none.csv }]\n",
              "bad.yaml:8:21: 'none.csv': no such file");
  write_file("lists/cases.csv", "name,layout.file\na\n");
  assert_flow(HEAD METHODS "    cases: [{ list: lists/cases.csv }]\n",
              "lists/cases.csv:2:1: 1 cells, the first line has 2");
  write_file("lists/cases.csv", "name,layout.file\n\"a,b\n");
  assert_flow(HEAD METHODS "    cases: [{ list: lists/cases.csv }]\n",
              "lists/cases.csv:2:1: unterminated quote");
}

static void test_refusals(void) {
  assert_flow(HEAD METHODS
              "    cases: [{ layout.file: cells/nand2.cif }, { layout.file: "
              "cells/nand2.cif, layout.scale: 2 }]\n",
              "two layers of 'cases' have the name 'nand2', the other one is "
              "at bad.yaml:8:13");
  assert_flow(HEAD CASES "    methods: [coarse, corse]\n",
              "bad.yaml:8:23: unknown variant 'corse', did you mean 'coarse'?");
  assert_flow(HEAD METHODS CASES "    set: { layout.file: cells/nor2.cif }\n",
              "bad.yaml:8:15: 'layout.file' is already fixed by 'set' at "
              "bad.yaml:9:12");
  assert_flow(HEAD METHODS "    cases: [{ layout.fiel: cells/nor2.cif }]\n",
              "unknown parameter 'fiel'");
  assert_flow(HEAD METHODS "    cases: []\n", "'cases' is empty");
  assert_flow(HEAD METHODS
              "    cases: [{ name: a/b, layout.file: cells/nor2.cif }]\n",
              "'a/b' cannot be the name of a folder");
  assert_flow(HEAD CASES, "required parameter 'methods'");
}

/* A former name of a parameter is accepted with a warning. Setting both names
   is an error. */
static void test_former(void) {
  g_autofree char *flow =
      g_build_filename(g_getenv("OPCFLOW_SOURCE"), "flows/newton.yaml", NULL);
  g_autofree char *err = NULL, *both = NULL;
  g_assert_cmpint(
      opcflow(&err, "run", flow, "--output", "former", "--set", "picture=~",
              "--set", "mask.max_iterations=1", "--set", "mask.seek.most=0",
              "--set",
              "mask.synthesizer={ use: synthesizer.dpb, max_pde: 3 % }", NULL),
      ==, 1); /* one iteration violates the requirement of the flow */
  g_assert_nonnull(strstr(err, "'max_pde' is now called 'ion_limit'"));
  g_assert_nonnull(strstr(err, "'seek.most' is now called 'search.most'"));
  g_autofree char *text = read_file("former", "flow.yaml");
  g_assert_nonnull(strstr(text, "ion_limit: 3 %"));
  g_assert_null(strstr(text, "max_pde"));
  g_assert_cmpint(
      opcflow(
          &both, "check", flow, "--set",
          "mask.synthesizer={ use: synthesizer.dpb, max_pde: 2 %, ion_limit: "
          "1 % }",
          NULL),
      ==, 2);
  g_assert_nonnull(strstr(both, "which is also set"));
}

int main(int argc, char **argv) {
  static const char *const cells[] = {"nand2", "nor2", "nmos"};
  g_test_init(&argc, &argv, NULL);
  begin_flows();
  write_file("inner.yaml", inner);
  for (guint i = 0; i < G_N_ELEMENTS(cells); i++) {
    g_autofree char *name = g_strdup_printf("cells/%s.cif", cells[i]);
    g_autofree char *more = g_strdup_printf("more/%s.CIF", cells[i]);
    copy_cell(cells[i], name);
    copy_cell(cells[i], more);
  }
  g_test_add_func("/experiment/alone", test_alone);
  g_test_add_func("/experiment/table", test_table);
  g_test_add_func("/experiment/sharing", test_sharing);
  g_test_add_func("/experiment/failing", test_failing);
  g_test_add_func("/experiment/requirements", test_requirements);
  g_test_add_func("/experiment/files", test_files);
  g_test_add_func("/experiment/pairs", test_pairs);
  g_test_add_func("/experiment/cells", test_cells);
  g_test_add_func("/experiment/lists", test_lists);
  g_test_add_func("/experiment/former", test_former);
  g_test_add_func("/experiment/refusals", test_refusals);
  return run_flows();
}
