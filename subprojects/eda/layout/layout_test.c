/* SPDX-License-Identifier: BSD-3-Clause */
/* Construction of layouts and access to their contents. */
#include <eda/layout.h>
#include <glib.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static eda_layout *new_layout(void) {
  opc_error e;
  eda_layout *layout = eda_layout_new(1, &e);
  g_assert_nonnull(layout);
  return layout;
}

static void cell_place(eda_layout *layout, const char *in, const char *child) {
  opc_error e;
  eda_placement p = {.magnification = 1, .columns = 1, .rows = 1};
  int32_t a = eda_layout_cell(layout, in, &e),
          b = eda_layout_cell(layout, child, &e);
  g_assert_cmpint(eda_layout_add_instance(layout, a, b, &p, NULL, &e), ==, 0);
}

static void test_names(void) {
  opc_error e;
  eda_layout *layout = new_layout();
  g_assert_cmpint(eda_layout_cell(layout, "A", &e), ==, 0);
  g_assert_cmpint(eda_layout_cell(layout, "B", &e), ==, 1);
  g_assert_cmpint(eda_layout_cell(layout, "A", &e), ==, 0);
  g_assert_cmpint(eda_layout_layer(layout, "poly", &e), ==, 0);
  g_assert_cmpint(eda_layout_layer(layout, "9/0", &e), ==, 1);
  g_assert_cmpint(eda_layout_find_cell(layout, "B"), ==, 1);
  g_assert_cmpint(eda_layout_find_cell(layout, "C"), ==, -1);
  g_assert_cmpint(eda_layout_find_layer(layout, "9/0"), ==, 1);
  g_assert_cmpstr(eda_layout_cell_name(layout, 1), ==, "B");
  g_assert_cmpstr(eda_layout_layer_name(layout, 0), ==, "poly");
  g_assert_cmpuint(eda_layout_cells(layout), ==, 2);
  g_assert_cmpuint(eda_layout_layers(layout), ==, 2);
  eda_layout_free(layout);
}

static void assert_polygon(const eda_layout *layout, int32_t cell, size_t i,
                           int32_t layer, const eda_point *points, size_t n) {
  size_t count;
  int32_t on;
  const eda_point *p = eda_layout_polygon(layout, cell, i, &count, &on);
  g_assert_cmpint(on, ==, layer);
  g_assert_cmpmem(p, count * sizeof *p, points, n * sizeof *p);
}

/* Boxes precede the polygons of their layer and have four points. */
static void test_shapes(void) {
  opc_error e;
  eda_layout *layout = new_layout();
  int32_t a = eda_layout_cell(layout, "A", &e);
  int32_t one = eda_layout_layer(layout, "1", &e),
          two = eda_layout_layer(layout, "2", &e);
  const eda_point corner[] = {{0, 0}, {5, 0}, {5, 2}, {2, 2}, {2, 7}, {0, 7}};
  const eda_point kite[] = {{0, 0}, {5, 1}, {6, 6}, {1, 5}};
  const eda_point turned[] = {{3, 9}, {3, 4}, {8, 4}, {8, 9}};
  const eda_point box[] = {{3, 4}, {8, 4}, {8, 9}, {3, 9}};
  g_assert_cmpint(eda_layout_add_polygon(layout, a, two, corner, 6, &e), ==, 0);
  g_assert_cmpint(eda_layout_add_polygon(layout, a, one, kite, 4, &e), ==, 0);
  g_assert_cmpint(eda_layout_add_polygon(layout, a, two, kite, 4, &e), ==, 0);
  g_assert_cmpint(eda_layout_add_polygon(layout, a, two, turned, 4, &e), ==, 0);
  g_assert_cmpint(eda_layout_add_box(layout, a, one, (eda_box){3, 4, 8, 9}, &e),
                  ==, 0);
  g_assert_cmpuint(eda_layout_polygons(layout, a), ==, 5);
  assert_polygon(layout, a, 0, two, box, 4);
  assert_polygon(layout, a, 1, two, corner, 6);
  assert_polygon(layout, a, 2, two, kite, 4);
  assert_polygon(layout, a, 3, one, box, 4);
  assert_polygon(layout, a, 4, one, kite, 4);
  g_assert_cmpint(
      eda_layout_add_text(layout, a, two, (eda_point){1, 2}, "VDD", &e), ==, 0);
  eda_point at;
  int32_t layer;
  g_assert_cmpuint(eda_layout_texts(layout, a), ==, 1);
  g_assert_cmpstr(eda_layout_text(layout, a, 0, &at, &layer), ==, "VDD");
  g_assert_true(at.x == 1 && at.y == 2 && layer == two);
  eda_layout_free(layout);
}

