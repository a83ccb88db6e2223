/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "step": typed inputs to typed outputs (read, segment, fracture, draw,
   write, and what others invent). */
#ifndef OPCFLOW_STEP_H
#define OPCFLOW_STEP_H

#include <opcflow/plugin.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An output. `kind` names the data: "layout" (opc_layout), "gates"
   (opc_gates), "mask" (opc_mask), or a name of your own. */
typedef struct opc_port {
  const char *name;
  const char *kind;
  /* Frees what run put there, before the instance that did is destroyed.
     [main] */
  void (*release)(void *object);
} opc_port;

typedef struct opc_step {
  size_t size;                 /* sizeof(opc_step) */

  /* The first one is what `${step}` means. Inputs are parameters of the type
     OPC_INPUT. An output may point into the inputs of its step: they live as
     long as it. */
  uint32_t n_outputs, port_size;
  const opc_port *outputs;

  /* Do the work, once, with the values given to `create`, whose OPC_INPUT
     objects are now there. Puts n_outputs objects into `outputs` (which is
     NULL-filled); on failure those that are there are released. [main] */
  int (*run)(void *self, void **outputs, opc_error *error);
} opc_step;

#ifdef __cplusplus
}
#endif
#endif
