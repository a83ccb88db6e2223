/* SPDX-License-Identifier: BSD-3-Clause */
/* Windows of a layout, compared with the whole layout: transistors bit by bit,
   and owners of edges. Flavours, settings and layers without transistors.
   Recognition is tested by segment.transistors. */
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

/* ---- flavours and settings ---- */

enum { ROW = 4, PITCH = 2000 };

/* Draw a marker over the gates a .. b of row_new. */
static void row_mark(eda_layout *layout, const char *layer, int a, int b) {
  box(layout, 0, layer, PITCH * a - 200, -200, PITCH * b + 900, 800);
}

/* Return ROW gates of length 150 and width 600, with the markers M on gates 1
   and 2, N on 2 and 3, PART on a part of gate 0, and no shape on EMPTY. */
static eda_layout *row_new(void) {
  opc_error e;
  eda_layout *layout = eda_layout_new(1, &e);
  eda_layout_cell(layout, "TOP", &e);
  for (int i = 0; i < ROW; i++) {
    box(layout, 0, "active", PITCH * i, 0, PITCH * i + 750, 600);
    box(layout, 0, "poly", PITCH * i + 300, -150, PITCH * i + 450, 750);
  }
  box(layout, 0, "nwell", 20000, 0, 21000, 1000);
  row_mark(layout, "M", 1, 2);
  row_mark(layout, "N", 2, 3);
  box(layout, 0, "PART", 310, 0, 900, 600);
  eda_layout_layer(layout, "EMPTY", &e);
  return layout;
}

/* Segment the row. Return the flavours with blanks between ("-": none), or the
   parameter and the message of the error. */
static char *row_flavours(const eda_layout *layout, const char *const *pairs,
                          size_t count) {
  opc_error error;
  eda_gates *g;
  eda_segment_report report;
  eda_segment_settings s = {
      .grid = 1, .flavours = pairs, .flavour_count = count};
  if (eda_segment_check(&s, &error) ||
      eda_segment(NULL, layout, 0, &s, &g, &report, &error))
    return g_strdup_printf("%s: %s", error.parameter, error.message);
  g_assert_cmpuint(g->count, ==, ROW);
  GString *out = g_string_new(NULL);
  for (size_t i = 0; i < ROW; i++) {
    const char *name = eda_gates_flavour(g, i);
    g_string_append_printf(out, "%s%s", i ? " " : "", *name ? name : "-");
  }
  eda_gates_free(g);
  return g_string_free(out, FALSE);
}

static void test_flavours(void) {
  static const struct {
    const char *pairs[6], *want;
  } cases[] = {
      {{NULL}, "- - - -"},
      {{"a", "M"}, "- a a -"},
      {{"a", "  M  N "}, "- - a -"},
      {{"a", "M + N"}, "- a a a"},
      {{"a", "M", "b", "N", "c", "N M"}, "- a c b"},
      {{"c", "N M", "a", "M", "b", "N"}, "- a c b"},
      {{"c", "N & M", "a", "M", "b", "N"}, "- a c b"},
      {{"a", "M", "b", "EMPTY"}, "- a a -"},
      {{"a", "M", "b", "N"},
       ": transistor from (4300, 0) to (4450, 600) nm, cell 'TOP': the "
       "transistor is marked as 'a' and as 'b': define a flavour of both "
       "markers, 'NAME: A B'"},
      {{"a", "M", "b", "M N", "c", "N M"},
       ": transistor from (4300, 0) to (4450, 600) nm, cell 'TOP': the "
       "transistor is marked as 'b' and as 'c': define a flavour of both "
       "markers, 'NAME: A B'"},
      {{"x", "PART"},
       ": transistor from (300, 0) to (450, 600) nm, cell 'TOP': a marker of "
       "'x' covers the transistor in part"},
      {{"a", "M", "x", "NONE"}, "flavours.x: the layout has no layer 'NONE'*"},
      {{"a", "M", "x", "  "},
       "flavours.x: 'x' must name the marker layer of the transistors, or "
       "several marker layers separated by blanks"},
      {{"", "M"}, "flavours.: '' must name the marker layer*"}};
  opc_error e;
  eda_layout *layout = row_new();
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    size_t n = 0;
    while (n < 6 && cases[k].pairs[n]) n++;
    g_autofree char *is = row_flavours(layout, cases[k].pairs, n / 2);
    if (!g_pattern_match_simple(cases[k].want, is)) g_error("%zu: %s", k, is);
  }
  const char *many[66];
  for (int i = 0; i < 66; i++) many[i] = "M";
  g_autofree char *is = row_flavours(layout, many, 33);
  g_assert_cmpstr(is, ==, "flavours: 33 flavours, expected at most 32");
  eda_segment_settings most = {
      .grid = 1, .flavours = many, .flavour_count = 32};
  g_assert_cmpint(eda_segment_check(&most, &e), ==, OPC_OK);
  eda_layout_free(layout);
}

