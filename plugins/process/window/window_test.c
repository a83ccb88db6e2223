/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the process window of gratings against closed forms, and against known
   results of the optics. */
#include "waves_test.h"

static void test_closed_form(void) {
  lines l;
  opc_error error;
  lines_make(&l);
  int code = run_step("{ " LITHO ", " RESIST
                      ", dose: [-12 %, -5 %, 0 %, 6 %], "
                      "defocus: [-120 nm, 0 nm, 90 nm], cut_lines: true }",
                      &with_focus, &l, &error);
  if (code) g_error("%s", error.message);
  const double focus[] = {-120, 0, 90}, dose[] = {-12, -5, 0, 6};
  const double *mean = column("process_window", "mean");
  const double *min = column("process_window", "min");
  const double *max = column("process_window", "max");
  const double *nils = column("process_window", "nils");
  const double *printed = column("cut_lines", "printed");
  const double *low = column("cut_lines", "ils_low");
  const double *high = column("cut_lines", "ils_high");
  double worst = 0, least = INFINITY;
  for (int k = 0; k < 12; k++) {
    double ils, want = length_at(focus[k / 4], dose[k % 4], &ils);
    g_assert_cmpfloat(column("process_window", "defocus")[k], ==, focus[k / 4]);
    g_assert_cmpfloat(column("process_window", "dose")[k], ==, dose[k % 4]);
    worst = fmax(worst, fabs(mean[k] - (want - drawn)));
    worst = fmax(worst, fabs(min[k] - (want - drawn)));
    worst = fmax(worst, fabs(max[k] - (want - drawn)));
    g_assert_cmpfloat(fabs(nils[k] - ils * drawn), <, 1e-4);
    least = fmin(least, ils * drawn);
    for (int i = 0; i < GATES; i++) {
      worst = fmax(worst, fabs(printed[k * GATES + i] - want));
      g_assert_cmpfloat(fabs(low[k * GATES + i] - ils), <, 2e-6);
      g_assert_cmpfloat(fabs(high[k * GATES + i] - ils), <, 2e-6);
    }
  }
  g_test_message("largest error of a length %.2g nm", worst);
  g_assert_cmpfloat(worst, <, 1e-3);
  g_assert_cmpfloat(fabs(opc_test_metric("nils_min") - least), <, 1e-4);
  g_assert_cmpfloat(opc_test_metric("failed_max"), ==, 0);
}

/* Test the doses and foci at which lengths leave the tolerance against the
   closed form. */
static void test_limits(void) {
  lines l;
  opc_error error;
  double ils, nominal = length_at(0, 0, &ils);
  lines_make(&l);
  for (int i = 0; i < GATES; i++) l.length[i] = nominal;
  GString *mapping = g_string_new("{ " LITHO ", " RESIST
                                  ", file: w.svg, tolerance: 4 %, dose: [");
  for (int d = -20; d <= 20; d++)
    g_string_append_printf(mapping, "%s%g %%", d > -20 ? ", " : "", 0.4 * d);
  g_string_append(mapping, "], defocus: [");
  for (int f = -12; f <= 12; f++)
    g_string_append_printf(mapping, "%s%d nm", f > -12 ? ", " : "", 20 * f);
  g_string_append(mapping, "] }");
  if (run_step(mapping->str, &with_focus, &l, &error))
    g_error("%s", error.message);
  double limit = 0.04;
  double low = -30, high = 30, depth = 400;
  for (int side = 0; side < 3; side++) {
    double from = 0, to = side == 0 ? low : side == 1 ? high : depth;
    for (int i = 0; i < 60; i++) {
      double middle = (from + to) / 2;
      double d =
          length_at(side == 2 ? middle : 0, side == 2 ? 0 : middle, &ils);
      if (fabs(d / nominal - 1) <= limit)
        from = middle;
      else
        to = middle;
    }
    *(side == 0 ? &low : side == 1 ? &high : &depth) = from;
  }
  const double *table_low = column("exposure_latitude", "lowest_dose");
  const double *table_high = column("exposure_latitude", "highest_dose");
  g_test_message(
      "doses %.3f .. %.3f, expected %.3f .. %.3f; depth of focus %.2f, "
      "expected %.2f",
      table_low[12], table_high[12], low, high,
      opc_test_metric("depth_of_focus"), 2 * depth);
  g_assert_cmpfloat(fabs(table_low[12] - low), <, 0.01);
  g_assert_cmpfloat(fabs(table_high[12] - high), <, 0.01);
  g_assert_cmpfloat(fabs(opc_test_metric("exposure_latitude") - (high - low)),
                    <, 0.3);
  g_assert_cmpfloat(fabs(opc_test_metric("depth_of_focus") - 2 * depth), <, 3);
  /* A gate that is drawn longer requires less dose. */
  l.length[2] = 1.02 * nominal;
  if (run_step(mapping->str, &with_focus, &l, &error))
    g_error("%s", error.message);
  table_high = column("exposure_latitude", "highest_dose");
  double want = 0, to = 30;
  for (int i = 0; i < 60; i++) {
    double middle = (want + to) / 2;
    if (length_at(0, middle, &ils) / l.length[2] - 1 >= -limit)
      want = middle;
    else
      to = middle;
  }
  g_assert_cmpfloat(want, <, high - 0.5);
  g_assert_cmpfloat(fabs(table_high[12] - want), <, 0.01);
  /* A gate that is within tolerance at no dose of the list: there is no
     window. */
  l.length[2] = 2 * nominal;
  if (run_step(mapping->str, &with_focus, &l, &error))
    g_error("%s", error.message);
  g_assert_cmpfloat(opc_test_metric("exposure_latitude"), ==, 0);
  g_assert_cmpfloat(opc_test_metric("depth_of_focus"), ==, 0);
  g_string_free(mapping, TRUE);
}

