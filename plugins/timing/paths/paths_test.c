/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests circuits with delays known in closed form. */
#include "printed_test.h"

static void close_to(double a, double b, double within) {
  if (!(fabs(a - b) <= within)) g_error("%.12g is not %.12g", a, b);
}

static void assert_good(int code, const opc_error *error) {
  if (code) g_error("%s", error->message);
}

/* Return the arc of a cell for a change of `input` from the pattern `from`. */
static const eda_timing_arc *arc(const eda_timing *t, size_t cell,
                                 uint32_t input, uint32_t from) {
  const eda_timing_cell *c = &t->cell[cell];
  return &c->arc[c->arc_of[(input << c->inputs) + from]];
}

/* Add the delay of a further cell to at[0], and set at[1] to its output slew.
 */
static void delay_step(const eda_timing *t, size_t cell, uint32_t input,
                       uint32_t from, double load, double at[2]) {
  const eda_timing_arc *a = arc(t, cell, input, from);
  double slew = at[1];
  at[0] += delay_of(cell, a, slew, load);
  at[1] = slew_of(cell, a, slew, load);
}

/* Test three inverters with wires: each edge follows the formulas; the static
   path is the slower edge. */
static void test_chain(void) {
  opc_error error;
  eda_timing *t = library();
  assert_good(run_paths(t, "a z",
                        "XU1 a n VDD VSS INV\nXU3 m z VDD VSS INV\n"
                        "XU2 n m VDD VSS INV\n",
                        ", load: 7 fF, wire: 1 fF, slew: 8 ps, events: 2", NULL,
                        NULL, &error),
              &error);
  double worst = 0, delay = 0;
  for (uint32_t high = 0; high < 2; high++) {
    double at[2] = {0, 8e-12};
    delay_step(t, 0, 0, high, pin_load + 1e-15, at);
    delay_step(t, 0, 0, !high, pin_load + 1e-15, at);
    delay_step(t, 0, 0, high, 7e-15, at);
    close_to(opc_test_number("events", "time", high), at[0] * 1e12, 6e-4);
    close_to(opc_test_number("events", "level", high), high, 0);
    worst = fmax(worst, at[0] * 1e12);
    delay += at[0] * 1e12 / 2;
  }
  close_to(opc_test_metric("transitions"), 2, 0);
  close_to(opc_test_metric("delays"), 2, 0);
  close_to(opc_test_metric("delay"), delay, 1e-9);
  close_to(opc_test_metric("delay_max"), worst, 1e-9);
  close_to(opc_test_metric("static"), worst, 1e-9);
  g_assert_cmpuint(opc_test_rows("static_path"), ==, 4);
  g_assert_cmpstr(opc_test_text("static_path", "net", 3), ==, "a");
  eda_timing_free(t);
}

/* Tables end at a slew of 50 ps and a load of 20 fF. A slew 10 % beyond the end
   and a load of ten times the end cause no finding; larger ones do. */
static void test_extrapolated(void) {
  static const char *const more[][2] = {
      {", slew: 54.9 ps, load: 4 fF", NULL},
      {", slew: 55.1 ps, load: 4 fF", "slews are up to 1.1 times, loads up"},
      {", slew: 8 ps, load: 199 fF", NULL},
      {", slew: 8 ps, load: 210 fF", "delays of 1 of 1 gates"}};
  for (size_t i = 0; i < G_N_ELEMENTS(more); i++) {
    opc_error error;
    eda_timing *t = library();
    assert_good(run_paths(t, "a z", "XU1 a z VDD VSS INV\n", more[i][0], NULL,
                          NULL, &error),
                &error);
    const char *want = more[i][1] ? more[i][1] : "extrapolated";
    g_assert_cmpint(strstr(opc_test_log(), want) != NULL, ==, !!more[i][1]);
    eda_timing_free(t);
  }
}

/* Test the NAND of an input and the inverted input; the output is 1 in both
   static states. After the input rises, both NAND inputs are 1 during the delay
   of the inverter. A slower NAND suppresses the resulting pulse. */
