/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the steps of thesis figure 3.3 by hand calculations on transistors
   whose response is a formula, optionally with an effect of neighbours. */
#include <eda/eda.h>

#include "tools/devel/testing.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 4 };

/* Transistors with a PDE of offset + by_l * l + by_w * w, %. */
typedef struct model {
  size_t n;
  double offset[MOST], by_l[MOST], by_w[MOST];
  uint32_t veto[MOST]; /* the correction is vetoed at l >= this value; with
                          EDA_VETO_SHORTER at l <= this value */
  int32_t veto_from[MOST];
  int veto_until; /* update that withdraws the vetoes; 0: none does */
  int32_t prints_from[MOST]; /* smallest l at which the line prints; with 0, the
                                line prints at every l */
  double width[MOST];        /* drawn width, nm; 0 means 200 */
  /* Effect of neighbours on the first transistor, %, from update `from`
     onwards. If `every` is not 0, the effect is added again after each `every`
     updates. */
  struct {
    double by;
    int from, every, most;
  } neighbours;
  const double *ion_limit; /* ion_limit of the step */
  int refines;             /* 1: refinement of an earlier mask */
  int32_t l[MOST], w[MOST];
  GString *trace; /* "l,w " of the first transistor, appended after each
                     update */
  int updates;
} model;

static double by_neighbours(const model *t) {
  int past = t->updates - t->neighbours.from;
  if (past < 0) return 0;
  int n = t->neighbours.every ? 1 + past / t->neighbours.every : 1;
  return t->neighbours.by * MIN(n, MAX(1, t->neighbours.most));
}

static void model_run(opc_module *m, model *t) {
  const eda_synthesizer *s = m->functions;
  double design[MOST], ion[MOST], width[MOST], length[MOST];
  uint32_t flags[MOST] = {0}, vetoes[MOST];
  for (size_t i = 0; i < t->n; i++)
    design[i] = 1e-3, width[i] = t->width[i] > 0 ? t->width[i] : 200,
    length[i] = 65;
  eda_gates gates = {
      .grid = 1, .count = t->n, .length = length, .width = width};
  eda_performance drawn = {.count = t->n, .ion = design};
  eda_performance printed = {.count = t->n, .ion = ion};
  eda_feedback f = {.gates = &gates,
                    .design = &drawn,
                    .flags = flags,
                    .vetoes = vetoes,
                    .ion_limit = t->ion_limit,
                    .refines = t->refines};
  eda_moves moves = {.l = t->l, .w = t->w};
  opc_error error;
  g_assert_cmpint(s->begin(m->self, &f, &error), ==, OPC_OK);
  memset(t->l, 0, sizeof t->l);
  memset(t->w, 0, sizeof t->w);
  f.printed = &printed;
  t->trace = g_string_new(NULL);
  t->updates = 0;
  int done = 0;
  while (!done && t->updates < 200) {
    for (size_t i = 0; i < t->n; i++) {
      double pde = t->offset[i] + t->by_l[i] * t->l[i] + t->by_w[i] * t->w[i];
      if (i == 0) pde += by_neighbours(t);
      int is_open = t->prints_from[i] && t->l[i] < t->prints_from[i];
      flags[i] = is_open ? EDA_PRINT_OPEN : 0;
      ion[i] = is_open ? 0 : design[i] * (1 + pde / 100);
      int beyond = t->veto[i] == EDA_VETO_SHORTER ? t->l[i] <= t->veto_from[i]
                                                  : t->l[i] >= t->veto_from[i];
      int withdrawn = t->veto_until && t->updates >= t->veto_until;
      vetoes[i] = beyond && !withdrawn ? t->veto[i] : 0;
    }
    g_assert_cmpint(s->update(m->self, &f, &moves, &done, &error), ==, OPC_OK);
    f.iteration++;
    t->updates++;
    g_string_append_printf(t->trace, "%d,%d ", t->l[0], t->w[0]);
  }
}

static opc_module *model_make(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("synthesizer.dpb", parameters, &error);
  g_assert_nonnull(m);
  return m;
}

