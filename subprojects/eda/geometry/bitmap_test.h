/* SPDX-License-Identifier: BSD-3-Clause */
/* Random polygons and shapes as bitmaps, for the tests of this folder. */
#pragma once

#include <glib.h>
#include <string.h>

#include "geometry/scan.h"

enum { SIZE = 24 }; /* coordinates 0 .. SIZE; pixels of one unit */

typedef struct bitmap {
  uint8_t at[SIZE][SIZE]; /* [y][x] */
} bitmap;

/* Draw shapes by winding numbers: in each row, count the edges to the left of
   each pixel. Polygons are counted separately, outlines and holes together. */
static inline void bitmap_draw(bitmap *b, const eda_shapes *s) {
  int wind[SIZE][SIZE] = {0};
  memset(b, 0, sizeof *b);
  for (size_t p = 0; p < s->count; p++) {
    uint32_t first = s->start[p], end = s->start[p + 1];
    if (!s->hole) memset(wind, 0, sizeof wind);
    for (uint32_t i = first; i < end; i++) {
      eda_point u = s->points[i], v = s->points[i + 1 < end ? i + 1 : first];
      if (u.x != v.x) continue;
      for (int y = MIN(u.y, v.y); y < MAX(u.y, v.y); y++)
        for (int x = u.x; x < SIZE; x++) wind[y][x] += u.y > v.y ? 1 : -1;
    }
    if (s->hole && p + 1 < s->count) continue;
    for (int y = 0; y < SIZE; y++)
      for (int x = 0; x < SIZE; x++) b->at[y][x] |= wind[y][x] != 0;
  }
}

typedef struct builder {
  GArray *start, *points;
} builder;

static inline builder builder_new(void) {
  builder b = {g_array_new(FALSE, FALSE, sizeof(uint32_t)),
               g_array_new(FALSE, FALSE, sizeof(eda_point))};
  uint32_t zero = 0;
  g_array_append_val(b.start, zero);
  return b;
}

static inline void builder_point(builder *b, int32_t x, int32_t y) {
  eda_point p = {x, y};
  g_array_append_val(b->points, p);
}

static inline void builder_close(builder *b) {
  uint32_t n = b->points->len;
  g_array_append_val(b->start, n);
}

static inline void builder_box(builder *b, int32_t x0, int32_t y0, int32_t x1,
                               int32_t y1) {
  builder_point(b, x0, y0);
  builder_point(b, x1, y0);
  builder_point(b, x1, y1);
  builder_point(b, x0, y1);
  builder_close(b);
}

/* Return a view of the shapes; builder_free frees their arrays. */
static inline eda_shapes builder_shapes(const builder *b) {
  return (eda_shapes){b->start->len - 1, (uint32_t *)(void *)b->start->data,
                      (eda_point *)(void *)b->points->data, NULL};
}

static inline void builder_free(builder *b) {
  g_array_free(b->start, TRUE);
  g_array_free(b->points, TRUE);
}

/* Return random boxes of both orientations, and random closed paths that cross
   themselves, repeat points and reverse on their own edges. */
static inline builder random_shapes(GRand *r, int most) {
  builder b = builder_new();
  int n = g_rand_int_range(r, 0, most + 1);
  int size = g_rand_boolean(r) ? SIZE : SIZE / 4;
  for (int i = 0; i < n; i++) {
    int x = g_rand_int_range(r, 0, size + 1);
    int y = g_rand_int_range(r, 0, size + 1);
    if (g_rand_int_range(r, 0, 3)) {
      int u = g_rand_int_range(r, 0, size + 1);
      int v = g_rand_int_range(r, 0, size + 1);
      if (size == SIZE) {
        u = MIN(x + 5, SIZE);
        v = MIN(y + 7, SIZE);
      }
      if (g_rand_boolean(r))
        builder_box(&b, x, y, u, v);
      else
        builder_box(&b, u, y, x, v);
      continue;
    }
    int x0 = x, steps = g_rand_int_range(r, 1, 9);
    for (int k = 0; k < steps; k++) {
      builder_point(&b, x, y);
      x = g_rand_int_range(r, 0, size + 1);
      builder_point(&b, x, y);
      y = g_rand_int_range(r, 0, size + 1);
    }
    builder_point(&b, x, y);
    builder_point(&b, x0, y);
    builder_close(&b);
  }
  return b;
}

/* Number the connected regions of pixels equal to `value` in label[y][x], from
   1. A pixel has 4 or 8 neighbours. Pixels outside the bitmap are 0. */
typedef struct labels {
  int at[SIZE + 2][SIZE + 2]; /* number of pixel [y - 1][x - 1] */
  int count;
} labels;

static inline void bitmap_label(const bitmap *b, int value, int neighbours,
                                labels *l) {
  enum { W = SIZE + 2 };
  static const int dx[] = {1, -1, 0, 0, 1, 1, -1, -1};
  static const int dy[] = {0, 0, 1, -1, 1, -1, 1, -1};
  int stack[W * W], top;
  memset(l, 0, sizeof *l);
#define IS(u, w)                                    \
  ((u) > 0 && (w) > 0 && (u) <= SIZE && (w) <= SIZE \
       ? b->at[(w)-1][(u)-1] == value               \
       : !value)
  for (int s = 0; s < W * W; s++) {
    if (l->at[s / W][s % W] || !IS(s % W, s / W)) continue;
    l->at[s / W][s % W] = ++l->count;
    stack[0] = s;
    for (top = 1; top;) {
      int p = stack[--top];
      for (int k = 0; k < neighbours; k++) {
        int u = p % W + dx[k], w = p / W + dy[k];
        if (u < 0 || w < 0 || u >= W || w >= W) continue;
        if (l->at[w][u] || !IS(u, w)) continue;
        l->at[w][u] = l->count;
        stack[top++] = w * W + u;
      }
    }
  }
#undef IS
}
