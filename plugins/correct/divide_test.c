/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests chips with known repetition against the flat simulation of all their
   displacements. */
#include "plugins/correct/chip_test.h"

/* ---- tests ---- */

/* A cell's transistors are equal in all orientations, and the flat simulation
   of the mask confirms the chip's figures. */
static void test_orientations(void) {
  drawing d = eight_orientations();
  opc_module *m = chip_of(&d, CHEAP ", radius: 800 nm");
  eda_mask *mask = run_step(m);
  eda_chip *chip = mask->chip;
  g_assert_cmpuint(chip->count, ==, 24);
  g_assert_true(opc_test_metric("classes") == 2);
  g_assert_true(opc_test_metric("prints") == 2);
  g_assert_cmpfloat(opc_test_metric("ion_max"), <, 0.5);
  g_assert_cmpfloat(opc_test_metric("ion_mean_drawn"), >, 2);
  double most = off_flat(&d, mask, ", fine: off, margin: 4000 nm");
  g_test_message("off by %.4f %%", most);
  g_assert_cmpfloat(most, <, 0.1);
  release_sample(m, mask);
  eda_layout_free(d.layout);
}

static size_t classes_with(int32_t x, const char *layer) {
  drawing d = eight_orientations();
  if (layer) box(&d, d.top, layer, x, 9000, x + 100, 9100);
  opc_module *m = chip_of(&d, CHEAP ", radius: 800 nm, max_iterations: 0");
  void *mask = run_step(m);
  size_t classes = (size_t)opc_test_metric("classes");
  release_sample(m, mask);
  eda_layout_free(d.layout);
  return classes;
}

/* A marker covers one of the copies: the transistors of this copy have another
   flavour than the transistors in equal environments, and no device table. */
static void test_flavours(void) {
  drawing d = eight_orientations();
  box(&d, d.top, "LVTN", -100, 8900, 1000, 9500);
  g_autoptr(opc_module) m = chip_of(
      &d, CHEAP ", radius: 800 nm, max_iterations: 0, flavours: { lvt: LVTN }");
  opc_error error = {0};
  void *outputs[1];
  opc_test_forget();
  g_assert_cmpint(opc_test_run(m, outputs, &error), ==, OPC_INVALID);
  if (!strstr(error.message, "has no table of flavour 'lvt'"))
    g_error("%s", error.message);
  g_autofree char *one = ptm65(), *text = NULL;
  g_assert_true(g_file_get_contents(one, &text, NULL, NULL));
  g_autofree char *both = g_strconcat(text, "---\nflavour: lvt\n", text, NULL);
  table = g_build_filename(opc_test_folder(), "both.yaml", NULL);
  g_assert_true(g_file_set_contents(table, both, -1, NULL));
  opc_module *good = chip_of(
      &d, CHEAP ", radius: 800 nm, max_iterations: 0, flavours: { lvt: LVTN }");
  void *mask = run_step(good);
  g_assert_true(opc_test_metric("classes") == 4);
  release_sample(good, mask);
  g_clear_pointer(&table, g_free);
  eda_layout_free(d.layout);
}

/* A shape beside one of the copies is within the radius of the copy's first
   transistor (at x 150), beyond the radius of all transistors, or in an unused
   layer. */
static void test_radius(void) {
  g_assert_cmpuint(classes_with(0, NULL), ==, 2);
  g_assert_cmpuint(classes_with(-651 - 100, "poly"), ==, 2);
  g_assert_cmpuint(classes_with(-649 - 100, "poly"), ==, 3);
  g_assert_cmpuint(classes_with(-300, "contact"), ==, 4);
  g_assert_cmpuint(classes_with(-300, "metal1"), ==, 2);
}

/* Return the displacements of one transistor in the row of copies. *odd
   receives the largest |Ion deviation| of the other copies, %. */
