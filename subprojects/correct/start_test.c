/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests which transistors a continued correction opens because of shapes that
   the regulator adds. */
#include <correct/start.h>

#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>

#include <correct/loop.h>

/* Lists of the loop: added shapes of two layers, then cut-outs. */
enum { GATES = 4, LAYERS = 2, LISTS = 2 * LAYERS };

static eda_boxes boxes_copy(const eda_box *from, size_t n) {
  eda_box *box = eda_alloc(n, sizeof *box);
  for (size_t i = 0; i < n; i++) box[i] = from[i];
  return (eda_boxes){box, n};
}

/* Gates 0 and 1 have added shapes in the first layer, gate 2 has a cut-out in
   the second layer. The shape of gate 3, which never opens, is touched. */
static void test_touched(void) {
  const eda_box added[] = {
      {0, 0, 10, 10}, {100, 0, 110, 10}, {20, 0, 30, 10}, {200, 0, 210, 10}};
  const eda_box cutouts[] = {{0, 50, 10, 60}};
  const eda_box by_added[] = {{10, 5, 15, 8}, {205, 5, 220, 8}},
                by_cut[] = {{5, 55, 6, 56}}, far[] = {{60, 60, 70, 70}};
  uint32_t owner_added[] = {0, 1, 0, 3}, owner_cut[] = {2};
  uint32_t *owner[LISTS] = {owner_added, NULL, NULL, owner_cut};
  const double limit[GATES] = {2, 2, 2, INFINITY};
  eda_boxes begun[LISTS] = {
      boxes_copy(added, 4), {0}, {0}, boxes_copy(cutouts, 1)};
  uint8_t still[GATES] = {1, 1, 1, 1};
  const eda_gates gates = {.count = GATES, .layers = LAYERS};
  loop l = {.gates = &gates,
            .begun = begun,
            .still = still,
            .start = {.limit = limit, .owner = owner}};
  eda_boxes add[LAYERS] = {{far, 1}, {0}}, cut[LAYERS] = {{0}};
  const eda_ruling ruling = {.added = add, .cutouts = cut};

  correct_start_open_touched(&l, 0, &ruling);
  g_assert_cmpuint(begun[0].count, ==, 4);
  g_assert_true(still[0] && still[1] && still[2] && still[3]);

  add[0] = (eda_boxes){by_added, 2};
  cut[1] = (eda_boxes){by_cut, 1};
  for (size_t k = 0; k < LAYERS; k++)
    correct_start_open_touched(&l, k, &ruling);
  g_assert_true(!still[0] && still[1] && !still[2] && still[3]);
  g_assert_cmpuint(begun[0].count, ==, 2);
  g_assert_cmpint(begun[0].box[0].x0, ==, 100);
  g_assert_cmpint(begun[0].box[1].x0, ==, 200);
  g_assert_cmpuint(begun[3].count, ==, 0);
  free((eda_box *)begun[0].box);
  free((eda_box *)begun[3].box);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/start/touched", test_touched);
  return g_test_run();
}
