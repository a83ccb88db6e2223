/* SPDX-License-Identifier: BSD-3-Clause */
/* Helpers for unit tests of library.*: two cells of one transistor each, and
   the steps that build a library from these cells. */
#pragma once

#include <eda/gates.h>
#include <eda/layout.h>
#include <string.h>

#include "tests/data.h"
#include "tools/devel/testing.h"

#define LIBRARY_NA "0.75"
#define LIBRARY_MODELS(na)                                                    \
  "litho: { use: litho.hopkins, wavelength: 193 nm, na: " na                  \
  ", sigma: 0.75 }, resist: { use: resist.threshold, anchor: { line: 65 nm, " \
  "pitch: 250 nm } }, extractor: { use: extractor.plain, devices: '%s' }, "   \
  "fine: off"

/* A finished step with its output. */
typedef struct ran {
  opc_module *module;
  void *out;
} ran;

static inline void ran_clear(ran *r) {
  if (r->module) opc_test_release(r->module, &r->out);
  opc_test_module_free(r->module);
}

/* Run a step with up to three inputs: `names`, NULL-terminated, and
   `objects`. */
static inline int run_step(ran *r, const char *id, const char *mapping,
                           const char *const *names, void *const *objects,
                           opc_error *error) {
  *error = (opc_error){0};
  opc_test_forget();
  *r = (ran){opc_test_module(id, mapping, error), NULL};
  if (!r->module) return error->code;
  for (size_t i = 0; names[i]; i++)
    opc_test_input(r->module, names[i], objects[i]);
  return opc_test_run(r->module, &r->out, error);
}

static inline void add_box(eda_layout *l, int32_t cell, const char *layer,
                           eda_box b) {
  opc_error error;
  int32_t k = eda_layout_layer(l, layer, &error);
  g_assert_cmpint(eda_layout_add_box(l, cell, k, b, &error), ==, OPC_OK);
}

/* Add a transistor: a vertical line of poly, L nm long, `wide` nm of active. */
static inline int32_t add_transistor(eda_layout *l, const char *name,
                                     int32_t length, int32_t wide) {
  opc_error error;
  int32_t c = eda_layout_cell(l, name, &error);
  add_box(l, c, "active", (eda_box){0, 0, 400, wide});
  add_box(l, c, "poly", (eda_box){150, -120, 150 + length, wide + 110});
  add_box(l, c, "nimplant", (eda_box){-50, -50, 450, wide + 50});
  add_box(l, c, "outline", (eda_box){-100, -200, 500, wide + 200});
  return c;
}

static inline void add_cell(eda_layout *l, int32_t top, int32_t cell,
                            const char *name, int32_t x, int mirror) {
  opc_error error;
  eda_placement p = {.origin = {x, 0},
                     .magnification = 1,
                     .mirror = (uint32_t)mirror,
                     .columns = 1,
                     .rows = 1};
  g_assert_cmpint(eda_layout_add_instance(l, top, cell, &p, name, &error), ==,
                  OPC_OK);
}

/* Return a circuit with two placements of the cell "long", one of them
   mirrored, and one of "wide". The cells are too far apart to interact. */
static inline eda_layout *library_circuit(void) {
  opc_error error;
  eda_layout *l = eda_layout_new(1, &error);
  int32_t one = add_transistor(l, "long", 70, 200);
  int32_t two = add_transistor(l, "wide", 65, 450);
  int32_t top = eda_layout_cell(l, "top", &error);
  add_cell(l, top, one, "X1", 0, 0);
  add_cell(l, top, one, "X2", 8000, 1);
  add_cell(l, top, two, "X3", 16000, 0);
  return l;
}

static inline ran layout_segment(eda_layout *l) {
  ran r;
  opc_error error;
  if (run_step(&r, "segment.transistors", "{ grid: 1 nm }",
               (const char *const[]){"layout", NULL}, (void *[]){l}, &error))
    g_error("%s", error.message);
  return r;
}

static inline ran sheet_of(eda_layout *l, const char *mapping) {
  ran r;
  opc_error error;
  if (run_step(&r, "library.sheet", mapping,
               (const char *const[]){"layout", NULL}, (void *[]){l}, &error))
    g_error("%s", error.message);
  return r;
}

/* Return the parameters of a step: the models and `more`. */
static inline char *library_map(const char *models, const char *more) {
  g_autofree char *devices = source_path("data/devices/ptm65.yaml");
  g_autofree char *all = g_strdup_printf("{ %s, %s }", models, more);
  g_auto(GStrv) parts = g_strsplit(all, "%s", 2);
  return g_strjoinv(devices, parts);
}

/* Correct the cells of `sheet`. */
static inline int build_library(ran *r, eda_layout *sheet, void *gates,
                                const char *more, opc_error *error) {
  g_autofree char *rest = g_strdup_printf(
      "synthesizer: { use: synthesizer.newton }, regulator: { use: "
      "regulator.drc, want_extension: 60 nm }%s",
      more);
  g_autofree char *map = library_map(LIBRARY_MODELS(LIBRARY_NA), rest);
  return run_step(r, "library.build", map,
                  (const char *const[]){"sheet", "gates", NULL},
                  (void *[]){sheet, gates}, error);
}