static void test_pulse(void) {
  opc_error error;
  static const char *const more[] = {
      ", slew: 8 ps, events: 2, load: 0.1 fF, wire: 4 fF",
      ", slew: 8 ps, events: 2, load: 20 fF"};
  for (int slow = 0; slow < 2; slow++) {
    eda_timing *t = library();
    assert_good(run_paths(t, "a z y",
                          "XU1 a n VDD VSS INV\nXU2 a n z VDD VSS NAND2\n"
                          "XU3 a y VDD VSS INV\n",
                          more[slow], NULL, NULL, &error),
                &error);
    double wire = slow ? 0 : 4e-15, z = slow ? 20e-15 : 0.1e-15;
    double up[2] = {0, 8e-12}, down[2] = {0, 8e-12};
    delay_step(t, 1, 0, 2, z, up); /* a rises while n is 1, so z falls */
    delay_step(t, 0, 0, 0, pin_load + wire, down);
    int passes = down[0] >= up[0];
    delay_step(t, 1, 1, 3, z, down); /* n falls, so z rises */
    g_assert_cmpint(passes, ==, !slow);
    g_assert_cmpuint(opc_test_rows("events"), ==, slow ? 2 : 4);
    for (size_t i = 0; i < opc_test_rows("events") && !slow; i++) {
      if (strcmp(opc_test_text("events", "output", i), "z")) continue;
      int rises = (int)opc_test_number("events", "level", i);
      close_to(opc_test_number("events", "time", i),
               1e12 * (rises ? down : up)[0], 6e-4);
    }
    /* The final level of z equals its initial level, so only y has a delay. */
    close_to(opc_test_metric("delays"), 2, 0);
    eda_timing_free(t);
  }
}

/* Test an inverter with larger printed length, width and area: each changes the
   delay as in the library, and eq. 3.15 holds for both edges. */
static void test_printed(void) {
  opc_error error;
  eda_circuit circuit;
  const eda_mask *mask = printed("z", &circuit);
  memcpy(leq, (double[]){62, 60}, sizeof leq);
  memcpy(weq, (double[]){210, 297}, sizeof weq);
  memcpy(area, (double[]){57 * 210, 60 * 297}, sizeof area);
  eda_timing *t = library();
  eda_timing_cell *c = &t->cell[0];
  /* Delay change in ps for each size, equal at all three points. */
  const double by[] = {4e-12, -7e-12, 2e-12, 1e-12, -3e-12, 5e-12};
  for (size_t a = 0; a < 2; a++)
    for (size_t k = 0; k < 18; k++)
      c->arc[a].delay_by[k] = by[k % 6] * (a ? 1 : -0.5);
  assert_good(run_paths(t, "a z", "XU1 a z VDD VSS INV\n",
                        ", slew: 8 ps, load: 4 fF", &circuit, mask, &error),
              &error);
  double moved = by[0] * log(62.0 / 60) + by[1] * log(210.0 / 200) +
                 by[2] * log(57.0 / 60) + by[4] * log(297.0 / 300);
  double sum = 0, low = INFINITY, high = -INFINITY, x[2];
  for (uint32_t a = 0; a < 2; a++) {
    double drawn = delay_of(0, &c->arc[a], 8e-12, 4e-15);
    x[a] = 100 * moved * (a ? 1 : -0.5) / drawn;
    sum += fabs(x[a]) / 2;
    low = fmin(low, x[a]);
    high = fmax(high, x[a]);
  }
  close_to(opc_test_metric("mean"), sum, 1e-9);
  close_to(opc_test_metric("lowest"), low, 1e-9);
  close_to(opc_test_metric("highest"), high, 1e-9);
  close_to(opc_test_metric("stdv"), fabs(fabs(x[0]) - fabs(x[1])) / sqrt(2),
           1e-9);
  /* A transistor without width is reported. */
  weq[1] = 0;
  int code =
      run_paths(t, "a z", "XU1 a z VDD VSS INV\n", "", &circuit, mask, &error);
  g_assert_cmpint(code, ==, OPC_FAILED);
  g_assert_nonnull(strstr(error.message, "'XU1/MP' has no size"));
  eda_timing_free(t);
}

