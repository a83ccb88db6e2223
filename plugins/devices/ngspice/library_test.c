/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests tables from libraries: a small library with all values of `ends`,
   compiled models, and tables of open processes, read by extractor.plain,
   against plain ngspice. */
#include <eda/curves.h>
#include <eda/devices.h>
#include <eda/extractor.h>
#include <math.h>
#include <string.h>

#include "plain_test.h"
#include "tests/data.h"

/* ---- a library of our own ---- */

/* Two bins, from 100 and 150 nm of length and from 1 um of width. */
#define BINS(kind, vth)                                                \
  ".subckt " kind                                                      \
  " d g s b\n.param l=1 w=1\nm1 d g s b c l={l} w={w}\n"               \
  ".model c.1 " kind                                                   \
  "mos level=54 version=4.5 toxe=2n lpe0=0 k3=0 lmin=1e-7 lmax=1.5e-7" \
  " wmin=1e-6 wmax=1e-4 wint=5n vth0=" vth                             \
  "\n"                                                                 \
  ".model c.2 " kind                                                   \
  "mos level=54 version=4.5 toxe=2n lpe0=0 k3=0 lmin=1.5e-7 lmax=1e-6" \
  " wmin=1e-6 wmax=1e-4 wint=5n vth0=" vth "\n.ends\n"

static const char library[] =
    ".lib tt\n.option scale=1u\n.param v={agauss(0.4,0.5,1)}\n" BINS("n", "{v}")
        BINS("p", "{-v}") ".endl\n";

static int make_of(const char *nmos, const char *rest, const char *table,
                   opc_error *error) {
  static int n;
  void *no_outputs[1];
  g_autofree char *path = g_build_filename(opc_test_folder(), "own.lib", NULL);
  g_assert_true(g_file_set_contents(path, library, -1, NULL));
  opc_test_forget();
  g_autofree char *mapping = g_strdup_printf(
      "{ library: %s, corner: tt, nmos: %s, pmos: p, supply: 1 V, file: %s, "
      "picture: l%d.png, %s }",
      path, nmos, table, n++, rest);
  g_autoptr(opc_module) m = opc_test_module("devices.ngspice", mapping, error);
  if (!m) return error->code;
  return opc_test_run(m, no_outputs, error);
}

static int table_make(const char *rest, const char *table, opc_error *error) {
  return make_of("n", rest, table, error);
}

static eda_devices *table_load(const char *table) {
  opc_error error;
  g_autofree char *path = g_build_filename(opc_test_folder(), table, NULL);
  eda_devices *d = eda_devices_read(path, &error);
  if (!d) g_error("%s", error.message);
  return d;
}

#define SHORT "length: { from: 80 nm, to: 200 nm, step: 10 nm }"

static void test_ends(void) {
  opc_error error;
  if (!have_ngspice()) return;
  if (table_make(SHORT, "cut.yaml", &error)) g_error("%s", error.message);
  eda_devices *cut = table_load("cut.yaml");
  g_assert_cmpfloat(cut->length[0], ==, 100);
  g_assert_nonnull(
      strstr(opc_test_log(), "the library has no bin for the size"));
  /* For three widths with equal valid lengths, each current of each type is
     reported once. */
  opc_test_forget();
  if (table_make(SHORT ", widths: [2 um, 3 um, 4 um]", "wide.yaml", &error))
    g_error("%s", error.message);
  int warnings = 0;
  for (const char *at = opc_test_log(); (at = strstr(at, "no bin")); at++)
    warnings++;
  g_assert_cmpint(warnings, ==, 4);
  g_assert_cmpint(table_make(SHORT ", ends: refuse", "no.yaml", &error), ==,
                  OPC_FAILED);
  g_assert_nonnull(
      strstr(error.message, "at 90 nm: the library has no bin for the size"));
  if (table_make(SHORT ", ends: extend", "more.yaml", &error))
    g_error("%s", error.message);
  eda_devices *more = table_load("more.yaml");
  g_assert_nonnull(
      strstr(opc_test_log(), "shorter than 100 nm by the last bin"));
  if (table_make(SHORT ", ends: slope", "slope.yaml", &error))
    g_error("%s", error.message);
  eda_devices *slope = table_load("slope.yaml");
  g_assert_nonnull(strstr(opc_test_log(), "shorter than 100 nm by the slope"));
  g_assert_cmpfloat(more->length[0], ==, 80);
  g_assert_cmpfloat(slope->length[0], ==, 80);
  for (int t = 0; t < 2; t++) {
    /* The bins begin at 100 nm. */
    g_assert_cmpfloat(cut->modelled[t], ==, 0);
    g_assert_cmpfloat(more->modelled[t], ==, 100);
    g_assert_cmpfloat(slope->modelled[t], ==, 100);
    for (size_t i = 0; i < cut->count; i++) {
      g_assert_cmpfloat(cut->ion[t][i], ==, more->ion[t][i + 2]);
      g_assert_cmpfloat(cut->ion[t][i], ==, slope->ion[t][i + 2]);
    }
    double step = slope->ion[t][2] / slope->ion[t][3];
    g_assert_cmpfloat(fabs(slope->ion[t][1] / slope->ion[t][2] / step - 1), <,
                      1e-5);
    g_assert_cmpfloat(more->ion[t][0], >, more->ion[t][1]);
    /* The logarithm of the model's current is not linear in the length. */
    g_assert_cmpfloat(fabs(more->ion[t][0] / slope->ion[t][0] - 1), >, 1e-3);
  }
  eda_devices_free(cut);
  eda_devices_free(more);
  eda_devices_free(slope);
}

