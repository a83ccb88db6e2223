/* SPDX-License-Identifier: BSD-3-Clause */
/* Fractures of random shapes, compared with bitmaps, and of known shapes. */
#include "geometry/bitmap_test.h"

/* Return the number of slabs of part `label` if dissected along x (0) or y (1):
   the runs of pixels that do not also occur in the previous row. */
static size_t count_slabs(const labels *l, int label, int orientation) {
  size_t n = 0;
  for (int j = 1; j <= SIZE; j++)
    for (int i = 1; i <= SIZE; i++) {
#define AT(u, v) (orientation ? l->at[u][v] == label : l->at[v][u] == label)
      if (!AT(i, j) || AT(i - 1, j)) continue;
      int end = i;
      while (AT(end, j)) end++;
      int goes_on = !AT(i - 1, j - 1) && !AT(end, j - 1);
      for (int k = i; k < end; k++) goes_on &= AT(k, j - 1);
      n += !goes_on;
#undef AT
    }
  return n;
}

static void fracture_check(const eda_shapes *s) {
  opc_error error;
  eda_box *boxes;
  size_t n, want = 0;
  bitmap drawn;
  labels l;
  uint8_t cover[SIZE][SIZE] = {0};
  g_assert_cmpint(eda_fracture(s, &boxes, &n, &error), ==, OPC_OK);
  bitmap_draw(&drawn, s);
  for (size_t i = 0; i < n; i++) {
    g_assert_true(boxes[i].x0 < boxes[i].x1 && boxes[i].y0 < boxes[i].y1);
    if (i)
      g_assert_true(
          boxes[i - 1].y0 < boxes[i].y0 ||
          (boxes[i - 1].y0 == boxes[i].y0 && boxes[i - 1].x0 < boxes[i].x0));
    for (int y = boxes[i].y0; y < boxes[i].y1; y++)
      for (int x = boxes[i].x0; x < boxes[i].x1; x++) cover[y][x]++;
  }
  g_assert_cmpmem(cover, sizeof cover, &drawn, sizeof drawn);
  bitmap_label(&drawn, 1, 4, &l);
  for (int c = 1; c <= l.count; c++)
    want += MIN(count_slabs(&l, c, 0), count_slabs(&l, c, 1));
  g_assert_cmpuint(n, ==, want);
  free(boxes);
}

static void test_random(void) {
  GRand *r = g_rand_new_with_seed(2);
  for (int i = 0; i < 6000; i++) {
    builder b = random_shapes(r, i % 16);
    eda_shapes s = builder_shapes(&b), merged;
    opc_error error;
    g_assert_cmpint(eda_boolean(EDA_OR, &s, NULL, &merged, &error), ==, OPC_OK);
    fracture_check(&merged);
    eda_shapes_clear(&merged);
    builder_free(&b);
  }
  g_rand_free(r);
}

/* Shapes that are not merged are invalid input, but must not cause a crash. */
static void test_not_merged(void) {
  GRand *r = g_rand_new_with_seed(3);
  for (int i = 0; i < 2000; i++) {
    builder b = random_shapes(r, 12);
    eda_shapes s = builder_shapes(&b);
    opc_error error;
    eda_box *boxes;
    size_t n;
    g_assert_cmpint(eda_fracture(&s, &boxes, &n, &error), ==, OPC_OK);
    free(boxes);
    builder_free(&b);
  }
  g_rand_free(r);
}

static void test_known(void) {
  /* A comb: 1 + 3 boxes along x, but 7 along y. */
  builder b = builder_new();
  builder_box(&b, 0, 0, 14, 2);
  builder_box(&b, 1, 2, 3, 9);
  builder_box(&b, 5, 2, 7, 9);
  builder_box(&b, 9, 2, 11, 9);
  eda_shapes s = builder_shapes(&b), merged;
  opc_error error;
  eda_box *boxes;
  size_t n;
  g_assert_cmpint(eda_boolean(EDA_OR, &s, NULL, &merged, &error), ==, OPC_OK);
  g_assert_cmpint(eda_fracture(&merged, &boxes, &n, &error), ==, OPC_OK);
  static const eda_box want[] = {
      {0, 0, 14, 2}, {1, 2, 3, 9}, {5, 2, 7, 9}, {9, 2, 11, 9}};
  g_assert_cmpmem(boxes, n * sizeof *boxes, want, sizeof want);
  free(boxes);
  eda_shapes_clear(&merged);
  builder_free(&b);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/fracture/random", test_random);
  g_test_add_func("/fracture/not-merged", test_not_merged);
  g_test_add_func("/fracture/known", test_known);
  return g_test_run();
}
