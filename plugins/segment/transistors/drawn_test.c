/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests that L and W are as drawn on any mask grid: drawings with known sizes,
   and a circuit compared with its netlist. */
#include <eda/gates.h>
#include <eda/layout.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/data.h"
#include "tools/devel/testing.h"

/* ---- drawing ---- */

typedef struct drawing {
  eda_layout *layout;
  int32_t cell;
} drawing;

static drawing drawing_new(double unit) {
  opc_error error;
  drawing d = {eda_layout_new(unit, &error), 0};
  d.cell = eda_layout_cell(d.layout, "GATE", &error);
  return d;
}

static void box(drawing *d, const char *layer, int32_t x0, int32_t y0,
                int32_t x1, int32_t y1) {
  opc_error error;
  int32_t l = eda_layout_layer(d->layout, layer, &error);
  eda_box b = {x0, y0, x1, y1};
  g_assert_false(eda_layout_add_box(d->layout, d->cell, l, b, &error));
}

/* Draw a poly line of 51 x 1000 units on an active of 600 x 401 from (3, 7). */
static void draw_gate(drawing *d) {
  box(d, "nwell", 5000, 5000, 6000, 6000);
  box(d, "active", 3, 7, 603, 408);
  box(d, "poly", 201, -300, 252, 700);
}

static opc_module *layout_segment(void *layout, void **gates) {
  opc_error error;
  opc_test_forget();
  opc_module *m = opc_test_module("segment.transistors", "{}", &error);
  g_assert_nonnull(m);
  opc_test_input(m, "layout", layout);
  if (opc_test_run(m, gates, &error)) g_error("%s", error.message);
  return m;
}

/* Assert the size of the first gate within `error` nm. */
static void assert_size(drawing *d, double length, double width, double error) {
  void *out;
  opc_module *m = layout_segment(d->layout, &out);
  const eda_gates *g = out;
  g_test_message("L %.6f, W %.6f nm", g->length[0], g->width[0]);
  g_assert_cmpfloat(fabs(g->length[0] - length), <, error);
  g_assert_cmpfloat(fabs(g->width[0] - width), <, error);
  opc_test_release(m, &out);
  opc_test_module_free(m);
}

/* ---- tests ---- */

static void test_unit(void) {
  drawing d = drawing_new(0.65);
  draw_gate(&d);
  assert_size(&d, 51 * 0.65, 401 * 0.65, 1e-9);
  eda_layout_free(d.layout);
}

/* Test rotated and magnified instances, whose corners are between units. */
static void test_magnified(void) {
  opc_error error;
  drawing d = drawing_new(0.5);
  draw_gate(&d);
  int32_t top = eda_layout_cell(d.layout, "TOP", &error);
  eda_placement p = {.origin = {-100, 33},
                     .magnification = 1.037,
                     .angle = 90,
                     .columns = 1,
                     .rows = 1};
  g_assert_false(
      eda_layout_add_instance(d.layout, top, d.cell, &p, NULL, &error));
  assert_size(&d, 51 * 0.5 * 1.037, 401 * 0.5 * 1.037, 0.5 / 16 + 1e-9);
  eda_layout_free(d.layout);
}

/* Test a unit so small that a sixteenth of it cannot represent the layout. */
static void test_fine_unit(void) {
  drawing d = drawing_new(0.0011);
  box(&d, "nwell", 0, 0, 1000, 1000);
  box(&d, "active", 800000000, 0, 800600000, 401000);
  box(&d, "poly", 800200000, -300000, 800251001, 700000);
  assert_size(&d, 51001 * 0.0011, 401000 * 0.0011, 1e-9);
  eda_layout_free(d.layout);
}

/* Test a step below the grid: W is ambiguous and a warning is logged. */
static void test_stepped(void) {
  drawing d = drawing_new(0.1);
  box(&d, "nwell", 50000, 50000, 60000, 60000);
  box(&d, "active", 0, 0, 2300, 4003);
  box(&d, "active", 2300, 0, 6000, 4001);
  box(&d, "poly", 2000, -3000, 2651, 7000);
  assert_size(&d, 65, 400, 1e-9);
  g_assert_nonnull(strstr(opc_test_log(), "1 gate is not drawn as a rect"));
  eda_layout_free(d.layout);
}

