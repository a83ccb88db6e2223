/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the variable threshold against its definition, integrated
   numerically; of the effect of the grid on contours; and of fits to tables
   with known coefficients. */
#include <string.h>

#include "../lines_test.h"

#define vtr(parameters, litho) lines_resist("resist.vtr", parameters, litho)

static const double pitches[] = {220, 250, 320, 500, 1500};
enum { PITCHES = 5 };

/* Test that, without variable terms, the result equals that of
   resist.threshold. */
static void test_constant(void) {
  g_autoptr(opc_module) litho = lines_hopkins();
  static const char *const parameters[] = {"{}", "{ diffusion: 20 nm }",
                                           "{ anchor: { pitch: 0 nm } }"};
  for (size_t i = 0; i < G_N_ELEMENTS(parameters); i++) {
    g_autoptr(opc_module) a = vtr(parameters[i], litho);
    g_autoptr(opc_module) b =
        lines_resist("resist.threshold", parameters[i], litho);
    for (int layer = 0; layer < 3; layer++) {
      eda_field f = lines_print(litho, a, layer, 65, 320);
      eda_field g = lines_print(litho, b, layer, 65, 320);
      g_assert_cmpint(f.nx, ==, g.nx);
      g_assert_cmpmem(f.coefficients, sizeof(float) * (size_t)(f.nx * f.ny),
                      g.coefficients, sizeof(float) * (size_t)(g.nx * g.ny));
      eda_field_clear(&f);
      eda_field_clear(&g);
    }
  }
}

/* ---- the definition ---- */

static const double period = 400, mean = 0.55, first = -0.3, second = 0.08;

/* Return an image along x and its derivative. */
static double line_image(double x, double *slope) {
  double w = 2 * M_PI / period;
  *slope = -w * (first * sin(w * x) + 2 * second * sin(2 * w * x));
  return mean + first * cos(w * x) + second * cos(2 * w * x);
}

/* Compute M and S at x by a sum over a grid of 0.25 nm. */
static void moments_integrate(double x, double radius, double slope_radius,
                              double *m, double *s) {
  double sums[2] = {0}, weights[2] = {0}, r[2] = {radius, slope_radius};
  for (int k = 0; k < 2; k++) {
    for (double t = -2 * r[k]; t <= 2 * r[k]; t += 0.25) {
      double slope, value = line_image(x + t, &slope),
                    g = exp(-2 * t * t / (r[k] * r[k]));
      sums[k] += g * (k ? slope * slope : pow(value, 8));
      weights[k] += g;
    }
  }
  *m = pow(sums[0] / weights[0], 0.125);
  *s = sqrt(sums[1] / weights[1]);
}

static eda_field make_image(int axis) {
  const opc_host *host = opc_test_host();
  eda_field f = {.frame = {0, 0, period, period}, .nx = 16, .ny = 16};
  f.coefficients = eda_alloc(256, sizeof(float));
  for (int i = 0; i < 256; i++) {
    double slope;
    f.coefficients[i] =
        (float)line_image((axis ? i / 16 : i % 16) * period / 16, &slope);
  }
  eda_field_from_samples(host->context, &f);
  return f;
}

/* Test dark lines along y and bright lines along x. */
static void test_definition(void) {
  static const struct {
    const char *step;
    double reach;
  } steps[] = {{"32 nm", 1e-4}, {"16 nm", 1e-4}, {"8 nm", 5e-5}};
  g_autoptr(opc_module) litho = lines_hopkins();
  for (size_t k = 0; k < G_N_ELEMENTS(steps); k++)
    for (int tone = 0; tone < 2; tone++) {
      g_autofree char *parameters = g_strdup_printf(
          "{ constant: 0.1, maximum: 0.3, slope: 7 nm, product: -3 nm, "
          "active_constant: 0.2, radius: 150 nm, slope_radius: 50 nm, "
          "step: %s, tone: %s }",
          steps[k].step, tone ? "bright" : "dark");
      g_autoptr(opc_module) m = vtr(parameters, litho);
      const eda_resist *resist = m->functions;
      eda_field f = make_image(tone);
      opc_error error;
      double worst = 0;
      g_assert_cmpint(resist->print(m->self, EDA_POLY, &f, &error), ==, OPC_OK);
      for (double x = 0; x < period; x += 3.7) {
        double maximum, s, slope;
        moments_integrate(x, 150, 50, &maximum, &s);
        double level = 0.1 + 0.3 * maximum + 7 * s - 3 * maximum * s -
                       line_image(x, &slope);
        double other = 10, got;
        eda_field_sample(&f, tone ? &other : &x, tone ? &x : &other, 1, &got);
        worst = fmax(worst, fabs(got - (tone ? -level : level)));
      }
      g_test_message("step %s: largest error of the level %.2g", steps[k].step,
                     worst);
      g_assert_cmpfloat(worst, <, steps[k].reach);
      eda_field_clear(&f);
    }
}

