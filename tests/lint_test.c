/* SPDX-License-Identifier: BSD-3-Clause */
/* `opcflow lint`: detects the faults of test plugins, and none in the shipped
   plugins. */
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static char *out, *err;

/* Lint a plugin of a folder of the build; return the exit code. */
static int plugin_lint(const char *folder, const char *id, const char *with) {
  const char *build = g_getenv("OPCFLOW_BUILD");
  g_autofree char *command = g_build_filename(build, "opcflow", NULL);
  g_autofree char *file = g_strconcat(id, ".so", NULL);
  g_autofree char *path = g_build_filename(build, folder, file, NULL);
  const char *argv[] = {
      command, "lint", "--strict", path, with ? "--with" : NULL, with, NULL};
  g_clear_pointer(&out, g_free);
  g_clear_pointer(&err, g_free);
  int status;
  g_assert_true(g_spawn_sync(NULL, (char **)argv, NULL, G_SPAWN_DEFAULT, NULL,
                             NULL, &out, &err, &status, NULL));
  g_assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

static const struct {
  const char *id, *finding;
} bad[] = {
    {"bad.crash", "crashes (Aborted): loading"},
    {"bad.exit", "ends the process: loading"},
    {"bad.major", "built for plugin interface 9.8, this is 0.8"},
    {"bad.step_check", "crashes (Segmentation fault): check"},
    {"bad.step_refuse", "check fails without a message"},
    {"bad.litho_segv", "crashes (Segmentation fault): work"},
    {"bad.litho_nan", "image: intensity is not a number at ("},
    {"bad.litho_frame", "image: intensity has the frame"},
    {"bad.litho_silent", "image failed without a message"},
    {"bad.litho_code", "image returned the unknown code 42"},
    {"bad.litho_band", "the band is nan 1/nm"},
    {"bad.resist_nan", "print: level set is not a number at ("},
    {"bad.extractor_sum",
     "slicing: the widths of the slices sum to 0.9 of the width"},
    {"bad.extractor_negative", "extract: ion of transistor 'sample:1' is -1"},
    {"bad.synthesizer_moves",
     "update: moves the width of transistor 2 by -2147483648"},
    {"bad.litho_dim",
     "image: the intensity of the clear field is 0.9, expected 1"},
    {"bad.litho_dark",
     "image: the intensity of the clear field is 0.9, expected 1"},
    {"bad.litho_fine", "image_fine: the intensity for the error 0.002 is"},
    {"bad.resist_sign", "print: a dark field must print, found no shape"},
    {"bad.extractor_milli",
     "extract: Ion of a gate of L 60, W 200 nm is 0.333333 A, expected 1e-08 "
     "to 0.01"},
    {"bad.extractor_narrow",
     "extract: a gate of twice the width has 1 times the Ion, expected about "
     "2"},
    {"bad.extractor_scratch",
     "extract returns different bits while other threads call the function, "
     "although declared [any]"},
    {"bad.synthesizer_restless", "update is not done after 500 iterations"},
    {"bad.regulator_place",
     "violations: 'space' at (-5000, 40) nm is not in the layout"},
    {"bad.regulator_ends",
     "rule: moves the line end of transistor 1 by 16777216"},
};

static void test_bad(void) {
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
    g_test_message("%s", bad[i].id);
    g_assert_cmpint(plugin_lint("tests", bad[i].id, NULL), ==, 1);
    if (!strstr(out, bad[i].finding)) g_assert_cmpstr(out, ==, bad[i].finding);
  }
}

static void test_untidy(void) {
  g_assert_cmpint(plugin_lint("tests", "test.untidy", NULL), ==, 1);
  static const char *const findings[] = {
      "exports 'untidy_helper'; only opcflow_plugin may be exported\n",
      "the summary of size is not one line without a full stop\n",
      "check fails without a message for size\n",
      "returns different bits the second time, for the same input\n",
      "returns different bits on several threads than on one\n",
  };
  for (size_t i = 0; i < G_N_ELEMENTS(findings); i++)
    if (!strstr(out, findings[i])) g_assert_cmpstr(out, ==, findings[i]);
#ifndef __SANITIZE_ADDRESS__ /* it does not measure memory */
  const char *leak = strstr(out, "leaks 10");
  g_assert_nonnull(leak);
  g_assert_nonnull(
      strstr(leak, " bytes each time an instance is created and freed\n"));
#endif
}

/* The last line for a plugin without a fault, and the exit code with --strict:
   for a tested plugin, for one that is not reentrant, and for one whose kind
   has no tests. */
#define WORK                                                                 \
  "note: checked: exports, loading, check, work, the same work again, work " \
  "on several threads, "
static const char tried[] =
    WORK "two instances at once, creating and freeing; not checked: nothing\n";
static const char alone[] = WORK
    "creating and freeing; not checked: two instances at once: "
    "the plugin is not OPC_REENTRANT\n";
static const char untried[] =
    "note: checked: exports, loading, check, creating and freeing; not "
    "checked: work: the kind '*' has no test of plugins\n";

static const struct {
  const char *folder, *id, *said;
  int code;
} good[] = {
    {"plugins", "synthesizer.dpb", tried, 0},
    {"plugins", "synthesizer.newton", tried, 0},
    {"plugins", "regulator.drc", tried, 0},
    {"plugins", "resist.threshold", tried, 0},
    {"plugins", "resist.vtr", tried, 0},
    {"plugins", "litho.abbe", tried, 0},
    {"plugins", "extractor.plain", tried, 0},
    {"plugins", "extractor.gamma", tried, 0},
    {"plugins", "read.gds", tried, 0},
    {"plugins", "read.oasis", tried, 0},
    {"plugins", "read.cif", tried, 0},
    {"plugins", "write.cif", tried, 0},
    {"plugins", "netlist.match", tried, 0},
    {"plugins", "draw.mask", tried, 0},
    {"plugins", "segment.transistors", tried, 0},
    {"plugins", "process.window", tried, 0},
    {"tests", "bad.litho_none", alone, 1},
    {"plugins", "kind.litho", untried, 1},
    {"tests", "command.tell", untried, 1},
};

