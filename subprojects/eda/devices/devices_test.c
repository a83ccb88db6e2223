/* SPDX-License-Identifier: BSD-3-Clause */
/* Valid device tables, and the faults of invalid ones. */
#include <eda/devices.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

static char *folder;

static eda_devices *table_load(const char *text, opc_error *error) {
  g_assert_true(g_file_set_contents("table.yaml", text, -1, NULL));
  return eda_devices_read("table.yaml", error);
}

static const char good[] =
    "opcflow-devices: 1\nname: test bulk\nsource: somewhere\nsupply: 1100 mV\n"
    "temperature: 27 C\nwidth: 10 um\nion: at full supply\nioff: at none\n"
    "length: { unit: um, values: [0.044, 0.065, 1] }\n"
    "nmos:\n  ion: { unit: mA, values: [12, 11, 1] }\n"
    "  ioff: { unit: nA, values: [30, 20, 1e-3] }\n"
    "pmos:\n  ion: { unit: A, values: [6e-3, 5e-3, 1e-3] }\n"
    "  ioff: { unit: pA, values: [3, 2, 1] }\n";

static void test_good(void) {
  opc_error error;
  eda_devices *d = table_load(good, &error);
  g_assert_nonnull(d);
  g_assert_cmpuint(d->count, ==, 3);
  g_assert_cmpstr(d->name, ==, "test bulk");
  g_assert_true(d->supply == 1.1 && d->width == 10000);
  g_assert_true(d->length[0] == 44 && d->length[1] == 65);
  /* Per nm of width. */
  g_assert_cmpfloat_with_epsilon(d->ion[EDA_NMOS][0], 12e-3 / 1e4, 1e-20);
  g_assert_cmpfloat_with_epsilon(d->ioff[EDA_NMOS][2], 1e-12 / 1e4, 1e-30);
  g_assert_cmpfloat_with_epsilon(d->ion[EDA_PMOS][1], 5e-3 / 1e4, 1e-20);
  g_assert_cmpfloat_with_epsilon(d->ioff[EDA_PMOS][1], 2e-12 / 1e4, 1e-30);
  eda_devices_free(d);
  eda_devices_free(NULL);
}

/* Test the shortest length of the model; that of the other type is unknown. */
static void test_modelled(void) {
  opc_error error;
  g_autofree char *text = g_strconcat(good, "nmos_modelled: 50 nm\n", NULL);
  eda_devices *d = table_load(text, &error);
  g_assert_nonnull(d);
  g_assert_true(d->modelled[EDA_NMOS] == 50 && d->modelled[EDA_PMOS] == 0);
  eda_devices_free(d);
  g_autofree char *zero = g_strconcat(good, "pmos_modelled: 0 nm\n", NULL);
  g_assert_null(table_load(zero, &error));
  g_assert_cmpstr(error.message, ==,
                  "table.yaml:16:16: 'pmos_modelled' must be above 0 nm, found "
                  "'0 nm'");
}

/* Two lengths, three widths. */
static const char wide[] =
    "opcflow-devices: 1\nname: w\nsupply: 1 V\n"
    "width: { unit: um, values: [0.5, 1, 10] }\n"
    "length: { unit: nm, values: [50, 60] }\n"
    "nmos:\n  ion: { unit: mA, values: [[5, 4], [11, 9], [120, 100]] }\n"
    "  ioff: { unit: nA, values: [[5, 4], [11, 9], [120, 130]] }\n"
    "pmos:\n  ion: { unit: mA, values: [[2, 1], [4, 3], [40, 30]] }\n"
    "  ioff: { unit: nA, values: [[5, 4], [11, 9], [120, 100]] }\n";

static void test_widths(void) {
  opc_error error;
  eda_devices *d = table_load(wide, &error);
  g_assert_nonnull(d);
  g_assert_cmpuint(d->narrow, ==, 2);
  g_assert_true(d->width == 10000);
  g_assert_true(d->narrow_width[0] == 500 && d->narrow_width[1] == 1000);
  g_assert_cmpfloat_with_epsilon(d->ion[EDA_NMOS][1], 0.1 / 1e4, 1e-20);
  g_assert_cmpfloat_with_epsilon(d->narrow_ion[EDA_NMOS][0], 5e-3 / 500, 1e-20);
  g_assert_cmpfloat_with_epsilon(d->narrow_ion[EDA_NMOS][3], 9e-3 / 1e3, 1e-20);
  g_assert_cmpfloat_with_epsilon(d->narrow_ioff[EDA_PMOS][1], 4e-9 / 500,
                                 1e-26);
  eda_devices_free(d);
}

/* Check the fault of a table with one text replaced; `*` in `expected` matches
   anything. */