/* wint subtracts 5 nm on each side of W and has no other effect. Therefore the
   current is proportional to W - 10 nm, also for widths without a bin. */
static void test_widths(void) {
  static const double widths[] = {500, 1000, 1500, 3000};
  opc_error error;
  if (!have_ngspice()) return;
  if (table_make(
          "length: { list: [100 nm, 120 nm, 140 nm] }, ends: slope, widths: "
          "[500 nm, 1000 nm, 1500 nm, 3000 nm]",
          "w.yaml", &error))
    g_error("%s", error.message);
  g_assert_nonnull(
      strstr(opc_test_log(), "narrower than 1000 nm by the slope"));
  eda_devices *d = table_load("w.yaml");
  g_assert_cmpuint(d->narrow, ==, 3);
  g_assert_cmpfloat(d->width, ==, 3000);
  for (int t = 0; t < 2; t++)
    for (size_t w = 0; w < 3; w++)
      for (size_t i = 0; i < d->count; i++) {
        double part = d->narrow_ion[t][w * d->count + i] / d->ion[t][i];
        double want = (1 - 10 / widths[w]) / (1 - 10 / widths[3]);
        g_assert_cmpfloat(d->narrow_width[w], ==, widths[w]);
        if (!(fabs(part / want - 1) < 3e-4))
          g_error("W %g nm: %g, not %g", widths[w], part, want);
      }
  eda_devices_free(d);
}

/* ---- compiled models ---- */

#define SQUARE(name, type)                                                  \
  ".subckt " name                                                           \
  " d g s b w=1u l=1u\nn1 d g s b m w=w l=l\n.model m squarelaw type=" type \
  " k=1m vt=0.4 leak=1n\n.ends\n"

/* A square-law model with the OSDI interface, compared with the equations of
   the model. If ngspice has no OSDI support, test the error message. */
static void test_osdi(void) {
  opc_error error;
  void *no_outputs[1];
  if (!have_ngspice()) return;
  g_autofree char *path = g_build_filename(opc_test_folder(), "sq.lib", NULL);
  g_autofree char *osdi =
      g_build_filename(g_getenv("OPCFLOW_BUILD"), "subprojects", "eda",
                       "simulator", "square.osdi", NULL);
  g_assert_true(g_file_set_contents(
      path, ".lib tt\n" SQUARE("n", "1") SQUARE("p", "-1") ".endl\n", -1,
      NULL));
  g_autofree char *mapping = g_strdup_printf(
      "{ library: %s, corner: tt, osdi: %s, nmos: n, pmos: p, supply: 1 V, "
      "length: { list: [100 nm, 120 nm, 140 nm] }, width: 500 nm, file: "
      "sq.yaml, picture: sq.png }",
      path, osdi);
  g_autoptr(opc_module) m = opc_test_module("devices.ngspice", mapping, &error);
  if (!m) g_error("%s", error.message);
  int code = opc_test_run(m, no_outputs, &error);
  if (code == OPC_NO_PLUGIN) {
    g_assert_nonnull(strstr(error.message, "compiled models (OSDI)"));
    g_test_skip(error.message);
    return;
  }
  if (code) g_error("%s", error.message);
  eda_devices *d = table_load("sq.yaml");
  for (int t = 0; t < 2; t++)
    for (size_t i = 0; i < 3; i++) {
      double on = 1 / d->length[i] * (1e-3 / 2 * 0.6 * 0.6 + 1e-9);
      double off = 1 / d->length[i] * 1e-9; /* leakage per nm of width */
      g_assert_cmpfloat(fabs(d->ion[t][i] / on - 1), <, 2e-6);
      g_assert_cmpfloat(fabs(d->ioff[t][i] / off - 1), <, 2e-6);
    }
  eda_devices_free(d);
}

