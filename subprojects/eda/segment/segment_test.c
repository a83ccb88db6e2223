/* SPDX-License-Identifier: BSD-3-Clause */
/* Windows of a layout, compared with the whole layout: transistors bit by bit,
   and owners of edges. Gates and instances written by hand. Recognition is
   tested by segment.transistors. */
#include <eda/segment.h>
#include <glib.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* ---- layouts ---- */

static void box(eda_layout *layout, int32_t cell, const char *layer, int32_t x0,
                int32_t y0, int32_t x1, int32_t y1) {
  opc_error e;
  int32_t l = eda_layout_layer(layout, layer, &e);
  g_assert_cmpint(
      eda_layout_add_box(layout, cell, l, (eda_box){x0, y0, x1, y1}, &e), ==,
      0);
}

/* Add lines over an active, with near and far ends; some with contacts, with a
   turning tail, or with a note. */
static int32_t random_cell(eda_layout *layout, int k, GRand *rand) {
  opc_error e;
  char name[8];
  g_snprintf(name, sizeof name, "C%d", k);
  int32_t cell = eda_layout_cell(layout, name, &e);
  int lines = g_rand_int_range(rand, 1, 4);
  int pitch = g_rand_int_range(rand, 200, 500);
  int w = g_rand_int_range(rand, 100, k % 4 ? 900 : 5000);
  int left = g_rand_int_range(rand, 60, k % 5 ? 300 : 6000);
  box(layout, cell, "active", -left, 0, lines * pitch + left, w);
  if (g_rand_boolean(rand))
    box(layout, cell, "nwell", -left - 99, -99, lines * pitch + left + 99,
        w + 99);
  for (int i = 0; i < lines; i++) {
    int x = i * pitch, up = g_rand_int_range(rand, 20, 600);
    int down = g_rand_int_range(rand, 20, 600);
    box(layout, cell, "poly", x, -down, x + 60 + i, w + up);
    if (i == 1) box(layout, cell, "poly", x, w + up, x + 300, w + up + 70);
    box(layout, cell, "contact", x + 90, 20, x + 150, 80);
  }
  int32_t notes = eda_layout_layer(layout, "notes", &e);
  g_snprintf(name, sizeof name, "ion=1.%d", k);
  if (k % 2)
    eda_layout_add_text(layout, cell, notes, (eda_point){30, 30}, name, &e);
  return cell;
}

/* Return a layout of cells and arrays in all eight orientations, side by side,
   in two levels, with rows of a shared active and a long line of poly. */
static eda_layout *random_layout(double unit, GRand *rand) {
  opc_error e;
  eda_layout *layout = eda_layout_new(unit, &e);
  static const char *const layers[] = {"poly",  "active", "contact",
                                       "nwell", "notes",  "M1"};
  for (size_t k = 0; k < G_N_ELEMENTS(layers); k++)
    eda_layout_layer(layout, layers[k], &e);
  int32_t top = eda_layout_cell(layout, "TOP", &e), cell[6];
  for (int k = 0; k < 6; k++) cell[k] = random_cell(layout, k, rand);
  for (int y = 0; y < 3; y++)
    for (int x = 0; x < 3; x++) {
      eda_placement p = {.magnification = 1,
                         .angle = 90 * g_rand_int_range(rand, 0, 4),
                         .mirror = (uint32_t)g_rand_int_range(rand, 0, 2),
                         .origin = {x * 36000, y * 36000},
                         .columns = 2,
                         .rows = 1,
                         .column_step = {17000, 11}};
      eda_layout_add_instance(layout, top, cell[g_rand_int_range(rand, 0, 6)],
                              &p, NULL, &e);
    }
  for (int x = 0; x < 40; x++)
    box(layout, top, "poly", 120000 + x * 1900, 0, 120060 + x * 1900, 700);
  box(layout, top, "active", 119000, 200, 200000, 600);
  box(layout, top, "active", 119000, -9000, 200000, -8000);
  box(layout, top, "poly", 150000, -30000, 150070, -2000);
  box(layout, top, "M1", 0, 0, 9000, 100);
  return layout;
}

/* ---- contents ---- */

static bool starts_in(eda_box core, eda_box b) {
  return b.x0 >= core.x0 && b.x0 < core.x1 && b.y0 >= core.y0 && b.y0 < core.y1;
}