static void check_fault_of(const char *table, const char *old, const char *new,
                           const char *expected) {
  const char *at = strstr(table, old);
  g_assert_nonnull(at);
  g_autofree char *head = g_strndup(table, (gsize)(at - table));
  g_autofree char *text = g_strconcat(head, new, at + strlen(old), NULL);
  opc_error error = {0};
  g_assert_null(table_load(text, &error));
  g_assert_cmpint(error.code, ==, OPC_INVALID);
  if (!g_pattern_match_simple(expected, error.message))
    g_error("%s\nnot\n%s", error.message, expected);
}

static void check_fault(const char *old, const char *new,
                        const char *expected) {
  check_fault_of(good, old, new, expected);
}

static void test_width_faults(void) {
  check_fault_of(wide, "[0.5, 1, 10]", "[1, 1, 10]",
                 "table.yaml:4:32: widths must increase: '1'");
  check_fault_of(wide, "[0.5, 1, 10]", "[10]",
                 "table.yaml:4:8: a list of widths must have at least two "
                 "values (and 12 more)");
  check_fault_of(
      wide, "[[5, 4], [11, 9], [120, 100]]", "[[5, 4], [11, 9]]",
      "table.yaml:7:28: 'ion' has 2 lists, expected 3 as in 'width'");
  check_fault_of(
      wide, "[[5, 4], [11", "[[5, 4, 3], [11",
      "table.yaml:7:29: 'ion' must be a list of 2 values for each width");
  check_fault_of(
      wide, "[[5, 4], [11", "[4, [11",
      "table.yaml:7:29: 'ion' must be a list of 2 values for each width");
  check_fault_of(
      wide, "{ unit: um, values: [0.5, 1, 10] }", "1 um",
      "table.yaml:7:29: 'ion' requires a current with a unit, found a "
      "list (and 11 more)");
}

static void test_faults(void) {
  check_fault("supply: 1100", "suply: 1100",
              "table.yaml:1:1: missing 'supply' (and 1 more)");
  check_fault(
      "devices: 1", "devices: 2",
      "table.yaml:1:18: 'opcflow-devices' must be at most 1, found '2'");
  check_fault("[0.044, 0.065, 1]", "[0.044, 0.044, 1]",
              "table.yaml:9:37: lengths must increase: '0.044'");
  check_fault(
      "[0.044, 0.065, 1]", "[0.044]",
      "table.yaml:9:29: 'length' must have at least two values (and 4 more)");
  check_fault("[12, 11, 1]", "[12, 11]",
              "table.yaml:11:8: 'ion' has 2 values, expected 3 as in 'length'");
  check_fault("[12, 11, 1]", "[12, 0, 1]",
              "table.yaml:11:33: 'ion' must be above 0 A, found '0 mA'");
  check_fault(
      "[12, 11, 1]", "[12, nan, 1]",
      "table.yaml:11:33: 'ion' requires a current with a unit, found 'nan mA'");
  check_fault("[12, 11, 1]", "[12, 1e999, 1]",
              "table.yaml:11:33: 'ion' is too large: '1e999 mA'");
  check_fault(
      "unit: mA", "unit: mV",
      "table.yaml:11:29: 'ion' requires a current, found '12 mV' (and 2 "
      "more)");
  check_fault("{ unit: mA, values: [12, 11, 1] }", "[1, 2, 3]",
              "table.yaml:11:8: 'ion' needs a map");
  check_fault("[30, 20, 1e-3]", "[3e7, 2e7, 1e6]",
              "table.yaml:12:40: 'ioff' at 1000 nm is not below 'ion'");
  check_fault("width: 10 um", "width: 0 um",
              "table.yaml:6:8: 'width' must be above 0 nm, found '0 um'");
  check_fault(good, "[]",
              "table.yaml:1:1: a device table must be a map, found a list");
}

/* ---- capacitance of the gate ---- */

/* Return (area L + 2 edge) W + 2 end L + 4 corner, which is linear in L and in
   W. */
static double made_up(int type, double length, double width) {
  double area = type ? 1.3e-20 : 1.1e-20; /* F/nm2 */
  return (area * length + 3e-19) * width + 7e-20 * length + 5e-18;
}

static void put_made_up(GString *out, int type, size_t widths,
                        const double *width, size_t lengths,
                        const double *length) {
  g_string_append(out, "  cgate: { unit: fF, values: [");
  for (size_t w = 0; w < widths; w++) {
    g_string_append(out, w ? ", " : "");
    g_string_append(out, widths > 1 ? "[" : "");
    for (size_t i = 0; i < lengths; i++)
      g_string_append_printf(out, "%s%.15g", i ? ", " : "",
                             1e15 * made_up(type, length[i], width[w]));
    g_string_append(out, widths > 1 ? "]" : "");
  }
  g_string_append(out, "] }\n");
}

