/* SPDX-License-Identifier: BSD-3-Clause */
/* Extension "opcflow.choices/1": a plugin lists the allowed values of a
   parameter with the flag OPC_LISTED, such as the cells of a layout file. */
#ifndef OPCFLOW_CHOICES_H
#define OPCFLOW_CHOICES_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

/* Name of the extension, for opc_plugin.extension. */
#define OPC_CHOICES "opcflow.choices/1"

/* The extension. */
typedef struct opc_choices {
  /* Call `take` once with each allowed value of `parameter`, in any order;
     `take` copies the value. Fields of inputs (OPC_INPUT) may be NULL, because
     no step may have run yet. Returns 0, or an error code with *error filled.
     [main] */
  int (*list)(void *self, const char *parameter,
              void (*take)(void *data, const char *value), void *data,
              opc_error *error);
} opc_choices;

OPC_C_END
#endif
