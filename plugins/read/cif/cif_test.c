/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of written files with known layouts, and of rejected files with the
   places of their errors. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <eda/layout.h>

#include "tools/devel/testing.h"

static char *made(void) {
  return g_build_filename(opc_test_folder(), "made.cif", NULL);
}

static void write_made(const char *path, const char *text, size_t size) {
  FILE *f = fopen(path, "wb"); /* a new file: g_file_set_contents would flush
                                  the file to the disk */
  g_assert_nonnull(f);
  g_assert_cmpuint(fwrite(text, 1, size, f), ==, size);
  fclose(f);
}

static eda_layout *read_more(const char *text, gssize n, const char *more,
                             opc_error *error) {
  g_autofree char *path = made();
  write_made(path, text, n < 0 ? strlen(text) : (size_t)n);
  g_autofree char *mapping = g_strdup_printf("{ file: '%s'%s }", path, more);
  g_autoptr(opc_module) module = opc_test_module("read.cif", mapping, error);
  void *output = NULL;
  if (!module || opc_test_run(module, &output, error)) return NULL;
  return output;
}

static eda_layout *read_good(const char *text, const char *more) {
  opc_error e = {0};
  eda_layout *layout = read_more(text, -1, more, &e);
  if (!layout) g_error("%s", e.message);
  return layout;
}

/* Return a polygon of a cell as "x,y x,y ...". */
static char *points(const eda_layout *layout, const char *cell, size_t i) {
  size_t n;
  int32_t layer, number = eda_layout_find_cell(layout, cell);
  g_assert_cmpint(number, >=, 0);
  g_assert_cmpuint(i, <, eda_layout_polygons(layout, number));
  const eda_point *p = eda_layout_polygon(layout, number, i, &n, &layer);
  GString *s = g_string_new(NULL);
  for (size_t k = 0; k < n; k++)
    g_string_append_printf(s, "%s%d,%d", k ? " " : "", p[k].x, p[k].y);
  return g_string_free(s, FALSE);
}

static void assert_points(const eda_layout *layout, const char *cell, size_t i,
                          const char *want) {
  g_autofree char *got = points(layout, cell, i);
  g_assert_cmpstr(got, ==, want);
}

/* Test cells in the style of data/cells65: DS 1 / 10 makes the unit 1 nm. */
static void test_cell(void) {
  eda_layout *layout = read_good(
      "(made by hand (or not));\n"
      "DS 1 1 10;\n9 inverter;\nL CP;\n"
      "P 218 216 283 216 283 684 218 684;\nB 500 180 250 0;\n"
      "L CM; P 0 0 9 0 9 5 4 5 4 9 0 9 0 0;94 VSS 250 -7 CP; 94 A 1 2;\n"
      "DF;\nC 1;\nE\nrubbish",
      ", layers: { poly: CP }, scale: 1.5");
  opc_error e;
  g_assert_cmpfloat_with_epsilon(eda_layout_unit(layout), 1.5, 1e-15);
  g_assert_cmpuint(eda_layout_cells(layout), ==, 1);
  g_assert_cmpint(eda_layout_top(layout, &e), ==, 0);
  g_assert_cmpuint(eda_layout_layers(layout), ==, 2);
  g_assert_cmpstr(eda_layout_layer_name(layout, 0), ==, "poly");
  g_assert_cmpstr(eda_layout_layer_name(layout, 1), ==, "CM");
  assert_points(layout, "inverter", 0, "218,216 283,216 283,684 218,684");
  assert_points(layout, "inverter", 1, "0,-90 500,-90 500,90 0,90");
  assert_points(layout, "inverter", 2, "0,0 9,0 9,5 4,5 4,9 0,9");
  eda_point at;
  int32_t layer;
  g_assert_cmpuint(eda_layout_texts(layout, 0), ==, 2);
  g_assert_cmpstr(eda_layout_text(layout, 0, 0, &at, &layer), ==, "VSS");
  g_assert_true(at.x == 250 && at.y == -7 && layer == 0);
  g_assert_cmpstr(eda_layout_text(layout, 0, 1, &at, &layer), ==, "A");
  g_assert_true(at.x == 1 && at.y == 2 && layer == 1);
  eda_layout_free(layout);
}

