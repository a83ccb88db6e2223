/* SPDX-License-Identifier: BSD-3-Clause */
/* Circuits with closed forms, and every way to fail. */
#include <eda/simulator.h>

#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "simulator/paths.h"

enum { LIMIT = 20 };

static int stop; /* whether the user wants to */
static int stopped(const opc_context *unused) {
  (void)unused;
  return stop;
}
static const opc_context context = {.cancelled = stopped};

static const char rc[] =
    "low-pass\n"
    "Vin in 0 dc 0 ac 1 pulse(0 1 0 1f 1f 1 2)\n"
    "R1 in Out 1k\n"
    "C1 out 0 1p\n"
    ".options reltol=1e-6\n"
    ".end\n";

/* Its library may be missing, the program that loads it is ours. */
static int have_ngspice(void) {
  eda_spice_result r;
  opc_error error;
  int missing = eda_spice_run(&context, rc, "", LIMIT, &r, &error) &&
                strstr(error.message, "libngspice");
  eda_spice_clear(&r);
  if (missing) g_test_skip(error.message);
  return !missing;
}

static const double *values(const eda_spice_plot *p, const char *name,
                            size_t *count) {
  const eda_spice_vector *v = eda_spice_vector_find(p, name);
  if (!v) g_error("'%s' has no '%s'", p->name, name);
  if (count) *count = v->count;
  return v->value;
}

/* Charging through a resistor; the real part of a low-pass; a line in a sweep.
   In the order of the commands. */
static void test_closed_form(void) {
  eda_spice_result r;
  opc_error error;
  if (!have_ngspice()) return;
  if (eda_spice_run(&context, rc,
                    "tran 10p 5n\nac lin 11 1meg 1000meg\n\ndc vin -1 1 0.5\n",
                    LIMIT, &r, &error))
    g_error("%s", error.message);
  g_assert_cmpuint(r.count, ==, 3);
  g_assert_cmpstr(r.plot[0].name, ==, "tran1");
  size_t n, points;
  const double *t = values(&r.plot[0], "time", &n);
  const double *v = values(&r.plot[0], "v(out)", &points);
  const double *i = values(&r.plot[0], "i(vin)", NULL);
  g_assert_cmpuint(n, ==, points);
  g_assert_cmpuint(n, >, 400);
  double worst = 0;
  for (size_t k = 0; k < n; k++) {
    if (t[k] < 1e-12) continue;
    double want = 1 - exp(-t[k] / 1e-9);
    worst = fmax(worst, fabs(v[k] - want));
    g_assert_cmpfloat(fabs(v[k] - want), <, 1e-4);
    g_assert_cmpfloat(fabs(i[k] + 1e-3 * (1 - want)), <, 1e-7);
  }
  g_test_message("charging: worst %.2g V of 1 V at %zu times", worst, n);
  const double *f = values(&r.plot[1], "frequency", &n);
  v = values(&r.plot[1], "v(out)", NULL);
  g_assert_cmpuint(n, ==, 11);
  for (size_t k = 0; k < n; k++) {
    double x = 2 * M_PI * f[k] * 1e-9;
    g_assert_cmpfloat(fabs(v[k] - 1 / (1 + x * x)), <, 1e-9);
  }
  const double *sweep = values(&r.plot[2], "v-sweep", &n);
  v = values(&r.plot[2], "v(out)", NULL);
  g_assert_cmpuint(n, ==, 5);
  for (size_t k = 0; k < n; k++)
    g_assert_cmpfloat(fabs(v[k] - sweep[k]), <, 1e-9);
  eda_spice_clear(&r);
}

static void fails(const char *deck, const char *commands, double limit,
                  int code, const char *words, size_t plots) {
  eda_spice_result r;
  opc_error error;
  int got = eda_spice_run(&context, deck, commands, limit, &r, &error);
  if (got != code || !strstr(error.message, words))
    g_error("code %d, '%s', expected %d, '%s'", got, error.message, code,
            words);
  g_test_message("%s", error.message);
  g_assert_cmpuint(r.count, ==, plots);
  eda_spice_clear(&r);
}

static void test_words(void) {
  if (!have_ngspice()) return;
  fails("t\nm1 d 0 0 0 nope w=1u l=1u\nv1 d 0 1\n.end\n", "op", LIMIT,
        OPC_FAILED, "m1 d 0 0 0 nope w=1u l=1u; could not find a valid model",
        0);
  fails("t\nv1 a 0 1\n.include \"/nowhere/at.all\"\n.end", "op", LIMIT,
        OPC_FAILED, "Could not find include file /nowhere/at.all", 0);
  fails("t\nv1 a 0 1\n", "op", LIMIT, OPC_FAILED, ".end statement is missing",
        0);
  fails("", "op", LIMIT, OPC_FAILED, "there aren't any circuits", 0);
  fails(rc, "op\ndc v9 0 1 1\nop", LIMIT, OPC_FAILED,
        "'dc v9 0 1 1': Fatal error", 1);
  fails(rc, "op\nfly 1", LIMIT, OPC_FAILED, "fly: no such command", 1);
  fails("two sources\nv1 a 0 1\nv2 a 0 2\n.end", "op", LIMIT, OPC_FAILED,
        "'op': Error", 0);
}

