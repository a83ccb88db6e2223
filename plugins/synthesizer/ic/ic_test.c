/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests thesis figure 5.2 by hand calculations on transistors whose response is
   a formula. */
#include <eda/eda.h>

#include "tools/devel/testing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One transistor with deviations of Ion and area that are linear in l and w,
   plus `bend` % of area for each step of W beyond the second. */
typedef struct model {
  double i, i_by_l, i_by_w;
  double a, a_by_l, a_by_w;
  double bend;
  uint32_t veto; /* vetoes from |l| + |w| = veto_from on */
  int32_t veto_from;
  int32_t prints_from; /* smallest l at which the line prints; with 0, the line
                          prints at every l */
  uint32_t lot; /* seed of random deviations up to 2 % and of random vetoes;
                   with 0, the model has neither */
  double width; /* drawn width; 0 means 200 */
  int32_t l, w;
  GString *trace; /* "l,w " after each update */
  int updates;
} model;

/* Return a value from -1 to 1, a function of mask and seed. */
static double random_at(const model *t, int32_t l, int32_t w, uint32_t which) {
  uint32_t h = t->lot;
  const uint32_t parts[] = {(uint32_t)l, (uint32_t)w, which};
  for (int k = 0; k < 3; k++) {
    h = (h ^ parts[k]) * 2654435761u;
    h ^= h >> 15;
  }
  return t->lot ? (h & 0xffff) / 32768.0 - 1 : 0;
}

static uint32_t veto_of(const model *t) {
  static const uint32_t all[] = {EDA_VETO_LONGER, EDA_VETO_SHORTER,
                                 EDA_VETO_WIDER, EDA_VETO_NARROWER};
  uint32_t veto = abs(t->l) + abs(t->w) >= t->veto_from ? t->veto : 0;
  for (uint32_t k = 0; k < 4; k++)
    if (random_at(t, t->l, t->w, 2 + k) > 0.8) veto |= all[k];
  return veto;
}

static double model_di(const model *t) {
  return t->i + t->i_by_l * t->l + t->i_by_w * t->w +
         2 * random_at(t, t->l, t->w, 0);
}

static double model_da(const model *t) {
  int beyond = abs(t->w) > 2 ? abs(t->w) - 2 : 0;
  return t->a + t->a_by_l * t->l + t->a_by_w * t->w + t->bend * beyond +
         2 * random_at(t, t->l, t->w, 1);
}

static void model_run(opc_module *m, model *t) {
  const eda_synthesizer *s = m->functions;
  double one = 1, ion, area, length = 65, width = t->width > 0 ? t->width : 200;
  uint32_t flags = 0, veto = 0;
  eda_gates gates = {.grid = 1, .count = 1, .length = &length, .width = &width};
  eda_performance drawn = {.count = 1, .ion = &one, .area = &one};
  eda_performance printed = {.count = 1, .ion = &ion, .area = &area};
  eda_feedback f = {
      .gates = &gates, .design = &drawn, .flags = &flags, .vetoes = &veto};
  eda_moves moves = {.l = &t->l, .w = &t->w};
  opc_error error;
  t->l = t->w = t->updates = 0;
  t->trace = g_string_new(NULL);
  g_assert_cmpint(s->begin(m->self, &f, &error), ==, OPC_OK);
  f.printed = &printed;
  for (int done = 0; !done && t->updates < 100; t->updates++) {
    int is_open = t->prints_from && t->l < t->prints_from;
    flags = is_open ? EDA_PRINT_OPEN : 0;
    ion = is_open ? 0 : 1 + model_di(t) / 100;
    area = is_open ? 0 : 1 + model_da(t) / 100;
    veto = veto_of(t);
    g_assert_cmpint(s->update(m->self, &f, &moves, &done, &error), ==, OPC_OK);
    f.iteration++;
    g_string_append_printf(t->trace, "%d,%d ", t->l, t->w);
  }
}

static opc_module *model_make(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("synthesizer.ic", parameters, &error);
  g_assert_nonnull(m);
  return m;
}

static const char *model_verdict(opc_module *m) {
  return ((const eda_synthesizer *)m->functions)->verdict(m->self, 0);
}