static void test_instances(void) {
  opc_error e;
  eda_layout *layout = new_layout();
  int32_t a = eda_layout_cell(layout, "A", &e),
          b = eda_layout_cell(layout, "B", &e);
  eda_placement p = {{3, 4}, 2, 90, 1, 5, 6, {7, 8}, {9, 10}}, got;
  g_assert_cmpint(eda_layout_add_instance(layout, a, b, &p, "X1", &e), ==, 0);
  p.origin.x = -3;
  g_assert_cmpint(eda_layout_add_instance(layout, a, b, &p, NULL, &e), ==, 0);
  int32_t child;
  g_assert_cmpuint(eda_layout_instances(layout, a), ==, 2);
  g_assert_cmpstr(eda_layout_instance(layout, a, 0, &child, &got), ==, "X1");
  g_assert_cmpint(child, ==, b);
  g_assert_null(eda_layout_instance(layout, a, 1, &child, &got));
  g_assert_true(got.origin.x == -3 && got.origin.y == 4 && got.mirror == 1 &&
                got.magnification == 2 && got.angle == 90 && got.columns == 5 &&
                got.rows == 6 && got.column_step.y == 8 && got.row_step.x == 9);
  eda_layout_free(layout);
}

/* Cells with very many layers find their sheets by a hash table. */
static void test_many_layers(void) {
  opc_error e;
  eda_layout *layout = new_layout();
  int32_t a = eda_layout_cell(layout, "A", &e);
  for (int round = 0; round < 2; round++)
    for (int i = 0; i < 100; i++) {
      char name[16];
      g_snprintf(name, sizeof name, "%d", i);
      int32_t layer = eda_layout_layer(layout, name, &e);
      eda_box box = {i, round, 200, 200};
      g_assert_cmpint(eda_layout_add_box(layout, a, layer, box, &e), ==, 0);
    }
  g_assert_cmpuint(eda_layout_polygons(layout, a), ==, 200);
  for (int i = 0; i < 200; i++) {
    eda_point box[] = {{i / 2, i % 2}, {200, i % 2}, {200, 200}, {i / 2, 200}};
    assert_polygon(layout, a, (size_t)i, i / 2, box, 4);
  }
  eda_layout_free(layout);
}

static void test_refusals(void) {
  opc_error e;
  g_assert_null(eda_layout_new(0, &e));
  g_assert_null(eda_layout_new(NAN, &e));
  eda_layout *layout = new_layout();
  int32_t a = eda_layout_cell(layout, "A", &e),
          one = eda_layout_layer(layout, "1", &e);
  const eda_point two[2] = {{0, 0}, {1, 1}};
  eda_placement p = {.magnification = 0, .columns = 1, .rows = 1};
  g_assert_cmpint(eda_layout_add_polygon(layout, a, one, two, 2, &e), ==,
                  OPC_INVALID);
  g_assert_cmpint(eda_layout_add_box(layout, a, one, (eda_box){1, 0, 0, 1}, &e),
                  ==, OPC_INVALID);
  g_assert_cmpint(
      eda_layout_add_box(layout, a + 1, one, (eda_box){0, 0, 1, 1}, &e), ==,
      OPC_INVALID);
  g_assert_cmpint(eda_layout_add_box(layout, a, -1, (eda_box){0, 0, 1, 1}, &e),
                  ==, OPC_INVALID);
  g_assert_cmpint(eda_layout_add_instance(layout, a, a, &p, NULL, &e), ==,
                  OPC_INVALID);
  p.magnification = 1;
  p.rows = 0;
  g_assert_cmpint(eda_layout_add_instance(layout, a, a, &p, NULL, &e), ==,
                  OPC_INVALID);
  g_assert_cmpint(eda_layout_add_instance(layout, a, 7, &p, NULL, &e), ==,
                  OPC_INVALID);
  g_assert_cmpuint(eda_layout_polygons(layout, a), ==, 0);
  g_assert_cmpuint(eda_layout_instances(layout, a), ==, 0);
  eda_layout_free(layout);
}

