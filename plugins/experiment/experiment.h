/* SPDX-License-Identifier: BSD-3-Clause */
/* The state of the step `experiment`, and what it tells. */
#pragma once

#include <glib.h>
#include <opcflow/inner.h>

/* A figure of any of the runs. */
typedef struct figure {
  char *name;       /* "mask.ion_mean" */
  const char *unit; /* NULL: a plain number */
  uint32_t better;
  double *values; /* of each run; NAN where there is none */
} figure;

typedef struct experiment {
  const opc_host *host;
  const char *flow, *variant; /* parameters */
  opc_map set, cases, methods, columns;
  size_t n_cases, n_methods, count; /* runs: those of a case in a row */
  const char *const *case_names, *const *method_names;
  char **folders;     /* of each run, its path; NULL where it failed */
  char **places;      /* the same in the run folder, "" where it failed */
  char **results;     /* "good", or what went wrong */
  double *seconds;    /* NAN where it failed */
  GPtrArray *figures; /* figure * */
  size_t done, failed, missed, with_findings;
} experiment;

/* ---- report.c ---- */

void figure_free(void *object);

/* Take what the last run gave. */
void take_figures(experiment *e, size_t run);

/* experiment.csv, the summary by method, metrics and findings. */
int experiment_report(experiment *e, opc_error *error);