/* Test paths that differ from the paths at drawn sizes. z is the NAND of m and
   n. Both are the inverted a; n has more load, so m changes first. XU1 drives
   m. If XU1 prints long enough, m changes last. Each change of z then has
   another path than at drawn sizes and is counted in `others`. */
static void test_others(void) {
  opc_error error;
  eda_circuit circuit;
  const eda_mask *mask = printed("m", &circuit);
  memcpy(weq, (double[]){200, 300}, sizeof weq);
  memcpy(area, (double[]){60 * 200, 60 * 300}, sizeof area);
  for (int swap = 0; swap < 2; swap++) {
    eda_timing *t = library();
    eda_timing_cell *c = &t->cell[0];
    for (size_t k = 0; k < 2 * 18; k++) /* sensitivities to ln of the length */
      c->arc[k / 18].delay_by[k % 18] = k % 6 ? 0 : swap ? 200e-12 : 1e-12;
    leq[0] = leq[1] = 62;
    assert_good(run_paths(t, "a z y",
                          "XU1 a m VDD VSS INV\nXU2 a n VDD VSS INV\n"
                          "XU3 n y VDD VSS INV\nXU4 m n z VDD VSS NAND2\n",
                          ", slew: 8 ps, load: 4 fF", &circuit, mask, &error),
                &error);
    close_to(opc_test_metric("delays"), 4, 0);
    close_to(opc_test_metric("others"), swap ? 2 : 0, 0);
    close_to(opc_test_number("paths", "others", 1), swap ? 2 : 0, 0);
    if (swap)
      close_to(opc_test_metric("mean"), 0, 0); /* the delay of y is as
                                                  drawn */
    g_assert_cmpint(opc_test_metric("mean") > 0, ==, !swap);
    g_assert_cmpfloat(opc_test_metric("longest"), >=, 0);
    /* The histogram contains all compared delays. */
    double share = 0;
    for (size_t i = 0; i < opc_test_rows("histogram"); i++)
      share += opc_test_number("histogram", "share", i);
    close_to(share, 100, 0.05);
    eda_timing_free(t);
  }
}

/* Test a NAND whose inputs change at the same time, followed by an inverter.
   The inputs are in series if they rise, and in parallel if they fall. The
   factors of the pairs are constant. Delay and slew then equal the factor times
   the mean of the values of both inputs alone. */
static void test_together(void) {
  opc_error error;
  eda_timing *t = library();
  eda_timing_cell *c = &t->cell[1];
  static const double factor[2][2] = {{1.25, 1.1}, {0.6, 0.7}};
  static double figure[2][2][6 + 5 * EDA_TIMING_GAPS];
  eda_timing_pair pair[2] = {
      {.first = 0, .second = 1, .from = 0},
      {.first = 0, .second = 1, .from = 3, .parallel = 1}};
  for (int k = 0; k < 2; k++) {
    pair[k].at[0] = figure[k][0];
    pair[k].at[1] = figure[k][0] + 3;
    figure[k][0][1] = figure[k][0][4] = 1;
    pair[k].delay = figure[k][0] + 6;
    pair[k].slew = figure[k][1];
    for (int g = 0; g < 5 * EDA_TIMING_GAPS; g++) {
      pair[k].delay[g] = factor[k][0];
      pair[k].slew[g] = factor[k][1];
    }
    c->pair_of[1 << 2 | pair[k].from] = k;
  }
  c->pair = pair;
  c->pairs = 2;
  assert_good(
      run_paths(t, "a b z w", "XU1 a b z VDD VSS NAND2\nXU2 z w VDD VSS INV\n",
                ", slew: 8 ps, load: 3 fF, events: 12", NULL, NULL, &error),
      &error);
  const double load = 3e-15 + pin_load;
  for (uint32_t rises = 0; rises < 2; rises++) {
    double a[2] = {0, 8e-12}, b[2] = {0, 8e-12};
    delay_step(t, 1, 0, rises ? 2 : 3, load, a);
    delay_step(t, 1, 1, rises ? 1 : 3, load, b);
    double z[2] = {factor[!rises][0] * (a[0] + b[0]) / 2,
                   factor[!rises][1] * (a[1] + b[1]) / 2};
    double w[2] = {z[0], z[1]};
    delay_step(t, 0, 0, rises, 3e-15, w);
    int found = 0;
    for (size_t i = 0; i < opc_test_rows("events"); i++) {
      double at = opc_test_number("events", "time", i);
      int is_w = !strcmp(opc_test_text("events", "output", i), "w");
      found |= (fabs(at - 1e12 * (is_w ? w : z)[0]) < 6e-4) << is_w;
    }
    g_assert_cmpint(found, ==, 3);
  }
  eda_timing_free(t);
}

