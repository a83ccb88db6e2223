/* SPDX-License-Identifier: BSD-3-Clause */
/* Windows of layouts, compared with a selection from all shapes; the number of
   traversed placements; refused windows. */
#include <eda/layout.h>
#include <glib.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { CELLS = 5 };

static int whole(GRand *rand, int low, int high) {
  return g_rand_int_range(rand, low, high);
}

static void add_shapes(eda_layout *layout, int32_t cell, GRand *rand, int n) {
  opc_error e;
  for (int k = 0; k < n; k++) {
    int32_t layer = whole(rand, 0, 2);
    int x = whole(rand, -99, 99), y = whole(rand, -99, 99);
    eda_point p[] = {{x, y}, {x + 9, y + 1}, {x + 4, y + whole(rand, 2, 20)}};
    eda_box box = {x, y, x + whole(rand, 0, 20), y + whole(rand, 0, 9)};
    char text[8];
    g_snprintf(text, sizeof text, "%d", k);
    int code = k % 3 ? eda_layout_add_box(layout, cell, layer, box, &e)
                     : eda_layout_add_polygon(layout, cell, layer, p, 3, &e);
    code |= eda_layout_add_text(layout, cell, layer, p[0], text, &e);
    g_assert_cmpint(code, ==, 0);
  }
}

static eda_placement random_placement(GRand *rand, bool right) {
  eda_placement p = {
      .origin = {whole(rand, -300, 300), whole(rand, -300, 300)},
      .magnification = right ? 1 : g_rand_double_range(rand, 0.5, 1.5),
      .angle = right ? 90 * whole(rand, -4, 4)
                     : g_rand_double_range(rand, -400, 400),
      .mirror = (uint32_t)whole(rand, 0, 2),
      .columns = (uint32_t)whole(rand, 1, 4),
      .rows = (uint32_t)whole(rand, 1, 4)};
  /* array of one of four kinds: square, slanted, all members in a line, all
     members in one place */
  int kind = whole(rand, 0, 4);
  p.column_step = (eda_point){kind == 3 ? 0 : whole(rand, -90, 90),
                              kind == 1 ? whole(rand, -90, 90) : 0};
  p.row_step = (eda_point){kind == 1 ? whole(rand, -90, 90) : 0,
                           kind == 3 ? 0 : whole(rand, -90, 90)};
  if (kind == 2) p.row_step = (eda_point){p.column_step.x / 2, 0};
  return p;
}

/* Build cells that place only later cells; some have enough shapes and
   instances for an index, others few. */
static eda_layout *random_layout(GRand *rand, bool right) {
  opc_error e;
  eda_layout *layout = eda_layout_new(right ? 1 : 0.7, &e);
  eda_layout_layer(layout, "poly", &e);
  eda_layout_layer(layout, "active", &e);
  for (int i = 0; i < CELLS; i++) {
    char name[8];
    g_snprintf(name, sizeof name, "C%d", i);
    eda_layout_cell(layout, name, &e);
  }
  for (int i = 0; i < CELLS; i++) {
    add_shapes(layout, i, rand, whole(rand, 0, 4) ? whole(rand, 1, 5) : 90);
    int n = i + 1 == CELLS ? 0 : whole(rand, 0, 4) ? 2 : 40;
    if (i && n > 2 && i < CELLS - 2) n = 2;
    for (int k = 0; k < n; k++) {
      eda_placement p = random_placement(rand, right || whole(rand, 0, 2));
      int32_t child = whole(rand, n > 2 ? CELLS - 2 : i + 1, CELLS);
      if (child == i) child++;
      g_assert_cmpint(eda_layout_add_instance(layout, i, child, &p, NULL, &e),
                      ==, 0);
    }
  }
  return layout;
}