/* ---- a circuit against its netlist ---- */

static int by_text(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

static char *size_text(const char *cell, char type, double l, double w) {
  return g_strdup_printf("%s %c %.4f %.4f", cell, type, l, w);
}

/* Read "CELL type L W" lines, in nm times `scale`: the transistors of each cell
   and of all instances. */
static void read_line(const char *line, double scale, char *cell,
                      GPtrArray *devices, GPtrArray *out) {
  const char *w = strstr(line, " W="), *l = strstr(line, " L=");
  const char *last = strrchr(line, ' ');
  (void)sscanf(line, ".SUBCKT %63s", cell);
  if (*line == 'M')
    g_ptr_array_add(devices,
                    size_text(cell, strstr(line, "PMOS") ? 'p' : 'n',
                              1000 * scale * g_ascii_strtod(l + 3, NULL),
                              1000 * scale * g_ascii_strtod(w + 3, NULL)));
  for (guint i = 0; *line == 'X' && i < devices->len; i++) {
    const char *d = devices->pdata[i];
    size_t n = strlen(last + 1);
    if (!strncmp(d, last + 1, n) && d[n] == ' ')
      g_ptr_array_add(out, g_strdup(d));
  }
}

static GPtrArray *read_netlist(const char *path, double scale) {
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
  GPtrArray *out = g_ptr_array_new_with_free_func(g_free);
  g_autoptr(GPtrArray) devices = g_ptr_array_new_with_free_func(g_free);
  char cell[64] = "";
  for (char **line = lines; *line; line++)
    read_line(*line, scale, cell, devices, out);
  qsort(out->pdata, out->len, sizeof *out->pdata, by_text);
  return out;
}

/* Test c432 at scale 1.3: W of 415 nm becomes 539.5 nm, 539 or 540 nm on the
   mask grid. */
static void test_c432(void) {
  g_autofree char *path = find_data("iscas85/c432/c432.gds");
  if (!path) return;
  g_autofree char *map = g_strdup_printf(
      "{ file: '%s', scale: 1.3, layers: { active: 1/0, nwell: 3/0, poly: 9/0 "
      "} }",
      path);
  opc_error error;
  void *layout, *out;
  opc_module *reader = opc_test_module("read.gds", map, &error);
  if (!reader || opc_test_run(reader, &layout, &error))
    g_error("%s", error.message);
  opc_module *m = layout_segment(layout, &out);
  const eda_gates *g = out;
  g_autofree char *netlist = data_path("iscas85/c432/c432.sp");
  g_autoptr(GPtrArray) want = read_netlist(netlist, 1.3);
  g_autoptr(GPtrArray) got = g_ptr_array_new_with_free_func(g_free);
  double off = 0;
  for (size_t i = 0; i < g->count; i++) {
    eda_box b = g->box[i];
    double on_grid = g->grid * (g->axis[i] ? b.x1 - b.x0 : b.y1 - b.y0);
    off = fmax(off, fabs(on_grid - g->width[i]));
    g_ptr_array_add(got, size_text(g->cell[i], "np"[g->type[i]], g -> length[i],
                                   g -> width[i]));
  }
  qsort(got->pdata, got->len, sizeof *got->pdata, by_text);
  g_assert_cmpuint(got->len, ==, want->len);
  for (guint i = 0; i < got->len; i++)
    g_assert_cmpstr(got->pdata[i], ==, want->pdata[i]);
  g_assert_cmpfloat(fabs(off - 0.5), <, 1e-9);
  opc_test_release(m, &out);
  opc_test_module_free(m);
  opc_test_release(reader, &layout);
  opc_test_module_free(reader);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/drawn/unit", test_unit);
  g_test_add_func("/drawn/magnified", test_magnified);
  g_test_add_func("/drawn/fine-unit", test_fine_unit);
  g_test_add_func("/drawn/stepped", test_stepped);
  g_test_add_func("/drawn/c432", test_c432);
  return g_test_run();
}
