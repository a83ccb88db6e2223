/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests sequential circuits: transitions against the functions of latches and
   flip-flops, delays against hand-written sequences run by plain ngspice. */
#include "circuit_test.h"

/* Clocked inverter: Y is held while EN is 0 and its complement ENB is 1. */
#define CLOCKED(id, a, y, en, enb)                                       \
  "MN" id "1 " id "N " a " VSS VSS n 65 300,MN" id "2 " y " " en " " id  \
  "N VSS n 65 300,MP" id "1 " id "P " a " VDD VDD p 65 450,MP" id "2 " y \
  " " enb " " id "P VDD p 65 450"
#define INVERT(id, a, y)                                    \
  "MN" id " " y " " a " VSS VSS n 65 300,MP" id " " y " " a \
  " VDD VDD p 65 "                                          \
  "450"
#define HOLD(id, a, m, q, en, enb) \
  CLOCKED(id "A", a, m, en, enb)   \
  "," INVERT(id "B", m, q) "," CLOCKED(id "C", q, m, enb, en)
#define LATCH INVERT("0", "G", "GB") "," HOLD("1", "D", "M", "Q", "G", "GB")
#define FLIP_FLOP                                                         \
  INVERT("0", "CK", "CB")                                                 \
  "," HOLD("1", "D", "M", "MB", "CB", "CK") "," HOLD("2", "MB", "S", "Q", \
                                                     "CK", "CB")
#define CROSSED                                          \
  "MN1 X SN VSS VSS n 65 400,MN2 Q QN X VSS n 65 400,"   \
  "MP1 Q SN VDD VDD p 65 450,MP2 Q QN VDD VDD p 65 450," \
  "MN3 Z RN VSS VSS n 65 400,MN4 QN Q Z VSS n 65 400,"   \
  "MP3 QN RN VDD VDD p 65 450,MP4 QN Q VDD VDD p 65 450"

/* ---- transitions ---- */

/* Check that the table has the rows "INPUTS OUTPUT WAY", in any order. */
static void assert_rows(const char *const *rows, size_t count) {
  g_assert_cmpuint(opc_test_rows("delays"), ==, count);
  for (size_t k = 0; k < count; k++) {
    size_t n = 0;
    for (size_t i = 0; i < count; i++) {
      g_autoptr(GString) row =
          g_string_new(opc_test_text("delays", "inputs", i));
      g_string_append_printf(row, " %s", opc_test_text("delays", "output", i));
      g_string_append_printf(row, " %s",
                             opc_test_text("delays", "direction", i));
      n += !strcmp(row->str, rows[k]);
    }
    if (n != 1) g_error("%zu times '%s'", n, rows[k]);
  }
  g_assert_cmpfloat(opc_test_metric("unmeasured"), ==, 0);
}

/* A latch is transparent while G is 1. */
static const char *const of_latch[] = {
    "D 0>1, G 1 Q rises", "D 1>0, G 1 Q falls", "D 1, G 0>1 Q rises",
    "D 0, G 0>1 Q falls"};
/* If both inputs are 0, both outputs are 1. The input that rises last
   determines the state. */
static const char *const of_crossed[] = {
    "SN 1>0, RN 1 Q rises",  "SN 1>0, RN 1 QN falls", "SN 1, RN 1>0 Q falls",
    "SN 1, RN 1>0 QN rises", "SN 0, RN 1>0 QN rises", "SN 1>0, RN 0 Q rises",
    "SN 0>1, RN 0 Q falls",  "SN 0, RN 0>1 QN falls"};

static void test_crossed(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m = circuit_make("SN:i RN:i Q:o QN:o VDD:s VSS:g", CROSSED);
  circuit_run(m, 0, card, "measure: delays");
  assert_rows(of_crossed, G_N_ELEMENTS(of_crossed));
  g_assert_nonnull(strstr(opc_test_log(), "is sequential: 5 "));
  circuit_run(m, 0, card, "measure: delays, most: 3");
  g_assert_nonnull(strstr(opc_test_log(), "more exist"));
  circuit_run(m, 0, card, "measure: delays, most: 1");
  g_assert_nonnull(strstr(opc_test_log(),
                          "output 'QN' does not change for the tried inputs"));
}

