/* SPDX-License-Identifier: BSD-3-Clause */
/* Whole flows through the command, as a user runs them: what the ready flows
   reach, that nothing depends on the number of threads or on the orientation
   of a cell, and what is said of bad input. */
#include <gio/gio.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

static char *folder;   /* of all runs; removed at the end */

static char *source(const char *name) {
  return g_build_filename(g_getenv("OPCFLOW_SOURCE"), name, NULL);
}

static char *test_data(const char *name) {
  const char *root = g_getenv("OPCFLOW_TEST_DATA");
  g_autofree char *usual = source("../shared/data");
  char *path = g_build_filename(root ? root : usual, name, NULL);
  if (g_file_test(path, G_FILE_TEST_EXISTS)) return path;
  g_free(path);
  g_test_skip("no test data: set OPCFLOW_TEST_DATA");
  return NULL;
}

/* opcflow ARGS...; its exit code, and its standard error if asked for. */
static int opcflow(char **errors, const char *first, ...) {
  g_autoptr(GPtrArray) argv = g_ptr_array_new_with_free_func(g_free);
  g_ptr_array_add(argv, g_build_filename(g_getenv("OPCFLOW_BUILD"), "opcflow", NULL));
  va_list args;
  va_start(args, first);
  for (const char *a = first; a; a = va_arg(args, const char *))
    g_ptr_array_add(argv, g_strdup(a));
  va_end(args);
  g_ptr_array_add(argv, NULL);
  g_autoptr(GError) error = NULL;
  g_autofree char *out = NULL, *err = NULL;
  int status;
  g_spawn_sync(NULL, (char **)argv->pdata, NULL, 0, NULL, NULL, &out, &err,
               &status, &error);
  g_assert_no_error(error);
  g_assert_true(WIFEXITED(status));   /* no signal */
  if (errors) *errors = g_steal_pointer(&err);
  else if (WEXITSTATUS(status)) g_test_message("%s", err);
  return WEXITSTATUS(status);
}

static char *place(const char *name) { return g_build_filename(folder, name, NULL); }

static GBytes *bytes(const char *run, const char *file) {
  g_autofree char *path = g_build_filename(folder, run, file, NULL);
  char *text = NULL;
  gsize length;
  g_file_get_contents(path, &text, &length, NULL);
  g_assert_nonnull(text);
  return g_bytes_new_take(text, length);
}

static void expect_equal(const char *run, const char *other, const char *file) {
  g_autoptr(GBytes) a = bytes(run, file), b = bytes(other, file);
  if (!g_bytes_equal(a, b)) g_error("%s differs between %s and %s", file, run, other);
}

/* A metric of a run's step. */
static double metric(const char *run, const char *step, const char *name) {
  g_autoptr(GBytes) text = bytes(run, "metrics.json");
  g_autoptr(JsonParser) parser = json_parser_new();
  g_assert_true(json_parser_load_from_data(
      parser, g_bytes_get_data(text, NULL), (gssize)g_bytes_get_size(text), NULL));
  JsonObject *o = json_node_get_object(json_parser_get_root(parser));
  g_assert_true(json_object_has_member(o, step));
  o = json_object_get_object_member(o, step);
  g_assert_true(json_object_has_member(o, name));
  return json_object_get_double_member(json_object_get_object_member(o, name), "value");
}

static void test_demo(void) {
  g_autofree char *flow = source("flows/demo.yaml"), *out = place("demo");
  g_assert_cmpint(opcflow(NULL, "run", flow, "--output", out, NULL), ==, 0);
  g_assert_cmpfloat(metric("demo", "mask", "transistors"), ==, 4);
  g_assert_cmpfloat(metric("demo", "mask", "ion_max_drawn"), >, 5);
  g_assert_cmpfloat(metric("demo", "mask", "ion_max"), <=, 0.5);
  g_assert_cmpfloat(metric("demo", "mask", "failed"), ==, 0);
  g_assert_cmpfloat(metric("demo", "mask", "violations"), ==, 0);
  const char *files[] = {"mask.gds", "gates.csv", "metrics.json", "flow.yaml",
                         "mask.png", "manifest.json"};
  for (size_t i = 0; i < G_N_ELEMENTS(files); i++) {
    g_autoptr(GBytes) content = bytes("demo", files[i]);
    g_assert_cmpuint(g_bytes_get_size(content), >, 0);
  }
}

