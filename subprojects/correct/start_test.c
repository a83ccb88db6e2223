/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests which transistors a continued correction opens because of shapes that
   the regulator adds, which transistors keep their masks, and the displacements
   that the regulator receives. */
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

/* correct_start_open opens for correction either the transistors that violate a
   rule, or the transistors that do not print or whose |Ion deviation| exceeds
   the limit. */
static void test_open(void) {
  double ion[] = {1.01, 1.03, 0.97, 1.09, 1, 0.99, 1.03};
  double drawn[] = {1, 1, 1, 1, 1, 1, 1};
  enum { N = G_N_ELEMENTS(ion), RULES = 3 };
  static const uint8_t open[2][N] = {{0, 1, 1, 0, 1, 0, 1},
                                     {0, 1, 0, 0, 0, 1, 0}};
  const double limit[N] = {2, 2, 2, INFINITY, 2, 2, 2};
  uint32_t flags[N] = {[4] = EDA_PRINT_OPEN};
  eda_violation violation[RULES] = {{.gate = -1}, {.gate = 5}, {.gate = 1}};
  for (int violations = 0; violations < 2; violations++) {
    eda_boxes begun[LISTS] = {{0}};
    uint32_t *owner[LISTS] = {NULL};
    uint8_t still[N] = {1, 1, 1, 1, 1, 1, 1};
    const eda_gates gates = {.count = N, .layers = LAYERS};
    loop l = {.gates = &gates,
              .begun = begun,
              .still = still,
              .start = {.limit = limit, .owner = owner},
              .design = {.ion = drawn}};
    l.measured.performance.ion = ion;
    l.measured.flags = flags;
    l.guard.drawn = violation;
    l.guard.rules = RULES;
    correct_start_open(&l, violations);
    for (int i = 0; i < N; i++)
      g_assert_cmpuint(still[i], ==, !open[violations][i]);
  }
}

/* Transistor 0 is corrected and within its limit, 1 exceeds it again, the line
   end of 2 is displaced, as is that of 3, which always keeps its mask. */
static void test_keep(void) {
  double ion[GATES] = {1.01, 1.03, 1, 1.5}, drawn[GATES] = {1, 1, 1, 1};
  const double limit[GATES] = {2, 2, 2, INFINITY};
  uint32_t flags[GATES] = {0}, vetoes[GATES] = {0};
  const eda_box shapes[] = {{0, 0, 10, 10}, {20, 0, 30, 10}};
  uint32_t owner_added[] = {1, 2};
  uint32_t *owner[LISTS] = {owner_added};
  eda_boxes begun[LISTS] = {boxes_copy(shapes, 2)};
  uint8_t still[GATES] = {0, STILL_WITHIN, STILL_BEGUN, STILL_BEGUN};
  const eda_gates gates = {.count = GATES, .layers = LAYERS};
  eda_moved *from = eda_moved_new(LAYERS, GATES);
  loop l = {.gates = &gates,
            .begun = begun,
            .still = still,
            .vetoes = vetoes,
            .start = {.limit = limit, .owner = owner, .from = from},
            .design = {.ion = drawn}};
  l.measured.performance.ion = ion;
  l.measured.flags = flags;
  correct_trial_init(&l.now, LAYERS, GATES);
  correct_trial_init(&l.next, LAYERS, GATES);

  correct_start_open(&l, 0);
  g_assert_cmpuint(still[0], ==, STILL_WITHIN);
  g_assert_cmpuint(still[1], ==, 0);
  g_assert_cmpuint(begun[0].count, ==, 2); /* 1 had left the start before */
  for (size_t i = 0; i < GATES; i++) {
    from->l[i] = 1;
    l.now.biases.l[i] = l.now.biases.part[EDA_PARTS * i].by = 5;
    l.next.biases.l[i] = 7;
  }
  l.next.biases.end[0] = l.next.biases.end[4] = l.next.biases.end[6] = 3;
  g_assert_false(correct_start_is_done(&l));
  correct_start_keep(&l);
  static const int32_t by[GATES] = {5, 7, 7, 1};
  for (size_t i = 0; i < GATES; i++)
    g_assert_cmpint(l.next.biases.l[i], ==, by[i]);
  g_assert_cmpint(l.next.biases.part[0].by, ==, 5);
  g_assert_cmpint(l.next.biases.end[0], ==, 3);
  g_assert_cmpint(l.next.biases.end[6], ==, 0);
  g_assert_true(!still[2] && still[3] == STILL_BEGUN);
  g_assert_cmpuint(begun[0].count, ==, 1);

  ion[1] = 1.015;
  vetoes[0] = EDA_VETO_LONGER;
  correct_start_open(&l, 0);
  g_assert_true(correct_start_is_done(&l));
  l.next.biases.l[0] = 4;
  correct_start_keep(&l);
  g_assert_cmpint(l.next.biases.l[0], ==, 4);
  l.start.limit = NULL;
  g_assert_false(correct_start_is_done(&l));
  correct_trial_clear(&l.now);
  correct_trial_clear(&l.next);
  eda_moved_free(from);
  free((eda_box *)begun[0].box);
}

