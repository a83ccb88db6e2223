/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests a library of three cells: the figures of each cell equal those of the
   step `correct` on that cell alone, and stored cells are not corrected
   again. */
#include <math.h>

#include "tests/library.h"

enum { CELLS = 3 };
static const char *const names[CELLS] = {"long", "wide", "pair"};
static const double transistors[CELLS] = {1, 1, 2};

typedef struct made {
  eda_layout *circuit;
  ran sheet, gates;
} made;

static made make_sheet(const char *cells) {
  made m = {.circuit = library_circuit()};
  int32_t pair = add_transistor(m.circuit, "pair", 65, 300);
  add_box(m.circuit, pair, "active", (eda_box){400, 0, 700, 300});
  add_box(m.circuit, pair, "nimplant", (eda_box){400, -50, 750, 350});
  add_box(m.circuit, pair, "poly", (eda_box){450, -120, 515, 420});
  g_autofree char *map = g_strdup_printf("{ cells: '%s' }", cells);
  m.sheet = sheet_of(m.circuit, map);
  m.gates = layout_segment(m.sheet.out);
  return m;
}

static void made_clear(made *m) {
  ran_clear(&m->gates);
  ran_clear(&m->sheet);
  eda_layout_free(m->circuit);
}

static void build_made(made *m, const char *more, double *ion) {
  ran r;
  opc_error error;
  if (build_library(&r, m->sheet.out, m->gates.out, more, &error))
    g_error("%s", error.message);
  for (size_t i = 0; i < opc_test_rows("cells"); i++)
    ion[i] = opc_test_number("cells", "ion_max", i);
  ran_clear(&r);
}

/* Return the largest |Ion deviation| of a cell that the step `correct`
   corrected. */
static double corrected(const char *cell, const char *more) {
  static const char *const inputs[] = {"gates", NULL};
  opc_error error;
  ran r;
  made m = make_sheet(cell);
  g_autofree char *rest = g_strdup_printf(
      "synthesizer: { use: synthesizer.newton }, regulator: { use: "
      "regulator.drc, want_extension: 60 nm }%s",
      more);
  g_autofree char *map = library_map(LIBRARY_MODELS(LIBRARY_NA), rest);
  if (run_step(&r, "correct", map, inputs, (void *[]){m.gates.out}, &error))
    g_error("%s", error.message);
  double ion = opc_test_metric("ion_max");
  ran_clear(&r);
  made_clear(&m);
  return ion;
}

/* Compare the figures as drawn and after all displacements. */
static void test_alone(void) {
  static const char *const mores[] = {", max_iterations: 0", ""};
  double ion[2][CELLS];
  made m = make_sheet("*");
  for (int k = 0; k < 2; k++) {
    build_made(&m, mores[k], ion[k]);
    g_assert_cmpuint(opc_test_rows("cells"), ==, CELLS);
    double mean = 0;
    for (size_t i = 0; i < CELLS; i++) {
      g_assert_cmpstr(opc_test_text("cells", "cell", i), ==, names[i]);
      g_assert_cmpstr(opc_test_text("cells", "state", i), ==, "corrected");
      g_assert_cmpfloat(opc_test_number("cells", "transistors", i), ==,
                        transistors[i]);
      mean += opc_test_number("cells", "ion_mean", i) * transistors[i] / 4;
    }
    g_assert_cmpfloat_with_epsilon(opc_test_metric("ion_mean"), mean, 1e-9);
    g_assert_cmpfloat(opc_test_metric("ion_max"), ==,
                      fmax(ion[k][0], fmax(ion[k][1], ion[k][2])));
    for (size_t i = 0; i < CELLS; i++) {
      double alone = corrected(names[i], mores[k]);
      g_test_message("%s: %.4f %%, alone %.4f %%", names[i], ion[k][i], alone);
      g_assert_cmpfloat_with_epsilon(ion[k][i], alone, 0.01);
    }
  }
  for (size_t i = 0; i < CELLS; i++)
    g_assert_cmpfloat(ion[1][i], <, ion[0][i] / 4);
  made_clear(&m);
}

/* With equal settings, nothing is simulated and the figures are unchanged. With
   other settings, all cells are corrected again, and the store keeps both
   versions. */
static void test_kept(void) {
  double first[CELLS], again[CELLS], other[CELLS];
  made m = make_sheet("*");
  g_autofree char *store = g_build_filename(opc_test_folder(), "store", NULL);
  g_setenv("OPCFLOW_STORE", store, TRUE);
  build_made(&m, "", first);
  g_assert_cmpfloat(opc_test_metric("corrected"), ==, CELLS);
  g_assert_cmpfloat(opc_test_metric("simulations"), >, 0);
  build_made(&m, "", again);
  g_assert_cmpfloat(opc_test_metric("corrected"), ==, 0);
  g_assert_cmpfloat(opc_test_metric("kept"), ==, CELLS);
  g_assert_cmpfloat(opc_test_metric("simulations"), ==, 0);
  g_assert_cmpmem(first, sizeof first, again, sizeof again);
  build_made(&m, ", max_iterations: 1", other);
  g_assert_cmpfloat(opc_test_metric("corrected"), ==, CELLS);
  build_made(&m, "", again);
  g_assert_cmpfloat(opc_test_metric("kept"), ==, CELLS);
  g_assert_cmpmem(first, sizeof first, again, sizeof again);
  g_setenv("OPCFLOW_STORE", "", TRUE);
  made_clear(&m);
}

static void test_cancelled(void) {
  ran r;
  opc_error error;
  made m = make_sheet("long");
  opc_test_cancel(TRUE);
  g_assert_cmpint(build_library(&r, m.sheet.out, m.gates.out, "", &error), ==,
                  OPC_CANCELLED);
  opc_test_cancel(FALSE);
  opc_test_module_free(r.module);
  made_clear(&m);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_setenv("OPCFLOW_STORE", "", TRUE);
  g_test_add_func("/library.build/alone", test_alone);
  g_test_add_func("/library.build/kept", test_kept);
  g_test_add_func("/library.build/cancelled", test_cancelled);
  return g_test_run();
}
