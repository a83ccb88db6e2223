/* SPDX-License-Identifier: BSD-3-Clause */
/* Test helpers of the regulator: a chip on a 1 nm grid whose printed image is a
   function of the test, which may depend on the last ruling. */
#pragma once

#include <eda/eda.h>
#include <math.h>
#include <string.h>

#include "core/plugin/host.h"
#include "tools/devel/testing.h"

enum { STEP = 8, N = 250, MOST = 8 };

/* Poly, active and contacts; contacts are not corrected. */
enum { CONTACT = 2, LAYERS = 3 };
static char *names[] = {"poly", "active", "contact"};
static uint8_t corrected[] = {1, 1, 0};

typedef struct chip {
  eda_point points[4 * MOST], moved[4 * MOST];
  uint32_t start[MOST + 1];
  eda_fragment fragments[4 * MOST];
  eda_point contact[4];
  eda_gates gates;
  eda_shapes shapes[LAYERS];
  eda_edges edges[LAYERS];
  eda_box box[1];
  uint8_t axis[1];
  double space[2], drawn[2], extension[2];
  uint32_t flags[1], veto[1];
  int32_t l[1], w[1], end[2];
  eda_field print[LAYERS];
  eda_shapes mask[LAYERS];
  eda_boxes added[LAYERS], cutouts[LAYERS];
  eda_printed p;
  eda_ruling ruling;
} chip;

static inline void box_points(eda_point *p, int32_t x0, int32_t y0, int32_t x1,
                              int32_t y1) {
  p[0] = (eda_point){x0, y0};
  p[1] = (eda_point){x1, y0};
  p[2] = (eda_point){x1, y1};
  p[3] = (eda_point){x0, y1};
}

static inline void add_poly(chip *c, int32_t x0, int32_t y0, int32_t x1,
                            int32_t y1) {
  size_t n = c->shapes[EDA_POLY].count++;
  box_points(c->points + 4 * n, x0, y0, x1, y1);
  for (size_t i = 4 * n; i < 4 * n + 4; i++)
    c->fragments[i] = (eda_fragment){.from = c->points[i], .gate = -1};
  c->start[n + 1] = 4 * (uint32_t)(n + 1);
}

static inline void add_contact(chip *c, int32_t x0, int32_t y0, int32_t x1,
                               int32_t y1) {
  static const uint32_t one[] = {0, 4};
  box_points(c->contact, x0, y0, x1, y1);
  c->shapes[CONTACT] = (eda_shapes){1, (uint32_t *)one, c->contact, NULL};
}

static inline void chip_begin(chip *c) {
  eda_gates *g = &c->gates;
  g->grid = 1;
  g->extent = (eda_box){-500, -500, 1500, 1500};
  g->layers = LAYERS;
  g->layer = names;
  g->corrected = corrected;
  g->drawn = c->shapes;
  g->edges = c->edges;
  c->shapes[EDA_POLY].start = c->start;
  c->shapes[EDA_POLY].points = c->points;
  c->edges[EDA_POLY] =
      (eda_edges){c->shapes[EDA_POLY].count, c->start, c->fragments};
  c->mask[EDA_POLY] = c->shapes[EDA_POLY];
  c->p = (eda_printed){.gates = g,
                       .flags = c->flags,
                       .l = c->l,
                       .w = c->w,
                       .extension = c->extension,
                       .shapes = c->mask,
                       .print = c->print};
  c->ruling = (eda_ruling){.added = c->added, .cutouts = c->cutouts};
}

/* Set the printed image to a function that is positive inside poly. */
static inline void chip_print(chip *c, double (*poly)(const chip *c, double x,
                                                      double y)) {
  const opc_host *host = opc_test_host();
  for (int layer = 0; layer <= EDA_ACTIVE; layer++) {
    eda_field *f = &c->print[layer];
    eda_field_clear(f);
    *f = (eda_field){
        .frame = {-500, -500, STEP * N, STEP * N}, .nx = N, .ny = N};
    f->coefficients = eda_alloc(N * N, sizeof(float));
    for (int j = 0; j < N; j++)
      for (int i = 0; i < N; i++)
        f->coefficients[j * N + i] =
            layer == EDA_ACTIVE
                ? -60
                : (float)fmin(
                      fmax(poly(c, -500 + STEP * i, -500 + STEP * j), -60), 60);
    eda_field_from_samples(host->context, f);
  }
}

