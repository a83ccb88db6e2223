/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures EPE-OPC of a synthetic metal layer of 30 x 30 um: 8 iterations with
   fragments of 32 nm, on two processors. The time of synthesizer.epe is also
   measured separately. */
#include <eda/eda.h>
#include <glib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/bench.h"
#include "core/plugin/host.h"
#include "tools/devel/testing.h"

enum { SIDE = 30000, PITCH = 280, WIDTH = 130, ITERATIONS = 8, RUNS = 3 };

static const opc_host *host;

static void require_good(int code, const opc_error *error) {
  if (code == OPC_OK) return;
  fprintf(stderr, "error: %s\n", error->message);
  exit(1);
}

static uint32_t random_draw(uint32_t *state, uint32_t below) {
  *state = *state * 1664525u + 1013904223u;
  return (*state >> 8) % below;
}

/* Return tracks of wires of 0.3 to 3 um length. One wire in five continues in
   the next track. */
static eda_layout *metal(void) {
  opc_error error;
  uint32_t state = 1;
  eda_layout *l = eda_layout_new(1, &error);
  int32_t cell = eda_layout_cell(l, "METAL", &error);
  int32_t layer = eda_layout_layer(l, "M1", &error);
  for (int32_t y = 0; y + WIDTH <= SIDE; y += PITCH)
    for (int32_t x = (int32_t)random_draw(&state, 300); x < SIDE - 300;) {
      int32_t end = x + 300 + (int32_t)random_draw(&state, 2700);
      if (end > SIDE) end = SIDE;
      eda_box wire = {x, y, end, y + WIDTH};
      require_good(eda_layout_add_box(l, cell, layer, wire, &error), &error);
      if (!random_draw(&state, 5) && y + PITCH + WIDTH <= SIDE) {
        eda_box link = {end - WIDTH, y, end, y + PITCH + WIDTH};
        require_good(eda_layout_add_box(l, cell, layer, link, &error), &error);
      }
      x = end + 150 + (int32_t)random_draw(&state, 200);
    }
  return l;
}

static opc_module *module(const char *id, const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module(id, parameters, &error);
  if (!m) require_good(OPC_FAILED, &error);
  return m;
}

/* Measure the complete step with the further parameters `more`. */
static double correct_measure(eda_gates *gates, const char *more) {
  g_autofree char *parameters = g_strdup_printf(
      "{ litho: { use: litho.hopkins }, resist: { use: resist.threshold, "
      "threshold: 0.4, active_threshold: 0.4 }, extractor: { use: "
      "extractor.plain, "
      "devices: '%s/data/devices/ptm65.yaml' }, synthesizer: { use: "
      "synthesizer.epe, "
      "fragment: 32 nm, blur: 50 nm, iterations: %d, %s } }",
      g_getenv("OPCFLOW_SOURCE") ? g_getenv("OPCFLOW_SOURCE") : ".", ITERATIONS,
      more);
  g_autoptr(opc_module) m = module("correct", parameters);
  opc_error error;
  void *outputs[1];
  opc_test_input(m, "gates", gates);
  gint64 before = g_get_monotonic_time();
  require_good(opc_test_run(m, outputs, &error), &error);
  double seconds = (double)(g_get_monotonic_time() - before) / 1e6;
  opc_test_release(m, outputs);
  return seconds;
}

/* Measure synthesizer.epe alone, on synthetic errors. */
static double epe_measure(eda_gates *gates) {
  g_autofree char *parameters = g_strdup_printf(
      "{ fragment: 32 nm, blur: 50 nm, iterations: %d }", ITERATIONS);
  g_autoptr(opc_module) m = module("synthesizer.epe", parameters);
  const eda_synthesizer *s = m->functions;
  eda_cuts cuts = {0};
  opc_error error;
  eda_feedback f = {.gates = gates};
  gint64 before = g_get_monotonic_time();
  require_good(s->begin(m->self, &f, &error), &error);
  require_good(s->cut(m->self, gates, EDA_POLY, &cuts, &error), &error);
  size_t n = cuts.start[cuts.polygons];
  g_autofree double *epe = g_new0(double, n);
  g_autofree int32_t *shift = g_new0(int32_t, n);
  eda_boxes assists = {0};
  const double *errors[] = {epe};
  int32_t *shifts[] = {shift};
  eda_moves moves = {.shift = shifts, .assists = &assists};
  f.epe = errors;
  for (int done = 0; !done; f.iteration++) {
    for (size_t i = 0; i < n; i++) epe[i] = 8 * sin((double)i) + 1.3 * shift[i];
    require_good(s->update(m->self, &f, &moves, &done, &error), &error);
  }
  double seconds = (double)(g_get_monotonic_time() - before) / 1e6;
  bench_report("epe.metal.fragments", (double)n, "", INFINITY, BENCH_HIGHER);
  return seconds;
}

int main(void) {
  host = opc_test_host();
  eda_layout *layout = metal();
  g_autoptr(opc_module) segment = module("segment.edges", "{}");
  opc_error error;
  void *gates[1];
  opc_test_input(segment, "layout", layout);
  require_good(opc_test_run(segment, gates, &error), &error);
  opc_set_threads(2);
  double all[RUNS];
  for (int i = 0; i < RUNS; i++)
    all[i] = correct_measure(gates[0], "assist: 0");
  bench_report("epe.metal_30um.two_cores", bench_median(all, RUNS), "s", 2,
               BENCH_LOWER);
  /* A second case has scatter bars where space permits, and other doses. */
  for (int i = 0; i < RUNS; i++)
    all[i] = correct_measure(gates[0],
                             "assist: 1, assist_distance: 40 nm, "
                             "assist_width: 20 nm, window: { weight: 0.5 }");
  bench_report("epe.metal_30um.window", bench_median(all, RUNS), "s", INFINITY,
               BENCH_LOWER);
  bench_report("epe.metal_30um.synthesizer", epe_measure(gates[0]), "s",
               INFINITY, BENCH_LOWER);
  opc_test_release(segment, gates);
  eda_layout_free(layout);
  return bench_write("epe");
}
