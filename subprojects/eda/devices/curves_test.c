/* SPDX-License-Identifier: BSD-3-Clause */
/* Curves of a table whose currents are exponentials: what is interpolated, the
   way back to a length, and tables that tell none. */
#include <eda/curves.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

static char *folder;

/* ion 1e-3 * 2^(-L/50) A and ioff 1e-6 * 2^(-L/5) A, of 1 nm of width. */
static int read_table(int lengths, double last, eda_curves *c,
                      opc_error *error) {
  g_autoptr(GString) length = g_string_new("length: { unit: nm, values: [");
  g_autoptr(GString) ion = g_string_new("  ion: { unit: A, values: [");
  g_autoptr(GString) ioff = g_string_new("  ioff: { unit: A, values: [");
  for (int i = 0; i < lengths; i++) {
    double l = 40 + 2 * i, factor = i + 1 == lengths ? last : 1;
    const char *comma = i ? ", " : "";
    g_string_append_printf(length, "%s%g", comma, l);
    g_string_append_printf(ion, "%s%.17g", comma,
                           factor * 1e-3 * exp2(-l / 50));
    g_string_append_printf(ioff, "%s%.17g", comma, 1e-6 * exp2(-l / 5));
  }
  g_autofree char *text = g_strdup_printf(
      "opcflow-devices: 1\nname: test\nsupply: 1 V\nwidth: 1 nm\n%s] }\n"
      "nmos:\n%s] }\n%s] }\npmos:\n%s] }\n%s] }\n",
      length->str, ion->str, ioff->str, ion->str, ioff->str);
  g_assert_true(g_file_set_contents("table.yaml", text, -1, NULL));
  return eda_curves_read(c, "table.yaml", error);
}

static void test_values(void) {
  eda_curves c = {0};
  opc_error error;
  if (read_table(21, 1, &c, &error)) g_error("%s", error.message);
  g_assert_cmpfloat(eda_curves_shortest(&c), ==, 40);
  g_assert_cmpfloat(eda_curves_longest(&c), ==, 80);
  for (double l = 40; l <= 80; l += 0.37) {
    double at[EDA_CURRENTS], quick[EDA_CURRENTS];
    eda_curves_quick(&c, EDA_PMOS, l, quick);
    for (int k = 0; k < EDA_CURRENTS; k++) {
      at[k] = eda_curves_at(&c, EDA_PMOS, k, l);
      double want =
          k == EDA_ION ? log(1e-3 * exp2(-l / 50)) : log(1e-6 * exp2(-l / 5));
      g_assert_cmpfloat(fabs(at[k] - want), <, 1e-9);
      g_assert_cmpfloat(fabs(quick[k] / exp(at[k]) - 1), <, 1e-5);
      g_assert_cmpfloat(fabs(eda_curves_length(&c, EDA_PMOS, k, at[k]) - l), <,
                        1e-6);
    }
  }
  eda_devices *once = c.devices;
  g_assert_cmpint(eda_curves_read(&c, "none.yaml", &error), ==, OPC_OK);
  g_assert_true(c.devices == once);
  eda_curves_clear(&c);
  g_assert_null(c.devices);
}

static void same(double a, double b, double within) {
  if (!(fabs(a - b) <= within)) g_error("%.12g is not %.12g", a, b);
}

/* Exponentials go on as they are, and back to their lengths: down to a quarter
   of the shortest and up to four times the longest, or over e^20. */
static void test_beyond(void) {
  static const double last[EDA_CURRENTS] = {320, 80 + 20 * 5 / M_LN2};
  static const double fall[EDA_CURRENTS] = {50, 5}, unit[] = {1e-3, 1e-6};
  eda_curves c = {0};
  opc_error error;
  if (read_table(21, 1, &c, &error)) g_error("%s", error.message);
  for (int k = 0; k < EDA_CURRENTS; k++) {
    for (double l = 10; l < 220; l += l < 40 || l > 80 ? 0.7 : 41) {
      double at = eda_curves_at(&c, EDA_NMOS, k, l), quick[EDA_CURRENTS];
      eda_curves_quick(&c, EDA_NMOS, l, quick);
      same(at, log(unit[k]) - l / fall[k] * M_LN2, 1e-9);
      same(quick[k] / exp(at), 1, 1e-5);
      same(eda_curves_length(&c, EDA_NMOS, k, at), l, 1e-6);
    }
    double far[] = {eda_curves_at(&c, 0, k, 10),
                    eda_curves_at(&c, 0, k, last[k])};
    static const double lengths[] = {0, -5, 9, NAN, 1e12, INFINITY};
    for (size_t i = 0; i < G_N_ELEMENTS(lengths); i++)
      same(eda_curves_at(&c, 0, k, lengths[i]), far[i > 3], 1e-9);
    same(eda_curves_length(&c, 0, k, INFINITY), 10, 0);
    same(eda_curves_length(&c, 0, k, -INFINITY), last[k], 1e-6);
  }
  eda_curves_clear(&c);
}

/* The slope of log Ion beyond the long end of a table of 41 lengths, whose last
   current is that many times what it should be; over that of the others. */
static double slope_beyond(double last) {
  eda_curves c = {0};
  opc_error error;
  if (read_table(41, last, &c, &error)) g_error("%s", error.message);
  double at[] = {eda_curves_at(&c, EDA_NMOS, EDA_ION, 120),
                 eda_curves_at(&c, EDA_NMOS, EDA_ION, 130)};
  same(eda_curves_length(&c, EDA_NMOS, EDA_ION, at[1]), 130, 1e-6);
  eda_curves_clear(&c);
  return (at[1] - at[0]) / 10 / (-M_LN2 / 50);
}

/* The last step of the table gives the slope, but no less than half and no more
   than twice the mean of its last tenth, which is four steps. */
static void test_rough_end(void) {
  const double step = 2 * M_LN2 / 50;
  same(slope_beyond(1), 1, 1e-9);
  same(slope_beyond(exp(0.3 * step)), 0.7, 1e-9);
  same(slope_beyond(exp(0.999 * step)), 3.001 / 4 / 2, 1e-9);
  same(slope_beyond(exp(-step)), 2, 1e-9);
  same(slope_beyond(exp(-5 * step)), 9.0 / 4 * 2, 1e-9);
}

static void test_refused(void) {
  eda_curves c = {0};
  opc_error error;
  g_assert_cmpint(read_table(2, 1, &c, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "devices");
  g_assert_cmpstr(error.message, ==,
                  "'table.yaml' has 2 lengths, at least 3 are needed");
  g_assert_cmpint(read_table(5, 2, &c, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.message, ==,
                  "'table.yaml': a current does not fall from 46 to 48 nm, so "
                  "that it tells no length");
  g_assert_null(c.devices);
  g_assert_cmpint(eda_curves_read(&c, "none.yaml", &error), ==, OPC_IO);
  eda_curves_clear(&c);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("eda-XXXXXX", NULL);
  g_assert_cmpint(g_chdir(folder), ==, 0);
  g_test_add_func("/curves/values", test_values);
  g_test_add_func("/curves/beyond", test_beyond);
  g_test_add_func("/curves/rough-end", test_rough_end);
  g_test_add_func("/curves/refused", test_refused);
  int failed = g_test_run();
  g_unlink("table.yaml");
  g_assert_cmpint(g_chdir("/"), ==, 0);
  g_assert_cmpint(g_rmdir(folder), ==, 0);
  g_free(folder);
  return failed;
}
