/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares characterized cells with hand-written decks: logic, delays,
   derivatives with respect to sizes, pin capacitances. Also tests the reuse of
   stored results. */
#include <eda/simulator.h>
#include <eda/timing.h>
#include <glib/gstdio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/devel/testing.h"

static void close_to(double a, double b, double share) {
  if (!(fabs(a / b - 1) <= share)) g_error("%.6g is not %.6g", a, b);
}

static char *data(const char *name) {
  return g_build_filename(g_getenv("OPCFLOW_SOURCE"), "data", name, NULL);
}

/* ---- running the step ---- */

static const char more_cells[] =
    "* cells\n"
    ".subckt aoi21 A B1 B2 Z VDD VSS\n"
    "M1 Z A VSS VSS nmos w=400n l=65n\nM2 x B1 Z VSS nmos w=200n l=65n\n"
    "M2b x B1 Z VSS nmos w=200n l=65n\nM3 VSS B2 x VSS nmos w=400n l=65n\n"
    "M4 y A VDD VDD pmos w=600n l=65n\nM5 Z B1 y VDD pmos w=600n l=65n\n"
    "M6 y B2 Z VDD pmos w=600n l=65n\n.ends\n"
    ".subckt latch A B Q QN VDD VSS\n"
    "M1 Q A VSS VSS nmos w=400n l=65n\nM2 Q QN VSS VSS nmos w=400n l=65n\n"
    "M3 x A VDD VDD pmos w=400n l=65n\nM4 Q QN x VDD pmos w=400n l=65n\n"
    "M5 QN B VSS VSS nmos w=400n l=65n\nM6 QN Q VSS VSS nmos w=400n l=65n\n"
    "M7 y B VDD VDD pmos w=400n l=65n\nM8 QN Q y VDD pmos w=400n "
    "l=65n\n.ends\n";

static eda_timing *cells_run(const char *file, const char *more,
                             opc_error *error) {
  g_autofree char *card = data("devices/opcflow65.pm");
  g_autofree char *text = g_strdup_printf(
      "{ file: '%s', models: '%s', supply: 1.1 V, %s }", file, card, more);
  void *outputs[1] = {NULL};
  opc_test_forget();
  opc_module *m = opc_test_module("timing.characterize", text, error);
  if (!m) return NULL;
  int code = opc_test_run(m, outputs, error);
  opc_test_module_free(m);
  return code ? NULL : outputs[0];
}

static eda_timing *run_well(const char *file, const char *more) {
  opc_error error;
  eda_timing *t = cells_run(file, more, &error);
  if (!t) g_error("%s", error.message);
  if (eda_timing_check(t, &error)) g_error("%s", error.message);
  return t;
}

/* A small grid, because each point is simulated. */
#define GRID "slews: [5 ps, 15 ps, 40 ps], loads: [1 fF, 3 fF, 9 fF]"

/* Set the store to the folder `name` in the test's folder; without a name,
   results are not stored. */
static void keep_in(const char *name) {
  g_autofree char *path = g_build_filename(opc_test_folder(), name, NULL);
  g_setenv("OPCFLOW_STORE", *name ? path : "", TRUE);
}

static const eda_timing_arc *arc(const eda_timing_cell *c, uint32_t input,
                                 uint32_t from) {
  int32_t k = c->arc_of[(input << c->inputs) + from];
  return k < 0 ? NULL : &c->arc[k];
}

/* ---- logic functions ---- */

static int aoi21(int a, int b1, int b2) { return !(a | (b1 & b2)); }

static void same_logic(const eda_timing_cell *c, int (*f)(int, int, int)) {
  size_t arcs = 0;
  for (uint32_t p = 0; p >> c->inputs == 0; p++) {
    int v = f(p & 1, p >> 1 & 1, p >> 2 & 1);
    g_assert_cmpint(c->level[p], ==, v);
    for (uint32_t i = 0; i < c->inputs; i++) {
      uint32_t q = p ^ 1u << i;
      int moves = f(q & 1, q >> 1 & 1, q >> 2 & 1) != v;
      const eda_timing_arc *a = arc(c, i, p);
      g_assert_cmpint(a != NULL, ==, moves);
      if (a) g_assert_cmpint(a->rises, ==, !v);
      arcs += (size_t)moves;
    }
  }
  g_assert_cmpuint(c->arcs, ==, arcs);
}

