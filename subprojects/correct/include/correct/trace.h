/* SPDX-License-Identifier: BSD-3-Clause */
/* Displacements and deviations of each transistor in each simulation. */
#pragma once

#include <opcflow/plugin.h>
#include <stdint.h>

struct loop;

/* A transistor in one simulation. */
typedef struct trace_row {
  int64_t iteration;
  const char *name; /* name of the transistor; set by correct_trace_report */
  double l, w, jog, end_low, end_high; /* displacements of the mask, nm */
  double ion, ioff, area;              /* deviations, %; NAN: does not print */
  const char *print; /* fault of the printed transistor; "": none */
  int64_t vetoes;    /* EDA_VETO_*, set after the preceding simulation */
} trace_row;

/* Rows of all transistors, in the order of simulations. */
typedef struct trace {
  trace_row *row;
  size_t count, capacity;
} trace;

/* Append the rows of the last simulation. */
OPC_EXPORT void correct_trace_add(trace *trace, const struct loop *loop);
/* Free all rows. */
OPC_EXPORT void correct_trace_clear(trace *trace);
/* Publish the rows as the table "trace". */
OPC_EXPORT int correct_trace_report(trace *trace, const struct loop *loop,
                                    opc_error *error);
