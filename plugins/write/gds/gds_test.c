/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/plugin/host.h"
#include "core/plugin/testing.h"

static const opc_layout_service *l = &opc_layout_functions;

/* ---- there and back ---- */

/* Write `object` as the input `kind`: the path of the file, NULL and *error
   if it is refused. */
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

static opc_layout *read_good(const char *path, const char *parameters) {
  opc_error e = {0};
  g_autofree char *mapping =
      g_strdup_printf("{ file: '%s'%s }", path, parameters);
  g_autoptr(opc_module) module = opc_test_module("read.gds", mapping, &e);
  void *output = NULL;
  if (!module || opc_test_run(module, &output, &e)) g_error("%s", e.message);
  return output;
}

/* All of a layout as text. */
static char *dump(const opc_layout *layout) {
  GString *s = g_string_new(NULL);
  g_string_append_printf(s, "%.17g\n", l->unit(layout));
  for (size_t c = 0; c < l->cells(layout); c++) {
    int32_t cell = (int32_t)c, layer, child;
    g_string_append_printf(s, "cell %s\n", l->cell_name(layout, cell));
    for (size_t i = 0; i < l->polygons(layout, cell); i++) {
      size_t n;
      const opc_point *p = l->polygon(layout, cell, i, &n, &layer);
      g_string_append(s, l->layer_name(layout, layer));
      for (size_t k = 0; k < n; k++)
        g_string_append_printf(s, " %d,%d", p[k].x, p[k].y);
      g_string_append(s, "\n");
    }
    for (size_t i = 0; i < l->texts(layout, cell); i++) {
      opc_point at;
      const char *text = l->text(layout, cell, i, &at, &layer);
      g_string_append_printf(s, "%s %d,%d '%s'\n", l->layer_name(layout, layer),
                             at.x, at.y, text);
    }
    for (size_t i = 0; i < l->instances(layout, cell); i++) {
      opc_placement p;
      const char *name = l->instance(layout, cell, i, &child, &p);
      g_string_append_printf(
          s, "%s of %s %d,%d %.17g %.17g %u %ux%u %d,%d %d,%d\n",
          name ? name : "-", l->cell_name(layout, child), p.origin.x,
          p.origin.y, p.magnification, p.angle, p.mirror, p.columns, p.rows,
          p.column_step.x, p.column_step.y, p.row_step.x, p.row_step.y);
    }
  }
  return g_string_free(s, FALSE);
}

static opc_layout *new_layout(void) {
  opc_error e;
  return l->create(opc_test_host(), 0.5, &e);
}

static void test_everything(void) {
  opc_error e;
  opc_layout *layout = new_layout();
  int32_t top = l->cell(layout, "TOP", &e), leaf = l->cell(layout, "LEAF", &e);
  int32_t poly = l->layer(layout, "9/0", &e);
  int32_t other = l->layer(layout, "65535/7", &e);
  l->layer(layout, "nothing here", &e);
  const opc_point kite[] = {{0, 0}, {50, 10}, {60, 60}, {10, 50}};
  l->add_box(layout, leaf, poly, (opc_box){-5, -6, 7, 8}, &e);
  l->add_polygon(layout, leaf, other, kite, 4, &e);
  l->add_text(layout, leaf, other, (opc_point){INT32_MAX, INT32_MIN}, "odd",
              &e);
  l->add_text(layout, leaf, poly, (opc_point){1, 1}, "even", &e);
  const opc_placement placements[] = {
      {{1, 2}, 1, 0, 0, 1, 1, {0, 0}, {0, 0}},
      {{-1, -2}, 1, 90, 0, 1, 1, {0, 0}, {0, 0}},
      {{3, 4}, 0.1, 33.25, 1, 1, 1, {0, 0}, {0, 0}},
      {{3, 4}, 1, 0, 1, 32767, 2, {5, -6}, {-7, 8}},
      {{3, 4}, 1, 270, 0, 3, 1, {5, 0}, {0, 0}},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(placements); i++)
    l->add_instance(layout, top, leaf, &placements[i], i % 2 ? "XU1" : NULL,
                    &e);
  g_autofree char *path = write_good("layout", layout, "");
  opc_layout *back = read_good(path, "");
  g_autofree char *want = dump(layout), *got = dump(back);
  g_assert_cmpstr(got, ==, want);
  l->destroy(back);
  l->destroy(layout);
}

