/* SPDX-License-Identifier: BSD-3-Clause */
/* Boolean operations on random shapes, compared with bitmaps, and on known
   shapes. */
#include "geometry/bitmap_test.h"

static int64_t outline2(const eda_shapes *s, size_t p) {
  int64_t sum = 0;
  for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
    eda_point a = s->points[i];
    eda_point b = s->points[i + 1 < s->start[p + 1] ? i + 1 : s->start[p]];
    sum += (int64_t)a.x * b.y - (int64_t)b.x * a.y;
  }
  return sum;
}

/* Check all properties of merged shapes in geometry.h, except the area. */
static void check_canonical(const eda_shapes *s) {
  for (size_t p = 0; p < s->count; p++) {
    uint32_t first = s->start[p], n = s->start[p + 1] - first;
    const eda_point *q = &s->points[first];
    g_assert_cmpuint(n, >=, 4);
    for (uint32_t i = 0; i < n; i++) {
      eda_point a = q[i], b = q[(i + 1) % n], c = q[(i + 2) % n];
      g_assert_true((a.x == b.x) != (a.y == b.y));
      g_assert_true((a.x == b.x) != (b.x == c.x));
      g_assert_true(i == 0 || a.y > q->y || (a.y == q->y && a.x > q->x));
    }
    g_assert_true(s->hole[p] ? outline2(s, p) < 0 : outline2(s, p) > 0);
    if (p == 0) continue;
    eda_point last = s->points[s->start[p - 1]];
    g_assert_true(last.y < q->y || (last.y == q->y && last.x < q->x));
  }
}

static int shapes_same(const eda_shapes *a, const eda_shapes *b) {
  if (a->count != b->count) return 0;
  if (a->count == 0) return 1;
  return !memcmp(a->start, b->start, (a->count + 1) * sizeof *a->start) &&
         !memcmp(a->hole, b->hole, a->count) &&
         !memcmp(a->points, b->points, a->start[a->count] * sizeof *a->points);
}

static void check_against_bitmap(int op, const eda_shapes *a,
                                 const eda_shapes *b, eda_shapes *out) {
  opc_error error;
  bitmap pa, pb, want, got;
  g_assert_cmpint(eda_boolean(op, a, b, out, &error), ==, OPC_OK);
  bitmap_draw(&pa, a);
  bitmap_draw(&pb, b);
  bitmap_draw(&got, out);
  int64_t area = 0;
  for (int y = 0; y < SIZE; y++)
    for (int x = 0; x < SIZE; x++) {
      int u = pa.at[y][x], v = pb.at[y][x];
      int w = op == EDA_OR    ? u || v
              : op == EDA_AND ? u && v
              : op == EDA_NOT ? u && !v
                              : u != v;
      want.at[y][x] = (uint8_t)w;
      area += w;
    }
  g_assert_cmpmem(&got, sizeof got, &want, sizeof want);
  g_assert_cmpint(eda_area2(out), ==, 2 * area);
  check_canonical(out);
  /* Shapes that touch only in a corner are separate shapes; holes that touch
     only in a corner are one hole. */
  labels l;
  size_t holes = 0;
  for (size_t p = 0; p < out->count; p++) holes += out->hole[p];
  bitmap_label(&want, 1, 4, &l);
  g_assert_cmpuint(out->count - holes, ==, l.count);
  bitmap_label(&want, 0, 8, &l);
  g_assert_cmpuint(holes, ==, l.count - 1);
}

static void test_random(void) {
  GRand *r = g_rand_new_with_seed(1);
  for (int i = 0; i < 4000; i++) {
    builder ba = random_shapes(r, i % 12), bb = random_shapes(r, i % 7);
    eda_shapes a = builder_shapes(&ba), b = builder_shapes(&bb), out[4], again;
    opc_error error;
    int64_t area[4];
    for (int op = 0; op < 4; op++) {
      check_against_bitmap(op, &a, &b, &out[op]);
      area[op] = eda_area2(&out[op]);
      g_assert_cmpint(eda_boolean(EDA_OR, &out[op], NULL, &again, &error), ==,
                      OPC_OK);
      g_assert_true(shapes_same(&out[op], &again));
      eda_shapes_clear(&again);
    }
    g_assert_cmpint(area[EDA_XOR], ==, area[EDA_OR] - area[EDA_AND]);
    g_assert_cmpint(
        eda_boolean(EDA_NOT, &out[EDA_OR], &out[EDA_AND], &again, &error), ==,
        OPC_OK);
    g_assert_true(shapes_same(&out[EDA_XOR], &again));
    eda_shapes_clear(&again);
    for (int op = 0; op < 4; op++) eda_shapes_clear(&out[op]);
    builder_free(&ba);
    builder_free(&bb);
  }
  g_rand_free(r);
}

static void check_points(const eda_shapes *s, const char *want) {
  g_autoptr(GString) text = g_string_new("");
  for (size_t p = 0; p < s->count; p++) {
    g_string_append(text, s->hole[p] ? "hole" : "poly");
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++)
      g_string_append_printf(text, " %d,%d", s->points[i].x, s->points[i].y);
    g_string_append(text, "; ");
  }
  g_assert_cmpstr(text->str, ==, want);
}

static void merge_is(builder *b, const char *want) {
  eda_shapes s = builder_shapes(b), out;
  opc_error error;
  g_assert_cmpint(eda_boolean(EDA_OR, &s, NULL, &out, &error), ==, OPC_OK);
  check_points(&out, want);
  eda_shapes_clear(&out);
  builder_free(b);
}