/* Run a circuit in which XU1 has printed sizes, and return the latest static
   arrival, ps. */
static double printed_static(eda_timing *t, const eda_circuit *circuit,
                             const eda_mask *mask) {
  opc_error error;
  assert_good(run_paths(t, "a b y z",
                        "XU0 a n VDD VSS INV\nXU1 n m VDD VSS INV\n"
                        "XU2 m z VDD VSS INV\nXU3 m b y VDD VSS NAND2\n",
                        ", slew: 8 ps, load: 4 fF", circuit, mask, &error),
              &error);
  return opc_test_number("paths", "static", 1);
}

/* Test the derivatives of the longest path against runs with changed printed
   sizes. The sizes of XU1 change its own delay and slew, and the load of XU0;
   the slews of XU1 change the delay of the next gate. */
static void test_derivatives(void) {
  eda_circuit circuit;
  const eda_mask *mask = printed("m", &circuit);
  eda_timing *t = library();
  eda_timing_cell *c = &t->cell[0];
  for (size_t k = 0; k < 2 * 18; k++) {
    c->arc[k / 18].delay_by[k % 18] = 1e-12 * (double)(k % 7 + 1);
    c->arc[k / 18].slew_by[k % 18] = -2e-12 * (double)(k % 5 + 1);
  }
  for (size_t k = 0; k < 4 * 6; k++)
    c->capacitance_by[k] = 1e-16 * (double)(k % 6 + 1);
  memcpy(leq, (double[]){62, 59}, sizeof leq);
  memcpy(weq, (double[]){205, 290}, sizeof weq);
  memcpy(area, (double[]){61 * 205, 60 * 290}, sizeof area);
  double *size[EDA_SIZES] = {leq, weq, area};
  double at = printed_static(t, &circuit, mask);
  g_assert_cmpuint(sensed->paths, >=, 4);
  close_to(sensed->drawn, opc_test_metric("static"), 1e-9);
  const eda_delay_path *path = &sensed->path[0];
  close_to(path->delay.time, at, 1e-9);
  g_assert_cmpstr(path->from, ==, "a");
  g_assert_cmpuint(path->delay.terms, ==, 2);
  eda_delay_term term[2];
  memcpy(term, path->delay.term, sizeof term);
  for (size_t i = 0; i < 2; i++)
    for (int k = 0; k < EDA_SIZES; k++)
      close_to(sensed->size[k][i], size[k][i], 1e-9);
  for (size_t i = 0; i < 2; i++)
    for (int k = 0; k < EDA_SIZES; k++) {
      const double step = 1e-3;
      g_assert_cmpuint(term[i].gate, ==, i);
      double was = size[k][i], wide = area[i];
      size[k][i] *= exp(step);
      /* The third size is the mean length: the area over the width. */
      if (k == EDA_SIZE_W) area[i] *= exp(step);
      double by = (printed_static(t, &circuit, mask) - at) / step;
      g_assert_cmpfloat(fabs(by), >, 0.1);
      close_to((double)term[i].by[k], by, 2e-3 * fabs(by));
      size[k][i] = was;
      area[i] = wide;
    }
  /* The arcs have the mean delay over the patterns, as in the SDF file. */
  printed_static(t, &circuit, mask);
  double sum = 0;
  for (size_t i = 0; i < sensed->arcs; i++)
    if (!strcmp(sensed->arc[i].instance, "U1") && sensed->arc[i].rises)
      sum += sensed->arc[i].delay.time;
  g_autofree char *file =
      g_build_filename(opc_test_folder(), "top.printed.sdf", NULL);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(file, &text, NULL, NULL));
  const char *own = strstr(strstr(text, "(INSTANCE U1)"), "IOPATH");
  close_to(sum, atof(strchr(own, ':') + 1), 6e-4);
  eda_timing_free(t);
}