/* ---- effect of the grid on contours ---- */

#define STRONG                                                          \
  "{ constant: 0.15, maximum: 0.2, slope: 8 nm, product: 2 nm, active_" \
  "constant: 0.2, step: %g nm }"

/* Return the level set of an L of poly and a rectangle with a slanted end. */
static eda_field print_shapes(opc_module *litho, opc_module *resist) {
  const opc_host *host = opc_test_host();
  const eda_litho *model = litho->functions;
  const eda_resist *develop = resist->functions;
  eda_point points[] = {{-300, -400}, {-235, -400}, {-235, 200}, {100, 200},
                        {100, 265},   {-300, 265},  {100, -400}, {165, -400},
                        {165, 80},    {100, 20}};
  uint32_t start[] = {0, 6, 10};
  eda_shapes shapes = {2, start, points, NULL};
  eda_frame f = {-1000, -1000, 2000, 2000};
  eda_spectrum mask;
  eda_field field;
  opc_error error;
  g_assert_cmpint(eda_mask_spectrum(host->context, &shapes, 1, f,
                                    model->band(litho->self), &mask, &error),
                  ==, OPC_OK);
  g_assert_cmpint(model->image(litho->self, EDA_POLY, &mask, &field, &error),
                  ==, OPC_OK);
  eda_spectrum_clear(&mask);
  g_assert_cmpint(develop->print(resist->self, EDA_POLY, &field, &error), ==,
                  OPC_OK);
  return field;
}

/* Return the largest distance of contour points of one field from the contour
   of the other field, to first order. */
static double distance(const eda_field *fine, const eda_field *coarse) {
  double *points, worst = 0;
  uint32_t *start;
  size_t lines;
  opc_error error;
  eda_frame window = {-600, -700, 1200, 1300};
  g_assert_cmpint(
      eda_contours(NULL, fine, window, 4, &points, &start, &lines, &error), ==,
      OPC_OK);
  g_assert_cmpuint(lines, ==, 2);
  for (uint32_t i = 0; i < start[lines]; i++) {
    double v, w, dx, dy, *p = points + 2 * i;
    eda_field_gradient(fine, &p[0], &p[1], 1, &w, &dx, &dy);
    eda_field_gradient(coarse, &p[0], &p[1], 1, &v, NULL, NULL);
    worst = fmax(worst, fabs(v - w) / hypot(dx, dy));
  }
  free(points);
  free(start);
  return worst;
}

static void test_grid(void) {
  g_autoptr(opc_module) litho = lines_hopkins();
  g_autofree char *finest = g_strdup_printf(STRONG, 3.0);
  g_autoptr(opc_module) reference = vtr(finest, litho);
  eda_field fine = print_shapes(litho, reference);
  static const struct {
    double step, reach;
  } steps[] = {{32, 0.5}, {16, 0.01}, {8, 0.01}};
  for (size_t i = 0; i < G_N_ELEMENTS(steps); i++) {
    g_autofree char *parameters = g_strdup_printf(STRONG, steps[i].step);
    g_autoptr(opc_module) resist = vtr(parameters, litho);
    eda_field f = print_shapes(litho, resist);
    double worst = distance(&fine, &f);
    g_test_message("step %g nm: contours off by %.2g nm", steps[i].step, worst);
    g_assert_cmpfloat(worst, <, steps[i].reach);
    eda_field_clear(&f);
  }
  eda_field_clear(&fine);
}

/* ---- fits ---- */

static void widths(opc_module *litho, opc_module *resist, double line,
                   double out[PITCHES]) {
  for (int i = 0; i < PITCHES; i++) {
    eda_field f = lines_print(litho, resist, EDA_POLY, line, pitches[i]);
    out[i] = lines_width(&f);
    eda_field_clear(&f);
  }
}

static double rms(const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < PITCHES; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum / PITCHES);
}

/* Test a table printed by a known variable threshold of two terms: the fit
   reproduces the widths, and the widths of a line that is not in the table. */
