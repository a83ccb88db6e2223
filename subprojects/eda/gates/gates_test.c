/* SPDX-License-Identifier: BSD-3-Clause */
/* Gates and masks with more than two layers: creation, checks, release. */
#include <eda/check.h>
#include <eda/memory.h>
#include <eda/samples.h>
#include <glib.h>
#include <math.h>
#include <string.h>

enum { LAYERS = 4, METAL = 3 };

/* Return the sample with two more layers: contacts, which are not corrected,
   and metal. */
static eda_gates *four_layers(void) {
  static const char *const names[] = {"poly", "active", "contact", "metal1"};
  const eda_gates *from = eda_gates_sample();
  eda_gates *g = eda_gates_new(LAYERS, from->count);
  opc_error error;
  g->name = eda_gates_text(g, from->name);
  g->grid = from->grid;
  g->extent = from->extent;
  for (size_t k = 0; k < LAYERS; k++) {
    g->layer[k] = eda_gates_text(g, names[k]);
    g->corrected[k] = k != 2;
    g_assert_cmpint(
        eda_boolean(EDA_OR, &from->drawn[k % 2], NULL, &g->drawn[k], &error),
        ==, OPC_OK);
  }
  for (size_t i = 0; i < from->count; i++) {
    g->box[i] = from->box[i];
    g->type[i] = from->type[i];
    g->length[i] = from->length[i];
    g->width[i] = from->width[i];
    g->instance[i] = eda_gates_text(g, "XU1");
    g->cell[i] = eda_gates_text(g, "INV");
    g->number[i] = (uint32_t)i + 1;
  }
  return g;
}

/* The fragments of the sample follow its polygons corner by corner, and its
   gates are located in both layers. */
static void test_sample(void) {
  const eda_gates *g = eda_gates_sample();
  for (size_t k = 0; k < g->layers; k++) {
    const eda_shapes *s = &g->drawn[k];
    const eda_edges *e = &g->edges[k];
    g_assert_cmpuint(e->polygons, ==, s->count);
    for (size_t p = 0; p < s->count; p++) {
      const eda_fragment *f = e->fragments + e->start[p];
      uint32_t n = e->start[p + 1] - e->start[p], corner = s->start[p];
      for (uint32_t i = 0; i < n; i++) {
        eda_point a = f[(i + n - 1) % n].from, b = f[i].from;
        eda_point c = f[(i + 1) % n].from;
        g_assert_true((a.x == b.x) != (a.y == b.y));
        if ((a.x == b.x) == (b.x == c.x)) {
          g_assert_true(a.x == b.x ? (b.y > a.y) == (c.y > b.y)
                                   : (b.x > a.x) == (c.x > b.x));
          continue;
        }
        g_assert_cmpint(b.x, ==, s->points[corner].x);
        g_assert_cmpint(b.y, ==, s->points[corner++].y);
      }
      g_assert_cmpuint(corner, ==, s->start[p + 1]);
    }
  }
  eda_shapes both;
  opc_error error;
  g_assert_cmpint(eda_boolean(EDA_AND, &g->drawn[EDA_POLY],
                              &g->drawn[EDA_ACTIVE], &both, &error),
                  ==, OPC_OK);
  g_assert_cmpuint(both.count, ==, g->count);
  for (size_t i = 0; i < g->count; i++) {
    eda_box b = eda_bounds(both.points + both.start[i], 4), own = g->box[i];
    g_assert_cmpmem(&b, sizeof b, &own, sizeof own);
    g_assert_cmpfloat(g->length[i], ==, b.x1 - b.x0);
    g_assert_cmpfloat(g->width[i], ==, b.y1 - b.y0);
  }
  eda_shapes_clear(&both);
}

static void test_layers(void) {
  eda_gates *g = four_layers();
  opc_error error;
  g_assert_cmpint(eda_gates_check(g, &error), ==, OPC_OK);
  g_assert_cmpint(eda_gates_layer(g, "metal1"), ==, METAL);
  g_assert_cmpint(eda_gates_layer(g, "metal2"), ==, -1);
  g_assert_true(g->instance[0] == g->instance[1]); /* equal texts are shared */
  eda_gates_free(g);
  eda_gates_free(NULL);
}

