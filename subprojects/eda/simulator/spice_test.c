/* SPDX-License-Identifier: BSD-3-Clause */
/* Circuits with closed-form solutions, and all kinds of failures. */
#include <eda/simulator.h>

#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "simulator/paths.h"
#include "simulator/sandbox.h"

enum { LIMIT = 20 };

static int stop; /* non-zero: request cancellation */
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

static char *
    own; /* ngspice library selected by the user; NULL: the installed library */

/* Select the ngspice library; NULL: the library of the user. */
static void library_use(const char *library) {
  if (library || own)
    g_setenv("OPCFLOW_NGSPICE", library ? library : own, TRUE);
  else
    g_unsetenv("OPCFLOW_NGSPICE");
}

/* Return whether ngspice is available. The ngspice library may be missing,
   although the helper program is always built. */
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

/* Charging through a resistor; the real part of a low-pass filter; a line in a
   sweep. Results have the order of the commands. */
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

static void assert_fails(const char *deck, const char *commands, double limit,
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
  assert_fails("t\nm1 d 0 0 0 nope w=1u l=1u\nv1 d 0 1\n.end\n", "op", LIMIT,
               OPC_FAILED,
               "m1 d 0 0 0 nope w=1u l=1u; could not find a valid model", 0);
  assert_fails("t\nv1 a 0 1\n.include \"/nowhere/at.all\"\n.end", "op", LIMIT,
               OPC_INVALID, "deck:3:10: '/nowhere/at.all': No such file", 0);
  assert_fails("t\nv1 a 0 1\n", "op", LIMIT, OPC_FAILED,
               ".end statement is missing", 0);
  assert_fails("", "op", LIMIT, OPC_FAILED, ".end statement is missing", 0);
  assert_fails("t\n.param x={lacking+1}\nv1 a 0 {x}\nr1 a 0 1\n.end\n", "op",
               LIMIT, OPC_FAILED, "Undefined parameter [lacking]", 0);
  assert_fails(rc, "op\ndc v9 0 1 1\nop", LIMIT, OPC_FAILED,
               "'dc v9 0 1 1': Fatal error", 1);
  assert_fails(rc, "op\nfly 1", LIMIT, OPC_FAILED, "fly: no such command", 1);
  assert_fails("two sources\nv1 a 0 1\nv2 a 0 2\n.end", "op", LIMIT, OPC_FAILED,
               "'op': Error", 0);
}

/* A library that exits or hangs does not stop this process. */
static void test_death(void) {
  static const char endless[] = "tran 1f 1000";
  if (!have_ngspice()) return;
  assert_fails(rc, "op\nquit 3", LIMIT, OPC_FAILED, "a quit command", 1);
  gint64 start = g_get_monotonic_time();
  assert_fails(rc, endless, 0.5, OPC_FAILED, "did not finish within 0.5 s", 0);
  assert_fails(rc, "tran 1n 1000 0 1n", 0.5, OPC_FAILED,
               "'tran 1n 1000 0 1n' is at ", 0);
  assert_fails(rc, "tran 1n 1000 0 1n", 0.5, OPC_FAILED, ", in steps of 1e-09",
               0);
  g_assert_cmpint(g_get_monotonic_time() - start, <, 5 * G_USEC_PER_SEC);
  stop = 1;
  assert_fails(rc, endless, LIMIT, OPC_CANCELLED, "stopped", 0);
  stop = 0;
}

/* ---- the sandbox ---- */

static guint entries(const char *folder) {
  GDir *dir = g_dir_open(folder, 0, NULL);
  guint n = 0;
  while (g_dir_read_name(dir)) n++;
  g_dir_close(dir);
  return n;
}

static void clear_entries(const char *folder) {
  GDir *dir = g_dir_open(folder, 0, NULL);
  for (const char *name; (name = g_dir_read_name(dir));) {
    g_autofree char *path = g_build_filename(folder, name, NULL);
    g_remove(path);
  }
  g_dir_close(dir);
}

static const char with_osdi[] = "t\n.osdi \"" EDA_OSDI_BUILT "\"\n.end";

/* Check that an attempt of the evil library fails with a message or ends the
   process, with and without compiled models. */
static void assert_cannot(const char *deed, const char *path,
                          const char *words) {
  g_autofree char *command = g_strdup_printf("%s %s", deed, path);
  assert_fails("t\n.end", command, LIMIT, OPC_FAILED, words, 0);
  assert_fails(with_osdi, command, LIMIT, OPC_FAILED, words, 0);
}

