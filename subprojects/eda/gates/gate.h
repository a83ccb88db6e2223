/* SPDX-License-Identifier: BSD-3-Clause */
/* One printed gate: cut lines through the fields of poly and active. */
#ifndef EDA_GATES_GATE_H
#define EDA_GATES_GATE_H

#include <eda/extractor.h>

enum { EDA_GATE_LENGTHS = 256 };

/* A gate in its own terms: [L, W], nm. */
typedef struct eda_gate {
  eda_printed_gate shown; /* first: what an extractor gets to see */
  const eda_field *poly, *active;
  int axis[2];
  double low[2], high[2], middle[2]; /* as drawn */
  const double *space, *drawn_extension;
  double from, to; /* the printed active, along W */
  double extension[2];
  uint32_t flags;
  /* Lengths that were measured already. */
  size_t known;
  double place[EDA_GATE_LENGTHS], length[EDA_GATE_LENGTHS];
} eda_gate;

/* Gate i of a print ([layers]): its width, extensions and flags. */
void eda_gate_measure(const eda_gates *gates, size_t i, const eda_field *print,
                      eda_gate *gate);

/* Gate i as drawn: a rectangle. */
void eda_gate_draw(const eda_gates *gates, size_t i, eda_gate *gate);

/* The lengths at fractions of the width, 0 where nothing prints; the flags are
   those of all lengths that were asked for. NAN for a place that is none. Many
   at once take much less time than one by one. */
void eda_gate_lengths(eda_gate *gate, size_t n, const double *place,
                      double *length);

#endif