/* A library that crashes, exits or hangs is not ours to wait for. What we do
   with signals is not handed down to it. */
static void test_death(void) {
  static const char loop[] =
      "t\nv1 a 0 1\n.control\nop\nlet x = 1\nwhile 1\n"
      "let x = x + 1\nend\n.endc\n.end\n";
  if (!have_ngspice()) return;
  g_autofree char *folder = g_dir_make_tmp("spice-test-XXXXXX", NULL);
  g_autofree char *script = g_build_filename(folder, "crash", NULL);
  g_assert_true(g_file_set_contents(script, "kill -s SEGV $PPID", -1, NULL));
  g_autofree char *commands =
      g_strdup_printf("op\nshell exec sh %s\nop", script);
  signal(SIGSEGV, SIG_IGN);
  fails(rc, commands, LIMIT, OPC_FAILED, "crashed (Segmentation fault)", 1);
  signal(SIGSEGV, SIG_DFL);
  g_unlink(script);
  g_rmdir(folder);
  fails(rc, "op\nquit 3", LIMIT, OPC_FAILED, "told to quit", 1);
  gint64 start = g_get_monotonic_time();
  fails(loop, "", 0.3, OPC_FAILED, "not done after 0.3 s", 0);
  g_assert_cmpint(g_get_monotonic_time() - start, <, 5 * G_USEC_PER_SEC);
  stop = 1;
  fails(loop, "", LIMIT, OPC_CANCELLED, "stopped", 0);
  stop = 0;
}

static void test_missing(void) {
  g_setenv("OPCFLOW_NGSPICE", "/nowhere/libngspice.so", TRUE);
  fails(rc, "op", LIMIT, OPC_NO_PLUGIN, "package 'libngspice0'", 0);
  g_unsetenv("OPCFLOW_NGSPICE");
  g_setenv("OPCFLOW_SIMULATOR", "/nowhere/opcflow-simulator", TRUE);
  fails(rc, "op", LIMIT, OPC_NO_PLUGIN,
        "program that loads ngspice is not installed", 0);
  g_unsetenv("OPCFLOW_SIMULATOR");
}

/* The program does nothing for anyone but who has started it. */
static void test_orphan(void) {
  g_autoptr(GSubprocess) child =
      g_subprocess_new(G_SUBPROCESS_FLAGS_STDOUT_PIPE, NULL,
                       EDA_SIMULATOR_BUILT, "/tmp", "10", "1", NULL);
  g_autoptr(GBytes) answer = NULL;
  g_assert_nonnull(child);
  g_assert_true(
      g_subprocess_communicate(child, NULL, NULL, &answer, NULL, NULL));
  g_assert_cmpuint(g_bytes_get_size(answer), ==, 0);
  g_assert_cmpint(g_subprocess_get_exit_status(child), ==, 1);
}

static gpointer one_run(gpointer data) {
  eda_spice_result r;
  opc_error error;
  double *last = data;
  if (eda_spice_run(&context, rc, "tran 10p 5n", LIMIT, &r, &error))
    g_error("%s", error.message);
  size_t n;
  const double *v = values(&r.plot[0], "v(out)", &n);
  *last = v[n - 1];
  eda_spice_clear(&r);
  return NULL;
}

static guint entries(const char *folder) {
  GDir *dir = g_dir_open(folder, 0, NULL);
  guint n = 0;
  while (g_dir_read_name(dir)) n++;
  g_dir_close(dir);
  return n;
}

/* From several threads at once, the same numbers; and nothing is left, though
   a BSIM4 transistor writes a log where it stands. */
static void test_together(void) {
  static const char bsim[] =
      "t\nm1 d d 0 0 n w=1u l=60n\nv1 d 0 1\n"
      ".model n nmos level=54 version=4.5 paramchk=1 toxe=-1\n.end";
  enum { THREADS = 6 };
  if (!have_ngspice()) return;
  g_autofree char *temporary = g_dir_make_tmp("spice-test-XXXXXX", NULL);
  g_autofree char *here = g_get_current_dir();
  guint before = entries(here);
  g_setenv("TMPDIR", temporary, TRUE);
  GThread *thread[THREADS];
  double last[THREADS];
  for (int i = 0; i < THREADS; i++)
    thread[i] = g_thread_new("run", one_run, &last[i]);
  for (int i = 0; i < THREADS; i++) g_thread_join(thread[i]);
  for (int i = 1; i < THREADS; i++) g_assert_cmpfloat(last[i], ==, last[0]);
  fails(bsim, "op", LIMIT, OPC_FAILED, "oxe", 0);
  g_assert_cmpuint(entries(temporary), ==, 0);
  g_assert_cmpuint(entries(here), ==, before);
  g_assert_cmpint(g_rmdir(temporary), ==, 0);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/spice/closed-form", test_closed_form);
  g_test_add_func("/spice/words", test_words);
  g_test_add_func("/spice/death", test_death);
  g_test_add_func("/spice/missing", test_missing);
  g_test_add_func("/spice/orphan", test_orphan);
  g_test_add_func("/spice/together", test_together);
  return g_test_run();
}