/* A node that can be set but not reset stays set; the states before the node is
   set are not recurrent. */
static void test_once(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m =
      circuit_make("SN:i Q:o VDD:s VSS:g",
                   "MN1 X SN VSS VSS n 65 400,MN2 Q QN X VSS n 65 400,"
                   "MP1 Q SN VDD VDD p 65 450,MP2 Q QN VDD VDD p 65 450,"
                   "MN4 QN Q VSS VSS n 65 400,MP4 QN Q VDD VDD p 65 450");
  circuit_run(m, 0, card, "measure: delays");
  g_assert_cmpuint(opc_test_rows("delays"), ==, 0);
  g_assert_nonnull(strstr(opc_test_log(), "output 'Q' does not change"));
}

/* Test a frequency divider; its power-up state is unknown. */
static void test_halving(void) {
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m =
      circuit_make("CK:i Q:o VDD:s VSS:g", FLIP_FLOP "," INVERT("9", "Q", "D"));
  circuit_run(m, 0, card, "measure: delays");
  g_assert_cmpuint(opc_test_rows("delays"), ==, 2);
  g_assert_nonnull(
      strstr(opc_test_log(), "no sequence of input changes is known"));
}

/* A ring oscillator with various periods. With some of these loads, the levels
   are equal in the middle and at the end of a phase. */
static void test_ringing(void) {
  static const char *const loads[] = {"0", "0.4", "1.5", "2.9", "3.1", "3.5"};
  if (!have_ngspice()) return;
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m =
      circuit_make("E:i C:o VDD:s VSS:g",
                   "MN1 X E VSS VSS n 65 400,MN2 A C X VSS n 65 400,"
                   "MP1 A E VDD VDD p 65 450,MP2 A C VDD VDD p 65 450," INVERT(
                       "3", "A", "B") "," INVERT("4", "B", "C"));
  for (size_t i = 0; i < G_N_ELEMENTS(loads); i++) {
    g_autofree char *rest =
        g_strdup_printf("measure: delays, load: %s fF", loads[i]);
    assert_refused(
        m, 0, card, rest,
        "'made' does not settle: net '*' changes at least 32 times*");
  }
}

/* ---- delays ---- */

enum { CHANGES = 12 };

/* Measurement: phase and row of the table. */
typedef struct event {
  int phase;
  const char *inputs, *output;
  int rises;
} event;

/* Simulate a sequence with plain ngspice. Phases take 2 ns; input changes take
   20 ps at the beginning of a phase. */
static char *sequence_by_hand(const char *card, const char *cell,
                              const char *ports, const char *const *inputs,
                              const char *const *levels, const event *events,
                              size_t count) {
  g_autoptr(GString) deck = g_string_new("by hand\n");
  g_string_append_printf(
      deck, ".include \"%s\"\n%sx1 %s cell\nvs vdd 0 1.1\nvg vss 0 0\n", card,
      cell, ports);
  for (size_t i = 0; inputs[i]; i++) {
    const char *l = levels[i];
    g_string_append_printf(deck, "v%zu %s 0 pwl(0 %g", i, inputs[i],
                           l[0] == '1' ? 1.1 : 0.0);
    for (size_t k = 1; l[k]; k++)
      g_string_append_printf(deck, " %zun %g %zu.02n %g", 2 * k,
                             l[k - 1] == '1' ? 1.1 : 0.0, 2 * k,
                             l[k] == '1' ? 1.1 : 0.0);
    g_string_append(deck, ")\n");
  }
  for (size_t i = 0; i < count; i++) {
    size_t first = 0;
    while (strcmp(events[first].output, events[i].output)) first++;
    if (first == i)
      g_string_append_printf(deck, "c%zu %s 0 4f\n", i, events[i].output);
  }
  g_string_append_printf(deck,
                         ".options gmin=1e-15 reltol=1e-4 abstol=1e-15 "
                         "chgtol=1e-19\n.control\nset numdgt=12\n"
                         "tran 0.5p %zun 0 0.5p\n",
                         2 * strlen(levels[0]));
  for (size_t i = 0; i < count; i++) {
    const event *e = &events[i];
    const char *direction = e->rises ? "rise" : "fall";
    g_string_append_printf(
        deck,
        "meas tran d%zu trig at=%d.01n targ v(%s) val=0.55 %s=1 td=%dn\n"
        "meas tran t%zu trig v(%s) val=%s %s=1 td=%dn targ v(%s) val=%s %s=1 "
        "td=%dn\n",
        i, 2 * e->phase, e->output, direction, 2 * e->phase, i, e->output,
        e->rises ? "0.11" : "0.99", direction, 2 * e->phase, e->output,
        e->rises ? "0.99" : "0.11", direction, 2 * e->phase);
  }
  g_string_append(deck, ".endc\n.end\n");
  return by_hand(deck->str);
}

