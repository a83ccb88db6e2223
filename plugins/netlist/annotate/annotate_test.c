/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the written text and its results in ngspice, for an inverter with the
   two gates of eda_gates_sample. */
#include <eda/circuit.h>
#include <glib/gstdio.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tools/devel/testing.h"

/* ---- an inverter and its printed sizes ---- */

static const uint32_t fingers[2] = {0, 1};
static const char *nets[] = {"IN", "OUT", "XU1/VDD", "VSS"};
static uint32_t ports[] = {0, 1, 2, 3};
static uint8_t roles[] = {EDA_PIN_INPUT, EDA_PIN_OUTPUT, EDA_PIN_SUPPLY,
                          EDA_PIN_GROUND};
static eda_device devices[2] = {{.name = "MN",
                                 .drain = 1,
                                 .gate = 0,
                                 .source = 3,
                                 .bulk = 3,
                                 .length = 60,
                                 .width = 200,
                                 .type = EDA_NMOS,
                                 .fingers = 1,
                                 .finger = &fingers[0]},
                                {.name = "XU1/MP",
                                 .drain = 1,
                                 .gate = 0,
                                 .source = 2,
                                 .bulk = 2,
                                 .length = 60,
                                 .width = 300,
                                 .type = EDA_PMOS,
                                 .fingers = 1,
                                 .finger = &fingers[1]}};
static eda_circuit circuit = {.name = "inv",
                              .nets = 4,
                              .net = nets,
                              .ports = 4,
                              .port = ports,
                              .role = roles,
                              .count = 2,
                              .device = devices};

/* n-transistor: current of 62 nm, area of 57 nm by 210 nm; p-transistor as
   drawn. */
static double leq[2] = {62, 60}, weq[2] = {210, 300},
              area[2] = {57 * 210, 60 * 300};
static uint32_t flags[2];
static eda_mask mask = {.flags = flags};

static const char card[] =
    "* cards\n"
    ".MODEL nmos nmos level=54 version=4.5 (toxe=1.8e-9\n"
    "* a comment\n"
    "+ xl=-1e-8 LINT = 5n vth0='0.3' cgso=1e-10 cgdo=1e-10 dvt0=0 eta0=0 "
    "lpe0=0)\n"
    ".model pmos pmos level=54 version=4.5 toxe=1.8e-9 dlc=7n lint=5n\n"
    "+ vth0=-0.3 cgso=1e-10 cgdo=1e-10\n";

static char *in_folder(const char *name, const char *text) {
  char *path = g_build_filename(opc_test_folder(), name, NULL);
  if (!text) return path;
  g_unlink(path); /* a new file, which need not be flushed to the disk */
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  return path;
}

static void gates_prepare(void) {
  circuit.gates = mask.gates = eda_gates_sample();
  mask.after = mask.before =
      (eda_performance){.count = 2, .leq_ion = leq, .weq = weq, .area = area};
  leq[0] = 62;
  flags[0] = 0;
}

/* Return the written text, or the error message if `fails`. */
static char *netlist_annotate(const char *map, int with_mask, int fails) {
  static int number;
  opc_error error;
  g_autofree char *name = g_strdup_printf("out%d.sp", number++);
  g_autofree char *whole = g_strdup_printf("{ file: %s%s }", name, map);
  g_autoptr(opc_module) m = opc_test_module("netlist.annotate", whole, &error);
  if (!m && fails) return g_strdup(error.message);
  if (!m) g_error("%s", error.message);
  void *none[1];
  opc_test_input(m, "circuit", &circuit);
  if (with_mask) opc_test_input(m, "mask", &mask);
  int code = opc_test_run(m, none, &error);
  g_assert_cmpint(code != OPC_OK, ==, fails);
  if (fails) return g_strdup(error.message);
  g_autofree char *path = in_folder(name, NULL);
  char *text;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  return text;
}

/* ---- the text ---- */

static void test_text(void) {
  gates_prepare();
  g_autofree char *drawn = netlist_annotate("", 0, 0);
  g_assert_cmpstr(drawn, ==,
                  "* inv: sizes as drawn\n"
                  ".subckt inv IN OUT XU1.VDD VSS\n"
                  "MN OUT IN VSS VSS nmos w=200e-9 l=60e-9\n"
                  "M.XU1.MP OUT IN XU1.VDD XU1.VDD pmos w=300e-9 l=60e-9\n"
                  ".ends\n");
  g_autofree char *same = netlist_annotate(", state: drawn", 1, 0);
  g_assert_cmpstr(same, ==, drawn);
  g_autofree char *after = netlist_annotate(", nmos: n1, pmos: p1", 1, 0);
  g_assert_cmpstr(after, ==,
                  "* inv: sizes as printed after correction\n"
                  ".subckt inv IN OUT XU1.VDD VSS\n"
                  "MN OUT IN VSS VSS n1 w=210e-9 l=62e-9\n"
                  "M.XU1.MP OUT IN XU1.VDD XU1.VDD p1 w=300e-9 l=60e-9\n"
                  ".ends\n");
}