/* ---- capacitance of the gate ---- */

/* Return the gate charge of a transistor driven from 0 to `supply` within 1 ns,
   divided by `supply`. In a transient, the `ngspice` command integrates the
   gate current on a capacitor of 1 fF, with the accuracy of charges. Leakage is
   negligible. Return NAN if the command is missing. */
static double charge(const char *models, const char *name, int type,
                     double length, double width, double supply) {
  double v = type ? -supply : supply;
  g_autofree char *deck = g_strdup_printf(
      "by hand\n.lib \"%s\" tt\n.options gmin=1e-20 reltol=1e-5\n"
      "x1 d g 0 0 %s l=%.9g w=%.9g\nvd d 0 %g\n"
      "vg g 0 pwl(0 0 0.1n 0 1.1n %g 1.2n %g)\n"
      "f1 0 gathered vg 1\nc1 gathered 0 1f\nr1 gathered 0 1e12\n.control\n"
      "set numdgt=12\n"
      "tran 20p 1.2n 0 20p\nlet n = length(v(gathered)) - 1\n"
      "let taken = v(gathered)[n] - v(gathered)[0]\nprint taken\n.endc\n"
      ".end\n",
      models, name, length / 1000, width / 1000, v, v, v);
  g_autofree char *out = by_hand(deck);
  if (!out) return NAN;
  const char *at = strstr(out, "taken = ");
  if (!at) g_error("%s", out);
  return fabs(1e-15 * g_ascii_strtod(at + 8, NULL)) / supply;
}

/* Compare transistors between the lengths and widths of the table. */
static void compare_charge(const char *table, const char *models,
                           const char *const names[2], double voltage,
                           const double sizes[][2], size_t count) {
  eda_devices *d = table_load(table);
  double worst = 0;
  for (size_t i = 0; i < 2 * count; i++) {
    int type = i % 2;
    double length = sizes[i / 2][0], width = sizes[i / 2][1];
    double got = eda_devices_cgate(d, type, length, width);
    double want = charge(models, names[type], type, length, width, voltage);
    if (isnan(want)) {
      g_test_skip("no command 'ngspice'");
      break;
    }
    worst = fmax(worst, fabs(got / want - 1));
    if (!(fabs(got / want - 1) < 5e-4))
      g_error("%c, L %g W %g nm: %g F, not %g F (%+.3f %%)", "np"[type], length,
              width, got, want, 100 * (got / want - 1));
  }
  g_test_message("Cgate: at most %.4f %% off", 100 * worst);
  eda_devices_free(d);
}

static void test_capacitance(void) {
  static const char *const names[2] = {"n", "p"};
  static const double sizes[][2] = {{105, 1234}, {127, 1600}, {144, 2900}};
  opc_error error;
  if (!have_ngspice()) return;
  if (table_make("length: { list: [100 nm, 110 nm, 120 nm, 135 nm, 149 nm] }, "
                 "capacitance: true, widths: [1 um, 1.5 um, 3 um], "
                 "reference: { length: 120 nm, width: 1.5 um }",
                 "c.yaml", &error))
    g_error("%s", error.message);
  /* Plain ngspice would use random values. */
  g_auto(GStrv) parts = g_strsplit(library, "{agauss(0.4,0.5,1)}", 2);
  g_autofree char *nominal = g_strjoinv("0.4", parts);
  g_autofree char *path = g_build_filename(opc_test_folder(), "nom.lib", NULL);
  g_assert_true(g_file_set_contents(path, nominal, -1, NULL));
  compare_charge("c.yaml", path, names, 1, sizes, G_N_ELEMENTS(sizes));
  eda_devices *d = table_load("c.yaml");
  for (int t = 0; t < 2; t++) {
    double want = eda_devices_cgate(d, t, 120, 1500);
    double got = opc_test_metric(t ? "cgate_p" : "cgate_n");
    g_assert_cmpfloat(fabs(got / want - 1), <, 1e-6);
  }
  eda_devices_free(d);
}

