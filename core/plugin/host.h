/* SPDX-License-Identifier: BSD-3-Clause */
/* Hosts: the functions that plugins call (opc_host). */
#pragma once

#include <opcflow/opcflow.h>

/* Functions that receive messages and progress of instances; each may be NULL.
   log, progress and cancelled may be called from any thread. `path` is the path
   of the instance, "first.model". */
typedef struct opc_watch {
  void *data;
  void (*log)(void *data, const char *path, int level, const char *message);
  void (*step)(void *data, const char *name, size_t number, size_t count);
  void (*progress)(void *data, const char *path, const opc_progress *progress);
  int (*cancelled)(void *data);
  /* Called when a point of a sweep begins; `number` counts from 1. */
  void (*point)(void *data, size_t number, size_t count);
} opc_watch;

/* Return a host for the instance at `path` (opc_host_free). *watch, unless
   NULL, receives messages and progress. The functions table, metric,
   output_path and service call those of *like. If *like lacks a function,
   tables and metrics are ignored, output_path fails, and work units run in this
   process. `path`, `watch` and `like` outlive the host. */
opc_host *opc_host_new(const char *path, const opc_watch *watch,
                       const opc_host *like);
/* Detach the host from the watch, which receives nothing more. */
void opc_host_ignore(opc_host *host);
/* Free the host. */
void opc_host_free(opc_host *host);

/* Set the number of threads of opc_host.parallel; 0 for one per processor. Call
   before the first parallel call. opc_threads: return the number. */
void opc_set_threads(unsigned n);
unsigned opc_threads(void);