static void test_top(void) {
  opc_error e;
  eda_layout *layout = new_layout();
  g_assert_cmpint(eda_layout_top(layout, &e), ==, -1);
  cell_place(layout, "TOP", "A");
  cell_place(layout, "A", "B");
  g_assert_cmpint(eda_layout_top(layout, &e), ==, 0);
  cell_place(layout, "OTHER", "B");
  g_assert_cmpint(eda_layout_top(layout, &e), ==, -1);
  g_assert_nonnull(strstr(e.message, "'TOP', 'OTHER'"));
  cell_place(layout, "TOP", "OTHER");
  g_assert_cmpint(eda_layout_top(layout, &e), ==, 0);
  cell_place(layout, "C", "D");
  cell_place(layout, "D", "C");
  g_assert_cmpint(eda_layout_top(layout, &e), ==, -1);
  g_assert_nonnull(strstr(e.message, "cycle: 'C', 'D'"));
  eda_layout_free(layout);
}

/* A message lists the top cells that fit, and the number of further cells. */
static void test_many_tops(void) {
  enum { MANY = 200 };
  opc_error e;
  eda_layout *layout = new_layout();
  for (int i = 0; i < MANY; i++) {
    g_autofree char *name = g_strdup_printf("cell%d", i);
    eda_layout_cell(layout, name, &e);
  }
  g_assert_cmpint(eda_layout_top(layout, &e), <, 0);
  g_assert_nonnull(strstr(e.message, "select one by 'top'"));
  int named = 0, more = 0;
  for (const char *at = e.message; (at = strstr(at, "'cell")); at++) named++;
  const char *rest = strstr(e.message, " and ");
  g_assert_nonnull(rest);
  g_assert_cmpint(sscanf(rest, " and %d more", &more), ==, 1);
  g_assert_cmpint(named, >, 1);
  g_assert_cmpint(named + more, ==, MANY);
  eda_layout_free(layout);
}

static void test_keep(void) {
  opc_error e;
  eda_layout *layout = new_layout();
  cell_place(layout, "X", "B");
  cell_place(layout, "TOP", "A");
  cell_place(layout, "A", "B");
  int32_t one = eda_layout_layer(layout, "1", &e),
          b = eda_layout_find_cell(layout, "B");
  g_assert_cmpint(eda_layout_add_box(layout, b, one, (eda_box){0, 0, 1, 1}, &e),
                  ==, 0);
  g_assert_cmpint(
      eda_layout_keep(layout, eda_layout_find_cell(layout, "A"), &e), ==, 0);
  g_assert_cmpuint(eda_layout_cells(layout), ==, 2);
  g_assert_cmpint(eda_layout_find_cell(layout, "TOP"), ==, -1);
  g_assert_cmpint(eda_layout_find_cell(layout, "B"), ==, 0);
  g_assert_cmpint(eda_layout_top(layout, &e), ==, 1);
  int32_t child;
  eda_placement p;
  eda_layout_instance(layout, 1, 0, &child, &p);
  g_assert_cmpint(child, ==, 0);
  g_assert_cmpuint(eda_layout_polygons(layout, 0), ==, 1);
  g_assert_cmpint(eda_layout_cell(layout, "TOP", &e), ==, 2);
  eda_layout_free(layout);
}

/* Boxes of every size keep their corners in each representation. */
static void test_box_sizes(void) {
  static const eda_box boxes[] = {
      {0, 0, 65535, 65535},
      {0, 0, 65536, 1},
      {5, 5, 6, 65541},
      {-7, -9, -7, -9},
      {INT32_MIN, 0, INT32_MAX, 1},
      {INT32_MAX - 65535, INT32_MIN, INT32_MAX, INT32_MIN + 65535},
  };
  enum { N = G_N_ELEMENTS(boxes) };
  opc_error e;
  eda_layout *layout = new_layout();
  int32_t cell = eda_layout_cell(layout, "A", &e),
          layer = eda_layout_layer(layout, "a", &e);
  for (size_t i = 0; i < N; i++)
    g_assert_cmpint(eda_layout_add_box(layout, cell, layer, boxes[i], &e), ==,
                    0);
  g_assert_cmpuint(eda_layout_polygons(layout, cell), ==, N);
  gboolean seen[N] = {FALSE};
  for (size_t i = 0; i < N; i++) {
    size_t n;
    const eda_point *p = eda_layout_polygon(layout, cell, i, &n, &layer);
    g_assert_cmpuint(n, ==, 4);
    for (size_t k = 0; k < N; k++)
      seen[k] |= p[0].x == boxes[k].x0 && p[0].y == boxes[k].y0 &&
                 p[2].x == boxes[k].x1 && p[2].y == boxes[k].y1 &&
                 p[1].x == p[2].x && p[3].y == p[2].y;
  }
  for (size_t k = 0; k < N; k++) g_assert_true(seen[k]);
  eda_layout_free(layout);
}

