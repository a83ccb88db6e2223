/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of transistors that marker layers distinguish: the flavour of each
   transistor, and the use of the device table of the flavour. */
#include <eda/extractor.h>
#include <eda/layout.h>
#include <eda/print.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

enum { GATES = 4, PITCH = 2000 };

static eda_layout *layout;

static void box(const char *layer, int32_t x0, int32_t y0, int32_t x1,
                int32_t y1) {
  opc_error error;
  int32_t l = eda_layout_layer(layout, layer, &error);
  eda_box b = {x0, y0, x1, y1};
  g_assert_false(eda_layout_add_box(layout, 0, l, b, &error));
}

/* Draw GATES n-transistors in a row, L 150 and W 600, and one distant
   n-well. */
static void gates_draw(void) {
  opc_error error;
  layout = eda_layout_new(1, &error);
  (void)eda_layout_cell(layout, "TOP", &error);
  for (int32_t i = 0; i < GATES; i++) {
    box("active", PITCH * i, 0, PITCH * i + 750, 600);
    box("poly", PITCH * i + 300, -150, PITCH * i + 450, 750);
  }
  box("nwell", 20000, 0, 21000, 1000);
}

/* Draw a marker that covers the gates a .. b. */
static void gates_mark(const char *layer, int32_t a, int32_t b) {
  box(layer, PITCH * a - 200, -200, PITCH * b + 900, 800);
}

static opc_module *layout_segment(const char *map, void **gates, int expect,
                                  opc_error *error) {
  opc_module *m = opc_test_module("segment.transistors", map, error);
  if (!m) g_error("%s", error->message);
  opc_test_input(m, "layout", layout);
  int code = opc_test_run(m, gates, error);
  if (code != expect) g_error("%d: %s", code, error->message);
  return m;
}

static void expect_flavours(const char *map, const char *want) {
  opc_error error;
  void *gates;
  g_autoptr(opc_module) m = layout_segment(map, &gates, OPC_OK, &error);
  g_autoptr(GString) is = g_string_new(NULL);
  for (size_t i = 0; i < GATES; i++)
    g_string_append_printf(
        is, "%s%s", i ? " " : "",
        *eda_gates_flavour(gates, i) ? eda_gates_flavour(gates, i) : "-");
  g_assert_cmpstr(is->str, ==, want);
  opc_test_release(m, &gates);
}

static void expect_refused(const char *map, const char *want) {
  opc_error error;
  void *gates;
  g_autoptr(opc_module) m = layout_segment(map, &gates, OPC_INVALID, &error);
  if (!g_pattern_match_simple(want, error.message))
    g_error("%s", error.message);
}

/* Test that, if two flavours cover a gate, the flavour with more markers is
   selected. */
static void test_markers(void) {
  gates_draw();
  expect_flavours("{}", "- - - -");
  gates_mark("LVTN", 1, 2);
  gates_mark("HVI", 2, 3);
  expect_flavours("{ flavours: { lvt: LVTN } }", "- lvt lvt -");
  expect_flavours("{ flavours: { lvt: LVTN, hv: HVI, nvt: HVI LVTN } }",
                  "- lvt nvt hv");
  expect_flavours("{ flavours: { nvt: LVTN HVI, lvt: LVTN, hv: HVI } }",
                  "- lvt nvt hv");
  expect_refused("{ flavours: { lvt: LVTN, hv: HVI } }",
                 "transistor from (4300, 0) to (4450, 600) nm, cell 'TOP': the "
                 "transistor is marked as 'lvt' and as 'hv'*");
  expect_refused("{ flavours: { lvt: NONE } }",
                 "the layout has no layer 'NONE'");
  box("PART", 310, 0, 900, 600);
  expect_refused("{ flavours: { x: PART } }",
                 "*(300, 0)*: a marker of 'x' covers the transistor in part");
  opc_error error;
  g_autoptr(opc_module) none = opc_test_module(
      "segment.transistors", "{ flavours: { x: ' ' } }", &error);
  g_assert_null(none);
  if (!strstr(error.message, "'x' must name the marker layer"))
    g_error("%s", error.message);
  eda_layout_free(layout);
}

/* Write a table whose Ion per width is `ion` exp(-L / 100). */
static void put_table(GString *out, double ion) {
  g_string_append(out,
                  "opcflow-devices: 1\nname: t\nsupply: 1 V\nwidth: 1 um\n"
                  "length: { unit: nm, values: [100, 150, 200] }\n");
  for (int t = 0; t < 2; t++)
    g_string_append_printf(
        out,
        "%cmos:\n  ion: { unit: A, values: [%.12g, %.12g, %.12g] }\n"
        "  ioff: { unit: A, values: [3e-12, 2e-12, 1e-12] }\n",
        "np"[t], ion * exp(-1), ion * exp(-1.5), ion * exp(-2));
}

static void test_currents(void) {
  static const double ion[GATES] = {1e-3, 2e-3, 4e-3, 3e-3};
  opc_error error;
  void *gates;
  g_autoptr(GString) text = g_string_new(NULL);
  gates_draw();
  gates_mark("LVTN", 1, 2);
  gates_mark("HVI", 2, 3);
  put_table(text, ion[0]);
  g_string_append(text, "---\nflavour: lvt\n");
  put_table(text, ion[1]);
  g_string_append(text, "---\nflavour: hv\n");
  put_table(text, ion[3]);
  g_autofree char *path =
      g_build_filename(opc_test_folder(), "devices.yaml", NULL);
  g_autofree char *map = g_strdup_printf("{ devices: '%s' }", path);
  g_assert_true(g_file_set_contents(path, text->str, -1, NULL));
  g_autoptr(opc_module) m = layout_segment(
      "{ flavours: { lvt: LVTN, hv: HVI, nvt: HVI LVTN } }", &gates, 0, &error);
  eda_performance out;
  eda_performance_init(&out, GATES);
  opc_module *x = opc_test_module("extractor.plain", map, &error);
  if (!x || eda_extractor_prepare(NULL, x, &error))
    g_error("%s", error.message);
  g_assert_cmpint(eda_measure_drawn(NULL, gates, x, &out, &error), ==,
                  OPC_INVALID);
  if (!strstr(error.message, "has no table of flavour 'nvt'"))
    g_error("%s", error.message);
  opc_test_module_free(x);
  g_string_append(text, "---\nflavour: nvt\n");
  put_table(text, ion[2]);
  g_assert_true(g_file_set_contents(path, text->str, -1, NULL));
  x = opc_test_module("extractor.plain", map, &error);
  if (!x || eda_extractor_prepare(NULL, x, &error) ||
      eda_measure_drawn(NULL, gates, x, &out, &error))
    g_error("%s", error.message);
  for (size_t i = 0; i < GATES; i++)
    g_assert_cmpfloat_with_epsilon(out.ion[i] / (0.6 * ion[i] * exp(-1.5)), 1,
                                   1e-6);
  eda_performance_clear(&out);
  opc_test_module_free(x);
  opc_test_release(m, &gates);
  eda_layout_free(layout);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/flavours/markers", test_markers);
  g_test_add_func("/flavours/currents", test_currents);
  return g_test_run();
}