static void test_good(void) {
  for (size_t i = 0; i < G_N_ELEMENTS(good); i++) {
    int code = plugin_lint(good[i].folder, good[i].id, NULL);
    g_test_message("%s", good[i].id);
    g_assert_cmpstr(out, ==, "");
    if (!g_pattern_match_simple(good[i].said, err))
      g_assert_cmpstr(err, ==, good[i].said);
    g_assert_cmpint(code, ==, good[i].code);
  }
}

/* Required inputs can be given; tests that could not be done are reported and
   fail with --strict. */
static void test_with(void) {
  g_assert_cmpint(
      plugin_lint("plugins", "extractor.plain", "{ devices: /proc/self/exe }"),
      ==, 1);
  g_assert_cmpstr(out, ==, "");
  g_assert_nonnull(
      strstr(err, "check, creating and freeing; not checked: prepare: "));
  g_autofree char *with = g_strdup_printf(
      "{ devices: %s/data/devices/ptm65.yaml }", g_getenv("OPCFLOW_SOURCE"));
  g_assert_cmpint(plugin_lint("plugins", "extractor.plain", with), ==, 0);
  g_assert_cmpstr(err, ==, tried);
  g_assert_cmpint(plugin_lint("plugins", "correct", "{ litho: {} }"), ==, 1);
  g_assert_nonnull(strstr(err, "not checked: check: "));
  g_assert_cmpint(plugin_lint("plugins", "litho.kernels", NULL), ==, 1);
  g_assert_nonnull(strstr(
      err, "work: requires a file 'focus' and no example file is accepted"));
  g_assert_cmpint(plugin_lint("plugins", "none", NULL), ==, 5);
}

/* A child process in an endless loop ends with its parent, however the parent
   ends. */
static void test_killed(void) {
  g_autofree char *folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_setenv("TMPDIR", folder, TRUE);
  const char *build = g_getenv("OPCFLOW_BUILD");
  g_autofree char *command = g_build_filename(build, "opcflow", NULL);
  g_autofree char *path = g_build_filename(build, "tests", "bad.hang.so", NULL);
  const char *argv[] = {command, "lint", path, NULL};
  GPid pid;
  int output;
  g_assert_true(g_spawn_async_with_pipes(NULL, (char **)argv, NULL,
                                         G_SPAWN_DO_NOT_REAP_CHILD, NULL, NULL,
                                         &pid, NULL, &output, NULL, NULL));
  g_usleep(G_USEC_PER_SEC);
  g_assert_cmpint(kill(pid, SIGKILL), ==, 0);
  g_assert_cmpint(waitpid(pid, NULL, 0), ==, pid);
  /* The child holds the other end of the pipe, which closes when the child
     ends. */
  struct pollfd end = {output, POLLIN, 0};
  char byte;
  g_assert_cmpint(poll(&end, 1, 5000), ==, 1);
  g_assert_cmpint(read(output, &byte, 1), ==, 0);
  close(output);
  g_unsetenv("TMPDIR");
  g_assert_cmpint(g_rmdir(folder), ==, 0);
}

/* A slow plugin is no fault if it can be cancelled. The other tests run
   meanwhile. */
static GSubprocess *slow;

static void start_slow(void) {
  const char *build = g_getenv("OPCFLOW_BUILD");
  g_autofree char *command = g_build_filename(build, "opcflow", NULL);
  g_autofree char *path =
      g_build_filename(build, "tests", "bad.step_slow.so", NULL);
  slow = g_subprocess_new(
      G_SUBPROCESS_FLAGS_STDERR_PIPE | G_SUBPROCESS_FLAGS_STDOUT_SILENCE, NULL,
      command, "lint", path, NULL);
  g_assert_nonnull(slow);
}

static void test_slow(void) {
  g_autofree char *said = NULL;
  g_subprocess_communicate_utf8(slow, NULL, NULL, NULL, &said, NULL);
  g_assert_cmpint(g_subprocess_get_exit_status(slow), ==, 0);
  g_assert_cmpstr(
      said, ==,
      "note: checked: exports, loading, check, creating and freeing; not "
      "checked: run: stopped after 15 s, see --with\n");
  g_object_unref(slow);
}

/* A missing nm is reported. */
static void test_without_nm(void) {
  g_autofree char *path = g_strdup(g_getenv("PATH"));
  g_setenv("PATH", "/nowhere", TRUE);
  g_assert_cmpint(plugin_lint("tests", "test.untidy", NULL), ==, 1);
  g_setenv("PATH", path, TRUE);
  g_assert_null(strstr(out, "exports"));
  g_assert_nonnull(
      strstr(err, "; not checked: exports: the program nm is missing"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  start_slow();
  g_test_add_func("/lint/bad", test_bad);
  g_test_add_func("/lint/untidy", test_untidy);
  g_test_add_func("/lint/good", test_good);
  g_test_add_func("/lint/with", test_with);
  g_test_add_func("/lint/killed", test_killed);
  g_test_add_func("/lint/without-nm", test_without_nm);
  g_test_add_func("/lint/slow", test_slow);
  int failed = g_test_run();
  g_free(out);
  g_free(err);
  return failed;
}
