/* SPDX-License-Identifier: BSD-3-Clause */
/* The host table that plugins call back through. */
#pragma once

#include <opcflow/opcflow.h>

/* Who looks on while instances work. log, progress and cancelled may come from
   any thread; `path` is that of the instance ("first.model"). Functions may be
   NULL. */
typedef struct opc_watch {
  void *data;
  void (*log)(void *data, const char *path, int level, const char *message);
  void (*step)(void *data, const char *name, size_t number, size_t count);
  void (*progress)(void *data, const char *path, const opc_progress *progress);
  int (*cancelled)(void *data);
  /* Of a sweep: the point that begins, from 1. */
  void (*point)(void *data, size_t number, size_t count);
} opc_watch;

/* A host for the instance of that path, which tells *watch (NULL: nobody). What
   it publishes goes to the functions table, metric and output_path of *like,
   and services are those of that; where there are none, the first two are
   ignored, no path is given, and pieces are done one after another. All three
   outlive it. */
opc_host *opc_host_new(const char *path, const opc_watch *watch,
                       const opc_host *like);
/* From now on it tells nobody. */
void opc_host_ignore(opc_host *host);
void opc_host_free(opc_host *host);

/* How many threads opc_host.parallel uses; 0 for as many as there are
   processors. Before the first parallel call. */
void opc_set_threads(unsigned n);
unsigned opc_threads(void);
