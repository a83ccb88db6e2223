/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes delays in SDF (IEEE 1497, version 3.0). [any]: opcflow/plugin.h. */
#pragma once

#include <opcflow/base.h>
#include <stdio.h>

OPC_C_BEGIN

/* An arc of a cell instance: three delays (min, typ, max), ps, of a falling [0]
   and of a rising [1] output; NAN: the output has no such edge. */
typedef struct eda_sdf_arc {
  const char *cell, *instance, *input, *output;
  double delay[2][3];
} eda_sdf_arc;

/* Write an SDF file. `program`: name of the program and origin of the delays.
   `supply` in V, `temperature` in C. Adjacent arcs of one output of an instance
   form one entry. Return OPC_OK; or OPC_IO, or OPC_FAILED if a delay is not
   finite, and *error. [any] */
OPC_EXPORT int eda_sdf_write(const char *path, const char *design,
                             const char *program, double supply,
                             double temperature, size_t arcs,
                             const eda_sdf_arc *arc, opc_error *error);

/* Write a name in the syntax of Verilog, escaped if needed. [any] */
OPC_EXPORT void eda_verilog_name(FILE *out, const char *name);

OPC_C_END
