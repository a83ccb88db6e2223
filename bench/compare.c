/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures flows/compare.yaml: seven methods on seven cells, with the report
   page. Further runs: the same run repeated, with one changed parameter of a
   method, on a circuit if available, and killed at random times. Reports
   wall-clock time and processor time, which does not depend on other load. */
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <store/files.h>
#include "bench/bench.h"

enum { KILLS = 20 };

static const char *const methods[] = {"epe",   "pb",       "dpb", "ic",
                                      "plain", "balanced", "full"};
static char *folder, *flow;

/* ---- commands ---- */

static GPid opcflow_start(const char *store, const char *output,
                          const char *set) {
  g_autofree char *place = g_build_filename(folder, store, NULL);
  const char *command = g_getenv("OPCFLOW_COMMAND");
  char *words[] = {(char *)(command ? command : "opcflow"),
                   "run",
                   flow,
                   "--quiet",
                   "--force",
                   "--output",
                   (char *)output,
                   set ? "--set" : NULL,
                   (char *)set,
                   NULL};
  g_auto(GStrv) around =
      g_environ_setenv(g_get_environ(), "OPCFLOW_STORE", place, TRUE);
  GPid pid;
  g_autoptr(GError) error = NULL;
  if (!g_spawn_async(folder, words, around,
                     G_SPAWN_DO_NOT_REAP_CHILD | G_SPAWN_SEARCH_PATH |
                         G_SPAWN_STDOUT_TO_DEV_NULL |
                         G_SPAWN_STDERR_TO_DEV_NULL,
                     NULL, NULL, &pid, &error))
    g_error("%s", error->message);
  return pid;
}

static double processor(void) {
  struct rusage used;
  getrusage(RUSAGE_CHILDREN, &used);
  return (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec) * 1e-6;
}

/* Run the experiment to the end; return the wall-clock time, s. */
static double opcflow_run(const char *store, const char *output,
                          const char *set) {
  gint64 before = g_get_monotonic_time();
  int status;
  GPid pid = opcflow_start(store, output, set);
  if (waitpid(pid, &status, 0) != pid || !WIFEXITED(status) ||
      WEXITSTATUS(status))
    g_error("%s: the run failed", output);
  return (double)(g_get_monotonic_time() - before) * 1e-6;
}

/* Measure a run and report both times. */
static double run_measure(const char *name, double reach, const char *store,
                          const char *output, const char *set) {
  g_autofree char *used = g_strconcat(name, "_processor", NULL);
  double before = processor();
  double seconds = opcflow_run(store, output, set);
  bench_report(name, seconds, "s", reach, BENCH_LOWER);
  bench_report(used, processor() - before, "s", INFINITY, BENCH_LOWER);
  return seconds;
}

/* ---- one parameter of one method ---- */

/* Return whether `opcflow explain` reports that a run computed a new mask. */
static int is_made(const char *path) {
  g_autofree char *text = NULL;
  const char *command = g_getenv("OPCFLOW_COMMAND");
  char *words[] = {(char *)(command ? command : "opcflow"), "explain",
                   (char *)path, NULL};
  if (!g_spawn_sync(folder, words, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL, &text,
                    NULL, NULL, NULL))
    return 0;
  const char *line = strstr(text, "\nmask ");
  return line && g_regex_match_simple("^\\nmask +ran ", line, 0, 0);
}

/* Count the newly computed masks of dpb, and those of all other methods. */
static void count_made(const char *output, double *dpb, double *others) {
  g_autofree char *all = g_build_filename(folder, output, "compare", NULL);
  g_autoptr(GDir) dir = g_dir_open(all, 0, NULL);
  *dpb = *others = 0;
  for (const char *name; dir && (name = g_dir_read_name(dir));)
    for (size_t m = 0; m < G_N_ELEMENTS(methods); m++) {
      g_autofree char *path = g_build_filename(all, name, methods[m], NULL);
      *(strcmp(methods[m], "dpb") ? others : dpb) += is_made(path);
    }
}

static void change_one(const char *source) {
  g_autofree char *from =
      g_build_filename(source, "flows", "methods.yaml", NULL);
  g_autofree char *to = g_build_filename(folder, "methods.yaml", NULL);
  g_autofree char *data = g_build_filename(source, "data/", NULL);
  g_autofree char *set = g_strconcat("compare.flow=", to, NULL);
  g_autofree char *text = NULL;
  if (!g_file_get_contents(from, &text, NULL, NULL)) g_error("%s", from);
  g_autoptr(GString) changed = g_string_new(text);
  g_string_replace(changed, "../data/", data, 0);
  if (g_string_replace(changed, "w_step: proportional", "w_step: unit", 0) != 1)
    g_error("%s: w_step of dpb is not where it was", from);
  g_file_set_contents(to, changed->str, -1, NULL);
  run_measure("cells.changed", INFINITY, "store", "cells", set);
  double dpb, others;
  count_made("cells", &dpb, &others);
  bench_report("cells.changed_made", dpb, "masks", 7, BENCH_HIGHER);
  bench_report("cells.changed_others", others, "masks", 0, BENCH_LOWER);
}