static void assert_states(const char *hand, const char *state,
                          const event *events, size_t count) {
  g_autofree char *delay = g_strdup_printf("delay %s", state);
  g_autofree char *slope = g_strdup_printf("slope %s", state);
  for (size_t k = 0; k < count; k++) {
    const event *e = &events[k];
    g_autofree char *d = g_strdup_printf("d%zu", k);
    g_autofree char *t = g_strdup_printf("t%zu", k);
    size_t i = 0;
    while (strcmp(opc_test_text("delays", "inputs", i), e->inputs) ||
           g_ascii_strcasecmp(opc_test_text("delays", "output", i), e->output))
      i++;
    assert_near(e->inputs, opc_test_number("delays", delay, i),
                1e12 * printed_value(hand, d), 2.5e-3);
    assert_near(e->inputs, opc_test_number("delays", slope, i),
                1e12 * printed_value(hand, t), 2.5e-3);
  }
}

/* Return the netlist of a circuit, as drawn or with the sizes after
   correction. */
static char *cell_of(const made *m, const char *ports, int after) {
  GString *text = g_string_new(NULL);
  g_string_append_printf(text, ".subckt cell %s\n", ports);
  for (size_t i = 0; i < m->circuit.count; i++) {
    const eda_device *d = &m->device[i];
    g_string_append_printf(text, "m%zu %s %s %s %s %s l=%gn w=%gn\n", i,
                           m->net[d->drain], m->net[d->gate], m->net[d->source],
                           m->net[d->bulk],
                           d->type == EDA_PMOS ? "pmos" : "nmos",
                           after ? m->leq[1][i] : m->length[i],
                           after ? m->weq[1][i] : m->width[i]);
  }
  g_string_append(text, ".ends\n");
  return g_string_free(text, FALSE);
}

/* Change the printed sizes of all transistors slightly. */
static void print_changed(made *m) {
  for (size_t i = 0; i < m->circuit.count; i++) {
    m->leq[1][i] = m->off[1][i] = m->length[i] + 1 + (double)(i % 3);
    m->weq[1][i] = m->width[i] * (i % 2 ? 0.98 : 1.03);
    m->area[1][i] = m->leq[1][i] * m->weq[1][i];
  }
}

static void test_sequence(const char *ports, const char *devices,
                          const char *hand_ports, const char *const *inputs,
                          const char *const *levels, const event *events,
                          size_t count) {
  g_autofree char *card = of_project("data/devices/opcflow65.pm");
  g_autoptr(made) m = circuit_make(ports, devices);
  print_changed(m);
  circuit_run(m, 1, card, "measure: delays, dlc: false");
  g_assert_cmpfloat(opc_test_metric("tp_worst"), >, 1);
  g_assert_cmpfloat(opc_test_metric("tp_worst_before"), <, 0.001);
  for (int after = 0; after < 2; after++) {
    g_autofree char *cell = cell_of(m, hand_ports, after);
    g_autofree char *hand =
        sequence_by_hand(card, cell, hand_ports, inputs, levels, events, count);
    if (hand) assert_states(hand, after ? "after" : "drawn", events, count);
  }
}

