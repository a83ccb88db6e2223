/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of files made record by record with known layouts, of files of other
   programs, and of rejected files with the places of their errors. */
#include <math.h>

#include "making_test.h"

/* ---- against KLayout ---- */

/* Twice the area of a layer over all cells, from KLayout 0.30. KLayout rounds
   corners of slanted paths differently, by up to one unit. */
static const struct {
  const char *file, *layer;
  double twice, tolerance;
} drawn[] = {
    {"gdstk_proof_lib.gds", "0/0", 478025293090704, 0},
    {"gdstk_proof_lib.gds", "1/0", 163585591815634, 0},
    {"gdstk_proof_lib.gds", "2/0", 23335592398374, 0},
    {"gdstk_proof_lib.gds", "3/0", 128649629267711, 0},
    {"gdstk_proof_lib.gds", "4/0", 298416636669322, 0},
    {"gdstk_proof_lib.gds", "5/0", 7335592418316, 0},
    {"klayout_basic_instances.gds", "1/0", 46781708, 0},
    {"klayout_t10.gds", "6/0", 6451200, 0},
    {"klayout_t10.gds", "3/0", 4495200, 0},
    {"own_elements_a.gds", "4/0", 72000, 0},
    {"own_elements_a.gds", "4/2", 75200, 0},
    {"own_elements_a.gds", "4/4", 75600, 0},
    {"own_elements_a.gds", "4/5", 40000, 0},
    {"own_elements_a.gds", "4/8", 36736, 0},
    {"openram_testLayoutA.gds", "51/0", 65250000, 0},
    {"openram_testLayoutA.gds", "49/0", 71550000, 0},
    {"pythongdsii_test1.gds", "44/0", 6609952000, 300000},
};

static double drawn_twice(const eda_layout *layout, const char *name) {
  double sum = 0;
  int32_t wanted = eda_layout_find_layer(layout, name), layer;
  for (size_t c = 0; c < eda_layout_cells(layout); c++)
    for (size_t i = 0; i < eda_layout_polygons(layout, (int32_t)c); i++) {
      size_t n;
      const eda_point *p =
          eda_layout_polygon(layout, (int32_t)c, i, &n, &layer);
      if (layer != wanted) continue;
      double twice = 0;
      for (size_t k = 0; k < n; k++) {
        eda_point a = p[k], b = p[(k + 1) % n];
        twice += (double)a.x * b.y - (double)b.x * a.y;
      }
      sum += fabs(twice);
    }
  return sum;
}

/* tests/corpus_test.c has further comparisons with KLayout. */
static void test_drawn(void) {
  g_autofree char *folder = find_data("gds-corpus");
  if (!folder) return;
  for (size_t k = 0; k < G_N_ELEMENTS(drawn); k++) {
    g_autofree char *path = g_build_filename(folder, drawn[k].file, NULL);
    eda_layout *layout = read_good(path, "");
    g_assert_cmpfloat_with_epsilon(drawn_twice(layout, drawn[k].layer),
                                   drawn[k].twice, drawn[k].tolerance + 0.5);
    eda_layout_free(layout);
  }
}

/* Areas, nm^2, of masks as drawn shapes with additions and without cut-outs,
   by operations of KLayout 0.30 on regions. */
static void test_expressions(void) {
  static const struct {
    const char *cell;
    double poly, active;
  } masks[] = {{"sram_dp_cell_opt1a", 1641800, 1013200},
               {"sram_sp_cell_opt1", 779800, 565300},
               {"sram_sp_cell", 648000, 565300}};
  g_autofree char *folder = find_data("sky130_sram");
  if (!folder) return;
  for (size_t k = 0; k < G_N_ELEMENTS(masks); k++) {
    g_autofree char *path =
        g_strdup_printf("%s/sky130_fd_bd_sram__%s.gds", folder, masks[k].cell);
    opc_test_forget();
    eda_layout *layout = read_good(
        path,
        ", layers: { poly: drawn + 33/43 - 33/42, drawn: 66/20, "
        "active: 'grow(shrink((65/20 + 22/21) - 22/22, 5 nm), .005 um)' }");
    g_assert_cmpint(strstr(opc_test_log(),
                           "no layer 33/43, 33/42: empty in "
                           "the expression of 'poly'") != NULL,
                    ==, !strcmp(masks[k].cell, "sram_sp_cell"));
    const char *const names[] = {"poly", "active"};
    const double areas[] = {masks[k].poly, masks[k].active};
    for (int i = 0; i < 2; i++) {
      opc_error e;
      eda_flat flat;
      eda_shapes merged;
      int32_t layer = eda_layout_find_layer(layout, names[i]);
      g_assert_cmpstr(eda_layout_file_layer(layout, layer), ==,
                      i ? "65/20" : "66/20");
      g_assert_false(eda_layout_flatten(layout, eda_layout_top(layout, &e),
                                        layer, 1, &flat, &e));
      g_assert_false(eda_boolean(EDA_OR, &flat.shapes, NULL, &merged, &e));
      g_assert_cmpfloat((double)eda_area2(&merged), ==, 2 * areas[i]);
      eda_shapes_clear(&merged);
      eda_flat_clear(&flat);
    }
    eda_layout_free(layout);
  }
}

