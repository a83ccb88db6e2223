/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests windows beside boxes and nearest boxes against an exhaustive search of
   unit squares, and the capacity of edges to move outwards. */
#include "near.c"

#include <glib.h>

enum { SIZE = 24, BOXES = 7 };

static uint32_t state = 11;

static int32_t draw_boxes(int32_t low, int32_t high) {
  state = state * 1664525u + 1013904223u;
  return low + (int32_t)((state >> 8) % (uint32_t)(high - low + 1));
}

static eda_box draw_box(void) {
  int32_t x = draw_boxes(0, SIZE - 4), y = draw_boxes(0, SIZE - 4);
  return (eda_box){x, y, x + draw_boxes(1, 4), y + draw_boxes(1, 4)};
}

/* Return the distance of the unit square at (x, y) outwards from a side; 0
   touches the side. */
static int32_t outwards(eda_box b, int side, int32_t x, int32_t y) {
  return side == LEFT    ? b.x0 - 1 - x
         : side == RIGHT ? x - b.x1
         : side == BELOW ? b.y0 - 1 - y
                         : y - b.y1;
}

/* Return whether the unit square is at most `beside` beyond the flanks. */
static int is_along(eda_box b, int side, int32_t beside, int32_t x, int32_t y) {
  return side_upright(side) ? y >= b.y0 - beside && y < b.y1 + beside
                            : x >= b.x0 - beside && x < b.x1 + beside;
}

static int places_have(eda_box b, int32_t x, int32_t y) {
  return x >= b.x0 && x < b.x1 && y >= b.y0 && y < b.y1;
}

static void test_window(void) {
  for (int n = 0; n < 200; n++) {
    eda_box b = draw_box();
    int side = n % SIDES;
    int32_t from = draw_boxes(0, 3), to = from + draw_boxes(1, 6),
            beside = draw_boxes(0, 3);
    eda_box w = box_window(b, side, from, to, beside);
    for (int32_t y = -SIZE; y < 2 * SIZE; y++)
      for (int32_t x = -SIZE; x < 2 * SIZE; x++) {
        int32_t out = outwards(b, side, x, y);
        g_assert_cmpint(
            places_have(w, x, y), ==,
            out >= from && out < to && is_along(b, side, beside, x, y));
      }
  }
}

static void test_nearest(void) {
  int found = 0;
  for (int n = 0; n < 400; n++) {
    places p;
    eda_box *box = eda_alloc(BOXES, sizeof *box), b = draw_box(), which = {0};
    for (int i = 0; i < BOXES; i++) box[i] = draw_box();
    places_init(&p, box, BOXES, draw_boxes(1, 8), 1);
    int side = n % SIDES;
    int32_t to = draw_boxes(2, 12), beside = draw_boxes(0, 3),
            none = draw_boxes(1, to), want = none;
    eda_box w = box_window(b, side, 0, to, beside);
    for (int32_t y = w.y0; y < w.y1; y++)
      for (int32_t x = w.x0; x < w.x1; x++)
        for (int i = 0; i < BOXES; i++)
          if (places_have(box[i], x, y))
            want = MIN(want, outwards(b, side, x, y));
    int32_t got = places_nearest(&p, w, side, none, &which);
    g_assert_cmpint(got, ==, want);
    g_assert_cmpint(places_nearest(&p, w, side, none, NULL), ==, want);
    if (want < none) {
      int is_there = 0;
      for (int32_t y = w.y0; y < w.y1; y++)
        for (int32_t x = w.x0; x < w.x1; x++)
          is_there |=
              places_have(which, x, y) && outwards(b, side, x, y) == want;
      g_assert_true(is_there);
      found++;
    }
    places_clear(&p);
  }
  g_assert_cmpint(found, >, 80);
}

/* An edge may move outwards until the boxes in front of it or beside it are a
   space away. */
static void test_spacing(void) {
  enum { SPACE = 3 };
  int bounded = 0;
  for (int n = 0; n < 400; n++) {
    eda_point points[4 * BOXES];
    uint32_t start[BOXES + 1] = {0};
    eda_box box[BOXES], edge = draw_box();
    int side = n % SIDES;
    for (int i = 0; i < BOXES; i++) {
      eda_box b = box[i] = draw_box();
      const eda_point p[] = {
          {b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
      memcpy(points + 4 * i, p, sizeof p);
      start[i + 1] = (uint32_t)(4 * (i + 1));
    }
    if (side_upright(side))
      edge.x1 = edge.x0;
    else
      edge.y1 = edge.y0;
    eda_shapes shapes = {BOXES, start, points, NULL};
    eda_printed print = {.shapes = &shapes};
    drc r = {.grid = 0.5, .min_space = SPACE * 0.5 - 0.1};
    int32_t most = draw_boxes(0, 6), want = most;
    /* The edges of a box are lines, so another edge is one step beyond each
       edge. */
    for (int i = 0; i < BOXES; i++) {
      eda_box e[] = {{box[i].x0, box[i].y0, box[i].x0, box[i].y1},
                     {box[i].x1, box[i].y0, box[i].x1, box[i].y1},
                     {box[i].x0, box[i].y0, box[i].x1, box[i].y0},
                     {box[i].x0, box[i].y1, box[i].x1, box[i].y1}};
      for (int k = 0; k < 4; k++) {
        eda_box flank = side_upright(side)
                            ? (eda_box){0, edge.y0 - SPACE, 0, edge.y1 + SPACE}
                            : (eda_box){edge.x0 - SPACE, 0, edge.x1 + SPACE, 0};
        int beside = side_upright(side)
                         ? e[k].y0 < flank.y1 && e[k].y1 > flank.y0
                         : e[k].x0 < flank.x1 && e[k].x1 > flank.x0;
        int32_t near = side == LEFT    ? edge.x0 - e[k].x1
                       : side == RIGHT ? e[k].x0 - edge.x1
                       : side == BELOW ? edge.y0 - e[k].y1
                                       : e[k].y0 - edge.y1;
        int32_t far = side == LEFT    ? edge.x0 - e[k].x0
                      : side == RIGHT ? e[k].x1 - edge.x1
                      : side == BELOW ? edge.y0 - e[k].y0
                                      : e[k].y1 - edge.y1;
        if (!beside || far <= 1) continue;
        want = MIN(want, MAX(0, MAX(near, 1) - SPACE));
      }
    }
    g_assert_cmpint(mask_spacing(&r, &print, edge, side, most), ==, want);
    bounded += want > 0 && want < most;
    places_clear(&r.mask);
  }
  g_assert_cmpint(bounded, >, 10);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/near/window", test_window);
  g_test_add_func("/near/nearest", test_nearest);
  g_test_add_func("/near/spacing", test_spacing);
  return g_test_run();
}