/* ---- copies into another layout ---- */

/* Return a layout: TOP places A twice, A places B in an array; X is separate.
   The layer `both` is derived. */
static eda_layout *import_source(void) {
  opc_error e;
  eda_layout *layout = new_layout();
  const eda_point kite[] = {{0, 0}, {5, 1}, {6, 6}, {1, 5}};
  int32_t x = eda_layout_cell(layout, "X", &e);
  cell_place(layout, "TOP", "A");
  int32_t top = eda_layout_cell(layout, "TOP", &e),
          a = eda_layout_cell(layout, "A", &e),
          b = eda_layout_cell(layout, "B", &e),
          poly = eda_layout_layer(layout, "poly", &e),
          notes = eda_layout_layer(layout, "notes", &e);
  eda_layout_set_file_layer(layout, notes, "9/3");
  g_assert_cmpint(eda_layout_derive(layout, "both", "poly & notes", &e), ==, 0);
  eda_placement p = {{3, 4}, 2, 90, 1, 5, 6, {7, 8}, {9, 10}};
  eda_layout_add_instance(layout, a, b, &p, "XB", &e);
  p.origin.x = 30;
  eda_layout_add_instance(layout, top, a, &p, NULL, &e);
  eda_layout_add_box(layout, b, poly, (eda_box){1, 2, 3, 4}, &e);
  eda_layout_add_polygon(layout, b, notes, kite, 4, &e);
  eda_layout_add_text(layout, b, notes, (eda_point){8, 9}, "ion=2", &e);
  eda_layout_add_box(layout, x, poly, (eda_box){0, 0, 9, 9}, &e);
  return layout;
}

static void assert_instance(const eda_layout *layout, int32_t cell, size_t i,
                            int32_t child, const char *name, int32_t x) {
  int32_t of;
  eda_placement p;
  g_assert_cmpstr(eda_layout_instance(layout, cell, i, &of, &p), ==, name);
  g_assert_cmpint(of, ==, child);
  g_assert_true(p.origin.x == x && p.origin.y == 4 && p.magnification == 2 &&
                p.angle == 90 && p.mirror == 1 && p.columns == 5 &&
                p.rows == 6 && p.column_step.x == 7 && p.row_step.y == 10);
}

/* Cells whose names exist get the first free number; layers are joined by name,
   and their names in the file do not change. */