/* Test that lower case letters, commas and comments are blanks, and that the
   layer is restored after a symbol. */
static void test_syntax(void) {
  eda_layout *layout = read_good(
      "Layer NP (the (poly) layer);;Define Start 5;Layer ND;"
      "Box length 4 width(no;)2 center 10,-20;Define Finish;\n"
      "Box 6 8 0 0;2 a b c;0x;Call 5 Translate by 1,2;\nEnd\n",
      "");
  assert_points(layout, "made", 0, "-3,-4 3,-4 3,4 -3,4");
  assert_points(layout, "5", 0, "8,-21 12,-21 12,-19 8,-19");
  g_assert_cmpfloat(eda_layout_unit(layout), ==, 10);
  g_assert_cmpint(eda_layout_find_layer(layout, "NP"), >=, 0);
  g_assert_cmpint(eda_layout_find_layer(layout, "ND"), >=, 0);
  eda_layout_free(layout);
}

/* Test the unit of the layout. Symbols in 1 / 4 and 1 / 6 centimicron require a
   unit of 1 / 12 centimicron. Half of that unit is required only for a side
   that is an odd number of units. */
static void test_unit(void) {
  eda_layout *layout = read_good(
      "DS 1 1 4;L A;B 3 2 0 0;DF;DS 2 5 6;L A;B 2 2 1 0;DF;C 1;C 2 T 1 1;E",
      "");
  g_assert_cmpfloat_with_epsilon(eda_layout_unit(layout), 10.0 / 24, 1e-15);
  assert_points(layout, "1", 0, "-9,-6 9,-6 9,6 -9,6");
  assert_points(layout, "2", 0, "0,-20 40,-20 40,20 0,20");
  int32_t child;
  eda_placement p;
  eda_layout_instance(layout, eda_layout_find_cell(layout, "made"), 1, &child,
                      &p);
  g_assert_cmpint(p.origin.x, ==, 24);
  eda_layout_free(layout);
  layout = read_good("DS 1 1 4;L A;B 2 2 0 0;DF;L A;B 1 1 0 0;C 1;E", "");
  g_assert_cmpfloat_with_epsilon(eda_layout_unit(layout), 10.0 / 4, 1e-15);
  eda_layout_free(layout);
}

/* Test calls: the points of a symbol, transformed step by step by the rules of
   the standard, are compared with the placement in the layout. */
static void test_transformations(void) {
  GRand *rand = g_rand_new_with_seed(4);
  for (int round = 0; round < 500; round++) {
    GString *s = g_string_new("DS 1;L A;P 3 1 8 2 5 9;DF;L A;B 2 2 0 0;C 1");
    int64_t p[3][2] = {{3, 1}, {8, 2}, {5, 9}};
    int steps = g_rand_int_range(rand, 0, 6);
    for (int k = 0; k < steps; k++) {
      int x = g_rand_int_range(rand, -50, 50),
          y = g_rand_int_range(rand, -9, 9);
      int kind = g_rand_int_range(rand, 0, 4),
          turn = g_rand_int_range(rand, 0, 4);
      static const int c[] = {1, 0, -1, 0}, d[] = {0, 1, 0, -1};
      if (kind == 0) g_string_append_printf(s, " T %d %d", x, y);
      if (kind == 1) g_string_append(s, " M X");
      if (kind == 2) g_string_append(s, " MY");
      if (kind == 3)
        g_string_append_printf(s, " R%d,%d", 7 * c[turn], 7 * d[turn]);
      for (int i = 0; i < 3; i++) {
        int64_t u = p[i][0], v = p[i][1];
        if (kind == 0) p[i][0] = u + x, p[i][1] = v + y;
        if (kind == 1) p[i][0] = -u;
        if (kind == 2) p[i][1] = -v;
        if (kind == 3) {
          p[i][0] = c[turn] * u - d[turn] * v;
          p[i][1] = d[turn] * u + c[turn] * v;
        }
      }
    }
    g_string_append(s, ";E");
    eda_layout *layout = read_good(s->str, "");
    opc_error e;
    eda_flat flat;
    g_assert_cmpint(eda_layout_flatten(layout, eda_layout_top(layout, &e), 0,
                                       10, &flat, &e),
                    ==, 0);
    g_assert_cmpuint(flat.shapes.count, ==, 2);
    for (int i = 0; i < 3; i++) {
      g_assert_cmpint(flat.shapes.points[4 + i].x, ==, p[i][0]);
      g_assert_cmpint(flat.shapes.points[4 + i].y, ==, p[i][1]);
    }
    eda_flat_clear(&flat);
    eda_layout_free(layout);
    g_string_free(s, TRUE);
  }
  g_rand_free(rand);
}

