/* SPDX-License-Identifier: BSD-3-Clause */
/* State of the step `experiment`, and its report. */
#pragma once

#include <glib.h>
#include <opcflow/inner.h>

/* A figure of one or more runs. */
typedef struct figure {
  char *name;       /* "mask.ion_mean" */
  const char *unit; /* NULL: a plain number */
  uint32_t better;
  double *values; /* for each run; NAN: none */
} figure;

typedef struct experiment {
  const opc_host *host;
  const char *flow, *variant; /* parameters */
  opc_map set, cases, methods, columns;
  size_t n_cases, n_methods, count; /* number of runs: sorted by case, then
                                       method */
  const char *const *case_names, *const *method_names;
  char **folders;     /* for each run: path of the folder; NULL: failed */
  char **places;      /* for each run: path relative to the step's folder; "":
                         failed */
  char **results;     /* for each run: "good", or the error message */
  double *seconds;    /* NAN: failed */
  GPtrArray *figures; /* figure * */
  size_t done, failed, missed, with_findings;
} experiment;

/* ---- report.c ---- */

void figure_free(void *object);

/* Store the metrics of the last run as figures of run `run`. */
void take_figures(experiment *e, size_t run);

/* Publish experiment.csv, the summary by method, metrics and findings. Returns
   the status. */
int experiment_report(experiment *e, opc_error *error);