static void test_touching(void) {
  builder b = builder_new();
  builder_box(&b, 5, 5, 10, 10);
  builder_box(&b, 0, 0, 5, 5);
  merge_is(&b, "poly 0,0 5,0 5,5 0,5; poly 5,5 10,5 10,10 5,10; ");
  b = builder_new();
  builder_box(&b, 5, 0, 10, 5);
  builder_box(&b, 0, 5, 5, 10);
  merge_is(&b, "poly 5,0 10,0 10,5 5,5; poly 0,5 5,5 5,10 0,10; ");
  b = builder_new();
  builder_box(&b, 0, 0, 5, 5);
  builder_box(&b, 5, 0, 10, 5);
  merge_is(&b, "poly 0,0 10,0 10,5 0,5; ");
}

static void test_hole(void) {
  builder b = builder_new();
  builder_box(&b, 0, 0, 9, 3);
  builder_box(&b, 0, 6, 9, 9);
  builder_box(&b, 0, 0, 3, 9);
  builder_box(&b, 6, 0, 9, 9);
  merge_is(&b, "poly 0,0 9,0 9,9 0,9; hole 3,3 3,6 6,6 6,3; ");
  /* An outline of the opposite orientation with redundant points. */
  b = builder_new();
  builder_point(&b, 0, 0);
  builder_point(&b, 0, 4);
  builder_point(&b, 0, 4);
  builder_point(&b, 0, 9);
  builder_point(&b, 9, 9);
  builder_point(&b, 9, 0);
  builder_point(&b, 12, 0);
  builder_point(&b, 9, 0);
  builder_close(&b);
  merge_is(&b, "poly 0,0 9,0 9,9 0,9; ");
}

static void assert_refused(builder *b, const char *message) {
  eda_shapes s = builder_shapes(b), out;
  opc_error error;
  eda_box *boxes;
  size_t n;
  g_assert_cmpint(eda_boolean(EDA_OR, NULL, &s, &out, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.message, ==, message);
  g_assert_cmpuint(out.count, ==, 0);
  g_assert_cmpint(eda_fracture(&s, &boxes, &n, &error), ==, OPC_INVALID);
  g_assert_null(boxes);
  builder_free(b);
}

static void test_refused(void) {
  builder b = builder_new();
  builder_point(&b, 0, 0);
  builder_point(&b, 10, 0);
  builder_point(&b, 7, -3);
  builder_close(&b);
  assert_refused(&b, "slanted edge from (10, 0) to (7, -3)");
  b = builder_new();
  builder_box(&b, 0, 0, 1, 1);
  builder_box(&b, 0, 0, (1 << 30) + 1, 1);
  assert_refused(&b, "point (1073741825, 0) is beyond 2^30");
  b = builder_new();
  eda_shapes s = builder_shapes(&b), out;
  opc_error error;
  g_assert_cmpint(eda_boolean(7, &s, NULL, &out, &error), ==, OPC_INVALID);
  builder_free(&b);
}

static void test_bounds(void) {
  int32_t m = 1 << 30;
  builder b = builder_new();
  builder_box(&b, -m, -m, m, 0);
  merge_is(&b,
           "poly -1073741824,-1073741824 1073741824,-1073741824 1073741824,0 "
           "-1073741824,0; ");
  b = builder_new();
  builder_box(&b, -m, -m, m, m - 1);
  eda_shapes s = builder_shapes(&b);
  g_assert_cmpint(eda_area2(&s), ==, INT64_MAX - ((INT64_C(1) << 32) - 1));
  builder_free(&b);
  b = builder_new();
  eda_shapes none = builder_shapes(&b), out;
  opc_error error;
  g_assert_cmpint(eda_boolean(EDA_XOR, &none, NULL, &out, &error), ==, OPC_OK);
  g_assert_cmpuint(out.count, ==, 0);
  g_assert_cmpint(eda_area2(&out), ==, 0);
  builder_free(&b);
}

/* Cross lines with bands: the result contains every crossing, and its number of
   polygons is known. */
static void test_grid(void) {
  enum { N = 300 };
  builder lines = builder_new(), bands = builder_new();
  for (int i = 0; i < N; i++) {
    builder_box(&lines, 250 * i, 0, 250 * i + 65, 200 * N);
    builder_box(&bands, 0, 200 * i, 250 * N, 200 * i + 90);
  }
  eda_shapes a = builder_shapes(&lines), b = builder_shapes(&bands), out;
  opc_error error;
  g_assert_cmpint(eda_boolean(EDA_AND, &a, &b, &out, &error), ==, OPC_OK);
  g_assert_cmpuint(out.count, ==, (size_t)N * N);
  g_assert_cmpint(eda_area2(&out), ==, 2LL * N * N * 65 * 90);
  eda_shapes_clear(&out);
  g_assert_cmpint(eda_boolean(EDA_OR, &a, &b, &out, &error), ==, OPC_OK);
  g_assert_cmpuint(out.count, ==, 1 + (size_t)(N - 1) * (N - 1));
  eda_shapes_clear(&out);
  builder_free(&lines);
  builder_free(&bands);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/boolean/random", test_random);
  g_test_add_func("/boolean/touching", test_touching);
  g_test_add_func("/boolean/hole", test_hole);
  g_test_add_func("/boolean/refused", test_refused);
  g_test_add_func("/boolean/bounds", test_bounds);
  g_test_add_func("/boolean/grid", test_grid);
  return g_test_run();
}
