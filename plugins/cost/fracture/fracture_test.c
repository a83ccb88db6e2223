/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests masks with costs counted by hand, files of the writers, and the
   trapezoids of KLayout. */
#include <math.h>
#include <string.h>

#include <eda/gates.h>

#include "tools/devel/testing.h"

/* ---- masks made by hand ---- */

typedef struct drawing {
  uint32_t start[16];
  eda_point points[64];
  uint8_t hole[16];
  eda_shapes shapes;
} drawing;

static void add_shape(drawing *d, uint8_t hole, const int32_t (*xy)[2],
                      size_t n) {
  size_t i = d->shapes.count++;
  g_assert_cmpuint(d->start[i] + n, <=, G_N_ELEMENTS(d->points));
  for (size_t k = 0; k < n; k++)
    d->points[d->start[i] + k] = (eda_point){xy[k][0], xy[k][1]};
  d->start[i + 1] = d->start[i] + (uint32_t)n;
  d->hole[i] = hole;
  d->shapes.start = d->start;
  d->shapes.points = d->points;
  d->shapes.hole = d->hole;
}
#define ADD(d, hole, ...)                         \
  do {                                            \
    static const int32_t xy[][2] = {__VA_ARGS__}; \
    add_shape(d, hole, xy, G_N_ELEMENTS(xy));     \
  } while (0)

static void square(drawing *d) {
  ADD(d, 0, {0, 0}, {100, 0}, {100, 100}, {0, 100});
}

static void ell(drawing *d) {
  ADD(d, 0, {200, 0}, {300, 0}, {300, 40}, {240, 40}, {240, 100}, {200, 100});
}

/* Draw a square of side 100 with a hole of side 20. */
static void ring(drawing *d) {
  ADD(d, 0, {400, 0}, {500, 0}, {500, 100}, {400, 100});
  ADD(d, 1, {430, 30}, {430, 50}, {450, 50}, {450, 30});
}

/* Draw a bar of 90 x 10 with three teeth of 10 x 30. Vertical cuts give 5
   rectangles, horizontal cuts 4. */
static void comb(drawing *d) {
  ADD(d, 0, {600, 0}, {690, 0}, {690, 10}, {680, 10}, {680, 40}, {670, 40},
      {670, 10}, {650, 10}, {650, 40}, {640, 40}, {640, 10}, {620, 10},
      {620, 40}, {610, 40}, {610, 10}, {600, 10});
}

/* ---- counting ---- */

static void *no_outputs[1];

static int64_t integer_of(const char *table, const char *column, size_t row) {
  const opc_column *c = opc_table_column(opc_test_table(table), column);
  g_assert_nonnull(c);
  g_assert_cmpuint(c->type, ==, OPC_INT);
  return ((const int64_t *)c->data)[row];
}

static int64_t integer(const char *column, size_t row) {
  return integer_of("cost", column, row);
}

static double real(const char *column, size_t row) {
  const opc_column *c = opc_table_column(opc_test_table("cost"), column);
  g_assert_nonnull(c);
  g_assert_cmpuint(c->type, ==, OPC_REAL);
  return ((const double *)c->data)[row];
}

enum { LAYERS = 3 };

/* A mask with `layers` of poly, active and metal1. */
typedef struct hand_made {
  eda_gates gates;
  eda_mask mask;
  eda_shapes drawn[LAYERS], shapes[LAYERS];
} hand_made;

static void make_sample(hand_made *m, size_t layers, double grid,
                        eda_box extent) {
  static char *names[] = {"poly", "active", "metal1"};
  static uint8_t corrected[] = {1, 1, 1};
  *m = (hand_made){.gates = {.name = "TOP",
                             .grid = grid,
                             .extent = extent,
                             .layers = layers,
                             .layer = names,
                             .corrected = corrected,
                             .drawn = m->drawn},
                   .mask = {.gates = &m->gates, .shapes = m->shapes}};
}