/* Displacements of a gate in the start and in the loop, and the outward
   displacements of both active edges, counted by hand. */
typedef struct moves {
  int32_t base_w, base_aside, base_l;
  uint8_t flip;
  int32_t w, aside, l;
  int32_t low, high, both_l;
} moves;

/* Return the extent along y of an active with one gate, displaced by a loop. */
static eda_box displaced(const loop *l) {
  eda_fragment edge[] = {{{0, 0}, 0, EDA_W_LOW},
                         {{300, 0}, -1, EDA_FIXED},
                         {{300, 200}, 0, EDA_W_HIGH},
                         {{0, 200}, -1, EDA_FIXED}};
  uint32_t start[] = {0, 4};
  eda_edges edges[LAYERS] = {{0}, {1, start, edge}};
  eda_box box = {100, 0, 160, 200};
  uint8_t axis = EDA_X;
  const eda_gates gates = {
      .count = 1, .layers = LAYERS, .edges = edges, .box = &box, .axis = &axis};
  pieces p;
  eda_shapes out;
  correct_pieces_of_edges(&edges[EDA_ACTIVE], 1, &p);
  correct_pieces_alloc(&p, &out);
  correct_pieces_follow(&gates, EDA_ACTIVE, &l->now.biases, &p);
  correct_pieces_build(&p, &out);
  eda_box b = eda_bounds(out.points, out.start[1]);
  eda_shapes_clear(&out);
  correct_pieces_clear(&p);
  return b;
}

static void expect_printed(const moves *m, int started) {
  const eda_gates gates = {.count = 1, .layers = LAYERS};
  eda_mask mask = {.moved = eda_moved_new(LAYERS, 1)};
  eda_moved *base = mask.moved;
  loop l = {.gates = &gates, .start = {.mask = started ? &mask : NULL}};
  base->w[0] = m->base_w;
  base->aside[0] = m->base_aside;
  base->l[0] = m->base_l;
  base->flip[0] = m->flip;
  correct_trial_init(&l.now, LAYERS, 1);
  correct_trial_init(&l.next, LAYERS, 1);
  correct_start_begin(&l);
  l.now.biases.w[0] = m->w;
  l.now.biases.aside[0] = m->aside;
  l.now.biases.l[0] = m->l;
  eda_box b = displaced(&l);
  g_assert_cmpint(b.y0, ==, -m->low);
  g_assert_cmpint(b.y1, ==, 200 + m->high);
  eda_printed p = correct_loop_printed(&l);
  g_assert_cmpint((p.w[0] >> 1) - p.aside[0], ==, m->low);
  g_assert_cmpint(p.w[0] - (p.w[0] >> 1) + p.aside[0], ==, m->high);
  g_assert_cmpint(p.l[0], ==, m->both_l);
  g_assert_cmpint(l.now.biases.w[0], ==, m->w);
  correct_trial_clear(&l.now);
  correct_trial_clear(&l.next);
  free(l.whole.w);
  free(l.begun);
  eda_moved_free(base);
}

/* The regulator receives the displacements of the simulated mask from the drawn
   edges, including those of the start. The HIGH edge has the odd step, or the
   LOW edge for a mirrored mask. */
static void test_printed(void) {
  static const moves cases[] = {
      {.base_w = 5, .low = 2, .high = 3},
      {.base_w = 5, .flip = EDA_FLIP_W, .low = 3, .high = 2},
      {.base_w = 4, .base_aside = 3, .low = -1, .high = 5},
      {.base_w = 5, .flip = EDA_FLIP_W, .w = -3, .low = 1, .high = 1},
      {.base_w = -3, .flip = EDA_FLIP_W, .aside = 1, .low = -2, .high = -1},
      {.base_l = 3, .l = -1, .w = 7, .low = 3, .high = 4, .both_l = 2}};
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) expect_printed(&cases[k], 1);
  moves none = {.base_w = 5, .w = 7, .aside = 1, .l = 3};
  none.low = 2, none.high = 5, none.both_l = 3;
  expect_printed(&none, 0);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/start/touched", test_touched);
  g_test_add_func("/start/open", test_open);
  g_test_add_func("/start/keep", test_keep);
  g_test_add_func("/start/printed", test_printed);
  return g_test_run();
}
