/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests edge placement errors against contours in closed form. */
#include <correct/sites.h>

#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>

/* Return a field that is positive for |x - 500| < half, along either axis. */
static eda_field strip(double half, int axis) {
  eda_field f = {.frame = {0, 0, 1000, 1000}, .nx = 40, .ny = 40};
  f.coefficients = eda_alloc(1600, sizeof(float));
  for (int j = 0; j < 40; j++)
    for (int i = 0; i < 40; i++)
      f.coefficients[40 * j + i] =
          (float)(-cos(2 * M_PI * half / 1000) -
                  cos(M_PI * (axis == EDA_X ? i : j) / 20));
  eda_field_from_samples(NULL, &f);
  return f;
}

/* Two edges of a box, on the low and the high side. */
static void test_sites(void) {
  const struct {
    double half;    /* half width of the print; drawn edges are at 500 -+ 100 */
    double site[2]; /* positions of the low and high site */
    double epe[2];
  } cases[] = {
      {130, {400, 600}, {30, 30}},
      {90, {400, 600}, {-10, -10}},
      {199, {400, 600}, {99, 99}},
      {201, {400, 600}, {NAN, NAN}},
      /* One site is just outside of the printed strip, near its edge; the other
         is far inside. */
      {103, {360, 640}, {-37, -37}},
      {103, {460, 560}, {63, 43}},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    for (int axis = 0; axis < 2; axis++) {
      eda_field f = strip(cases[i].half, axis);
      const eda_point box[] = {{400, 450}, {600, 450}, {600, 550}, {400, 550}};
      const eda_point turned[] = {
          {450, 400}, {550, 400}, {550, 600}, {450, 600}};
      const double low = cases[i].site[0], high = cases[i].site[1];
      const double x[] = {500, 450, high, 500, 500, 550, low, 500};
      const double y[] = {500, low, 550, 500, 500, high, 450, 500};
      uint32_t start[] = {0, 4};
      const eda_cuts cuts = {.polygons = 1,
                             .start = start,
                             .from = axis == EDA_X ? box : turned,
                             .site = axis == EDA_X ? x : y};
      sites s;
      correct_sites_init(&s, &cuts);
      correct_sites_measure(NULL, &s, &f, (eda_scanner){0});
      for (int side = 0; side < 2; side++) {
        int k = axis == EDA_X ? (side ? 1 : 3) : (side ? 2 : 0);
        double want = cases[i].epe[side], got = s.epe[k];
        if (isnan(want))
          g_assert_true(isnan(got));
        else
          g_assert_cmpfloat(fabs(got - want), <, 0.02);
      }
      correct_sites_clear(&s);
      free(f.coefficients);
    }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/sites/errors", test_sites);
  return g_test_run();
}
