/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests that written layouts are equal after reading. Also tests the checksum
   and the tables of the file. */
#include <string.h>
#include <zlib.h>

#include <eda/layout.h>
#include <eda/oasis.h>

#include "tools/devel/testing.h"

static char *write_more(const char *kind, void *object, const char *more,
                        opc_error *error) {
  static int files;
  g_autofree char *name = g_strdup_printf("%d.oas", files++);
  g_autofree char *mapping = g_strdup_printf("{ file: %s%s }", name, more);
  g_autoptr(opc_module) module = opc_test_module("write.oasis", mapping, error);
  if (!module) return NULL;
  opc_test_input(module, kind, object);
  void *none = NULL;
  if (opc_test_run(module, &none, error)) return NULL;
  return g_build_filename(opc_test_folder(), name, NULL);
}

static char *write_good(const char *kind, void *object) {
  opc_error e = {0};
  char *path = write_more(kind, object, "", &e);
  if (!path) g_error("%s", e.message);
  return path;
}

static eda_layout *read_good(const char *path) {
  opc_error e = {0};
  g_autofree char *mapping = g_strdup_printf("{ file: '%s' }", path);
  g_autoptr(opc_module) module = opc_test_module("read.oasis", mapping, &e);
  void *output = NULL;
  if (!module || opc_test_run(module, &output, &e)) g_error("%s", e.message);
  return output;
}

static eda_layout *new_layout(double unit) {
  opc_error e;
  return eda_layout_new(unit, &e);
}

/* ---- placements, names, units ---- */

static char *layout_dump(const eda_layout *layout, const char *cell) {
  GString *s = g_string_new(NULL);
  int32_t number = eda_layout_find_cell(layout, cell), child, layer;
  g_string_append_printf(s, "%.17g\n", eda_layout_unit(layout));
  for (size_t i = 0; i < eda_layout_texts(layout, number); i++) {
    eda_point at;
    const char *text = eda_layout_text(layout, number, i, &at, &layer);
    g_string_append_printf(s, "%s %d,%d '%s'\n",
                           eda_layout_layer_name(layout, layer), at.x, at.y,
                           text);
  }
  for (size_t i = 0; i < eda_layout_instances(layout, number); i++) {
    eda_placement p;
    const char *name = eda_layout_instance(layout, number, i, &child, &p);
    g_string_append_printf(
        s, "%s of %s %d,%d %.17g %.17g %u %ux%u %d,%d %d,%d\n",
        name ? name : "-", eda_layout_cell_name(layout, child), p.origin.x,
        p.origin.y, p.magnification, p.angle, p.mirror, p.columns, p.rows,
        p.column_step.x, p.column_step.y, p.row_step.x, p.row_step.y);
  }
  return g_string_free(s, FALSE);
}

static void test_placements(void) {
  static const double units[] = {1, 0.5, 0.1, 0.13, 1e-3, 2.5, 10};
  const eda_placement placements[] = {
      {{1, 2}, 1, 0, 0, 1, 1, {0, 0}, {0, 0}},
      {{-1, -2}, 1, 90, 0, 1, 1, {0, 0}, {0, 0}},
      {{3, 4}, 0.1, 33.25, 1, 1, 1, {0, 0}, {0, 0}},
      {{3, 4}, 2, -90, 1, 1, 1, {0, 0}, {0, 0}},
      {{3, 4}, 1, 180, 1, 100000, 2, {5, -6}, {-7, 8}},
      {{INT32_MAX, INT32_MIN}, 1, 270, 0, 3, 1, {5, 0}, {0, 0}},
      {{3, 4}, 1, 270, 0, 2, 2, {0, 9}, {7, 0}},
  };
  for (size_t u = 0; u < G_N_ELEMENTS(units); u++) {
    opc_error e;
    eda_layout *layout = new_layout(units[u]);
    int32_t top = eda_layout_cell(layout, "TOP", &e);
    int32_t leaf = eda_layout_cell(layout, "LE AF", &e);
    int32_t layer = eda_layout_layer(layout, "70000/7", &e);
    eda_layout_add_text(layout, top, layer, (eda_point){INT32_MAX, INT32_MIN},
                        "a b", &e);
    eda_layout_add_text(layout, top, layer, (eda_point){1, 2}, "", &e);
    for (size_t i = 0; i < G_N_ELEMENTS(placements); i++)
      eda_layout_add_instance(layout, top, leaf, &placements[i],
                              i % 2 ? (i % 4 == 1 ? "XU1" : "XU2") : NULL, &e);
    g_autofree char *path = write_good("layout", layout);
    eda_layout *back = read_good(path);
    g_autofree char *want = layout_dump(layout, "TOP"),
                    *got = layout_dump(back, "TOP");
    g_auto(GStrv) parts = g_strsplit(want, "LE AF", -1);
    g_autofree char *named = g_strjoinv("LE\\x20AF", parts);
    g_assert_cmpstr(got, ==, named);
    eda_layout_free(back);
    eda_layout_free(layout);
  }
}

/* ---- shapes ---- */

/* Return a checksum over the points and layers of all shapes, independent of
   their order: a missing or moved shape changes the checksum. */
static uint64_t layout_weigh(const eda_layout *layout, size_t *n_shapes) {
  uint64_t sum = 0;
  int32_t layer;
  *n_shapes = eda_layout_polygons(layout, 0);
  for (size_t i = 0; i < *n_shapes; i++) {
    size_t n;
    const eda_point *p = eda_layout_polygon(layout, 0, i, &n, &layer);
    for (size_t k = 0; k < n; k++)
      sum += ((uint64_t)p[k].x * 7 +
              g_str_hash(eda_layout_layer_name(layout, layer))) *
             ((uint64_t)p[k].y + 3);
  }
  return sum;
}