static void test_corpus(void) {
  static const char *const files[] = {
      "gdstk_proof_lib.gds",    "klayout_arefs.gds",
      "klayout_t10.gds",        "klayout_t11.gds",
      "libgdsii_bend-flux.gds", "openram_freepdk45_cell_1rw.gds",
      "own_elements_a.gds",     "pythongdsii_test1.gds",
  };
  const char *data = g_getenv("OPCFLOW_TEST_DATA");
  g_autofree char *folder =
      data ? g_strdup(data)
           : g_build_filename(g_getenv("OPCFLOW_SOURCE"), "..", "shared",
                              "data", NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++) {
    g_autofree char *path =
        g_build_filename(folder, "gds-corpus", files[i], NULL);
    if (!g_file_test(path, G_FILE_TEST_EXISTS)) {
      g_test_skip("no test data");
      return;
    }
    opc_layout *layout = read_good(path, "");
    g_autofree char *first = write_good("layout", layout, "");
    opc_layout *back = read_good(first, "");
    g_autofree char *want = dump(layout), *got = dump(back);
    g_assert_cmpstr(got, ==, want);
    g_autofree char *second = write_good("layout", back, "");
    g_autofree char *bytes = NULL, *again = NULL;
    gsize n, m;
    g_assert_true(g_file_get_contents(first, &bytes, &n, NULL));
    g_assert_true(g_file_get_contents(second, &again, &m, NULL));
    g_assert_cmpmem(bytes, n, again, m);
    l->destroy(back);
    l->destroy(layout);
  }
}

static opc_flat flat(const opc_layout *layout, const char *layer) {
  opc_error e;
  opc_flat out;
  if (l->flatten(opc_test_host(), layout, l->top(layout, &e),
                 l->find_layer(layout, layer), l->unit(layout), &out, &e))
    g_error("%s", e.message);
  return out;
}

/* An array that one record cannot hold. */
static void test_large_array(void) {
  opc_error e;
  opc_layout *layout = new_layout();
  int32_t top = l->cell(layout, "TOP", &e), leaf = l->cell(layout, "LEAF", &e);
  l->add_box(layout, leaf, l->layer(layout, "9/0", &e), (opc_box){0, 0, 1, 1},
             &e);
  opc_placement p = {{7, 7}, 1, 0, 0, 70000, 3, {2, 0}, {1, 5}};
  l->add_instance(layout, top, leaf, &p, NULL, &e);
  g_autofree char *path = write_good("layout", layout, "");
  opc_layout *back = read_good(path, "");
  g_assert_cmpuint(l->instances(back, l->find_cell(back, "TOP")), ==, 3);
  opc_flat out = flat(back, "9/0");
  g_assert_cmpuint(out.shapes.count, ==, 210000);
  double sum = 0; /* of the lower left corners' x */
  for (size_t i = 0; i < out.shapes.count; i++)
    sum += out.shapes.points[4 * i].x;
  g_assert_cmpfloat(sum, ==, 210000 * (7 + 1 + 69999.0));
  l->release(&out);
  l->destroy(back);
  l->destroy(layout);
}

static double area(const opc_shapes *s, size_t i) {
  double twice = 0;
  for (uint32_t k = s->start[i]; k < s->start[i + 1]; k++) {
    opc_point a = s->points[k];
    opc_point b = s->points[k + 1 < s->start[i + 1] ? k + 1 : s->start[i]];
    twice += (double)a.x * b.y - (double)b.x * a.y;
  }
  return twice / 2;
}

/* The polygon's area, as the sum of the parts that were written. */
static double written_area(const opc_point *points, size_t n, size_t *parts) {
  opc_error e;
  opc_layout *layout = new_layout();
  g_assert_cmpint(l->add_polygon(layout, l->cell(layout, "TOP", &e),
                                 l->layer(layout, "9/0", &e), points, n, &e),
                  ==, 0);
  g_autofree char *path = write_good("layout", layout, "");
  opc_layout *back = read_good(path, "");
  opc_flat out = flat(back, "9/0");
  double sum = 0;
  *parts = out.shapes.count;
  for (size_t i = 0; i < out.shapes.count; i++) {
    g_assert_cmpuint(out.shapes.start[i + 1] - out.shapes.start[i], <=, 8190);
    sum += area(&out.shapes, i);
  }
  l->release(&out);
  l->destroy(back);
  l->destroy(layout);
  return sum;
}

