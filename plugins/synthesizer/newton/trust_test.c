/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the bracket on curves with known roots, with initial steps that are ten
   times too long. */
#include "trust.c"

#include <glib.h>

/* Return a curve that is steep below the root at -7, and constant beyond -9
   like the end of a table. */
static double curve_ion(double x) {
  return x < -9 ? 0.4 : x < -7 ? -0.2 * (x + 7) : -0.01 * (x + 7);
}

static void test_bracket(void) {
  trust t = {.radius = 20};
  double x = 0, seen[ENDS] = {-INFINITY, INFINITY};
  int n = 0;
  for (; fabs(curve_ion(x)) > 1e-3; n++) {
    trust_see(&t, x, curve_ion(x));
    seen[curve_ion(x) > 0 ? SHORT : LONG] = x;
    g_assert_cmpint(n, <, 20);
    x += trust_step(&t, x, curve_ion(x) / 0.002);
    g_assert_true(seen[SHORT] < x && x < seen[LONG]);
    g_assert_true(trust_permits(&t, x));
  }
  g_assert_false(trust_permits(&t, seen[SHORT]));
  g_assert_false(trust_permits(&t, seen[LONG]));
  trust_forget(&t);
  g_assert_true(trust_permits(&t, seen[LONG]));
}

static void test_radius(void) {
  trust t = {.radius = 20};
  trust_judge(&t, -8, 0.2, 0.1, 0.21);
  g_assert_cmpfloat(t.radius, ==, 2);
  trust_judge(&t, -2, 0.2, 0.1, 0.1);
  g_assert_cmpfloat(t.radius, ==, 4);
  trust_judge(&t, -0.5, 0.2, 0.1, 0.21); /* a jog */
  g_assert_cmpfloat(t.radius, ==, 4);
  trust_see(&t, 0, -0.1);
  trust_see(&t, -9, INFINITY);
  trust_drift(&t, 0, 0.2); /* the error of the end at 0 may have changed sign */
  g_assert_cmpfloat(trust_step(&t, 0, -30), ==, -4);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/trust/bracket", test_bracket);
  g_test_add_func("/trust/radius", test_radius);
  return g_test_run();
}
