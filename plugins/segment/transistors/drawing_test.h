/* SPDX-License-Identifier: BSD-3-Clause */
/* Test helpers of segment.transistors: layouts drawn by hand, and checks of the
   transistors and edges found in them. */
#pragma once

#include <eda/gates.h>
#include <eda/layout.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

/* ---- drawing ---- */

typedef struct drawing {
  eda_layout *layout;
  int32_t cell;
} drawing;

static inline drawing drawing_new(void) {
  opc_error error;
  drawing d = {eda_layout_new(1, &error), 0};
  d.cell = eda_layout_cell(d.layout, "TOP", &error);
  return d;
}

static inline void box(drawing *d, const char *layer, int32_t x0, int32_t y0,
                       int32_t x1, int32_t y1) {
  opc_error error;
  int32_t l = eda_layout_layer(d->layout, layer, &error);
  eda_box b = {x0, y0, x1, y1};
  g_assert_cmpint(eda_layout_add_box(d->layout, d->cell, l, b, &error), ==,
                  OPC_OK);
}

/* 1: x and y are exchanged. */
static int swap;
static inline void drawing_box(drawing *d, const char *layer, int32_t x0,
                               int32_t y0, int32_t x1, int32_t y1) {
  if (swap)
    box(d, layer, y0, x0, y1, x1);
  else
    box(d, layer, x0, y0, x1, y1);
}

/* ---- running ---- */

typedef struct result {
  opc_module *module;
  void *gates;
} result;

static inline result layout_segment(void *layout, const char *map) {
  opc_error error;
  result r = {opc_test_module("segment.transistors", map, &error), NULL};
  if (!r.module) g_error("%s", error.message);
  opc_test_input(r.module, "layout", layout);
  if (opc_test_run(r.module, &r.gates, &error)) g_error("%s", error.message);
  return r;
}

static inline void result_free(result *r) {
  opc_test_release(r->module, &r->gates);
  opc_test_module_free(r->module);
}

static inline void assert_refused(drawing *d, const char *map, int code,
                                  const char *message) {
  opc_error error;
  void *out;
  g_autoptr(opc_module) m = opc_test_module("segment.transistors", map, &error);
  g_assert_nonnull(m);
  opc_test_input(m, "layout", d->layout);
  g_assert_cmpint(opc_test_run(m, &out, &error), ==, code);
  g_assert_cmpstr(error.message, ==, message);
  g_assert_null(out);
  eda_layout_free(d->layout);
}

/* ---- checks ---- */

static inline char *gates_text(const eda_gates *g) {
  GString *s = g_string_new("");
  for (size_t i = 0; i < g->count; i++)
    g_string_append_printf(s, "%c%c %d,%d %gx%g space %g %g ends %g %g\n",
                           "np"[g->type[i]], "xy"[g->axis[i]], g -> box[i].x0,
                           g->box[i].y0, g->length[i], g->width[i],
                           g->space[2 * i], g->space[2 * i + 1],
                           g->extension[2 * i], g->extension[2 * i + 1]);
  return g_string_free(s, FALSE);
}

/* Return a text that lists the start, role and gate of each fragment. */
static inline char *edges_text(const eda_edges *e) {
  static const char *const roles[] = {"-", "L<", "L>", "W<", "W>", "E<", "E>"};
  GString *s = g_string_new("");
  for (size_t p = 0; p < e->polygons; p++) {
    for (uint32_t i = e->start[p]; i < e->start[p + 1]; i++) {
      const eda_fragment *f = &e->fragments[i];
      g_string_append_printf(s, "%s%d,%d %s", i > e->start[p] ? "; " : "",
                             f->from.x, f->from.y, roles[f->role]);
      if (f->gate >= 0) g_string_append_printf(s, "%d", f->gate);
    }
    g_string_append_c(s, '\n');
  }
  return g_string_free(s, FALSE);
}

