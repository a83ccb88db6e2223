/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares noise margins with squares from another algorithm, and with noise
   sources raised until the cell flips; and write margins, read currents and
   leakage with transients in a hand-written deck. */
#include <eda/samples.h>

#include "circuit_test.h"

/* ---- reference: noise margins by squares ---- */

/* The largest square is found by bisection: for each point of one curve, find
   the square whose opposite corner is on the other curve. `f` decreases with x,
   `g` with y. Both curves have n equidistant points. */
static double at(const double *curve, size_t n, double step, double x) {
  double place = x / step;
  size_t i = place < 0 ? 0 : (size_t)place;
  if (i > n - 2) i = n - 2;
  return curve[i] + (place - (double)i) * (curve[i + 1] - curve[i]);
}

/* Return the largest square with the lower left corner on x = g(y), above the
   diagonal, and the upper right corner on y = f(x). */
static double largest_square(const double *f, const double *g, size_t n,
                             double step) {
  double best = 0, most = step * (double)(n - 1);
  for (size_t j = 0; j < n; j++) {
    double y = step * (double)j, x = g[j], low = 0, high = most;
    if (at(f, n, step, x) <= y || x > y) continue;
    for (int i = 0; i < 50; i++) {
      double side = (low + high) / 2;
      if (x + side < most && at(f, n, step, x + side) > y + side)
        low = side;
      else
        high = side;
    }
    best = fmax(best, low);
  }
  return best;
}

/* Read a curve written by `wrdata`: x, then the value. */
static double *read_curve(const char *name, size_t column, size_t *count) {
  g_autofree char *path = g_build_filename(opc_test_folder(), name, NULL);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  g_auto(GStrv) lines = g_strsplit(g_strchomp(text), "\n", -1);
  *count = g_strv_length(lines);
  double *out = g_new0(double, *count);
  for (size_t i = 0; i < *count; i++) {
    char *place = lines[i];
    for (size_t k = 0; k < 2 * column + 2; k++)
      out[i] = g_ascii_strtod(place, &place);
  }
  return out;
}

/* Return a deck with both transfer curves. The deck also has the cell with a
   noise source before one of the inverters. The noise at which the state flips
   is the margin. */
static char *memory_deck(const char *card, const char *word, const char *data,
                         const double margin[2]) {
  /* Steps of 0.25 mV, starting far below the margin: a sweep that starts above
     the margin finds no flip. */
  return g_strdup_printf(
      "by hand\n.include \"%s\"\nvs s 0 1.1\nvin in 0 0\nvn n 0 0\nvm m 0 0\n"
      ".subckt left in out s\nma out %s s 0 nmos w=140n l=65n\n"
      "md out in 0 0 nmos w=300n l=65n\nml out in s s pmos w=105n "
      "l=65n\n.ends\n"
      ".subckt right in out s\nma out %s s 0 nmos w=140n l=65n\n"
      "md out in 0 0 nmos w=330n l=65n\nml out in s s pmos w=160n "
      "l=65n\n.ends\n"
      /* Q as a function of QB, QB as a function of Q */
      "x1 in q0 s left\nx2 in qb0 s right\n"
      /* One cell holds Q high and the other Q low, with noise of the opposite
         sign. */
      "x3 g1 q1 s left\nx4 g2 qb1 s right\n"
      "e1 g1 qb1 n 0 1\ne2 q1 g2 n 0 1\n.nodeset v(q1)=1.1 v(qb1)=0\n"
      "x5 g3 q2 s left\nx6 g4 qb2 s right\n"
      "e3 qb2 g3 m 0 1\ne4 g4 q2 m 0 1\n.nodeset v(q2)=0 v(qb2)=1.1\n"
      ".options gmin=1e-15 reltol=1e-5 abstol=1e-15\n"
      ".control\nset num_threads=1\nset numdgt=12\ndc vin 0 1.101 "
      "0.002\nwrdata %s v(qb0) v(q0)\n"
      /* Separate sweeps: after a cell flips, the solver restarts, and all cells
         may flip. */
      "dc vn %g %g 0.00025\n"
      "meas dc right find v(n) when v(q1)=v(qb1)\ndc vm %g %g 0.00025\n"
      "meas dc left find v(m) when v(q2)=v(qb2)\n.endc\n.end\n",
      card, word, word, data, margin[1] - 0.03, margin[1] + 0.01,
      margin[0] - 0.03, margin[0] + 0.01);
}