/* ---- killed runs ---- */

static char *contents(const char *output, const char *a, const char *b,
                      const char *c) {
  g_autofree char *path = g_build_filename(folder, output, a, b, c, NULL);
  char *text = NULL;
  if (!g_file_get_contents(path, &text, NULL, NULL)) g_error("%s", path);
  return text;
}

/* Return experiment.csv without the fifth column, the run times. */
static char *figures(const char *output) {
  g_autofree char *text = contents(output, "experiment.csv", NULL, NULL);
  g_auto(GStrv) lines = g_strsplit(text, "\r\n", -1);
  g_autoptr(GString) out = g_string_new(NULL);
  for (char **line = lines; *line; line++) {
    g_auto(GStrv) cells = g_strsplit(*line, ",", -1);
    for (guint i = 0; cells[i]; i++)
      if (i != 4) g_string_append_printf(out, "%s,", cells[i]);
    g_string_append_c(out, '\n');
  }
  return g_string_free(g_steal_pointer(&out), FALSE);
}

static int is_same(const char *one, const char *other) {
  static const char *const cells[] = {"inverter", "nand2"};
  g_autofree char *a = figures(one), *b = figures(other);
  int same = !strcmp(a, b);
  for (size_t c = 0; c < G_N_ELEMENTS(cells); c++)
    for (size_t m = 0; m < G_N_ELEMENTS(methods); m++) {
      g_autofree char *path =
          g_build_filename("compare", cells[c], methods[m], NULL);
      g_autofree char *x = contents(one, path, "verify.gates.csv", NULL);
      g_autofree char *y = contents(other, path, "verify.gates.csv", NULL);
      same &= !strcmp(x, y);
    }
  return same;
}

/* Kill a run twenty times. The total time of the killed runs is about that of
   one run. Then let the run finish. */
static void kill_often(const char *source) {
  g_autofree char *set = g_strdup_printf(
      "compare.cases=[{ layout: { use: read.cif, layers: { poly: CP, active: "
      "CA, nwell: CW } }, layout.file: [%s/data/cells65/inverter.cif, "
      "%s/data/cells65/nand2.cif] }]",
      source, source);
  double whole = opcflow_run("store-whole", "whole", set);
  g_autoptr(GRand) random = g_rand_new_with_seed(1);
  double killed = 0;
  for (int i = 0; i < KILLS; i++) {
    GPid pid = opcflow_start("store-killed", "killed", set);
    int status;
    g_usleep((gulong)(g_rand_double_range(random, 0, 2 * whole / KILLS) * 1e6));
    kill(pid, SIGKILL);
    waitpid(pid, &status, 0);
    killed += WIFSIGNALED(status);
  }
  run_measure("killed.rest", INFINITY, "store-killed", "killed", set);
  bench_report("killed.times", killed, "", KILLS, BENCH_HIGHER);
  bench_report("killed.same", is_same("whole", "killed"), "", 1, BENCH_HIGHER);
}

int main(void) {
  const char *source = g_getenv("OPCFLOW_SOURCE");
  const char *data = g_getenv("OPCFLOW_TEST_DATA");
  if (!source) source = ".";
  folder = g_dir_make_tmp("opcflow-bench-XXXXXX", NULL);
  flow = g_build_filename(source, "flows", "compare.yaml", NULL);
  run_measure("cells.first", 20, "store", "cells", NULL);
  run_measure("cells.again", 0.5, "store", "cells", NULL);
  change_one(source);
  g_autofree char *circuit =
      data ? g_build_filename(data, "iscas85", "c1908", "c1908.gds", NULL)
           : NULL;
  if (circuit && g_file_test(circuit, G_FILE_TEST_EXISTS)) {
    g_autofree char *set = g_strdup_printf(
        "compare.cases=[{ layout.file: %s, layout.scale: 1.3 }]", circuit);
    run_measure("c1908.first", 60, "store", "c1908", set);
    run_measure("c1908.again", INFINITY, "store", "c1908", set);
  }
  kill_often(source);
  opc_remove_tree(folder);
  g_free(folder);
  g_free(flow);
  return bench_write("compare");
}
