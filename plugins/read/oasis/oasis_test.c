/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of files made byte by byte with known layouts, of files of other
   programs, and of rejected files with the places of their errors. */
#include <math.h>
#include <stdlib.h>

#include "making_test.h"

/* ---- comparing ---- */

/* Return the points of all polygons and texts of TOP as text. */
static char *layout_dump(const eda_layout *layout) {
  GString *s = g_string_new(NULL);
  int32_t top = eda_layout_find_cell(layout, "TOP"), layer;
  for (size_t i = 0; i < eda_layout_polygons(layout, top); i++) {
    size_t n;
    const eda_point *p = eda_layout_polygon(layout, top, i, &n, &layer);
    g_string_append(s, eda_layout_layer_name(layout, layer));
    for (size_t k = 0; k < n; k++)
      g_string_append_printf(s, " %d,%d", p[k].x, p[k].y);
    g_string_append(s, "\n");
  }
  for (size_t i = 0; i < eda_layout_texts(layout, top); i++) {
    eda_point at;
    const char *text = eda_layout_text(layout, top, i, &at, &layer);
    g_string_append_printf(s, "%s %d,%d '%s'\n",
                           eda_layout_layer_name(layout, layer), at.x, at.y,
                           text);
  }
  return g_string_free(s, FALSE);
}

static void assert_dump(GByteArray *f, const char *want) {
  eda_layout *layout = read_made(file_finish(f));
  g_autofree char *got = layout_dump(layout);
  g_assert_cmpstr(got, ==, want);
  eda_layout_free(layout);
}

/* ---- numbers ---- */

/* Test magnifications of every type of real. */
static void test_reals(void) {
  static const uint8_t half[] = {6, 0, 0, 0, 0x3f};
  static const uint8_t quarter[] = {7, 0, 0, 0, 0, 0, 0, 0xd0, 0x3f};
  const struct {
    const uint8_t *bytes;
    size_t n;
    double value;
  } cases[] = {
      {(const uint8_t[]){0, 3}, 2, 3},
      {(const uint8_t[]){2, 8}, 2, 0.125},
      {(const uint8_t[]){4, 3, 4}, 3, 0.75},
      {half, sizeof half, 0.5},
      {quarter, sizeof quarter, 0.25},
      {(const uint8_t[]){1, 3}, 2, -1},
      {(const uint8_t[]){3, 3}, 2, -1},
      {(const uint8_t[]){5, 3, 4}, 3, -1},
      {(const uint8_t[]){0, 0}, 2, -1},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    GByteArray *f = new_cell();
    values_put(f, "bbt", EDA_OASIS_PLACEMENT_REAL, 0x80 | 4 | 2, "A");
    g_byte_array_append(f, cases[i].bytes, (guint)cases[i].n);
    values_put(f, "bbbb", 5, 45, 2, EDA_OASIS_PAD); /* an angle of -45 / 2 */
    char *path = file_finish(f);
    if (cases[i].value < 0) {
      assert_refused(path, OPC_IO, "impossible magnification at byte 27");
      continue;
    }
    eda_layout *layout = read_made(path);
    eda_placement p;
    int32_t child;
    eda_layout_instance(layout, eda_layout_find_cell(layout, "TOP"), 0, &child,
                        &p);
    g_assert_cmpfloat(p.magnification, ==, cases[i].value);
    g_assert_cmpfloat(p.angle, ==, -22.5);
    eda_layout_free(layout);
  }
}

