/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests circuit.ngspice against closed-form solutions and hand-written decks
   run by plain ngspice. */
#include "circuit_test.h"

/* ---- closed forms ---- */

/* Return the time in which a square-law inverter with a step input discharges
   its load to `level`. The transistor is saturated down to V - VT (J. P.
   Uyemura, CMOS Logic Circuit Design). */
static double discharge(double c, double k, double v, double vt, double level) {
  double over = v - vt;
  double first = c * fmin(vt, v - level) / (k / 2 * over * over);
  if (level >= over) return first;
  return first + c / (k * over) * log((2 * over - level) / level);
}

static void test_closed_form(void) {
  if (!have_ngspice()) return;
  g_autofree char *card =
      in_folder("square.pm",
                "* cards\n.model nmos nmos level=1 vto=0.3 kp=1e-4\n"
                ".model pmos pmos level=1 vto=-0.25 kp=4e-5\n");
  g_autoptr(made) m =
      circuit_make("A:i Y:o VDD:s VSS:g",
                   "MN Y A VSS VSS n 100 300,MP Y A VDD VDD p 100 450");
  circuit_run(m, 0, card,
              "dlc: false, load: 1 pF, slew: 0.01 ps, edges: [20 %, 70 %]");
  double v = 1.1, c = 1e-12, kn = 3e-4, kp = 1.8e-4;
  assert_near("tphl", opc_test_metric("tphl"),
              1e12 * discharge(c, kn, v, 0.3, v / 2), 1e-3);
  assert_near("tplh", opc_test_metric("tplh"),
              1e12 * discharge(c, kp, v, 0.25, v / 2), 1e-3);
  assert_near("tf", opc_test_metric("tf"),
              1e12 * (discharge(c, kn, v, 0.3, 0.3 * v) -
                      discharge(c, kn, v, 0.3, 0.8 * v)),
              1e-3);
  assert_near("tr", opc_test_metric("tr"),
              1e12 * (discharge(c, kp, v, 0.25, 0.3 * v) -
                      discharge(c, kp, v, 0.25, 0.8 * v)),
              1e-3);
  /* All times are proportional to L (k = KP W / L). */
  for (int i = 0; i < 2; i++) {
    m->leq[0][i] = 110;
    m->leq[1][i] = i ? 98 : 101;
  }
  circuit_run(m, 1, card, "dlc: false, load: 1 pF, slew: 0.01 ps");
  g_assert_cmpfloat(fabs(opc_test_metric("tp_worst_before") - 10), <, 0.02);
  g_assert_cmpfloat(fabs(opc_test_metric("tp_worst") - 2), <, 0.02);
  g_assert_cmpfloat(fabs(opc_test_metric("tplh_worst") - 2), <, 0.02);
  g_assert_cmpfloat(fabs(opc_test_metric("tphl_worst") - 1), <, 0.02);
  g_assert_cmpfloat(fabs(opc_test_metric("tr_worst") - 2), <, 0.02);
  g_assert_cmpfloat(fabs(opc_test_number("performance", "worst after", 0) + 2),
                    <, 0.02);
}

/* Test the delays of test_closed_form with a compiled model (OSDI). If ngspice
   has no OSDI support, test the error message. */
static void test_osdi(void) {
  if (!have_ngspice()) return;
  opc_error error;
  g_autofree char *path = in_folder(
      "square.lib",
      ".lib tt\n.subckt n d g s b w=1u l=1u\nn1 d g s b m w=w l=l\n"
      ".model m squarelaw type=1 k=1e-4 vt=0.3 leak=1e-12\n.ends\n"
      ".subckt p d g s b w=1u l=1u\nn1 d g s b m w=w l=l\n"
      ".model m squarelaw type=-1 k=4e-5 vt=0.25 leak=1e-12\n.ends\n.endl\n");
  g_autofree char *rest = g_strdup_printf(
      "osdi: '%s/subprojects/eda/simulator/square.osdi', corner: tt, nmos: n, "
      "pmos: p, load: 1 "
      "pF, slew: 0.01 ps",
      g_getenv("OPCFLOW_BUILD"));
  g_autoptr(made) m =
      circuit_make("A:i Y:o VDD:s VSS:g",
                   "MN Y A VSS VSS n 100 300,MP Y A VDD VDD p 100 450");
  int code = run_on(&m->circuit, NULL, path, rest, &error);
  if (code == OPC_NO_PLUGIN) {
    g_assert_nonnull(strstr(error.message, "compiled models (OSDI)"));
    g_test_skip(error.message);
    return;
  }
  if (code) g_error("%s", error.message);
  double v = 1.1, c = 1e-12;
  assert_near("tphl", opc_test_metric("tphl"),
              1e12 * discharge(c, 3e-4, v, 0.3, v / 2), 1e-3);
  assert_near("tplh", opc_test_metric("tplh"),
              1e12 * discharge(c, 1.8e-4, v, 0.25, v / 2), 1e-3);
}

