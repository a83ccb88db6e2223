/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares each layout file of the corpus with data from KLayout: cells,
   placements and shapes by layer. For each top cell and layer, also compares
   the bounding box and, for rectilinear shapes, the merged area. */
#include <glib.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

#include <eda/eda.h>

#include "tests/data.h"
#include "tools/devel/testing.h"

static eda_layout *read_file(const char *path) {
  opc_error e = {0};
  const char *id = g_str_has_suffix(path, ".oas") ? "read.oasis" : "read.gds";
  g_autofree char *mapping = g_strdup_printf("{ file: '%s' }", path);
  g_autoptr(opc_module) module = opc_test_module(id, mapping, &e);
  void *output = NULL;
  if (!module || opc_test_run(module, &output, &e)) g_error("%s", e.message);
  return output;
}

static int64_t object_count(JsonObject *object, const char *name) {
  return json_object_get_int_member_with_default(object, name, 0);
}

/* ---- cells and placements ---- */

static void check_cells(const eda_layout *layout, JsonObject *cells) {
  g_assert_cmpuint(eda_layout_cells(layout), ==, json_object_get_size(cells));
  for (size_t i = 0; i < eda_layout_cells(layout); i++) {
    const char *name = eda_layout_cell_name(layout, (int32_t)i);
    if (!json_object_has_member(cells, name)) g_error("cell '%s'", name);
    int64_t single = 0, arrays = 0, placed = 0;
    for (size_t k = 0; k < eda_layout_instances(layout, (int32_t)i); k++) {
      int32_t child;
      eda_placement p;
      eda_layout_instance(layout, (int32_t)i, k, &child, &p);
      int64_t members = (int64_t)p.columns * p.rows;
      single += members == 1;
      arrays += members > 1;
      placed += members;
    }
    JsonObject *want = json_object_get_object_member(cells, name);
    g_assert_cmpint(single, ==, object_count(want, "single"));
    g_assert_cmpint(arrays, ==, object_count(want, "arrays"));
    g_assert_cmpint(placed, ==, object_count(want, "placed"));
  }
}

/* ---- shapes ---- */

/* Paths of zero width have no area and are dropped. Count the dropped paths of
   each layer as missing shapes. */
static GHashTable *check_layers(const eda_layout *layout, JsonObject *layers) {
  GHashTable *missing =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  g_autofree int64_t *shapes = g_new0(int64_t, eda_layout_layers(layout) + 1);
  g_autofree int64_t *texts = g_new0(int64_t, eda_layout_layers(layout) + 1);
  for (size_t c = 0; c < eda_layout_cells(layout); c++) {
    int32_t cell = (int32_t)c, layer;
    size_t n;
    eda_point at;
    for (size_t i = 0; i < eda_layout_polygons(layout, cell); i++) {
      eda_layout_polygon(layout, cell, i, &n, &layer);
      shapes[layer]++;
    }
    for (size_t i = 0; i < eda_layout_texts(layout, cell); i++) {
      eda_layout_text(layout, cell, i, &at, &layer);
      texts[layer]++;
    }
  }
  g_assert_cmpuint(eda_layout_layers(layout), ==, json_object_get_size(layers));
  for (size_t i = 0; i < eda_layout_layers(layout); i++) {
    const char *name = eda_layout_layer_name(layout, (int32_t)i);
    g_assert_true(json_object_has_member(layers, name));
    JsonObject *want = json_object_get_object_member(layers, name);
    int64_t paths = object_count(want, "path");
    int64_t less =
        object_count(want, "polygon") + object_count(want, "box") + paths;
    less -= shapes[i];
    g_assert_cmpint(texts[i], ==, object_count(want, "text"));
    g_assert_cmpint(less, >=, 0);
    g_assert_cmpint(less, <=, paths);
    g_hash_table_insert(missing, g_strdup(name), GINT_TO_POINTER((int)less));
  }
  return missing;
}

/* ---- areas and boxes ---- */

static gboolean rectilinear(const eda_shapes *s) {
  for (size_t i = 0; i < s->count; i++)
    for (uint32_t k = s->start[i]; k < s->start[i + 1]; k++) {
      eda_point a = s->points[k];
      eda_point b = s->points[k + 1 < s->start[i + 1] ? k + 1 : s->start[i]];
      if (a.x != b.x && a.y != b.y) return FALSE;
    }
  return TRUE;
}

static void check_area(const eda_shapes *flat, double unit, JsonObject *want) {
  opc_error e;
  eda_shapes merged;
  if (eda_boolean(EDA_OR, flat, NULL, &merged, &e)) g_error("%s", e.message);
  double area = 0.5 * (double)eda_area2(&merged) * unit * unit;
  double expected = json_object_get_double_member(want, "area_um2") * 1e6;
  eda_shapes_clear(&merged);
  /* KLayout prints 9 digits. */
  g_assert_cmpfloat_with_epsilon(area, expected, 1e-8 * expected + 1e-9);
}