/* Test models as in a foundry's design kit. */
static void test_kit(void) {
  gates_prepare();
  g_autofree char *text = netlist_annotate(
      ", nmos: nfet, pmos: pfet, subcircuits: true, unit: 1 um", 1, 0);
  g_assert_cmpstr(text, ==,
                  "* inv: sizes as printed after correction\n"
                  ".subckt inv IN OUT XU1.VDD VSS\n"
                  "XMN OUT IN VSS VSS nfet w=0.21 l=0.062\n"
                  "XU1.MP OUT IN XU1.VDD XU1.VDD pfet w=0.3 l=0.06\n"
                  ".ends\n");
}

/* Test that each device keeps its model of the netlist if no models are
   given. */
static void test_own_models(void) {
  gates_prepare();
  devices[0].model = "nfet_lvt";
  g_autofree char *text = netlist_annotate(", pmos: pfet", 1, 0);
  g_assert_nonnull(strstr(text, "MN OUT IN VSS VSS nfet_lvt w=210e-9"));
  g_assert_nonnull(strstr(text, "XU1.VDD pfet w=300e-9"));
  devices[0].model = NULL;
}

/* Test equation 3.11: 5 nm + (62 nm - 57 nm) / 2, with lint of the card. */
static void test_dlc(void) {
  gates_prepare();
  g_autofree char *cards = in_folder("cards.sp", card);
  g_autofree char *map = g_strdup_printf(", models: '%s'", cards);
  g_autofree char *text = netlist_annotate(map, 1, 0);
  g_assert_nonnull(strstr(text,
                          ".model nmos_dlc250 nmos dlc=7.5e-9\n+ level=54 "
                          "version=4.5 toxe=1.8e-9 xl=-1e-8 LINT=5n "
                          "vth0=0.3\n"));
  g_assert_nonnull(strstr(text, "MN OUT IN VSS VSS nmos_dlc250 w=210e-9 "));
  g_assert_nonnull(strstr(text, " pmos w=300e-9 l=60e-9\n"));
  g_assert_cmpfloat(opc_test_metric("models"), ==, 1);
  g_assert_cmpfloat(opc_test_metric("transistors"), ==, 2);
  /* The correction is added to a DLC in the card. */
  area[1] = 61 * 300;
  g_autofree char *both = netlist_annotate(map, 1, 0);
  g_assert_nonnull(strstr(both, ".model pmos_dlcm50 pmos dlc=6.5e-9\n"));
  g_assert_null(strstr(both, "dlc=7n"));
  area[1] = 60 * 300;
}

/* Test that values which the model derives from XJ or DLC are written
   explicitly, because the changed DLC would change them: 0.6 XJ Cox, and DLC
   Cox - CGSL. */
static void test_overlap(void) {
  gates_prepare();
  g_autofree char *cards =
      in_folder("overlap.sp",
                ".model nmos nmos level=54 toxe=1.8e-9 xj=4e-8 lint=5n\n"
                ".model pmos pmos level=49 tox=1.8e-9 dlc=7n cgsl=1e-11 "
                "cgdo=1e-10\n");
  g_autofree char *map = g_strdup_printf(", models: '%s'", cards);
  area[1] = 61 * 300;
  g_autofree char *text = netlist_annotate(map, 1, 0);
  area[1] = 60 * 300;
  g_assert_nonnull(strstr(text,
                          "lint=5n cgso=4.6041736e-10 "
                          "cgdo=4.6041736e-10\n"));
  g_assert_nonnull(strstr(text, "cgdo=1e-10 cgso=1.24288506e-10\n"));
}

/* Test that fingers become parallel devices. */
static void test_fingers(void) {
  gates_prepare();
  eda_device both = devices[0], *before = circuit.device;
  both.fingers = 2;
  both.width = 1000;
  both.length = 59;
  circuit.device = &both;
  circuit.count = 1;
  g_autofree char *drawn = netlist_annotate("", 0, 0);
  g_assert_cmpstr(strchr(drawn, 'M'), ==,
                  "MN OUT IN VSS VSS nmos w=400e-9 l=59e-9\n"
                  "MN_f2 OUT IN VSS VSS nmos w=600e-9 l=59e-9\n"
                  ".ends\n");
  circuit.device = before;
  circuit.count = 2;
}

