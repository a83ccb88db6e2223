/* SPDX-License-Identifier: BSD-3-Clause */
/* State of the step `experiment`, and its report. */
#pragma once

#include <glib.h>
#include <opcflow/inner.h>

/* A figure of one or more runs. */
typedef struct figure {
  char *name;       /* "step.metric", such as "mask.ion_mean" */
  const char *unit; /* or NULL */
  uint32_t better;  /* OPC_LOWER, OPC_HIGHER or OPC_NEUTRAL */
  double *values;   /* for each run; NAN if the run does not have the figure */
} figure;

/* The instance of the step. */
typedef struct experiment {
  const opc_host *host;
  const char *flow, *variant; /* parameters */
  opc_map set, cases, methods, columns;
  size_t n_cases, n_methods;
  const char *const *case_names, *const *method_names;
  size_t count; /* number of runs, which are sorted by case, then by method */

  /* For each run. If the run failed, the folder is NULL, the place "", and the
     time NAN. */
  char **folders;  /* path of the run folder */
  char **places;   /* the same, relative to the step's folder */
  char **results;  /* "good", or the error message */
  double *seconds; /* run time */

  GPtrArray *figures; /* of type figure * */
  size_t failed;
  size_t missed; /* number of runs that do not meet the flow's requirements */
  size_t with_findings;
} experiment;

/* ---- report.c ---- */

/* Free a figure. */
void figure_free(void *object);

/* Store the metrics of the last run as figures of run `run`. */
void take_figures(experiment *e, size_t run);

/* Publish experiment.csv, the summary by method, metrics and findings. Returns
   OPC_OK or an error. */
int experiment_report(experiment *e, opc_error *error);
