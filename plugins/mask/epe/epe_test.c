/* SPDX-License-Identifier: BSD-3-Clause */
/* Fragments of shapes whose print is made up: solved, kept within the rules of
   the mask (checked here edge by edge), the same for any number of threads; and
   a line printed by the real models. */
#include "core/plugin/testing.h"

#include "core/plugin/host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const opc_host *host;

/* ---- shapes ---- */

typedef struct shapes {
  opc_gates gates;
  opc_shapes drawn;
} shapes;

/* Merged boxes on a grid of 1 nm. */
static shapes *make_shapes(const opc_box *boxes, size_t n) {
  shapes *s = g_new0(shapes, 1);
  g_autofree opc_point *points = g_new(opc_point, 4 * n);
  g_autofree uint32_t *start = g_new(uint32_t, n + 1);
  for (size_t i = 0; i < n; i++) {
    opc_box b = boxes[i];
    opc_point p[] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
    memcpy(points + 4 * i, p, sizeof p);
    start[i] = (uint32_t)(4 * i);
  }
  start[n] = (uint32_t)(4 * n);
  opc_shapes all = {n, start, points, NULL};
  opc_error error;
  g_assert_cmpint(host->geometry->boolean(host, OPC_OR, &all, NULL, &s->drawn,
                                          &error),
                  ==, OPC_OK);
  s->gates = (opc_gates){.size = sizeof s->gates, .grid = 1};
  s->gates.drawn[OPC_POLY] = s->drawn;
  return s;
}

static void free_shapes(shapes *s) {
  host->geometry->release(&s->drawn);
  g_free(s);
}
G_DEFINE_AUTOPTR_CLEANUP_FUNC(shapes, free_shapes)

static uint32_t draw(uint32_t *state, uint32_t below) {
  *state = *state * 1664525u + 1013904223u;
  return (*state >> 8) % below;
}

/* Wires with gaps, links between them, and steps of a few nm. */
static shapes *messy(uint32_t seed) {
  opc_box boxes[200];
  size_t n = 0;
  for (int32_t row = 0; row < 4; row++)
    for (int32_t x = (int32_t)draw(&seed, 100); x < 1200 && n < 190;) {
      int32_t y = 160 * row, end = x + 80 + (int32_t)draw(&seed, 600);
      boxes[n++] = (opc_box){x, y, end, y + 70};
      if (!draw(&seed, 3)) boxes[n++] = (opc_box){end - 70, y, end, y + 230};
      if (!draw(&seed, 3))
        boxes[n++] = (opc_box){x, y - (int32_t)draw(&seed, 30), x + 75, y + 70};
      x = end + 85 + (int32_t)draw(&seed, 80);
    }
  return make_shapes(boxes, n);
}

/* ---- a correction on a print made up ---- */

typedef struct trial {
  opc_module *module;
  opc_cuts cuts;
  size_t count;
  int32_t *shift;
  double *epe;
  int updates;
} trial;

typedef double (*response)(const trial *t, size_t i);

static trial correct(const char *parameters, const opc_gates *gates,
                     response errors) {
  opc_error error;
  trial t = {.module = opc_test_module("mask.epe", parameters, &error)};
  if (!t.module) g_error("%s", error.message);
  const opc_synthesizer *s = t.module->plugin->operations;
  opc_feedback f = {.size = sizeof f, .gates = gates};
  t.cuts.size = sizeof t.cuts;
  g_assert_cmpint(s->begin(t.module->self, &f, &error), ==, OPC_OK);
  g_assert_cmpint(s->cut(t.module->self, gates, OPC_POLY, &t.cuts, &error), ==,
                  OPC_OK);
  t.count = t.cuts.start[t.cuts.polygons];
  t.shift = g_new0(int32_t, t.count);
  t.epe = g_new0(double, t.count);
  f.epe[OPC_POLY] = t.epe;
  opc_moves moves = {.size = sizeof moves, .shift = {t.shift, NULL}};
  for (int done = 0; !done; f.iteration++, t.updates++) {
    g_assert_cmpint(t.updates, <, 200);
    for (size_t i = 0; i < t.count; i++) t.epe[i] = errors(&t, i);
    g_assert_cmpint(s->update(t.module->self, &f, &moves, &done, &error), ==,
                    OPC_OK);
  }
  for (size_t i = 0; i < t.count; i++) t.epe[i] = errors(&t, i);
  return t;
}

