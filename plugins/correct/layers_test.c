/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests layers without transistors, corrected together with poly and active:
   cells with one and two metal layers, with the plugins of a real flow. */
#include <eda/gates.h>
#include <eda/layout.h>
#include <glib.h>
#include <math.h>
#include <string.h>

#include "tests/shapes.h"
#include "tools/devel/testing.h"

/* ---- help ---- */

static char *source(const char *name) {
  return g_build_filename(g_getenv("OPCFLOW_SOURCE"), name, NULL);
}

static opc_module *make_sample(const char *id, const char *mapping) {
  opc_error error = {0};
  opc_module *m = opc_test_module(id, mapping, &error);
  if (!m) g_error("%s %s: %s", id, mapping, error.message);
  return m;
}

/* Run a step. Returns its first output. */
static void *run_step(opc_module *m, const char *input, void *object) {
  static void *outputs[4];
  opc_error error = {0};
  if (input) opc_test_input(m, input, object);
  if (opc_test_run(m, outputs, &error)) g_error("%s: %s", m->id, error.message);
  return outputs[0];
}

static void release_sample(opc_module *m, void *object) {
  void *outputs[4] = {object};
  opc_test_release(m, outputs);
}

/* A cell's transistors with additional layers. */
typedef struct cell {
  opc_module *reader, *segments;
  void *layout;
  eda_gates *gates;
} cell;

static void cell_init(cell *c, const char *file, const char *layers,
                      const char *also) {
  g_autofree char *path = source(file);
  g_autofree char *read = g_strdup_printf(
      "{ file: '%s', layers: { poly: CP, active: CA, contact: CC, nwell: CW, "
      "%s } }",
      path, layers);
  g_autofree char *segment =
      g_strdup_printf("{ grid: 1 nm, also: { %s } }", also);
  c->reader = make_sample("read.cif", read);
  c->layout = run_step(c->reader, NULL, NULL);
  c->segments = make_sample("segment.transistors", segment);
  c->gates = run_step(c->segments, "layout", c->layout);
}

static void cell_clear(cell *c) {
  release_sample(c->segments, c->gates);
  opc_test_module_free(c->segments);
  release_sample(c->reader, c->layout);
  opc_test_module_free(c->reader);
}

static char *models(void) {
  g_autofree char *devices = source("data/devices/ptm65.yaml");
  return g_strdup_printf(
      "litho: { use: litho.hopkins, wavelength: 193 nm, na: 0.75, sigma: 0.75 "
      "}, resist: { use: resist.threshold, anchor: { line: 65 nm, pitch: 250 "
      "nm } }, extractor: { use: extractor.plain, devices: '%s' }",
      devices);
}

/* A correction with these synthesizers. */
typedef struct correction {
  opc_module *module;
  eda_mask *mask;
} correction;

static void correction_init(correction *c, const cell *of,
                            const char *synthesizers) {
  g_autofree char *models_text = models();
  g_autofree char *map =
      g_strdup_printf("{ %s, %s }", models_text, synthesizers);
  opc_test_forget();
  c->module = make_sample("correct", map);
  c->mask = run_step(c->module, "gates", of->gates);
}

static void correction_clear(correction *c) {
  release_sample(c->module, c->mask);
  opc_test_module_free(c->module);
}

static size_t layer(const eda_gates *gates, const char *name) {
  int k = eda_gates_layer(gates, name);
  g_assert_cmpint(k, >, EDA_ACTIVE);
  return (size_t)k;
}

/* ---- tests ---- */

#define THREE "metal1: CM", "metal1: metal1"
#define NEWTON "synthesizer: { use: synthesizer.newton }"
#define EPE "synthesizer.epe, fragment: 40 nm, iterations: 8"

/* With newton alone, metal is as drawn and simulated once. With epe for the
   edges, metal is corrected and the transistors are bit-identical. */
static void test_newton(void) {
  cell c;
  correction alone, both;
  cell_init(&c, "data/cells65/nand2.cif", THREE);
  size_t metal = layer(c.gates, "metal1");
  g_assert_true(c.gates->corrected[metal]);
  correction_init(&alone, &c, NEWTON);
  g_assert_cmpfloat(
      shapes_difference(&alone.mask->shapes[metal], &c.gates->drawn[metal]), ==,
      0);
  g_assert_nonnull(alone.mask->print[metal].coefficients);
  g_assert_true(isnan(opc_test_metric("epe_mean")));
  double ion = opc_test_metric("ion_max");
  double simulations = opc_test_metric("simulations");
  size_t gate_rows = opc_test_rows("gates");
  correction_init(&both, &c, NEWTON ", edges: { use: " EPE " }");
  for (int k = 0; k <= EDA_ACTIVE; k++) {
    const eda_shapes *a = &alone.mask->shapes[k], *b = &both.mask->shapes[k];
    g_assert_cmpuint(a->count, ==, b->count);
    g_assert_cmpmem(a->points, a->start[a->count] * sizeof *a->points,
                    b->points, b->start[b->count] * sizeof *b->points);
  }
  size_t bytes = c.gates->count * sizeof(double);
  g_assert_cmpmem(alone.mask->after.ion, bytes, both.mask->after.ion, bytes);
  g_assert_true(opc_test_metric("ion_max") == ion);
  g_assert_cmpuint(opc_test_rows("gates"), ==, gate_rows);
  g_assert_cmpstr(opc_test_text("gates", "verdict", 0), !=, "");
  g_assert_cmpfloat(
      shapes_difference(&both.mask->shapes[metal], &c.gates->drawn[metal]), >,
      0);
  /* Metal alone is simulated when only metal moves. */
  double more = opc_test_metric("simulations") - simulations;
  g_assert_cmpfloat(more, >, 0);
  g_assert_cmpfloat(more, <=, opc_test_metric("iterations"));
  size_t last = opc_test_rows("history") - 1;
  double first_epe = opc_test_number("history", "epe_mean", 0);
  g_assert_cmpfloat(opc_test_number("history", "epe_mean", last), <,
                    first_epe / 3);
  g_assert_true(fabs(opc_test_metric("epe_mean") -
                     opc_test_number("history", "epe_mean", last)) < 1e-3);
  correction_clear(&both);
  correction_clear(&alone);
  cell_clear(&c);
}

