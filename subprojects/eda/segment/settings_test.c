/* SPDX-License-Identifier: BSD-3-Clause */
/* Types and flavours of transistors, further layers, and layers without
   transistors, with the messages about invalid settings. */
#include <eda/segment.h>
#include <glib.h>
#include <string.h>

static void box(eda_layout *layout, int32_t cell, const char *layer, int32_t x0,
                int32_t y0, int32_t x1, int32_t y1) {
  opc_error e;
  int32_t l = eda_layout_layer(layout, layer, &e);
  g_assert_cmpint(
      eda_layout_add_box(layout, cell, l, (eda_box){x0, y0, x1, y1}, &e), ==,
      0);
}

/* ---- flavours and settings ---- */

enum { ROW = 4, PITCH = 2000 };

/* Return a layout with an empty cell TOP, grid 1 nm. */
static eda_layout *top_new(void) {
  opc_error e;
  eda_layout *layout = eda_layout_new(1, &e);
  eda_layout_cell(layout, "TOP", &e);
  return layout;
}

/* Draw a marker over the gates a .. b of row_new. */
static void row_mark(eda_layout *layout, const char *layer, int a, int b) {
  box(layout, 0, layer, PITCH * a - 200, -200, PITCH * b + 900, 800);
}

/* Return ROW gates of length 150 and width 600, with the markers M on gates 1
   and 2, N on 2 and 3, PART on a part of gate 0, and no shape on EMPTY. */
static eda_layout *row_new(void) {
  opc_error e;
  eda_layout *layout = top_new();
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

/* Implants decide the type of a gate, then wells. A word is a layer that covers
   the gate; "_LAYER" is elsewhere, "/LAYER" covers the gate in part. */
static void test_types(void) {
  static const struct {
    const char *layers, *want;
  } cases[] = {
      {"nwell", "p"},
      {"_nwell", "n"},
      {"pwell", "n"},
      {"_pwell", "p"},
      {"_nwell pwell", "n"},
      {"_nwell _pwell", "n"},
      {"nimplant", "n"},
      {"nimplant nwell", "n"},
      {"nimplant /nwell", "n"},
      {"pimplant", "p"},
      {"pimplant _nwell", "p"},
      {"_nimplant _pimplant nwell", "p"},
      {"/nimplant", "'nimplant' covers the transistor in part"},
      {"nimplant /pimplant", "'pimplant' covers the transistor in part"},
      {"nimplant pimplant", "both implants cover the transistor"},
      {"/nwell", "'nwell' covers the transistor in part"},
      {"nwell /pwell", "'pwell' covers the transistor in part"},
      {"nwell pwell", "both wells cover the transistor"},
      {"_nimplant",
       "the type is unknown: no layer 'nwell' or 'pwell' exists, and no "
       "implant covers the transistor"}};
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    opc_error e;
    eda_gates *g;
    eda_segment_report report;
    eda_layout *layout = top_new();
    box(layout, 0, "active", 0, 0, 750, 600);
    box(layout, 0, "poly", 300, -150, 450, 750);
    g_auto(GStrv) words = g_strsplit(cases[k].layers, " ", -1);
    for (char **w = words; *w; w++)
      if (**w == '_')
        box(layout, 0, *w + 1, 2000, 0, 3000, 900);
      else if (**w == '/')
        box(layout, 0, *w + 1, 310, 0, 900, 900);
      else
        box(layout, 0, *w, -100, -100, 900, 900);
    eda_segment_settings s = {.grid = 1};
    int code = eda_segment(NULL, layout, 0, &s, &g, &report, &e);
    if (code)
      g_assert_true(g_str_has_suffix(e.message, cases[k].want));
    else
      g_assert_cmpstr(g->type[0] == EDA_PMOS ? "p" : "n", ==, cases[k].want);
    eda_gates_free(g);
    eda_layout_free(layout);
  }
}

/* Crossings of poly and active that are no transistors. Each case has boxes of
   poly and of active. */