/* Return all fields of a gate as text, exact to the bit. */
static char *gate_text(const eda_gates *g, size_t i) {
  eda_box b = g->box[i];
  eda_goal goal = eda_gates_goal(g, i);
  return g_strdup_printf(
      "%d,%d %d,%d %d%d %a %a space %a %a ends %a %a wish %d %a", b.x0, b.y0,
      b.x1, b.y1, g->type[i], g->axis[i], g->length[i], g->width[i],
      g->space[2 * i], g->space[2 * i + 1], g->extension[2 * i],
      g->extension[2 * i + 1], goal.given, goal.target[EDA_GOAL_ION]);
}

static GPtrArray *gates_in(const eda_gates *g, eda_box core) {
  GPtrArray *all = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; i < g->count; i++)
    if (starts_in(core, g->box[i])) g_ptr_array_add(all, gate_text(g, i));
  return all;
}

/* Clip an edge from a to b to the core. Return whether a part remains. */
static bool edge_clip(eda_point *a, eda_point *b, eda_box c) {
  int *from[2] = {&a->x, &a->y}, *to[2] = {&b->x, &b->y};
  int low[2] = {c.x0, c.y0}, high[2] = {c.x1, c.y1};
  for (int d = 0; d < 2; d++) {
    if (*from[d] == *to[d] && (*from[d] <= low[d] || *from[d] >= high[d]))
      return false;
    *from[d] = CLAMP(*from[d], low[d], high[d]);
    *to[d] = CLAMP(*to[d], low[d], high[d]);
  }
  return a->x != b->x || a->y != b->y;
}

