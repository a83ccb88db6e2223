/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests tables against cards with known results, hand-written decks run by
   plain ngspice, and results of extractor.plain with the computed table. */
#include <eda/devices.h>
#include <eda/extractor.h>
#include <math.h>
#include <string.h>

#include "plain_test.h"
#include "tests/data.h"

/* A BSIM4 card of few parameters, for tests independent of the process. */
#define SMALL(l)                                                \
  ".model n nmos level=54 version=4.5 toxe=2n vth0=0.4 lint=" l \
  "\n"                                                          \
  ".model p pmos level=54 version=4.5 toxe=2n vth0=-0.4 u0=0.01 lint=" l "\n"

/* Return the path of a card with that text, or of a file of the project or the
   test data; if missing, skip the test and return NULL. */
static char *card_of(const char *text) {
  static int n;
  g_autofree char *name = g_strdup_printf("card%d.pm", n++);
  char *path = g_build_filename(opc_test_folder(), name, NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  return path;
}

/* Run the step with the table `table` in the test's folder. */
static int run_step(const char *card, const char *rest, const char *table,
                    opc_error *error) {
  void *no_outputs[1];
  static int n;
  opc_test_forget();
  g_autofree char *mapping = g_strdup_printf(
      "{ card: %s, file: %s, picture: p%d.png, %s }", card, table, n++, rest);
  g_autoptr(opc_module) m = opc_test_module("devices.ngspice", mapping, error);
  if (!m) return error->code;
  return opc_test_run(m, no_outputs, error);
}

static eda_devices *table_load(const char *table) {
  opc_error error;
  g_autofree char *path = g_build_filename(opc_test_folder(), table, NULL);
  eda_devices *d = eda_devices_read(path, &error);
  if (!d) g_error("%s", error.message);
  return d;
}

/* ---- comparison with plain ngspice ---- */

/* Return the drain current of a deck run by the command `ngspice`; NAN if the
   command is missing. */
static double plain_current(const char *card, const char *model, double sign,
                            int on, double width, double length) {
  g_autofree char *deck = g_strdup_printf(
      "by hand\n.include \"%s\"\n"
      "m1 d g 0 0 %s w=%gn l=%gn\nvd d 0 %g\nvg g 0 %g\n"
      ".options gmin=1e-15 reltol=1e-6 abstol=1e-15\n"
      ".control\nset numdgt=12\nop\nprint i(vd)\n.endc\n.end\n",
      card, model, width, length, sign, on ? sign : 0);
  g_autofree char *out = by_hand(deck);
  if (!out) return NAN;
  const char *at = strstr(out, "i(vd) = ");
  if (!at) g_error("%s", out);
  return -sign * g_ascii_strtod(at + 8, NULL);
}

static void test_by_hand(void) {
  static const char *const models[] = {"n", "p"};
  opc_error error;
  if (!have_ngspice()) return;
  g_autofree char *card = card_of(SMALL("10n"));
  if (run_step(card,
               "nmos: n, pmos: p, supply: 1 V, length: { list: [50 nm, "
               "61.5 nm, 80 nm, 200 nm] }",
               "hand.yaml", &error))
    g_error("%s", error.message);
  g_assert_cmpstr(opc_test_log(), ==, "");
  eda_devices *d = table_load("hand.yaml");
  g_assert_cmpuint(d->count, ==, 4);
  g_assert_cmpfloat(d->supply, ==, 1);
  g_assert_cmpfloat(d->width, ==, 10000);
  for (int t = 0; t < 2; t++)
    for (size_t i = 0; i < d->count; i++)
      for (int on = 0; on < 2; on++) {
        double want =
            plain_current(card, models[t], t ? -1 : 1, on, 10000, d->length[i]);
        double got = (on ? d->ion : d->ioff)[t][i] * 10000;
        if (isnan(want)) {
          g_test_skip("no command 'ngspice'");
          eda_devices_free(d);
          return;
        }
        g_assert_cmpfloat(fabs(got / want - 1), <, 2e-6);
      }
  eda_devices_free(d);
}

/* ---- known tables ---- */

/* Thesis 2.2.1: Ion of an n-transistor with L 65, W 1000 is 1.152 mA. The
   shipped table must equal the computed table. */
static void test_thesis(void) {
  opc_error error;
  if (!have_ngspice()) return;
  g_autofree char *card = find_data("models/ptm/ptm_65nm_bulk.pm");
  if (!card) return;
  if (run_step(card,
               "supply: 1.1 V, length: { from: 44 nm, to: 120 nm }, "
               "overrides: { igbmod: 0 }, "
               "reference: { length: 65 nm, width: 1 um }",
               "ptm.yaml", &error))
    g_error("%s", error.message);
  double ion = opc_test_metric("ion_n");
  g_test_message("%.5f mA, %+.3f %% from 1.152", 1e3 * ion,
                 100 * (1e3 * ion / 1.152 - 1));
  g_assert_cmpfloat(fabs(1e3 * ion - 1.152), <, 0.0005);
  eda_devices *d = table_load("ptm.yaml");
  g_autofree char *path = source_path("data/devices/ptm65.yaml");
  eda_devices *shipped = eda_devices_read(path, &error);
  if (!shipped) g_error("%s", error.message);
  g_assert_cmpuint(d->count, ==, shipped->count);
  for (int t = 0; t < 2; t++)
    for (size_t i = 0; i < d->count; i++) {
      g_assert_cmpfloat(d->length[i], ==, shipped->length[i]);
      g_assert_cmpfloat(fabs(d->ion[t][i] / shipped->ion[t][i] - 1), <, 1e-5);
      g_assert_cmpfloat(fabs(d->ioff[t][i] / shipped->ioff[t][i] - 1), <, 1e-5);
    }
  eda_devices_free(d);
  eda_devices_free(shipped);
}

/* Compare our own card with the table to which the card was fitted. */
static void test_own_card(void) {
  opc_error error;
  if (!have_ngspice()) return;
  g_autofree char *card = source_path("data/devices/opcflow65.pm");
  if (run_step(card, "supply: 1.1 V, length: { from: 44 nm, to: 120 nm }",
               "own.yaml", &error))
    g_error("%s", error.message);
  eda_devices *d = table_load("own.yaml");
  g_autofree char *path = source_path("data/devices/ptm65.yaml");
  eda_devices *want = eda_devices_read(path, &error);
  if (!want) g_error("%s", error.message);
  for (int t = 0; t < 2; t++) {
    double on = 0, off = 0;
    size_t skip = want->count - d->count; /* both tables end at 120 nm */
    for (size_t i = 0; i < d->count; i++) {
      size_t k = i + skip;
      g_assert_cmpfloat(d->length[i], ==, want->length[k]);
      if (d->length[i] < 55 || d->length[i] > 80) continue;
      on = fmax(on, fabs(d->ion[t][i] / want->ion[t][k] - 1));
      off = fmax(off, fabs(d->ioff[t][i] / want->ioff[t][k] - 1));
    }
    g_test_message("%s: Ion within %.2f %%, Ioff within %.1f %%", t ? "p" : "n",
                   100 * on, 100 * off);
    g_assert_cmpfloat(on, <, 0.01);
    g_assert_cmpfloat(off, <, 0.1);
  }
  g_assert_cmpfloat(d->length[0], <=, 52);
  eda_devices_free(d);
  eda_devices_free(want);
}

/* ---- range of a card ---- */

/* Test a card whose effective channel length is 0 at 60 nm. */
static void test_clamped(void) {
  opc_error error;
  if (!have_ngspice()) return;
  g_autofree char *card = card_of(SMALL("30n"));
  if (run_step(card,
               "nmos: n, pmos: p, supply: 1 V, "
               "length: { from: 50 nm, to: 120 nm, step: 5 nm }",
               "end.yaml", &error))
    g_error("%s", error.message);
  g_test_message("%s", opc_test_log());
  if (!strstr(opc_test_log(), "channel length") &&
      !strstr(opc_test_log(), "does not rise"))
    g_error("no reason was logged: '%s'", opc_test_log());
  double shortest = opc_test_metric("shortest");
  g_assert_cmpfloat(shortest, >, 60);
  g_assert_cmpfloat(shortest, <=, 80);
  eda_devices *d = table_load("end.yaml");
  g_assert_cmpfloat(d->length[0], ==, shortest);
  g_assert_cmpfloat(d->length[d->count - 1], ==, 120);
  eda_devices_free(d);
  /* Here the range is the same, but the simulator fails at the next length. */
  if (run_step(card,
               "nmos: n, pmos: p, supply: 1 V, "
               "length: { list: [60 nm, 90 nm, 100 nm, 120 nm] }",
               "end2.yaml", &error))
    g_error("%s", error.message);
  if (!strstr(opc_test_log(), "valid from 90 nm") ||
      !strstr(opc_test_log(), "Effective channel length"))
    g_error("'%s'", opc_test_log());
  /* A current decreases before the simulator fails. */
  g_autofree char *own = source_path("data/devices/opcflow65.pm");
  if (run_step(own, "supply: 1.1 V, length: { from: 30 nm, to: 80 nm }",
               "end4.yaml", &error))
    g_error("%s", error.message);
  if (!strstr(opc_test_log(),
              "the current does not rise with decreasing length"))
    g_error("'%s'", opc_test_log());
  d = table_load("end4.yaml");
  for (int t = 0; t < 2; t++)
    for (size_t i = 1; i < d->count; i++) {
      g_assert_cmpfloat(d->ion[t][i], <, d->ion[t][i - 1]);
      g_assert_cmpfloat(d->ioff[t][i], <, d->ioff[t][i - 1]);
    }
  eda_devices_free(d);
  /* No valid length remains. */
  g_assert_cmpint(run_step(card,
                           "nmos: n, pmos: p, supply: 1 V, "
                           "length: { from: 50 nm, to: 60 nm, step: 5 nm }",
                           "end3.yaml", &error),
                  ==, OPC_FAILED);
  if (!strstr(error.message, "Effective channel length"))
    g_error("%s", error.message);
}

/* ---- two lengths in one gate ---- */

enum { SLICES = 2 };
static const double slice_length[SLICES] = {60, 70};
static const double slice_width[SLICES] = {400, 600};

/* Compute Ion and Ioff by extractor.plain. */
static void sum_slices(const char *table, double current[2]) {
  opc_error error;
  const uint8_t type = EDA_NMOS;
  const double edge[SLICES] = {1000, 1000};
  const eda_slices slices = {.count = 1,
                             .slices = SLICES,
                             .type = &type,
                             .width = slice_width,
                             .length = slice_length,
                             .edge = edge};
  double leq[2], weq, area;
  uint8_t outside;
  eda_performance out = {1,       &current[0], &current[1], &leq[0],
                         &leq[1], &weq,        &area,       &outside};
  g_autofree char *mapping =
      g_strdup_printf("{ devices: %s/%s, slices: %d, rule: gauss }",
                      opc_test_folder(), table, SLICES);
  g_autoptr(opc_module) m = opc_test_module("extractor.plain", mapping, &error);
  if (!m) g_error("%s", error.message);
  const eda_extractor *extract = m->functions;
  if (extract->prepare(m->self, &error) ||
      extract->extract(m->self, &slices, &out, &error))
    g_error("%s", error.message);
}

/* Compare transistors in parallel, simulated together, with the sum of slices
   from the table. The remaining difference is the width that the card subtracts
   from each W: 0 for opcflow65.pm, 10 nm for PTM. */
static void check_slices(const char *card, const char *table,
                         const char *overrides, double within) {
  opc_error error;
  eda_spice_result r;
  double got[2];
  g_autofree char *rest = g_strdup_printf(
      "supply: 1.1 V, length: { from: 50 nm, to: 100 nm }%s", overrides);
  if (run_step(card, rest, table, &error)) g_error("%s", error.message);
  sum_slices(table, got);
  g_autofree char *deck = g_strdup_printf(
      "two\n.include \"%s\"\n"
      ".options gmin=1e-15 reltol=1e-6 abstol=1e-15\n"
      "m1 d g 0 0 nmos w=%gn l=%gn\nm2 d g 0 0 nmos w=%gn l=%gn\n"
      "vd d 0 1.1\nvg g 0 1.1\n.end\n",
      card, slice_width[0], slice_length[0], slice_width[1], slice_length[1]);
  if (eda_spice_run(NULL, deck, "op\nalter vg = 0\nop", 20, &r, &error))
    g_error("%s", error.message);
  static const char *const names[] = {"Ion", "Ioff"};
  for (int i = 0; i < 2; i++) {
    double want = -eda_spice_vector_find(&r.plot[i], "i(vd)")->value[0];
    g_test_message("%s: %s of slices %.6g A, in parallel %.6g A, %+.3f %%",
                   table, names[i], got[i], want, 100 * (got[i] / want - 1));
    g_assert_cmpfloat(fabs(got[i] / want - 1), <, within);
  }
  eda_spice_clear(&r);
}

static void test_slices(void) {
  if (!have_ngspice()) return;
  g_autofree char *own = source_path("data/devices/opcflow65.pm");
  check_slices(own, "own_slices.yaml", "", 1e-5);
  g_autofree char *ptm = find_data("models/ptm/ptm_65nm_bulk.pm");
  if (ptm)
    check_slices(ptm, "ptm_slices.yaml", ", overrides: { igbmod: 0 }", 0.03);
}

/* ---- refused ---- */

static void assert_refused(const char *card, const char *rest,
                           const char *why) {
  opc_error error;
  int code = run_step(card, rest, "refused.yaml", &error);
  if (!code || !strstr(error.message, why))
    g_error("'%s' does not say '%s'", code ? error.message : "", why);
}

static void test_refused(void) {
  g_autofree char *card = card_of(SMALL("10n")), *text = card_of("hello\n");
  const char *range = "supply: 1 V, length: { from: 50 nm, to: 60 nm }";
  assert_refused(card, "supply: 1 V", "requires 'from' and 'to', or a 'list'");
  assert_refused(card, "supply: 1 V, length: { from: 50 nm, to: 51 nm }",
                 "3 to 2000 lengths, found 2");
  assert_refused(card,
                 "supply: 1 V, length: { from: 50 nm, to: 60 nm, step: 1 pm }",
                 "found 2001");
  assert_refused(card, "supply: 1 V, length: { list: [50 nm, 50 nm, 60 nm] }",
                 "must increase");
  assert_refused(
      card, "supply: 1 V, length: { from: 50 nm, list: [50 nm, 55 nm, 60 nm] }",
      "excludes");
  g_autofree char *name = g_strdup_printf("nmos: 'a b', %s", range);
  assert_refused(card, name, "'a b' is not the name of a model");
  g_autofree char *number = g_strdup_printf("overrides: { a: 1k }, %s", range);
  assert_refused(card, number, "'1k' is not a plain number");
  g_autofree char *osdi = g_strdup_printf("osdi: %s, %s", card, range);
  assert_refused(card, osdi, "requires 'library'");
  if (!have_ngspice()) return;
  assert_refused(card, range, "could not find a valid modelname");
  assert_refused(text, range, "Error");
  g_autofree char *unknown =
      g_strdup_printf("nmos: n, pmos: p, overrides: { igbmd: 0 }, %s", range);
  assert_refused(card, unknown, "no such parameter igbmd");
  g_setenv("OPCFLOW_NGSPICE", "/nowhere/libngspice.so", TRUE);
  assert_refused(card, range, "package 'libngspice0'");
  g_unsetenv("OPCFLOW_NGSPICE");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/devices/by-hand", test_by_hand);
  g_test_add_func("/devices/thesis", test_thesis);
  g_test_add_func("/devices/own-card", test_own_card);
  g_test_add_func("/devices/clamped", test_clamped);
  g_test_add_func("/devices/slices", test_slices);
  g_test_add_func("/devices/refused", test_refused);
  return g_test_run();
}
