/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of clips: shapes, units and names as written, damaged files, and the
   contest's clips against their published areas. */
#include <eda/layout.h>

#include "tests/data.h"
#include "tools/devel/testing.h"

#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

static const opc_host *host;

static char *write_clip(const char *text, gssize n) {
  char *path = g_build_filename(opc_test_folder(), "clip.glp", NULL);
  size_t size = n < 0 ? strlen(text) : (size_t)n;
  FILE *file = g_fopen(path, "wb");
  g_assert_nonnull(file);
  g_assert_cmpuint(fwrite(text, 1, size, file), ==, size);
  g_assert_cmpint(fclose(file), ==, 0);
  return path;
}

static eda_layout *read_clip(const char *path, const char *more,
                             opc_error *error) {
  g_autofree char *parameters = g_strdup_printf("{ file: '%s'%s }", path, more);
  g_autoptr(opc_module) m = opc_test_module("read.glp", parameters, error);
  if (!m) g_error("%s", error->message);
  void *outputs[1] = {NULL};
  return opc_test_run(m, outputs, error) ? NULL : outputs[0];
}

/* Return the merged area of a layer, nm^2. */
static double area(const eda_layout *layout, const char *layer) {
  opc_error error;
  eda_flat flat;
  eda_shapes merged;
  int32_t top = eda_layout_top(layout, &error);
  int32_t number = eda_layout_find_layer(layout, layer);
  g_assert_cmpint(number, >=, 0);
  g_assert_cmpint(eda_layout_flatten(layout, top, number, 0.5, &flat, &error),
                  ==, OPC_OK);
  g_assert_cmpint(eda_boolean(EDA_OR, &flat.shapes, NULL, &merged, &error), ==,
                  OPC_OK);
  double twice = (double)eda_area2(&merged);
  eda_shapes_clear(&merged);
  eda_flat_clear(&flat);
  return twice / 8;
}

static const char good[] =
    "BEGIN     /* by hand */\r\n"
    "EQUIV  2  1000  MICRON  +X,+Y\n"
    "CNAME T\nLEVEL M1\n\nCELL T PRIME\n"
    "   RECT N M1  10 -20  30  40   /* a box */\n"
    "\tPGON N V1  0 0  5 0  5 5  0 5\n"
    "   PGON N M1  100 0 120 0 120 10 110 10 110 30 100 30\n"
    "ENDMSG\nwhat follows does not count\n";

static void test_shapes(void) {
  opc_error error;
  g_autofree char *path = write_clip(good, -1);
  eda_layout *l = read_clip(path, "", &error);
  if (!l) g_error("%s", error.message);
  g_assert_cmpfloat(eda_layout_unit(l), ==, 2);
  g_assert_cmpstr(eda_layout_cell_name(l, 0), ==, "T");
  g_assert_cmpuint(eda_layout_layers(l), ==, 2);
  g_assert_cmpfloat(area(l, "M1"), ==, 4 * (1200 + 400));
  g_assert_cmpfloat(area(l, "V1"), ==, 100);
  size_t n;
  int32_t layer;
  const eda_point *p = eda_layout_polygon(l, 0, 0, &n, &layer);
  g_assert_cmpuint(n, ==, 4);
  g_assert_cmpint(p[0].x, ==, 10);
  g_assert_cmpint(p[0].y, ==, -20);
  g_assert_cmpint(p[2].x, ==, 40);
  g_assert_cmpint(p[2].y, ==, 20);
  eda_layout_free(l);
}

static void test_parameters(void) {
  opc_error error;
  g_autofree char *path = write_clip(good, -1);
  eda_layout *l =
      read_clip(path, ", layers: { metal: M1 }, scale: 3, top: T", &error);
  if (!l) g_error("%s", error.message);
  g_assert_cmpfloat(eda_layout_unit(l), ==, 6);
  g_assert_cmpint(eda_layout_find_layer(l, "M1"), ==, -1);
  g_assert_cmpfloat(area(l, "metal"), ==, 36 * (1200 + 400));
  g_assert_cmpfloat(area(l, "V1"), ==, 900);
  eda_layout_free(l);
  g_assert_null(read_clip(path, ", layers: { metal: M2 }", &error));
  g_assert_cmpint(error.code, ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "layers");
  g_assert_null(read_clip(path, ", layers: { V1: M2 }", &error));
  g_assert_null(read_clip(path, ", top: U", &error));
  g_assert_cmpstr(error.parameter, ==, "top");
}

