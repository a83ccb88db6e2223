/* SPDX-License-Identifier: BSD-3-Clause */
/* Messages and kept files if a plugin fails during a run of a flow.
   tests/badplugins has one plugin for each fault. */
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <opcflow/plugin.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>

#include "tests/command.h"

/* ---- help ---- */

static gboolean has_text(const char *name, const char *text) {
  g_autofree char *content = NULL;
  g_assert_true(g_file_get_contents(name, &content, NULL, NULL));
  return strstr(content, text) != NULL;
}

/* Check the message; '*' in `want` matches any text. */
static void expect_error(const char *want) {
  if (!g_pattern_match_simple(want, err)) g_assert_cmpstr(err, ==, want);
}

/* ---- the correction loop ---- */

static const char *const slots[] = {"litho", "resist", "extractor",
                                    "synthesizer", "regulator"};

/* Write a correction flow in which the plugin bad.KIND_FAULT is faulty. */
static void write_correction(const char *bad) {
  char *used[G_N_ELEMENTS(slots)];
  for (size_t i = 0; i < G_N_ELEMENTS(slots); i++)
    used[i] = g_str_has_prefix(bad, slots[i])
                  ? g_strdup(bad)
                  : g_strdup_printf("%s_none", slots[i]);
  g_autofree char *text = g_strdup_printf(
      "opcflow: 1\n"
      "steps:\n"
      "  layout:\n"
      "    { use: read.cif, file: %s/data/cells65/nand2.cif,\n"
      "      layers: { poly: CP, active: CA, contact: CC, nwell: CW } }\n"
      "  gates: { use: segment.transistors, layout: ${layout}, grid: 1 nm }\n"
      "  kept: { use: test.numbers, size: 1 nm }\n"
      "  mask:\n"
      "    use: correct\n"
      "    gates: ${gates}\n"
      "    litho: { use: bad.%s }\n"
      "    resist: { use: bad.%s }\n"
      "    extractor: { use: bad.%s }\n"
      "    synthesizer: { use: bad.%s }\n"
      "    regulator: { use: bad.%s }\n"
      "    margin: 3 um\n"
      "    min_space: 40 nm\n"
      "    min_mask_width: 40 nm\n"
      "    min_edge: 20 nm\n"
      "  after: { use: test.numbers, size: 1 nm, add: ${kept} }\n",
      g_getenv("OPCFLOW_SOURCE"), used[0], used[1], used[2], used[3], used[4]);
  write_text("bad.yaml", text);
  for (size_t i = 0; i < G_N_ELEMENTS(slots); i++) g_free(used[i]);
}

/* Places of the slots in the flow. */
static const struct {
  const char *kind, *place;
} places[] = {{"litho", "11:12"},
              {"resist", "12:13"},
              {"extractor", "13:16"},
              {"synthesizer", "14:18"},
              {"regulator", "15:16"}};

static const struct {
  const char *plugin, *message;
} failures[] = {
    {"litho_silent", "no error message"},
    {"litho_code", "no error message"},
    {"litho_cancel", "no error message"},
    {"litho_band", "the band is nan 1/nm"},
    {"litho_nan", "intensity is not a number at (*) nm"},
    {"litho_infinite", "intensity is infinite at (*) nm"},
    {"litho_shape", "intensity is a field of 0 x * without values"},
    {"litho_empty", "intensity is a field of 0 x 0 without values"},
    {"litho_frame",
     "intensity has the frame (*) * x * nm, but the mask has (*) * x * nm"},
    {"resist_silent", "no error message"},
    {"resist_nan", "level set is not a number at (*) nm"},
    {"extractor_silent", "no error message"},
    {"extractor_nan", "ioff of transistor 'nand2:2' is nan"},
    {"extractor_negative", "ion of transistor 'nand2:1' is -1"},
    {"extractor_slices", "divides a gate into 0 slices, expected 1 to 65536"},
    {"extractor_order",
     "slice 2 is at 0.25 of the width, not within 0.75 to 1"},
    {"extractor_sum",
     "the widths of the slices sum to 0.9 of the width of the gate, expected "
     "1"},
    {"synthesizer_silent", "no error message"},
    {"synthesizer_moves",
     "moves the width of transistor 2 by -2147483648 steps, expected at most "
     "1048576"},
    {"regulator_silent", "no error message"},
    {"regulator_ends",
     "moves the line end of transistor 1 by 16777216 steps, expected at most "
     "1048576"},
    {"regulator_vetoes", "the veto 0x40 of transistor 3 is unknown"},
    {"regulator_count", "violation 1 has no rule"},
    {"regulator_gate",
     "violation 1 names transistor 100, but the layout has 4"},
};

/* Check that the files of finished steps are kept, and that the reports contain
   the reason of the failure. */
