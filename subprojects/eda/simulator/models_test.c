/* SPDX-License-Identifier: BSD-3-Clause */
/* A small model library: the statements that a device needs, bins, and nominal
   values without random draws. */
#include <eda/models.h>
#include <eda/simulator.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <stdlib.h>
#include <string.h>

static char *path;

#define BIN(number, l, w, vth)                                            \
  ".model core." number " nmos level=54 version=4.5 toxe=2n\n+ lmin = " l \
  " wmin=" w "\n+ vth0={" vth "+agauss( 0.01*(1+1) , 1,3)} u0=0.03\n"

static const char text[] =
    "* title\n.lib tt\n.param vt=0.4\n.options scale=1.0u parser\n"
    ".subckt nfet d g s b\n.param l=1 w=1\n"
    "M1 d g s b core l={l} w={w}\n"
    BIN("1", "1E-7 lmax = 2E-7", "1e-6 wmax=2e-6", "vt")
    BIN("2", "2E-7 lmax = 8E-7", "1e-6 wmax=2e-6", "vt-0.1")
    BIN("3", "1E-7 lmax = 2E-7", "2e-6 wmax=9e-6", "vt+0.1")
    ".ends nfet\n"
    ".subckt other a b\nr1 a b 1k\n.ends\n"
    ".subckt outer d g s b\nX1 d g s b NFET\n.ends\n"
    ".model alone pmos level=54 version=4.5 toxe=2n\n"
    ".endl\n.lib ss\n.param vt=0.6\n.endl ss\n";

static eda_models *models_load(const char *section) {
  opc_error error;
  eda_models *l = eda_models_read(path, section, NULL, &error);
  if (!l) g_error("%s", error.message);
  return l;
}

static void test_facts(void) {
  eda_models *l = models_load("tt");
  eda_sizes bins;
  g_assert_cmpint(eda_models_kind(l, "NFET"), ==, EDA_MODEL_SUBCIRCUIT);
  g_assert_cmpint(eda_models_kind(l, "alone"), ==, EDA_MODEL_CARD);
  g_assert_cmpint(eda_models_kind(l, "core"), ==, 0);
  g_assert_cmpfloat_with_epsilon(eda_models_unit(l), 1000, 1e-9);
  g_assert_true(eda_models_bins(l, "nfet", &bins));
  g_assert_cmpfloat_with_epsilon(bins.length[0], 100, 1e-9);
  g_assert_cmpfloat_with_epsilon(bins.length[1], 800, 1e-9);
  g_assert_cmpfloat_with_epsilon(bins.width[0], 1000, 1e-9);
  g_assert_cmpfloat_with_epsilon(bins.width[1], 9000, 1e-9);
  g_assert_false(eda_models_bins(l, "alone", &bins));
  eda_models_free(l);
  l = models_load("ss");
  g_assert_cmpint(eda_models_kind(l, "nfet"), ==, 0);
  g_assert_cmpfloat(eda_models_unit(l), ==, 1e9);
  eda_models_free(l);
}

/* Check the bins of an excerpt. */
static void cut_has(const eda_models *l, const eda_sizes *sizes, int extend,
                    const char *want, const char *bound) {
  char *cut = eda_models_cut(l, "nfet", sizes, extend);
  g_autoptr(GString) found = g_string_new(NULL);
  for (const char *k = "123"; *k; k++) {
    char name[] = {'c', 'o', 'r', 'e', '.', *k, 0};
    if (strstr(cut, name)) g_string_append_c(found, *k);
  }
  g_assert_cmpstr(found->str, ==, want);
  g_assert_null(strstr(cut, "other"));
  g_assert_null(strstr(cut, "alone"));
  g_assert_nonnull(strstr(cut, ".param vt=0.4"));
  if (*want) g_assert_nonnull(strstr(cut, "+agauss( 0.01*(1+1) ,0,3)}"));
  if (bound && !strstr(cut, bound)) g_error("no '%s' in %s", bound, cut);
  free(cut);
}

