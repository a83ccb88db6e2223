/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests layer numbers, the division of polygons, the removal of holes, and the
   content of an OASIS file. Further cases are in the tests of the readers and
   writers. */
#include <eda/file.h>
#include <eda/memory.h>
#include <eda/oasis.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static void test_numbers(void) {
  eda_layer_number n;
  int any;
  g_assert_true(eda_layer_number_read("9/3", 65535, &n, NULL));
  g_assert_cmpuint(n.layer, ==, 9);
  g_assert_cmpuint(n.datatype, ==, 3);
  g_assert_true(eda_layer_number_read("65535/0", 65535, &n, &any));
  g_assert_false(any);
  g_assert_true(eda_layer_number_read("17", 65535, &n, &any));
  g_assert_true(any);
  g_assert_cmpuint(n.layer, ==, 17);
  static const char *const bad[] = {"",     "9",       "/0",
                                    "9/",   "9/0/",    "9/0 ",
                                    "-1/0", "65536/0", "99999999999/0",
                                    "poly"};
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++)
    g_assert_false(eda_layer_number_read(bad[i], 65535, &n, NULL));
}

/* Contacts are optional; other layers keep their numbers. */
static void test_layers(void) {
  char *names[] = {"poly", "active", "contact", "metal1", "metal2"};
  static const uint32_t want[] = {9, 1, 10, 11, 12};
  eda_gates gates = {.layers = 5, .layer = names};
  for (size_t k = 0; k < 5; k++)
    g_assert_cmpuint(eda_gates_number(&gates, k), ==, want[k]);
  char *without[] = {"poly", "active", "metal1"};
  gates = (eda_gates){.layers = 3, .layer = without};
  g_assert_cmpuint(eda_gates_number(&gates, 2), ==, 11);
}

typedef struct sum {
  size_t n, most;
  int64_t area2;
} sum;

static int shape_add(void *data, const eda_point *p, size_t n,
                     opc_error *error) {
  sum *s = data;
  for (size_t i = 0; i < n; i++) {
    eda_point a = p[i], b = p[i + 1 < n ? i + 1 : 0];
    s->area2 += (int64_t)a.x * b.y - (int64_t)b.x * a.y;
  }
  s->n++;
  s->most = MAX(s->most, n);
  return s->n < 1000 ? OPC_OK : opc_fail(error, OPC_FAILED, NULL, "enough");
}

static void test_cut(void) {
  enum { TEETH = 100, N = 4 * TEETH + 2 };
  eda_point p[N];
  size_t n = 0;
  for (int i = TEETH; i-- > 0;) { /* make a comb, counter-clockwise */
    p[n++] = (eda_point){20 * i + 20, 3};
    p[n++] = (eda_point){20 * i + 20, 13};
    p[n++] = (eda_point){20 * i + 10, 13};
    p[n++] = (eda_point){20 * i + 10, 3};
  }
  p[n++] = (eda_point){0, 0};
  p[n++] = (eda_point){20 * TEETH, 0};
  p[n - 2].x = 10;
  sum s = {0};
  opc_error e;
  eda_polygon_taker take = {shape_add, &s, 40};
  g_assert_cmpint(eda_polygon_cut(p, n, &take, &e), ==, OPC_OK);
  g_assert_cmpint(s.area2, ==, 2 * (3 * (20 * TEETH - 10) + 100 * TEETH));
  g_assert_cmpuint(s.most, <=, 40);
  g_assert_cmpuint(s.n, >=, n / 40);
  take.most = 3; /* boxes cannot be divided into triangles */
  g_assert_cmpint(eda_polygon_cut(p, n, &take, &e), ==, OPC_FAILED);
  /* A part may have 4/5 of the points, also of 9 points: 7. */
  const eda_point nine[] = {{0, 4},  {2, 1},  {5, 0},  {8, 1}, {11, 4},
                            {11, 7}, {8, 11}, {4, 11}, {0, 8}};
  s = (sum){0};
  take.most = 8;
  g_assert_cmpint(eda_polygon_cut(nine, G_N_ELEMENTS(nine), &take, &e), ==,
                  OPC_OK);
  g_assert_cmpuint(s.n, ==, 2);
  g_assert_cmpuint(s.most, <=, 7);
}

