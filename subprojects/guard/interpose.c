/* SPDX-License-Identifier: BSD-3-Clause */
/* Replaces functions of the C library that end the process or start a thread.
   The dynamic linker searches the command before the C library, so that calls
   by plugins reach these functions. Only the command contains them; other
   programs that use the kernel call the C library. */
#include <dlfcn.h>
#include <guard/guard.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

/* Find the definition of a function in the C library. `to` points to the
   function pointer to set. */
static void find_next(const char *name, void *to) {
  void *next = dlsym(RTLD_NEXT, name);
  memcpy(to, &next, sizeof next);
}

/* ---- end of the process ---- */

/* End the process with a function of the C library. The guard's own exit
   handlers (atexit) run later, within exit() and quick_exit(), when another
   thread could already have ended the process. Therefore guard_exit reports the
   plugin first. */
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

EXPORT _Noreturn void _Exit(int code) { process_leave("_Exit", code); }

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

/* Size of the inaccessible area below the stack of each thread, bytes; equal to
   the gap that Linux keeps below the stack of the first thread. A function with
   large local variables would skip the default area, one page, and write to
   memory of another thread. */
enum { GUARD = 1 << 20 };

/* Return a copy of `how` (NULL: default attributes) with an inaccessible area
   of at least GUARD bytes. */
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
