/* SPDX-License-Identifier: BSD-3-Clause */
/* What the plugins that go wrong while they run share. BAD_ID is the id of one,
   BAD_FAULT the word that says what it does wrong; "none" for nothing. */
#ifndef BAD_H
#define BAD_H

#include <math.h>
#include <opcflow/opcflow.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

static const opc_host *host;

static inline int does(const char *fault) { return !strcmp(BAD_FAULT, fault); }

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

/* What any function of a plugin can do wrong. */
static inline int misbehave(void) {
  volatile int depth = 0;
  if (does("loop")) {
    alarm(30); /* no longer if that is not ended, which fails the test */
    host->log(host, OPC_LOG_WARNING, "for ever");
    for (volatile int forever = 1; forever;) continue;
  }
  if (does("silent")) return OPC_FAILED;
  if (does("code")) return 42;
  if (does("cancel")) return OPC_CANCELLED;
  if (does("segv")) write_wildly(NULL, 7);
  if (does("thread")) host->parallel(host, 100, write_wildly, NULL);
  if (does("stack")) return descend(&depth);
  if (does("bus")) raise(SIGBUS);
  if (does("fpe")) raise(SIGFPE);
  if (does("ill")) raise(SIGILL);
  if (does("abort")) raise(SIGABRT);
  return OPC_OK;
}

static void *create(const opc_host *h, const opc_value *values,
                    opc_error *error) {
  (void)values, (void)error;
  host = h;
  if (does("create")) write_wildly(NULL, 7);
  if (does("refuse")) return NULL;
  return h->alloc(h, 1, 1);
}

static void destroy(void *self) { host->free(host, self); }

#define BAD_PLUGIN(KIND, OPERATIONS)                         \
  static const opc_plugin plugin = {                         \
      .size = sizeof plugin,                                 \
      .abi_major = OPC_ABI_MAJOR,                            \
      .abi_minor = OPC_ABI_MINOR,                            \
      .id = BAD_ID,                                          \
      .version = "1.0.0",                                    \
      .licence = "BSD-3-Clause",                             \
      .summary = "Goes wrong while it runs",                 \
      .kind = (KIND),                                        \
      .create = create,                                      \
      .destroy = destroy,                                    \
      .operations = &(OPERATIONS),                           \
  };                                                         \
  OPC_EXPORT const opc_plugin *opcflow_plugin(void);         \
  const opc_plugin *opcflow_plugin(void) { return &plugin; } \
  struct bad_semicolon

#endif