static const char *model_verdict(opc_module *m, size_t i) {
  const eda_synthesizer *s = m->functions;
  return s->verdict(m->self, i);
}

/* Figure 3.3 on one isolated transistor: +7 %, 3 % per step of L, 0.8 % per
   step of W:

     0  +7.0  beyond the limit: one step longer
     1  +4.0  falls: continue
     2  +1.0  falls: continue
     3  -2.0  rises: revert
     4  +1.0  L is at its minimum: W, one step narrower
     5  +0.2  within the limit: no correction
     6  +0.2  nothing changed since: done */
static void test_by_hand(void) {
  g_autoptr(opc_module) m = model_make("{ w_step: unit, ion_limit: 0.5 % }");
  model t = {.n = 1, .offset = {7}, .by_l = {-3}, .by_w = {0.8}};
  model_run(m, &t);
  g_assert_cmpstr(t.trace->str, ==, "1,0 2,0 3,0 2,0 2,-1 2,-1 2,-1 ");
  g_assert_cmpstr(model_verdict(m, 0), ==, "within limit");
  g_string_free(t.trace, TRUE);
}

/* The same with too little current: -6.5 % remain at L -2. W grows by single
   steps; -1 % would remain, and L -3 would result in +2 %. */
static void test_by_hand_shorter(void) {
  g_autoptr(opc_module) m = model_make("{ w_step: unit, ion_limit: 0.5 % }");
  model t = {.n = 1, .offset = {-7}, .by_l = {-3}, .by_w = {0.2}};
  model_run(m, &t);
  g_assert_cmpstr(t.trace->str, ==,
                  "-1,0 -2,0 -3,0 -2,0 -2,1 -2,2 -2,3 -2,3 -2,3 ");
  g_string_free(t.trace, TRUE);
}

/* Default parameters of all synthesizers at 248 nm, NA 0.7: 0.311, 0.155 and
   0.233 times wavelength / NA (354.3 nm). */
static void test_follows(void) {
  static const char *const all[][2] = {
      {"synthesizer.dpb", "max_bias 110 nm"},
      {"synthesizer.ic", "max_bias 110 nm"},
      {"synthesizer.pb", "max_bias 110 nm"},
      {"synthesizer.newton", "min_jog 55 nm, max_bias 110 nm"},
      {"synthesizer.epe", "fragment 83 nm"}};
  const eda_feedback f = {.gates = eda_gates_sample(), .scanner = {248, 0.7}};
  for (size_t i = 0; i < G_N_ELEMENTS(all); i++) {
    opc_error error;
    g_autoptr(opc_module) m = opc_test_module(all[i][0], "{}", &error);
    const eda_synthesizer *s = m->functions;
    opc_test_forget();
    g_assert_cmpint(s->begin(m->self, &f, &error), ==, OPC_OK);
    g_assert_nonnull(strstr(opc_test_log(), all[i][1]));
  }
}

/* A deviation of +7 % is within a limit of 8 % and beyond a limit of 6 %. The
   limit of the synthesizer has priority over the limit of the step; the default
   is 0.5 %. */
static void test_limit_of_step(void) {
  static const double wide = 8, narrow = 6;
  static const struct {
    const char *parameters;
    const double *ion_limit;
    int moves;
  } cases[] = {{"{ w_step: unit }", &wide, 0},
               {"{ w_step: unit }", &narrow, 1},
               {"{ w_step: unit }", NULL, 1},
               {"{ w_step: unit, ion_limit: 8 % }", &narrow, 0},
               {"{ w_step: unit, ion_limit: 6 % }", &wide, 1},
               {"{ w_step: unit, limit: 8 % }", &narrow, 0}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_module) m = model_make(cases[i].parameters);
    model t = {.n = 1,
               .offset = {7},
               .by_l = {-3},
               .by_w = {0.8},
               .ion_limit = cases[i].ion_limit};
    model_run(m, &t);
    g_assert_cmpint(strcmp(t.trace->str, "0,0 ") != 0, ==, cases[i].moves);
    g_string_free(t.trace, TRUE);
  }
}

