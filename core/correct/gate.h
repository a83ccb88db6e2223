/* SPDX-License-Identifier: BSD-3-Clause */
/* One printed gate: cut lines through the fields of poly and active. */
#ifndef OPCFLOW_CORE_GATE_H
#define OPCFLOW_CORE_GATE_H

#include <opcflow/opcflow.h>

enum { OPC_GATE_LENGTHS = 256 };

/* A gate in its own terms: [L, W], nm. */
typedef struct opc_gate {
  opc_printed_gate shown;         /* first: what an extractor gets to see */
  const opc_field *poly, *active;
  int axis[2];
  double low[2], high[2], middle[2];   /* as drawn */
  const double *room, *drawn_extension;
  double from, to;                /* the printed active, along W */
  double extension[2];
  uint32_t flags;
  /* Lengths that were measured already. */
  size_t known;
  double place[OPC_GATE_LENGTHS], length[OPC_GATE_LENGTHS];
} opc_gate;

/* Gate i of a print: its width, extensions and flags. */
void opc_gate_measure(const opc_gates *gates, size_t i,
                      const opc_field print[OPC_MASKS], opc_gate *gate);

/* Gate i as drawn: a rectangle. */
void opc_gate_draw(const opc_gates *gates, size_t i, opc_gate *gate);

/* The lengths at fractions of the width, 0 where nothing prints; the flags are
   those of all lengths that were asked for. NAN for a place that is none. Many
   at once take much less time than one by one. */
void opc_gate_lengths(opc_gate *gate, size_t n, const double *place,
                      double *length);

#endif
