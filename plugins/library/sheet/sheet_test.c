/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests sheets of cells: each cell is placed once, as drawn, at least the gap
   apart. With neighbours, there are nine abutting copies.. */
#include "tests/library.h"

enum { GAP = 4000, STEP = 10000 }; /* nm; database units, see README.md */

/* Return the merged shapes below a cell on a layer. */
static eda_shapes drawn(const eda_layout *l, int32_t cell, const char *layer) {
  opc_error error;
  eda_flat flat;
  eda_shapes merged;
  if (eda_layout_flatten(l, cell, eda_layout_find_layer(l, layer), 1, &flat,
                         &error) ||
      eda_boolean(EDA_OR, &flat.shapes, NULL, &merged, &error))
    g_error("%s", error.message);
  eda_flat_clear(&flat);
  return merged;
}

static double area(const eda_layout *l, int32_t cell, const char *layer) {
  eda_shapes merged = drawn(l, cell, layer);
  double twice = (double)eda_area2(&merged);
  eda_shapes_clear(&merged);
  return twice / 2;
}

/* Return the bounding box of an instance. */
static eda_box bounds(const eda_layout *l, int32_t child,
                      const eda_placement *p) {
  opc_error error;
  eda_box all = {INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN};
  for (size_t k = 0; k < eda_layout_layers(l); k++) {
    eda_box b;
    g_assert_cmpint(eda_layout_bounds(l, child, (int32_t)k, 1, &b, &error), ==,
                    OPC_OK);
    all = (eda_box){MIN(all.x0, b.x0), MIN(all.y0, b.y0), MAX(all.x1, b.x1),
                    MAX(all.y1, b.y1)};
  }
  return (eda_box){all.x0 + p->origin.x, all.y0 + p->origin.y,
                   all.x1 + p->origin.x, all.y1 + p->origin.y};
}

/* Return a layout of twelve cells of different sizes and one without poly and
   active, which is skipped. */
static eda_layout *many_cells(void) {
  opc_error error;
  eda_layout *l = library_circuit();
  for (int i = 0; i < 10; i++) {
    g_autofree char *name = g_strdup_printf("more%d", i);
    add_transistor(l, name, 60 + 10 * i, 200 + 600 * (i % 4));
  }
  add_box(l, eda_layout_cell(l, "empty", &error), "outline",
          (eda_box){0, 0, 50, 50});
  /* Without the gap, less than 4 um would remain beside one cell and below
     another. */
  add_box(l, eda_layout_find_cell(l, "wide"), "outline",
          (eda_box){0, 0, 9500, 300});
  add_box(l, eda_layout_find_cell(l, "long"), "outline",
          (eda_box){0, 0, 300, 29000});
  return l;
}

static void test_cells(void) {
  opc_error error;
  eda_layout *l = many_cells();
  ran r = sheet_of(l, "{}");
  eda_layout *sheet = r.out;
  int32_t top = eda_layout_top(sheet, &error);
  size_t n = eda_layout_instances(sheet, top);
  g_assert_cmpuint(n, ==, 12);
  g_assert_cmpfloat(opc_test_metric("cells"), ==, 12);
  g_assert_true(eda_layout_unit(sheet) == eda_layout_unit(l));
  g_autofree eda_box *at = g_new(eda_box, n);
  int32_t right = 0, upper = 0;
  for (size_t i = 0; i < n; i++) {
    int32_t cell;
    eda_placement p;
    const char *name = eda_layout_instance(sheet, top, i, &cell, &p);
    int32_t from = eda_layout_find_cell(l, name);
    g_assert_cmpstr(eda_layout_cell_name(sheet, cell), ==, name);
    g_assert_cmpint(p.origin.x % STEP, ==, 0);
    g_assert_cmpint(p.origin.y % STEP, ==, 0);
    g_assert_false(p.mirror);
    static const char *const layers[] = {"poly", "active", "outline"};
    for (size_t k = 0; k < G_N_ELEMENTS(layers); k++)
      g_assert_cmpfloat(area(sheet, cell, layers[k]), ==,
                        area(l, from, layers[k]));
    at[i] = bounds(sheet, cell, &p);
    right = MAX(right, at[i].x1);
    upper = MAX(upper, at[i].y1);
    for (size_t k = 0; k < i; k++) {
      int32_t x = MAX(at[i].x0 - at[k].x1, at[k].x0 - at[i].x1);
      int32_t y = MAX(at[i].y0 - at[k].y1, at[k].y0 - at[i].y1);
      g_assert_cmpint(MAX(x, y), >=, GAP);
    }
  }
  g_assert_cmpint(right, <, 2 * upper); /* the cells are in several rows */
  g_assert_cmpint(upper, <, 2 * right);
  ran_clear(&r);
  eda_layout_free(l);
}

