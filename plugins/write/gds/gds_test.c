/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests that written layouts are equal after reading. Also tests divided
   polygons, and masks with their layer numbers. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <eda/gates.h>
#include <eda/layout.h>

#include "tests/data.h"
#include "tools/devel/testing.h"

/* ---- there and back ---- */

/* Write `object` as the input named `kind`. Return the path of the file, or
   NULL and *error. */
static char *write_more(const char *kind, void *object, const char *parameters,
                        opc_error *error) {
  static int files;
  g_autofree char *name = g_strdup_printf("%d.gds", files++);
  g_autofree char *mapping =
      g_strdup_printf("{ file: %s%s }", name, parameters);
  g_autoptr(opc_module) module = opc_test_module("write.gds", mapping, error);
  if (!module) return NULL;
  if (object) opc_test_input(module, kind, object);
  void *none = NULL;
  if (opc_test_run(module, &none, error)) return NULL;
  return g_build_filename(opc_test_folder(), name, NULL);
}

static char *write_good(const char *kind, void *object,
                        const char *parameters) {
  opc_error e = {0};
  char *path = write_more(kind, object, parameters, &e);
  if (!path) g_error("%s", e.message);
  return path;
}

static eda_layout *read_good(const char *path, const char *parameters) {
  opc_error e = {0};
  g_autofree char *mapping =
      g_strdup_printf("{ file: '%s'%s }", path, parameters);
  g_autoptr(opc_module) module = opc_test_module("read.gds", mapping, &e);
  void *output = NULL;
  if (!module || opc_test_run(module, &output, &e)) g_error("%s", e.message);
  return output;
}

/* Return a layout as text. */
static char *layout_dump(const eda_layout *layout) {
  GString *s = g_string_new(NULL);
  g_string_append_printf(s, "%.17g\n", eda_layout_unit(layout));
  for (size_t c = 0; c < eda_layout_cells(layout); c++) {
    int32_t cell = (int32_t)c, layer, child;
    g_string_append_printf(s, "cell %s\n", eda_layout_cell_name(layout, cell));
    for (size_t i = 0; i < eda_layout_polygons(layout, cell); i++) {
      size_t n;
      const eda_point *p = eda_layout_polygon(layout, cell, i, &n, &layer);
      g_string_append(s, eda_layout_layer_name(layout, layer));
      for (size_t k = 0; k < n; k++)
        g_string_append_printf(s, " %d,%d", p[k].x, p[k].y);
      g_string_append(s, "\n");
    }
    for (size_t i = 0; i < eda_layout_texts(layout, cell); i++) {
      eda_point at;
      const char *text = eda_layout_text(layout, cell, i, &at, &layer);
      g_string_append_printf(s, "%s %d,%d '%s'\n",
                             eda_layout_layer_name(layout, layer), at.x, at.y,
                             text);
    }
    for (size_t i = 0; i < eda_layout_instances(layout, cell); i++) {
      eda_placement p;
      const char *name = eda_layout_instance(layout, cell, i, &child, &p);
      g_string_append_printf(
          s, "%s of %s %d,%d %.17g %.17g %u %ux%u %d,%d %d,%d\n",
          name ? name : "-", eda_layout_cell_name(layout, child), p.origin.x,
          p.origin.y, p.magnification, p.angle, p.mirror, p.columns, p.rows,
          p.column_step.x, p.column_step.y, p.row_step.x, p.row_step.y);
    }
  }
  return g_string_free(s, FALSE);
}

static eda_layout *new_layout(void) {
  opc_error e;
  return eda_layout_new(0.5, &e);
}

