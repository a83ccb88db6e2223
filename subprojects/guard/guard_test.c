/* SPDX-License-Identifier: BSD-3-Clause */
/* Plugins that crash, end or change a process. The parent process reads the
   exit code and the message. */
#include <fcntl.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <guard/child.h>
#include <guard/guard.h>
#include <guard/memory.h>
#include <guard/process.h>
#include <guard/stop.h>
#include <locale.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* Run a plugin 'bad' in a guarded process. Return the exit code, or minus the
   signal that ended the process. *message receives the standard error
   (g_free). */
static int guarded_run(void (*plugin)(void), char **message) {
  GString *text = g_string_new(NULL);
  int ends[2], status;
  char buffer[256];
  g_assert_cmpint(pipe(ends), ==, 0);
  pid_t pid = fork();
  if (!pid) {
    dup2(ends[1], STDERR_FILENO);
    close(ends[0]);
    close(ends[1]);
    guard_install(NULL);
    guard_where("here", GUARD_CRASH_RUNNING);
    const char *before = guard_enter("bad");
    plugin();
    guard_leave(before);
    guard_done(7);
    exit(7);
  }
  close(ends[1]);
  for (ssize_t n; (n = read(ends[0], buffer, sizeof buffer)) > 0;)
    g_string_append_len(text, buffer, n);
  close(ends[0]);
  g_assert_cmpint(waitpid(pid, &status, 0), ==, pid);
  *message = g_string_free(text, FALSE);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

static void do_nothing(void) {}

static void plugin_crash(void) { raise(SIGSEGV); }

static void plugin_leave(void) { exit(0); }

static void leave_at_once(void) { _exit(0); }

static void plugin_move(void) { g_assert_cmpint(chdir("/"), ==, 0); }

static void close_input(void) { close(STDIN_FILENO); }

static void take_handler(void) { signal(SIGINT, SIG_IGN); }

static void mask_files(void) { umask(0123); }

static void set_alarm(void) { alarm(60); }

/* The plugin continues after a request to stop. */
static void go_on(void) {
  stop_on_signals(9);
  raise(SIGINT);
  while (stop_is_asked()) pause();
}

/* The limit of the outer call is the earlier one. */
static void exceed_limit(void) {
  stop_limit outer, inner;
  stop_on_signals(9);
  stop_limit_begin(&outer, 0.05, "outer");
  stop_limit_begin(&inner, 60, "inner");
  for (;;) pause();
}

/* A time limit has no effect after stop_limit_end. */
static void keep_limits(void) {
  stop_limit outer, inner;
  stop_on_signals(9);
  stop_limit_begin(&outer, 60, "outer");
  stop_limit_begin(&inner, 0.05, "inner");
  stop_limit_end(&inner);
  g_usleep(100000);
  stop_limit_end(&outer);
}

static void *end_process(void *unused) {
  (void)unused;
  exit(0);
}

/* A thread belongs to the plugin that started it. */
static void leave_by_thread(void) {
  pthread_t thread;
  g_assert_cmpint(pthread_create(&thread, NULL, end_process, NULL), ==, 0);
  pthread_join(thread, NULL);
}

static void *end_thread(void *unused) {
  guard_join("bad");
  pthread_exit(unused);
}

/* A plugin ends a thread of the program during a task. */
static void leave_task(void) {
  pthread_t thread;
  g_assert_cmpint(pthread_create(&thread, NULL, end_thread, NULL), ==, 0);
  pthread_join(thread, NULL);
}

/* A stack overflow cannot be reported without the signal stack. */
static void drop_stack(void) {
  const stack_t none = {.ss_flags = SS_DISABLE};
  sigaltstack(&none, NULL);
}

#ifndef __SANITIZE_ADDRESS__
static int overflow(int depth) {
  volatile char page[4096] = {0};
  if (depth < 0) return page[0];
  return overflow(depth + 1) + page[1]; /* no tail call */
}

static void *drop_and_overflow(void *unused) {
  drop_stack();
  return overflow(0) ? unused : NULL;
}

static void overflow_by_thread(void) {
  pthread_t thread;
  g_assert_cmpint(pthread_create(&thread, NULL, drop_and_overflow, NULL), ==,
                  0);
  pthread_join(thread, NULL);
}
#endif

static void become_daemon(void) { (void)!daemon(0, 0); }

/* The child, or the child of a child that has ended, continues. */
static void leave_child(void) {
  if (fork()) return;
  sleep(60);
  _exit(0);
}

static void leave_orphan(void) {
  int status;
  pid_t child = fork();
  if (!child) {
    if (!fork()) sleep(60);
    _exit(0);
  }
  waitpid(child, &status, 0);
}

/* Use a process that has ended but was not waited for, and one that ends during
   the call. */
static void use_child(void) {
  siginfo_t ended;
  if (!fork()) _exit(0);
  g_assert_cmpint(waitid(P_ALL, 0, &ended, WEXITED | WNOWAIT), ==, 0);
  g_assert_cmpint(system("exit 3"), ==, 3 << 8);
}

static void *run_command(void *unused) {
  g_assert_cmpint(system("sleep 0.3"), ==, 0);
  return unused;
}

/* While a thread is in system(), SIGINT is ignored; this is not a change of the
   handler by a plugin. */
static void run_command_beside(void) {
  pthread_t thread;
  g_assert_cmpint(pthread_create(&thread, NULL, run_command, NULL), ==, 0);
  for (int i = 0; i < 20; i++) {
    guard_leave(guard_enter("other"));
    g_usleep(10000);
  }
  pthread_join(thread, NULL);
}

static void crash_after_other(void) {
  guard_leave(guard_enter("other"));
  guard_leave(guard_enter("third"));
  abort();
}

/* A plugin of an earlier step is listed, too, even if the memory of its name
   has been freed. */
static void crash_in_next_step(void) {
  char name[] = "earlier";
  guard_leave(NULL);
  guard_leave(guard_enter(name));
  memset(name, 'x', sizeof name - 1);
  guard_enter("later");
  abort();
}

static void *crash_beside(void *barrier) {
  guard_enter("bad");
  pthread_barrier_wait(barrier);
  raise(SIGSEGV);
  return NULL;
}

static const char *const earlier[] = {"a", "b", "c", "d", "e", "f", "g", "h"};

/* Several threads crash at once, after calls of eight plugins. */
static void crash_together(void) {
  pthread_barrier_t barrier;
  pthread_t thread;
  for (size_t i = 0; i < G_N_ELEMENTS(earlier); i++)
    guard_leave(guard_enter(earlier[i]));
  guard_enter("bad");
  pthread_barrier_init(&barrier, NULL, 8);
  for (int i = 0; i < 7; i++)
    pthread_create(&thread, NULL, crash_beside, &barrier);
  pthread_barrier_wait(&barrier);
  raise(SIGSEGV);
}

static void test_together(void) {
  for (int i = 0; i < 200; i++) {
    g_autofree char *message = NULL;
    g_assert_cmpint(guarded_run(crash_together, &message), ==, 4);
    g_assert_cmpstr(message, ==,
                    "here: crashed in plugin 'bad': segmentation fault\nnote: "
                    "plugins called before may have damaged the memory: 'a', "
                    "'b', 'c', 'd', 'e', 'f', 'g', 'h'; OPCFLOW_GUARD=pages "
                    "detects more of such writes\n");
  }
}

static void crash_outside(void) {
  guard_leave(NULL);
  abort();
}

static const struct {
  void (*plugin)(void);
  int code;
  const char *message;
} cases[] = {
    {do_nothing, 7, ""},
    {plugin_crash, 4, "here: crashed in plugin 'bad': segmentation fault\n"},
    {plugin_leave, 4, "here: plugin 'bad' ended the process\n"},
    {leave_at_once, 4, "here: plugin 'bad' ended the process\n"},
    {leave_by_thread, 4, "here: plugin 'bad' ended the process\n"},
    {leave_task, 4, "here: plugin 'bad' ended the thread\n"},
    {plugin_move, 4, "here: plugin 'bad' changed the working folder\n"},
    {close_input, 4,
     "here: plugin 'bad' closed or redirected standard input\n"},
    {take_handler, 4, "here: plugin 'bad' changed the handler of SIGINT\n"},
    {mask_files, 4, "here: plugin 'bad' changed the modes of new files\n"},
    {go_on, 9, "here: stopped in plugin 'bad'\n"},
    {exceed_limit, 4, "outer: stopped in plugin 'bad'\n"},
    {keep_limits, 7, ""},
    {drop_stack, 4, "here: plugin 'bad' changed the alternate signal stack\n"},
#ifndef __SANITIZE_ADDRESS__ /* the sanitizer has its own signal stack */
    {overflow_by_thread, 4,
     "here: crashed in plugin 'bad': segmentation fault\n"},
#endif
    {become_daemon, 4, "here: plugin 'bad' ended the process\n"},
    {leave_child, 4, "here: plugin 'bad' left a process running\n"},
    {leave_orphan, 4, "here: plugin 'bad' left a process running\n"},
    {use_child, 7, ""},
    {run_command_beside, 7, ""},
    {crash_after_other, 4,
     "here: crashed in plugin 'bad': aborted\nnote: plugins called before may "
     "have damaged the memory: 'other', 'third'; OPCFLOW_GUARD=pages detects "
     "more of such writes\n"},
    {crash_outside, 4,
     "here: crashed outside of plugins: aborted\nnote: plugins called before "
     "may "
     "have damaged the memory: 'bad'; OPCFLOW_GUARD=pages detects more of such "
     "writes\n"},
    {crash_in_next_step, 4,
     "here: crashed in plugin 'later': aborted\nnote: plugins called before "
     "may have damaged the memory: 'bad', 'earlier'; OPCFLOW_GUARD=pages "
     "detects more of such writes\n"},
    {set_alarm, 4, "here: plugin 'bad' left an alarm set\n"},
};

static void test_plugins(void) {
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *message = NULL;
    g_test_message("case %zu", i);
    int code = guarded_run(cases[i].plugin, &message);
    g_assert_cmpstr(message, ==, cases[i].message);
    g_assert_cmpint(code, ==, cases[i].code);
  }
}

