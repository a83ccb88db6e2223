/* SPDX-License-Identifier: BSD-3-Clause */
/* What single transistors want of their correction: from the notes upon them in
   the layout, or from a CSV file. */
#ifndef SYNTHESIZER_NEWTON_WISHES_H
#define SYNTHESIZER_NEWTON_WISHES_H

#include <eda/gates.h>

typedef struct wish {
  double weight; /* the tolerance is divided by it; 0: leave it as drawn */
  double ion;    /* the drive current wanted, as a multiple of the drawn one */
} wish;

/* Read `path` into wish[gates->count], which holds the defaults. The first line
   names the columns: transistor (as in gates.csv), and weight, ion or both. */
int read_wishes(const char *path, const eda_gates *gates, wish *out,
                opc_error *error);

/* Take in the notes: words with blanks or commas between, weight=... and
   ion=...; words with a dot in their name are for others, and a note that
   begins with # is a remark. */
int read_notes(const eda_gates *gates, wish *out, opc_error *error);

#endif