/* Cells of more_cells, characterized once for all tests, and the log. */
static char *log_of_more;

static const eda_timing *more_characterized(void) {
  static eda_timing *t;
  g_autofree char *file = g_build_filename(opc_test_folder(), "cells.sp", NULL);
  if (t) return t;
  g_assert_true(g_file_set_contents(file, more_cells, -1, NULL));
  t = run_well(file, "cells: aoi21 latch, " GRID);
  log_of_more = g_strdup(opc_test_log());
  return t;
}

static void test_logic(void) {
  const eda_timing *t = more_characterized();
  g_autofree char *file = g_build_filename(opc_test_folder(), "cells.sp", NULL);
  g_assert_cmpuint(t->count, ==, 2);
  const eda_timing_cell *c = eda_timing_find(t, "AOI21");
  same_logic(c, aoi21);
  g_assert_cmpuint(c->bundles, ==, 6); /* M2 and M2b are merged */
  const eda_timing_cell *l = eda_timing_find(t, "latch");
  g_assert_nonnull(strstr(l->trouble, "is sequential"));
  g_assert_nonnull(strstr(log_of_more, "'latch' has no arcs"));
  opc_error error;
  g_assert_null(cells_run(file, "cells: latch", &error));
  g_assert_nonnull(strstr(error.message, "no cell that can be"));
}

/* ---- by hand ---- */

/* Return the last time at which v(node) crosses a level, s. */
static double last_crossing(const eda_spice_plot *p, const char *node,
                            double level) {
  const eda_spice_vector *t = eda_spice_vector_find(p, "time"),
                         *v = eda_spice_vector_find(p, node);
  for (size_t i = t->count - 1; i-- > 0;)
    if ((v->value[i] < level) != (v->value[i + 1] < level))
      return t->value[i] + (level - v->value[i]) /
                               (v->value[i + 1] - v->value[i]) *
                               (t->value[i + 1] - t->value[i]);
  g_error("'%s' does not pass %g V", node, level);
}

static const double supply = 1.1;

static void put_ramp(GString *deck, const char *net, int rises, double slew,
                     double middle) {
  double t[EDA_TIMING_RAMP], level[EDA_TIMING_RAMP];
  eda_timing_ramp_points(rises, t, level);
  double whole =
      slew / (eda_timing_ramp(rises, 0.7) - eda_timing_ramp(rises, 0.3));
  g_string_append_printf(deck, "v%s %s 0 pwl(0 %g", net, net,
                         rises ? 0 : supply);
  for (int i = 0; i < EDA_TIMING_RAMP; i++)
    g_string_append_printf(deck, " %.17g %.17g", middle + whole * (t[i] - 0.5),
                           supply * (rises ? level[i] : 1 - level[i]));
  g_string_append(deck, ")\n");
}

/* Return the start of a deck with devices, the supply node s and the output
   y. */
static GString *hand_deck(const char *devices) {
  g_autofree char *card = data("devices/opcflow65.pm");
  GString *deck = g_string_new(NULL);
  g_string_printf(deck,
                  "by hand\n.include \"%s\"\n.options reltol=1e-5 "
                  "abstol=1e-15 chgtol=1e-19\n%s\nvs s 0 1.1\n"
                  ".save v(y) v(b)\n",
                  card, devices);
  return deck;
}

/* Simulate devices with the input node b, a ramp with the shape of the library
   that rises or falls. Return the delay and the slew of the output. */
