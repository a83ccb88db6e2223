/* SPDX-License-Identifier: BSD-3-Clause */
/* Run folders: replacement by --force, folders left by killed runs, folders of
   active runs, and files that cannot be written. */
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/command.h"

/* ---- help ---- */

/* Run a shell script in which $O is opcflow; return the exit code. */
static int sh(const char *script) {
  return program_spawn((const char *const[]){"/bin/sh", "-c", script, NULL});
}

/* Check the names in a folder, including hidden names, separated by spaces. */
static void expect_names(const char *name, const char *want) {
  g_autofree char *script = g_strdup_printf("ls -A %s | xargs echo", name);
  g_assert_cmpint(sh(script), ==, 0);
  g_assert_cmpstr(g_strchomp(out), ==, want);
}

static void set_up_runs(void) {
  set_up(FALSE);
  g_setenv("O", command, TRUE);
  write_text("in.txt", "some input\n");
  write_text(
      "two.yaml",
      "opcflow: 1\nname: two\nsteps:\n"
      "  a: { use: test.numbers, size: 65 nm, output: deep/er/out.txt }\n"
      "  b: { use: test.numbers, size: 2 nm, add: ${a} }\n");
}

/* ---- --force ---- */

static void assert_refused(const char *change, const char *want) {
  g_assert_cmpint(sh(change), ==, 0);
  g_assert_cmpint(sh("$O run two.yaml --output f/x --force"), ==, 5);
  g_assert_cmpstr(err, ==, want);
}

static void test_force(void) {
  g_assert_cmpint(sh("$O run two.yaml --output f/x --set b.whole=7"), ==, 0);
  assert_refused("mkdir f/x/src && echo 'int x;' >f/x/src/x.c && touch f/x/zzz",
                 "error: 'f/x' is not replaced, because the folder has the "
                 "file 'src/x.c', which the run did not write\n");
  assert_refused("rm f/x/zzz f/x/src/x.c",
                 "error: 'f/x' is not replaced, because the folder has the "
                 "folder 'src', which the run did not write\n");
  assert_refused(
      "rmdir f/x/src && mv f/x/numbers.csv f/ && "
      "ln -s ../numbers.csv f/x/numbers.csv",
      "error: 'f/x' is not replaced, because the folder has the symbolic link "
      "'numbers.csv', which the run did not write\n");
  assert_refused(
      "mv f/numbers.csv f/x/numbers.csv && echo '# mine' >>f/x/flow.yaml",
      "error: 'f/x' is not replaced, because the file 'flow.yaml' has changed "
      "since the run\n");
  assert_refused(
      "cp f/x/manifest.json f/keep && sed -i '/\"files\"/,/]/d' "
      "f/x/manifest.json",
      "error: 'f/x' is not replaced, because manifest.json does not list the "
      "files of a run\n");
  assert_refused("rm f/x/manifest.json f/x/flow.yaml",
                 "error: 'f/x' is not replaced, because the folder has no "
                 "readable manifest.json of a run\n");
  g_assert_true(is_there("f/x/deep/er/out.txt"));
  expect_names("f", "keep x");
  /* A run folder with a missing file still counts as a run folder. */
  g_assert_cmpint(sh("mv f/keep f/x/manifest.json; $O run two.yaml --output "
                     "f/x --force"),
                  ==, 0);
  expect_names("f", "x");
  g_assert_cmpint(sh("grep -q 'whole: 7' f/x/flow.yaml"), ==, 1);
}

static void test_places(void) {
  g_assert_cmpint(sh("$O run two.yaml --output p/x"), ==, 0);
  g_assert_cmpint(sh("ln -s x p/link; $O run two.yaml --output p/link --force"),
                  ==, 5);
  g_assert_cmpstr(err, ==,
                  "error: 'p/link' is not replaced, because the name is a "
                  "symbolic link to 'x'\n");
  g_assert_cmpint(sh("touch p/file; $O run two.yaml --output p/file --force"),
                  ==, 5);
  g_assert_cmpstr(err, ==, "error: 'p/file' is a file, expected a folder\n");
  static const char *const nameless[] = {"''", ".", "..", "/", "p/.", "p/x/.."};
  for (guint i = 0; i < G_N_ELEMENTS(nameless); i++) {
    g_autofree char *line =
        g_strdup_printf("$O run two.yaml --force --output %s", nameless[i]);
    g_assert_cmpint(sh(line), ==, 2);
    g_assert_nonnull(strstr(err, "' does not end in the name"));
  }
  expect_names("p", "file link x");
  g_assert_cmpint(sh("$O run two.yaml --force"), ==, 2);
  g_assert_cmpstr(
      err, ==,
      "error: '--force' requires '--output', the run folder to replace\n");
  g_assert_cmpint(sh("$O run two.yaml --output p/file/x"), ==, 5);
  g_assert_cmpstr(err, ==,
                  "error: 'p/file' cannot be created: Not a directory\n");
  g_assert_cmpint(sh("$O run two.yaml --output /proc/x"), ==, 5);
  g_assert_true(
      g_str_has_prefix(err, "error: '/proc/x' cannot be created in '/proc': "));
  /* A path through a symbolic link is accepted. */
  g_assert_cmpint(sh("ln -s p q; $O run two.yaml --output q/x --force"), ==, 0);
  expect_names("p", "file link x");
}

