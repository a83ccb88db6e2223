/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of runs: metrics, tables and files against sums computed here; run
   folders, sweeps, stops, time limits and refused publications. */
#include "core/run/forecast.h"
#include "core/run/trial_test.h"

/* test.numbers publishes whole + size + the list + the input: 1 + size + 3.
   test.kept publishes a third of the number + the input, and twice that. */
#define FLOW                                                            \
  "opcflow: 1\nname: sums\nsteps:\n"                                    \
  "  c: { use: test.kept, number: 6, add: \"${b.twice}\", file: c.txt " \
  "}\n"                                                                 \
  "  b: { use: test.kept, number: 3, add: ${a} }\n"                     \
  "  a: { use: test.numbers, size: 2 nm, input: in.txt }\n"
enum { SUM_A = 6, SUM_B = 7, SUM_C = 16 };

/* ---- one run ---- */

static void test_results(void) {
  trial t = {.options = {.output = "results"}};
  trial_run_good(&t, FLOW, NULL);
  g_assert_cmpstr(t.run->out.folder, ==, "results");
  g_assert_cmpfloat(trial_metric(&t, "a", "sum"), ==, SUM_A);
  g_assert_cmpfloat(trial_metric(&t, "b", "sum"), ==, SUM_B);
  g_assert_cmpfloat(trial_metric(&t, "c", "sum"), ==, SUM_C);
  g_autofree char *text = get_text("results", "c.txt");
  g_assert_cmpfloat(g_ascii_strtod(text, NULL), ==, SUM_C);
  /* The first step that publishes a table `kept` gets the short name. */
  g_autofree char *b = get_text("results", "kept.csv");
  g_autofree char *c = get_text("results", "c.kept.csv");
  g_assert_cmpstr(b, ==, "sum\r\n7\r\n");
  g_assert_cmpstr(c, ==, "sum\r\n16\r\n");
  g_assert_true(g_str_has_prefix(t.log->str, "[1/3] a\na: 2 numbers\n[2/3] b"));
  for (int i = 0; i < 3; i++) g_assert_true(t.run->out.seconds[i] >= 0);
  trial_clear(&t);
}

/* The checksums of the flow and of all read files are those of the texts. */
static void test_inputs(void) {
  trial t = {.options = {.output = "inputs"}};
  trial_run_good(&t, FLOW, NULL);
  const GPtrArray *found = t.run->out.inputs;
  const char *const names[] = {"flow.yaml", "in.txt"};
  const char *const texts[] = {FLOW, "some input\n"};
  g_assert_cmpuint(found->len, ==, 4);
  for (guint i = 0; i < 2; i++) {
    g_autofree char *path = g_canonicalize_filename(names[i], NULL);
    g_autofree char *sum =
        g_compute_checksum_for_string(G_CHECKSUM_SHA256, texts[i], -1);
    g_assert_cmpstr(found->pdata[2 * i], ==, path);
    g_assert_cmpstr(found->pdata[2 * i + 1], ==, sum);
  }
  trial_clear(&t);
}

/* Without a given folder, runs get the name of the flow and a number. */
static void test_folders(void) {
  const char *const names[] = {"runs/sums", "runs/sums-2", "runs/sums-3"};
  trial t = {0};
  for (int i = 0; i < 3; i++) {
    trial_run_good(&t, FLOW, NULL);
    g_assert_cmpstr(t.run->out.folder, ==, names[i]);
    trial_clear(&t);
  }
  t.options.output = "runs/sums///";
  g_assert_cmpint(trial_run(&t, FLOW, NULL), !=, OPC_OK);
  g_assert_null(t.run->out.folder);
  trial_clear(&t);
  const char *const sets[] = {"c.number=9", NULL};
  t.options = (opc_run_options){.output = "runs/sums///", .force = TRUE};
  trial_run_good(&t, FLOW, sets);
  g_assert_cmpstr(t.run->out.folder, ==, "runs/sums");
  g_autofree char *text = get_text("runs/sums", "c.txt");
  g_assert_cmpfloat(g_ascii_strtod(text, NULL), ==, SUM_C + 1);
  trial_clear(&t);
}

