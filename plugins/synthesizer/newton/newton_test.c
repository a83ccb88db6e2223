/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests Newton's steps on transistors whose response is a formula. Printed L
   and W are linear in those of the mask, with a small effect of the neighbour;
   currents are exponential in L. */
#include "model_test.h"

/* All transistors converge within 4 moves, although the initial gain is
   wrong. */
static void test_ion(void) {
  g_autoptr(opc_module) m =
      model_make("{ tolerance: 0.05 %, ion_limit: 0 %, gain: { l: 2 } }");
  model t = made_up(MOST);
  model_run(m, &t);
  g_assert_cmpfloat(model_worst(t.ion, t.n), <=, 0.05);
  g_assert_cmpint(t.prints, <=, 6);
  for (size_t i = 0; i < t.n; i++) g_assert_cmpint(t.w[i], ==, 0);
  /* Here each transistor has a different gain. */
  model u = made_up(MOST);
  u.spread = 0.5;
  model_run(m, &u);
  g_assert_cmpfloat(model_worst(u.ion, u.n), <=, 0.05);
  g_assert_cmpint(u.prints, <=, 8);
}

/* Transistors near the resolution limit: nonlinear currents, the end of the
   device table, open and merged lines. The initial gain is exact, up to 6 times
   too small, or up to 10 times too large. The cases have one transistor, or
   many that share a common factor. The solution is known: the printed length
   equals the drawn length. */
static void test_near_resolution(void) {
  static const double guess[] = {2.6, 5.2}, true_gain[] = {0.5, 2, 8};
  int held = 0;
  for (size_t k = 0; k < G_N_ELEMENTS(guess); k++)
    for (size_t j = 0; j < G_N_ELEMENTS(true_gain); j++)
      for (size_t n = 1; n <= MOST; n += MOST - 1) {
        g_autofree char *text = g_strdup_printf(
            "{ iterations: 20, max_bias: 200 nm, gain: { l: %g } }", guess[k]);
        g_autoptr(opc_module) m = model_make(text);
        model t = {.n = n,
                   .gain_l = true_gain[j],
                   .gain_w = 1.05,
                   .steep = 0.005,
                   .table = 57,
                   .open = 55,
                   .merge = 100,
                   .regulated = 1,
                   .guarded = 1};
        for (size_t i = 0; i < n; i++) {
          t.off_l[i] = 12 + 10.0 * (double)i / MOST;
          t.bracket[i][0] = -1e6, t.bracket[i][1] = 1e6;
        }
        model_run(m, &t);
        held += t.held;
        for (size_t i = 0; i < n; i++) {
          g_assert_cmpint(t.flags[i], ==, 0);
          g_assert_cmpint(abs(t.w[i]), <=, 1); /* L corrects the error without
                                                  W */
        }
        g_assert_cmpfloat(model_worst(t.ion, n), <=, 0.5);
        g_test_message("guess %g, gain %g, %zu: %d prints", guess[k],
                       true_gain[j], n, t.prints);
        g_assert_cmpint(t.prints, <=, 16);
      }
  g_assert_cmpint(held, >, 10);
}

/* Lines that are open or merged as drawn are recovered. */
static void test_unprinted_as_drawn(void) {
  g_autoptr(opc_module) m = model_make("{ iterations: 20 }");
  model t = {.n = 2,
             .gain_l = 2,
             .gain_w = 1.05,
             .open = 50,
             .merge = 90,
             .off_l = {-30, 40}};
  model_run(m, &t);
  g_assert_cmpint(t.flags[0], ==, 0);
  g_assert_cmpint(t.flags[1], ==, 0);
  g_assert_cmpfloat(model_worst(t.ion, 2), <=, 0.5);
}

/* A line that is open only because of a short line end keeps its length once
   the line end has been extended. */
static void test_open_by_line_end(void) {
  g_autoptr(opc_module) m = model_make("{}");
  model t = {.n = 2,
             .gain_l = 2,
             .gain_w = 1.05,
             .thin = {0.3, 0.3},
             .grow = 40,
             .ends_open = 1,
             .off_l = {0, 4}};
  model_run(m, &t);
  g_assert_cmpfloat(model_worst(t.ion, 2), <=, 0.5);
}

/* If only an open line would reach the target, the result is a line that prints
   with an error no larger than as drawn. */
static void test_out_of_reach(void) {
  static eda_goal goal[] = {{1, {3, 1, 1}, 1}};
  g_autoptr(opc_module) m = model_make("{}");
  const eda_synthesizer *s = m->functions;
  model t = {.n = 1, .gain_l = 2, .gain_w = 1.05, .open = 50, .off_l = {10}};
  goals = goal;
  model_run(m, &t);
  goals = NULL;
  g_assert_cmpint(t.flags[0], ==, 0);
  g_assert_cmpfloat(t.ion[0], >, 20); /* the drawn mask has -20 */
  g_assert_cmpfloat(s->target(m->self, 0), ==, 3);
}