/* ---- errors ---- */

static void assert_refused(const char *map, int with_mask,
                           const char *pattern) {
  g_autofree char *message = netlist_annotate(map, with_mask, 1);
  if (!g_pattern_match_simple(pattern, message))
    g_error("'%s' is not '%s'", message, pattern);
}

static void refused_card(const char *text, const char *pattern) {
  g_autofree char *path = in_folder("bad.sp", text);
  g_autofree char *map = g_strdup_printf(", models: '%s'", path);
  assert_refused(map, 1, pattern);
}

static void test_refused(void) {
  gates_prepare();
  assert_refused(", state: after", 0, "a mask is needed for state 'after'");
  leq[0] = NAN;
  assert_refused(
      "", 1, "netlist device 'MN' has no size: the gate '*' does not print");
  leq[0] = 62;
  flags[0] = EDA_PRINT_OPEN;
  assert_refused("", 1, "netlist device 'MN' *:1' does not print well");
  flags[0] = EDA_PRINT_NECK;
  g_autofree char *fine = netlist_annotate("", 1, 0);
  flags[0] = 0;
  eda_gates other = *circuit.gates;
  mask.gates = &other;
  assert_refused("", 1, "the mask and the circuit belong to different gates");
  mask.gates = circuit.gates;
  assert_refused(", nmos: ''", 0, "*'' is not a model name");
  assert_refused(", nmos: 'n m'", 0, "*'n m' is not a model name");
  assert_refused(", pmos: \"p\\nm\"", 0, "*is not a model name");
  refused_card("*\n", "'*bad.sp' has no model 'nmos'");
  refused_card(".model nmos nmos level=54 toxe='2*t'\n",
               "*:1:1: model 'nmos' has no cgso, without which a DLC would "
               "change other properties");
  refused_card("*\n.model nmos pmos level=54\n",
               "*bad.sp:2:13: model 'nmos' is not of the type nmos");
  refused_card("*\n.model nmos nmos level=1\n",
               "*bad.sp:2:24: a model of level 1 has no DLC*");
  refused_card("*\n.model nmos nmos lint=1n\n",
               "*:2:1: model 'nmos' has no level");
  refused_card("*\n.model nmos nmos level=54 lint=x\n",
               "*:2:32: 'x' is not a number");
  refused_card("*\n.model nmos nmos level=54 dlc=1e999\n",
               "*bad.sp:2:*: '1e999' is too large");
  refused_card("*\n.model nmos nmos level=54 lint=-1e300\n",
               "*bad.sp:2:*: '-1e300' is too large");
  refused_card("*\n.model nmos nmos level=54 toxe=1e-300 xj=1e300\n",
               "*bad.sp:2:1: cgso of model 'nmos' would not be finite");
  refused_card("*\n.model nmos nmos level=54 lint\n",
               "*:2:27: 'lint' is not of the form NAME=VALUE");
  refused_card("*\n.model nmos nmos level=54\n.model nmos nmos level=54\n",
               "*:3:8: 'nmos' is already defined");
}

/* ---- the simulator ---- */

/* Return the values of all lines "NAME = NUMBER" in the output of ngspice, in
   order. */
static GArray *deck_simulate(const char *deck) {
  g_autofree char *program = g_find_program_in_path("ngspice");
  if (!program) {
    g_test_skip("no ngspice");
    return NULL;
  }
  g_autofree char *path = in_folder("deck.sp", deck);
  char *argv[] = {program, (char *)"-n", (char *)"-b", path, NULL};
  g_autofree char *out = NULL, *err = NULL;
  g_assert_true(
      g_spawn_sync(NULL, argv, NULL, 0, NULL, NULL, &out, &err, NULL, NULL));
  GArray *list = g_array_new(FALSE, FALSE, sizeof(double));
  g_auto(GStrv) lines = g_strsplit(out, "\n", -1);
  for (char **l = lines; *l; l++) {
    char *equals = strstr(*l, " = ");
    double v;
    if (equals && (*l)[0] == 'q' && sscanf(equals + 3, "%lf", &v) == 1)
      g_array_append_val(list, v);
  }
  if (!list->len) g_error("%s\n%s", out, err);
  return list;
}

/* Return the current at full drive and the gate capacitance of an
   n-transistor. */
