/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs the plugin on a layout from a file. */
#pragma once

#include <eda/circuit.h>
#include <eda/layout.h>
#include <glib/gstdio.h>
#include <stdio.h>
#include <string.h>

#include "tests/data.h"
#include "tools/devel/testing.h"

/* ---- running ---- */

typedef struct run {
  opc_module *read, *segment, *match;
  void *layout, *gates, *circuit;
} run;

static inline opc_module *module_of(const char *id, const char *map) {
  opc_error error;
  opc_module *m = opc_test_module(id, map, &error);
  if (!m) g_error("%s: %s", id, error.message);
  return m;
}

static inline run read_layout(const char *id, const char *path,
                              const char *rest) {
  opc_error error;
  g_autofree char *map = g_strdup_printf("{ file: '%s', %s }", path, rest);
  run r = {.read = module_of(id, map)};
  if (opc_test_run(r.read, &r.layout, &error)) g_error("%s", error.message);
  return r;
}

static inline void find_gates(run *r, const char *map) {
  opc_error error;
  r->segment = module_of("segment.transistors", map);
  opc_test_input(r->segment, "layout", r->layout);
  if (opc_test_run(r->segment, &r->gates, &error)) g_error("%s", error.message);
}

/* Return the circuit, or NULL and the message. */
static inline const eda_circuit *circuit_match(run *r, const char *netlist,
                                               const char *rest,
                                               char **message) {
  opc_error error;
  g_autofree char *map = g_strdup_printf("{ file: '%s'%s }", netlist, rest);
  r->match = module_of("netlist.match", map);
  opc_test_input(r->match, "layout", r->layout);
  opc_test_input(r->match, "gates", r->gates);
  int code = opc_test_run(r->match, &r->circuit, &error);
  if (message) *message = code ? g_strdup(error.message) : NULL;
  if (code && !message) g_error("%s", error.message);
  return code ? NULL : r->circuit;
}

static inline void drop_circuit(run *r) {
  if (r->circuit) opc_test_release(r->match, &r->circuit);
  if (r->match) opc_test_module_free(r->match);
  r->circuit = r->match = NULL;
}

static inline void drop_gates(run *r) {
  drop_circuit(r);
  opc_test_release(r->segment, &r->gates);
  opc_test_module_free(r->segment);
}

static inline void run_drop(run *r) {
  drop_gates(r);
  opc_test_release(r->read, &r->layout);
  opc_test_module_free(r->read);
}

static inline const char *net(const eda_circuit *c, uint32_t n) {
  return c->net[n];
}

/* ---- material ---- */

static inline char *text_of(const char *path) {
  char *text;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  return text;
}

static inline char *in_folder(const char *name, const char *text, gssize n) {
  char *path = g_build_filename(opc_test_folder(), name, NULL);
  if (!text) return path;
  /* Create a new file, because some file systems flush a replaced file to the
     disk. */
  g_unlink(path);
  FILE *file = fopen(path, "wb");
  size_t bytes = n < 0 ? strlen(text) : (size_t)n;
  g_assert_nonnull(file);
  g_assert_cmpuint(fwrite(text, 1, bytes, file), ==, bytes);
  fclose(file);
  return path;
}

/* ---- layouts by hand ---- */

static inline void box(void *layout, int32_t cell, const char *layer,
                       int32_t x0, int32_t y0, int32_t x1, int32_t y1) {
  opc_error error;
  int32_t l = eda_layout_layer(layout, layer, &error);
  eda_box b = {x0, y0, x1, y1};
  g_assert_cmpint(eda_layout_add_box(layout, cell, l, b, &error), ==, OPC_OK);
}

/* Return a layout of two transistors in a row, with a metal strap over all
   three diffusions. */
static inline void *two_in_a_row(int32_t *cell) {
  opc_error error;
  void *layout = eda_layout_new(1, &error);
  *cell = eda_layout_cell(layout, "pair", &error);
  box(layout, *cell, "active", 0, 0, 600, 200);
  box(layout, *cell, "poly", 150, -100, 215, 300);
  box(layout, *cell, "poly", 400, -100, 465, 300);
  box(layout, *cell, "nimplant", -50, -50, 650, 250);
  box(layout, *cell, "metal1", 0, 50, 600, 100);
  return layout;
}

static inline void text(void *layout, int32_t cell, const char *layer,
                        int32_t x, int32_t y, const char *t) {
  opc_error error;
  int32_t l = eda_layout_layer(layout, layer, &error);
  eda_point at = {x, y};
  g_assert_cmpint(eda_layout_add_text(layout, cell, l, at, t, &error), ==,
                  OPC_OK);
}