/* The folder of a crashed run is renamed; an empty folder is removed. */
static void crash_in_run(void) {
  guard_folder("work", "run.failed", "slot/lock");
  plugin_crash();
}

static void test_folder(void) {
  g_autofree char *folder = g_dir_make_tmp("guard-XXXXXX", NULL);
  g_autofree char *message = NULL, *again = NULL;
  g_assert_cmpint(chdir(folder), ==, 0);
  g_assert_cmpint(g_mkdir("work", 0777) + g_mkdir("work/kept", 0777), ==, 0);
  g_assert_cmpint(guarded_run(crash_in_run, &message), ==, 4);
  g_assert_nonnull(strstr(message, "are in 'run.failed'\n"));
  g_assert_cmpint(rmdir("run.failed/kept") + rmdir("run.failed"), ==, 0);
  g_assert_cmpint(g_mkdir("work", 0777), ==, 0);
  g_assert_cmpint(guarded_run(crash_in_run, &again), ==, 4);
  g_assert_null(strstr(again, "run.failed"));
  g_assert_cmpint(chdir("/") + rmdir(folder), ==, 0);
}

static void say_hello(int out, void *data) {
  process_write(out, data, strlen(data));
}

static void sleep_long(int out, void *data) {
  (void)out, (void)data;
  sleep(60);
}

