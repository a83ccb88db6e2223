/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares the chosen first correction with all other first corrections in the
   correction loop, on a layout with the evaluation transistor of thesis figure
   3.5. */
#include <eda/eda.h>

#include "tools/devel/testing.h"

#include <math.h>
#include <string.h>

#define OPTICS                                                                 \
  "litho: { use: litho.hopkins, wavelength: 193 nm, na: 0.75, sigma: 0.75 }, " \
  "resist: { use: resist.threshold, "                                          \
  "anchor: { line: 65 nm, pitch: 250 nm } }, "                                 \
  "extractor: { use: extractor.plain, devices: %s/data/devices/ptm65.yaml }, "

static char *with_optics(const char *rest) {
  const char *source = g_getenv("OPCFLOW_SOURCE");
  return g_strdup_printf("{ " OPTICS "%s }", source ? source : ".", rest);
}

static int characterize_run(const char *rest, opc_error *error) {
  g_autofree char *text = with_optics(rest);
  opc_module *m = opc_test_module("characterize.init_adjust", text, error);
  void *outputs[1];
  if (!m) return error->code;
  opc_test_forget();
  int code = opc_test_run(m, outputs, error);
  opc_test_module_free(m);
  return code;
}

static void step_characterize(const char *rest) {
  opc_error error;
  if (characterize_run(rest, &error)) g_error("%s", error.message);
}

/* ---- the loop ---- */

/* Gates of a vertical transistor of L and W, with 84 nm of poly past the active
   and 98 nm of active past the gate. */
typedef struct evaluation_layout {
  eda_point points[2][4];
  uint32_t start[2];
  eda_fragment fragments[2][4];
  eda_box box;
  uint8_t type, axis;
  double length, width, space[2], extension[2];
  char *name;
  uint32_t number;
  eda_shapes drawn[2];
  eda_edges edges[2];
  eda_gates gates;
} evaluation_layout;

static void evaluation_draw(evaluation_layout *f, int32_t l, int32_t w,
                            int32_t grid) {
  int32_t length = l / grid, width = w / grid, past = 84 / grid,
          beside = 98 / grid;
  static const uint8_t roles[2][4] = {
      {EDA_END_LOW, EDA_L_HIGH, EDA_END_HIGH, EDA_L_LOW},
      {EDA_W_LOW, EDA_FIXED, EDA_W_HIGH, EDA_FIXED}};
  memset(f, 0, sizeof *f);
  f->start[1] = 4;
  f->box = (eda_box){0, 0, length, width};
  f->length = l;
  f->width = w;
  f->space[0] = f->space[1] = 2 * 98;
  f->extension[0] = f->extension[1] = 84;
  static char *names[] = {"poly", "active"}, none[] = "", top[] = "figure 3.5";
  static uint8_t corrected[] = {1, 1};
  f->name = none;
  f->number = 1;
  f->gates =
      (eda_gates){.name = top,
                  .grid = grid,
                  .extent = {-beside, -past, length + beside, width + past},
                  .layers = 2,
                  .layer = names,
                  .corrected = corrected,
                  .drawn = f->drawn,
                  .edges = f->edges,
                  .count = 1,
                  .box = &f->box,
                  .type = &f->type,
                  .axis = &f->axis,
                  .length = &f->length,
                  .width = &f->width,
                  .space = f->space,
                  .extension = f->extension,
                  .instance = &f->name,
                  .cell = &f->name,
                  .number = &f->number};
  for (int layer = 0; layer < 2; layer++) {
    int32_t x = layer ? beside : 0, y = layer ? 0 : past;
    const eda_point p[] = {
        {-x, -y}, {length + x, -y}, {length + x, width + y}, {-x, width + y}};
    memcpy(f->points[layer], p, sizeof p);
    for (int k = 0; k < 4; k++) {
      int owned = roles[layer][k] != EDA_FIXED;
      f->fragments[layer][k] =
          (eda_fragment){p[k], owned ? 0 : -1, roles[layer][k]};
    }
    f->drawn[layer] = (eda_shapes){1, f->start, f->points[layer], NULL};
    f->edges[layer] = (eda_edges){1, f->start, f->fragments[layer]};
  }
}

/* Return the final PDE of the step `correct` from a first correction, and its
   number of moves in `iterations`. */
static double by_loop(int32_t length, int32_t width, int32_t grid, int adjust,
                      double *iterations) {
  evaluation_layout f;
  opc_error error;
  void *outputs[1] = {NULL};
  evaluation_draw(&f, length, width, grid);
  g_autofree char *rest = g_strdup_printf(
      "synthesizer: { use: synthesizer.dpb, w_step: proportional, init_adjust: "
      "%d nm }",
      adjust);
  g_autofree char *text = with_optics(rest);
  opc_module *m = opc_test_module("correct", text, &error);
  if (!m) g_error("%s", error.message);
  opc_test_input(m, "gates", &f.gates);
  if (opc_test_run(m, outputs, &error)) g_error("%s", error.message);
  const eda_mask *mask = outputs[0];
  double pde = 100 * (mask->after.ion[0] / mask->design.ion[0] - 1);
  *iterations = mask->iterations;
  opc_test_release(m, outputs);
  opc_test_module_free(m);
  return pde;
}

/* All first corrections for L 70, W 150: the step and the loop have equal
   results. The loop counts two more iterations, which move nothing. The chosen
   first correction is the best. */
