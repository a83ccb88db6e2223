/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow compare on synthetic run folders with known differences. */
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

#include "tests/command.h"
#include "tests/run_folder.h"

/* ---- run folders ---- */

/* Create a run whose step 'out' wrote a mask of CIF boxes. The table of costs
   has the given number of shots. */
static void make_mask(const char *run, const char *boxes, int shots) {
  g_autofree char *cif =
      g_strdup_printf("DS 1 1 10;%sDF;C 1;E\n", boxes); /* in nm */
  write_text("mask.cif", cif);
  write_text("mask.yaml",
             "opcflow: 1\nname: mask\nsteps:\n"
             "  layout: { use: read.cif, file: mask.cif }\n"
             "  out: { use: write.gds, layout: ${layout}, file: mask.gds,\n"
             "    layers: { A: 9/0, B: 1/0 } }\n");
  g_assert_cmpint(opcflow_call("run mask.yaml --output written --force"), ==,
                  0);
  make_run(
      &(made_run){.folder = run,
                  .files = "{ \"path\" : \"mask.gds\", \"sha256\" : \"cc\" }"});
  g_autofree char *to = g_build_filename(run, "mask.gds", NULL);
  g_assert_cmpint(g_rename("written/mask.gds", to), ==, 0);
  g_autofree char *name = g_build_filename(run, "flow.yaml", NULL);
  g_autofree char *flow = read_text(name);
  g_autofree char *more = g_strconcat(
      flow,
      "  out:\n    use: write.gds\n    mask: ${mask}\n    file: mask.gds\n"
      "    layers:\n      poly: 9/0\n",
      NULL);
  put_file(run, "flow.yaml", more);
  g_autofree char *cost = g_strdup_printf(
      "layer,figures,shots\r\nactive,1,5\r\npoly,2,%d\r\n", shots);
  put_file(run, "cost.csv", cost);
}

/* ---- output of the command ---- */

static JsonParser *parser;

/* Run with --json and return the exit code. */
static int runs_compare(const char *line) {
  g_autofree char *whole = g_strconcat("compare --json ", line, NULL);
  int code = opcflow_call(whole);
  g_clear_object(&parser);
  parser = json_parser_new();
  g_assert_true(json_parser_load_from_data(parser, out, -1, NULL));
  return code;
}

static JsonObject *table_of(const char *name) {
  JsonObject *all = json_node_get_object(json_parser_get_root(parser));
  JsonArray *tables = json_object_get_array_member(all, "tables");
  for (guint i = 0; i < json_array_get_length(tables); i++) {
    JsonObject *t = json_array_get_object_element(tables, i);
    if (!strcmp(json_object_get_string_member(t, "name"), name)) return t;
  }
  return NULL;
}

static guint rows_of(const char *table) {
  JsonObject *t = table_of(table);
  return t ? json_array_get_length(json_object_get_array_member(t, "rows")) : 0;
}

/* Return a cell of a table. */
static JsonNode *cell(const char *table, guint row, const char *column) {
  JsonObject *t = table_of(table);
  JsonArray *columns = json_object_get_array_member(t, "columns");
  JsonArray *rows = json_object_get_array_member(t, "rows");
  for (guint i = 0; i < json_array_get_length(columns); i++) {
    JsonObject *c = json_array_get_object_element(columns, i);
    if (!strcmp(json_object_get_string_member(c, "name"), column))
      return json_array_get_element(json_array_get_array_element(rows, row), i);
  }
  g_error("no column '%s' in '%s'", column, table);
}

static const char *text(const char *table, guint row, const char *column) {
  return json_node_get_string(cell(table, row, column));
}

static double number(const char *table, guint row, const char *column) {
  JsonNode *node = cell(table, row, column);
  return JSON_NODE_HOLDS_NULL(node) ? NAN : json_node_get_double(node);
}

/* Return the row of a metric for the run or method `who`. */
static guint row_of(const char *table, const char *column, const char *who,
                    const char *metric) {
  for (guint i = 0; i < rows_of(table); i++)
    if (!strcmp(text(table, i, "metric"), metric) &&
        (!who || !strcmp(text(table, i, column), who)))
      return i;
  g_error("no row '%s'", metric);
}

