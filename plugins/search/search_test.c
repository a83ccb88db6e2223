/* SPDX-License-Identifier: BSD-3-Clause */
/* Searches of a flow whose figure is a formula of two parameters. The best
   setting is compared with the least or greatest value over all settings. */
#include "search.h"

#include <math.h>

#include "tests/inner.h"

/* ---- a flow ---- */

static const opc_metric figure = {"ion", "%", OPC_LOWER, 0, "a figure"};
static const opc_metric effort = {"simulations", NULL, OPC_LOWER, 0, "effort"};

enum { LENGTHS = 3, MOVES = 4, ALL = LENGTHS * MOVES };
static const double lengths[LENGTHS] = {10, 20, 30};
static const double moves[MOVES] = {0, 1, 2, 4};
static const char *const length_texts[] = {"10 nm", "20 nm", "30 nm"};
static const char *const move_texts[] = {"0", "1", "2", "4"};
static const opc_inner_axis axes[] = {
    {"mask.length", "nm", LENGTHS, lengths, length_texts, 1},
    {"mask.moves", NULL, MOVES, moves, move_texts, 1}};

/* Return the figure. The minimum is at 20 nm, and equal for 1 and 2 moves; the
   maximum is at 30 nm and 4 moves. */
static double formula(double length, double move) {
  return (length - 20) * (length - 19) / 4 + (move - 1.5) * (move - 1.5);
}

static double truth(size_t setting) {
  return formula(lengths[setting / MOVES], moves[setting % MOVES]);
}

static int failing = -1; /* point of the failing run */
static double later;     /* added to the figure when the best setting runs
                            again */

static int run_point(size_t point, opc_error *error) {
  inner.n_metrics = 0;
  inner_report("mask", &effort, 7);
  if ((int)point == failing)
    return opc_fail(error, OPC_FAILED, NULL, "no light at %zu", point);
  int last = inner.keep[inner.n_points - 1];
  inner_report("mask.synthesizer", &figure,
               -1000); /* metric of another plugin */
  inner_report("mask", &figure, truth(point) + (last ? later : 0));
  return OPC_OK;
}

static int mask; /* its address represents a mask */
static const inner_flow flow = {.axes = axes,
                                .n_axes = 2,
                                .metric = &figure,
                                .path = "mask.ion",
                                .mask = "mask",
                                .object = &mask,
                                .point = run_point};

/* ---- searches ---- */

static const opc_step *functions(void) { return opcflow_plugin()->functions; }

/* Check and run a search, release the outputs, and return the code. */
static int run_search(search *s, opc_error *error) {
  void *outputs[2] = {NULL, NULL};
  int code = opcflow_plugin()->check(s, error);
  if (!code) code = functions()->run(s, outputs, error);
  if (!code) {
    const eda_settings *all = outputs[1];
    g_assert_true(outputs[0] == &mask);
    g_assert_cmpint(eda_settings_check(all, error), ==, OPC_OK);
    g_assert_cmpuint(all->n_parameters, ==, inner.n_axes);
    for (size_t i = 0; i < all->count; i++)
      if (!isnan(all->figure[i]))
        g_assert_true(all->figure[i] == opc_test_number("settings", "ion", i) ||
                      all->figure[i] ==
                          opc_test_number("settings", "mask.ion", i) ||
                      all->figure[i] == opc_test_number("settings", "cost", i));
    eda_settings_free(outputs[1]);
  }
  opcflow_plugin()->clear(s);
  return code;
}

static size_t best_of(int greatest) {
  size_t best = 0;
  for (size_t i = 1; i < ALL; i++)
    if (greatest ? truth(i) > truth(best) : truth(i) < truth(best)) best = i;
  return best;
}

/* Each setting runs once, in order. Then the best setting runs again, and its
   files are kept. If settings are equal, the first is the best. */
