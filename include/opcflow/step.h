/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "step": typed inputs to typed outputs (read, correct, draw, write, and
   what others invent). */
#ifndef OPCFLOW_STEP_H
#define OPCFLOW_STEP_H

#include <opcflow/plugin.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An output. `kind` names the data, which brings its own check and release:
   libraries offer ports of their kinds as macros (eda: EDA_PORT_LAYOUT ...). */
typedef struct opc_port {
  const char *name;
  const char *kind;

  /* Whether what `run` put there is what the kind says, down to its arrays:
     others rely on it. [main] */
  int (*check)(const void *object, opc_error *error);

  /* Frees it, before the instance that made it is cleared. [main] */
  void (*release)(void *object);
} opc_port;

typedef struct opc_step {
  /* The first one is what `${step}` means. Inputs are parameters of the type
     OPC_INPUT. An output may point into the inputs of its step: they live as
     long as it. */
  size_t n_outputs;
  const opc_port *outputs;

  /* Do the work, once, with the inputs there. Puts n_outputs objects into
     `outputs` (which is NULL-filled); on failure those that are there are
     released. [main] */
  int (*run)(void *self, void **outputs, opc_error *error);
} opc_step;

#define OPC_OUTPUTS(array) \
  .n_outputs = sizeof(array) / sizeof((array)[0]), .outputs = (array)

#ifdef __cplusplus
}
#endif
#endif
