/* SPDX-License-Identifier: BSD-3-Clause */
/* Line and pitch of the transistors of a layout, for the default anchor. */
#pragma once

#include <eda/gates.h>

/* Line and pitch, with the numbers of gates and pitches from which they were
   found. */
typedef struct resist_drawn {
  double line, pitch; /* length of the shortest gate, and pitch, nm */
  size_t gates;       /* number of gates of length `line` */
  size_t pitches;     /* number of pitches between such gates; if 0, `pitch` is
                         assumed */
  size_t equal;       /* number of pitches equal to `pitch` */
} resist_drawn;

/* Find the length of the shortest gate and the most frequent centre-to-centre
   distance of two such gates side by side. The shortest length is the nominal
   length of a process and occurs in nearly every cell, while the most frequent
   length varies between cells. The smallest pitch is not used: even a single
   pair of gates in series without a contact would define the pitch. Return 0 if
   `gates` is empty. */
int resist_drawn_of(const eda_gates *gates, resist_drawn *out);
