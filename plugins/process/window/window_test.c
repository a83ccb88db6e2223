/* SPDX-License-Identifier: BSD-3-Clause */
/* The process window of gratings: against closed forms, with an image that has
   them, and against known figures of the optics. */
#include <eda/gates.h>
#include <eda/litho.h>
#include <eda/memory.h>
#include <math.h>
#include <string.h>

#include "core/testing/testing.h"

enum { GATES = 4 };
static const double pitch = 250, drawn = 65;

/* ---- gates: four vertical lines ---- */

typedef struct lines {
  eda_point points[4 * GATES];
  uint32_t start[GATES + 1];
  eda_box box[GATES];
  uint8_t axis[GATES];
  double length[GATES], space[2 * GATES];
  eda_shapes poly;
  eda_gates gates;
} lines;

static char *const layer[] = {"poly"};

static void make(lines *l) {
  memset(l, 0, sizeof *l);
  for (int i = 0; i < GATES; i++) {
    int32_t x0 = (int32_t)(2 * (125 - drawn / 2 + pitch * i));
    int32_t x1 = x0 + (int32_t)(2 * drawn);
    eda_point p[] = {{x0, 0}, {x1, 0}, {x1, 4000}, {x0, 4000}};
    memcpy(l->points + 4 * i, p, sizeof p);
    l->start[i + 1] = 4 * (uint32_t)(i + 1);
    l->box[i] = (eda_box){x0, 1500, x1, 2500};
    l->length[i] = drawn;
    l->space[2 * i] = l->space[2 * i + 1] = pitch - drawn;
  }
  l->poly = (eda_shapes){GATES, l->start, l->points, NULL};
  l->gates = (eda_gates){.name = "LINES",
                         .layers = 1,
                         .layer = (char **)layer,
                         .drawn = &l->poly,
                         .grid = 0.5,
                         .extent = {0, 0, 2000, 4000},
                         .count = GATES,
                         .box = l->box,
                         .axis = l->axis,
                         .length = l->length,
                         .space = l->space};
}

/* ---- an image with closed forms ---- */

/* 0.5 - m cos(2 pi (x - 125) / pitch) at any mask, with a contrast m that falls
   with the square of the defocus. */
static double contrast(double defocus) {
  return 0.35 * (1 - defocus * defocus / (400 * 400));
}

static int no_preparation(void *self, opc_error *error) {
  (void)self;
  (void)error;
  return OPC_OK;
}

static double some_band(const void *self) {
  (void)self;
  return 0.005;
}

static int waves_at(const void *self, int which, const eda_spectrum *mask,
                    double defocus, eda_field *out, opc_error *error) {
  (void)error;
  (void)self;
  (void)which;
  eda_frame f = mask->frame;
  *out = (eda_field){.frame = f, .nx = (int)(f.width / 10), .ny = 32};
  size_t n = (size_t)out->nx * (size_t)out->ny;
  out->coefficients = eda_alloc(n, sizeof(float));
  for (size_t i = 0; i < n; i++) {
    double x = f.x0 + f.width * (double)(i % (size_t)out->nx) / out->nx;
    out->coefficients[i] =
        (float)(0.5 - contrast(defocus) * cos(2 * M_PI * (x - 125) / pitch));
  }
  eda_field_from_samples(NULL, out);
  return OPC_OK;
}

static int waves(const void *self, int which, const eda_spectrum *mask,
                 eda_field *out, opc_error *error) {
  return waves_at(self, which, mask, 0, out, error);
}

static const eda_litho with_focus = {.prepare = no_preparation,
                                     .band = some_band,
                                     .image = waves,
                                     .image_at = waves_at};
static const eda_litho one_focus = {
    .prepare = no_preparation, .band = some_band, .image = waves};

#define RESIST \
  "resist: { use: resist.threshold, threshold: 0.4, active_threshold: 0.2 }"
#define LITHO "litho: { use: litho.hopkins }"