/* Count the drawn layers; the last one is omitted if empty. */
static void count_as(const drawing drawn[LAYERS],
                     const drawing corrected[LAYERS], double grid,
                     eda_box extent, const char *parameters) {
  opc_error error;
  hand_made made;
  size_t layers = corrected[LAYERS - 1].shapes.count ? LAYERS : LAYERS - 1;
  make_sample(&made, layers, grid, extent);
  for (size_t layer = 0; layer < layers; layer++) {
    made.drawn[layer] = drawn[layer].shapes;
    made.shapes[layer] = corrected[layer].shapes;
  }
  g_autoptr(opc_module) m =
      opc_test_module("cost.fracture", parameters, &error);
  g_assert_nonnull(m);
  opc_test_forget();
  opc_test_input(m, "mask", &made.mask);
  g_assert_cmpint(opc_test_run(m, no_outputs, &error), ==, OPC_OK);
  const opc_table *t = opc_test_table("cost");
  g_assert_nonnull(t);
  g_assert_cmpuint(t->rows, ==, layers);
  g_assert_cmpuint(t->flags, ==, OPC_TABLE_PRINT);
}

static void assert_count(const drawing drawn[LAYERS],
                         const drawing corrected[LAYERS], double grid) {
  count_as(drawn, corrected, grid, (eda_box){0, 0, 700, 100}, "{}");
}

/* ---- tests ---- */

