/* SPDX-License-Identifier: BSD-3-Clause */
/* Records the state of the process, and finds changes. */
#include <guard/process.h>

#include <errno.h>
#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

enum {
  STREAMS = 3,
  SIGNALS = 20,         /* at least as many as process_signals has */
  LONGEST_LOCALE = 512, /* "LC_CTYPE=...;LC_NUMERIC=...", all categories */
  FIRST_OWN = 100       /* first descriptor of the guard; lower descriptors are
                           left to plugins */
};

const process_signal process_signals[] = {
    {SIGSEGV, "SIGSEGV", "segmentation fault"},
    {SIGBUS, "SIGBUS", "bus error"},
    {SIGFPE, "SIGFPE", "arithmetic error"},
    {SIGILL, "SIGILL", "illegal instruction"},
    {SIGABRT, "SIGABRT", "aborted"},
    {SIGTRAP, "SIGTRAP", "trap"},
    {SIGSYS, "SIGSYS", "bad system call"},
    {SIGPIPE, "SIGPIPE", "broken pipe"},
    {SIGALRM, "SIGALRM", "alarm"},
    {SIGVTALRM, "SIGVTALRM", "alarm"},
    {SIGPROF, "SIGPROF", "alarm"},
    {SIGPOLL, "SIGPOLL", "input or output"},
    {SIGUSR1, "SIGUSR1", "user signal 1"},
    {SIGUSR2, "SIGUSR2", "user signal 2"},
    {SIGHUP, "SIGHUP", NULL},
    {SIGINT, "SIGINT", NULL},
    {SIGTERM, "SIGTERM", NULL},
    {0, NULL, NULL}};

/* ---- the present state ---- */

typedef struct place {
  dev_t device;
  ino_t number;
} place;

typedef struct state {
  place folder, stream[STREAMS];
  void (*handler[SIGNALS])(int);
  char locale[LONGEST_LOCALE];
  mode_t modes;     /* umask */
  uint64_t blocked; /* signals 1 to 31 */
  uint32_t numbers; /* floating-point control */
} state;

static state settled;
static int folder = -1, voice = -1;

/* Return the device and inode of a file; zeros if `code` reports a failure. */
static place place_of(const struct stat *s, int code) {
  return code ? (place){0, 0} : (place){s->st_dev, s->st_ino};
}

static int places_differ(place a, place b) {
  return a.device != b.device || a.number != b.number;
}

static place folder_now(void) {
  struct stat s;
  int code = stat(".", &s);
  return place_of(&s, code);
}

static place stream_now(int i) {
  struct stat s;
  int code = fstat(i, &s);
  return place_of(&s, code);
}

static void (*handler_now(int number))(int) {
  struct sigaction action;
  sigaction(number, NULL, &action);
  return action.sa_handler; /* union with sa_sigaction */
}

static uint64_t blocked_now(void) {
  sigset_t set;
  uint64_t bits = 0;
  pthread_sigmask(SIG_SETMASK, NULL, &set);
  for (const process_signal *s = process_signals; s->number; s++)
    if (sigismember(&set, s->number) == 1) bits |= UINT64_C(1) << s->number;
  return bits;
}

/* Return the floating-point control word, without exception flags. */
static uint32_t numbers_now(void) {
#if defined(__x86_64__)
  uint16_t x87;
  __asm__ volatile("fnstcw %0" : "=m"(x87));
  return (__builtin_ia32_stmxcsr() & ~0x3fu) | (uint32_t)x87 << 16;
#else
  return (uint32_t)fegetround() | (uint32_t)fegetexcept() << 16;
#endif
}

void process_settle(void) {
  if (folder < 0) {
    int here = open(".", O_PATH | O_DIRECTORY | O_CLOEXEC);
    folder = fcntl(here, F_DUPFD_CLOEXEC, FIRST_OWN);
    voice = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, FIRST_OWN);
    if (here >= 0) close(here);
  }
  settled.folder = folder_now();
  for (int i = 0; i < STREAMS; i++) settled.stream[i] = stream_now(i);
  for (int i = 0; process_signals[i].number; i++)
    settled.handler[i] = handler_now(process_signals[i].number);
  snprintf(settled.locale, sizeof settled.locale, "%s",
           setlocale(LC_ALL, NULL));
  settled.modes = umask(077);
  umask(settled.modes);
  settled.blocked = blocked_now();
  settled.numbers = numbers_now();
}

/* ---- changes ---- */

static const char *stream_change(void) {
  static const char *const names[STREAMS] = {
      "closed or redirected standard input",
      "closed or redirected standard output",
      "closed or redirected standard error"};
  for (int i = 0; i < STREAMS; i++)
    if (places_differ(stream_now(i), settled.stream[i])) return names[i];
  return NULL;
}

const char *process_thread_change(void) {
  if (numbers_now() != settled.numbers)
    return "changed the floating-point rounding, flush-to-zero or trap mode";
  return uselocale((locale_t)0) == LC_GLOBAL_LOCALE ? NULL
                                                    : "changed the locale";
}

int process_signals_change(void) { return blocked_now() != settled.blocked; }

/* Return whether a timer is set. The signal of the timer would interrupt
   another plugin. */
static int has_alarm(void) {
  struct itimerval left;
  getitimer(ITIMER_REAL, &left);
  return left.it_value.tv_sec || left.it_value.tv_usec;
}

/* Number of threads in system(), and number of calls of system(). */
static unsigned interrupts_ignored, ignored_calls;

void process_ignores_interrupt(int more) {
  if (more > 0) __atomic_add_fetch(&ignored_calls, 1, __ATOMIC_SEQ_CST);
  __atomic_add_fetch(&interrupts_ignored, (unsigned)more, __ATOMIC_SEQ_CST);
}

/* Return whether the handler of signal i has changed, except by system(). */
static int handler_changed(int i) {
  unsigned before = __atomic_load_n(&ignored_calls, __ATOMIC_SEQ_CST);
  unsigned ignored = __atomic_load_n(&interrupts_ignored, __ATOMIC_SEQ_CST);
  if (handler_now(process_signals[i].number) == settled.handler[i]) return 0;
  return process_signals[i].number != SIGINT ||
         (!ignored &&
          before == __atomic_load_n(&ignored_calls, __ATOMIC_SEQ_CST));
}

const char *process_change(const char **detail) {
  *detail = "";
  if (strncmp(setlocale(LC_ALL, NULL), settled.locale, LONGEST_LOCALE - 1) != 0)
    return "changed the locale";
  for (int i = 0; process_signals[i].number; i++)
    if (handler_changed(i)) {
      *detail = process_signals[i].name;
      return "changed the handler of ";
    }
  if (places_differ(folder_now(), settled.folder))
    return "changed the working folder";
  /* umask() can only be read by setting it. Setting the recorded value does not
     affect other threads. */
  if (umask(settled.modes) != settled.modes)
    return "changed the modes of new files";
  if (has_alarm()) return "left an alarm set";
  return stream_change();
}

int process_folder(void) {
  return fcntl(folder, F_GETFD) < 0 ? AT_FDCWD : folder;
}

void process_write(int out, const char *bytes, size_t n) {
  for (size_t done = 0; done < n;) {
    ssize_t k = write(out, bytes + done, n - done);
    if (k < 0 && errno != EINTR) return;
    if (k > 0) done += (size_t)k;
  }
}

void process_say(const char *text) {
  int out = fcntl(voice, F_GETFD) < 0 ? STDERR_FILENO : voice;
  process_write(out, text, strlen(text));
}