/* Printed length and slope of the logarithm at its edges. */
static double length_at(double defocus, double dose, double *ils) {
  double level = 0.4 / (1 + dose / 100), m = contrast(defocus);
  double angle = acos((0.5 - level) / m);
  *ils = m * 2 * M_PI / pitch * sin(angle) / level;
  return pitch / M_PI * angle;
}

static int run_step(const char *mapping, const eda_litho *litho, lines *l,
                    opc_error *error) {
  void *none[1];
  opc_module model = {litho, NULL,
                      litho == &one_focus ? "litho.one" : "litho.waves"};
  opc_test_forget();
  g_autoptr(opc_module) m = opc_test_module("process.window", mapping, error);
  if (!m) return error->code;
  if (litho) opc_test_input(m, "litho", &model);
  if (l) opc_test_input(m, "gates", &l->gates);
  return opc_test_run(m, none, error);
}

static const double *column(const char *table, const char *name) {
  const opc_table *t = opc_test_table(table);
  g_assert_nonnull(t);
  const opc_column *c = opc_table_column(t, name);
  g_assert_nonnull(c);
  return c->data;
}

static void test_closed_form(void) {
  lines l;
  opc_error error;
  make(&l);
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

/* The doses and foci where lengths leave the tolerance, by their closed form.
 */
static void test_limits(void) {
  lines l;
  opc_error error;
  double ils, nominal = length_at(0, 0, &ils);
  make(&l);
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
  /* A gate that is drawn wider wants less dose. */
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
  /* One that no dose of the list prints well: no window at all. */
  l.length[2] = 2 * nominal;
  if (run_step(mapping->str, &with_focus, &l, &error))
    g_error("%s", error.message);
  g_assert_cmpfloat(opc_test_metric("exposure_latitude"), ==, 0);
  g_assert_cmpfloat(opc_test_metric("depth_of_focus"), ==, 0);
  g_string_free(mapping, TRUE);
}

/* The optics of the thesis: lengths at 0, 100 and 150 nm of defocus as a
   prototype with other code gave them; the same on both sides of the focus,
   and less with more dose. */
static void test_optics(void) {
  lines l;
  opc_error error;
  make(&l);
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

/* Lines that do not print are counted, and end the window. */
static void test_failing(void) {
  lines l;
  opc_error error;
  make(&l);
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

static void refused(const char *mapping, lines *l, const char *why) {
  opc_error error;
  g_assert_cmpint(run_step(mapping, &one_focus, l, &error), ==, OPC_INVALID);
  if (!strstr(error.message, why))
    g_error("'%s' does not say '%s'", error.message, why);
}

static void test_refused(void) {
  lines l;
  make(&l);
  refused("{ " LITHO ", " RESIST " }", &l, "'litho.one' has one focus only");
  refused("{ " LITHO ", " RESIST ", defocus: [0 nm] }", NULL,
          "one of 'mask' and 'gates' is needed");
  refused("{ " LITHO ", " RESIST ", dose: [1 %, 1 %] }", &l, "must increase");
  refused("{ " LITHO ", " RESIST ", dose: [-100 %, 1 %] }", &l, "out of range");
  GString *many = g_string_new("{ " LITHO ", " RESIST ", dose: [0 %");
  for (int i = 1; i <= 100; i++) g_string_append_printf(many, ", %d %%", i);
  g_string_append(many, "] }");
  refused(many->str, &l, "needs 1 to 100 values, not 101");
  g_string_free(many, TRUE);
  refused("{ " LITHO ", " RESIST ", file: a.jpg }", &l, ".png, .svg or .pdf");
  l.gates.count = 0;
  refused("{ " LITHO ", " RESIST ", defocus: [0 nm] }", &l, "no transistors");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/window/closed-form", test_closed_form);
  g_test_add_func("/window/limits", test_limits);
  g_test_add_func("/window/optics", test_optics);
  g_test_add_func("/window/failing", test_failing);
  g_test_add_func("/window/refused", test_refused);
  return g_test_run();
}
