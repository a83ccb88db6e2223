/* SPDX-License-Identifier: BSD-3-Clause */
#include <eda/litho.h>
#include <eda/natural.h>
#include <math.h>
#include <string.h>

#include <glib.h>

static const eda_scanner arf = {193, 0.75}, krf = {248, 0.7},
                         iline = {365, 0.6};

/* Expected lengths computed by hand: 193 / 0.75 = 257.3, 248 / 0.7 = 354.3, 365
   / 0.6 = 608.3. */
static void test_lengths(void) {
  static const struct {
    const eda_scanner *scanner;
    const char *text;
    double nm;
  } all[] = {
      {&arf, "0.155 lambda/NA", 40},        {&krf, "0.155 lambda/NA", 55},
      {&iline, "0.155 lambda/NA", 94},      {&krf, "1 lambda/NA", 354},
      {&krf, "0.5 lambda/NA^2", 253},       /* half of 506.1 */
      {&iline, "0.001 (lambda/NA)^2", 370}, /* 370069 nm^2 */
      {&arf, "0.0001 lambda/NA", 1}};
  for (size_t i = 0; i < G_N_ELEMENTS(all); i++)
    g_assert_cmpfloat(eda_natural(all[i].scanner, all[i].text), ==, all[i].nm);
  g_assert_cmpfloat(eda_natural_unit(iline), ==, 365 / 0.6);
}

/* An unknown scanner counts as 193 nm and NA 0.75, with a message. */
static void test_unknown(void) {
  static const eda_scanner none = {0};
  char text[128];
  g_assert_cmpfloat(eda_natural(&none, "0.155 lambda/NA"), ==, 40);
  g_assert_cmpfloat(eda_natural(&none, "1 lambda/NA^2"), ==, 343);
  eda_natural_text(none, text, sizeof text);
  g_assert_nonnull(strstr(text, "does not report"));
  eda_natural_text(krf, text, sizeof text);
  g_assert_cmpstr(text, ==, "from wavelength / NA = 354.3 nm");
  static const char *const wrong[] = {"", "0.155", "40 nm",
                                      "0.155 lambda/NA^3"};
  for (size_t i = 0; i < G_N_ELEMENTS(wrong); i++)
    g_assert_true(isnan(eda_natural(&krf, wrong[i])));
}

static eda_scanner model_scanner(const void *self) {
  return *(const eda_scanner *)self;
}

static void test_model(void) {
  static const eda_litho knows = {.scanner = model_scanner}, silent = {0};
  eda_scanner s = krf, bad = {-1, 0.7};
  opc_module m = {&knows, &s, "litho.mine"};
  g_assert_cmpfloat(eda_scanner_of(&m).wavelength, ==, 248);
  m.self = &bad;
  g_assert_cmpfloat(eda_scanner_of(&m).na, ==, 0);
  m.functions = &silent;
  g_assert_cmpfloat(eda_scanner_of(&m).na, ==, 0);
  g_assert_cmpfloat(eda_scanner_of(NULL).wavelength, ==, 0);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/natural/lengths", test_lengths);
  g_test_add_func("/natural/unknown", test_unknown);
  g_test_add_func("/natural/model", test_model);
  return g_test_run();
}