static const char *verdict(const char *metric) {
  return text("metrics", row_of("metrics", NULL, NULL, metric), "verdict");
}

/* ---- tests ---- */

static void test_verdicts(void) {
  make_run(
      &(made_run){
          .folder = "a",
          .metrics = "{ \"mask\" : { " RUN_METRIC("low", "1.0", "lower", "0.1") ", " RUN_METRIC(
              "high", "1.0", "higher",
              "0.1") ", " RUN_METRIC("near", "1.0", "lower",
                                     "0.1") ", " RUN_METRIC("free", "1.0",
                                                            "neutral",
                                                            "0.0") ","
                                                                   " " RUN_METRIC(
                                                                       "same",
                                                                       "1.0",
                                                                       "lower",
                                                                       "0.0") ", " RUN_METRIC("gone",
                                                                                              "1.0",
                                                                                              "lower",
                                                                                              "0.0") " } }"});
  make_run(
      &(made_run){
          .folder = "b",
          .target = "full",
          .metrics = "{ \"mask\" : { " RUN_METRIC("low", "1.25", "lower", "0.1") ", " RUN_METRIC(
              "high", "1.25", "higher",
              "0.1") ", " RUN_METRIC("near", "1.0625", "lower",
                                     "0.1") ", " RUN_METRIC("free", "2.0",
                                                            "neutral",
                                                            "0.0") ","
                                                                   " " RUN_METRIC(
                                                                       "same",
                                                                       "1.0",
                                                                       "lower",
                                                                       "0.0") ", " RUN_METRIC("new",
                                                                                              "1.0",
                                                                                              "lower",
                                                                                              "0.0") " } }"});
  g_assert_cmpint(runs_compare("a b --all"), ==, 0);
  g_assert_cmpstr(verdict("mask.low"), ==, "worse");
  g_assert_cmpstr(verdict("mask.high"), ==, "better");
  g_assert_cmpstr(verdict("mask.near"), ==, "same");
  g_assert_cmpstr(verdict("mask.free"), ==, "differs");
  g_assert_cmpstr(verdict("mask.same"), ==, "same");
  g_assert_cmpstr(verdict("mask.gone"), ==, "missing");
  g_assert_cmpstr(verdict("mask.new"), ==, "missing");
  guint low = row_of("metrics", NULL, NULL, "mask.low");
  g_assert_cmpfloat(number("metrics", low, "base"), ==, 1);
  g_assert_cmpfloat(number("metrics", low, "value"), ==, 1.25);
  g_assert_cmpfloat(number("metrics", low, "change"), ==, 0.25);
  /* By default, only differences are listed. */
  g_assert_cmpuint(rows_of("metrics"), ==, 7);
  runs_compare("a b");
  g_assert_cmpuint(rows_of("metrics"), ==, 6);
  runs_compare("b a --metrics low,same --sort verdict");
  g_assert_cmpuint(rows_of("metrics"), ==, 2);
  g_assert_cmpstr(verdict("mask.low"), ==, "better");
  runs_compare("a b --metrics mask.* --sort verdict");
  g_assert_cmpstr(text("metrics", 0, "metric"), ==, "mask.low");
  runs_compare("a b --sort name");
  g_assert_cmpstr(text("metrics", 0, "metric"), ==, "mask.free");
  runs_compare("a b --metrics low,free --sort change");
  g_assert_cmpstr(text("metrics", 0, "metric"), ==, "mask.free");
  g_assert_cmpuint(rows_of("parameters"), ==, 1);
  g_assert_cmpstr(text("parameters", 0, "parameter"), ==,
                  "mask.synthesizer.target");
  g_assert_cmpstr(text("parameters", 0, "value"), ==, "full");
}