static void test_crossings(void) {
  static const struct {
    eda_box poly[4], active[4];
    const char *fault;
  } cases[] = {
      {{{300, -150, 450, 750}},
       {{0, 0, 750, 200},
        {0, 400, 750, 600},
        {0, 0, 320, 600},
        {400, 0, 750, 600}},
       "the gate has a hole"},
      {{{300, -150, 450, 750}, {450, 100, 600, 200}},
       {{0, 0, 750, 600}},
       "the gate is not a rectangle"},
      {{{300, 0, 450, 750}},
       {{0, 0, 750, 600}},
       "an edge of poly coincides with an edge of active"},
      {{{300, 100, 450, 750}}, {{0, 0, 750, 600}}, "poly ends on active"},
      {{{300, -150, 900, 750}},
       {{0, 0, 750, 600}},
       "no two opposite sides are edges of poly"}};
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    opc_error e;
    eda_gates *g;
    eda_segment_report report;
    eda_layout *layout = top_new();
    box(layout, 0, "nwell", 5000, 0, 5100, 100);
    for (int i = 0; i < 4; i++) {
      eda_box p = cases[k].poly[i], a = cases[k].active[i];
      if (p.x1) box(layout, 0, "poly", p.x0, p.y0, p.x1, p.y1);
      if (a.x1) box(layout, 0, "active", a.x0, a.y0, a.x1, a.y1);
    }
    eda_segment_settings s = {.grid = 1};
    g_assert_cmpint(eda_segment(NULL, layout, 0, &s, &g, &report, &e), ==,
                    OPC_INVALID);
    if (!g_str_has_suffix(e.message, cases[k].fault))
      g_error("%zu: %s", k, e.message);
    g_assert_null(g);
    eda_layout_free(layout);
  }
}

static void log_message(void *data, int warning, const char *message);

/* Texts of cells and of the top cell, on gates and beside them. */
static void test_notes(void) {
  static const struct {
    const char *first, *second; /* texts on gate 0, and on gate 0 of row_new */
    const char *beside, *want;
  } cases[] = {
      {"ion=1.5", NULL, NULL, "1.5"},
      {"ion=1.5", "ion=1.5", NULL, "1.5"},
      {"ion=1.5", "ion=1.6", NULL,
       "transistor 'TOP:1' has two notes: 'ion=1.5', and at (399, 10) nm "
       "'ion=1.6'"},
      {"ion=x", NULL, NULL, "note of 'TOP:1': *"},
      {"ion=1.5", NULL, "VDD", "1.5"}};
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    opc_error e;
    eda_gates *g;
    eda_segment_report report;
    g_autoptr(GString) log = g_string_new(NULL);
    eda_layout *layout = row_new();
    int32_t notes = eda_layout_layer(layout, "notes", &e);
    eda_layout_add_text(layout, 0, notes, (eda_point){300, 0}, cases[k].first,
                        &e);
    if (cases[k].second)
      eda_layout_add_text(layout, 0, notes, (eda_point){399, 10},
                          cases[k].second, &e);
    for (int i = 0; cases[k].beside && i < 2; i++)
      eda_layout_add_text(layout, 0, notes, (eda_point){299, 7 + i},
                          cases[k].beside, &e);
    eda_segment_settings s = {.grid = 1, .log = log_message, .data = log};
    int code = eda_segment(NULL, layout, 0, &s, &g, &report, &e);
    g_autofree char *is =
        code ? g_strdup(e.message)
             : g_strdup_printf("%g", eda_gates_goal(g, 0).target[EDA_GOAL_ION]);
    if (!g_pattern_match_simple(cases[k].want, is)) g_error("%zu: %s", k, is);
    if (!code) g_assert_cmpint(eda_gates_goal(g, 1).given, ==, 0);
    g_assert_cmpstr(log->str, ==,
                    cases[k].beside
                        ? "1 texts of layer 'notes' on no transistor: 2, the "
                          "first 'VDD' at (299, 7) nm;"
                        : "");
    eda_gates_free(g);
    eda_layout_free(layout);
  }
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

static void log_message(void *data, int warning, const char *message) {
  g_string_append_printf(data, "%d %s;", warning, message);
}

/* Layouts without transistors, and the message about displaced vertices. */
static void test_messages(void) {
  opc_error error;
  eda_gates *g;
  eda_segment_report report;
  g_autoptr(GString) log = g_string_new(NULL);
  eda_segment_settings s = {.grid = 1, .log = log_message, .data = log};
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
  g_assert_cmpstr(
      log->str, ==,
      "0 the grid of 1 nm moved 2 of 4 vertices of layer 'poly', by "
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
  g_test_add_func("/settings/flavours", test_flavours);
  g_test_add_func("/settings/types", test_types);
  g_test_add_func("/settings/crossings", test_crossings);
  g_test_add_func("/settings/notes", test_notes);
  g_test_add_func("/settings/further", test_further);
  g_test_add_func("/settings/messages", test_messages);
  g_test_add_func("/settings/edges", test_edges);
  return g_test_run();
}
