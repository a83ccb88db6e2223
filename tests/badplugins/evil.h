/* SPDX-License-Identifier: BSD-3-Clause */
/* Faults that affect the whole process. The environment variable BAD_HOW has
   the name of the fault, and BAD_WHEN the function in which the fault
   occurs. */
#ifndef EVIL_H
#define EVIL_H

#include <err.h>
#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <math.h>
#include <opcflow/base.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static inline int is_word(const char *variable, const char *word) {
  const char *value = getenv(variable);
  return value && !strcmp(value, word);
}

static inline void *thread_crash(void *unused) {
  int *volatile nowhere = (int *)16;
  *nowhere = 1;
  return unused;
}

static inline void *end_process(void *unused) {
  exit(0);
  return unused;
}

/* Handlers for atexit. */
static inline void end_well(void) { _exit(0); }
static inline void end_badly(void) { thread_crash(NULL); }

static inline void in_thread(void *(*work)(void *)) {
  pthread_t thread;
  if (!pthread_create(&thread, NULL, work, NULL)) pthread_join(thread, NULL);
}

/* Simulate a stack overflow by a function with a large frame: the access is
   beyond the guard page, in the memory below. */
static inline void *step_over(void *unused) {
  enum { PAGE = 4096 };
  pthread_attr_t how;
  void *stack = NULL;
  size_t size;
  pthread_getattr_np(pthread_self(), &how);
  pthread_attr_getstack(&how, &stack, &size);
  char *below = (char *)stack - 100 * PAGE;
  void *page = mmap(below, PAGE, PROT_READ | PROT_WRITE,
                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
  if (page != MAP_FAILED) below = page;
  *(volatile char *)below = 1;
  return unused;
}

/* Crash in a thread, after the plugin's function has returned. */
static inline void *crash_later(void *data) {
  usleep(20000);
  return thread_crash(data);
}

static inline void leave_thread(void) {
  pthread_t thread;
  if (!pthread_create(&thread, NULL, crash_later, NULL)) pthread_detach(thread);
  /* Return while the thread runs. */
}

/* Use processor time for half a second, then sleep, because other tests run
   meanwhile. A process that is not killed within ten minutes fails the test. */
static inline void be_for_ever(void) {
  fputs("for ever\n", stderr);
  while (clock() < CLOCKS_PER_SEC / 2) continue;
  for (time_t end = time(NULL) + 600; time(NULL) < end;) usleep(1000);
  abort();
}

/* Change the folder in the first thread that calls. Other threads may call
   other plugins during that time. */
static inline void chdir_slowly(void) {
  static int taken;
  if (__atomic_exchange_n(&taken, 1, __ATOMIC_SEQ_CST)) return;
  if (chdir("/")) abort();
  usleep(300000);
}

static inline void signal_block(int number) {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, number);
  pthread_sigmask(SIG_BLOCK, &set, NULL);
}

static inline void flush_to_zero(void) {
#if defined(__x86_64__)
  __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | 0x8040);
#endif
}

static inline void be_evil(void) {
  const char *how = getenv("BAD_HOW");
  if (!how) return;
#define HOW(word) if (!strcmp(how, word))
  HOW("exit") exit(0);
  HOW("quick_exit") quick_exit(0);
  HOW("_exit") _exit(0);
  HOW("_Exit") _Exit(0);
  HOW("err") errx(0, "good bye");
  HOW("atexit") atexit(end_well);
  HOW("atexit crash") atexit(end_badly);
  HOW("pthread_exit") pthread_exit(NULL);
  HOW("abort") abort();
  HOW("trap") raise(SIGTRAP);
  HOW("segv") thread_crash(NULL);
  HOW("usr1") raise(SIGUSR1);
  HOW("pipe") raise(SIGPIPE);
  HOW("alarm") raise(SIGALRM);
  HOW("profile") raise(SIGPROF);
  HOW("timer") alarm(1);
  HOW("thread") in_thread(thread_crash);
  HOW("overflow") in_thread(step_over);
  HOW("thread_exit") in_thread(end_process);
  HOW("handler") signal(SIGSEGV, SIG_IGN);
  HOW("deaf") signal(SIGTERM, SIG_IGN);
  HOW("block") signal_block(SIGINT);
  HOW("chdir") if (chdir("/")) abort();
  HOW("chdir slowly") chdir_slowly();
  HOW("rounding") fesetround(FE_UPWARD);
  HOW("flush") flush_to_zero();
  HOW("unmask") feenableexcept(FE_DIVBYZERO);
  HOW("locale") setlocale(LC_NUMERIC, "C.UTF-8");
  HOW("uselocale") uselocale(newlocale(LC_ALL_MASK, "C.UTF-8", (locale_t)0));
  HOW("umask") umask(0777);
  HOW("stdin") close(STDIN_FILENO);
  HOW("stdout") close(STDOUT_FILENO);
  HOW("stderr") if (!freopen("/dev/null", "w", stderr)) abort();
  HOW("close") close_range(0, ~0U, 0);
  HOW("execve") execve("/bin/true", (char *[]){"true", NULL}, environ);
  HOW("execl") execl("/bin/true", "true", NULL);
  HOW("fork") if (fork()) _exit(0); /* the child continues */
  HOW("hang") be_for_ever();
  HOW("hang aside") {
    if (gettid() != getpid()) be_for_ever();
    usleep(200000); /* lets another thread begin */
  }
  HOW("print") {
    printf("{ \"evil\": 1 }\n");
    fflush(stdout);
    if (write(STDOUT_FILENO, "not JSON\n", 9) < 0) abort();
  }
#undef HOW
}

/* Apply the selected fault at the beginning of the function `when`. A plugin
   with BAD_FAULT has only that fault. */
static inline void evil(const char *when) {
#ifdef BAD_FAULT
  (void)when;
#else
  if (is_word("BAD_WHEN", when)) be_evil();
#endif
}

#endif
