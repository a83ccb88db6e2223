/* SPDX-License-Identifier: BSD-3-Clause */
/* The progress line of a run on a terminal, and the lines of its steps. */
#pragma once

#include <glib.h>

#include "core/plugin/host.h"

/* State of the progress line. */
typedef struct cli_progress {
  gboolean shown; /* print the progress line */
  gboolean steps; /* print a line for each step of a second or more */
  int level;      /* lowest OPC_LOG_* level printed */
  GMutex lock;
  char *step;           /* name of the running step */
  size_t number, count; /* number of the step from 1; number of steps */
  size_t point, points; /* point and points of a sweep, or 0 */
  gint64 began, last;   /* start of the step; time of the last line; us */
} cli_progress;

/* Initialize. `steps`: report steps and progress; `shown` stays FALSE if
   standard error is no terminal. cli_progress_end: remove the status line. */
void cli_progress_start(cli_progress *progress, int level, gboolean steps);
void cli_progress_end(cli_progress *progress);

/* Functions for an opc_watch whose data is a cli_progress. */
void cli_progress_log(void *data, const char *path, int level,
                      const char *message);
void cli_progress_step(void *data, const char *name, size_t number,
                       size_t count);
void cli_progress_point(void *data, size_t number, size_t count);
void cli_progress_show(void *data, const char *path,
                       const opc_progress *progress);