static inline void chip_judge(opc_module *m, chip *c) {
  const eda_regulator *r = m->functions;
  opc_error error;
  c->ruling.vetoes = c->veto;
  c->ruling.end = c->end;
  c->veto[0] = 0;
  g_assert_cmpint(r->rule(m->self, &c->p, &c->ruling, &error), ==, OPC_OK);
}

static inline void chip_smooth(opc_module *m, chip *c) {
  const eda_regulator *r = m->functions;
  opc_error error;
  g_assert_cmpint(r->smooth(m->self, &c->p, &c->ruling, &error), ==, OPC_OK);
}

static inline size_t drc_violations(opc_module *m, chip *c, eda_violation *v,
                                    size_t capacity) {
  const eda_regulator *r = m->functions;
  opc_error error;
  size_t n = 0;
  g_assert_cmpint(r->violations(m->self, &c->p, v, capacity, &n, &error), ==,
                  OPC_OK);
  return n;
}

static inline opc_module *drc_make(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("regulator.drc", parameters, &error);
  g_assert_nonnull(m);
  return m;
}

static inline void chip_end(chip *c) {
  for (int layer = 0; layer <= EDA_ACTIVE; layer++)
    eda_field_clear(&c->print[layer]);
}

/* Return the extent of repair shapes beyond the right edge at x, at height
   y. */
static inline int32_t added_extent(const chip *c, int32_t x, double y) {
  int32_t by = 0;
  for (size_t i = 0; i < c->ruling.added[EDA_POLY].count; i++) {
    eda_box b = c->ruling.added[EDA_POLY].box[i];
    if (y >= b.y0 && y <= b.y1) by = MAX(by, b.x1 - x);
  }
  return by;
}

/* Add a vertical line x 0..65, y 0..400, with a gate at y 100..300 and a line
   end at 400; and the line end of another line `gap` above. */
static inline void add_end(chip *c, int32_t gap) {
  add_poly(c, 0, 0, 65, 400);
  add_poly(c, 0, 400 + gap, 65, 1200);
  c->fragments[2].gate = 0;
  c->fragments[2].role = EDA_END_HIGH;
  c->box[0] = (eda_box){0, 100, 65, 300};
  c->space[0] = c->space[1] = 500;
  c->drawn[0] = INFINITY;
  c->drawn[1] = 100;
  c->gates.count = 1;
  c->gates.box = c->box;
  c->gates.axis = c->axis;
  c->gates.space = c->space;
  c->gates.extension = c->drawn;
}

static inline double line_ends(const chip *c, double x, double y) {
  double low = fmin(fmin(x, 65 - x), 300 + c->extension[1] - y);
  return fmax(fmin(low, y), fmin(fmin(x, 65 - x), y - 520));
}

/* Displace the line end of the mask as the last ruling requires. */
static inline void chip_follow(chip *c) {
  memcpy(c->moved, c->points, sizeof c->moved);
  c->moved[2].y = c->moved[3].y += c->end[1];
  c->mask[EDA_POLY].points = c->moved;
}

/* Return the width of the head beyond the line on each side, or 0 without a
   head. */
static inline int32_t head_width(const chip *c) {
  if (!c->ruling.added[EDA_POLY].count) return 0;
  g_assert_cmpuint(c->ruling.added[EDA_POLY].count, ==, 1);
  eda_box b = c->ruling.added[EDA_POLY].box[0];
  g_assert_cmpint(-b.x0, ==, b.x1 - 65);
  g_assert_cmpint(b.y0, ==, 320); /* twice the overlay past the active */
  g_assert_cmpint(b.y1, ==, 400 + c->end[1]);
  return -b.x0;
}

/* Return the depth of cut-outs at x, from the edge y downwards (`down`) or
   upwards. */
static inline int32_t cutout_depth(const chip *c, double x, int32_t y,
                                   int down) {
  int32_t depth = 0;
  for (size_t i = 0; i < c->ruling.cutouts[EDA_POLY].count; i++) {
    eda_box b = c->ruling.cutouts[EDA_POLY].box[i];
    if (x < b.x0 || x > b.x1) continue;
    if (down ? b.y0 < y && b.y1 >= y : b.y1 > y && b.y0 <= y)
      depth = MAX(depth, down ? y - b.y0 : b.y1 - y);
  }
  return depth;
}