static void check_moves(const char *parameters, model t, const char *trace,
                        const char *why) {
  g_autoptr(opc_module) m = model_make(parameters);
  model_run(m, &t);
  g_assert_cmpstr(t.trace->str, ==, trace);
  g_assert_cmpstr(model_verdict(m), ==, why);
  g_string_free(t.trace, TRUE);
}

/* Lines 12 to 19: one step in each quarter of the decision matrix. */
static void test_matrix(void) {
  const struct {
    double i, a;
    const char *first;
  } cases[] = {{9, -9, "1,0 "}, {-9, 9, "-1,0 "}, {-9, -9, "0,1 "},
               {9, 9, "0,-1 "}, {0, 9, "0,0 "},   {9, 0, "0,0 "}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_module) m = model_make("{}");
    model t = {.i = cases[i].i, .a = cases[i].a};
    model_run(m, &t);
    g_assert_true(g_str_has_prefix(t.trace->str, cases[i].first));
    g_string_free(t.trace, TRUE);
  }
}

/* Deviations as drawn: I +7, A -4. A step of L changes I by -3 and A by +1.5; a
   step of W changes I by +0.5 and A by +0.5. By hand:
     k  mask   I     A     Eff   line
     0  0,0   +7.0  -4.0  11.0   13: increase L
     1  1,0   +4.0  -2.5   6.5   falls; 13
     2  2,0   +1.0  -1.0   2.0   falls; 13
     3  3,0   -2.0  +0.5   2.5   rises; 20: restored
     4  2,0   +1.0  -1.0   2.0   ended
     5  2,0   nothing changed: line 22 */
static void test_freeze(void) {
  const model t = {.i = 7,
                   .i_by_l = -3,
                   .i_by_w = 0.5,
                   .a = -4,
                   .a_by_l = 1.5,
                   .a_by_w = 0.5};
  check_moves("{}", t, "1,0 2,0 3,0 2,0 2,0 2,0 ", "stalled");
}

/* The same transistor, but a step of W changes A by +0.3. The variant
   `continue` continues from (2, 0), with I +1 and A -1:
     k  mask   I     A     Eff
     3  3,0   -2.0  +0.5   2.5   failed: longer, by the matrix. Wider and
                                 narrower have the same expected deviation, 2
     4  2,1   +1.5  -0.7   2.2   failed: wider
     5  2,-1  +0.5  -1.3   1.8   falls: longer by the matrix
     6  3,-1  -2.5  +0.2   2.7   failed; wider is first again
     7  2,0   +1.0  -1.0   2.0   failed; narrower
     8  2,-2   0.0  -1.6   1.6   falls */
static void test_continue(void) {
  g_autoptr(opc_module) m = model_make("{ stall: continue }");
  model t = {.i = 7,
             .i_by_l = -3,
             .i_by_w = 0.5,
             .a = -4,
             .a_by_l = 1.5,
             .a_by_w = 0.3};
  model_run(m, &t);
  g_assert_true(
      g_str_has_prefix(t.trace->str, "1,0 2,0 3,0 2,1 2,-1 3,-1 2,0 2,-2 "));
  /* The transistor ends at the best state. */
  g_assert_cmpfloat(fabs(model_di(&t)) + fabs(model_da(&t)), <, 1.6 + 1e-9);
  g_assert_cmpstr(model_verdict(m), ==, "stalled");
  g_string_free(t.trace, TRUE);
}

/* A single correction fails where a combination succeeds: I +3, A +3, so W
   decreases; after two steps of W the area deviation rises. The variant
   `freeze` then ends; `continue` tries L and ends with a smaller deviation. */
static void test_continue_is_better(void) {
  const model t = {.i = 3,
                   .i_by_l = -1,
                   .i_by_w = 0.5,
                   .a = 3,
                   .a_by_l = 0.1,
                   .a_by_w = 0.5,
                   .bend = 2};
  g_autoptr(opc_module) freeze = model_make("{}");
  g_autoptr(opc_module) go_on = model_make("{ stall: continue }");
  model a = t, b = t;
  model_run(freeze, &a);
  model_run(go_on, &b);
  g_assert_cmpint(a.w, ==, -2);
  g_assert_cmpint(a.l, ==, 0);
  g_assert_cmpfloat(fabs(model_di(&b)) + fabs(model_da(&b)), <,
                    fabs(model_di(&a)) + fabs(model_da(&a)) - 1);
  g_string_free(a.trace, TRUE);
  g_string_free(b.trace, TRUE);
}