static void compare_margins(const char *card, const char *access,
                            const char *word) {
  static const char *const sides[] = {"left", "right"};
  g_autoptr(made) m = circuit_make(MEMORY_PORTS, MEMORY);
  g_autofree char *rest = g_strdup_printf("access: %s", access);
  circuit_run(m, 1, card, rest);
  g_assert_cmpstr(opc_test_log(), ==, "");
  double margin[] = {opc_test_metric("snm_left") / 1000,
                     opc_test_metric("snm_right") / 1000};
  g_autofree char *deck = memory_deck(card, word, "curves.txt", margin);
  g_autofree char *hand = by_hand(deck);
  size_t n;
  if (!hand) return;
  g_autofree double *f = read_curve("curves.txt", 0, &n);
  g_autofree double *g = read_curve("curves.txt", 1, &n);
  double square[] = {largest_square(f, g, n, 0.002),
                     largest_square(g, f, n, 0.002)};
  g_assert_cmpfloat(fabs(square[0] / square[1] - 1), >, 0.01);
  for (int i = 0; i < 2; i++) {
    g_autofree char *metric = g_strdup_printf("snm_%s", sides[i]);
    double got = opc_test_metric(metric);
    double flip = 1000 * printed_value(hand, sides[i]);
    g_test_message("%s, %s: %.3f mV, square %.3f mV, flips at %.3f mV", access,
                   sides[i], got, 1000 * square[i], flip);
    g_assert_cmpfloat(fabs(got - 1000 * square[i]), <, 0.1);
    g_assert_cmpfloat(fabs(got - flip), <, 1.0);
    g_autofree char *after = g_strdup_printf("snm_%s_worst", sides[i]);
    g_assert_cmpfloat(opc_test_metric(after), <, 1e-6);
  }
}

static void test_margins(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  compare_margins(card, "hold", "0");
  compare_margins(card, "read", "s");
}

/* In a cell that is almost lost when it is read, the curves cross five times.
   The margins are those of the outer states. */
static void test_five_crossings(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m =
      circuit_make(MEMORY_PORTS,
                   "MA1 Q WL BL VSS n 65 370,MD1 Q QB VSS VSS n 65 600,"
                   "ML1 Q QB VDD VDD p 65 300,MA2 QB WL BLB VSS n 65 370,"
                   "MD2 QB Q VSS VSS n 65 600,ML2 QB Q VDD VDD p 65 300");
  circuit_run(m, 0, card, "access: read");
  g_autofree char *deck = g_strdup_printf(
      "by hand\n.include \"%s\"\nvs s 0 1.1\nvin in 0 0\n"
      "ma out s s 0 nmos w=370n l=65n\nmd out in 0 0 nmos w=600n l=65n\n"
      "ml out in s s pmos w=300n l=65n\n"
      ".options gmin=1e-15 reltol=1e-5 abstol=1e-15\n.control\n"
      "set numdgt=12\ndc vin 0 1.101 0.002\nwrdata five.txt v(out)\n"
      ".endc\n.end\n",
      card);
  g_autofree char *hand = by_hand(deck);
  size_t n, crossings = 0;
  if (!hand) return;
  g_autofree double *f = read_curve("five.txt", 0, &n);
  for (size_t i = 1; i < n; i++)
    crossings += (at(f, n, 0.002, f[i]) > 0.002 * (double)i) !=
                 (at(f, n, 0.002, f[i - 1]) > 0.002 * (double)(i - 1));
  g_assert_cmpuint(crossings, ==, 5);
  double square = 1000 * largest_square(f, f, n, 0.002);
  g_assert_cmpfloat(fabs(opc_test_metric("snm_left") - square), <, 0.1);
  g_assert_cmpfloat(fabs(opc_test_metric("snm_right") - square), <, 0.1);
}

