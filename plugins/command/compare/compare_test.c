/* SPDX-License-Identifier: BSD-3-Clause */
/* Comparisons of synthetic run folders: verdicts by definition, paired
   differences of transistors with known intervals, and means over cases. */
#include <glib/gstdio.h>
#include <math.h>
#include <opcflow/command.h>

#include "boxes_test.h"
#include "tests/run_folder.h"
#include "tools/devel/testing.h"

static char *in_folder(const char *name) {
  return g_build_filename(opc_test_folder(), name, NULL);
}

static void folder_make(const char *name, made_run run) {
  g_autofree char *folder = in_folder(name);
  run.folder = folder;
  make_run(&run);
}

/* Compare two folders and return the code. */
static int folders_compare(const char *mapping, const char *a, const char *b,
                           opc_error *error) {
  g_autofree char *one = in_folder(a), *other = b ? in_folder(b) : NULL;
  const char *const paths[] = {one, other};
  opc_test_forget();
  *error = (opc_error){0};
  g_autoptr(opc_module) m = opc_test_module("command.compare", mapping, error);
  if (!m) return error->code;
  const opc_command *command = m->functions;
  return command->run(m->self, other ? 2 : 1, paths, error);
}

static void compare_good(const char *mapping, const char *a, const char *b) {
  opc_error error;
  if (folders_compare(mapping, a, b, &error)) g_error("%s", error.message);
}

/* Return the row of a table whose column has that text. */
static size_t row_of(const char *table, const char *column, const char *text) {
  for (size_t i = 0; i < opc_test_rows(table); i++)
    if (!strcmp(opc_test_text(table, column, i), text)) return i;
  g_error("no '%s' in '%s'", text, table);
}

/* ---- tests ---- */

/* For each direction of a metric: changes with both signs within, at and beyond
   the tolerance. */
static void test_verdicts(void) {
  static const char *const ways[] = {"lower", "higher", "neutral"};
  static const double changes[] = {-1, -0.5, -0.25, 0, 0.25, 0.5, 1};
  for (int k = 0; k < 2; k++) {
    g_autoptr(GString) text = g_string_new("{ \"mask\" : {");
    for (guint w = 0; w < 3; w++)
      for (guint i = 0; i < G_N_ELEMENTS(changes); i++)
        g_string_append_printf(
            text,
            "%s \"m%u%u\" : { \"value\" : %g, \"unit\" : \"nm\", \"better\" : "
            "\"%s\", \"tolerance\" : 0.5 }",
            w + i ? "," : "", w, i, 8 + k * changes[i], ways[w]);
    g_string_append(text, "} }");
    folder_make(k ? "b" : "a", (made_run){.metrics = text->str});
  }
  compare_good("{ all: true }", "a", "b");
  double better = 0, worse = 0, same = 0, differs = 0;
  for (guint w = 0; w < 3; w++)
    for (guint i = 0; i < G_N_ELEMENTS(changes); i++) {
      double change = changes[i];
      g_autofree char *name = g_strdup_printf("mask.m%u%u", w, i);
      size_t row = row_of("metrics", "metric", name);
      int is_same = fabs(change) <= 0.5, is_less = change < 0;
      const char *want = is_same               ? "same"
                         : w == 2              ? "differs"
                         : is_less == (w == 0) ? "better"
                                               : "worse";
      g_assert_cmpstr(opc_test_text("metrics", "verdict", row), ==, want);
      g_assert_true(opc_test_number("metrics", "change", row) == change);
      g_assert_true(opc_test_number("metrics", "value", row) == 8 + change);
      same += is_same;
      differs += !is_same && w == 2;
      better += !is_same && w < 2 && is_less == (w == 0);
      worse += !is_same && w < 2 && is_less == (w == 1);
    }
  g_assert_cmpfloat(opc_test_metric("better"), ==, better);
  g_assert_cmpfloat(opc_test_metric("worse"), ==, worse);
  g_assert_cmpfloat(opc_test_metric("same"), ==, same);
  g_assert_cmpfloat(opc_test_metric("differs"), ==, differs);
}

