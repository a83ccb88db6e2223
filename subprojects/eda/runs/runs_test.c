/* SPDX-License-Identifier: BSD-3-Clause */
/* Valid and damaged run folders and experiments, written by hand. */
#include <eda/runs.h>
#include <eda/verdicts.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char manifest[] =
    "{\n  \"opcflow\" : \"0.2.0\",\n  \"flow\" : \"a.yaml\",\n"
    "  \"variant\" : \"plain\",\n  \"result\" : \"complete\",\n"
    "  \"started\" : \"2026-01-02T03:04:05Z\",\n  \"seconds\" : 1.5,\n"
    "  \"steps\" : { \"mask\" : 1.25 },\n  \"threads\" : 2,\n"
    "  \"plugins\" : [ { \"id\" : \"p.q\", \"version\" : \"1\", "
    "\"sha256\" : \"ab\" } ],\n"
    "  \"inputs\" : [ { \"path\" : \"/x/y.gds\", \"sha256\" : \"cd\" } ],\n"
    "  \"files\" : [ { \"path\" : \"gates.csv\", \"bytes\" : 12, "
    "\"sha256\" : \"ef\" } ]\n}\n";

static const char metrics[] =
    "{\n  \"mask\" : {\n    \"ion_max\" : { \"value\" : 0.25, \"unit\" : "
    "\"%\", \"better\" : \"lower\", \"tolerance\" : 1e-05 },\n"
    "    \"yield\" : { \"value\" : null, \"unit\" : null, \"better\" : "
    "\"higher\", \"tolerance\" : 0.0 } },\n"
    "  \"require\" : [ { \"metric\" : \"mask.ion_max\", \"required\" : \"at "
    "most 0.2 %\", \"least\" : null, \"most\" : 0.2, \"value\" : 0.25, "
    "\"unit\" : \"%\", \"kept\" : false } ],\n"
    "  \"findings\" : [ { \"step\" : \"mask\", \"text\" : \"two \\u00b5m\" } ]"
    ",\n  \"more_findings\" : 3\n}\n";

static const char flow[] =
    "# The flow as it ran\nopcflow: 1\nname: test\nsteps:\n"
    "  layout:                 # a.yaml:9:3\n"
    "    use: read.gds\n"
    "    layers: { poly: 9/0, other: \"a: # default\" } # a.yaml:1:2\n"
    "  mask:   # a\n"
    "    use: correct\n"
    "    gates: ${layout}      # a.yaml:1:2\n"
    "    litho:                # a.yaml:1:2\n"
    "      use: litho.hopkins\n"
    "      anchor:\n"
    "        line: 65 nm       # default\n"
    "      na: 0.75            # a.yaml:1:2\n"
    "    list: [1 nm, ${x.y}, { a: ${b} }] # default\n"
    "require:\n  mask.ion_max: 0.2 %\n";

