/* SPDX-License-Identifier: BSD-3-Clause */
/* Verdicts: measured metrics of a run against the requirements of the flow. */
#pragma once

#include "core/binding/flow.h"

/* Result of a requirement. */
typedef struct opc_verdict {
  size_t point;       /* point of a sweep, from 1; 0 if not of a point */
  char *path;         /* "step.largest" */
  char *required;     /* "at most 1 %" */
  char *unit;         /* may be NULL */
  double least, most; /* infinite without a bound */
  double value;       /* NAN if not measured */
  gboolean kept;      /* `value` meets the requirement */
  opc_place at;       /* owns its `file` */
} opc_verdict;

/* Return an empty list of verdicts. */
GPtrArray *opc_verdicts_new(void);

/* Add a verdict for each requirement of the steps that are not left out (of all
   steps if `left_out` is NULL); `metrics` has opc_inner_metric. */
void opc_verdicts_judge(GPtrArray *verdicts, const opc_flow *flow,
                        const GArray *metrics, const gboolean *left_out);

/* Copy the failed verdicts of another run, until the list has 1000 verdicts.
   `point` is the point of the other run, or 0 outside a sweep; `prefix` is
   prepended to the paths. */
void opc_verdicts_take(GPtrArray *verdicts, const GPtrArray *from, size_t point,
                       const char *prefix);

/* Add a problem for each requirement that is not met. */
void opc_verdicts_add_broken(const GPtrArray *verdicts, opc_problems *problems);
