/* SPDX-License-Identifier: BSD-3-Clause */
/* What each transistor did at each print, for authors of synthesizers. */
#ifndef CORRECT_TRACE_H
#define CORRECT_TRACE_H

#include <opcflow/plugin.h>
#include <stdint.h>

struct loop;

typedef struct trace_row {
  int64_t iteration;
  const char *name; /* of the transistor, while it is reported */
  double l, w, jog, end_low, end_high; /* of the mask, nm */
  double ion, ioff, area;              /* deviations, %; NAN: no print */
  const char *print;
  int64_t vetoes; /* EDA_VETO_* that were set after the print before */
} trace_row;

/* All transistors of the first print, of the second, and so on. */
typedef struct trace {
  trace_row *row;
  size_t count, room;
} trace;

/* The last print. */
OPC_EXPORT void correct_trace_add(trace *trace, const struct loop *loop);
OPC_EXPORT void correct_trace_clear(trace *trace);
OPC_EXPORT int correct_trace_report(trace *trace, const struct loop *loop,
                                    opc_error *error);

#endif
