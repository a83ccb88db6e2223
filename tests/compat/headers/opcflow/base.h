/* SPDX-License-Identifier: BSD-3-Clause */
/* Result codes, errors, threads, and an object with its functions. The headers
   of the kernel and those of the library eda include this file, so that their
   errors are of one type although neither knows the other. */
#ifndef OPC_BASE_H
#define OPC_BASE_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define OPC_EXPORT __attribute__((visibility("default")))
#define OPC_PRINTF(f, a) __attribute__((format(printf, f, a)))
#define OPC_UNUSED __attribute__((unused))
#else
#define OPC_EXPORT
#define OPC_PRINTF(f, a)
#define OPC_UNUSED
#endif

/* Stands before the end of each struct that may get more fields there without
   breaking anything that was built before. */
#ifndef OPC_MAY_GROW
#define OPC_MAY_GROW
#endif

/* Result codes. The command maps them to its exit codes. */
enum {
  OPC_OK = 0,
  OPC_INVALID = 1,   /* a parameter or an input does not make sense: exit 2 */
  OPC_FAILED = 2,    /* the work could not be done: exit 4 */
  OPC_IO = 3,        /* a file could not be read or written: exit 5 */
  OPC_NO_PLUGIN = 4, /* a plugin is missing or incompatible: exit 3 */
  OPC_LIMIT = 5,     /* a limit was not kept: exit 1 */
  OPC_CANCELLED = 6  /* the user stopped it: exit 4 */
};

/* Why a function failed. A function that can fail returns one of the codes
   above and fills the `opc_error *` that is its last argument, which is never
   NULL. `parameter` names the parameter at fault, or is empty. */
typedef struct opc_error {
  int32_t code;
  char parameter[64];
  char message[956];
} opc_error;

/* Fill *error and return `code`: `return opc_fail(error, OPC_FAILED, NULL,
   "...")`. `parameter` may be NULL. Texts that are too long are cut. [any] */
OPC_UNUSED OPC_PRINTF(4, 5) static int opc_fail(opc_error *error, int code,
                                                const char *parameter,
                                                const char *format, ...) {
  va_list arguments;
  error->code = code;
  snprintf(error->parameter, sizeof error->parameter, "%s",
           parameter ? parameter : "");
  va_start(arguments, format);
  vsnprintf(error->message, sizeof error->message, format, arguments);
  va_end(arguments);
  return code;
}

/* What a library may ask of the program it works in. NULL in place of a
   context: one thread, never cancelled. All functions are [any]. */
typedef struct opc_context opc_context;
struct opc_context {
  /* Call task(data, i) for each i below n, from several threads at once; all
     are done when it returns. Cut the work by its content, never by the number
     of threads, and no result will depend on it. May be nested. */
  void (*parallel)(const opc_context *context, size_t n,
                   void (*task)(void *data, size_t i), void *data);

  /* Non-zero once the user wants to stop: clean up, return OPC_CANCELLED. */
  int (*cancelled)(const opc_context *context);

  /* Around each call of another module's function, so that a crash is told to
     be that module's: `before = enter(context, id); ...; leave(context,
     before)`. `id` outlives the call. */
  const char *(*enter)(const opc_context *context, const char *id);
  void (*leave)(const opc_context *context, const char *before);
  OPC_MAY_GROW
};

OPC_UNUSED static inline void opc_parallel(const opc_context *context, size_t n,
                                           void (*task)(void *data, size_t i),
                                           void *data) {
  size_t i;
  if (context)
    context->parallel(context, n, task, data);
  else
    for (i = 0; i < n; i++) task(data, i);
}

OPC_UNUSED static inline int opc_cancelled(const opc_context *context) {
  return context && context->cancelled(context);
}

OPC_UNUSED static inline const char *opc_enter(const opc_context *context,
                                               const char *id) {
  return context ? context->enter(context, id) : NULL;
}

OPC_UNUSED static inline void opc_leave(const opc_context *context,
                                        const char *before) {
  if (context) context->leave(context, before);
}

/* An object of some kind: what it can do, and what it works on. The functions
   of a kind are a struct that the kind's header declares; each takes `self`
   first. */
typedef struct opc_module {
  const void *functions;
  void *self;
  const char *id; /* of its plugin: "litho.hopkins" */
} opc_module;

#ifdef __cplusplus
}
#endif
#endif