static void test_bounds(void) {
  GByteArray *f = new_cell();
  values_put(f, "bbuuuu", EDA_OASIS_RECTANGLE, 0x63, 1ul, 0ul, 0xfffffffful,
             0xfffffffful);
  assert_refused(file_finish(f), OPC_IO,
                 "a coordinate beyond 32 bits at byte 27");
  f = new_cell();
  values_put(f, "bbuuuuss", EDA_OASIS_RECTANGLE, 0x7b, 4294967295ul,
             4294967295ul, 0xfffffffful, 0xfffffffful, -2147483648l,
             -2147483648l);
  assert_dump(f,
              "4294967295/4294967295 -2147483648,-2147483648 "
              "2147483647,-2147483648 2147483647,2147483647 "
              "-2147483648,2147483647\n");
  f = new_cell();
  values_put(f, "bbuuuus", EDA_OASIS_RECTANGLE, 0x73, 1ul, 0ul, 1ul, 1ul,
             2147483648l);
  assert_refused(file_finish(f), OPC_IO, "a coordinate beyond 32 bits");
  f = new_cell();
  values_put(f, "bbu", EDA_OASIS_RECTANGLE, 0x63, 4294967296ul);
  assert_refused(file_finish(f), OPC_IO, "a layer beyond 32 bits");
  f = new_cell();
  values_put(f, "bbuu", EDA_OASIS_RECTANGLE, 0x63, 1ul, 0ul);
  for (int i = 0; i < 9; i++) values_put(f, "b", 0xff);
  values_put(f, "b", 2); /* the 65th bit */
  assert_refused(file_finish(f), OPC_IO, "an integer beyond 64 bits");
}

/* ---- repetitions, point lists ---- */