static eda_moved *row_moved(const drawing *d, const drawing *row, int rounds,
                            double *odd) {
  g_autofree char *more =
      g_strdup_printf(CHEAP ", radius: 300 nm, rounds: %d", rounds);
  opc_module *m = chip_of(d, more);
  eda_mask *mask = run_step(m);
  eda_chip *chip = mask->chip;
  eda_gates *g = flat(row);
  eda_moved *moved = eda_chip_moved(chip, g);
  *odd = 0;
  for (size_t i = 0; i < chip->count; i++) {
    size_t p = chip->gate[i].print;
    if (chip->gate[i].box.y0 < -5000)
      *odd = fmax(*odd,
                  fabs(eda_deviation(mask->after.ion[p], mask->design.ion[p])));
  }
  g_assert_cmpfloat(off_flat(d, mask, ", fine: off, margin: 4000 nm"), <, 0.1);
  eda_gates_free(g);
  release_sample(m, mask);
  return moved;
}

/* Check that two masks are equal within the tolerance of a jog. A jog of 1 nm
   is up to 400 nm long here; a jog whose length differs by 20 nm changes the
   mean length by 0.05 nm. */
static void expect_same(const eda_moved *a, const eda_moved *b) {
  size_t size = a->gates * sizeof *a->l;
  g_assert_cmpmem(a->l, size, b->l, size);
  g_assert_cmpmem(a->w, size, b->w, size);
  for (size_t i = 0; i < a->gates; i++) {
    g_test_message("jog %d %d", a->jog[i], b->jog[i]);
    g_assert_cmpint(abs(a->jog[i] - b->jog[i]), <, 20);
  }
}

/* A copy with a neighbour beyond the radius is the lowest member of its class.
   The other members receive the same mask as in a row without this copy. The
   copy receives a mask of its own once its deviation has been found. */
static void test_representatives(void) {
  double none, before, after;
  drawing row = drawing_new(), odd = drawing_new();
  place_sample(&row, 0, 0, 0, 0, 5);
  place_sample(&odd, 0, 0, 0, 0, 5);
  place_sample(&odd, 0, -9000, 0, 0, 1);
  box(&odd, odd.top, "active", 800, -9000, 1400, -8600);
  box(&odd, odd.top, "poly", 850, -9084, 915, -8516);
  eda_moved *truth = row_moved(&row, &row, 2, &none);
  eda_moved *first = row_moved(&odd, &row, 0, &before);
  eda_moved *last = row_moved(&odd, &row, 2, &after);
  g_assert_cmpuint(truth->gates, ==, 10);
  expect_same(truth, first);
  expect_same(truth, last);
  g_test_message("others by %.3f %%, %.3f %% with masks of their own", before,
                 after);
  g_assert_cmpfloat(before, >, 0.5);
  g_assert_cmpfloat(after, <, 0.25);
  eda_moved_free(truth);
  eda_moved_free(first);
  eda_moved_free(last);
  eda_layout_free(row.layout);
  eda_layout_free(odd.layout);
}

/* Results are bit-identical for any number of threads. */
static void test_threads(void) {
  drawing d = eight_orientations();
  eda_mask *mask[2];
  opc_module *m[2];
  for (int k = 0; k < 2; k++) {
    opc_set_threads(k ? 3 : 1);
    m[k] = chip_of(&d, NEWTON ", fine: 1e-3, window: 3000 nm");
    mask[k] = run_step(m[k]);
  }
  opc_set_threads(0);
  const eda_chip *a = mask[0]->chip, *b = mask[1]->chip;
  g_assert_cmpuint(a->masks, ==, b->masks);
  g_assert_cmpuint(a->prints, ==, b->prints);
  g_assert_cmpmem(a->mask, a->masks * sizeof(eda_chip_mask), b->mask,
                  b->masks * sizeof(eda_chip_mask));
  for (size_t k = 0; k < a->prints; k++) {
    g_assert_true(mask[0]->after.ion[k] == mask[1]->after.ion[k]);
    g_assert_true(mask[0]->after.ioff[k] == mask[1]->after.ioff[k]);
    g_assert_true(mask[0]->before.ion[k] == mask[1]->before.ion[k]);
  }
  for (int k = 0; k < 2; k++) release_sample(m[k], mask[k]);
  eda_layout_free(d.layout);
}

