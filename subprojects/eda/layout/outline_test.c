/* SPDX-License-Identifier: BSD-3-Clause */
/* Outlines of paths, compared with the area that they cover. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "layout/layout.h"

enum { SIDE = 60 };

/* Return the winding number of a rectilinear polygon around (x + 1/2,
   y + 1/2). */
static int winding(const eda_point *p, size_t n, int x, int y) {
  int w = 0;
  for (size_t i = 0; i < n; i++) {
    eda_point a = p[i], b = p[(i + 1) % n];
    if (a.x > x || a.x != b.x) continue;
    if (a.y <= y && b.y > y) w--;
    if (b.y <= y && a.y > y) w++;
  }
  return w;
}

static double area(const eda_point *p, size_t n) {
  double twice = 0;
  for (size_t i = 0; i < n; i++) {
    eda_point a = p[i], b = p[(i + 1) % n];
    twice += (double)a.x * b.y - (double)b.x * a.y;
  }
  return twice / 2;
}

static eda_point *outline(const eda_point *points, size_t n, int32_t width,
                          int ends, int32_t begin, int32_t end, size_t *out) {
  opc_error e;
  eda_point *p;
  g_assert_cmpint(
      eda_path_outline(points, n, width, ends, begin, end, &p, out, &e), ==, 0);
  return p;
}

static void pixels_cover(uint8_t *covered, int x0, int y0, int x1, int y1) {
  for (int y = MIN(y0, y1); y < MAX(y0, y1); y++)
    for (int x = MIN(x0, x1); x < MAX(x0, x1); x++) covered[y * SIDE + x] = 1;
}

/* Mark the area covered by the segment from a to b of a rectilinear path.
   c: point after b, NULL at the end of the path. Before a turn, also mark the
   outer square of the corner at b; before a reversal, extend the segment by
   `half`. `first` and `last`: extensions beyond a and b, pixels; `last` applies
   only at the end of the path. */
static void cover_segment(uint8_t *covered, eda_point a, eda_point b,
                          const eda_point *c, int half, int first, int last) {
  int dx = (b.x > a.x) - (b.x < a.x), dy = (b.y > a.y) - (b.y < a.y);
  if (c) {
    int ex = (c->x > b.x) - (c->x < b.x), ey = (c->y > b.y) - (c->y < b.y);
    last = 0;
    if (dx == -ex && dy == -ey)
      last = half;
    else
      pixels_cover(covered, b.x, b.y, b.x + half * (dx - ex),
                   b.y + half * (dy - ey));
  }
  pixels_cover(covered, a.x - first * dx - half * dy,
               a.y - first * dy - half * dx, b.x + last * dx + half * dy,
               b.y + last * dy + half * dx);
}

/* Random rectilinear paths that turn, reverse and cross, compared with the
   union of squares and rectangles. */
static void test_rectilinear(void) {
  GRand *rand = g_rand_new_with_seed(1);
  for (int round = 0; round < 3000; round++) {
    eda_point p[8];
    int n = g_rand_int_range(rand, 2, 9), half = g_rand_int_range(rand, 1, 5);
    int axis = g_rand_int_range(rand, 0, 2);
    p[0] = (eda_point){g_rand_int_range(rand, 10, 50),
                       g_rand_int_range(rand, 10, 50)};
    for (int i = 1; i < n; i++, axis = !axis) {
      p[i] = p[i - 1];
      int32_t *moved = axis ? &p[i].y : &p[i].x, old = *moved;
      while (*moved == old) *moved = g_rand_int_range(rand, 10, 50);
      if (g_rand_int_range(rand, 0, 8) == 0) axis = !axis;
    }
    /* A continuation along the same line is no corner. */
    for (int i = 1; i + 1 < n;) {
      int64_t dx = p[i].x - p[i - 1].x, dy = p[i].y - p[i - 1].y;
      int64_t ex = p[i + 1].x - p[i].x, ey = p[i + 1].y - p[i].y;
      if (dx * ey == dy * ex && dx * ex + dy * ey > 0) {
        memmove(&p[i], &p[i + 1], (size_t)(n - i - 1) * sizeof p[0]);
        n--;
      } else {
        i++;
      }
    }
    int ends = g_rand_int_range(rand, 0, 2) * 2;
    uint8_t covered[SIDE * SIDE] = {0};
    for (int i = 0; i + 1 < n; i++)
      cover_segment(covered, p[i], p[i + 1], i + 2 < n ? &p[i + 2] : NULL, half,
                    i || !ends ? 0 : half, ends ? half : 0);
    size_t m;
    eda_point *q = outline(p, (size_t)n, 2 * half, ends, 0, 0, &m);
    for (int y = 0; y < SIDE; y++)
      for (int x = 0; x < SIDE; x++) {
        int w = winding(q, m, x, y);
        if (covered[y * SIDE + x])
          g_assert_cmpint(w, >=, 1);
        else
          g_assert_cmpint(w, ==, 0);
      }
    free(q);
  }
  g_rand_free(rand);
}