/* The delay of an inverter with a large load is about C V / (2 Ion). */
static void test_estimate(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m = circuit_make("A:i Y:o VDD:s VSS:g", INVERTER);
  circuit_run(m, 0, card, "load: 100 fF, slew: 1 ps, measure: delays");
  assert_near("tphl", opc_test_metric("tphl"), 100e-3 * 0.55 / 347.7e-6, 0.2);
  assert_near("tplh", opc_test_metric("tplh"), 100e-3 * 0.55 / 241.2e-6, 0.2);
}

/* ---- delays by hand ---- */

static const char *const drives[4][3] = {
    /* transitions of the inputs A and B, from 20 ps to 40 ps */
    {"A 0>1, B 1", "pwl(0 0 20p 0 40p 1.1)", "1.1"},
    {"A 1, B 0>1", "1.1", "pwl(0 0 20p 0 40p 1.1)"},
    {"A 1>0, B 1", "pwl(0 1.1 20p 1.1 40p 0)", "1.1"},
    {"A 1, B 1>0", "1.1", "pwl(0 1.1 20p 1.1 40p 0)"}};

/* Return the output of plain ngspice for four instances of the subcircuit
   `cell` with the ports A B Y VDD VSS, each with one transition. */
static char *four_by_hand(const char *card, const char *cell) {
  g_autoptr(GString) deck = g_string_new("by hand\n");
  g_string_append_printf(deck, ".include \"%s\"\n%s\n", card, cell);
  for (int i = 0; i < 4; i++)
    g_string_append_printf(deck,
                           "x%d a%d b%d y%d s 0 cell\nva%d a%d 0 %s\nvb%d b%d "
                           "0 %s\nc%d y%d 0 4f\n",
                           i, i, i, i, i, i, drives[i][1], i, i, drives[i][2],
                           i, i);
  g_string_append(deck,
                  "vs s 0 1.1\n.options gmin=1e-15 reltol=1e-5 abstol=1e-15 "
                  "chgtol=1e-20\n.control\nset numdgt=12\n"
                  "tran 0.1p 120p 0 0.1p\n");
  for (int i = 0; i < 4; i++) {
    const char *direction = i < 2 ? "fall" : "rise";
    const char *input = *drives[i][1] == 'p' ? "a" : "b";
    g_string_append_printf(deck,
                           "meas tran d%d trig v(%s%d) val=0.55 cross=1 targ "
                           "v(y%d) val=0.55 %s=1\n"
                           "meas tran t%d trig v(y%d) val=%s %s=1 targ v(y%d) "
                           "val=%s %s=1\n",
                           i, input, i, i, direction, i, i,
                           i < 2 ? "0.99" : "0.11", direction, i,
                           i < 2 ? "0.11" : "0.99", direction);
  }
  g_string_append(deck, ".endc\n.end\n");
  return by_hand(deck->str);
}

static void compare_four(const char *hand, const char *state) {
  g_autofree char *delay = g_strdup_printf("delay %s", state);
  g_autofree char *slope = g_strdup_printf("slope %s", state);
  g_assert_cmpuint(opc_test_rows("delays"), ==, 4);
  for (size_t i = 0; i < 4; i++) {
    g_autofree char *d = g_strdup_printf("d%zu", i);
    g_autofree char *t = g_strdup_printf("t%zu", i);
    assert_near(drives[i][0], opc_test_number("delays", delay, i),
                1e12 * printed_value(hand, d), 1e-3);
    assert_near(drives[i][0], opc_test_number("delays", slope, i),
                1e12 * printed_value(hand, t), 1e-3);
  }
}

