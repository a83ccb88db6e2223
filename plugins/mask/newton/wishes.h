/* SPDX-License-Identifier: BSD-3-Clause */
/* What single transistors want of their correction: from the notes upon them in
   the layout, or from a CSV file. */
#ifndef OPCFLOW_MASK_NEWTON_WISHES_H
#define OPCFLOW_MASK_NEWTON_WISHES_H

#include <opcflow/mask.h>

typedef struct wish {
  double weight;   /* the tolerance is divided by it; 0: leave it as drawn */
  double ion;      /* the drive current wanted, as a multiple of the drawn one */
} wish;

/* Read `path` into wish[gates->count], which holds the defaults. The first line
   names the columns: transistor (as in gates.csv), and weight, ion or both. */
int read_wishes(const opc_host *host, const char *path, const opc_gates *gates,
                wish *out, opc_error *error);

/* Take in the notes: words with blanks or commas between, weight=... and
   ion=...; words with a dot in their name are for others, and a note that
   begins with # is a remark. */
int read_notes(const opc_host *host, const opc_gates *gates, wish *out,
               opc_error *error);

#endif
