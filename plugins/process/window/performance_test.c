/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests currents over dose, focus and mask errors, with images and devices in
   closed form. */
#include <eda/extractor.h>

#include "waves_test.h"

/* ---- devices ---- */

/* Devices with Ion = W / L, Ioff = W exp(-L / 10 nm). */
static int no_devices(void *self, opc_error *error) {
  (void)self;
  (void)error;
  return OPC_OK;
}

static size_t in_the_middle(const void *self, const double **place,
                            const double **width) {
  static const double half = 0.5, all = 1;
  (void)self;
  *place = &half;
  *width = &all;
  return 1;
}

static double ion_of(double width, double length) { return width / length; }

static double ioff_of(double width, double length) {
  return width * exp(-length / 10);
}

static int length_extract(const void *self, const eda_slices *in,
                          eda_performance *out, opc_error *error) {
  (void)self;
  (void)error;
  for (size_t i = 0; i < in->count; i++) {
    double w = in->width[i], l = in->length[i];
    out->ion[i] = l > 0 ? ion_of(w, l) : 0;
    out->ioff[i] = l > 0 ? ioff_of(w, l) : 0;
    out->leq_ion[i] = out->leq_ioff[i] = l;
    out->weq[i] = w;
    out->area[i] = w * l;
  }
  return OPC_OK;
}

/* Shortest lengths that the devices cover, of n and p. */
static double modelled[2];

static double modelled_from(const void *self, int type, const char *flavour) {
  (void)self;
  (void)flavour;
  return modelled[type];
}

static const eda_extractor devices = {.prepare = no_devices,
                                      .slicing = in_the_middle,
                                      .extract = length_extract,
                                      .modelled = modelled_from};
static opc_module extractor = {&devices, NULL, "extractor.simple"};

static void window_run(const char *mapping, const eda_litho *litho, lines *l) {
  opc_error error;
  if (run_with(mapping, litho, &extractor, l, &error))
    g_error("%s", error.message);
}

/* ---- closed forms ---- */

static double width_at(double dose) {
  double level = 0.2 / (1 + dose / 100);
  return active_pitch / M_PI * acos((0.5 - level) / contrast(0));
}

/* Return the logarithm of printed over drawn Ion of a gate of drawn length
   `length`. */
static double log_ion(double defocus, double dose, double length) {
  double ils, printed = length_at(defocus, dose, &ils);
  return log(ion_of(width_at(dose), printed) / ion_of(drawn_width, length));
}

static double log_ioff(double defocus, double dose, double length) {
  double ils, printed = length_at(defocus, dose, &ils);
  return log(ioff_of(width_at(dose), printed) / ioff_of(drawn_width, length));
}

/* ---- tests ---- */

static void assert_near(double got, double want, double error) {
  if (!(fabs(got - want) <= error)) g_error("%.10g, not %.10g", got, want);
}

/* Test mean, spread, extremes and sums for two lengths of each type. */
static void test_places(void) {
  lines l;
  lines_make(&l);
  const double lengths[] = {65, 70, 66, 75}; /* n, p, n, p */
  memcpy(l.length, lengths, sizeof lengths);
  window_run("{ " LITHO ", " RESIST
             ", dose: [-4 %, 0 %, 3 %], defocus: [-90 nm, 0 nm] }",
             &with_focus, &l);
  const double focus[] = {-90, 0}, dose[] = {-4, 0, 3};
  double sd_max = 0, worst_max = 0, leakage_max = 0;
  for (int k = 0; k < 6; k++) {
    double off[4], printed[3] = {0}, as_drawn[3] = {0}, worst = 0;
    for (int i = 0; i < 4; i++) {
      double ioff = ioff_of(drawn_width, lengths[i]);
      off[i] = 100 * expm1(log_ion(focus[k / 3], dose[k % 3], lengths[i]));
      if (fabs(off[i]) > fabs(worst)) worst = off[i];
      as_drawn[i % 2] += ioff;
      as_drawn[2] += ioff;
      printed[i % 2] +=
          ioff * exp(log_ioff(focus[k / 3], dose[k % 3], lengths[i]));
    }
    printed[2] = printed[0] + printed[1];
    assert_near(column("performance_window", "ion_n")[k], (off[0] + off[2]) / 2,
                1e-3);
    assert_near(column("performance_window", "ion_p")[k], (off[1] + off[3]) / 2,
                1e-3);
    assert_near(column("performance_window", "sd_n")[k],
                fabs(off[0] - off[2]) / 2, 1e-3);
    assert_near(column("performance_window", "sd_p")[k],
                fabs(off[1] - off[3]) / 2, 1e-3);
    assert_near(column("performance_window", "ion_worst")[k], worst, 1e-3);
    assert_near(column("performance_window", "leakage_n")[k],
                printed[0] / as_drawn[0], 1e-4);
    assert_near(column("performance_window", "leakage_p")[k],
                printed[1] / as_drawn[1], 1e-4);
    assert_near(column("performance_window", "leakage")[k],
                printed[2] / as_drawn[2], 1e-4);
    sd_max = fmax(sd_max, fabs(off[1] - off[3]) / 2);
    worst_max = fmax(worst_max, fabs(worst));
    leakage_max = fmax(leakage_max, printed[2] / as_drawn[2]);
  }
  assert_near(opc_test_metric("ion_sd_max"), sd_max, 1e-3);
  assert_near(opc_test_metric("ion_worst"), worst_max, 1e-3);
  assert_near(opc_test_metric("leakage_max"), leakage_max, 1e-3);
  g_assert_cmpfloat(opc_test_metric("transistors_failed_max"), ==, 0);
  g_assert_cmpfloat(opc_test_metric("outside_max"), ==, 0);
}