static void by_hand(const char *devices, int rises, double slew, double *delay,
                    double *out) {
  g_autoptr(GString) deck = hand_deck(devices);
  put_ramp(deck, "b", rises, slew, 5e-12 + 2 * slew);
  g_string_append(deck, ".end\n");
  eda_spice_result r = {0};
  opc_error error;
  if (eda_spice_run(NULL, deck->str, "tran 2e-13 2e-10 0 2e-13\n", 100, &r,
                    &error))
    g_error("%s", error.message);
  *delay = last_crossing(&r.plot[0], "v(y)", supply / 2) -
           last_crossing(&r.plot[0], "v(b)", supply / 2);
  *out = fabs(last_crossing(&r.plot[0], "v(y)", 0.7 * supply) -
              last_crossing(&r.plot[0], "v(y)", 0.3 * supply));
  eda_spice_clear(&r);
}

/* Simulate nand2 of data/cells65, from the text of its file, with the given W
   of MN1. */
static void nand_by_hand(double w, double slew, const char *load, double *delay,
                         double *out) {
  g_autofree char *devices = g_strdup_printf(
      "va a 0 1.1\nmn1 0 a x 0 nmos w=%.17g l=65n\n"
      "mn2 y b x 0 nmos w=400n l=65n\n"
      "mp1 y a s s pmos w=450n l=65n\nmp2 y b s s pmos "
      "w=450n l=65n\n%s",
      w, load);
  by_hand(devices, 1, slew, delay, out);
}

/* Return the derivative of the delay with respect to ln of a transistor size.
 */
static double moved_by(const eda_timing_cell *c, const eda_timing_arc *a,
                       const char *device, size_t size) {
  for (size_t i = 0; i < c->devices; i++)
    if (g_str_equal(c->device[i].name, device))
      return c->device[i].share *
             a->delay_by[c->device[i].bundle * EDA_SIZES + size];
  g_error("no %s", device);
}

static void test_delays(void) {
  g_autofree char *file = data("cells65/nand2.sp");
  eda_timing *t = run_well(file, "checks: 4, " GRID);
  const eda_timing_cell *c = &t->cell[0];
  /* Channel width at the output: 0.4 + 2 * 0.45 um. */
  close_to(c->at_load[1], 3e-15 * 1.3, 1e-12);
  const eda_timing_arc *a = arc(c, 1, 1); /* B rises while A is 1 */
  double d, s, wider, narrower, unused;
  nand_by_hand(400e-9, 15e-12, "cl y 0 3.9f", &d, &s);
  close_to(a->delay[1 * 3 + 1], d, 0.004);
  close_to(a->slew[1 * 3 + 1], s, 0.008);
  /* The first point of size changes is at 5 ps and 1 fF. */
  nand_by_hand(400e-9 * exp(0.02), 5e-12, "cl y 0 1.3f", &wider, &unused);
  nand_by_hand(400e-9 * exp(-0.02), 5e-12, "cl y 0 1.3f", &narrower, &unused);
  close_to(moved_by(c, a, "MN1", EDA_SIZE_W), (wider - narrower) / 0.04, 0.05);
  g_assert_cmpfloat(opc_test_metric("delay_error"), <, 3);
  g_assert_cmpfloat(opc_test_metric("delay_error"), >, 0);
  /* Replace the pin by the gate itself: the capacitance for delays must cause
     the same delay. */
  double pin = c->capacitance[(1 * 2 + 0) * EDA_CAPS + EDA_CAP_DELAY];
  g_autofree char *same = g_strdup_printf("cl y 0 %.17g", pin);
  double by_pin;
  nand_by_hand(400e-9, 5e-12, same, &by_pin, &unused);
  nand_by_hand(400e-9, 5e-12,
               "mq1 0 s z 0 nmos w=400n l=65n\nmq2 q y z 0 nmos w=400n "
               "l=65n\nmq3 q s s s pmos w=450n l=65n\n"
               "mq4 q y s s pmos w=450n l=65n\ncq q 0 3.9f",
               &d, &unused);
  close_to(by_pin, d, 0.03);
  eda_timing_free(t);
}

