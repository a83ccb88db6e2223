/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the statistics of a correction's report. */
#include <glib.h>
#include <math.h>

#include <correct/report.h>

/* Statistics of the deviations +1, +3 and one transistor that does not print,
   by hand. */
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

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/report/statistics", test_statistics);
  return g_test_run();
}