/* A larger dose prints shorter gates. At the nominal dose, the n-transistors
   are shorter than their model covers, and the p-transistors are not. */
static void test_short_slices(void) {
  lines l;
  double ils, length = length_at(0, 0, &ils);
  lines_make(&l);
  modelled[EDA_NMOS] = length + 0.1;
  modelled[EDA_PMOS] = length - 0.1;
  g_assert_cmpfloat(length_at(0, 3, &ils), <, length - 0.2);
  g_assert_cmpfloat(length_at(0, -4, &ils), >, length + 0.2);
  window_run("{ " LITHO ", " RESIST
             ", dose: [-4 %, 0 %, 3 %], defocus: [0 nm] }",
             &with_focus, &l);
  g_autofree char *text = g_strdup_printf(
      "2 of 4 slices, in 2 transistors, are shorter than the device model "
      "covers: the shortest is %.1f nm long, its model begins at %g nm",
      length, modelled[EDA_NMOS]);
  g_assert_nonnull(strstr(opc_test_log(), text));
  g_assert_cmpfloat(opc_test_metric("short_slices_max"), ==, 4);
  window_run("{ " LITHO ", " RESIST
             ", dose: [-4 %, 0 %, 200 %], defocus: [0 nm] }",
             &with_focus, &l);
  g_assert_cmpfloat(opc_test_metric("transistors_failed_max"), ==, GATES);
  g_assert_cmpfloat(opc_test_metric("short_slices_max"), ==, 2);
  modelled[EDA_NMOS] = modelled[EDA_PMOS] = 0;
  window_run("{ " LITHO ", " RESIST ", dose: [0 %], defocus: [0 nm] }",
             &with_focus, &l);
  g_assert_null(strstr(opc_test_log(), "shorter than"));
  g_assert_cmpfloat(opc_test_metric("short_slices_max"), ==, 0);
}

/* Return the area of doses from -8 % to 8 % and foci from -120 to 120 nm in
   which both lengths meet the limits, from a million samples. */
static double count_area(int ion, int ioff, double a, double b) {
  enum { N = 1000 };
  size_t good = 0;
  double most = log(1.05), least = log(0.95), leak = log(1.4);
  for (int i = 0; i < N; i++)
    for (int k = 0; k < N; k++) {
      double f = -120 + 240 * (i + 0.5) / N, d = -8 + 16 * (k + 0.5) / N;
      double x = log_ion(f, d, a), y = log_ion(f, d, b);
      double u = log_ioff(f, d, a), v = log_ioff(f, d, b);
      good += (!ion || (fmin(x, y) >= least && fmax(x, y) <= most)) &&
              (!ioff || fmax(u, v) <= leak);
    }
  return 16. * 240 * (double)good / N / N;
}

static void test_area(void) {
  lines l;
  double ils, length = length_at(60, 0, &ils);
  lines_make(&l);
  for (int i = 0; i < GATES; i++) {
    l.length[i] = i == 2 ? 1.03 * length : length;
  }
  GString *mapping = g_string_new(
      "{ " LITHO ", " RESIST ", ion_limit: 5 %, ioff_limit: 40 %, dose: [");
  for (int d = -16; d <= 16; d++)
    g_string_append_printf(mapping, "%s%g %%", d > -16 ? ", " : "", 0.5 * d);
  g_string_append(mapping, "], defocus: [");
  for (int f = -12; f <= 12; f++)
    g_string_append_printf(mapping, "%s%d nm", f > -12 ? ", " : "", 10 * f);
  g_string_append(mapping, "] }");
  window_run(mapping->str, &with_focus, &l);
  static const struct {
    int ion, ioff;
    const char *name;
  } kinds[] = {
      {1, 0, "ion_window"}, {0, 1, "ioff_window"}, {1, 1, "both_window"}};
  for (int k = 0; k < 3; k++) {
    double want =
        count_area(kinds[k].ion, kinds[k].ioff, length, 1.03 * length);
    double got = opc_test_metric(kinds[k].name);
    g_test_message("%s %.1f, expected %.1f %% nm", kinds[k].name, got, want);
    g_assert_cmpfloat(want, >, 100);
    g_assert_cmpfloat(fabs(got / want - 1), <, 0.005);
  }
  g_string_free(mapping, TRUE);
}