/* The resolved flow of a run gives the same masks and figures again. */
static void test_resolved(void) {
  g_autofree char *flow = place("demo/flow.yaml"), *out = place("again");
  g_assert_cmpint(opcflow(NULL, "run", flow, "--output", out, NULL), ==, 0);
  expect_equal("demo", "again", "gates.csv");
  expect_equal("demo", "again", "mask.gds");
}

/* Same bytes for any number of threads. */
static void test_threads(void) {
  g_autofree char *flow = source("flows/demo.yaml");
  for (int threads = 1; threads <= 4; threads++) {
    g_autofree char *name = g_strdup_printf("threads%d", threads);
    g_autofree char *number = g_strdup_printf("%d", threads), *out = place(name);
    g_assert_cmpint(opcflow(NULL, "run", flow, "--threads", number, "--output",
                            out, NULL), ==, 0);
    expect_equal("threads1", name, "gates.csv");
    expect_equal("threads1", name, "mask.gds");
  }
}

/* A NAND2 with horizontal gates is the same one, turned: as drawn, its
   transistors deviate the same. */
static void test_orientation(void) {
  g_autofree char *flow = source("flows/demo.yaml"), *out = place("turned");
  g_autofree char *file = source("data/cells65/nand2h.cif");
  g_autofree char *set = g_strdup_printf("layout.file=%s", file);
  g_assert_cmpint(opcflow(NULL, "run", flow, "--set", set, "--output", out, NULL),
                  ==, 0);
  const char *figures[] = {"ion_mean_drawn", "ion_max_drawn"};
  for (size_t i = 0; i < G_N_ELEMENTS(figures); i++)
    g_assert_cmpfloat(fabs(metric("turned", "mask", figures[i]) -
                           metric("demo", "mask", figures[i])), <, 0.02);
  g_assert_cmpfloat(metric("turned", "mask", "ion_max"), <=, 0.5);
}

/* NAND2_X1 of the NanGate library, scaled to L = 65 nm. */
static void test_nangate(void) {
  g_autofree char *file = test_data("nangate45/NangateOpenCellLibrary.gds");
  if (!file) return;
  g_autofree char *flow = source("flows/dpb.yaml"), *out = place("nangate");
  g_autofree char *set = g_strdup_printf("layout.file=%s", file);
  g_assert_cmpint(opcflow(NULL, "run", flow, "--set", set, "--set",
                          "layout.scale=1.3", "--set", "layout.top=NAND2_X1",
                          "--output", out, NULL), ==, 0);
  g_assert_cmpfloat(metric("nangate", "mask", "transistors"), ==, 4);
  g_assert_cmpfloat(metric("nangate", "mask", "ion_max"), <=, 0.5);
}

/* The mask again, by the models of its loop and by others. */
static void test_verify(void) {
  g_autofree char *flow = place("verify.yaml"), *out = place("verify");
  g_autofree char *demo = source("flows/demo.yaml");
  g_autofree char *devices = source("data/devices/ptm65.yaml");
  g_autofree char *text = g_strdup_printf(
      "opcflow: 1\nname: verify\nextends: %s\nsteps:\n"
      "  same:\n    use: verify\n    mask: ${mask}\n"
      "    litho: { use: litho.hopkins, wavelength: 193 nm, na: 0.75, sigma: 0.75 }\n"
      "    resist: { use: resist.threshold, anchor: { line: 65 nm, pitch: 250 nm } }\n"
      "    extract: { use: extract.plain, devices: %s }\n"
      "  other:\n    use: verify\n    mask: ${same}\n"
      "    litho: { use: litho.abbe, wavelength: 193 nm, na: 0.75, sigma: 0.75 }\n"
      "    resist: { use: resist.threshold, anchor: { line: 65 nm, pitch: 250 nm } }\n"
      "    extract: { use: extract.plain, devices: %s }\n",
      demo, devices, devices);
  g_assert_true(g_file_set_contents(flow, text, -1, NULL));
  g_assert_cmpint(opcflow(NULL, "run", flow, "--output", out, NULL), ==, 0);
  const char *figures[] = {"ion_mean", "ion_max", "ion_stdv", "area_mean",
                           "area_max", "ioff_mean", "failed"};
  for (size_t i = 0; i < G_N_ELEMENTS(figures); i++)   /* the same bits */
    g_assert_true(metric("verify", "same", figures[i]) ==
                  metric("verify", "mask", figures[i]));
  g_assert_true(metric("verify", "same", "ion_change_max") == 0);
  g_assert_cmpfloat(metric("verify", "other", "ion_change_mean"), >, 0);
  g_assert_cmpfloat(metric("verify", "other", "ion_change_max"), <, 4);
  g_assert_cmpfloat(metric("verify", "other", "failed"), ==, 0);
}

