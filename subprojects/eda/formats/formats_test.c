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
  g_test_add_func("/formats/file", test_file);
  return g_test_run();
}