/* Not a parameter of nand_by_hand: compilers check literal formats only. */
static const char hand_nand[] =
    ".subckt cell a b y vdd vss\n"
    "m1 vss a x vss nmos w=0.4u l=%gn\nm2 y b x vss nmos w=0.4u l=65n\n"
    "m3 y a vdd vdd pmos w=0.45u l=65n\nm4 y b vdd vdd pmos w=%gn l=65n\n"
    ".ends\n";

static char *nand_by_hand(const char *card, double length, double width) {
  g_autoptr(GString) cell = g_string_new(NULL);
  g_string_append_printf(cell, hand_nand, length, width);
  return four_by_hand(card, cell->str);
}

/* The table of quantities has the mean of the drawn figures of the two falling
   (first) or the two rising delays, and the deviations of largest magnitude. */
static void compare_quantities(void) {
  static const struct {
    const char *name, *figure;
    size_t first, last;
  } want[] = {{"rise time", "slope", 2, 4},
              {"fall time", "slope", 0, 2},
              {"delay, rising", "delay", 2, 4},
              {"delay, falling", "delay", 0, 2},
              {"delay", "delay", 0, 4}};
  g_assert_cmpuint(opc_test_rows("performance"), ==, G_N_ELEMENTS(want));
  for (size_t q = 0; q < G_N_ELEMENTS(want); q++) {
    g_autofree char *drawn = g_strdup_printf("%s drawn", want[q].figure);
    g_autofree char *after = g_strdup_printf("%s after", want[q].figure);
    double n = (double)(want[q].last - want[q].first), mean = 0, off = 0,
           worst = 0;
    for (size_t i = want[q].first; i < want[q].last; i++) {
      double d = opc_test_number("delays", drawn, i),
             by = 100 * (opc_test_number("delays", after, i) / d - 1);
      mean += d / n;
      off += by / n;
      if (fabs(by) > fabs(worst)) worst = by;
    }
    g_assert_cmpstr(opc_test_text("performance", "quantity", q), ==,
                    want[q].name);
    g_assert_cmpfloat(opc_test_number("performance", "transitions", q), ==, n);
    assert_near(want[q].name, opc_test_number("performance", "drawn", q), mean,
                1e-6);
    assert_near(want[q].name, opc_test_number("performance", "worst after", q),
                worst, 1e-6);
    assert_near(want[q].name, opc_test_number("performance", "mean after", q),
                off, 1e-6);
  }
}

static void test_delays(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m = circuit_make("A:i B:i Y:o VDD:s VSS:g", NAND);
  m->leq[1][0] = 66.5;
  m->weq[1][3] = 430;
  m->area[1][0] = 66.5 * 400;
  m->area[1][3] = 65 * 430;
  circuit_run(m, 1, card, "slew: 20 ps, load: 4 fF, measure: delays");
  g_assert_cmpstr(opc_test_log(), ==, "");
  g_autofree char *drawn = nand_by_hand(card, 65, 450);
  if (!drawn) return;
  g_autofree char *after = nand_by_hand(card, 66.5, 430);
  for (size_t i = 0; i < 4; i++)
    g_assert_cmpstr(opc_test_text("delays", "inputs", i), ==, drives[i][0]);
  compare_four(drawn, "drawn");
  compare_four(drawn, "before");
  compare_four(after, "after");
  compare_quantities();
  /* Thesis, equation 3.8: largest |deviation| of a delay. */
  double worst = 0;
  for (int i = 0; i < 4; i++) {
    g_autofree char *name = g_strdup_printf("d%d", i);
    worst = fmax(worst, 100 * fabs(printed_value(after, name) /
                                       printed_value(drawn, name) -
                                   1));
  }
  g_test_message("worst deviation %g %%", worst);
  g_assert_cmpfloat(worst, >, 1);
  g_assert_cmpfloat(fabs(opc_test_metric("tp_worst") - worst), <, 0.02);
  g_assert_cmpfloat(opc_test_metric("tp_worst_before"), <, 0.005);
  g_assert_cmpfloat(opc_test_metric("transitions"), ==, 4);
}