/* No attempt of the library changes a file or starts a program. */
static void test_sandbox(void) {
  static const char ended[] = "start a program or to write a file",
                    denied[] = "gave -1 (Permission denied)";
  static const struct {
    const char *deed, *words;
  } deeds[] = {{"append", ended},  {"create", ended}, {"change", ended},
               {"remove", ended},  {"folder", ended}, {"shell", ended},
               {"exec", ended},    {"fork", ended},   {"parent", ended},
               {"socket", denied}, {"code", denied},  {"truncate", denied},
               {"link", denied},   {"mode", denied}};
  g_autofree char *folder = g_dir_make_tmp("spice-test-XXXXXX", NULL);
  g_autofree char *old = g_build_filename(folder, "old", NULL);
  g_autofree char *new = g_build_filename(folder, "new", NULL);
  g_assert_true(g_file_set_contents(old, "unchanged", -1, NULL));
  library_use(EDA_EVIL_BUILT);
  for (size_t i = 0; i < G_N_ELEMENTS(deeds); i++) {
    assert_cannot(deeds[i].deed, old, deeds[i].words);
    assert_cannot(deeds[i].deed, new, deeds[i].words);
  }
  assert_cannot("read", old, denied);
  if (!SANDBOX_ANY_MEMORY)
    assert_cannot("memory", "", "(Cannot allocate memory)");
  /* Signal settings of the caller are not inherited. */
  signal(SIGSEGV, SIG_IGN);
  assert_cannot("crash", "", "crashed (Segmentation fault)");
  signal(SIGSEGV, SIG_DFL);
  assert_fails("t\n.end", "hang", 0.3, OPC_FAILED, "not finish within 0.3 s",
               0);
  library_use(NULL);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(old, &text, NULL, NULL));
  g_assert_cmpstr(text, ==, "unchanged");
  g_assert_cmpint(g_remove(old), ==, 0);
  g_assert_cmpint(g_rmdir(folder), ==, 0);
}

/* Only the given file is readable, by all its names. */
static void test_osdi_file(void) {
  library_use(EDA_EVIL_BUILT);
  assert_fails(with_osdi, "read " EDA_OSDI_BUILT, LIMIT, OPC_FAILED,
               "read gave 5", 0);
  assert_cannot("change", EDA_OSDI_BUILT, "start a program or to write a file");
  assert_cannot("read", EDA_EVIL_BUILT, "gave -1 (Permission denied)");
  library_use(NULL);
}

/* ---- compiled models ---- */

#define SQUARE                                                             \
  "t\n.osdi \"" EDA_OSDI_BUILT                                             \
  "\"\n.model m squarelaw type=1 k=1m vt=0.4 leak=1n\n"                    \
  ".model other unknown x=1\nvd d 0 1\nvg g 0 1\nn1 d g 0 0 m w=2u l=1u\n" \
  ".end\n"

/* A square-law model whose shared object attempts forbidden actions when
   loaded. The transistor conducts only if all attempts fail. */
static void test_osdi(void) {
  eda_spice_result r;
  opc_error error;
  int code = eda_spice_run(&context, SQUARE, "op\nalter vg = 0\nop\ntran 1n 9n",
                           LIMIT, &r, &error);
  if (code == OPC_NO_PLUGIN) {
    g_test_skip(error.message);
  } else {
    if (code) g_error("%s", error.message);
    g_assert_cmpuint(r.count, ==, 3);
    double on = values(&r.plot[0], "i(vd)", NULL)[0];
    double off = values(&r.plot[1], "i(vd)", NULL)[0];
    g_assert_cmpfloat(fabs(-on / (1e-3 * 0.36 + 2e-9) - 1), <, 1e-6);
    g_assert_cmpfloat(fabs(-off / 2e-9 - 1), <, 1e-3); /* the leakage and
                                                          gmin */
  }
  eda_spice_clear(&r);
}

/* A library without support for compiled models is reported for any deck. */
static void test_no_osdi(void) {
  g_autofree char *folder = g_dir_make_tmp("spice-test-XXXXXX", NULL);
  g_autofree char *none = g_build_filename(folder, "none.osdi", NULL);
  g_autofree char *deck = g_strdup_printf("t\n.osdi \"%s\"\n.end", none);
  g_assert_true(g_file_set_contents(none, "no object", -1, NULL));
  library_use(EDA_EVIL_BUILT);
  assert_fails(deck, "op", LIMIT, OPC_NO_PLUGIN,
               "cannot load compiled models (OSDI)", 0);
  library_use(NULL);
  eda_spice_result r;
  opc_error error;
  int code = eda_spice_run(&context, deck, "op", LIMIT, &r, &error);
  g_test_message("%s", error.message);
  if (code != OPC_NO_PLUGIN) {
    g_assert_cmpint(code, ==, OPC_FAILED);
    g_assert_nonnull(strstr(error.message, "none.osdi': Error opening"));
  }
  eda_spice_clear(&r);
  g_assert_cmpint(g_remove(none), ==, 0);
  g_assert_cmpint(g_rmdir(folder), ==, 0);
}