static bool shape_touches(const eda_flat *all, size_t i, eda_box w) {
  uint32_t from = all->shapes.start[i], n = all->shapes.start[i + 1] - from;
  eda_box b = eda_bounds(all->shapes.points + from, n);
  return b.x0 <= w.x1 && w.x0 <= b.x1 && b.y0 <= w.y1 && w.y0 <= b.y1;
}

static int64_t turned(eda_point a, eda_point b, int64_t x, int64_t y) {
  return ((int64_t)b.x - a.x) * (y - a.y) - ((int64_t)b.y - a.y) * (x - a.x);
}

/* Return whether a line along an edge separates a convex shape from the
   window. */
static bool shape_apart(const eda_point *p, uint32_t n, eda_box w) {
  for (uint32_t i = 0; i < n; i++)
    for (int sign = -1; sign <= 1; sign += 2) {
      eda_point a = p[i], b = p[(i + 1) % n];
      bool parts = true;
      for (uint32_t k = 0; k < n; k++)
        parts = parts && sign * turned(a, b, p[k].x, p[k].y) <= 0;
      for (int k = 0; k < 4; k++)
        parts =
            parts &&
            sign * turned(a, b, k & 1 ? w.x1 : w.x0, k & 2 ? w.y1 : w.y0) > 0;
      if (parts) return true;
    }
  return false;
}

static bool shape_same(const eda_flat *all, size_t i, const eda_flat *part,
                       size_t n) {
  if (n == part->shapes.count || all->placement[i] != part->placement[n])
    return false;
  uint32_t a = all->shapes.start[i], b = part->shapes.start[n];
  uint32_t points = all->shapes.start[i + 1] - a;
  return part->shapes.start[n + 1] - b == points &&
         !memcmp(part->shapes.points + b, all->shapes.points + a,
                 points * sizeof(eda_point));
}

/* Check that the window has the shapes selected from all shapes, in order. At
   arbitrary angles, shapes whose bounding box touches the window, but not the
   shape itself, may be missing. */
static void assert_selection(const eda_flat *all, const eda_flat *part,
                             eda_box w, bool right) {
  size_t n = 0;
  for (size_t i = 0; i < all->shapes.count; i++) {
    if (!shape_touches(all, i, w)) continue;
    uint32_t from = all->shapes.start[i];
    if (shape_same(all, i, part, n))
      n++;
    else
      g_assert_true(!right && shape_apart(all->shapes.points + from,
                                          all->shapes.start[i + 1] - from, w));
  }
  g_assert_cmpuint(n, ==, part->shapes.count);
  g_assert_true((n == 0) == (part->shapes.start == NULL));
  g_assert_cmpuint(part->vertices, ==,
                   n ? part->shapes.start[part->shapes.count] : 0);
  g_assert_cmpuint(part->moved, <=, all->moved);
  g_assert_cmpfloat(part->worst, <=, all->worst);
}

static void compare_texts(const eda_layout *layout, int32_t layer,
                          const eda_flat_texts *all, eda_box w) {
  opc_error e;
  eda_flat_texts part;
  g_assert_cmpint(
      eda_layout_flatten_texts_window(layout, 0, layer, 1, &w, &part, &e), ==,
      0);
  assert_selection(&all->at, &part.at, w, true);
  size_t n = 0;
  for (size_t i = 0; i < all->at.shapes.count; i++) {
    if (!shape_touches(&all->at, i, w)) continue;
    g_assert_cmpstr(part.text[n], ==, all->text[i]);
    g_assert_cmpuint(part.depth[n], ==, all->depth[i]);
    n++;
  }
  eda_flat_texts_clear(&part);
}

