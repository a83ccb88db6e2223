/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests pairs of fragments against an exhaustive search, and the shifts that
   separate them. */
#include "cut.c"

#include "tools/devel/testing.h"

#include "pairs.c"

enum { BOXES = 14, SHIFT = 15, WIDTH = 46, SPACE = 52 };

static uint32_t state = 21;

static int32_t by_lot(int32_t low, int32_t high) {
  state = state * 1664525u + 1013904223u;
  return low + (int32_t)((state >> 8) % (uint32_t)(high - low + 1));
}

static const epe_rules rules = {.fragment = 40,
                                .min_edge = 20,
                                .concave_corner = 30,
                                .corner_edge = 30,
                                .line_end = 90,
                                .ripple = 30,
                                .tangency = 20,
                                .min_width = WIDTH,
                                .min_space = SPACE,
                                .max_shift = SHIFT,
                                .blur = 40};

/* Cut merged boxes into fragments. */
static void make_fragments(epe_layer *l, const eda_box *boxes, int n,
                           eda_shapes *drawn) {
  eda_point points[4 * BOXES];
  uint32_t start[BOXES + 1] = {0};
  opc_error error;
  for (int i = 0; i < n; i++) {
    eda_box b = boxes[i];
    const eda_point p[] = {
        {b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
    memcpy(points + 4 * i, p, sizeof p);
    start[i + 1] = (uint32_t)(4 * i + 4);
  }
  eda_shapes all = {(size_t)n, start, points, NULL};
  g_assert_cmpint(eda_boolean(EDA_OR, &all, NULL, drawn, &error), ==, OPC_OK);
  eda_edges none = {0};
  eda_gates gates = {.grid = 1, .drawn = drawn, .edges = &none};
  *l = (epe_layer){.context = opc_test_host()->context, .rules = &rules};
  epe_cut(l, &gates, 0);
  epe_find_pairs(l);
}

/* Return the distance between the walls of two fragments that face each
   other. */
static double wall_distance(const epe_layer *l, const int32_t *shift,
                            uint32_t i, uint32_t j) {
  const epe_fragment *p = l->fragments;
  double i0 = epe_begin(p, shift, i), i1 = epe_end(p, shift, i);
  double j0 = epe_begin(p, shift, j), j1 = epe_end(p, shift, j);
  double past = fmax(fmin(i0, i1) - fmax(j0, j1), fmin(j0, j1) - fmax(i0, i1));
  return hypot(epe_line(p, shift, j) - epe_line(p, shift, i), fmax(past, 0));
}

static int has_pair(const epe_layer *l, uint32_t a, uint32_t b, int inside) {
  for (size_t k = 0; k < l->pair_count; k++)
    if (l->pairs[k].a == a && l->pairs[k].b == b && !l->pairs[k].corner)
      return l->pairs[k].inside == inside;
  return 0;
}

/* All pairs are found whose distance may become smaller than the rule and than
   the drawn distance. */
static void test_all(void) {
  int near[2] = {0};
  for (int n = 0; n < 12; n++) {
    eda_box boxes[BOXES];
    for (int i = 0; i < BOXES; i++) {
      int32_t x = by_lot(0, 700), y = by_lot(0, 700), wide = i & 1;
      boxes[i] = (eda_box){x, y, x + (wide ? by_lot(120, 400) : 55),
                           y + (wide ? 55 : by_lot(120, 400))};
    }
    eda_shapes drawn;
    epe_layer l;
    make_fragments(&l, boxes, BOXES, &drawn);
    g_autofree int32_t *shift = g_new0(int32_t, l.count);
    for (int round = 0; round < 4; round++) {
      for (size_t i = 0; i < l.count; i++)
        shift[i] = round == 0   ? SHIFT
                   : round == 1 ? -SHIFT
                                : by_lot(-SHIFT, SHIFT);
      for (uint32_t i = 0; i < l.count; i++)
        for (uint32_t j = 0; j < l.count; j++) {
          const epe_fragment *p = &l.fragments[i], *q = &l.fragments[j];
          int32_t off =
              epe_line(l.fragments, NULL, j) - epe_line(l.fragments, NULL, i);
          if (p->axis != q->axis || p->sign < 0 || q->sign > 0 || !off)
            continue;
          int inside = off < 0;
          double limit = inside ? WIDTH : SPACE;
          double was = wall_distance(&l, NULL, i, j),
                 is = wall_distance(&l, shift, i, j);
          if (is >= fmin(limit, was) - 0.01) continue;
          /* The area between diagonal polygons is outside of the mask. */
          if (inside && p->polygon != q->polygon) continue;
          if (!has_pair(&l, inside ? j : i, inside ? i : j, inside))
            g_error("%u and %u: %g, drawn %g", i, j, is, was);
          near[inside]++;
        }
    }
    for (size_t k = 0; k < l.pair_count; k++) {
      const epe_pair *pair = &l.pairs[k];
      double limit = pair->inside ? WIDTH : SPACE;
      g_assert_cmpfloat(pair->limit, <=, limit);
      if (pair->corner) continue;
      double was = wall_distance(&l, NULL, pair->a, pair->b);
      g_assert_cmpfloat(fabs(pair->limit - fmin(limit, was)), <, 1e-3);
    }
    epe_clear(&l);
    eda_shapes_clear(&drawn);
  }
  g_assert_cmpint(near[0], >, 200);
  g_assert_cmpint(near[1], >, 200);
}

/* Return the fragment in the middle of the edge of a box with this normal. */
static uint32_t middle_of(const epe_layer *l, uint32_t polygon, int axis,
                          int sign) {
  for (uint32_t i = l->start[polygon]; i < l->start[polygon + 1]; i++) {
    const epe_fragment *p = &l->fragments[i];
    int32_t a = epe_along(p, p->from), b = epe_along(p, p->to);
    if (p->axis == axis && p->sign == sign && MIN(a, b) <= 200 &&
        MAX(a, b) >= 200)
      return i;
  }
  g_assert_not_reached();
}

/* The shift of each fragment is reduced by its share of the missing distance,
   rounded up. One case has two lines 60 apart with min_space 52, the other a
   line 50 wide with min_width 46. */
static void test_direction(void) {
  static const struct {
    int32_t by[2], left[2];
  } cases[] = {{{12, 6}, {5, 2}},    {{6, 12}, {2, 5}}, {{15, -3}, {11, -3}},
               {{-3, 15}, {-3, 11}}, {{4, 4}, {4, 4}},  {{10, 10}, {4, 4}}};
  const eda_box lines[] = {{0, 0, 50, 400}, {110, 0, 160, 400}};
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++)
    for (int axis = 0; axis < 2; axis++) {
      eda_box boxes[2];
      for (int i = 0; i < 2; i++)
        boxes[i] = axis == EDA_X ? lines[i]
                                 : (eda_box){lines[i].y0, lines[i].x0,
                                             lines[i].y1, lines[i].x1};
      eda_shapes drawn;
      epe_layer l;
      make_fragments(&l, boxes, 2, &drawn);
      uint32_t a = middle_of(&l, 0, axis, 1), b = middle_of(&l, 1, axis, -1);
      if (drawn.points[0].x + drawn.points[0].y > 20) /* so that the other
                                                         polygon comes first */
        a = middle_of(&l, 1, axis, 1), b = middle_of(&l, 0, axis, -1);
      g_autofree int32_t *shift = g_new0(int32_t, l.count);
      for (size_t i = 0; i < l.count; i++) l.low[i] = -SHIFT, l.high[i] = SHIFT;
      for (size_t i = 0; i < l.count; i++)
        if (l.fragments[i].edge == l.fragments[a].edge)
          shift[i] = cases[k].by[0];
        else if (l.fragments[i].edge == l.fragments[b].edge)
          shift[i] = cases[k].by[1];
      int missing = SPACE - (60 - shift[a] - shift[b]) > 0;
      g_assert_cmpint(epe_separate(&l, shift, 0) > 0, ==, missing);
      const uint32_t who[2] = {a, b};
      for (int i = 0; i < 2 && missing; i++) {
        int32_t by = cases[k].by[i];
        g_assert_cmpint(l.high[who[i]], ==, by > 0 ? cases[k].left[i] : SHIFT);
        g_assert_cmpint(l.low[who[i]], ==, -SHIFT);
      }
      epe_clear(&l);
      eda_shapes_clear(&drawn);
    }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/pairs/all", test_all);
  g_test_add_func("/pairs/direction", test_direction);
  return g_test_run();
}
