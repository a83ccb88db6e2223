/* SPDX-License-Identifier: BSD-3-Clause */
/* The host table that plugins call back through. */
#ifndef OPCFLOW_CORE_HOST_H
#define OPCFLOW_CORE_HOST_H

#include <opcflow/opcflow.h>

/* Where a host sends what its functions say. Any function may be NULL: the
   call is then ignored (table, metric) or refused (output_path). */
typedef struct opc_sink {
  void *data;
  void (*log)(void *data, int level, const char *message);
  void (*progress)(void *data, const opc_progress *progress);
  int (*cancelled)(void *data);
  int (*table)(void *data, const char *name, uint32_t flags, size_t rows,
               const opc_column *columns, size_t n_columns, opc_error *error);
  int (*metric)(void *data, const char *name, double value, opc_error *error);
  const char *(*output_path)(void *data, const char *name, opc_error *error);
} opc_sink;

/* A host that reports to *sink, which outlives it. NULL: to nowhere. */
opc_host *opc_host_new(const opc_sink *sink);
void opc_host_free(opc_host *host);

/* How many threads opc_host.parallel uses; 0 for as many as there are
   processors. Before the first parallel call. */
void opc_set_threads(unsigned n);
unsigned opc_threads(void);

#endif
