/* SPDX-License-Identifier: BSD-3-Clause */
/* Conversions of units, compared with their definitions. */
#include <base/unit.h>
#include <math.h>
#include <string.h>

static double unit_convert(const char *text, const char *to) {
  size_t n = opc_number_length(text);
  g_assert_cmpuint(n, >, 0);
  const char *name = text + n;
  while (*name == ' ') name++;
  const opc_unit *from = opc_unit_find(name), *unit = opc_unit_find(to);
  g_assert_nonnull(from);
  g_assert_nonnull(unit);
  g_assert_true(opc_unit_noun(from) == opc_unit_noun(unit));
  return opc_number_in(text, n, from, unit);
}

/* Powers of ten are exact: a value written in another unit is bit-identical. */
static void test_exact(void) {
  g_assert_true(unit_convert("0.065 um", "nm") == 65);
  g_assert_true(unit_convert("193nm", "nm") == 193);
  g_assert_true(unit_convert("1930 angstrom", "nm") == 193);
  g_assert_true(unit_convert("0.1 um", "nm") == 100);
  g_assert_true(unit_convert("65 nm", "um") == 0.065);
  g_assert_true(unit_convert("1.1523 mA", "A") == 0.0011523);
  g_assert_true(unit_convert("3e2 pA", "nA") == 0.3);
  g_assert_true(unit_convert("1 1/um", "1/nm") == 0.001);
  g_assert_true(unit_convert("3 um^2", "nm^2") == 3e6);
  g_assert_true(unit_convert(".5 %", "%") == 0.5);
  g_assert_true(unit_convert("2.5 ns", "s") == 2.5e-9);
  g_assert_true(unit_convert("-1.e-3 m", "nm") == -1e6);
  g_assert_true(unit_convert("7 \xC2\xB5m", "nm") == 7000);
}

static void test_other(void) {
  g_assert_cmpfloat_with_epsilon(unit_convert("300 K", "C"), 26.85, 1e-10);
  g_assert_cmpfloat_with_epsilon(unit_convert("27 C", "K"), 300.15, 1e-10);
  g_assert_cmpfloat_with_epsilon(unit_convert("3.14159265358979 rad", "deg"),
                                 180, 1e-10);
  g_assert_cmpfloat_with_epsilon(unit_convert("90 deg", "rad"), G_PI_2, 1e-12);
}

static void test_numbers(void) {
  static const struct {
    const char *text;
    size_t length;
  } cases[] = {{"12", 2},  {"-1.5e-9x", 7}, {"+.5", 3},  {"1.", 2},
               {"1e", 1},  {"1e+", 1},      {"0x10", 1}, {"nan", 0},
               {"inf", 0}, {".", 0},        {"-", 0},    {"e5", 0},
               {"", 0},    {"1e5 nm", 3},   {"5eV", 1}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    g_assert_cmpuint(opc_number_length(cases[i].text), ==, cases[i].length);
  g_assert_true(isinf(opc_number_in("1e99999999999999999999", 22, NULL, NULL)));
  g_assert_true(opc_number_in("1e-99999999999999999999", 23, NULL, NULL) == 0);
}

static void test_zero(void) {
  static const char *const same[] = {"nm", "um^2", "1/um", "%", "mV", "rad"};
  for (size_t i = 0; i < G_N_ELEMENTS(same); i++)
    g_assert_true(opc_unit_shares_zero(opc_unit_find(same[i])));
  g_assert_false(opc_unit_shares_zero(opc_unit_find("C")));
  g_assert_false(opc_unit_shares_zero(opc_unit_find("K")));
}

static void test_text(void) {
  static const double numbers[] = {0.1,  1e300,  1.0 / 3,  65,
                                   -0.5, 5e-324, 0.1 + 0.2};
  for (size_t i = 0; i < G_N_ELEMENTS(numbers); i++) {
    g_autofree char *text = opc_number_text(numbers[i]);
    g_assert_true(g_ascii_strtod(text, NULL) == numbers[i]);
  }
  g_autofree char *tenth = opc_number_text(0.1);
  g_assert_cmpstr(tenth, ==, "0.1");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/unit/exact", test_exact);
  g_test_add_func("/unit/other", test_other);
  g_test_add_func("/unit/numbers", test_numbers);
  g_test_add_func("/unit/zero", test_zero);
  g_test_add_func("/unit/text", test_text);
  return g_test_run();
}