static void test_everything(void) {
  opc_error e;
  eda_layout *layout = new_layout();
  int32_t top = eda_layout_cell(layout, "TOP", &e),
          leaf = eda_layout_cell(layout, "LEAF", &e);
  int32_t poly = eda_layout_layer(layout, "9/0", &e);
  int32_t other = eda_layout_layer(layout, "65535/7", &e);
  eda_layout_layer(layout, "nothing here", &e);
  const eda_point kite[] = {{0, 0}, {50, 10}, {60, 60}, {10, 50}};
  eda_layout_add_box(layout, leaf, poly, (eda_box){-5, -6, 7, 8}, &e);
  eda_layout_add_polygon(layout, leaf, other, kite, 4, &e);
  eda_layout_add_text(layout, leaf, other, (eda_point){INT32_MAX, INT32_MIN},
                      "odd", &e);
  eda_layout_add_text(layout, leaf, poly, (eda_point){1, 1}, "even", &e);
  const eda_placement placements[] = {
      {{1, 2}, 1, 0, 0, 1, 1, {0, 0}, {0, 0}},
      {{-1, -2}, 1, 90, 0, 1, 1, {0, 0}, {0, 0}},
      {{3, 4}, 0.1, 33.25, 1, 1, 1, {0, 0}, {0, 0}},
      {{3, 4}, 1, 0, 1, 32767, 2, {5, -6}, {-7, 8}},
      {{3, 4}, 1, 270, 0, 3, 1, {5, 0}, {0, 0}},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(placements); i++)
    eda_layout_add_instance(layout, top, leaf, &placements[i],
                            i % 2 ? "XU1" : NULL, &e);
  g_autofree char *path = write_good("layout", layout, "");
  eda_layout *back = read_good(path, "");
  g_autofree char *want = layout_dump(layout), *got = layout_dump(back);
  g_assert_cmpstr(got, ==, want);
  eda_layout_free(back);
  eda_layout_free(layout);
}

static void test_corpus(void) {
  static const char *const files[] = {
      "gdstk_proof_lib.gds",    "klayout_arefs.gds",
      "klayout_t10.gds",        "klayout_t11.gds",
      "libgdsii_bend-flux.gds", "openram_freepdk45_cell_1rw.gds",
      "own_elements_a.gds",     "pythongdsii_test1.gds",
  };
  g_autofree char *folder = find_data("gds-corpus");
  if (!folder) return;
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++) {
    g_autofree char *path = g_build_filename(folder, files[i], NULL);
    eda_layout *layout = read_good(path, "");
    g_autofree char *first = write_good("layout", layout, "");
    eda_layout *back = read_good(first, "");
    g_autofree char *want = layout_dump(layout), *got = layout_dump(back);
    g_assert_cmpstr(got, ==, want);
    g_autofree char *second = write_good("layout", back, "");
    g_autofree char *bytes = NULL, *again = NULL;
    gsize n, m;
    g_assert_true(g_file_get_contents(first, &bytes, &n, NULL));
    g_assert_true(g_file_get_contents(second, &again, &m, NULL));
    g_assert_cmpmem(bytes, n, again, m);
    eda_layout_free(back);
    eda_layout_free(layout);
  }
}

static eda_flat flat(const eda_layout *layout, const char *layer) {
  opc_error e;
  eda_flat out;
  if (eda_layout_flatten(layout, eda_layout_top(layout, &e),
                         eda_layout_find_layer(layout, layer),
                         eda_layout_unit(layout), &out, &e))
    g_error("%s", e.message);
  return out;
}

/* Test an array that exceeds one record. */
static void test_large_array(void) {
  opc_error e;
  eda_layout *layout = new_layout();
  int32_t top = eda_layout_cell(layout, "TOP", &e),
          leaf = eda_layout_cell(layout, "LEAF", &e);
  eda_layout_add_box(layout, leaf, eda_layout_layer(layout, "9/0", &e),
                     (eda_box){0, 0, 1, 1}, &e);
  eda_placement p = {{7, 7}, 1, 0, 0, 70000, 3, {2, 0}, {1, 5}};
  eda_layout_add_instance(layout, top, leaf, &p, NULL, &e);
  g_autofree char *path = write_good("layout", layout, "");
  eda_layout *back = read_good(path, "");
  g_assert_cmpuint(
      eda_layout_instances(back, eda_layout_find_cell(back, "TOP")), ==, 3);
  eda_flat out = flat(back, "9/0");
  g_assert_cmpuint(out.shapes.count, ==, 210000);
  double sum = 0; /* sum of x of the lower left corners */
  for (size_t i = 0; i < out.shapes.count; i++)
    sum += out.shapes.points[4 * i].x;
  g_assert_cmpfloat(sum, ==, 210000 * (7 + 1 + 69999.0));
  eda_flat_clear(&out);
  eda_layout_free(back);
  eda_layout_free(layout);
}

static double area(const eda_shapes *s, size_t i) {
  double twice = 0;
  for (uint32_t k = s->start[i]; k < s->start[i + 1]; k++) {
    eda_point a = s->points[k];
    eda_point b = s->points[k + 1 < s->start[i + 1] ? k + 1 : s->start[i]];
    twice += (double)a.x * b.y - (double)b.x * a.y;
  }
  return twice / 2;
}