static void test_cut(void) {
  eda_models *l = models_load("tt");
  cut_has(l, &(eda_sizes){{120, 150}, {1500, 1500}}, 0, "1", "lmin = 1E-7");
  cut_has(l, &(eda_sizes){{120, 200}, {1500, 1500}}, 0, "12", NULL);
  cut_has(l, &(eda_sizes){{120, 250}, {500, 9000}}, 0, "123", NULL);
  cut_has(l, &(eda_sizes){{80, 90}, {1500, 1500}}, 0, "", NULL);
  /* The bound is 1 nm beyond the size, because a size equal to a bound may
     belong to no bin. */
  cut_has(l, &(eda_sizes){{80, 90}, {1500, 1500}}, 1, "1", "lmin=7.9e-08");
  cut_has(l, &(eda_sizes){{150, 160}, {500, 500}}, 1, "1", "wmin=4.99e-07");
  cut_has(l, &(eda_sizes){{900, 1000}, {1500, 1500}}, 1, "2", "lmax=1.001e-06");
  /* A subcircuit needs the subcircuits in it. */
  char *cut =
      eda_models_cut(l, "outer", &(eda_sizes){{120, 150}, {1500, 1500}}, 0);
  g_assert_nonnull(strstr(cut, ".subckt outer"));
  g_assert_nonnull(strstr(cut, ".subckt nfet"));
  g_assert_nonnull(strstr(cut, "core.1"));
  g_assert_null(strstr(cut, ".subckt other"));
  free(cut);
  eda_models_free(l);
}

/* Return the drain current of a deck; 0 and a skip without a simulator. */
static double current_of(const char *models) {
  opc_error error;
  eda_spice_result r;
  g_autofree char *deck = g_strdup_printf(
      "t\n%s.options temp=27\nx1 d g 0 0 nfet l=0.15 w=1.5\nvd d 0 1\n"
      "vg g 0 1\n.end\n",
      models);
  int code = eda_spice_run(NULL, deck, "op", 20, &r, &error);
  const eda_spice_vector *v =
      r.count ? eda_spice_vector_find(r.plot, "i(vd)") : NULL;
  double current = v ? -v->value[0] : 0;
  eda_spice_clear(&r);
  if (code == OPC_NO_PLUGIN) g_test_skip(error.message);
  if (code && code != OPC_NO_PLUGIN) g_error("%s", error.message);
  return current;
}

/* An excerpt of the library yields the same current as a hand-written card with
   nominal values. */
static void test_current(void) {
  eda_models *l = models_load("tt");
  char *cut =
      eda_models_cut(l, "nfet", &(eda_sizes){{150, 150}, {1500, 1500}}, 0);
  double current = current_of(cut);
  double by_hand = current_of(
      ".options scale=1u\n.subckt nfet d g s b\n.param l=1 w=1\n"
      "m1 d g s b n l={l} w={w}\n"
      ".model n nmos level=54 version=4.5 toxe=2n vth0=0.42 u0=0.03\n.ends\n");
  g_assert_cmpfloat_with_epsilon(current, by_hand, 1e-9 * by_hand);
  free(cut);
  eda_models_free(l);
}

static void test_refused(void) {
  opc_error error;
  g_assert_null(eda_models_read(path, "fs", NULL, &error));
  g_assert_cmpint(error.code, ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "no section 'fs'"));
  g_assert_null(eda_models_read("/none/at.all", NULL, NULL, &error));
  g_assert_cmpint(error.code, ==, OPC_IO);
  g_assert_null(eda_models_read(path, "tt", "/none/at.osdi", &error));
  g_assert_cmpint(error.code, ==, OPC_IO);
  g_assert_nonnull(strstr(error.message, "/none/at.osdi"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_autofree char *folder = g_dir_make_tmp("eda-XXXXXX", NULL);
  path = g_build_filename(folder, "made.lib", NULL);
  g_assert_true(g_file_set_contents(path, text, -1, NULL));
  g_test_add_func("/models/facts", test_facts);
  g_test_add_func("/models/cut", test_cut);
  g_test_add_func("/models/current", test_current);
  g_test_add_func("/models/refused", test_refused);
  int failed = g_test_run();
  g_unlink(path);
  g_rmdir(folder);
  g_free(path);
  return failed;
}
