/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests `opcflow lint`, which must detect the faults of test plugins and must
   find no fault in the shipped plugins. */
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
     "extract fails or returns different bits while other threads call the "
     "function, "
     "although declared [any]"},
    {"bad.synthesizer_restless", "update is not done after 500 iterations"},
    {"bad.regulator_place",
     "violations: 'space' at (-5000, 40) nm is not in the layout"},
    {"bad.regulator_ends",
     "rule: moves the line end of transistor 1 by 16777216"},
    {"bad.regulator_vetoes", "rule: writes beyond the array of vetoes"},
    {"bad.regulator_smooth", "smooth: writes beyond the array of vetoes"},
};

/* Return the expected finding of a plugin of `bad`; NULL for other plugins. */
static const char *bad_finding(const char *id) {
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++)
    if (!strcmp(id, bad[i].id)) return bad[i].finding;
  return NULL;
}

/* Return FALSE for plugins without a fault, for plugins that are only slow, and
   for endless loops, which another test runs. */
static gboolean is_bad(const char *file) {
  static const char *const others[] = {"*_none.so", "*_loop.so", "*_slow.so"};
  for (size_t i = 0; i < G_N_ELEMENTS(others); i++)
    if (g_pattern_match_simple(others[i], file)) return FALSE;
  return g_pattern_match_simple("bad.*_*.so", file) ||
         (g_pattern_match_simple("bad.*.so", file) &&
          !g_strv_contains(
              (const char *const[]){"bad.none.so", "bad.hang.so",
                                    "bad.litho.so", "bad.resist.so",
                                    "bad.extractor.so", "bad.synthesizer.so",
                                    "bad.regulator.so", "bad.step.so", NULL},
              file));
}

/* Lint finds a fault in every faulty plugin, and the expected fault in those of
   `bad`. */
static void test_all(void) {
  g_autofree char *folder =
      g_build_filename(g_getenv("OPCFLOW_BUILD"), "tests", NULL);
  g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
  size_t count = 0, found = 0;
  for (const char *file; (file = g_dir_read_name(dir));) {
    if (!is_bad(file)) continue;
    g_autofree char *id = g_strndup(file, strlen(file) - strlen(".so"));
    if (plugin_lint("tests", id, NULL) != 1) g_error("%s passes: %s", id, err);
    g_assert_cmpstr(out, !=, "");
    const char *finding = bad_finding(id);
    if (finding && !strstr(out, finding)) g_assert_cmpstr(out, ==, finding);
    found += finding != NULL;
    count++;
  }
  g_assert_cmpuint(count, >, 60);
  g_assert_cmpuint(found, ==, G_N_ELEMENTS(bad));
}

/* Lint finds faults that end a run: writes beyond arrays and texts, and changes
   of the process (evil.h). The finding names the function with the fault. */