/* ---- active runs ---- */

/* Start a run whose second step waits without end. */
static GSubprocess *run_start(const char *target) {
  const char *argv[] = {command,         "run",     "two.yaml",
                        "--output",      target,    "--set",
                        "b.behave=wait", "--force", NULL};
  g_autofree char *script = g_strdup_printf(
      "for i in $(seq 1000); do ls $(dirname "
      "%s)/.*.opcflow-1/run/manifest.json "
      ">/dev/null 2>&1 && exit; sleep 0.01; done; exit 1",
      target);
  GSubprocess *process = g_subprocess_newv(
      argv,
      G_SUBPROCESS_FLAGS_STDOUT_SILENCE | G_SUBPROCESS_FLAGS_STDERR_SILENCE,
      NULL);
  g_assert_nonnull(process);
  g_assert_cmpint(sh(script), ==, 0);
  return process;
}

static int run_end(GSubprocess *process, int number) {
  g_subprocess_send_signal(process, number);
  g_assert_true(g_subprocess_wait(process, NULL, NULL));
  int code = g_subprocess_get_if_exited(process)
                 ? g_subprocess_get_exit_status(process)
                 : -1;
  g_object_unref(process);
  return code;
}

static void test_busy(void) {
  g_assert_cmpint(sh("$O run two.yaml --output b/x"), ==, 0);
  GSubprocess *first = run_start("b/x");
  g_assert_cmpint(sh("$O run two.yaml --output b/x --force"), ==, 5);
  g_assert_cmpstr(err, ==,
                  "error: 'b/x': another run is writing this folder, in "
                  "'b/.x.opcflow-1'\n");
  g_assert_true(is_there("b/.x.opcflow-1/run/numbers.csv"));
  /* A killed run leaves its files; the next run removes them. */
  g_assert_cmpint(run_end(first, SIGKILL), ==, -1);
  expect_names("b", ".x.opcflow-1 x");
  g_assert_cmpint(sh("$O run two.yaml --output b/x --force"), ==, 0);
  expect_names("b", "x");
}

/* Without --output, several runs of a flow may be active, because names are
   numbered. */
static void test_together(void) {
  g_assert_cmpint(sh("mkdir t; cd t; cp ../two.yaml .; "
                     "for i in 1 2 3 4; do $O run two.yaml --quiet & done; "
                     "wait; ls -A runs | xargs echo; for i in runs/*; do "
                     "test -f $i/manifest.json || exit 1; done"),
                  ==, 0);
  g_assert_cmpstr(out, ==, "two two-2 two-3 two-4\n");
}

static void test_hangup(void) {
  g_assert_cmpint(run_end(run_start("h/x"), SIGHUP), ==, 130);
  g_assert_cmpint(run_end(run_start("h/x"), SIGTERM), ==, 130);
  expect_names("h", "");
  /* A run that ignores SIGHUP, as under nohup. */
  g_assert_cmpint(
      sh("trap '' HUP; $O run two.yaml --output h/y --set b.behave=wait & "
         "until ls h/.y.*/run/manifest.json >/dev/null 2>&1; do sleep 0.01; "
         "done; kill -HUP $!; sleep 0.2; kill -0 $! || exit 1; kill -TERM $!; "
         "wait "
         "$!"),
      ==, 130);
  expect_names("h", "");
}

/* ---- files that cannot be written ---- */