static const char oai21[] =
    "* cell\n.subckt oai21 A B1 B2 Z VDD VSS\n"
    "M1 Z B2 x VSS nmos W=0.415000U L=0.050000U\nM2 x B1 Z VSS nmos "
    "W=0.415000U L=0.050000U\n"
    "M3 VSS A x VSS nmos W=0.415000U L=0.050000U\nM4 y B2 VDD VDD pmos "
    "W=0.630000U L=0.050000U\n"
    "M5 Z B1 y VDD pmos W=0.630000U L=0.050000U\nM6 VDD A Z VDD pmos "
    "W=0.630000U L=0.050000U\n"
    ".ends\n";

/* Return the delay of Z, which rises as B2 falls, for a length of M4. A is 1,
   B1 is 0. */
static double oai_by_hand(double l) {
  g_autofree char *devices = g_strdup_printf(
      "m1 y b x 0 nmos w=539.5n l=65n\nm2 x 0 y 0 nmos w=539.5n l=65n\n"
      "m3 0 s x 0 nmos w=539.5n l=65n\nm4 z b s s pmos w=819n l=%.17g\n"
      "m5 y 0 z s pmos w=819n l=65n\nm6 s s y s pmos w=819n l=65n\n"
      "cl y 0 2.717f",
      l);
  double delay, slew;
  by_hand(devices, 0, 5e-12, &delay, &slew);
  return delay;
}

/* No supply is connected to the net between M4 and M5 before the change.
   Without first guesses, the simulator accepts -0.4 V there in some copies, and
   the derivative by the length is negative. */
static void test_floating(void) {
  g_autofree char *file = g_build_filename(opc_test_folder(), "oai.sp", NULL);
  g_assert_true(g_file_set_contents(file, oai21, -1, NULL));
  eda_timing *t = run_well(file, "scale: 1.3, " GRID);
  double up = oai_by_hand(65e-9 * exp(0.01));
  double by = (up - oai_by_hand(65e-9 * exp(-0.01))) / 0.02;
  const eda_timing_cell *c = eda_timing_find(t, "oai21");
  close_to(moved_by(c, arc(c, 2, 5), "M4", EDA_SIZE_L), by, 0.05);
  eda_timing_free(t);
}

/* ---- two inputs ---- */

/* Return the delay from the middle of the causing input to the middle of the
   output. Circuit: nand2; A changes with a slew of 12 ps, B changes `gap` later
   with a slew of 20 ps. */
static double both_by_hand(int rises, double gap) {
  const double middle = 60e-12;
  g_autoptr(GString) deck = hand_deck(
      "mn1 0 a x 0 nmos w=400n l=65n\nmn2 y b x 0 nmos w=400n l=65n\n"
      "mp1 y a s s pmos w=450n l=65n\nmp2 y b s s pmos w=450n l=65n\n"
      "cl y 0 3.9f");
  put_ramp(deck, "a", rises, 12e-12, middle);
  put_ramp(deck, "b", rises, 20e-12, middle + gap);
  g_string_append(deck, ".end\n");
  eda_spice_result r = {0};
  opc_error error;
  if (eda_spice_run(NULL, deck->str, "tran 2e-13 3e-10 0 2e-13\n", 100, &r,
                    &error))
    g_error("%s", error.message);
  double y = last_crossing(&r.plot[0], "v(y)", supply / 2);
  eda_spice_clear(&r);
  return y - middle - (rises ? gap : 0);
}

static double alone_at(const eda_timing_cell *c, const eda_timing_arc *a,
                       double slew) {
  double delay[5], out[5], cubic[16];
  eda_timing_at(c, a, 3.9e-15, 3.9e-15, NULL, delay, out);
  eda_timing_cubic(c->at_slew, delay, c->slews, cubic);
  return eda_timing_cubic_at(c->at_slew, cubic, c->slews, slew);
}

