/* SPDX-License-Identifier: BSD-3-Clause */
/* The index of boxes, compared with an exhaustive search, and its order. */
#include <eda/index.h>
#include <glib.h>
#include <string.h>

static int boxes_touch(eda_box a, eda_box b) {
  return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1;
}

static eda_box random_box(GRand *r, int span, int most) {
  int x = g_rand_int_range(r, -span, span + 1);
  int y = g_rand_int_range(r, -span, span + 1);
  return (eda_box){x, y, x + g_rand_int_range(r, 0, most + 1),
                   y + g_rand_int_range(r, 0, most + 1)};
}

/* Check that each box that touches the window is returned exactly once, that no
   other box is returned, and that a second search returns the same order. */
static void index_check(const eda_index *index, const eda_box *box, size_t n,
                        eda_box window) {
  g_autofree uint8_t *found = g_new0(uint8_t, n + 1);
  eda_finder f = eda_index_find(index, window), again = f;
  for (uint32_t i, j; eda_index_next(&f, &i);) {
    g_assert_cmpuint(i, <, n);
    g_assert_false(found[i]);
    found[i] = 1;
    g_assert_true(eda_index_next(&again, &j));
    g_assert_cmpuint(i, ==, j);
  }
  for (size_t i = 0; i < n; i++)
    g_assert_cmpint(found[i], ==, boxes_touch(box[i], window));
}

static void test_random(void) {
  static const int32_t cells[] = {0, 1, 7, 50, 5000};
  static const int spans[] = {3, 100, 100000};
  GRand *r = g_rand_new_with_seed(5);
  for (int k = 0; k < 600; k++) {
    int span = spans[k % 3];
    size_t n = (size_t)g_rand_int_range(r, 0, 120);
    eda_box box[120];
    for (size_t i = 0; i < n; i++)
      box[i] = random_box(r, span, i % 9 ? span / 10 : 3 * span);
    eda_index *index = eda_index_new(box, n, cells[k % 5]);
    for (int q = 0; q < 30; q++)
      index_check(index, box, n, random_box(r, 2 * span, q % 3 ? span / 5 : 0));
    eda_index_free(index);
  }
  g_rand_free(r);
}

/* The order is by cell, row by row, and within a cell by number. */
static void test_order(void) {
  static const eda_box box[] = {{90, 90, 90, 90}, {10, 10, 12, 12},
                                {50, 0, 50, 100}, {5, 5, 5, 5},
                                {0, 60, 99, 60},  {0, 0, 100, 0}};
  static const uint32_t want[] = {1, 3, 5, 2, 4, 0};
  eda_index *index = eda_index_new(box, G_N_ELEMENTS(box), 40);
  eda_finder f = eda_index_find(index, (eda_box){0, 0, 100, 100});
  uint32_t i;
  for (size_t k = 0; k < G_N_ELEMENTS(want); k++) {
    g_assert_true(eda_index_next(&f, &i));
    g_assert_cmpuint(i, ==, want[k]);
  }
  g_assert_false(eda_index_next(&f, &i));
  eda_index_free(index);
}

/* Coordinates at the ends of their range, empty boxes, and no box. */
static void test_extremes(void) {
  static const eda_box box[] = {{INT32_MIN, INT32_MIN, INT32_MIN, INT32_MIN},
                                {3, 0, 2, 0},
                                {INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX},
                                {INT32_MIN, 0, INT32_MAX, 0}};
  for (int32_t cell = 0; cell < 3; cell++) {
    eda_index *index = eda_index_new(box, G_N_ELEMENTS(box), cell);
    eda_finder f = eda_index_find(
        index, (eda_box){INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX});
    unsigned seen = 0;
    for (uint32_t i; eda_index_next(&f, &i);) seen |= 1u << i;
    g_assert_cmpuint(seen, ==, 13);
    eda_index_free(index);
    uint32_t i;
    index = eda_index_new(NULL, 0, cell);
    f = eda_index_find(index, (eda_box){-5, -5, 5, 5});
    g_assert_false(eda_index_next(&f, &i));
    eda_index_free(index);
  }
  eda_index_free(NULL);
}

/* Many large boxes need no more memory than many small ones. */
static void test_large(void) {
  enum { N = 20000 };
  g_autofree eda_box *box = g_new(eda_box, N);
  for (int i = 0; i < N; i++) box[i] = (eda_box){i, i, N + i, N + i};
  eda_index *index = eda_index_new(box, N, 1);
  eda_finder f = eda_index_find(index, (eda_box){N / 2, 0, N / 2, N});
  size_t n = 0;
  for (uint32_t i; eda_index_next(&f, &i);) n++;
  g_assert_cmpuint(n, ==, N / 2 + 1);
  eda_index_free(index);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/index/random", test_random);
  g_test_add_func("/index/order", test_order);
  g_test_add_func("/index/extremes", test_extremes);
  g_test_add_func("/index/large", test_large);
  return g_test_run();
}