/* A file that was not written completely does not appear under its name. */
static void test_full(void) {
  g_assert_cmpint(sh("ulimit -f 0; $O run two.yaml --output w/x"), ==, 5);
  g_assert_nonnull(strstr(err, "/deep/er/out.txt': "));
  expect_names("w", "x.failed");
  g_assert_cmpint(sh("find w -type f | grep ."), ==, 1);
  g_assert_cmpint(sh("rm -r w; ulimit -f 0; $O run two.yaml --output w/x --set "
                     "a.output=null"),
                  ==, 5);
  g_assert_nonnull(strstr(err, "/numbers.csv': File too large\n"));
  g_assert_cmpint(sh("find w -type f | grep ."), ==, 1);
  /* The earlier run is kept if the disk is full when the reports are
     written. */
  g_assert_cmpint(sh("rm -r w; $O run two.yaml --output w/x --set b.whole=7"),
                  ==, 0);
  g_assert_cmpint(sh("ulimit -f 1; $O run two.yaml --output w/x --force"), ==,
                  5);
  g_assert_nonnull(strstr(err, "/flow.yaml': File too large\n"));
  g_assert_cmpint(sh("grep -q 'whole: 7' w/x/flow.yaml"), ==, 0);
  expect_names("w", "x x.failed");
  g_assert_cmpint(sh("ulimit -f 0; $O echo --output written.txt one"), ==, 5);
  g_assert_cmpstr(
      err, ==,
      "echo: 1 words, second, 2 cases\n--output: 'written.txt': not written\n");
  g_assert_false(is_there("written.txt"));
}

/* ---- names of files ---- */

static void expect_fault(const char *steps, const char *want) {
  g_autofree char *text = g_strdup_printf("opcflow: 1\nsteps:\n%s", steps);
  write_text("names.yaml", text);
  g_assert_cmpint(sh("$O check names.yaml"), ==, 2);
  g_assert_cmpstr(err, ==, want);
  g_assert_cmpint(sh("$O run names.yaml --output names"), ==, 2);
  g_assert_false(is_there("names"));
}

static void test_names(void) {
  static const char *const own[] = {"manifest.json", "flow.yaml",
                                    "metrics.json", "sweep.csv"};
  for (size_t i = 0; i < G_N_ELEMENTS(own); i++) {
    g_autofree char *steps = g_strdup_printf(
        "  a: { use: test.numbers, size: 1 nm, output: %s }\n", own[i]);
    g_autofree char *want = g_strdup_printf(
        "names.yaml:3:47: step 'a' (test.numbers): 'output' is '%s', but the "
        "run writes '%s'\n",
        own[i], own[i]);
    expect_fault(steps, want);
  }
  expect_fault(
      "  a: { use: test.numbers, size: 1 nm, output: d/x }\n"
      "  b: { use: test.numbers, size: 1 nm, output: d/x }\n",
      "names.yaml:4:47: step 'b' (test.numbers): 'output' is 'd/x', "
      "but 'a' already writes 'd/x'\n");
  expect_fault(
      "  a: { use: test.numbers, size: 1 nm, output: d/x }\n"
      "  b: { use: test.numbers, size: 1 nm, output: d }\n",
      "names.yaml:4:47: step 'b' (test.numbers): 'output' is 'd', "
      "but 'a' already writes 'd/x'\n");
}

/* An output file of the same or a later step replaces a table of the same
   name. */
static void test_tables(void) {
  write_text("names.yaml",
             "opcflow: 1\nsteps:\n  a: { use: test.numbers, size: 1 nm }\n"
             "  b: { use: test.numbers, size: 1 nm, output: numbers.csv }\n");
  g_assert_cmpint(sh("$O run names.yaml --output n/x"), ==, 0);
  expect_names("n/x",
               "a.numbers.csv b.numbers.csv flow.yaml manifest.json "
               "metrics.json numbers.csv");
  g_assert_cmpint(sh("head -c 4 n/x/a.numbers.csv n/x/b.numbers.csv | grep -c "
                     "name"),
                  ==, 0);
  g_assert_cmpstr(out, ==, "2\n");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  set_up_runs();
  g_test_add_func("/folders/force", test_force);
  g_test_add_func("/folders/places", test_places);
  g_test_add_func("/folders/busy", test_busy);
  g_test_add_func("/folders/together", test_together);
  g_test_add_func("/folders/hangup", test_hangup);
  g_test_add_func("/folders/full", test_full);
  g_test_add_func("/folders/names", test_names);
  g_test_add_func("/folders/tables", test_tables);
  return run_all();
}