/* Transistors are paired by name, in any order. Ion changes by -0.5 in four
   cells of one transistor each, and by 1.5 and -0.5 in the cell e. The mean
   change of e is 0.5, so the interval over the five cells contains zero. Ioff
   does not change. Without e, there are too few cells for a verdict. */
static void test_transistors(void) {
  static const char few[] =
      "a:1,n,65,100,0.5,4\r\nb:1,n,65,100,1.5,4\r\n"
      "c:1,p,65,100,-3,4\r\nd:1,p,65,100,1,4\r\n";
  g_autofree char *base = g_strconcat(
      gates_head, "a:1,n,65,100,-1,4\r\nb:1,n,65,100,2,4\r\n",
      "c:1,p,65,100,3.5,-4\r\nd:1,p,65,100,1.5,4\r\n",
      "e:1,p,65,100,1,4\r\ne:2,p,65,100,1,4\r\n", "e:3,p,65,100,,4\r\n", NULL);
  g_autofree char *other =
      g_strconcat(gates_head, "e:3,p,65,100,1,4\r\ne:2,p,65,100,0.5,4\r\n",
                  "e:1,p,65,100,2.5,4\r\n", few, NULL);
  folder_make("a", (made_run){.gates = base});
  folder_make("b", (made_run){.gates = other});
  compare_good("{}", "a", "b");
  size_t ion = row_of("transistors", "figure", "ion");
  static const struct {
    const char *column;
    double value;
  } want[] = {{"base", 10.0 / 6}, {"change", -1.0 / 6}, {"median", -0.5},
              {"low", -0.5},      {"high", 0.5},        {"better", 5},
              {"worse", 1},       {"same", 0},          {"cells", 5}};
  for (size_t i = 0; i < G_N_ELEMENTS(want); i++)
    g_assert_cmpfloat_with_epsilon(
        opc_test_number("transistors", want[i].column, ion), want[i].value,
        1e-12);
  g_assert_cmpstr(opc_test_text("transistors", "verdict", ion), ==, "same");
  g_assert_cmpstr(opc_test_text("verdicts", "verdict", 0), ==,
                  "b is better than a in transistors that do not print by 1; "
                  "no clear difference in Ion; equal in Ioff, seconds");
  size_t ioff = row_of("transistors", "figure", "ioff");
  g_assert_cmpfloat(opc_test_number("transistors", "same", ioff), ==, 7);
  g_assert_cmpfloat(opc_test_number("transistors", "change", ioff), ==, 0);

  g_autofree char *with =
      g_strconcat(gates_head, few, "e:1,p,65,100,0.25,4", "\r\n", NULL);
  g_autofree char *before = g_strndup(base, strlen(base) - 35);
  folder_make("a", (made_run){.gates = before});
  folder_make("b", (made_run){.gates = with});
  compare_good("{}", "a", "b");
  g_assert_cmpstr(opc_test_text("transistors", "verdict", ion), ==, "better");
  g_assert_cmpstr(
      opc_test_text("verdicts", "verdict", 0), ==,
      "b is better than a in Ion by 0.5 points (95 %: 0.5 to 0.75); "
      "equal in Ioff, seconds");
  compare_good("{}", "b", "a");
  g_assert_cmpstr(
      opc_test_text("verdicts", "verdict", 0), ==,
      "b is better than a in Ion by 0.5 points (95 %: 0.5 to 0.75); "
      "equal in Ioff, seconds");
  opc_error error;
  g_assert_cmpint(folders_compare("{ fail_on: 'worse, worse:transistors.ion' }",
                                  "b", "a", &error),
                  ==, OPC_LIMIT);
  g_assert_cmpstr(error.message, ==, "worse: a: transistors.ion");
  compare_good("{ fail_on: 'worse:transistors.ion' }", "a", "b");
  compare_good("{ fail_on: 'worse:transistors.ioff' }", "b", "a");

  g_autofree char *four = g_strconcat(gates_head, few, NULL);
  g_autofree char *drawn = g_strndup(before, strlen(before) - 18);
  static const char shots[] =
      "{ \"cost\" : { \"shots\" : { \"value\" : %d, \"unit\" : null, "
      "\"better\" : \"lower\", \"tolerance\" : 0 } } }";
  g_autofree char *less = g_strdup_printf(shots, 100);
  g_autofree char *more = g_strdup_printf(shots, 116);
  folder_make("a", (made_run){.gates = drawn, .metrics = more});
  folder_make("b", (made_run){.gates = four, .metrics = less});
  compare_good("{}", "a", "b");
  g_assert_cmpstr(opc_test_text("transistors", "verdict", ion), ==, "too few");
  g_assert_true(isnan(opc_test_number("transistors", "low", ion)));
  g_assert_cmpstr(
      opc_test_text("verdicts", "verdict", 0), ==,
      "b is better than a in shots by 14 % (1 case); equal in Ioff, "
      "seconds; too few cells for Ion (4 of 5)");
}