static void test_exit(void) {
  static const struct {
    const char *line;
    int code;
    const char *message;
  } cases[] = {
      {"compare a b --fail-on worse", 1,
       "error: worse: b: mask.low; b: mask.gone is missing\n"},
      {"compare a b --fail-on worse:mask.low", 1, "worse: b: mask.low"},
      {"compare a b --fail-on worse:high --fail-on worse:low", 1, "mask.low"},
      {"compare a b --fail-on worse:high", 0, ""},
      {"compare b a --fail-on worse:low", 0, ""},
      {"compare b a --fail-on worse", 1, "mask.high"},
      {"compare a b --fail-on worse:lwo", 2, "metric does not exist"},
      {"compare a b --fail-on worse:gone", 1, "b: mask.gone is missing"},
      {"compare b a --fail-on worse:gone", 0, ""},
      {"compare a b --fail-on=", 2, "'' must be 'worse' or"},
      {"compare a b --fail-on better", 2, "'better' must be 'worse' or"},
      {"compare a b --metrics mask.lwo", 2, "did you mean 'mask.low'?"},
      {"compare a", 2, "expected two or more runs"},
      {"compare a a", 0, ""}, /* tables without rows */
      {"compare a nowhere", 5, "'nowhere': no such run folder"},
      {"compare a b --table mask", 2, "table 'mask' does not exist"},
      {"compare a b --variant x", 2,
       "'--variant' requires exactly one flow file"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_test_message("%s", cases[i].line);
    g_assert_cmpint(opcflow_call(cases[i].line), ==, cases[i].code);
    if (!strstr(err, cases[i].message)) g_error("%s", err);
  }
}

static void test_forms(void) {
  opcflow_call("compare a b --metrics low --table metrics --csv");
  g_assert_cmpstr(out, ==,
                  "metric,unit,base,value,change,verdict,tolerance,better\n"
                  "mask.low,%,1,1.25,0.25,worse,0.1,lower\n");
  opcflow_call("compare a b --metrics low --table metrics --markdown");
  g_assert_nonnull(strstr(
      out, "\n| mask.low | % | 1 | 1.25 | 0.25 | worse | 0.1 | lower |\n"));
  opcflow_call("compare a b --metrics low --table metrics");
  g_assert_nonnull(
      strstr(out, "mask.low  %        1   1.25    0.25  worse          0.1  "));
}

/* Incomparable runs are refused with the reasons, and compared with
   --anyway. */
/* Poly has two boxes, of which one moves and one is removed. Active is equal in
   both masks and not listed. */
static void test_masks(void) {
#define SAME "L A;B 1000 200 0 0;L B;B 400 400 0 1000;"
  make_mask("mask1", SAME "L A;B 200 100 0 -400;B 60 50 0 -900;", 7);
  make_mask("mask2", SAME "L A;B 200 100 50 -400;", 6);
  g_assert_cmpint(runs_compare("mask1 mask2"), ==, 0);
  g_assert_cmpuint(rows_of("masks"), ==, 1);
  g_assert_cmpstr(text("masks", 0, "layer"), ==, "poly");
  g_assert_cmpfloat_with_epsilon(number("masks", 0, "area_base"), 0.223, 1e-9);
  g_assert_cmpfloat_with_epsilon(number("masks", 0, "area"), 0.22, 1e-9);
  g_assert_cmpfloat_with_epsilon(number("masks", 0, "differs"), 0.013, 1e-9);
  g_assert_cmpint(json_node_get_int(cell("masks", 0, "places")), ==, 3);
  g_assert_cmpfloat(number("masks", 0, "shots_base"), ==, 7);
  g_assert_cmpfloat(number("masks", 0, "shots"), ==, 6);
  g_assert_cmpint(runs_compare("mask1 mask2 --all"), ==, 0);
  g_assert_cmpuint(rows_of("masks"), ==, 2);
  g_assert_cmpint(runs_compare("mask1 mask1"), ==, 0);
  g_assert_cmpuint(rows_of("masks"), ==, 0);
}

static void test_refusals(void) {
  static const struct {
    made_run other;
    const char *message;
  } cases[] = {
      {{.layout = "bb"}, "layout.file differs in content (aa, bb)"},
      {{.na = "0.85"}, "mask.litho.na is 0.75 and 0.85"},
      {{.gates = "a:1,n,65,100,1,1\r\na:3,n,65,100,1,1\r\n"},
       "only the base has a transistor 'a:2'"},
      {{.gates = "a:1,n,65,100,1,1\r\na:2,n,65,130,1,1\r\n"},
       "transistor 'a:2' is drawn differently"},
      {{.gates = "a:2,n,65,100,1,1\r\na:1,n,65,100,1,1\r\na:3,n,65,100,1,1"
                 "\r\n"},
       "the runs have 2 and 3 transistors"},
      {{.more = "\"failure\" : \"no light\","}, "'other' failed: no light"},
  };
  g_autofree char *gates =
      g_strconcat(gates_head, "a:1,n,65,100,1,1\r\na:2,n,65,100,1,1\r\n", NULL);
  make_run(&(made_run){.folder = "base", .gates = gates});
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    made_run m = cases[i].other;
    g_autofree char *its =
        m.gates ? g_strconcat(gates_head, m.gates, NULL) : g_strdup(gates);
    m.folder = "other";
    m.gates = its;
    make_run(&m);
    g_test_message("%s", cases[i].message);
    g_assert_cmpint(opcflow_call("compare base other"), ==, 2);
    g_assert_nonnull(strstr(err, "not comparable: other: "));
    if (!strstr(err, cases[i].message)) g_error("%s", err);
    g_assert_cmpstr(out, ==, "");
    g_assert_cmpint(opcflow_call("compare base other --anyway"), ==, 0);
    if (!strstr(err, cases[i].message)) g_error("%s", err);
  }
  make_run(&(made_run){.folder = "other", .more = "\"points\" : 3,"});
  g_assert_cmpint(opcflow_call("compare base other --anyway"), ==, 2);
  g_assert_nonnull(strstr(err, "is a sweep of 3 points"));
  /* A different target of the same plugin is comparable. */
  make_run(&(made_run){.folder = "other", .target = "full"});
  g_assert_cmpint(opcflow_call("compare base other"), ==, 0);
}