/* Test a call rotated to a direction that is no multiple of 45 degrees: the
   test point is rotated to that direction. */
static void test_turns(void) {
  GRand *rand = g_rand_new_with_seed(5);
  for (int round = 0; round < 200; round++) {
    int dx = g_rand_int_range(rand, -40, 41),
        dy = g_rand_int_range(rand, -40, 41);
    if (!dx && !dy) continue;
    g_autofree char *text = g_strdup_printf(
        "DS 1;L A;P 0 0 90000 20000 -500 70000;DF;L A;B 2 2 0 0;C 1 R%d %d;E",
        dx, dy);
    eda_layout *layout = read_good(text, "");
    opc_error e;
    eda_flat flat;
    g_assert_cmpint(eda_layout_flatten(layout, eda_layout_top(layout, &e), 0,
                                       10, &flat, &e),
                    ==, 0);
    double size = hypot(dx, dy), c = dx / size, d = dy / size;
    g_assert_cmpfloat_with_epsilon(flat.shapes.points[5].x,
                                   90000 * c - 20000 * d, 1);
    g_assert_cmpfloat_with_epsilon(flat.shapes.points[5].y,
                                   90000 * d + 20000 * c, 1);
    eda_flat_clear(&flat);
    eda_layout_free(layout);
  }
  g_rand_free(rand);
}

/* Test a box and a call that end at each limit of the coordinates, or one unit
   beyond. */
static void test_edges(void) {
  static const int x[] = {1, -1, 0, 0}, y[] = {0, 0, 1, -1};
  for (int side = 0; side < 4; side++)
    for (int beyond = 0; beyond < 2; beyond++)
      for (int call = 0; call < 2; call++) {
        opc_error e = {0};
        const long far = INT32_MAX - (call ? 0 : 1) + (long)beyond;
        g_autofree char *text =
            g_strdup_printf(call ? "DS 1;L A;B 2 2 0 0;DF;C 1 T %ld %ld;C 1;E"
                                 : "L A;B 2 2 %ld %ld;E",
                            far * x[side], far * y[side]);
        eda_layout *layout = read_more(text, -1, "", &e);
        g_assert_cmpint(layout == NULL, ==, beyond);
        if (beyond) g_assert_nonnull(strstr(e.message, "beyond 32 bits"));
        eda_layout_free(layout);
      }
}

static void test_shapes(void) {
  eda_layout *layout = read_good(
      "L A;B 10 4 100 0 0 1;L B;B 1414 1414 0 0 1 1;L C;W 4 0 0 20 0 20 30;"
      "L D;R 200 50 50;L E;B 5 5 0 0;E",
      "");
  /* the odd side halves the unit */
  g_assert_cmpfloat(eda_layout_unit(layout), ==, 5);
  assert_points(layout, "made", 0, "196,-10 204,-10 204,10 196,10");
  assert_points(layout, "made", 1, "0,-2000 2000,0 0,2000 -2000,0");
  assert_points(layout, "made", 2, "-4,-4 44,-4 44,64 36,64 36,4 -4,4");
  assert_points(layout, "made", 4, "-5,-5 5,-5 5,5 -5,5");
  size_t n;
  int32_t layer;
  const eda_point *p = eda_layout_polygon(layout, 0, 3, &n, &layer);
  g_assert_cmpuint(n, ==, 32);
  for (size_t i = 0; i < n; i++)
    g_assert_cmpfloat_with_epsilon(hypot(p[i].x - 100, p[i].y - 100), 200, 0.8);
  eda_layout_free(layout);
}