/* ---- a real one ---- */

static eda_layout *read_sram(opc_module **reader) {
  g_autofree char *file = g_build_filename(g_getenv("OPCFLOW_SOURCE"), "data",
                                           "cells65", "sram4.gds", NULL);
  g_autofree char *map = g_strdup_printf(
      "{ file: '%s', layers: { poly: 9/0, active: 1/0, contact: 10/0, nwell: "
      "3/0 } }",
      file);
  opc_error error = {0};
  *reader = opc_test_module("read.gds", map, &error);
  if (!*reader) g_error("%s", error.message);
  return run_step(*reader);
}

#define REGULATOR                                             \
  ", regulator: { use: regulator.drc, min_extension: 30 nm, " \
  "want_extension: 60 nm }"

/* For all window sizes, the chip is as accurate as the flat correction, and as
   accurate as its reported figures. */
static void test_sram(void) {
  static const char *const windows[] = {"60 um", "1200 nm"};
  opc_module *reader;
  drawing d = {.layout = read_sram(&reader)};
  opc_error error = {0};
  d.top = eda_layout_top(d.layout, &error);
  eda_gates *g = flat(&d);
  opc_module *loop = make_sample("correct", CHEAP REGULATOR);
  opc_test_input(loop, "gates", g);
  eda_mask *whole = run_step(loop);
  double mean = opc_test_metric("ion_mean"), worst = opc_test_metric("ion_max");
  for (size_t k = 0; k < G_N_ELEMENTS(windows); k++) {
    g_autofree char *more =
        g_strdup_printf(CHEAP REGULATOR ", window: %s", windows[k]);
    opc_module *m = chip_of(&d, more);
    eda_mask *mask = run_step(m);
    eda_chip *chip = mask->chip;
    g_test_message("flat %.3f %.3f, chip %.3f %.3f of %g classes", mean, worst,
                   opc_test_metric("ion_mean"), opc_test_metric("ion_max"),
                   opc_test_metric("classes"));
    g_assert_cmpuint(chip->count, ==, g->count);
    /* The mean over twenty classes depends on random rounding to the grid:
       thresholds that differ by 5e-5 result in 0.065, 0.076 and 0.087. */
    g_assert_cmpfloat(opc_test_metric("ion_mean"), <, mean + 0.1);
    g_assert_cmpfloat(opc_test_metric("ion_max"), <, fmax(worst, 0.5));
    g_assert_true(opc_test_metric("worse") == 0);
    double most = off_flat(&d, mask, ", fine: off, margin: 4000 nm");
    g_test_message("off by %.4f %%", most);
    g_assert_cmpfloat(most, <, 0.3);
    release_sample(m, mask);
  }
  release_sample(loop, whole);
  eda_gates_free(g);
  release_sample(reader, d.layout);
}

/* ---- violations ---- */

static const char *const counts[] = {
    "violations",      "violations_unexplained",
    "mask_violations", "mask_space",
    "mask_width",      "mask_edge",
    "mask_jog",        "mask_violations_added"};

/* Each copy has narrow gaps and lines. The report counts as many of them as the
   report of the flat layout, in any orientation and in one row for each
   rule. */