/* Return the area of a polygon as the sum of the written parts. */
static double written_area(const eda_point *points, size_t n, size_t *parts) {
  opc_error e;
  eda_layout *layout = new_layout();
  g_assert_cmpint(eda_layout_add_polygon(
                      layout, eda_layout_cell(layout, "TOP", &e),
                      eda_layout_layer(layout, "9/0", &e), points, n, &e),
                  ==, 0);
  g_autofree char *path = write_good("layout", layout, "");
  eda_layout *back = read_good(path, "");
  eda_flat out = flat(back, "9/0");
  double sum = 0;
  *parts = out.shapes.count;
  for (size_t i = 0; i < out.shapes.count; i++) {
    g_assert_cmpuint(out.shapes.start[i + 1] - out.shapes.start[i], <=, 8190);
    sum += area(&out.shapes, i);
  }
  eda_flat_clear(&out);
  eda_layout_free(back);
  eda_layout_free(layout);
  return sum;
}

static void test_large_polygons(void) {
  enum { TEETH = 20000 };
  eda_point *p = g_new(eda_point, 4 * TEETH + 3);
  size_t n = 0, parts;
  for (int i = 0; i < TEETH; i++) { /* a comb: 3 high, teeth of 10 */
    p[n++] = (eda_point){20 * i, 3};
    p[n++] = (eda_point){20 * i, 13};
    p[n++] = (eda_point){20 * i + 10, 13};
    p[n++] = (eda_point){20 * i + 10, 3};
  }
  p[n++] = (eda_point){20 * TEETH, 3};
  p[n++] = (eda_point){20 * TEETH, 0};
  p[n++] = (eda_point){0, 0};
  double sum = written_area(p, n, &parts);
  g_assert_cmpfloat(-sum, ==, 60.0 * TEETH + 100.0 * TEETH);
  g_assert_cmpuint(parts, >=, 10);
  g_assert_cmpuint(parts, <=, 20);
  for (size_t i = 0; i < n; i++) /* exchange x and y: cuts in the other
                                    direction */
    p[i] = (eda_point){p[i].y, p[i].x};
  sum = written_area(p, n, &parts);
  g_assert_cmpfloat(sum, ==, 60.0 * TEETH + 100.0 * TEETH);
  n = 0;
  for (int i = 0; i < TEETH; i++) { /* a star */
    double r = i % 2 ? 5e7 : 1e8, angle = 2 * G_PI * i / TEETH;
    p[n++] = (eda_point){(int32_t)(r * cos(angle)), (int32_t)(r * sin(angle))};
  }
  sum = written_area(p, n, &parts);
  double want = TEETH * 0.5 * 5e7 * 1e8 * sin(2 * G_PI / TEETH);
  g_assert_cmpfloat_with_epsilon(sum / want, 1, 1e-6);
  g_assert_cmpuint(parts, >=, 3);
  n = 0;
  for (int i = 0; i < TEETH / 4; i++) /* repeatedly around the smallest
                                         square */
    for (int k = 0; k < 4; k++) p[n++] = (eda_point){k == 1 || k == 2, k >= 2};
  opc_error e;
  eda_layout *layout = new_layout();
  eda_layout_add_polygon(layout, eda_layout_cell(layout, "TOP", &e),
                         eda_layout_layer(layout, "9/0", &e), p, n, &e);
  g_assert_null(write_more("layout", layout, "", &e));
  g_assert_nonnull(strstr(e.message, "cannot be divided"));
  eda_layout_free(layout);
  g_free(p);
}

/* ---- masks ---- */

static eda_shapes boxes(const eda_box *list, size_t n) {
  eda_shapes s = {.count = n};
  s.start = g_new0(uint32_t, n + 1);
  s.points = g_new0(eda_point, 4 * n);
  for (size_t i = 0; i < n; i++) {
    eda_box b = list[i];
    eda_point *p = s.points + 4 * i;
    p[0] = (eda_point){b.x0, b.y0};
    p[1] = (eda_point){b.x1, b.y0};
    p[2] = (eda_point){b.x1, b.y1};
    p[3] = (eda_point){b.x0, b.y1};
    s.start[i + 1] = (uint32_t)(4 * i + 4);
  }
  return s;
}

static eda_shapes shapes_combine(int op, const eda_shapes *a,
                                 const eda_shapes *b) {
  opc_error e;
  eda_shapes out;
  if (eda_boolean(op, a, b, &out, &e)) g_error("%s", e.message);
  return out;
}

