/* SPDX-License-Identifier: BSD-3-Clause */
/* One printed gate in artificial fields: its flags, and its dimensions compared
   with closed forms. */
#include "gates/gate.h"

#include <eda/imaging.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>

#include "testing/testing.h"

static const opc_context *context; /* a context with several threads */

/* Nodes of a fine grid with a period of 1200 nm, which samples `f`. */
enum { NODES = 120 };
static const double step = 10, corner = -600;
typedef double level(double l, double w);

static eda_field field(level *f, int across) {
  eda_field out = {.frame = {corner, corner, step * NODES, step * NODES},
                   .nx = NODES,
                   .ny = NODES};
  out.coefficients = eda_alloc((size_t)NODES * NODES, sizeof(float));
  for (int j = 0; j < NODES; j++)
    for (int i = 0; i < NODES; i++) {
      double x = corner + step * i, y = corner + step * j;
      out.coefficients[j * NODES + i] = (float)(across ? f(y, x) : f(x, y));
    }
  eda_field_from_samples(context, &out);
  return out;
}

typedef struct result {
  uint32_t flags;
  double from, to, extension[2], length[41];
} result;

/* Measure a gate of L 60 and W 300 around (0, 0) that ends 80 nm beyond the
   active at its low side and has `space` beside it. */
static result gate_measure(level *poly, level *active, double space,
                           int across) {
  eda_box box =
      across ? (eda_box){-150, -30, 150, 30} : (eda_box){-30, -150, 30, 150};
  uint8_t type = EDA_NMOS, axis = across ? EDA_Y : EDA_X;
  double both[2] = {space, space}, extension[2] = {80, INFINITY};
  double length = 60.3, width = 299.6; /* drawn size, before snapping to the
                                          grid */
  const eda_gates gates = {.grid = 1,
                           .count = 1,
                           .box = &box,
                           .type = &type,
                           .axis = &axis,
                           .length = &length,
                           .width = &width,
                           .space = both,
                           .extension = extension};
  eda_field print[2] = {field(poly, across), field(active, across)};
  eda_gate gate;
  result r;
  eda_gate_measure(&gates, 0, print, &gate);
  double place[41], none[2];
  for (int k = 0; k <= 40; k++) place[k] = k / 40.0;
  eda_gate_lengths(&gate, 41, place, r.length);
  eda_gate_lengths(&gate, 2, (double[]){-0.1, NAN}, none);
  g_assert_true(isnan(none[0]) && isnan(none[1]));
  g_assert_cmpfloat(gate.shown.length(&gate.shown, 0.5), ==, r.length[20]);
  g_assert_cmpfloat(gate.shown.design_length, ==, length);
  g_assert_cmpfloat(gate.shown.design_width, ==, width);
  r.flags = gate.flags;
  r.from = gate.from;
  r.to = gate.to;
  for (int side = 0; side < 2; side++) r.extension[side] = gate.extension[side];
  eda_field_clear(&print[0]);
  eda_field_clear(&print[1]);
  return r;
}

/* ---- level sets: positive inside, with slopes that the grid resolves ---- */

static double within(double x, double half) {
  return (half * half - x * x) / (half * half + x * x);
}
static double bump(double x, double y, double radius) {
  return exp(-(x * x + y * y) / (radius * radius));
}

static double line(double l, double w) { return (void)w, within(l, 30); }
static double stripe(double l, double w) { return (void)l, within(w, 150); }

/* Return the level of an active whose lower edge slopes down to the right by
   0.2. */
static double sloped(double l, double w) {
  double low = -150 - 0.2 * l, half = (150 - low) / 2;
  return within(w - (150 + low) / 2, half);
}
/* Return the level of a round active, a disk. */
static double disk(double l, double w) { return within(hypot(l - 20, w), 90); }
static double nothing(double l, double w) { return (void)l, (void)w, -1; }
static double everything(double l, double w) { return (void)l, (void)w, 1; }
/* Return the level of a line with a round end at w = `end`, of constant length
   far from the end. */
static double rounded(double l, double w, double end) {
  return 1 - l * l / 900 - fmin(3, exp((end - w) / 40));
}
static double ended(double l, double w) { return rounded(l, w, -190); }
static double ended_early(double l, double w) { return rounded(l, w, -120); }
/* Return the level of a line with a gap at w = 60. */
static double gap(double l, double w) {
  return within(l, 30) - 2.2 * bump(0, w - 60, 40);
}
/* Return the level of a line with about half the length at w = 60 (waist), or
   three times the length at 0 (belly). */
static double waist(double l, double w) {
  return within(l, 30 - 14 * bump(0, w - 60, 40));
}
static double belly(double l, double w) {
  return within(l, 30 + 60 * bump(0, w, 60));
}
/* Return the level of a line with a hole beside the middle, which splits the
   line into two pieces. */
static double hole(double l, double w) {
  return within(l, 30) - 1.6 * bump(l - 13, w - 60, 9);
}
/* Return the level of an active of two islands, one of which is in the
   middle. */