static void test_all(void) {
  for (int greatest = 0; greatest < 2; greatest++) {
    opc_error error;
    search s = {.host = inner_host(flow),
                .minimise = greatest ? NULL : "mask.ion",
                .maximise = greatest ? "mask.ion" : NULL};
    inner.shared[inner.n_shared++] = (opc_inner_metric){"gates", &effort, 3};
    size_t best = best_of(greatest);
    g_assert_cmpint(run_search(&s, &error), ==, OPC_OK);
    g_assert_cmpuint(inner.n_points, ==, ALL + 1);
    for (size_t i = 0; i < ALL; i++) {
      g_assert_cmpuint(inner.points[i], ==, i);
      g_assert_cmpint(inner.keep[i], ==, 0);
      g_assert_true(opc_test_number("settings", "mask.ion", i) == truth(i));
      g_assert_true(opc_test_number("settings", "mask.length", i) ==
                    lengths[i / MOVES]);
      g_assert_true(opc_test_number("settings", "mask.moves", i) ==
                    moves[i % MOVES]);
      g_assert_cmpstr(opc_test_text("settings", "result", i), ==, "good");
    }
    g_assert_cmpuint(inner.points[ALL], ==, best);
    g_assert_cmpint(inner.keep[ALL], ==, 1);
    g_assert_true(opc_test_metric(greatest ? "greatest" : "least") ==
                  truth(best));
    g_assert_cmpfloat(opc_test_metric("setting"), ==, (double)best + 1);
    g_assert_cmpfloat(opc_test_metric("settings"), ==, ALL);
    g_assert_cmpfloat(opc_test_metric("runs"), ==, ALL);
    g_assert_cmpfloat(opc_test_metric("failed"), ==, 0);
    g_assert_cmpfloat(opc_test_metric("simulations"), ==, 3 + 7 * (ALL + 1));
    g_assert_cmpstr(opc_test_text("best", "value", 0), ==,
                    length_texts[best / MOVES]);
    g_assert_cmpstr(opc_test_text("best", "value", 1), ==,
                    move_texts[best % MOVES]);
  }
  g_assert_true(
      truth(best_of(0)) ==
      truth(best_of(0) + 1)); /* two best settings with equal figures */
}

/* ---- the weighted sum of squares ---- */

static const opc_metric leakage = {"leak", "%", OPC_LOWER, 0, "a figure"};

/* Return a second figure, smallest at 10 nm and 4 moves. */
static double leak(double length, double move) {
  return length / 10 + 3 / (1 + move);
}

static double table_leak[16];

/* Run the settings of a length; the table has a row for each number of
   moves. */
static int run_weighted(size_t point, opc_error *error) {
  static double at[16], ion[16];
  static const opc_column columns[] = {{"at", NULL, OPC_REAL, 0, at},
                                       {"ion", "%", OPC_REAL, 0, ion},
                                       {"leak", "%", OPC_REAL, 0, table_leak}};
  int code = run_point(point, error);
  double length = lengths[point / MOVES];
  inner_report("mask", &leakage, leak(length, moves[point % MOVES]));
  inner.columns = columns;
  inner.n_columns = 3;
  for (inner.rows = 0; inner.rows <= point % MOVES; inner.rows++) {
    at[inner.rows] = moves[inner.rows];
    ion[inner.rows] = formula(length, moves[inner.rows]);
    table_leak[inner.rows] = leak(length, moves[inner.rows]);
  }
  return code;
}

/* Test eq. 2.5 with and without a shared run. */
static void test_weights(void) {
  static const char *const q2[] = {"0", "0.5", "100"};
  static const opc_pair pair = {"mask.moves", "mask.history.at"};
  for (size_t k = 0; k < 2 * G_N_ELEMENTS(q2); k++) {
    const opc_pair pairs[] = {{"mask.ion", "2"}, {"mask.leak", q2[k / 2]}};
    double q = g_ascii_strtod(q2[k / 2], NULL);
    inner_flow weighted = flow;
    weighted.more = &leakage;
    weighted.more_path = "mask.leak";
    weighted.point = run_weighted;
    search s = {.host = inner_host(weighted),
                .weights = {pairs, 2},
                .along = {&pair, k % 2}};
    opc_error error;
    if (run_search(&s, &error)) g_error("%s", error.message);
    double least = INFINITY;
    size_t best = 0;
    for (size_t i = 0; i < ALL; i++) {
      double l = lengths[i / MOVES], m = moves[i % MOVES];
      double known = 2 * pow(formula(l, m), 2) + q * pow(leak(l, m), 2);
      g_assert_cmpfloat(fabs(opc_test_number("settings", "cost", i) - known), <,
                        1e-9 * known + 1e-12);
      if (known < least) least = known, best = i;
    }
    g_assert_cmpfloat(opc_test_metric("setting"), ==, (double)best + 1);
    g_assert_cmpfloat(opc_test_metric("runs"), ==, k % 2 ? LENGTHS : ALL);
    g_assert_cmpint(best == best_of(0), ==, q == 0);
  }
}

/* ---- settings that share a run ---- */

/* Table of a run: `at` rises by 0.5 up to the limit of the run. */
static double table_at[16], table_ion[16];
static const opc_column table[] = {{"at", NULL, OPC_REAL, 0, table_at},
                                   {"ion", "%", OPC_REAL, 0, table_ion}};
static double rest; /* value at which a run converges and ends */

