/* SPDX-License-Identifier: BSD-3-Clause */
/* A printed gate, measured on cut lines through the level sets of poly and
   active. */
#pragma once

#include <eda/extractor.h>

enum { EDA_GATE_LENGTHS = 256 };

/* A gate in coordinates [0] along L and [1] along W, nm. */
typedef struct eda_gate {
  eda_printed_gate
      shown; /* part that extractors see; must be the first member */
  const eda_field *poly, *active;
  int axis[2];
  double low[2], high[2], middle[2]; /* drawn edges */
  const double *space, *drawn_extension;
  double from, to; /* edges of the printed active along W */
  double extension[2];
  uint32_t flags;
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
   nothing prints, NAN if `place` is not within 0 to 1. Flags accumulate over
   all requested lengths. One call with many places is much faster than many
   calls. */
void eda_gate_lengths(eda_gate *gate, size_t n, const double *place,
                      double *length);