static void check_layer(const eda_layout *layout, int32_t layer, bool right,
                        GRand *rand) {
  opc_error e;
  eda_flat all;
  eda_flat_texts texts;
  eda_box bounds;
  g_assert_cmpint(eda_layout_flatten(layout, 0, layer, 1, &all, &e), ==, 0);
  g_assert_cmpint(eda_layout_flatten_texts(layout, 0, layer, 1, &texts, &e), ==,
                  0);
  g_assert_cmpint(eda_layout_bounds(layout, 0, layer, 1, &bounds, &e), ==, 0);
  eda_box b = eda_bounds(all.shapes.points, all.vertices);
  if (!all.vertices) b = (eda_box){0, 0, -1, -1};
  if (right)
    g_assert_cmpmem(&bounds, sizeof bounds, &b, sizeof b);
  else
    g_assert_true(bounds.x0 <= b.x0 && bounds.y0 <= b.y0 && bounds.x1 >= b.x1 &&
                  bounds.y1 >= b.y1);
  for (int k = 0; k < 40; k++) {
    int x = whole(rand, b.x0 - 50, b.x1 + 50);
    int y = whole(rand, b.y0 - 50, b.y1 + 50);
    int size = k % 4 ? 100 : k % 8 ? 0 : 5000;
    eda_box w = {x, y, x + whole(rand, 0, size + 1),
                 y + whole(rand, 0, size + 1)};
    eda_flat part;
    g_assert_cmpint(
        eda_layout_flatten_window(layout, 0, layer, 1, &w, &part, &e), ==, 0);
    assert_selection(&all, &part, w, right);
    eda_flat_clear(&part);
    compare_texts(layout, layer, &texts, w);
  }
  eda_flat_clear(&all);
  eda_flat_texts_clear(&texts);
}

static void test_against_all(void) {
  GRand *rand = g_rand_new_with_seed(7);
  for (int round = 0; round < 30; round++) {
    eda_layout *layout = random_layout(rand, round % 2);
    for (int32_t layer = 0; layer < 2; layer++)
      check_layer(layout, layer, round % 2, rand);
    eda_layout_free(layout);
  }
  g_rand_free(rand);
}

/* A window finds the few of 10^12 shapes (an array of 10^6 x 10^6) that touch
   the window; impossible windows are refused. */
static void test_large(void) {
  opc_error e;
  eda_layout *layout = eda_layout_new(1, &e);
  int32_t layer = eda_layout_layer(layout, "poly", &e);
  int32_t bit = eda_layout_cell(layout, "bit", &e);
  int32_t row = eda_layout_cell(layout, "row", &e);
  int32_t top = eda_layout_cell(layout, "top", &e);
  eda_layout_add_box(layout, bit, layer, (eda_box){0, 0, 10, 10}, &e);
  eda_placement p = {
      .magnification = 1, .columns = 30000, .rows = 1, .column_step = {30, 0}};
  eda_layout_add_instance(layout, row, bit, &p, NULL, &e);
  p = (eda_placement){.magnification = 1,
                      .columns = 1,
                      .rows = 30000,
                      .row_step = {0, 30},
                      .angle = 180,
                      .origin = {900000, 0}};
  eda_layout_add_instance(layout, top, row, &p, NULL, &e);
  eda_box w = {450000, 450000, 450299, 450299}, bounds;
  eda_flat part;
  for (int k = 0; k < 2000; k++) {
    g_assert_cmpint(
        eda_layout_flatten_window(layout, top, layer, 1, &w, &part, &e), ==, 0);
    g_assert_cmpuint(part.shapes.count, ==, 121);
    eda_flat_clear(&part);
  }
  g_assert_cmpint(eda_layout_bounds(layout, top, layer, 1, &bounds, &e), ==, 0);
  g_assert_cmpint(bounds.x0, ==, 20);
  g_assert_cmpint(bounds.x1, ==, 900000);
  g_assert_cmpint(bounds.y0, ==, -10);
  g_assert_cmpint(bounds.y1, ==, 29999 * 30);
  /* refused: a window too far away, shapes outside the range after a change,
     circular placements */
  g_assert_cmpint(eda_layout_bounds(layout, top, layer, 1e-6, &bounds, &e), ==,
                  OPC_INVALID);
  g_assert_nonnull(strstr(e.message, "2^30"));
  eda_layout_add_box(layout, top, layer,
                     (eda_box){450100, 450011, 450101, 450012}, &e);
  g_assert_cmpint(
      eda_layout_flatten_window(layout, top, layer, 1, &w, &part, &e), ==, 0);
  g_assert_cmpuint(part.shapes.count, ==, 122);
  eda_flat_clear(&part);
  eda_layout_add_instance(layout, bit, top, &p, NULL, &e);
  g_assert_cmpint(
      eda_layout_flatten_window(layout, top, layer, 1, &w, &part, &e), ==,
      OPC_INVALID);
  g_assert_nonnull(strstr(e.message, "cycle"));
  eda_layout_free(layout);
}