static void test_faults(void) {
  const char *drawn = CHEAP REGULATOR ", max_iterations: 0";
  double all[G_N_ELEMENTS(counts)];
  drawing d = eight_orientations();
  box(&d, d.cell, "poly", 860, 0, 960, 100);
  box(&d, d.cell, "poly", 990, 0, 1090, 100);
  box(&d, d.cell, "poly", 860, 300, 960, 330);
  box(&d, d.cell, "poly", 900, 320, 1000, 335);
  eda_gates *g = flat(&d);
  opc_module *m = make_sample("correct", drawn);
  opc_test_input(m, "gates", g);
  void *output = run_step(m);
  for (size_t k = 0; k < G_N_ELEMENTS(counts); k++)
    all[k] = opc_test_metric(counts[k]);
  release_sample(m, output);
  g_autofree char *more = g_strdup_printf("%s, window: 3000 nm", drawn);
  m = chip_of(&d, more);
  output = run_step(m);
  for (size_t k = 0; k < G_N_ELEMENTS(counts); k++) {
    g_test_message("%s: %g, flat %g", counts[k], opc_test_metric(counts[k]),
                   all[k]);
    g_assert_true(opc_test_metric(counts[k]) == all[k]);
  }
  g_assert_true(opc_test_metric("mask_space") == 12); /* as drawn */
  g_assert_cmpuint(opc_test_table("violations")->rows, <, 8);
  release_sample(m, output);
  eda_gates_free(g);
  eda_layout_free(d.layout);
}

/* Check that added shapes are only where the environments of a class are
   equal. */
static void expect_boxes_within(const eda_chip *c, int32_t radius) {
  g_assert_cmpuint(c->boxes, >, 0);
  for (size_t i = 0; i < c->count; i++) {
    const eda_chip_gate *g = &c->gate[i];
    const eda_chip_mask *m = &c->mask[g->mask];
    eda_box own = eda_chip_own(g->box, g->axis, g->flip, g->box);
    for (uint32_t k = m->box; k < m->box + m->boxes; k++) {
      eda_box b = c->box[k].box;
      g_assert_true(b.x0 >= -radius && b.x1 <= own.x1 + radius &&
                    b.y0 >= -radius && b.y1 <= own.y1 + radius);
    }
  }
}

/* A contact is between two equal transistors at the same distance from both; a
   strip with contacts is below. The left neighbours of the two transistors
   differ, so the right transistor is the representative. The masks repair all
   contacts, as in a flat layout. */
static void test_ties(void) {
  drawing d = drawing_new();
  box(&d, d.top, "active", -4500, -400, 22500, -310);
  for (int32_t x = -4000; x <= 22000; x += 1000)
    box(&d, d.top, "contact", x - 30, -385, x + 30, -325);
  for (int k = 0; k < 3; k++) {
    int32_t x = 9000 * k, side = 100 * k;
    box(&d, d.top, "active", x - 400, 0, x + 400, 200);
    box(&d, d.top, "poly", x - 185, -84, x - 120, 284);
    box(&d, d.top, "poly", x + 120, -84, x + 185, 284);
    box(&d, d.top, "contact", x - 30, 130, x + 30, 190);
    box(&d, d.top, "active", x - 2500, side, x - 1900, side + 400);
    box(&d, d.top, "poly", x - 2180, side - 84, x - 2115, side + 484);
  }
  const char *more = NEWTON
      ", fine: off, margin: 2000 nm, regulator: { use: "
      "regulator.drc, overlay: 20 nm }";
  g_autofree char *top = g_strconcat(more, ", top: TOP, radius: 1100 nm", NULL);
  opc_module *m = chip_of(&d, top);
  eda_mask *mask = run_step(m);
  eda_chip *chip = mask->chip;
  g_test_message("%g classes", opc_test_metric("classes"));
  expect_boxes_within(chip, 1100);
  g_assert_true(opc_test_metric("violations") == 0);
  release_sample(m, mask);
  eda_gates *g = flat(&d);
  m = make_sample("correct", more);
  opc_test_input(m, "gates", g);
  void *whole = run_step(m);
  g_assert_true(opc_test_metric("violations") == 0);
  release_sample(m, whole);
  eda_gates_free(g);
  eda_layout_free(d.layout);
}

/* ---- line ends ---- */