/* Return the answer of the program alone to an unfiltered deck. */
static GBytes *hand_over(const char *deck) {
  g_autofree char *parent = g_strdup_printf("%d", (int)getpid());
  g_autoptr(GSubprocess) child = g_subprocess_new(
      G_SUBPROCESS_FLAGS_STDIN_PIPE | G_SUBPROCESS_FLAGS_STDOUT_PIPE, NULL,
      EDA_SIMULATOR_BUILT, "10", parent, NULL);
  g_assert_nonnull(child);
  g_autoptr(GBytes) request = g_bytes_new(deck, strlen(deck) + 1);
  GBytes *answer = NULL;
  g_assert_true(
      g_subprocess_communicate(child, request, NULL, &answer, NULL, NULL));
  return answer;
}

/* Decks that the filter rejects have no effect in ngspice inside the sandbox.
   The ngspice command, if installed, shows that the decks have an effect
   without a sandbox. */
static void test_evil_decks(void) {
  static const char *const evil[] = {
      "t\nv1 a 0 1\n.control\nshell touch %s\n.endc\n.end",
      "*ng_script\nshell touch %s\n",
      "t\n*# shell touch %s\nv1 a 0 1\n.end",
      "t\nv1 a 0 1\n.control\nset x = `touch %s`\n.endc\n.end",
      "t\nv1 a 0 1\n.control\nop\nwrite %s\n.endc\n.end",
      "t\nv1 a 0 1\n.control\nop\nwrdata %s v(a)\n.endc\n.end",
      "t\nv1 a 0 1\n.control\necho x > %s\n.endc\n.end",
      "t\nv1 a 0 1\n.control\nop\nprint all > %s\n.endc\n.end"};
  if (!have_ngspice()) return;
  g_autofree char *folder = g_dir_make_tmp("spice-test-XXXXXX", NULL);
  g_autofree char *file = g_build_filename(folder, "made", NULL);
  g_autofree char *program = g_find_program_in_path("ngspice");
  g_autofree char *path = g_build_filename(folder, "deck", NULL);
  int works = 0;
  for (size_t i = 0; i < G_N_ELEMENTS(evil); i++) {
    g_auto(GStrv) parts = g_strsplit(evil[i], "%s", -1);
    g_autofree char *deck = g_strjoinv(file, parts);
    g_autoptr(GBytes) answer = hand_over(deck);
    g_assert_cmpuint(entries(folder), ==, 0);
    g_assert_cmpuint(g_bytes_get_size(answer), >, 0); /* the program answered */
    if (!program) continue;
    const char *argv[] = {program, "-b", path, NULL};
    g_assert_true(g_file_set_contents(path, deck, -1, NULL));
    g_spawn_sync(folder, (char **)argv, NULL,
                 G_SPAWN_STDOUT_TO_DEV_NULL | G_SPAWN_STDERR_TO_DEV_NULL, NULL,
                 NULL, NULL, NULL, NULL, NULL);
    g_remove(path);
    works += g_remove(file) == 0 || entries(folder);
    clear_entries(folder);
  }
  if (program) g_assert_cmpint(works, >=, 4);
  g_test_message("%d of %zu work in a plain ngspice", works,
                 G_N_ELEMENTS(evil));
  g_assert_cmpint(g_rmdir(folder), ==, 0);
}

/* Wait for a helper that hangs, in a thread, and print its process number. */
static gpointer helper_call(gpointer unused) {
  (void)unused;
  g_autofree char *path =
      g_strdup_printf("/proc/self/task/%d/children", (int)getpid());
  for (;;) {
    g_autofree char *text = NULL;
    if (g_file_get_contents(path, &text, NULL, NULL) && *text) {
      g_usleep(100000); /* the helper has entered the sandbox by then */
      printf("%ld\n", atol(text));
      fflush(stdout);
      return NULL;
    }
    g_usleep(1000);
  }
}

static int run_endless(void) {
  eda_spice_result r;
  opc_error error;
  library_use(EDA_EVIL_BUILT);
  g_thread_unref(g_thread_new("call", helper_call, NULL));
  return eda_spice_run(&context, "t\n.end", "hang", LIMIT, &r, &error);
}

