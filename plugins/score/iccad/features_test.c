/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the features of random pixels, compared with a simple relaxation and a
   comparison of all pairs. Also tests a case drawn by hand. */
#include <glib.h>
#include <string.h>

#include "features.c"

enum { SIDE = 24, PIXELS = SIDE * SIDE };

static const iccad_tile tile = {.side = SIDE};

/* Compute for each pixel the least index + 1 of its connected set. */
static void pixels_spread(const uint8_t *pixels, int *number) {
  static const int dx[] = {1, -1, 0, 0}, dy[] = {0, 0, 1, -1};
  int again = 1;
  for (int i = 0; i < PIXELS; i++) number[i] = pixels[i] ? i + 1 : 0;
  while (again) {
    again = 0;
    for (int i = 0; i < PIXELS; i++)
      for (int k = 0; k < 4 && number[i]; k++) {
        int x = i % SIDE + dx[k], y = i / SIDE + dy[k];
        if (x < 0 || y < 0 || x >= SIDE || y >= SIDE) continue;
        int other = number[y * SIDE + x];
        if (!other || other >= number[i]) continue;
        number[i] = other;
        again = 1;
      }
  }
}

static int sets_overlap(const int *a, int in_a, const int *b, int in_b) {
  for (int i = 0; i < PIXELS; i++)
    if (a[i] == in_a && b[i] == in_b) return 1;
  return 0;
}

/* Count the sets of `a` that share no pixel with a set of `b`, and the sets of
   `b` in excess of one per set of `a`. */
static void meetings(const int *a, const int *b, int64_t *none, int64_t *more) {
  *none = *more = 0;
  for (int i = 0; i < PIXELS; i++) {
    if (a[i] != i + 1) continue;
    int met = 0;
    for (int j = 0; j < PIXELS; j++)
      if (b[j] == j + 1) met += sets_overlap(a, i + 1, b, j + 1);
    *none += !met;
    if (met) *more += met - 1;
  }
}

static void test_random(void) {
  g_autoptr(GRand) rand = g_rand_new_with_seed(7);
  int64_t seen[4] = {0};
  for (int run = 0; run < 40; run++) {
    uint8_t target[PIXELS], print[PIXELS];
    int feature[PIXELS], piece[PIXELS];
    double part = g_rand_double_range(rand, 0.2, 0.6);
    for (int i = 0; i < PIXELS; i++) {
      target[i] = g_rand_double(rand) < part;
      print[i] = g_rand_double(rand) < 0.2 ? !target[i] : target[i];
    }
    pixels_spread(target, feature);
    pixels_spread(print, piece);
    iccad_features got = iccad_compare(&tile, target, print), want;
    meetings(feature, piece, &want.lost, &want.broken);
    meetings(piece, feature, &want.extra, &want.bridged);
    g_assert_cmpint(got.lost, ==, want.lost);
    g_assert_cmpint(got.broken, ==, want.broken);
    g_assert_cmpint(got.bridged, ==, want.bridged);
    g_assert_cmpint(got.extra, ==, want.extra);
    seen[0] += got.lost, seen[1] += got.broken;
    seen[2] += got.bridged, seen[3] += got.extra;
  }
  for (int k = 0; k < 4; k++) g_assert_cmpint(seen[k], >, 10);
}

static void box(uint8_t *pixels, int x0, int y0, int x1, int y1) {
  for (int y = y0; y < y1; y++)
    memset(pixels + y * SIDE + x0, 1, (size_t)(x1 - x0));
}

/* Test four rectangles: two that print as one, one in two pieces, one not
   printed, and a spot between them. Pixels that touch only at a corner are not
   connected. */
static void test_drawn(void) {
  uint8_t target[PIXELS] = {0}, print[PIXELS] = {0};
  for (int k = 0; k < 4; k++) box(target, 6 * k, 2, 6 * k + 3, 22);
  box(print, 0, 2, 9, 22);
  box(print, 12, 2, 15, 8);
  box(print, 12, 14, 15, 22);
  box(print, 21, 22, 23, 24);
  iccad_features f = iccad_compare(&tile, target, print);
  g_assert_cmpint(f.bridged, ==, 1);
  g_assert_cmpint(f.broken, ==, 1);
  g_assert_cmpint(f.lost, ==, 1);
  g_assert_cmpint(f.extra, ==, 1);
  f = iccad_compare(&tile, target, target);
  g_assert_cmpint(f.bridged + f.broken + f.lost + f.extra, ==, 0);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/features/random", test_random);
  g_test_add_func("/features/drawn", test_drawn);
  return g_test_run();
}