static void expect_kept(const char *reason) {
  g_assert_true(is_there("x.failed/numbers.csv"));
  g_assert_true(is_there("x.failed/flow.yaml"));
  g_assert_true(is_there("x.failed/metrics.json"));
  g_assert_true(has_text("x.failed/manifest.json", "\"result\" : \"failed\""));
  g_assert_true(has_text("x.failed/manifest.json", reason));
  g_assert_false(is_there("x.failed/after.numbers.csv"));
  g_assert_false(is_there("x"));
  g_assert_false(is_there(".x.opcflow-1"));
  g_assert_true(opc_remove_tree("x.failed"));
}

static void test_failures(void) {
  for (size_t i = 0; i < G_N_ELEMENTS(failures); i++) {
    const char *plugin = failures[i].plugin;
    size_t k = 0;
    while (!g_str_has_prefix(plugin, places[k].kind)) k++;
    write_correction(plugin);
    g_test_message("%s", plugin);
    g_assert_cmpint(opcflow_call("run bad.yaml --output x"), ==, 4);
    g_autofree char *want = g_strdup_printf(
        "bad.yaml:%s: step 'mask' (correct), %s (bad.%s): %s\n"
        "note: files "
        "written so far are in 'x.failed'\n",
        places[k].place, places[k].kind, plugin, failures[i].message);
    expect_error(want);
    expect_kept("\"failure\"");
  }
}

/* The command exits with the code returned by the plugin. */
static void test_code(void) {
  write_correction("synthesizer_begin");
  g_assert_cmpint(opcflow_call("run bad.yaml --output x"), ==, 2);
  expect_error(
      "bad.yaml:14:18: step 'mask' (correct), synthesizer "
      "(bad.synthesizer_begin): no error message\n*");
  expect_kept("no error message");
}

/* A plugin without a fault causes no message. */
static void test_good(void) {
  write_correction("none");
  g_assert_cmpint(opcflow_call("run bad.yaml --output good"), ==, 0);
  g_assert_cmpstr(err, ==, "");
  g_assert_true(is_there("good/gates.csv"));
}

/* ---- crashes ---- */

static const struct {
  const char *plugin, *what;
} crashes[] = {
    {"litho_segv", "segmentation fault"},
    {"litho_thread", "segmentation fault"},
    {"litho_stack", "segmentation fault"},
    {"litho_bus", "bus error"},
    {"litho_fpe", "arithmetic error"},
    {"litho_ill", "illegal instruction"},
    {"litho_abort", "aborted"},
    {"extractor_segv", "segmentation fault"},
    {"synthesizer_verdict", "segmentation fault"},
};

static void test_crashes(void) {
  for (size_t i = 0; i < G_N_ELEMENTS(crashes); i++) {
    write_correction(crashes[i].plugin);
    g_test_message("%s", crashes[i].plugin);
    g_assert_cmpint(opcflow_call("run bad.yaml --output x --threads 3"), ==, 4);
    g_autofree char *want = g_strdup_printf(
        "bad.yaml:8:3: step 'mask' (correct): crashed in plugin 'bad.%s': "
        "%s\n",
        crashes[i].plugin, crashes[i].what);
    /* Lines of steps that took more than a second may precede the message. A
       note of plugins called before may follow. */
    if (!strstr(err, want)) g_assert_cmpstr(err, ==, want);
    g_assert_true(g_str_has_suffix(
        err, "note: files written so far are in 'x.failed'\n"));
    expect_kept("the process ended while step 'mask' ran");
  }
}

/* The folder of an earlier failed run stays unchanged. */
static void test_numbered(void) {
  g_assert_cmpint(g_mkdir("x.failed", 0777), ==, 0);
  g_assert_cmpint(g_mkdir("x.failed-2", 0777), ==, 0);
  write_correction("litho_segv");
  g_assert_cmpint(opcflow_call("run bad.yaml --output x"), ==, 4);
  expect_error("*\nnote: files written so far are in 'x.failed-3'\n");
  g_assert_true(is_there("x.failed-3/numbers.csv"));
  g_assert_cmpint(g_rmdir("x.failed"), ==, 0);
  g_assert_cmpint(g_rmdir("x.failed-2"), ==, 0);
  g_assert_true(opc_remove_tree("x.failed-3"));
}

/* ---- endless loops ---- */

/* Check that the process ignores the first signal and ends at the second. The
   signals are different, because two equal pending signals would be delivered
   only once. */
static void expect_end(GSubprocess *process, int first, int second,
                       const char *want) {
  g_autofree char *rest = NULL;
  GError *fault = NULL;
  g_subprocess_send_signal(process, first);
  g_usleep(50000);
  g_assert_nonnull(g_subprocess_get_identifier(process));
  g_subprocess_send_signal(process, second);
  g_subprocess_communicate_utf8(process, NULL, NULL, NULL, &rest, &fault);
  g_assert_no_error(fault);
  g_assert_true(g_subprocess_get_if_exited(process));
  g_assert_cmpint(g_subprocess_get_exit_status(process), ==, 130);
  g_assert_cmpstr(rest, ==, want);
  g_object_unref(process);
}