/* Both inputs of a NAND gate at slews and gaps between the simulated values.
   With tables of one input, the errors would be 20 % (rising) and 80 %
   (falling). */
static void test_pairs(void) {
  static const double gap[] = {0, 2e-12, 7e-12, 60e-12};
  g_autofree char *file = data("cells65/nand2.sp");
  eda_timing *t = run_well(file,
                           "slews: [5 ps, 10 ps, 15 ps, 22 ps, 40 ps], "
                           "loads: [1 fF, 3 fF, 9 fF]");
  const eda_timing_cell *c = &t->cell[0];
  g_assert_cmpuint(c->pairs, ==, 4);
  for (int rises = 0; rises < 2; rises++) {
    /* A is the first input; initially, both inputs are 0 or 1. */
    const eda_timing_pair *p = &c->pair[c->pair_of[1 << 2 | (rises ? 0 : 3)]];
    g_assert_cmpint(p->first, ==, 0);
    g_assert_cmpint(p->parallel, ==, !rises);
    double a = alone_at(c, arc(c, 0, rises ? 2 : 3), 12e-12),
           b = alone_at(c, arc(c, 1, rises ? 1 : 3), 20e-12),
           cause = rises ? b : a;
    for (size_t k = 0; k < G_N_ELEMENTS(gap); k++) {
      double delay, slew, at = gap[k] / cause;
      eda_timing_pair_at(p, at, 12e-12 / a, 20e-12 / b, &delay, &slew);
      double ours = delay * eda_timing_blend(at, cause, rises ? a : b);
      close_to(ours, both_by_hand(rises, gap[k]), 0.015);
    }
  }
  eda_timing_free(t);
}

/* ---- equivalent transistors ---- */

/* A NAND gate with two fingers per transistor and separate nets for the stacks,
   and a NAND gate with single fingers in another order. The values of both must
   be equal. */
static const char fingers[] =
    "* cells\n"
    ".subckt two A B Z VDD VSS\n"
    "M1 VDD B Z VDD pmos w=350n l=65n\nM2 Z B VDD VDD pmos w=350n l=65n\n"
    "M3 Z A VDD VDD pmos w=350n l=65n\nM4 VDD A Z VDD pmos w=350n l=65n\n"
    "M5 Z B x VSS nmos w=300n l=65n\nM6 x A VSS VSS nmos w=300n l=65n\n"
    "M7 VSS A y VSS nmos w=300n l=65n\nM8 y B Z VSS nmos w=300n l=65n\n"
    ".ends\n.subckt one A B Z VDD VSS\n"
    "M1 Z B x VSS nmos w=300n l=65n\nM2 x A VSS VSS nmos w=300n l=65n\n"
    "M3 Z A VDD VDD pmos w=350n l=65n\nM4 Z B VDD VDD pmos w=350n l=65n\n"
    /* The stacks differ, so no two transistors are equivalent. */
    ".ends\n.subckt odd A B Z VDD VSS\n"
    "M1 Z B x VSS nmos w=300n l=65n\nM2 x A VSS VSS nmos w=300n l=65n\n"
    "M3 Z B y VSS nmos w=300n l=65n\nM4 y A VSS VSS nmos w=310n l=65n\n"
    "M5 Z A VDD VDD pmos w=350n l=65n\nM6 Z B VDD VDD pmos w=350n l=65n\n"
    ".ends\n";

/* Simulate `two` without reduction, with another width of one transistor in one
   stack. */
static double two_by_hand(double w) {
  double delay, slew;
  g_autofree char *devices = g_strdup_printf(
      "va a 0 1.1\nm1 s b y s pmos w=350n l=65n\n"
      "m2 y b s s pmos w=350n l=65n\nm3 y a s s pmos w=350n l=65n\n"
      "m4 s a y s pmos w=350n l=65n\nm5 y b n1 0 nmos w=%.17g l=65n\n"
      "m6 n1 a 0 0 nmos w=300n l=65n\nm7 0 a n2 0 nmos w=300n l=65n\n"
      "m8 n2 b y 0 nmos w=300n l=65n\ncl y 0 2f",
      w);
  by_hand(devices, 1, 5e-12, &delay, &slew);
  return delay;
}