/* Return nested rings, holes that touch, and polygons without holes. */
static eda_shapes holed(void) {
  GRand *rand = g_rand_new_with_seed(6);
  const eda_box solid[] = {
      {0, 0, 1000, 1000}, {2000, 0, 2100, 300}, {2100, 100, 2400, 200}};
  eda_box cut[80];
  size_t n = 0;
  cut[n++] = (eda_box){100, 100, 900, 900};
  for (int i = 0; i < 60; i++) {
    int x = 10 * g_rand_int_range(rand, 0, 9),
        y = 10 * g_rand_int_range(rand, 0, 99);
    cut[n++] = (eda_box){x, y, x + 10, y + 10};
  }
  const eda_box island[] = {{300, 300, 700, 700}};
  const eda_box hole[] = {{400, 400, 600, 600}};
  eda_shapes a = boxes(solid, G_N_ELEMENTS(solid)), b = boxes(cut, n);
  eda_shapes c = boxes(island, 1), d = boxes(hole, 1);
  eda_shapes ab = shapes_combine(EDA_NOT, &a, &b),
             abc = shapes_combine(EDA_OR, &ab, &c);
  eda_shapes out = shapes_combine(EDA_NOT, &abc, &d);
  eda_shapes_clear(&ab);
  eda_shapes_clear(&abc);
  eda_shapes_clear(&a);
  eda_shapes_clear(&b);
  eda_shapes_clear(&c);
  eda_shapes_clear(&d);
  g_rand_free(rand);
  return out;
}

static void assert_layer(const eda_layout *layout, const char *layer,
                         const eda_shapes *want) {
  eda_flat out = flat(layout, layer);
  eda_shapes wrong = shapes_combine(EDA_XOR, &out.shapes, want);
  g_assert_cmpuint(wrong.count, ==, 0);
  eda_shapes_clear(&wrong);
  eda_flat_clear(&out);
}

static void free_mask(eda_mask *mask) {
  eda_gates_free((eda_gates *)mask->gates);
  eda_mask_free(mask);
}

/* Return a mask of poly with holes and small boxes on other layers. */
static eda_mask *mask_of(const char *const *names, size_t layers) {
  static const eda_box small[] = {{0, 0, 7, 9}};
  eda_gates *g = eda_gates_new(layers, 0);
  eda_mask *mask = eda_mask_new(g);
  g->name = eda_gates_text(g, "chip");
  g->grid = 0.25;
  for (size_t k = 0; k < layers; k++) {
    g->layer[k] = eda_gates_text(g, names[k]);
    g->corrected[k] = strcmp(names[k], "contact") != 0;
    g->drawn[k] = boxes(small, 1);
    if (g->corrected[k]) mask->shapes[k] = k ? boxes(small, 1) : holed();
  }
  return mask;
}

static void test_mask(void) {
  static const char *const names[] = {"poly", "active", "contact"};
  eda_mask *mask = mask_of(names, 3);
  const eda_shapes *poly = &mask->shapes[EDA_POLY];
  const eda_shapes *box = &mask->shapes[EDA_ACTIVE];
  size_t holes = 0;
  for (size_t i = 0; i < poly->count; i++) holes += poly->hole[i];
  g_assert_cmpuint(holes, >, 10);
  g_autofree char *path =
      write_good("mask", mask, ", layers: { active: 77/3 }");
  eda_layout *back = read_good(path, "");
  opc_error e;
  g_assert_cmpfloat(eda_layout_unit(back), ==, 0.25);
  g_assert_cmpstr(eda_layout_cell_name(back, eda_layout_top(back, &e)), ==,
                  "chip");
  g_assert_cmpuint(eda_layout_layers(back), ==, 5);
  assert_layer(back, "9/0", poly);
  assert_layer(back, "77/3", box);
  assert_layer(back, "10/0", box);
  assert_layer(back, "109/0", box);
  assert_layer(back, "101/0", box);
  eda_layout_free(back);
  g_assert_null(write_more("mask", mask, ", layers: { gate: 1/0 }", &e));
  g_assert_cmpstr(e.message, ==,
                  "'gate': a mask has the layers poly, active, contact, "
                  "poly_drawn and active_drawn");
  free_mask(mask);
}

/* Test numbers of further layers: from 11 on, or as set by the flow; all
   numbers differ. Contacts may be named even if none are drawn. */