static int run_rows(size_t point, opc_error *error) {
  double most = fmin(moves[point % MOVES], rest);
  int code = run_point(point, error);
  inner.columns = table;
  inner.n_columns = 2;
  for (inner.rows = 0; 0.5 * (double)inner.rows <= most; inner.rows++) {
    double at = 0.5 * (double)inner.rows;
    table_at[inner.rows] = at;
    table_ion[inner.rows] = formula(lengths[point / MOVES], at);
  }
  return code;
}

static void test_shared(void) {
  static const opc_pair pair = {"mask.moves", "mask.history.at"};
  static const double ends[] = {100, 1.5}; /* beyond all values; between
                                              values */
  for (size_t k = 0; k < G_N_ELEMENTS(ends); k++) {
    inner_flow shared = flow;
    opc_error error;
    shared.point = run_rows;
    rest = ends[k];
    search s = {.host = inner_host(shared),
                .minimise = "mask.ion",
                .along = {&pair, 1}};
    int code = run_search(&s, &error);
    if (code) g_error("%s", error.message);
    g_assert_cmpuint(inner.n_points, ==, LENGTHS + 1);
    g_assert_cmpfloat(opc_test_metric("runs"), ==, LENGTHS);
    for (size_t i = 0; i < LENGTHS; i++) {
      g_assert_cmpuint(inner.points[i], ==, (i + 1) * MOVES - 1);
      g_assert_cmpuint(inner.shares[i], ==, MOVES);
    }
    for (size_t i = 0; i < ALL; i++) {
      double at = fmin(moves[i % MOVES], rest);
      g_assert_true(opc_test_number("settings", "mask.ion", i) ==
                    formula(lengths[i / MOVES], at));
      size_t runs_before = i / MOVES;
      g_assert_cmpfloat(opc_test_number("settings", "run", i), ==,
                        (double)runs_before + 1);
    }
    if (k) continue;
    g_assert_cmpfloat(opc_test_metric("setting"), ==, (double)best_of(0) + 1);
    g_assert_null(strstr(opc_test_log(), "run alone has"));
  }
}

/* The shared parameter is the first axis, so that the settings of a run are not
   adjacent. The figure has the minimum 0 at settings 1 and 3. The run of
   setting 3 comes first, and one of the runs fails. */
static const opc_inner_axis turned[] = {
    {"mask.moves", NULL, MOVES, moves, move_texts, 1},
    {"mask.length", "nm", LENGTHS, lengths, length_texts, 1}};

static int run_turned(size_t point, opc_error *error) {
  size_t length = point % LENGTHS;
  int code = run_point(point, error);
  inner.columns = table;
  inner.n_columns = 2;
  for (inner.rows = 0; inner.rows < MOVES; inner.rows++) {
    table_at[inner.rows] = moves[inner.rows];
    table_ion[inner.rows] = fabs((double)(inner.rows + length) - 1);
  }
  return code;
}

static void test_turned(void) {
  static const opc_pair pair = {"mask.moves", "mask.history.at"};
  inner_flow other = flow;
  opc_error error;
  other.axes = turned;
  other.point = run_turned;
  search s = {
      .host = inner_host(other), .minimise = "mask.ion", .along = {&pair, 1}};
  failing = ALL - 1;
  int code = run_search(&s, &error);
  failing = -1;
  if (code) g_error("%s", error.message);
  g_assert_cmpuint(inner.n_points, ==, LENGTHS + 1);
  for (size_t i = 0; i < LENGTHS; i++)
    g_assert_cmpuint(inner.points[i], ==, ALL - LENGTHS + i);
  for (size_t i = 0; i < ALL; i++) {
    size_t steps = i / LENGTHS + i % LENGTHS;
    double want = fabs((double)steps - 1);
    double got = opc_test_number("settings", "mask.ion", i);
    g_assert_true(i % LENGTHS == 2 ? isnan(got) : got == want);
  }
  g_assert_cmpfloat(opc_test_metric("failed"), ==, MOVES);
  g_assert_cmpfloat(opc_test_metric("setting"), ==, 1 + 1);
}

/* ---- errors ---- */

/* If the run of the best setting fails, the next best setting is the best. */
static void test_failing(void) {
  opc_error error;
  search s = {.host = inner_host(flow), .minimise = "mask.ion"};
  failing = (int)best_of(0);
  g_assert_cmpint(run_search(&s, &error), ==, OPC_OK);
  g_assert_cmpfloat(opc_test_metric("failed"), ==, 1);
  g_assert_cmpfloat(
      opc_test_metric("setting"), ==,
      failing + 2); /* the equal setting is a neighbour of the failed one */
  g_assert_true(
      isnan(opc_test_number("settings", "mask.ion", (size_t)failing)));
  g_assert_nonnull(
      strstr(opc_test_text("settings", "result", (size_t)failing), "no light"));
  g_assert_nonnull(strstr(opc_test_log(), "1 of 12 settings failed"));
  failing = -1;
}

