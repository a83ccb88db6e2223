/* SPDX-License-Identifier: BSD-3-Clause */
/* A printed gate, measured on cut lines through the level sets of poly and
   active. */
#pragma once

#include <eda/extractor.h>

/* Largest number of lengths that a gate keeps. */
enum { EDA_GATE_LENGTHS = 256 };

/* A gate. Coordinates are in nm; array index 0 is the direction along L, 1 the
   direction along W. */
typedef struct eda_gate {
  eda_printed_gate
      shown; /* part that extractors see; must be the first member */
  const eda_field *poly, *active;    /* level sets */
  int axis[2];                       /* EDA_X or EDA_Y */
  double low[2], high[2], middle[2]; /* drawn edges, and the middle between */
  /* eda_gates.space and eda_gates.extension of both sides of the gate */
  const double *space, *drawn_extension;
  double from, to;     /* edges of the printed active along W */
  double extension[2]; /* of the printed poly, as eda_printed_gate.extension */
  uint32_t flags;      /* EDA_PRINT_* */
  /* Lengths already measured, by fraction of the width. */
  size_t known;
  double place[EDA_GATE_LENGTHS], length[EDA_GATE_LENGTHS];
} eda_gate;

/* Measure gate i in the level sets `print` ([layers]): printed width,
   extensions and flags. `print` must outlive the gate. */
void eda_gate_measure(const eda_gates *gates, size_t i, const eda_field *print,
                      eda_gate *gate);

/* Set gate i to the drawn rectangle. */
void eda_gate_draw(const eda_gates *gates, size_t i, eda_gate *gate);

/* Compute the lengths (nm) at n fractions `place` of the printed width: 0 where
   the middle between the drawn edges does not print, NAN if `place` is not
   within 0 to 1. Flags accumulate over all requested lengths. One call with
   many places is much faster than many calls. */
void eda_gate_lengths(eda_gate *gate, size_t n, const double *place,
                      double *length);