static void test_evil(void) {
  static const struct {
    const char *id, *when, *how, *finding;
  } faults[] = {
      {"bad.synthesizer", "", "overrun",
       "update: writes beyond the array of jogs"},
      {"bad.synthesizer", "", "underrun",
       "update: writes before the array of moves of L"},
      {"bad.synthesizer", "", "assists",
       "update: writes beyond the array of assists"},
      {"bad.synthesizer", "", "endless",
       "verdict: a verdict is not a text of at most 200 bytes"},
      {"bad.resist", "", "overrun",
       "print: writes beyond the array of level sets"},
      {"bad.extractor", "", "overrun",
       "extract: writes beyond the array of figures"},
      {"bad.regulator", "", "underrun",
       "rule: writes before the array of line ends"},
      {"bad.regulator", "", "overrun violations",
       "violations: writes beyond the array of violations"},
      {"bad.synthesizer", "update", "chdir",
       "changed the working folder: work\n"},
      {"bad.synthesizer", "begin", "umask",
       "changed the modes of new files: work\n"},
      {"bad.synthesizer", "verdict", "timer", "left an alarm set: work\n"},
      {"bad.extractor", "extract", "locale", "changed the locale: work\n"},
      {"bad.resist", "prepare", "deaf",
       "changed the handler of SIGTERM: work\n"},
      {"bad.litho", "band", "rounding",
       "changed the floating-point rounding, flush-to-zero or trap mode: "
       "work\n"},
      {"bad.regulator", "rule", "stdout",
       "closed or redirected standard output: work\n"},
      {"bad.regulator", "violations", "exit", "ends the process: work\n"},
      {"bad.synthesizer", "update", "pthread_exit", "ended the thread: work\n"},
      {"bad.step", "check", "chdir", "changed the working folder: check\n"},
      {"bad.step", "forecast", "chdir", "changed the working folder: work\n"},
      {"bad.step", "release", "chdir", "changed the working folder: work\n"},
      {"bad.none", "load", "block", "changed the signal mask: loading\n"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(faults); i++) {
    g_setenv("BAD_WHEN", faults[i].when, TRUE);
    g_setenv("BAD_HOW", faults[i].how, TRUE);
    int code = plugin_lint("tests", faults[i].id, NULL);
    if (code != 1 || !strstr(out, faults[i].finding))
      g_error("%s in %s of %s: exit code %d, '%s' is not in:\n%s%s",
              faults[i].how, faults[i].when, faults[i].id, code,
              faults[i].finding, out, err);
  }
  g_unsetenv("BAD_WHEN");
  g_unsetenv("BAD_HOW");
}

static void test_untidy(void) {
  g_assert_cmpint(plugin_lint("tests", "test.untidy", NULL), ==, 1);
  static const char *const findings[] = {
      "exports 'untidy_helper'; only opcflow_plugin may be exported\n",
      "the summary of size is not one line without a full stop\n",
      "'min' of shift has no effect without OPC_AT_LEAST or OPC_ABOVE\n",
      "'max' of shift has no effect without OPC_AT_MOST or OPC_BELOW\n",
      "check fails without a message for size\n",
      "returns different bits the second time, for the same input\n",
      "returns different bits on several threads than on one\n",
  };
  for (size_t i = 0; i < G_N_ELEMENTS(findings); i++)
    if (!strstr(out, findings[i])) g_assert_cmpstr(out, ==, findings[i]);
#ifndef __SANITIZE_ADDRESS__ /* AddressSanitizer does not measure memory */
  const char *leak = strstr(out, "leaks 10");
  g_assert_nonnull(leak);
  g_assert_nonnull(
      strstr(leak, " bytes each time an instance is created and freed\n"));
#endif
}

/* The last line for a plugin without a fault, and the exit code with --strict.
   The test runs a plugin with tests, a plugin that is not reentrant, and a
   plugin whose kind has no tests. */
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

/* Parameters for short simulations; NULL for the default parameters. */
static const char few_points[] = "{ points_across: 8 }";
static const char few_doses[] = "{ dose: [0 %, 2 %], defocus: [0 nm] }";

static const struct {
  const char *folder, *id, *message;
  int code;
  const char *with;
} good[] = {
    {"plugins", "synthesizer.dpb", tried, 0, NULL},
    {"plugins", "synthesizer.newton", tried, 0, NULL},
    {"plugins", "regulator.drc", tried, 0, NULL},
    {"plugins", "resist.threshold", tried, 0, NULL},
    {"plugins", "resist.vtr", tried, 0, NULL},
    {"plugins", "litho.abbe", tried, 0, few_points},
    {"plugins", "extractor.plain", tried, 0, NULL},
    {"plugins", "extractor.gamma", tried, 0, NULL},
    {"plugins", "read.gds", tried, 0, NULL},
    {"plugins", "read.oasis", tried, 0, NULL},
    {"plugins", "read.cif", tried, 0, NULL},
    {"plugins", "write.cif", tried, 0, NULL},
    {"plugins", "netlist.match", tried, 0, NULL},
    {"plugins", "draw.mask", tried, 0, NULL},
    {"plugins", "segment.transistors", tried, 0, NULL},
    {"plugins", "process.window", tried, 0, few_doses},
    {"tests", "bad.litho_none", alone, 1, NULL},
    {"plugins", "kind.litho", untried, 1, NULL},
    {"tests", "command.echo", untried, 1, NULL},
};

static void test_good(void) {
  for (size_t i = 0; i < G_N_ELEMENTS(good); i++) {
    int code = plugin_lint(good[i].folder, good[i].id, good[i].with);
    g_test_message("%s", good[i].id);
    g_assert_cmpstr(out, ==, "");
    if (!g_pattern_match_simple(good[i].message, err))
      g_assert_cmpstr(err, ==, good[i].message);
    g_assert_cmpint(code, ==, good[i].code);
  }
}

/* Required inputs can be given. Skipped tests are reported, and are a failure
   with --strict. */
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
  /* The child holds one end of the pipe; the pipe closes when the child
     ends. */
  struct pollfd end = {output, POLLIN, 0};
  char byte;
  g_assert_cmpint(poll(&end, 1, 5000), ==, 1);
  g_assert_cmpint(read(output, &byte, 1), ==, 0);
  close(output);
  g_unsetenv("TMPDIR");
  g_assert_cmpint(g_rmdir(folder), ==, 0);
}