static int by_text(gconstpointer a, gconstpointer b) {
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Return the fragments within a core, with the boxes of their gates. */
static GPtrArray *edges_in(const eda_gates *g, eda_box core) {
  GPtrArray *all = g_ptr_array_new_with_free_func(g_free);
  for (size_t k = 0; k < g->layers; k++) {
    const eda_edges *e = &g->edges[k];
    for (size_t p = 0; p < e->polygons; p++)
      for (uint32_t i = e->start[p]; i < e->start[p + 1]; i++) {
        const eda_fragment *f = &e->fragments[i];
        uint32_t next = i + 1 < e->start[p + 1] ? i + 1 : e->start[p];
        eda_point a = f->from, b = e->fragments[next].from;
        if (!edge_clip(&a, &b, core)) continue;
        eda_box of = f->gate >= 0 ? g->box[f->gate] : (eda_box){0, 0, 0, 0};
        g_ptr_array_add(
            all, g_strdup_printf("%s %d,%d %d,%d %d of %d,%d %d,%d",
                                 g->layer[k], a.x, a.y, b.x, b.y, f->role,
                                 of.x0, of.y0, of.x1, of.y1));
      }
  }
  g_ptr_array_sort(all, by_text);
  return all;
}

static void assert_same(GPtrArray *a, GPtrArray *b) {
  for (guint i = 0; i < MIN(a->len, b->len); i++)
    g_assert_cmpstr(a->pdata[i], ==, b->pdata[i]);
  g_assert_cmpuint(a->len, ==, b->len);
  g_ptr_array_free(a, TRUE);
  g_ptr_array_free(b, TRUE);
}

/* ---- tests ---- */

static const char *const also[] = {"metal1", "M1"};
static const eda_segment_settings usual = {
    .grid = 1, .overhang = 84, .line_end = 200, .also = also, .also_count = 1};

/* Check the extent: the bounds of all shapes; without shapes, a place near the
   core. */
static void check_extent(const eda_gates *g) {
  eda_box all = {INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN};
  for (size_t k = 0; k < g->layers; k++) {
    const eda_shapes *s = &g->drawn[k];
    for (uint32_t i = 0; s->count && i < s->start[s->count]; i++) {
      eda_point p = s->points[i];
      all = (eda_box){MIN(all.x0, p.x), MIN(all.y0, p.y), MAX(all.x1, p.x),
                      MAX(all.y1, p.y)};
    }
  }
  if (all.x0 > all.x1) return;
  g_assert_cmpmem(&g->extent, sizeof all, &all, sizeof all);
}

static void check_windows(const eda_layout *layout, const eda_gates *all,
                          int32_t size, eda_point offset) {
  opc_error error;
  size_t seen = 0;
  eda_box e = all->extent;
  for (int32_t y = e.y0 - offset.y; y <= e.y1; y += size)
    for (int32_t x = e.x0 - offset.x; x <= e.x1; x += size) {
      eda_box core = {x, y, x + size, y + size};
      eda_gates *g;
      if (eda_segment_core(layout, 0, &usual, core, 0, &g, &error))
        g_error("%s", error.message);
      if (eda_gates_check(g, &error)) g_error("%s", error.message);
      g_assert_cmpuint(g->layers, ==, all->layers);
      check_extent(g);
      GPtrArray *gates = gates_in(g, core);
      seen += gates->len;
      assert_same(gates, gates_in(all, core));
      assert_same(edges_in(g, core), edges_in(all, core));
      eda_gates_free(g);
    }
  g_assert_cmpuint(seen, ==, all->count);
}

static void test_windows(void) {
  static const double units[] = {1, 0.7, 1.3};
  GRand *rand = g_rand_new_with_seed(5);
  for (int round = 0; round < 6; round++) {
    opc_error error;
    eda_layout *layout = random_layout(units[round % 3], rand);
    eda_gates *all;
    eda_segment_report report;
    if (eda_segment(NULL, layout, 0, &usual, &all, &report, &error))
      g_error("%s", error.message);
    g_assert_cmpuint(all->count, >, 60);
    check_extent(all);
    g_assert_true(round % 3 == 0 || report.moved > 0);
    eda_point offset = {g_rand_int_range(rand, 0, 3000),
                        g_rand_int_range(rand, 0, 3000)};
    check_windows(layout, all, round % 2 ? 3700 : 16000, offset);
    check_windows(layout, all, 400000, offset);
    eda_gates_free(all);
    eda_layout_free(layout);
  }
  g_rand_free(rand);
}

/* A window clips the shapes at its border and may be empty. */
static void test_cut(void) {
  opc_error error;
  eda_layout *layout = eda_layout_new(1, &error);
  eda_layout_cell(layout, "TOP", &error);
  box(layout, 0, "active", 0, 0, 1000, 200);
  box(layout, 0, "poly", 200, -100, 260, 300);
  box(layout, 0, "poly", 600, -100, 660, 300);
  box(layout, 0, "nwell", 5000, 5000, 5100, 5100);
  static const struct {
    eda_box window;
    size_t gates, polygons;
    double extension; /* extension of the first gate at its low end */
  } cases[] = {{{-500, -500, 5000, 5000}, 2, 2, 100},
               {{-500, -500, 630, 5000}, 1, 2, 100},
               {{210, -500, 5000, 250}, 1, 2, 100},
               {{0, -50, 5000, 250}, 2, 2, INFINITY},
               {{0, 0, 5000, 250}, 0, 2, 0},
               {{300, -500, 500, 5000}, 0, 0, 0},
               {{7000, 7000, 9000, 9000}, 0, 0, 0}};
  eda_segment_settings settings = {.grid = 1, .line_end = 200, .paths = 1};
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    eda_gates *g;
    if (eda_segment_window(layout, 0, &settings, &cases[k].window, &g, &error))
      g_error("%s", error.message);
    g_assert_cmpint(eda_gates_check(g, &error), ==, OPC_OK);
    g_assert_cmpuint(g->count, ==, cases[k].gates);
    g_assert_cmpuint(g->drawn[EDA_POLY].count, ==, cases[k].polygons);
    if (g->count) {
      g_assert_cmpfloat(g->extension[0], ==, cases[k].extension);
      g_assert_cmpstr(g->cell[0], ==, "TOP");
      g_assert_cmpuint(g->number[0], ==, 0);
    }
    eda_gates_free(g);
  }
  /* Invalid transistors are rejected if they are entirely inside the window. */
  box(layout, 0, "poly", 260, 50, 300, 100);
  eda_gates *g;
  g_assert_cmpint(
      eda_segment_window(layout, 0, &settings, &cases[0].window, &g, &error),
      ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "the gate is not a rectangle"));
  g_assert_null(g);
  g_assert_cmpint(
      eda_segment_window(layout, 0, &settings, &cases[5].window, &g, &error),
      ==, OPC_OK);
  eda_gates_free(g);
  eda_layout_free(layout);
}

/* ---- gates by hand ---- */

/* The gates of eda_gates_sample, written by hand. The sides of the poly belong
   to a gate up to the line end, the sides of the active up to its ends. */