static void test_more_layers(void) {
  static const char *const names[] = {"poly", "active", "metal1", "metal2"};
  eda_mask *mask = mask_of(names, 4);
  const eda_shapes *box = &mask->shapes[EDA_ACTIVE];
  g_autofree char *path =
      write_good("mask", mask, ", layers: { metal2: 30/2, contact: 11/0 }");
  eda_layout *back = read_good(path, "");
  static const char *const files[] = {"1/0",   "11/0",  "30/2",
                                      "101/0", "111/0", "112/0"};
  g_assert_cmpuint(eda_layout_layers(back), ==, 8);
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++)
    assert_layer(back, files[i], box);
  eda_layout_free(back);
  opc_error e;
  g_assert_null(write_more("mask", mask, ", layers: { metal1: 9/0 }", &e));
  g_assert_cmpstr(e.message, ==,
                  "'poly' and 'metal1' would both be layer 9/0; set "
                  "different ones, as in { metal1: 9/0 }");
  g_assert_null(
      write_more("mask", mask, ", layers: { metal2_drawn: 0011/00 }", &e));
  g_assert_nonnull(strstr(e.message, "'metal1' and 'metal2_drawn' would both"));
  free_mask(mask);
}

/* ---- refusals ---- */

static void test_layers(void) {
  opc_error e;
  eda_layout *layout = new_layout();
  int32_t top = eda_layout_cell(layout, "TOP", &e);
  eda_layout_add_box(layout, top, eda_layout_layer(layout, "poly", &e),
                     (eda_box){0, 0, 1, 1}, &e);
  g_assert_null(write_more("layout", layout, "", &e));
  g_assert_nonnull(strstr(e.message, "'poly': the layer has no number"));
  g_assert_null(write_more("layout", layout, ", layers: { pluy: 9/0 }", &e));
  g_assert_nonnull(strstr(e.message, "'pluy': the layout has no such layer"));
  g_assert_null(write_more("layout", layout, ", layers: { poly: 9 }", &e));
  g_assert_nonnull(strstr(e.message, "'9': invalid layer (example: 9/0)"));
  g_assert_null(write_more("layout", NULL, "", &e));
  g_assert_nonnull(strstr(e.message, "either 'layout' or 'mask'"));
  g_autofree char *path =
      write_good("layout", layout, ", layers: { poly: 9/1 }");
  eda_layout *back = read_good(path, "");
  g_assert_cmpstr(eda_layout_layer_name(back, 0), ==, "9/1");
  eda_layout_free(back);
  g_autofree char *longer = g_strnfill(70000, 'x');
  eda_layout_add_text(layout, top, 0, (eda_point){0, 0}, longer, &e);
  g_assert_null(write_more("layout", layout, ", layers: { poly: 9/1 }", &e));
  g_assert_nonnull(strstr(e.message, "too long"));
  eda_layout_free(layout);
}

/* Named layers keep the numbers of the file from which they were read. */
static void test_numbers(void) {
  static const char map[] =
      ", layers: { poly: 9/0, active: 1, contact: 10/0, nwell: 3/0 }";
  opc_error e = {0};
  g_autofree char *file = g_build_filename(g_getenv("OPCFLOW_SOURCE"), "data",
                                           "cells65", "sram4.gds", NULL);
  eda_layout *named = read_good(file, map), *plain = read_good(file, "");
  g_assert_cmpstr(
      eda_layout_file_layer(named, eda_layout_find_layer(named, "active")), ==,
      "1/0");
  g_autofree char *path = write_good("layout", named, "");
  eda_layout *back = read_good(path, "");
  g_autofree char *before = layout_dump(plain), *after = layout_dump(back);
  g_assert_cmpstr(before, ==, after);
  g_assert_null(write_more("layout", named, ", layers: { poly: 1/0 }", &e));
  g_assert_nonnull(strstr(e.message, "'active' and 'poly' would both be"));
  g_autofree char *moved =
      write_good("layout", named, ", layers: { poly: 7/3 }");
  eda_layout *other = read_good(moved, "");
  g_assert_cmpint(eda_layout_find_layer(other, "7/3"), >=, 0);
  g_assert_cmpint(eda_layout_find_layer(other, "9/0"), ==, -1);
  eda_layout_free(named);
  eda_layout_free(plain);
  eda_layout_free(back);
  eda_layout_free(other);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/write-gds/everything", test_everything);
  g_test_add_func("/write-gds/corpus", test_corpus);
  g_test_add_func("/write-gds/large-array", test_large_array);
  g_test_add_func("/write-gds/large-polygons", test_large_polygons);
  g_test_add_func("/write-gds/mask", test_mask);
  g_test_add_func("/write-gds/more-layers", test_more_layers);
  g_test_add_func("/write-gds/layers", test_layers);
  g_test_add_func("/write-gds/numbers", test_numbers);
  return g_test_run();
}