/* Test rows, columns, lattices and irregular sets of equal shapes, and polygons
   of all types of edges. */
static void test_shapes(void) {
  opc_error e;
  eda_layout *layout = new_layout(1);
  GRand *rand = g_rand_new_with_seed(5);
  int32_t top = eda_layout_cell(layout, "TOP", &e);
  int32_t first = eda_layout_layer(layout, "9/0", &e);
  int32_t second = eda_layout_layer(layout, "9/1", &e);
  for (int i = 0; i < 3000; i++) {
    int x = 20 * (i % 50), y = 30 * (i / 50);
    eda_layout_add_box(layout, top, i % 2 ? first : second,
                       (eda_box){x, y, x + 5, y + 5}, &e);
    x = g_rand_int_range(rand, -100000, 100000);
    y = g_rand_int_range(rand, -100000, 100000);
    eda_layout_add_box(layout, top, first,
                       (eda_box){x, y, x + 7 + i % 3, y + 9}, &e);
    const eda_point shapes[][6] = {
        {{0, 0}, {9, 0}, {9, 5}, {4, 5}, {4, 8}, {0, 8}},
        {{0, 0}, {0, 9}, {5, 9}, {5, 4}, {8, 4}, {8, 0}},
        {{0, 0}, {9, 0}, {19, 10}, {4, 40}, {-4, 8}, {-9, 8}},
    };
    eda_point p[6];
    for (int k = 0; k < 6; k++)
      p[k] = (eda_point){shapes[i % 3][k].x + x, shapes[i % 3][k].y + y};
    eda_layout_add_polygon(layout, top, second, p, 6, &e);
  }
  for (int i = 0; i < 12; i++) { /* four rows of three, the third irregular */
    int x = 10 * (i % 3) + (i == 8), y = 50 * (i / 3);
    eda_layout_add_box(layout, top, first, (eda_box){x, y, x + 77, y + 3}, &e);
  }
  eda_layout_add_box(layout, top, first,
                     (eda_box){INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX}, &e);
  g_rand_free(rand);
  g_autofree char *path = write_good("layout", layout);
  eda_layout *back = read_good(path);
  size_t n, m;
  uint64_t want = layout_weigh(layout, &n), got = layout_weigh(back, &m);
  g_assert_cmpuint(m, ==, n);
  g_assert_cmpuint(got, ==, want);
  g_autofree char *second_path = write_good("layout", back);
  g_autofree char *a = NULL, *b = NULL;
  gsize size, other;
  g_assert_true(g_file_get_contents(path, &a, &size, NULL));
  g_assert_true(g_file_get_contents(second_path, &b, &other, NULL));
  g_assert_cmpmem(a, size, b, other);
  g_assert_cmpuint(size, <, 9 * n); /* else no repetitions were formed */
  eda_layout_free(back);
  eda_layout_free(layout);
}

/* Test END: 256 bytes, strict tables, the CRC of all preceding bytes. */
static void test_end(void) {
  opc_error e;
  eda_layout *layout = new_layout(1);
  eda_layout_add_box(layout, eda_layout_cell(layout, "TOP", &e),
                     eda_layout_layer(layout, "1/0", &e), (eda_box){0, 0, 1, 1},
                     &e);
  g_autofree char *path = write_good("layout", layout);
  g_autofree char *text = NULL;
  gsize n;
  g_assert_true(g_file_get_contents(path, &text, &n, NULL));
  const uint8_t *bytes = (const uint8_t *)text;
  g_assert_cmpint(bytes[n - 256], ==, EDA_OASIS_END);
  g_assert_cmpint(bytes[n - 255], ==, 1);
  g_assert_cmpint(bytes[bytes[n - 254]], ==, EDA_OASIS_CELLNAME);
  for (gsize i = n - 205; i < n - 5; i++) g_assert_cmpint(bytes[i], ==, 0);
  g_assert_cmpint(bytes[n - 5], ==, EDA_OASIS_CRC32);
  uint32_t sum = (uint32_t)crc32(0, bytes, (uInt)n - 4);
  for (gsize i = 0; i < 4; i++)
    g_assert_cmpint(bytes[n - 4 + i], ==, sum >> 8 * i & 0xff);
  eda_layout_free(layout);
}

static void test_refusals(void) {
  opc_error e;
  eda_layout *layout = new_layout(1);
  eda_layout_add_box(layout, eda_layout_cell(layout, "", &e),
                     eda_layout_layer(layout, "poly", &e),
                     (eda_box){0, 0, 1, 1}, &e);
  g_assert_null(write_more("layout", layout, ", layers: { poly: 1/0 }", &e));
  g_assert_nonnull(strstr(e.message, "no cells without a name"));
  eda_layout_free(layout);
  layout = new_layout(1);
  eda_layout_add_box(layout, eda_layout_cell(layout, "TOP", &e),
                     eda_layout_layer(layout, "poly", &e),
                     (eda_box){0, 0, 1, 1}, &e);
  g_assert_null(write_more("layout", layout, "", &e));
  g_assert_nonnull(strstr(e.message, "'poly': the layer has no number"));
  g_assert_null(write_more("layout", layout, ", layers: { poly: CP }", &e));
  g_assert_nonnull(strstr(e.message, "'CP': invalid layer (example: 9/0)"));
  eda_layout_free(layout);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/write-oasis/placements", test_placements);
  g_test_add_func("/write-oasis/shapes", test_shapes);
  g_test_add_func("/write-oasis/end", test_end);
  g_test_add_func("/write-oasis/refusals", test_refusals);
  return g_test_run();
}
