/* SPDX-License-Identifier: BSD-3-Clause */
/* Test helpers of regulator.drc: layouts of boxes on a 1 nm grid, and images in
   which these or other boxes print. */
#pragma once

#include <eda/eda.h>
#include <math.h>
#include <string.h>

#include "core/plugin/host.h"
#include "tools/devel/testing.h"

/* Contacts are not corrected. */
enum { CONTACT = 2, METAL = 3, LAYERS = 4 };
static char *names[] = {"poly", "active", "contact", "metal1"};
static uint8_t corrected[] = {1, 1, 0, 1};

static inline opc_module *drc_make(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("regulator.drc", parameters, &error);
  g_assert_nonnull(m);
  return m;
}

static inline size_t drc_violations(opc_module *m, const eda_printed *p,
                                    eda_violation *v, size_t capacity) {
  const eda_regulator *r = m->functions;
  opc_error error;
  size_t count = 0;
  g_assert_cmpint(r->violations(m->self, p, v, capacity, &count, &error), ==,
                  OPC_OK);
  return count;
}

/* Up to 16 boxes of a layer, as polygons and as printed image. */
typedef struct boxes {
  eda_point points[64];
  uint32_t start[17];
  eda_shapes shapes;
} boxes;

static inline void add_box(boxes *b, int32_t x0, int32_t y0, int32_t x1,
                           int32_t y1) {
  eda_point p[4] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  size_t n = b->shapes.count++;
  memcpy(b->points + 4 * n, p, sizeof p);
  b->start[n + 1] = 4 * (uint32_t)(n + 1);
  b->shapes.start = b->start;
  b->shapes.points = b->points;
}

/* Return the level set whose contours are the sides of the boxes, except at
   corners. */
static inline eda_field field_of(const boxes *b) {
  enum { STEP = 8, N = 250 };
  const opc_host *host = opc_test_host();
  eda_field f = {.frame = {-500, -500, STEP * N, STEP * N}, .nx = N, .ny = N};
  f.coefficients = eda_alloc(N * N, sizeof(float));
  for (int j = 0; j < N; j++)
    for (int i = 0; i < N; i++) {
      double x = -500 + STEP * i, y = -500 + STEP * j, best = -60;
      for (size_t k = 0; k < b->shapes.count; k++) {
        eda_point low = b->points[4 * k], high = b->points[4 * k + 2];
        double d =
            fmin(fmin(x - low.x, high.x - x), fmin(y - low.y, high.y - y));
        best = fmax(best, d);
      }
      f.coefficients[j * N + i] = (float)fmin(best, 60);
    }
  eda_field_from_samples(host->context, &f);
  return f;
}

/* A layout without gates, the drawn mask, and the printed image. */
typedef struct chip {
  boxes drawn[LAYERS], printed[LAYERS];
  eda_gates gates;
  eda_shapes shapes[LAYERS], mask[LAYERS];
  eda_edges edges[LAYERS];
  eda_field print[LAYERS];
  eda_boxes added[LAYERS], cutouts[LAYERS];
  eda_printed p;
  eda_ruling ruling;
  uint32_t veto[1];
} chip;

static inline void chip_show(chip *c) {
  static double nowhere[1];
  c->gates.grid = 1;
  c->gates.extent = (eda_box){-500, -500, 1500, 1500};
  c->gates.layers = LAYERS;
  c->gates.layer = names;
  c->gates.corrected = corrected;
  c->gates.drawn = c->shapes;
  c->gates.edges = c->edges;
  for (int layer = 0; layer < LAYERS; layer++) {
    c->shapes[layer] = c->drawn[layer].shapes;
    if (!corrected[layer]) continue;
    eda_field_clear(&c->print[layer]);
    c->print[layer] = field_of(&c->printed[layer]);
    c->mask[layer] = c->shapes[layer];
  }
  c->p = (eda_printed){.gates = &c->gates,
                       .shapes = c->mask,
                       .print = c->print,
                       .extension = nowhere};
}

static inline void chip_judge(opc_module *m, chip *c) {
  const eda_regulator *r = m->functions;
  opc_error error;
  c->ruling =
      (eda_ruling){.vetoes = c->veto, .added = c->added, .cutouts = c->cutouts};
  g_assert_cmpint(r->rule(m->self, &c->p, &c->ruling, &error), ==, OPC_OK);
}

static inline void chip_end(chip *c) {
  for (int layer = 0; layer < LAYERS; layer++)
    eda_field_clear(&c->print[layer]);
}
