/* SPDX-License-Identifier: BSD-3-Clause */
/* Small test circuits, and functions that run circuit.ngspice or plain ngspice
   on the circuits. */
#pragma once

#include <eda/circuit.h>
#include <eda/simulator.h>
#include <glib/gstdio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/data.h"
#include "tools/devel/testing.h"

/* ---- circuits ---- */

enum { MOST = 32 };

/* Circuit with one gate for each transistor, and printed sizes. */
typedef struct made {
  eda_gates gates;
  eda_circuit circuit;
  eda_mask mask;
  double width[MOST], length[MOST], leq[2][MOST], off[2][MOST], weq[2][MOST],
      area[2][MOST];
  uint32_t finger[MOST], number[MOST], flags[MOST], port[MOST];
  uint8_t role[MOST];
  char *path[MOST], *cell[MOST];
  const char *net[MOST];
  eda_device device[MOST];
  GStringChunk *text;
} made;

static inline uint32_t net_of(made *m, const char *name) {
  uint32_t i = 0;
  while (i < m->circuit.nets && strcmp(m->net[i], name)) i++;
  if (i == m->circuit.nets)
    m->net[m->circuit.nets++] = g_string_chunk_insert(m->text, name);
  return i;
}

static inline void set_printed(made *m) {
  eda_performance *p[2] = {&m->mask.before, &m->mask.after};
  for (int s = 0; s < 2; s++)
    *p[s] = (eda_performance){.count = m->gates.count,
                              .leq_ion = m->leq[s],
                              .leq_ioff = m->off[s],
                              .weq = m->weq[s],
                              .area = m->area[s]};
}

static inline void add_device(made *m, const char *line) {
  g_auto(GStrv) w = g_strsplit(line, " ", -1);
  size_t i = m->circuit.count++;
  g_assert_cmpuint(i, <, MOST);
  g_assert_cmpuint(g_strv_length(w), ==, 8);
  m->length[i] = atof(w[6]);
  m->width[i] = atof(w[7]);
  for (int s = 0; s < 2; s++) {
    m->leq[s][i] = m->off[s][i] = m->length[i];
    m->weq[s][i] = m->width[i];
    m->area[s][i] = m->length[i] * m->width[i];
  }
  m->finger[i] = (uint32_t)i;
  m->number[i] = (uint32_t)i + 1;
  m->path[i] = (char *)"";
  m->cell[i] = (char *)"made";
  m->device[i] = (eda_device){.name = g_string_chunk_insert(m->text, w[0]),
                              .drain = net_of(m, w[1]),
                              .gate = net_of(m, w[2]),
                              .source = net_of(m, w[3]),
                              .bulk = net_of(m, w[4]),
                              .length = m->length[i],
                              .width = m->width[i],
                              .type = *w[5] == 'p' ? EDA_PMOS : EDA_NMOS,
                              .fingers = 1,
                              .finger = &m->finger[i]};
}

/* Return a circuit. Ports: "A:i Y:o VDD:s VSS:g". Devices, separated by commas:
   "MN1 drain gate source bulk n L W", L and W in nm. */
static inline made *circuit_make(const char *ports, const char *devices) {
  static const char letters[] = {[EDA_PIN_INPUT] = 'i',
                                 [EDA_PIN_OUTPUT] = 'o',
                                 [EDA_PIN_SUPPLY] = 's',
                                 [EDA_PIN_GROUND] = 'g'};
  made *m = g_new0(made, 1);
  m->text = g_string_chunk_new(256);
  m->gates = (eda_gates){.width = m->width,
                         .length = m->length,
                         .instance = m->path,
                         .cell = m->cell,
                         .number = m->number};
  m->circuit = (eda_circuit){.name = "made",
                             .gates = &m->gates,
                             .net = m->net,
                             .port = m->port,
                             .role = m->role,
                             .device = m->device};
  m->mask = (eda_mask){.gates = &m->gates, .flags = m->flags};
  g_auto(GStrv) p = g_strsplit(ports, " ", -1);
  g_auto(GStrv) d = g_strsplit(devices, ",", -1);
  for (char **at = p; *at; at++) {
    char *colon = strchr(*at, ':');
    *colon = 0;
    m->port[m->circuit.ports] = net_of(m, *at);
    for (uint8_t role = 0; role < 4; role++)
      if (letters[role] == colon[1]) m->role[m->circuit.ports] = role;
    m->circuit.ports++;
  }
  for (char **at = d; *at; at++) add_device(m, *at);
  m->gates.count = m->circuit.count;
  set_printed(m);
  return m;
}

