/* SPDX-License-Identifier: BSD-3-Clause */
/* Grown and shrunk shapes, compared with pixels of a bitmap and their
   neighbours. */
#include "geometry/bitmap_test.h"

static int pixel(const bitmap *b, int x, int y) {
  return x >= 0 && y >= 0 && x < SIZE && y < SIZE && b->at[y][x];
}

/* Return whether any pixel (`by` > 0), or each pixel (`by` < 0), at a distance
   of at most |by| from a pixel along x and y is set. */
static int around(const bitmap *b, int x, int y, int by) {
  int any = 0, all = 1, r = ABS(by);
  for (int v = y - r; v <= y + r; v++)
    for (int u = x - r; u <= x + r; u++) {
      any |= pixel(b, u, v);
      all &= pixel(b, u, v);
    }
  return by > 0 ? any : all;
}

/* Draw shapes clipped to the bitmap. */
static void draw_inside(bitmap *b, const eda_shapes *s) {
  opc_error error;
  builder frame = builder_new();
  builder_box(&frame, 0, 0, SIZE, SIZE);
  eda_shapes box = builder_shapes(&frame), inside;
  g_assert_false(eda_boolean(EDA_AND, s, &box, &inside, &error));
  bitmap_draw(b, &inside);
  eda_shapes_clear(&inside);
  builder_free(&frame);
}

static void grow_check(const eda_shapes *merged, int by) {
  opc_error error;
  eda_shapes out;
  bitmap was, got, want;
  g_assert_false(eda_shapes_grow(merged, by, &out, &error));
  bitmap_draw(&was, merged);
  draw_inside(&got, &out);
  for (int y = 0; y < SIZE; y++)
    for (int x = 0; x < SIZE; x++)
      want.at[y][x] = (uint8_t)around(&was, x, y, by);
  g_assert_cmpmem(&got, sizeof got, &want, sizeof want);
  eda_shapes_clear(&out);
}

static void test_random(void) {
  GRand *r = g_rand_new_with_seed(7);
  for (int i = 0; i < 1000; i++) {
    builder b = random_shapes(r, i % 9);
    eda_shapes s = builder_shapes(&b), merged;
    opc_error error;
    g_assert_false(eda_boolean(EDA_OR, &s, NULL, &merged, &error));
    for (int by = -2; by <= 2; by++) grow_check(&merged, by);
    eda_shapes_clear(&merged);
    builder_free(&b);
  }
  g_rand_free(r);
}

/* Grow and shrink a rectangle and empty shapes. */
static void test_known(void) {
  opc_error error;
  builder b = builder_new();
  builder_box(&b, 0, 0, 10, 20);
  eda_shapes s = builder_shapes(&b), out;
  g_assert_false(eda_shapes_grow(&s, 3, &out, &error));
  g_assert_cmpint(eda_area2(&out), ==, 2 * 16 * 26);
  eda_shapes_clear(&out);
  g_assert_false(eda_shapes_grow(&s, -4, &out, &error));
  g_assert_cmpint(eda_area2(&out), ==, 2 * 2 * 12);
  eda_shapes_clear(&out);
  g_assert_false(eda_shapes_grow(&s, -5, &out, &error));
  g_assert_cmpuint(out.count, ==, 0);
  eda_shapes_clear(&out);
  builder_free(&b);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/grow/random", test_random);
  g_test_add_func("/grow/known", test_known);
  return g_test_run();
}