/* Test an island within a ring, each with a hole, and a plain box. */
static void test_holes(void) {
  static const int sides[] = {0, 100, 10, 90, 20, 80, 30, 70, 200, 210};
  uint32_t start[6] = {0};
  eda_point p[20];
  uint8_t hole[5];
  for (uint32_t i = 0; i < 5; i++) {
    int low = sides[2 * i], high = sides[2 * i + 1];
    hole[i] = i == 1 || i == 3;
    eda_point box[4] = {{low, low}, {high, low}, {high, high}, {low, high}};
    for (uint32_t k = 0; k < 4; k++) p[4 * i + k] = box[hole[i] ? 3 - k : k];
    start[i + 1] = 4 * i + 4;
  }
  eda_shapes shapes = {5, start, p, hole};
  sum s = {0};
  opc_error e;
  const eda_polygon_taker take = {shape_add, &s, 1000};
  g_assert_cmpint(eda_polygons_without_holes(&shapes, &take, &e), ==, OPC_OK);
  g_assert_cmpint(s.area2, ==, eda_area2(&shapes));
  g_assert_cmpuint(s.n, ==, 9);
  /* A hole outside of all outlines. */
  eda_shapes lost = {1, start, p + 4, hole + 1};
  g_assert_cmpint(eda_polygons_without_holes(&lost, &take, &e), ==, OPC_FAILED);
  g_assert_nonnull(strstr(e.message, "is not inside of a polygon"));
}

/* Equal boxes become one record with a repetition; a box on another layer
   becomes another record. */
static void test_oasis(void) {
  char *bytes = NULL;
  size_t n = 0;
  FILE *file = open_memstream(&bytes, &n);
  eda_oasis *out = eda_oasis_new(file);
  for (int i = 0; i < 1000; i++) {
    eda_point box[4] = {{7 * i, 0}, {7 * i + 5, 0}, {7 * i + 5, 5}, {7 * i, 5}};
    eda_oasis_polygon(out, (eda_layer_number){9, 0}, box, 4);
  }
  const eda_point other[4] = {{1, 2}, {6, 2}, {6, 7}, {1, 7}};
  eda_oasis_polygon(out, (eda_layer_number){8, 3}, other, 4);
  eda_oasis_end_shapes(out);
  static const uint8_t want[] = {
      20, 0xdf,         9,  0,    5, 0, 0, 9,      0xe6,
      7,  7 << 4 & 127, 20, 0xdb, 8, 3, 5, 1 << 1, 2 << 1};
  g_assert_cmpuint(eda_oasis_collected(out), ==, sizeof want);
  eda_oasis_end_plain(out);
  g_assert_cmpuint(eda_oasis_place(out), ==, sizeof want);
  eda_oasis_free(out);
  fclose(file);
  g_assert_cmpmem(bytes, n, want, sizeof want);
  free(bytes);
}

/* ---- bytes of OASIS, by hand (SEMI P39) ---- */

/* Return a writer to *bytes, which oasis_end completes. */
static eda_oasis *oasis_begin(char **bytes, size_t *n, FILE **file) {
  *bytes = NULL;
  *file = open_memstream(bytes, n);
  return eda_oasis_new(*file);
}

static void oasis_end(eda_oasis *out, FILE *file) {
  eda_oasis_end_plain(out);
  eda_oasis_free(out);
  fclose(file);
}

/* The two bytes of a number from 128 to 16383. */
#define WIDE(v) ((v)&127) | 128, (v) >> 7

static void test_oasis_numbers(void) {
  static const int deltas[][2] = {{9, 0},  {0, 9},   {-9, 0},  {0, -9}, {9, 9},
                                  {-9, 9}, {-9, -9}, {9, -9},  {9, 8},  {-9, 8},
                                  {9, -8}, {0, 0},   {100, 99}};
  static const uint8_t want[] = {
      0,         5,         /* real 5 */
      1,         WIDE(128), /* real -128 */
      0,         0,         /* real 0 */
      7,         0,         0,         0,         0,    0,
      0,         0xe0,      0xbf, /* real -0.5 */
      7,         0,         0,         0x34,      0x26, 0xf5,
      0x6b,      0x0c,      0x43,                 /* real 1e15 */
      WIDE(144), WIDE(146), WIDE(148), WIDE(150), /* east, north, west ... */
      WIDE(152), WIDE(154), WIDE(156), WIDE(158), 37,   16,
      39,        16,        37,        17,        0,    WIDE(401),
      WIDE(198), 4,         'T',       'O',       'P',  '1'};
  char *bytes;
  size_t n;
  FILE *file;
  eda_oasis *out = oasis_begin(&bytes, &n, &file);
  eda_oasis_real(out, 5);
  eda_oasis_real(out, -128);
  eda_oasis_real(out, 0);
  eda_oasis_real(out, -0.5);
  eda_oasis_real(out, 1e15);
  for (size_t i = 0; i < G_N_ELEMENTS(deltas); i++)
    eda_oasis_delta(out, deltas[i][0], deltas[i][1]);
  eda_oasis_string(out, "TOP1");
  uint32_t before = eda_oasis_crc(out);
  eda_oasis_end_plain(out);
  g_assert_cmpuint(before, ==, 0);
  g_assert_cmphex(eda_oasis_crc(out), ==,
                  (uint32_t)crc32(0, want, sizeof want));
  oasis_end(out, file);
  g_assert_cmpmem(bytes, n, want, sizeof want);
  free(bytes);
}