/* Cells selected by name, or below a cell. */
static void test_chosen(void) {
  static const struct {
    const char *map;
    double cells;
  } cases[] = {{"{ cells: 'more*' }", 10},
               {"{ cells: 'more? wide' }", 11},
               {"{ top: top }", 2},
               {"{ top: top, cells: 'l*' }", 1}};
  eda_layout *l = many_cells();
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    ran r = sheet_of(l, cases[i].map);
    g_assert_cmpfloat(opc_test_metric("cells"), ==, cases[i].cells);
    ran_clear(&r);
  }
  eda_layout_free(l);
}

/* The nine outlines have no gaps or overlaps. In the rows above and below, all
   shapes, including poly, are mirrored. */
static void test_neighbours(void) {
  opc_error error;
  eda_layout *l = library_circuit();
  ran r = sheet_of(l, "{ cells: wide, neighbours: itself }");
  eda_layout *sheet = r.out;
  int32_t top = eda_layout_top(sheet, &error);
  int32_t cell = eda_layout_find_cell(l, "wide");
  g_assert_cmpuint(eda_layout_instances(sheet, top), ==, 9);
  eda_shapes all = drawn(sheet, top, "outline");
  g_assert_cmpuint(all.count, ==, 1);
  g_assert_cmpfloat((double)eda_area2(&all) / 2, ==,
                    9 * area(l, cell, "outline"));
  eda_box b = eda_bounds(all.points, all.start[1]);
  eda_shapes poly = drawn(sheet, top, "poly");
  g_assert_cmpuint(poly.count, ==, 9);
  /* Expected distances of the poly from the lower end of the outline, for the
     three rows. The rows above and below the middle row are mirrored. */
  int32_t low[3] = {80 + 10, 850 + 80, 1700 + 80 + 10};
  for (size_t i = 0; i < 9; i++) {
    eda_box q = eda_bounds(poly.points + poly.start[i], 4);
    int found = 0;
    for (int k = 0; k < 3; k++) found += q.y0 - b.y0 == low[k];
    g_assert_cmpint(found, ==, 1);
    g_assert_cmpint((q.x0 - b.x0 - 250) % 600, ==, 0);
  }
  eda_shapes_clear(&poly);
  eda_shapes_clear(&all);
  ran_clear(&r);
  eda_layout_free(l);
}

static void test_refused(void) {
  static const struct {
    const char *map, *parameter, *message;
  } cases[] = {
      {"{ top: none }", "top", "cell 'none' does not exist"},
      {"{ cells: x* }", "cells", "no cell with a name of 'cells' draws"},
      {"{ neighbours: itself, boundary: none }", "boundary",
       "has no shape on layer 'none'"}};
  eda_layout *l = library_circuit();
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error;
    ran r;
    g_assert_cmpint(
        run_step(&r, "library.sheet", cases[i].map,
                 (const char *const[]){"layout", NULL}, (void *[]){l}, &error),
        ==, OPC_INVALID);
    g_assert_cmpstr(error.parameter, ==, cases[i].parameter);
    if (!strstr(error.message, cases[i].message)) g_error("%s", error.message);
    opc_test_module_free(r.module);
  }
  eda_layout_free(l);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/library.sheet/cells", test_cells);
  g_test_add_func("/library.sheet/chosen", test_chosen);
  g_test_add_func("/library.sheet/neighbours", test_neighbours);
  g_test_add_func("/library.sheet/refused", test_refused);
  return g_test_run();
}
