/* SPDX-License-Identifier: BSD-3-Clause */
/* Helpers for unit tests of steps with an inner flow (opcflow/inner.h). The
   test defines functions that compute the metrics and tables of the inner flow.
   The step is linked into the test. */
#pragma once

#include <opcflow/inner.h>
#include <opcflow/step.h>
#include <string.h>

#include "tools/devel/testing.h"

enum { INNER_MOST = 64 };

typedef struct inner_flow {
  /* Set by the test. */
  const opc_inner_axis *axes;
  size_t n_axes;
  const opc_metric *metric; /* the metric at `path` */
  const char *path;         /* "mask.ion" */
  const opc_metric *more;   /* a second metric at `more_path`; NULL if there is
                               none */
  const char *more_path;
  const char *mask; /* the step with a mask, or NULL */
  void *object;     /* object that represents the mask */
  int (*point)(size_t point, opc_error *error); /* compute a run, and set the
                                                   members below */

  /* Set by `point`. */
  opc_inner_metric metrics[8], shared[8];
  size_t n_metrics, n_shared;
  const opc_column *columns; /* columns of the only table */
  size_t n_columns, rows;
  opc_inner_run whole;

  /* Recorded calls of the step, in order. */
  int begun;
  size_t points[INNER_MOST], shares[INNER_MOST], n_points;
  int keep[INNER_MOST];
  char places[INNER_MOST][80];
} inner_flow;

static inner_flow inner;

static inline const opc_inner_axis *const *inner_axes(const opc_host *host,
                                                      size_t *count) {
  static const opc_inner_axis *list[INNER_MOST];
  (void)host;
  *count = inner.n_axes;
  for (size_t i = 0; i < inner.n_axes; i++) list[i] = &inner.axes[i];
  return list;
}

static inline int inner_axis(const opc_host *host, const char *path,
                             opc_error *error) {
  (void)host;
  for (size_t i = 0; i < inner.n_axes; i++)
    if (!strcmp(inner.axes[i].path, path)) return (int)i;
  opc_fail(error, OPC_INVALID, NULL, "'%s' is not a swept parameter", path);
  return -1;
}

static inline const opc_metric *inner_metric(const opc_host *host,
                                             const char *path,
                                             opc_error *error) {
  (void)host;
  if (inner.path && !strcmp(inner.path, path)) return inner.metric;
  if (inner.more_path && !strcmp(inner.more_path, path)) return inner.more;
  opc_fail(error, OPC_INVALID, NULL, "no metric '%s'", path);
  return NULL;
}

static inline const char *inner_output(const opc_host *host, const char *step,
                                       const char *kind, opc_error *error) {
  (void)host;
  if (inner.mask && !strcmp(kind, "mask") &&
      (!step || !strcmp(step, inner.mask)))
    return inner.mask;
  opc_fail(error, OPC_INVALID, NULL, "'%s' makes no mask", step ? step : "");
  return NULL;
}

static inline int inner_begin(const opc_host *host, opc_error *error) {
  (void)host, (void)error;
  g_assert_cmpuint(inner.n_points, ==, 0);
  inner.begun++;
  return OPC_OK;
}

static inline int inner_run_whole(const opc_host *host, size_t point,
                                  const char *folder, size_t share,
                                  const opc_inner_run **out, opc_error *error) {
  (void)host;
  g_assert_cmpint(inner.begun, ==, 1);
  g_assert_cmpuint(inner.n_points, <, INNER_MOST);
  inner.points[inner.n_points] = point;
  inner.shares[inner.n_points] = share;
  g_strlcpy(inner.places[inner.n_points++], folder, sizeof *inner.places);
  inner.whole = (opc_inner_run){NULL, 0, 0};
  int code = inner.point(point, error);
  *out = inner.whole.folder ? &inner.whole : NULL;
  return code;
}

static inline int inner_run(const opc_host *host, size_t point, int keep,
                            size_t share, opc_error *error) {
  const opc_inner_run *none;
  inner.keep[inner.n_points] = keep;
  return inner_run_whole(host, point, "", share, &none, error);
}

static inline const opc_inner_metric *const *inner_metrics(const opc_host *host,
                                                           int shared,
                                                           size_t *count) {
  static const opc_inner_metric *list[8];
  (void)host;
  *count = shared ? inner.n_shared : inner.n_metrics;
  for (size_t i = 0; i < *count; i++)
    list[i] = shared ? &inner.shared[i] : &inner.metrics[i];
  return list;
}

static inline const opc_column *inner_column(const opc_host *host,
                                             const char *step,
                                             const char *table,
                                             const char *column, size_t *rows,
                                             opc_error *error) {
  (void)host;
  *rows = inner.rows;
  for (size_t i = 0; i < inner.n_columns; i++)
    if (!strcmp(inner.columns[i].name, column)) return &inner.columns[i];
  opc_fail(error, OPC_INVALID, NULL, "%s.%s.%s does not exist", step, table,
           column);
  return NULL;
}

static inline void *inner_object(const opc_host *host, const char *step,
                                 const char *kind) {
  (void)host, (void)kind;
  return inner.mask && !strcmp(step, inner.mask) ? inner.object : NULL;
}

static const opc_inner_service inner_functions = {
    .size = sizeof inner_functions,
    .axes = inner_axes,
    .axis = inner_axis,
    .metric = inner_metric,
    .output = inner_output,
    .begin = inner_begin,
    .run = inner_run,
    .metrics = inner_metrics,
    .column = inner_column,
    .object = inner_object,
    .run_whole = inner_run_whole,
};

static inline const void *inner_service(const opc_host *host,
                                        const char *name) {
  (void)host;
  return strcmp(name, OPC_INNER) ? NULL : &inner_functions;
}

/* Return the host of all tests, with the inner flow `flow`. */
static inline const opc_host *inner_host(inner_flow flow) {
  opc_host *host = (opc_host *)opc_test_host();
  host->service = inner_service;
  inner = flow;
  opc_test_forget();
  return host;
}

/* Append a metric of the last run. */
static inline void inner_report(const char *path, const opc_metric *metric,
                                double value) {
  g_assert_cmpuint(inner.n_metrics, <, G_N_ELEMENTS(inner.metrics));
  inner.metrics[inner.n_metrics++] = (opc_inner_metric){path, metric, value};
}

/* Descriptor of the linked plugin. */
const opc_plugin *opcflow_plugin(void);