/* The number of failed corrections is limited; with 0, the result equals that
   of `freeze`. */
static void test_retries(void) {
  const model t = {.i = 7,
                   .i_by_l = -3,
                   .i_by_w = 0.5,
                   .a = -4,
                   .a_by_l = 1.5,
                   .a_by_w = 0.5};
  check_moves("{ stall: continue, retries: 0 }", t, "1,0 2,0 3,0 2,0 2,0 2,0 ",
              "stalled");
}

/* Nothing moves within both limits; L or W moves if either limit is
   exceeded. */
static void test_limits(void) {
  const model t = {.i = 0.9, .i_by_l = -0.5, .a = -1.9, .a_by_l = 0.5};
  check_moves("{ ion_limit: 1 %, area_limit: 2 % }", t, "0,0 ", "within limit");
  check_moves("{ ion_limit: 0.5 %, area_limit: 2 % }", t, "1,0 1,0 1,0 ",
              "within limit");
}

/* Weights: an area deviation 1.5 % larger is accepted for 1 % of current only
   if the current has the larger weight. I +2, A -1: longer. */
static void test_weights(void) {
  const model t = {.i = 2, .i_by_l = -1, .a = -0.2, .a_by_l = 1.5};
  check_moves("{ ion_limit: 0.1 % }", t, "1,0 0,0 0,0 0,0 ", "stalled");
  g_autoptr(opc_module) m = model_make("{ alpha_i: 3, ion_limit: 0.1 % }");
  model u = t;
  model_run(m, &u);
  g_assert_true(g_str_has_prefix(u.trace->str, "1,0 1,-1 "));
  g_string_free(u.trace, TRUE);
}

/* A vetoed length is reverted. */
static void test_veto(void) {
  const model t = {.i = 9,
                   .i_by_l = -1,
                   .a = -9,
                   .a_by_l = 1,
                   .veto = EDA_VETO_LONGER,
                   .veto_from = 2};
  check_moves("{}", t, "1,0 2,0 1,0 1,0 1,0 ", "bridging");
}

/* The other three corrections are vetoed likewise. */
static void test_other_vetoes(void) {
  const model shorter = {.i = -9, .i_by_l = -1, .a = 9, .a_by_l = 1};
  const model wider = {.i = -9, .i_by_w = 1, .a = -9, .a_by_w = 1};
  const model narrower = {.i = 9, .i_by_w = 1, .a = 9, .a_by_w = 1};
  const struct {
    model t;
    uint32_t veto;
    const char *trace;
  } ways[] = {{shorter, EDA_VETO_SHORTER, "-1,0 -2,0 -1,0 -1,0 -1,0 "},
              {wider, EDA_VETO_WIDER, "0,1 0,2 0,1 0,1 0,1 "},
              {narrower, EDA_VETO_NARROWER, "0,-1 0,-2 0,-1 0,-1 0,-1 "}};
  for (int k = 0; k < 3; k++) {
    model t = ways[k].t;
    t.veto = ways[k].veto;
    t.veto_from = 2;
    check_moves("{}", t, ways[k].trace, "bridging");
  }
}

/* The matrix chooses longer, which increases the deviation. Among the other
   corrections, one step of W (drawn: 200) changes both deviations by 0.5 %:
   wider results in 9.5 alpha_i + 8.5 alpha_a, narrower in 8.5 alpha_i + 9.5
   alpha_a; the larger weight decides. */
static void test_promises(void) {
  static const char *const parameters[] = {
      "{ stall: continue, alpha_i: 3, alpha_a: 2 }",
      "{ stall: continue, alpha_i: 2, alpha_a: 3 }"};
  static const char *const first[] = {"1,0 0,-1 ", "1,0 0,1 "};
  for (int k = 0; k < 2; k++) {
    model t = {.i = 9, .i_by_l = 1, .a = -9};
    g_autoptr(opc_module) m = model_make(parameters[k]);
    model_run(m, &t);
    if (!g_str_has_prefix(t.trace->str, first[k])) g_error("%s", t.trace->str);
    g_string_free(t.trace, TRUE);
  }
}