static void test_shapes(void) {
  static const struct {
    void (*draw)(drawing *);
    int64_t rectangles, vertices;
    double area; /* in grid units */
  } cases[] = {{square, 1, 4, 10000},
               {ell, 2, 6, 4000 + 2400},
               {ring, 4, 8, 10000 - 400},
               {comb, 4, 16, 900 + 3 * 300}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    for (int layer = 0; layer < 2; layer++) {
      drawing drawn[LAYERS] = {0}, corrected[LAYERS] = {0};
      cases[i].draw(&corrected[layer]);
      assert_count(drawn, corrected, 2);
      g_assert_cmpint(integer("rectangles", layer), ==, cases[i].rectangles);
      g_assert_cmpint(integer("vertices", layer), ==, cases[i].vertices);
      g_assert_cmpfloat(fabs(real("area", layer) - cases[i].area * 4e-6), <,
                        1e-15);
      g_assert_cmpint(integer("rectangles", 1 - layer), ==, 0);
      g_assert_cmpint(integer("rectangles_drawn", layer), ==, 0);
      g_assert_cmpint(integer("vertices_drawn", layer), ==, 0);
      g_assert_cmpfloat(real("area_drawn", layer), ==, 0);
    }
}

/* The results of drawn and corrected shapes, and of poly and active, are in
   separate rows and columns. */
static void test_places(void) {
  drawing drawn[LAYERS] = {0}, corrected[LAYERS] = {0};
  square(&drawn[EDA_POLY]);
  square(&corrected[EDA_POLY]);
  ell(&corrected[EDA_POLY]);
  square(&drawn[EDA_ACTIVE]);
  ring(&drawn[EDA_ACTIVE]);
  square(&corrected[EDA_ACTIVE]);
  ell(&corrected[EDA_ACTIVE]);
  ring(&corrected[EDA_ACTIVE]);
  comb(&corrected[EDA_ACTIVE]);
  assert_count(drawn, corrected, 1);
  const opc_column *names = opc_table_column(opc_test_table("cost"), "layer");
  g_assert_cmpstr(((const char *const *)names->data)[0], ==, "poly");
  g_assert_cmpstr(((const char *const *)names->data)[1], ==, "active");
  g_assert_cmpint(integer("rectangles_drawn", 0), ==, 1);
  g_assert_cmpint(integer("rectangles_drawn", 1), ==, 5);
  g_assert_cmpint(integer("rectangles", 0), ==, 3);
  g_assert_cmpint(integer("rectangles", 1), ==, 11);
  g_assert_cmpint(integer("vertices_drawn", 1), ==, 12);
  g_assert_cmpint(integer("vertices", 0), ==, 10);
  g_assert_cmpint(integer("vertices", 1), ==, 34);
  g_assert_cmpfloat(opc_test_metric("rectangles"), ==, 14);
  g_assert_cmpfloat(opc_test_metric("rectangles_drawn"), ==, 6);
  g_assert_cmpfloat(opc_test_metric("vertices"), ==, 44);
}

/* A third layer has a separate row and is included in the sums. */
static void test_third_layer(void) {
  drawing drawn[LAYERS] = {0}, corrected[LAYERS] = {0};
  square(&corrected[EDA_POLY]);
  ell(&corrected[EDA_ACTIVE]);
  square(&drawn[2]);
  comb(&corrected[2]);
  assert_count(drawn, corrected, 1);
  g_assert_cmpstr(opc_test_text("cost", "layer", 2), ==, "metal1");
  g_assert_cmpint(integer("rectangles", 2), ==, 4);
  g_assert_cmpint(integer("rectangles_drawn", 2), ==, 1);
  g_assert_cmpfloat(opc_test_metric("rectangles"), ==, 7);
  g_assert_cmpfloat(opc_test_metric("vertices"), ==, 4 + 6 + 16);
}

/* Equal drawn and corrected masks have equal cost and area. */
static void test_same(void) {
  drawing mask[LAYERS] = {0};
  for (int layer = 0; layer < 2; layer++) {
    ring(&mask[layer]);
    comb(&mask[layer]);
  }
  assert_count(mask, mask, 1);
  for (size_t layer = 0; layer < 2; layer++) {
    g_assert_cmpint(integer("rectangles", layer), ==,
                    integer("rectangles_drawn", layer));
    g_assert_cmpint(integer("vertices", layer), ==,
                    integer("vertices_drawn", layer));
    g_assert_cmpfloat(real("area", layer), ==, real("area_drawn", layer));
    g_assert_cmpfloat(real("area", layer), >, 0);
  }
}

/* A slanted edge is rejected by the fracturing, and the error is returned. */
static void test_slanted(void) {
  opc_error error;
  drawing d = {0};
  ADD(&d, 0, {0, 0}, {100, 0}, {50, 100});
  hand_made made;
  make_sample(&made, 2, 1, (eda_box){0});
  made.shapes[EDA_ACTIVE] = d.shapes;
  g_autoptr(opc_module) m = opc_test_module("cost.fracture", "{}", &error);
  g_assert_nonnull(m);
  opc_test_forget();
  opc_test_input(m, "mask", &made.mask);
  g_assert_cmpint(opc_test_run(m, no_outputs, &error), ==, OPC_INVALID);
  g_assert_null(opc_test_table("cost"));
}

/* ---- shots ---- */

/* The ell is divided into two rectangles, 100 x 40 and 40 x 60; the square is
   one rectangle. */
static void test_shots(void) {
  drawing none[LAYERS] = {0}, mask[LAYERS] = {0};
  square(&mask[EDA_POLY]);
  ell(&mask[EDA_ACTIVE]);
  /* On the mask plate the square is 400 nm, the ell 400 x 160 and 160 x 240, or
     160 x 400 and 240 x 160. */
  eda_box extent = {0, 0, 300, 100};
  count_as(none, mask, 1, extent, "{ max_shot: 400 nm, sliver: 160 nm }");
  g_assert_cmpint(integer("shots", EDA_POLY), ==, 1);
  g_assert_cmpint(integer("shots", EDA_ACTIVE), ==, 2);
  g_assert_cmpint(integer("slivers", EDA_ACTIVE), ==, 0);
  g_assert_cmpint(integer("shots_drawn", EDA_ACTIVE), ==, 0);
  count_as(none, mask, 1, extent, "{ max_shot: 399 nm, sliver: 161 nm }");
  g_assert_cmpint(integer("shots", EDA_POLY), ==, 4);
  g_assert_cmpint(integer("shots", EDA_ACTIVE), ==, 3);
  g_assert_cmpint(integer("slivers", EDA_ACTIVE), ==, 3);
  g_assert_cmpint(integer("slivers", EDA_POLY), ==, 0);
  g_assert_cmpfloat(opc_test_metric("shots"), ==, 7);
  g_assert_cmpfloat(opc_test_metric("slivers"), ==, 3);
  /* Shots of 133 nm result from cutting the square, not from its shape. */
  count_as(none, mask, 1, extent, "{ max_shot: 150 nm, sliver: 140 nm }");
  g_assert_cmpint(integer("shots", EDA_POLY), ==, 9);
  g_assert_cmpint(integer("slivers", EDA_POLY), ==, 9);
  count_as(none, mask, 1, extent, "{ magnification: 1, array: [30, 7] }");
  g_assert_cmpint(integer("shots", EDA_POLY), ==, 210);
  g_assert_cmpint(integer("vertices", EDA_ACTIVE), ==, 6 * 210);
}

/* ---- bytes ---- */

enum { STRIPE = 1024, SEGMENT = 32768 };

/* Count the records of the README's model in loops over segments, stripes, and
   the rectangles of each row with all copies. */
static int64_t mebes(const eda_box *boxes, size_t n, eda_box e, int columns,
                     int rows, int64_t px, int64_t py) {
  int64_t width = (int64_t)e.x1 - e.x0 + (columns - 1) * px, bytes = 2;
  int64_t height = (int64_t)e.y1 - e.y0 + (rows - 1) * py;
  for (int64_t sx = 0; sx < width; sx += SEGMENT) {
    bytes += 4;
    for (int64_t sy = 0; sy < height; sy += STRIPE) {
      bytes += 2;
      for (size_t i = 0; i < n; i++)
        for (int r = 0; r < rows; r++) {
          int64_t y0 = boxes[i].y0 - e.y0 + r * py;
          int64_t y1 = boxes[i].y1 - e.y0 + r * py;
          int whole = 0;
          if (y1 <= sy || y0 >= sy + STRIPE) continue;
          for (int c = 0; c < columns; c++) {
            int64_t x0 = boxes[i].x0 - e.x0 + c * px;
            int64_t x1 = boxes[i].x1 - e.x0 + c * px;
            if (x1 <= sx || x0 >= sx + SEGMENT) continue;
            if (x0 >= sx && x1 <= sx + SEGMENT)
              whole++;
            else
              bytes += 8;
          }
          bytes += whole > 1 ? 14 : 8 * whole;
        }
    }
  }
  return 2048 + (bytes + 2047) / 2048 * 2048;
}

static eda_box outline(int32_t x0, int32_t y0, int32_t x1, int32_t y1,
                       drawing *d) {
  const int32_t xy[][2] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  add_shape(d, 0, xy, 4);
  return (eda_box){x0, y0, x1, y1};
}

static void test_mebes(void) {
  static const struct {
    int columns, rows, space;
  } cases[] = {{1, 1, 200}, {40, 30, 0}, {7, 250, 1500}, {300, 1, 31}};
  drawing none[LAYERS] = {0};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    drawing mask[LAYERS] = {0};
    eda_box boxes[2] = {outline(-300, -900, 140, 1500, &mask[EDA_POLY]),
                        outline(200, 100, 1300, 124, &mask[EDA_POLY])};
    eda_box extent = {-310, -950, 1310, 1600};
    g_autofree char *text =
        g_strdup_printf("{ array: [%d, %d], array_space: %d nm }",
                        cases[i].columns, cases[i].rows, cases[i].space);
    count_as(none, mask, 1, extent, text);
    int64_t want = mebes(boxes, 2, extent, cases[i].columns, cases[i].rows,
                         1620 + cases[i].space, 2550 + cases[i].space);
    g_assert_cmpint(integer_of("cost_bytes", "mebes", EDA_POLY), ==, want);
    g_assert_cmpint(want % 2048, ==, 0);
  }
  /* A chip wider than a segment, with a rectangle across the border. */
  drawing mask[LAYERS] = {0};
  eda_box box = outline(0, 0, 70000, 3000, &mask[EDA_POLY]);
  count_as(none, mask, 1, box, "{}");
  g_assert_cmpint(integer_of("cost_bytes", "mebes", EDA_POLY), ==,
                  mebes(&box, 1, box, 1, 1, 1, 1));
  /* The header and one block hold about 250 rectangles. */
  g_assert_cmpint(integer_of("cost_bytes", "mebes", EDA_POLY), ==, 4096);
}

