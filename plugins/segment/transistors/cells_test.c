/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the transistors of the Nangate cells against a list made by KLayout,
   and of the circuit c432. */
#include "drawing_test.h"
#include "tests/data.h"

/* ---- the cell library ---- */

/* Return a reader with its layout. Without test data, skip the test and return
   NULL. */
static opc_module *read_gds(const char *name, double scale, void **layout) {
  g_autofree char *path = find_data(name);
  if (!path) return NULL;
  g_autofree char *map = g_strdup_printf(
      "{ file: '%s', scale: %g, layers: { active: 1/0, pwell: 2/0, nwell: 3/0, "
      "nimplant: 4/0, pimplant: 5/0, poly: 9/0, contact: 10/0 } }",
      path, scale);
  opc_error error;
  opc_module *reader = opc_test_module("read.gds", map, &error);
  if (!reader || opc_test_run(reader, layout, &error))
    g_error("%s", error.message);
  return reader;
}

static int by_text(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Return devices.csv as sorted lines: cell, type, corners in units of 0.5
   nm. */
static GPtrArray *read_devices(void) {
  g_autofree char *path = data_path("nangate45/devices.csv");
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
  GPtrArray *out = g_ptr_array_new_with_free_func(g_free);
  for (char **line = lines + 1; *line && **line; line++) {
    g_auto(GStrv) f = g_strsplit(*line, ",", -1);
    int at[6];
    for (int k = 0; k < 6; k++)
      at[k] = (int)lround(g_ascii_strtod(f[3 + k], NULL) * 2000);
    g_ptr_array_add(
        out, g_strdup_printf("%s %c %d %d %d %d %d %d", f[0],
                             strstr(f[2], "PMOS") ? 'p' : 'n', at[0], at[1],
                             at[2], at[3], at[4], at[5]));
  }
  qsort(out->pdata, out->len, sizeof *out->pdata, by_text);
  return out;
}

static void test_nangate(void) {
  void *layout;
  opc_module *reader =
      read_gds("nangate45/NangateOpenCellLibrary.gds", 1, &layout);
  if (!reader) return;
  g_autoptr(GPtrArray) want = read_devices();
  g_autoptr(GPtrArray) got = g_ptr_array_new_with_free_func(g_free);
  size_t without = 0;
  for (size_t c = 0; c < eda_layout_cells(layout); c++) {
    const char *name = eda_layout_cell_name(layout, (int32_t)c);
    g_autofree char *map = g_strdup_printf("{ top: %s, grid: 0.5 nm }", name);
    opc_error error;
    g_autoptr(opc_module) m =
        opc_test_module("segment.transistors", map, &error);
    opc_test_input(m, "layout", layout);
    void *out;
    int code = opc_test_run(m, &out, &error);
    if (code) {
      g_assert_cmpstr(
          error.message, ==,
          "no transistors: layers 'poly' and 'active' do not overlap");
      without++;
      continue;
    }
    const eda_gates *g = out;
    check_all(g);
    g_assert_cmpfloat(opc_test_metric("snapped"), ==, 0);
    for (size_t i = 0; i < g->count; i++) {
      g_assert_cmpstr(g->cell[i], ==, name);
      g_assert_cmpuint(g->number[i], ==, i + 1);
      g_ptr_array_add(
          got, g_strdup_printf("%s %c %d %d %d %d %d %d", name,
                               "np"[g->type[i]], (int)(2 * g->length[i]),
                               (int)(2 * g->width[i]), g -> box[i].x0,
                               g->box[i].y0, g->box[i].x1, g->box[i].y1));
    }
    opc_test_release(m, &out);
  }
  qsort(got->pdata, got->len, sizeof *got->pdata, by_text);
  g_assert_cmpuint(without, ==, 135 - 127);
  g_assert_cmpuint(got->len, ==, 2590);
  g_assert_cmpuint(got->len, ==, want->len);
  for (guint i = 0; i < got->len; i++)
    g_assert_cmpstr(got->pdata[i], ==, want->pdata[i]);
  opc_test_release(reader, &layout);
  opc_test_module_free(reader);
}

/* Return the space by comparison with every edge. */
static double slow_space(const eda_gates *g, size_t i, int side) {
  double away[2] = {INFINITY, INFINITY};
  const eda_box *b = &g->box[i];
  int x = g->axis[i] == EDA_X;
  double from = x ? (side ? b->x1 : b->x0) : (side ? b->y1 : b->y0);
  double middle = x ? (b->y0 + b->y1) / 2. : (b->x0 + b->x1) / 2.;
  for (int layer = 0; layer < 2; layer++)
    for (size_t p = 0; p < g->drawn[layer].count; p++) {
      const eda_shapes *s = &g->drawn[layer];
      for (uint32_t k = s->start[p]; k < s->start[p + 1]; k++) {
        eda_point u = s->points[k];
        eda_point v = s->points[k + 1 < s->start[p + 1] ? k + 1 : s->start[p]];
        double at = x ? u.x : u.y, low = x ? MIN(u.y, v.y) : MIN(u.x, v.x),
               high = x ? MAX(u.y, v.y) : MAX(u.x, v.x);
        if (at != (x ? v.x : v.y) || middle < low || middle >= high) continue;
        double far = side ? at - from : from - at;
        if (far > 0) away[layer] = fmin(away[layer], far);
      }
    }
  return fmin(away[EDA_POLY], 2 * fmax(away[EDA_ACTIVE], g->length[i]));
}

static void test_c432(void) {
  void *layout;
  opc_module *reader = read_gds("iscas85/c432/c432.gds", 1.3, &layout);
  if (!reader) return;
  opc_test_forget();
  result r = layout_segment(layout, "{}");
  const eda_gates *g = r.gates;
  check_all(g);
  g_assert_cmpuint(g->count, ==, 820);
  g_assert_cmpfloat(opc_test_metric("transistors"), ==, 820);
  g_assert_cmpfloat(opc_test_metric("nmos"), ==, 410);
  g_assert_cmpfloat(opc_test_metric("snapped"), >, 0);
  g_assert_cmpfloat(opc_test_metric("snapped_worst"), <=, 0.5 * sqrt(2) + 1e-9);
  g_assert_nonnull(strstr(opc_test_log(), "vertices of layer 'poly'"));
  for (size_t i = 0; i < g->count; i++) {
    g_assert_cmpfloat(g->length[i], ==, 65);
    g_assert_true(g->instance[i][0] == 'U');
    for (int side = 0; side < 2; side++)
      g_assert_cmpfloat(g->space[2 * i + side], ==, slow_space(g, i, side));
  }
  result_free(&r);
  opc_test_release(reader, &layout);
  opc_test_module_free(reader);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/transistors/nangate", test_nangate);
  g_test_add_func("/transistors/c432", test_c432);
  return g_test_run();
}
