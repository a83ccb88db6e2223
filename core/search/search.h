/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of the step `search`: the best of all settings of a flow's
   parameters, and the mask that it makes (thesis 3.3.1). */
#ifndef OPCFLOW_CORE_SEARCH_H
#define OPCFLOW_CORE_SEARCH_H

#include <opcflow/opcflow.h>

#include "core/flow/inner.h"
#include "core/flow/run.h"

/* Its parameters. */
enum {
  SEARCH_FLOW,
  SEARCH_VARIANT,
  SEARCH_SET,
  SEARCH_SWEEP,
  SEARCH_ALONG,
  SEARCH_MINIMISE,
  SEARCH_MAXIMISE,
  SEARCH_MASK,
  SEARCH_PARAMETERS
};

/* ---- plan.c: what to look for ---- */

typedef struct opc_search_plan {
  const opc_binding *of;    /* whose figure it is, in the inner flow */
  const opc_metric *metric; /* the figure */
  gboolean greatest;        /* is best, not the least */
  guint figure_step;        /* the numbers of its step, */
  guint mask_step;          /* of that whose mask is handed on, */
  size_t mask_port;         /* and of its port */

  /* One run at the last value of axis `along` stands for all values of it: row
     by row, a table has the figure at each. -1: none. */
  int along;
  double *values;       /* of that axis, increasing */
  char *table, *column; /* names; the column holds the values */
  size_t count;         /* of settings that share a run */
  size_t stride;        /* from one of them to the next */
} opc_search_plan;

/* With the problems of what the binding of a `search` says of its inner flow.
   It is good if none was added. */
void opc_search_plan_make(opc_search_plan *plan, const opc_binding *binding,
                          opc_problems *problems);
void opc_search_plan_clear(opc_search_plan *plan);

/* Only the problems. */
void opc_search_check(const opc_binding *binding, opc_problems *problems);

/* ---- scan.c: running the settings ---- */

typedef struct opc_search {
  const opc_host *host;
  const opc_value *values;
  const opc_binding *binding;
  const opc_inner *inner;
  opc_search_plan plan;
  opc_run *outer; /* the run that the step is of */
  opc_watch watch;
  opc_run *trunk; /* what all settings share */
  opc_flow *best_flow;
  opc_run *best_run;

  size_t count, done; /* settings */
  size_t runs, failed;
  double simulations;
  double *figure;     /* of each setting */
  int64_t *run;       /* of each setting: its run, from 1 */
  GPtrArray *results; /* of each run: "good", or what went wrong */
  size_t best;        /* `count`: none yet */
  gboolean telling;   /* messages are passed on */
} opc_search;

/* Run all settings, then the best one again, whose objects stay. */
int opc_search_scan(opc_search *search, opc_error *error);
void opc_search_clear(opc_search *search);

/* ---- report.c ---- */

/* What the port `settings` hands on. */
opc_settings *opc_search_settings(const opc_search *search);
void opc_search_settings_release(void *settings);

/* The tables and the metrics. */
int opc_search_report(const opc_search *search, const opc_settings *settings,
                      opc_error *error);

#endif