/* Test that the times of the steps decide, not those of the runs: the steps of
   one of these runs were reused, and both runs took 1 s. */
static void test_seconds(void) {
  folder_make("slow",
              (made_run){.more = "\"steps\" : { \"x\" : 6, \"y\" : 2 },"});
  folder_make("fast",
              (made_run){.more = "\"steps\" : { \"x\" : 3, \"y\" : 1 },"});
  compare_good("{}", "slow", "fast");
  g_assert_cmpstr(opc_test_text("verdicts", "verdict", 0), ==,
                  "fast is better than slow in seconds by 50 % (1 case)");
  g_assert_cmpfloat(opc_test_number("runs", "seconds", 0), ==, 8);
  g_assert_cmpfloat(opc_test_number("runs", "seconds", 1), ==, 4);
}

static const char places_head[] =
    "transistor,cell,type,l (nm),w (nm),x (nm),y (nm),ion_after (%)";

/* Five transistors in cells c1 to c5. */
static const char one_each[] =
    "A:1,c1,n,65,100,10.0,5.0,1\r\nA:2,c2,n,65,100,20.0,5.0,-2\r\n"
    "A:3,c3,n,65,100,30.0,5.0,3\r\nA:4,c4,n,65,100,40.0,5.0,4\r\n"
    "A:5,c5,p,65,100,50.0,5.0,5\r\n";

static void expect_change(double base, double value, double better,
                          double worse, double n) {
  size_t ion = row_of("transistors", "figure", "ion");
  const double want[] = {base, value, better, worse, n};
  static const char *const columns[] = {"base", "value", "better", "worse",
                                        "transistors"};
  for (size_t i = 0; i < G_N_ELEMENTS(want); i++)
    g_assert_cmpfloat_with_epsilon(
        opc_test_number("transistors", columns[i], ion), want[i], 1e-12);
}

/* A table with a row for each class is compared with a table of transistors, in
   both orders, and with a table of equal classes; other classes are refused,
   unless a run has the file of all transistors. */
static void test_classes(void) {
  opc_error error;
  g_autofree char *flat = g_strconcat(places_head, "\r\n", one_each, NULL);
  g_autofree char *classes = g_strconcat(
      places_head, ",count\r\n", "T:1,T,n,65,100,10.0,5.0,0.5,4\r\n",
      "T:5,T,p,65,100,50.0,5.0,-6,1\r\n", NULL);
  g_autofree char *other = g_strconcat(
      places_head, ",count\r\n", "T:2,T,n,65,100,20.0,5.0,0.5,4\r\n",
      "T:5,T,p,65,100,50.0,5.0,-6,1\r\n", NULL);
  folder_make("flat", (made_run){.gates = flat});
  folder_make("classes", (made_run){.gates = classes});
  folder_make("other", (made_run){.gates = other});
  compare_good("{}", "flat", "classes");
  expect_change(9.0 / 5, 8.0 / 5, 4, 1, 5);
  compare_good("{}", "classes", "flat");
  expect_change(8.0 / 5, 9.0 / 5, 1, 4, 5);
  compare_good("{}", "classes", "classes");
  expect_change(8.0 / 5, 8.0 / 5, 0, 0, 5);
  g_assert_cmpint(folders_compare("{}", "classes", "other", &error), ==,
                  OPC_INVALID);
  if (!strstr(error.message,
              "transistor at (10.0, 5.0) nm is not in both "
              "runs: set 'transistors: all.csv'"))
    g_error("%s", error.message);
  static const char *const runs[] = {"classes", "other"};
  for (int k = 0; k < 2; k++) {
    g_autofree char *folder = in_folder(runs[k]), *text = NULL;
    g_autofree char *flow = g_build_filename(folder, "flow.yaml", NULL);
    g_autofree char *all =
        g_strconcat(places_head, "\r\n", "A:1,c1,n,65,100,10.0,5.0,",
                    k ? "3" : "9", "\r\n", strchr(one_each, '\n') + 1, NULL);
    g_assert_true(g_file_get_contents(flow, &text, NULL, NULL));
    g_autofree char *longer =
        g_strconcat(text, "    transistors: all.csv\n", NULL);
    put_file(folder, "flow.yaml", longer);
    put_file(folder, "all.csv", all);
  }
  compare_good("{}", "classes", "other");
  expect_change(23.0 / 5, 17.0 / 5, 1, 0, 5);
}

