/* SPDX-License-Identifier: BSD-3-Clause */
/* Result codes, errors, threads, and modules (objects with their functions).
   The core and the library eda, which do not depend on each other, share these
   types. A plugin is a shared object; the host is the program that loads
   plugins (plugin.h). [any]: may be called from several threads at once. */
#pragma once

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Enclose the declarations of a header, so that C++ can include the header. */
#ifdef __cplusplus
#define OPC_C_BEGIN extern "C" {
#define OPC_C_END }
#else
#define OPC_C_BEGIN
#define OPC_C_END
#endif

OPC_C_BEGIN

/* Attributes: exported function; function with a format as printf; function
   that a file may leave unused. */
#if defined(__GNUC__)
#define OPC_EXPORT __attribute__((visibility("default")))
#define OPC_PRINTF(f, a) __attribute__((format(printf, f, a)))
#define OPC_UNUSED __attribute__((unused))
#else
#define OPC_EXPORT
#define OPC_PRINTF(f, a)
#define OPC_UNUSED
#endif

/* Marks the end of each struct to which later versions may add fields without
   breaking older binaries. Empty unless a test defines the mark as a field. */
#ifndef OPC_MAY_GROW
#define OPC_MAY_GROW
#endif

/* Result codes. The command maps these codes to exit codes. */
enum {
  OPC_OK = 0,
  OPC_INVALID = 1,   /* a parameter or an input is not valid: exit 2 */
  OPC_FAILED = 2,    /* the operation failed: exit 4 */
  OPC_IO = 3,        /* a file could not be read or written: exit 5 */
  OPC_NO_PLUGIN = 4, /* a plugin is missing or incompatible: exit 3 */
  OPC_LIMIT = 5,     /* a result does not meet a requirement: exit 1 */
  OPC_CANCELLED = 6  /* stopped by the user: exit 130 */
};

/* Description of a failure. A function whose last argument is an `opc_error *`
   can fail. The function returns one of the codes above, or a pointer that is
   NULL on failure, and then fills *error. The argument must not be NULL. */
typedef struct opc_error {
  int32_t code;       /* OPC_INVALID ... */
  char parameter[64]; /* name of the parameter at fault, or empty */
  char message[956];  /* fault, place, found and expected value */
} opc_error;

/* Fill *error and return `code`: `return opc_fail(error, OPC_FAILED, NULL,
   "...")`. `parameter` may be NULL. Long texts are truncated. [any] */
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

/* Services that the program provides to the libraries and plugins that it
   calls: threads, cancellation, and the attribution of crashes to plugins. A
   NULL context means one thread and no cancellation. All functions are [any].
 */
typedef struct opc_context opc_context;
struct opc_context {
  /* Call task(data, i) for each i below n, from several threads at once; return
     when all calls have returned. Results must not depend on the number of
     threads, so do not derive n from that number. Calls may be nested. */
  void (*parallel)(const opc_context *context, size_t n,
                   void (*task)(void *data, size_t i), void *data);

  /* Return non-zero after a request to stop. The caller then frees its data and
     returns OPC_CANCELLED. */
  int (*cancelled)(const opc_context *context);

  /* Enclose each call of a function of another module, so that the host
     attributes a crash to that module: `before = enter(context, id); ...;
     leave(context, before)`. `id` must outlive the call. */
  const char *(*enter)(const opc_context *context, const char *id);
  void (*leave)(const opc_context *context, const char *before);
  OPC_MAY_GROW
};

/* Call context->parallel; without a context, call the tasks one after another.
 */
OPC_UNUSED static inline void opc_parallel(const opc_context *context, size_t n,
                                           void (*task)(void *data, size_t i),
                                           void *data) {
  size_t i;
  if (context)
    context->parallel(context, n, task, data);
  else
    for (i = 0; i < n; i++) task(data, i);
}

/* Call context->cancelled; without a context, return 0. */
OPC_UNUSED static inline int opc_cancelled(const opc_context *context) {
  return context && context->cancelled(context);
}

/* Call context->enter and context->leave; without a context, do nothing. */
OPC_UNUSED static inline const char *opc_enter(const opc_context *context,
                                               const char *id) {
  return context ? context->enter(context, id) : NULL;
}
OPC_UNUSED static inline void opc_leave(const opc_context *context,
                                        const char *before) {
  if (context) context->leave(context, before);
}

/* An instance of a plugin, together with the functions that act on the
   instance. The header of a plugin kind declares these functions as a struct of
   function pointers. Pass `self` as the first argument of each. */
typedef struct opc_module {
  const void *functions; /* struct of the kind, such as eda_litho */
  void *self;            /* instance of the plugin */
  const char *id;        /* id of the plugin: "litho.hopkins" */
} opc_module;

OPC_C_END