/* init_adjust is signed and applied as given: -3 nm shortens the gate by 3
   steps at once. 2 nm lengthens the gate in the wrong direction, and single
   steps then revert the correction. */
static void test_init_adjust(void) {
  g_autoptr(opc_module) m =
      model_make("{ w_step: unit, ion_limit: 0.5 %, init_adjust: -3 nm }");
  model t = {.n = 1, .offset = {-9.2}, .by_l = {-3}, .by_w = {0.8}};
  model_run(m, &t);
  g_assert_cmpstr(t.trace->str, ==, "-3,0 -3,0 -3,0 ");
  g_string_free(t.trace, TRUE);
  g_autoptr(opc_module) wrong =
      model_make("{ w_step: unit, ion_limit: 0.5 %, init_adjust: 2 nm }");
  model u = {.n = 1, .offset = {-3.2}, .by_l = {-3}, .by_w = {0.8}};
  model_run(wrong, &u);
  g_assert_cmpstr(u.trace->str, ==, "2,0 1,0 0,0 -1,0 -1,0 -1,0 ");
  g_string_free(u.trace, TRUE);
}

/* If a first correction of several steps overshoots the minimum, single steps
   follow; the correction is not reverted as a whole. */
static void test_init_adjust_too_far(void) {
  g_autoptr(opc_module) m =
      model_make("{ w_step: unit, ion_limit: 0.5 %, init_adjust: 5 nm }");
  model t = {.n = 1, .offset = {7}, .by_l = {-3}, .by_w = {0.8}};
  model_run(m, &t);
  g_assert_cmpstr(t.trace->str, ==, "5,0 4,0 3,0 2,0 2,-1 2,-1 2,-1 ");
  g_string_free(t.trace, TRUE);
}

/* Steps of W are proportional to the error: -4 % of W 200 is 8 steps. If W has
   half of the expected effect, the error converges in a few steps, the last of
   which are single. If W has twice the expected effect, each change of sign
   halves the steps. */
static void test_proportional(void) {
  g_autoptr(opc_module) m =
      model_make("{ ion_limit: 0.1 %, w_step: proportional }");
  model t = {.n = 1, .offset = {-4}, .by_l = {-9}, .by_w = {0.25}};
  model_run(m, &t);
  /* L -1: +5, back to 0; W 8: -2, 12: -1, 14: -0.5, 15: -0.25, 16: 0. */
  g_assert_cmpstr(t.trace->str, ==,
                  "-1,0 0,0 0,8 0,12 0,14 0,15 0,16 0,16 0,16 ");
  g_string_free(t.trace, TRUE);
  g_autoptr(opc_module) n =
      model_make("{ ion_limit: 0.1 %, w_step: proportional }");
  model u = {.n = 1, .offset = {-4}, .by_l = {-9}, .by_w = {1}};
  model_run(n, &u);
  /* W 8: +4; 4: 0. */
  g_assert_cmpstr(u.trace->str, ==, "-1,0 0,0 0,8 0,4 0,4 0,4 ");
  g_string_free(u.trace, TRUE);
}

/* If W is at its limit, L takes one more step, and W returns from the limit. */
static void test_exchange(void) {
  g_autoptr(opc_module) m =
      model_make("{ ion_limit: 0.3 %, w_step: proportional, max_bias: 10 nm }");
  model t = {.n = 1, .offset = {-4.5}, .by_l = {-10}, .by_w = {0.4}};
  model_run(m, &t);
  g_assert_cmpint(t.l[0], ==, -1);
  g_assert_cmpint(t.w[0], ==, -10);
  g_assert_cmpstr(model_verdict(m, 0), ==, "bias limit");
  g_string_free(t.trace, TRUE);
  model u = {.n = 1, .offset = {-4.5}, .by_l = {-10}, .by_w = {0.43}};
  u.offset[0] = -4.9;
  u.by_l[0] = -9;
  model_run(m,
            &u); /* +4.1 at L -1: W -10 results in -0.2, W +10 at L 0 in -0.6 */
  g_assert_cmpint(u.l[0], ==, -1);
  g_assert_cmpstr(model_verdict(m, 0), ==, "within limit");
  g_string_free(u.trace, TRUE);
}

