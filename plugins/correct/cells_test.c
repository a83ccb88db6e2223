/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests masks of cells, placed in a layout, against the correction of the cell
   alone and the flat simulation of the layout. */
#include <environments/align.c>
#include "plugins/correct/chip_test.h"

static opc_module *cells_of(const drawing *d, const char *more) {
  g_autofree char *all = g_strconcat(", divide: cells", more, NULL);
  opc_module *m = make_sample("correct", all);
  opc_test_input(m, "layout", d->layout);
  return m;
}

/* Return the placements of a drawing, with another cell, as a layout. */
static eda_layout *placed_as(const drawing *d, const eda_mask *cell) {
  opc_error error = {0};
  eda_layout *out = eda_layout_new(1, &error);
  int32_t to = eda_layout_cell(out, "CELL", &error),
          top = eda_layout_cell(out, "TOP", &error);
  for (size_t k = 0; k < 2; k++) {
    const eda_shapes *s = &cell->shapes[k];
    int32_t layer = eda_layout_layer(out, cell->gates->layer[k], &error);
    for (size_t i = 0; i < s->count; i++)
      g_assert_false(
          eda_layout_add_polygon(out, to, layer, s->points + s->start[i],
                                 s->start[i + 1] - s->start[i], &error));
  }
  for (size_t i = 0; i < eda_layout_instances(d->layout, d->top); i++) {
    int32_t from;
    eda_placement p;
    (void)eda_layout_instance(d->layout, d->top, i, &from, &p);
    g_assert_false(eda_layout_add_instance(out, top, to, &p, NULL, &error));
  }
  return out;
}

/* Check that all layers of two layouts are equal. */
static void expect_equal(const eda_layout *a, const eda_layout *b) {
  static const char *const layers[] = {"poly", "active"};
  const eda_layout *const from[] = {a, b};
  for (size_t k = 0; k < G_N_ELEMENTS(layers); k++) {
    eda_flat flat[2];
    eda_shapes odd;
    opc_error error = {0};
    for (int i = 0; i < 2; i++)
      g_assert_false(eda_layout_flatten(
          from[i], eda_layout_top(from[i], &error),
          eda_layout_find_layer(from[i], layers[k]), 1, &flat[i], &error));
    g_assert_cmpuint(flat[0].shapes.count, >, 0);
    g_assert_false(
        eda_boolean(EDA_XOR, &flat[0].shapes, &flat[1].shapes, &odd, &error));
    g_assert_cmpuint(odd.count, ==, 0);
    eda_shapes_clear(&odd);
    eda_flat_clear(&flat[0]);
    eda_flat_clear(&flat[1]);
  }
}

/* Correct the cell of a drawing alone, by the loop for whole layouts. */
static eda_mask *cell_alone(const drawing *d, const char *more,
                            opc_module **loop) {
  drawing one = {d->layout, d->cell, d->cell};
  eda_gates *g = flat(&one);
  *loop = make_sample("correct", more);
  opc_test_input(*loop, "gates", g);
  return run_step(*loop);
}

/* Without neighbours, the mask of the layout consists of masks of the cell in
   all orientations, corner by corner, and prints as in the cell. */
static void test_orientations(void) {
  static const char *const more = CHEAP
      ", margin: 2000 nm, regulator: { use: regulator.drc, "
      "min_extension: 30 nm, want_extension: 60 nm }";
  drawing d = eight_orientations();
  opc_module *loop;
  eda_mask *alone = cell_alone(&d, more, &loop);
  g_autofree char *placed = g_strconcat(more, ", verify: false", NULL);
  opc_module *m = cells_of(&d, placed);
  eda_mask *mask = run_step(m);
  g_assert_cmpuint(mask->chip->count, ==, 24);
  g_assert_true(opc_test_metric("cells") == 1);
  g_assert_true(opc_test_metric("outside_cells") == 0);
  eda_gates *g = flat(&d);
  eda_layout *found = mask_of(mask->chip, g), *expected = placed_as(&d, alone);
  expect_equal(found, expected);
  g_assert_cmpfloat(opc_test_metric("ion_max"), <, 0.5);
  double most = off_flat(&d, mask, ", fine: off, margin: 4000 nm");
  g_test_message("off by %.4f %%", most);
  g_assert_cmpfloat(most, <, 0.1);
  eda_layout_free(found);
  eda_layout_free(expected);
  eda_gates_free(g);
  g = (eda_gates *)alone->gates;
  release_sample(m, mask);
  release_sample(loop, alone);
  eda_gates_free(g);
  eda_layout_free(d.layout);
}