static inline void made_free(made *m) {
  g_string_chunk_free(m->text);
  g_free(m);
}
G_DEFINE_AUTOPTR_CLEANUP_FUNC(made, made_free)

#define INVERTER "MN Y A VSS VSS n 65 300,MP Y A VDD VDD p 65 450"
#define NAND                                         \
  "MN1 VSS A X VSS n 65 400,MN2 Y B X VSS n 65 400," \
  "MP1 Y A VDD VDD p 65 450,MP2 Y B VDD VDD p 65 450"
/* Both halves of the cell have different sizes, so that the left and right
   margins differ. */
#define MEMORY                                            \
  "MA1 Q WL BL VSS n 65 140,MD1 Q QB VSS VSS n 65 300,"   \
  "ML1 Q QB VDD VDD p 65 105,MA2 QB WL BLB VSS n 65 140," \
  "MD2 QB Q VSS VSS n 65 330,ML2 QB Q VDD VDD p 65 160"
#define MEMORY_PORTS "WL:i BL:o BLB:o VDD:s VSS:g"

/* ---- running ---- */

/* Return 1 if ngspice is available; otherwise mark the test as skipped and
   return 0. The ngspice library may be missing, although the program that loads
   the library is always built. */
static inline int have_ngspice(void) {
  static int missing = -1;
  static opc_error error;
  eda_spice_result r;
  if (missing < 0) {
    missing = eda_spice_run(NULL, "t\nv1 a 0 1\n.end", "op", 20, &r, &error) &&
              strstr(error.message, "libngspice");
    eda_spice_clear(&r);
  }
  if (missing) g_test_skip(error.message);
  return !missing;
}

static inline char *of_project(const char *name) {
  g_autofree char *path = source_path(name);
  return realpath(path, NULL);
}

static inline char *test_data(const char *name) {
  g_autofree char *path = find_data(name);
  return path ? realpath(path, NULL) : NULL;
}