/* Return whether a process runs; false for zombies. */
static int is_running(pid_t process) {
  g_autofree char *path = g_strdup_printf("/proc/%d/stat", (int)process);
  g_autofree char *text = NULL;
  return g_file_get_contents(path, &text, NULL, NULL) && !strstr(text, ") Z ");
}

/* Return the limit of a process called `what` in /proc; -1 for none. */
static long limit_of(pid_t process, const char *what) {
  g_autofree char *path = g_strdup_printf("/proc/%d/limits", (int)process);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
  const char *at = strstr(text, what);
  g_assert_nonnull(at);
  at += strlen(what) + strspn(at + strlen(what), " ");
  return g_ascii_isdigit(*at) ? atol(at) : -1; /* unlimited */
}

/* The helper leaves no core and has limited processor time; a killed parent
   ends its helper. */
static void test_parent(void) {
  struct rlimit core;
  g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
  const char *argv[] = {self, "--endless", NULL};
  /* Raise the limit of the parent, so that any restriction comes from the
     helper. */
  getrlimit(RLIMIT_CORE, &core);
  core.rlim_cur = core.rlim_max;
  setrlimit(RLIMIT_CORE, &core);
  GPid parent;
  int out;
  g_assert_true(g_spawn_async_with_pipes(NULL, (char **)argv, NULL,
                                         G_SPAWN_DO_NOT_REAP_CHILD, NULL, NULL,
                                         &parent, NULL, &out, NULL, NULL));
  char line[32] = "";
  for (size_t n = 0; n < sizeof line - 1 && !strchr(line, '\n'); n++)
    g_assert_cmpint(read(out, line + n, 1), ==, 1);
  pid_t helper = (pid_t)atol(line);
  g_assert_cmpint(kill(helper, 0), ==, 0);
  g_assert_cmpint(limit_of(helper, "Max core file size"), ==, 0);
  g_assert_cmpint(limit_of(helper, "Max cpu time"), >=, LIMIT);
  g_assert_cmpint(limit_of(helper, "Max cpu time"), <=, 2 * LIMIT);
  kill(parent, SIGKILL);
  waitpid(parent, NULL, 0);
  gint64 start = g_get_monotonic_time();
  while (is_running(helper)) {
    g_assert_cmpint(g_get_monotonic_time() - start, <, G_USEC_PER_SEC);
    g_usleep(10000);
  }
  close(out);
}

static void test_missing(void) {
  library_use("/nowhere/libngspice.so");
  assert_fails(rc, "op", LIMIT, OPC_NO_PLUGIN, "package 'libngspice0'", 0);
  library_use(NULL);
  g_setenv("OPCFLOW_SIMULATOR", "/nowhere/opcflow-simulator", TRUE);
  assert_fails(rc, "op", LIMIT, OPC_NO_PLUGIN,
               "program that loads ngspice is not installed", 0);
  g_unsetenv("OPCFLOW_SIMULATOR");
}

/* The program exits if its parent process is not the process that started
   it. */
static void test_orphan(void) {
  g_autoptr(GSubprocess) child =
      g_subprocess_new(G_SUBPROCESS_FLAGS_STDOUT_PIPE, NULL,
                       EDA_SIMULATOR_BUILT, "10", "1", NULL);
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

/* Several threads obtain equal numbers; no file remains, although a BSIM4
   transistor writes a log to the current folder. */
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
  assert_fails(bsim, "op", LIMIT, OPC_FAILED, "oxe", 0);
  g_assert_cmpuint(entries(temporary), ==, 0);
  g_assert_cmpuint(entries(here), ==, before);
  g_assert_cmpint(g_rmdir(temporary), ==, 0);
}

int main(int argc, char **argv) {
  if (argc > 1 && !strcmp(argv[1], "--endless")) return run_endless();
  g_test_init(&argc, &argv, NULL);
  own = g_strdup(g_getenv("OPCFLOW_NGSPICE"));
  g_test_add_func("/spice/closed-form", test_closed_form);
  g_test_add_func("/spice/words", test_words);
  g_test_add_func("/spice/death", test_death);
  g_test_add_func("/spice/sandbox", test_sandbox);
  g_test_add_func("/spice/osdi-file", test_osdi_file);
  g_test_add_func("/spice/osdi", test_osdi);
  g_test_add_func("/spice/no-osdi", test_no_osdi);
  g_test_add_func("/spice/evil-decks", test_evil_decks);
  g_test_add_func("/spice/parent", test_parent);
  g_test_add_func("/spice/missing", test_missing);
  g_test_add_func("/spice/orphan", test_orphan);
  g_test_add_func("/spice/together", test_together);
  int failed = g_test_run();
  g_free(own);
  return failed;
}