/* Ion changes by 1 and 3 with one method, by -2 and 0 with the other. */
static void test_cases(void) {
  static const char *const ions[2][2][2] = {{{"4.0", "5.0"}, {"6.0", "9.0"}},
                                            {{"4.0", "2.0"}, {"6.0", "6.0"}}};
  static const char list[] =
      "case,method,folder,result,seconds (s)\r\nA,x,A/x,good,1\r\n"
      "A,y,A/y,good,1\r\nB,x,B/x,good,1\r\nB,y,B/y,good,1\r\n";
  for (int which = 0; which < 2; which++) {
    g_autofree char *top = in_folder(which ? "e2" : "e1");
    for (int method = 0; method < 2; method++)
      for (int one = 0; one < 2; one++) {
        g_autofree char *metrics = g_strdup_printf(
            "{ \"mask\" : { \"ion\" : { \"value\" : %s, \"unit\" : \"%%\", "
            "\"better\" : \"lower\", \"tolerance\" : 0.1 } } }",
            ions[method][one][which]);
        g_autofree char *name = g_strdup_printf("%s/%c/%c", which ? "e2" : "e1",
                                                "AB"[one], "xy"[method]);
        folder_make(name, (made_run){.metrics = metrics});
      }
    put_file(top, "experiment.csv", list);
  }
  compare_good("{}", "e1", "e2");
  g_assert_cmpuint(opc_test_rows("cases"), ==, 2);
  for (int method = 0; method < 2; method++) {
    size_t row = row_of("cases", "method", method ? "y" : "x");
    g_assert_cmpfloat(opc_test_number("cases", "cases", row), ==, 2);
    g_assert_cmpfloat(opc_test_number("cases", "base", row), ==, 5);
    g_assert_cmpfloat(opc_test_number("cases", "value", row), ==,
                      method ? 4 : 7);
    g_assert_cmpfloat(opc_test_number("cases", "change", row), ==,
                      method ? -1 : 2);
    g_assert_cmpfloat(opc_test_number("cases", "wins", row), ==, method);
    g_assert_cmpfloat(opc_test_number("cases", "losses", row), ==,
                      method ? 0 : 2);
    g_assert_cmpfloat(opc_test_number("cases", "ties", row), ==, method);
  }
}

/* Failures requested by fail_on, with their messages. */
static void test_fail_on(void) {
  static const struct {
    const char *map;
    int code;
    const char *expected;
  } cases[] = {
      {"{ fail_on: worse }", OPC_LIMIT, "worse: d: mask.ion"},
      {"{ fail_on: 'worse:mask.ion' }", OPC_LIMIT, "worse: d: mask.ion"},
      {"{ fail_on: 'worse:io?' }", OPC_INVALID,
       "'worse:io?': metric does not exist"},
      {"{ fail_on: better }", OPC_INVALID, "'better' must be 'worse' or"},
      {"{ metrics: mask.iom }", OPC_INVALID, "did you mean 'mask.ion'?"},
      {"{ metrics: 'mask.*' }", OPC_OK, ""}};
  opc_error error;
  folder_make("c", (made_run){.metrics = RUN_ION("1.0")});
  folder_make("d", (made_run){.metrics = RUN_ION("1.5")});
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_assert_cmpint(folders_compare(cases[i].map, "c", "d", &error), ==,
                    cases[i].code);
    if (!strstr(error.message, cases[i].expected)) g_error("%s", error.message);
  }
  g_assert_cmpint(folders_compare("{ fail_on: worse }", "d", "c", &error), ==,
                  OPC_OK);
}

