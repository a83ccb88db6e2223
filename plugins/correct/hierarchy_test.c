/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests masks of chips as layouts with cells against the flat mask: the
   difference is empty, by the internal booleans and by KLayout. */
#include <eda/chip.h>
#include <eda/memory.h>
#include <eda/segment.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <stdlib.h>
#include <string.h>

#include <correct/classes.h>
#include <correct/start.h>
#include "tools/devel/testing.h"

/* ---- a layout ---- */

static void box(eda_layout *layout, int32_t cell, const char *layer, int32_t x0,
                int32_t y0, int32_t x1, int32_t y1) {
  opc_error e;
  int32_t l = eda_layout_layer(layout, layer, &e);
  g_assert_false(
      eda_layout_add_box(layout, cell, l, (eda_box){x0, y0, x1, y1}, &e));
}

static void place_sample(eda_layout *layout, int32_t in, int32_t cell,
                         int32_t x, int32_t y, int orientation,
                         uint32_t columns, uint32_t rows) {
  opc_error e;
  eda_placement p = {.origin = {x, y},
                     .magnification = 1,
                     .angle = 90 * (orientation % 4),
                     .mirror = (uint32_t)orientation / 4,
                     .columns = columns,
                     .rows = rows,
                     .column_step = {1500, 0},
                     .row_step = {0, 1300}};
  g_assert_false(eda_layout_add_instance(layout, in, cell, &p, NULL, &e));
}

/* Return a layout of blocks of 30 x 20 cells that overlap at their seams, in
   all eight orientations. The cell has two transistors whose poly extends
   beyond the cell. The layout also has a ring around a hole, a line over all
   rows, and a cell within a cell. */
static eda_layout *draw_sample(double unit) {
  opc_error e;
  eda_layout *layout = eda_layout_new(unit, &e);
  int32_t top = eda_layout_cell(layout, "TOP", &e);
  int32_t cell = eda_layout_cell(layout, "BIT", &e);
  int32_t block = eda_layout_cell(layout, "BLOCK", &e);
  int32_t over = eda_layout_cell(layout, "OVER", &e);
  box(layout, top, "nwell", -900, -900, -800, -800);
  box(layout, cell, "active", 0, 0, 700, 400);
  box(layout, cell, "poly", 150, -84, 215, 484);
  box(layout, cell, "poly", 400, -84, 465, 700);
  box(layout, cell, "poly", 465, 600, 1600, 700);
  box(layout, cell, "contact", 20, 20, 80, 80);
  place_sample(layout, block, cell, 0, 0, 0, 30, 20);
  place_sample(layout, top, block, 0, 0, 0, 1, 1);
  place_sample(layout, top, block, 45000, 0, 0, 1, 1);
  for (int orientation = 0; orientation < 8; orientation++)
    place_sample(layout, top, cell, orientation * 3000, -9000, orientation, 1,
                 1);
  box(layout, over, "poly", 3000, 0, 3065, 900);
  place_sample(layout, over, cell, 0, 0, 4, 1, 1);
  place_sample(layout, top, over, 5000, -20000, 1, 3, 1);
  box(layout, top, "active", -5000, -5000, 120000, -4900);
  box(layout, top, "active", -5000, 40000, 120000, 40100);
  box(layout, top, "active", -5000, -5000, -4900, 40100);
  box(layout, top, "active", 119900, -5000, 120000, 40100);
  box(layout, top, "poly", -4000, 550, 110000, 590);
  return layout;
}

/* ---- a chip ---- */

static const eda_segment_settings usual = {
    .grid = 1, .overhang = 84, .line_end = 200};

static eda_gates *flat(const eda_layout *layout) {
  eda_gates *g;
  eda_segment_report report;
  opc_error error;
  if (eda_segment(NULL, layout, 0, &usual, &g, &report, &error))
    g_error("%s", error.message);
  return g;
}

/* Return a corrected chip: most transistors of equal size have one mask, some
   have other masks; added shapes and cut-outs extend beyond the cell. */
