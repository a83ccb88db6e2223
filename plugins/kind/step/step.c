/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "step": sample files and input data for the tests of steps. The input
   data are the transistors of eda_gates_sample as a layout, as gates and as a
   mask. The kernel (core/) defines the functions of the kind. */
#include <eda/layout.h>
#include <opcflow/step.h>
#include <stdlib.h>
#include <string.h>

#include "../try.h"
#include "samples.h"

/* ---- data ---- */

static int add_shapes(eda_layout *layout, int32_t cell, const char *name,
                      const eda_shapes *shapes, opc_error *error) {
  int32_t layer = eda_layout_layer(layout, name, error);
  int code = layer < 0 ? error->code : OPC_OK;
  for (size_t p = 0; p < shapes->count && !code; p++)
    code = eda_layout_add_polygon(
        layout, cell, layer, &shapes->points[shapes->start[p]],
        shapes->start[p + 1] - shapes->start[p], error);
  return code;
}

/* Return the sample as a layout, with the n-well that marks the PMOS. */
static const void *give_layout(opc_error *error) {
  static eda_layout *layout;
  const eda_gates *g = eda_gates_sample();
  if (layout) return layout;
  layout = eda_layout_new(g->grid, error);
  int32_t cell = eda_layout_cell(layout, g->name, error);
  int32_t well = eda_layout_layer(layout, "nwell", error);
  int code = OPC_OK;
  for (size_t k = 0; k < g->layers && !code; k++)
    code = add_shapes(layout, cell, g->layer[k], &g->drawn[k], error);
  for (size_t i = 0; i < g->count && !code; i++)
    if (g->type[i] == EDA_PMOS) {
      eda_box b = g->box[i];
      eda_box around = {b.x0 - 300, b.y0 - 50, b.x1 + 300, b.y1 + 50};
      code = eda_layout_add_box(layout, cell, well, around, error);
    }
  return code ? NULL : layout;
}

static const void *give_gates(opc_error *error) {
  (void)error;
  return eda_gates_sample();
}

static eda_shapes copy_shapes(const eda_shapes *from) {
  size_t points = from->start[from->count];
  eda_shapes to = {.count = from->count,
                   .start = eda_alloc(from->count + 1, sizeof *to.start),
                   .points = eda_alloc(points, sizeof *to.points),
                   .hole = eda_alloc(from->count, sizeof *to.hole)};
  memcpy(to.start, from->start, (from->count + 1) * sizeof *to.start);
  memcpy(to.points, from->points, points * sizeof *to.points);
  return to;
}

static void ignore_finding(opc_inspector *in, const char *format, ...) {
  (void)in, (void)format;
}

/* Return the uncorrected mask with its simulated image. */
static const void *give_mask(opc_error *error) {
  static eda_mask *mask;
  static opc_inspector nobody = {.find = ignore_finding,
                                 .note = ignore_finding};
  const eda_gates *g = eda_gates_sample();
  if (mask) return mask;
  mask = eda_mask_new(g);
  mask->flags = eda_alloc(g->count, sizeof *mask->flags);
  for (size_t k = 0; k < g->layers; k++) {
    mask->shapes[k] = copy_shapes(&g->drawn[k]);
    if (!try_develop(&nobody, (int)k, &mask->print[k])) break;
  }
  eda_performance *const all[] = {&mask->design, &mask->before, &mask->after};
  for (size_t i = 0; i < 3; i++) {
    eda_performance_init(all[i], g->count);
    try_performance(g, all[i]);
  }
  return eda_mask_check(mask, error) ? NULL : mask;
}

/* ---- entry ---- */

static const opc_example examples[] = {
    {"layout", give_layout}, {"gates", give_gates}, {"mask", give_mask}};

static const opc_function required[] = {OPC_FUNCTION(opc_step, run)};
static const opc_kind functions = {.functions_size = sizeof(opc_step),
                                   OPC_REQUIRED_FUNCTIONS(required),
                                   OPC_SAMPLES(samples),
                                   OPC_EXAMPLES(examples)};

typedef struct kind_state {
  const opc_host *host;
} kind_state;

OPC_PLUGIN(kind_state, .id = "kind.step", .kind = "kind", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "sample files and input data for tests of steps",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_FUNCTIONS(functions));