static void test_fingers(void) {
  g_autofree char *file = g_build_filename(opc_test_folder(), "two.sp", NULL);
  g_assert_true(g_file_set_contents(file, fingers, -1, NULL));
  keep_in("two");
  eda_timing *t = run_well(file, GRID);
  keep_in("");
  const eda_timing_cell *one = eda_timing_find(t, "one"),
                        *two = eda_timing_find(t, "two"),
                        *odd = eda_timing_find(t, "odd");
  g_assert_cmpfloat(opc_test_metric("kept"), ==, 1);
  g_assert_cmpuint(one->bundles, ==, 4);
  g_assert_cmpuint(two->bundles, ==, 4);
  g_assert_cmpuint(odd->bundles, ==, 6);
  const eda_timing_arc *a = arc(two, 1, 1), *b = arc(one, 1, 1);
  for (size_t i = 0; i < 9; i++)
    g_assert_cmpfloat(a->delay[i], ==, b->delay[i]);
  for (size_t i = 0; i < 3; i++)
    close_to(two->at_load[i], 2 * one->at_load[i], 1e-12);
  for (size_t i = 0; i < 2 * 2 * EDA_CAPS; i++)
    g_assert_cmpfloat(two->capacitance[i], ==, 2 * one->capacitance[i]);
  /* 1 fF for each um of 2 * 0.3 + 4 * 0.35. */
  close_to(two->at_load[0], 2e-15, 1e-12);
  close_to(a->delay[0], two_by_hand(300e-9), 0.004);
  double by_hand =
      (two_by_hand(300e-9 * exp(0.03)) - two_by_hand(300e-9 * exp(-0.03))) /
      0.06;
  close_to(moved_by(two, a, "M5", EDA_SIZE_W), by_hand, 0.05);
  eda_timing_free(t);
}

/* Simulate aoi21 while A rises and Z falls. B1 is 0, so M2 is off; B2 is 1, so
   M3 connects its capacitance. */
static double off_by_hand(double w2, double l2, double w3) {
  double delay, slew;
  g_autofree char *devices = g_strdup_printf(
      "m1 y b 0 0 nmos w=400n l=65n\nm2 x 0 y 0 nmos w=%.17g l=%.17g\n"
      "m3 0 s x 0 nmos w=%.17g l=65n\nm4 q b s s pmos w=600n l=65n\n"
      "m5 y 0 q s pmos w=600n l=65n\nm6 q s y s pmos w=600n l=65n\n"
      "cl y 0 2f",
      w2, l2, w3);
  by_hand(devices, 1, 5e-12, &delay, &slew);
  return delay;
}

/* A transistor that is off acts as a capacitance: its width has an effect, its
   length has none. If its nets do not change, neither has an effect. */
static void test_off(void) {
  const eda_timing_cell *c = eda_timing_find(more_characterized(), "aoi21");
  const eda_timing_arc *a = arc(c, 0, 4);
  double up = exp(0.02), down = exp(-0.02);
  close_to(c->at_load[0], 2e-15, 1e-12);
  close_to(a->delay[0], off_by_hand(400e-9, 65e-9, 400e-9), 0.004);
  double w = (off_by_hand(400e-9 * up, 65e-9, 400e-9) -
              off_by_hand(400e-9 * down, 65e-9, 400e-9)) /
             0.04,
         l = (off_by_hand(400e-9, 65e-9 * up, 400e-9) -
              off_by_hand(400e-9, 65e-9 * down, 400e-9)) /
             0.04,
         w3 = (off_by_hand(400e-9, 65e-9, 400e-9 * up) -
               off_by_hand(400e-9, 65e-9, 400e-9 * down)) /
              0.04;
  /* The delay is 11 ps; the effect of w is 7 %, of l 0.2 %, of w3 less. */
  close_to(moved_by(c, a, "M2", EDA_SIZE_W) + moved_by(c, a, "M2b", EDA_SIZE_W),
           w, 0.05);
  g_assert_cmpfloat(moved_by(c, a, "M2", EDA_SIZE_L), ==, 0);
  g_assert_cmpfloat(fabs(l), <, 0.002 * a->delay[0]);
  g_assert_cmpfloat(moved_by(c, a, "M3", EDA_SIZE_W), ==, 0);
  g_assert_cmpfloat(fabs(w3), <, 0.002 * a->delay[0]);
  /* A conducting transistor has an effect even if its gate does not change. */
  g_assert_cmpfloat(fabs(moved_by(c, a, "M5", EDA_SIZE_L)), >, 0);
}