/* Other devices of the circuit do not change the margins of a memory cell. A
   mirrored cell has mirrored margins. A cell that is not bistable has margin 0.
 */
static void test_cells(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m = circuit_make(MEMORY_PORTS, MEMORY);
  m->leq[1][1] = 70;
  circuit_run(m, 1, card, "access: hold, cell: qb");
  double left = opc_test_metric("snm_left"),
         right = opc_test_metric("snm_right");
  g_assert_cmpfloat(opc_test_metric("cells"), ==, 1);
  g_assert_cmpfloat(opc_test_metric("snm_left_worst"), >, 0.1);
  g_assert_cmpfloat(opc_test_metric("snm_left_worst_before"), <, 1e-6);
  g_autoptr(made) behind = circuit_make(
      MEMORY_PORTS,
      "MP0 X WL VDD VDD p 65 400,MN0 X WL VSS VSS n 65 200," MEMORY);
  circuit_run(behind, 0, card, "access: hold");
  assert_near("left", opc_test_metric("snm_left"), left, 1e-6);
  g_autoptr(made) turned =
      circuit_make(MEMORY_PORTS,
                   "MA2 QB WL BLB VSS n 65 140,MA1 Q WL BL VSS n 65 140,"
                   "MD1 Q QB VSS VSS n 65 300,ML1 VDD QB Q VDD p 65 105,"
                   "MD2 VSS Q QB VSS n 65 330,ML2 QB Q VDD VDD p 65 160");
  circuit_run(turned, 0, card, "access: hold");
  assert_near("left", opc_test_metric("snm_left"), right, 1e-6);
  assert_near("right", opc_test_metric("snm_right"), left, 1e-6);
  g_autoptr(made) weak =
      circuit_make(MEMORY_PORTS,
                   "MA1 Q WL BL VSS n 65 900,MD1 Q QB VSS VSS n 65 120,"
                   "ML1 Q QB VDD VDD p 65 105,MA2 QB WL BLB VSS n 65 900,"
                   "MD2 QB Q VSS VSS n 65 120,ML2 QB Q VDD VDD p 65 105");
  circuit_run(weak, 0, card, "access: read");
  g_assert_cmpfloat(opc_test_metric("snm_left"), ==, 0);
  g_assert_nonnull(strstr(opc_test_log(), "1 of 1 cells do not hold both"));
}

/* The bit line of each side falls from 1.1 V within 1 ms, beginning at 1 us.
   Cells x1 and x2 are read and written, x3 and x4 are at rest. Q is high in x1
   and x3. */
static const char access_deck[] =
    "by hand\n.include \"%s\"\nvs s 0 1.1\n"
    ".subckt mem q qb wl bl blb s\n"
    "ma1 q wl bl 0 nmos w=140n l=65n\nma2 qb wl blb 0 nmos w=140n l=65n\n"
    "md1 q qb 0 0 nmos w=300n l=65n\nmd2 qb q 0 0 nmos w=330n l=65n\n"
    "ml1 q qb s s pmos w=105n l=65n\nml2 qb q s s pmos w=160n l=65n\n.ends\n"
    "vb b 0 pwl(0 1.1 1u 1.1 1001u 0)\n"
    "va s a 0\nx1 q1 qb1 s b a s mem\n"
    "vc s c 0\nx2 q2 qb2 s c b s mem\n"
    "vd s d 0\nx3 q3 qb3 0 d d d mem\n"
    "ve s e 0\nx4 q4 qb4 0 e e e mem\n"
    ".ic v(q1)=1.1 v(qb1)=0 v(q2)=0 v(qb2)=1.1\n"
    "+ v(q3)=1.1 v(qb3)=0 v(q4)=0 v(qb4)=1.1\n"
    ".options gmin=1e-15 reltol=1e-5 abstol=1e-15\n"
    ".control\ntran 100n 1001u 0 100n\n"
    "meas tran write0 find v(b) when v(q1)=v(qb1)\n"
    "meas tran write1 find v(b) when v(q2)=v(qb2)\n"
    "meas tran read1 find i(va) at=0.9u\nmeas tran read0 find i(vc) at=0.9u\n"
    "meas tran rest0 find i(vd) at=0.9u\nmeas tran rest1 find i(ve) at=0.9u\n"
    ".endc\n.end\n";