static void test_large_polygons(void) {
  enum { TEETH = 20000 };
  opc_point *p = g_new(opc_point, 4 * TEETH + 3);
  size_t n = 0, parts;
  for (int i = 0; i < TEETH; i++) { /* a comb: 3 high, teeth of 10 */
    p[n++] = (opc_point){20 * i, 3};
    p[n++] = (opc_point){20 * i, 13};
    p[n++] = (opc_point){20 * i + 10, 13};
    p[n++] = (opc_point){20 * i + 10, 3};
  }
  p[n++] = (opc_point){20 * TEETH, 3};
  p[n++] = (opc_point){20 * TEETH, 0};
  p[n++] = (opc_point){0, 0};
  double sum = written_area(p, n, &parts);
  g_assert_cmpfloat(-sum, ==, 60.0 * TEETH + 100.0 * TEETH);
  g_assert_cmpuint(parts, >=, 10);
  g_assert_cmpuint(parts, <=, 20);
  for (size_t i = 0; i < n; i++) /* it lies on its side: cut the other way */
    p[i] = (opc_point){p[i].y, p[i].x};
  sum = written_area(p, n, &parts);
  g_assert_cmpfloat(sum, ==, 60.0 * TEETH + 100.0 * TEETH);
  n = 0;
  for (int i = 0; i < TEETH; i++) { /* a star */
    double r = i % 2 ? 5e7 : 1e8, angle = 2 * G_PI * i / TEETH;
    p[n++] = (opc_point){(int32_t)(r * cos(angle)), (int32_t)(r * sin(angle))};
  }
  sum = written_area(p, n, &parts);
  double want = TEETH * 0.5 * 5e7 * 1e8 * sin(2 * G_PI / TEETH);
  g_assert_cmpfloat_with_epsilon(sum / want, 1, 1e-6);
  g_assert_cmpuint(parts, >=, 3);
  n = 0;
  for (int i = 0; i < TEETH / 4; i++) /* round and round the smallest square */
    for (int k = 0; k < 4; k++) p[n++] = (opc_point){k == 1 || k == 2, k >= 2};
  opc_error e;
  opc_layout *layout = new_layout();
  l->add_polygon(layout, l->cell(layout, "TOP", &e),
                 l->layer(layout, "9/0", &e), p, n, &e);
  g_assert_null(write_more("layout", layout, "", &e));
  g_assert_nonnull(strstr(e.message, "cannot be cut"));
  l->destroy(layout);
  g_free(p);
}

/* ---- masks ---- */

static opc_shapes boxes(const opc_box *list, size_t n) {
  opc_shapes s = {.count = n};
  s.start = g_new0(uint32_t, n + 1);
  s.points = g_new0(opc_point, 4 * n);
  for (size_t i = 0; i < n; i++) {
    opc_box b = list[i];
    opc_point *p = s.points + 4 * i;
    p[0] = (opc_point){b.x0, b.y0};
    p[1] = (opc_point){b.x1, b.y0};
    p[2] = (opc_point){b.x1, b.y1};
    p[3] = (opc_point){b.x0, b.y1};
    s.start[i + 1] = (uint32_t)(4 * i + 4);
  }
  return s;
}

static opc_shapes combine(int op, const opc_shapes *a, const opc_shapes *b) {
  opc_error e;
  opc_shapes out;
  const opc_host *host = opc_test_host();
  if (host->geometry->boolean(host, op, a, b, &out, &e))
    g_error("%s", e.message);
  return out;
}

static void free_boxes(opc_shapes *s) {
  g_free(s->start);
  g_free(s->points);
}

/* Rings in rings, holes that touch, and polygons without any. */
static opc_shapes holed(void) {
  GRand *rand = g_rand_new_with_seed(6);
  const opc_box solid[] = {
      {0, 0, 1000, 1000}, {2000, 0, 2100, 300}, {2100, 100, 2400, 200}};
  opc_box cut[80];
  size_t n = 0;
  cut[n++] = (opc_box){100, 100, 900, 900};
  for (int i = 0; i < 60; i++) {
    int x = 10 * g_rand_int_range(rand, 0, 9),
        y = 10 * g_rand_int_range(rand, 0, 99);
    cut[n++] = (opc_box){x, y, x + 10, y + 10};
  }
  const opc_box island[] = {{300, 300, 700, 700}};
  const opc_box hole[] = {{400, 400, 600, 600}};
  opc_shapes a = boxes(solid, G_N_ELEMENTS(solid)), b = boxes(cut, n);
  opc_shapes c = boxes(island, 1), d = boxes(hole, 1);
  opc_shapes ab = combine(OPC_NOT, &a, &b), abc = combine(OPC_OR, &ab, &c);
  opc_shapes out = combine(OPC_NOT, &abc, &d);
  const opc_host *host = opc_test_host();
  host->geometry->release(&ab);
  host->geometry->release(&abc);
  free_boxes(&a);
  free_boxes(&b);
  free_boxes(&c);
  free_boxes(&d);
  g_rand_free(rand);
  return out;
}

