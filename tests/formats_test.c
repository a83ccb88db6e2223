/* SPDX-License-Identifier: BSD-3-Clause */
/* Conversion between layout formats: the flattened geometry of a file is the
   same after writing and reading. */
#include <glib.h>
#include <stdio.h>
#include <string.h>

#include <eda/eda.h>

#include "tests/data.h"
#include "tools/devel/testing.h"

static eda_layout *read_file(const char *path, opc_error *error) {
  const char *id = g_str_has_suffix(path, ".oas")   ? "read.oasis"
                   : g_str_has_suffix(path, ".cif") ? "read.cif"
                                                    : "read.gds";
  g_autofree char *mapping = g_strdup_printf("{ file: '%s' }", path);
  g_autoptr(opc_module) module = opc_test_module(id, mapping, error);
  void *output = NULL;
  if (!module || opc_test_run(module, &output, error)) return NULL;
  return output;
}

static eda_layout *read_good(const char *path) {
  opc_error e = {0};
  eda_layout *layout = read_file(path, &e);
  if (!layout) g_error("%s", e.message);
  return layout;
}

/* Return the path of `layout` written as `kind` ("gds", "oasis", "cif"), or
   NULL. */
static char *write_file(eda_layout *layout, const char *kind,
                        const char *layers, opc_error *error) {
  static int files;
  const char *suffix = strcmp(kind, "oasis") ? kind : "oas";
  g_autofree char *name = g_strdup_printf("%d.%s", files++, suffix);
  g_autofree char *id = g_strdup_printf("write.%s", kind);
  g_autofree char *mapping =
      g_strdup_printf("{ file: %s, layers: { %s } }", name, layers);
  g_autoptr(opc_module) module = opc_test_module(id, mapping, error);
  if (!module) return NULL;
  opc_test_input(module, "layout", layout);
  void *none = NULL;
  if (opc_test_run(module, &none, error)) return NULL;
  return g_build_filename(opc_test_folder(), name, NULL);
}

static eda_layout *through(eda_layout *layout, const char *kind,
                           const char *layers) {
  opc_error e = {0};
  g_autofree char *path = write_file(layout, kind, layers, &e);
  if (!path) g_error("%s", e.message);
  return read_good(path);
}

/* ---- comparing ---- */

static eda_point at(const eda_point *p, size_t n, size_t from, gboolean back,
                    size_t k) {
  return p[back ? (from + n - k) % n : (from + k) % n];
}

/* Return a polygon as text that does not depend on start point and direction:
   the least of all representations. */
static char *polygon_text(const eda_point *p, size_t n) {
  size_t best = 0;
  gboolean best_back = FALSE;
  for (size_t start_and_order = 1; start_and_order < 2 * n; start_and_order++) {
    size_t from = start_and_order / 2, k = 0;
    gboolean back = start_and_order % 2;
    eda_point a, b;
    do {
      a = at(p, n, from, back, k);
      b = at(p, n, best, best_back, k);
    } while (a.x == b.x && a.y == b.y && ++k < n);
    if (k == n || a.x > b.x || (a.x == b.x && a.y > b.y)) continue;
    best = from;
    best_back = back;
  }
  GString *s = g_string_new(NULL);
  for (size_t k = 0; k < n; k++) {
    eda_point a = at(p, n, best, best_back, k);
    g_string_append_printf(s, "%d,%d ", a.x, a.y);
  }
  return g_string_free(s, FALSE);
}

