/* SPDX-License-Identifier: BSD-3-Clause */
/* Test helpers of synthesizer.epe: shapes without transistors, and their
   correction with edge placement errors from a function of the test. */
#pragma once

#include <eda/eda.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

/* ---- shapes ---- */

enum { LAYERS = 2 }; /* poly and active; active is empty */

typedef struct shapes {
  eda_gates gates;
  eda_shapes drawn[LAYERS];
  eda_edges edges[LAYERS];
} shapes;

/* Return merged boxes on a grid of 1 nm. */
static inline shapes *make_shapes(const eda_box *boxes, size_t n) {
  shapes *s = g_new0(shapes, 1);
  g_autofree eda_point *points = g_new(eda_point, 4 * n);
  g_autofree uint32_t *start = g_new(uint32_t, n + 1);
  for (size_t i = 0; i < n; i++) {
    eda_box b = boxes[i];
    eda_point p[] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
    memcpy(points + 4 * i, p, sizeof p);
    start[i] = (uint32_t)(4 * i);
  }
  start[n] = (uint32_t)(4 * n);
  eda_shapes all = {n, start, points, NULL};
  opc_error error;
  g_assert_cmpint(eda_boolean(EDA_OR, &all, NULL, s->drawn, &error), ==,
                  OPC_OK);
  static char *names[LAYERS] = {"poly", "active"};
  static uint8_t corrected[LAYERS] = {1, 1};
  s->gates = (eda_gates){.grid = 1,
                         .layers = LAYERS,
                         .layer = names,
                         .corrected = corrected,
                         .drawn = s->drawn,
                         .edges = s->edges};
  return s;
}

static inline void free_shapes(shapes *s) {
  eda_shapes_clear(s->drawn);
  g_free(s);
}
G_DEFINE_AUTOPTR_CLEANUP_FUNC(shapes, free_shapes)

static inline uint32_t trial_draw(uint32_t *state, uint32_t below) {
  *state = *state * 1664525u + 1013904223u;
  return (*state >> 8) % below;
}

/* Return wires with gaps, links between them, and jogs of a few nm. */
static inline shapes *messy(uint32_t seed) {
  eda_box boxes[200];
  size_t n = 0;
  for (int32_t row = 0; row < 4; row++)
    for (int32_t x = (int32_t)trial_draw(&seed, 100); x < 1200 && n < 190;) {
      int32_t y = 160 * row, end = x + 80 + (int32_t)trial_draw(&seed, 600);
      boxes[n++] = (eda_box){x, y, end, y + 70};
      if (!trial_draw(&seed, 3))
        boxes[n++] = (eda_box){end - 70, y, end, y + 230};
      if (!trial_draw(&seed, 3))
        boxes[n++] =
            (eda_box){x, y - (int32_t)trial_draw(&seed, 30), x + 75, y + 70};
      x = end + 85 + (int32_t)trial_draw(&seed, 80);
    }
  return make_shapes(boxes, n);
}

/* ---- correction with a synthetic image ---- */

typedef struct trial {
  opc_module *module;
  eda_cuts cuts;
  size_t count;
  int32_t *shift;
  double *epe;
  int updates;
} trial;

typedef double (*response)(const trial *t, size_t i);

