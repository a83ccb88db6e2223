/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests against a table in closed form, in which the edges of the active remove
   a strip of the channel. */
#include <eda/memory.h>
#include <math.h>
#include <string.h>

#include "reference.h"
#include "tools/devel/testing.h"

static void assert_close(double a, double b, double relative) {
  if (!(fabs(a - b) <= relative * fabs(b) + 1e-4 * relative))
    g_error("%.10g is not %.10g within %g", a, b, relative);
}

static const double widths[] = {100, 200, 500, 10000};

/* Return Ion of an n-transistor, A; Ioff is a thousandth and steeper. */
static double current(int off, double width, double length, double strip) {
  return (width - 2 * strip) * (off ? 1e-9 * exp(-(length - 65) / 4)
                                    : 1e-6 * exp(-(length - 65) / 30));
}

static void put_list(GString *s, int off, double strip, size_t k) {
  g_string_append(s, "[");
  for (int length = 50; length <= 90; length++)
    g_string_append_printf(s, "%s%.10g", length > 50 ? ", " : "",
                           current(off, widths[k], length, strip));
  g_string_append(s, "]");
}

/* Write a table of the last `count` widths, all with strips of `strip` nm. */
static char *table_write(const char *name, size_t count, double strip) {
  GString *s = g_string_new(
      "opcflow-devices: 1\nname: test\nsource: formula\nsupply: 1 V\n"
      "temperature: 27 C\nion: on\nioff: off\nwidth: ");
  size_t first = G_N_ELEMENTS(widths) - count;
  if (count == 1) g_string_append(s, "10 um");
  for (size_t k = first; k < G_N_ELEMENTS(widths) && count > 1; k++)
    g_string_append_printf(
        s, "%s%g", k > first ? ", " : "{ unit: nm, values: [", widths[k]);
  if (count > 1) g_string_append(s, "] }");
  g_string_append(s, "\nlength: { unit: nm, values: [50");
  for (int length = 51; length <= 90; length++)
    g_string_append_printf(s, ", %d", length);
  g_string_append(s, "] }\n");
  for (int type = 0; type < 2; type++) {
    g_string_append_printf(s, "%s:\n", type ? "pmos" : "nmos");
    for (int off = 0; off < 2; off++) {
      g_string_append_printf(s, "  %s: { unit: A, values: %s",
                             off ? "ioff" : "ion", count > 1 ? "[" : "");
      for (size_t k = first; k < G_N_ELEMENTS(widths); k++) {
        if (k > first) g_string_append(s, ", ");
        put_list(s, off, strip, k);
      }
      g_string_append(s, count > 1 ? "] }\n" : " }\n");
    }
  }
  char *path = g_build_filename(opc_test_folder(), name, NULL);
  g_assert_true(g_file_set_contents(path, s->str, -1, NULL));
  g_string_free(s, TRUE);
  return path;
}

/* Run the step for extractor.plain with the table `extractor`. */
static int check_run(const char *devices, const char *extractor,
                     const char *more, opc_error *error) {
  g_autofree char *text = g_strdup_printf(
      "{ devices: '%s', extractor: { use: extractor.plain, devices: '%s' }%s }",
      devices, extractor, more);
  opc_test_forget();
  g_autoptr(opc_module) m = opc_test_module("devices.check", text, error);
  return m ? opc_test_run(m, NULL, error) : (int)error->code;
}