static void abort_child(int out, void *data) {
  (void)out, (void)data;
  abort();
}

static void test_child(void) {
  char hello[] = "hello";
  int end;
  GString *text = child_run(say_hello, hello, 10, &end);
  g_assert_cmpstr(text->str, ==, hello);
  g_assert_cmpint(end, ==, CHILD_ENDED);
  g_string_free(text, TRUE);
  g_string_free(child_run(sleep_long, NULL, 0.1, &end), TRUE);
  g_assert_cmpint(end, ==, CHILD_LATE);
  g_string_free(child_run(abort_child, NULL, 10, &end), TRUE);
  g_assert_cmpint(end, ==, SIGABRT);
}

/* A limit on the address space applies, and is named as the source. */
static void limit_memory(int out, void *data) {
  const rlim_t most = 3000000000;
  struct rlimit limit = {most, most};
  const char *source;
  setrlimit(RLIMIT_AS, &limit);
  double bytes = memory_free(&source);
  (void)data;
  if (bytes < 2e9 || !strstr(source, "(ulimit -v)")) source = "none";
  if (bytes > 3e9) source = "too much";
  process_write(out, source, strlen(source));
}

static void test_memory(void) {
  const char *source;
  int end;
  double before = memory_free(&source);
  g_assert_cmpfloat(before, >, 0);
#ifdef __SANITIZE_ADDRESS__
  before = 0; /* the address space of a sanitized process exceeds the limit */
#endif
  if (before < 4e9) {
    g_test_skip("less memory than the limit");
    return;
  }
  GString *text = child_run(limit_memory, NULL, 10, &end);
  g_assert_nonnull(strstr(text->str, "(ulimit -v)"));
  g_string_free(text, TRUE);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/guard/plugins", test_plugins);
  g_test_add_func("/guard/together", test_together);
  g_test_add_func("/guard/folder", test_folder);
  g_test_add_func("/guard/child", test_child);
  g_test_add_func("/guard/memory", test_memory);
  return g_test_run();
}