/* Test NAND2_X1 of the NanGate library, from its layout and CDL. */
static void test_nangate(void) {
  g_autofree char *n_card = test_data(NANGATE_CARDS "NMOS_VTL.inc");
  g_autofree char *cell = run_nangate("NAND2_X1");
  g_autofree char *hand = cell ? four_by_hand(n_card, cell) : NULL;
  if (hand) compare_four(hand, "drawn");
}

/* A larger printed area with the same L and W changes the delay only by its
   capacitance, if `dlc` is on. */
static void test_capacitance(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m =
      circuit_make("A:i Y:o VDD:s VSS:g",
                   "MN B A VSS VSS n 65 300,MP B A VDD VDD p 65 450,"
                   "MN2 Y B VSS VSS n 65 3000,MP2 Y B VDD VDD p 65 4500");
  for (int i = 2; i < 4; i++) m->area[1][i] *= 1.2;
  circuit_run(m, 1, card, "measure: delays, load: 0 F");
  g_assert_cmpfloat(opc_test_metric("tp_worst"), >, 3);
  circuit_run(m, 1, card, "measure: delays, load: 0 F, dlc: false");
  g_assert_cmpfloat(opc_test_metric("tp_worst"), <, 1e-6);
}

/* A card with another DLC has the same overlap capacitance, although ngspice
   would derive it from DLC for a card without CGSO and CGDO. */
static void test_overlap(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m =
      circuit_make("A:i Y:o VDD:s VSS:g",
                   "MN B A VSS VSS n 65 300,MP B A VDD VDD p 65 450,"
                   "MN2 Y B VSS VSS n 65 3000,MP2 Y B VDD VDD p 65 4500");
  for (int i = 0; i < 4; i++) m->area[1][i] *= 1.0004;
  circuit_run(m, 1, card, "measure: delays, load: 0 F");
  g_assert_cmpfloat(fabs(opc_test_metric("tp_worst")), >, 1e-3);
  g_assert_cmpfloat(fabs(opc_test_metric("tp_worst")), <, 0.05);
}

/* ---- sizes ---- */

/* With `sizes: length`, the printed L (60 nm) and W are ignored: the current of
   L = 64 nm at drawn W produces the results of L = 64 nm. */
static void test_length(void) {
  if (!have_ngspice()) return;
  opc_error error;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autofree char *table = of_project("data/devices/ptm65.yaml");
  eda_devices *d = eda_devices_read(table, &error);
  g_assert_nonnull(d);
  g_autoptr(made) m = circuit_make("A:i Y:o VDD:s VSS:g", INVERTER);
  uint8_t type[2] = {EDA_NMOS, EDA_PMOS};
  double ion[2][2], ioff[2][2];
  m->gates.type = type;
  for (int i = 0; i < 2; i++)
    for (size_t k = 0; k < d->count; k++)
      for (int s = 0; s < 2; s++)
        if (d->length[k] == 65 - s) {
          ion[s][i] = d->ion[i][k] * m->width[i];
          ioff[s][i] = d->ioff[i][k] * m->width[i];
        }
  eda_devices_free(d);
  m->mask.design.ion = m->mask.before.ion = ion[0];
  m->mask.design.ioff = m->mask.before.ioff = ioff[0];
  m->mask.after.ion = ion[1];
  m->mask.after.ioff = ioff[1];
  for (int i = 0; i < 2; i++) m->leq[1][i] = 64;
  static const char *const figures[] = {"tr_worst", "tf_worst", "tp_worst"};
  double want[3];
  circuit_run(m, 1, card, "measure: delays, dlc: false");
  for (int k = 0; k < 3; k++) want[k] = opc_test_metric(figures[k]);
  g_assert_cmpfloat(fabs(want[2]), >, 0.5);
  for (int i = 0; i < 2; i++) m->leq[1][i] = 60, m->weq[1][i] *= 0.9;
  g_autofree char *rest = g_strdup_printf(
      "measure: delays, dlc: false, sizes: length, devices: '%s'", table);
  circuit_run(m, 1, card, rest);
  for (int k = 0; k < 3; k++)
    g_assert_cmpfloat(fabs(opc_test_metric(figures[k]) - want[k]), <, 0.001);
  g_autofree char *wrong =
      g_strdup_printf("{ models: '%s', supply: 1 V, sizes: length }", card);
  g_assert_null(opc_test_module("circuit.ngspice", wrong, &error));
  g_assert_nonnull(strstr(error.message, "requires a device table"));
}