/* Assert that unmoved fragments form the drawn polygons. */
static inline void check_rebuilt(const eda_gates *g, int layer) {
  const eda_edges *e = &g->edges[layer];
  const eda_shapes *drawn = &g->drawn[layer];
  g_assert_cmpuint(e->polygons, ==, drawn->count);
  for (size_t p = 0; p < e->polygons; p++) {
    uint32_t n = e->start[p + 1] - e->start[p], corner = drawn->start[p];
    const eda_fragment *f = e->fragments + e->start[p];
    for (uint32_t i = 0; i < n; i++) {
      eda_point a = f[(i + n - 1) % n].from, b = f[i].from,
                c = f[(i + 1) % n].from;
      g_assert_true((a.x == b.x) != (a.y == b.y));
      if ((a.x == b.x) == (b.x == c.x)) {
        /* The boundary of two fragments is on the segment between two
           corners. */
        g_assert_true((b.x > a.x) == (c.x > b.x) && (b.x < a.x) == (c.x < b.x));
        g_assert_true((b.y > a.y) == (c.y > b.y) && (b.y < a.y) == (c.y < b.y));
        continue;
      }
      g_assert_cmpint(b.x, ==, drawn->points[corner].x);
      g_assert_cmpint(b.y, ==, drawn->points[corner].y);
      corner++;
    }
    g_assert_cmpuint(corner, ==, drawn->start[p + 1]);
  }
}

/* Assert that every gate owns its sides, each with one fragment that covers the
   side, and owns its line ends, if any. */
static inline void check_owned(const eda_gates *g) {
  g_autofree uint8_t *seen = g_new0(uint8_t, g->count);
  for (int layer = 0; layer < 2; layer++)
    for (size_t p = 0; p < g->edges[layer].polygons; p++) {
      const eda_edges *e = &g->edges[layer];
      for (uint32_t i = e->start[p]; i < e->start[p + 1]; i++) {
        const eda_fragment *f = &e->fragments[i];
        g_assert_true((f->role == EDA_FIXED) == (f->gate < 0));
        if (f->gate < 0) continue;
        g_assert_cmpint(f->gate, <, g->count);
        g_assert_true((f->role == EDA_W_LOW || f->role == EDA_W_HIGH) ==
                      (layer == EDA_ACTIVE));
        g_assert_false(seen[f->gate] & 1 << f->role);
        seen[f->gate] |= (uint8_t)(1 << f->role);
        const eda_box *b = &g->box[f->gate];
        eda_point to =
            e->fragments[i + 1 < e->start[p + 1] ? i + 1 : e->start[p]].from;
        int vertical = f->from.x == to.x, high = !(f->role & 1);
        int axis = g->axis[f->gate];
        g_assert_true(vertical == ((axis == EDA_X) == (f->role == EDA_L_LOW ||
                                                       f->role == EDA_L_HIGH)));
        /* The interior is on the left. */
        g_assert_true(vertical ? (to.y > f->from.y) == high
                               : (to.x < f->from.x) == high);
        int32_t low = vertical ? MIN(f->from.y, to.y) : MIN(f->from.x, to.x);
        int32_t top = vertical ? MAX(f->from.y, to.y) : MAX(f->from.x, to.x);
        g_assert_cmpint(low, <=, vertical ? b->y0 : b->x0);
        g_assert_cmpint(top, >=, vertical ? b->y1 : b->x1);
        if (f->role >= EDA_END_LOW) continue;
        g_assert_cmpint(
            vertical ? f->from.x : f->from.y, ==,
            vertical ? (high ? b->x1 : b->x0) : (high ? b->y1 : b->y0));
      }
    }
  for (size_t i = 0; i < g->count; i++)
    for (int role = EDA_L_LOW; role <= EDA_END_HIGH; role++)
      g_assert_true(!(seen[i] & 1 << role) ==
                    (role >= EDA_END_LOW &&
                     isinf(g->extension[2 * i + (role == EDA_END_HIGH)])));
}

static inline void check_all(const eda_gates *g) {
  check_rebuilt(g, EDA_POLY);
  check_rebuilt(g, EDA_ACTIVE);
  check_owned(g);
}

static inline void segment_is(drawing *d, const char *map, const char *gates,
                              const char *poly, const char *active) {
  result r = layout_segment(d->layout, map);
  const eda_gates *g = r.gates;
  check_all(g);
  g_autofree char *got = gates_text(g);
  g_autofree char *got_poly = edges_text(&g->edges[EDA_POLY]);
  g_autofree char *got_active = edges_text(&g->edges[EDA_ACTIVE]);
  g_assert_cmpstr(got, ==, gates);
  g_assert_cmpstr(got_poly, ==, poly);
  g_assert_cmpstr(got_active, ==, active);
  result_free(&r);
  eda_layout_free(d->layout);
}

static inline void draw_single(drawing *d) {
  drawing_box(d, "active", 0, 0, 400, 200);
  drawing_box(d, "poly", 150, -100, 215, 300);
  drawing_box(d, "nimplant", -50, -50, 450, 250);
}
