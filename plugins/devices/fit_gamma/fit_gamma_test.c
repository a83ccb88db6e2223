/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests that the fit recovers known edge effects, through the table read by
   extractor.gamma. */
#include <eda/extractor.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

static char *devices(void) {
  const char *source = g_getenv("OPCFLOW_SOURCE");
  return g_build_filename(source ? source : ".", "data", "devices",
                          "ptm65.yaml", NULL);
}

static opc_module *module_make(const char *id, const char *more,
                               opc_error *error) {
  g_autofree char *file = devices();
  g_autofree char *text = g_strdup_printf("{ devices: '%s'%s }", file, more);
  return opc_test_module(id, text, error);
}

/* Compute the currents of extractor.gamma for a transistor with many slices. */
static void currents(const opc_module *m, uint8_t type, double width,
                     double low, double high, double *ion, double *ioff) {
  enum { SLICES = 4000 };
  static double slice[3][SLICES];
  for (int i = 0; i < SLICES; i++) {
    double t = (i + 0.5) / SLICES;
    slice[0][i] = width / SLICES;
    slice[1][i] = low + (high - low) * t;
    slice[2][i] = width * MIN(t, 1 - t);
  }
  double other[4];
  uint8_t outside;
  eda_performance out = {1,         ion,       ioff,      &other[0],
                         &other[1], &other[2], &other[3], &outside};
  eda_slices in = {.count = 1,
                   .slices = SLICES,
                   .type = &type,
                   .width = slice[0],
                   .length = slice[1],
                   .edge = slice[2]};
  opc_error error;
  const eda_extractor *e = m->functions;
  g_assert_cmpint(e->extract(m->self, &in, &out, &error), ==, OPC_OK);
}

static opc_module *extractor(const char *more) {
  opc_error error;
  opc_module *m = module_make("extractor.gamma", more, &error);
  if (!m) g_error("%s", error.message);
  const eda_extractor *e = m->functions;
  if (e->prepare(m->self, &error)) g_error("%s", error.message);
  return m;
}

static const double widths[] = {90, 120, 180, 270, 400, 800};

/* Write a file of reference transistors computed by an extractor: straight and
   tapered transistors of both types. `worst`: largest deviation of slicing
   without gamma, %. */
static char *write_reference(const char *name, const char *terms,
                             double worst[2]) {
  g_autoptr(opc_module) truth = extractor(terms);
  g_autoptr(opc_module) plain = extractor("");
  GString *s = g_string_new("type,width (nm),length (nm),ion (A),ioff (A)\n");
  worst[0] = worst[1] = 0;
  for (uint8_t type = 0; type < 2; type++)
    for (size_t i = 0; i < G_N_ELEMENTS(widths); i++)
      for (int taper = 0; taper < 2; taper++) {
        double low = 62, high = taper ? 70 : 62, a[2], b[2];
        currents(truth, type, widths[i], low, high, &a[0], &a[1]);
        currents(plain, type, widths[i], low, high, &b[0], &b[1]);
        for (int k = 0; k < 2; k++)
          worst[k] = fmax(worst[k], 100 * fabs(b[k] / a[k] - 1));
        g_string_append_printf(s, "%c,%g,%g", "np"[type], widths[i], low);
        if (taper) g_string_append_printf(s, ";%g", high);
        g_string_append_printf(s, ",%.9g,%.9g\n", a[0], a[1]);
      }
  char *path = g_build_filename(opc_test_folder(), name, NULL);
  g_assert_true(g_file_set_contents(path, s->str, -1, NULL));
  g_string_free(s, TRUE);
  return path;
}

static const char terms[] =
    ", nmos: { ion_edge: 0.4, ion_decay: 22 nm, ioff_edge: 3, ioff_decay: 9 nm "
    "}, pmos: { ion_edge: -0.3, ion_decay: 14 nm, ioff_edge: -0.6, ioff_decay: "
    "30 nm }";
static const double truth[4][2] = {{0.4, 22}, {3, 9}, {-0.3, 14}, {-0.6, 30}};

static void gamma_fit(const char *reference, const char *more) {
  g_autofree char *map =
      g_strdup_printf(", reference: '%s'%s", reference, more);
  opc_error error;
  g_autoptr(opc_module) m = module_make("devices.fit_gamma", map, &error);
  if (!m || opc_test_run(m, NULL, &error)) g_error("%s", error.message);
}

/* Return the largest deviation, %, of extractor.gamma with the fitted table. */
static double table_check(const char *table) {
  g_autofree char *path = g_build_filename(opc_test_folder(), table, NULL);
  g_autofree char *more = g_strdup_printf(", table: '%s'", path);
  g_autoptr(opc_module) found = extractor(more);
  g_autoptr(opc_module) known = extractor(terms);
  double worst = 0;
  for (uint8_t type = 0; type < 2; type++)
    for (double w = 100; w < 1000; w *= 1.3) {
      double a[2], b[2];
      currents(known, type, w, 60, 68, &a[0], &a[1]);
      currents(found, type, w, 60, 68, &b[0], &b[1]);
      for (int k = 0; k < 2; k++)
        worst = fmax(worst, 100 * fabs(b[k] / a[k] - 1));
    }
  return worst;
}

