/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal interface of the step `search`, which finds the best of all settings
   of a flow's parameters and returns the mask of that setting (thesis
   3.3.1). */
#pragma once

#include <eda/settings.h>
#include <opcflow/inner.h>

/* A metric of the objective. */
typedef struct term {
  const opc_metric *metric;
  double weight; /* factor of the square of the metric; used if `weighted` */
} term;

/* Objective of the search: one metric, or the weighted sum of the squares of
   several metrics of a step (thesis eq. 2.5). */
typedef struct plan {
  const char *figure; /* "step.metric", or "cost" */
  const char *unit;   /* of the objective, or NULL */
  char *of; /* path of the step or plugin that publishes the metrics */
  term *terms;
  size_t n_terms;
  int weighted;     /* whether the objective is the sum of `weights`; if not, it
                       is terms[0] */
  int greatest;     /* whether the figure is maximised, not minimised */
  const char *mask; /* step whose mask is the output */

  /* Index of the shared axis, or -1 if no axis is shared. One run at the last
     value of the shared axis covers all `count` values, because a table of the
     run has a row with the figure for each value. Without a shared axis,
     `count` is 1. */
  int along;
  size_t count, stride; /* number of values; distance between the indices of
                           settings that share a run */
  char **column;        /* column of the axis values: step, table, column */
} plan;

/* The instance of the step. */
typedef struct search {
  const opc_host *host;
  const char *flow, *variant, *minimise, *maximise, *mask;
  const void *gates; /* only the host uses this field */
  opc_map set, sweep, along, weights;
  const opc_inner_axis *const *axes;
  size_t n_axes;
  plan plan;

  /* Results. */
  size_t count; /* number of settings */
  size_t runs, failed;
  double simulations;
  double *figure; /* for each setting; NAN if the setting has no figure */
  int64_t *run;   /* for each setting: number of the run, from 1 */
  char **results; /* for each run: "good", or the error message */
  size_t best;    /* index of the best setting; `count` before a setting has a
                     figure */
} search;

/* Return the output `settings`; the caller owns it. */
eda_settings *search_settings(const search *search);

/* Publish the tables and the metrics. Returns OPC_OK or an error. */
int search_report(const search *search, const eda_settings *settings,
                  opc_error *error);
