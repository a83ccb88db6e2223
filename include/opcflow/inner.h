/* SPDX-License-Identifier: BSD-3-Clause */
/* A flow that a step runs inside of it, at points of a sweep or of axes of
   layers.

   A step has one if a parameter of the type OPC_FILE carries OPC_INNER_FLOW: it
   names the flow. What is laid over that flow is in the step's parameters
   `variant` (OPC_TEXT), `set` and `sweep` (OPC_MAP with OPC_MAP_OF_ANY), where
   it declares them. The host reads the flow and checks it at each value that is
   swept, with its instances, before the step's own `check`.

   A parameter with OPC_INNER_AXIS is an axis whose values are layers: variants
   of that flow, or maps of paths and values, with lists, patterns and files
   that the host expands (docs/reference/flow.md). These axes come before those
   of a sweep, in the order of the declaration; a later one is laid over an
   earlier one. Steps that only the first axes touch run once for all points
   that have the same values of these.

   An OPC_INPUT with OPC_INNER_STEP takes the place of the step of that flow
   that is called as the parameter is, if it is given: what the other step made
   is what that one gives, and it does not run.

   The step asks through opc_get_inner, NULL if it has no such flow. What is
   returned belongs to the host and is valid until the next call of `run`, if
   nothing else is said. A function that gives NULL has filled *error. [main] */
#ifndef OPCFLOW_INNER_H
#define OPCFLOW_INNER_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

/* A parameter that is swept. As long as the instance. */
typedef struct opc_inner_axis {
  const char *path; /* "mask.synthesizer.fragment" */
  const char *unit; /* NULL: plain numbers, or texts */
  size_t count;
  const double *values;     /* in that unit; NULL: not numbers of one unit */
  const char *const *texts; /* as written; of layers: their names, no two the
                               same, each good as that of a folder */
  int used;                 /* by what `metric` and `output` were asked for */
  OPC_MAY_GROW
} opc_inner_axis;

/* A metric that a run gave. */
typedef struct opc_inner_metric {
  const char *path; /* of its instance: "mask", "mask.synthesizer" */
  const opc_metric *metric;
  double value;
  OPC_MAY_GROW
} opc_inner_metric;

/* A run that is kept whole. */
typedef struct opc_inner_run {
  const char *folder; /* its path, while the step runs */
  double seconds;     /* of all its steps, those that it shares included */
  size_t findings;    /* of all its steps */
  OPC_MAY_GROW
} opc_inner_run;

#define OPC_INNER "opcflow.inner/1"

typedef struct opc_inner_service {
  size_t size; /* of this struct */

  /* ---- from `check` on ---- */

  /* The axes. Points are numbered from 0; the last axis changes first. */
  const opc_inner_axis *const *(*axes)(const opc_host *host, size_t *count);
  /* The number of that path's one; -1 and *error if it is not swept. */
  int (*axis)(const opc_host *host, const char *path, opc_error *error);

  /* The declaration of "step.metric"; and the name of `step` if it makes data
     of that kind, or of the first step that does for NULL. Only steps that were
     asked for here, and what they need, will run; all, if none was. */
  const opc_metric *(*metric)(const opc_host *host, const char *path,
                              opc_error *error);
  const char *(*output)(const opc_host *host, const char *step,
                        const char *kind, opc_error *error);

  /* ---- while the step runs ---- */

  /* First: run the steps that no axis touches, for all points. */
  int (*begin)(const opc_host *host, opc_error *error);

  /* Run the others at a point. `keep`: what it writes stays, in a folder of the
     step's name; otherwise only if the user wants to keep all points. Progress
     is told in points; this one counts for `share` of them. OPC_CANCELLED if
     the user wants to stop; after another failure, other points may be run. */
  int (*run)(const opc_host *host, size_t point, int keep, size_t share,
             opc_error *error);

  /* The metrics of the last run, or of `begin`, whose points share them. */
  const opc_inner_metric *const *(*metrics)(const opc_host *host, int shared,
                                            size_t *count);

  /* A column of numbers (OPC_REAL, OPC_INT) of a table of the last run. */
  const opc_column *(*column)(const opc_host *host, const char *step,
                              const char *table, const char *column,
                              size_t *rows, opc_error *error);

  /* What `output` was asked for, as the last run made it. If there is no later
     run, it is valid as long as the instance. */
  void *(*object)(const opc_host *host, const char *step, const char *kind);

  /* As `run`, and what it and the steps it shares have written is a complete
     run folder, of the name `folder` in one of the step's name: with flow.yaml,
     metrics.json and manifest.json; `metrics` then has all of them. OPC_LIMIT:
     the run is there and does not keep what its flow requires. After another
     failure *out is NULL and there is no folder. What failed counts for the
     exit code, as a point of a sweep does. */
  int (*run_whole)(const opc_host *host, size_t point, const char *folder,
                   size_t share, const opc_inner_run **out, opc_error *error);
  OPC_MAY_GROW
} opc_inner_service;

/* Return the service; NULL if the step has no inner flow. */
OPC_UNUSED static const opc_inner_service *opc_get_inner(const opc_host *host) {
  return (const opc_inner_service *)host->service(host, OPC_INNER);
}

OPC_C_END
#endif
