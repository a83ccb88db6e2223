/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests calibration with synthetic gauges: widths of lines and spaces printed
   by resist.threshold with known parameters, with noise. */
#include <eda/eda.h>
#include <eda/print.h>
#include <eda/random.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/devel/testing.h"

/* The hidden parameters. */
enum { HIDDEN = 7 };
static const char *const names[HIDDEN] = {
    "threshold", "active_threshold", "diffusion", "defocus", "na",
    "sigma",     "bias_density"};
static const double hidden[HIDDEN] = {0.37, 0.33, 23, 90, 0.75, 0.75, 20};
#define LITHO "use: litho.hopkins, wavelength: 193 nm, na: 0.75, sigma: 0.75"
static const char resist[] =
    "{ threshold: 0.37, active_threshold: 0.33, diffusion: 23 nm }";

enum { GAUGES = 200 };
typedef struct site {
  int layer, axis, space;
  double x, y, printed;
  double biased; /* printed, with the bias of etching by density */
} site;

/* Widths and spaces of the lines, nm. */
enum { LINES = 8, ROWS = 2 };
static const int width[LINES] = {80, 95, 70, 130, 90, 250, 100, 85},
                 space[LINES] = {110, 140, 190, 160, 240, 130, 300, 200};

static opc_module *module_of(const char *id, const char *text) {
  opc_error error = {0};
  opc_module *m = opc_test_module(id, text, &error);
  if (!m) g_error("%s: %s", id, error.message);
  return m;
}

/* ---- the mask ---- */

/* Return line k of a row, or the space after that line. Lines of active are
   horizontal. */
static eda_box box_of(int layer, int row, int k, int is_space) {
  int at = -1100 - 90 * row;
  for (int i = 0; i < k; i++) at += width[i] + 6 * row + space[i];
  int end = at + width[k] + 6 * row;
  if (is_space) {
    at = end;
    end += space[k];
  }
  int from = row ? 320 : -1150, to = row ? 1500 : 60;
  return layer ? (eda_box){from, at, to, end} : (eda_box){at, from, end, to};
}