enum { N = 1, P = 2 };

/* Return the table `text` with capacitances of made_up for N, P or both
   types. */
static char *with_cgate(const char *text, int types, size_t widths,
                        const double *width, size_t lengths,
                        const double *length) {
  const char *pmos = strstr(text, "pmos:");
  GString *out = g_string_new_len(text, pmos - text);
  if (types & N) put_made_up(out, EDA_NMOS, widths, width, lengths, length);
  g_string_append(out, pmos);
  if (types & P) put_made_up(out, EDA_PMOS, widths, width, lengths, length);
  g_string_append(out, "cgate: how\n");
  return g_string_free(out, FALSE);
}

static const double few_lengths[] = {44, 65, 1000}, one_width[] = {10000};
static const double two_lengths[] = {50, 60}, some_widths[] = {500, 1e3, 1e4};

static void check_made_up(const eda_devices *d, int type, double length,
                          double width, double want) {
  double got = eda_devices_cgate(d, type, length, width);
  if (!(fabs(got / want - 1) < 1e-12))
    g_error("%c, L %g, W %g: %g F, not %g F", "np"[type], length, width, got,
            want);
}

static void test_cgate(void) {
  static const double lengths[] = {50, 53.7, 60};
  static const double widths[] = {500, 750, 1000, 2345, 1e4};
  opc_error error;
  g_autofree char *text =
      with_cgate(wide, N | P, 3, some_widths, 2, two_lengths);
  eda_devices *d = table_load(text, &error);
  if (!d) g_error("%s", error.message);
  for (int type = 0; type < 2; type++) {
    for (size_t l = 0; l < G_N_ELEMENTS(lengths); l++) {
      for (size_t w = 0; w < G_N_ELEMENTS(widths); w++)
        check_made_up(d, type, lengths[l], widths[w],
                      made_up(type, lengths[l], widths[w]));
      /* Above the largest width: proportional to width. */
      check_made_up(d, type, lengths[l], 3e4,
                    3 * made_up(type, lengths[l], 1e4));
    }
    g_assert_true(isnan(eda_devices_cgate(d, type, 49.9, 1e3)));
    g_assert_true(isnan(eda_devices_cgate(d, type, 60.1, 1e3)));
    g_assert_true(isnan(eda_devices_cgate(d, type, 55, 499)));
    g_assert_true(isnan(eda_devices_cgate(d, type, NAN, 1e3)));
    g_assert_true(isnan(eda_devices_cgate(d, type, 55, NAN)));
  }
  eda_devices_free(d);
}

static void test_cgate_one_width(void) {
  opc_error error;
  g_autofree char *text = with_cgate(good, N | P, 1, one_width, 3, few_lengths);
  eda_devices *d = table_load(text, &error);
  if (!d) g_error("%s", error.message);
  check_made_up(d, EDA_NMOS, 50, 1e4, made_up(EDA_NMOS, 50, 1e4));
  check_made_up(d, EDA_PMOS, 500, 100, made_up(EDA_PMOS, 500, 1e4) / 100);
  eda_devices_free(d);
  d = table_load(good, &error);
  g_assert_null(d->cgate[EDA_NMOS]);
  g_assert_true(isnan(eda_devices_cgate(d, EDA_NMOS, 50, 1e4)));
  eda_devices_free(d);
}

/* Nonlinear capacitances, fF: only adjacent nodes have an effect. */
static void test_cgate_bent(void) {
  static const char lines[] =
      "  cgate: { unit: fF, values: [[1, 2], [3, 5], [40, 60]] }\n";
  static const char line[] = "  cgate: { unit: fF, values: [10, 20, 100] }\n";
  opc_error error;
  const char *pmos = strstr(wide, "pmos:");
  g_autofree char *head = g_strndup(wide, (gsize)(pmos - wide));
  g_autofree char *text = g_strconcat(head, lines, pmos, lines, NULL);
  eda_devices *d = table_load(text, &error);
  if (!d) g_error("%s", error.message);
  check_made_up(d, EDA_NMOS, 55, 750, 2.75e-15);
  check_made_up(d, EDA_PMOS, 55, 5500, 27e-15);
  eda_devices_free(d);
  pmos = strstr(good, "pmos:");
  g_autofree char *start = g_strndup(good, (gsize)(pmos - good));
  g_autofree char *other = g_strconcat(start, line, pmos, line, NULL);
  d = table_load(other, &error);
  if (!d) g_error("%s", error.message);
  check_made_up(d, EDA_NMOS, 54.5, 1e4, 15e-15);
  check_made_up(d, EDA_PMOS, 532.5, 1e4, 60e-15);
  eda_devices_free(d);
}

