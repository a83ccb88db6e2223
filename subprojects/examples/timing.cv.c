/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements timing.cv: the delay C V / I, the time in which a constant current
   charges a gate. */
#include "timing.h"

typedef struct cv {
  const opc_host *host;
  double supply;      /* V */
  double capacitance; /* aF/nm^2 */
} cv;

static double cv_delay(const void *self, double ion, double area) {
  const cv *s = self;
  return s->capacitance * 1e-18 * area * s->supply / ion;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(cv, supply, .type = OPC_REAL, .flags = OPC_ABOVE, .unit = "V",
                  .preset = "1.1 V", .summary = "supply voltage"),
    OPC_PARAMETER(
        cv, capacitance, .type = OPC_REAL, .flags = OPC_ABOVE,
        .preset = "0.0173",
        .summary = "gate capacitance, aF/nm^2; default: an oxide of 2 nm"),
};

/* ---- entry ---- */

static const timing functions = {.delay = cv_delay};

OPC_PLUGIN(cv, .id = "timing.cv", .kind = "timing", .version = "1.0.0",
           .licence = "BSD-3-Clause", .summary = "delay as C V / I",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_FUNCTIONS(functions));
