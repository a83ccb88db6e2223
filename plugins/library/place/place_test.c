/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests circuits of isolated cells: the placed mask equals the mask of the
   cell, moved and mirrored, and the figures equal the figures of the cells. */
#include <eda/print.h>
#include <math.h>

#include "tests/library.h"

typedef struct made {
  eda_layout *circuit;
  ran sheet, cells, library, gates;
  double ion; /* largest |Ion deviation| in the library, % */
} made;

/* Make a circuit and the library of the cells with these names. */
static made make_sample(const char *cells) {
  opc_error error;
  made m = {.circuit = library_circuit()};
  g_autofree char *map = g_strdup_printf("{ cells: '%s' }", cells);
  m.sheet = sheet_of(m.circuit, map);
  m.cells = layout_segment(m.sheet.out);
  if (build_library(&m.library, m.sheet.out, m.cells.out, "", &error))
    g_error("%s", error.message);
  m.ion = opc_test_metric("ion_max");
  m.gates = layout_segment(m.circuit);
  return m;
}

static void made_clear(made *m) {
  ran_clear(&m->gates);
  ran_clear(&m->library);
  ran_clear(&m->cells);
  ran_clear(&m->sheet);
  eda_layout_free(m->circuit);
}

static int place_sample(const made *m, const char *models, const char *more,
                        ran *r, opc_error *error) {
  static const char *const inputs[] = {"layout", "gates", "library", NULL};
  g_autofree char *map = library_map(models, more);
  return run_step(r, "library.place", map, inputs,
                  (void *[]){m->circuit, m->gates.out, m->library.out}, error);
}

static ran place_good(const made *m, const char *more) {
  ran r;
  opc_error error;
  if (place_sample(m, LIBRARY_MODELS(LIBRARY_NA), more, &r, &error))
    g_error("%s", error.message);
  return r;
}

/* Return the poly of the mask within 2 um of x = `at`, moved to 0 and mirrored
   back in y. */
static eda_shapes poly_at(const eda_mask *m, int32_t at, int mirror) {
  const eda_shapes *all = &m->shapes[EDA_POLY];
  opc_error error;
  for (size_t i = 0; i < all->count; i++) {
    size_t n = all->start[i + 1] - all->start[i];
    const eda_point *p = all->points + all->start[i];
    if (p->x < at - 1000 || p->x > at + 1500) continue;
    g_autofree eda_point *turned = g_new(eda_point, n);
    for (size_t k = 0; k < n; k++) {
      eda_point q = p[mirror ? n - 1 - k : k];
      turned[k] = (eda_point){q.x - at, mirror ? -q.y : q.y};
    }
    uint32_t start[] = {0, (uint32_t)n};
    eda_shapes one = {1, start, turned, NULL}, out;
    g_assert_cmpint(eda_boolean(EDA_OR, &one, NULL, &out, &error), ==, OPC_OK);
    return out;
  }
  g_error("no poly at %d", at);
}

static double difference(const eda_shapes *a, const eda_shapes *b) {
  opc_error error;
  eda_shapes both;
  g_assert_cmpint(eda_boolean(EDA_XOR, a, b, &both, &error), ==, OPC_OK);
  double area = (double)eda_area2(&both) / 2;
  eda_shapes_clear(&both);
  return area;
}