/* No width moves while any length moves. */
static void test_coarse_before_fine(void) {
  g_autoptr(opc_module) m = model_make("{ w_step: unit, ion_limit: 0.5 % }");
  model t = {.n = 2, .offset = {1, 15.2}, .by_l = {-3, -3}, .by_w = {0.6, 0.6}};
  model_run(m, &t);
  g_assert_cmpstr(t.trace->str, ==, "1,0 0,0 0,0 0,0 0,0 0,-1 0,-1 0,-1 ");
  g_assert_cmpint(t.l[1], ==, 5);
  g_string_free(t.trace, TRUE);
}

/* In a refinement, widths do not wait for the lengths of other transistors. */
static void test_refines(void) {
  g_autoptr(opc_module) m = model_make("{ w_step: unit, ion_limit: 0.5 % }");
  model t = {.n = 2,
             .offset = {-2, 30},
             .by_l = {-3, -2},
             .by_w = {0.8, 0.8},
             .refines = 1};
  model_run(m, &t);
  g_assert_true(g_str_has_prefix(t.trace->str, "-1,0 -1,-1 -1,-1 "));
  g_string_free(t.trace, TRUE);
}

/* A transistor within the limit does not move. */
static void test_within(void) {
  g_autoptr(opc_module) m = model_make("{ w_step: unit, ion_limit: 0.5 % }");
  model t = {.n = 1, .offset = {-0.49}, .by_l = {-3}, .by_w = {0.8}};
  model_run(m, &t);
  g_assert_cmpstr(t.trace->str, ==, "0,0 ");
  g_assert_cmpint(t.updates, ==, 1);
  g_string_free(t.trace, TRUE);
}

/* With a grid too coarse for the limit, the transistor stays at the minimum of
   W, and the verdict names the grid. Steps of L change the PDE from 7 to 4, 1,
   -2 and, reverted, 1. A step of W changes the PDE by 2: from 1 to -1 (|PDE| is
   unchanged, so W continues), then to -3 (|PDE| rises, so the step is
   reverted). */
static void test_grid(void) {
  g_autoptr(opc_module) m = model_make("{ w_step: unit, ion_limit: 0.1 % }");
  model t = {.n = 1, .offset = {7}, .by_l = {-3}, .by_w = {2}};
  model_run(m, &t);
  g_assert_cmpint(t.l[0], ==, 2);
  g_assert_cmpint(abs(7 - 3 * t.l[0] + 2 * t.w[0]), ==, 1);
  g_assert_cmpstr(model_verdict(m, 0), ==, "grid");
  g_string_free(t.trace, TRUE);
}

/* At L = 2 the gate bridges: L returns to 1, and W decreases to the limit. */
static void test_veto(void) {
  g_autoptr(opc_module) m = model_make("{ w_step: unit, ion_limit: 0.5 % }");
  model t = {.n = 1,
             .offset = {7},
             .by_l = {-3},
             .by_w = {0.8},
             .veto = {EDA_VETO_LONGER},
             .veto_from = {2}};
  model_run(m, &t);
  g_assert_cmpint(t.l[0], ==, 1);
  g_assert_cmpint(t.w[0], ==, -5);
  g_assert_true(g_str_has_prefix(t.trace->str, "1,0 2,0 1,0 1,-1 1,-2 "));
  g_string_free(t.trace, TRUE);
}

/* The same in the other direction: at L = -2 the gate is open. */
static void test_veto_of_shorter(void) {
  g_autoptr(opc_module) m = model_make("{ w_step: unit, ion_limit: 0.5 % }");
  model t = {.n = 1,
             .offset = {-7},
             .by_l = {-3},
             .by_w = {0.8},
             .veto = {EDA_VETO_SHORTER},
             .veto_from = {-2}};
  model_run(m, &t);
  g_assert_cmpint(t.l[0], ==, -1);
  g_assert_cmpint(t.w[0], ==, 5);
  g_assert_true(g_str_has_prefix(t.trace->str, "-1,0 -2,0 -1,0 -1,1 -1,2 "));
  g_string_free(t.trace, TRUE);
}

