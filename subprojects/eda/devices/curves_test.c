/* SPDX-License-Identifier: BSD-3-Clause */
/* Curves of a table with exponential currents: interpolation, inverse, and
   tables without a unique inverse. */
#include <eda/curves.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

static char *folder;

/* Read a table with ion 1e-3 * 2^(-L/50) A and ioff 1e-6 * 2^(-L/5) A for 1 nm
   of width. */
static int read_table(int lengths, double first, double last, eda_curves *c,
                      opc_error *error) {
  g_autoptr(GString) length = g_string_new("length: { unit: nm, values: [");
  g_autoptr(GString) ion = g_string_new("  ion: { unit: A, values: [");
  g_autoptr(GString) ioff = g_string_new("  ioff: { unit: A, values: [");
  for (int i = 0; i < lengths; i++) {
    double l = 40 + 2 * i, factor = i + 1 == lengths ? last : i ? 1 : first;
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
  if (read_table(21, 1, 1, &c, &error)) g_error("%s", error.message);
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

static void assert_same(double a, double b, double within) {
  if (!(fabs(a - b) <= within)) g_error("%.12g is not %.12g", a, b);
}

/* Exponentials and their inverses are extrapolated exactly: down to a quarter
   of the shortest length, up to four times the longest length, or over a factor
   of e^20. */
static void test_beyond(void) {
  static const double last[EDA_CURRENTS] = {320, 80 + 20 * 5 / M_LN2};
  static const double fall[EDA_CURRENTS] = {50, 5}, unit[] = {1e-3, 1e-6};
  eda_curves c = {0};
  opc_error error;
  if (read_table(21, 1, 1, &c, &error)) g_error("%s", error.message);
  for (int k = 0; k < EDA_CURRENTS; k++) {
    for (double l = 10; l < 220; l += l < 40 || l > 80 ? 0.7 : 41) {
      double at = eda_curves_at(&c, EDA_NMOS, k, l), quick[EDA_CURRENTS];
      eda_curves_quick(&c, EDA_NMOS, l, quick);
      assert_same(at, log(unit[k]) - l / fall[k] * M_LN2, 1e-9);
      assert_same(quick[k] / exp(at), 1, 1e-5);
      assert_same(eda_curves_length(&c, EDA_NMOS, k, at), l, 1e-6);
    }
    double far[] = {eda_curves_at(&c, 0, k, 10),
                    eda_curves_at(&c, 0, k, last[k])};
    static const double lengths[] = {0, -5, 9, NAN, 1e12, INFINITY};
    for (size_t i = 0; i < G_N_ELEMENTS(lengths); i++)
      assert_same(eda_curves_at(&c, 0, k, lengths[i]), far[i > 3], 1e-9);
    assert_same(eda_curves_length(&c, 0, k, INFINITY), 10, 0);
    assert_same(eda_curves_length(&c, 0, k, -INFINITY), last[k], 1e-6);
  }
  eda_curves_clear(&c);
}

/* Return the ratio of the slope of log Ion beyond an end of a table to the
   slope within the table. The table has 41 lengths; its last step in the
   logarithm is reduced by `smaller`. */
static double slope_beyond(int high, double smaller) {
  eda_curves c = {0};
  opc_error error;
  double last = high ? exp(smaller) : 1, first = high ? 1 : exp(-smaller);
  if (read_table(41, first, last, &c, &error)) g_error("%s", error.message);
  double end = high ? 120 : 40, out = high ? 130 : 30;
  double at[] = {eda_curves_at(&c, EDA_NMOS, EDA_ION, end),
                 eda_curves_at(&c, EDA_NMOS, EDA_ION, out)};
  assert_same(eda_curves_length(&c, EDA_NMOS, EDA_ION, at[1]), out, 1e-6);
  eda_curves_clear(&c);
  return (at[1] - at[0]) / (out - end) / (-M_LN2 / 50);
}

/* The last step of the table determines the slope, limited to half and twice
   the mean over the outermost tenth (four steps). */
static void test_rough_end(void) {
  const double step = 2 * M_LN2 / 50;
  for (int high = 0; high < 2; high++) {
    assert_same(slope_beyond(high, 0), 1, 1e-9);
    assert_same(slope_beyond(high, 0.3 * step), 0.7, 1e-9);
    assert_same(slope_beyond(high, 0.999 * step), 3.001 / 4 / 2, 1e-9);
    assert_same(slope_beyond(high, -step), 2, 1e-9);
    assert_same(slope_beyond(high, -5 * step), 9.0 / 4 * 2, 1e-9);
  }
}

/* Three widths, with an additional factor exp(b / W) in the current per width;
   Ioff of the p-transistor rises with length. */
static const double part[EDA_CURRENTS] = {-40, 90}; /* b, nm */

static double made_up(int type, int k, double length, double width) {
  double fall = k == EDA_ION ? 50 : type == EDA_PMOS ? -500 : 5;
  return log(k == EDA_ION ? 1e-3 : 1e-6) - length / fall * M_LN2 +
         part[k] / width;
}

static void read_widths(eda_curves *c) {
  static const double widths[] = {200, 400, 5000};
  opc_error error;
  g_autoptr(GString) text = g_string_new(
      "opcflow-devices: 1\nname: test\nsupply: 1 V\n"
      "width: { unit: nm, values: [200, 400, 5000] }\n"
      "length: { unit: nm, values: [40, 50, 60, 70] }\n");
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < EDA_CURRENTS; k++) {
      g_string_append_printf(text, "%s  %s: { unit: A, values: [",
                             k   ? ""
                             : t ? "pmos:\n"
                                 : "nmos:\n",
                             k ? "ioff" : "ion");
      for (int w = 0; w < 3; w++)
        for (int i = 0; i < 4; i++)
          g_string_append_printf(
              text, "%s%.17g%s",
              i   ? ", "
              : w ? ", ["
                  : "[",
              widths[w] * exp(made_up(t, k, 40 + 10 * i, widths[w])),
              i == 3 ? "]" : "");
      g_string_append(text, "] }\n");
    }
  g_assert_true(g_file_set_contents("table.yaml", text->str, -1, NULL));
  if (eda_curves_read(c, "table.yaml", &error)) g_error("%s", error.message);
}

static void test_widths(void) {
  eda_curves c = {0};
  read_widths(&c);
  assert_same(eda_curves_narrowest(&c), 200, 0);
  for (double width = 200; width < 5000; width *= 1.17) {
    eda_curves_width w = eda_curves_among(&c, width);
    g_assert_false(w.is_wide);
    for (double l = 41.3; l < 70; l += 3.1)
      for (int t = 0; t < 2; t++) {
        double quick[EDA_CURRENTS];
        eda_curves_narrow_quick(&c, t, l, &w, quick);
        for (int k = 0; k < EDA_CURRENTS; k++) {
          double want = made_up(t, k, l, width);
          assert_same(eda_curves_narrow_at(&c, t, k, l, &w), want, 1e-9);
          assert_same(log(quick[k]), want, 1e-5);
          /* The search starts 5 nm away; it also works where the current
             rises. */
          assert_same(eda_curves_narrow_length(&c, t, k, want, &w, l + 5), l,
                      1e-6);
        }
      }
    double least = exp(part[EDA_ION] * (1 / width - 1.0 / 5000));
    assert_same(eda_curves_least_share(&c, 0, EDA_ION, &w), least, 2e-2);
    assert_same(eda_curves_least_share(&c, 0, EDA_IOFF, &w), 1, 1e-12);
  }
  /* Widths outside the table have the current per width of the nearest width.
   */
  eda_curves_width w = eda_curves_among(&c, 90);
  assert_same(eda_curves_narrow_at(&c, 0, 0, 55, &w), made_up(0, 0, 55, 200),
              1e-9);
  w = eda_curves_among(&c, 5001);
  g_assert_true(w.is_wide);
  assert_same(eda_curves_narrow_at(&c, 0, 0, 55, &w), made_up(0, 0, 55, 5000),
              1e-9);
  eda_curves_clear(&c);
}

static void test_refused(void) {
  eda_curves c = {0};
  opc_error error;
  g_assert_cmpint(read_table(2, 1, 1, &c, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "devices");
  g_assert_cmpstr(error.message, ==,
                  "'table.yaml' has 2 lengths, expected at least 3");
  g_assert_cmpint(read_table(5, 1, 2, &c, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.message, ==,
                  "'table.yaml': a current does not fall from 46 to 48 nm, so "
                  "that a length cannot be computed");
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
  g_test_add_func("/curves/widths", test_widths);
  g_test_add_func("/curves/refused", test_refused);
  int failed = g_test_run();
  g_unlink("table.yaml");
  g_assert_cmpint(g_chdir("/"), ==, 0);
  g_assert_cmpint(g_rmdir(folder), ==, 0);
  g_free(folder);
  return failed;
}