static eda_mask *mask_of_lines(void) {
  eda_mask *m = eda_mask_new(eda_gates_sample());
  for (int layer = 0; layer < 2; layer++) {
    eda_point points[ROWS * LINES * 4];
    uint32_t start[ROWS * LINES + 1] = {0};
    for (int i = 0; i < ROWS * LINES; i++) {
      eda_box b = box_of(layer, i / LINES, i % LINES, 0);
      eda_point corners[4] = {
          {b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
      memcpy(points + (size_t)i * 4, corners, sizeof corners);
      start[i + 1] = 4 * (uint32_t)(i + 1);
    }
    const eda_shapes all = {
        .count = ROWS * LINES, .start = start, .points = points};
    opc_error error = {0};
    g_assert_false(eda_boolean(EDA_OR, &all, NULL, &m->shapes[layer], &error));
  }
  return m;
}

/* Return the part of a Gaussian around x that is between a and b. */
static double gauss_part(double x, double a, double b, double range) {
  double scale = 1 / (range * sqrt(2));
  return (erf((b - x) * scale) - erf((a - x) * scale)) / 2;
}

/* Return the average of the lines of a layer around (x, y), weighted by a
   Gaussian with the standard deviation `range`. */
static double density_of(int layer, double x, double y, double range) {
  double sum = 0;
  for (int i = 0; i < ROWS * LINES; i++) {
    eda_box b = box_of(layer, i / LINES, i % LINES, 0);
    sum += gauss_part(x, b.x0, b.x1, range) * gauss_part(y, b.y0, b.y1, range);
  }
  return sum;
}

/* ---- synthetic gauges ---- */

/* Return the distance from (x, y) to the first sign change along an axis, by
   samples of 1 nm and a straight line between two of them. */
static double edge_of(const eda_field *f, int axis, int way, double x, double y,
                      double sign) {
  double last = 0;
  for (int k = 0; k < 400; k++) {
    double px = x + (axis ? 0 : way * k), py = y + (axis ? way * k : 0), value;
    eda_field_sample(f, &px, &py, 1, &value);
    value *= sign;
    if (!(value > 0)) return k ? k - 1 + last / (last - value) : NAN;
    last = value;
  }
  return NAN;
}

/* Print the mask with the hidden parameters, and measure GAUGES sites. */
static void sites_measure(const eda_mask *m, site *out) {
  opc_error error = {0};
  g_autoptr(opc_module) litho =
      module_of("litho.hopkins", "{ " LITHO ", defocus: 90 nm }");
  g_autoptr(opc_module) exposed = module_of("resist.threshold", resist);
  eda_printer p;
  eda_printer_init(&p, opc_test_host()->context, m->gates, litho, exposed,
                   1500);
  p.fine = 5e-4;
  const uint8_t both[2] = {1, 1};
  if (eda_printer_prepare(&p, &error) ||
      eda_printer_print(&p, both, m->shapes, &error) ||
      eda_printer_refine(&p, both, m->shapes, &error))
    g_error("%s", error.message);
  size_t n = 0;
  for (int i = 0; n < GAUGES; i++) {
    int layer = i % 2, is_space = i / 2 % 2, k = i / 4 % LINES;
    int row = i / (4 * LINES) % ROWS, part = i / (4 * LINES * ROWS);
    eda_box b = box_of(layer, row, k, is_space);
    double x = (b.x0 + b.x1) / 2.0, y = (b.y0 + b.y1) / 2.0;
    if (layer)
      x = b.x0 + (b.x1 - b.x0) * (0.08 + 0.12 * part);
    else
      y = b.y0 + (b.y1 - b.y0) * (0.08 + 0.12 * part);
    g_assert_cmpint(part, <, 8);
    double sign = is_space ? -1 : 1;
    double w = edge_of(&p.print[layer], layer, 1, x, y, sign) +
               edge_of(&p.print[layer], layer, -1, x, y, sign);
    double bias = hidden[6] * (density_of(layer, x, y, 300) - 0.5);
    if (w > 20)
      out[n++] = (site){layer, layer, is_space, x, y, w, w + sign * bias};
  }
  eda_printer_clear(&p);
}

/* Write the gauges with normal noise of 1 nm; if `bad` is not 0, every `bad`th
   gauge has an additional error of 25 nm. `biased`: 1: with the bias of
   etching. `masks`: the gauges belong to these masks in turn. */
static char *sites_write(const site *s, size_t n, uint64_t seed, size_t bad,
                         int biased, size_t masks) {
  GString *text =
      g_string_new("layer,x (nm),y (nm),axis,width (nm),feature,mask\n");
  for (size_t i = 0; i < n; i++) {
    double a = sqrt(-2 * log(1 - eda_random_unit(&seed)));
    double noise = a * cos(2 * G_PI * eda_random_unit(&seed));
    if (bad && i % bad == 0) noise += 25;
    g_string_append_printf(text, "%s,%.3f,%.3f,%s,%.6f,%s,%zu\n",
                           s[i].layer ? "active" : "poly", s[i].x, s[i].y,
                           s[i].axis ? "y" : "x",
                           (biased ? s[i].biased : s[i].printed) + noise,
                           s[i].space ? "space" : "line", i / 4 % masks + 1);
  }
  char *path = g_build_filename(opc_test_folder(), "gauges.csv", NULL);
  g_assert_true(g_file_set_contents(path, text->str, -1, NULL));
  g_string_free(text, TRUE);
  return path;
}

/* ---- runs ---- */

static int run_calibrate(eda_mask *mask, eda_mask *second, const char *path,
                         const char *more, opc_error *error) {
  g_autofree char *text = g_strdup_printf(
      "{ litho: { " LITHO " }, gauges: '%s', margin: 1500 nm, %s }", path,
      more);
  g_autoptr(opc_module) m = module_of("calibrate", text);
  opc_test_input(m, "mask", mask);
  opc_test_input(m, "mask_2", second);
  opc_test_forget();
  return opc_test_run(m, NULL, error);
}

/* Return the row of a parameter in the table `calibration`. */
static size_t row_of(const char *name) {
  for (size_t i = 0; i < opc_test_rows("calibration"); i++)
    if (!strcmp(opc_test_text("calibration", "parameter", i), name)) return i;
  g_error("no parameter %s", name);
}

static double figure_of(const char *name, const char *column) {
  return opc_test_number("calibration", column, row_of(name));
}

static site sites[GAUGES];
static eda_mask *mask;

/* Fit gauges of random noise, for OPCFLOW_TRIALS trials or else `trials`; one
   trial under the sanitizer. Test that the `fitted` parameters are within 4
   standard deviations of the hidden values, and that gauges left out are
   predicted with the error of the noise. Log how many intervals contain the
   hidden values. */
static void run_trials(int trials, const char *settings, int biased,
                       const uint8_t fitted[HIDDEN]) {
  const char *wish = g_getenv("OPCFLOW_TRIALS");
#ifdef __SANITIZE_ADDRESS__
  trials = 1;
#endif
  if (wish) trials = atoi(wish);
  int inside[HIDDEN] = {0};
  for (int k = 0; k < trials; k++) {
    opc_error error = {0};
    g_autofree char *path =
        sites_write(sites, GAUGES, 1000 + (uint64_t)k, 0, biased, 1);
    if (run_calibrate(mask, NULL, path, settings, &error))
      g_error("%s", error.message);
    for (size_t i = 0; i < HIDDEN; i++) {
      if (!fitted[i]) continue;
      double low = figure_of(names[i], "low_95"),
             high = figure_of(names[i], "high_95");
      double off = fabs(figure_of(names[i], "value") - hidden[i]);
      inside[i] += low <= hidden[i] && hidden[i] <= high;
      g_test_message("%s: %g, from %g to %g", names[i],
                     figure_of(names[i], "value"), low, high);
      g_assert_cmpfloat(off, <, 4 * figure_of(names[i], "sd"));
    }
    g_assert_cmpfloat(fabs(opc_test_metric("rms") - 1), <, 0.15);
    g_assert_cmpfloat(fabs(opc_test_metric("rms_left_out") - 1), <, 0.17);
    g_assert_cmpfloat(opc_test_metric("undetermined"), ==, 0);
    g_assert_cmpfloat(opc_test_metric("interpolation"), <, 0.1);
    g_test_message("rms %g, left out %g, interpolation %g nm",
                   opc_test_metric("rms"), opc_test_metric("rms_left_out"),
                   opc_test_metric("interpolation"));
  }
  for (size_t i = 0; i < HIDDEN; i++)
    if (fitted[i])
      g_test_message("%s: within the 95 %% interval in %d of %d trials",
                     names[i], inside[i], trials);
}

/* Test that hidden thresholds, diffusion and focus are found. */
static void test_recovered(void) {
  if (opc_test_sanitized_skip()) return;
  run_trials(2, "defocus: [0 nm, 200 nm], starts: 2, folds: 4", 0,
             (const uint8_t[HIDDEN]){1, 1, 1, 1});
}

/* Test that hidden optics and a hidden bias by density are found. */
static void test_optics(void) {
  if (opc_test_sanitized_skip()) return;
  run_trials(1,
             "na: [0.68, 0.8], sigma: [0.6, 0.9], defocus: [90 nm], "
             "bias_density: [-50 nm, 50 nm], density_range: 300 nm, "
             "starts: 2, folds: 4",
             1, (const uint8_t[HIDDEN]){1, 1, 1, 0, 1, 1, 1});
}

/* Test that gross errors of a tenth of the gauges move least squares, but not
   the robust fit. */
static void test_outliers(void) {
  if (opc_test_sanitized_skip()) return;
  opc_error error = {0};
  g_autofree char *path = sites_write(sites, GAUGES, 7, 10, 0, 1);
  double off[2];
  for (int k = 0; k < 2; k++) {
    if (run_calibrate(mask, NULL, path,
                      k ? "defocus: [90 nm], starts: 1, folds: 0, loss: squares"
                        : "defocus: [90 nm], starts: 1, folds: 0",
                      &error))
      g_error("%s", error.message);
    off[k] = fabs(figure_of("threshold", "value") - hidden[0]);
  }
  g_assert_cmpfloat(off[0], <, 0.003);
  g_assert_cmpfloat(off[1], >, 2 * off[0]);
  g_assert_cmpfloat(opc_test_metric("rms"), >, 5);
}

/* Test that parameters that the gauges do not determine are reported. */
static void test_undetermined(void) {
  opc_error error = {0};
  site one[20];
  for (size_t i = 0; i < G_N_ELEMENTS(one); i++) one[i] = sites[0];
  g_autofree char *path = sites_write(one, G_N_ELEMENTS(one), 3, 0, 0, 1);
  if (run_calibrate(mask, NULL, path,
                    "diffusion: [23 nm], bias: [-20 nm, 20 nm], "
                    "defocus: [90 nm], starts: 1, folds: 0",
                    &error))
    g_error("%s", error.message);
  g_assert_cmpfloat(opc_test_metric("undetermined"), >=, 1);
  g_assert_nonnull(strstr(opc_test_log(), "do not determine"));
}

/* Test that gauges of two masks are fitted together, and that `leave: masks`
   predicts the gauges of each mask from the other mask. */
static void test_masks(void) {
  if (opc_test_sanitized_skip()) return;
  opc_error error = {0};
  eda_mask *second = mask_of_lines();
  g_autofree char *path = sites_write(sites, GAUGES, 11, 0, 0, 2);
  if (run_calibrate(mask, second, path,
                    "defocus: [90 nm], starts: 1, leave: masks", &error))
    g_error("%s", error.message);
  for (size_t i = 0; i < 3; i++)
    g_assert_cmpfloat(fabs(figure_of(names[i], "value") - hidden[i]), <,
                      4 * figure_of(names[i], "sd"));
  g_assert_cmpuint(opc_test_rows("masks"), ==, 4);
  double gauges = 0;
  for (size_t i = 0; i < 4; i++) {
    const size_t number = 1 + i / 2;
    gauges += opc_test_number("masks", "gauges", i);
    g_assert_cmpfloat(opc_test_number("masks", "mask", i), ==, (double)number);
    g_assert_cmpfloat(fabs(opc_test_number("masks", "rms_left_out", i) - 1), <,
                      0.4);
  }
  g_assert_cmpfloat(gauges, ==, GAUGES);
  /* Shapes of the second mask are absent: its gauges do not print. */
  for (int layer = 0; layer < 2; layer++)
    eda_shapes_clear(&second->shapes[layer]);
  if (run_calibrate(mask, second, path, "defocus: [90 nm], starts: 1, folds: 0",
                    &error))
    g_error("%s", error.message);
  g_assert_cmpfloat(opc_test_metric("worst"), >, 50);
  eda_mask_free(second);
}

enum { ROW = 12 };

/* Return a row of vertical gates with increasing lengths and widths, nm. */
static eda_gates *gates_of_row(void) {
  eda_gates *g = eda_gates_new(2, ROW);
  g->grid = 1;
  for (int i = 0; i < ROW; i++) {
    g->box[i] = (eda_box){600 * i, 0, 600 * i + 100 + i, 200 + 10 * i};
    g->length[i] = 100 + i;
    g->width[i] = 200 + 10 * i;
  }
  g->extent = (eda_box){0, 0, 600 * ROW, 600};
  return g;
}

/* Test which drawn sizes are gauges without a file. */
static void test_drawn(void) {
  static const char *const drawn[] = {"both", "lengths", "widths"};
  eda_gates *gates = gates_of_row();
  eda_mask *row = eda_mask_new(gates);
  for (size_t k = 0; k < G_N_ELEMENTS(drawn); k++) {
    opc_error error = {0};
    g_autofree char *text =
        g_strdup_printf("{ litho: { " LITHO
                        " }, margin: 1500 nm, diffusion: [0 nm], starts: 1, "
                        "folds: 0, drawn: %s }",
                        drawn[k]);
    g_autoptr(opc_module) m = module_of("calibrate", text);
    opc_test_input(m, "mask", row);
    opc_test_forget();
    if (opc_test_run(m, NULL, &error)) g_error("%s", error.message);
    size_t n = opc_test_rows("gauges");
    g_assert_cmpuint(n, ==, k ? ROW : 2 * ROW);
    for (size_t i = 0; i < n; i++) {
      size_t gate = k ? i : i / 2;
      int across = k ? k == 2 : i % 2;
      g_assert_cmpfloat(opc_test_number("gauges", "measured", i), ==,
                        across ? gates->width[gate] : gates->length[gate]);
    }
  }
  eda_mask_free(row);
  eda_gates_free(gates);
}

/* Free the masks before the step, as a flow does. The step must not use the
   masks after its run; AddressSanitizer finds such a use. */
static void test_masks_freed_first(void) {
  opc_error error = {0};
  eda_mask *masks[] = {mask_of_lines(), mask_of_lines()};
  g_autofree char *path = sites_write(sites, GAUGES, 5, 0, 0, 2);
  g_autofree char *text = g_strdup_printf(
      "{ litho: { " LITHO
      " }, gauges: '%s', margin: 1500 nm, "
      "diffusion: [23 nm], defocus: [90 nm], starts: 1, folds: 0 }",
      path);
  opc_module *m = module_of("calibrate", text);
  opc_test_input(m, "mask", masks[0]);
  opc_test_input(m, "mask_2", masks[1]);
  opc_test_forget();
  if (opc_test_run(m, NULL, &error)) g_error("%s", error.message);
  for (int i = 0; i < 2; i++) eda_mask_free(masks[i]);
  opc_test_module_free(m);
  g_assert_cmpfloat(fabs(figure_of("threshold", "value") - hidden[0]), <,
                    4 * figure_of("threshold", "sd"));
}

static void test_refused(void) {
  static const struct {
    const char *row, *fault;
  } faults[] = {
      {"metal9,0,0,x,80,1", "has no layer 'metal9'"},
      {"poly,0,0,z,80,1", "expected 'x' or 'y'"},
      {"poly,0,0,x,80,2", "has no mask of the number"},
      {"poly,0,0,x,80,-inf", "bad.csv:2:15: not a number: '-inf'"},
      {"poly,99999,0,x,80,1", "outside of the simulated field"},
      {"poly,0,0,x,80,1", "1 gauges are too few"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(faults); i++) {
    opc_error error = {0};
    g_autofree char *path =
        g_build_filename(opc_test_folder(), "bad.csv", NULL);
    GString *text = g_string_new("layer,x,y,axis,width,mask\n");
    for (int k = 0; k < (i == 5 ? 1 : 9); k++)
      g_string_append_printf(text, "%s\n", faults[i].row);
    g_assert_true(g_file_set_contents(path, text->str, -1, NULL));
    g_string_free(text, TRUE);
    g_assert_cmpint(run_calibrate(mask, NULL, path, "starts: 1", &error), ==,
                    OPC_INVALID);
    if (!strstr(error.message, faults[i].fault)) g_error("%s", error.message);
  }
  opc_error error = {0};
  opc_module *m =
      module_of("calibrate", "{ litho: { " LITHO " }, margin: 1 nm }");
  opc_test_input(m, "mask", mask);
  g_assert_cmpint(opc_test_run(m, NULL, &error), ==, OPC_INVALID);
  opc_test_module_free(m);
  g_assert_cmpstr(error.parameter, ==, "margin");
  g_assert_null(opc_test_module(
      "calibrate", "{ litho: { " LITHO " }, fine: 1e-9 }", &error));
  g_assert_nonnull(strstr(error.message, "'fine' must be at least 5e-05"));
  /* Drawn sizes beside a file would be ignored. */
  g_autofree char *text = g_strdup_printf(
      "{ litho: { " LITHO " }, gauges: '%s/bad.csv', drawn: lengths }",
      opc_test_folder());
  g_assert_null(opc_test_module("calibrate", text, &error));
  g_test_message("%s", error.message);
  g_assert_nonnull(strstr(error.message, "'drawn' selects gauges"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  mask = mask_of_lines();
  sites_measure(mask, sites);
  g_test_add_func("/calibrate/recovered", test_recovered);
  g_test_add_func("/calibrate/optics", test_optics);
  g_test_add_func("/calibrate/outliers", test_outliers);
  g_test_add_func("/calibrate/undetermined", test_undetermined);
  g_test_add_func("/calibrate/masks", test_masks);
  g_test_add_func("/calibrate/masks-freed-first", test_masks_freed_first);
  g_test_add_func("/calibrate/drawn", test_drawn);
  g_test_add_func("/calibrate/refused", test_refused);
  int code = g_test_run();
  eda_mask_free(mask);
  return code;
}