static void test_bias_limit(void) {
  const model t = {.i = 9, .i_by_l = -1, .a = -9, .a_by_l = 1};
  check_moves("{ max_bias: 2 nm }", t, "1,0 2,0 2,0 2,0 ", "bias limit");
  const model shorter = {.i = -9, .i_by_l = -1, .a = 9, .a_by_l = 1};
  check_moves("{ max_bias: 2 nm }", shorter, "-1,0 -2,0 -2,0 -2,0 ",
              "bias limit");
  const model narrower = {.i = 9, .i_by_w = 1, .a = 9, .a_by_w = 1};
  check_moves("{ max_bias: 2 nm }", narrower, "0,-1 0,-2 0,-2 0,-2 ",
              "bias limit");
  /* W moves by at most half of the drawn width. */
  const model slim = {.i = 9, .i_by_w = 1, .a = 9, .a_by_w = 1, .width = 7};
  check_moves("{}", slim, "0,-1 0,-2 0,-3 0,-3 0,-3 ", "bias limit");
}

/* An open line has no figures; the length of the gate grows until the line
   prints, in both variants. */
static void test_open(void) {
  model t = {.i = 12, .i_by_l = -3, .a = -12, .a_by_l = 3, .prints_from = 3};
  check_moves("{ stall: freeze }", t, "1,0 2,0 3,0 4,0 4,0 4,0 ",
              "within limit");
  check_moves("{ stall: continue }", t, "1,0 2,0 3,0 4,0 4,0 4,0 ",
              "within limit");
}

/* ---- random deviations ---- */

enum { BIAS = 6 };
static const double alpha[2] = {1.5, 0.7}, limit[2] = {0.8, 1.1};

static double model_eff(const model *t) {
  return alpha[0] * fabs(model_di(t)) + alpha[1] * fabs(model_da(t));
}

static int is_within(const model *t) {
  return fabs(model_di(t)) <= limit[0] && fabs(model_da(t)) <= limit[1];
}

/* Steps of l and w: longer, shorter, wider, narrower. */
static const int32_t step[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};

/* Return the quarter of figure 5.3. */
static int matrix_quarter(double i, double a) {
  return i > 0 && a < 0 ? 0 : i < 0 && a > 0 ? 1 : i < 0 && a < 0 ? 2 : 3;
}

static uint32_t vetoes_direction(uint32_t veto, int direction) {
  return veto & (uint32_t[]){EDA_VETO_LONGER, EDA_VETO_SHORTER, EDA_VETO_WIDER,
                             EDA_VETO_NARROWER}[direction];
}

static int is_too_far(const model *t, int direction) {
  return abs(t->l + step[direction][0]) > BIAS ||
         abs(t->w + step[direction][1]) > BIAS;
}

/* Compute figure 5.2 as one loop: step while the effective deviation falls,
   revert the first step that fails. Return the verdict. */
static const char *run_freeze(model *t) {
  for (;;) {
    model before = *t;
    if (is_within(t)) return "within limit";
    int direction = matrix_quarter(model_di(t), model_da(t));
    if (vetoes_direction(veto_of(t), direction)) return "bridging";
    if (is_too_far(t, direction)) return "bias limit";
    t->l += step[direction][0];
    t->w += step[direction][1];
    int vetoed = vetoes_direction(veto_of(t), direction) != 0;
    if (!vetoed && model_eff(t) < model_eff(&before)) continue;
    *t = before;
    return is_within(t) ? "within limit" : vetoed ? "bridging" : "stalled";
  }
}

/* Return the deviation expected after a correction of the best mask. */
static double deviation_after(const model *t, int direction) {
  double l = 100.0 * step[direction][0] / 65,
         w = 100.0 * step[direction][1] / 200;
  return alpha[0] * fabs(model_di(t) - l + w) +
         alpha[1] * fabs(model_da(t) + l + w);
}

/* Compute the variant `continue` with `retries`: a failed step is followed by
   another step from the best mask. A correction counts as forbidden if the last
   attempt at this correction was vetoed. Return the verdict. */
