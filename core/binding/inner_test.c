/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of flows that a step runs: names and values of the layers into which
   lists, patterns and files expand; faults with their places. */
#include "core/binding/inner.h"

#include <glib/gstdio.h>
#include <store/files.h>
#include <string.h>

#include "core/binding/resolve.h"

static char *folder;

static void write_file(const char *name, const char *text) {
  g_autofree char *parent = g_path_get_dirname(name);
  g_assert_cmpint(g_mkdir_with_parents(parent, 0777), ==, 0);
  g_assert_true(g_file_set_contents(name, text, -1, NULL));
}

/* The plugin `experiment` has the axes `methods` and `cases`. */
static opc_registry *registry(void) {
  static opc_registry *all;
  if (all) return all;
  const char *build = g_getenv("OPCFLOW_BUILD");
  g_autofree char *tests = g_build_filename(build, "tests", NULL);
  g_autofree char *plugins = g_build_filename(build, "plugins", NULL);
  const char *folders[] = {tests, plugins, NULL};
  return all = opc_registry_new(folders);
}

/* Load a flow with the step `e`, which runs inner.yaml for the given lines. */
static opc_flow *load(const char *lines, opc_problems *problems) {
  g_autofree char *text = g_strconcat(
      "opcflow: 1\nsteps:\n  e:\n    use: experiment\n    flow: inner.yaml\n",
      lines, NULL);
  write_file("flow.yaml", text);
  return opc_flow_load("flow.yaml", NULL, registry(), problems);
}

static const opc_inner *inner_of(const opc_flow *flow) {
  return ((const opc_flow_step *)flow->steps->pdata[0])->binding->inner;
}

/* Check the names of all layers: those of `cases`, "|", those of `methods`. */
static void expect_layers(const char *lines, const char *expected) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow = load(lines, problems);
  g_autofree char *faults = opc_problems_text(problems);
  g_assert_cmpstr(faults, ==, "");
  const GPtrArray *axes = inner_of(flow)->sweep->axes;
  g_autoptr(GString) found = g_string_new(NULL);
  for (guint a = 0; a < axes->len; a++) {
    const opc_axis *axis = axes->pdata[a];
    g_string_append(found, a ? "| " : "");
    for (guint k = 0; k < axis->values->len; k++)
      g_string_append_printf(found, "%s ", axis->info.texts[k]);
  }
  g_assert_cmpstr(found->str, ==, expected);
}

static void expect_fault(const char *lines, const char *part) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow = load(lines, problems);
  g_autofree char *faults = opc_problems_text(problems);
  if (!strstr(faults, part)) g_assert_cmpstr(faults, ==, part);
}

#define METHODS "    methods: { less: base, more: more }\n"

/* Lists combine, the last one varies fastest; keys with one value are not part
   of the name. */
static void test_lists(void) {
  expect_layers(METHODS "    cases: [{ a.size: [1 nm, 5 nm] }]\n",
                "1nm 5nm | less more ");
  expect_layers(METHODS
                "    cases: [{ a.note: [x, y], a.whole: [1, 2], a.flag: true "
                "}]\n",
                "x-1 x-2 y-1 y-2 | less more ");
  expect_layers(
      "    methods: [base, more]\n"
      "    cases: [{ name: one, a.whole: 1 }, { name: two, a.whole: "
      "2 }]\n",
      "one two | base more ");
}

static void test_files(void) {
  static const char *const names[] = {"in/a1.txt", "in/a2.txt", "in/b1.txt",
                                      "other/a1.txt", "other/a2.txt"};
  for (size_t i = 0; i < G_N_ELEMENTS(names); i++) write_file(names[i], "x\n");
  expect_layers(METHODS "    cases: [{ a.input: 'in/*1.txt' }]\n",
                "a1 b1 | less more ");
  expect_layers(METHODS "    cases: [{ a.input: ['in/*.txt', '!b*'] }]\n",
                "a1 a2 | less more ");
  expect_layers(METHODS
                "    cases: [{ a.input: 'in/a*.txt', c.input: 'other/a*.txt' "
                "}]\n",
                "a1 a2 | less more ");
  write_file("lists/all.csv",
             "name,a.input,a.whole\nx,../in/a1.txt,4\n"
             "\"y\",../in/b1.txt,5\n");
  expect_layers(METHODS "    cases: [{ list: lists/all.csv }]\n",
                "x y | less more ");
  write_file("lists/all.yaml", "u: { a.whole: 1 }\nv: { a.whole: 2 }\n");
  expect_layers(METHODS "    cases: [{ list: lists/all.yaml, a.note: n }]\n",
                "u v | less more ");
  expect_fault(METHODS "    cases: [{ a.input: 'in/c*.txt' }]\n",
               "flow.yaml:7:24: no file matches 'in/c*.txt'");
  expect_fault(METHODS "    cases: [{ list: gone.csv }]\n",
               "flow.yaml:7:21: 'gone.csv': no such file");
  write_file("lists/bad.csv", "name,a.whole\nx\n");
  expect_fault(METHODS "    cases: [{ list: lists/bad.csv }]\n",
               "lists/bad.csv:2:1: 1 cells, the first line has 2");
}

