/* SPDX-License-Identifier: BSD-3-Clause */
/* The host table that plugins call back. */
#pragma once

#include <opcflow/opcflow.h>

/* Receiver of the messages and progress of instances. log, progress and
   cancelled may be called from any thread; `path` is that of the instance
   ("first.model"). Functions may be NULL. */
typedef struct opc_watch {
  void *data;
  void (*log)(void *data, const char *path, int level, const char *message);
  void (*step)(void *data, const char *name, size_t number, size_t count);
  void (*progress)(void *data, const char *path, const opc_progress *progress);
  int (*cancelled)(void *data);
  /* Called when a point of a sweep begins; `number` counts from 1. */
  void (*point)(void *data, size_t number, size_t count);
} opc_watch;

/* Return a host for the instance of that path (opc_host_free). *watch (NULL:
   none) receives messages and progress. Published tables, metrics, output paths
   and services go to the functions of *like. Where *like has none, tables and
   metrics are ignored, output_path fails, and the pieces service runs pieces
   one after another. `path`, `watch` and `like` outlive the host. */
opc_host *opc_host_new(const char *path, const opc_watch *watch,
                       const opc_host *like);
/* Detach the host from the watch: no messages or progress from now on. */
void opc_host_ignore(opc_host *host);
void opc_host_free(opc_host *host);

/* Set the number of threads of opc_host.parallel; 0: one per processor. Call
   before the first parallel call. */
void opc_set_threads(unsigned n);
unsigned opc_threads(void);
