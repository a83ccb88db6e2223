/* SPDX-License-Identifier: BSD-3-Clause */
/* Histories: for each step of a run, whether its result was computed or read
   from the store. */
#pragma once

#include <glib.h>

/* Origin of the result of a step. */
typedef struct opc_history {
  size_t point; /* point of a sweep, from 1; 0 for a step that is not part of a
                   point */
  char *path;   /* path of the step; "a.step" is `step` in the inner flow of
                   step `a` */
  gboolean reused;
  char *key;      /* NULL if the result is not stored */
  char *reason;   /* reason why the step ran; NULL if the result was reused */
  double seconds; /* time for which the step ran to compute the result */
} opc_history;

/* The first 1000 histories of a run, and the numbers of all steps. */
typedef struct opc_histories {
  GPtrArray *list;     /* opc_history * */
  size_t done, reused; /* steps */
} opc_histories;

/* Initialise and clear a list. */
void opc_histories_init(opc_histories *histories);
void opc_histories_clear(opc_histories *histories);

/* Count a step, and keep a copy of the history unless 1000 histories are
   kept. */
void opc_histories_add(opc_histories *histories, const opc_history *history);

/* Insert the histories of another run before the present histories. */
void opc_histories_take(opc_histories *histories, const opc_histories *from);

/* Change the latest history of a reused step, because the step ran again. */
void opc_histories_rerun(opc_histories *histories, const char *path,
                         const char *reason, double seconds);
