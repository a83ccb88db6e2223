/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests correction of lines with the real models: printed widths, in and out of
   focus. */
#include "trial_test.h"

#include "core/plugin/host.h"

static const opc_host *host;

/* ---- real models ---- */

/* An isolated, corrected line of 65 nm. */
typedef struct printed {
  eda_layout *layout;
  opc_module *segment, *module;
  void *gates[1], *mask[1];
} printed;

static printed print_line(const char *synthesizer) {
  opc_error error;
  printed p = {.layout = eda_layout_new(1, &error)};
  int32_t cell = eda_layout_cell(p.layout, "LINE", &error);
  int32_t layer = eda_layout_layer(p.layout, "poly", &error);
  eda_box line = {0, 0, 65, 2000};
  g_assert_cmpint(eda_layout_add_box(p.layout, cell, layer, line, &error), ==,
                  OPC_OK);
  p.segment = opc_test_module("segment.edges", "{}", &error);
  g_autofree char *text = g_strdup_printf(
      "{ litho: { use: litho.hopkins }, resist: { use: resist.threshold, "
      "threshold: 0.38, active_threshold: 0.38 }, extractor: { use: "
      "extractor.plain, devices: '%s/data/devices/ptm65.yaml' }, synthesizer: "
      "{ "
      "use: synthesizer.epe, blur: 50 nm, %s } }",
      g_getenv("OPCFLOW_SOURCE") ? g_getenv("OPCFLOW_SOURCE") : ".",
      synthesizer);
  p.module = opc_test_module("correct", text, &error);
  if (!p.module) g_error("%s", error.message);
  opc_test_input(p.segment, "layout", p.layout);
  g_assert_cmpint(opc_test_run(p.segment, p.gates, &error), ==, OPC_OK);
  opc_test_input(p.module, "gates", p.gates[0]);
  if (opc_test_run(p.module, p.mask, &error)) g_error("%s", error.message);
  return p;
}

static void clear_print(printed *p) {
  opc_test_release(p->module, p->mask);
  opc_test_release(p->segment, p->gates);
  opc_test_module_free(p->module);
  opc_test_module_free(p->segment);
  eda_layout_free(p->layout);
}

static void test_line(void) {
  printed p = print_line("iterations: 20");
  const eda_mask *result = p.mask[0];
  /* Measure the printed width along the line, and the printed line ends. */
  for (double y = 60; y < 1940; y += 47) {
    const eda_field *f = &result->print[EDA_POLY];
    double low = eda_field_edge(f, EDA_X, 0, y, 40);
    double high = eda_field_edge(f, EDA_X, 65, y, 40);
    g_assert_cmpfloat(fabs(low), <, y < 200 || y > 1800 ? 3 : 1);
    g_assert_cmpfloat(fabs(high), <, y < 200 || y > 1800 ? 3 : 1);
  }
  double end = eda_field_edge(&result->print[EDA_POLY], EDA_Y, 32.5, 0, 90);
  g_assert_cmpfloat(fabs(end), <, 3);
  clear_print(&p);
}

/* Return the printed width in the middle of the line, out of focus. */
static double width_at(printed *p, double defocus) {
  opc_error error;
  g_autofree char *text = g_strdup_printf(
      "{ litho: { use: litho.hopkins, defocus: %g nm }, resist: { use: "
      "resist.threshold, threshold: 0.38, active_threshold: 0.38 }, extractor: "
      "{ "
      "use: extractor.plain, devices: '%s/data/devices/ptm65.yaml' } }",
      defocus, g_getenv("OPCFLOW_SOURCE") ? g_getenv("OPCFLOW_SOURCE") : ".");
  g_autoptr(opc_module) m = opc_test_module("verify", text, &error);
  if (!m) g_error("%s", error.message);
  void *out[1];
  opc_test_input(m, "mask", p->mask[0]);
  if (opc_test_run(m, out, &error)) g_error("%s", error.message);
  const eda_field *f = &((const eda_mask *)out[0])->print[EDA_POLY];
  double low = eda_field_edge(f, EDA_X, 0, 1000, 60);
  double high = eda_field_edge(f, EDA_X, 65, 1000, 60);
  opc_test_release(m, out);
  return isnan(low) || isnan(high) ? 0 : 65 + high - low;
}