/* Transistors are paired by name, in any order, and compared by absolute
   deviation. Transistors that do not print in one of the runs are excluded. */
static void test_transistors(void) {
  g_autofree char *a =
      g_strconcat(gates_head,
                  "p,n,65,100,1,-8\r\nq,n,65,100,-2,8\r\nr,n,65,100,3,8\r\n"
                  "s,n,65,100,,8\r\n",
                  NULL);
  g_autofree char *b =
      g_strconcat(gates_head,
                  "s,n,65,100,4,8\r\nr,n,65,100,-1,8\r\nq,n,65,100,2,8\r\n"
                  "p,n,65,100,-0.5,8\r\n",
                  NULL);
  make_run(&(made_run){.folder = "x", .gates = a});
  make_run(&(made_run){.folder = "y", .gates = b});
  g_assert_cmpint(runs_compare("x y"), ==, 0);
  g_assert_cmpuint(rows_of("transistors"), ==, 2);
  g_assert_cmpstr(text("transistors", 0, "figure"), ==, "ion");
  g_assert_cmpfloat(number("transistors", 0, "transistors"), ==, 3);
  g_assert_cmpfloat_with_epsilon(number("transistors", 0, "base"), 2, 1e-12);
  g_assert_cmpfloat_with_epsilon(number("transistors", 0, "change"), -2.5 / 3,
                                 1e-12);
  g_assert_cmpfloat(number("transistors", 0, "better"), ==, 2);
  g_assert_cmpfloat(number("transistors", 0, "worse"), ==, 0);
  g_assert_cmpfloat(number("transistors", 0, "same"), ==, 1);
  g_assert_cmpfloat(number("transistors", 0, "cells"), ==, 3);
  g_assert_cmpstr(text("transistors", 0, "verdict"), ==, "too few");
  g_assert_cmpstr(text("transistors", 1, "verdict"), ==, "same");
}

