/* SPDX-License-Identifier: BSD-3-Clause */
/* Arrays compared point by point with the cell: mirroring about shared edges
   folds the coordinates of the array back into the cell. */
#include <eda/layout.h>
#include <stdlib.h>
#include <string.h>

#include "tools/devel/testing.h"

enum { W = 10, H = 7, X0 = 3, Y0 = -2 }; /* the boundary of the cell */

static void add(eda_layout *l, int32_t cell, const char *layer, int x, int y,
                int w, int h) {
  opc_error e;
  eda_box b = {x, y, x + w, y + h};
  int32_t k = eda_layout_layer(l, layer, &e);
  g_assert_false(eda_layout_add_box(l, cell, k, b, &e));
}

/* Return a cell with a sub-cell, a boundary, and a shape beyond the boundary.
 */
static eda_layout *cell_new(int w, int h) {
  opc_error e;
  eda_layout *l = eda_layout_new(2, &e);
  int32_t top = eda_layout_cell(l, "BIT", &e);
  int32_t part = eda_layout_cell(l, "PART", &e);
  eda_placement p = {{X0, Y0}, 1, 0, 0, 1, 1, {0, 0}, {0, 0}};
  g_assert_false(eda_layout_add_instance(l, top, part, &p, "P", &e));
  add(l, top, "81/2", X0, Y0, w, h);
  add(l, part, "poly", 1, 1, 2, 4);
  add(l, part, "drop", 1, 3, 1, 1);
  add(l, top, "poly", X0 + 4, Y0 + 5, 3, 1);
  g_assert_false(eda_layout_derive(l, "mask", "poly - drop", &e));
  return l;
}

/* Return whether a layer covers the pixel (x, y) of a cell. */
static int covers(const eda_layout *l, int32_t cell, const char *layer, int x,
                  int y) {
  opc_error e;
  eda_flat flat;
  int any = 0;
  eda_box w = {x, y, x + 1, y + 1};
  g_assert_false(eda_layout_flatten_window(
      l, cell, eda_layout_find_layer(l, layer), 2, &w, &flat, &e));
  for (size_t i = 0; i < flat.shapes.count; i++) {
    eda_box b = eda_shape_box(&flat.shapes, i);
    any |= b.x0 <= x && b.y0 <= y && b.x1 > x && b.y1 > y;
  }
  eda_flat_clear(&flat);
  return any;
}

/* Return the pixel of the cell for pixel x of the array, with mirroring of
   every second cell. */
static int fold(int x, int size, int mirror) {
  int at = x % size;
  return mirror && x / size % 2 ? size - 1 - at : at;
}

static opc_module *array_new(const char *settings, const eda_layout *cell) {
  opc_error e;
  opc_module *m = opc_test_module("layout.array", settings, &e);
  if (!m) g_error("%s", e.message);
  opc_test_input(m, "layout", (void *)cell);
  return m;
}

static void *array_run(opc_module *m) {
  opc_error e;
  void *out = NULL;
  if (opc_test_run(m, &out, &e)) g_error("%s", e.message);
  return out;
}

static void check_mirror(const char *mirror, int rows, int columns) {
  eda_layout *cell = cell_new(W, H);
  g_autofree char *text = g_strdup_printf(
      "{ columns: 3, rows: 4, boundary: 81/2, mirror: %s }", mirror);
  opc_module *m = array_new(text, cell);
  void *out = array_run(m);
  g_assert_cmpfloat(opc_test_metric("cells"), ==, 12);
  g_assert_cmpfloat(opc_test_metric("width"), ==, 2 * W);
  int32_t top = eda_layout_find_cell(out, "array");
  for (int y = 0; y < 4 * H; y++)
    for (int x = 0; x < 3 * W; x++)
      for (int k = 0; k < 2; k++) {
        const char *layer = k ? "mask" : "poly";
        g_assert_cmpint(covers(out, top, layer, x, y), ==,
                        covers(cell, 0, layer, X0 + fold(x, W, rows),
                               Y0 + fold(y, H, columns)));
      }
  opc_test_release(m, &out);
  opc_test_module_free(m);
  eda_layout_free(cell);
}

static void test_mirror(void) {
  check_mirror("none", 0, 0);
  check_mirror("rows", 1, 0);
  check_mirror("columns", 0, 1);
  check_mirror("both", 1, 1);
}

/* Cells of the same names from several layouts; positions of the ends. */
static void test_ends(void) {
  eda_layout *cell = cell_new(W, H), *row = cell_new(5, H);
  eda_layout *column = cell_new(W, 6), *corner = cell_new(5, 6);
  opc_module *m =
      array_new("{ columns: 2, rows: 2, boundary: 81/2, name: core }", cell);
  opc_test_input(m, "row_end", row);
  opc_test_input(m, "column_end", column);
  opc_test_input(m, "corner", corner);
  void *out = array_run(m);
  g_assert_cmpint(eda_layout_find_cell(out, "BIT$4"), >=, 0);
  int32_t top = eda_layout_find_cell(out, "core");
  for (int y = -6; y < 2 * H + 6; y++)
    for (int x = -5; x < 2 * W + 5; x++) {
      int right = x >= 2 * W, above = y >= 2 * H;
      int u = x < 0 ? -1 - x : right ? x - 2 * W : fold(x, W, 1);
      int v = y < 0 ? -1 - y : above ? y - 2 * H : fold(y, H, 1);
      int end = x < 0 || right, side = y < 0 || above;
      const eda_layout *from = end ? side ? corner : row : side ? column : cell;
      g_assert_cmpint(covers(out, top, "81/2", x, y), ==, 1);
      g_assert_cmpint(covers(out, top, "mask", x, y), ==,
                      covers(from, 0, "mask", X0 + u, Y0 + v));
    }
  opc_test_release(m, &out);
  opc_test_module_free(m);
  eda_layout_free(cell);
  eda_layout_free(row);
  eda_layout_free(column);
  eda_layout_free(corner);
}

static void assert_refused(const char *settings, const eda_layout *row_end,
                           const char *parameter, const char *message) {
  eda_layout *cell = cell_new(W, H);
  opc_module *m = array_new(settings, cell);
  if (row_end) opc_test_input(m, "row_end", (void *)row_end);
  opc_error e;
  void *out = NULL;
  g_assert_cmpint(opc_test_run(m, &out, &e), ==, OPC_INVALID);
  g_assert_cmpstr(e.parameter, ==, parameter);
  g_assert_nonnull(strstr(e.message, message));
  opc_test_module_free(m);
  eda_layout_free(cell);
}

static void test_refused(void) {
  eda_layout *end = cell_new(5, H + 1);
  assert_refused("{ boundary: 81/2 }", end, "row_end",
                 "a height of 16 nm, expected 14 nm");
  assert_refused("{ boundary: 81/3 }", NULL, "layout",
                 "the layout has no layer '81/3'");
  assert_refused("{ name: PART }", NULL, "name", "has a cell 'PART'");
  assert_refused("{ top: NO }", NULL, "top", "no cell 'NO'");
  opc_error e;
  g_assert_null(opc_test_module("layout.array", "{ columns: 0 }", &e));
  g_assert_nonnull(strstr(e.message, "'columns' must be at least 1"));
  g_assert_null(opc_test_module("layout.array", "{ rows: -1 }", &e));
  g_assert_nonnull(strstr(e.message, "'rows' must be at least 1"));
  eda_layout_free(end);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/layout-array/mirror", test_mirror);
  g_test_add_func("/layout-array/ends", test_ends);
  g_test_add_func("/layout-array/refused", test_refused);
  return g_test_run();
}