#define DPB ", synthesizer: { use: synthesizer.dpb }"

static double simulations; /* number of simulations of the last pair */

/* Two cells, side by side, disturb each other. Return the largest |Ion
   deviation| of the flat simulation, %. */
static double pair_off(const char *by, const char *more, double *refined) {
  drawing d = drawing_new();
  place_sample(&d, 0, 0, 0, 0, 1);
  place_sample(&d, 760, 0, 0, 0, 1);
  g_autofree char *all =
      g_strconcat(by, ", fine: 1e-4, margin: 2000 nm", more, NULL);
  opc_module *m = cells_of(&d, all);
  eda_mask *mask = run_step(m);
  double most = 0;
  *refined = opc_test_metric("refined");
  simulations = opc_test_metric("simulations");
  g_assert_cmpuint(mask->chip->count, ==, 4);
  g_assert_cmpfloat(off_flat(&d, mask, ", fine: 1e-4, margin: 4000 nm"), <,
                    0.3);
  for (size_t k = 0; k < mask->gates->count; k++)
    most = fmax(most,
                fabs(eda_deviation(mask->after.ion[k], mask->design.ion[k])));
  release_sample(m, mask);
  eda_layout_free(d.layout);
  return most;
}

/* Transistors that neighbours disturb by more than `max_diff` are refined. The
   flat simulation confirms the figures of fast simulations, multiplied by the
   ratio of the models in the cell, and of accurate simulations. */
static void test_refined(void) {
  double n;
  g_assert_cmpfloat(pair_off(NEWTON, ", max_diff: 100 %", &n), >, 1);
  g_assert_true(n == 0);
  g_assert_cmpfloat(pair_off(NEWTON, ", max_diff: 0.5 %", &n), <, 1);
  g_assert_true(n >= 1 && n < 4);
  g_assert_cmpfloat(pair_off(NEWTON, "", &n), <, 0.5);
  g_assert_true(n >= 1);
}

/* A synthesizer that continues from the simulated mask starts from the placed
   masks. All masks stay if the limit exceeds the disturbances, but not the
   deviations of the drawn mask, which are larger. The refinement ends when all
   transistors are within their limits. */
static void test_continued(void) {
  double n;
  g_assert_cmpfloat(pair_off(DPB, ", max_diff: 6 %", &n), >, 1);
  g_assert_true(n == 0);
  g_assert_cmpfloat(pair_off(DPB, ", max_diff: 0.2 %", &n), <, 0.7);
  g_assert_true(n >= 1 && n <= 4);
  (void)pair_off(DPB, ", max_diff: 0.05 %, ion_limit: 0.1 %", &n);
  double all = simulations,
         most = pair_off(DPB, ", max_diff: 1 %, ion_limit: 0.1 %", &n);
  g_test_message("%.3f %%, %g of %g simulations", most, simulations, all);
  g_assert_true(most > 0.2 && most < 1.2);
  g_assert_true(n >= 1 && simulations < all);
}

/* Return the largest |Ion deviation| in the middle of rows of cells, with the
   masks of the cell, %. */
static double rows_off(const char *more) {
  drawing d = drawing_new();
  double most = 0;
  box(&d, d.cell, "outline", -100, -200, 800, 800);
  for (int row = 0; row < 5; row++) /* mirrored about y = 800, 1800 ... */
    for (int column = 0; column < 5; column++)
      place_sample(&d, 900 * column, row % 2 ? 600 + 1000 * row : 1000 * row,
                   row % 2, 0, 1);
  g_autofree char *all = g_strconcat(
      CHEAP ", margin: 2000 nm, max_diff: 0 %, rounds: 0", more, NULL);
  opc_module *m = cells_of(&d, all);
  eda_mask *mask = run_step(m);
  g_assert_cmpuint(mask->chip->count, ==, 50);
  for (size_t i = 0; i < mask->chip->count; i++) {
    const eda_chip_gate *g = &mask->chip->gate[i];
    size_t k = g->print;
    if (g->box.x0 > 1800 && g->box.x0 < 2600 && g->box.y0 > 1800 &&
        g->box.y0 < 2800)
      most = fmax(most,
                  fabs(eda_deviation(mask->after.ion[k], mask->design.ion[k])));
  }
  release_sample(m, mask);
  eda_layout_free(d.layout);
  return most;
}