/* ---- leakage by hand ---- */

static void test_leakage(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m = circuit_make("A:i B:i Y:o VDD:s VSS:g", NAND);
  m->off[1][0] = 62; /* the length of the off current differs from that of the
                        on current */
  m->leq[1][0] = 80;
  circuit_run(m, 1, card, "measure: leakage");
  g_assert_cmpuint(opc_test_rows("leakage"), ==, 4);
  g_autoptr(GString) deck = g_string_new("by hand\n");
  g_string_append_printf(deck, ".include \"%s\"\n", card);
  for (int after = 0; after < 2; after++) {
    g_autofree char *cell = g_strdup_printf(".subckt cell%d", after);
    g_autoptr(GString) text = g_string_new(NULL);
    g_string_append_printf(text, hand_nand, after ? 62.0 : 65.0, 450.0);
    g_string_append_printf(deck, "%s%s", cell,
                           text->str + strlen(".subckt cell"));
    for (int i = 0; i < 4; i++)
      g_string_append_printf(
          deck, "x%d%d a%d b%d y%d%d s%d%d 0 cell%d\nvs%d%d s%d%d 0 1.1\n",
          after, i, i, i, after, i, after, i, after, after, i, after, i);
  }
  for (int i = 0; i < 4; i++)
    g_string_append_printf(deck, "va%d a%d 0 %s\nvb%d b%d 0 %s\n", i, i,
                           i & 2 ? "1.1" : "0", i, i, i & 1 ? "1.1" : "0");
  g_string_append(deck,
                  ".options gmin=1e-15 reltol=1e-6 abstol=1e-16\n"
                  ".control\nset numdgt=12\nop\n");
  for (int i = 0; i < 8; i++)
    g_string_append_printf(deck, "let q%d%d=-i(vs%d%d)\nprint q%d%d\n", i / 4,
                           i % 4, i / 4, i % 4, i / 4, i % 4);
  g_string_append(deck, ".endc\n.end\n");
  g_autofree char *hand = by_hand(deck->str);
  if (!hand) return;
  double sum = 0;
  for (size_t i = 0; i < 4; i++)
    for (int after = 0; after < 2; after++) {
      g_autofree char *name = g_strdup_printf("q%d%zu", after, i);
      double want = printed_value(hand, name);
      assert_near(
          opc_test_text("leakage", "inputs", i),
          1e-9 * opc_test_number("leakage",
                                 after ? "leakage after" : "leakage drawn", i),
          want, 1e-4);
      assert_near(
          "power",
          1e-9 * opc_test_number("leakage",
                                 after ? "power after" : "power drawn", i),
          1.1 * want, 1e-4);
      if (!after) sum += want;
    }
  assert_near("mean", opc_test_metric("leakage"), sum / 4, 1e-4);
}

/* ---- patterns ---- */

static void test_patterns(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m = circuit_make("A:i B:i Y:o VDD:s VSS:g", NAND);
  circuit_run(m, 0, card, "transitions: several, measure: delays");
  g_assert_cmpfloat(opc_test_metric("transitions"), ==, 6);
  double all = opc_test_metric("tp");
  circuit_run(m, 0, card, "transitions: several, measure: delays, most: 12");
  g_assert_true(opc_test_metric("tp") == all);
  g_assert_cmpstr(opc_test_log(), ==, "");
  circuit_run(m, 0, card, "most: 5, measure: delays");
  g_assert_nonnull(strstr(opc_test_log(), "5 random transitions"));
  /* The 4 patterns exceed `most`, so the transitions are drawn one by one. */
  circuit_run(m, 0, card, "most: 3");
  g_assert_cmpuint(opc_test_rows("leakage"), ==, 6);
  /* The other port is now an output and never changes. */
  circuit_run(m, 0, card, "inputs: B, measure: delays");
  g_assert_nonnull(strstr(opc_test_log(), "output 'A' does not change"));
}