/* Compare the interpolation between four conditions with samples. */
static void test_between(void) {
  enum { N = 1500 };
  lines l;
  double ils, length = length_at(0, 0, &ils);
  lines_make(&l);
  for (int i = 0; i < GATES; i++) l.length[i] = length;
  window_run("{ " LITHO ", " RESIST
             ", ion_limit: 4 %, ioff_limit: 20 %, dose: [-7 %, 6 %], "
             "defocus: [0 nm, 140 nm] }",
             &with_focus, &l);
  size_t good[3] = {0};
  for (int i = 0; i < N; i++)
    for (int k = 0; k < N; k++) {
      double f = (i + 0.5) / N, d = (k + 0.5) / N, on = 0, off = 0;
      for (int c = 0; c < 4; c++) {
        double share = (c & 1 ? f : 1 - f) * (c & 2 ? d : 1 - d);
        on += share * log_ion(c & 1 ? 140 : 0, c & 2 ? 6 : -7, length);
        off += share * log_ioff(c & 1 ? 140 : 0, c & 2 ? 6 : -7, length);
      }
      int ion = on >= log(0.96) && on <= log(1.04), ioff = off <= log(1.2);
      good[0] += ion;
      good[1] += ioff;
      good[2] += ion && ioff;
    }
  static const char *const names[] = {"ion_window", "ioff_window",
                                      "both_window"};
  for (int k = 0; k < 3; k++) {
    double want = 13. * 140 * (double)good[k] / N / N;
    double got = opc_test_metric(names[k]);
    g_test_message("%s %.2f, sampled %.2f %% nm", names[k], got, want);
    g_assert_cmpfloat(want, >, 50);
    g_assert_cmpfloat(fabs(got - want), <, 1e-3 * want);
  }
}

/* Test the length on masks with all shapes larger or smaller. */
static void test_mask_error(void) {
  lines l;
  double ils, length[3], on[3];
  lines_make(&l);
  window_run(
      "{ " LITHO ", " RESIST
      ", dose: [0 %], defocus: [0 nm], mask_error: [-1 nm, 0 nm, 1.5 nm] }",
      &with_focus, &l);
  const double by[] = {-1, 0, 1.5};
  double sxx = 0, meef = 0, ion = 0, mean = 0.5 / 3;
  for (int k = 0; k < 3; k++) {
    length[k] = length_of(0, 0, by[k], &ils);
    on[k] = log(ion_of(width_at(0), length[k]));
    assert_near(column("mask_error", "mean")[k], length[k] - drawn, 1e-3);
    sxx += (by[k] - mean) * (by[k] - mean);
    meef += (by[k] - mean) * length[k] / 2;
    ion += (by[k] - mean) * on[k] * 100;
  }
  g_test_message("MEEF %.4f, Ion %.3f %% per nm", meef / sxx, ion / sxx);
  g_assert_cmpfloat(meef / sxx, >, 0.1);
  assert_near(opc_test_metric("meef_mean"), meef / sxx, 1e-3);
  assert_near(opc_test_metric("meef_max"), meef / sxx, 1e-3);
  assert_near(opc_test_metric("ion_per_nm_mean"), fabs(ion / sxx), 3e-3);
  assert_near(opc_test_metric("ion_per_nm_max"), fabs(ion / sxx), 3e-3);
}

/* Test the optics of the thesis: lines of 65 nm at 250 nm pitch have a MEEF of
   2.2 to 2.6 according to a prototype with other code. */
static void test_meef(void) {
  lines l;
  opc_error error;
  lines_make(&l);
  if (run_step("{ " LITHO ", resist: { use: resist.threshold }, margin: 0 nm, "
               "dose: [0 %], defocus: [0 nm], mask_error: [-1 nm, 1 nm] }",
               NULL, &l, &error))
    g_error("%s", error.message);
  g_test_message("MEEF %.3f", opc_test_metric("meef_mean"));
  g_assert_cmpfloat(opc_test_metric("meef_mean"), >, 2.2);
  g_assert_cmpfloat(opc_test_metric("meef_max"), <, 2.6);
}

/* A displaced image of active equals the image of displaced shapes. The active
   ends 50 nm beside the gates on one side. */