/* Values of the flows that opc_inner_visit passes on. */
typedef struct visited {
  int flows;
  double sizes[8], numbers[8];
} visited;

static double real_of(const opc_flow *flow, guint step, const char *name) {
  const opc_binding *b =
      ((const opc_flow_step *)flow->steps->pdata[step])->binding;
  for (size_t i = 0; i < b->plugin->n_parameters; i++)
    if (!strcmp(b->plugin->parameters[i].name, name))
      return b->values[i].field.real;
  g_assert_not_reached();
}

static void visit(void *data, const opc_flow *flow) {
  visited *v = data;
  g_assert_cmpint(v->flows, <, 8);
  v->sizes[v->flows] = real_of(flow, 0, "size");
  v->numbers[v->flows++] = real_of(flow, 1, "number");
}

/* Visited are the first point and each other value of an axis. */
static void test_visit(void) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow =
      load(METHODS "    cases: [{ a.size: [2 nm, 5 nm] }]\n", problems);
  g_assert_cmpuint(problems->list->len, ==, 0);
  const opc_inner *in = inner_of(flow);
  g_assert_cmpuint(in->sweep->points, ==, 4);
  visited v = {0};
  opc_inner_visit(in, visit, &v);
  gboolean small = FALSE, large = FALSE, less = FALSE, more = FALSE;
  for (int i = 0; i < v.flows; i++) {
    small |= v.sizes[i] == 2, large |= v.sizes[i] == 5;
    less |= v.numbers[i] == 3, more |= v.numbers[i] == 9;
  }
  g_assert_true(small && large && less && more);
  g_assert_cmpfloat(real_of(opc_inner_flow(in), 0, "size"), ==, 2);
  g_assert_cmpfloat(real_of(opc_inner_flow(in), 1, "number"), ==, 3);
  g_autofree gboolean *needed = opc_inner_needed(in, opc_inner_flow(in));
  g_assert_true(needed[0] && needed[1]);
}

/* ---- queries of the step ---- */

/* An axis is used if a requested step, or a step that provides its input, has
   a value of the axis. Without requests, all axes are used. */
static void test_queries(void) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow =
      load(METHODS "    cases: [{ a.size: [2 nm, 5 nm] }]\n", problems);
  const opc_host host = {.data = (void *)inner_of(flow)->binding};
  opc_error error = {0};
  size_t n;
  const opc_inner_axis *const *axes = opc_inner_axes(&host, &n);
  g_assert_cmpuint(n, ==, 2);
  g_assert_true(axes[0]->used && axes[1]->used);
  g_assert_cmpstr(opc_inner_find_output(&host, "c", "number", &error), ==, "c");
  axes = opc_inner_axes(&host, &n);
  g_assert_true(!axes[0]->used && !axes[1]->used);
  g_assert_cmpstr(opc_inner_find_output(&host, NULL, "number", &error), ==,
                  "a");
  axes = opc_inner_axes(&host, &n);
  g_assert_true(axes[0]->used && !axes[1]->used);
  g_assert_cmpstr(opc_inner_find_metric(&host, "b.sum", &error)->name, ==,
                  "sum");
  axes = opc_inner_axes(&host, &n);
  g_assert_true(axes[0]->used && axes[1]->used);
  g_assert_cmpint(opc_inner_find_axis(&host, "cases", &error), ==, 0);
  g_assert_cmpint(opc_inner_find_axis(&host, "methods", &error), ==, 1);
  g_assert_cmpint(error.code, ==, OPC_OK);
  g_assert_cmpint(opc_inner_find_axis(&host, "method", &error), ==, -1);
  g_assert_cmpstr(error.message, ==,
                  "'method' is not a swept parameter, did you mean 'methods'?");
  g_assert_null(opc_inner_find_output(&host, "b", "mask", &error));
  g_assert_nonnull(strstr(error.message, "makes no mask"));
  g_assert_null(opc_inner_find_output(&host, "d", "number", &error));
  g_assert_null(opc_inner_find_metric(&host, "b.smu", &error));
  g_assert_nonnull(strstr(error.message, "did you mean 'sum'?"));
}

/* Resolved flows contain absolute names of files. Files with lists of cases are
   sources of the inner flow; a run records the checksums of sources. */
