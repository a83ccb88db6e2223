/* SPDX-License-Identifier: BSD-3-Clause */
/* Placements of drawing cells, compared with the flattened layout, and
   checksums of equal and of different cells. */
#include <correct/units.h>
#include <glib.h>
#include <stdlib.h>

static opc_error error;

static eda_layout *layout_new(double unit) {
  eda_layout *layout = eda_layout_new(unit, &error);
  g_assert_nonnull(layout);
  return layout;
}

static int32_t cell_of(eda_layout *layout, const char *name) {
  return eda_layout_cell(layout, name, &error);
}

static void draw(eda_layout *layout, const char *cell, const char *layer,
                 eda_box box) {
  int32_t number = eda_layout_layer(layout, layer, &error);
  g_assert_cmpint(
      eda_layout_add_box(layout, cell_of(layout, cell), number, box, &error),
      ==, OPC_OK);
}

static void place(eda_layout *layout, const char *in, const char *child,
                  eda_placement p) {
  g_assert_cmpint(
      eda_layout_add_instance(layout, cell_of(layout, in),
                              cell_of(layout, child), &p, NULL, &error),
      ==, OPC_OK);
}

static int by_point(const void *a, const void *b) {
  const eda_point *p = a, *q = b;
  return p->x != q->x ? (p->x > q->x) - (p->x < q->x)
                      : (p->y > q->y) - (p->y < q->y);
}

static int by_text(const void *a, const void *b) {
  return g_strcmp0(*(char *const *)a, *(char *const *)b);
}

/* Return a text of the corners of a shape, in any order. */
static char *text_of(const eda_point *points, size_t n) {
  g_autofree eda_point *sorted = g_memdup2(points, n * sizeof *points);
  GString *text = g_string_new(NULL);
  qsort(sorted, n, sizeof *sorted, by_point);
  for (size_t i = 0; i < n; i++)
    g_string_append_printf(text, "%d %d,", (int)sorted[i].x, (int)sorted[i].y);
  return g_string_free(text, FALSE);
}

/* A cell with one L-shaped polygon, in arrays, in eight orientations, two
   levels deep. */
static eda_layout *everywhere(void) {
  static const eda_point corner[] = {{0, 0},   {70, 0},  {70, 20},
                                     {30, 20}, {30, 50}, {0, 50}};
  eda_layout *layout = layout_new(1);
  int32_t poly = eda_layout_layer(layout, "poly", &error);
  g_assert_cmpint(eda_layout_add_polygon(layout, cell_of(layout, "leaf"), poly,
                                         corner, 6, &error),
                  ==, OPC_OK);
  draw(layout, "wire", "metal1", (eda_box){0, 0, 9, 9});
  place(layout, "group", "leaf",
        (eda_placement){{100, 7}, 1, 90, 1, 2, 3, {200, 3}, {5, 300}});
  place(layout, "group", "leaf",
        (eda_placement){{-300, 1}, 1, -360, 0, 1, 1, {0, 0}, {0, 0}});
  place(layout, "top", "wire",
        (eda_placement){{0, 0}, 1, 45, 0, 1, 1, {0, 0}, {0, 0}});
  for (int i = 0; i < 8; i++)
    place(layout, "top", "group",
          (eda_placement){{5000 * i, 11 * i},
                          1,
                          90.0 * (i % 4) - 180,
                          i / 4,
                          1,
                          1,
                          {0, 0},
                          {0, 0}});
  return layout;
}

static void test_places(void) {
  eda_layout *layout = everywhere();
  int32_t top = cell_of(layout, "top"), leaf = cell_of(layout, "leaf"), layer;
  size_t n;
  eda_flat flat;
  g_assert_cmpint(
      eda_layout_flatten(layout, top, eda_layout_find_layer(layout, "poly"), 1,
                         &flat, &error),
      ==, OPC_OK);
  for (int named = 0; named < 2; named++) {
    units u;
    g_assert_cmpint(correct_units_find(layout, named ? top : -1, &u, &error),
                    ==, OPC_OK);
    g_assert_cmpuint(u.count, ==, 8 * (2 * 3 + 1));
    g_assert_cmpuint(flat.shapes.count, ==, u.count);
    g_auto(GStrv) want = g_new0(char *, u.count + 1);
    g_auto(GStrv) got = g_new0(char *, u.count + 1);
    for (size_t i = 0; i < u.count; i++) {
      uint32_t from = flat.shapes.start[i];
      want[i] =
          text_of(flat.shapes.points + from, flat.shapes.start[i + 1] - from);
      g_assert_cmpint(u.unit[i].cell, ==, leaf);
      const eda_point *p = eda_layout_polygon(layout, leaf, 0, &n, &layer);
      turn t = u.unit[i].at;
      eda_point moved[6];
      for (size_t k = 0; k < n; k++)
        moved[k] = (eda_point){(int32_t)(t.xx * p[k].x + t.xy * p[k].y + t.dx),
                               (int32_t)(t.yx * p[k].x + t.yy * p[k].y + t.dy)};
      got[i] = text_of(moved, n);
    }
    qsort(want, u.count, sizeof *want, by_text);
    qsort(got, u.count, sizeof *got, by_text);
    for (size_t i = 0; i < u.count; i++) g_assert_cmpstr(got[i], ==, want[i]);
    g_free(u.unit);
  }
  eda_flat_clear(&flat);
  eda_layout_free(layout);
}