/* A transistor that a shape of the regulator or a neighbour disturbs after
   convergence is corrected again. */
static void test_disturbed(void) {
  g_autoptr(opc_module) m = model_make("{ ion_limit: 3 % }");
  model t = made_up(MOST);
  t.late = 6;
  model_run(m, &t);
  g_assert_cmpint(t.prints, >, 8);
  g_assert_cmpfloat(model_worst(t.ion, t.n), <=, 1.5);
}

/* Where no jog fits, W corrects a part of the rounding error of L. */
static void test_coarse(void) {
  g_autoptr(opc_module) m = model_make("{ min_jog: 1000 nm }");
  g_autoptr(opc_module) none = model_make("{ fine: none }");
  model t = made_up(MOST), u = made_up(MOST);
  model_run(m, &t);
  model_run(none, &u);
  g_assert_cmpfloat(model_worst(u.ion, u.n), >, 2);
  g_assert_cmpfloat(model_worst(t.ion, t.n), <, 0.9 * model_worst(u.ion, u.n));
  int moved = 0;
  for (size_t i = 0; i < t.n; i++) moved += t.w[i] != 0;
  g_assert_cmpint(moved, >, 0);
}

/* There are no iterations beyond those that the limit requires. */
static void test_limit(void) {
  g_autoptr(opc_module) m = model_make("{ ion_limit: 2 % }");
  model t = made_up(MOST);
  model_run(m, &t);
  g_assert_cmpfloat(model_worst(t.ion, t.n), <=, 2);
  g_autoptr(opc_module) all = model_make("{ ion_limit: 0 % }");
  model u = made_up(MOST);
  model_run(all, &u);
  g_assert_cmpint(t.prints, <, u.prints);
}

/* The effect of line ends that move together with the first step and change the
   current by a tenth is predicted. */
static void test_line_ends(void) {
  g_autoptr(opc_module) m = model_make("{}");
  model t = made_up(MOST);
  t.grow = 25;
  for (size_t i = 0; i < t.n; i++) t.thin[i] = 0.05 + 0.1 * (double)i / MOST;
  model u = t;
  t.knows_ends = 1;
  model_run(m, &t);
  g_assert_cmpfloat(t.second, <, 1.5);
  g_assert_cmpfloat(model_worst(t.ion, t.n), <=, 0.5);
  model_run(m, &u); /* if the moves are not known in advance, the error is the
                       whole effect */
  g_assert_cmpfloat(u.second, >, 10);
  g_assert_cmpfloat(model_worst(u.ion, u.n), <=, 0.5);
  g_assert_cmpint(t.prints, <, u.prints);
}

/* Without a jog, a step of L is 2.6 nm and changes Ion by 5.7 %; up to half of
   a step remains as an error. */
static void test_rounding(void) {
  g_autoptr(opc_module) m = model_make("{ fine: none }");
  model t = made_up(MOST);
  model_run(m, &t);
  g_assert_cmpfloat(model_worst(t.ion, t.n), >, 1);
  g_assert_cmpfloat(model_worst(t.ion, t.n), <, 3.2);
  g_autoptr(opc_module) width = model_make("{ fine: width, ion_limit: 0 % }");
  t = made_up(MOST);
  model_run(width, &t);
  /* The bound is half a step of 1.05 / 400, plus a fifth, because a smaller
     error does not justify a move. */
  g_assert_cmpfloat(model_worst(t.ion, t.n), <, 0.131 / 0.8 + 0.01);
  for (size_t i = 0; i < t.n; i++) g_assert_cmpint(t.jog[i], ==, 0);
}

static void test_area(void) {
  g_autoptr(opc_module) m =
      model_make("{ weight: { area: 1 }, ion_limit: 0 % }");
  model t = made_up(MOST);
  model_run(m, &t);
  /* L and W share the rounding error of W. */
  g_assert_cmpfloat(model_worst(t.ion, t.n), <=, 0.23);
  g_assert_cmpfloat(model_worst(t.area, t.n), <=, 0.23);
}

static void test_ioff(void) {
  g_autoptr(opc_module) m =
      model_make("{ weight: { ioff: 0.01 }, ion_limit: 0 % }");
  model t = made_up(MOST);
  model_run(m, &t);
  g_assert_cmpfloat(model_worst(t.ion, t.n), <=, 0.2);
  g_assert_cmpfloat(model_worst(t.ioff, t.n), <=, 2);
}