static void test_cgate_faults(void) {
  g_autofree char *n = with_cgate(good, N, 1, one_width, 3, few_lengths);
  g_autofree char *p = with_cgate(good, P, 1, one_width, 3, few_lengths);
  g_autofree char *both = with_cgate(good, N | P, 1, one_width, 3, few_lengths);
  g_autofree char *less = with_cgate(good, N | P, 1, one_width, 2, few_lengths);
  g_autofree char *rows =
      with_cgate(wide, N | P, 2, some_widths, 2, two_lengths);
  check_fault_of(n, "unit", "unit",
                 "table.yaml:1:1: only one type has 'cgate'");
  check_fault_of(p, "unit", "unit",
                 "table.yaml:1:1: only one type has 'cgate'");
  check_fault_of(less, "unit", "unit",
                 "table.yaml:13:10: 'cgate' has 2 values, expected 3 as in "
                 "'length' (and 1 more)");
  check_fault_of(rows, "unit", "unit",
                 "table.yaml:9:30: 'cgate' has 2 lists, expected 3 as in "
                 "'width' (and 1 more)");
  check_fault_of(both, "unit: fF", "unit: A",
                 "table.yaml:13:30: 'cgate' requires a capacitance, found '*");
  check_fault_of(both, "fF, values: [", "fF, values: [-",
                 "table.yaml:13:31: 'cgate' must be above 0 F, found '-*");
}

/* A file of several tables: each table after the first has a flavour. */
static void test_flavours(void) {
  opc_error error;
  g_autofree char *both = g_strconcat(good, "---\nflavour: lvt\n", wide,
                                      "---\nflavour: hv\n", good, NULL);
  eda_devices *d = table_load(both, &error);
  if (!d) g_error("%s", error.message);
  g_assert_null(d->flavour);
  g_assert_cmpuint(d->count, ==, 3);
  g_assert_cmpstr(d->next->flavour, ==, "lvt");
  g_assert_cmpuint(d->next->narrow, ==, 2);
  g_assert_cmpstr(d->next->next->flavour, ==, "hv");
  g_assert_cmpstr(d->next->next->name, ==, "test bulk");
  g_assert_null(d->next->next->next);
  eda_devices_free(d);
  static const struct {
    const char *head, *want;
  } bad[] = {
      {"",
       "table.yaml:17:1: 'flavour' is missing, required for all tables after "
       "the first"},
      {"flavour: hv\n---\nflavour: hv\n",
       "table.yaml:17:1: missing 'opcflow-devices' (and *"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
    g_autofree char *text = g_strconcat(good, "---\n", bad[i].head, good, NULL);
    g_assert_null(table_load(text, &error));
    if (!g_pattern_match_simple(bad[i].want, error.message))
      g_error("%s", error.message);
  }
  g_autofree char *twice = g_strconcat(good, "---\nflavour: hv\n", good,
                                       "---\n", good, "flavour: hv\n", NULL);
  g_assert_null(table_load(twice, &error));
  g_assert_nonnull(strstr(error.message, "a second table of flavour 'hv'"));
  g_autofree char *first = g_strconcat("flavour: hv\n", good, NULL);
  g_assert_null(table_load(first, &error));
  g_assert_cmpstr(error.message, ==,
                  "table.yaml:1:10: the first table must not have a 'flavour'");
}

static void test_missing(void) {
  opc_error error = {0};
  g_assert_null(eda_devices_read("none.yaml", &error));
  g_assert_cmpint(error.code, ==, OPC_IO);
  g_assert_cmpstr(error.message, ==, "'none.yaml': no such file");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_assert_cmpint(g_chdir(folder), ==, 0);
  g_test_add_func("/devices/good", test_good);
  g_test_add_func("/devices/modelled", test_modelled);
  g_test_add_func("/devices/faults", test_faults);
  g_test_add_func("/devices/widths", test_widths);
  g_test_add_func("/devices/width-faults", test_width_faults);
  g_test_add_func("/devices/flavours", test_flavours);
  g_test_add_func("/devices/cgate", test_cgate);
  g_test_add_func("/devices/cgate-one-width", test_cgate_one_width);
  g_test_add_func("/devices/cgate-bent", test_cgate_bent);
  g_test_add_func("/devices/cgate-faults", test_cgate_faults);
  g_test_add_func("/devices/missing", test_missing);
  int failed = g_test_run();
  g_unlink("table.yaml");
  g_assert_cmpint(g_chdir("/"), ==, 0);
  g_assert_cmpint(g_rmdir(folder), ==, 0);
  g_free(folder);
  return failed;
}
