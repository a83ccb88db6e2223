/* SPDX-License-Identifier: BSD-3-Clause */
/* Experiments with a flow whose metrics are formulas of case and method. The
   table must have the values of the formulas, and the summary their means. */
#include "experiment.h"

#include <eda/experiment.h>
#include <math.h>

#include "tests/inner.h"

/* ---- a flow ---- */

enum { CASES = 3, METHODS = 2, ALL = CASES * METHODS };
static const char *const case_names[] = {"A", "B", "C"};
static const char *const method_names[] = {"fast", "fine"};
static const opc_inner_axis axes[] = {
    {.path = "cases", .count = CASES, .texts = case_names},
    {.path = "methods", .count = METHODS, .texts = method_names},
    {.path = "mask.limit", .count = 2}};

static const opc_metric ion = {"ion", "%", OPC_LOWER, 0, "a figure"},
                        shots = {"shots", NULL, OPC_LOWER, 0, "another one"},
                        count = {"count", NULL, OPC_NEUTRAL, 0, "neutral"},
                        dose = {"ion", "mA", OPC_HIGHER, 0, "an other unit"};

static double formula(size_t point) {
  size_t c = point / METHODS, m = point % METHODS;
  return 1 + (double)(c * c + 10 * m);
}

static int failing = -1, limited = -1; /* index of the point */
static char folder[80];

static int run_point(size_t point, opc_error *error) {
  inner.n_metrics = 0;
  if ((int)point == failing)
    return opc_fail(error, OPC_FAILED, NULL, "no light at %zu", point);
  inner_report("mask", &ion, formula(point));
  inner_report("cost", &shots, 5); /* equal for all methods */
  inner_report("gates", &count, (double)point);
  g_snprintf(folder, sizeof folder, "/runs/e/%s",
             inner.places[inner.n_points - 1]);
  inner.whole = (opc_inner_run){folder, 2 + (double)point, point == 1};
  return (int)point == limited
             ? opc_fail(error, OPC_LIMIT, NULL, "'mask.ion' is too large")
             : OPC_OK;
}

static const inner_flow flow = {.axes = axes, .n_axes = 2, .point = run_point};

/* ---- experiments ---- */

static int run_experiment(experiment *e, eda_experiment **out,
                          opc_error *error) {
  void *outputs[1] = {NULL};
  const opc_step *step = opcflow_plugin()->functions;
  int code = opcflow_plugin()->check(e, error);
  if (!code) code = step->run(e, outputs, error);
  if (!code) g_assert_cmpint(eda_experiment_check(outputs[0], error), ==, 0);
  if (out)
    *out = outputs[0];
  else if (outputs[0])
    eda_experiment_free(outputs[0]);
  opcflow_plugin()->clear(e);
  return code;
}

static double mean(size_t method, double (*value_of)(size_t)) {
  double sum = 0, n = 0;
  for (size_t i = method; i < ALL; i += METHODS)
    if ((int)i != failing) sum += value_of(i), n++;
  return sum / n;
}

static double seconds(size_t point) { return 2 + (double)point; }

/* Each run is listed once, sorted by case and method, in a folder with these
   names. */
static void test_table(void) {
  opc_error error;
  eda_experiment *out;
  experiment e = {.host = inner_host(flow)};
  g_assert_cmpint(run_experiment(&e, &out, &error), ==, OPC_OK);
  g_assert_cmpuint(out->n_cases, ==, CASES);
  g_assert_cmpuint(out->n_methods, ==, METHODS);
  g_assert_cmpuint(inner.n_points, ==, ALL);
  g_assert_cmpuint(opc_test_rows("experiment"), ==, ALL);
  for (size_t i = 0; i < ALL; i++) {
    const char *c = case_names[i / METHODS], *m = method_names[i % METHODS];
    g_autofree char *place = g_strdup_printf("%s/%s", c, m);
    g_autofree char *path = g_strdup_printf("/runs/e/%s", place);
    g_autofree char *inside = g_strdup_printf("e/%s", place);
    g_assert_cmpuint(inner.points[i], ==, i);
    g_assert_cmpstr(inner.places[i], ==, place);
    g_assert_cmpstr(out->folders[i], ==, path);
    g_assert_cmpstr(opc_test_text("experiment", "case", i), ==, c);
    g_assert_cmpstr(opc_test_text("experiment", "method", i), ==, m);
    g_assert_cmpstr(opc_test_text("experiment", "folder", i), ==, inside);
    g_assert_cmpstr(opc_test_text("experiment", "result", i), ==, "good");
    g_assert_true(opc_test_number("experiment", "mask.ion", i) == formula(i));
    g_assert_true(opc_test_number("experiment", "seconds", i) == seconds(i));
  }
  g_assert_cmpfloat(opc_test_metric("cases"), ==, CASES);
  g_assert_cmpfloat(opc_test_metric("methods"), ==, METHODS);
  g_assert_cmpfloat(opc_test_metric("failed"), ==, 0);
  g_assert_nonnull(strstr(opc_test_log(), "1 of 6 runs have findings"));
  eda_experiment_free(out);
}

/* Means over the cases: first the metrics that methods optimise and the run
   time, then figures that have a direction and differ between methods; or the
   requested figures. */