/* ---- kept ---- */

static void test_kept(void) {
  g_autofree char *file = data("cells65/inverter.sp");
  keep_in("kept");
  eda_timing *first = run_well(file, GRID);
  g_assert_cmpfloat(opc_test_metric("kept"), ==, 0);
  g_assert_cmpfloat(opc_test_metric("simulated"), >, 0);
  eda_timing *again = run_well(file, GRID);
  g_assert_cmpfloat(opc_test_metric("kept"), ==, 1);
  g_assert_cmpfloat(opc_test_metric("simulated"), ==, 0);
  const eda_timing_cell *a = &first->cell[0], *b = &again->cell[0];
  g_assert_cmpmem(a->figure, a->figures * sizeof(double), b->figure,
                  b->figures * sizeof(double));
  eda_timing_free(again);
  again = run_well(file, "temperature: 28 C, " GRID);
  g_assert_cmpfloat(opc_test_metric("kept"), ==, 0);
  eda_timing_free(again);
  eda_timing_free(first);
}

/* An empty OPCFLOW_STORE stores nothing, in particular not in ./timing. */
static void test_unkept(void) {
  g_autofree char *file = data("cells65/inverter.sp");
  g_autofree char *before = g_get_current_dir();
  keep_in("");
  g_assert_cmpint(g_chdir(opc_test_folder()), ==, 0);
  for (int i = 0; i < 2; i++) {
    eda_timing_free(run_well(file, GRID));
    g_assert_cmpfloat(opc_test_metric("kept"), ==, 0);
  }
  g_assert_false(g_file_test("timing", G_FILE_TEST_EXISTS));
  g_assert_cmpint(g_chdir(before), ==, 0);
}

/* ---- standard deviations by line edges ---- */

static const double w_of[2] = {400, 600};

/* Write an inverter with the given lengths of n and p, nm, and run the step. */
static eda_timing *inverter_run(double n, double p, const char *more) {
  g_autofree char *file = g_build_filename(opc_test_folder(), "i.sp", NULL);
  g_autofree char *text = g_strdup_printf(
      ".subckt inv A Z VDD VSS\nM1 Z A VSS VSS nmos w=%gn l=%.6fn\n"
      "M2 Z A VDD VDD pmos w=%gn l=%.6fn\n.ends\n",
      w_of[0], n, w_of[1], p);
  g_assert_true(g_file_set_contents(file, text, -1, NULL));
  g_autofree char *words = g_strdup_printf(GRID "%s", more);
  return run_well(file, words);
}

/* Return value number k of the first table `name` of the Liberty file, s. */
static double liberty_value(const char *text, const char *name, size_t k) {
  const char *at = strstr(text, name);
  if (!at) g_error("the Liberty file has no table '%s'", name);
  at = strchr(strstr(at, "values ("), '"') + 1;
  for (size_t i = 0; i < k; i++) {
    at += strcspn(at, ",") + 1;
    at += strspn(at, " \\\n\"");
  }
  return atof(at) * 1e-9;
}