/* W must not decrease: the transistor is not changed, and the verdict names the
   veto. After the regulator has withdrawn the veto, W decreases. */
static void test_veto_of_narrower(void) {
  for (int until = 0; until < 8; until += 4) {
    g_autoptr(opc_module) m = model_make("{ w_step: unit, ion_limit: 0.5 % }");
    /* Another transistor, which moves for ten updates. */
    model t = {.n = 2,
               .offset = {1, 33},
               .by_l = {-3, -3},
               .by_w = {0.8, 0.8},
               .veto = {EDA_VETO_NARROWER},
               .veto_from = {-100},
               .veto_until = until,
               .refines = 1};
    model_run(m, &t);
    g_assert_cmpint(t.updates, >, 9);
    g_assert_cmpint(t.w[0], ==, until ? -1 : 0);
    g_assert_cmpstr(model_verdict(m, 0), ==,
                    until ? "within limit" : "bridging");
    g_string_free(t.trace, TRUE);
  }
}

/* 25 % too little current, 0.5 % for each of 200 steps of W, no effect of L. W
   grows by at most 20 steps per iteration, then by 5 % of 240, and then shrinks
   by 1 % of 252. */
static void test_widest(void) {
  g_autoptr(opc_module) m =
      model_make("{ ion_limit: 0.5 %, w_step: proportional }");
  model t = {.n = 1, .offset = {-25}, .by_l = {-60}, .by_w = {0.5}};
  model_run(m, &t);
  g_assert_true(
      g_str_has_prefix(t.trace->str, "-1,0 0,0 0,20 0,40 0,52 0,50 0,50 "));
  g_assert_cmpstr(model_verdict(m, 0), ==, "within limit");
  g_string_free(t.trace, TRUE);
}

/* W moves by at most half of W, however large max_bias is. */
static void test_half_width(void) {
  g_autoptr(opc_module) m =
      model_make("{ w_step: unit, ion_limit: 0.5 %, max_bias: 20 nm }");
  model t = {.n = 1, .offset = {200}, .by_l = {-3}, .by_w = {5}, .width = {13}};
  model_run(m, &t);
  g_assert_cmpint(t.l[0], ==, 20);
  g_assert_cmpint(t.w[0], ==, -6);
  g_assert_cmpstr(model_verdict(m, 0), ==, "bias limit");
  g_string_free(t.trace, TRUE);
}

static void test_bias_limit(void) {
  g_autoptr(opc_module) m =
      model_make("{ w_step: unit, ion_limit: 0.5 %, max_bias: 2 nm }");
  model t = {.n = 1, .offset = {30}, .by_l = {-3}, .by_w = {0.8}};
  model_run(m, &t);
  g_assert_cmpint(t.l[0], ==, 2);
  g_assert_cmpint(t.w[0], ==, -2);
  g_assert_cmpstr(model_verdict(m, 0), ==, "bias limit");
  g_string_free(t.trace, TRUE);
}

/* An open line has no current; the length of the gate grows until the line
   prints. Each transistor converges independently, and the loop ends after the
   last one. */
static void test_open(void) {
  g_autoptr(opc_module) m = model_make("{ w_step: unit }");
  model t = {
      .n = 1, .offset = {12}, .by_l = {-3}, .by_w = {1}, .prints_from = {3}};
  model_run(m, &t);
  g_assert_true(g_str_has_prefix(t.trace->str, "1,0 2,0 3,0 4,0 4,0 "));
  g_assert_cmpstr(model_verdict(m, 0), ==, "within limit");
  g_string_free(t.trace, TRUE);
}

static void test_independent(void) {
  g_autoptr(opc_module) m = model_make("{ w_step: unit, ion_limit: 0.5 % }");
  model t = {.n = 3,
             .offset = {7, -0.2, -9.2},
             .by_l = {-3, -3, -3},
             .by_w = {0.8, 0.8, 0.8}};
  model_run(m, &t);
  g_assert_cmpint(t.l[0], ==, 2);
  g_assert_cmpint(t.w[0], ==, -1);
  g_assert_cmpint(t.l[1], ==, 0);
  g_assert_cmpint(t.l[2], ==, -3);
  g_string_free(t.trace, TRUE);
}