/* Two and more variants of a flow; the latest run of each is used. */
static void test_variants(void) {
  write_text("demo.yaml", "opcflow: 1\nname: demo # its name\n");
  make_run(&(made_run){.folder = "runs/demo", .metrics = RUN_ION("4.0")});
  make_run(&(made_run){.folder = "runs/demo-2",
                       .metrics = RUN_ION("3.0"),
                       .started = "2026-01-03T00:00:00Z"});
  make_run(&(made_run){.folder = "runs/demo-fast",
                       .metrics = RUN_ION("2.0"),
                       .variant = "fast"});
  g_assert_cmpint(runs_compare("demo.yaml --variant base --variant fast"), ==,
                  0);
  g_assert_cmpuint(rows_of("metrics"), ==, 1);
  g_assert_cmpfloat(number("metrics", 0, "base"), ==, 3);
  g_assert_cmpfloat(number("metrics", 0, "value"), ==, 2);
  g_assert_cmpint(
      opcflow_call("compare demo.yaml --variant fast --variant slow"), ==, 2);
  g_assert_nonnull(strstr(err, "'opcflow run demo.yaml --variant slow'"));
  runs_compare("runs/demo runs/demo-2 runs/demo-fast");
  g_assert_cmpuint(rows_of("metrics"), ==, 2);
  g_assert_cmpfloat(
      number("metrics", row_of("metrics", "run", "demo-fast", "mask.ion"),
             "change"),
      ==, -2);
}

/* ---- experiments ---- */

/* Return metrics with this value of Ion. */
static char *ion_metrics(const char *value) {
  g_autoptr(GString) text = g_string_new(RUN_ION("@"));
  g_string_replace(text, "@", value, 0);
  return g_strdup(text->str);
}

/* Create an experiment of two methods on three cases. The third case fails with
   the second method. Metrics are 1 unless given. */
static void make_experiment(const char *name, const char *nand,
                            const char *nor) {
  static const char *const cases[] = {"nand", "nor", "inv"};
  g_autoptr(GString) table =
      g_string_new("case,method,folder,result,seconds (s),mask.ion (%)\r\n");
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 2; k++) {
      const char *ion = !k || i == 2 ? "1.0" : i ? nor : nand;
      g_autofree char *its =
          g_strdup_printf("cmp/%s/%s", cases[i], k ? "pb" : "epe");
      g_autofree char *run = g_build_filename(name, its, NULL);
      g_autofree char *metrics = ion_metrics(ion);
      int failed = i == 2 && k;
      if (!failed)
        make_run(&(made_run){.folder = run,
                             .metrics = metrics,
                             .layout = cases[i],
                             .target = k ? "full" : NULL});
      g_string_append_printf(table, "%s,%s,%s,%s,1.5,%s\r\n", cases[i],
                             k ? "pb" : "epe", failed ? "" : its,
                             failed ? "no light" : "good", failed ? "" : ion);
    }
  put_file(name, "experiment.csv", table->str);
}

static void test_experiment(void) {
  make_experiment("one", "0.5", "1.25");
  g_assert_cmpint(runs_compare("one"), ==, 0);
  g_assert_cmpuint(rows_of("cases"), ==, 1);
  g_assert_cmpstr(text("cases", 0, "method"), ==, "pb");
  g_assert_cmpfloat(number("cases", 0, "cases"), ==, 2);
  g_assert_cmpfloat(number("cases", 0, "wins"), ==, 1);
  g_assert_cmpfloat(number("cases", 0, "losses"), ==, 1);
  g_assert_cmpfloat(number("cases", 0, "ties"), ==, 0);
  g_assert_cmpfloat_with_epsilon(number("cases", 0, "change"), -0.125, 1e-12);
  g_assert_nonnull(strstr(err, "inv, pb: left out: no light"));
  g_assert_null(table_of("metrics"));
  runs_compare("one --cases");
  g_assert_cmpuint(rows_of("metrics"), ==, 2);
  g_assert_cmpstr(text("metrics", 0, "case"), ==, "nand");
  g_assert_cmpint(opcflow_call("compare one --fail-on worse"), ==, 1);
  g_assert_nonnull(strstr(err, "worse: nor, pb: mask.ion\n"));
  make_experiment("one", "0.5", "1.0625"); /* within the tolerance */
  runs_compare("one");
  g_assert_cmpfloat(number("cases", 0, "ties"), ==, 1);
}