/* Names and layers of further layers, missing and empty layers. */
static void test_further(void) {
  static const struct {
    const char *pairs[4], *want;
  } cases[] = {
      {{"m1", "M", "x_9", "N"}, NULL},
      {{"drawn", "M", "_drawn_", "N"}, NULL},
      {{"m1", "M", "m1_drawn", "N"},
       "also.m1_drawn: 'm1_drawn' cannot be the name of a layer: expected "
       "letters, digits and '_', not ending in '_drawn'"},
      {{"m.1", "M"}, "also.m.1: 'm.1' cannot be the name of a layer*"},
      {{"", "M"}, "also.: '' cannot be the name of a layer*"},
      {{"active", "M"},
       "also.active: 'active': a layer of this name exists already"},
      {{"m1", "M", "m1", "N"},
       "also.m1: 'm1': a layer of this name exists already"},
      {{"m1", "M", "m2", "M"}, "also.m2: 'm2': layer M is 'm1' already"},
      {{"m1", "poly"}, "also.m1: 'm1': layer poly is 'poly' already"},
      {{"m1", "M", "m2", "Z"}, "also.m2: the layout has no layer 'Z'*"},
      {{"m1", "EMPTY"}, "also.m1: layer 'EMPTY' is empty"}};
  eda_layout *layout = row_new();
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    opc_error error;
    eda_gates *g = NULL;
    eda_segment_report report;
    eda_segment_settings s = {.grid = 1, .also = cases[k].pairs};
    while (s.also_count < 2 && cases[k].pairs[2 * s.also_count]) s.also_count++;
    int code = eda_segment_check(&s, &error);
    if (!code) code = eda_segment(NULL, layout, 0, &s, &g, &report, &error);
    g_autofree char *is =
        g_strdup_printf("%s: %s", error.parameter, error.message);
    if (!cases[k].want
            ? code != OPC_OK
            : code != OPC_INVALID || !g_pattern_match_simple(cases[k].want, is))
      g_error("%zu: %s", k, is);
    /* Without contacts, further layers follow poly and active. */
    g_assert_cmpuint(g ? g->layers : 4, ==, 4);
    if (g) g_assert_cmpstr(g->layer[3], ==, cases[k].pairs[2]);
    eda_gates_free(g);
  }
  eda_layout_free(layout);
}

static void count_messages(void *data, int warning, const char *message) {
  (void)warning;
  g_string_append_printf(data, "%s;", message);
}