/* L and W restore both currents although L alone cannot correct the leakage,
   for example that of a ripple. With Ion alone the leakage remains. */
static void test_balanced(void) {
  g_autoptr(opc_module) both = make_any("{ target: balanced }");
  g_autoptr(opc_module) plain = model_make("{}");
  model t = made_up(MOST), u = made_up(MOST);
  t.leaky = u.leaky = 0.3;
  model_run(both, &t);
  model_run(plain, &u);
  g_assert_cmpfloat(model_worst(t.ion, t.n), <=, 0.2);
  g_assert_cmpfloat(model_worst(t.ioff, t.n), <=, 5);
  g_assert_cmpfloat(model_worst(u.ioff, u.n), >, 30);
  g_assert_cmpint(t.prints, <=, 12);
}

/* Neighbours couple and the responses to L differ, so a step of W for Ioff
   often increases the error of Ion. W continues to move nevertheless. */
static void test_width_goes_on(void) {
  static const double leaky[] = {1.2, 1.6}, spread[] = {0, 0.6};
  g_autoptr(opc_module) both = make_any("{ target: balanced }");
  for (int k = 0; k < 4; k++) {
    model t = made_up(MOST);
    t.leaky = leaky[k & 1];
    t.spread = spread[k >> 1];
    t.coupling = 0.25;
    model_run(both, &t);
    g_assert_cmpfloat(model_worst(t.ion, t.n), <=, 0.5);
    g_assert_cmpfloat(model_worst(t.ioff, t.n), <=, 12);
    g_assert_cmpint(t.prints, <=, 11);
  }
}

/* Moves of W for Ioff make the active merge with its neighbours: W reverts to a
   width that prints separately, and L corrects Ion. */
static void test_active_merges(void) {
  g_autoptr(opc_module) m = make_any("{}");
  model t = made_up(40);
  for (size_t i = 0; i < t.n; i++) t.off_w[i] -= 15;
  t.active_limit = 5;
  model_run(m, &t);
  g_assert_cmpfloat(model_worst(t.ion, t.n), <=, 0.5);
  for (size_t i = 0; i < t.n; i++) {
    g_assert_cmpuint(t.flags[i], ==, 0);
    g_assert_cmpint(t.w[i], >=, t.active_limit);
  }
}

/* The regulator vetoes narrower gates, because moves of W for Ioff take the
   enclosure of contacts: the ends return to where no veto is, and L corrects
   Ion. */
static void test_contact_holds_width(void) {
  g_autoptr(opc_module) m = make_any("{}");
  model t = made_up(40);
  for (size_t i = 0; i < t.n; i++) t.off_w[i] += 25;
  t.contact = -3;
  model_run(m, &t);
  g_assert_cmpfloat(model_worst(t.ion, t.n), <=, 0.5);
  for (size_t i = 0; i < t.n; i++) {
    g_assert_cmpuint(t.veto[i], ==, 0);
    g_assert_cmpint(t.w[i], <, 0);
  }
}

/* Return the image of the gates of the model, whose length increases by `taper`
   nm along the width. Spline coefficients of linear functions equal the
   function values. */
static eda_field image_of(double taper) {
  enum { NX = 140, NY = 320, NODE = 2, FROM = -100 };
  eda_field f = {.frame = {FROM, FROM, NX * NODE, NY * NODE},
                 .nx = NX,
                 .ny = NY,
                 .coefficients = g_new(float, (size_t)NX *NY)};
  for (int y = 0; y < NY; y++)
    for (int x = 0; x < NX; x++) {
      double along = (double)(FROM + NODE * y) / WIDTH - 0.5;
      f.coefficients[y * NX + x] = (float)(length / 2 + taper / 2 * along -
                                           fabs(FROM + NODE * x - length / 2));
    }
  return f;
}

/* Parts of the edges make the length even. The leakage that then rises for one
   simulation, because a line end is short, does not bring back the former mask:
   parts could not move again. */
static void test_shape_stays(void) {
  g_autoptr(opc_module) m = make_any("{}");
  eda_field tapered[2] = {image_of(30)}, even[2] = {image_of(0)};
  model t = made_up(4);
  t.tapered = tapered;
  t.even = even;
  t.surge = 3;
  t.knows_ends = 1;
  model_run(m, &t);
  for (size_t i = 0; i < t.n; i++)
    g_assert_true(t.part[EDA_PARTS * i].by || t.part[EDA_PARTS * i + 1].by);
  g_assert_cmpfloat(model_worst(t.ion, t.n), <=, 0.5);
  g_free(tapered->coefficients);
  g_free(even->coefficients);
}

