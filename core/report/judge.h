/* SPDX-License-Identifier: BSD-3-Clause */
/* What a run measured against what its flow requires. */
#pragma once

#include "core/binding/flow.h"

/* The result of a requirement. */
typedef struct opc_verdict {
  size_t point;       /* of a sweep, from 1; 0: of all */
  char *path;         /* "step.largest" */
  char *required;     /* "at most 1 %" */
  char *unit;         /* NULL: a plain number */
  double least, most; /* infinite: no bound */
  double value;       /* NAN: not measured */
  gboolean kept;
  opc_place at; /* with a `file` of its own */
} opc_verdict;

/* Return an empty list of verdicts. */
GPtrArray *opc_verdicts_new(void);

/* Add a verdict for each requirement of the steps that are not left out (NULL:
   none is); `metrics` has opc_inner_metric. */
void opc_verdicts_judge(GPtrArray *verdicts, const opc_flow *flow,
                        const GArray *metrics, const gboolean *left_out);

/* Take the requirements that another run did not keep; `point`: where that
   was, `prefix`: text before their paths. The list takes 1000 at most. */
void opc_verdicts_take(GPtrArray *verdicts, const GPtrArray *from, size_t point,
                       const char *prefix);

/* Add a problem for each requirement that was not kept. */
void opc_verdicts_add_broken(const GPtrArray *verdicts, opc_problems *problems);
