/* SPDX-License-Identifier: BSD-3-Clause */
/* A mask made by hand, for the tests of draw.mask. */
#pragma once

#include <eda/gates.h>
#include <math.h>
#include <string.h>

#include "../picture_test.h"

enum { SIDE = 1000, NODES = 40, GATES = 2 };
enum { CONTACT = 2, METAL, LAYERS };

typedef struct rectangles {
  uint32_t start[2];
  eda_point points[4];
  eda_shapes shapes;
} rectangles;

/* Storage of a mask. */
typedef struct drawing {
  rectangles drawn[LAYERS], mask_of[LAYERS];
  char *layer[LAYERS];
  uint8_t corrected[LAYERS];
  eda_shapes drawn_shapes[LAYERS], mask_shapes[LAYERS];
  eda_field print[LAYERS];
  eda_box box[GATES];
  double design[GATES], before[GATES], after[GATES];
  uint32_t flags[GATES];
  eda_gates gates;
  eda_mask mask;
} drawing;

static inline void rectangle(rectangles *r, int32_t x0, int32_t y0, int32_t x1,
                             int32_t y1) {
  *r = (rectangles){{0, 4}, {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, {0}};
  r->shapes = (eda_shapes){1, r->start, r->points, NULL};
}

/* Return level - cos - cos over one period in each direction: positive around
   the middle; along the axes, up to the point where cos = level - 1. */
static inline eda_field island(double level) {
  eda_field f = {.frame = {0, 0, SIDE, SIDE}, .nx = NODES, .ny = NODES};
  f.coefficients = g_new(float, NODES *NODES);
  for (int j = 0; j < NODES; j++)
    for (int i = 0; i < NODES; i++)
      f.coefficients[NODES * j + i] =
          (float)(level - cos(2 * M_PI * i / NODES) -
                  cos(2 * M_PI * j / NODES));
  eda_field_from_samples(NULL, &f);
  return f;
}

/* Draw a cross of two lines with two transistors in the middle. The contour of
   the poly contains (333 1/3, 500), where the cosine is -1/2. */
static inline void make_sample(drawing *d) {
  memset(d, 0, sizeof *d);
  rectangle(&d->drawn[EDA_POLY], 450, 100, 550, 900);
  rectangle(&d->drawn[EDA_ACTIVE], 100, 300, 900, 700);
  rectangle(&d->mask_of[EDA_POLY], 430, 80, 570, 920);
  rectangle(&d->mask_of[EDA_ACTIVE], 120, 280, 880, 720);
  d->box[0] = (eda_box){450, 300, 550, 500};
  d->box[1] = (eda_box){450, 500, 550, 700};
  d->design[0] = d->design[1] = 1e-3;
  d->before[0] = d->before[1] = 0.8e-3;
  d->after[0] = 1.02e-3;
  d->after[1] = 0.99e-3;
  static char *const names[LAYERS] = {"poly", "active", "contact", "metal1"};
  memcpy(d->layer, names, sizeof names);
  d->corrected[EDA_POLY] = d->corrected[EDA_ACTIVE] = 1;
  d->gates = (eda_gates){.name = "ISLAND",
                         .grid = 1,
                         .extent = {100, 100, 900, 900},
                         .layers = LAYERS,
                         .layer = d->layer,
                         .corrected = d->corrected,
                         .drawn = d->drawn_shapes,
                         .count = GATES,
                         .box = d->box};
  d->mask = (eda_mask){.gates = &d->gates,
                       .shapes = d->mask_shapes,
                       .print = d->print,
                       .design = {.count = GATES, .ion = d->design},
                       .before = {.count = GATES, .ion = d->before},
                       .after = {.count = GATES, .ion = d->after},
                       .flags = d->flags,
                       .iterations = 7};
  for (int layer = 0; layer < LAYERS; layer++) {
    d->drawn_shapes[layer] = d->drawn[layer].shapes;
    d->mask_shapes[layer] = d->mask_of[layer].shapes;
  }
  d->print[EDA_POLY] = island(-1.5);
}

static inline void drawing_clear(drawing *d) {
  for (int layer = 0; layer < LAYERS; layer++)
    g_free(d->print[layer].coefficients);
}

static inline int draw_sample(drawing *d, const char *mapping,
                              opc_error *error) {
  void *no_outputs[1];
  g_autoptr(opc_module) m = opc_test_module("draw.mask", mapping, error);
  if (!m) g_error("%s", error->message);
  opc_test_input(m, "mask", &d->mask);
  return opc_test_run(m, no_outputs, error);
}

#define WINDOW "window: [0 nm, 0 nm, 1000 nm, 1000 nm]"