/* In rows of one cell, the masks of the cell among copies of itself print as in
   these copies; those of the cell alone do not. */
static void test_neighbours(void) {
  double alone = rows_off(""), among = rows_off(", neighbours: outline");
  g_test_message("%.3f %% alone, %.3f %% among copies", alone, among);
  g_assert_cmpfloat(alone, >, 0.5);
  g_assert_cmpfloat(among, <, 0.2);
}

/* A transistor of the top cell is corrected in place. */
static void test_outside(void) {
  drawing d = eight_orientations();
  box(&d, d.top, "active", -6000, 0, -5300, 400);
  box(&d, d.top, "poly", -5800, -84, -5735, 484);
  opc_module *m = cells_of(&d, CHEAP ", margin: 2000 nm");
  eda_mask *mask = run_step(m);
  g_assert_cmpuint(mask->chip->count, ==, 25);
  g_assert_true(opc_test_metric("outside_cells") == 1);
  g_assert_cmpfloat(opc_test_metric("ion_max"), <, 0.5);
  release_sample(m, mask);
  eda_layout_free(d.layout);
}

/* Return the shape added to poly after its alignment, with a line end of the
   first gate at y = -94. */
static eda_box aligned(const eda_gates *g, int placed, eda_box b) {
  const eda_chip chip = {.placed = placed};
  eda_moved *m = eda_moved_new(g->layers, g->count);
  m->end[0] = 10;
  eda_box_list_add(&m->added[EDA_POLY], b);
  align_boxes(&chip, g, m);
  b = m->added[EDA_POLY].box[0];
  eda_moved_free(m);
  return b;
}

/* A side of an added shape that is one step inside of a mask edge moves onto
   the edge, if the mask is that of a cell. Other sides stay, for example those
   of a head that is one step wider than the line. */
static void test_aligned(void) {
  static const struct {
    int placed;
    eda_box from, to;
  } cases[] = {{1, {500, 601, 640, 699}, {500, 600, 640, 700}},
               {0, {500, 601, 640, 699}, {500, 601, 640, 699}},
               {1, {500, 600, 640, 701}, {500, 600, 640, 701}},
               {1, {500, 602, 640, 698}, {500, 602, 640, 698}},
               {1, {140, -93, 225, -60}, {140, -94, 225, -60}},
               {1, {149, -94, 216, -60}, {149, -94, 216, -60}}};
  drawing d = drawing_new();
  place_sample(&d, 0, 0, 0, 0, 1);
  eda_gates *g = flat(&d);
  g_assert_cmpint(g->box[0].x0, ==, 150);
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    eda_box to = aligned(g, cases[k].placed, cases[k].from);
    g_assert_cmpmem(&to, sizeof to, &cases[k].to, sizeof to);
  }
  eda_gates_free(g);
  eda_layout_free(d.layout);
}

static void expect_refused(const char *more, const char *words) {
  opc_error error = {0};
  g_autofree char *all = g_strconcat(NEWTON, more, NULL);
  if (try_to_make("correct", all, &error) || !strstr(error.message, words))
    g_error("'%s' instead of '%s'", error.message, words);
}

static void test_refused(void) {
  expect_refused(", divide: environments, verify: false", "'divide: cells'");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/cells/orientations", test_orientations);
  g_test_add_func("/cells/refined", test_refined);
  g_test_add_func("/cells/continued", test_continued);
  g_test_add_func("/cells/neighbours", test_neighbours);
  g_test_add_func("/cells/outside", test_outside);
  g_test_add_func("/cells/aligned", test_aligned);
  g_test_add_func("/cells/refused", test_refused);
  return g_test_run();
}