/* Return n transistors, each in a cell. In every third transistor, poly extends
   by 1 nm beyond the active, not by 140 nm, and L is 40 nm, not 65 nm. */
static drawing line_ends(int n) {
  opc_error error;
  drawing d = {.layout = eda_layout_new(1, &error)};
  d.top = eda_layout_cell(d.layout, "TOP", &error);
  box(&d, d.top, "nwell", -20000, -20000, -19000, -19000);
  int32_t cell[] = {eda_layout_cell(d.layout, "SHORT", &error),
                    eda_layout_cell(d.layout, "LONG", &error)};
  for (int k = 0; k < 2; k++) {
    box(&d, cell[k], "active", 0, 0, 465, 400);
    box(&d, cell[k], "poly", 200, k ? -140 : -1, k ? 265 : 240, 540);
  }
  for (int i = 0; i < n; i++) {
    d.cell = cell[i % 3 > 0];
    place_sample(&d, 900 * i, 0, 0, 0, 1);
  }
  return d;
}

/* Correct four transistors. flags[i] and off[i] receive the flags and the
   deviation of Ion, %, of transistor i from the left. */
static void line_ends_correct(const char *divide, const char *more,
                              uint32_t flags[4], double off[4]) {
  drawing d = line_ends(4);
  g_autofree char *all =
      g_strdup_printf(CHEAP ", margin: 2000 nm, divide: %s%s", divide, more);
  opc_module *m = make_sample("correct", all);
  opc_test_input(m, "layout", d.layout);
  eda_mask *mask = run_step(m);
  for (size_t i = 0; i < 4; i++) {
    size_t k = mask->chip ? mask->chip->gate[i].print : i;
    eda_box b = mask->chip ? mask->chip->gate[i].box : mask->gates->box[i];
    int32_t at = b.x0 / 900;
    flags[at] = mask->flags[k];
    off[at] = eda_deviation(mask->after.ion[k], mask->design.ion[k]);
    g_test_message("%s %d: 0x%x, %.3f %%", divide, at, flags[at], off[at]);
  }
  release_sample(m, mask);
  eda_layout_free(d.layout);
}

/* The whole, environments and cells lead to the same flags and about the same
   currents. Transistors with short line ends print with a regulator only. */
static void test_line_ends(void) {
  static const char *const more[] = {"", REGULATOR};
  for (size_t r = 0; r < G_N_ELEMENTS(more); r++) {
    uint32_t flags[4], by[4];
    double off[4], by_off[4];
    line_ends_correct("whole", more[r], flags, off);
    for (int k = 0; k < 2; k++) {
      line_ends_correct(k ? "cells" : "environments", more[r], by, by_off);
      for (int i = 0; i < 4; i++) {
        g_assert_cmpuint(by[i], ==, flags[i]);
        g_assert_cmpint(eda_print_failed(by[i]), ==, !r && i % 3 == 0);
        if (!eda_print_failed(by[i]))
          g_assert_cmpfloat(fabs(by_off[i] - off[i]), <, 0.5);
      }
    }
  }
}

/* If no transistor prints, the finding states no worst deviation. A setting of
   another way to divide is a finding. */
static void test_nothing(void) {
  drawing d = line_ends(1);
  opc_module *m = make_sample("correct", CHEAP
                              ", top: TOP, margin: 1000 nm, divide: whole, "
                              "neighbours: outline, max_iterations: 1");
  opc_test_input(m, "layout", d.layout);
  eda_mask *mask = run_step(m);
  g_assert_true(opc_test_metric("failed") == 1);
  g_assert_nonnull(
      strstr(opc_test_log(), "('max_iterations'): nothing prints"));
  g_assert_nonnull(strstr(opc_test_log(), "'neighbours' has no effect"));
  release_sample(m, mask);
  eda_layout_free(d.layout);
}

/* ---- the decision ---- */

