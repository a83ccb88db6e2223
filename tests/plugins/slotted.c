/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step test.slotted, whose slot has a default plugin with a
   parameter, for tests of the framework. */
#include <opcflow/step.h>

typedef struct slotted {
  const opc_host *host;
  const opc_module *rule;
} slotted;

/* ---- work ---- */

static int slotted_run(void *self, void **outputs, opc_error *error) {
  (void)self, (void)outputs, (void)error;
  return OPC_OK;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(slotted, rule, .type = OPC_SLOT,
                  .preset = "{ use: bad.none, size: 60 nm }",
                  .choices = "regulator", .summary = "a regulator"),
};

/* ---- entry ---- */

static const opc_step functions = {.run = slotted_run};

OPC_PLUGIN(slotted, .id = "test.slotted", .kind = "step", .version = "1.0.0",
           .licence = "BSD-3-Clause", .summary = "A slot with a default",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_FUNCTIONS(functions));