/* Read the Liberty file with OpenSTA; no warnings are expected. */
static void liberty_read(const char *path) {
  g_autofree char *there = g_find_program_in_path("sta");
  if (!there) {
    g_test_message("not read by OpenSTA: sta is not installed");
    return;
  }
  g_autofree char *script = g_build_filename(opc_test_folder(), "s.tcl", NULL);
  g_autofree char *text = g_strdup_printf(
      "read_liberty %s\nputs \"cell [get_property [get_lib_cells */inv] "
      "name]\"\nexit\n",
      path);
  g_assert_true(g_file_set_contents(script, text, -1, NULL));
  const char *const argv[] = {"sta", "-no_splash", "-exit", script, NULL};
  g_autofree char *out = NULL;
  g_autofree char *words = NULL;
  g_assert_true(g_spawn_sync(NULL, (char **)argv, NULL, G_SPAWN_SEARCH_PATH,
                             NULL, NULL, &out, &words, NULL, NULL));
  if (!strstr(out, "cell inv") || strstr(out, "Warning") ||
      strstr(out, "Error") || strstr(words, "Warning") ||
      strstr(words, "Error"))
    g_error("OpenSTA: %s %s", out, words);
}

/* Compare the standard deviations in the Liberty file with the differences of
   delays of inverters with other lengths, times the standard deviation of the
   mean length. For an exponential covariance, the variance of the mean over the
   width w is 2 sigma^2 2 (w l - l^2 (1 - exp(-w / l))) / w^2. */
static void test_line_edges(void) {
  const double step = 0.65, l = 25, sigma = 1.3;
  eda_timing *at = inverter_run(65, 65, ", line_edges.sigma: 1.3 nm");
  g_autofree char *path =
      g_build_filename(opc_test_folder(), "cells.lib", NULL);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  liberty_read(path);
  eda_timing *n = inverter_run(65 + step, 65, "");
  eda_timing *p = inverter_run(65, 65 + step, "");
  int points = 0;
  for (uint32_t from = 0; from < 2; from++) {
    const char *names[2] = {"ocv_sigma_cell_rise", "ocv_sigma_rise_transition"};
    if (!from) { /* the input rises */
      names[0] = "ocv_sigma_cell_fall";
      names[1] = "ocv_sigma_fall_transition";
    }
    for (size_t k = 0; k < 9; k++) {
      double variance[2] = {0};
      for (int d = 0; d < 2; d++) {
        const eda_timing_arc *a = arc(&at->cell[0], 0, from);
        const eda_timing_arc *b = arc(&(d ? p : n)->cell[0], 0, from);
        double w = w_of[d],
               share = 2 * (w * l - l * l * (1 - exp(-w / l))) / (w * w);
        double each = 2 * sigma * sigma * share / (step * step);
        variance[0] += each * pow(b->delay[k] - a->delay[k], 2);
        variance[1] += each * pow(b->slew[k] - a->slew[k], 2);
      }
      /* The changes are a plane through three of these points. */
      const eda_timing_cell *c = &at->cell[0];
      size_t i = k / c->loads == c->near_slew[1],
             j = k % c->loads == c->near_load[1];
      int simulated = (i || k / c->loads == c->near_slew[0]) &&
                      (j || k % c->loads == c->near_load[0]) && i + j < 2;
      points += simulated;
      for (int q = 0; q < 2 && simulated; q++)
        close_to(liberty_value(text, names[q], k), sqrt(variance[q]), 0.06);
    }
  }
  g_assert_cmpint(points, ==, 6);
  eda_timing_free(at);
  eda_timing_free(n);
  eda_timing_free(p);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/characterize/logic", test_logic);
  g_test_add_func("/characterize/delays", test_delays);
  g_test_add_func("/characterize/floating", test_floating);
  g_test_add_func("/characterize/pairs", test_pairs);
  g_test_add_func("/characterize/fingers", test_fingers);
  g_test_add_func("/characterize/off", test_off);
  g_test_add_func("/characterize/kept", test_kept);
  g_test_add_func("/characterize/unkept", test_unkept);
  g_test_add_func("/characterize/line_edges", test_line_edges);
  return g_test_run();
}
