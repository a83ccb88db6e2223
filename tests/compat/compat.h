/* SPDX-License-Identifier: BSD-3-Clause */
/* What the plugins of this folder share. They are kept as binaries: changing
   their sources changes nothing before build.sh is run, which is to be done for
   a new major of the interface only. */
#ifndef COMPAT_H
#define COMPAT_H

#include <opcflow/opcflow.h>

typedef struct compat {
  const opc_host *host;
  const opc_value *values;
} compat;

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  compat *c = host->alloc(host, 1, sizeof *c);
  if (!c) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  c->host = host;
  c->values = values;
  return c;
}

static void destroy(void *self) {
  compat *c = self;
  c->host->free(c->host, c);
}

#define COMPAT_PLUGIN(ID, KIND, ...)                         \
  static const opc_plugin plugin = {                         \
      .size = sizeof plugin,                                 \
      .abi_major = OPC_ABI_MAJOR,                            \
      .abi_minor = OPC_ABI_MINOR,                            \
      .id = ID,                                              \
      .version = "1.0.0",                                    \
      .licence = "BSD-3-Clause",                             \
      .summary = "built once and kept",                      \
      .kind = (KIND),                                        \
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,            \
      .create = create,                                      \
      .destroy = destroy,                                    \
      .operations = &operations,                             \
      __VA_ARGS__};                                          \
  OPC_EXPORT const opc_plugin *opcflow_plugin(void);         \
  const opc_plugin *opcflow_plugin(void) { return &plugin; } \
  struct compat_semicolon

#endif