static void test_summary(void) {
  opc_error error;
  experiment e = {.host = inner_host(flow)};
  g_assert_cmpint(run_experiment(&e, NULL, &error), ==, OPC_OK);
  g_assert_cmpuint(opc_test_rows("summary"), ==, METHODS);
  for (size_t m = 0; m < METHODS; m++) {
    g_assert_cmpfloat(opc_test_number("summary", "cases", m), ==, CASES);
    g_assert_cmpfloat_with_epsilon(opc_test_number("summary", "mask.ion", m),
                                   mean(m, formula), 5e-4 * mean(m, formula));
    g_assert_cmpfloat_with_epsilon(opc_test_number("summary", "seconds", m),
                                   mean(m, seconds), 5e-3);
  }
  static const char *const order[] = {"method", "cases", "cost.shots",
                                      "seconds", "mask.ion"};
  const opc_table *t = opc_test_table("summary");
  g_assert_cmpuint(t->n_columns, ==, G_N_ELEMENTS(order));
  for (size_t i = 0; i < t->n_columns; i++)
    g_assert_cmpstr(t->columns[i].name, ==, order[i]);
  g_assert_true(isnan(opc_test_number("summary", "gates.count", 0)));
  static const opc_pair wanted[] = {{"cost.shots", "shots"},
                                    {"gates.number", "none"}};
  experiment asked = {.host = inner_host(flow), .columns = {wanted, 2}};
  g_assert_cmpint(run_experiment(&asked, NULL, &error), ==, OPC_OK);
  g_assert_cmpfloat(opc_test_number("summary", "shots", 1), ==, 5);
  g_assert_true(isnan(opc_test_number("summary", "mask.ion", 1)));
  g_assert_nonnull(strstr(opc_test_log(), "'gates.number'"));
}

/* A failed run has a row without figures and is excluded from the means; a run
   that violates a requirement is included. */
static void test_failing(void) {
  opc_error error;
  eda_experiment *out;
  experiment e = {.host = inner_host(flow)};
  failing = 2;
  limited = 5;
  g_assert_cmpint(run_experiment(&e, &out, &error), ==, OPC_OK);
  g_assert_cmpuint(inner.n_points, ==, ALL);
  g_assert_null(out->folders[2]);
  g_assert_nonnull(out->folders[5]);
  eda_experiment_free(out);
  g_assert_cmpstr(opc_test_text("experiment", "result", 2), ==,
                  "no light at 2");
  g_assert_cmpstr(opc_test_text("experiment", "folder", 2), ==, "");
  g_assert_true(isnan(opc_test_number("experiment", "mask.ion", 2)));
  g_assert_true(isnan(opc_test_number("experiment", "seconds", 2)));
  g_assert_true(opc_test_number("experiment", "mask.ion", 5) == formula(5));
  g_assert_cmpfloat(opc_test_metric("failed"), ==, 1);
  g_assert_cmpfloat(opc_test_metric("missed"), ==, 1);
  g_assert_cmpfloat(opc_test_number("summary", "cases", 0), ==, CASES - 1);
  g_assert_cmpfloat_with_epsilon(opc_test_number("summary", "mask.ion", 0),
                                 mean(0, formula), 5e-4 * mean(0, formula));
  g_assert_nonnull(strstr(opc_test_log(), "B by fast failed: no light at 2"));
  g_assert_nonnull(strstr(opc_test_log(), "1 of 6 runs failed"));
  failing = limited = -1;
}

/* Methods may use different plugins that publish metrics of the same name in
   different units. */
static int run_units(size_t point, opc_error *error) {
  int code = run_point(point, error);
  if (point % METHODS) inner.metrics[0].metric = &dose;
  return code;
}

static void test_units(void) {
  opc_error error;
  inner_flow other = flow;
  other.point = run_units;
  experiment e = {.host = inner_host(other)};
  g_assert_cmpint(run_experiment(&e, NULL, &error), ==, OPC_OK);
  const opc_table *t = opc_test_table("experiment");
  int found = 0;
  for (size_t c = 0; c < t->n_columns; c++) {
    if (strcmp(t->columns[c].name, "mask.ion") != 0) continue;
    const double *values = t->columns[c].data;
    int first = !strcmp(t->columns[c].unit, "%");
    found += first ? 1 : 10;
    for (size_t i = 0; i < ALL; i++)
      g_assert_true((i % METHODS == 0) == first ? values[i] == formula(i)
                                                : isnan(values[i]));
  }
  g_assert_cmpint(found, ==, 11);
}

static int run_dark(size_t point, opc_error *error) {
  return opc_fail(error, OPC_FAILED, NULL, "dark %zu", point);
}

static int run_cancelled(size_t point, opc_error *error) {
  return point ? opc_fail(error, OPC_CANCELLED, NULL, "cancelled")
               : run_point(point, error);
}

static void test_refused(void) {
  static const opc_pair wrong = {"ion", "head"};
  opc_error error = {0};
  inner_flow other = flow;
  other.point = run_dark;
  experiment dark = {.host = inner_host(other)};
  g_assert_cmpint(run_experiment(&dark, NULL, &error), ==, OPC_FAILED);
  g_assert_cmpstr(error.message, ==, "no run succeeded: dark 0");
  other.point = run_cancelled;
  experiment ended = {.host = inner_host(other)};
  g_assert_cmpint(run_experiment(&ended, NULL, &error), ==, OPC_CANCELLED);
  g_assert_cmpuint(inner.n_points, ==, 2);
  experiment column = {.host = inner_host(flow), .columns = {&wrong, 1}};
  g_assert_cmpint(run_experiment(&column, NULL, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "columns.ion");
  other.n_axes = 3;
  experiment swept = {.host = inner_host(other), .flow = "inner.yaml"};
  g_assert_cmpint(run_experiment(&swept, NULL, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "flow");
  g_assert_nonnull(strstr(error.message, "'inner.yaml' sweeps 'mask.limit'"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/experiment/table", test_table);
  g_test_add_func("/experiment/summary", test_summary);
  g_test_add_func("/experiment/failing", test_failing);
  g_test_add_func("/experiment/units", test_units);
  g_test_add_func("/experiment/refused", test_refused);
  return g_test_run();
}