static void test_import(void) {
  opc_error e;
  eda_layout *from = import_source(), *to = new_layout();
  int32_t other = eda_layout_cell(to, "A", &e),
          own = eda_layout_layer(to, "own", &e),
          poly = eda_layout_layer(to, "poly", &e);
  eda_layout_cell(to, "B", &e);
  eda_layout_cell(to, "B$2", &e);
  eda_layout_set_file_layer(to, poly, "66/20");
  eda_layout_set_file_layer(from, eda_layout_find_layer(from, "poly"), "7/0");
  int32_t top =
      eda_layout_import(to, from, eda_layout_find_cell(from, "TOP"), &e);
  g_assert_cmpint(top, >=, 0);
  g_assert_cmpuint(eda_layout_cells(to), ==, 6);
  g_assert_cmpint(eda_layout_find_cell(to, "X"), ==, -1);
  g_assert_cmpstr(eda_layout_cell_name(to, top), ==, "TOP");
  int32_t a = eda_layout_find_cell(to, "A$2"),
          b = eda_layout_find_cell(to, "B$3"),
          notes = eda_layout_find_layer(to, "notes");
  g_assert_cmpint(a, >, other);
  g_assert_cmpint(b, >, other);
  g_assert_cmpuint(eda_layout_instances(to, top), ==, 2);
  int32_t child;
  eda_placement p;
  g_assert_null(eda_layout_instance(to, top, 0, &child, &p));
  g_assert_cmpint(child, ==, a);
  assert_instance(to, top, 1, a, NULL, 30);
  assert_instance(to, a, 0, b, "XB", 3);
  g_assert_cmpuint(eda_layout_polygons(to, top), ==, 0);
  g_assert_cmpuint(eda_layout_polygons(to, b), ==, 2);
  const eda_point box[] = {{1, 2}, {3, 2}, {3, 4}, {1, 4}},
                  kite[] = {{0, 0}, {5, 1}, {6, 6}, {1, 5}};
  assert_polygon(to, b, 0, poly, box, 4);
  assert_polygon(to, b, 1, notes, kite, 4);
  g_assert_cmpint(notes, >, own);
  g_assert_cmpstr(eda_layout_file_layer(to, poly), ==, "66/20");
  g_assert_cmpstr(eda_layout_file_layer(to, notes), ==, "9/3");
  eda_point at;
  int32_t layer;
  g_assert_cmpuint(eda_layout_texts(to, b), ==, 1);
  g_assert_cmpstr(eda_layout_text(to, b, 0, &at, &layer), ==, "ion=2");
  g_assert_true(at.x == 8 && at.y == 9 && layer == notes);
  layer = eda_layout_find_layer(to, "both");
  g_assert_true(eda_layout_is_derived(to, layer));
  g_assert_false(eda_layout_is_derived(to, notes));
  /* A second copy has further names and the same layers. */
  size_t layers = eda_layout_layers(to);
  top = eda_layout_import(to, from, eda_layout_find_cell(from, "A"), &e);
  g_assert_cmpstr(eda_layout_cell_name(to, top), ==, "A$3");
  g_assert_cmpuint(eda_layout_layers(to), ==, layers);
  eda_layout_free(to);
  eda_layout_free(from);
}

/* A derived layer with another definition, or with shapes, is refused. */
static void test_import_refusals(void) {
  static const char *const own[] = {NULL, "poly & notes", "notes & poly", ""};
  opc_error e;
  eda_layout *from = import_source();
  for (size_t k = 0; k < G_N_ELEMENTS(own); k++) {
    eda_layout *to = new_layout();
    int32_t a = eda_layout_cell(to, "A", &e);
    eda_layout_layer(to, "poly", &e);
    eda_layout_layer(to, "notes", &e);
    int32_t both = eda_layout_layer(to, "both", &e);
    if (own[k] && *own[k])
      g_assert_cmpint(eda_layout_derive(to, "both", own[k], &e), ==, 0);
    else if (own[k])
      eda_layout_add_box(to, a, both, (eda_box){0, 0, 1, 1}, &e);
    int32_t top = eda_layout_import(to, from, 1, &e);
    if (k < 2) {
      g_assert_cmpint(top, ==, 1);
      g_assert_true(eda_layout_is_derived(to, both));
    } else {
      g_assert_cmpint(top, ==, -1);
      g_assert_cmpstr(e.message, ==,
                      "layer 'both' has different definitions in the layouts");
      g_assert_cmpuint(eda_layout_cells(to), ==, 1);
    }
    eda_layout_free(to);
  }
  eda_layout *to = eda_layout_new(0.5, &e);
  g_assert_cmpint(eda_layout_import(to, from, 1, &e), ==, -1);
  g_assert_cmpstr(e.message, ==,
                  "the layouts have units of 0.5 and 1 nm, expected equal "
                  "units");
  eda_layout_free(to);
  eda_layout_free(from);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/layout/names", test_names);
  g_test_add_func("/layout/shapes", test_shapes);
  g_test_add_func("/layout/box-sizes", test_box_sizes);
  g_test_add_func("/layout/instances", test_instances);
  g_test_add_func("/layout/many-layers", test_many_layers);
  g_test_add_func("/layout/refusals", test_refusals);
  g_test_add_func("/layout/top", test_top);
  g_test_add_func("/layout/many-tops", test_many_tops);
  g_test_add_func("/layout/keep", test_keep);
  g_test_add_func("/layout/import", test_import);
  g_test_add_func("/layout/import-refusals", test_import_refusals);
  return g_test_run();
}