static void assert_layer(const opc_layout *layout, const char *layer,
                         const opc_shapes *want) {
  opc_flat out = flat(layout, layer);
  opc_shapes wrong = combine(OPC_XOR, &out.shapes, want);
  g_assert_cmpuint(wrong.count, ==, 0);
  opc_test_host()->geometry->release(&wrong);
  l->release(&out);
}

static void test_mask(void) {
  const opc_box small[] = {{0, 0, 7, 9}};
  const opc_host *host = opc_test_host();
  opc_gates gates = {.size = sizeof gates, .name = "chip", .grid = 0.25};
  opc_mask mask = {.size = sizeof mask, .gates = &gates};
  opc_shapes box = boxes(small, 1);
  mask.shapes[OPC_POLY] = holed();
  mask.shapes[OPC_ACTIVE] = box;
  gates.drawn[OPC_CONTACT] = box;
  gates.drawn[OPC_POLY] = box;
  gates.drawn[OPC_ACTIVE] = box;
  size_t holes = 0;
  for (size_t i = 0; i < mask.shapes[OPC_POLY].count; i++)
    holes += mask.shapes[OPC_POLY].hole[i];
  g_assert_cmpuint(holes, >, 10);
  g_autofree char *path =
      write_good("mask", &mask, ", layers: { active: 77/3 }");
  opc_layout *back = read_good(path, "");
  opc_error e;
  g_assert_cmpfloat(l->unit(back), ==, 0.25);
  g_assert_cmpstr(l->cell_name(back, l->top(back, &e)), ==, "chip");
  g_assert_cmpuint(l->layers(back), ==, 5);
  assert_layer(back, "9/0", &mask.shapes[OPC_POLY]);
  assert_layer(back, "77/3", &box);
  assert_layer(back, "10/0", &box);
  assert_layer(back, "109/0", &box);
  assert_layer(back, "101/0", &box);
  l->destroy(back);
  g_assert_null(write_more("mask", &mask, ", layers: { gate: 1/0 }", &e));
  g_assert_nonnull(strstr(e.message, "a mask has the layers poly"));
  host->geometry->release(&mask.shapes[OPC_POLY]);
  free_boxes(&box);
}

/* ---- refusals ---- */

static void test_layers(void) {
  opc_error e;
  opc_layout *layout = new_layout();
  int32_t top = l->cell(layout, "TOP", &e);
  l->add_box(layout, top, l->layer(layout, "poly", &e), (opc_box){0, 0, 1, 1},
             &e);
  g_assert_null(write_more("layout", layout, "", &e));
  g_assert_nonnull(strstr(e.message, "'poly': the layer has no number"));
  g_assert_null(write_more("layout", layout, ", layers: { pluy: 9/0 }", &e));
  g_assert_nonnull(strstr(e.message, "'pluy': the layout has no such layer"));
  g_assert_null(write_more("layout", layout, ", layers: { poly: 9 }", &e));
  g_assert_nonnull(strstr(e.message, "'9': a layer is written 9/0"));
  g_assert_null(write_more("layout", NULL, "", &e));
  g_assert_nonnull(strstr(e.message, "either a layout or a mask"));
  g_autofree char *path =
      write_good("layout", layout, ", layers: { poly: 9/1 }");
  opc_layout *back = read_good(path, "");
  g_assert_cmpstr(l->layer_name(back, 0), ==, "9/1");
  l->destroy(back);
  g_autofree char *longer = g_strnfill(70000, 'x');
  l->add_text(layout, top, 0, (opc_point){0, 0}, longer, &e);
  g_assert_null(write_more("layout", layout, ", layers: { poly: 9/1 }", &e));
  g_assert_nonnull(strstr(e.message, "too long"));
  l->destroy(layout);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/write-gds/everything", test_everything);
  g_test_add_func("/write-gds/corpus", test_corpus);
  g_test_add_func("/write-gds/large-array", test_large_array);
  g_test_add_func("/write-gds/large-polygons", test_large_polygons);
  g_test_add_func("/write-gds/mask", test_mask);
  g_test_add_func("/write-gds/layers", test_layers);
  return g_test_run();
}