/* Return n transistors in rows; their widths repeat after `period`. */
static drawing row_of_lines(int n, int period) {
  opc_error error;
  drawing d = {.layout = eda_layout_new(1, &error)};
  d.top = eda_layout_cell(d.layout, "TOP", &error);
  box(&d, d.top, "nwell", -20000, -20000, -19000, -19000);
  for (int i = 0; i < n; i++) {
    int32_t x = 500 * (i % 40), y = 2200 * (i / 40), w = 200 + i % period;
    box(&d, d.top, "active", x, y, x + 300, y + w);
    box(&d, d.top, "poly", x + 120, y - 84, x + 185, y + w + 84);
  }
  return d;
}

/* `divide: auto` corrects few transistors and transistors without repetition as
   a whole, and many equal ones by classes. It logs why. */
static void test_auto(void) {
  static const struct {
    int n, period, by_classes;
    const char *words;
  } rows[] = {{900, 1, 0, NULL},
              {1040, 1, 1, "divide: environments, because "},
              {1040, 1040, 0, "divide: whole, because 1040 of 1040 "}};
  for (size_t k = 0; k < G_N_ELEMENTS(rows); k++) {
    drawing d = row_of_lines(rows[k].n, rows[k].period);
    opc_module *m = make_sample(
        "correct", CHEAP ", divide: auto, max_iterations: 0, margin: 500 nm");
    opc_test_input(m, "layout", d.layout);
    eda_mask *mask = run_step(m);
    g_assert_cmpint(mask->chip != NULL, ==, rows[k].by_classes);
    g_assert_cmpfloat(opc_test_metric("transistors"), ==, rows[k].n);
    const char *log = opc_test_log();
    if (!rows[k].words)
      g_assert_null(strstr(log, "divide: "));
    else if (!strstr(log, rows[k].words))
      g_error("'%s' is not in '%s'", rows[k].words, log);
    release_sample(m, mask);
    eda_layout_free(d.layout);
  }
}

/* ---- rejected input ---- */

static void expect_refused(const drawing *d, const char *more,
                           const char *parameter, const char *words) {
  opc_error error = {0};
  void *outputs[1];
  g_autofree char *all = g_strconcat(", divide: environments", more, NULL);
  opc_module *m = try_to_make("correct", all, &error);
  if (m) {
    opc_test_input(m, "layout", d->layout);
    g_assert_cmpint(opc_test_run(m, outputs, &error), !=, OPC_OK);
    opc_test_module_free(m);
  }
  if (!strstr(error.message, words) || !strstr(error.parameter, parameter))
    g_error("%s: '%s' instead of '%s'", error.parameter, error.message, words);
}

static void test_refused(void) {
  drawing d = eight_orientations();
  expect_refused(&d, NEWTON ", radius: 0 nm", "", "above 0 nm");
  expect_refused(&d, NEWTON ", radius: 70 um", "", "expected at most 'window'");
  expect_refused(&d, NEWTON ", window: 100 nm", "", "100 nm");
  expect_refused(&d, NEWTON ", top: NONE", "top", "NONE");
  expect_refused(&d, NEWTON ", also: { metal1: M1 }", "",
                 "layers without transistors");
  expect_refused(&d, ", synthesizer: { use: synthesizer.epe }, fine: off",
                 "divide", "dissects edges");
  drawing none = drawing_new();
  box(&none, none.top, "active", 0, 0, 700, 400);
  box(&none, none.top, "poly", 0, 1000, 700, 1065);
  expect_refused(&none, NEWTON ", top: TOP", "layout", "no transistor");
  eda_layout_free(none.layout);
  eda_layout_free(d.layout);
}

static double memory_of(const drawing *d, const char *divide) {
  g_autofree char *more = g_strdup_printf(CHEAP ", divide: %s", divide);
  opc_module *m = make_sample("correct", more);
  const opc_step *step = m->functions;
  opc_forecast out = {0};
  opc_error error = {0};
  opc_test_input(m, "layout", d->layout);
  g_assert_false(step->forecast(m->self, &out, &error));
  opc_test_module_free(m);
  return out.memory;
}