/* Disjoint shapes, which may be slanted: compare the sum of the areas. */
static void check_sum(const eda_shapes *flat, double unit, JsonObject *want) {
  double twice = 0;
  if (object_count(want, "polygons") != (int64_t)flat->count) return;
  for (size_t i = 0; i < flat->count; i++) {
    double one = 0;
    for (uint32_t k = flat->start[i]; k < flat->start[i + 1]; k++) {
      eda_point a = flat->points[k];
      eda_point b =
          flat->points[k + 1 < flat->start[i + 1] ? k + 1 : flat->start[i]];
      one += (double)a.x * b.y - (double)b.x * a.y;
    }
    twice += fabs(one);
  }
  double expected = json_object_get_double_member(want, "area_um2") * 1e6;
  g_assert_cmpfloat_with_epsilon(0.5 * twice * unit * unit, expected,
                                 1e-8 * expected + 0.51 * unit * unit);
}

/* For slanted paths, rotated cells and round ends, corners may differ by one
   unit. */
static void check_box(const eda_shapes *flat, double unit, JsonObject *want) {
  JsonArray *box = json_object_get_array_member(want, "bbox_um");
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (uint32_t k = 0; k < (flat->count ? flat->start[flat->count] : 0); k++) {
    const double v[2] = {flat->points[k].x, flat->points[k].y};
    for (int i = 0; i < 2; i++) {
      low[i] = MIN(low[i], v[i]);
      high[i] = MAX(high[i], v[i]);
    }
  }
  double slack = rectilinear(flat) ? 1e-6 : 1.5;
  for (guint i = 0; i < 2; i++) {
    g_assert_cmpfloat_with_epsilon(
        low[i], json_array_get_double_element(box, i) * 1e3 / unit, slack);
    g_assert_cmpfloat_with_epsilon(
        high[i], json_array_get_double_element(box, i + 2) * 1e3 / unit, slack);
  }
}

static int check_top(const eda_layout *layout, const char *top,
                     JsonObject *areas, JsonObject *layers,
                     GHashTable *missing) {
  int checked = 0;
  double unit = eda_layout_unit(layout);
  g_autoptr(GList) names = json_object_get_members(areas);
  for (GList *k = names; k; k = k->next) {
    JsonObject *want = json_object_get_object_member(areas, k->data);
    opc_error e;
    eda_flat flat;
    g_test_message("  %s, layer %s", top, (const char *)k->data);
    if (eda_layout_flatten(layout, eda_layout_find_cell(layout, top),
                           eda_layout_find_layer(layout, k->data), unit, &flat,
                           &e))
      g_error("%s", e.message);
    gboolean lost = GPOINTER_TO_INT(g_hash_table_lookup(missing, k->data)) > 0;
    if (rectilinear(&flat.shapes) && !flat.moved) {
      check_area(&flat.shapes, unit, want);
      checked++;
    } else {
      g_assert_false(lost); /* the loss must be reported */
      if (!flat.moved &&
          !object_count(json_object_get_object_member(layers, k->data), "path"))
        check_sum(&flat.shapes, unit, want);
    }
    if (!lost) check_box(&flat.shapes, unit, want);
    eda_flat_clear(&flat);
  }
  return checked;
}

static void test_file(const char *name, JsonObject *want) {
  g_autofree char *folder = find_data("gds-corpus");
  if (!folder) return;
  g_autofree char *path = g_build_filename(folder, name, NULL);
  g_test_message("%s", name);
  eda_layout *layout = read_file(path);
  g_assert_cmpfloat_with_epsilon(
      eda_layout_unit(layout) / json_object_get_double_member(want, "dbu_um"),
      1000, 1e-9);
  check_cells(layout, json_object_get_object_member(want, "cells"));
  g_autoptr(GHashTable) missing =
      check_layers(layout, json_object_get_object_member(want, "layers"));
  JsonObject *layers = json_object_get_object_member(want, "layers");
  JsonObject *tops = json_object_get_object_member(want, "top_cells");
  g_autoptr(GList) names = json_object_get_members(tops);
  int checked = 0;
  for (GList *n = names; n; n = n->next)
    checked +=
        check_top(layout, n->data, json_object_get_object_member(tops, n->data),
                  layers, missing);
  g_test_message("  %d areas", checked);
  eda_layout_free(layout);
}

static void test_corpus(void) {
  g_autofree char *folder = find_data("gds-corpus");
  if (!folder) return;
  g_autofree char *json = g_build_filename(folder, "expected.json", NULL);
  g_autoptr(JsonParser) parser = json_parser_new();
  g_assert_true(json_parser_load_from_file(parser, json, NULL));
  JsonObject *all = json_node_get_object(json_parser_get_root(parser));
  g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
  const char *name;
  int files = 0;
  while ((name = g_dir_read_name(dir))) {
    if (!g_str_has_suffix(name, ".gds") && !g_str_has_suffix(name, ".oas"))
      continue;
    if (!json_object_has_member(all, name))
      g_error("no message about %s", name);
    test_file(name, json_object_get_object_member(all, name));
    files++;
  }
  g_assert_cmpint(files, >, 0);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/corpus", test_corpus);
  return g_test_run();
}
