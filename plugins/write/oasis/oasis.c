/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements write.oasis: a layout or a corrected mask as an OASIS file. */
#include "stream.h"

/* ---- parameters ---- */

static const opc_parameter parameters[] =
    WRITE_PARAMETERS(oasis, "mask.oas", "Layer numbers, as in { poly: 9/0 }");

static int oasis_check(void *self, opc_error *error) {
  return writer_check(self, &oasis_stream, error);
}

/* ---- entry ---- */

static const opc_step functions = {.run = writer_run,
                                   .forecast = writer_forecast};

OPC_PLUGIN(oasis, .id = "write.oasis", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "Write a layout or a mask as an OASIS file",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = oasis_check,
           OPC_FUNCTIONS(functions));