/* Test the optics of the thesis: lengths at 0, 100 and 150 nm of defocus equal
   those of a prototype with other code, are symmetric in focus, and decrease
   with dose. */
static void test_optics(void) {
  lines l;
  opc_error error;
  lines_make(&l);
  int code =
      run_step("{ " LITHO
               ", resist: { use: resist.threshold }, margin: 0 nm, "
               "defocus: [-100 nm, 0 nm, 100 nm, 150 nm], file: lines.png }",
               NULL, &l, &error);
  if (code) g_error("%s", error.message);
  const double *mean = column("process_window", "mean");
  const double want[] = {54.5, 65, 54.5, 34};
  g_assert_cmpfloat(fabs(mean[2] - mean[12]), <, 0.01);
  for (int f = 0; f < 4; f++) {
    const double *doses = mean + 5 * f;
    g_test_message("defocus %g nm: %.2f nm",
                   column("process_window", "defocus")[5 * f],
                   drawn + doses[2]);
    g_assert_cmpfloat(fabs(drawn + doses[2] - want[f]), <, f < 3 ? 0.5 : 1);
    for (int d = 1; d < 5; d++)
      g_assert_true(isnan(doses[d]) || doses[d] < doses[d - 1]);
  }
  g_assert_cmpfloat(fabs(column("process_window", "nils")[7] - 0.80), <, 0.02);
  g_autofree char *path =
      g_build_filename(opc_test_folder(), "lines.png", NULL);
  g_assert_true(g_file_test(path, G_FILE_TEST_EXISTS));
}

/* Test that lines that do not print are counted, and limit the window. */
static void test_failing(void) {
  lines l;
  opc_error error;
  lines_make(&l);
  int code = run_step("{ " LITHO ", " RESIST
                      ", tolerance: 50 %, "
                      "dose: [-45 %, 0 %, 60 %, 200 %], defocus: [0 nm] }",
                      &one_focus, &l, &error);
  if (code) g_error("%s", error.message);
  const int64_t *failed =
      (const int64_t *)(const void *)column("process_window", "failed");
  const double *mean = column("process_window", "mean");
  g_assert_cmpint(failed[0], ==, 0);
  g_assert_cmpint(failed[1], ==, 0);
  g_assert_cmpint(failed[3], ==, GATES);
  g_assert_true(isnan(mean[3]));
  g_assert_cmpfloat(opc_test_metric("failed_max"), ==, GATES);
}

static void assert_refused(const char *mapping, lines *l, const char *why) {
  opc_error error;
  g_assert_cmpint(run_step(mapping, &one_focus, l, &error), ==, OPC_INVALID);
  if (!strstr(error.message, why))
    g_error("'%s' does not say '%s'", error.message, why);
}

static void test_refused(void) {
  lines l;
  lines_make(&l);
  assert_refused("{ " LITHO ", " RESIST " }", &l,
                 "'litho.one' has one focus only");
  assert_refused("{ " LITHO ", " RESIST ", defocus: [0 nm] }", NULL,
                 "set either 'mask' or 'gates'");
  assert_refused("{ " LITHO ", " RESIST ", dose: [1 %, 1 %] }", &l,
                 "must increase");
  assert_refused("{ " LITHO ", " RESIST ", dose: [-100 %, 1 %] }", &l,
                 "out of range");
  GString *many = g_string_new("{ " LITHO ", " RESIST ", dose: [0 %");
  for (int i = 1; i <= 100; i++) g_string_append_printf(many, ", %d %%", i);
  g_string_append(many, "] }");
  assert_refused(many->str, &l, "must have 1 to 100 values, found 101");
  g_string_free(many, TRUE);
  assert_refused("{ " LITHO ", " RESIST ", file: a.jpg }", &l,
                 ".png, .svg or .pdf");
  assert_refused("{ " LITHO ", " RESIST ", defocus: [0 nm], margin: 1 nm }", &l,
                 "expected at least 300 nm");
  assert_refused("{ " LITHO ", " RESIST ", overlay_x: [1e300 nm] }", &l,
                 "out of range");
  l.gates.count = 0;
  assert_refused("{ " LITHO ", " RESIST ", defocus: [0 nm] }", &l,
                 "no transistors");
}

/* Test the defaults at 248 nm, NA 0.7: 0.1457 and 0.2915 * 248 / 0.49 = 73.7
   and 147.5 nm of defocus, 3.886 * 248 / 0.7 = 1376.8 nm of margin. */
static void test_follows(void) {
  opc_error error;
  opc_test_forget();
  g_autoptr(opc_module) m = opc_test_module(
      "process.window",
      "{ litho: { use: litho.hopkins, wavelength: 248 nm, na: 0.7 }, resist: { "
      "use: resist.threshold } }",
      &error);
  if (!m) g_error("%s", error.message);
  g_assert_nonnull(strstr(opc_test_log(), "defocus 0, +-74 and +-148 nm"));
  g_assert_nonnull(strstr(opc_test_log(), "margin 1377 nm"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/window/closed-form", test_closed_form);
  g_test_add_func("/window/limits", test_limits);
  g_test_add_func("/window/optics", test_optics);
  g_test_add_func("/window/failing", test_failing);
  g_test_add_func("/window/refused", test_refused);
  g_test_add_func("/window/follows", test_follows);
  return g_test_run();
}
