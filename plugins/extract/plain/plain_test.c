/* SPDX-License-Identifier: BSD-3-Clause */
/* Slicing against closed forms, on a table whose current falls exponentially
   with length (a straight line in what is interpolated). */
#include "core/plugin/testing.h"

#include <math.h>
#include <string.h>

/* Ion = 1e-3 A exp(-(L - 65) / 30) per um for n, half of it for p; Ioff falls
   five times as fast. */
static double current(int type, int off, double length) {
  return (type == OPC_PMOS ? 0.5e-6 : 1e-6) * exp(-(length - 65) / (off ? 6 : 30));
}

static char *write_table(const char *name, double bend) {
  GString *lengths = g_string_new(NULL), *columns[4];
  for (int k = 0; k < 4; k++) columns[k] = g_string_new(NULL);
  for (int length = 40; length <= 120; length += 5) {
    const char *comma = length > 40 ? ", " : "";
    g_string_append_printf(lengths, "%s%d", comma, length);
    for (int k = 0; k < 4; k++)
      g_string_append_printf(columns[k], "%s%.9g", comma,
                             1e4 * current(k / 2, k % 2, length) *
                                 (length == 80 ? bend : 1));
  }
  char *path = g_build_filename(opc_test_folder(), name, NULL);
  g_autofree char *text = g_strdup_printf(
      "opcflow-devices: 1\nname: test\nsource: formula\nsupply: 1 V\n"
      "temperature: 27 C\nwidth: 10 um\nion: on\nioff: off\n"
      "length: {unit: nm, values: [%s]}\n"
      "nmos: {ion: {unit: A, values: [%s]}, ioff: {unit: A, values: [%s]}}\n"
      "pmos: {ion: {unit: A, values: [%s]}, ioff: {unit: A, values: [%s]}}\n",
      lengths->str, columns[0]->str, columns[1]->str, columns[2]->str,
      columns[3]->str);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  g_string_free(lengths, TRUE);
  for (int k = 0; k < 4; k++) g_string_free(columns[k], TRUE);
  return path;
}

static opc_module *make(const char *file, const char *more, int expect) {
  g_autofree char *text = g_strdup_printf("{ devices: '%s'%s }", file, more);
  opc_error error = {0};
  opc_module *m = opc_test_module("extract.plain", text, &error);
  g_assert_nonnull(m);
  const opc_extract *e = m->plugin->operations;
  g_assert_cmpint(e->prepare(m->self, &error), ==, expect);
  return m;
}

typedef struct figures {
  double ion, ioff, leq_ion, leq_ioff, weq, area;
} figures;

/* A gate of width w whose length at the fraction t of it is length(t). */
static figures of_gate(opc_module *m, uint8_t type, double w,
                       double (*length)(double)) {
  const opc_extract *e = m->plugin->operations;
  const double *place, *share;
  size_t n = e->slicing(m->self, &place, &share);
  g_autofree double *widths = g_new0(double, 3 * n);
  for (size_t i = 0; i < n; i++) {
    widths[i] = share[i] * w;
    widths[n + i] = length(place[i]);
    widths[2 * n + i] = w * MIN(place[i], 1 - place[i]);
  }
  figures f;
  opc_performance out = {1, &f.ion, &f.ioff, &f.leq_ion, &f.leq_ioff,
                         &f.weq, &f.area};
  opc_slices in = {.size = sizeof in, .count = 1, .slices = n, .type = &type,
                   .width = widths, .length = widths + n, .edge = widths + 2 * n};
  opc_error error;
  g_assert_cmpint(e->extract(m->self, &in, &out, &error), ==, OPC_OK);
  return f;
}

static void near(double a, double b, double relative) {
  if (!(fabs(a - b) <= relative * fabs(b)))
    g_error("%.12g is not %.12g within %g", a, b, relative);
}

static double straight(double t) { return t < 2 ? 71.3 : 0; }
static double slope(double t) { return 60 + 14 * t; }
static double two_lengths(double t) { return t < 0.5 ? 60 : 75; }
static double short_one(double t) { return t < 2 ? 20 : 0; }

static void test_rectangle(void) {
  g_autofree char *file = write_table("rectangle.yaml", 1);
  g_autoptr(opc_module) m = make(file, "", OPC_OK);
  for (int type = OPC_NMOS; type <= OPC_PMOS; type++) {
    figures f = of_gate(m, (uint8_t)type, 350, straight);
    near(f.ion, 350 * current(type, 0, 71.3), 1e-8);
    near(f.ioff, 350 * current(type, 1, 71.3), 1e-8);
    near(f.leq_ion, 71.3, 1e-9);
    near(f.leq_ioff, 71.3, 1e-9);
    near(f.weq, 350, 1e-12);
    near(f.area, 350 * 71.3, 1e-12);
  }
}

/* The integral of exp(-L / s) over L from 60 to 74. */
static void test_trapezoid(void) {
  g_autofree char *file = write_table("trapezoid.yaml", 1);
  g_autoptr(opc_module) m = make(file, "", OPC_OK);
  figures f = of_gate(m, OPC_NMOS, 400, slope);
  double ion = 400 / 14.0 * 30 * (current(0, 0, 60) - current(0, 0, 74));
  double ioff = 400 / 14.0 * 6 * (current(0, 1, 60) - current(0, 1, 74));
  near(f.ion, ion, 1e-8);
  near(f.ioff, ioff, 1e-8);
  near(f.leq_ion, 65 - 30 * log(ion / 400 / 1e-6), 1e-8);
  near(f.leq_ioff, 65 - 6 * log(ioff / 400 / 1e-6), 1e-8);
  near(f.area, 400 * 67, 1e-12);
  g_assert_cmpfloat(f.leq_ioff, <, f.leq_ion);   /* leakage looks shortest */
}

static void test_two_lengths(void) {
  g_autofree char *file = write_table("two.yaml", 1);
  g_autoptr(opc_module) m = make(file, ", rule: equal, slices: 10", OPC_OK);
  figures f = of_gate(m, OPC_PMOS, 200, two_lengths);
  near(f.ion, 100 * current(1, 0, 60) + 100 * current(1, 0, 75), 1e-8);
  near(f.area, 100 * 60 + 100 * 75, 1e-12);
}

/* Slices shorter than the table takes count as its shortest. */
static void test_clamped(void) {
  g_autofree char *file = write_table("clamped.yaml", 1);
  g_autoptr(opc_module) m = make(file, "", OPC_OK);
  figures f = of_gate(m, OPC_NMOS, 100, short_one);
  near(f.ion, 100 * current(0, 0, 40), 1e-8);
  near(f.leq_ion, 40, 1e-9);
}

static void test_rising_table(void) {
  g_autofree char *file = write_table("rising.yaml", 3);
  g_autofree char *text = g_strdup_printf("{ devices: '%s' }", file);
  opc_error error;
  g_autoptr(opc_module) m = opc_test_module("extract.plain", text, &error);
  g_assert_nonnull(m);
  const opc_extract *e = m->plugin->operations;
  g_assert_cmpint(e->prepare(m->self, &error), ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "does not fall from 75 to 80 nm"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/plain/rectangle", test_rectangle);
  g_test_add_func("/plain/trapezoid", test_trapezoid);
  g_test_add_func("/plain/two-lengths", test_two_lengths);
  g_test_add_func("/plain/clamped", test_clamped);
  g_test_add_func("/plain/rising-table", test_rising_table);
  return g_test_run();
}
