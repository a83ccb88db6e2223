/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "step": typed inputs to typed outputs (read, correct, draw, write, and
   what others invent). */
#ifndef OPCFLOW_STEP_H
#define OPCFLOW_STEP_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

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
  OPC_MAY_GROW
} opc_port;

/* What a run of a step is about to want. Texts are for the user, plain and on
   one line; they may stay empty. */
typedef struct opc_forecast {
  double memory;  /* bytes at its height, beyond what its inputs have; 0: it
                     cannot be said. Rather too low: what wants more than there
                     is, is refused */
  char work[200]; /* "at least 36 simulations of 2048 x 1024 points" */
  char help[200]; /* what would take less: "a smaller 'na'" */
  OPC_MAY_GROW
} opc_forecast;

enum {
  OPC_STEP_LIGHT = 1 << 0,   /* takes a few seconds at most, writes no file: run
                              by `opcflow check`, too, so that later steps have
                              inputs for their forecast */
  OPC_STEP_OUTSIDE = 1 << 1, /* what it does depends on more than parameters,
                                files they name, and inputs: on files that those
                                files name, on other programs. Its result is
                                never used again */
  OPC_STEP_PIECES = 1 << 2   /* shares its work by pieces.h with the processes
                                that   run the flow together. It and those that it
                                takes   from run in each of them, all others in
                                the   first   one alone */
};

typedef struct opc_step {
  /* The first one is what `${step}` means. Inputs are parameters of the type
     OPC_INPUT. An output may point into the inputs of its step: they live as
     long as it. */
  size_t n_outputs, output_size; /* output_size: of an opc_port */
  const opc_port *outputs;

  /* Do the work, once, with the inputs there. Puts n_outputs objects into
     `outputs` (which is NULL-filled); on failure those that are there are
     released. [main] */
  int (*run)(void *self, void **outputs, opc_error *error);

  /* Say what `run` will want, without the work, with the inputs there; *out is
     zero-filled. May warn by host->log and refuse as `run` would. Called before
     `run`, and by `opcflow check`. NULL: nothing to say. [main] */
  int (*forecast)(void *self, opc_forecast *out, opc_error *error);
  uint32_t flags; /* OPC_STEP_* */

  /* Write the outputs into an empty folder, and make them again from what
     `save` wrote there, on this machine: the same to the last bit for whoever
     takes them. Inputs are there, for `restore` equal ones; it may be called in
     place of `run`, on an instance that did nothing, and leaves in `outputs`
     what is to be released if it fails. The step then runs. NULL, both: the
     step runs when a later one that runs wants its outputs. [main] */
  int (*save)(void *self, void *const *outputs, const char *folder,
              opc_error *error);
  int (*restore)(void *self, const char *folder, void **outputs,
                 opc_error *error);
  OPC_MAY_GROW
} opc_step;

#define OPC_OUTPUTS(array)                         \
  .n_outputs = sizeof(array) / sizeof((array)[0]), \
  .output_size = sizeof(opc_port), .outputs = (array)

OPC_C_END
#endif