static void assert_refused(const char *rest, const char *why) {
  opc_error error;
  int code = table_make(rest, "refused.yaml", &error);
  if (!code || !strstr(error.message, why))
    g_error("'%s' does not say '%s'", code ? error.message : "", why);
}

static void test_refused(void) {
  assert_refused(SHORT ", widths: [1 um]", "2 to 200 widths, found 1");
  assert_refused(SHORT ", widths: [2 um, 1 um]", "widths must increase");
  g_autofree char *both =
      g_strdup_printf(SHORT ", card: %s/own.lib", opc_test_folder());
  assert_refused(both, "exclude each other");
  opc_error error;
  g_assert_cmpint(make_of("q", SHORT, "q.yaml", &error), ==, OPC_INVALID);
  g_assert_nonnull(
      strstr(error.message, "neither a subcircuit nor a model 'q'"));
  assert_refused(SHORT ", overrides: { vth0: 1 }",
                 "'overrides' require 'card'");
}

/* ---- open processes: shipped tables against the kits' models ---- */

enum { GATES = 40 };

typedef struct process {
  const char *name, *library, *corner;
  const char *osdi; /* may be NULL */
  const char *model[2], *flavour[2];
  double supply;               /* V */
  double unit;                 /* unit of sizes in the decks, nm */
  double length[2], width[2];  /* range of gate sizes (from, to), nm */
  double abstol[EDA_CURRENTS]; /* current tolerances, A: the accuracy of the
                                  models */
} process;

/* Lengths and widths of the cells, and 10 % beyond; for SkyWater, only sizes
   within the bins. */
static const process sky130 = {
    "sky130",
    "sky130/models/sky130.lib.spice",
    "tt",
    NULL,
    {"sky130_fd_pr__nfet_01v8", "sky130_fd_pr__pfet_01v8_hvt"},
    {NULL, "hvt"},
    1.8,
    1000,
    {150, 165},
    {420, 1100},
    {1e-19, 1e-19}};
static const process ihp130 = {"ihp130",
                               "ihp130/models/cornerMOSlv.lib",
                               "mos_tt",
                               "ihp130/models/psp103.osdi",
                               {"sg13_lv_nmos", "sg13_lv_pmos"},
                               {NULL, NULL},
                               1.2,
                               1e9,
                               {117, 143},
                               {135, 1232},
                               {1e-15, 1e-19}};

typedef struct gate {
  uint8_t type;
  double length, width;
} gate;

static void make_gates(const process *p, gate gates[GATES]) {
  g_autoptr(GRand) lot = g_rand_new_with_seed(130);
  for (int i = 0; i < GATES; i++)
    gates[i] = (gate){(uint8_t)(i % 2),
                      g_rand_double_range(lot, p->length[0], p->length[1]),
                      g_rand_double_range(lot, p->width[0], p->width[1])};
}

/* Simulate one current of all gates with the `ngspice` command and the whole
   library. If the command or the library is missing, skip the test and return
   0. */
static int gates_simulate(const process *p, const gate gates[GATES],
                          int current, double out[GATES]) {
  g_autofree char *lib = find_data(p->library);
  g_autofree char *osdi = lib && p->osdi ? find_data(p->osdi) : NULL;
  if (!lib || (p->osdi && !osdi)) return 0;
  g_autoptr(GString) deck = g_string_new("by hand\n");
  double on = current == EDA_ION ? p->supply : 0;
  g_string_append_printf(deck,
                         ".lib \"%s\" %s\n.options gmin=1e-20 reltol=1e-6 "
                         "abstol=%g\nvn n 0 %g\nvp p 0 %g\n",
                         lib, p->corner, p->abstol[current], on, -on);
  for (int i = 0; i < GATES; i++)
    g_string_append_printf(
        deck, "x%d d%d %s 0 0 %s l=%.9g w=%.9g\nv%d d%d 0 %g\n", i, i,
        gates[i].type ? "p" : "n", p->model[gates[i].type],
        gates[i].length / p->unit, gates[i].width / p->unit, i, i,
        gates[i].type ? -p->supply : p->supply);
  g_string_append(deck, ".control\n");
  if (osdi) g_string_append_printf(deck, "pre_osdi '%s'\n", osdi);
  g_string_append(deck, "set numdgt=12\nop\n");
  for (int i = 0; i < GATES; i++)
    g_string_append_printf(deck, "print i(v%d)\n", i);
  g_string_append(deck, ".endc\n.end\n");
  g_autofree char *text = by_hand(deck->str);
  if (!text) {
    g_test_skip("no command 'ngspice'");
    return 0;
  }
  const char *at = text;
  if (osdi && !strstr(at, ") = ")) {
    g_test_skip("the command 'ngspice' cannot load compiled models");
    return 0;
  }
  for (int k = 0; k < GATES; k++) {
    at = strstr(at, ") = ");
    if (!at) g_error("%s", text);
    out[k] = fabs(g_ascii_strtod(at += 4, NULL));
  }
  return 1;
}