/* Endless loops, and a slow plugin that can be cancelled and has no fault.
   Other tests run at the same time. */
static struct {
  const char *id, *out, *err;
  int code;
  GSubprocess *process;
} endless[] = {
    {"bad.step_slow", "",
     "note: checked: exports, loading, check, creating and freeing; not "
     "checked: run: stopped after 10 s, see --with\n",
     0, NULL},
    {"bad.hang", "no sign of life for 15 s: loading\n", "", 1, NULL},
    {"bad.synthesizer_loop", "no sign of life for 15 s: work\n", "", 1, NULL},
};

static void start_endless(void) {
  const char *build = g_getenv("OPCFLOW_BUILD");
  g_autofree char *command = g_build_filename(build, "opcflow", NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(endless); i++) {
    g_autofree char *file = g_strconcat(endless[i].id, ".so", NULL);
    g_autofree char *path = g_build_filename(build, "tests", file, NULL);
    endless[i].process = g_subprocess_new(
        G_SUBPROCESS_FLAGS_STDERR_PIPE | G_SUBPROCESS_FLAGS_STDOUT_PIPE, NULL,
        command, "lint", path, NULL);
    g_assert_nonnull(endless[i].process);
  }
}

static void test_endless(void) {
  for (size_t i = 0; i < G_N_ELEMENTS(endless); i++) {
    g_autofree char *found = NULL, *message = NULL;
    GSubprocess *process = endless[i].process;
    g_subprocess_communicate_utf8(process, NULL, NULL, &found, &message, NULL);
    g_assert_cmpint(g_subprocess_get_exit_status(process), ==, endless[i].code);
    if (!g_str_has_suffix(found, endless[i].out))
      g_assert_cmpstr(found, ==, endless[i].out);
    if (*endless[i].err) g_assert_cmpstr(message, ==, endless[i].err);
    g_object_unref(process);
  }
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
  start_endless();
  g_test_add_func("/lint/evil", test_evil);
  g_test_add_func("/lint/all", test_all);
  g_test_add_func("/lint/untidy", test_untidy);
  g_test_add_func("/lint/good", test_good);
  g_test_add_func("/lint/with", test_with);
  g_test_add_func("/lint/killed", test_killed);
  g_test_add_func("/lint/without-nm", test_without_nm);
  g_test_add_func("/lint/endless", test_endless);
  int failed = g_test_run();
  g_free(out);
  g_free(err);
  return failed;
}