static void test_still(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m =
      circuit_make("A:i Y:o Z:o VDD:s VSS:g", INVERTER
                   ",MN2 Z VDD VSS VSS n 65 300,MP2 Z VDD VDD VDD p 65 450");
  circuit_run(m, 0, card, "measure: delays");
  g_assert_nonnull(strstr(opc_test_log(), "output 'Z' does not change"));
  g_assert_null(strstr(opc_test_log(), "'Y'"));
  g_assert_cmpuint(opc_test_rows("delays"), ==, 2);
}

/* The output of an inverter that is switched off floats: leakage determines the
   voltage, which is not a logic level. */
static void test_floating(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m =
      circuit_make("A:i E:i Y:o VDD:s VSS:g",
                   "MN1 Y A X VSS n 65 300,MN2 X E VSS VSS n 65 300,"
                   "MP1 Y A Z VDD p 65 450,MP2 Z F VDD VDD p 65 450,"
                   "MN3 F E VSS VSS n 65 300,MP3 F E VDD VDD p 65 450");
  circuit_run(m, 0, card, "measure: delays");
  g_assert_cmpstr(opc_test_log(), ==,
                  "output 'Y' is at no logic level in 2 of 4 patterns\n");
  g_assert_cmpfloat(opc_test_metric("transitions"), ==, 2);
}

/* ---- libraries and errors ---- */

/* A library that contains the card in subcircuits, with sizes in um and two
   bins, has the same results as the card. */
static void test_library(void) {
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autofree char *path = g_build_filename(opc_test_folder(), "own.lib", NULL);
  g_autofree char *text = NULL;
  if (!have_ngspice()) return;
  g_assert_true(g_file_get_contents(card, &text, NULL, NULL));
  char *p_card = strstr(text, ".model pmos");
  g_autoptr(GString) lib = g_string_new(".lib tt\n.option scale=1u\n");
  for (int type = 0; type < 2; type++) {
    const char *from = type ? p_card : strstr(text, ".model nmos");
    g_autofree char *one =
        type ? g_strdup(from) : g_strndup(from, (gsize)(p_card - from));
    const char *rest = strchr(one, '\n');
    g_string_append_printf(lib,
                           ".subckt %cfet d g s b\n.param w=1 l=1\n"
                           "m1 d g s b core l={l} w={w}\n",
                           "np"[type]);
    for (int bin = 1; bin <= 2; bin++)
      g_string_append_printf(lib,
                             ".model core.%d %cmos\n+ lmin=%s wmin=1e-7 "
                             "wmax=1e-5%s\n",
                             bin, "np"[type],
                             bin == 1 ? "6e-8 lmax=6.6e-8" : "6.6e-8 lmax=1e-6",
                             rest);
    g_string_append(lib, ".ends\n");
  }
  g_string_append(lib, ".endl\n");
  g_assert_true(g_file_set_contents(path, lib->str, -1, NULL));
  g_autoptr(made) m = circuit_make("A:i Y:o VDD:s VSS:g", INVERTER);
  m->leq[1][0] = m->off[1][0] = 66.7; /* this length is in the other bin */
  m->leq[1][1] = m->off[1][1] = 58;   /* this length is shorter than the
                                         shortest bin */
  circuit_run(m, 1, card, "load: 4 fF, measure: delays, dlc: false");
  double tp = opc_test_metric("tp"), worst = opc_test_metric("tp_worst");
  circuit_run(
      m, 1, path,
      "load: 4 fF, measure: delays, corner: tt, nmos: nfet, pmos: pfet");
  g_assert_cmpfloat(worst, >, 1);
  g_assert_cmpfloat_with_epsilon(opc_test_metric("tp"), tp, 1e-5 * tp);
  g_assert_cmpfloat_with_epsilon(opc_test_metric("tp_worst"), worst, 1e-3);
  /* Test a model that the library lacks. */
  m->device[0].model = "other_nfet";
  assert_refused(m, 0, path, "corner: tt, pmos: pfet",
                 "*has no model 'other_nfet'*");
  assert_refused(m, 0, path, "corner: tt, pmos: pfet, stand_ins: other_nfet",
                 "'other_nfet' has no substitute model");
  circuit_run(m, 1, path,
              "load: 4 fF, measure: delays, corner: tt, pmos: pfet, stand_ins: "
              "other_nfet nfet");
  g_assert_nonnull(strstr(opc_test_log(), "replaces 'other_nfet' in 1 "));
  g_assert_cmpfloat_with_epsilon(opc_test_metric("tp_worst"), worst, 1e-3);
}