/* ---- neighbours ---- */

/* Return the moves after the error jumps by `jump` at update 8. The transistor
   has an error of 7 % + `rest`, a change of 3 % per step of L and of 1 % per
   step of W (synthesizer.dpb expects 0.5 %). With rest 0.4, the moves before
   the jump are "1,0 2,0 3,0 2,0 2,-1 2,-2 2,-1 2,-1 ". */
static char *after_jump(const char *parameters, double rest, double jump) {
  g_autoptr(opc_module) m = model_make(parameters);
  model t = {.n = 1, .offset = {7 + rest}, .by_l = {-3}, .by_w = {1}};
  t.neighbours.by = jump;
  t.neighbours.from = 8;
  model_run(m, &t);
  static const char first[] = "1,0 2,0 3,0 2,0 2,-1 2,-2 2,-1 2,-1 ";
  g_assert_true(g_str_has_prefix(t.trace->str, first));
  char *rest_of_it = g_strdup(t.trace->str + sizeof first - 1);
  g_string_free(t.trace, TRUE);
  return rest_of_it;
}

/* A converged transistor resumes if its error changed by more than a tenth of
   the limit. W moves if the change exceeds 0.55 of the expected effect of a
   step of W (0.275 %). L moves if it exceeds 0.55 of the measured effect of a
   step of L (1.65 %). */
static void test_taken_up(void) {
  static const struct {
    double rest, jump;
    const char *trace;
  } cases[] = {
      {0.4, 0.009, "2,-1 2,-1 "},
      {0.4, 0.011, "2,-2 2,-1 2,-1 2,-1 "},
      {0.4, -0.011, "2,-2 2,-1 2,-1 2,-1 "},
      {0.2, 0.07, "2,-1 2,-1 "},
      {0.2, 0.08, "2,-2 2,-1 2,-1 2,-1 "},
      {0.4, 1.24, "2,-2 2,-3 2,-3 2,-3 "},
      {0.4, 1.26, "3,-1 3,0 3,1 3,0 3,0 3,0 "},
      {0.4, -2.04, "2,0 2,1 2,1 2,1 "},
      {0.4, -2.07, "1,-1 1,-2 1,-3 1,-2 1,-2 1,-2 "},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *got = after_jump("{ w_step: unit, ion_limit: 0.1 % }",
                                      cases[i].rest, cases[i].jump);
    g_assert_cmpstr(got, ==, cases[i].trace);
  }
}

/* A transistor resumes at most eight times. */
static void test_taken_up_often(void) {
  g_autoptr(opc_module) m = model_make("{ w_step: unit, ion_limit: 0.1 % }");
  model t = {.n = 1, .offset = {8.2}, .by_l = {-3.3}, .by_w = {1.2}};
  t.neighbours.by = 0.011;
  t.neighbours.from = 8;
  t.neighbours.every = 3;
  t.neighbours.most = 12;
  model_run(m, &t);
  int n = 0;
  for (const char *c = t.trace->str; (c = strstr(c, "2,-2 ")); c++) n++;
  g_assert_cmpint(n, ==, 1 + 8);
  g_assert_cmpstr(model_verdict(m, 0), ==, "grid");
  g_string_free(t.trace, TRUE);
}

/* ---- the table of first corrections ---- */