/* A case from a corrected mask: one chord serves two concave corners, and no
   better chord crosses it. Vertical or horizontal cuts alone result in 6
   rectangles. */
static void test_chord(void) {
  drawing none[LAYERS] = {0}, mask[LAYERS] = {0};
  ADD(&mask[EDA_POLY], 0, {256, 0}, {321, 0}, {321, 809}, {74, 809}, {74, 1774},
      {9, 1774}, {9, 803}, {0, 803}, {0, 718}, {9, 718}, {9, 712}, {15, 712},
      {15, 704}, {100, 704}, {100, 712}, {256, 712});
  /* With shots of one grid step, their number is the area of all rectangles. */
  count_as(none, mask, 1, (eda_box){0, 0, 321, 1774},
           "{ max_shot: 10 nm, magnification: 10 }");
  g_assert_cmpint(integer("rectangles", EDA_POLY), ==, 5);
  g_assert_cmpint(integer("shots", EDA_POLY), ==,
                  65 * 712 + 247 * 97 + 85 * 8 + 65 * 1062 + 9 * 85);
}

/* A line of 65 nm with a strip of 1 nm along a part (from a jog), and a step of
   1 nm. Shots are cut across the line, so that no shot is narrow. Files have
   the fewest rectangles, two of which are slivers. */