static const char *run_continue(model *t, int retries) {
  model best = *t;
  int tried = 0, vetoed = 0;
  uint32_t veto = veto_of(t);
  for (;;) {
    int direction = -1,
        first = matrix_quarter(model_di(&best), model_da(&best));
    if (is_within(&best) && t->l == best.l && t->w == best.w) break;
    for (int k = 0; k < 4; k++) {
      if (tried & 1 << k || vetoes_direction(veto, k) || is_too_far(&best, k))
        continue;
      if (k == first) {
        direction = k;
        break;
      }
      if (direction < 0 ||
          deviation_after(&best, k) < deviation_after(&best, direction))
        direction = k;
    }
    if (direction < 0 || retries < 0) break;
    *t = best;
    t->l += step[direction][0];
    t->w += step[direction][1];
    veto = veto_of(t);
    vetoed = vetoes_direction(veto, direction) != 0;
    if (!vetoed && model_eff(t) < model_eff(&best)) {
      best = *t;
      tried = 0;
    } else {
      tried |= 1 << direction;
      retries--;
    }
  }
  *t = best;
  return is_within(t) ? "within limit" : vetoed ? "bridging" : "stalled";
}

/* Compare final masks and verdicts of both variants for random deviations and
   vetoes. */
static void test_by_lot(void) {
  int words = 0, moved = 0;
  for (uint32_t lot = 1; lot <= 400; lot++)
    for (int variant = 0; variant < 2; variant++) {
      int retries = (int)(lot % 7);
      g_autofree char *p = g_strdup_printf(
          "{ alpha_i: %g, alpha_a: %g, ion_limit: %g %%, area_limit: %g %%, "
          "max_bias: %d nm, stall: %s, retries: %d }",
          alpha[0], alpha[1], limit[0], limit[1], BIAS,
          variant ? "continue" : "freeze", retries);
      model t = {.i_by_l = -1.4, .i_by_w = 0.9, .a_by_l = 1.3, .a_by_w = 0.7};
      t.lot = lot * 77;
      t.i = 12 * random_at(&t, 99, 0, 9);
      t.a = 12 * random_at(&t, 99, 1, 9);
      model want = t;
      const char *why =
          variant ? run_continue(&want, retries) : run_freeze(&want);
      g_autoptr(opc_module) m = model_make(p);
      model_run(m, &t);
      if (t.l != want.l || t.w != want.w || !g_str_equal(model_verdict(m), why))
        g_error("lot %u, variant %d: %d, %d, %s; not %d, %d, %s: %s", lot,
                variant, t.l, t.w, model_verdict(m), want.l, want.w, why,
                t.trace->str);
      words |= 1 << why[1] % 32;
      moved += abs(t.l) + abs(t.w) > 3;
      g_string_free(t.trace, TRUE);
    }
  /* The verdicts bridging and stalled, and one of within limit and bias limit,
     occurred. */
  g_assert_cmpint(words, ==, 1 << 'i' % 32 | 1 << 'r' % 32 | 1 << 't' % 32);
  g_assert_cmpint(moved, >, 100);
}

static void test_refused(void) {
  opc_error error = {0};
  g_assert_null(
      opc_test_module("synthesizer.ic", "{ alpha_i: 0, alpha_a: 0 }", &error));
  g_assert_nonnull(strstr(error.message, "both 0"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/ic/matrix", test_matrix);
  g_test_add_func("/ic/freeze", test_freeze);
  g_test_add_func("/ic/continue", test_continue);
  g_test_add_func("/ic/continue-is-better", test_continue_is_better);
  g_test_add_func("/ic/retries", test_retries);
  g_test_add_func("/ic/limits", test_limits);
  g_test_add_func("/ic/weights", test_weights);
  g_test_add_func("/ic/veto", test_veto);
  g_test_add_func("/ic/other-vetoes", test_other_vetoes);
  g_test_add_func("/ic/promises", test_promises);
  g_test_add_func("/ic/bias-limit", test_bias_limit);
  g_test_add_func("/ic/open", test_open);
  g_test_add_func("/ic/by-lot", test_by_lot);
  g_test_add_func("/ic/refused", test_refused);
  return g_test_run();
}
