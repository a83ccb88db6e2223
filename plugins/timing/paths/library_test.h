/* SPDX-License-Identifier: BSD-3-Clause */
/* Test library of cells with closed-form delays, and a circuit of these
   cells. */
#pragma once

#include <eda/circuit.h>
#include <eda/delays.h>
#include <eda/timing.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

enum { SLEWS = 3, LOADS = 3 };
static double at_slew[SLEWS] = {2e-12, 10e-12, 50e-12},
              at_load[LOADS] = {0.5e-15, 2e-15, 20e-15};
static const double pin_load = 2e-15;

/* Return delay or slew of an arc, s: linear in slew and load, with coefficients
   that depend on cell, input, direction and the levels of the other inputs. */
static inline double part(size_t cell, const eda_timing_arc *a) {
  return 1 + 0.1 * (double)cell + 0.037 * a->input + 0.011 * (a->from % 7) +
         0.053 * a->rises;
}
static inline double delay_of(size_t cell, const eda_timing_arc *a, double slew,
                              double load) {
  return part(cell, a) * (5e-12 + 0.2 * slew + 2e3 * load);
}
static inline double slew_of(size_t cell, const eda_timing_arc *a, double slew,
                             double load) {
  return part(cell, a) * (3e-12 + 0.1 * slew + 1.5e3 * load);
}

static inline void cell_fill(eda_timing *t, size_t k) {
  eda_timing_cell *c = &t->cell[k];
  const size_t patterns = (size_t)1 << c->inputs;
  c->slews = SLEWS;
  c->loads = LOADS;
  c->at_slew = at_slew;
  c->at_load = at_load;
  c->near_slew[1] = c->near_load[1] = 1;
  c->bundles = c->devices;
  c->arc = eda_pool_alloc(&t->memory, c->inputs * patterns, sizeof *c->arc);
  c->arc_of =
      eda_pool_alloc(&t->memory, c->inputs * patterns, sizeof *c->arc_of);
  for (uint32_t i = 0; i < c->inputs * patterns; i++) {
    uint32_t from = i % (uint32_t)patterns, in = i / (uint32_t)patterns;
    uint8_t after = c->level[from ^ 1u << in];
    c->arc_of[i] = -1;
    if (after == c->level[from]) continue;
    c->arc_of[i] = (int32_t)c->arcs;
    c->arc[c->arcs++] =
        (eda_timing_arc){.input = (uint8_t)in, .rises = after, .from = from};
  }
  c->pair_of = eda_pool_alloc(&t->memory, c->inputs * c->inputs * patterns,
                              sizeof *c->pair_of);
  for (size_t i = 0; i < c->inputs * c->inputs * patterns; i++)
    c->pair_of[i] = -1;
  eda_timing_cell_figures(&t->memory, c);
  for (size_t i = 0; i < c->arcs; i++)
    for (int g = 0; g < SLEWS * LOADS; g++) {
      double s = at_slew[g / LOADS], l = at_load[g % LOADS];
      c->arc[i].delay[g] = delay_of(k, &c->arc[i], s, l);
      c->arc[i].slew[g] = slew_of(k, &c->arc[i], s, l);
    }
  for (size_t i = 0; i < c->inputs * 2 * EDA_CAPS; i++)
    c->capacitance[i] = pin_load;
  for (size_t i = 0; i < (c->inputs << c->inputs) * EDA_CAPS; i++)
    c->pin_capacitance[i] = pin_load;
}

/* Return a library of INV, NAND2 and XOR2. Each cell has two transistors; the
   tests use only those of the inverter. */
static inline eda_timing *library(void) {
  static const char *pins[][3] = {{"A", "Y"}, {"A", "B", "Y"}, {"A", "B", "Y"}};
  static uint8_t levels[][4] = {{1, 0}, {1, 1, 1, 0}, {0, 1, 1, 0}};
  static const char *const names[] = {"INV", "NAND2", "XOR2"};
  static eda_timing_device devices[] = {
      {.name = "MN", .type = EDA_NMOS, .length = 60, .width = 200, .share = 1},
      {.name = "MP",
       .type = EDA_PMOS,
       .length = 60,
       .width = 300,
       .bundle = 1,
       .share = 1}};
  eda_timing *t = eda_timing_new(3);
  t->supply = 1;
  t->low = 0.3;
  t->high = 0.7;
  for (size_t k = 0; k < 3; k++) {
    eda_timing_cell *c = &t->cell[k];
    c->name = names[k];
    c->inputs = k ? 2 : 1;
    c->outputs = 1;
    c->pin = pins[k];
    c->level = levels[k];
    c->devices = 2;
    c->device = devices;
    cell_fill(t, k);
  }
  return t;
}

static const char cells_text[] =
    ".subckt INV A Y VDD VSS\nMN Y A VSS VSS nmos w=200n l=60n\n"
    "MP Y A VDD VDD pmos w=300n l=60n\n.ends\n"
    ".subckt NAND2 A B Y VDD VSS\nMN Y A VSS VSS nmos w=200n l=60n\n"
    "MP Y B VDD VDD pmos w=300n l=60n\n.ends\n"
    ".subckt XOR2 A B Y VDD VSS\nMN Y A VSS VSS nmos w=200n l=60n\n"
    "MP Y B VDD VDD pmos w=300n l=60n\n.ends\n";

static inline char *write_circuit(const char *ports, const char *instances) {
  char *path = g_build_filename(opc_test_folder(), "circuit.sp", NULL);
  g_autofree char *text =
      g_strdup_printf("* circuit\n%s.subckt top %s VDD VSS\n%s.ends\n",
                      cells_text, ports, instances);
  g_unlink(path);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  return path;
}

/* Output of the last run; replaced by the next run. */
static eda_delays *sensed;

/* Run the step on a circuit. `more` holds further parameters in the syntax of a
   flow. */
static inline int run_paths(eda_timing *t, const char *ports,
                            const char *instances, const char *more,
                            const eda_circuit *circuit, const eda_mask *mask,
                            opc_error *error) {
  g_autofree char *path = write_circuit(ports, instances);
  g_autofree char *text =
      g_strdup_printf("{ file: %s, top: top%s }", path, more);
  opc_test_forget();
  opc_module *m = opc_test_module("timing.paths", text, error);
  if (!m) return error->code;
  opc_test_input(m, "timing", t);
  if (circuit) opc_test_input(m, "circuit", (void *)circuit);
  if (mask) opc_test_input(m, "mask", (void *)mask);
  void *outputs[1] = {NULL};
  int code = opc_test_run(m, outputs, error);
  eda_delays_free(sensed);
  sensed = outputs[0];
  opc_test_module_free(m);
  return code;
}
