/* SPDX-License-Identifier: BSD-3-Clause */
/* Helpers of plugins that fail at run time. BAD_ID is the id, BAD_FAULT the
   name of the fault ("none": no fault); without BAD_FAULT, evil.h selects
   one. */
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
static inline int does(const char *fault) { return !strcmp(BAD_FAULT, fault); }
#else
static inline int does(const char *fault) { return is_word("BAD_HOW", fault); }
#endif

static inline int descend(volatile int *depth) {
  volatile char room[4096] = {0};
  if (*depth < 0) return room[0];
  return descend(depth) + room[1];
}

static inline void write_wildly(void *data, size_t i) {
  (void)data;
  int *volatile nowhere = (int *)16;
  if (i == 7) *nowhere = 1;
}

/* Faults that any function of a plugin can have. */
static inline int misbehave(void) {
  volatile int depth = 0;
#ifndef BAD_FAULT
  return is_word("BAD_HOW", "atexit") ? OPC_FAILED : OPC_OK;
#endif
  if (does("loop")) be_for_ever();
  if (does("silent")) return OPC_FAILED;
  if (does("code")) return 42;
  if (does("cancel")) return OPC_CANCELLED;
  if (does("segv")) write_wildly(NULL, 7);
  if (does("thread")) opc_parallel(host->context, 100, write_wildly, NULL);
  if (does("stack")) return descend(&depth);
  if (does("bus")) raise(SIGBUS);
  if (does("fpe")) raise(SIGFPE);
  if (does("ill")) raise(SIGILL);
  if (does("abort")) raise(SIGABRT);
  return OPC_OK;
}

static int check(void *self, opc_error *error) {
  evil("check");
  (void)error;
  host = ((bad *)self)->host;
  if (does("check")) write_wildly(NULL, 7);
  return does("refuse") ? OPC_FAILED : OPC_OK;
}

static void clear(void *self) {
  evil("clear");
  (void)self;
  if (does("clear")) write_wildly(NULL, 7);
}

#define BAD_PLUGIN(KIND, FUNCTIONS)                                            \
  OPC_PLUGIN(bad, .id = BAD_ID, .kind = (KIND), .version = "1.0.0",            \
             .licence = "BSD-3-Clause", .summary = "Goes wrong while it runs", \
             .check = check, .clear = clear, OPC_FUNCTIONS(FUNCTIONS))

#endif