static void test_repetitions(void) {
  const struct {
    const char *format;
    unsigned long v[10];
    const char *places;
  } cases[] = {
      {"uuuuu", {1, 0, 1, 10, 20}, "0,0 10,0 0,20 10,20 0,40 10,40"},
      {"uuu", {2, 1, 7}, "0,0 7,0 14,0"},
      {"uuu", {3, 0, 7}, "0,0 0,7"},
      {"uuuu", {4, 1, 3, 5}, "0,0 3,0 8,0"},
      {"uuuuu", {5, 1, 10, 3, 5}, "0,0 30,0 80,0"},
      {"uuuu", {6, 1, 3, 5}, "0,0 0,3 0,8"},
      {"uuuuu", {7, 1, 10, 3, 5}, "0,0 0,30 0,80"},
      /* 5 to the north-east, then (-3, 2) */
      {"uuuuuu", {8, 0, 0, 5 << 4 | 4 << 1, 3 << 2 | 3, 4}, "0,0 5,5 -3,2 2,7"},
      {"uuu", {9, 1, 5 << 4 | 7 << 1}, "0,0 5,-5 10,-10"},
      {"uuuuu", {10, 1, 5 << 4 | 1 << 1, 3 << 2 | 1, 5}, "0,0 0,5 3,3"},
      {"uuuuuu",
       {11, 1, 10, 5 << 4 | 2 << 1, 3 << 2 | 1, 5},
       "0,0 -50,0 -20,-20"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    GByteArray *f = new_cell();
    values_put(f, "bbtuu", EDA_OASIS_TEXT, 0x47, "T", 1ul, 2ul);
    for (size_t k = 0; cases[i].format[k]; k++)
      values_put(f, "u", cases[i].v[k]);
    values_put(f, "bbsb", EDA_OASIS_TEXT, 0x14, 100l, 0); /* same place */
    GString *want = g_string_new(NULL);
    for (int again = 0; again < 2; again++) {
      g_auto(GStrv) places = g_strsplit(cases[i].places, " ", -1);
      for (char **p = places; *p; p++) {
        char *y = strchr(*p, ',');
        g_string_append_printf(want, "1/2 %d%s 'T'\n", atoi(*p) + 100 * again,
                               y);
      }
    }
    assert_dump(f, want->str);
    g_string_free(want, TRUE);
  }
  GByteArray *f = new_cell();
  values_put(f, "bbtuub", EDA_OASIS_TEXT, 0x47, "T", 1ul, 2ul, 0);
  assert_refused(file_finish(f), OPC_IO,
                 "a reference to the preceding repetition without one");
}

static void test_points(void) {
  const struct {
    unsigned long v[10];
    size_t n;
    const char *points;
  } cases[] = {
      {{0, 4, 40, 20, 20, 20}, 6, "0,0 20,0 20,10 30,10 30,20 0,20"},
      {{1, 4, 40, 20, 20, 20}, 6, "0,0 0,20 10,20 10,30 20,30 20,0"},
      {{2, 3, 5 << 2, 6 << 2 | 1, 4 << 2 | 2}, 5, "0,0 5,0 5,6 1,6"},
      {{3, 3, 5 << 3, 6 << 3 | 4, 4 << 3 | 2}, 5, "0,0 5,0 11,6 7,6"},
      {{4, 2, 5 << 4, 6 << 2 | 3, 40}, 5, "0,0 5,0 -1,20"},
      {{5, 3, 5 << 4, 6 << 2 | 3, 40, 1 << 4 | 1 << 1}, 6, "0,0 5,0 4,20 3,41"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    GByteArray *f = new_cell();
    values_put(f, "bbuu", EDA_OASIS_POLYGON, 0x23, 1ul, 2ul);
    for (size_t k = 0; k < cases[i].n; k++) values_put(f, "u", cases[i].v[k]);
    g_autofree char *want = g_strdup_printf("1/2 %s\n", cases[i].points);
    assert_dump(f, want);
  }
}

/* ---- shapes ---- */

static void test_shapes(void) {
  GByteArray *f = new_cell();
  /* A square, and a rectangle in relative coordinates with the modal layer. */
  values_put(f, "bbuuuss", EDA_OASIS_RECTANGLE, 0xdb, 1ul, 2ul, 5ul, 10l, 20l);
  values_put(f, "b", EDA_OASIS_XYRELATIVE);
  values_put(f, "bbuss", EDA_OASIS_RECTANGLE, 0x38, 7ul, 1l, 2l);
  values_put(f, "b", EDA_OASIS_XYABSOLUTE);
  values_put(f, "bbuussss", EDA_OASIS_TRAPEZOID, 0x78, 20ul, 10ul, 3l, -4l, 0l,
             0l);
  values_put(f, "bbuusss", EDA_OASIS_TRAPEZOID_A, 0xf8, 10ul, 20ul, -3l, 0l,
             0l);
  values_put(f, "bbuusss", EDA_OASIS_TRAPEZOID_B, 0x78, 10ul, 20ul, 10l, 0l,
             0l);
  values_put(f, "bbuusss", EDA_OASIS_TRAPEZOID_B, 0xf8, 10ul, 20ul, 3l, 0l, 0l);
  assert_dump(f,
              "1/2 10,20 15,20 15,25 10,25\n1/2 11,22 16,22 16,29 11,29\n"
              "1/2 0,0 20,0 16,10 3,10\n1/2 0,0 10,3 10,20 0,20\n"
              "1/2 0,0 10,20 0,20\n1/2 0,0 10,0 10,17 0,20\n");
  f = new_cell();
  values_put(f, "bbuuuuss", EDA_OASIS_TRAPEZOID, 0x63, 1ul, 2ul, 20ul, 10ul,
             15l, -16l);
  assert_refused(file_finish(f), OPC_IO, "a trapezoid whose sides cross");
  f = new_cell();
  values_put(f, "bbuuuuu", EDA_OASIS_CTRAPEZOID, 0xe3, 1ul, 2ul, 4ul, 20ul,
             11ul);
  assert_refused(file_finish(f), OPC_IO, "a trapezoid whose sides cross");
  f = new_cell();
  values_put(f, "bbuuuu", EDA_OASIS_CTRAPEZOID, 0xe3, 1ul, 2ul, 26ul, 20ul);
  assert_refused(file_finish(f), OPC_IO, "an unknown kind of trapezoid");
}

/* The path is extended by half a width at the start, and by 7 at the end. */
static void test_path(void) {
  GByteArray *f = new_cell();
  values_put(f, "bbuuuusuuuss", EDA_OASIS_PATH, 0xfb, 1ul, 2ul, 5ul,
             2ul << 2 | 3, 7l, 4ul, 1ul, 100ul << 4, 3l, 4l);
  values_put(f, "bbuu", EDA_OASIS_PATH, 0xc0, 4ul, 1ul << 2 | 1); /* the same
                                                              point list */
  eda_layout *layout = read_made(file_finish(f));
  opc_error e;
  eda_flat flat;
  g_assert_cmpint(eda_layout_flatten(layout, 0, 0, 1, &flat, &e), ==, 0);
  g_assert_cmpuint(flat.shapes.count, ==, 2);
  int32_t x0 = INT32_MAX, x1 = INT32_MIN, y0 = INT32_MAX, y1 = INT32_MIN;
  for (int k = 0; k < 4; k++) {
    x0 = MIN(x0, flat.shapes.points[k].x);
    x1 = MAX(x1, flat.shapes.points[k].x);
    y0 = MIN(y0, flat.shapes.points[4 + k].y);
    y1 = MAX(y1, flat.shapes.points[4 + k].y);
  }
  g_assert_cmpint(x0, ==, 3 - 5);
  g_assert_cmpint(x1, ==, 103 + 7);
  g_assert_cmpint(y0, ==, 0);
  g_assert_cmpint(y1, ==, 8);
  eda_flat_clear(&flat);
  eda_layout_free(layout);
}

static void test_circle(void) {
  GByteArray *f = new_cell();
  values_put(f, "bbuuuss", EDA_OASIS_CIRCLE, 0x3b, 1ul, 2ul, 100000ul, 7l, -9l);
  eda_layout *layout = read_made(file_finish(f));
  size_t n;
  int32_t layer;
  const eda_point *p = eda_layout_polygon(layout, 0, 0, &n, &layer);
  double area = 0;
  g_assert_cmpuint(n, ==, 64);
  for (size_t k = 0; k < n; k++) {
    eda_point a = p[k], b = p[(k + 1) % n];
    g_assert_cmpfloat_with_epsilon(hypot(a.x - 7, a.y + 9), 100000, 1);
    area += 0.5 * ((double)a.x * b.y - (double)b.x * a.y);
  }
  double want = 32 * sin(2 * G_PI / 64) * 1e10;
  g_assert_cmpfloat_with_epsilon(area / want, 1, 1e-5);
  eda_layout_free(layout);
}

/* Test that unknown records are skipped and update modal variables. */
static void test_extensions(void) {
  GByteArray *f = new_file();
  values_put(f, "but", EDA_OASIS_XNAME, 1ul, "?");
  values_put(f, "btuuuuu", EDA_OASIS_LAYERNAME, "POLY", 4ul, 1ul, 9ul, 3ul,
             0ul);
  values_put(f, "bt", EDA_OASIS_CELL, "TOP");
  values_put(f, "but", EDA_OASIS_XELEMENT, 1ul, "?");
  values_put(f, "bbuuutss", EDA_OASIS_XGEOMETRY, 0x1b, 1ul, 4ul, 5ul, "?", 7l,
             8l);
  values_put(f, "bbuu", EDA_OASIS_RECTANGLE, 0x60, 1ul, 2ul);
  assert_dump(f, "4/5 7,8 8,8 8,10 7,10\n");
}

/* ---- names ---- */

/* Test numbers used before their names, in every order; instance names. */
static void test_names(void) {
  for (int explicit = 0; explicit < 2; explicit ++) {
    GByteArray *f = new_file();
    values_put(f, "bu", EDA_OASIS_CELL_NUMBER, 1ul);
    values_put(f, "bbu", EDA_OASIS_PLACEMENT, 0xc0, 0ul);
    values_put(f, "bbuuuuu", EDA_OASIS_PROPERTY, 0x27, 1ul, 8ul, 5ul, 14ul,
               1ul);
    values_put(f, "bbuuuuu", EDA_OASIS_PROPERTY, 0x27, 1ul, 8ul, 61ul, 14ul,
               0ul);
    values_put(f, "bbu", EDA_OASIS_PLACEMENT, 0xc0, 0ul);
    values_put(f, "bbuuuuu", EDA_OASIS_PROPERTY, 0x27, 1ul, 8ul, 5ul, 14ul,
               1ul);
    values_put(f, "b", EDA_OASIS_PROPERTY_AGAIN);
    values_put(f, "bb", EDA_OASIS_PLACEMENT, 0);
    values_put(f, "bbuuuuu", EDA_OASIS_PROPERTY, 0x27, 0ul, 8ul, 61ul, 14ul,
               1ul);
    values_put(f, "bbuuu", EDA_OASIS_TEXT, 0x63, 1ul, 6ul, 7ul);
    const struct {
      int record;
      const char *name[2];
    } tables[] = {
        {EDA_OASIS_TEXTSTRING, {"no", "yes \xe4"}},
        {EDA_OASIS_PROPSTRING, {"XU1", "XU2"}},
        {EDA_OASIS_PROPNAME, {"other", EDA_OASIS_GDS_PROPERTY}},
        {EDA_OASIS_CELLNAME, {"LEAF", "TOP"}},
    };
    for (size_t t = 0; t < G_N_ELEMENTS(tables); t++)
      for (int k = 0; k < 2; k++) {
        int i = explicit ? !k : k;
        values_put(f, "bt", tables[t].record + explicit, tables[t].name[i]);
        if (explicit) values_put(f, "u", (unsigned long)i);
      }
    values_put(f, "bu", EDA_OASIS_CELL_NUMBER, 0ul);
    eda_layout *layout = read_made(file_finish(f));
    int32_t top = eda_layout_find_cell(layout, "TOP"), child;
    eda_placement p;
    static const char *const want[] = {"XU1", "XU2", NULL};
    g_assert_cmpuint(eda_layout_cells(layout), ==, 2);
    g_assert_cmpuint(eda_layout_instances(layout, top), ==, 3);
    for (size_t i = 0; i < 3; i++) {
      g_assert_cmpstr(eda_layout_instance(layout, top, i, &child, &p), ==,
                      want[i]);
      g_assert_cmpstr(eda_layout_cell_name(layout, child), ==, "LEAF");
    }
    g_autofree char *got = layout_dump(layout);
    g_assert_cmpstr(got, ==, "6/7 0,0 'yes \\xE4'\n");
    eda_layout_free(layout);
  }
  GByteArray *f = new_file();
  values_put(f, "bu", EDA_OASIS_CELL_NUMBER, 7ul);
  assert_refused(file_finish(f), OPC_IO,
                 "a cell whose number has no name at byte 22");
  f = new_file();
  values_put(f, "btubtu", EDA_OASIS_CELLNAME_NUMBER, "A", 1ul,
             EDA_OASIS_CELLNAME_NUMBER, "B", 1ul);
  assert_refused(file_finish(f), OPC_IO,
                 "a second name for the same number at byte 26");
  f = new_cell();
  values_put(f, "bt", EDA_OASIS_CELL, "TOP");
  assert_refused(file_finish(f), OPC_IO, "cell 'TOP' a second time at byte 27");
}

/* Test that modal variables are undefined at the start of a cell. */
static void test_modal(void) {
  GByteArray *f = new_cell();
  values_put(f, "bbuuuuss", EDA_OASIS_RECTANGLE, 0x7b, 1ul, 2ul, 3ul, 4ul, 5l,
             6l);
  values_put(f, "bt", EDA_OASIS_CELL, "OTHER");
  guint at = f->len;
  values_put(f, "bbuu", EDA_OASIS_RECTANGLE, 0x60, 3ul, 4ul);
  g_autofree char *why = g_strdup_printf("without a layer at byte %u", at);
  assert_refused(file_finish(f), OPC_IO, why);
  f = new_file();
  values_put(f, "bbuu", EDA_OASIS_RECTANGLE, 0x60, 3ul, 4ul);
  assert_refused(file_finish(f), OPC_IO, "not in a cell, at byte 22");
}

/* ---- blocks and sums ---- */

static void put_block(GByteArray *f, const GByteArray *content, long more) {
  uint8_t packed[4096];
  z_stream z = {0};
  g_assert_cmpint(deflateInit2(&z, 9, Z_DEFLATED, -15, 8, 0), ==, Z_OK);
  z.next_in = content->data;
  z.avail_in = content->len;
  z.next_out = packed;
  z.avail_out = sizeof packed;
  g_assert_cmpint(deflate(&z, Z_FINISH), ==, Z_STREAM_END);
  guint n = (guint)(sizeof packed - z.avail_out);
  deflateEnd(&z);
  values_put(f, "bbuu", EDA_OASIS_CBLOCK, 0,
             (unsigned long)((long)content->len + more), (unsigned long)n);
  g_byte_array_append(f, packed, n);
}

static void test_blocks(void) {
  static const struct {
    long more;
    const char *why;
  } cases[] = {{0, NULL},
               {1, "a compressed block is shorter than declared"},
               {-1, "of the content of the compressed block at byte 27"},
               {-4, "a compressed block is longer than declared"},
               {1l << 40, "compressed blocks are too large"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(GByteArray) content = g_byte_array_new();
    GByteArray *f = new_cell();
    values_put(content, "bbuuuuss", EDA_OASIS_RECTANGLE, 0x7b, 1ul, 2ul, 3ul,
               4ul, 5l, 6l);
    for (int k = 0; k < 100; k++) values_put(content, "b", EDA_OASIS_PAD);
    values_put(content, "bbs", EDA_OASIS_RECTANGLE, 0x10, 300l);
    put_block(f, content, cases[i].more);
    values_put(f, "bbs", EDA_OASIS_RECTANGLE, 0x10, 9l);
    if (cases[i].why)
      assert_refused(file_finish(f), OPC_IO, cases[i].why);
    else
      assert_dump(f,
                  "1/2 5,6 8,6 8,10 5,10\n1/2 300,6 303,6 303,10 300,10\n"
                  "1/2 9,6 12,6 12,10 9,10\n");
  }
}

static void test_sums(void) {
  for (int scheme = 0; scheme <= EDA_OASIS_SUM32; scheme++)
    for (uint32_t wrong = 0; wrong < 2; wrong++) {
      GByteArray *f = new_cell();
      for (int i = 0; i < 300000; i++) values_put(f, "b", EDA_OASIS_PAD);
      values_put(f, "bbuuuuss", EDA_OASIS_RECTANGLE, 0x7b, 1ul, 2ul, 3ul, 4ul,
                 5l, 6l);
      char *path = finish_sum(f, scheme, wrong);
      if (wrong && scheme)
        assert_refused(path, OPC_IO,
                       scheme == 1 ? "the CRC32 is" : "the sum is");
      else
        eda_layout_free(read_made(path));
    }
}

/* Test names of layers, the factor on the unit, and the top cell. */
static void test_parameters(void) {
  GByteArray *f = new_cell();
  opc_error e = {0};
  values_put(f, "bbuuuu", EDA_OASIS_RECTANGLE, 0x63, 9ul, 5ul, 3ul, 4ul);
  values_put(f, "bt", EDA_OASIS_CELL, "OTHER");
  g_autofree char *path = file_finish(f);
  eda_layout *layout =
      read_more(path, ", layers: { poly: '9' }, scale: 1.3, top: TOP", &e);
  g_assert_nonnull(layout);
  g_assert_cmpstr(eda_layout_layer_name(layout, 0), ==, "poly");
  g_assert_cmpfloat_with_epsilon(eda_layout_unit(layout), 1.3, 1e-15);
  g_assert_cmpuint(eda_layout_cells(layout), ==, 1);
  eda_layout_free(layout);
  g_assert_null(read_more(path, ", layers: { poly: 8/0 }", &e));
  g_assert_nonnull(strstr(e.message, "no layer 8/0 for 'poly'"));
  g_assert_null(read_more(path, ", top: NONE", &e));
  g_assert_nonnull(strstr(e.message, "cell 'NONE' does not exist"));
}

/* ---- hostile files ---- */

/* Test truncation at every byte: an error with a place in the file. */
static void test_truncated(void) {
  static const char *const files[] = {"own_crc32.oas", "klayout_t14.1.oas"};
  g_autofree char *path = g_build_filename(opc_test_folder(), "cut.oas", NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++) {
    size_t n;
    g_autofree char *bytes = corpus_file(files[i], &n);
    if (!bytes) return;
    for (size_t length = 0; length < n; length++) {
      opc_error e = {0};
      write_bytes(path, bytes, length);
      g_assert_null(read_more(path, "", &e));
      if (!strstr(e.message, " at byte ")) g_error("%s", e.message);
      g_assert_cmpint(e.code, ==, OPC_IO);
    }
  }
}

/* Test random changes; OPCFLOW_FUZZ sets a larger number of rounds. */
static void test_flipped(void) {
  static const char *const files[] = {"own_crc32.oas",    "klayout_t3.1.oas",
                                      "klayout_t5.1.oas", "klayout_t8.6.oas",
                                      "klayout_t9.1.oas", "klayout_t14.1.oas",
                                      "own_c432.oas"};
  const char *more = g_getenv("OPCFLOW_FUZZ");
  int rounds = more ? atoi(more) : 500;
  g_autofree char *path = g_build_filename(opc_test_folder(), "flip.oas", NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++) {
    size_t n;
    g_autofree char *bytes = corpus_file(files[i], &n);
    if (!bytes) return;
    GRand *rand = g_rand_new_with_seed((guint32)i);
    for (int round = 0; round < rounds; round++) {
      g_autofree char *copy = g_memdup2(bytes, n);
      int flips = g_rand_int_range(rand, 1, 6);
      for (int k = 0; k < flips;
           k++) { /* END has only padding and a checksum: not changed */
        int at = g_rand_int_range(rand, 0, (gint32)n - 250);
        copy[at] = (char)(copy[at] ^ 1 << g_rand_int_range(rand, 0, 8));
      }
      if (copy[n - 5] == EDA_OASIS_CRC32) {
        uint32_t sum = (uint32_t)crc32(0, (const Bytef *)copy, (uInt)n - 4);
        for (int k = 0; k < 4; k++)
          copy[n - 4 + (size_t)k] = (char)(sum >> 8 * k);
      }
      write_bytes(path, copy, n);
      assert_survives("read.oasis", path);
    }
    g_rand_free(rand);
  }
}

/* Test cells that place themselves and each other, and name tables that refer
   to each other. */
static void test_circles(void) {
  GByteArray *f = new_cell();
  values_put(f, "bbt", EDA_OASIS_PLACEMENT, 0x80, "TOP");
  values_put(f, "bbt", EDA_OASIS_PLACEMENT, 0x80, "OTHER");
  values_put(f, "bbuuuu", EDA_OASIS_RECTANGLE, 0x63, 1ul, 2ul, 3ul, 4ul);
  values_put(f, "bt", EDA_OASIS_CELL, "OTHER");
  values_put(f, "bbt", EDA_OASIS_PLACEMENT, 0x80, "TOP");
  eda_layout *layout = read_made(file_finish(f));
  opc_error e = {0};
  eda_flat flat;
  g_assert_cmpint(eda_layout_top(layout, &e), ==, -1);
  g_assert_nonnull(strstr(e.message, "cycle"));
  g_assert_cmpint(eda_layout_flatten(layout, 0, 0, 1, &flat, &e), !=, 0);
  eda_layout_free(layout);
  f = g_byte_array_new(); /* the offsets of all tables point to START */
  g_byte_array_append(f, (const uint8_t *)EDA_OASIS_MAGIC, 13);
  values_put(f, "btrb", EDA_OASIS_START, "1.0", 1000, 0);
  for (int i = 0; i < 6; i++) values_put(f, "bb", 1, 13);
  values_put(f, "bu", EDA_OASIS_CELL_NUMBER, 0ul);
  assert_refused(file_save(f), OPC_IO, "at byte ");
  g_byte_array_free(f, TRUE);
}

/* Test arrays of a million times a million: kept for cells, rejected for
   shapes. */
static void test_arrays(void) {
  const unsigned long million = 999998;
  GByteArray *f = new_cell();
  values_put(f, "bbtuuuuu", EDA_OASIS_PLACEMENT, 0x88, "A", 1ul, million,
             million, 20ul, 20ul);
  values_put(f, "bt", EDA_OASIS_CELL, "A");
  values_put(f, "bbuuuu", EDA_OASIS_RECTANGLE, 0x63, 1ul, 2ul, 3ul, 4ul);
  eda_layout *layout = read_made(file_finish(f));
  opc_error e = {0};
  eda_flat flat;
  eda_placement p;
  int32_t child;
  eda_layout_instance(layout, eda_layout_find_cell(layout, "TOP"), 0, &child,
                      &p);
  g_assert_true(p.columns == 1000000 && p.rows == 1000000);
  g_assert_cmpint(eda_layout_flatten(layout, 0, 0, 1, &flat, &e), !=, 0);
  eda_layout_free(layout);
  f = new_cell();
  values_put(f, "bbuuuuuuuuu", EDA_OASIS_RECTANGLE, 0x67, 1ul, 2ul, 3ul, 4ul,
             1ul, million, million, 20ul, 20ul);
  assert_refused(file_finish(f), OPC_IO,
                 "too many shapes for the length of the file");
  f = new_cell(); /* fewer members than above, but still too many */
  values_put(f, "bbuuuuuuuuu", EDA_OASIS_RECTANGLE, 0x67, 1ul, 2ul, 3ul, 4ul,
             1ul, 1030ul, 1030ul, 20ul, 20ul);
  assert_refused(file_finish(f), OPC_IO,
                 "too many shapes for the length of the file");
  f = new_cell();
  values_put(f, "bbtuuuuuuu", EDA_OASIS_TEXT, 0x47, "T", 1ul, 2ul, 1ul, million,
             million, 0ul, 0ul);
  assert_refused(file_finish(f), OPC_IO,
                 "too many shapes for the length of the file");
  f = new_cell(); /* many instances with a long name */
  g_autofree char *name = g_strnfill(100000, 'n');
  values_put(f, "bbt", EDA_OASIS_PLACEMENT, 0x80, "A");
  values_put(f, "bbtuuut", EDA_OASIS_PROPERTY, 0x24, "S_GDS_PROPERTY", 8ul,
             61ul, 10ul, name);
  for (int i = 0; i < 1000; i++)
    values_put(f, "bbb", EDA_OASIS_PLACEMENT, 0, EDA_OASIS_PROPERTY_AGAIN);
  assert_refused(file_finish(f), OPC_IO,
                 "too many shapes for the length of the file");
  f = new_cell(); /* many polygons that repeat a long point list */
  values_put(f, "bbuuuu", EDA_OASIS_POLYGON, 0x23, 1ul, 2ul, 4ul, 100000ul);
  for (int i = 0; i < 100000; i++)
    values_put(f, "u", 1ul << 4 | (i % 2 ? 2 : 0));
  for (int i = 0; i < 5000; i++) values_put(f, "bb", EDA_OASIS_POLYGON, 0);
  assert_refused(file_finish(f), OPC_IO,
                 "too many shapes for the length of the file");
  f = new_cell();
  values_put(f, "bbuuuuuu", EDA_OASIS_RECTANGLE, 0x67, 1ul, 2ul, 3ul, 4ul, 10ul,
             ~0ul);
  assert_refused(file_finish(f), OPC_IO, "a repetition of too many");
  f = new_cell();
  values_put(f, "bbuuuuuu", EDA_OASIS_RECTANGLE, 0x67, 1ul, 2ul, 3ul, 4ul, 10ul,
             1ul << 61);
  assert_refused(file_finish(f), OPC_IO, "at byte ");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/read-oasis/reals", test_reals);
  g_test_add_func("/read-oasis/bounds", test_bounds);
  g_test_add_func("/read-oasis/repetitions", test_repetitions);
  g_test_add_func("/read-oasis/points", test_points);
  g_test_add_func("/read-oasis/shapes", test_shapes);
  g_test_add_func("/read-oasis/path", test_path);
  g_test_add_func("/read-oasis/circle", test_circle);
  g_test_add_func("/read-oasis/extensions", test_extensions);
  g_test_add_func("/read-oasis/names", test_names);
  g_test_add_func("/read-oasis/modal", test_modal);
  g_test_add_func("/read-oasis/blocks", test_blocks);
  g_test_add_func("/read-oasis/sums", test_sums);
  g_test_add_func("/read-oasis/parameters", test_parameters);
  g_test_add_func("/read-oasis/truncated", test_truncated);
  g_test_add_func("/read-oasis/flipped", test_flipped);
  g_test_add_func("/read-oasis/circles", test_circles);
  g_test_add_func("/read-oasis/arrays", test_arrays);
  return g_test_run();
}