static void test_latch(void) {
  static const char *const inputs[] = {"D", "G", NULL};
  static const char *const levels[] = {"00011001", "01111011"};
  static const event events[] = {{3, "D 0>1, G 1", "Q", 1},
                                 {7, "D 0>1, G 1", "Q", 1},
                                 {6, "D 0, G 0>1", "Q", 0}};
  if (!have_ngspice()) return;
  test_sequence("D:i G:i Q:o VDD:s VSS:g", LATCH, "D G Q VDD VSS", inputs,
                levels, events, 3);
  assert_rows(of_latch, G_N_ELEMENTS(of_latch));
  g_assert_nonnull(strstr(opc_test_log(), "is sequential: 6 "));
}

static const char *const clock_levels[] = {"000011100", "010001001"};
static const char *const of_flip_flop[] = {"D 1, CK 0>1 Q rises",
                                           "D 0, CK 0>1 Q falls"};

static void test_flip_flop(void) {
  if (opc_test_sanitized_skip()) return;
  static const char *const inputs[] = {"D", "CK", NULL};
  static const event events[] = {{5, "D 1, CK 0>1", "Q", 1},
                                 {8, "D 0, CK 0>1", "Q", 0}};
  if (!have_ngspice()) return;
  test_sequence("D:i CK:i Q:o VDD:s VSS:g", FLIP_FLOP, "D CK Q VDD VSS", inputs,
                clock_levels, events, 2);
  assert_rows(of_flip_flop, G_N_ELEMENTS(of_flip_flop));
  g_assert_nonnull(strstr(opc_test_log(), "is sequential: 8 "));
}

/* A keeper on a net that is always driven holds no state. */
static void test_keeper(void) {
  static const char *const inputs[] = {"A", NULL};
  static const char *const levels[] = {"010"};
  static const event events[] = {{1, "A 0>1", "Y", 1}, {2, "A 1>0", "Y", 0}};
  if (!have_ngspice()) return;
  test_sequence("A:i Y:o VDD:s VSS:g",
                INVERT("1", "A", "B") "," INVERT("2", "B", "Y") ",MN3 B Y VSS "
                                                                "VSS n 130 "
                                                                "100,MP3 B Y "
                                                                "VDD VDD p 130 "
                                                                "100",
                "A Y VDD VSS", inputs, levels, events, 2);
  g_assert_cmpuint(opc_test_rows("delays"), ==, 2);
}

/* Test DFF_X1 of the NanGate library, from its layout and CDL. */
static void test_nangate(void) {
  if (opc_test_sanitized_skip()) return;
  static const char *const inputs[] = {"d", "ck", NULL};
  static const event events[] = {{5, "D 1, CK 0>1", "q", 1},
                                 {5, "D 1, CK 0>1", "qn", 0},
                                 {8, "D 0, CK 0>1", "q", 0},
                                 {8, "D 0, CK 0>1", "qn", 1}};
  g_autofree char *n_card = test_data(NANGATE_CARDS "NMOS_VTL.inc");
  g_autofree char *cell = run_nangate("DFF_X1");
  if (!cell) return;
  g_assert_cmpuint(opc_test_rows("delays"), ==, 4);
  g_autofree char *hand =
      sequence_by_hand(n_card, cell, "d ck q qn vdd vss", inputs, clock_levels,
                       events, G_N_ELEMENTS(events));
  if (hand) assert_states(hand, "drawn", events, G_N_ELEMENTS(events));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/circuit/states/crossed", test_crossed);
  g_test_add_func("/circuit/states/once", test_once);
  g_test_add_func("/circuit/states/halving", test_halving);
  g_test_add_func("/circuit/states/ringing", test_ringing);
  g_test_add_func("/circuit/states/latch", test_latch);
  g_test_add_func("/circuit/states/flip-flop", test_flip_flop);
  g_test_add_func("/circuit/states/keeper", test_keeper);
  g_test_add_func("/circuit/states/nangate", test_nangate);
  return g_test_run();
}