/* Test the errors of rectangles against the strips, 5 nm at each edge. */
static void test_rectangles(void) {
  g_autofree char *several = table_write("several.yaml", 4, 5);
  g_autofree char *wide = table_write("wide.yaml", 1, 5);
  opc_error error = {0};
  if (check_run(several, wide, ", length: { from: 60 nm, to: 69 nm }", &error))
    g_error("%s", error.message);
  g_assert_cmpuint(opc_test_rows("rectangles"), ==, 2 * 4 * 10);
  for (size_t i = 0; i < 80; i++) {
    double w = opc_test_number("rectangles", "width", i);
    double length = opc_test_number("rectangles", "length", i);
    double expected = 100 * (0.999 * w / (w - 10) - 1);
    g_assert_cmpfloat(length, ==, 60 + (double)(i % 10));
    assert_close(opc_test_number("rectangles", "ion_error", i), expected, 1e-4);
    assert_close(opc_test_number("rectangles", "ioff_error", i), expected,
                 1e-4);
    assert_close(opc_test_number("rectangles", "ion", i),
                 current(0, w, length, 5), 1e-9);
  }
  double worst = 100 * (99.9 / 90 - 1);
  double mean = 25 * (99.9 / 90 + 199.8 / 190 + 499.5 / 490 + 1 - 4);
  assert_close(opc_test_metric("ion_max"), worst, 1e-4);
  g_assert_cmpuint(opc_test_rows("check"), ==, 2);
  for (size_t i = 0; i < 2; i++) {
    assert_close(opc_test_number("check", "ion_mean", i), mean, 1e-4);
    assert_close(opc_test_number("check", "ioff_max", i), worst, 1e-4);
    g_assert_true(isnan(opc_test_number("check", "ion_change_mean", i)));
  }
  if (check_run(several, several, "", &error)) g_error("%s", error.message);
  g_assert_cmpfloat(opc_test_metric("ion_max"), <, 1e-4);
}

/* Return the integral over a gate 200 nm wide with lengths from 60 to 70 nm,
   without a strip of the width `strip` at both edges. */
static double slope_current(int off, double strip) {
  double decay = off ? 4 : 30, scale = off ? 1e-9 : 1e-6;
  double low = 60 + strip / 20 - 65, high = 70 - strip / 20 - 65;
  return scale * 20 * decay * (exp(-low / decay) - exp(-high / decay));
}

/* Test the reference for a gate with a slope. With a negative `strip`, the
   edges add current that depends on the local length. */
static void test_reference(void) {
  static double place[REFERENCE_SLICES][3];
  for (double strip = 5; strip >= -5; strip -= 10) {
    g_autofree char *file =
        table_write(strip > 0 ? "removed.yaml" : "added.yaml", 4, strip);
    eda_curves curves = {0};
    opc_error error = {0};
    if (eda_curves_read(&curves, file, &error)) g_error("%s", error.message);
    static reference r;
    reference_init(&r, &curves);
    opc_module m = reference_module(&r);
    const eda_extractor *e = m.functions;
    const double *at, *share;
    double *width = place[0], *length = width + REFERENCE_SLICES,
           *edge = length + REFERENCE_SLICES;
    size_t n = e->slicing(m.self, &at, &share);
    for (size_t k = 0; k < n; k++) {
      width[k] = 200 * share[k];
      length[k] = 60 + 10 * at[k];
    }
    uint8_t type = EDA_NMOS;
    double f[6];
    eda_performance out = {1, &f[0], &f[1], &f[2], &f[3], &f[4], &f[5], NULL};
    eda_slices in = {1, n, &type, width, length, edge, NULL};
    g_assert_cmpint(e->extract(m.self, &in, &out, &error), ==, OPC_OK);
    for (int off = 0; off < 2; off++) {
      double known = slope_current(off, fmax(strip, 0));
      if (strip < 0)
        known += 5 * (current(off, 1, 60, 0) + current(off, 1, 70, 0));
      assert_close(f[off], known, 1e-3);
    }
    assert_close(f[4], 200, 1e-9);
    assert_close(f[5], 200 * 65, 1e-9);
    eda_curves_clear(&curves);
  }
}

/* Return a field that depends on x or y (`axis`) and is positive within `width`
   around `centre` and further places at distances of `period`, which divides
   the frame. B-spline coefficients of a cosine are the cosine divided by a
   constant. */
static eda_field wave(int axis, double centre, double period, double width) {
  enum { N = 100 };
  eda_field f = {{-470, -300, 1000, 1000}, N, N, NULL};
  double turn = 2 * M_PI * 10 / period, level = cos(M_PI * width / period);
  double sum = (66 + 52 * cos(turn) + 2 * cos(2 * turn)) / 120;
  f.coefficients = eda_alloc((size_t)N * N, sizeof(float));
  for (int j = 0; j < N; j++)
    for (int i = 0; i < N; i++) {
      double at = axis == EDA_X ? -470 + 10 * i : -300 + 10 * j;
      f.coefficients[j * N + i] =
          (float)(cos(2 * M_PI * (at - centre) / period) / sum - level);
    }
  return f;
}