/* The outermost drawing cells are units, also with cells below; a top cell only
   if no cell below draws. */
static void test_outermost(void) {
  static const eda_placement once = {{40, 0}, 1, 0, 0, 1, 1, {0, 0}, {0, 0}};
  eda_layout *layout = layout_new(1);
  units u;
  draw(layout, "alone", "active", (eda_box){0, 0, 10, 10});
  draw(layout, "leaf", "poly", (eda_box){0, 0, 10, 10});
  draw(layout, "cell", "active", (eda_box){0, 0, 30, 10});
  draw(layout, "top", "poly", (eda_box){0, 0, 10, 10});
  place(layout, "cell", "leaf", once);
  place(layout, "top", "cell", once);
  g_assert_cmpint(correct_units_find(layout, -1, &u, &error), ==, OPC_OK);
  g_assert_cmpuint(u.count, ==, 2);
  g_assert_cmpint(u.unit[0].cell, ==, cell_of(layout, "alone"));
  g_assert_cmpint(u.unit[0].at.dx, ==, 0);
  g_assert_cmpint(u.unit[1].cell, ==, cell_of(layout, "cell"));
  g_assert_cmpint(u.unit[1].at.dx, ==, 40);
  g_free(u.unit);
  eda_layout_free(layout);
}

static void expect_refused(eda_placement p, const char *pattern) {
  eda_layout *layout = layout_new(1);
  units u;
  draw(layout, "leaf", "poly", (eda_box){0, 0, 10, 10});
  place(layout, "top", "leaf", p);
  g_assert_cmpint(correct_units_find(layout, -1, &u, &error), ==, OPC_INVALID);
  if (!g_pattern_match_simple(pattern, error.message))
    g_error("%s", error.message);
  g_free(u.unit);
  eda_layout_free(layout);
}

static void test_refused(void) {
  expect_refused((eda_placement){{0, 0}, 1, 45, 0, 1, 1, {0, 0}, {0, 0}},
                 "cell 'leaf' is placed with an angle of 45 degrees *");
  expect_refused((eda_placement){{0, 0}, 2, 0, 0, 1, 1, {0, 0}, {0, 0}},
                 "*a magnification of 2, expected multiples of 90 *");
  eda_layout *layout = layout_new(1);
  units u;
  draw(layout, "top", "active", (eda_box){0, 0, 10, 10});
  g_assert_cmpint(eda_layout_derive(layout, "poly", "active + active", &error),
                  ==, OPC_OK);
  g_assert_cmpint(correct_units_find(layout, -1, &u, &error), ==, OPC_INVALID);
  g_assert_true(g_str_has_prefix(error.message, "poly or active is an exp"));
  eda_layout_free(layout);
}

/* Return the checksum of a cell of two boxes: the second on `layer` from x to x
   + 20 nm. `swapped`: drawn first, with two halves. */
static char *sum_of(double unit, const char *layer, int x, int swapped) {
  eda_layout *layout = layout_new(unit);
  int32_t k = (int32_t)(1 / unit);
  eda_box first = {0, 0, 10 * k, 50 * k}, second = {x * k, 0, (x + 20) * k, k};
  if (!swapped) {
    draw(layout, "c", "poly", first);
    draw(layout, "c", layer, second);
  } else {
    eda_box low = second, high = second;
    low.x1 = high.x0 = (x + 10) * k;
    draw(layout, "c", layer, high);
    draw(layout, "c", layer, low);
    draw(layout, "c", "poly", first);
  }
  char *sum = correct_units_sum(layout, cell_of(layout, "c"), &error);
  g_assert_nonnull(sum);
  eda_layout_free(layout);
  return sum;
}

static void test_sum(void) {
  g_autofree char *sum = sum_of(1, "active", 15, 0);
  g_autofree char *fine = sum_of(0.5, "active", 15, 1);
  g_autofree char *moved = sum_of(1, "active", 16, 0);
  g_autofree char *other = sum_of(1, "metal1", 15, 0);
  g_assert_cmpstr(sum, ==, fine);
  g_assert_cmpstr(sum, !=, moved);
  g_assert_cmpstr(sum, !=, other);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/units/places", test_places);
  g_test_add_func("/units/outermost", test_outermost);
  g_test_add_func("/units/refused", test_refused);
  g_test_add_func("/units/sum", test_sum);
  return g_test_run();
}