static void assert_refused(eda_gates *g, const char *message) {
  opc_error error;
  g_assert_cmpint(eda_gates_check(g, &error), ==, OPC_FAILED);
  g_assert_cmpstr(error.message, ==, message);
}

static void test_unsound(void) {
  opc_error error;
  g_assert_cmpint(eda_gates_check(eda_gates_sample(), &error), ==, OPC_OK);
  eda_gates *g = four_layers();
  char *name = g->layer[METAL];
  g->layer[METAL] = NULL;
  assert_refused(g, "layer 4 has no name");
  g->layer[METAL] = g->layer[EDA_POLY];
  assert_refused(g, "two layers have the name 'poly'");
  g->layer[METAL] = name;
  eda_shapes drawn = g->drawn[METAL];
  eda_edges edges = g->edges[METAL];
  g->drawn[METAL] = (eda_shapes){.count = 1};
  assert_refused(
      g, "drawn shapes: the point ranges of the polygons are not valid");
  g->drawn[METAL] = drawn;
  g->edges[METAL] = (eda_edges){.polygons = 1};
  assert_refused(g, "edges are missing");
  g->edges[METAL] = edges;
  g->layers = 1;
  assert_refused(g, "1 layers are too few for transistors");
  g->layers = LAYERS;
  g->length[1] = 0;
  assert_refused(g, "transistor 2 is not valid");
  g->length[1] = 60;
  g->grid = 0;
  assert_refused(
      g, "the grid of the gates is 0 nm, expected a positive finite number");
  eda_gates_free(g);
}

/* A mask may have no printed images; printed images must have values. */
static void test_mask(void) {
  eda_gates *g = four_layers();
  eda_mask *m = eda_mask_new(g);
  opc_error error;
  eda_performance_init(&m->design, g->count);
  eda_performance_init(&m->before, g->count);
  eda_performance_init(&m->after, g->count);
  m->flags = eda_alloc(g->count, sizeof *m->flags);
  for (size_t k = 0; k < LAYERS; k++) {
    if (!g->corrected[k]) continue;
    g_assert_cmpint(eda_mask_check(m, &error), ==, OPC_OK);
    m->print[k] =
        (eda_field){{0, 0, 100, 100}, 4, 4, eda_alloc(16, sizeof(float))};
    m->print[k].coefficients[5] = NAN;
    g_assert_cmpint(eda_mask_check(m, &error), ==, OPC_FAILED);
    m->print[k].coefficients[5] = 0;
  }
  g_assert_cmpint(eda_mask_check(m, &error), ==, OPC_OK);
  /* The mask may be freed after its gates. */
  eda_gates_free(g);
  eda_mask_free(m);
  eda_mask_free(NULL);
}

/* Performance figures and their flags, copied and checked. */
static void test_performance(void) {
  const eda_gates *g = eda_gates_sample();
  eda_performance from, to;
  opc_error error;
  eda_performance_init(&from, g->count);
  eda_performance_init(&to, g->count);
  for (int k = 0; k < 6; k++)
    for (size_t i = 0; i < g->count; i++) (&from.ion)[k][i] = k + 1;
  from.outside[1] = 1;
  eda_performance_copy(&to, &from);
  g_assert_true(to.area[1] == 6 && to.outside[1] == 1 && to.outside[0] == 0);
  g_assert_cmpint(eda_check_performance(g, 0, NULL, &to, &error), ==, OPC_OK);
  to.outside[1] = 7;
  g_assert_cmpint(eda_check_performance(g, 0, NULL, &to, &error), ==,
                  OPC_FAILED);
  g_assert_cmpstr(error.message, ==, "outside of transistor 'sample:2' is 7");
  eda_performance_clear(&from);
  eda_performance_clear(&to);
}

