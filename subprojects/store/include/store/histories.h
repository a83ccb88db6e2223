/* SPDX-License-Identifier: BSD-3-Clause */
/* How the results of a run's steps came to be. */
#pragma once

#include <glib.h>

/* How the result of a step came to be. */
typedef struct opc_history {
  size_t point; /* of a sweep, from 1; 0: of all */
  char *path;   /* of the step; in a flow that step 'a' runs: "a.step" */
  gboolean reused;
  char *key;      /* NULL: it is not kept */
  char *reason;   /* why it ran; NULL: it was reused */
  double seconds; /* of the run that made the result */
} opc_history;

/* The first 1000 of a run, and the number of all. */
typedef struct opc_histories {
  GPtrArray *list;     /* opc_history * */
  size_t done, reused; /* steps */
} opc_histories;

void opc_histories_init(opc_histories *histories);
void opc_histories_clear(opc_histories *histories);

/* Count a step, and keep a copy of its history if there is room. */
void opc_histories_add(opc_histories *histories, const opc_history *history);

/* Count those of another run, and put them first. */
void opc_histories_take(opc_histories *histories, const opc_histories *from);

/* Record that a step which had been reused ran after all. */
void opc_histories_rerun(opc_histories *histories, const char *path,
                         const char *reason, double seconds);
