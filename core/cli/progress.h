/* SPDX-License-Identifier: BSD-3-Clause */
/* The line on a terminal that tells how far a run is. */
#pragma once

#include <glib.h>

#include "core/plugin/host.h"

typedef struct cli_progress {
  gboolean shown; /* whether to show it at all */
  int level;      /* OPC_LOG_*: the least that is told */
  GMutex lock;
  char *step;
  size_t number, count;
  size_t point, points; /* of a sweep; 0: none */
  gint64 began, last;   /* of the step, of the last line; us */
} cli_progress;

/* `shown` is left FALSE where standard error is no terminal. */
void cli_progress_start(cli_progress *progress, int level);
void cli_progress_end(cli_progress *progress);

/* The functions of an opc_watch whose data is a cli_progress. */
void cli_progress_log(void *data, const char *path, int level,
                      const char *message);
void cli_progress_step(void *data, const char *name, size_t number,
                       size_t count);
void cli_progress_point(void *data, size_t number, size_t count);
void cli_progress_show(void *data, const char *path,
                       const opc_progress *progress);
