/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "resist": converts an intensity to printed shapes, in the form of a
   level set. Kind, instance, [any], [main]: see opcflow/plugin.h. */
#pragma once

#include <eda/gates.h>
#include <eda/litho.h>

OPC_C_BEGIN

/* Functions of a resist model. */
typedef struct eda_resist {
  /* Prepare the instance once, before `print`: calibrate each layer for the
     litho model in use (functions: eda_litho). [main] */
  int (*prepare)(void *self, const opc_module *litho, opc_error *error);

  /* Convert the intensity of a layer, in place, to its level set: positive
     where the resist remains. The grid of the field may change: free replaced
     coefficients by eda_field_clear. [any] */
  int (*print)(const void *self, int layer, eda_field *field, opc_error *error);

  /* Optional. Receive the transistors to be simulated, to derive defaults of
     parameters. Called before `prepare`; the gates are valid until `prepare`
     returns. Since 0.7. [main] */
  void (*drawn)(void *self, const eda_gates *gates);
  OPC_MAY_GROW
} eda_resist;

OPC_C_END