/* Test that a number denotes another symbol after DD, and that equal names are
   made different. */
static void test_delete(void) {
  eda_layout *layout = read_good(
      "DS 5;9 a;L A;B 2 2 0 0;DF;DS 6;9 b;C 5;DF;C 6;"
      "DD 5;DS 5;9 a;L A;B 4 4 0 0;DF;C 5;C 5 T 100 0;E",
      "");
  int32_t top = eda_layout_find_cell(layout, "made"), child;
  eda_placement p;
  g_assert_cmpuint(eda_layout_cells(layout), ==, 4);
  g_assert_cmpuint(eda_layout_instances(layout, top), ==, 3);
  eda_layout_instance(layout, top, 0, &child, &p);
  g_assert_cmpstr(eda_layout_cell_name(layout, child), ==, "b");
  eda_layout_instance(layout, child, 0, &child, &p);
  g_assert_cmpstr(eda_layout_cell_name(layout, child), ==, "a");
  assert_points(layout, "a", 0, "-1,-1 1,-1 1,1 -1,1");
  eda_layout_instance(layout, top, 1, &child, &p);
  g_assert_true(g_str_has_prefix(eda_layout_cell_name(layout, child), "a$"));
  assert_points(layout, eda_layout_cell_name(layout, child), 0,
                "-2,-2 2,-2 2,2 -2,2");
  eda_layout_free(layout);
}

/* Test the top cell: the single symbol called without transformation, or a cell
   with the name of the file. Symbols that the top cell does not use are
   dropped. */
static void test_top(void) {
  static const struct {
    const char *calls, *more, *top;
    size_t cells;
  } cases[] = {
      {"C 1;", "", "one", 1},
      {"C 2;", "", "two", 2},
      {"C 1 T 1 0;", "", "made", 2},
      {"C 1;C 1;", "", "made", 2},
      {"C 2;L A;B 2 2 0 0;", "", "made", 3},
      {"C 1;C 3;", ", top: two", "two", 2},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *text = g_strdup_printf(
        "DS 1;9 one;L A;B 2 2 0 0;DF;DS 2;9 two;C 1 T 5 5;DF;"
        "DS 3;9 three;C 1;DF;%sE",
        cases[i].calls);
    eda_layout *layout = read_good(text, cases[i].more);
    opc_error e;
    g_assert_cmpuint(eda_layout_cells(layout), ==, cases[i].cells);
    g_assert_cmpstr(eda_layout_cell_name(layout, eda_layout_top(layout, &e)),
                    ==, cases[i].top);
    eda_layout_free(layout);
  }
}