/* ---- bad input ---- */

static void expect(int want, const char *say, const char *set) {
  g_autofree char *flow = source("flows/demo.yaml"), *out = place("bad");
  g_autofree char *errors = NULL;
  int code = opcflow(&errors, "run", flow, "--set", set, "--output", out, NULL);
  if (code != want || !strstr(errors, say))
    g_error("--set %s: exit code %d, want %d; '%s' is not in:\n%s", set, code,
            want, say, errors);
  g_assert_false(g_file_test(out, G_FILE_TEST_EXISTS));
}

static void test_bad_input(void) {
  expect(5, "nowhere.cif", "layout.file=nowhere.cif");
  expect(2, "XY", "layout.layers.poly=XY");
  expect(2, "did you mean 'max_pde'", "mask.synthesizer.max_ped=0.5 %");
  expect(3, "litho.hopkin", "mask.litho.use=litho.hopkin");
}

/* Poly and active that never meet. */
static void test_no_transistor(void) {
  g_autofree char *cif = place("apart.cif");
  g_assert_true(g_file_set_contents(
      cif,
      "L CP; B 10 100 0 0; L CA; B 50 20 500 0; L CC; B 8 8 500 0; "
      "L CW; B 200 200 500 0; E\n",
      -1, NULL));
  g_autofree char *set = g_strdup_printf("layout.file=%s", cif);
  expect(2, "no transistor", set);
}

static void test_truncated(void) {
  g_autofree char *whole = NULL, *flow = source("flows/dpb.yaml");
  g_autofree char *mask = place("demo/mask.gds"), *cut = place("cut.gds");
  gsize length;
  g_assert_true(g_file_get_contents(mask, &whole, &length, NULL));
  g_assert_true(g_file_set_contents(cut, whole, (gssize)(length / 2 | 1), NULL));
  g_autofree char *set = g_strdup_printf("layout.file=%s", cut), *errors = NULL;
  g_autofree char *out = place("truncated");
  g_assert_cmpint(opcflow(&errors, "run", flow, "--set", set, "--output", out,
                          NULL), ==, 5);
  g_test_message("%s", errors);
  g_assert_nonnull(strstr(errors, "cut.gds"));
  g_assert_nonnull(strstr(errors, "byte"));
}

static void test_typo(void) {
  g_autofree char *flow = place("typo.yaml"), *errors = NULL;
  g_assert_true(g_file_set_contents(
      flow, "opcflow: 1\nname: typo\nsteps:\n  layout:\n    use: read.cfi\n", -1,
      NULL));
  g_assert_cmpint(opcflow(&errors, "run", flow, NULL), ==, 3);
  g_assert_nonnull(strstr(errors, "typo.yaml:5:"));
  g_assert_nonnull(strstr(errors, "did you mean 'read.cif'"));
}

static void remove_tree(const char *path) {
  GDir *dir = g_dir_open(path, 0, NULL);
  const char *name;
  while (dir && (name = g_dir_read_name(dir))) {
    g_autofree char *child = g_build_filename(path, name, NULL);
    remove_tree(child);
  }
  if (dir) g_dir_close(dir);
  g_remove(path);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  folder = g_dir_make_tmp("opcflow-flows-XXXXXX", NULL);
  g_test_add_func("/flows/demo", test_demo);
  g_test_add_func("/flows/resolved", test_resolved);
  g_test_add_func("/flows/threads", test_threads);
  g_test_add_func("/flows/orientation", test_orientation);
  g_test_add_func("/flows/nangate", test_nangate);
  g_test_add_func("/flows/verify", test_verify);
  g_test_add_func("/flows/bad-input", test_bad_input);
  g_test_add_func("/flows/no-transistor", test_no_transistor);
  g_test_add_func("/flows/truncated", test_truncated);
  g_test_add_func("/flows/typo", test_typo);
  int code = g_test_run();
  remove_tree(folder);
  g_free(folder);
  return code;
}