/* Compute the currents of rectangles, each in a few slices, by extractor.plain
   with the shipped table. */
static void gates_extract(const process *p, const gate gates[GATES],
                          double current[2][GATES]) {
  enum { SLICES = 12 };
  opc_error error;
  uint8_t type[GATES], outside[GATES];
  double length[GATES * SLICES], width[GATES * SLICES], edge[GATES * SLICES];
  double rest[4][GATES];
  const char *source = g_getenv("OPCFLOW_SOURCE"), *flavour[GATES];
  for (int i = 0; i < GATES; i++) {
    type[i] = gates[i].type;
    flavour[i] = p->flavour[type[i]];
    for (int k = 0; k < SLICES; k++) {
      length[i * SLICES + k] = gates[i].length;
      width[i * SLICES + k] = gates[i].width / SLICES;
      edge[i * SLICES + k] =
          gates[i].width * (0.5 - fabs((k + 0.5) / SLICES - 0.5));
    }
  }
  const eda_slices slices = {.count = GATES,
                             .slices = SLICES,
                             .type = type,
                             .width = width,
                             .length = length,
                             .edge = edge,
                             .flavour = flavour};
  eda_performance out = {GATES,   current[0], current[1], rest[0],
                         rest[1], rest[2],    rest[3],    outside};
  g_autofree char *mapping = g_strdup_printf(
      "{ devices: %s/data/devices/%s.yaml }", source ? source : ".", p->name);
  g_autoptr(opc_module) m = opc_test_module("extractor.plain", mapping, &error);
  if (!m) g_error("%s", error.message);
  const eda_extractor *e = m->functions;
  if (e->prepare(m->self, &error) || e->extract(m->self, &slices, &out, &error))
    g_error("%s", error.message);
  for (int i = 0; i < GATES; i++) g_assert_cmpuint(outside[i], ==, 0);
}

static void test_process(gconstpointer data) {
  static const double within[2] = {1e-3, 2e-2};
  const process *p = data;
  gate gates[GATES];
  double want[2][GATES], got[2][GATES], worst[2] = {0};
  make_gates(p, gates);
  for (int k = 0; k < EDA_CURRENTS; k++)
    if (!gates_simulate(p, gates, k, want[k])) return;
  gates_extract(p, gates, got);
  for (int k = 0; k < 2; k++) {
    for (int i = 0; i < GATES; i++) {
      double off = fabs(got[k][i] / want[k][i] - 1);
      worst[k] = fmax(worst[k], off);
      if (!(off < within[k]))
        g_error("%s of gate %d, %c, L %g W %g nm: %g A, not %g A (%+.3f %%)",
                k ? "Ioff" : "Ion", i, "np"[gates[i].type], gates[i].length,
                gates[i].width, got[k][i], want[k][i],
                100 * (got[k][i] / want[k][i] - 1));
    }
    g_test_message("%s: at most %.4f %% off", k ? "Ioff" : "Ion",
                   100 * worst[k]);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/library/ends", test_ends);
  g_test_add_func("/library/widths", test_widths);
  g_test_add_func("/library/osdi", test_osdi);
  g_test_add_func("/library/capacitance", test_capacitance);
  g_test_add_func("/library/refused", test_refused);
  g_test_add_data_func("/library/sky130", &sky130, test_process);
  g_test_add_data_func("/library/ihp130", &ihp130, test_process);
  return g_test_run();
}