static void test_edge(void) {
  double plain[2];
  g_autofree char *reference = write_reference("edge.csv", terms, plain);
  opc_test_forget();
  gamma_fit(reference, ", table: edge-gamma.csv");
  g_assert_cmpuint(opc_test_rows("gamma"), ==, 4);
  for (size_t k = 0; k < 4; k++) {
    double a = opc_test_number("gamma", "edge", k);
    double decay = opc_test_number("gamma", "decay", k);
    g_autofree char *type = g_strdup(opc_test_text("gamma", "type", k));
    g_test_message("%s %s: %.4f at %.3f nm, plain is %.1f %% off", type,
                   opc_test_text("gamma", "current", k), a, decay,
                   opc_test_number("gamma", "plain_max", k));
    g_assert_cmpfloat(fabs(a / truth[k][0] - 1), <, 0.01);
    g_assert_cmpfloat(fabs(decay / truth[k][1] - 1), <, 0.01);
    g_assert_cmpfloat(opc_test_number("gamma", "plain_max", k), >, 5);
    g_assert_cmpfloat(opc_test_number("gamma", "gamma_max", k), <, 0.1);
  }
  g_assert_cmpfloat(plain[0], >, 5);
  g_assert_cmpfloat(opc_test_metric("ion_max"), <, 0.1);
  g_assert_cmpuint(opc_test_rows("gamma_residuals"), ==, 48);
  double worst = table_check("edge-gamma.csv");
  g_test_message("other transistors: %.4f %% off", worst);
  g_assert_cmpfloat(worst, <, 0.2);
}

static void test_table(void) {
  double plain[2];
  g_autofree char *reference = write_reference("free.csv", terms, plain);
  opc_test_forget();
  gamma_fit(reference,
            ", form: table, edges: [0 nm, 15 nm, 40 nm, 120 nm], "
            "table: free-gamma.csv");
  g_assert_true(isnan(opc_test_number("gamma", "edge", 0)));
  double worst = table_check("free-gamma.csv");
  g_test_message("other transistors: %.4f %% off", worst);
  g_assert_cmpfloat(worst, <, 1);
}

/* Test the table of several widths of this project, whose edges carry no
   current: both forms fit it with their defaults. */
static void test_widths(void) {
  const char *source = g_getenv("OPCFLOW_SOURCE");
  g_autofree char *reference = g_build_filename(
      source ? source : ".", "data", "devices", "ptm65-widths.yaml", NULL);
  static const char *const forms[] = {"edge", "table"};
  for (size_t k = 0; k < G_N_ELEMENTS(forms); k++) {
    g_autofree char *more = g_strdup_printf(
        ", form: %s, table: widths.csv, length: { from: 55 nm, to: 80 nm }",
        forms[k]);
    opc_test_forget();
    gamma_fit(reference, more);
    g_assert_cmpuint(opc_test_rows("gamma_residuals"), ==, 4 * 8 * 26);
    for (size_t i = 0; i < 4; i++) {
      g_assert_cmpfloat(opc_test_number("gamma", "plain_max", i), >, 13);
      g_assert_cmpfloat(opc_test_number("gamma", "gamma_max", i), <, 2);
      /* The card removes 5 nm at each edge from the channel for Ioff. */
      if (k == 0 && i % 2)
        g_assert_cmpfloat(fabs(-opc_test_number("gamma", "edge", i) *
                                   opc_test_number("gamma", "decay", i) -
                               5),
                          <, 0.1);
    }
    g_autofree char *path =
        g_build_filename(opc_test_folder(), "widths.csv", NULL);
    g_autofree char *term = g_strdup_printf(", table: '%s'", path);
    g_autoptr(opc_module) found = extractor(term);
    double ion, ioff;
    currents(found, EDA_NMOS, 100, 65, 65, &ion, &ioff);
    g_test_message("W = 100 nm, L = 65 nm: Ion %.6g A", ion);
    g_assert_cmpfloat(fabs(ion / 0.0001081513 - 1), <, 0.005);
  }
}

static void assert_refused(const char *text, const char *more,
                           const char *message) {
  g_autofree char *path = g_build_filename(opc_test_folder(), "bad.csv", NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  g_autofree char *map = g_strdup_printf(", reference: '%s'%s", path, more);
  opc_error error;
  g_autoptr(opc_module) m = module_make("devices.fit_gamma", map, &error);
  if (m) g_assert_cmpint(opc_test_run(m, NULL, &error), ==, OPC_INVALID);
  if (!strstr(error.message, message))
    g_error("'%s' is not '%s'", error.message, message);
}

static void test_refused(void) {
  static const char head[] = "type,width,length,ion,ioff\n";
  static const struct {
    const char *rows, *more, *message;
  } cases[] = {
      {"n,100,65,1e-4,\n", "", "1 n-transistor with Ion, expected at least 2"},
      {"n,100,,1e-4,\n", "", "bad.csv:2:7: no length: ''"},
      {"n,100,65;x,1e-4,\n", "",
       "bad.csv:2:7: a length is not a number above 0 in '65;x'"},
      {"n,100,65,-1,\n", "", "bad.csv:2:10: not above 0: '-1'"},
      {"n,100,65,1,y\n", "", "bad.csv:2:12: not a number: 'y'"},
      {"n,100,65,1e-4,\nn,100,65,1e-4,\n",
       ", form: table, edges: [0 nm, 10 nm]", "at only 1 of 2 distances"},
      {"n,100,65,1e-4,\n", ", length: { from: 70 nm, to: 60 nm }",
       "bad.csv' has no transistor with a mean length of 70 to 60 nm"},
      {"n,100,65,1e-4,\n", ", edges: [10 nm, 0 nm]", "distances must increase"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *text = g_strconcat(head, cases[i].rows, NULL);
    assert_refused(text, cases[i].more, cases[i].message);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/fit-gamma/edge", test_edge);
  g_test_add_func("/fit-gamma/table", test_table);
  g_test_add_func("/fit-gamma/widths", test_widths);
  g_test_add_func("/fit-gamma/refused", test_refused);
  return g_test_run();
}
