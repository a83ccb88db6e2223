/* SPDX-License-Identifier: BSD-3-Clause */
/* The line that a layout's transistors are made of, for an anchor. */
#ifndef OPCFLOW_RESIST_DRAWN_H
#define OPCFLOW_RESIST_DRAWN_H

#include <eda/gates.h>

typedef struct resist_drawn {
  double line, pitch; /* nm */
  size_t gates;       /* of that length */
  size_t pitches;     /* between such gates; 0: pitch is a guess */
  size_t alike;       /* of them, those that are `pitch` */
} resist_drawn;

/* The shortest gate, and the most frequent distance from middle to middle of
   two such gates side by side. The shortest one is what a process has as its
   length, and nearly every cell has it; what is most frequent changes from cell
   to cell. Of pitches the least would be that of gates in series, without a
   contact between them, however few there are. 0: there are no gates. */
int resist_drawn_of(const eda_gates *gates, resist_drawn *out);

#endif