/* Printed gates are rectangles 64 by 212 nm, drawn 60 by 200 nm. The extractor
   has the currents of wide transistors per width; the reference lacks strips of
   5 nm. */
static void test_printed(void) {
  g_autofree char *several = table_write("several.yaml", 4, 5);
  g_autofree char *wide = table_write("wide.yaml", 1, 5);
  opc_error error = {0};
  eda_gates *g = eda_gates_new(2, 2);
  g->grid = 1;
  for (int i = 0; i < 2; i++) {
    g->box[i] = (eda_box){0, 100 + 500 * i, 60, 300 + 500 * i};
    g->type[i] = i ? EDA_PMOS : EDA_NMOS;
    g->axis[i] = EDA_X;
    g->length[i] = 60;
    g->width[i] = 200;
    g->extension[2 * i] = g->extension[2 * i + 1] = INFINITY;
    g->space[2 * i] = g->space[2 * i + 1] = 400;
    g->instance[i] = eda_gates_text(g, "");
    g->cell[i] = eda_gates_text(g, "C");
    g->number[i] = (uint32_t)i + 1;
  }
  eda_mask *mask = eda_mask_new(g);
  mask->print[EDA_POLY] = wave(EDA_X, 30, 1000, 64);
  mask->print[EDA_ACTIVE] = wave(EDA_Y, 200, 500, 212);
  g_autofree char *text = g_strdup_printf(
      "{ devices: '%s', extractor: { use: extractor.plain, devices: '%s' } }",
      several, wide);
  opc_test_forget();
  g_autoptr(opc_module) m = opc_test_module("devices.check", text, &error);
  if (!m) g_error("%s", error.message);
  opc_test_input(m, "mask", mask);
  if (opc_test_run(m, NULL, &error)) g_error("%s", error.message);
  g_assert_cmpuint(opc_test_rows("printed"), ==, 2);
  double shorter = exp(-4.0 / 30), known = 202.0 / 190 * shorter,
         found = 212.0 / 200 * shorter;
  double scale = 0.999 * 212 / 202; /* found / known current */
  for (size_t i = 0; i < 2; i++) {
    g_assert_cmpstr(opc_test_text("printed", "owner", i), ==, "C");
    g_assert_cmpstr(opc_test_text("printed", "type", i), ==, i ? "p" : "n");
    g_assert_cmpfloat(opc_test_number("printed", "number", i), ==, i + 1);
    g_assert_cmpfloat(opc_test_number("printed", "width", i), ==, 200);
    assert_close(opc_test_number("printed", "ion_error", i), 100 * (scale - 1),
                 2e-3);
    assert_close(opc_test_number("printed", "ion_deviation", i),
                 100 * (found - 1), 2e-3);
    assert_close(opc_test_number("printed", "ion_reference", i),
                 100 * (known - 1), 2e-3);
    assert_close(opc_test_number("printed", "ioff_deviation", i),
                 100 * (212.0 / 200 * exp(-1) - 1), 2e-3);
    assert_close(opc_test_number("printed", "ioff_reference", i),
                 100 * (202.0 / 190 * exp(-1) - 1), 2e-3);
  }
  size_t row = opc_test_rows("check") - 1;
  assert_close(opc_test_number("check", "ion_change_mean", row),
               100 * fabs(found - known), 2e-2);
  eda_mask_free(mask);
  eda_gates_free(g);
}

static void test_refused(void) {
  g_autofree char *several = table_write("several.yaml", 4, 5);
  g_autofree char *wide = table_write("wide.yaml", 1, 5);
  opc_error error = {0};
  g_assert_cmpint(check_run(wide, wide, "", &error), ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "has one width, expected several"));
  g_assert_cmpint(check_run(several, wide, ", length: { from: 95 nm }", &error),
                  ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "no length from 95 to"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/devices-check/rectangles", test_rectangles);
  g_test_add_func("/devices-check/reference", test_reference);
  g_test_add_func("/devices-check/printed", test_printed);
  g_test_add_func("/devices-check/refused", test_refused);
  return g_test_run();
}
