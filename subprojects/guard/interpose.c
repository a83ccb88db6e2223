/* SPDX-License-Identifier: BSD-3-Clause */
/* Replaces functions of the C library that end the process or start a thread.
   The dynamic linker searches the command before the C library, so that plugins
   call these functions. Only the command contains these functions; other
   programs that link opcflow's libraries do not. */
#include <dlfcn.h>
#include <errno.h>
#include <guard/guard.h>
#include <guard/process.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

/* Find the definition of a function in the C library. `to` points to the
   function pointer to set. */
static void find_next(const char *name, void *to) {
  void *next = dlsym(RTLD_NEXT, name);
  memcpy(to, &next, sizeof next);
}

/* ---- end of the process ---- */

/* End the process by a function of the C library. guard_exit reports the plugin
   first: the guard's exit handlers (atexit) run later, when another thread may
   already have ended the process. */
_Noreturn static void process_leave(const char *name, int code) {
  void (*next)(int);
  guard_exit();
  find_next(name, &next);
  next(guard_code(code));
  abort();
}

EXPORT _Noreturn void exit(int code) { process_leave("exit", code); }

EXPORT _Noreturn void quick_exit(int code) {
  process_leave("quick_exit", code);
}

EXPORT _Noreturn void _exit(int code) { process_leave("_exit", code); }

/* daemon() ends the process by an internal call of _exit. */
EXPORT int daemon(int folder, int streams) {
  int (*next)(int, int);
  guard_exit();
  find_next("daemon", &next);
  return next(folder, streams);
}

EXPORT _Noreturn void _Exit(int code) { process_leave("_Exit", code); }

/* ---- another program in this process ---- */

/* A plugin that calls a function of the exec family would end the run with the
   exit code of another program. A forked child may call the exec functions. The
   C library's functions are looked up at start, because dlsym() can block in a
   child, and in a thread while another thread loads a plugin. */
typedef int exec_path(const char *, char *const[]);
typedef int exec_environment(const char *, char *const[], char *const[]);

static struct {
  exec_path *execv, *execvp;
  exec_environment *execve, *execvpe;
  int (*fexecve)(int, char *const[], char *const[]);
  int (*execveat)(int, const char *, char *const[], char *const[], int);
} next_exec;

static int (*next_system)(const char *);

__attribute__((constructor)) static void exec_find(void) {
  find_next("system", &next_system);
  find_next("execv", &next_exec.execv);
  find_next("execvp", &next_exec.execvp);
  find_next("execve", &next_exec.execve);
  find_next("execvpe", &next_exec.execvpe);
  find_next("fexecve", &next_exec.fexecve);
  find_next("execveat", &next_exec.execveat);
}

EXPORT int execv(const char *path, char *const words[]) {
  guard_exit();
  return next_exec.execv(path, words);
}

EXPORT int execvp(const char *file, char *const words[]) {
  guard_exit();
  return next_exec.execvp(file, words);
}

EXPORT int execve(const char *path, char *const words[],
                  char *const environment[]) {
  guard_exit();
  return next_exec.execve(path, words, environment);
}

EXPORT int execvpe(const char *file, char *const words[],
                   char *const environment[]) {
  guard_exit();
  return next_exec.execvpe(file, words, environment);
}

EXPORT int fexecve(int file, char *const words[], char *const environment[]) {
  guard_exit();
  return next_exec.fexecve(file, words, environment);
}

EXPORT int execveat(int folder, const char *path, char *const words[],
                    char *const environment[], int flags) {
  guard_exit();
  return next_exec.execveat(folder, path, words, environment, flags);
}

/* Collect the words of execl() and its variants. Return E2BIG, as the system
   does, if there are more than MAX_WORDS. */
enum { MAX_WORDS = 1024 };
static int words_collect(const char *first, va_list more, char **words) {
  int n = 0;
  for (const char *w = first; w && n < MAX_WORDS; w = va_arg(more, char *))
    memcpy(&words[n++], &w, sizeof w);
  words[n] = NULL;
  return n < MAX_WORDS ? 0 : E2BIG;
}

/* Define execl() and its variants by a function of an array of words. */
#define EXEC_LIST(name, call)                             \
  EXPORT int name(const char *path, const char *w, ...) { \
    char *words[MAX_WORDS + 1];                           \
    va_list more;                                         \
    guard_exit();                                         \
    va_start(more, w);                                    \
    errno = words_collect(w, more, words);                \
    int code = errno ? -1 : (call);                       \
    va_end(more);                                         \
    return code;                                          \
  }
EXEC_LIST(execl, next_exec.execv(path, words))
EXEC_LIST(execlp, next_exec.execvp(path, words))
EXEC_LIST(execle, next_exec.execve(path, words, va_arg(more, char **)))

/* ---- signals ---- */

/* A sanitizer calls this function before constructors run. */
EXPORT int sigaltstack(const stack_t *stack, stack_t *before) {
  if (stack) guard_stack_check();
  int code = (int)syscall(SYS_sigaltstack, stack, before);
  if (!code && stack && stack->ss_flags & SS_DISABLE) guard_stack_give();
  return code;
}

/* system() ignores SIGINT while the command runs. */
EXPORT int system(const char *command) {
  process_ignores_interrupt(1);
  int code = next_system(command);
  process_ignores_interrupt(-1);
  return code;
}

/* ---- threads ---- */

/* Arguments of a new thread, and the plugin that starts the thread. The guard
   attributes all work of the thread to that plugin. */
typedef struct beginning {
  void *(*work)(void *);
  void *data;
  const char *inside;
} beginning;

static void *thread_begin(void *data) {
  beginning b = *(beginning *)data;
  free(data);
  guard_adopt(b.inside);
  return b.work(b.data);
}

/* Size of the inaccessible area below the stack of each thread, bytes, as Linux
   keeps below the stack of the first thread. With the default area of one page,
   a function with large local variables would write to memory of another
   thread. */
enum { GUARD = 1 << 20 };

/* Return a copy of `how`, or of the default attributes if NULL, with an
   inaccessible area of at least GUARD bytes. */
static pthread_attr_t attributes_guarded(const pthread_attr_t *how) {
  pthread_attr_t own;
  size_t guard = 0;
  if (how)
    own = *how;
  else
    pthread_attr_init(&own);
  pthread_attr_getguardsize(&own, &guard);
  if (guard < GUARD) pthread_attr_setguardsize(&own, GUARD);
  return own;
}

EXPORT int pthread_create(pthread_t *thread, const pthread_attr_t *how,
                          void *(*work)(void *), void *data) {
  int (*next)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);
  find_next("pthread_create", &next);
  const pthread_attr_t own = attributes_guarded(how);
  const char *inside = guard_inside();
  beginning *b = inside ? malloc(sizeof *b) : NULL;
  if (!b) return next(thread, &own, work, data);
  *b = (beginning){work, data, inside};
  int code = next(thread, &own, thread_begin, b);
  if (code) free(b);
  return code;
}