/* The files of a failed run remain under another name. A failed run without
   files leaves no folder. */
static void test_failure(void) {
  trial t = {.options = {.output = "failure"}};
  g_assert_cmpint(
      trial_run(&t,
                "opcflow: 1\nsteps:\n"
                "  a: { use: test.kept, file: a.txt }\n"
                "  b: { use: test.numbers, size: 3 nm, add: ${a}, behave: fail "
                "}\n"
                "  c: { use: test.kept, add: ${b} }\n",
                NULL),
      ==, OPC_FAILED);
  trial_expect(&t,
               "flow.yaml:4:33: step 'b' (test.numbers): 3 nm is not possible");
  g_assert_cmpstr(t.run->out.failure, ==, "3 nm is not possible");
  g_assert_cmpstr(t.run->out.folder, ==, "failure.failed");
  g_assert_true(has_file("failure.failed", "a.txt"));
  g_assert_false(has_file(".", "failure"));
  g_assert_true(isnan(t.run->out.seconds[2]));
  trial_clear(&t);
  t.options.output = "nothing";
  g_assert_cmpint(trial_run(&t,
                            "opcflow: 1\nsteps:\n  b: { use: test.numbers, "
                            "size: 3 nm, behave: fail }\n",
                            NULL),
                  ==, OPC_FAILED);
  g_assert_null(t.run->out.folder);
  g_assert_false(has_file(".", "nothing.failed"));
  trial_clear(&t);
}

/* A stopped run leaves no folder, and later steps do not run. */
static void test_stop(void) {
  trial t = {.options = {.output = "stopped"}, .stop = "b"};
  g_assert_cmpint(trial_run(&t, FLOW, NULL), ==, OPC_CANCELLED);
  trial_expect(&t, "flow.yaml:4:3: stopped");
  g_assert_true(g_str_has_suffix(t.log->str, "[2/3] b\nb: ran\n"));
  g_assert_null(t.run->out.folder);
  g_assert_false(has_file(".", "stopped"));
  g_assert_false(has_file(".", "stopped.failed"));
  trial_clear(&t);
}

/* A step that waits until it is cancelled ends at the time limit. */
static void test_time_limit(void) {
  trial t = {.options = {.output = "late"}};
  g_assert_cmpint(
      trial_run(&t,
                "opcflow: 1\nsteps:\n  a: { use: test.numbers, size: 1 nm, "
                "behave: wait, timeout: 0.1 s }\n",
                NULL),
      ==, OPC_FAILED);
  g_autofree char *faults = opc_problems_text(t.problems);
  g_assert_nonnull(strstr(faults, "exceeded the time limit of 0.1 s"));
  g_assert_true(t.run->out.seconds[0] >= 0.1);
  trial_clear(&t);
}

/* ---- publications ---- */

