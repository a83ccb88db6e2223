/* SPDX-License-Identifier: BSD-3-Clause */
/* Printed sizes from tables and experiments, and the comparison with
   ngspice. */
#include <eda/experiment.h>
#include <stdlib.h>

#include "printed_test.h"

static void close_to(double a, double b, double within) {
  if (!(fabs(a - b) <= within)) g_error("%.12g is not %.12g", a, b);
}

/* ---- tables ---- */

static const char head[] = "transistor,leq_ion (nm),weq (nm),area_after (%)\n";

/* Change of the delay of the rising output for each size, ps per ln. */
static const double by[] = {4, -7, 2, 1, -3, 5};

/* Return a library in which the sizes change the delays of the inverter. */
static eda_timing *library_sensitive(void) {
  eda_timing *t = library();
  eda_timing_cell *c = &t->cell[0];
  for (size_t a = 0; a < 2; a++)
    for (size_t k = 0; k < 18; k++)
      c->arc[a].delay_by[k] = 1e-12 * by[k % 6] * (a ? 1 : -0.5);
  return t;
}

/* Return the mean |deviation| of both edges for a change of `moved` ps. */
static double mean_of(const eda_timing *t, double moved) {
  double sum = 0;
  for (uint32_t a = 0; a < 2; a++)
    sum += fabs(moved * (a ? 1 : -0.5)) /
           (1e12 * delay_of(0, &t->cell[0].arc[a], 8e-12, 4e-15)) / 2;
  return 100 * sum;
}

static char *table_put(const char *name, const char *first, const char *rows) {
  char *path = g_build_filename(opc_test_folder(), name, NULL);
  g_autofree char *folder = g_path_get_dirname(path);
  g_autofree char *text = g_strconcat(first, rows, NULL);
  g_assert_cmpint(g_mkdir_with_parents(folder, 0700), ==, 0);
  g_unlink(path);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  return path;
}

/* Run the inverter with an experiment or tables; return the code. */
static int run_prints(eda_timing *t, const char *prints,
                      const eda_experiment *experiment, opc_error *error) {
  eda_circuit circuit;
  g_autofree char *path = write_circuit("a z", "XU1 a z VDD VSS INV\n");
  g_autofree char *text =
      g_strdup_printf("{ file: %s, top: top, slew: 8 ps, load: 4 fF%s%s%s }",
                      path, prints ? ", prints: { one: '" : "",
                      prints ? prints : "", prints ? "' }" : "");
  (void)printed("z", &circuit);
  opc_test_forget();
  g_autoptr(opc_module) m = opc_test_module("timing.paths", text, error);
  if (!m) g_error("%s", error->message);
  opc_test_input(m, "timing", t);
  opc_test_input(m, "circuit", &circuit);
  if (experiment) opc_test_input(m, "experiment", (void *)experiment);
  void *outputs[1] = {NULL};
  int code = opc_test_run(m, outputs, error);
  eda_delays_free(outputs[0]);
  return code;
}

/* The table has the sizes of both transistors; the area is that of the drawn
   gate (60 by 200 and 60 by 300) plus the given percentage. */
static void test_table(void) {
  opc_error error;
  eda_timing *t = library_sensitive();
  g_autofree char *path =
      table_put("one.csv", head, "sample:2,59,310,5\nsample:1,62,210,-2.5\n");
  if (run_prints(t, path, NULL, &error)) g_error("%s", error.message);
  double mean[2] = {12000 * 0.975 / 210, 18000 * 1.05 / 310};
  close_to(opc_test_metric("mean"),
           mean_of(t, by[0] * log(62.0 / 60) + by[1] * log(210.0 / 200) +
                          by[2] * log(mean[0] / 60) + by[3] * log(59.0 / 60) +
                          by[4] * log(310.0 / 300) + by[5] * log(mean[1] / 60)),
           1e-9);
  g_assert_cmpstr(opc_test_text("paths", "sizes", 1), ==, "one");
  eda_timing_free(t);
}