static void test_refusals(void) {
  static const struct {
    const char *text, *more, *why;
  } cases[] = {
      {"L A;\nB 2 2 0 0\nB 1 1 0 0;E", "",
       "made.cif:3:1: ';' is missing (byte 15)"},
      {"L A;\n  B 2 2 0;E", "", "made.cif:2:10: a number is missing (byte 14)"},
      {"B 2 2 0 0;E", "", ":1:1: a shape without a layer"},
      {"L A;B 2 2 0 0;", "", "ends before its E command (byte 14)"},
      {"DS 1;DS 2;E", "", ":1:6: symbol definition inside"},
      {"DF;E", "", "DF without DS"},
      {"DS 1;DF;\nDS 1;DF;E", "", ":2:1: a symbol defined twice"},
      {"DS 1;E", "", "E inside"},
      {"DS 1 1 0;DF;E", "", ":1:8: not a positive number"},
      {"C 7;E", "", ":1:1: calls a symbol that is not defined"},
      {"C 1 Q 1;E", "", "not a transformation"},
      {"C 1 R 0 0;E", "", "no direction"},
      {"(a (b);E", "", ":1:1: unterminated comment"},
      {"X;E", "", "unknown command"},
      {"L A;P 0 0 1 1;E", "", "fewer than 3"},
      {"L A;B 2 2 0 3000000000;E", "", "beyond 32 bits"},
      {"DS 1 100 1;L A;B 2 2 0 2000000000;DF;C 1;E", "", "beyond 32 bits"},
      {"DS 1 1 2147483647;DF;DS 2 1 2147483646;DF;E", "", "no common unit"},
      {"L A;B 2 2 0 0;L B;B 2 2 0 0;E", ", layers: { poly: CP }",
       "no layer CP for 'poly'; the file has A, B"},
      {"L A;B 2 2 0 0;E", ", layers: { A: B }", "name that 'layers' assigns"},
      {"L A;B 2 2 0 0;E", ", layers: { a: A, b: A }", "is 'a' already"},
      {"L A;B 2 2 0 0;E", ", top: x", "cell 'x' does not exist"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error e = {0};
    g_assert_null(read_more(cases[i].text, -1, cases[i].more, &e));
    if (!strstr(e.message, cases[i].why))
      g_error("%s: %s", cases[i].text, e.message);
  }
}

/* Test that a file of another format is reported as such, also by other
   readers, unless its signature is incomplete. */
static void test_formats(void) {
  static const struct {
    const char *text;
    size_t n;
    const char *name, *reader;
  } formats[] = {{"\0\6\0\2\2\130", 6, "GDSII", "read.gds"},
                 {"%SEMI-OASIS\r\n\1", 14, "OASIS", "read.oasis"},
                 {"BEGIN /* a clip */\n", 19, "GLP", "read.glp"}};
  static const char *const readers[] = {"read.cif", "read.gds", "read.oasis",
                                        "read.glp"};
  g_autofree char *path = made();
  for (size_t i = 0; i < G_N_ELEMENTS(formats); i++)
    for (size_t k = 0; k < G_N_ELEMENTS(readers); k++) {
      opc_error e = {0};
      void *output = NULL;
      g_autofree char *mapping = g_strdup_printf("{ file: '%s' }", path);
      write_made(path, formats[i].text, formats[i].n);
      g_autoptr(opc_module) m = opc_test_module(readers[k], mapping, &e);
      g_assert_cmpint(opc_test_run(m, &output, &e), ==, OPC_IO);
      g_autofree char *what =
          g_strdup_printf("is a file of %s, expected ", formats[i].name);
      g_autofree char *use =
          g_strdup_printf("use the reader '%s'", formats[i].reader);
      int own = !strcmp(readers[k], formats[i].reader);
      g_assert_cmpint(!strstr(e.message, what), ==, own);
      g_assert_cmpint(!strstr(e.message, use), ==, own);
    }
}

/* Return the number of polygons of layer CP in a file of one symbol; one per
   line. */
static size_t poly_lines(const char *text) {
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
  size_t n = 0;
  gboolean poly = FALSE;
  for (size_t i = 0; lines[i]; i++) {
    if (g_str_has_prefix(lines[i], "L ")) poly = !strcmp(lines[i], "L CP;");
    if (poly && (lines[i][0] == 'P' || lines[i][0] == 'B')) n++;
  }
  return n;
}

static void test_own_cells(void) {
  static const char *const cells[] = {"inverter", "nmos", "pmos", "nand2"};
  for (size_t i = 0; i < G_N_ELEMENTS(cells); i++) {
    g_autofree char *file = g_strdup_printf("%s.cif", cells[i]);
    g_autofree char *path = g_build_filename(g_getenv("OPCFLOW_SOURCE"), "data",
                                             "cells65", file, NULL);
    g_autofree char *text = NULL;
    g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
    eda_layout *layout = read_good(text, ", layers: { poly: CP, active: CA }");
    opc_error e;
    eda_flat flat;
    int32_t top = eda_layout_top(layout, &e);
    g_assert_cmpstr(eda_layout_cell_name(layout, top), ==, cells[i]);
    g_assert_cmpint(
        eda_layout_flatten(layout, top, eda_layout_find_layer(layout, "poly"),
                           1, &flat, &e),
        ==, 0);
    g_assert_cmpuint(flat.shapes.count, >, 0);
    g_assert_cmpuint(flat.shapes.count, ==, poly_lines(text));
    g_assert_cmpuint(flat.moved, ==, 0);
    eda_flat_clear(&flat);
    eda_layout_free(layout);
  }
}

/* Test symbols with equal names. The numbers that make the names different must
   not lead to names of other symbols. */
static void test_names(void) {
  enum { MANY = 30000 };
  g_autoptr(GString) text = g_string_new(NULL);
  for (int i = 1; i < 2 * MANY; i++)
    g_string_append_printf(
        text, i < MANY ? "DS %d;9 x$%d;DF;" : "DS %d;9 x;DF;", i, i + MANY);
  g_string_append_c(text, 'E');
  opc_error e;
  gint64 start = g_get_monotonic_time();
  eda_layout *layout = read_more(text->str, (gssize)text->len, "", &e);
  g_assert_cmpint(g_get_monotonic_time() - start, <, 5 * G_USEC_PER_SEC);
  g_assert_cmpuint(eda_layout_cells(layout), ==, 2 * MANY - 1);
  eda_layout_free(layout);
}

/* Test random changes of a file. Each result is a layout or an error with its
   place. OPCFLOW_FUZZ sets a larger number of rounds. */
static void test_flipped(void) {
  static const char text[] =
      "(c (d));DS 1 1 10;9 inv;L CP;P 0 0 9 0 9 9;B 5 4 1 1 0 1;W 3 0 0 7 7;"
      "R 9 1 1;DF;DS 2 3 4;C 1 T 5 5 M X R 1 2;C 1 R 0 1;94 A 1 2 CP;DF;DD 2;"
      "DS 2;C 1;DF;C 2 T 9 9;L CA;B 2 2 0 0;C 1;E";
  static const char alphabet[] = "0123456789-;() DSFCTMXYRLPBWE94\n\xff";
  const char *more = g_getenv("OPCFLOW_FUZZ");
  int rounds = more ? atoi(more) : 3000;
  size_t n = sizeof text - 1, good = 0;
  GRand *rand = g_rand_new_with_seed(5);
  for (int round = 0; round < rounds; round++) {
    char copy[sizeof text];
    memcpy(copy, text, sizeof text);
    int flips = g_rand_int_range(rand, 1, 5);
    for (int k = 0; k < flips; k++)
      copy[g_rand_int_range(rand, 0, (gint32)n)] =
          alphabet[g_rand_int_range(rand, 0, sizeof alphabet - 1)];
    size_t length =
        round % 4 ? n : (size_t)g_rand_int_range(rand, 0, (gint32)n);
    opc_error e = {0};
    eda_layout *layout = read_more(copy, (gssize)length, "", &e);
    if (!layout) {
      g_assert_cmpint(e.code, !=, 0);
      continue;
    }
    good++;
    eda_flat flat;
    int32_t top = eda_layout_top(layout, &e);
    if (top >= 0 && eda_layout_layers(layout) &&
        !eda_layout_flatten(layout, top, 0, 1, &flat, &e))
      eda_flat_clear(&flat);
    eda_layout_free(layout);
  }
  g_assert_cmpuint(good, >, 10);
  g_rand_free(rand);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/read-cif/cell", test_cell);
  g_test_add_func("/read-cif/syntax", test_syntax);
  g_test_add_func("/read-cif/unit", test_unit);
  g_test_add_func("/read-cif/transformations", test_transformations);
  g_test_add_func("/read-cif/turns", test_turns);
  g_test_add_func("/read-cif/edges", test_edges);
  g_test_add_func("/read-cif/shapes", test_shapes);
  g_test_add_func("/read-cif/delete", test_delete);
  g_test_add_func("/read-cif/top", test_top);
  g_test_add_func("/read-cif/refusals", test_refusals);
  g_test_add_func("/read-cif/formats", test_formats);
  g_test_add_func("/read-cif/own-cells", test_own_cells);
  g_test_add_func("/read-cif/names", test_names);
  g_test_add_func("/read-cif/flipped", test_flipped);
  return g_test_run();
}