static void test_refused(void) {
  static const struct {
    const char *step, *message;
  } faults[] = {
      {"size: 1 nm, behave: leave", "'../out' is outside of the run folder"},
      {"size: 1 nm, behave: nan", "metric 'sum'"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(faults); i++) {
    trial t = {.options = {.output = "refused"}};
    g_autofree char *flow = g_strdup_printf(
        "opcflow: 1\nsteps:\n  a: { use: test.numbers, %s }\n", faults[i].step);
    g_assert_cmpint(trial_run(&t, flow, NULL), !=, OPC_OK);
    g_autofree char *found = opc_problems_text(t.problems);
    if (!strstr(found, faults[i].message))
      g_assert_cmpstr(found, ==, faults[i].message);
    g_assert_false(has_file(".", "out"));
    trial_clear(&t);
  }
}

/* The run keeps 100 of 250 findings, which several threads log. Three equal
 * findings are kept once. */
static void test_findings(void) {
  trial t = {.options = {.output = "findings", .force = TRUE}};
  const char *const many[] = {"a.behave=many", NULL};
  const char *const find[] = {"a.behave=find", NULL};
  trial_run_good(&t, FLOW, many);
  g_assert_cmpuint(t.run->out.findings.list->len, ==, 100);
  g_assert_cmpuint(t.run->out.findings.more, ==, 150);
  trial_clear(&t);
  t.options = (opc_run_options){.output = "findings", .force = TRUE};
  trial_run_good(&t, FLOW, find);
  g_assert_cmpuint(t.run->out.findings.list->len, ==, 1);
  const opc_finding *f = t.run->out.findings.list->pdata[0];
  g_assert_cmpstr(f->path, ==, "a");
  g_assert_cmpstr(f->text, ==, "2 nm is odd");
  trial_clear(&t);
}

/* ---- sweeps ---- */

static void expect_cell(const trial *t, const char *column, size_t row,
                        const char *text) {
  const opc_column *c = opc_table_column(t->run->out.points, column);
  if (!c) g_error("no column '%s'", column);
  g_autofree char *cell = opc_table_cell(c, row);
  g_assert_cmpstr(cell, ==, text);
}

/* Steps that no axis changes run once; each point has the sums of its
   parameters. */
static void test_sweep(void) {
  trial t = {.options = {.output = "sweep", .keep = TRUE}};
  trial_run_good(&t,
                 FLOW
                 "sweep: { b.number: [3, 6], c.number: [0, 3, 9] }\n"
                 "require: { c.sum: 16 }\n",
                 NULL);
  const opc_table *all = t.run->out.points;
  g_assert_cmpuint(all->rows, ==, 6);
  for (int i = 0; i < 6; i++) {
    int number_b = i / 3 ? 6 : 3, number_c = (int[]){0, 3, 9}[i % 3];
    int sum_b = SUM_A + number_b / 3, sum_c = 2 * sum_b + number_c / 3;
    g_autofree char *folder = g_strdup_printf("sweep/%04d", i + 1);
    g_autofree char *point = g_strdup_printf("%d", i + 1);
    g_autofree char *b = g_strdup_printf("%d", sum_b);
    g_autofree char *c = g_strdup_printf("%d", sum_c);
    g_autofree char *file = get_text(folder, "c.txt");
    expect_cell(&t, "point", (size_t)i, point);
    expect_cell(&t, "a.sum", (size_t)i, "6");
    expect_cell(&t, "b.sum", (size_t)i, b);
    expect_cell(&t, "c.sum", (size_t)i, c);
    g_assert_cmpfloat(g_ascii_strtod(file, NULL), ==, sum_c);
    const opc_column *results = opc_table_column(all, "result");
    const char *result = ((char **)results->data)[i];
    if (sum_c <= 16)
      g_assert_cmpstr(result, ==, "good");
    else
      g_assert_nonnull(strstr(result, "expected at most 16"));
  }
  g_assert_cmpuint(t.run->out.failed_points, ==, 3);
  g_assert_cmpint(t.run->out.points_code, ==, OPC_LIMIT);
  g_auto(GStrv) starts = g_strsplit(t.log->str, "] a\n", -1);
  g_assert_cmpuint(g_strv_length(starts), ==, 2);
  trial_clear(&t);
}

/* Failed points do not end the sweep. Their code is that of all, or
   OPC_FAILED. */
static void test_failed_points(void) {
  trial t = {.options = {.output = "points"}};
  const char *const flow =
      "opcflow: 1\nsteps:\n  a: { use: test.numbers, size: 1 nm }\n";
  g_autofree char *limit =
      g_strconcat(flow, "sweep: { a.behave: [limit, well, limit] }\n", NULL);
  g_autofree char *mixed =
      g_strconcat(flow, "sweep: { a.behave: [limit, fail, well] }\n", NULL);
  trial_run_good(&t, limit, NULL);
  g_assert_cmpuint(t.run->out.failed_points, ==, 2);
  g_assert_cmpint(t.run->out.points_code, ==, OPC_LIMIT);
  expect_cell(&t, "a.sum", 0, "");
  expect_cell(&t, "a.sum", 1, "5");
  expect_cell(&t, "result", 1, "good");
  g_assert_false(has_file("points", "0002")); /* without `keep` */
  trial_clear(&t);
  t.options = (opc_run_options){.output = "points", .force = TRUE};
  trial_run_good(&t, mixed, NULL);
  g_assert_cmpuint(t.run->out.failed_points, ==, 2);
  g_assert_cmpint(t.run->out.points_code, ==, OPC_FAILED);
  trial_clear(&t);
}

/* A stop ends the sweep after the finished points. */
static void test_stopped_sweep(void) {
  trial t = {.options = {.output = "half"}, .stop = "c"};
  g_assert_cmpint(trial_run(&t, FLOW "sweep: { c.number: [0, 3, 9] }\n", NULL),
                  ==, OPC_CANCELLED);
  trial_expect(&t, "stopped after 1 of 3 points");
  g_assert_cmpuint(t.run->out.points->rows, ==, 1);
  trial_clear(&t);
}

/* ---- the flow of a step ---- */

/* Three cases and three methods; all runs of the third case or method fail. The
   table has a row for each run. Each successful run writes its sum, and its
   manifest has the checksum of the flow. Three of the four sums violate the
   requirement. Failed runs leave no folder. */
static void test_inner_flow(void) {
  trial t = {.options = {.output = "outer"}};
  put_text("inner.yaml",
           "opcflow: 1\nname: inner\nsteps:\n"
           "  a: { use: test.numbers, size: 1 nm }\n"
           "  b: { use: test.kept, number: 3, add: ${a}, file: b.txt }\n"
           "  c: { use: test.numbers, size: 1 nm, add: ${b} }\n"
           "require: { b.sum: 7 }\n"
           "variants:\n  more: { b.number: 9 }\n"
           "  bad: { b.number: 12, c.behave: fail }\n");
  trial_run_good(&t,
                 "opcflow: 1\nname: outer\nsteps:\n"
                 "  e:\n    use: experiment\n    flow: inner.yaml\n"
                 "    methods: { less: base, more: more, bad: bad }\n"
                 "    cases: [{ a.size: [1 nm, 5 nm] }, { a.behave: fail }]\n",
                 NULL);
  g_autofree char *csv = get_text("outer", "experiment.csv");
  g_autofree char *flow = get_text(".", "inner.yaml");
  g_autofree char *checksum =
      g_compute_checksum_for_string(G_CHECKSUM_SHA256, flow, -1);
  g_assert_cmpuint(t.run->out.verdicts->len, ==, 3);
  for (guint i = 0; i < t.run->out.verdicts->len; i++) {
    const opc_verdict *v = t.run->out.verdicts->pdata[i];
    g_assert_cmpuint(v->point, ==, 0);
    g_assert_true(g_str_has_suffix(v->path, i == 1 ? "s: b.sum" : "e: b.sum"));
  }
  g_auto(GStrv) lines = g_strsplit(csv, "\r\n", -1);
  g_assert_cmpuint(g_strv_length(lines), ==, 11); /* a head, and the last \n */
  g_auto(GStrv) head = g_strsplit(lines[0], ",", -1);
  int folder = -1;
  for (int i = 0; head[i]; i++)
    if (!strcmp(head[i], "folder")) folder = i;
  g_assert_cmpint(folder, >=, 0);
  for (int i = 0; i < 4; i++) {
    g_auto(GStrv) cells = g_strsplit(lines[3 * (i / 2) + i % 2 + 1], ",", -1);
    g_autofree char *path = g_build_filename("outer", cells[folder], NULL);
    g_autofree char *failed = g_build_filename(path, "../bad", NULL);
    g_autofree char *manifest = get_text(path, "manifest.json");
    g_assert_nonnull(strstr(manifest, checksum));
    g_autofree char *text = get_text(path, "b.txt");
    int sum = 1 + (i / 2 ? 5 : 1) + 3 + (i % 2 ? 3 : 1);
    g_assert_cmpfloat(g_ascii_strtod(text, NULL), ==, sum);
    g_assert_false(has_file(failed, "."));
  }
  trial_clear(&t);
}

/* ---- forecasts ---- */

static void test_forecast_text(void) {
  static const struct {
    opc_forecast forecast;
    const char *text;
  } cases[] = {{{.memory = 0, .work = ""}, ""},
               {{.memory = 0, .work = "5 windows"}, "5 windows"},
               {{.memory = 2e9, .work = ""}, "2.0 GB"},
               {{.memory = 3e6, .work = "5 windows"}, "5 windows, 3 MB"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *text = opc_forecast_text(&cases[i].forecast);
    g_assert_cmpstr(text, ==, cases[i].text);
  }
}

/* Return the forecasts of a flow, "step: text" one a line (g_free). */
static char *forecast(const char *text, opc_problems *problems) {
  put_text("flow.yaml", text);
  g_autoptr(opc_recipe) recipe = opc_recipe_read("flow.yaml", problems);
  g_autoptr(opc_sweep) none = opc_sweep_none();
  const opc_choice choice = {.sweep = none};
  g_autoptr(GArray) list = g_array_new(FALSE, TRUE, sizeof(opc_outlook));
  opc_run_forecast(recipe, &choice, trial_registry(), NULL, list, problems);
  GString *out = g_string_new(NULL);
  for (guint i = 0; i < list->len; i++) {
    opc_outlook *o = &g_array_index(list, opc_outlook, i);
    g_autofree char *its = opc_forecast_text(&o->forecast);
    g_string_append_printf(out, "%s: %s\n", o->step, its);
    g_free(o->step);
  }
  return g_string_free(out, FALSE);
}

/* Light steps run, so that the forecast of the next step knows the input; the
   forecast of a step behind a step that does not run is unknown. */
static void test_forecast(void) {
  g_autoptr(opc_problems) good = opc_problems_new();
  g_autoptr(opc_problems) bad = opc_problems_new();
  g_autofree char *text = forecast(
      "opcflow: 1\nsteps:\n  a: { use: test.light }\n"
      "  b: { use: test.light, from: ${a}, memory: 1e-3 }\n"
      "  c: { use: test.heavy, from: ${b} }\n"
      "  d: { use: test.light, from: ${c} }\n",
      good);
  g_assert_cmpstr(text, ==, "a: 1 sums\nb: 2 sums, 1 MB\nc: 4 sums\n");
  g_assert_cmpuint(good->list->len, ==, 0);
  g_autofree char *few = forecast(
      "opcflow: 1\nsteps:\n  a: { use: test.light, memory: -1 }\n"
      "  b: { use: test.light, from: ${a} }\n"
      "  c: { use: test.heavy, memory: 1e9 }\n",
      bad);
  g_autofree char *faults = opc_problems_text(bad);
  g_assert_nonnull(strstr(faults, "less than nothing"));
  g_assert_nonnull(strstr(faults, " of memory for 1 sums, but "));
  g_assert_nonnull(strstr(faults, "; less with a smaller 'memory'"));
  g_assert_cmpuint(bad->list->len, ==, 2);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  trial_begin();
  put_text("in.txt", "some input\n");
  g_test_add_func("/run/results", test_results);
  g_test_add_func("/run/inputs", test_inputs);
  g_test_add_func("/run/folders", test_folders);
  g_test_add_func("/run/failure", test_failure);
  g_test_add_func("/run/stop", test_stop);
  g_test_add_func("/run/time-limit", test_time_limit);
  g_test_add_func("/run/refused", test_refused);
  g_test_add_func("/run/findings", test_findings);
  g_test_add_func("/run/sweep", test_sweep);
  g_test_add_func("/run/failed-points", test_failed_points);
  g_test_add_func("/run/stopped-sweep", test_stopped_sweep);
  g_test_add_func("/run/inner-flow", test_inner_flow);
  g_test_add_func("/run/forecast-text", test_forecast_text);
  g_test_add_func("/run/forecast", test_forecast);
  return trial_end();
}
