/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests thesis 2.2.5 by hand calculations on transistors whose response is a
   formula. */
#include <eda/eda.h>

#include "tools/devel/testing.h"

#include <math.h>
#include <string.h>

enum { MOST = 3 };

/* Transistors of L 65 with the deviations offset + by_l * l + by_w * w, %. */
typedef struct model {
  size_t n;
  double ion[MOST], ion_by_l, ion_by_w;
  double ioff[MOST], ioff_by_l, ioff_by_w;
  double leq_ion[MOST], leq_ioff[MOST]; /* equivalent lengths with the drawn
                                           mask */
  double weq; /* printed width; 0 means the drawn width */
  int32_t l[MOST], w[MOST];
  GString *trace; /* "l,w " of the first transistor, appended after each
                     update */
  int updates;
} model;

static void model_run(opc_module *m, model *t) {
  const eda_synthesizer *s = m->functions;
  double one[MOST], ion[MOST], ioff[MOST], length[MOST], width[MOST], weq[MOST];
  uint32_t flags[MOST] = {0}, vetoes[MOST] = {0};
  for (size_t i = 0; i < t->n; i++) {
    one[i] = 1, length[i] = 65, width[i] = 200;
    weq[i] = t->weq > 0 ? t->weq : width[i];
  }
  eda_gates gates = {
      .grid = 1, .count = t->n, .length = length, .width = width};
  eda_performance drawn = {.count = t->n, .ion = one, .ioff = one};
  eda_performance printed = {.count = t->n,
                             .ion = ion,
                             .ioff = ioff,
                             .weq = weq,
                             .leq_ion = t->leq_ion,
                             .leq_ioff = t->leq_ioff};
  eda_feedback f = {
      .gates = &gates, .design = &drawn, .flags = flags, .vetoes = vetoes};
  eda_moves moves = {.l = t->l, .w = t->w};
  opc_error error;
  t->trace = g_string_new(NULL);
  t->updates = 0;
  g_assert_cmpint(s->begin(m->self, &f, &error), ==, OPC_OK);
  f.printed = &printed;
  for (int done = 0; !done && t->updates < 200; t->updates++) {
    for (size_t i = 0; i < t->n; i++) {
      ion[i] =
          1 + (t->ion[i] + t->ion_by_l * t->l[i] + t->ion_by_w * t->w[i]) / 100;
      ioff[i] =
          1 +
          (t->ioff[i] + t->ioff_by_l * t->l[i] + t->ioff_by_w * t->w[i]) / 100;
    }
    g_assert_cmpint(s->update(m->self, &f, &moves, &done, &error), ==, OPC_OK);
    f.iteration++;
    g_string_append_printf(t->trace, "%d,%d ", t->l[0], t->w[0]);
  }
}

static void check_moves(const char *parameters, model t, const char *trace,
                        const char *why) {
  opc_error error;
  g_autoptr(opc_module) m =
      opc_test_module("synthesizer.pb", parameters, &error);
  g_assert_nonnull(m);
  model_run(m, &t);
  g_assert_cmpstr(t.trace->str, ==, trace);
  const eda_synthesizer *s = m->functions;
  g_assert_cmpstr(s->verdict(m->self, 0), ==, why);
  g_string_free(t.trace, TRUE);
}

static const model both = {.n = 1,
                           .ion = {7},
                           .ion_by_l = -3,
                           .ion_by_w = 0.8,
                           .ioff = {90},
                           .ioff_by_l = -50,
                           .ioff_by_w = 1,
                           .leq_ion = {63.1},
                           .leq_ioff = {61.6}};

/* L - Leq = 65 - 63.1 = 1.9, so L moves by 2 at once.
     0  +7.0  L 2
     1  +1.0  falls: continue
     2  -2.0  rises: revert
     3  +1.0  W, one step narrower
     4  +0.2  within the tolerance */
static void test_ion(void) {
  check_moves("{ mode: ion }", both, "2,0 3,0 2,0 2,-1 2,-1 2,-1 ",
              "within limit");
}