/* ---- masks ---- */

/* Make a run that wrote a mask with a box of layer 9 and one of layer 11, of
   the given widths. */
static void masked_make(const char *name, int poly, int metal,
                        const char *shots) {
  static const char files[] =
      "{ \"path\" : \"mask.gds\", \"bytes\" : 1, \"sha256\" : \"cc\" }";
  g_autofree char *metrics = g_strdup_printf(
      "{ \"cost\" : { \"shots\" : { \"value\" : %s, \"unit\" : null, "
      "\"better\" : \"lower\", \"tolerance\" : 0 } } }",
      shots);
  folder_make(name, (made_run){.files = files, .metrics = metrics});
  g_autofree char *folder = in_folder(name);
  g_autofree char *path = g_build_filename(folder, "flow.yaml", NULL);
  g_autofree char *flow = NULL;
  g_assert_true(g_file_get_contents(path, &flow, NULL, NULL));
  g_autofree char *with =
      g_strconcat(flow,
                  "  out:\n    use: write.gds\n    mask: ${mask.mask}\n"
                  "    file: mask.gds\n    layers:\n      metal1: 11/0\n",
                  NULL);
  put_file(folder, "flow.yaml", with);
  GByteArray *mask = file_begin(1);
  put_box(mask, 1, 0, 0, 500, 500);
  put_box(mask, 9, 0, 0, poly, 2000);
  put_box(mask, 11, 0, 0, metal, 1000);
  record_put(mask, EDA_GDS_ENDSTR, EDA_GDS_NOTHING, "", 0);
  record_put(mask, EDA_GDS_ENDLIB, EDA_GDS_NOTHING, "", 0);
  g_autofree char *gds = g_build_filename(folder, "mask.gds", NULL);
  g_assert_true(
      g_file_set_contents(gds, (char *)mask->data, (gssize)mask->len, NULL));
  g_byte_array_unref(mask);
  g_autofree char *cost =
      g_strdup_printf("layer,shots\npoly,%s\nactive,2\nmetal1,7\n", shots);
  put_file(folder, "cost.csv", cost);
}

/* Layer 9 is named by the table of costs, layer 11 by the step. Layers without
   a difference are listed on request. */
static void test_masks(void) {
  static const struct {
    const char *layer;
    double base, area, differs, shots_base, shots;
  } want[] = {{"active", 0.25, 0.25, 0, 2, 2},
              {"poly", 2, 2.4, 0.4, 50, 40},
              {"metal1", 1, 0.5, 0.5, 7, 7}};
  masked_make("a", 1000, 1000, "50");
  masked_make("b", 1200, 500, "40");
  for (size_t all = 0; all < 2; all++) {
    compare_good(all ? "{ all: true }" : "{}", "a", "b");
    g_assert_cmpuint(opc_test_rows("masks"), ==, 2 + all);
    for (size_t i = 0; i < 2 + all; i++) {
      size_t k = i + !all;
      g_assert_cmpstr(opc_test_text("masks", "layer", i), ==, want[k].layer);
      const struct {
        const char *column;
        double value;
      } figures[] = {{"area_base", want[k].base},
                     {"area", want[k].area},
                     {"differs", want[k].differs},
                     {"places", want[k].differs > 0},
                     {"rectangles", want[k].differs > 0},
                     {"shots_base", want[k].shots_base},
                     {"shots", want[k].shots}};
      for (size_t c = 0; c < G_N_ELEMENTS(figures); c++)
        g_assert_cmpfloat_with_epsilon(
            opc_test_number("masks", figures[c].column, i), figures[c].value,
            1e-9);
    }
  }
}

/* ---- runs of variants ---- */

/* The latest run of each variant is compared. Other variants, names and runs
   with longer names do not count. */
