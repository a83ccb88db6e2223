/* SPDX-License-Identifier: BSD-3-Clause */
/* Masks whose rectangles can be counted by hand. */
#include <math.h>
#include <string.h>

#include "core/plugin/testing.h"

/* ---- masks by hand ---- */

typedef struct drawing {
  uint32_t start[16];
  opc_point points[64];
  uint8_t hole[16];
  opc_shapes shapes;
} drawing;

static void add(drawing *d, uint8_t hole, const int32_t (*xy)[2], size_t n) {
  size_t i = d->shapes.count++;
  g_assert_cmpuint(d->start[i] + n, <=, G_N_ELEMENTS(d->points));
  for (size_t k = 0; k < n; k++)
    d->points[d->start[i] + k] = (opc_point){xy[k][0], xy[k][1]};
  d->start[i + 1] = d->start[i] + (uint32_t)n;
  d->hole[i] = hole;
  d->shapes.start = d->start;
  d->shapes.points = d->points;
  d->shapes.hole = d->hole;
}
#define ADD(d, hole, ...)                         \
  do {                                            \
    static const int32_t xy[][2] = {__VA_ARGS__}; \
    add(d, hole, xy, G_N_ELEMENTS(xy));           \
  } while (0)

static void square(drawing *d) {
  ADD(d, 0, {0, 0}, {100, 0}, {100, 100}, {0, 100});
}

static void ell(drawing *d) {
  ADD(d, 0, {200, 0}, {300, 0}, {300, 40}, {240, 40}, {240, 100}, {200, 100});
}

/* A square of side 100 with a hole of side 20. */
static void ring(drawing *d) {
  ADD(d, 0, {400, 0}, {500, 0}, {500, 100}, {400, 100});
  ADD(d, 1, {430, 30}, {430, 50}, {450, 50}, {450, 30});
}

/* A bar of 90 x 10 with three teeth of 10 x 30. Vertical cuts would give 5
   rectangles, horizontal ones give 4. */
static void comb(drawing *d) {
  ADD(d, 0, {600, 0}, {690, 0}, {690, 10}, {680, 10}, {680, 40}, {670, 40},
      {670, 10}, {650, 10}, {650, 40}, {640, 40}, {640, 10}, {620, 10},
      {620, 40}, {610, 40}, {610, 10}, {600, 10});
}

/* ---- counting ---- */

static void *no_outputs[1];

static int64_t integer(const char *column, size_t row) {
  const opc_column *c = opc_table_column(opc_test_table("cost"), column);
  g_assert_nonnull(c);
  g_assert_cmpuint(c->type, ==, OPC_INT);
  return ((const int64_t *)c->data)[row];
}

static double real(const char *column, size_t row) {
  const opc_column *c = opc_table_column(opc_test_table("cost"), column);
  g_assert_nonnull(c);
  g_assert_cmpuint(c->type, ==, OPC_REAL);
  return ((const double *)c->data)[row];
}

static void count(const drawing drawn[OPC_MASKS],
                  const drawing corrected[OPC_MASKS], double grid) {
  opc_error error;
  opc_gates gates = {.size = sizeof gates, .name = "TOP", .grid = grid};
  opc_mask mask = {.size = sizeof mask, .gates = &gates};
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    gates.drawn[layer] = drawn[layer].shapes;
    mask.shapes[layer] = corrected[layer].shapes;
  }
  g_autoptr(opc_module) m = opc_test_module("cost.fracture", "{}", &error);
  g_assert_nonnull(m);
  opc_test_forget();
  opc_test_input(m, "mask", &mask);
  g_assert_cmpint(opc_test_run(m, no_outputs, &error), ==, OPC_OK);
  const opc_table *t = opc_test_table("cost");
  g_assert_nonnull(t);
  g_assert_cmpuint(t->rows, ==, OPC_MASKS);
  g_assert_cmpuint(t->flags, ==, OPC_TABLE_PRINT);
}

/* ---- tests ---- */

static void test_shapes(void) {
  static const struct {
    void (*draw)(drawing *);
    int64_t rectangles, vertices;
    double area; /* in units of the grid */
  } cases[] = {{square, 1, 4, 10000},
               {ell, 2, 6, 4000 + 2400},
               {ring, 4, 8, 10000 - 400},
               {comb, 4, 16, 900 + 3 * 300}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    for (int layer = 0; layer < OPC_MASKS; layer++) {
      drawing drawn[OPC_MASKS] = {0}, corrected[OPC_MASKS] = {0};
      cases[i].draw(&corrected[layer]);
      count(drawn, corrected, 2);
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

/* Drawn and corrected, poly and active, each to its own place. */
static void test_places(void) {
  drawing drawn[OPC_MASKS] = {0}, corrected[OPC_MASKS] = {0};
  square(&drawn[OPC_POLY]);
  square(&corrected[OPC_POLY]);
  ell(&corrected[OPC_POLY]);
  square(&drawn[OPC_ACTIVE]);
  ring(&drawn[OPC_ACTIVE]);
  square(&corrected[OPC_ACTIVE]);
  ell(&corrected[OPC_ACTIVE]);
  ring(&corrected[OPC_ACTIVE]);
  comb(&corrected[OPC_ACTIVE]);
  count(drawn, corrected, 1);
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

/* The same mask as drawn and corrected costs the same and has the same area. */
static void test_same(void) {
  drawing mask[OPC_MASKS] = {0};
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    ring(&mask[layer]);
    comb(&mask[layer]);
  }
  count(mask, mask, 1);
  for (size_t layer = 0; layer < OPC_MASKS; layer++) {
    g_assert_cmpint(integer("rectangles", layer), ==,
                    integer("rectangles_drawn", layer));
    g_assert_cmpint(integer("vertices", layer), ==,
                    integer("vertices_drawn", layer));
    g_assert_cmpfloat(real("area", layer), ==, real("area_drawn", layer));
    g_assert_cmpfloat(real("area", layer), >, 0);
  }
}

/* A slanted edge is refused by the fracturing; its error comes through. */
static void test_slanted(void) {
  opc_error error;
  drawing d = {0};
  ADD(&d, 0, {0, 0}, {100, 0}, {50, 100});
  opc_gates gates = {.size = sizeof gates, .name = "TOP", .grid = 1};
  opc_mask mask = {.size = sizeof mask, .gates = &gates};
  mask.shapes[OPC_ACTIVE] = d.shapes;
  g_autoptr(opc_module) m = opc_test_module("cost.fracture", "{}", &error);
  g_assert_nonnull(m);
  opc_test_forget();
  opc_test_input(m, "mask", &mask);
  g_assert_cmpint(opc_test_run(m, no_outputs, &error), ==, OPC_INVALID);
  g_assert_null(opc_test_table("cost"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/fracture/shapes", test_shapes);
  g_test_add_func("/fracture/places", test_places);
  g_test_add_func("/fracture/same", test_same);
  g_test_add_func("/fracture/slanted", test_slanted);
  return g_test_run();
}