static void test_access(void) {
  /* Rows of the table: figure and side; scale to V and A. */
  static const struct {
    const char *name;
    double unit, share;
  } figure[] = {
      {"write", 1e-3, 1e-3}, {"read", 1e-6, 1e-5}, {"rest", 1e-12, 1e-3}};
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m = circuit_make(MEMORY_PORTS, MEMORY);
  circuit_run(m, 0, card, "measure: cell");
  g_autofree char *deck = g_strdup_printf(access_deck, card);
  g_autofree char *hand = by_hand(deck);
  if (!hand) return;
  for (size_t k = 0; k < 3; k++)
    for (size_t side = 0; side < 2; side++) {
      g_autofree char *name = g_strdup_printf("%s%zu", figure[k].name, side);
      double got = opc_test_number("cells", "value drawn", 4 + 2 * k + side);
      assert_near(name, got * figure[k].unit, printed_value(hand, name),
                  figure[k].share);
    }
  /* The margins are those of `measure: snm`. */
  double hold = opc_test_number("cells", "value drawn", 0);
  double read = opc_test_number("cells", "value drawn", 3);
  circuit_run(m, 0, card, "access: hold");
  assert_near("hold", hold, opc_test_metric("snm_left"), 1e-5);
  circuit_run(m, 0, card, "access: read");
  assert_near("read", read, opc_test_metric("snm_right"), 1e-5);
}

/* A second port is off when the first one is read or written, and on for the
   noise margin of a read. */
static void test_ports(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) one = circuit_make(MEMORY_PORTS, MEMORY);
  g_autoptr(made) two = circuit_make(MEMORY_PORTS " WL2:i BL2:o BLB2:o", MEMORY
                                     ",MA3 Q WL2 BL2 VSS n 65 140,"
                                     "MA4 QB WL2 BLB2 VSS n 65 140");
  double of[2][10];
  for (int k = 0; k < 2; k++) {
    circuit_run(k ? two : one, 0, card, "measure: cell");
    for (size_t i = 0; i < 10; i++)
      of[k][i] = opc_test_number("cells", "value drawn", i);
  }
  for (size_t i = 4; i < 8; i++) assert_near("port", of[1][i], of[0][i], 2e-3);
  for (size_t i = 2; i < 4; i++) g_assert_cmpfloat(of[1][i], <, 0.7 * of[0][i]);
  for (size_t i = 8; i < 10; i++) g_assert_cmpfloat(of[1][i], >, of[0][i]);
}

/* Leakage has the printed L of the off current; a cell whose access transistor
   is too weak is not written. */
static void test_printed_access(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m = circuit_make(MEMORY_PORTS, MEMORY);
  for (size_t i = 0; i < m->circuit.count; i++) m->off[1][i] = 60;
  circuit_run(m, 1, card, "measure: cell");
  g_assert_cmpfloat(opc_test_metric("cell_leakage_mean"), >, 10);
  g_assert_cmpfloat(fabs(opc_test_metric("cell_leakage_worst_before")), <,
                    1e-6);
  g_assert_cmpfloat(fabs(opc_test_metric("read_current_worst")), <, 1e-6);
  g_assert_cmpfloat(fabs(opc_test_metric("write_margin_worst")), <, 1e-6);
  g_autoptr(made) weak =
      circuit_make(MEMORY_PORTS,
                   "MA1 Q WL BL VSS n 65 60,MD1 Q QB VSS VSS n 65 300,"
                   "ML1 Q QB VDD VDD p 65 900,MA2 QB WL BLB VSS n 65 140,"
                   "MD2 QB Q VSS VSS n 65 330,ML2 QB Q VDD VDD p 65 160");
  circuit_run(weak, 0, card, "measure: cell");
  g_assert_cmpfloat(opc_test_number("cells", "value drawn", 4), ==, 0);
  g_assert_cmpfloat(opc_test_number("cells", "value drawn", 5), >, 100);
  g_autoptr(made) latch =
      circuit_make(MEMORY_PORTS " D:i",
                   "MD1 Q QB VSS VSS n 65 300,ML1 Q QB VDD VDD p 65 160,"
                   "MD2 QB Q VSS VSS n 65 330,ML2 QB Q VDD VDD p 65 160");
  assert_refused(latch, 0, card, "measure: cell",
                 "storage node 'Q' has no access transistor");
}

