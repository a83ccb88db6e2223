/* SPDX-License-Identifier: BSD-3-Clause */
/* test.slotted: a step whose slot has a default plugin with a parameter, for
   the tests of the framework. */
#include <opcflow/opcflow.h>

/* ---- work ---- */

static int run(void *self, void **outputs, opc_error *error) {
  (void)self, (void)outputs, (void)error;
  return OPC_OK;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    {"rule", OPC_SLOT, 0, NULL, "{ use: bad.none, size: 60 nm }", 0, 0, "drc",
     "a regulator"},
};

/* ---- entry ---- */

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  (void)host, (void)error;
  return (void *)values;
}

static void destroy(void *self) { (void)self; }

static const opc_step operations = {
    .size = sizeof operations, .port_size = sizeof(opc_port), .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "test.slotted",
    .version = "1.0.0",
    .licence = "BSD-3-Clause",
    .summary = "A slot with a default",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    .create = create,
    .destroy = destroy,
    .operations = &operations,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