static int by_text(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Return all polygons of a layer of a flattened cell, on a grid, sorted. */
static GPtrArray *flat(const eda_layout *layout, int32_t cell, int32_t layer,
                       double grid) {
  opc_error e;
  eda_flat f;
  GPtrArray *list = g_ptr_array_new_with_free_func(g_free);
  if (layer < 0) return list;
  if (eda_layout_flatten(layout, cell, layer, grid, &f, &e))
    g_error("%s", e.message);
  for (size_t i = 0; i < f.shapes.count; i++) {
    uint32_t start = f.shapes.start[i];
    g_ptr_array_add(list, polygon_text(f.shapes.points + start,
                                       f.shapes.start[i + 1] - start));
  }
  eda_flat_clear(&f);
  g_ptr_array_sort(list, by_text);
  return list;
}

static size_t total(const eda_layout *layout,
                    size_t (*count)(const eda_layout *, int32_t)) {
  size_t sum = 0;
  for (size_t i = 0; i < eda_layout_cells(layout); i++)
    sum += count(layout, (int32_t)i);
  return sum;
}

/* Return the CIF name of a layer: "L9D0" for "9/0". */
static char *renamed(const char *layer, gboolean cif) {
  unsigned a, b;
  char end;
  if (cif && sscanf(layer, "%u/%u%c", &a, &b, &end) == 2)
    return g_strdup_printf("L%uD%u", a, b);
  return g_strdup(layer);
}

/* Check that `got` has all cells of `want`, with the same flattened shapes.
   Return the number of cells. */
static size_t assert_same(const eda_layout *got, const eda_layout *want,
                          gboolean cif) {
  size_t shapes = 0;
  for (size_t c = 0; c < eda_layout_cells(want); c++) {
    const char *name = eda_layout_cell_name(want, (int32_t)c);
    int32_t cell = eda_layout_find_cell(got, name);
    if (cell < 0) g_error("cell '%s' is lost", name);
    for (size_t i = 0; i < eda_layout_layers(want); i++) {
      g_autofree char *layer =
          renamed(eda_layout_layer_name(want, (int32_t)i), cif);
      double grid = eda_layout_unit(want);
      g_autoptr(GPtrArray) a = flat(want, (int32_t)c, (int32_t)i, grid);
      g_autoptr(GPtrArray) b =
          flat(got, cell, eda_layout_find_layer(got, layer), grid);
      g_assert_cmpuint(a->len, ==, b->len);
      for (guint k = 0; k < a->len; k++)
        g_assert_cmpstr(b->pdata[k], ==, a->pdata[k]);
      shapes += a->len;
    }
  }
  g_assert_cmpuint(total(got, eda_layout_texts), ==,
                   total(want, eda_layout_texts));
  return shapes;
}

static char *dump_instances(const eda_layout *layout, const char *cell) {
  GString *s = g_string_new(NULL);
  int32_t number = eda_layout_find_cell(layout, cell), child;
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

static void assert_instances(const eda_layout *got, const eda_layout *want) {
  g_assert_cmpuint(eda_layout_cells(got), ==, eda_layout_cells(want));
  for (size_t c = 0; c < eda_layout_cells(want); c++) {
    const char *name = eda_layout_cell_name(want, (int32_t)c);
    g_autofree char *a = dump_instances(want, name);
    g_autofree char *b = dump_instances(got, name);
    g_assert_cmpstr(b, ==, a);
  }
}

/* ---- the round trips ---- */

/* Return a map of layer names to GDSII numbers. */
static char *numbers(const eda_layout *layout) {
  GString *s = g_string_new("");
  for (size_t i = 0; i < eda_layout_layers(layout); i++) {
    const char *name = eda_layout_layer_name(layout, (int32_t)i);
    if (strchr(name, '/')) continue;
    g_string_append_printf(s, "%s%s: %zu/0", s->len ? ", " : "", name, i + 1);
  }
  return g_string_free(s, FALSE);
}

static void round_trip(const char *path) {
  eda_layout *first = read_good(path);
  g_autofree char *map = numbers(first);
  eda_layout *gds = through(first, "gds", map);
  eda_layout *oasis = through(gds, "oasis", "");
  eda_layout *again = through(oasis, "gds", "");
  size_t n = assert_same(oasis, gds, FALSE);
  if (!*map) g_assert_cmpuint(assert_same(gds, first, FALSE), ==, n);
  g_assert_cmpuint(assert_same(again, gds, FALSE), ==, n);
  assert_instances(oasis, gds);
  assert_instances(again, gds);
  g_test_message("%s: %zu polygons", path, n);
  eda_layout_free(again);
  eda_layout_free(oasis);
  eda_layout_free(gds);
  eda_layout_free(first);
}

/* Convert a layout to CIF and back. For a layout that CIF cannot represent,
   check the message and return FALSE. */
static gboolean trip_cif(const char *path) {
  opc_error e = {0};
  eda_layout *first = read_good(path);
  g_autofree char *file = write_file(first, "cif", "", &e);
  if (file) {
    eda_layout *cif = read_good(file);
    assert_same(cif, first, TRUE);
    eda_layout_free(cif);
  } else {
    g_test_message("%s: %s", path, e.message);
    g_assert_nonnull(strstr(e.message, "' in '"));
  }
  eda_layout_free(first);
  return file != NULL;
}

static void test_corpus(void) {
  g_autofree char *folder = find_data("gds-corpus");
  if (!folder) return;
  g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
  const char *name;
  int refused = 0, files = 0;
  g_assert_nonnull(dir);
  while ((name = g_dir_read_name(dir))) {
    if (!g_str_has_suffix(name, ".gds") && !g_str_has_suffix(name, ".oas"))
      continue;
    g_autofree char *path = g_build_filename(folder, name, NULL);
    round_trip(path);
    refused += !trip_cif(path);
    files++;
  }
  g_assert_cmpint(files, >, 0);
  g_assert_cmpint(refused, >, 0); /* magnified cells, or cells rotated by 22
                                     degrees */
  g_assert_cmpint(refused, <, files / 2);
}

static void test_cells(void) {
  g_autofree char *folder =
      g_build_filename(g_getenv("OPCFLOW_SOURCE"), "data", "cells65", NULL);
  g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
  const char *name;
  int files = 0;
  g_assert_nonnull(dir);
  while ((name = g_dir_read_name(dir))) {
    if (!g_str_has_suffix(name, ".gds") && !g_str_has_suffix(name, ".cif"))
      continue;
    g_autofree char *path = g_build_filename(folder, name, NULL);
    round_trip(path);
    g_assert_true(trip_cif(path));
    files++;
  }
  g_assert_cmpint(files, >=, 3);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/formats/cells", test_cells);
  g_test_add_func("/formats/corpus", test_corpus);
  return g_test_run();
}