static GArray *current_and_capacitance(const char *cards, const char *models,
                                       const char *transistor) {
  g_autofree char *deck = g_strdup_printf(
      "* deck\n%s\n%s\nVD d 0 1.1\nVG g 0 1.1 ac 1\nVE e 0 0\nVH h 0 1.1 ac 1\n"
      "M1 d g 0 0 %s\nM2 e h 0 0 %s\n.control\nset num_threads=1\nop\nlet "
      "qi=-i(vd)\nprint qi\n"
      "ac lin 1 1e6 1e6\nlet qc=abs(imag(i(vh)))*1e9/6.2831853\nprint "
      "qc\n.endc\n.end\n",
      cards, models, transistor, transistor);
  return deck_simulate(deck);
}

#define AT(array, i) g_array_index(array, double, i)

/* Test equation 3.13: the current is that of Leq, and the capacitance is that
   of a transistor of length area / Weq. */
static void test_capacitance(void) {
  gates_prepare();
  g_autofree char *cards = in_folder("cards.sp", card);
  g_autofree char *map = g_strdup_printf(", models: '%s'", cards);
  g_autofree char *text = netlist_annotate(map, 1, 0);
  *strstr(text, ".subckt") = '\0';
  g_autoptr(GArray) plain = current_and_capacitance(card + strlen("* cards\n"),
                                                    "", "nmos w=210n l=62n");
  if (!plain) return;
  g_autoptr(GArray) with = current_and_capacitance(
      card + strlen("* cards\n"), text, "nmos_dlc250 w=210n l=62n");
  g_autoptr(GArray) mean = current_and_capacitance(card + strlen("* cards\n"),
                                                   "", "nmos w=210n l=57n");
  g_test_message("current %g %g %g A, capacitance %g %g %g fF", AT(plain, 0),
                 AT(with, 0), AT(mean, 0), AT(plain, 1), AT(with, 1),
                 AT(mean, 1));
  g_assert_cmpfloat(fabs(AT(with, 0) / AT(plain, 0) - 1), <, 1e-5);
  g_assert_cmpfloat(fabs(AT(with, 1) / AT(mean, 1) - 1), <, 2e-3);
  g_assert_cmpfloat(fabs(AT(plain, 1) / AT(mean, 1) - 1), >, 0.02);
}

/* Test that drawn sizes give the results of the original netlist. */
static void test_drawn(void) {
  gates_prepare();
  static const char *const original =
      ".subckt inv in out vdd vss\n"
      "mn out in vss vss nmos w=0.2u l=0.06u\n"
      "mp out in vdd vdd pmos w=0.3u l=0.06u\n.ends\n";
  static const char *const rest =
      "VDD s 0 1.1\nVI i 0 0.45\nX1 i o s 0 inv\nRL o 0 100k\n.control\nset "
      "num_threads=1\nop\n"
      "let qv=v(o)\nprint qv\nlet qi=i(vdd)\nprint qi\ntf v(o) vi\n"
      "let qt=transfer_function\nprint qt\n.endc\n.end\n";
  g_autofree char *text = netlist_annotate("", 0, 0);
  g_autofree char *deck = g_strdup_printf("* deck\n%s%s%s", card, text, rest);
  g_autofree char *deck0 =
      g_strdup_printf("* deck\n%s%s%s", card, original, rest);
  g_autoptr(GArray) got = deck_simulate(deck);
  if (!got) return;
  g_autoptr(GArray) wanted = deck_simulate(deck0);
  g_assert_cmpuint(got->len, ==, wanted->len);
  g_assert_cmpuint(got->len, >=, 2);
  g_test_message("%g V %g A", AT(got, 0), AT(got, 1));
  g_assert_cmpfloat(AT(got, 0), >, 0.05);
  g_assert_cmpfloat(AT(got, 0), <, 1.05);
  for (guint i = 0; i < got->len; i++)
    g_assert_cmpfloat(fabs(AT(got, i) / AT(wanted, i) - 1), <, 1e-5);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/annotate/text", test_text);
  g_test_add_func("/annotate/kit", test_kit);
  g_test_add_func("/annotate/own-models", test_own_models);
  g_test_add_func("/annotate/dlc", test_dlc);
  g_test_add_func("/annotate/overlap", test_overlap);
  g_test_add_func("/annotate/fingers", test_fingers);
  g_test_add_func("/annotate/refused", test_refused);
  g_test_add_func("/annotate/capacitance", test_capacitance);
  g_test_add_func("/annotate/drawn", test_drawn);
  return g_test_run();
}
