/* SPDX-License-Identifier: BSD-3-Clause */
/* Layouts with known repetition, steps that correct them, and the flat
   simulation of all displacements of a chip. */
#pragma once

#include <eda/chip.h>
#include <eda/memory.h>
#include <eda/print.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <correct/start.h>
#include "core/plugin/host.h"
#include "tests/step.h"

/* ---- drawings ---- */

typedef struct drawing {
  eda_layout *layout;
  int32_t cell, top;
} drawing;

static void box(const drawing *d, int32_t cell, const char *layer, int32_t x0,
                int32_t y0, int32_t x1, int32_t y1) {
  opc_error error;
  int32_t l = eda_layout_layer(d->layout, layer, &error);
  eda_box b = {x0, y0, x1, y1};
  g_assert_false(eda_layout_add_box(d->layout, cell, l, b, &error));
}

/* Draw two lines over an active, without any symmetry. */
static void draw_cell(const drawing *d) {
  box(d, d->cell, "active", 0, 0, 700, 400);
  box(d, d->cell, "poly", 150, -84, 215, 484);
  box(d, d->cell, "poly", 400, -84, 465, 700);
  box(d, d->cell, "poly", 465, 600, 600, 700);
}

static drawing drawing_new(void) {
  opc_error error;
  drawing d = {.layout = eda_layout_new(1, &error)};
  d.cell = eda_layout_cell(d.layout, "CELL", &error);
  d.top = eda_layout_cell(d.layout, "TOP", &error);
  box(&d, d.top, "nwell", -20000, -20000, -19000, -19000);
  draw_cell(&d);
  return d;
}

static void place_sample(const drawing *d, int32_t x, int32_t y, int mirror,
                         double angle, uint32_t columns) {
  opc_error error;
  eda_placement p = {.origin = {x, y},
                     .magnification = 1,
                     .mirror = (uint32_t)mirror,
                     .angle = angle,
                     .columns = columns,
                     .rows = 1,
                     .column_step = {4000, 0}};
  g_assert_false(
      eda_layout_add_instance(d->layout, d->top, d->cell, &p, NULL, &error));
}

/* Return a layout with all eight orientations, then several more in a row. */
static OPC_UNUSED drawing eight_orientations(void) {
  drawing d = drawing_new();
  for (int k = 0; k < 8; k++)
    place_sample(&d, 4000 * (k % 4), 4000 * (k / 4), k / 4, 90 * (k % 4), 1);
  place_sample(&d, 0, 9000, 0, 0, 4);
  return d;
}

/* ---- steps ---- */

#define MODELS                                                   \
  "litho: { use: litho.hopkins, kernels: 6 }, resist: { use: "   \
  "resist.threshold, anchor: { line: 65 nm, pitch: 250 nm } }, " \
  "extractor: { use: extractor.plain, devices: "                 \
  "'%s' }"

static char *table; /* NULL: ptm65.yaml */
static char *ptm65(void) {
  return g_build_filename(g_getenv("OPCFLOW_SOURCE"), "data", "devices",
                          "ptm65.yaml", NULL);
}

static opc_module *try_to_make(const char *id, const char *more,
                               opc_error *error) {
  g_autofree char *file = table ? g_strdup(table) : ptm65();
  g_autofree char *models = g_strdup_printf(MODELS, file);
  g_autofree char *map = g_strdup_printf("{ %s%s }", models, more);
  return opc_test_module(id, map, error);
}

static opc_module *make_sample(const char *id, const char *more) {
  opc_error error = {0};
  opc_module *m = try_to_make(id, more, &error);
  if (!m) g_error("%s: %s: %s", id, error.parameter, error.message);
  return m;
}

#define NEWTON ", synthesizer: { use: synthesizer.newton, target: plain }"
#define CHEAP NEWTON ", fine: off"

static OPC_UNUSED opc_module *chip_of(const drawing *d, const char *more) {
  g_autofree char *all = g_strconcat(", divide: environments", more, NULL);
  opc_module *m = make_sample("correct", all);
  opc_test_input(m, "layout", d->layout);
  return m;
}

/* ---- the truth ---- */

static eda_gates *flat(const drawing *d) {
  const eda_segment_settings settings = {
      .grid = 1, .overhang = 84, .line_end = 200};
  eda_gates *g;
  eda_segment_report report;
  opc_error error = {0};
  if (eda_segment(NULL, d->layout, d->top, &settings, &g, &report, &error))
    g_error("%s", error.message);
  return g;
}

/* Return the mask of all gates, built from a chip's displacements, as a
   layout. */
static eda_layout *mask_of(const eda_chip *chip, const eda_gates *g) {
  opc_error error = {0};
  eda_layout *out = eda_layout_new(1, &error);
  int32_t cell = eda_layout_cell(out, "MASK", &error);
  eda_moved *moved = eda_chip_moved(chip, g);
  for (size_t k = 0; k < 2; k++) {
    int32_t layer = eda_layout_layer(out, g->layer[k], &error);
    eda_shapes s;
    g_assert_false(correct_start_mask(g, moved, k, &s, &error));
    for (size_t i = 0; i < s.count; i++)
      g_assert_false(
          eda_layout_add_polygon(out, cell, layer, s.points + s.start[i],
                                 s.start[i + 1] - s.start[i], &error));
    eda_shapes_clear(&s);
  }
  eda_moved_free(moved);
  return out;
}

/* Return the largest deviation of a chip's figures from a flat simulation of
   all its masks, %. */
static OPC_UNUSED double off_flat(const drawing *d, const eda_mask *classes,
                                  const char *fine) {
  const eda_chip *chip = classes->chip;
  eda_gates *g = flat(d);
  eda_layout *layout = mask_of(chip, g);
  g_autofree char *more =
      g_strdup_printf(", layers: { poly: poly, active: active }%s", fine);
  opc_module *given = make_sample("given", more);
  opc_test_input(given, "gates", g);
  opc_test_input(given, "mask_layout", layout);
  eda_mask *mask = run_step(given);
  double most = 0;
  g_assert_cmpuint(g->count, ==, chip->count);
  for (size_t i = 0; i < g->count; i++) {
    size_t k = eda_chip_find(chip, g->box[i]);
    g_assert_cmpuint(k, !=, SIZE_MAX);
    size_t p = chip->gate[k].print;
    double as = classes->after.ion[p], drawn = classes->design.ion[p];
    g_assert_cmpfloat(fabs(drawn / mask->design.ion[i] - 1), <, 1e-9);
    most = fmax(most, fabs(eda_deviation(as, mask->after.ion[i])));
  }
  release_sample(given, mask);
  eda_layout_free(layout);
  eda_gates_free(g);
  return most;
}
