/* SPDX-License-Identifier: BSD-3-Clause */
/* The steps of thesis figure 3.3, followed by hand on transistors whose
   response is a formula. */
#include "core/plugin/testing.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 4 };

/* Transistors whose PDE is offset + by_l * l + by_w * w, %. */
typedef struct model {
  size_t n;
  double offset[MOST], by_l[MOST], by_w[MOST];
  uint32_t veto[MOST];       /* OPC_VETO_LONGER from this l on */
  int32_t veto_from[MOST];
  int32_t l[MOST], w[MOST];
  GString *trace;            /* of the first: "l,w " after each update */
  int updates;
} model;

static void run(opc_module *m, model *t) {
  const opc_synthesizer *s = m->plugin->operations;
  double design[MOST], ion[MOST], width[MOST];
  uint32_t flags[MOST] = {0}, vetoes[MOST];
  for (size_t i = 0; i < t->n; i++) design[i] = 1e-3, width[i] = 200;
  opc_gates gates = {.size = sizeof gates, .grid = 1, .count = t->n, .width = width};
  opc_performance drawn = {.count = t->n, .ion = design};
  opc_performance printed = {.count = t->n, .ion = ion};
  opc_feedback f = {.size = sizeof f, .gates = &gates, .design = &drawn,
                    .flags = flags, .vetoes = vetoes};
  opc_moves moves = {.size = sizeof moves, .l = t->l, .w = t->w};
  opc_error error;
  g_assert_cmpint(s->begin(m->self, &f, &error), ==, OPC_OK);
  memset(t->l, 0, sizeof t->l);
  memset(t->w, 0, sizeof t->w);
  f.printed = &printed;
  t->trace = g_string_new(NULL);
  t->updates = 0;
  int done = 0;
  while (!done && t->updates < 100) {
    for (size_t i = 0; i < t->n; i++) {
      double pde = t->offset[i] + t->by_l[i] * t->l[i] + t->by_w[i] * t->w[i];
      ion[i] = design[i] * (1 + pde / 100);
      vetoes[i] = t->veto[i] && t->l[i] >= t->veto_from[i] ? t->veto[i] : 0;
    }
    g_assert_cmpint(s->update(m->self, &f, &moves, &done, &error), ==, OPC_OK);
    f.iteration++;
    t->updates++;
    g_string_append_printf(t->trace, "%d,%d ", t->l[0], t->w[0]);
  }
}

static opc_module *make(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("mask.dpb", parameters, &error);
  g_assert_nonnull(m);
  return m;
}

static const char *verdict(opc_module *m, size_t i) {
  const opc_synthesizer *s = m->plugin->operations;
  return s->verdict(m->self, i);
}

/* +7 %, 3 % a step of L, 0.8 % a step of W:
   L 1: 4, L 2: 1, L 3: -2 rises, so back to L 2: 1; then W -1: 0.2, done. */
static void test_by_hand(void) {
  g_autoptr(opc_module) m = make("{ max_pde: 0.5 % }");
  model t = {.n = 1, .offset = {7}, .by_l = {-3}, .by_w = {0.8}};
  run(m, &t);
  g_assert_cmpstr(t.trace->str, ==, "1,0 2,0 3,0 2,0 2,-1 2,-1 ");
  g_assert_cmpstr(verdict(m, 0), ==, "within limit");
  g_string_free(t.trace, TRUE);
}

/* Too little current, and a first jump of 3: 3 steps at once. */
static void test_init_adjust(void) {
  g_autoptr(opc_module) m = make("{ max_pde: 0.5 %, init_adjust: 3 nm }");
  model t = {.n = 1, .offset = {-9.2}, .by_l = {-3}, .by_w = {0.8}};
  run(m, &t);
  g_assert_cmpstr(t.trace->str, ==, "-3,0 -3,0 ");
  g_string_free(t.trace, TRUE);
}

/* A transistor within the limit is not touched. */
static void test_within(void) {
  g_autoptr(opc_module) m = make("{ max_pde: 0.5 % }");
  model t = {.n = 1, .offset = {-0.49}, .by_l = {-3}, .by_w = {0.8}};
  run(m, &t);
  g_assert_cmpstr(t.trace->str, ==, "0,0 ");
  g_assert_cmpint(t.updates, ==, 1);
  g_string_free(t.trace, TRUE);
}

/* A grid too coarse for the limit: it stays at the minimum of W, and says
   so. PDE 7, 4, 1, -2, 1; W: -2 % a step, 1 -> -1 (no better, not worse) ->
   -3 rises -> back. */
static void test_grid(void) {
  g_autoptr(opc_module) m = make("{ max_pde: 0.1 % }");
  model t = {.n = 1, .offset = {7}, .by_l = {-3}, .by_w = {2}};
  run(m, &t);
  g_assert_cmpint(t.l[0], ==, 2);
  g_assert_cmpint(abs(7 - 3 * t.l[0] + 2 * t.w[0]), ==, 1);
  g_assert_cmpstr(verdict(m, 0), ==, "grid");
  g_string_free(t.trace, TRUE);
}

/* At L = 2 the gate bridges: back to 1, and on with W down to the limit. */
static void test_veto(void) {
  g_autoptr(opc_module) m = make("{ max_pde: 0.5 % }");
  model t = {.n = 1, .offset = {7}, .by_l = {-3}, .by_w = {0.8},
             .veto = {OPC_VETO_LONGER}, .veto_from = {2}};
  run(m, &t);
  g_assert_cmpint(t.l[0], ==, 1);
  g_assert_cmpint(t.w[0], ==, -5);
  g_assert_true(g_str_has_prefix(t.trace->str, "1,0 2,0 1,0 1,-1 1,-2 "));
  g_string_free(t.trace, TRUE);
}

static void test_bias_limit(void) {
  g_autoptr(opc_module) m = make("{ max_pde: 0.5 %, max_bias: 2 nm }");
  model t = {.n = 1, .offset = {30}, .by_l = {-3}, .by_w = {0.8}};
  run(m, &t);
  g_assert_cmpint(t.l[0], ==, 2);
  g_assert_cmpint(t.w[0], ==, -2);
  g_assert_cmpstr(verdict(m, 0), ==, "bias limit");
  g_string_free(t.trace, TRUE);
}

/* Each transistor goes its own way, and the loop ends when the last does. */
static void test_independent(void) {
  g_autoptr(opc_module) m = make("{ max_pde: 0.5 % }");
  model t = {.n = 3, .offset = {7, -0.2, -9.2}, .by_l = {-3, -3, -3},
             .by_w = {0.8, 0.8, 0.8}};
  run(m, &t);
  g_assert_cmpint(t.l[0], ==, 2);
  g_assert_cmpint(t.w[0], ==, -1);
  g_assert_cmpint(t.l[1], ==, 0);
  g_assert_cmpint(t.l[2], ==, -3);
  g_string_free(t.trace, TRUE);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/dpb/by-hand", test_by_hand);
  g_test_add_func("/dpb/init-adjust", test_init_adjust);
  g_test_add_func("/dpb/within", test_within);
  g_test_add_func("/dpb/grid", test_grid);
  g_test_add_func("/dpb/veto", test_veto);
  g_test_add_func("/dpb/bias-limit", test_bias_limit);
  g_test_add_func("/dpb/independent", test_independent);
  return g_test_run();
}