static double islands(double l, double w) {
  (void)l;
  return fmax(within(w, 60), within(w + 120, 20));
}
/* Return the level of a line whose edges are beyond half of the space of 100
   nm. */
static double fat(double l, double w) { return (void)w, within(l, 81); }

/* Return the level of a line with one edge beyond half of the space of 100 nm
   and the other edge within. */
static double high(double l, double w) { return (void)w, within(l - 26, 55); }
static double low(double l, double w) { return (void)w, within(l + 26, 55); }
static double high_less(double l, double w) {
  return (void)w, within(l - 26, 53);
}
static double low_less(double l, double w) {
  return (void)w, within(l + 26, 53);
}

static void test_good(void) {
  for (int across = 0; across < 2; across++) {
    result r = gate_measure(line, stripe, 400, across);
    g_assert_cmphex(r.flags, ==, 0);
    g_assert_cmpfloat(fabs(r.from + 150), <, 0.01);
    g_assert_cmpfloat(fabs(r.to - 150), <, 0.01);
    for (int k = 0; k <= 40; k++)
      g_assert_cmpfloat(fabs(r.length[k] - 60), <, 0.05);
    r = gate_measure(ended, stripe, 400, across);
    g_assert_cmphex(r.flags & ~(uint32_t)EDA_PRINT_NOTES, ==, 0);
    g_assert_cmpfloat(fabs(r.extension[0] - 40), <, 0.05);
    double want = 60 * sqrt(1 - exp(-1)); /* expected length at the edge of the
                                             active */
    g_assert_cmpfloat(fabs(r.length[0] - want), <, 0.05);
    g_assert_true(isinf(r.extension[1]));
  }
}

/* For a sloping edge, the mean over the channel equals the edge in the middle;
   the slope sets no flag. For a disk, the mean equals the mean of a circle. */
static void test_width(void) {
  for (int across = 0; across < 2; across++) {
    result r = gate_measure(line, sloped, 400, across);
    g_assert_cmphex(r.flags, ==, 0);
    g_assert_cmpfloat(fabs(r.from + 150), <, 0.05);
    g_assert_cmpfloat(fabs(r.to - 150), <, 0.05);
    r = gate_measure(line, disk, 400, across);
    double area = 0;
    enum { STEPS = 6000 };
    for (int i = 0; i < STEPS; i++) {
      double l = -30 + 60 * (i + 0.5) / STEPS - 20;
      area += 2 * sqrt(90 * 90 - l * l) / STEPS;
    }
    g_test_message("a disk: %.3f nm, mean chord %.3f nm", r.to - r.from, area);
    g_assert_cmpfloat(fabs(r.to - r.from - area), <, 0.5);
    g_assert_cmphex(r.flags & EDA_PRINT_NOTCH, ==, EDA_PRINT_NOTCH);
  }
}

static void test_flags(void) {
  static const struct {
    level *poly, *active;
    double capacity;
    uint32_t must, may;
  } cases[] = {
      {nothing, stripe, 400, EDA_PRINT_OPEN, EDA_PRINT_SHORT | EDA_PRINT_NECK},
      {gap, stripe, 400, EDA_PRINT_OPEN, EDA_PRINT_NECK},
      {line, nothing, 400, EDA_PRINT_NO_ACTIVE, 0},
      {fat, stripe, 100, EDA_PRINT_MERGED, EDA_PRINT_WIDE},
      {fat, stripe, 400, EDA_PRINT_WIDE, 0},
      {high, stripe, 100, EDA_PRINT_MERGED, 0},
      {low, stripe, 100, EDA_PRINT_MERGED, 0},
      {high_less, stripe, 100, 0, 0},
      {low_less, stripe, 100, 0, 0},
      {everything, stripe, 400, EDA_PRINT_MERGED, EDA_PRINT_WIDE},
      {line, everything, 400, EDA_PRINT_MERGED, 0},
      {ended_early, stripe, 400, EDA_PRINT_SHORT | EDA_PRINT_OPEN,
       EDA_PRINT_NECK},
      {hole, stripe, 400, EDA_PRINT_ISLAND, EDA_PRINT_NECK},
      {line, islands, 400, EDA_PRINT_ISLAND, 0},
      {waist, stripe, 400, EDA_PRINT_NECK, 0},
      {belly, stripe, 800, EDA_PRINT_WIDE, 0},
      {line, disk, 400, EDA_PRINT_NOTCH, 0},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    for (int across = 0; across < 2; across++) {
      result r = gate_measure(cases[i].poly, cases[i].active, cases[i].capacity,
                              across);
      if ((r.flags & cases[i].must) != cases[i].must ||
          r.flags & ~(cases[i].must | cases[i].may))
        g_error("case %zu, %d: flags %#x, not %#x", i, across, r.flags,
                cases[i].must);
    }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  context = eda_test_context_new(4);
  g_test_add_func("/gate/good", test_good);
  g_test_add_func("/gate/width", test_width);
  g_test_add_func("/gate/flags", test_flags);
  int failed = g_test_run();
  eda_test_context_free(context);
  return failed;
}
