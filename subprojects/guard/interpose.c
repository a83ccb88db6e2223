/* SPDX-License-Identifier: BSD-3-Clause */
/* Functions of the C library that plugins find here first, as they look into
   the command before it. They are the command's alone: programs that are linked
   to the kernel keep their own. */
#include <dlfcn.h>
#include <guard/guard.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

/* The next one of that name, as a pointer to a function: `to` points to it. */
static void find_next(const char *name, void *to) {
  void *next = dlsym(RTLD_NEXT, name);
  memcpy(to, &next, sizeof next);
}

/* ---- the end ---- */

/* The guard hears of exit() and quick_exit() by itself as well, from within the
   C library; but while one thread is there, another one could end the process.
 */
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

/* A thread that a plugin starts is in that plugin. */
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

/* Guard below the stack of each thread, bytes, as Linux keeps below the first
   thread's. A function with much on the stack would step over the usual page,
   into memory of another thread. */
enum { GUARD = 1 << 20 };

/* As `how`, which may be NULL, with that guard. */
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
