/* SPDX-License-Identifier: BSD-3-Clause */
/* Data of the kind "experiment": where the runs of several methods on several
   cases are, as the step `experiment` makes them. */
#ifndef EDA_EXPERIMENT_H
#define EDA_EXPERIMENT_H

#include <opcflow/base.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct eda_experiment {
  size_t n_cases, n_methods;
  const char *const *cases, *const *methods; /* their names */
  /* Of case c by method m, at [c * n_methods + m]: its run folder, complete,
     with flow.yaml, metrics.json and manifest.json; good while the flow that
     made it runs. NULL where the run failed. */
  const char *const *folders;
} eda_experiment;

/* All is copied; the last array has n_cases * n_methods elements. [any] */
OPC_EXPORT eda_experiment *eda_experiment_new(size_t n_cases,
                                              const char *const *cases,
                                              size_t n_methods,
                                              const char *const *methods,
                                              const char *const *folders);

/* Frees it with all texts; an object of the data kind "experiment". */
OPC_EXPORT void eda_experiment_free(void *experiment);
OPC_EXPORT int eda_experiment_check(const void *experiment, opc_error *error);

/* For the initialiser of an opc_port (opcflow/step.h). */
#define EDA_PORT_EXPERIMENT(port)                                      \
  {                                                                    \
    .name = port, .kind = "experiment", .check = eda_experiment_check, \
    .release = eda_experiment_free                                     \
  }

#ifdef __cplusplus
}
#endif
#endif