static void test_weights_of_plain(void) {
  opc_error error;
  g_assert_null(opc_test_module(
      "synthesizer.newton", "{ target: full, weight: { area: 1 } }", &error));
  g_assert_nonnull(strstr(error.message, "weights require 'target: plain'"));
}

/* A jog keeps its distance from both ends of the gate. */
static void test_jog(void) {
  g_autoptr(opc_module) m = model_make("{ min_jog: 150 nm, ion_limit: 0 % }");
  model t = made_up(MOST);
  model_run(m, &t);
  int some = 0;
  for (size_t i = 0; i < t.n; i++) {
    some += t.jog[i] > 0;
    g_assert_true(t.jog[i] == 0 ||
                  (t.jog[i] >= 150 && t.jog[i] <= WIDTH + 120 - 150));
  }
  g_assert_cmpint(some, >, MOST / 2);
}

/* If the regulator vetoes a length, W corrects the error. */
static void test_veto(void) {
  g_autoptr(opc_module) m = model_make("{ ion_limit: 0 % }");
  const eda_synthesizer *s = m->functions;
  model t = {.n = 2, .gain_l = 2.6, .gain_w = 1.05, .off_l = {-4, -4}};
  t.veto[0] = EDA_VETO_LONGER;
  model_run(m, &t);
  g_assert_cmpint(t.l[0], ==, 0);
  g_assert_cmpint(t.w[0], <, -20);
  g_assert_cmpfloat(fabs(t.ion[0]), <, 0.15);
  g_assert_cmpint(t.l[1], >, 0);
  g_assert_cmpint(t.w[1], ==, 0);
  t.veto[0] = t.veto[1] = 15;
  memset(t.l, 0, sizeof t.l);
  memset(t.w, 0, sizeof t.w);
  memset(t.jog, 0, sizeof t.jog);
  model_run(m, &t);
  g_assert_cmpstr(s->verdict(m->self, 0), ==, "bridging");
}

/* After the last iteration, the message names the worst transistor. */
static void test_unconverged(void) {
  g_autoptr(opc_module) m = model_make("{ iterations: 1, gain: { l: 9 } }");
  model t = {.n = 3, .gain_l = 2.6, .gain_w = 1.05, .off_l = {0, 9, 12}};
  opc_test_log();
  model_run(m, &t);
  g_assert_cmpfloat(fabs(t.ion[2]), >, fabs(t.ion[1]));
  g_assert_cmpfloat(fabs(t.ion[1]), >, 1);
  g_assert_nonnull(strstr(opc_test_log(),
                          "2 of 3 transistors could move further, the worst is "
                          "cell:3"));
}

/* The regulator undoes moves of L for some iterations. W moves instead and
   reaches its bound of 10 nm with a large error. L corrects this error as soon
   as L has an effect again. */
static void test_bound_releases_length(void) {
  g_autoptr(opc_module) m = model_make("{ max_bias: 10 nm, iterations: 30 }");
  model t = {.n = 1, .gain_l = 2.6, .gain_w = 1.05, .undone = 9};
  t.off_l[0] = -7;
  model_run(m, &t);
  g_assert_cmpfloat(fabs(t.ion[0]), <=, 0.5);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/newton/ion", test_ion);
  g_test_add_func("/newton/near-resolution", test_near_resolution);
  g_test_add_func("/newton/unprinted-as-drawn", test_unprinted_as_drawn);
  g_test_add_func("/newton/open-by-line-end", test_open_by_line_end);
  g_test_add_func("/newton/out-of-reach", test_out_of_reach);
  g_test_add_func("/newton/limit", test_limit);
  g_test_add_func("/newton/disturbed", test_disturbed);
  g_test_add_func("/newton/coarse", test_coarse);
  g_test_add_func("/newton/line-ends", test_line_ends);
  g_test_add_func("/newton/rounding", test_rounding);
  g_test_add_func("/newton/area", test_area);
  g_test_add_func("/newton/ioff", test_ioff);
  g_test_add_func("/newton/balanced", test_balanced);
  g_test_add_func("/newton/width_goes_on", test_width_goes_on);
  g_test_add_func("/newton/active-merges", test_active_merges);
  g_test_add_func("/newton/contact-holds-width", test_contact_holds_width);
  g_test_add_func("/newton/shape-stays", test_shape_stays);
  g_test_add_func("/newton/weights-of-plain", test_weights_of_plain);
  g_test_add_func("/newton/jog", test_jog);
  g_test_add_func("/newton/veto", test_veto);
  g_test_add_func("/newton/unconverged", test_unconverged);
  g_test_add_func("/newton/bound-releases-length", test_bound_releases_length);
  return g_test_run();
}