static void test_loops(void) {
  write_correction("synthesizer_loop");
  expect_end(start_loop("bad.yaml"), SIGINT, SIGTERM,
             "bad.yaml:8:3: step 'mask' (correct): stopped in plugin "
             "'bad.synthesizer_loop'\n"
             "note: files written so far are in 'x.failed'\n");
  expect_kept("the process ended while step 'mask' ran");
  /* A run that wrote no file leaves no folder. */
  write_text("loop.yaml", "opcflow: 1\nsteps:\n  a: { use: bad.step_loop }\n");
  expect_end(start_loop("loop.yaml"), SIGTERM, SIGINT,
             "loop.yaml:3:3: step 'a' (bad.step_loop): stopped in plugin "
             "'bad.step_loop'\n");
  g_assert_false(is_there("x.failed"));
}

/* ---- steps ---- */

/* Call a verb on a flow of one step. The step writes no file, so no folder must
   remain. */
static int call_step(const char *verb, const char *fault) {
  g_autofree char *text =
      g_strdup_printf("opcflow: 1\nsteps:\n  a: { use: bad.step_%s }\n", fault);
  write_text("step.yaml", text);
  g_autofree char *line = g_strdup_printf("%s step.yaml", verb);
  int code = opcflow_call(line);
  g_assert_false(is_there("runs/step"));
  g_assert_false(is_there("runs/step.failed"));
  return code;
}

static void test_steps(void) {
  g_assert_cmpint(call_step("run", "segv"), ==, 4);
  g_assert_cmpstr(err, ==,
                  "step.yaml:3:3: step 'a' (bad.step_segv): crashed in plugin "
                  "'bad.step_segv': segmentation fault\n");
  g_assert_cmpint(call_step("run", "silent"), ==, 4);
  g_assert_cmpstr(
      err, ==, "step.yaml:3:3: step 'a' (bad.step_silent): no error message\n");
  g_assert_cmpint(call_step("run", "code"), ==, 4); /* the step returns 42 */
  g_assert_cmpint(call_step("run", "output"), ==, 4);
  g_assert_cmpstr(err, ==,
                  "step.yaml:3:3: step 'a' (bad.step_output): returned no "
                  "output 'gates'\n");
  g_assert_cmpint(call_step("run", "grid"), ==, 4);
  g_assert_cmpstr(
      err, ==,
      "step.yaml:3:3: step 'a' (bad.step_grid): output 'gates': the grid of "
      "the gates is 0 nm, expected a positive finite number\n");
  g_assert_cmpint(call_step("run", "arrays"), ==, 4);
  g_assert_cmpstr(err, ==,
                  "step.yaml:3:3: step 'a' (bad.step_arrays): output 'gates': "
                  "an array of the gates is missing\n");
  g_assert_cmpint(call_step("run", "release"), ==, 4);
  g_assert_cmpstr(err, ==,
                  "error: crashed in plugin 'bad.step_release': segmentation "
                  "fault\n");
  const char *const verbs[] = {"run", "check"};
  for (size_t i = 0; i < 2; i++) {
    g_assert_cmpint(call_step(verbs[i], "check"), ==, 4);
    g_assert_cmpstr(err, ==,
                    "step.yaml:3:3: step 'a' (bad.step_check): crashed in "
                    "plugin 'bad.step_check': segmentation fault\n");
    g_assert_cmpint(call_step(verbs[i], "refuse"), ==, 4);
    g_assert_cmpstr(
        err, ==,
        "step.yaml:3:3: step 'a' (bad.step_refuse): no error message\n");
  }
}

/* A crash in `clear` occurs after the run folder is complete. */
static void test_clear(void) {
  write_text("clear.yaml",
             "opcflow: 1\nsteps:\n  a: { use: bad.step_clear }\n");
  g_assert_cmpint(opcflow_call("run clear.yaml --output cleared"), ==, 4);
  g_assert_cmpstr(err, ==,
                  "error: crashed in plugin 'bad.step_clear': segmentation "
                  "fault\n");
  g_assert_true(is_there("cleared/flow.yaml"));
}

/* A plugin that crashes while it is loaded. */
static void test_loading(void) {
  write_text("load.yaml", "opcflow: 1\nsteps:\n  a: { use: bad.crash }\n");
  g_assert_cmpint(opcflow_call("run load.yaml"), ==, 3);
  expect_error(
      "error: 'bad.crash': cannot use '*/tests/bad.crash.so': crashed "
      "in plugin 'bad.crash': aborted\n");
  g_assert_cmpint(opcflow_call("inspect bad.crash"), ==, 3);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  set_up(TRUE);
  g_test_add_func("/contract/failures", test_failures);
  g_test_add_func("/contract/code", test_code);
  g_test_add_func("/contract/good", test_good);
  g_test_add_func("/contract/crashes", test_crashes);
  g_test_add_func("/contract/numbered", test_numbered);
  g_test_add_func("/contract/loops", test_loops);
  g_test_add_func("/contract/steps", test_steps);
  g_test_add_func("/contract/clear", test_clear);
  g_test_add_func("/contract/loading", test_loading);
  return run_all();
}