/* Chips with sizes near the drawn sizes. */
static eda_samples *chips_make(const made *m, size_t count) {
  eda_samples *chips = eda_samples_new(&m->gates, count);
  for (size_t k = 0; k < count; k++)
    for (size_t i = 0; i < m->gates.count; i++) {
      double phase = (double)k;
      chips->of[k].leq_ion[i] = m->length[i] * (1 + 0.02 * sin(7 * phase + i));
      chips->of[k].weq[i] = m->width[i] * (1 + 0.05 * cos(5 * phase + i));
      chips->of[k].area[i] = m->length[i] * m->width[i];
    }
  return chips;
}

static int chips_run(made *m, eda_samples *chips, const char *rest,
                     opc_error *error) {
  void *none[1];
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autofree char *map = g_strdup_printf(
      "{ models: '%s', supply: 1.1 V, picture: c.png, %s }", card, rest);
  g_autoptr(opc_module) step = opc_test_module("circuit.ngspice", map, error);
  if (!step) g_error("%s", error->message);
  opc_test_forget();
  opc_test_input(step, "circuit", &m->circuit);
  opc_test_input(step, "mask", &m->mask);
  opc_test_input(step, "chips", chips);
  return opc_test_run(step, none, error);
}

/* Figures of chips: those of the mask with the sizes of the chip, and their
   mean and standard deviation. The smaller figure of both sides counts. */
static void test_chips(void) {
  enum { CHIPS = 3, FIGURES = 4 };
  static const char *const columns[FIGURES] = {"hold margin", "read margin",
                                               "write margin", "read current"};
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m = circuit_make(MEMORY_PORTS, MEMORY);
  eda_samples *chips = chips_make(m, CHIPS);
  opc_error error;
  if (chips_run(m, chips, "measure: cell", &error))
    g_error("%s", error.message);
  double got[CHIPS][FIGURES], mean[FIGURES], sigma[FIGURES];
  for (size_t f = 0; f < FIGURES; f++) {
    for (size_t k = 0; k < CHIPS; k++)
      got[k][f] = opc_test_number("chip_cells", columns[f], k);
    mean[f] = opc_test_number("chips", "mean", f);
    sigma[f] = opc_test_number("chips", "sigma", f);
    g_assert_cmpint((int)opc_test_number("chips", "failed", f), ==, 0);
  }
  double sum[FIGURES] = {0}, square[FIGURES] = {0};
  for (size_t k = 0; k < CHIPS; k++) {
    memcpy(m->leq[1], chips->of[k].leq_ion, m->gates.count * sizeof(double));
    memcpy(m->weq[1], chips->of[k].weq, m->gates.count * sizeof(double));
    circuit_run(m, 1, card, "measure: cell");
    for (size_t f = 0; f < FIGURES; f++) {
      double left = opc_test_number("cells", "value after", 2 * f);
      double right = opc_test_number("cells", "value after", 2 * f + 1);
      double want = fmin(left, right);
      assert_near(columns[f], got[k][f], want, 1e-6);
      sum[f] += want / CHIPS;
      square[f] += want * want;
    }
  }
  for (size_t f = 0; f < FIGURES; f++) {
    double variance = (square[f] - CHIPS * sum[f] * sum[f]) / (CHIPS - 1);
    assert_near("mean", mean[f], sum[f], 1e-6);
    assert_near("sigma", sigma[f], sqrt(variance), 1e-3);
    g_assert_cmpfloat(sigma[f], >, 0.005 * mean[f]);
  }
  eda_samples_free(chips);
}