static void test_placed(void) {
  made m = make_sample("*");
  ran r = place_good(&m, "print: true");
  const eda_mask *mask = r.out;
  const eda_gates *g = m.gates.out;
  g_assert_cmpfloat(opc_test_metric("placed"), ==, 3);
  g_assert_cmpfloat(opc_test_metric("cells"), ==, 2);
  g_assert_cmpfloat(opc_test_metric("unknown"), ==, 0);
  g_assert_cmpfloat(opc_test_metric("iterations"), ==, 0);
  g_assert_cmpfloat(opc_test_metric("disturbance_max"), <, 0.05);
  eda_shapes one = poly_at(mask, 0, 0), two = poly_at(mask, 8000, 1);
  eda_shapes drawn = {
      1, (uint32_t[]){0, 4},
      (eda_point[]){{150, -120}, {220, -120}, {220, 310}, {150, 310}}, NULL};
  g_assert_cmpfloat(difference(&one, &two), ==, 0);
  g_assert_cmpfloat(difference(&one, &drawn), >, 0);
  double largest = 0;
  for (size_t i = 0; i < g->count; i++) {
    double alone = eda_deviation(mask->before.ion[i], mask->design.ion[i]);
    double there = eda_deviation(mask->after.ion[i], mask->design.ion[i]);
    g_assert_cmpfloat_with_epsilon(there, alone, 0.05);
    largest = fmax(largest, fabs(alone));
  }
  g_assert_cmpfloat_with_epsilon(largest, m.ion, 1e-6);
  /* Without a simulation, the mask is equal and the figures are those of the
     cells. */
  ran bare = place_good(&m, "print: false");
  const eda_mask *promised = bare.out;
  g_assert_cmpfloat(
      difference(&promised->shapes[EDA_POLY], &mask->shapes[EDA_POLY]), ==, 0);
  g_assert_cmpmem(promised->after.ion, g->count * sizeof(double),
                  promised->before.ion, g->count * sizeof(double));
  g_assert_true(isnan(opc_test_metric("disturbance_max")));
  ran_clear(&bare);
  eda_shapes_clear(&one);
  eda_shapes_clear(&two);
  ran_clear(&r);
  made_clear(&m);
}

/* A library lacks one of the cells: the library is refused, or the transistors
   of that cell stay as drawn. */
static void test_missing(void) {
  opc_error error;
  ran r;
  made m = make_sample("long");
  g_assert_cmpint(
      place_sample(&m, LIBRARY_MODELS(LIBRARY_NA), "print: false", &r, &error),
      ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "library");
  g_assert_nonnull(strstr(error.message,
                          "1 of 3 transistors are not in the "
                          "library"));
  g_assert_nonnull(strstr(error.message, "cell 'wide' is missing"));
  opc_test_module_free(r.module);
  ran drawn = place_good(&m, "print: false, missing: drawn");
  g_assert_cmpfloat(opc_test_metric("unknown"), ==, 1);
  g_assert_cmpfloat(opc_test_metric("placed"), ==, 2);
  eda_shapes poly = poly_at(drawn.out, 16000, 0);
  eda_shapes as_drawn = {
      1, (uint32_t[]){0, 4},
      (eda_point[]){{150, -120}, {215, -120}, {215, 560}, {150, 560}}, NULL};
  g_assert_cmpfloat(difference(&poly, &as_drawn), ==, 0);
  eda_shapes_clear(&poly);
  ran_clear(&drawn);
  made_clear(&m);
}

static void test_refused(void) {
  opc_error error;
  ran r;
  made m = make_sample("long");
  g_assert_cmpint(
      place_sample(&m, LIBRARY_MODELS("0.74"), "print: false", &r, &error), ==,
      OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "litho");
  opc_test_module_free(r.module);
  g_assert_cmpint(place_sample(&m, LIBRARY_MODELS(LIBRARY_NA),
                               "print: false, picture: a.png", &r, &error),
                  ==, OPC_INVALID);
  g_assert_null(r.module);
  g_assert_cmpint(place_sample(&m, LIBRARY_MODELS(LIBRARY_NA),
                               "print: false, top: none", &r, &error),
                  ==, OPC_INVALID);
  g_assert_cmpstr(error.message, ==, "cell 'none' does not exist");
  opc_test_module_free(r.module);
  made_clear(&m);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/library.place/placed", test_placed);
  g_test_add_func("/library.place/missing", test_missing);
  g_test_add_func("/library.place/refused", test_refused);
  return g_test_run();
}