/* A block is compressed if it becomes shorter. */
static void test_oasis_blocks(void) {
  static char same[4000], mixed[64];
  memset(same, 'a', sizeof same - 1);
  for (size_t i = 0; i + 1 < sizeof mixed; i++)
    mixed[i] = (char)(' ' + 37 * i % 91);
  const struct {
    const char *text;
    size_t bytes; /* before compression */
    int packed;
  } cases[] = {{same, 4001, 1},
               {same + sizeof same - 31, 31, 0},
               {same + sizeof same - 80, 80, 1},
               {mixed, 64, 0}};
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    char *bytes;
    size_t n;
    FILE *file;
    eda_oasis *out = oasis_begin(&bytes, &n, &file);
    eda_oasis_string(out, cases[k].text);
    g_assert_cmpuint(eda_oasis_collected(out), ==, cases[k].bytes);
    eda_oasis_end_block(out);
    g_assert_cmpuint(eda_oasis_collected(out), ==, 0);
    uint64_t place = eda_oasis_place(out);
    oasis_end(out, file);
    g_assert_cmpuint(n, ==, place);
    const uint8_t *b = (const uint8_t *)bytes;
    if (!cases[k].packed) {
      g_assert_cmpuint(n, ==, cases[k].bytes);
      g_assert_cmpmem(b + 1, n - 1, cases[k].text, n - 1);
    } else {
      uint8_t plain[5000];
      size_t at = 2, wide = cases[k].bytes > 127;
      g_assert_true(b[0] == 34 && b[1] == 0);
      g_assert_cmpuint(wide ? (size_t)(b[2] & 127) | (size_t)b[3] << 7 : b[2],
                       ==, cases[k].bytes);
      at += 1 + wide;
      g_assert_cmpuint(b[at], ==, n - at - 1);
      z_stream z = {.next_in = (uint8_t *)b + at + 1,
                    .avail_in = (uInt)(n - at - 1),
                    .next_out = plain,
                    .avail_out = sizeof plain};
      g_assert_cmpint(inflateInit2(&z, -15), ==, Z_OK);
      g_assert_cmpint(inflate(&z, Z_FINISH), ==, Z_STREAM_END);
      size_t skip = 1 + wide; /* length of the text */
      g_assert_cmpmem(plain + skip, z.total_out - skip, cases[k].text,
                      cases[k].bytes - skip);
      inflateEnd(&z);
    }
    free(bytes);
  }
}

static void put_box(eda_oasis *out, int x, int y, int w, int h) {
  const eda_point box[] = {{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}};
  eda_oasis_polygon(out, (eda_layer_number){1, 2}, box, 4);
}

/* Repetitions: a grid, a diagonal row and a list; polygons whose edges
   alternate, beginning in x or in y, and others. */
