/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "step": a stage of a flow, with typed inputs and outputs. The type of an
   input or output is a data kind, such as "layout" or "mask"; objects of a data
   kind are C structs of a library. [main]: see plugin.h. */
#ifndef OPCFLOW_STEP_H
#define OPCFLOW_STEP_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

/* Declaration of an output. `kind` names the data kind; `check` and `release`
   handle objects of that kind. Libraries define macros for outputs of their
   data kinds (eda: EDA_PORT_LAYOUT ...). */
typedef struct opc_port {
  const char *name; /* name of the output, as in `${step.name}` */
  const char *kind; /* data kind */

  /* Check that an object made by `run` is valid for its kind, including its
     arrays. Returns 0, or an error code with *error filled. [main] */
  int (*check)(const void *object, opc_error *error);

  /* Free the object. Called before `clear` of the instance that made the
     object. [main] */
  void (*release)(void *object);
  OPC_MAY_GROW
} opc_port;

/* Expected resources of a step's run. The texts are shown to the user, one line
   each; a text may be empty. */
typedef struct opc_forecast {
  double memory;  /* peak memory without the inputs, bytes; 0 if unknown.
                     Estimate low rather than high: the host refuses a step that
                     needs more memory than is available */
  char work[200]; /* "at least 36 simulations of 2048 x 1024 points" */
  char help[200]; /* how to reduce the cost: "a smaller 'na'" */
  OPC_MAY_GROW
} opc_forecast;

/* Flags of a step. */
enum {
  OPC_STEP_LIGHT = 1 << 0,   /* takes a few seconds at most and writes no file:
                                `opcflow check` runs the step, so that later
                                steps have inputs for their forecasts */
  OPC_STEP_OUTSIDE = 1 << 1, /* the result also depends on data other than
                                inputs, parameters and files named by
                                parameters, such as other programs; the host
                                never reuses the result */
  OPC_STEP_PIECES =
      1
      << 2 /* distributes work units (pieces.h) over the processes that run the
              flow together. The step and the steps that provide its inputs run
              in every process; all other steps run only in the first process */
};

/* Functions of a step. */
typedef struct opc_step {
  /* Outputs; `${step}` refers to the first one. Inputs are parameters of the
     type OPC_INPUT. An output may point into the inputs of the step, which live
     at least as long as the output. */
  size_t n_outputs, output_size; /* sizeof(opc_port) */
  const opc_port *outputs;

  /* Run the step once, with all inputs available. Stores n_outputs objects in
     `outputs` (filled with NULL by the host); on failure the host releases the
     objects stored so far. Returns 0, or an error code with *error filled.
     [main] */
  int (*run)(void *self, void **outputs, opc_error *error);

  /* Estimate the resources of `run`, with all inputs available; *out is filled
     with zeros by the host. May log warnings, and may fail for the same reasons
     as `run`. Called before `run` and by `opcflow check`. NULL for a step
     without an estimate. [main] */
  int (*forecast)(void *self, opc_forecast *out, opc_error *error);
  uint32_t flags; /* OPC_STEP_* */

  /* `save` writes the outputs into an empty folder. `restore`, called in place
     of `run` on the same machine, reads the outputs from that folder; later
     steps must produce bit-identical results. Inputs are available and equal in
     both calls. If `restore` fails, the host releases the objects in `outputs`
     and runs the step. If both are NULL, the step runs whenever a later step
     that runs needs the outputs. [main] */
  int (*save)(void *self, void *const *outputs, const char *folder,
              opc_error *error);
  int (*restore)(void *self, const char *folder, void **outputs,
                 opc_error *error);

  /* For steps without OPC_STEP_LIGHT: make small substitutes of the outputs in
     less than a second, such as a layout with all layers and few shapes. The
     objects are valid for their data kinds. `opcflow check` passes them to
     later steps, to obtain the forecasts of these steps. May fail for the same
     reasons as `run`. If NULL, later steps make no forecasts. [main] */
  int (*sketch)(void *self, void **outputs, opc_error *error);
  OPC_MAY_GROW
} opc_step;

/* Initialise the fields of an opc_step for an array of outputs. */
#define OPC_OUTPUTS(array)                         \
  .n_outputs = sizeof(array) / sizeof((array)[0]), \
  .output_size = sizeof(opc_port), .outputs = (array)

OPC_C_END
#endif