/* ---- contents of files ---- */

static void test_reals(void) {
  const struct {
    uint8_t bytes[8];
    double value;
  } cases[] = {
      {{0}, 0},
      {{0x41, 0x10}, 1},
      {{0xc1, 0x20}, -2},
      {{0x42, 0x5a}, 90},
      {{0x43, 0x10, 0xe0}, 270},
      {{0x40, 0x80}, 0.5},
      {{0x3e, 0x41, 0x89, 0x37, 0x4b, 0xc6, 0xa7, 0xf0}, 0.001},
      {{0x39, 0x44, 0xb8, 0x2f, 0xa0, 0x9b, 0x5a, 0x54}, 1e-9},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    g_assert_cmpfloat_with_epsilon(eda_gds_real(cases[i].bytes), cases[i].value,
                                   1e-15 * fabs(cases[i].value) + 1e-300);
  GRand *rand = g_rand_new_with_seed(3);
  for (int i = 0; i < 10000; i++) {
    uint8_t bytes[8];
    double v =
        ldexp(g_rand_double(rand) - 0.5, g_rand_int_range(rand, -200, 200));
    eda_gds_put_real(bytes, v);
    g_assert_cmpfloat(eda_gds_real(bytes), ==, v);
  }
  g_rand_free(rand);
}

/* Test names of layers, unnamed datatypes, and the factor on the unit. */
static void test_layers(void) {
  GByteArray *file = new_file();
  put_cell(file, "TOP");
  put_box(file, 9, 0);
  put_box(file, 9, 5);
  put_box(file, 10, 1);
  put_box(file, 10, 2);
  put_box(file, 40000, 60000);
  g_autofree char *path = file_finish(file);
  eda_layout *layout =
      read_good(path, ", layers: { poly: 9/0, contact: '10' }, scale: 1.3");
  g_assert_cmpuint(eda_layout_layers(layout), ==, 4);
  g_assert_cmpfloat_with_epsilon(eda_layout_unit(layout), 1.3, 1e-15);
  size_t n;
  int32_t layer;
  const char *const want[] = {"poly", "9/5", "contact", "contact",
                              "40000/60000"};
  g_assert_cmpuint(eda_layout_polygons(layout, 0), ==, 5);
  for (size_t i = 0; i < 5; i++) {
    eda_layout_polygon(layout, 0, i, &n, &layer);
    g_assert_cmpstr(eda_layout_layer_name(layout, layer), ==, want[i]);
  }
  eda_layout_free(layout);
}

static void test_parameters(void) {
  GByteArray *file = new_file();
  put_leaf(file);
  put_cell(file, "TOP");
  put_empty(file, EDA_GDS_SREF);
  put_text(file, EDA_GDS_SNAME, "LEAF");
  put_i32s(file, EDA_GDS_XY, 2, (int32_t[]){1, 2});
  put_empty(file, EDA_GDS_ENDEL);
  put_empty(file, EDA_GDS_ENDSTR);
  put_cell(file, "OTHER");
  put_box(file, 1, 0);
  g_autofree char *path = file_finish(file);
  assert_refused(path, ", layers: { poly: 9/0, active: 2/0 }", OPC_INVALID,
                 "no layer 2/0 for 'active'; the file has 1/0, 9/0");
  assert_refused(path, ", layers: { poly: nine }", OPC_INVALID,
                 "'nine': expected");
  assert_refused(path, ", layers: { poly: 9/0, gate: 9/0 }", OPC_INVALID,
                 "layer 9/0 is 'poly' already");
  assert_refused(path, ", layers: { poly: '9/0 + nine' }", OPC_INVALID,
                 "'nine': expected a layer as 9/0, or a name of 'layers'");
  assert_refused(path, ", layers: { poly: (9/0 }", OPC_INVALID,
                 "'(9/0': expected ')' or an operator at character 5");
  assert_refused(path, ", layers: { poly: 3/1 + 3/2 }", OPC_INVALID,
                 "no layer 3/1 + 3/2 for 'poly'");
  assert_refused(path, ", layers: { a: b + 9/0, b: a - 9/0 }", OPC_INVALID,
                 "the expression of 'b' contains this layer");
  assert_refused(path, ", layers: { '3/0': 9/0 }", OPC_INVALID,
                 "not allowed as a name");
  assert_refused(path, ", top: NONE", OPC_INVALID,
                 "cell 'NONE' does not exist");
  assert_refused(path, ", top: OTHR", OPC_INVALID,
                 "cell 'OTHR' does not exist, did you mean 'OTHER'?");
  opc_error e;
  eda_layout *layout = read_good(path, "");
  g_assert_cmpint(eda_layout_top(layout, &e), ==, -1);
  eda_layout_free(layout);
  layout = read_good(path, ", top: TOP");
  g_assert_cmpuint(eda_layout_cells(layout), ==, 2);
  g_assert_cmpstr(eda_layout_cell_name(layout, eda_layout_top(layout, &e)), ==,
                  "TOP");
  eda_layout_free(layout);
}

/* Test names of instances (property 61 or the first property), an array with
   fractional steps, counts of 0, and names that are not ASCII. */
static void test_placements(void) {
  GByteArray *file = new_file();
  put_leaf(file);
  put_cell(file, "T\xe4\n");
  static const char *const names[][2] = {
      {NULL, NULL}, {"A", NULL}, {"A", "B"}, {NULL, "B"}};
  for (size_t i = 0; i < 4; i++) {
    put_empty(file, EDA_GDS_SREF);
    put_text(file, EDA_GDS_SNAME, "LEAF");
    put_u16(file, EDA_GDS_STRANS, 0x8000);
    put_i32s(file, EDA_GDS_XY, 2, (int32_t[]){1, 2});
    for (uint32_t k = 0; k < 2; k++) {
      if (!names[i][k]) continue;
      put_u16(file, EDA_GDS_PROPATTR, k ? 61 : 7);
      put_text(file, EDA_GDS_PROPVALUE, names[i][k]);
    }
    put_empty(file, EDA_GDS_ENDEL);
  }
  put_empty(file, EDA_GDS_AREF);
  put_text(file, EDA_GDS_SNAME, "LEAF");
  put_u16s(file, EDA_GDS_COLROW, 2, (uint32_t[]){3, 2});
  put_i32s(file, EDA_GDS_XY, 6, (int32_t[]){0, 0, -61, 0, 0, 40});
  put_empty(file, EDA_GDS_ENDEL);
  put_empty(file, EDA_GDS_AREF);
  put_text(file, EDA_GDS_SNAME, "LEAF");
  put_u16s(file, EDA_GDS_COLROW, 2, (uint32_t[]){3, 0});
  put_i32s(file, EDA_GDS_XY, 6, (int32_t[]){0, 0, -60, 3, 0, 40});
  put_empty(file, EDA_GDS_ENDEL);
  g_autofree char *path = file_finish(file);
  eda_layout *layout = read_good(path, "");
  int32_t top = eda_layout_find_cell(layout, "T\\xE4\\x0A"), child;
  g_assert_cmpint(top, >=, 0);
  eda_placement p;
  g_assert_cmpuint(eda_layout_instances(layout, top), ==, 8);
  static const char *const want[] = {NULL, "A", "B", "B"};
  for (size_t i = 0; i < 4; i++) {
    g_assert_cmpstr(eda_layout_instance(layout, top, i, &child, &p), ==,
                    want[i]);
    g_assert_true(p.mirror == 1 && p.columns == 1);
  }
  /* the steps are -61 / 3 = -20.33 and -40.67 */
  static const int32_t x[] = {0, -20, -41};
  for (size_t i = 0; i < 3; i++) {
    eda_layout_instance(layout, top, 4 + i, &child, &p);
    g_assert_true(p.origin.x == x[i] && p.columns == 1 && p.rows == 2 &&
                  p.row_step.y == 20);
  }
  eda_layout_instance(layout, top, 7, &child, &p);
  g_assert_true(p.columns == 3 && p.rows == 1 && p.column_step.x == -20 &&
                p.column_step.y == 1);
  eda_layout_free(layout);
}

/* Test XY in several records, records irrelevant to the layout, and a placed
   cell without definition. */
static void test_odd_records(void) {
  GByteArray *file = new_file();
  put_text(file, EDA_GDS_REFLIBS, "A");
  put_text(file, EDA_GDS_REFLIBS, "B");
  put_u16(file, EDA_GDS_GENERATIONS, 3);
  put_cell(file, "$$$CONTEXT_INFO$$$");
  put_box(file, 99, 0);
  put_empty(file, EDA_GDS_ENDSTR);
  put_cell(file, "TOP");
  put_empty(file, EDA_GDS_BOUNDARY);
  put_u16(file, EDA_GDS_ELFLAGS, 1);
  put_i32s(file, EDA_GDS_PLEX, 1, (int32_t[]){5});
  put_u16(file, EDA_GDS_LAYER, 1);
  put_u16(file, EDA_GDS_DATATYPE, 0);
  put_i32s(file, EDA_GDS_XY, 6, (int32_t[]){0, 0, 9, 0, 9, 9});
  put_i32s(file, EDA_GDS_XY, 6, (int32_t[]){5, 9, 0, 5, 0, 0});
  put_empty(file, EDA_GDS_ENDEL);
  put_empty(file, EDA_GDS_SREF);
  put_text(file, EDA_GDS_SNAME, "GONE");
  put_i32s(file, EDA_GDS_XY, 2, (int32_t[]){1, 2});
  put_empty(file, EDA_GDS_ENDEL);
  g_autofree char *path = file_finish(file);
  opc_test_forget();
  eda_layout *layout = read_good(path, "");
  g_assert_nonnull(strstr(opc_test_log(), "1 placed cells are not defined"));
  g_assert_cmpuint(eda_layout_layers(layout), ==, 1);
  size_t n;
  int32_t layer;
  g_assert_cmpuint(
      eda_layout_polygons(layout, eda_layout_find_cell(layout, "TOP")), ==, 1);
  eda_layout_polygon(layout, eda_layout_find_cell(layout, "TOP"), 0, &n,
                     &layer);
  g_assert_cmpuint(n, ==, 5);
  eda_layout_free(layout);
}

/* Test a file larger than the reader's window, with records up to 64 KB: every
   point is read. */
static void test_large(void) {
  enum { POLYGONS = 600, MOST = 8190 };
  GByteArray *file = new_file();
  GArray *sizes = g_array_new(FALSE, FALSE, sizeof(int32_t));
  GRand *rand = g_rand_new_with_seed(4);
  put_cell(file, "TOP");
  uint8_t *data = g_malloc(8 * MOST);
  for (int32_t i = 0; i < POLYGONS; i++) {
    int32_t n = i % 8 ? 5 : g_rand_int_range(rand, 5, MOST);
    for (int32_t k = 0; k < n; k++) {
      eda_gds_put_i32(data + 8 * k, i);
      eda_gds_put_i32(data + 8 * k + 4, k * k % 1013);
    }
    put_empty(file, EDA_GDS_BOUNDARY);
    put_u16(file, EDA_GDS_LAYER, 1);
    put_u16(file, EDA_GDS_DATATYPE, 0);
    record_put(file, EDA_GDS_XY, EDA_GDS_INT4, data, 8 * (size_t)n);
    put_empty(file, EDA_GDS_ENDEL);
    g_array_append_val(sizes, n);
  }
  put_empty(file, EDA_GDS_ENDSTR);
  put_empty(file, EDA_GDS_ENDLIB);
  g_assert_cmpuint(file->len, >, 2 << 20);
  g_autofree char *path = file_save(file);
  eda_layout *layout = read_good(path, "");
  g_assert_cmpuint(eda_layout_polygons(layout, 0), ==, POLYGONS);
  for (int32_t i = 0; i < POLYGONS; i++) {
    size_t n;
    int32_t layer;
    const eda_point *p = eda_layout_polygon(layout, 0, (size_t)i, &n, &layer);
    g_assert_cmpuint(n, ==, g_array_index(sizes, int32_t, i));
    for (int32_t k = 0; k < (int32_t)n; k++)
      g_assert_true(p[k].x == i && p[k].y == k * k % 1013);
  }
  eda_layout_free(layout);
  g_free(data);
  g_rand_free(rand);
  g_array_free(sizes, TRUE);
  g_byte_array_free(file, TRUE);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/read-gds/drawn", test_drawn);
  g_test_add_func("/read-gds/expressions", test_expressions);
  g_test_add_func("/read-gds/reals", test_reals);
  g_test_add_func("/read-gds/layers", test_layers);
  g_test_add_func("/read-gds/parameters", test_parameters);
  g_test_add_func("/read-gds/placements", test_placements);
  g_test_add_func("/read-gds/odd-records", test_odd_records);
  g_test_add_func("/read-gds/large", test_large);
  return g_test_run();
}