/* Layouts without transistors, and the message about displaced vertices. */
static void test_messages(void) {
  opc_error error;
  eda_gates *g;
  eda_segment_report report;
  g_autoptr(GString) log = g_string_new(NULL);
  eda_segment_settings s = {.grid = 1, .log = count_messages, .data = log};
  eda_layout *layout = eda_layout_new(0.25, &error);
  int32_t top = eda_layout_cell(layout, "TOP", &error);
  box(layout, top, "active", 0, 0, 4000, 800);
  g_assert_cmpint(eda_segment(NULL, layout, top, &s, &g, &report, &error), ==,
                  OPC_INVALID);
  g_assert_cmpstr(error.message, ==,
                  "no transistors: the layout has no layer 'poly', but active; "
                  "name the layer in 'layers' of the reader");
  box(layout, top, "poly", 800, 2000, 1042, 4000);
  g_assert_cmpint(eda_segment(NULL, layout, top, &s, &g, &report, &error), ==,
                  OPC_INVALID);
  g_assert_cmpstr(error.message, ==,
                  "no transistors: layers 'poly' and 'active' do not overlap");
  g_assert_cmpstr(log->str, ==,
                  "the grid of 1 nm moved 2 of 4 vertices of layer 'poly', by "
                  "0.5 nm at most;");
  g_assert_cmpuint(report.moved, ==, 2);
  g_assert_cmpfloat(report.worst, ==, 0.5);
  /* Each flat layer is counted twice: for its merged shapes too. */
  g_assert_cmpfloat(eda_segment_bytes(layout, top, &s), ==,
                    2 * (eda_layout_flat_bytes(layout, top, 0) +
                         eda_layout_flat_bytes(layout, top, 1)));
  eda_layout_free(layout);
}

/* A layer without transistors: two overlapping boxes merge into one polygon of
   eight edges, on a grid of 2 nm. */
static void test_edges(void) {
  opc_error error;
  eda_gates *g;
  size_t moved;
  eda_layout *layout = eda_layout_new(1, &error);
  int32_t top = eda_layout_cell(layout, "A", &error),
          empty = eda_layout_layer(layout, "none", &error);
  eda_layout_cell(layout, "B", &error);
  box(layout, top, "m", 0, 0, 100, 21);
  box(layout, top, "m", 40, 10, 60, 80);
  g_assert_cmpint(eda_segment_top(layout, "B", &error), ==, 1);
  g_assert_cmpint(eda_segment_top(layout, "C", &error), ==, -1);
  g_assert_cmpstr(error.message, ==, "the layout has no cell 'C'");
  g_assert_cmpstr(error.parameter, ==, "top");
  g_assert_cmpint(eda_segment_top(layout, NULL, &error), ==, -1);
  if (eda_segment_edges(layout, top, empty + 1, 2, &g, &moved, &error))
    g_error("%s", error.message);
  static const eda_point want[] = {{0, 0},   {50, 0},  {50, 11}, {30, 11},
                                   {30, 40}, {20, 40}, {20, 11}, {0, 11}};
  g_assert_cmpstr(g->name, ==, "A");
  g_assert_cmpfloat(g->grid, ==, 2);
  g_assert_cmpuint(moved, ==, 2);
  g_assert_cmpuint(g->layers, ==, 1);
  g_assert_cmpstr(g->layer[0], ==, "m");
  g_assert_cmpint(g->corrected[0], ==, 1);
  g_assert_cmpuint(g->count, ==, 0);
  g_assert_true(g->extent.x0 == 0 && g->extent.y0 == 0 && g->extent.x1 == 50 &&
                g->extent.y1 == 40);
  g_assert_cmpuint(g->edges[0].polygons, ==, 1);
  g_assert_cmpuint(g->edges[0].start[1], ==, G_N_ELEMENTS(want));
  for (size_t i = 0; i < G_N_ELEMENTS(want); i++) {
    const eda_fragment *f = &g->edges[0].fragments[i];
    g_assert_true(f->from.x == want[i].x && f->from.y == want[i].y);
    g_assert_true(f->gate == -1 && f->role == EDA_FIXED);
  }
  eda_gates_free(g);
  g_assert_cmpint(eda_segment_edges(layout, top, empty, 2, &g, &moved, &error),
                  ==, OPC_INVALID);
  g_assert_cmpstr(error.message, ==, "layer 'none' is empty");
  g_assert_null(g);
  eda_layout_free(layout);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/segment/windows", test_windows);
  g_test_add_func("/segment/cut", test_cut);
  g_test_add_func("/segment/flavours", test_flavours);
  g_test_add_func("/segment/further", test_further);
  g_test_add_func("/segment/messages", test_messages);
  g_test_add_func("/segment/edges", test_edges);
  return g_test_run();
}