/* Added shapes and moves of a third corrected layer. */
static void test_third_layer(void) {
  eda_gates *g = four_layers();
  opc_error error;
  int32_t zero[2] = {0}, far[] = {0, 1 << 21};
  int32_t *shift[LAYERS] = {[METAL] = far};
  const eda_box good = {0, 0, 5, 5}, none = {0, 0, 5, 0};
  eda_boxes assists[LAYERS] = {[METAL] = {&good, 1}};
  size_t fragments[LAYERS] = {[METAL] = 1};
  eda_moves moves = {
      .l = zero, .w = zero, .jog = zero, .shift = shift, .assists = assists};
  g_assert_cmpint(eda_check_moves(g, &moves, fragments, &error), ==, OPC_OK);
  moves.aside = far;
  g_assert_cmpint(eda_check_moves(g, &moves, fragments, &error), ==,
                  OPC_FAILED);
  g_assert_cmpstr(error.message, ==,
                  "moves the active of transistor 2 by 2097152 steps, expected "
                  "at most 1048576");
  moves.aside = zero;
  assists[METAL].box = &none;
  g_assert_cmpint(eda_check_moves(g, &moves, fragments, &error), ==,
                  OPC_FAILED);
  g_assert_cmpstr(
      error.message, ==,
      "number 1 of the assists of metal1 is not a valid box: (0, 0) to (5, 0)");
  fragments[METAL] = 2;
  g_assert_cmpint(eda_check_moves(g, &moves, fragments, &error), ==,
                  OPC_FAILED);
  g_assert_cmpstr(
      error.message, ==,
      "moves fragment 2 of metal1 by 2097152 steps, expected at most 1048576");
  eda_gates_free(g);
}

/* Errors name the plugin that caused them. */
static void test_blame(void) {
  opc_error error = {0};
  g_assert_cmpint(eda_blame(&error, OPC_OK, "litho"), ==, OPC_OK);
  opc_fail(&error, OPC_IO, "file", "lost");
  g_assert_cmpint(eda_blame(&error, OPC_IO, "litho"), ==, OPC_IO);
  g_assert_cmpstr(error.parameter, ==, "litho.file");
  g_assert_cmpstr(error.message, ==, "lost");
  error = (opc_error){0};
  g_assert_cmpint(eda_blame(&error, 77, "resist"), ==, OPC_FAILED);
  g_assert_cmpstr(error.parameter, ==, "resist");
  g_assert_cmpstr(error.message, ==, "no error message");
}

/* Sizes of sampled chips are positive and finite; messages count from 1. */
static void test_samples(void) {
  const eda_gates *g = eda_gates_sample();
  static const double bad[] = {0, -1, NAN, INFINITY};
  eda_samples *chips = eda_samples_new(g, 2);
  opc_error error = {0};
  for (size_t i = 0; i < 2 * g->count; i++) {
    const eda_performance *p = &chips->of[i / g->count];
    p->leq_ion[i % g->count] = p->weq[i % g->count] = 50;
    p->area[i % g->count] = 2500;
  }
  g_assert_cmpint(eda_samples_check(chips, &error), ==, OPC_OK);
  for (size_t k = 0; k < G_N_ELEMENTS(bad); k++) {
    chips->of[1].weq[0] = bad[k];
    g_assert_cmpint(eda_samples_check(chips, &error), ==, OPC_FAILED);
    g_assert_true(g_str_has_prefix(error.message, "transistor 1 of chip 2 "));
  }
  eda_samples_free(chips);
  eda_samples_free(NULL);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/gates/sample", test_sample);
  g_test_add_func("/gates/layers", test_layers);
  g_test_add_func("/gates/unsound", test_unsound);
  g_test_add_func("/gates/mask", test_mask);
  g_test_add_func("/gates/performance", test_performance);
  g_test_add_func("/gates/third-layer", test_third_layer);
  g_test_add_func("/gates/blame", test_blame);
  g_test_add_func("/gates/samples", test_samples);
  return g_test_run();
}