static void test_variants(void) {
  static const struct {
    const char *folder, *variant, *started, *metrics;
  } runs[] = {{"demo", NULL, "2026-01-01T00:00:00Z", RUN_ION("9.0")},
              {"demo-2", NULL, "2026-01-03T00:00:00Z", RUN_ION("1.0")},
              {"demo-10", NULL, "2026-01-02T00:00:00Z", RUN_ION("8.0")},
              {"demo-x", NULL, "2026-01-09T00:00:00Z", RUN_ION("7.0")},
              {"demos", NULL, "2026-01-09T00:00:00Z", RUN_ION("7.0")},
              {"demo-fast", "fast", "2026-01-01T00:00:00Z", RUN_ION("6.0")},
              {"demo-fast-2", "fast", "2026-01-02T00:00:00Z", RUN_ION("3.0")},
              {"demo-fast-3", "other", "2026-01-05T00:00:00Z", RUN_ION("5.0")}};
  g_autofree char *was = g_get_current_dir();
  opc_error error = {0};
  for (size_t i = 0; i < G_N_ELEMENTS(runs); i++) {
    g_autofree char *name = g_build_filename("runs", runs[i].folder, NULL);
    folder_make(name, (made_run){.variant = runs[i].variant,
                                 .started = runs[i].started,
                                 .metrics = runs[i].metrics});
  }
  put_file(opc_test_folder(), "any.yaml", "opcflow: 1\nname: 'demo'\n");
  put_file(opc_test_folder(), "demo.yaml", "opcflow: 1\nsteps: {}\n");
  g_assert_cmpint(g_chdir(opc_test_folder()), ==, 0);
  static const char *const flows[] = {"any.yaml", "demo.yaml"};
  for (size_t i = 0; i < 2; i++) {
    compare_good("{ variant: 'base, fast' }", flows[i], NULL);
    g_assert_cmpuint(opc_test_rows("runs"), ==, 2);
    size_t row = row_of("metrics", "metric", "mask.ion");
    g_assert_cmpfloat(opc_test_number("metrics", "base", row), ==, 1);
    g_assert_cmpfloat(opc_test_number("metrics", "value", row), ==, 3);
  }
  g_assert_cmpint(
      folders_compare("{ variant: 'base, lost' }", "any.yaml", NULL, &error),
      ==, OPC_INVALID);
  g_assert_true(g_str_has_prefix(error.message,
                                 "runs/ has no run of 'lost': start one by "
                                 "'opcflow run "));
  g_assert_true(g_str_has_suffix(error.message, " --variant lost'"));
  g_assert_cmpint(folders_compare("{ variant: fast }", "no.yaml", NULL, &error),
                  ==, OPC_IO);
  g_assert_cmpint(
      folders_compare("{ variant: fast }", "any.yaml", "demo.yaml", &error), ==,
      OPC_INVALID);
  g_assert_cmpstr(error.message, ==,
                  "'--variant' requires exactly one flow file");
  g_assert_cmpint(g_chdir(was), ==, 0);
}

/* Comparison is refused for different layouts or optics. */
static void test_refused(void) {
  static const made_run others[] = {{.layout = "bb"}, {.na = "0.85"}};
  static const char *const expected[] = {
      "layout.file differs in content (aa, bb)",
      "mask.litho.na is 0.75 and 0.85"};
  opc_error error;
  folder_make("c", (made_run){.na = NULL});
  for (int i = 0; i < 2; i++) {
    folder_make("d", others[i]);
    g_assert_cmpint(folders_compare("{}", "c", "d", &error), ==, OPC_INVALID);
    g_assert_nonnull(strstr(error.message, "not comparable: d: "));
    if (!strstr(error.message, expected[i])) g_error("%s", error.message);
    compare_good("{ anyway: true }", "c", "d");
    g_assert_nonnull(strstr(opc_test_log(), expected[i]));
  }
  g_assert_cmpint(folders_compare("{}", "c", NULL, &error), ==, OPC_INVALID);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/command.compare/verdicts", test_verdicts);
  g_test_add_func("/command.compare/seconds", test_seconds);
  g_test_add_func("/command.compare/transistors", test_transistors);
  g_test_add_func("/command.compare/classes", test_classes);
  g_test_add_func("/command.compare/cases", test_cases);
  g_test_add_func("/command.compare/fail_on", test_fail_on);
  g_test_add_func("/command.compare/masks", test_masks);
  g_test_add_func("/command.compare/variants", test_variants);
  g_test_add_func("/command.compare/refused", test_refused);
  return g_test_run();
}