/* Test that two parallel branches of nearly equal delay are both paths of the
   latest output, which is not the first one. */
static void test_critical(void) {
  opc_error error;
  eda_circuit circuit;
  const eda_mask *mask = printed("m", &circuit);
  memcpy(leq, (double[]){60, 60}, sizeof leq);
  memcpy(weq, (double[]){200, 300}, sizeof weq);
  memcpy(area, (double[]){60 * 200, 60 * 300}, sizeof area);
  eda_timing *t = library();
  assert_good(run_paths(t, "a b y z",
                        "XU1 a m VDD VSS INV\nXU2 b n VDD VSS INV\n"
                        "XU3 m n z VDD VSS NAND2\nXU4 a y VDD VSS INV\n",
                        ", slew: 8 ps, load: 4 fF", &circuit, mask, &error),
              &error);
  int from[2] = {0, 0};
  for (size_t i = 0; i < sensed->paths; i++) {
    const eda_delay_path *p = &sensed->path[i];
    if (i) g_assert_cmpfloat(p->delay.time, <=, p[-1].delay.time);
    from[!strcmp(p->from, "b")] += !strcmp(p->to, "z");
  }
  g_assert_cmpint(from[0], >, 0);
  g_assert_cmpint(from[1], >, 0);
  close_to(opc_test_metric("critical_coverage"), 100, 0);
  eda_timing_free(t);
}

static void refused_with(const char *ports, const char *instances,
                         const char *more, const char *words) {
  opc_error error;
  eda_timing *t = library();
  int code = run_paths(t, ports, instances, more, NULL, NULL, &error);
  g_assert_cmpint(code, ==, OPC_INVALID);
  if (!strstr(error.message, words))
    g_error("'%s' does not say '%s'", error.message, words);
  eda_timing_free(t);
}

static void assert_refused(const char *ports, const char *instances,
                           const char *words) {
  refused_with(ports, instances, "", words);
}

static void test_refused(void) {
  assert_refused("a z", "XU1 a n VDD VSS INV\nXU2 n b z VDD VSS NAND2\n",
                 "nothing drives net 'b'");
  assert_refused("a z", "XU1 a z VDD VSS INV\nXU2 a z VDD VSS INV\n",
                 "'XU2' drives a net that has another driver");
  assert_refused("a z", "XU1 a m z VDD VSS NAND2\nXU2 z m VDD VSS INV\n",
                 "is on a loop");
  assert_refused("a z", "XU1 a z VDD VSS INV\nM1 z a VSS VSS nmos w=1u l=1u\n",
                 "'M1' is a transistor");
  /* Any existing file is sufficient, because the step reads the file only when
     it needs the circuit. */
  g_autofree char *more =
      g_strdup_printf(", spice: 1, models: %s/circuit.sp", opc_test_folder());
  refused_with("a z", "XU1 a z VDD VSS INV\n", more, "required by 'spice'");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/paths/extrapolated", test_extrapolated);
  g_test_add_func("/paths/chain", test_chain);
  g_test_add_func("/paths/pulse", test_pulse);
  g_test_add_func("/paths/printed", test_printed);
  g_test_add_func("/paths/others", test_others);
  g_test_add_func("/paths/together", test_together);
  g_test_add_func("/paths/derivatives", test_derivatives);
  g_test_add_func("/paths/critical", test_critical);
  g_test_add_func("/paths/refused", test_refused);
  return g_test_run();
}