static void test_refused(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m = circuit_make("A:i Y:o VDD:s VSS:g", INVERTER);
  assert_refused(m, 0, card, "nmos: nfet", "*has no model 'nfet'");
  assert_refused(m, 0, card, "nmos: nfet, dlc: false",
                 "'ngspice' failed*nfet*");
  g_autofree char *both = g_strdup_printf("library: '%s'", card);
  assert_refused(m, 0, card, both, "*set either 'models' or 'library'");
  g_autofree char *osdi = g_strdup_printf("osdi: '%s'", card);
  assert_refused(m, 0, card, osdi, "*requires 'library'");
  assert_refused(m, 0, card, "time_limit: 1 ns",
                 "*'ngspice' did not finish within*raise 'time_limit'*");
  assert_refused(m, 0, card, "inputs: A VSS", "'VSS' is no port of 'made'*");
  assert_refused(m, 0, card, "edges: [60 %, 90 %]",
                 "*'edges' must be two thresholds*");
  assert_refused(m, 0, card, "nmos: 'n m'", "*is not the name of a model*");
  assert_refused(m, 0, card, "measure: snm", "'made' has no cross-coupled*");
  m->flags[0] = EDA_PRINT_OPEN;
  assert_refused(m, 1, card, "measure: auto",
                 "netlist device 'MN' has no size*");
  m->flags[0] = 0;
  eda_gates other = m->gates;
  m->mask.gates = &other;
  assert_refused(m, 1, card, "measure: auto",
                 "the mask and the circuit belong to*");
  m->mask.gates = &m->gates;
  m->role[2] = EDA_PIN_INPUT;
  assert_refused(m, 0, card, "measure: auto",
                 "'made' has no supply among its ports");
  g_autoptr(made) latch = circuit_make(MEMORY_PORTS, MEMORY);
  assert_refused(latch, 0, card, "measure: leakage",
                 "*is sequential: net 'QB'*");
  assert_refused(latch, 0, card, "measure: delays, transitions: several",
                 "*is sequential*set one changing input at a time");
  assert_refused(latch, 0, card, "cell: WL",
                 "'WL' is not a storage node of 'made'");
}

/* A transistor without printed size before correction is no error. */
static void test_before(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m = circuit_make("A:i Y:o VDD:s VSS:g", INVERTER);
  m->leq[0][0] = NAN;
  circuit_run(m, 1, card, "measure: auto");
  g_assert_nonnull(
      strstr(opc_test_log(),
             "the circuit printed before the correction has no results"));
  g_assert_true(isnan(opc_test_metric("tp_worst_before")));
  g_assert_cmpfloat(opc_test_metric("tp_worst"), <, 1e-6);
  m->leq[0][0] = 2; /* the length is shorter than the simulator accepts */
  circuit_run(m, 1, card, "measure: auto");
  g_assert_cmpfloat(opc_test_metric("tp_worst"), <, 1e-6);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/circuit/closed-form", test_closed_form);
  g_test_add_func("/circuit/osdi", test_osdi);
  g_test_add_func("/circuit/estimate", test_estimate);
  g_test_add_func("/circuit/delays", test_delays);
  g_test_add_func("/circuit/library", test_library);
  g_test_add_func("/circuit/nangate", test_nangate);
  g_test_add_func("/circuit/capacitance", test_capacitance);
  g_test_add_func("/circuit/overlap", test_overlap);
  g_test_add_func("/circuit/length", test_length);
  g_test_add_func("/circuit/leakage", test_leakage);
  g_test_add_func("/circuit/patterns", test_patterns);
  g_test_add_func("/circuit/still", test_still);
  g_test_add_func("/circuit/floating", test_floating);
  g_test_add_func("/circuit/refused", test_refused);
  g_test_add_func("/circuit/before", test_before);
  return g_test_run();
}