static void test_slivers(void) {
  drawing none[LAYERS] = {0}, mask[LAYERS] = {0};
  ADD(&mask[EDA_POLY], 0, {0, 0}, {65, 0}, {65, 400}, {66, 400}, {66, 1000},
      {0, 1000}, {0, 800}, {-1, 800}, {-1, 200}, {0, 200});
  eda_box extent = {-1, 0, 66, 1000};
  count_as(none, mask, 1, extent, "{}");
  g_assert_cmpint(integer("rectangles", EDA_POLY), ==, 3);
  g_assert_cmpint(integer("slivers", EDA_POLY), ==, 0);
  /* Four rectangles; one is 67 x 400 and needs two shots of 250 nm. */
  g_assert_cmpint(integer("shots", EDA_POLY), ==, 5);
  count_as(none, mask, 1, extent, "{ sliver: 1 nm }");
  g_assert_cmpint(integer("rectangles", EDA_POLY), ==, 3);
  /* The shape is narrower than `sliver`, but written completely. */
  count_as(none, mask, 1, extent,
           "{ sliver: 1 um, max_shot: 10 nm, magnification: 10 }");
  g_assert_cmpint(integer("shots", EDA_POLY), ==, 65 * 1000 + 600 + 600);
}

/* With shots of one grid step, their number is the area of all rectangles: no
   overlap and no gap for ragged towers of rectangles with chords in both
   directions. */
static void test_ragged(void) {
  guint32 seed = 7;
  for (int run = 0; run < 200; run++) {
    drawing none[LAYERS] = {0}, mask[LAYERS] = {0};
    enum { BARS = 12 };
    int32_t left[BARS], right[BARS], xy[4 * BARS][2];
    int64_t area = 0;
    for (int i = 0; i < BARS; i++) {
      seed = seed * 1664525u + 1013904223u;
      left[i] = -(int32_t)(seed >> 28);
      right[i] = 1 + (int32_t)(seed >> 24 & 15);
      if (i && left[i] == left[i - 1]) left[i]--;
      if (i && right[i] == right[i - 1]) right[i]++;
      area += 3 * (right[i] - left[i]);
    }
    for (int i = 0; i < BARS; i++)
      for (int k = 0; k < 2; k++) {
        int up = 2 * i + k, down = 4 * BARS - 1 - up;
        xy[up][0] = right[i], xy[down][0] = left[i];
        xy[up][1] = xy[down][1] = 3 * (i + k);
      }
    add_shape(&mask[EDA_POLY], 0, (const int32_t(*)[2])xy, 4 * BARS);
    for (int sliver = 1; sliver < 8; sliver += 2) {
      g_autofree char *text = g_strdup_printf(
          "{ max_shot: 10 nm, magnification: 10, sliver: %d nm }", 10 * sliver);
      count_as(none, mask, 1, (eda_box){-20, 0, 20, 36}, text);
      g_assert_cmpint(integer("shots", EDA_POLY), ==, area);
    }
  }
}