static void test_sample(void) {
  static eda_fragment line[] = {
      {{0, 0}, 0, EDA_END_LOW},      {{60, 0}, 0, EDA_L_HIGH},
      {{60, 300}, -1, EDA_FIXED},    {{60, 600}, 1, EDA_L_HIGH},
      {{60, 1000}, 1, EDA_END_HIGH}, {{0, 1000}, 1, EDA_L_LOW},
      {{0, 600}, -1, EDA_FIXED},     {{0, 300}, 0, EDA_L_LOW}};
  static eda_fragment sides[] = {
      {{-200, 100}, 0, EDA_W_LOW}, {{260, 100}, -1, EDA_FIXED},
      {{260, 300}, 0, EDA_W_HIGH}, {{-200, 300}, -1, EDA_FIXED},
      {{-200, 600}, 1, EDA_W_LOW}, {{260, 600}, -1, EDA_FIXED},
      {{260, 900}, 1, EDA_W_HIGH}, {{-200, 900}, -1, EDA_FIXED}};
  static uint32_t poly[] = {0, 8}, active[] = {0, 4, 8};
  static const eda_edges edges[] = {{1, poly, line}, {2, active, sides}};
  opc_error error;
  eda_gates *g;
  eda_segment_report report;
  const eda_gates *want = eda_gates_sample();
  eda_layout *layout = eda_layout_new(1, &error);
  eda_layout_cell(layout, "sample", &error);
  box(layout, 0, "active", -200, 100, 260, 300);
  box(layout, 0, "active", -200, 600, 260, 900);
  box(layout, 0, "poly", 0, 0, 60, 1000);
  box(layout, 0, "nwell", -300, 500, 360, 1100);
  eda_segment_settings s = {.grid = 1, .overhang = 0, .line_end = 100};
  if (eda_segment(NULL, layout, 0, &s, &g, &report, &error))
    g_error("%s", error.message);
  g_assert_cmpuint(g->count, ==, want->count);
  g_assert_cmpuint(g->layers, ==, want->layers);
  for (size_t i = 0; i < g->count; i++) {
    g_autofree char *is = gate_text(g, i), *expected = gate_text(want, i);
    g_assert_cmpstr(is, ==, expected);
    g_assert_cmpstr(g->cell[i], ==, want->cell[i]);
    g_assert_cmpstr(g->instance[i], ==, want->instance[i]);
    g_assert_cmpuint(g->number[i], ==, want->number[i]);
  }
  for (size_t k = 0; k < g->layers; k++) {
    const eda_edges *a = &g->edges[k], *b = &edges[k];
    g_assert_cmpint(g->corrected[k], ==, want->corrected[k]);
    g_assert_cmpmem(a->start, (a->polygons + 1) * sizeof *a->start, b->start,
                    (b->polygons + 1) * sizeof *b->start);
    for (uint32_t i = 0; i < b->start[b->polygons]; i++) {
      const eda_fragment *f = &a->fragments[i], *o = &b->fragments[i];
      g_assert_true(f->from.x == o->from.x && f->from.y == o->from.y &&
                    f->gate == o->gate && f->role == o->role);
    }
  }
  eda_gates_free(g);
  eda_layout_free(layout);
}

/* Gates are numbered within their instances, from the lowest, then leftmost
   one. */
static void test_instances(void) {
  static const char want[] =
      "X1:PAIR:1 PAIR#1:PAIR:1 X1:PAIR:2 PAIR#1:PAIR:2 :TOP:1 ";
  opc_error error;
  eda_gates *g;
  eda_segment_report report;
  eda_layout *layout = eda_layout_new(1, &error);
  int32_t top = eda_layout_cell(layout, "TOP", &error),
          pair = eda_layout_cell(layout, "PAIR", &error);
  for (int32_t y = 0; y < 2000; y += 1000) {
    box(layout, pair, "active", 0, y, 500, y + 300);
    box(layout, pair, "poly", 200, y - 100, 260, y + 400);
  }
  box(layout, top, "active", 0, 4000, 500, 4300);
  box(layout, top, "poly", 200, 3900, 260, 4400);
  box(layout, top, "contact", 900, 900, 960, 960);
  box(layout, top, "nwell", 9000, 0, 9100, 100);
  eda_placement p = {.magnification = 1, .columns = 1, .rows = 1};
  eda_layout_add_instance(layout, top, pair, &p, "X1", &error);
  p.origin.x = 3000;
  eda_layout_add_instance(layout, top, pair, &p, NULL, &error);
  eda_segment_settings s = {.grid = 1};
  if (eda_segment(NULL, layout, top, &s, &g, &report, &error))
    g_error("%s", error.message);
  g_autoptr(GString) is = g_string_new(NULL);
  for (size_t i = 0; i < g->count; i++)
    g_string_append_printf(is, "%s:%s:%u ", g->instance[i], g->cell[i],
                           g->number[i]);
  g_assert_cmpstr(is->str, ==, want);
  /* Contacts are not corrected. */
  g_assert_cmpuint(g->layers, ==, 3);
  g_assert_true(g->corrected[0] == 1 && g->corrected[1] == 1 &&
                g->corrected[2] == 0);
  eda_gates_free(g);
  eda_layout_free(layout);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/segment/windows", test_windows);
  g_test_add_func("/segment/cut", test_cut);
  g_test_add_func("/segment/sample", test_sample);
  g_test_add_func("/segment/instances", test_instances);
  return g_test_run();
}