static inline trial trial_correct(const char *parameters,
                                  const eda_gates *gates, response errors) {
  opc_error error;
  trial t = {.module = opc_test_module("synthesizer.epe", parameters, &error)};
  if (!t.module) g_error("%s", error.message);
  const eda_synthesizer *s = t.module->functions;
  eda_feedback f = {.gates = gates};
  g_assert_cmpint(s->begin(t.module->self, &f, &error), ==, OPC_OK);
  g_assert_cmpint(s->cut(t.module->self, gates, EDA_POLY, &t.cuts, &error), ==,
                  OPC_OK);
  t.count = t.cuts.start[t.cuts.polygons];
  t.shift = g_new0(int32_t, t.count);
  t.epe = g_new0(double, t.count);
  const double *epe[LAYERS] = {t.epe};
  int32_t *shift[LAYERS] = {t.shift};
  eda_boxes assists[LAYERS] = {t.cuts.assists};
  f.epe = epe;
  eda_moves moves = {.shift = shift, .assists = assists};
  for (int done = 0; !done; f.iteration++, t.updates++) {
    g_assert_cmpint(t.updates, <, 200);
    for (size_t i = 0; i < t.count; i++) t.epe[i] = errors(&t, i);
    g_assert_cmpint(s->update(t.module->self, &f, &moves, &done, &error), ==,
                    OPC_OK);
  }
  for (size_t i = 0; i < t.count; i++) t.epe[i] = errors(&t, i);
  return t;
}

static inline void trial_clear(trial *t) {
  opc_test_module_free(t->module);
  g_free(t->shift);
  g_free(t->epe);
}

static inline size_t fragment_after(const trial *t, size_t i) {
  for (size_t p = 0; p < t->cuts.polygons; p++)
    if (i + 1 == t->cuts.start[p + 1]) return t->cuts.start[p];
  return i + 1;
}

static inline size_t fragment_before(const trial *t, size_t i) {
  for (size_t p = 0; p < t->cuts.polygons; p++)
    if (i == t->cuts.start[p]) return t->cuts.start[p + 1] - 1;
  return i - 1;
}

/* Return errors of an image that is 9 nm too small and changes by 1.5 nm per nm
   of shift. */
static inline double straight(const trial *t, size_t i) {
  return -9 + 1.5 * t->shift[i];
}

/* Return random errors up to 40 nm. */
static inline double nonsense(const trial *t, size_t i) {
  uint32_t state = (uint32_t)(i * 7919 + 13);
  return trial_draw(&state, 80) - 40.0 + 0.1 * t->shift[i];
}

/* Return the merged mask of the moves. */
static inline eda_shapes moved_of(const trial *t, const eda_gates *gates) {
  g_autoptr(GArray) points = g_array_new(FALSE, FALSE, sizeof(eda_point));
  g_autoptr(GArray) start = g_array_new(FALSE, FALSE, sizeof(uint32_t));
  for (size_t p = 0; p < t->cuts.polygons; p++) {
    g_array_append_val(start, points->len);
    for (uint32_t i = t->cuts.start[p]; i < t->cuts.start[p + 1]; i++) {
      size_t b = fragment_before(t, i);
      eda_point c[3] = {t->cuts.from[b], t->cuts.from[i],
                        t->cuts.from[fragment_after(t, i)]};
      size_t who[2] = {b, i};
      eda_point to[2] = {c[1], c[1]};
      for (int k = 0; k < 2; k++) {
        int32_t dx = c[k + 1].x - c[k].x, dy = c[k + 1].y - c[k].y;
        int32_t by = t->shift[who[k]];
        if (dx)
          to[k].y += dx > 0 ? -by : by;
        else
          to[k].x += dy > 0 ? by : -by;
      }
      int turn = (c[0].x == c[1].x) != (c[1].x == c[2].x);
      if (turn) {
        eda_point q = c[0].x == c[1].x ? (eda_point){to[0].x, to[1].y}
                                       : (eda_point){to[1].x, to[0].y};
        g_array_append_val(points, q);
      } else {
        g_array_append_vals(points, to, 2);
      }
    }
  }
  g_array_append_val(start, points->len);
  eda_shapes moved = {t->cuts.polygons, (uint32_t *)(void *)start->data,
                      (eda_point *)(void *)points->data,
                      gates->drawn[EDA_POLY].hole};
  eda_shapes merged;
  opc_error error;
  g_assert_cmpint(eda_boolean(EDA_OR, &moved, NULL, &merged, &error), ==,
                  OPC_OK);
  return merged;
}