/* The outline of a path without sharp corners, overlaps and extensions has an
   area of width times length. */
static void test_any_angle(void) {
  const eda_point p[] = {{0, 0},
                         {1000000, 0},
                         {1700000, 700000},
                         {1900000, 2000000},
                         {800000, 2400000}};
  double length = 0;
  for (int i = 0; i < 4; i++)
    length += hypot(p[i + 1].x - p[i].x, p[i + 1].y - p[i].y);
  size_t n;
  eda_point *q = outline(p, 5, 100000, 0, 0, 0, &n);
  g_assert_cmpuint(n, ==, 10);
  g_assert_cmpfloat_with_epsilon(area(q, n) / (100000 * length), 1, 1e-4);
  free(q);
  /* round ends: half a polygon of 32 sides at each end */
  q = outline(p, 5, 100000, 1, 0, 0, &n);
  double round = 16 * sin(G_PI / 16) * 50000 * 50000;
  g_assert_cmpfloat_with_epsilon(area(q, n), 100000 * length + round, 1e7);
  free(q);
}

/* A turn by 135 degrees: the mitre is truncated half a width beyond the corner.
   Computed by hand for half a width of 1: outer points (10 + 1, -1) and, along
   the other segment, (10, 0) + sqrt(2) (1, 0). */
static void test_sharp(void) {
  const eda_point p[] = {{0, 0}, {10000, 0}, {0, 10000}};
  size_t n;
  eda_point *q = outline(p, 3, 2000, 0, 0, 0, &n);
  const eda_point wanted[] = {{0, -1000},   {11000, -1000}, {11414, 0},
                              {707, 10707}, {-707, 9293},   {7586, 1000},
                              {0, 1000}};
  g_assert_cmpmem(q, n * sizeof *q, wanted, sizeof wanted);
  free(q);
}

static void test_ends(void) {
  const eda_point p[] = {{0, 0}, {50, 0}, {50, 0}, {100, 0}};
  const struct {
    int ends, begin, end;
    eda_point wanted[4];
  } cases[] = {
      {0, 0, 0, {{0, -10}, {100, -10}, {100, 10}, {0, 10}}},
      {2, 0, 0, {{-10, -10}, {110, -10}, {110, 10}, {-10, 10}}},
      {4, 3, -7, {{-3, -10}, {93, -10}, {93, 10}, {-3, 10}}},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    size_t n;
    eda_point *q =
        outline(p, 4, 20, cases[i].ends, cases[i].begin, cases[i].end, &n);
    g_assert_cmpmem(q, n * sizeof *q, cases[i].wanted, sizeof cases[i].wanted);
    free(q);
  }
}

/* An odd width is kept. */
static void test_odd_width(void) {
  const eda_point p[] = {{0, 0}, {100, 0}, {100, 100}};
  size_t n;
  eda_point *q = outline(p, 3, 5, 0, 0, 0, &n);
  const eda_point wanted[] = {{0, -2},   {103, -2}, {103, 100},
                              {98, 100}, {98, 3},   {0, 3}};
  g_assert_cmpmem(q, n * sizeof *q, wanted, sizeof wanted);
  free(q);
}

static void test_degenerate(void) {
  const eda_point p[] = {{7, 7}, {7, 7}};
  size_t n;
  /* A path without length has no outline. */
  g_assert_null(outline(p, 2, 10, 0, 0, 0, &n));
  g_assert_cmpuint(n, ==, 0);
  eda_point *q = outline(p, 2, 10, 2, 0, 0, &n);
  const eda_point dot[] = {{2, 2}, {12, 2}, {12, 12}, {2, 12}};
  g_assert_cmpmem(q, n * sizeof *q, dot, sizeof dot);
  free(q);
  q = outline(p, 1, 1000, 1, 0, 0, &n);
  g_assert_cmpuint(n, ==, 32);
  free(q);
  const eda_point line[] = {{0, 0}, {10, 0}};
  /* A path without width has no outline. */
  g_assert_null(outline(line, 2, 0, 0, 0, 0, &n));
  /* Extensions of -6 at both ends shorten a path of length 10 to nothing. */
  q = outline(line, 2, 4, 4, -6, -6, &n);
  g_assert_cmpuint(n, ==, 0);
  free(q);
  opc_error e;
  const eda_point far[] = {{INT32_MAX, 0}, {INT32_MAX - 10, 0}};
  g_assert_cmpint(eda_path_outline(far, 2, 100, 2, 0, 0, &q, &n, &e), ==,
                  OPC_INVALID);
  g_assert_cmpint(eda_path_outline(line, 2, 100, 3, 0, 0, &q, &n, &e), ==,
                  OPC_INVALID);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/outline/rectilinear", test_rectilinear);
  g_test_add_func("/outline/any-angle", test_any_angle);
  g_test_add_func("/outline/sharp", test_sharp);
  g_test_add_func("/outline/ends", test_ends);
  g_test_add_func("/outline/odd-width", test_odd_width);
  g_test_add_func("/outline/degenerate", test_degenerate);
  return g_test_run();
}
