/* SPDX-License-Identifier: BSD-3-Clause */
/* Helpers of plugins that fail at run time. BAD_ID is the id, BAD_FAULT the
   name of the fault, or "none". Without BAD_FAULT, evil.h selects a fault. */
#ifndef BAD_H
#define BAD_H

#include <eda/eda.h>
#include <math.h>
#include <opcflow/opcflow.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "evil.h"

typedef struct bad {
  const opc_host *host;
} bad;

static const opc_host *host;

#ifdef BAD_FAULT
static inline int fault_is(const char *fault) {
  return !strcmp(BAD_FAULT, fault);
}
#else
static inline int fault_is(const char *fault) {
  return is_word("BAD_HOW", fault);
}
#endif

static inline int stack_descend(volatile int *depth) {
  volatile char capacity[4096] = {0};
  if (*depth < 0) return capacity[0];
  return stack_descend(depth) + capacity[1];
}

static inline void write_wildly(void *data, size_t i) {
  (void)data;
  int *volatile nowhere = (int *)16;
  if (i == 7) *nowhere = 1;
}

/* Write 1 to an array of the present call, `n` elements beyond the end, or to
   the array of an earlier call. */
#define WRITE_AFAR(array, n)                      \
  do {                                            \
    static __typeof__(&*(array)) kept;            \
    if (fault_is("far")) (array)[(n) + 5000] = 1; \
    if (fault_is("before")) (array)[-5000] = 1;   \
    if (fault_is("kept") && kept) *kept = 1;      \
    kept = (array);                               \
  } while (0)

/* Overwrite the size that the heap keeps before a block, which the host or
   another plugin frees later. */
static inline void heap_damage(const void *block) {
  ((volatile size_t *)(uintptr_t)block)[-1] = 7;
}

/* Faults that any function of a plugin can have. */
static inline int fault_apply(void) {
  volatile int depth = 0;
#ifndef BAD_FAULT
  return is_word("BAD_HOW", "atexit") ? OPC_FAILED : OPC_OK;
#endif
  if (fault_is("loop")) be_for_ever();
  if (fault_is("silent")) return OPC_FAILED;
  if (fault_is("code")) return 42;
  if (fault_is("cancel")) return OPC_CANCELLED;
  if (fault_is("segv")) write_wildly(NULL, 7);
  if (fault_is("thread")) opc_parallel(host->context, 100, write_wildly, NULL);
  if (fault_is("stack")) return stack_descend(&depth);
  if (fault_is("bus")) raise(SIGBUS);
  if (fault_is("fpe")) raise(SIGFPE);
  if (fault_is("ill")) raise(SIGILL);
  if (fault_is("abort")) raise(SIGABRT);
  return OPC_OK;
}

static int bad_check(void *self, opc_error *error) {
  evil("check");
  (void)error;
  host = ((bad *)self)->host;
  if (fault_is("check")) write_wildly(NULL, 7);
  return fault_is("refuse") ? OPC_FAILED : OPC_OK;
}

static void bad_clear(void *self) {
  evil("clear");
  (void)self;
  if (fault_is("clear")) write_wildly(NULL, 7);
}

#define BAD_PLUGIN(KIND, FUNCTIONS)                                 \
  OPC_PLUGIN(bad, .id = BAD_ID, .kind = (KIND), .version = "1.0.0", \
             .licence = "BSD-3-Clause",                             \
             .summary = "Plugin with a fault in a function",        \
             .check = bad_check, .clear = bad_clear, OPC_FUNCTIONS(FUNCTIONS))

#endif