static void test_oasis_shapes(void) {
  static const eda_point flat[] = {{0, 0}, {9, 0}, {9, 3},
                                   {4, 3}, {4, 7}, {0, 7}},
                         tall[] = {{0, 0}, {0, 7}, {4, 7},
                                   {4, 3}, {9, 3}, {9, 0}},
                         kite[] = {{1, 0}, {5, 1}, {6, 6}, {1, 5}},
                         far[] = {{11, 0}, {15, 1}, {16, 6}, {11, 5}},
                         odd[] = {{0, 0}, {9, 0}, {9, 9}, {5, 9}, {0, 4}};
  static const uint8_t want[] = {
      /* 3 by 2: 4 columns, 3 rows; 5 by 4: three at steps of (6, 6); 6 by 4: a
         list; 7 by 4: a grid and one more; 8 by 4: a list */
      20, 0x7f, 1, 2, 3, 2, 0, 0, 1, 2, 1, 10, 20, 20, 0x7f, 1, 2, 5, 4, 0, 5,
      9, 1, 0x68, 20, 0x7f, 1, 2, 6, 4, 0, 0, 10, 1, 0x70, 27, 2, 20, 0x7f, 1,
      2, 7, 4, 0, 0, 1, 0, 0, 10, 5, 20, 0x7b, 1, 2, 7, 4, 2, 18, 20, 0x7f, 1,
      2, 8, 4, 0, 0, 10, 7, WIDE(160), 43, 10, WIDE(160), 39, 8, 34, 50, 66, 82,
      /* two kites; odd; tall; flat */
      21, 0x3f, 1, 2, 4, 3, 17, 2, 5, 10, 23, 3, 2, 0, 9, 0, WIDE(160), 21,
      0x3b, 1, 2, 4, 4, WIDE(144), WIDE(146), 0x44, 0x5c, 0, 0, 21, 0x3b, 1, 2,
      1, 4, 14, 8, 9, 10, 0, 0, 21, 0x3b, 1, 2, 0, 4, 18, 6, 11, 8, 0, 0};
  static const int rows[] = {23, 18, 14, 11, 9};
  char *bytes;
  size_t n;
  FILE *file;
  eda_oasis *out = oasis_begin(&bytes, &n, &file);
  for (int i = 12; i-- > 0;) put_box(out, i % 4 * 10, i / 4 * 20, 3, 2);
  for (int i = 0; i < 3; i++) put_box(out, 6 * i, 6 * i - 2, 5, 4);
  put_box(out, 1, 1, 6, 4);
  put_box(out, 0, 0, 6, 4);
  put_box(out, 7, 0, 6, 4);
  for (int k = 7; k <= 8; k++) {
    for (int i = 0; i < (k == 7 ? 1 : 5); i++)
      put_box(out, 1, k == 7 ? 9 : rows[i], k, 4);
    for (int i = 0; i < 4; i++) put_box(out, i % 2 * 10, i / 2 * 5, k, 4);
  }
  eda_oasis_polygon(out, (eda_layer_number){1, 2}, flat, 6);
  eda_oasis_polygon(out, (eda_layer_number){1, 2}, tall, 6);
  eda_oasis_polygon(out, (eda_layer_number){1, 2}, kite, 4);
  eda_oasis_polygon(out, (eda_layer_number){1, 2}, far, 4);
  eda_oasis_polygon(out, (eda_layer_number){1, 2}, odd, 5);
  eda_oasis_end_shapes(out);
  oasis_end(out, file);
  g_assert_cmpmem(bytes, n, want, sizeof want);
  free(bytes);
}

/* Test files that cannot be opened, or are on a full device. */
static void test_file(void) {
  opc_error error;
  static const struct {
    const char *path, *why;
  } faults[] = {{"/nowhere/x", "'/nowhere/x': No such file or directory"},
                {"/dev/full", "'/dev/full': No space left on device"}};
  for (size_t i = 0; i < G_N_ELEMENTS(faults); i++) {
    FILE *file = fopen(faults[i].path, "wb");
    if (file) fputs("text", file);
    g_assert_cmpint(eda_file_close(file, faults[i].path, "file", &error), ==,
                    OPC_IO);
    g_assert_cmpstr(error.message, ==, faults[i].why);
    g_assert_cmpstr(error.parameter, ==, "file");
  }
  /* The device accepts buffered text until the stream is flushed. */
  FILE *file = fopen("/dev/full", "wb");
  fputs("text", file);
  fflush(file);
  g_assert_cmpint(eda_file_close(file, "/dev/full", NULL, &error), ==, OPC_IO);
  g_assert_cmpint(
      eda_file_close(fopen("/dev/null", "wb"), "/dev/null", NULL, &error), ==,
      OPC_OK);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/formats/numbers", test_numbers);
  g_test_add_func("/formats/layers", test_layers);
  g_test_add_func("/formats/cut", test_cut);
  g_test_add_func("/formats/holes", test_holes);
  g_test_add_func("/formats/oasis", test_oasis);
  g_test_add_func("/formats/oasis-numbers", test_oasis_numbers);
  g_test_add_func("/formats/oasis-blocks", test_oasis_blocks);
  g_test_add_func("/formats/oasis-shapes", test_oasis_shapes);
  g_test_add_func("/formats/file", test_file);
  return g_test_run();
}