/* Touching copies are rejected. */
static void test_touching(void) {
  opc_error error;
  drawing d = {0};
  outline(0, 0, 100, 100, &d);
  hand_made made;
  make_sample(&made, 2, 1, (eda_box){10, 0, 90, 90});
  made.shapes[EDA_POLY] = d.shapes;
  g_autoptr(opc_module) m = opc_test_module(
      "cost.fracture", "{ array: [2, 1], array_space: 20 nm }", &error);
  g_assert_nonnull(m);
  opc_test_input(m, "mask", &made.mask);
  g_assert_cmpint(opc_test_run(m, no_outputs, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "array_space");
  static const char *const bad[] = {"[2]", "[0, 1]", "[1.5, 1]", "[1, 2, 3]",
                                    "[100001, 1]"};
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
    g_autofree char *text = g_strdup_printf("{ array: %s }", bad[i]);
    g_assert_null(opc_test_module("cost.fracture", text, &error));
  }
}

/* ---- files of the writers ---- */

static char *write_mask(const char *writer, const eda_mask *mask,
                        const char *name) {
  opc_error error = {0};
  g_autofree char *text = g_strdup_printf("{ file: %s }", name);
  g_autoptr(opc_module) m = opc_test_module(writer, text, &error);
  g_assert_nonnull(m);
  opc_test_input(m, "mask", (void *)mask);
  if (opc_test_run(m, no_outputs, &error)) g_error("%s", error.message);
  return g_build_filename(opc_test_folder(), name, NULL);
}

static int64_t file_size(const char *writer, const eda_mask *mask,
                         const char *name) {
  g_autofree char *path = write_mask(writer, mask, name), *bytes = NULL;
  gsize n = 0;
  g_assert_true(g_file_get_contents(path, &bytes, &n, NULL));
  return (int64_t)n;
}

/* Return a merged mask as from an edge-based correction: lines with edges that
   jog every few steps, some crossed by a wide line. */
static eda_shapes jagged(uint32_t seed, int bars) {
  opc_error error;
  g_autoptr(GRand) rand = g_rand_new_with_seed(seed);
  GArray *points = g_array_new(FALSE, FALSE, sizeof(eda_point));
  GArray *start = g_array_new(FALSE, TRUE, sizeof(uint32_t));
  g_array_set_size(start, 1);
  for (int i = 0; i < bars; i++) {
    int32_t x0 = 400 * (i % 30), y0 = 2000 * (i / 30);
    int pieces = g_rand_int_range(rand, 1, 12);
    for (int k = 0; k < pieces; k++) {
      eda_box b = {x0 - g_rand_int_range(rand, 0, 9), y0 + 80 * k,
                   x0 + 65 + g_rand_int_range(rand, 0, 9), y0 + 80 * k + 80};
      if (g_rand_int_range(rand, 0, 8) == 0) b.x1 = b.x0 + 500;
      eda_point p[4] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
      g_array_append_vals(points, p, 4);
      uint32_t end = points->len;
      g_array_append_val(start, end);
    }
  }
  eda_shapes in = {.count = start->len - 1,
                   .start = (uint32_t *)(void *)start->data,
                   .points = (eda_point *)(void *)points->data},
             out;
  int code = eda_boolean(EDA_OR, &in, NULL, &out, &error);
  g_assert_cmpint(code, ==, OPC_OK);
  g_array_free(points, TRUE);
  g_array_free(start, TRUE);
  return out;
}

/* Run with shots of one grid step, whose number is the area of all
   rectangles. */
static void run_on(const eda_mask *mask) {
  opc_error error = {0};
  g_autoptr(opc_module) m = opc_test_module(
      "cost.fracture", "{ max_shot: 10 nm, magnification: 10 }", &error);
  g_assert_nonnull(m);
  opc_test_forget();
  opc_test_input(m, "mask", (void *)mask);
  if (opc_test_run(m, no_outputs, &error)) g_error("%s", error.message);
}

static void check_files(const eda_shapes *shapes, int layer) {
  hand_made made;
  make_sample(&made, LAYERS, 1, (eda_box){0});
  int64_t gds = file_size("write.gds", &made.mask, "none.gds");
  int64_t oasis = file_size("write.oasis", &made.mask, "none.oas");
  made.shapes[layer] = *shapes;
  gds = file_size("write.gds", &made.mask, "some.gds") - gds;
  oasis = file_size("write.oasis", &made.mask, "some.oas") - oasis;
  run_on(&made.mask);
  size_t row = (size_t)layer, other = (row + 1) % LAYERS;
  g_assert_cmpint(integer_of("cost_bytes", "gdsii", row), ==, gds);
  g_assert_cmpint(integer_of("cost_bytes", "oasis", row), ==, oasis);
  g_assert_cmpint(integer_of("cost_bytes", "gdsii", other), ==, 0);
  g_assert_cmpint(integer_of("cost_bytes", "oasis", other), ==, 0);
  g_assert_cmpint(gds, >, 0);
}