static void test_refused(void) {
  static const struct {
    const char *text, *where;
  } cases[] = {
      {"", ":1:1: the file ends before ENDMSG"},
      {"ENDMSG\n", ":1:7: no CELL"},
      {"BEGIN\n  FOO 1\nENDMSG\n", ":2:3: unknown record"},
      {"RECT N M1 1 2 3 4\n", ":1:1: shape before the first CELL"},
      {"CELL A\nRECT N M1 1 2 3\n", ":2:16: a number is missing"},
      {"CELL A\n"
       "RECT N M1 1 2 3 4 5\n",
       ":2:19: unexpected number at the end"},
      {"CELL A\nRECT N M1 1 2 0 4\n", ":2:1: RECT without area"},
      {"CELL A\nRECT N M1 1 2 2147483647 4\n", ":2:1: RECT beyond 2^31"},
      {"CELL A\nRECT N M1 1 2 2147483648 4\n",
       ":2:15: expected a whole number"},
      {"CELL A\nRECT N M1 1 2 3.5 4\n", ":2:15: expected a whole number"},
      {"CELL A\nPGON N M1 0 0 1 1\n", ":2:1: PGON of fewer than 3 points"},
      {"CELL A\nPGON N M1 0 0 1 1 2\n", ":2:20: a number is missing"},
      {"CELL A\nPGON N\n", ":2:7: a name is missing"},
      {"CELL A\nCELL A\n", ":2:6: a cell of this name exists already"},
      {"EQUIV 1 1000 INCH +X,+Y\n", ":1:1: EQUIV that is not in MICRON"},
      {"EQUIV 1 0 MICRON +X,+Y\n", ":1:1: EQUIV that is not in MICRON"},
      {"EQUIV 1 1 MICRON -X,+Y\n", ":1:18: axes other than +X,+Y"},
      {"CELL A\nRECT N M1 1 2 3 4\n", ":3:1: the file ends before ENDMSG"},
      {"CELL \xE4\n", ":1:6: name with a letter that is not ASCII"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error = {0};
    g_autofree char *path = write_clip(cases[i].text, -1);
    g_assert_null(read_clip(path, "", &error));
    g_test_message("%s", error.message);
    g_assert_cmpint(error.code, ==, OPC_IO);
    g_assert_nonnull(strstr(error.message, cases[i].where));
  }
}

/* Test all truncations of a clip, and all changes of one byte: no crash. */
static void test_damaged(void) {
  opc_error error;
  GRand *random = g_rand_new_with_seed(5);
  size_t end = (size_t)(strstr(good, "ENDMSG") - good) + 6, n = sizeof good - 1;
  for (size_t i = 0; i < n; i++) {
    g_autofree char *path = write_clip(good, (gssize)i);
    eda_layout *l = read_clip(path, "", &error);
    g_assert_true((l != NULL) == (i >= end));
    if (l) eda_layout_free(l);
    g_autofree char *changed = g_strdup(good);
    changed[i] = (char)g_rand_int_range(random, 0, 256);
    g_autofree char *other = write_clip(changed, (gssize)n);
    l = read_clip(other, "", &error);
    if (l) eda_layout_free(l);
  }
  g_rand_free(random);
}

/* Test linear time: 200000 lines. */
static void test_many(void) {
  enum { MANY = 200000 };
  opc_error error;
  g_autoptr(GString) text = g_string_new("CELL T\n");
  for (int i = 0; i < MANY; i++)
    g_string_append(text, "RECT N M1 10 20 30 40\n");
  g_string_append(text, "ENDMSG\n");
  g_autofree char *path = write_clip(text->str, -1);
  gint64 start = g_get_monotonic_time();
  eda_layout *l = read_clip(path, "", &error);
  g_assert_cmpint(g_get_monotonic_time() - start, <, 5 * G_USEC_PER_SEC);
  g_assert_cmpuint(eda_layout_polygons(l, 0), ==, MANY);
  eda_layout_free(l);
}

/* Test the published areas of the contest's targets. */
static void test_contest(void) {
  static const double areas[] = {215344, 169280, 213504, 82560,  282044,
                                 286234, 229149, 128544, 317581, 102400};
  g_autofree char *folder = find_data("clips/iccad2013");
  if (!folder) return;
  for (int i = 0; i < 10; i++) {
    g_autofree char *path = g_strdup_printf("%s/M1_test%d.glp", folder, i + 1);
    opc_error error;
    eda_layout *l = read_clip(path, "", &error);
    if (!l) g_error("%s", error.message);
    g_test_message("%d: %.0f nm^2", i + 1, area(l, "M1"));
    g_assert_cmpfloat(area(l, "M1"), ==, areas[i]);
    eda_layout_free(l);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  host = opc_test_host();
  g_test_add_func("/glp/shapes", test_shapes);
  g_test_add_func("/glp/parameters", test_parameters);
  g_test_add_func("/glp/refused", test_refused);
  g_test_add_func("/glp/damaged", test_damaged);
  g_test_add_func("/glp/many", test_many);
  g_test_add_func("/glp/contest", test_contest);
  return g_test_run();
}