/* Assist features beside a line preserve its width out of focus. */
static void test_depth(void) {
  if (opc_test_sanitized_skip()) return;
  double lost[2];
  for (int srafs = 0; srafs < 2; srafs++) {
    printed p = print_line(srafs ? "assist: 1, assist_width: 50 nm, "
                                   "assist_distance: 150 nm"
                                 : "assist: 0");
    g_assert_cmpfloat(fabs(width_at(&p, 0) - 65), <, 1.5);
    lost[srafs] = 65 - width_at(&p, 100);
    g_test_message("65 nm less %.2f at 100 nm", lost[srafs]);
    clear_print(&p);
  }
  g_assert_cmpfloat(fabs(lost[1]), <, 0.8 * fabs(lost[0]));
}

/* Assist features as wide as the line print and are removed; narrow ones do not
   print and stay. */
static void test_dropped(void) {
  for (int wide = 0; wide < 2; wide++) {
    opc_test_forget();
    g_autofree char *text = g_strdup_printf(
        "assist: 1, assist_width: %d nm, assist_distance: 180 nm, "
        "assist_overhang: 0 nm, assist_min_length: 60 nm",
        wide ? 75 : 40);
    printed p = print_line(text);
    const eda_mask *m = p.mask[0];
    double there = opc_test_metric("assists");
    double dropped = opc_test_metric("assists_dropped");
    /* Only the line prints. */
    for (double y = -1000; y <= 3000; y += 10)
      for (double x = -500; x <= 565; x += 10) {
        double value;
        if (x > -30 && x < 95 && y > -60 && y < 2060) continue;
        eda_field_sample(&m->print[EDA_POLY], &x, &y, 1, &value);
        g_assert_cmpfloat(value, <, 0);
      }
    g_assert_cmpuint(m->shapes[EDA_POLY].count, ==, 1 + (size_t)there);
    g_assert_cmpfloat(there + dropped, ==, 4);
    /* The scatter bars at the line ends are too short to print. */
    g_assert_cmpfloat(dropped, ==, wide ? 2 : 0);
    clear_print(&p);
  }
}

/* A layer after active is dissected like poly, unless only active is
   corrected. */
static void test_further_layer(void) {
  static char *names[] = {"poly", "active", "metal1"};
  static uint8_t corrected[] = {1, 1, 1};
  static const char *const which[] = {"both", "poly", "active"};
  const eda_box line = {0, 0, 60, 1000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  const eda_shapes drawn[] = {{0}, {0}, s->drawn[EDA_POLY]};
  eda_edges edges[3] = {{0}};
  eda_gates gates = s->gates;
  gates.layers = 3;
  gates.layer = names;
  gates.corrected = corrected;
  gates.drawn = (eda_shapes *)drawn;
  gates.edges = edges;
  for (size_t k = 0; k < G_N_ELEMENTS(which); k++) {
    opc_error error;
    g_autofree char *text = g_strdup_printf("{ layers: %s }", which[k]);
    g_autoptr(opc_module) m = opc_test_module("synthesizer.epe", text, &error);
    const eda_synthesizer *y = m->functions;
    eda_feedback f = {.gates = &gates};
    eda_cuts cuts = {0};
    g_assert_cmpint(y->begin(m->self, &f, &error), ==, OPC_OK);
    g_assert_cmpint(y->cut(m->self, &gates, 2, &cuts, &error), ==, OPC_OK);
    g_assert_cmpuint(cuts.polygons, ==, k < 2);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  host = opc_test_host();
  g_test_add_func("/epe/line", test_line);
  g_test_add_func("/epe/depth", test_depth);
  g_test_add_func("/epe/dropped", test_dropped);
  g_test_add_func("/epe/further_layer", test_further_layer);
  return g_test_run();
}