static void test_overlay(void) {
  static const int32_t x[] = {-20, 30}, y[] = {0, 30};
  static const char *const columns[] = {"ion_n", "ion_p", "leakage_n",
                                        "leakage_p"};
  const eda_gates *sample = eda_gates_sample();
  g_autofree char *table = g_build_filename(g_getenv("OPCFLOW_SOURCE"), "data",
                                            "devices", "ptm65.yaml", NULL);
  double got[4][4], largest = 0;
  for (size_t k = 0; k <= 4; k++) {
    g_autofree char *map = g_strdup_printf(
        "{ litho: { use: litho.hopkins }, resist: { use: resist.threshold }, "
        "extractor: { use: extractor.plain, devices: '%s' }, dose: [0 %%], "
        "defocus: [0 nm]%s }",
        table,
        k ? "" : ", overlay_x: [-20 nm, 30 nm], overlay_y: [0 nm, 30 nm]");
    opc_error error;
    void *none[1];
    opc_test_forget();
    g_autoptr(opc_module) m = opc_test_module("process.window", map, &error);
    if (!m) g_error("%s", error.message);
    eda_gates gates = *sample;
    eda_shapes moved[2] = {sample->drawn[0], sample->drawn[1]};
    eda_shapes *active = &moved[EDA_ACTIVE];
    uint32_t n = active->start[active->count];
    g_autofree eda_point *points =
        g_memdup2(active->points, n * sizeof *points);
    for (uint32_t i = 0; i < n; i++) {
      if (points[i].x > 200) points[i].x = 110;
      points[i].x += k ? x[(k - 1) % 2] : 0;
      points[i].y += k ? y[(k - 1) / 2] : 0;
    }
    active->points = points;
    gates.drawn = moved;
    opc_test_input(m, "gates", &gates);
    if (opc_test_run(m, none, &error)) g_error("%s", error.message);
    for (size_t i = 0; i < 4 && !k; i++)
      for (size_t c = 0; c < 4; c++)
        got[i][c] = column("overlay", columns[c])[i];
    for (size_t c = 0; c < 4 && k; c++) {
      double want = column("performance_window", columns[c])[0];
      assert_near(got[k - 1][c], want, c < 2 ? 0.02 : 0.01 * want);
      if (c < 2) largest = fmax(largest, fabs(want - got[0][c]));
    }
  }
  g_assert_cmpfloat(largest, >, 1);
}

/* Test that a failing gate has no current, and that no adjacent condition meets
   the limits. */
static void test_failing(void) {
  lines l;
  lines_make(&l);
  for (int i = 0; i < GATES; i++) l.length[i] = 85;
  window_run(
      "{ " LITHO ", " RESIST
      ", ion_limit: 500 %, ioff_limit: 1e9 %, "
      "dose: [0 %, 5 %, 200 %], defocus: [0 nm, 10 nm], file: failing.png }",
      &with_focus, &l);
  const int64_t *failed =
      (const int64_t *)(const void *)column("performance_window", "failed");
  g_assert_cmpint(failed[0], ==, 0);
  g_assert_cmpint(failed[2], ==, GATES);
  g_assert_true(isnan(column("performance_window", "ion_n")[2]));
  g_assert_cmpfloat(opc_test_metric("transistors_failed_max"), ==, GATES);
  assert_near(column("kept_doses", "both")[0], 5, 1e-9);
  assert_near(opc_test_metric("both_window"), 50, 1e-9);
}

static void assert_refused(const char *mapping, const char *why) {
  lines l;
  opc_error error;
  lines_make(&l);
  g_assert_cmpint(run_with(mapping, &with_focus, &extractor, &l, &error), ==,
                  OPC_INVALID);
  if (!strstr(error.message, why))
    g_error("'%s' does not say '%s'", error.message, why);
}

static void test_refused(void) {
  assert_refused("{ " LITHO ", " RESIST ", mask_error: [-1 nm, 0.7 nm] }",
                 "0.7 nm is no multiple of the mask grid of 0.5 nm");
  assert_refused("{ " LITHO ", " RESIST ", mask_error: [1 nm] }",
                 "requires at least two values");
  assert_refused("{ " LITHO ", " RESIST ", mask_error: [1 nm, 0 nm] }",
                 "must increase");
  assert_refused("{ " LITHO ", " RESIST ", overlay_y: [1 nm, 0 nm] }",
                 "must increase");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/performance/places", test_places);
  g_test_add_func("/performance/short-slices", test_short_slices);
  g_test_add_func("/performance/area", test_area);
  g_test_add_func("/performance/between", test_between);
  g_test_add_func("/performance/mask-error", test_mask_error);
  g_test_add_func("/performance/meef", test_meef);
  g_test_add_func("/performance/overlay", test_overlay);
  g_test_add_func("/performance/failing", test_failing);
  g_test_add_func("/performance/refused", test_refused);
  return g_test_run();
}