/* Return a layout with `rows` rows of 100 cells, in which nearly all distances
   of neighbours differ. */
static drawing irregular(int rows) {
  drawing d = drawing_new();
  g_autoptr(GRand) rand = g_rand_new_with_seed(1);
  for (int row = 0; row < rows; row++)
    for (int x = 0, i = 0; i < 100; i++) {
      place_sample(&d, x, 2000 * row, 0, 0, 1);
      x += g_rand_int_range(rand, 800, 1200);
    }
  return d;
}

/* The forecast of a large layout uses a sample. If few environments repeat,
   `auto` requires the memory of the whole; by classes, each class and record
   requires memory. */
static void test_sample(void) {
  drawing d = irregular(70);
  double whole = memory_of(&d, "whole"), by = memory_of(&d, "environments");
  g_assert_cmpfloat(memory_of(&d, "auto"), ==, whole);
  eda_layout_free(d.layout);
  d = irregular(140);
  double more = memory_of(&d, "environments") - by;
  g_assert_cmpfloat(fabs(more / (21000 * 1928.0) - 1), <, 0.1);
  eda_layout_free(d.layout);
}

/* A layout on one sheet needs the memory of the whole; a large one needs that
   of a sheet. `auto` can decide for the whole. */
static void test_forecast(void) {
  drawing d = drawing_new();
  place_sample(&d, 0, 0, 0, 0, 1);
  double whole = memory_of(&d, "whole"), by = memory_of(&d, "environments");
  g_assert_cmpfloat(fabs(by / whole - 1), <, 0.01);
  for (int row = 0; row < 60; row++)
    place_sample(&d, 0, 4000 * (row + 1), 0, 0, 60);
  whole = memory_of(&d, "whole"), by = memory_of(&d, "environments");
  g_assert_cmpfloat(by, <, whole / 3);
  g_assert_cmpfloat(by, >, 1e8);
  g_assert_true(memory_of(&d, "auto") == whole);
  /* If the whole needs too much memory, the decision is for classes. */
  place_sample(&d, 9000000, 9000000, 0, 0, 1);
  g_assert_cmpfloat(memory_of(&d, "whole"), >, 1e10);
  g_assert_true(memory_of(&d, "auto") == memory_of(&d, "environments"));
  eda_layout_free(d.layout);
  /* A row or column longer than the window: the memory of a sheet does not
     depend on the length of the row. */
  for (int k = 0; k < 2; k++) {
    drawing line = drawing_new();
    for (int i = 0; i < 20; i++)
      place_sample(&line, k ? 0 : 4000 * i, k ? 4000 * i : 0, 0, 0, 1);
    double before = memory_of(&line, "environments, window: 4 um");
    place_sample(&line, k ? 0 : 160000, k ? 160000 : 0, 0, 0, 1);
    double after = memory_of(&line, "environments, window: 4 um");
    g_assert_cmpfloat(fabs(after / before - 1), <, 0.01);
    g_assert_cmpfloat(memory_of(&line, "whole"), >, 2 * after);
    eda_layout_free(line.layout);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/chip/ways", test_orientations);
  g_test_add_func("/chip/radius", test_radius);
  g_test_add_func("/chip/flavours", test_flavours);
  g_test_add_func("/chip/representatives", test_representatives);
  g_test_add_func("/chip/ties", test_ties);
  g_test_add_func("/chip/threads", test_threads);
  g_test_add_func("/chip/sram", test_sram);
  g_test_add_func("/chip/faults", test_faults);
  g_test_add_func("/chip/line-ends", test_line_ends);
  g_test_add_func("/chip/nothing", test_nothing);
  g_test_add_func("/chip/auto", test_auto);
  g_test_add_func("/chip/refused", test_refused);
  g_test_add_func("/chip/forecast", test_forecast);
  g_test_add_func("/chip/sample", test_sample);
  return g_test_run();
}