static inline char *in_folder(const char *name, const char *text) {
  char *path = g_build_filename(opc_test_folder(), name, NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  return path;
}

static inline int run_on(eda_circuit *circuit, eda_mask *mask, const char *card,
                         const char *rest, opc_error *error) {
  static int n;
  void *none[1];
  opc_test_forget();
  g_autofree char *map = g_strdup_printf(
      "{ %s: '%s', supply: 1.1 V, picture: p%d.png, %s }",
      g_str_has_suffix(card, ".lib") ? "library" : "models", card, n++, rest);
  g_autoptr(opc_module) m = opc_test_module("circuit.ngspice", map, error);
  if (!m) return error->code;
  opc_test_input(m, "circuit", circuit);
  if (mask) opc_test_input(m, "mask", mask);
  return opc_test_run(m, none, error);
}

static inline void circuit_run(made *m, int with_mask, const char *card,
                               const char *rest) {
  opc_error error;
  if (run_on(&m->circuit, with_mask ? &m->mask : NULL, card, rest, &error))
    g_error("%s", error.message);
}

static inline void assert_refused(made *m, int with_mask, const char *card,
                                  const char *rest, const char *pattern) {
  opc_error error;
  if (!run_on(&m->circuit, with_mask ? &m->mask : NULL, card, rest, &error))
    g_error("'%s' works", rest);
  g_test_message("%s", error.message);
  if (!g_pattern_match_simple(pattern, error.message))
    g_error("'%s' is not '%s'", error.message, pattern);
}

#define NANGATE_CARDS "models/freepdk45/nom/"

/* Read a NanGate cell from GDS and CDL, then run circuit.ngspice on the cell
   with the drawn sizes and the FreePDK cards. Return the netlist of the cell as
   the subcircuit `cell`, with the card of the p-transistor. Without the data or
   ngspice, mark the test as skipped and return NULL. */
static inline char *run_nangate(const char *name) {
  g_autofree char *gds = test_data("nangate45/NangateOpenCellLibrary.gds");
  g_autofree char *cdl = test_data("nangate45/NangateOpenCellLibrary.cdl");
  g_autofree char *n_card = test_data(NANGATE_CARDS "NMOS_VTL.inc");
  g_autofree char *p_card = test_data(NANGATE_CARDS "PMOS_VTL.inc");
  if (!gds || !cdl || !n_card || !p_card || !have_ngspice()) return NULL;
  opc_error error;
  void *object[3] = {NULL};
  opc_module *m[3];
  static const char *const ids[] = {"read.gds", "segment.transistors",
                                    "netlist.match"};
  g_autofree char *layout = g_strdup_printf(
      "{ file: '%s', top: %s, layers: { poly: 9/0, active: 1/0, contact: "
      "10/0, nwell: 3/0 } }",
      gds, name);
  g_autofree char *netlist = g_strdup_printf("{ file: '%s' }", cdl);
  const char *maps[] = {layout, "{ grid: 0.5 nm }", netlist};
  for (int i = 0; i < 3; i++) {
    m[i] = opc_test_module(ids[i], maps[i], &error);
    if (!m[i]) g_error("%s", error.message);
    if (i) opc_test_input(m[i], "layout", object[0]);
    if (i == 2) opc_test_input(m[i], "gates", object[1]);
    if (opc_test_run(m[i], &object[i], &error)) g_error("%s", error.message);
  }
  g_autofree char *rest = g_strdup_printf(
      "pmos_models: '%s', nmos: NMOS_VTL, pmos: PMOS_VTL, slew: 20 ps, "
      "load: 4 fF",
      p_card);
  if (run_on(object[2], NULL, n_card, rest, &error))
    g_error("%s", error.message);
  for (int i = 2; i >= 0; i--) {
    opc_test_release(m[i], &object[i]);
    opc_test_module_free(m[i]);
  }
  g_autofree char *text = NULL;
  g_autofree char *title = g_strdup_printf(".SUBCKT %s ", name);
  g_assert_true(g_file_get_contents(cdl, &text, NULL, NULL));
  const char *from = strstr(text, title);
  g_assert_nonnull(from);
  from += strlen(title);
  return g_strdup_printf(".include \"%s\"\n.subckt cell %.*s.ends\n", p_card,
                         (int)(strstr(from, ".ENDS") - from), from);
}

/* Return the output of the command `ngspice` for a deck; without the command,
   skip the test and return NULL. */
static inline char *by_hand(const char *deck) {
  g_autofree char *program = g_find_program_in_path("ngspice");
  if (!program) {
    g_test_skip("no command 'ngspice'");
    return NULL;
  }
  g_autofree char *path = in_folder("hand.sp", deck);
  char *argv[] = {program, (char *)"-n", (char *)"-b", path, NULL};
  /* ngspice evaluates transistor models in two OpenMP threads by default. The
     passive policy avoids busy waiting of these threads. */
  g_auto(GStrv) environment =
      g_environ_setenv(g_get_environ(), "OMP_WAIT_POLICY", "passive", TRUE);
  char *out = NULL;
  g_assert_true(g_spawn_sync(opc_test_folder(), argv, environment,
                             G_SPAWN_STDERR_TO_DEV_NULL, NULL, NULL, &out, NULL,
                             NULL, NULL));
  return out;
}

/* Return the value of a line "NAME = VALUE" of the output. */
static inline double printed_value(const char *out, const char *name) {
  g_autofree char *pattern = g_strdup_printf("(?m)^%s\\s*=\\s*(\\S+)", name);
  g_autoptr(GRegex) regex = g_regex_new(pattern, 0, 0, NULL);
  g_autoptr(GMatchInfo) match = NULL;
  if (!g_regex_match(regex, out, 0, &match))
    g_error("no '%s' in\n%s", name, out);
  g_autofree char *value = g_match_info_fetch(match, 1);
  return g_ascii_strtod(value, NULL);
}

static inline void assert_near(const char *what, double got, double want,
                               double share) {
  g_test_message("%s: %.6g, by hand %.6g, %+.4f %%", what, got, want,
                 100 * (got / want - 1));
  if (!(fabs(got / want - 1) <= share)) g_error("%s", what);
}