static void clear(trial *t) {
  opc_test_module_free(t->module);
  g_free(t->shift);
  g_free(t->epe);
}

static size_t after(const trial *t, size_t i) {
  for (size_t p = 0; p < t->cuts.polygons; p++)
    if (i + 1 == t->cuts.start[p + 1]) return t->cuts.start[p];
  return i + 1;
}

static size_t before(const trial *t, size_t i) {
  for (size_t p = 0; p < t->cuts.polygons; p++)
    if (i == t->cuts.start[p]) return t->cuts.start[p + 1] - 1;
  return i - 1;
}

/* ---- solved ---- */

/* The print follows at 1.5 nm a nm and is 9 nm too small. */
static double straight(const trial *t, size_t i) {
  return -9 + 1.5 * t->shift[i];
}

/* It follows the mean of three fragments, at 2 nm a nm. */
static double coupled(const trial *t, size_t i) {
  return 8 + 2 * (t->shift[before(t, i)] + t->shift[i] + t->shift[after(t, i)]) /
                 3.0;
}

static void test_solved(void) {
  const opc_box line = {0, 0, 100, 2000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  trial t = correct("{}", &s->gates, straight);
  g_assert_cmpuint(t.count, >, 80);
  for (size_t i = 0; i < t.count; i++) g_assert_cmpint(t.shift[i], ==, 6);
  clear(&t);
  t = correct("{ iterations: 40 }", &s->gates, coupled);
  for (size_t i = 0; i < t.count; i++) {
    g_assert_cmpfloat(fabs(t.epe[i]), <=, 1);
    g_assert_cmpint(abs(t.shift[i] + 4), <=, 1);
  }
  clear(&t);
}

/* Corners do not print; nothing they do helps. What is away from them comes out,
   and they stay within the largest shift. */
static double round_corners(const trial *t, size_t i) {
  int corner = t->cuts.from[i].y < 50 || t->cuts.from[i].y > 1950;
  return corner ? -30 : straight(t, i);
}

static void test_corners(void) {
  const opc_box line = {0, 0, 100, 2000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  trial t = correct("{ max_shift: 25 nm, blur: 20 nm, iterations: 60 }",
                    &s->gates, round_corners);
  for (size_t i = 0; i < t.count; i++) {
    int far = t.cuts.from[i].y > 200 && t.cuts.from[i].y < 1800;
    g_assert_cmpint(abs(t.shift[i]), <=, 25);
    if (far) g_assert_cmpfloat(fabs(t.epe[i]), <=, 1.5);
  }
  clear(&t);
}

/* A line that does not print is to grow; one that has merged, to shrink. */
static double hidden(const trial *t, size_t i) {
  return t->shift[i] < 10 ? (double)NAN : t->shift[i] > 25 ? (double)NAN : 14.0 - 20 + 1.0 * (t->shift[i] - 10);
}

static void test_lost(void) {
  const opc_box line = {0, 0, 60, 1000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  trial t = correct("{}", &s->gates, hidden);
  for (size_t i = 0; i < t.count; i++)
    g_assert_cmpfloat(fabs(t.epe[i]), <=, 1);
  clear(&t);
}

/* ---- fragments and sites ---- */

static void test_cut(void) {
  /* An L: concave at (200, 100). */
  const opc_box boxes[] = {{0, 0, 600, 100}, {0, 0, 200, 500}};
  g_autoptr(shapes) s = make_shapes(boxes, 2);
  trial t = correct("{ fragment: 50 nm, min_edge: 20 nm, corner_edge: 30 nm, concave_corner: 20 "
                    "nm, tangency: 45 nm, line_end: 100 nm, iterations: 0 }",
                    &s->gates, straight);
  int ends = 0, convex = 0, concave = 0;
  for (size_t i = 0; i < t.count; i++) {
    opc_point a = t.cuts.from[i], b = t.cuts.from[after(&t, i)];
    int length = abs(a.x - b.x) + abs(a.y - b.y);
    ends += a.x == 600 && b.x == 600 && length == 100;
    convex += a.x == 0 && a.y == 0 && length == 30;
    concave += length == 20 &&
               ((a.x == 200 && a.y == 100) || (b.x == 200 && b.y == 100));
    g_assert_cmpint(length, >=, 20);
    const double *site = &t.cuts.site[2 * i];
    if (a.y == 0 && b.y == 0) {
      g_assert_cmpfloat(site[0], >=, 45);
      g_assert_cmpfloat(site[0], <=, 555);
      g_assert_cmpfloat(site[1], ==, 0);
    }
  }
  g_assert_cmpint(ends, ==, 1);
  g_assert_cmpint(convex, ==, 1);
  g_assert_cmpint(concave, ==, 2);
  clear(&t);
}

/* Where the end of another line projects, an edge is cut. */
static void test_ripple(void) {
  const opc_box boxes[] = {{0, 0, 1000, 100}, {433, 200, 1500, 300}};
  g_autoptr(shapes) s = make_shapes(boxes, 2);
  for (int reach = 0; reach <= 150; reach += 150) {
    g_autofree char *p = g_strdup_printf(
        "{ ripple_reach: %d nm, ripple: 20 nm, iterations: 0 }", reach);
    trial t = correct(p, &s->gates, straight);
    int found = 0;
    for (size_t i = 0; i < t.count; i++)
      found += t.cuts.from[i].y == 100 &&
               (t.cuts.from[i].x == 433 || t.cuts.from[i].x == 413 ||
                t.cuts.from[i].x == 453);
    g_assert_cmpint(found, ==, reach ? 3 : 0);
    clear(&t);
  }
}

/* ---- the rules of the mask ---- */

/* An edge of the moved mask; the inside is on the left. */
typedef struct side {
  int32_t at, low, high;
  int upright, out;
} side;

static GArray *sides_of(const trial *t, const opc_gates *gates) {
  GArray *points = g_array_new(FALSE, FALSE, sizeof(opc_point));
  g_autoptr(GArray) start = g_array_new(FALSE, FALSE, sizeof(uint32_t));
  for (size_t p = 0; p < t->cuts.polygons; p++) {
    g_array_append_val(start, points->len);
    for (uint32_t i = t->cuts.start[p]; i < t->cuts.start[p + 1]; i++) {
      size_t b = before(t, i);
      opc_point c[3] = {t->cuts.from[b], t->cuts.from[i],
                        t->cuts.from[after(t, i)]};
      size_t who[2] = {b, i};
      opc_point to[2] = {c[1], c[1]};
      for (int k = 0; k < 2; k++) {
        int32_t dx = c[k + 1].x - c[k].x, dy = c[k + 1].y - c[k].y;
        int32_t by = t->shift[who[k]];
        if (dx) to[k].y += dx > 0 ? -by : by;
        else to[k].x += dy > 0 ? by : -by;
      }
      int turn = (c[0].x == c[1].x) != (c[1].x == c[2].x);
      if (turn) {
        opc_point q = c[0].x == c[1].x ? (opc_point){to[0].x, to[1].y}
                                       : (opc_point){to[1].x, to[0].y};
        g_array_append_val(points, q);
      } else {
        g_array_append_vals(points, to, 2);
      }
    }
  }
  g_array_append_val(start, points->len);
  opc_shapes moved = {t->cuts.polygons, (uint32_t *)(void *)start->data,
                      (opc_point *)(void *)points->data,
                      gates->drawn[OPC_POLY].hole};
  opc_shapes merged;
  opc_error error;
  g_assert_cmpint(
      host->geometry->boolean(host, OPC_OR, &moved, NULL, &merged, &error), ==,
      OPC_OK);
  GArray *sides = g_array_new(FALSE, FALSE, sizeof(side));
  for (size_t p = 0; p < merged.count; p++)
    for (uint32_t i = merged.start[p]; i < merged.start[p + 1]; i++) {
      opc_point a = merged.points[i];
      opc_point b = merged.points[i + 1 < merged.start[p + 1]
                                      ? i + 1
                                      : merged.start[p]];
      int upright = a.x == b.x, rises = upright ? b.y > a.y : b.x > a.x;
      side e = {upright ? a.x : a.y, upright ? MIN(a.y, b.y) : MIN(a.x, b.x),
                upright ? MAX(a.y, b.y) : MAX(a.x, b.x), upright,
                upright == rises ? 1 : -1};
      g_array_append_val(sides, e);
    }
  host->geometry->release(&merged);
  g_array_unref(points);
  return sides;
}

/* Pairs that face each other over less than `limit`: across the inside, where
   they overlap along their edges, or a space, also from corner to corner. */
static int too_near(GArray *sides, int inside, int32_t limit) {
  int found = 0;
  for (guint i = 0; i < sides->len; i++)
    for (guint k = 0; k < sides->len; k++) {
      side a = g_array_index(sides, side, i), b = g_array_index(sides, side, k);
      if (a.upright != b.upright || a.out == b.out) continue;
      if (a.out != (inside ? -1 : 1) || b.at <= a.at) continue;
      double along = MAX(a.low, b.low) - MIN(a.high, b.high);
      found += along < 0 ? b.at - a.at < limit
                         : !inside && hypot(b.at - a.at, along) < limit;
    }
  return found;
}

/* Errors of no sense at all, to 40 nm. */
static double nonsense(const trial *t, size_t i) {
  uint32_t state = (uint32_t)(i * 7919 + 13);
  return draw(&state, 80) - 40.0 + 0.1 * t->shift[i];
}

static int broken(const trial *t, const opc_gates *gates) {
  g_autoptr(GArray) sides = sides_of(t, gates);
  return too_near(sides, 0, 40) + too_near(sides, 1, 40);
}

/* Shapes that are drawn by the rules stay within them. */
static void test_rules(void) {
  int without = 0, tried = 0;
  for (uint32_t seed = 1; tried < 12; seed++) {
    g_assert_cmpuint(seed, <, 1000);
    g_autoptr(shapes) s = messy(seed);
    trial drawn = correct("{ iterations: 0 }", &s->gates, nonsense);
    if (!broken(&drawn, &s->gates)) {
      tried++;
      trial loose = correct(
          "{ min_width: 0 nm, min_space: 0 nm, iterations: 8 }", &s->gates,
          nonsense);
      trial t = correct("{ iterations: 8, min_jog: 3 nm }", &s->gates, nonsense);
      without += broken(&loose, &s->gates);
      g_assert_cmpint(broken(&t, &s->gates), ==, 0);
      int moved = 0;
      for (size_t i = 0; i < t.count; i++) moved += t.shift[i] != 0;
      g_assert_cmpint(moved, >, (int)t.count / 4);
      clear(&loose);
      clear(&t);
    }
    clear(&drawn);
  }
  g_assert_cmpint(without, >, 100);
}

static size_t jogs(const trial *t) {
  size_t n = 0;
  for (size_t i = 0; i < t->count; i++) n += t->shift[i] != t->shift[after(t, i)];
  return n;
}

static double wavy(const trial *t, size_t i) {
  return 6 * sin(0.4 * (double)i) + t->shift[i];
}

static void test_jogs(void) {
  const opc_box line = {0, 0, 100, 8000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  size_t last = SIZE_MAX;
  for (int jog = 1; jog <= 5; jog += 2) {
    g_autofree char *p = g_strdup_printf("{ min_jog: %d nm }", jog);
    trial t = correct(p, &s->gates, wavy);
    for (size_t i = 0; i < t.count; i++) {
      size_t k = after(&t, i);
      int corner = t.cuts.from[k].y % 8000 == 0;
      if (!corner && t.shift[i] != t.shift[k])
        g_assert_cmpint(abs(t.shift[i] - t.shift[k]), >=, jog);
    }
    g_assert_cmpuint(jogs(&t), <, last);
    last = jogs(&t);
    clear(&t);
  }
}

static void test_threads(void) {
  g_autoptr(shapes) s = messy(5);
  opc_set_threads(1);
  trial one = correct("{}", &s->gates, nonsense);
  opc_set_threads(7);
  trial seven = correct("{}", &s->gates, nonsense);
  opc_set_threads(0);
  g_assert_cmpmem(one.shift, one.count * sizeof *one.shift, seven.shift,
                  seven.count * sizeof *seven.shift);
  clear(&one);
  clear(&seven);
}

/* ---- real models ---- */

static void test_line(void) {
  opc_error error;
  opc_layout *layout = host->layout->create(host, 1, &error);
  int32_t cell = host->layout->cell(layout, "LINE", &error);
  int32_t layer = host->layout->layer(layout, "poly", &error);
  opc_box line = {0, 0, 65, 2000};
  g_assert_cmpint(host->layout->add_box(layout, cell, layer, line, &error), ==,
                  OPC_OK);
  g_autoptr(opc_module) segment = opc_test_module("segment.edges", "{}", &error);
  g_autofree char *p = g_strdup_printf(
      "{ litho: { use: litho.hopkins }, resist: { use: resist.threshold, "
      "threshold: 0.38, active_threshold: 0.38 }, extract: { use: "
      "extract.plain, devices: '%s/data/devices/ptm65.yaml' }, synthesizer: { "
      "use: mask.epe, blur: 50 nm } }",
      g_getenv("OPCFLOW_SOURCE") ? g_getenv("OPCFLOW_SOURCE") : ".");
  g_autoptr(opc_module) m = opc_test_module("correct", p, &error);
  if (!m) g_error("%s", error.message);
  void *gates[1], *mask[1];
  opc_test_input(segment, "layout", layout);
  g_assert_cmpint(opc_test_run(segment, gates, &error), ==, OPC_OK);
  opc_test_input(m, "gates", gates[0]);
  if (opc_test_run(m, mask, &error)) g_error("%s", error.message);
  const opc_mask *result = mask[0];
  /* The printed width along the line, and where it ends. */
  for (double y = 60; y < 1940; y += 47) {
    const opc_field *f = &result->print[OPC_POLY];
    double low = host->imaging->edge(f, OPC_X, 0, y, 40);
    double high = host->imaging->edge(f, OPC_X, 65, y, 40);
    g_assert_cmpfloat(fabs(low), <, y < 200 || y > 1800 ? 3 : 1);
    g_assert_cmpfloat(fabs(high), <, y < 200 || y > 1800 ? 3 : 1);
  }
  double end = host->imaging->edge(&result->print[OPC_POLY], OPC_Y, 32.5, 0, 90);
  g_assert_cmpfloat(fabs(end), <, 3);
  opc_test_release(m, mask);
  opc_test_release(segment, gates);
  host->layout->destroy(layout);
}

static void test_refused(void) {
  opc_error error;
  g_assert_null(opc_test_module(
      "mask.epe", "{ fragment: 20 nm, min_edge: 30 nm }", &error));
  g_assert_nonnull(strstr(error.message, "30 nm is more than a fragment"));
  const opc_box line = {0, 0, 60, 1000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  g_autoptr(opc_module) m = opc_test_module("mask.epe", "{ best: ion }", &error);
  const opc_synthesizer *y = m->plugin->operations;
  opc_feedback f = {.size = sizeof f, .gates = &s->gates};
  g_assert_cmpint(y->begin(m->self, &f, &error), ==, OPC_INVALID);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  host = opc_test_host();
  g_test_add_func("/epe/solved", test_solved);
  g_test_add_func("/epe/corners", test_corners);
  g_test_add_func("/epe/lost", test_lost);
  g_test_add_func("/epe/cut", test_cut);
  g_test_add_func("/epe/ripple", test_ripple);
  g_test_add_func("/epe/rules", test_rules);
  g_test_add_func("/epe/jogs", test_jogs);
  g_test_add_func("/epe/threads", test_threads);
  g_test_add_func("/epe/line", test_line);
  g_test_add_func("/epe/refused", test_refused);
  return g_test_run();
}