static void test_known(void) {
  g_autoptr(opc_module) litho = lines_hopkins();
  g_autoptr(opc_module) known =
      vtr("{ constant: 0.3, maximum: 0.1, slope: 4 nm, active_constant: 0.2 }",
          litho);
  GString *csv = g_string_new("# printed\npitch (nm), cd (nm),line\r\n\n");
  double want[PITCHES], got[PITCHES];
  for (int k = 0; k < 2; k++) {
    double line = k ? 90 : 65;
    widths(litho, known, line, want);
    for (int i = 0; i < PITCHES; i++)
      g_string_append_printf(csv, "%g, %.6f ,%g\n", pitches[i], want[i], line);
  }
  g_autofree char *path =
      g_build_filename(opc_test_folder(), "known.csv", NULL);
  g_assert_true(g_file_set_contents(path, csv->str, -1, NULL));
  g_string_free(csv, TRUE);
  g_autofree char *parameters = g_strdup_printf(
      "{ table_file: %s, fit: slope, active_constant: 0.2 }", path);
  opc_test_forget();
  g_autoptr(opc_module) fitted = vtr(parameters, litho);
  g_test_message("%s", opc_test_log());
  g_assert_nonnull(strstr(opc_test_log(), "0.3000 +0.1000 M +4.00"));
  widths(litho, known, 75, want);
  widths(litho, fitted, 75, got);
  for (int i = 0; i < PITCHES; i++)
    g_assert_cmpfloat(fabs(got[i] - want[i]), <, 0.005);
  /* Values set by the flow are not fitted. */
  g_autofree char *part = g_strdup_printf(
      "{ table_file: %s, fit: slope, slope: 4 nm, active_constant: 0.2 }",
      path);
  opc_test_forget();
  g_autoptr(opc_module) rest = vtr(part, litho);
  g_assert_nonnull(strstr(opc_test_log(), "0.3000 +0.1000 M +4.000 nm S"));
}

/* Test lines whose widths vary half as much through pitch as with a constant
   threshold: more terms reduce the error. */
static void test_through_pitch(void) {
  static const double wanted[PITCHES] = {63.9, 65, 66.1, 67.8, 69.2};
  static const char *const fits[] = {"constant", "maximum", "slope", "product"};
  static const double reach[] = {2.1, 1.2, 1.1, 0.6};
  g_autoptr(opc_module) litho = lines_hopkins();
  double before = 100, got[PITCHES];
  GString *table = g_string_new("");
  for (int i = 0; i < PITCHES; i++)
    g_string_append_printf(table, "%s%g nm, %g nm", i ? ", " : "", pitches[i],
                           wanted[i]);
  for (int k = 0; k < 4; k++) {
    g_autofree char *parameters = g_strdup_printf(
        "{ table: [%s], fit: %s, active_constant: 0.2 }", table->str, fits[k]);
    opc_test_forget();
    g_autoptr(opc_module) resist = vtr(parameters, litho);
    widths(litho, resist, 65, got);
    double error = rms(got, wanted);
    g_test_message("%s", opc_test_log());
    g_assert_cmpfloat(error, <, reach[k]);
    g_assert_cmpfloat(error, <, before);
    before = error;
    if (k) continue;
    /* Compare with the same fit of a constant threshold. */
    g_autofree char *same = g_strdup_printf("{ table: [%s] }", table->str);
    g_autoptr(opc_module) constant =
        lines_resist("resist.threshold", same, litho);
    double other[PITCHES];
    widths(litho, constant, 65, other);
    for (int i = 0; i < PITCHES; i++)
      g_assert_cmpfloat(fabs(other[i] - got[i]), <, 1e-4);
  }
  g_string_free(table, TRUE);
}

/* Test that an anchor prints to size for any coefficients of the variable
   terms. */
static void test_anchor(void) {
  g_autoptr(opc_module) litho = lines_hopkins();
  g_autoptr(opc_module) m = vtr(
      "{ maximum: 0.2, slope: 6 nm, anchor: { cd: 62 nm }, diffusion: 15 nm }",
      litho);
  eda_field f = lines_print(litho, m, EDA_POLY, 65, 250);
  g_test_message("anchor: %.4f nm", lines_width(&f));
  g_assert_cmpfloat(fabs(lines_width(&f) - 62), <, 0.002);
  eda_field_clear(&f);
  f = lines_print(litho, m, EDA_ACTIVE, 1000, 5000);
  g_assert_cmpfloat(fabs(lines_width(&f) - 1000), <, 0.01);
  eda_field_clear(&f);
}

static void test_refused(void) {
  g_autoptr(opc_module) litho = lines_hopkins();
  lines_refused("resist.vtr", "{ table: [250 nm, 65 nm, 500 nm, 70 nm] }",
                litho, "has 2 lines, too few for 3 coefficients");
  lines_refused("resist.vtr",
                "{ table: [250 nm, 65 nm, 250 nm, 65 nm, 250 nm, 65 nm] }",
                litho, "do not determine the coefficients");
  lines_refused("resist.vtr", "{ fit: maximum }", litho,
                "'fit' requires a table");
  lines_refused("resist.vtr",
                "{ table: [250 nm, 65 nm], constant: 0.3, fit: constant }",
                litho, "nothing to fit");
}

static void test_no_diffusion(void) { lines_check_diffusion("resist.vtr"); }

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/vtr/constant", test_constant);
  g_test_add_func("/vtr/definition", test_definition);
  g_test_add_func("/vtr/grid", test_grid);
  g_test_add_func("/vtr/known", test_known);
  g_test_add_func("/vtr/through-pitch", test_through_pitch);
  g_test_add_func("/vtr/anchor", test_anchor);
  g_test_add_func("/vtr/no-diffusion", test_no_diffusion);
  g_test_add_func("/vtr/refused", test_refused);
  return g_test_run();
}
