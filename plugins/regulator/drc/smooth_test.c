/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests smoothing of jogs that are too near to each other; the reference is the
   mask that the ruling produces. */
#include "chip_test.h"

static double wide_line(const chip *c, double x, double y) {
  (void)c, (void)y;
  return fmin(x + 5, 70 - x);
}

/* Return the mask of the ruling, from `base` by boolean operations. */
static eda_shapes ruled_mask(const eda_shapes *base, const eda_ruling *r) {
  opc_error error;
  eda_shapes now, next;
  g_assert_cmpint(eda_boolean(EDA_OR, base, NULL, &now, &error), ==, OPC_OK);
  for (int k = 0; k < 2; k++) {
    const eda_boxes *b = k ? &r->cutouts[EDA_POLY] : &r->added[EDA_POLY];
    for (size_t i = 0; i < b->count; i++) {
      eda_point q[4];
      uint32_t start[] = {0, 4};
      eda_shapes one = {1, start, q, NULL};
      box_points(q, b->box[i].x0, b->box[i].y0, b->box[i].x1, b->box[i].y1);
      g_assert_cmpint(
          eda_boolean(k ? EDA_NOT : EDA_OR, &now, &one, &next, &error), ==,
          OPC_OK);
      eda_shapes_clear(&now);
      now = next;
    }
  }
  return now;
}

/* Lines with random jogs of 1 to 3 nm: after a few repairs without a simulation
   the mask satisfies the rules, differs little from the requested mask, and
   stays constant. */
static void test_jogs(void) {
  for (uint32_t seed = 1; seed <= 30; seed++) {
    g_autoptr(opc_module) m = drc_make("{}");
    g_autoptr(GRand) rand = g_rand_new_with_seed(seed);
    enum { JOGS = 12 };
    eda_point q[2 * JOGS + 2];
    uint32_t start[] = {0, 2 * JOGS + 2};
    chip c = {0};
    eda_violation v[10];
    int32_t y = 0, x = 65;
    size_t n = 0, settled = 0;
    q[n++] = (eda_point){0, 0};
    for (int i = 0; i < JOGS; i++) {
      q[n++] = (eda_point){x, y};
      y += g_rand_int_range(rand, 20, 90);
      q[n++] = (eda_point){x, y};
      x += g_rand_int_range(rand, 1, 4) * (g_rand_boolean(rand) ? 1 : -1);
    }
    q[n++] = (eda_point){0, y};
    eda_shapes base = {1, start, q, NULL};
    add_poly(&c, 0, 0, 65, y);
    chip_begin(&c);
    chip_print(&c, wide_line);
    eda_shapes mask = ruled_mask(&base, &c.ruling);
    for (int i = 0; i < 12 && settled < 2; i++) {
      c.mask[EDA_POLY] = mask;
      if (i)
        chip_smooth(m, &c);
      else
        chip_judge(m, &c);
      eda_shapes next = ruled_mask(&base, &c.ruling), differ;
      opc_error error;
      g_assert_cmpint(eda_boolean(EDA_XOR, &mask, &next, &differ, &error), ==,
                      OPC_OK);
      settled = differ.count ? 0 : settled + 1;
      eda_shapes_clear(&differ);
      eda_shapes_clear(&mask);
      mask = next;
    }
    g_assert_cmpuint(settled, ==, 2);
    c.mask[EDA_POLY] = mask;
    size_t all = drc_violations(m, &c, v, 10);
    for (size_t i = 0; i < MIN(all, 10); i++) {
      g_test_message("seed %u: %s at %g, %g: %g", seed, v[i].rule, v[i].x,
                     v[i].y, v[i].value);
      g_assert_false(g_str_has_prefix(v[i].rule, "mask"));
    }
    gint64 more = eda_area2(&mask) - eda_area2(&base);
    g_assert_cmpint(ABS(more), <, 2 * 3 * 40 * JOGS);
    /* If the jogs are removed, their repairs vanish. */
    eda_shapes plain = c.shapes[EDA_POLY];
    for (int i = 0; i < 4; i++) {
      eda_shapes_clear(&mask);
      mask = ruled_mask(&plain, &c.ruling);
      c.mask[EDA_POLY] = mask;
      chip_judge(m, &c);
    }
    g_assert_cmpint(eda_area2(&mask), ==, eda_area2(&plain));
    eda_shapes_clear(&mask);
    chip_end(&c);
  }
}

static double notched_bar(const chip *c, double x, double y) {
  (void)c;
  return 5 + fmin(fmin(x, 400 - x), fmin(y, 200 - y));
}

/* Make a rectangle with a notch (or a bump) of 30 nm, `depth` deep, in its
   upper edge. */
static void make_notched(eda_point q[8], int bump, int32_t depth) {
  int32_t bottom = 200 + (bump ? depth : -depth);
  const eda_point all[] = {{0, 0},        {400, 0},      {400, 200}, {230, 200},
                           {230, bottom}, {200, bottom}, {200, 200}, {0, 200}};
  memcpy(q, all, sizeof all);
}

/* A repair remains while a synthesizer moves the edge in the notch by typical
   steps. No slit opens behind the repair, and no sliver remains. A notch deeper
   than its required width is not repaired. */
static void test_moving_jogs(void) {
  for (int bump = 0; bump < 2; bump++)
    for (int32_t depth = 5; depth <= 46; depth++) {
      g_autoptr(opc_module) m = drc_make("{ min_space: 40 nm }");
      uint32_t start[] = {0, 8};
      eda_point q[8];
      eda_shapes base = {1, start, q, NULL};
      chip c = {0};
      eda_violation v[10];
      add_poly(&c, 0, 0, 400, 200);
      chip_begin(&c);
      chip_print(&c, notched_bar);
      make_notched(q, bump, depth);
      c.mask[EDA_POLY] = base;
      chip_judge(m, &c);
      for (int i = 1; i < 3; i++) {
        make_notched(q, bump, depth + 9 * i);
        eda_shapes mask = ruled_mask(&base, &c.ruling);
        c.mask[EDA_POLY] = mask;
        size_t n = drc_violations(m, &c, v, 10), wrong = 0;
        for (size_t k = 0; k < MIN(n, 10); k++)
          wrong += g_str_has_prefix(v[k].rule, "mask");
        g_assert_cmpint(!wrong, ==, depth <= 40);
        if (!wrong) g_assert_cmpint(eda_area2(&mask), ==, 2 * 400 * 200);
        chip_judge(m, &c);
        eda_shapes_clear(&mask);
      }
      chip_end(&c);
    }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/regulator/jogs", test_jogs);
  g_test_add_func("/regulator/moving-jogs", test_moving_jogs);
  return g_test_run();
}