/* Test a layer that is not used below the given cell. */
static void test_none_below(void) {
  opc_error e = {0};
  eda_layout *layout = eda_layout_new(1, &e);
  int32_t layer = eda_layout_layer(layout, "poly", &e);
  int32_t cell = eda_layout_cell(layout, "CELL", &e);
  int32_t top = eda_layout_cell(layout, "TOP", &e);
  eda_box w = {0, 0, 10, 10}, bounds;
  eda_flat part;
  eda_layout_add_box(layout, cell, layer, w, &e);
  g_assert_cmpint(eda_layout_bounds(layout, top, layer, 1, &bounds, &e), ==, 0);
  g_assert_cmpint(bounds.x0, >, bounds.x1);
  g_assert_cmpint(
      eda_layout_flatten_window(layout, top, layer, 1, &w, &part, &e), ==, 0);
  g_assert_cmpuint(part.shapes.count, ==, 0);
  eda_flat_clear(&part);
  eda_layout_free(layout);
}

/* Deep hierarchies, very large arrays at one position, and infinite extents
   yield a result or an error within a short time. */
static void test_hostile(void) {
  opc_error e;
  eda_layout *layout = eda_layout_new(1, &e);
  int32_t layer = eda_layout_layer(layout, "poly", &e);
  int32_t last = eda_layout_cell(layout, "0", &e);
  eda_box w = {0, 0, 10, 10};
  eda_flat part;
  eda_layout_add_box(layout, last, layer, w, &e);
  eda_placement one = {.magnification = 1, .columns = 1, .rows = 1};
  for (int i = 1; i < 20000; i++) {
    char name[16];
    g_snprintf(name, sizeof name, "%d", i);
    int32_t up = eda_layout_cell(layout, name, &e);
    eda_layout_add_instance(layout, up, last, &one, NULL, &e);
    last = up;
  }
  g_assert_cmpint(
      eda_layout_flatten_window(layout, last, layer, 1, &w, &part, &e), ==, 0);
  g_assert_cmpuint(part.shapes.count, ==, 1);
  eda_flat_clear(&part);
  int32_t top = eda_layout_cell(layout, "top", &e);
  eda_placement huge = {
      .magnification = 1e300, .angle = 30, .columns = 9, .rows = 9};
  eda_layout_add_instance(layout, top, 1, &huge, NULL, &e);
  int32_t over = eda_layout_cell(layout, "over", &e);
  eda_layout_add_instance(layout, over, top, &huge, NULL, &e);
  g_assert_cmpint(
      eda_layout_flatten_window(layout, over, layer, 1, &w, &part, &e), ==,
      OPC_INVALID);
  eda_placement many = {.magnification = 1, .columns = 4000000000u, .rows = 1};
  int32_t pile = eda_layout_cell(layout, "pile", &e);
  eda_layout_add_instance(layout, pile, last, &many, NULL, &e);
  g_assert_cmpint(
      eda_layout_flatten_window(layout, pile, layer, 1, &w, &part, &e), ==,
      OPC_INVALID);
  eda_layout_free(layout);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/window/against-all", test_against_all);
  g_test_add_func("/window/large", test_large);
  g_test_add_func("/window/none-below", test_none_below);
  g_test_add_func("/window/hostile", test_hostile);
  return g_test_run();
}
