/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kind (opcflow/step.h) "experiment": the run folders of several methods
   on several cases, produced by the step `experiment`. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* The data object. A method is a change of the flow, such as another
   synthesizer; a case is an input, such as a layout. */
typedef struct eda_experiment {
  size_t n_cases, n_methods;
  const char *const *cases, *const *methods; /* names */
  /* Path of the run folder of case c and method m at [c * n_methods + m]; NULL
     for a failed run. The folder has flow.yaml, metrics.json and manifest.json,
     and exists while the flow that created it runs. */
  const char *const *folders;
} eda_experiment;

/* Return an experiment with copies of these arrays and texts; `folders` has
   n_cases * n_methods elements. [any] (opcflow/plugin.h) */
OPC_EXPORT eda_experiment *eda_experiment_new(size_t n_cases,
                                              const char *const *cases,
                                              size_t n_methods,
                                              const char *const *methods,
                                              const char *const *folders);

/* Release and check functions of an output of the data kind "experiment". */
OPC_EXPORT void eda_experiment_free(void *experiment);
OPC_EXPORT int eda_experiment_check(const void *experiment, opc_error *error);

/* Initialise an opc_port (opcflow/step.h). */
#define EDA_PORT_EXPERIMENT(port)                                      \
  {                                                                    \
    .name = port, .kind = "experiment", .check = eda_experiment_check, \
    .release = eda_experiment_free                                     \
  }

OPC_C_END
