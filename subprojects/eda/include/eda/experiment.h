/* SPDX-License-Identifier: BSD-3-Clause */
/* Data of the kind "experiment": the run folders of several methods on several
   cases, produced by the step `experiment`. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

typedef struct eda_experiment {
  size_t n_cases, n_methods;
  const char *const *cases, *const *methods; /* their names */
  /* Run folder of case c by method m at [c * n_methods + m]: complete, with
     flow.yaml, metrics.json and manifest.json; valid while the flow that made
     the folder runs. NULL for a failed run. */
  const char *const *folders;
} eda_experiment;

/* Return a copy of everything; the last array has n_cases * n_methods elements.
   [any] */
OPC_EXPORT eda_experiment *eda_experiment_new(size_t n_cases,
                                              const char *const *cases,
                                              size_t n_methods,
                                              const char *const *methods,
                                              const char *const *folders);

/* Free an experiment with all texts. An object of the data kind
   "experiment". */
OPC_EXPORT void eda_experiment_free(void *experiment);
OPC_EXPORT int eda_experiment_check(const void *experiment, opc_error *error);

/* Initialise an opc_port (opcflow/step.h). */
#define EDA_PORT_EXPERIMENT(port)                                      \
  {                                                                    \
    .name = port, .kind = "experiment", .check = eda_experiment_check, \
    .release = eda_experiment_free                                     \
  }

OPC_C_END