/* A cell that does not hold is lost by a read, too, but is one failed cell. */
static void test_chips_failed(void) {
  if (!have_ngspice()) return;
  g_autoptr(made) m = circuit_make(MEMORY_PORTS, MEMORY);
  eda_samples *chips = chips_make(m, 2);
  for (size_t i = 0; i < m->gates.count; i++) {
    int is_load = m->device[i].type == EDA_PMOS;
    int is_driver = m->width[i] > 299;
    if (is_driver) chips->of[1].leq_ion[i] *= 90;
    if (is_load) chips->of[1].leq_ion[i] *= 0.6, chips->of[1].weq[i] *= 90;
  }
  opc_error error;
  if (chips_run(m, chips, "measure: cell", &error))
    g_error("%s", error.message);
  for (size_t f = 0; f < 2; f++)
    g_assert_cmpint((int)opc_test_number("chips", "failed", f), ==, 1);
  g_assert_cmpint((int)opc_test_metric("failed_cells"), ==, 1);
  eda_samples_free(chips);
}

/* Inputs are known only when the step runs, so its check cannot refuse them. */
static void test_chips_refused(void) {
  static const struct {
    const char *rest, *message;
    size_t chips;
  } bad[] = {{"measure: snm", "'chips' requires 'measure: cell'", 1},
             {"measure: auto", "'chips' requires 'measure: cell'", 1},
             {"measure: cell, sizes: length, dlc: false", "*'sizes: both'*", 1},
             {"measure: cell", "there are no chips: set 'tables'*", 0}};
  g_autofree char *table = of_project("data/devices/opcflow65.yaml");
  g_autoptr(made) m = circuit_make(MEMORY_PORTS, MEMORY);
  for (size_t k = 0; k < G_N_ELEMENTS(bad); k++) {
    opc_error error;
    eda_samples *chips = chips_make(m, bad[k].chips);
    g_autofree char *rest =
        g_strdup_printf("%s, devices: '%s'", bad[k].rest, table);
    if (!chips_run(m, chips, rest, &error)) g_error("'%s' works", rest);
    g_assert_cmpstr(error.parameter, ==, "chips");
    if (!g_pattern_match_simple(bad[k].message, error.message))
      g_error("%s", error.message);
    eda_samples_free(chips);
  }
}

/* Cells whose word lines and bit lines cannot be driven separately. */
static void test_lines(void) {
  static const struct {
    const char *q, *qb, *refused;
  } of[] = {
      {"WL BL", "WL BL", "storage nodes 'Q' and 'QB' have one bit line, 'BL'*"},
      {"BL BL", "WL BLB", "the bit line 'BL' of storage node 'Q' is a word*"},
      {"WL BL", "BL BLB", "the bit line 'BL' of storage node 'Q' is a word*"},
      {"WL BL", "VDD BLB", "the word line of 'MA2', at storage nodes 'Q' and*"},
      {"WL BL", "VSS BLB", "*is the supply or ground 'VSS'"}};
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  for (size_t i = 0; i < G_N_ELEMENTS(of); i++) {
    g_autofree char *text = g_strdup_printf(
        "MA1 Q %s VSS n 65 140,MD1 Q QB VSS VSS n 65 300,"
        "ML1 Q QB VDD VDD p 65 160,MA2 QB %s VSS n 65 140,"
        "MD2 QB Q VSS VSS n 65 330,ML2 QB Q VDD VDD p 65 160",
        of[i].q, of[i].qb);
    g_autoptr(made) m = circuit_make(MEMORY_PORTS, text);
    assert_refused(m, 0, card, "measure: cell", of[i].refused);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/circuit/margins", test_margins);
  g_test_add_func("/circuit/cells", test_cells);
  g_test_add_func("/circuit/five-crossings", test_five_crossings);
  g_test_add_func("/circuit/access", test_access);
  g_test_add_func("/circuit/ports", test_ports);
  g_test_add_func("/circuit/printed-access", test_printed_access);
  g_test_add_func("/circuit/chips", test_chips);
  g_test_add_func("/circuit/chips/failed", test_chips_failed);
  g_test_add_func("/circuit/chips/refused", test_chips_refused);
  g_test_add_func("/circuit/lines", test_lines);
  return g_test_run();
}