static int run_cancelled(size_t point, opc_error *error) {
  return point < 2 ? run_point(point, error)
                   : opc_fail(error, OPC_CANCELLED, NULL, "cancelled");
}

static int run_dark(size_t point, opc_error *error) {
  inner.n_metrics = 0;
  return opc_fail(error, OPC_FAILED, NULL, "dark %zu", point);
}

/* Cancellation ends the search at once; if all runs fail, the search returns
   the error of a run. */
static void test_ends(void) {
  inner_flow other = flow;
  opc_error error;
  other.point = run_cancelled;
  search s = {.host = inner_host(other), .minimise = "mask.ion"};
  g_assert_cmpint(run_search(&s, &error), ==, OPC_CANCELLED);
  g_assert_cmpuint(inner.n_points, ==, 3);
  other.point = run_dark;
  search t = {.host = inner_host(other), .minimise = "mask.ion"};
  g_assert_cmpint(run_search(&t, &error), ==, OPC_FAILED);
  g_assert_cmpstr(error.message, ==, "no setting has a value: dark 0");
}

/* If the figure differs in the repeated run of the best setting, a warning has
   both values. */
static void test_differs(void) {
  opc_error error;
  search s = {.host = inner_host(flow), .minimise = "mask.ion"};
  later = 0.5;
  g_assert_cmpint(run_search(&s, &error), ==, OPC_OK);
  later = 0;
  g_autofree char *both = g_strdup_printf(
      "has %.9g, expected %.9g", truth(best_of(0)) + 0.5, truth(best_of(0)));
  g_assert_nonnull(strstr(opc_test_log(), both));
}

static void assert_refused(search s, const char *parameter,
                           const char *message) {
  opc_error error = {0};
  int code = opcflow_plugin()->check(&s, &error);
  opcflow_plugin()->clear(&s);
  g_assert_cmpint(code, ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, parameter);
  if (!strstr(error.message, message)) g_error("%s", error.message);
}

static void test_refused(void) {
  static const opc_pair unit = {"mask.length", "mask.history.at"},
                        other = {"mask.moves", "gates.history.at"},
                        none = {"mask.moves", "at"};
  const opc_host *host = inner_host(flow);
  const char *ion = "mask.ion";
  assert_refused((search){.host = host}, "",
                 "requires one of 'minimise', 'maximise' and 'weights'");
  assert_refused((search){.host = host, .minimise = ion, .maximise = ion}, "",
                 "requires one of");
  static const opc_pair bad = {"mask.ion", "-1"}, absent = {"mask.in", "1"};
  assert_refused((search){.host = host, .minimise = ion, .weights = {&bad, 1}},
                 "", "requires one of");
  assert_refused((search){.host = host, .weights = {&bad, 1}},
                 "weights.mask.ion", "at least 0, found '-1'");
  assert_refused((search){.host = host, .weights = {&absent, 1}},
                 "weights.mask.in", "no metric 'mask.in'");
  assert_refused((search){.host = host, .maximise = "mask.in"}, "maximise",
                 "no metric 'mask.in'");
  assert_refused((search){.host = host, .minimise = ion, .along = {&unit, 1}},
                 "along.mask.length", "requires increasing numbers");
  assert_refused((search){.host = host, .minimise = ion, .along = {&other, 1}},
                 "along.mask.moves", "found step 'gates'");
  assert_refused((search){.host = host, .minimise = ion, .along = {&none, 1}},
                 "along.mask.moves", "does not name a column");
  assert_refused((search){.host = host, .minimise = ion, .mask = "gates"},
                 "mask",
                 "'gates' makes no mask: 'mask' must name the step whose mask "
                 "is the output, such as 'mask'");
  inner.n_axes = 0;
  assert_refused((search){.host = host, .minimise = ion}, "",
                 "requires a 'sweep'");
  opc_inner_axis idle = axes[0];
  idle.used = 0;
  inner.axes = &idle;
  inner.n_axes = 1;
  assert_refused((search){.host = host, .minimise = ion}, "sweep.mask.length",
                 "has no effect");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/search/all", test_all);
  g_test_add_func("/search/weights", test_weights);
  g_test_add_func("/search/shared", test_shared);
  g_test_add_func("/search/turned", test_turned);
  g_test_add_func("/search/failing", test_failing);
  g_test_add_func("/search/ends", test_ends);
  g_test_add_func("/search/differs", test_differs);
  g_test_add_func("/search/refused", test_refused);
  return g_test_run();
}
