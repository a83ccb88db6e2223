/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of the step `search`: the best of all settings of a flow's
   parameters, and the mask that it makes (thesis 3.3.1). */
#pragma once

#include <eda/settings.h>
#include <opcflow/inner.h>

/* What to look for. */
typedef struct plan {
  const char *figure;       /* "step.metric" */
  char *of;                 /* the step, or a plugin in it */
  const opc_metric *metric; /* the figure */
  int greatest;             /* is best, not the least */
  const char *mask;         /* the step whose mask is handed on */

  /* One run at the last value of axis `along` stands for all `count` values of
     it: row by row, a table has the figure at each. Without: -1 and 1. */
  int along;
  size_t count, stride; /* from one setting that shares a run to the next */
  char **column;        /* of those values: step, table, column */
} plan;

typedef struct search {
  const opc_host *host;
  const char *flow, *variant, *minimise, *maximise, *mask;
  const void *gates; /* taken by the host */
  opc_map set, sweep, along;
  const opc_inner_axis *const *axes;
  size_t n_axes;
  plan plan;

  /* What came of it. */
  size_t count; /* settings */
  size_t runs, failed;
  double simulations;
  double *figure; /* of each setting; NAN: none */
  int64_t *run;   /* of each setting: its run, from 1 */
  char **results; /* of each run: "good", or what went wrong */
  size_t best;    /* `count`: none yet */
} search;

/* What `settings` hands on. */
eda_settings *search_settings(const search *search);

/* The tables and the metrics. */
int search_report(const search *search, const eda_settings *settings,
                  opc_error *error);
