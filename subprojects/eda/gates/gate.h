/* SPDX-License-Identifier: BSD-3-Clause */
/* A printed gate: cut lines through the fields of poly and active. */
#pragma once

#include <eda/extractor.h>

enum { EDA_GATE_LENGTHS = 256 };

/* A gate in its own coordinates: [L, W], nm. */
typedef struct eda_gate {
  eda_printed_gate shown; /* first field: the part visible to extractors */
  const eda_field *poly, *active;
  int axis[2];
  double low[2], high[2], middle[2]; /* drawn edges */
  const double *space, *drawn_extension;
  double from, to; /* printed active, along W */
  double extension[2];
  uint32_t flags;
  /* Lengths already measured. */
  size_t known;
  double place[EDA_GATE_LENGTHS], length[EDA_GATE_LENGTHS];
} eda_gate;

/* Measure gate i of a printed image ([layers]): its width, extensions and
   flags. */
void eda_gate_measure(const eda_gates *gates, size_t i, const eda_field *print,
                      eda_gate *gate);

/* Set gate i as drawn: a rectangle. */
void eda_gate_draw(const eda_gates *gates, size_t i, eda_gate *gate);

/* Compute the lengths at fractions of the width, 0 where nothing prints, NAN
   for an invalid place. Flags accumulate over all requested lengths. Many
   lengths at once take much less time than single ones. */
void eda_gate_lengths(eda_gate *gate, size_t n, const double *place,
                      double *length);