/* If the synthesizer dissects all layers, the second synthesizer has no layer.
 */
static void test_epe(void) {
  cell c;
  correction one, two;
  cell_init(&c, "data/cells65/nand2.cif", THREE);
  correction_init(&one, &c, "synthesizer: { use: " EPE " }");
  double sites = opc_test_number("effort", "fragments", 0);
  size_t last = opc_test_rows("history") - 1;
  g_assert_cmpfloat(opc_test_metric("epe_mean"), <, 2);
  g_assert_cmpfloat(opc_test_number("history", "epe_mean", last), <,
                    opc_test_number("history", "epe_mean", 0) / 3);
  size_t contact = layer(c.gates, "contact");
  for (size_t k = 0; k < c.gates->layers; k++)
    if (k != contact)
      g_assert_cmpfloat(
          shapes_difference(&one.mask->shapes[k], &c.gates->drawn[k]), >, 0);
  g_assert_cmpuint(one.mask->shapes[contact].count, ==, 0);
  correction_init(&two, &c,
                  "synthesizer: { use: " EPE " }, edges: { use: " EPE " }");
  g_assert_true(opc_test_number("effort", "fragments", 0) == sites);
  for (size_t k = 0; k < c.gates->layers; k++)
    g_assert_cmpfloat(
        shapes_difference(&one.mask->shapes[k], &two.mask->shapes[k]), ==, 0);
  correction_clear(&two);
  correction_clear(&one);
  cell_clear(&c);
}

/* A fourth layer requires one more word in the flow. All layers are verified
   and written to one file. */
static void test_four(void) {
  if (opc_test_sanitized_skip()) return;
  cell c;
  correction four;
  cell_init(&c, "data/cells65/sram4.cif", "metal1: CM, metal2: CM2",
            "metal1: metal1, metal2: metal2");
  correction_init(&four, &c, NEWTON ", edges: { use: " EPE " }");
  static const char *const names[] = {"poly", "active", "metal1", "metal2"};
  for (size_t i = 0; i < G_N_ELEMENTS(names); i++) {
    int k = eda_gates_layer(c.gates, names[i]);
    g_assert_cmpint(k, >=, 0);
    if (k == EDA_ACTIVE) continue; /* newton moves no widths here */
    g_assert_cmpfloat(
        shapes_difference(&four.mask->shapes[k], &c.gates->drawn[k]), >, 0);
  }
  g_autofree char *models_text = models();
  g_autofree char *verify = g_strdup_printf("{ %s }", models_text);
  opc_module *verifier = make_sample("verify", verify);
  eda_mask *again = run_step(verifier, "mask", four.mask);
  g_assert_cmpfloat(opc_test_metric("ion_change_max"), <, 1e-9);
  for (size_t k = 0; k < c.gates->layers; k++) {
    g_assert_cmpfloat(
        shapes_difference(&again->shapes[k], &four.mask->shapes[k]), ==, 0);
    g_assert_true(!again->print[k].coefficients == !c.gates->corrected[k]);
  }
  release_sample(verifier, again);
  opc_test_module_free(verifier);
  opc_module *writer = make_sample("write.gds", "{ file: mask.gds }");
  run_step(writer, "mask", four.mask);
  opc_test_module_free(writer);
  g_autofree char *file = g_build_filename(opc_test_folder(), "mask.gds", NULL);
  g_autofree char *map = g_strdup_printf("{ file: '%s' }", file);
  opc_module *reader = make_sample("read.gds", map);
  const eda_layout *layout = run_step(reader, NULL, NULL);
  /* All layers including contacts, and the drawn shapes of corrected layers. */
  g_assert_cmpuint(eda_layout_layers(layout), ==,
                   c.gates->layers + G_N_ELEMENTS(names));
  release_sample(reader, (void *)layout);
  opc_test_module_free(reader);
  correction_clear(&four);
  cell_clear(&c);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/layers/newton", test_newton);
  g_test_add_func("/layers/epe", test_epe);
  g_test_add_func("/layers/four", test_four);
  return g_test_run();
}
