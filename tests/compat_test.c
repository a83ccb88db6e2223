/* SPDX-License-Identifier: BSD-3-Clause */
/* Binary compatibility. Plugins kept as binaries (tests/compat) run in this
   opcflow, and in a build with an extended interface. In the extended
   interface, each extensible struct has one more member: a function of each
   kind, a field of each declaration, a function of each service; and the host
   has one more service. A plugin built with the extended interface uses the
   service there, and also runs in this opcflow, which lacks the service. */
#include <glib.h>
#include <store/files.h>
#include <string.h>
#include <sys/utsname.h>
#include <sys/wait.h>

static char *kept, *folder; /* folder of the binaries; folder of the runs */

/* Run this opcflow, or the build with the extended interface (`grown`), with
   words that have no blanks, and with the store in OPCFLOW_STORE. Return the
   output. */
static char *opcflow_call(gboolean grown, const char *words) {
  const char *build = g_getenv("OPCFLOW_BUILD");
  g_autofree char *line = g_strdup_printf(
      "%s/%s %s --plugin-path %s --plugin-path %s/tests/compat", build,
      grown ? "tests/compat/opcflow-grown" : "opcflow", words, kept, build);
  g_auto(GStrv) argv = g_strsplit(line, " ", -1);
  char *out = NULL;
  g_autofree char *err = NULL;
  int status;
  g_assert_true(g_spawn_sync(folder, argv, NULL, G_SPAWN_DEFAULT, NULL, NULL,
                             &out, &err, &status, NULL));
  if (!WIFEXITED(status) || WEXITSTATUS(status)) g_error("%s: %s", line, err);
  return out;
}

static char *read_file(const char *in, const char *name) {
  g_autofree char *path = g_build_filename(in, name, NULL);
  char *text = NULL;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  return text;
}

/* Run a kept flow and return the content of an output file. */
static char *run_flow(gboolean grown, const char *flow, const char *more,
                      const char *file) {
  g_autofree char *words = g_strdup_printf(
      "run %s/%s.yaml --output %s/run --force%s", kept, flow, folder, more);
  g_autofree char *run = g_build_filename(folder, "run", NULL);
  g_free(opcflow_call(grown, words));
  return read_file(run, file);
}

/* Covers declarations, work units, a table, an inner flow, a plugin in a
   slot. */
static void test_step(void) {
  g_autofree char *wanted = read_file(kept, "step.json");
  for (int grown = 0; grown < 2; grown++) {
    g_autofree char *got = run_flow(grown, "step", "", "metrics.json");
    g_assert_cmpstr(got, ==, wanted);
    g_autofree char *table = run_flow(grown, "step", "", "compat.csv");
    g_assert_cmpstr(table, ==,
                    "text,real (nm),whole\r\none,70,7\r\nother,30,2\r\n");
  }
}

static void test_results(void) {
  g_autofree char *store = g_build_filename(folder, "store", NULL);
  for (int grown = 0; grown < 2; grown++) {
    g_setenv("OPCFLOW_STORE", store, TRUE);
    g_free(run_flow(grown, "step", "", "metrics.json"));
    g_autofree char *again = run_flow(grown, "step", "", "metrics.json");
    g_autofree char *anew =
        run_flow(grown, "step", " --no-cache", "metrics.json");
    g_setenv("OPCFLOW_STORE", "", TRUE);
    g_assert_nonnull(strstr(again, "\"kept\" : {\n      \"value\" : 1.0"));
    g_assert_nonnull(strstr(anew, "\"kept\" : {\n      \"value\" : 0.0"));
  }
}

/* Covers models, synthesizer and regulator in the correction loop. */
static void test_correction(void) {
  g_autofree char *here = run_flow(FALSE, "correction", "", "gates.csv");
  g_autofree char *there = run_flow(TRUE, "correction", "", "gates.csv");
  g_assert_nonnull(strstr(here, "moved once"));
  g_assert_cmpstr(here, ==, there);
}

static void test_command(void) {
  for (int grown = 0; grown < 2; grown++) {
    g_autofree char *out = opcflow_call(grown, "compat a b c");
    g_assert_nonnull(strstr(out, "arguments"));
    g_assert_nonnull(strstr(out, "3"));
  }
}

/* A plugin of a later minor version with the step of the flow `step`. The added
   service doubles the metric `sum` of 30. */
static void test_newer(void) {
  g_autofree char *got = run_flow(FALSE, "newer", "", "metrics.json");
  g_autofree char *wanted = read_file(kept, "step.json");
  g_auto(GStrv) steps = g_strsplit(wanted, "\n  },\n  \"inner\"", 2);
  g_assert_true(g_str_has_prefix(got, steps[0]));
  g_autofree char *there = run_flow(TRUE, "newer", "", "metrics.json");
  g_assert_nonnull(strstr(got, "\"value\" : 30.0"));
  g_assert_nonnull(strstr(there, "\"value\" : 60.0"));
}

int main(int argc, char **argv) {
  struct utsname about;
  g_test_init(&argc, &argv, NULL);
  g_assert_false(uname(&about));
  kept = g_build_filename(g_getenv("OPCFLOW_SOURCE"), "tests", "compat",
                          about.machine, NULL);
  if (!g_file_test(kept, G_FILE_TEST_IS_DIR)) {
    g_print("1..0 # SKIP no plugins are kept for %s\n", about.machine);
    return 0;
  }
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_test_add_func("/compat/step", test_step);
  g_test_add_func("/compat/results", test_results);
  g_test_add_func("/compat/correction", test_correction);
  g_test_add_func("/compat/command", test_command);
  g_test_add_func("/compat/newer", test_newer);
  int failed = g_test_run();
  opc_remove_tree(folder);
  return failed;
}