static int count_of(const char *text, const char *word) {
  int n = 0;
  while ((text = strstr(text, word))) n++, text += strlen(word);
  return n;
}

/* A failed base run is reported once for all methods; parameters of many
   methods are printed on request. */
static void test_many_methods(void) {
  static const char *const methods[] = {"epe", "a", "b", "c"};
  g_autoptr(GString) table =
      g_string_new("case,method,folder,result,seconds (s),mask.ion (%)\r\n");
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 4; k++) {
      const char *name = i ? "inv" : "nand";
      g_autofree char *its = g_strdup_printf("cmp/%s/%s", name, methods[k]);
      g_autofree char *run = g_build_filename("many", its, NULL);
      int failed = i && !k;
      if (!failed)
        make_run(&(made_run){.folder = run,
                             .metrics = RUN_ION("1.0"),
                             .layout = name,
                             .target = k ? "full" : NULL});
      g_string_append_printf(table, "%s,%s,%s,%s,1.5,%s\r\n", name, methods[k],
                             failed ? "" : its, failed ? "no light" : "good",
                             failed ? "" : "1.0");
    }
  put_file("many", "experiment.csv", table->str);
  g_assert_cmpint(opcflow_call("compare many"), ==, 0);
  g_assert_cmpint(count_of(err, "inv, epe: left out: no light"), ==, 1);
  g_assert_null(strstr(out, "parameters\n"));
  g_assert_cmpint(opcflow_call("compare many --table parameters"), ==, 0);
  g_assert_cmpint(count_of(out, "full"), ==, 3);
}

/* Two experiments are compared by case and method. */
static void test_experiments(void) {
  make_experiment("one", "0.5", "1.0");
  make_experiment("two", "2.0", "0.25");
  g_assert_cmpint(runs_compare("one two"), ==, 0);
  g_assert_cmpuint(rows_of("cases"), ==, 1);
  g_assert_cmpstr(text("cases", 0, "method"), ==, "pb");
  g_assert_cmpfloat(number("cases", 0, "wins"), ==, 1);
  g_assert_cmpfloat(number("cases", 0, "losses"), ==, 1);
  g_assert_cmpfloat_with_epsilon(number("cases", 0, "base"), 0.75, 1e-12);
  g_assert_cmpfloat_with_epsilon(number("cases", 0, "value"), 1.125, 1e-12);
  runs_compare("one two --all");
  g_assert_cmpuint(rows_of("cases"), ==, 2);
  g_assert_cmpint(opcflow_call("compare one a"), ==, 2);
  g_assert_nonnull(strstr(err, "an experiment can be compared with another"));
  g_assert_cmpint(opcflow_call("compare one two one"), ==, 2);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  command = g_build_filename(g_getenv("OPCFLOW_BUILD"), "opcflow", NULL);
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_assert_false(g_chdir(folder));
  g_test_add_func("/compare/verdicts", test_verdicts);
  g_test_add_func("/compare/exit", test_exit);
  g_test_add_func("/compare/forms", test_forms);
  g_test_add_func("/compare/masks", test_masks);
  g_test_add_func("/compare/refusals", test_refusals);
  g_test_add_func("/compare/transistors", test_transistors);
  g_test_add_func("/compare/variants", test_variants);
  g_test_add_func("/compare/experiment", test_experiment);
  g_test_add_func("/compare/many-methods", test_many_methods);
  g_test_add_func("/compare/experiments", test_experiments);
  int failed = g_test_run();
  g_assert_true(!g_chdir("/") && opc_remove_tree(folder));
  g_clear_object(&parser);
  return failed;
}