static eda_chip *chip_of(const eda_layout *layout, const eda_gates *g,
                         GRand *rand) {
  enum { MASKS = 5, BOXES = 3 };
  eda_chip *c = eda_alloc(1, sizeof *c);
  *c = (eda_chip){.layout = layout,
                  .segment = usual,
                  .grid = 1,
                  .extent = g->extent,
                  .layers = g->layers,
                  .count = g->count,
                  .masks = MASKS,
                  .prints = 1,
                  .boxes = BOXES};
  c->layer = eda_alloc(g->layers, sizeof *c->layer);
  c->corrected = eda_alloc(g->layers, 1);
  for (size_t k = 0; k < g->layers; k++) {
    c->layer[k] = strdup(g->layer[k]);
    c->corrected[k] = g->corrected[k];
  }
  c->mask = eda_alloc(MASKS, sizeof *c->mask);
  c->box = eda_alloc(BOXES, sizeof *c->box);
  for (size_t i = 0; i < BOXES; i++) {
    int x = g_rand_int_range(rand, -90, 90), y = g_rand_int_range(rand, -90, 9);
    c->box[i] = (eda_chip_box){{x, y, x + 30, y + 20}, i > 1, i % 2};
  }
  for (int i = 0; i < MASKS; i++)
    c->mask[i] = (eda_chip_mask){.w = g_rand_int_range(rand, -9, 20),
                                 .l = g_rand_int_range(rand, -9, 20),
                                 .end = {i, 2 * i},
                                 .box = 0,
                                 .boxes = i % 2 ? BOXES : 0};
  c->gate = eda_alloc(g->count, sizeof *c->gate);
  for (size_t i = 0; i < g->count; i++)
    c->gate[i] = (eda_chip_gate){
        .box = g->box[i],
        .type = g->type[i],
        .axis = g->axis[i],
        .mask = i % 97 ? g->box[i].x0 % 2 ? 1 : 3 : (uint32_t)(i % MASKS)};
  opc_error error;
  if (eda_chip_check(c, &error)) g_error("%s", error.message);
  return c;
}

/* ---- the truth ---- */

/* Compute the flat mask of a layer, or its drawn shapes. */
static eda_shapes mask_of(const eda_chip *chip, const eda_gates *g, size_t k,
                          int drawn) {
  opc_error error;
  eda_shapes s;
  eda_moved *moved = eda_chip_moved(chip, g);
  int code = g->corrected[k] && !drawn
                 ? correct_start_mask(g, moved, k, &s, &error)
                 : eda_boolean(EDA_OR, &g->drawn[k], NULL, &s, &error);
  if (code) g_error("%s", error.message);
  eda_moved_free(moved);
  return s;
}

/* Check that the layers of a flattened layout equal these shapes. */
static void check_same(const eda_layout *made, const eda_chip *chip,
                       const eda_gates *g, int drawn) {
  opc_error error;
  for (size_t k = 0; k < g->layers; k++) {
    eda_flat all;
    eda_shapes want = mask_of(chip, g, k, drawn), differ;
    int32_t layer = eda_layout_find_layer(made, g->layer[k]);
    int32_t top = eda_layout_top(made, &error);
    g_assert_cmpint(top, >=, 0);
    g_assert_false(
        eda_layout_flatten(made, top, layer, chip->grid, &all, &error));
    g_assert_false(eda_boolean(EDA_XOR, &all.shapes, &want, &differ, &error));
    g_assert_cmpuint(want.count, >, 3);
    g_assert_cmpuint(differ.count, ==, 0);
    eda_shapes_clear(&want);
    eda_shapes_clear(&differ);
    eda_flat_clear(&all);
  }
}

/* ---- KLayout ---- */

/* The script runs in the program (klayout -zz) and with the Python module. */
static const char script[] =
    "try:\n"
    "  import pya as k\n"
    "except ImportError:\n"
    "  import klayout.db as k\n"
    "import os\n"
    "def read(name):\n"
    "  l = k.Layout(); l.read(os.environ['RUN'] + '/' + name)\n"
    "  return l\n"
    "a, b = read('made.oas'), read('flat.oas')\n"
    "for n in (9, 1, 10):\n"
    "  r = [k.Region(l.top_cell().begin_shapes_rec(l.layer(n, 0))) for l in "
    "(a, b)]\n"
    "  print('layer', n, 'there' if r[1].area() > 0 else 'empty', (r[0] ^ "
    "r[1]).area())\n"
    "print('end')\n";

static void write_oasis(void *layout, const char *file) {
  opc_error error;
  g_autofree char *map = g_strdup_printf(
      "{ file: %s, layers: { poly: 9/0, active: 1/0, contact: 10/0 } }", file);
  opc_module *m = opc_test_module("write.oasis", map, &error);
  if (!m) g_error("%s", error.message);
  opc_test_input(m, "layout", layout);
  if (opc_test_run(m, NULL, &error)) g_error("%s", error.message);
  opc_test_module_free(m);
}

