/* SPDX-License-Identifier: BSD-3-Clause */
/* What single transistors want of their correction: from the notes upon them in
   the layout, or from a CSV file. */
#ifndef SYNTHESIZER_NEWTON_WISHES_H
#define SYNTHESIZER_NEWTON_WISHES_H

#include <eda/gates.h>

#include "response.h"

typedef struct wish {
  double weight; /* the tolerance is divided by it; 0: leave it as drawn */
  double target[ERRORS]; /* what is wanted, as a multiple of what is drawn */
} wish;

/* Read `path` into wish[gates->count], which holds the defaults. The first line
   names the columns: transistor (as in gates.csv), and some of
   weight, ion, ioff, area. */
int read_wishes(const char *path, const eda_gates *gates, wish *out,
                opc_error *error);

/* Take in the notes: words with blanks or commas between, weight=..., ion=...,
   ioff=..., area=...; words with a dot in their name are for others, and a note
   that begins with # is a remark. */
int read_notes(const eda_gates *gates, wish *out, opc_error *error);

#endif