/* Write a table into the folder of the test and return its path. */
static char *write_table(const char *text) {
  char *path = g_build_filename(opc_test_folder(), "table.csv", NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  return path;
}

/* For transistors of L 65 and W 200, the nearest length in the table is 65, not
   60. Among the widths at this length, 150 is nearer than 300 by ratio (1.33
   against 1.5). */
static void test_table(void) {
  g_autofree char *path = write_table(
      "l (nm),w (nm),init_adjust (nm),iterations\n"
      "60,200,9,1\n65,300,7,1\n65,150,2,1\n100,200,5,1\n");
  g_autofree char *given = g_strdup_printf(
      "{ w_step: unit, ion_limit: 0.5 %%, init_adjust_table: %s }", path);
  g_autoptr(opc_module) m = model_make(given);
  model t = {.n = 1, .offset = {7}, .by_l = {-3}, .by_w = {0.8}};
  model_run(m, &t);
  g_assert_true(g_str_has_prefix(t.trace->str, "2,0 3,0 2,0 2,-1 "));
  g_string_free(t.trace, TRUE);
}

/* Check that reading the table fails with the message `want`. */
static void check_refused(const char *text, const char *want) {
  g_autofree char *path = write_table(text);
  g_autofree char *given =
      g_strdup_printf("{ w_step: unit, init_adjust_table: %s }", path);
  g_autoptr(opc_module) m = model_make(given);
  const eda_synthesizer *s = m->functions;
  eda_gates gates = {.grid = 1};
  eda_feedback f = {.gates = &gates};
  opc_error error = {0};
  g_assert_cmpint(s->begin(m->self, &f, &error), ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, want));
}

static void test_table_refused(void) {
  const struct {
    const char *text, *want;
  } cases[] = {
      {"l,w\n", "table.csv:1:1: missing column 'init_adjust'"},
      {"l,w (um),init_adjust\n", "table.csv:1:3: wrong unit: 'w (um)'"},
      {"l,w,init_adjust,l\n", "table.csv:1:17: duplicate column: 'l'"},
      {"l,w,init_adjust\n65,100,x\n", "table.csv:2:8: not a number: 'x'"},
      {"l,w,init_adjust\n65,100,nan\n", "table.csv:2:8: not a number: 'nan'"},
      {"l,w,init_adjust\n65,0,1\n", "table.csv:2:4: not above 0: '0'"},
      {"l,w,init_adjust\n65,100,101\n",
       "table.csv:2:8: beyond +-100 nm: '101'"},
      {"l,w,init_adjust\n65,100\n", "table.csv:2:7: not a number: ''"},
      {"l,w,init_adjust\n65,1,1\n65,1,2\n", "table.csv:3:1: a second row"},
      {"l,w,init_adjust\n", "has no rows"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    check_refused(cases[i].text, cases[i].want);
  /* Rows are compared in pairs, so their number is limited. */
  g_autoptr(GString) many = g_string_new("l,w,init_adjust\n");
  for (int i = 1; i <= 10001; i++) g_string_append_printf(many, "%d,1,1\n", i);
  check_refused(many->str, "table.csv:10002:1: more than 10000 rows");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/dpb/follows", test_follows);
  g_test_add_func("/dpb/limit-of-step", test_limit_of_step);
  g_test_add_func("/dpb/by-hand", test_by_hand);
  g_test_add_func("/dpb/by-hand-shorter", test_by_hand_shorter);
  g_test_add_func("/dpb/init-adjust", test_init_adjust);
  g_test_add_func("/dpb/init-adjust-too-far", test_init_adjust_too_far);
  g_test_add_func("/dpb/proportional", test_proportional);
  g_test_add_func("/dpb/exchange", test_exchange);
  g_test_add_func("/dpb/coarse-before-fine", test_coarse_before_fine);
  g_test_add_func("/dpb/refines", test_refines);
  g_test_add_func("/dpb/taken-up", test_taken_up);
  g_test_add_func("/dpb/taken-up-often", test_taken_up_often);
  g_test_add_func("/dpb/table", test_table);
  g_test_add_func("/dpb/table-refused", test_table_refused);
  g_test_add_func("/dpb/within", test_within);
  g_test_add_func("/dpb/grid", test_grid);
  g_test_add_func("/dpb/veto", test_veto);
  g_test_add_func("/dpb/veto-of-shorter", test_veto_of_shorter);
  g_test_add_func("/dpb/veto-of-narrower", test_veto_of_narrower);
  g_test_add_func("/dpb/widest", test_widest);
  g_test_add_func("/dpb/half-width", test_half_width);
  g_test_add_func("/dpb/bias-limit", test_bias_limit);
  g_test_add_func("/dpb/independent", test_independent);
  g_test_add_func("/dpb/open", test_open);
  return g_test_run();
}