static eda_layout *flat_layout(const eda_chip *chip, const eda_gates *g) {
  opc_error error;
  eda_layout *out = eda_layout_new(chip->grid, &error);
  int32_t cell = eda_layout_cell(out, "FLAT", &error);
  for (size_t k = 0; k < g->layers; k++) {
    eda_shapes s = mask_of(chip, g, k, 0);
    int32_t layer = eda_layout_layer(out, g->layer[k], &error);
    eda_box *boxes;
    size_t n;
    g_assert_false(eda_fracture(&s, &boxes, &n, &error));
    for (size_t i = 0; i < n; i++)
      g_assert_false(eda_layout_add_box(out, cell, layer, boxes[i], &error));
    free(boxes);
    eda_shapes_clear(&s);
  }
  return out;
}

/* Compare both files with KLayout. Returns its output, or NULL without
   KLayout. */
static char *ask_klayout(void) {
  g_autofree char *program = g_find_program_in_path("klayout");
  g_autofree char *path = g_build_filename(opc_test_folder(), "ask.py", NULL);
  if (!program) return NULL;
  g_assert_true(g_file_set_contents(path, script, -1, NULL));
  g_auto(GStrv) environment = g_get_environ();
  environment = g_environ_setenv(environment, "RUN", opc_test_folder(), TRUE);
  environment =
      g_environ_setenv(environment, "QT_QPA_PLATFORM", "offscreen", TRUE);
  const char *const argv[] = {program, "-zz", "-r", path, NULL};
  char *out = NULL;
  int status = 0;
  GError *e = NULL;
  if (!g_spawn_sync(NULL, (char **)argv, environment, 0, NULL, NULL, &out, NULL,
                    &status, &e))
    g_error("%s", e->message);
  g_assert_cmpint(status, ==, 0);
  return out;
}

/* ---- tests ---- */

static const eda_layout *hierarchy_of(eda_chip *chip, int drawn) {
  static const opc_host host = {0};
  static const classes_source source = {.host = &host};
  opc_error error;
  const eda_layout *made, *again;
  eda_mask *m = eda_chip_mask_new(chip);
  correct_classes_access(m, &source);
  if (m->access->layout(m, drawn, &made, &error)) g_error("%s", error.message);
  if (m->access->layout(m, drawn, &again, &error)) g_error("%s", error.message);
  g_assert_true(made == again);
  m->chip = NULL;
  eda_mask_free(m);
  return made;
}

/* Return the number of placed cells in the top cell; *references receives the
   number of arrays and single references. */
static size_t count_placed(const eda_layout *made, size_t *references) {
  opc_error error;
  eda_placement p;
  int32_t child, top = eda_layout_top(made, &error);
  size_t placed = 0;
  *references = eda_layout_instances(made, top);
  for (size_t i = 0; i < *references; i++) {
    eda_layout_instance(made, top, i, &child, &p);
    placed += (size_t)p.columns * p.rows;
  }
  return placed;
}

static void test_same(void) {
  GRand *rand = g_rand_new_with_seed(3);
  for (int round = 0; round < 3; round++) {
    eda_layout *layout = draw_sample(round == 2 ? 0.9 : 1);
    eda_gates *g = flat(layout);
    eda_chip *chip = chip_of(layout, g, rand);
    const eda_layout *made = hierarchy_of(chip, 0);
    check_same(made, chip, g, 0);
    check_same(hierarchy_of(chip, 1), chip, g, 1);
    size_t references, placed = count_placed(made, &references);
    g_assert_cmpuint(placed, ==, 1200 + 8 + 3);
    g_test_message("%zu cells, %zu references", eda_layout_cells(made),
                   references);
    if (round < 2) {
      g_assert_cmpuint(eda_layout_cells(made), <, 121);
      g_assert_cmpuint(references, <, placed / 4);
    }
    eda_chip_free(chip);
    eda_gates_free(g);
    eda_layout_free(layout);
  }
  g_rand_free(rand);
}

static void test_klayout(void) {
  GRand *rand = g_rand_new_with_seed(4);
  eda_layout *layout = draw_sample(1);
  eda_gates *g = flat(layout);
  eda_chip *chip = chip_of(layout, g, rand);
  eda_layout *all = flat_layout(chip, g);
  const eda_layout *made = hierarchy_of(chip, 0);
  write_oasis((void *)made, "made.oas");
  write_oasis(all, "flat.oas");
  g_autofree char *answer = ask_klayout();
  if (answer)
    g_assert_cmpstr(answer, ==,
                    "layer 9 there 0\nlayer 1 there 0\nlayer 10 there 0\n"
                    "end\n");
  else
    g_test_skip("KLayout is not installed");
  eda_layout_free(all);
  eda_chip_free(chip);
  eda_gates_free(g);
  eda_layout_free(layout);
  g_rand_free(rand);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/layout/same", test_same);
  g_test_add_func("/layout/klayout", test_klayout);
  return g_test_run();
}