static void test_absolute(void) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  write_file("lists/all.yaml", "u: { a.whole: 1 }\nv: { a.whole: 2 }\n");
  g_autoptr(opc_flow) flow =
      load(METHODS
           "    cases: [{ list: lists/all.yaml, a.note: in.txt }]\n"
           "    set: { a.input: in.txt, b.file: in.txt }\n",
           problems);
  g_autofree char *faults = opc_problems_text(problems);
  g_assert_cmpstr(faults, ==, "");
  const GPtrArray *sources = inner_of(flow)->recipe->sources;
  gboolean is_source = FALSE;
  for (guint i = 0; i < sources->len; i++)
    is_source |= !strcmp(((const opc_source *)sources->pdata[i])->name,
                         "lists/all.yaml");
  g_assert_true(is_source);
  g_autofree char *text = opc_flow_resolved(flow, NULL);
  g_autofree char *here = g_get_current_dir();
  const char *const parts[] = {"a.input: %s/in.txt", "list: %s/lists/all.yaml",
                               "flow: %s/inner.yaml"};
  for (size_t i = 0; i < G_N_ELEMENTS(parts); i++) {
    g_auto(GStrv) halves = g_strsplit(parts[i], "%s", 2);
    g_autofree char *part = g_strconcat(halves[0], here, halves[1], NULL);
    if (!strstr(text, part)) g_error("no '%s' in\n%s", part, text);
  }
  g_assert_nonnull(strstr(text, "a.note: in.txt"));
  g_assert_nonnull(strstr(text, "b.file: in.txt"));
}

/* ---- faults ---- */

/* Write a flow with an experiment that runs the flow `inner`. */
static void write_nest(const char *name, const char *inner) {
  g_autofree char *text =
      g_strconcat("opcflow: 1\nsteps:\n  e: { use: experiment, flow: ", inner,
                  ", methods: [base], cases: [{ name: x }] }\n", NULL);
  write_file(name, text);
}

/* An experiment can run experiments; the inner experiments cannot run further
   experiments. */
static void test_depth(void) {
  g_autoptr(opc_problems) good = opc_problems_new();
  g_autoptr(opc_problems) bad = opc_problems_new();
  write_nest("one.yaml", "inner.yaml");
  write_nest("two.yaml", "one.yaml");
  write_nest("three.yaml", "two.yaml");
  g_autoptr(opc_flow) two = opc_flow_load("two.yaml", NULL, registry(), good);
  g_autofree char *none = opc_problems_text(good);
  g_assert_cmpstr(none, ==, "");
  g_autoptr(opc_flow) three =
      opc_flow_load("three.yaml", NULL, registry(), bad);
  g_autofree char *faults = opc_problems_text(bad);
  g_assert_nonnull(strstr(faults, "inner flows may be nested only twice"));
  const opc_host host = {.data = (void *)inner_of(two)->binding};
  opc_error error = {0};
  g_assert_cmpint(inner_of(two)->binding->nested->service->begin(&host, &error),
                  ==, OPC_FAILED);
  g_assert_cmpstr(error.message, ==, "experiment runs in flows only");
}

static void test_faults(void) {
#define CASES "    cases: [{ a.size: [1 nm, 5 nm] }]\n"
  static const struct {
    const char *lines, *part;
  } faults[] = {
      {CASES "    methods: [more, mroe]\n",
       "flow.yaml:7:21: unknown variant 'mroe', did you mean 'more'?"},
      {METHODS "    cases: []\n", "'cases' is empty"},
      {METHODS "    cases: [{ a.size: 1 V }]\n", "requires a length"},
      {METHODS "    cases: [{ a.szie: 1 nm }]\n", "unknown parameter 'szie'"},
      {METHODS "    cases: [{ name: a/b, a.size: 1 nm }]\n",
       "'a/b' cannot be the name of a folder"},
      {METHODS "    cases: [{ name: x, a.size: 1 nm }, { name: x, a.size: 2 "
               "nm }]\n",
       "two layers of 'cases' have the name 'x'"},
      {METHODS CASES "    set: { a.size: 3 nm }\n", "is already fixed by"},
      {CASES, "required parameter 'methods'"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(faults); i++)
    expect_fault(faults[i].lines, faults[i].part);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_assert_cmpint(g_chdir(folder), ==, 0);
  write_file("in.txt", "x\n");
  write_file("inner.yaml",
             "opcflow: 1\nname: inner\nsteps:\n"
             "  a: { use: test.numbers, size: 1 nm }\n"
             "  b: { use: test.kept, number: 3, add: ${a} }\n"
             "  c: { use: test.numbers, size: 1 nm }\n"
             "variants:\n  more: { b.number: 9 }\n");
  g_test_add_func("/inner/lists", test_lists);
  g_test_add_func("/inner/files", test_files);
  g_test_add_func("/inner/visit", test_visit);
  g_test_add_func("/inner/queries", test_queries);
  g_test_add_func("/inner/absolute", test_absolute);
  g_test_add_func("/inner/depth", test_depth);
  g_test_add_func("/inner/faults", test_faults);
  int code = g_test_run();
  g_assert_cmpint(g_chdir("/"), ==, 0);
  opc_remove_tree(folder);
  g_free(folder);
  return code;
}
