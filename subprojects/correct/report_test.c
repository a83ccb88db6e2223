/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the statistics of a correction's report. */
#include <glib.h>
#include <math.h>

#include <correct/report.h>
#include <correct/rules.h>
#include <string.h>

/* Computes by hand the statistics of the deviations +1, +3 and of one
   transistor that does not print. */
static void test_statistics(void) {
  double one[] = {1, 1, 1}, ion[] = {1.01, 1.03, 0}, ioff[] = {0.6, 1.2, 0},
         area[] = {0.98, 1.04, 0};
  uint8_t type[] = {EDA_NMOS, EDA_PMOS, EDA_NMOS};
  uint32_t flags[] = {0, 0, EDA_PRINT_OPEN};
  const eda_gates g = {.count = 3, .type = type};
  const eda_performance design = {3, one, one, one, one, one, one, NULL};
  const eda_performance printed = {3, ion, ioff, one, one, one, area, NULL};
  summary s = correct_summarize(&g, &design, &printed, flags, NULL);
  const double want[][2] = {
      {s.ion_mean, 2},        {s.ion_max, 3},           {s.ion_stdv, 1},
      {s.ion_rms, sqrt(5)},   {s.ioff_rms, sqrt(1000)}, {s.ioff_mean, 30},
      {s.area_mean, 3},       {s.area_max, 4},          {s.ioff_max, 40},
      {s.ioff_total[0], -40}, {s.ioff_total[1], 20},    {s.ioff_total[2], -10},
      {(double)s.failed, 1}};
  for (size_t i = 0; i < G_N_ELEMENTS(want); i++)
    g_assert_cmpfloat(fabs(want[i][0] - want[i][1]), <, 1e-9);
}

/* ---- mask rules ---- */

static char *finding;
static double added;

static void keep_finding(const opc_host *h, int level, const char *format,
                         ...) {
  va_list arguments;
  (void)h;
  if (level != OPC_LOG_FINDING) return;
  va_start(arguments, format);
  finding = g_strdup_vprintf(format, arguments);
  va_end(arguments);
}

static int keep_added(const opc_host *h, const char *name, double value,
                      opc_error *error) {
  (void)h, (void)error;
  if (!strcmp(name, "mask_violations_added")) added = value;
  return OPC_OK;
}

static int skip_table(const opc_host *h, const char *name, uint32_t flags,
                      size_t rows, const opc_column *columns, size_t n,
                      size_t size, opc_error *error) {
  (void)h, (void)name, (void)flags, (void)rows, (void)columns, (void)n;
  (void)size, (void)error;
  return OPC_OK;
}

/* Rules with more violations than in the drawn layout are summed and named. A
   rule with fewer violations does not reduce the sum. */
static void test_rules(void) {
  const opc_host host = {
      .log = keep_finding, .table = skip_table, .metric = keep_added};
  rules_row rows[EDA_RULES] = {{"poly", "space", 40, 5, 5, 31, 10, 20},
                               {"poly", "width", 40, 9, 0, NAN, NAN, NAN},
                               {"poly", "edge", 20, 0, 0, NAN, NAN, NAN},
                               {"poly", "jog", 1, 0, 0, NAN, NAN, NAN}};
  opc_error error;
  g_assert_false(correct_rules_table(&host, rows, EDA_RULES, &error));
  g_assert_null(finding);
  g_assert_true(added == 0);
  rows[EDA_RULE_SPACE].count = 7;
  g_assert_false(correct_rules_table(&host, rows, EDA_RULES, &error));
  g_assert_cmpstr(finding, ==,
                  "the mask violates mask rules: space of 'poly' below 40 nm "
                  "in 7 places (5 as drawn), smallest 31 nm at (10, 20) nm");
  g_assert_true(added == 2);
  g_free(finding);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/report/statistics", test_statistics);
  g_test_add_func("/report/rules", test_rules);
  return g_test_run();
}
