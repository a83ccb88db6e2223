/* SPDX-License-Identifier: BSD-3-Clause */
/* Service "opcflow.inner/1": a step runs another flow, the inner flow, at the
   points of a sweep or at combinations of layers. A sweep runs a flow for all
   combinations of the values of its axes; each combination is a point.

   A step has an inner flow if a parameter of the type OPC_FILE carries
   OPC_INNER_FLOW and names a flow file. A step of an inner flow may have an
   inner flow of its own, but no deeper nesting is possible. The optional
   parameters `variant` (OPC_TEXT), `set` and `sweep` (OPC_MAP with
   OPC_MAP_OF_ANY) of the step change that flow. Before the host calls `check`
   of the step (opc_plugin.check), it reads the inner flow, creates its plugins
   and checks them at each swept value.

   A parameter with OPC_INNER_AXIS is an axis whose values are layers. A layer
   is a set of changes to the inner flow: a variant, or a map of paths and
   values. The host expands lists, patterns and files in the map
   (docs/reference/flow.md). Axes of layers precede the axes of `sweep`, in the
   order of declaration. If two axes change the same path, the later axis
   applies. A step that the last axes do not change runs once for all points
   that differ only in the values of those axes.

   An OPC_INPUT with OPC_INNER_STEP, if given, replaces the step of the inner
   flow that has the name of the parameter. The host uses the object of the
   input as the output of that step and does not run the step.

   A step gets the service by opc_get_inner, which returns NULL if the step has
   no inner flow. The host owns the returned objects, which are valid until the
   next call of `run` unless stated otherwise. Functions that return NULL fill
   *error. All functions are [main] (plugin.h). */
#ifndef OPCFLOW_INNER_H
#define OPCFLOW_INNER_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

/* A swept parameter. Valid until the instance is cleared. */
typedef struct opc_inner_axis {
  const char *path;     /* "mask.synthesizer.fragment" */
  const char *unit;     /* NULL for plain numbers and texts */
  size_t count;         /* number of values */
  const double *values; /* in `unit`; NULL if the values are not numbers of one
                           unit */
  const char *const
      *texts; /* values as written in the flow, or names of layers, which are
                 unique and valid as folder names */
  int used;   /* 1 if a result requested by `metric` or `output` depends on this
                 axis, else 0 */
  OPC_MAY_GROW
} opc_inner_axis;

/* The value of a metric after a run. */
typedef struct opc_inner_metric {
  const char *path; /* path of the instance: "mask", "mask.synthesizer" */
  const opc_metric *metric; /* declaration of the metric */
  double value;             /* in the unit of the declaration */
  OPC_MAY_GROW
} opc_inner_metric;

/* A run whose files are kept. */
typedef struct opc_inner_run {
  const char *folder; /* path of the folder, for use while the step runs */
  double seconds;     /* run time of all steps, including shared ones */
  size_t findings;    /* number of findings of all steps */
  OPC_MAY_GROW
} opc_inner_run;

/* Name of the service, for opc_host.service. */
#define OPC_INNER "opcflow.inner/1"

/* Functions of the service. */
typedef struct opc_inner_service {
  size_t size; /* size of this struct */

  /* ---- callable from opc_plugin.check on ---- */

  /* Return the *count axes. Points are numbered from 0; the value of the last
     axis varies fastest. */
  const opc_inner_axis *const *(*axes)(const opc_host *host, size_t *count);
  /* Return the index of the axis with the path `path`; -1 and *error if no axis
     has this path. */
  int (*axis)(const opc_host *host, const char *path, opc_error *error);

  /* `metric`: return the declaration of the metric with the path "step.metric".
     `output`: return the name of `step` if that step has an output of the data
     kind; if `step` is NULL, the name of the first step with such an output.
     Later runs execute only the steps named in calls of `metric` and `output`,
     and the steps that provide their inputs; without such calls, all steps. */
  const opc_metric *(*metric)(const opc_host *host, const char *path,
                              opc_error *error);
  const char *(*output)(const opc_host *host, const char *step,
                        const char *kind, opc_error *error);

  /* ---- callable while the step runs ---- */

  /* Run the steps that depend on no axis, once for all points. Call before
     `run`. Returns 0, or an error code with *error filled. */
  int (*begin)(const opc_host *host, opc_error *error);

  /* Run the remaining steps at a point. If `keep` is 1, keep the written files
     in a folder with the name of the calling step; if `keep` is 0, keep the
     files only if the user keeps all points. The call counts as `share` points
     of progress. Returns OPC_CANCELLED if the user stops the run. After any
     other failure, further points may be run. */
  int (*run)(const opc_host *host, size_t point, int keep, size_t share,
             opc_error *error);

  /* Return the *count metrics of the steps that the last `run` executed. If
     `shared` is 1, return those of the steps that `begin` executed, which are
     equal for all points. */
  const opc_inner_metric *const *(*metrics)(const opc_host *host, int shared,
                                            size_t *count);

  /* Return a numeric column (OPC_REAL, OPC_INT) of a table that the step `step`
     published in the last run, with the number of rows in *rows. */
  const opc_column *(*column)(const opc_host *host, const char *step,
                              const char *table, const char *column,
                              size_t *rows, opc_error *error);

  /* Return the output of the data kind `kind` that `step` produced in the last
     run; the function `output` must have requested this output. The object is
     valid until the next run or until the instance is cleared. */
  void *(*object)(const opc_host *host, const char *step, const char *kind);

  /* Run a point as `run` does, and write the complete run folder STEP/`folder`,
     where STEP is the calling step. The folder has flow.yaml, metrics.json,
     manifest.json and the files of all steps, including those of `begin`.
     `metrics` then returns the metrics of all steps. Returns OPC_LIMIT if the
     run is complete but violates a requirement of the flow. After any other
     failure *out is NULL and no folder exists. A failure changes the exit code
     of the command as a failed point of a sweep does. */
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