static void test_brute_force(void) {
  if (opc_test_sanitized_skip()) return;
  step_characterize(
      "lengths: [70 nm], widths: [150 nm], w_step: proportional, "
      "from: -9 nm, to: 3 nm");
  g_assert_cmpuint(opc_test_rows("init_adjust_trials"), ==, 13);
  double best = INFINITY,
         chosen = opc_test_number("init_adjust", "init_adjust", 0);
  double at_chosen = NAN;
  for (size_t k = 0; k < 13; k++) {
    int adjust = (int)k - 9;
    double listed = opc_test_number("init_adjust_trials", "pde", k), iterations;
    double steps = opc_test_number("init_adjust_trials", "iterations", k);
    if (adjust == 0) continue; /* synthesizer.dpb treats 0 differently */
    double pde = by_loop(70, 150, 1, adjust, &iterations);
    g_test_message("%d: %.4f in %g, %.4f in %g", adjust, listed, steps, pde,
                   iterations);
    g_assert_cmpfloat(fabs(pde - listed), <, 0.02);
    g_assert_cmpfloat(iterations, ==, steps + 2);
    best = fmin(best, fabs(pde));
    if (adjust == chosen) at_chosen = fabs(pde);
  }
  g_assert_cmpfloat(at_chosen, <, best + 0.02);
  /* On another grid. */
  step_characterize(
      "lengths: [70 nm], widths: [150 nm], w_step: proportional, grid: 2 nm, "
      "from: -4 nm, to: -4 nm");
  double iterations, pde = by_loop(70, 150, 2, -4, &iterations);
  g_assert_cmpfloat(fabs(pde - opc_test_number("init_adjust_trials", "pde", 0)),
                    <, 0.02);
  g_assert_cmpfloat(iterations, ==,
                    opc_test_number("init_adjust_trials", "iterations", 0) + 2);
}

/* Relative to the drawn length, the printed length of isolated lines increases
   with the drawn length beyond the 65 nm of the anchor. Therefore the first
   correction falls with L. At W 200, the line has about twice the deviation. */
static void test_falls_with_length(void) {
  if (opc_test_sanitized_skip()) return;
  step_characterize(
      "lengths: [65 nm, 70 nm, 80 nm], widths: [200 nm, 300 nm], "
      "w_step: proportional, from: -16 nm, to: 2 nm, tie: 1 %");
  for (size_t w = 0; w < 2; w++) {
    double last = 0;
    for (size_t l = 0; l < 3; l++) {
      double adjust = opc_test_number("init_adjust", "init_adjust", 2 * l + w);
      g_assert_cmpfloat(adjust, <, last);
      last = adjust;
    }
  }
  g_assert_cmpfloat(opc_test_metric("iterations_mean"), <,
                    opc_test_metric("iterations_mean_by_one"));
}

/* Without a tie, the result nearest to the drawn current is chosen. With a tie,
   the result with the fewest moves within the tie is chosen. */
static void test_tie(void) {
  double pde[2], iterations[2];
  for (int k = 0; k < 2; k++) {
    g_autofree char *text = g_strdup_printf(
        "lengths: [70 nm], widths: [200 nm], w_step: "
        "proportional, from: -8 nm, to: 2 nm, tie: %s",
        k ? "0.5 %" : "0 %");
    step_characterize(text);
    pde[k] = fabs(opc_test_number("init_adjust", "pde", 0));
    iterations[k] = opc_test_number("init_adjust", "iterations", 0);
    for (size_t i = 0; i < opc_test_rows("init_adjust_trials"); i++) {
      double p = fabs(opc_test_number("init_adjust_trials", "pde", i));
      double n = opc_test_number("init_adjust_trials", "iterations", i);
      if (k)
        g_assert_true(p > 0.5 || n >= iterations[1]);
      else
        g_assert_cmpfloat(p, >=, pde[0]);
    }
  }
  g_assert_cmpfloat(iterations[1], <=, iterations[0]);
}

/* Poly that does not extend beyond the active prints no transistor: the finding
   states that the row of the table has no meaning. */
static void test_open(void) {
  step_characterize(
      "lengths: [65 nm], widths: [200 nm], from: 0 nm, to: 1 nm, extension: 0 "
      "nm, max_iterations: 2");
  g_assert_nonnull(strstr(opc_test_log(), "1 of 1 sizes do not print"));
}

static void test_refused(void) {
  const struct {
    const char *rest, *want;
  } cases[] = {
      {"lengths: []", "is empty"},
      {"widths: [100.5 nm]", "'100.5 nm' is no multiple of the grid of 1 nm"},
      {"lengths: [65 nm, 65 nm]", "'65 nm' appears twice"},
      {"from: 3 nm, to: 2 nm", "'3 nm' is above 'to', 2 nm"},
      {"margin: 1 nm", "expected at least 300 nm"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error = {0};
    g_assert_cmpint(characterize_run(cases[i].rest, &error), ==, OPC_INVALID);
    g_assert_nonnull(strstr(error.message, cases[i].want));
  }
}

static void test_cancel(void) {
  opc_error error = {0};
  opc_test_cancel(1);
  g_assert_cmpint(
      characterize_run("lengths: [65 nm], widths: [200 nm]", &error), ==,
      OPC_CANCELLED);
  opc_test_cancel(0);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/init-adjust/brute-force", test_brute_force);
  g_test_add_func("/init-adjust/falls-with-length", test_falls_with_length);
  g_test_add_func("/init-adjust/tie", test_tie);
  g_test_add_func("/init-adjust/open", test_open);
  g_test_add_func("/init-adjust/refused", test_refused);
  g_test_add_func("/init-adjust/cancel", test_cancel);
  return g_test_run();
}