static void test_files(void) {
  for (int layer = 0; layer < LAYERS; layer++) {
    drawing d = {0};
    square(&d);
    ring(&d);
    comb(&d);
    check_files(&d.shapes, layer);
    eda_shapes shapes = jagged(3, 2000);
    check_files(&shapes, layer);
    eda_shapes_clear(&shapes);
  }
}

/* ---- KLayout ---- */

/* Counts of the three cutting methods and the area of each. */
static const char script[] =
    "import sys, klayout.db as k\n"
    "layout = k.Layout()\n"
    "layout.read(sys.argv[1])\n"
    "cell = layout.top_cell()\n"
    "region = k.Region(cell.begin_shapes_rec(layout.layer(9, 0))).merged()\n"
    "for mode in (k.Polygon.TD_simple, k.Polygon.TD_htrapezoids,\n"
    "             k.Polygon.TD_vtrapezoids):\n"
    "  parts = region.decompose_trapezoids_to_region(mode)\n"
    "  print(parts.count(), sum(p.area() for p in parts.each()))\n";

static void test_klayout(void) {
  const char *name = "jagged.gds";
  for (uint32_t seed = 1; seed < 4; seed++) {
    hand_made made;
    make_sample(&made, 2, 1, (eda_box){0});
    made.shapes[EDA_POLY] = jagged(seed, 600);
    g_autofree char *path = write_mask("write.gds", &made.mask, name);
    char *argv[] = {"python3", "-c", (char *)script, path, NULL};
    g_autofree char *out = NULL, *err = NULL;
    int status = -1;
    if (!g_spawn_sync(NULL, argv, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL, &out,
                      &err, &status, NULL) ||
        status != 0) {
      eda_shapes_clear(&made.shapes[EDA_POLY]);
      g_test_skip("no klayout module for python3");
      return;
    }
    run_on(&made.mask);
    int64_t ours = integer("rectangles", EDA_POLY);
    g_auto(GStrv) lines = g_strsplit(out, "\n", 0);
    for (int i = 0; i < 3; i++) {
      g_auto(GStrv) words = g_strsplit(lines[i], " ", 2);
      g_assert_nonnull(words[1]);
      int64_t theirs = g_ascii_strtoll(words[0], NULL, 10);
      g_test_message("rectangles: ours %" G_GINT64_FORMAT
                     ", KLayout's %" G_GINT64_FORMAT,
                     ours, theirs);
      g_assert_cmpint(ours, <=, theirs);
      g_assert_cmpfloat(fabs((double)integer("shots", EDA_POLY) * 1e-6 -
                             real("area", EDA_POLY)),
                        <, 1e-9);
      g_assert_cmpfloat(
          fabs(g_ascii_strtod(words[1], NULL) * 1e-6 - real("area", EDA_POLY)),
          <, 1e-9);
    }
    eda_shapes_clear(&made.shapes[EDA_POLY]);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/fracture/shapes", test_shapes);
  g_test_add_func("/fracture/places", test_places);
  g_test_add_func("/fracture/third-layer", test_third_layer);
  g_test_add_func("/fracture/same", test_same);
  g_test_add_func("/fracture/slanted", test_slanted);
  g_test_add_func("/fracture/shots", test_shots);
  g_test_add_func("/fracture/chord", test_chord);
  g_test_add_func("/fracture/mebes", test_mebes);
  g_test_add_func("/fracture/slivers", test_slivers);
  g_test_add_func("/fracture/ragged", test_ragged);
  g_test_add_func("/fracture/touching", test_touching);
  g_test_add_func("/fracture/files", test_files);
  g_test_add_func("/fracture/klayout", test_klayout);
  return g_test_run();
}