static void test_refused(void) {
  static const struct {
    const char *head, *rows, *want;
    int code;
  } cases[] = {
      {"transistor,leq_ion (nm),weq (nm)\n", "sample:1,62,210\n",
       "*one.csv' has no column 'area_after', expected a table of gates",
       OPC_INVALID},
      {head, "sample:1,x,210,0\n", "*one.csv:2:*no column of numbers: *",
       OPC_INVALID},
      {head, "sample:1,62,210,0\nsample:3,62,210,0\n",
       "*one.csv:3: column 'transistor': not a transistor of this circuit: "
       "'sample:3'",
       OPC_INVALID},
      {head, "sample:1,62,210,0\n",
       "netlist device 'XU1/MP' has no size: the gate 'sample:2' does not "
       "print",
       OPC_FAILED}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error;
    eda_timing *t = library_sensitive();
    g_autofree char *path = table_put("one.csv", cases[i].head, cases[i].rows);
    g_assert_cmpint(run_prints(t, path, NULL, &error), ==, cases[i].code);
    if (!g_pattern_match_simple(cases[i].want, error.message))
      g_error("%zu: %s", i, error.message);
    eda_timing_free(t);
  }
}

/* The table of a verification precedes that of a correction; failed runs are
   omitted. */
static void test_experiment(void) {
  opc_error error;
  eda_timing *t = library_sensitive();
  const char *const cases[] = {"c", "d"}, *const methods[] = {"epe", "lost",
                                                              "ic"};
  const char *folders[6] = {NULL};
  const char drawn[] = "sample:1,60,200,0\nsample:2,60,300,0\n",
             longer[] = "sample:1,66,200,0\nsample:2,60,300,0\n";
  g_autofree char *a = table_put("a/gates.csv", head, drawn);
  g_autofree char *b = table_put("b/gates.csv", head, drawn);
  g_autofree char *c = table_put("b/verify.gates.csv", head, longer);
  g_autofree char *one = g_path_get_dirname(a);
  g_autofree char *two = g_path_get_dirname(b);
  folders[0] = one;
  folders[2] = two;
  eda_experiment *e = eda_experiment_new(1, cases, 3, methods, folders);
  if (run_prints(t, NULL, e, &error)) g_error("%s", error.message);
  g_assert_cmpuint(opc_test_rows("paths"), ==, 3);
  g_assert_cmpstr(opc_test_text("paths", "sizes", 1), ==, "epe");
  g_assert_cmpstr(opc_test_text("paths", "sizes", 2), ==, "ic");
  close_to(opc_test_number("paths", "mean", 1), 0, 1e-12);
  close_to(opc_test_number("paths", "mean", 2), mean_of(t, by[0] * log(1.1)),
           1e-9);
  g_assert_nonnull(
      strstr(opc_test_log(), "'lost' is omitted, because the run failed"));
  eda_experiment_free(e);
  e = eda_experiment_new(2, cases, 3, methods, folders);
  g_assert_cmpint(run_prints(t, NULL, e, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "experiment");
  g_assert_cmpstr(error.message, ==,
                  "the experiment has 2 cases, expected one, the layout of "
                  "'circuit'");
  eda_experiment_free(e);
  eda_timing_free(t);
}

/* ---- ngspice ---- */

static const char cards[] =
    ".model nmos nmos level=54 version=4.5 toxe=1.8e-9 vth0=0.3 cgso=1e-10 "
    "cgdo=1e-10\n"
    ".model pmos pmos level=54 version=4.5 toxe=1.8e-9 vth0=-0.3 cgso=1e-10 "
    "cgdo=1e-10\n";

/* Return the delay of the inverter in ngspice by .measure, ps. */
static double delay_measured(char *program, const eda_timing *t, int rises,
                             double length) {
  char *ramp;
  size_t size;
  FILE *out = open_memstream(&ramp, &size);
  eda_timing_ramp_write(out, t, rises, !rises, 8e-12, 20e-12);
  fclose(out);
  g_autofree char *deck = g_strdup_printf(
      "* deck\n%s.options temp=25 gmin=1e-15 reltol=1e-4\n"
      "M1 z a 0 0 nmos w=200n l=%gn\nM2 z a d d pmos w=300n l=%gn\n"
      "VD d 0 1\nVA a 0 %sCL z 0 4f\n.control\nset num_threads=1\ntran .5p "
      "120p 0 .5p\n"
      "meas tran tz when v(z)=.5\nprint (tz-20p)*1e12\n.endc\n.end\n",
      cards, length, length, ramp);
  free(ramp);
  g_autofree char *path = g_build_filename(opc_test_folder(), "deck.sp", NULL);
  g_assert_true(g_file_set_contents(path, deck, -1, NULL));
  char *argv[] = {program, (char *)"-n", (char *)"-b", path, NULL};
  g_autofree char *text = NULL, *err = NULL;
  g_assert_true(
      g_spawn_sync(NULL, argv, NULL, 0, NULL, NULL, &text, &err, NULL, NULL));
  const char *found = strstr(text, "(tz-20p)*1e12 = ");
  if (!found) g_error("%s\n%s", text, err);
  return g_ascii_strtod(strchr(found, '=') + 1, NULL);
}

/* The table has the delays of both edges by the library and by ngspice, as
   drawn and as printed (66 nm). */
static void test_spice(void) {
  opc_error error;
  eda_circuit circuit;
  const eda_mask *mask = printed("z", &circuit);
  eda_timing *t = library_sensitive();
  g_autofree char *program = g_find_program_in_path("ngspice");
  if (!program) {
    g_test_skip("no ngspice");
    eda_timing_free(t);
    return;
  }
  t->temperature = 25;
  leq[0] = leq[1] = 66;
  weq[0] = 200, weq[1] = 300;
  area[0] = 66 * 200, area[1] = 66 * 300;
  g_autofree char *path = g_build_filename(opc_test_folder(), "cards.sp", NULL);
  g_assert_true(g_file_set_contents(path, cards, -1, NULL));
  g_autofree char *more =
      g_strdup_printf(", slew: 8 ps, load: 4 fF, spice: 9, models: '%s'", path);
  if (run_paths(t, "a z", "XU1 a z VDD VSS INV\n", more, &circuit, mask,
                &error))
    g_error("%s", error.message);
  g_assert_cmpuint(opc_test_rows("spice"), ==, 2);
  g_assert_cmpfloat(opc_test_metric("spice_delays"), ==, 2);
  double worst = 0, square = 0, off = 0, off_most = 0;
  const double moved = 1e-12 * ((by[0] + by[2] + by[3] + by[5]) * log(1.1));
  for (size_t i = 0; i < 2; i++) {
    int rises = !strcmp(opc_test_text("spice", "edge", i), "rises");
    const eda_timing_arc *a = &t->cell[0].arc[0];
    if (a->rises != rises) a++;
    double drawn = delay_of(0, a, 8e-12, 4e-15),
           now = drawn + moved * (a == t->cell[0].arc ? -0.5 : 1);
    double is = delay_measured(program, t, rises, 60),
           long_is = delay_measured(program, t, rises, 66);
    g_assert_cmpstr(opc_test_text("spice", "output", i), ==, "z");
    close_to(opc_test_number("spice", "drawn", i), 1e12 * drawn, 6e-4);
    close_to(opc_test_number("spice", "drawn_spice", i) / is, 1, 2e-3);
    close_to(opc_test_number("spice", "printed", i), 1e12 * now, 6e-4);
    close_to(opc_test_number("spice", "printed_spice", i) / long_is, 1, 2e-3);
    double e =
        100 * (1e12 * drawn / opc_test_number("spice", "drawn_spice", i) - 1);
    close_to(opc_test_number("spice", "error", i), e, 0.01);
    square += e * e / 2;
    worst = fmax(worst, fabs(e));
    double d = fabs(100 * (now / drawn - 1) -
                    opc_test_number("spice", "deviation_spice", i));
    close_to(opc_test_number("spice", "deviation_spice", i),
             100 * (long_is / is - 1), 0.2);
    off += d / 2;
    off_most = fmax(off_most, d);
  }
  close_to(opc_test_metric("spice_error"), sqrt(square), 0.01);
  close_to(opc_test_metric("spice_error_max"), worst, 0.01);
  close_to(opc_test_metric("spice_deviation"), off, 0.01);
  close_to(opc_test_metric("spice_deviation_max"), off_most, 0.01);
  /* A circuit without the port. */
  (void)printed("y", &circuit);
  g_assert_cmpint(run_paths(t, "a z", "XU1 a z VDD VSS INV\n", more, &circuit,
                            NULL, &error),
                  ==, OPC_INVALID);
  eda_timing_free(t);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/prints/table", test_table);
  g_test_add_func("/prints/refused", test_refused);
  g_test_add_func("/prints/experiment", test_experiment);
  g_test_add_func("/prints/spice", test_spice);
  return g_test_run();
}