/* L - Leq = 65 - 61.6 = 3.4, so L moves by 3 at once, which is too far; then L
   decreases.
     0   +90  L 3
     1   -60  L 2
     2   -10  L 1
     3   +40  rises: revert
     4   -10  W wider, to -0.5 at 9.5 steps: 10 */
static void test_ioff(void) {
  check_moves(
      "{ mode: ioff }", both,
      "3,0 2,0 1,0 2,0 2,1 2,2 2,3 2,4 2,5 2,6 2,7 2,8 2,9 2,10 2,10 2,10 ",
      "within limit");
}

/* L corrects Ioff as above, with -10 % remaining; then W corrects Ion, which is
   +1 at L 2. */
static void test_ioffion(void) {
  check_moves("{ mode: ioffion }", both, "3,0 2,0 1,0 2,0 2,-1 2,-1 2,-1 ",
              "within limit");
}

/* Correction of Ion keeps the length that Ioff determined, however large the
   deviation of Ion is. */
static void test_ioffion_keeps_length(void) {
  model t = both;
  t.ion[0] = 16; /* Ion is +10 at L 2, more than the effect of three steps of
                    L */
  opc_error error;
  g_autoptr(opc_module) m =
      opc_test_module("synthesizer.pb", "{ mode: ioffion }", &error);
  g_assert_nonnull(m);
  model_run(m, &t);
  g_assert_cmpint(t.l[0], ==, 2);
  g_assert_cmpint(t.w[0], ==, -12); /* 10 - 9.6 */
  g_string_free(t.trace, TRUE);
}

/* The first correction is one step if the effective length is correct within
   half a step, or if the gate does not print and has no effective length. */
static void test_first_step(void) {
  model t = both;
  t.leq_ion[0] = 65.3;
  check_moves("{}", t, "1,0 2,0 3,0 2,0 2,-1 2,-1 2,-1 ", "within limit");
  t.leq_ion[0] = 0;
  check_moves("{}", t, "1,0 2,0 3,0 2,0 2,-1 2,-1 2,-1 ", "within limit");
}

/* Current per width is exp(-0.03 (L - 65)). A transistor printed 66 long and
   220 wide (drawn: 200) has the current of a transistor 200 wide and 62.8 long:
   6.7 % too much. The correction is +2 nm, not the -1 nm that a length of 66
   suggests. */
static void test_drawn_width(void) {
  model t = both;
  double ratio = 220. / 200 * exp(-0.03 * (66 - 65));
  t.weq = 220;
  t.leq_ion[0] = 66;
  t.ion[0] = 100 * (ratio - 1);
  g_assert_cmpfloat(fabs(65 - log(ratio) / 0.03 - 62.82), <, 0.01);
  check_moves("{}", t, "2,0 3,0 2,0 2,-1 2,-1 2,-1 ", "within limit");
}

/* The parameter sets the limit; several transistors converge independently of
   each other. */
static void test_tolerance(void) {
  model t = both;
  t.n = 3;
  t.ion[1] = 1.2;
  t.ion[2] = -8;
  t.leq_ion[1] = 64.5;
  t.leq_ion[2] = 68;
  opc_error error;
  g_autoptr(opc_module) m =
      opc_test_module("synthesizer.pb", "{ current_limit: 1.5 % }", &error);
  g_assert_nonnull(m);
  model_run(m, &t);
  g_assert_cmpint(t.l[0], ==, 2);
  g_assert_cmpint(t.l[1], ==, 0);
  g_assert_cmpint(t.l[2], ==, -3);
  for (int i = 0; i < 3; i++) g_assert_cmpint(t.w[i], ==, 0);
  g_string_free(t.trace, TRUE);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/pb/ion", test_ion);
  g_test_add_func("/pb/ioff", test_ioff);
  g_test_add_func("/pb/ioffion", test_ioffion);
  g_test_add_func("/pb/ioffion-keeps-length", test_ioffion_keeps_length);
  g_test_add_func("/pb/first-step", test_first_step);
  g_test_add_func("/pb/drawn-width", test_drawn_width);
  g_test_add_func("/pb/tolerance", test_tolerance);
  return g_test_run();
}