static void file_put(const char *folder, const char *file, const char *text) {
  g_autofree char *path = g_build_filename(folder, file, NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
}

/* Return a folder (g_free) with a run, whose files contain the texts a, b and
   c. NULL selects the valid text of the file. */
static char *folder_make(const char *a, const char *b, const char *c) {
  char *folder = g_dir_make_tmp("runs-XXXXXX", NULL);
  file_put(folder, "manifest.json", a ? a : manifest);
  file_put(folder, "metrics.json", b ? b : metrics);
  file_put(folder, "flow.yaml", c ? c : flow);
  return folder;
}

static void folder_drop(char *folder) {
  GDir *dir = g_dir_open(folder, 0, NULL);
  const char *name;
  while ((name = g_dir_read_name(dir))) {
    g_autofree char *path = g_build_filename(folder, name, NULL);
    g_assert_false(g_remove(path));
  }
  g_dir_close(dir);
  g_assert_false(g_rmdir(folder));
  g_free(folder);
}

static void test_run(void) {
  char *folder = folder_make(NULL, NULL, NULL);
  opc_error error = {0};
  eda_run *run = eda_run_open(folder, &error);
  g_test_message("%s", error.message);
  const eda_run_facts *f = eda_run_info(run);
  g_assert_cmpstr(f->folder, ==, folder);
  g_assert_cmpstr(f->name, ==, "test");
  g_assert_cmpstr(f->variant, ==, "plain");
  g_assert_cmpstr(f->version, ==, "0.2.0");
  g_assert_cmpstr(f->started, ==, "2026-01-02T03:04:05Z");
  g_assert_null(f->failure);
  g_assert_cmpfloat(f->seconds, ==, 1.5);
  g_assert_cmpint(f->threads, ==, 2);
  g_assert_cmpint(f->points, ==, 0);
  g_assert_cmpuint(f->n_inputs, ==, 1);
  g_assert_cmpstr(f->inputs[0].sha256, ==, "cd");
  g_assert_cmpint(f->inputs[0].bytes, ==, -1);
  g_assert_cmpuint(f->n_files, ==, 1);
  g_assert_cmpint(f->files[0].bytes, ==, 12);
  g_assert_cmpuint(f->n_plugins, ==, 1);
  g_assert_cmpstr(f->plugins[0].id, ==, "p.q");
  g_assert_cmpuint(f->n_steps, ==, 1);
  g_assert_cmpfloat(f->steps[0].seconds, ==, 1.25);
  g_assert_cmpuint(f->n_findings, ==, 1);
  g_assert_cmpstr(f->findings[0].text, ==, "two \u00b5m");
  g_assert_cmpuint(f->n_requirements, ==, 1);
  g_assert_false(f->requirements[0].kept);
  g_assert_cmpuint(f->n_metrics, ==, 2);
  const eda_run_metric *m = eda_run_metric_of(run, "mask.ion_max");
  g_assert_cmpfloat(m->value, ==, 0.25);
  g_assert_cmpfloat(m->tolerance, ==, 1e-5);
  g_assert_cmpint(m->better, ==, EDA_RUN_LOWER);
  g_assert_cmpstr(m->unit, ==, "%");
  m = eda_run_metric_of(run, "mask.yield");
  g_assert_true(isnan(m->value));
  g_assert_null(m->unit);
  g_assert_cmpint(m->better, ==, EDA_RUN_HIGHER);
  g_assert_null(eda_run_metric_of(run, "yield"));
  eda_run_free(run);
  folder_drop(folder);
}

static void test_parameters(void) {
  static const eda_run_parameter want[] = {
      {"layout.use", "read.gds", 1},
      {"layout.layers.poly", "9/0", 1},
      {"layout.layers.other", "a: # default", 1},
      {"mask.use", "correct", 1},
      {"mask.gates", "${layout}", 1},
      {"mask.litho.use", "litho.hopkins", 1},
      {"mask.litho.anchor.line", "65 nm", 0},
      {"mask.litho.na", "0.75", 1},
      {"mask.list", "[1 nm, ${x.y}, { a: ${b} }]", 0},
  };
  char *folder = folder_make(NULL, NULL, NULL);
  opc_error error = {0};
  eda_run *run = eda_run_open(folder, &error);
  const eda_run_facts *f = eda_run_info(run);
  g_assert_cmpuint(f->n_parameters, ==, G_N_ELEMENTS(want));
  for (size_t i = 0; i < G_N_ELEMENTS(want); i++) {
    const eda_run_parameter *p = eda_run_parameter_of(run, want[i].name);
    g_assert_nonnull(p);
    g_assert_cmpstr(p->value, ==, want[i].value);
    g_assert_cmpint(p->given, ==, want[i].given);
  }
  eda_run_free(run);
  folder_drop(folder);
}

static void test_bad_runs(void) {
  /* File, its text, the expected code and message. */
  static const struct {
    int file, code;
    const char *text, *why;
  } cases[] = {
      {0, OPC_INVALID, "", "manifest.json:1:1: damaged"},
      {0, OPC_INVALID, "[1]", "manifest.json:1:1: damaged: expected a map"},
      {0, OPC_INVALID, "{\n \"opcflow\" : ", "manifest.json:3:1: damaged"},
      {0, OPC_INVALID, "{}", "manifest.json:1:1: text 'opcflow' is missing"},
      {0, OPC_INVALID, "{ \"opcflow\": \"1\\0\" }", "a text with a NUL byte"},
      {0, OPC_INVALID,
       "{\"opcflow\":\"1\",\"result\":\"complete\",\n \"inputs\":3}",
       ":2:11: 'inputs' is not a list"},
      {0, OPC_INVALID,
       "{\"opcflow\":\"1\",\"result\":\"complete\",\"files\":[\n{}]}",
       ":2:1: text 'path' is missing"},
      {0, OPC_INVALID, "{\xff}", "manifest.json': byte 1 is not UTF-8 text"},
      {1, OPC_INVALID,
       "{ \"a\": {\n"
       " \"b\": 3 } }",
       ":2:7: is not a metric"},
      {1, OPC_INVALID, "{ \"a\": { \"b\": { \"better\": \"more\" } } }",
       "found 'more'"},
      {1, OPC_INVALID, "{ \"a\": { \"b\": { \"better\": \"lower\" } } }",
       "'tolerance' is not a number"},
      {2, OPC_INVALID, "name: x\n",
       "flow.yaml:1:1: is a flow of the format ''"},
      {2, OPC_INVALID, "opcflow: 2\n",
       "flow.yaml:1:10: is a flow of the format"
       " '2'"},
      {2, OPC_INVALID, "opcflow: 1\nname: x\n", "flow.yaml:1:1: has no steps"},
      {2, OPC_INVALID, "opcflow: 1\nname: x\nsteps:\n  a: &b\n    c: *b\n",
       "flow.yaml:4:6: damaged: anchors and aliases ('&b') cannot be used"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    const char *text = cases[i].text;
    int file = cases[i].file;
    char *folder = folder_make(!file ? text : NULL, file == 1 ? text : NULL,
                               file == 2 ? text : NULL);
    opc_error error = {0};
    g_assert_null(eda_run_open(folder, &error));
    g_test_message("%s", error.message);
    g_assert_nonnull(strstr(error.message, cases[i].why));
    g_assert_cmpint(error.code, ==, cases[i].code);
    folder_drop(folder);
  }
  opc_error error = {0};
  g_assert_null(eda_run_open("/nowhere", &error));
  g_assert_cmpstr(error.message, ==, "'/nowhere': no such run folder");
  g_assert_cmpint(error.code, ==, OPC_IO);
}

static void test_deep(void) {
  for (int depth = 61; depth <= 62; depth++) {
    g_autoptr(GString) text =
        g_string_new("opcflow: 1\nname: x\nsteps: { a: { v: ");
    for (int i = 0; i < depth; i++) g_string_append_c(text, '[');
    for (int i = 0; i < depth; i++) g_string_append_c(text, ']');
    g_string_append(text, " } }");
    char *folder = folder_make(NULL, NULL, text->str);
    opc_error error = {0};
    eda_run *run = eda_run_open(folder, &error);
    g_assert_cmpint(!run, ==, depth > 61);
    g_assert_cmpint(!run, ==,
                    strstr(error.message, "nested deeper than 64") != NULL);
    eda_run_free(run);
    folder_drop(folder);
  }
}

static void test_table(void) {
  char *folder = folder_make(NULL, NULL, NULL);
  file_put(folder, "gates.csv",
           "transistor,ion (%),\"x \"\"y\"\", z\",n,none\r\n"
           "a/b:1,-0.5,\"two\r\nlines\",1,\r\n"
           "\"c,d\",,\"\",inf,\r\n"
           "e,2e1,z,-inf,");
  opc_error error = {0};
  eda_run *run = eda_run_open(folder, &error);
  g_assert_true(eda_run_has_table(run, "gates"));
  g_assert_false(eda_run_has_table(run, "other"));
  eda_table *t = eda_run_table(run, "gates", &error);
  g_test_message("%s", error.message);
  g_assert_true(t == eda_run_table(run, "gates", &error));
  g_assert_cmpuint(eda_table_rows(t), ==, 3);
  g_assert_cmpuint(eda_table_columns(t), ==, 5);
  g_assert_cmpstr(eda_table_name(t, 1), ==, "ion");
  g_assert_cmpstr(eda_table_unit(t, 1), ==, "%");
  g_assert_cmpstr(eda_table_name(t, 2), ==, "x \"y\", z");
  g_assert_cmpstr(eda_table_unit(t, 2), ==, "");
  g_assert_cmpstr(eda_table_text(t, 0, 2), ==, "two\r\nlines");
  g_assert_cmpstr(eda_table_text(t, 1, 0), ==, "c,d");
  g_assert_cmpint(eda_table_find(t, "n"), ==, 3);
  g_assert_cmpint(eda_table_find(t, "m"), ==, -1);
  g_assert_null(eda_table_numbers(t, 0));
  g_assert_null(eda_table_numbers(t, 4));
  const double *ion = eda_table_numbers(t, 1), *n = eda_table_numbers(t, 3);
  g_assert_cmpfloat(ion[0], ==, -0.5);
  g_assert_true(isnan(ion[1]));
  g_assert_cmpfloat(ion[2], ==, 20);
  g_assert_true(n[1] == INFINITY && n[2] == -INFINITY);
  eda_table_fail(t, 2, 1, "is odd:", &error);
  g_assert_nonnull(
      strstr(error.message, "gates.csv:5: column 'ion': is odd: '2e1'"));
  g_assert_null(eda_run_table(run, "other", &error));
  g_assert_cmpint(error.code, ==, OPC_IO);
  eda_run_free(run);
  folder_drop(folder);
}

static void test_bad_tables(void) {
  static const struct {
    const char *text, *why;
  } cases[] = {
      {"", ":1:1: a column without a name"},
      {"a,,b\n", ":1:3: a column without a name"},
      {"a,b\n1\n", ":2:1: found 1 fields, expected 2"},
      {"a,b\n1,2\n1,2,3\n", ":3:5: more than 2 fields"},
      {"a,b\n1,\"2\n3", ":2:3: a quote is not closed"},
      {"a,b\n"
       "\u00b5,\"2\"3\n",
       ":2:6: text after a closing quote"},
      {"a,b\n1,2\"\n", ":2:4: a quote within a field"},
      {"a,b\n1,2\r3\n", ":2:4: a carriage return within a line"},
  };
  char *folder = g_dir_make_tmp("runs-XXXXXX", NULL);
  g_autofree char *path = g_build_filename(folder, "t.csv", NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error = {0};
    file_put(folder, "t.csv", cases[i].text);
    g_assert_null(eda_table_read(path, &error));
    g_test_message("%s", error.message);
    g_assert_nonnull(strstr(error.message, cases[i].why));
    g_assert_cmpint(error.code, ==, OPC_INVALID);
  }
  folder_drop(folder);
}

#define HEAD "case,method,folder,result,seconds (s),mask.ion_max (%)\r\n"

static void test_experiment(void) {
  char *folder = g_dir_make_tmp("runs-XXXXXX", NULL);
  opc_error error = {0};
  g_assert_false(eda_run_is_experiment(folder));
  file_put(folder, "experiment.csv",
           HEAD
           "nand2,epe,x/nand2/epe,complete,1.5,0.25\r\n"
           "nand2,pb,,failed,,\r\n");
  g_assert_true(eda_run_is_experiment(folder));
  eda_run_cases *c = eda_run_cases_open(folder, &error);
  g_test_message("%s", error.message);
  size_t n;
  const eda_run_case *all = eda_run_cases_all(c, &n);
  g_assert_cmpuint(n, ==, 2);
  g_autofree char *where = g_build_filename(folder, "x/nand2/epe", NULL);
  g_assert_cmpstr(all[0].name, ==, "nand2");
  g_assert_cmpstr(all[0].method, ==, "epe");
  g_assert_cmpstr(all[0].folder, ==, where);
  g_assert_cmpfloat(all[0].seconds, ==, 1.5);
  g_assert_null(all[1].folder);
  g_assert_cmpstr(all[1].result, ==, "failed");
  g_assert_true(isnan(all[1].seconds));
  eda_run_cases_free(c);
  folder_drop(folder);
}

static void test_bad_experiments(void) {
  static const struct {
    const char *text, *why;
  } cases[] = {
      {"case,method,folder,result\n", "column 'seconds' is missing"},
      {HEAD "a,,b,complete,1,\n", ":2: column 'method': is empty: ''"},
      {HEAD "a,m,../b,complete,1,\n", "path outside of the folder: '../b'"},
      {HEAD "a,m,b/../../c,complete,1,\n", "path outside of the folder"},
      {HEAD "a,m,/b,complete,1,\n", "path outside of the folder"},
      {HEAD "a,m,b,complete,1,\na,m,c,complete,1,\n",
       "duplicate method of this case: 'm'"},
  };
  char *folder = g_dir_make_tmp("runs-XXXXXX", NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error = {0};
    file_put(folder, "experiment.csv", cases[i].text);
    g_assert_null(eda_run_cases_open(folder, &error));
    g_test_message("%s", error.message);
    g_assert_nonnull(strstr(error.message, cases[i].why));
    g_assert_cmpint(error.code, ==, OPC_INVALID);
  }
  folder_drop(folder);
}

/* ---- comparisons ---- */

/* Return a folder (g_free) with a run and its table of transistors. */
static char *run_make(const char *rows, const char *columns) {
  char *folder = folder_make(NULL, NULL, NULL);
  g_autofree char *table =
      g_strconcat("transistor,l (nm)", columns, rows, NULL);
  file_put(folder, "gates.csv", table);
  return folder;
}

/* Reasons why the transistors of two runs do not correspond. */
static void test_unlike(void) {
#define FLAT ",x (nm),y (nm)\r\n"
#define CLASSES ",x (nm),y (nm),count\r\n"
#define FURTHER \
  "set 'transistors: all.csv' in the steps of both runs that correct"
  static const struct {
    const char *base, *other, *of_base, *of_other, *why;
  } cases[] = {
      {"a:1,65,1,2\r\nb:1,60,3,4\r\n", "b:1,60,3,4\r\na:1,65,1,2\r\n", FLAT,
       FLAT, NULL},
      {"a:1,65,1,2\r\nb:1,60,3,4\r\n", "a:1,65,1,2\r\n", FLAT, FLAT,
       "only the base has a transistor 'b:1'"},
      {"a:1,65,1,2\r\n", "a:1,65,1,2\r\nb:1,60,3,4\r\n", FLAT, FLAT,
       "the runs have 1 and 2 transistors"},
      {"a:1,65,1,2\r\n", "a:1,66,1,2\r\n", FLAT, FLAT,
       "transistor 'a:1' is drawn differently"},
      {"T:1,65,1,2,2\r\n", "b:1,60,3,4\r\na:1,65,1,2\r\n", CLASSES, FLAT, NULL},
      {"a:1,65,1,2\r\nb:1,65,3,4\r\n", "T:1,65,1,2,3\r\n", FLAT, CLASSES,
       "the runs have 3 and 2 transistors"},
      {"T:1,65,1,2,1\r\n", "a:1,65,1,2\r\nb:1,65,3,4\r\n", CLASSES, FLAT,
       "the runs have 1 and 2 transistors"},
      {"T:1,65,1,2,2\r\n", "U:1,65,1,2,2\r\n", CLASSES, CLASSES, NULL},
      {"T:1,65,1,2,2\r\n", "T:1,65,1,2,3\r\n", CLASSES, CLASSES,
       "the class of the transistor at (1, 2) nm is not in both "
       "runs: " FURTHER},
      {"T:1,65,1,2,2\r\n", "T:1,65,1,3,2\r\n", CLASSES, CLASSES,
       "the class of the transistor at (1, 2) nm is not in both "
       "runs: " FURTHER},
      {"T:1,65,1,2,1\r\n", "a:1,66,1,2\r\n", CLASSES, FLAT,
       "transistor at (1, 2) nm is drawn differently"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    char *a = run_make(cases[i].base, cases[i].of_base);
    char *b = run_make(cases[i].other, cases[i].of_other);
    opc_error error = {0};
    eda_run *base = eda_run_open(a, &error), *other = eda_run_open(b, &error);
    char *why = NULL;
    g_assert_cmpint(eda_run_unlike(base, other, &why, &error), ==, OPC_OK);
    g_assert_cmpstr(why, ==, cases[i].why);
    free(why);
    eda_run_free(base);
    eda_run_free(other);
    folder_drop(a);
    folder_drop(b);
  }
}

/* Five cases of one transistor each, in which the second method improves Ion by
   0.1 to 0.5 points; the third method equals the first and has no run of the
   first case. */
static void test_verdicts(void) {
  enum { CASES = 5, METHODS = 3 };
  static const char *const methods[] = {"x", "y", "z"};
  static const char *const texts[] = {
      "y is better than x in Ion by 0.3 points (95 %: 0.1 to 0.5); equal in "
      "seconds",
      "no verdict on z against x; equal in Ion, seconds",
      "no verdict on z against y; equal in seconds; too few cells for Ion (4 "
      "of 5)"};
  char *folders[CASES * METHODS];
  for (int i = 0; i < CASES * METHODS; i++) {
    int k = i / METHODS, better = i % METHODS == 1;
    g_autofree char *row =
        g_strdup_printf("%c:1,65,-%g\r\n", 'a' + k, 5 - better * (k + 1) * 0.1);
    folders[i] = i == 2 ? NULL : run_make(row, ",ion_after (%)\r\n");
  }
  size_t n;
  opc_error error = {0};
  eda_verdict *v = eda_verdicts_new(CASES, METHODS, methods,
                                    (const char *const *)folders, &n, &error);
  g_assert_cmpuint(n, ==, 3);
  for (size_t i = 0; i < n; i++) g_assert_cmpstr(v[i].text, ==, texts[i]);
  const eda_change *ion = &v[0].changes[EDA_CHANGE_ION];
  g_assert_cmpint(ion->better, ==, 5);
  g_assert_cmpfloat_with_epsilon(ion->value, 4.7, 1e-12);
  g_assert_cmpfloat_with_epsilon(ion->median.low, -0.5, 1e-12);
  eda_verdicts_free(v, n);
  for (int i = 0; i < CASES * METHODS; i++)
    if (folders[i]) folder_drop(folders[i]);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/runs/run", test_run);
  g_test_add_func("/runs/parameters", test_parameters);
  g_test_add_func("/runs/bad_runs", test_bad_runs);
  g_test_add_func("/runs/deep", test_deep);
  g_test_add_func("/runs/table", test_table);
  g_test_add_func("/runs/bad_tables", test_bad_tables);
  g_test_add_func("/runs/experiment", test_experiment);
  g_test_add_func("/runs/bad_experiments", test_bad_experiments);
  g_test_add_func("/runs/unlike", test_unlike);
  g_test_add_func("/runs/verdicts", test_verdicts);
  return g_test_run();
}
