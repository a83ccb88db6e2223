/* SPDX-License-Identifier: BSD-3-Clause */
/* What is drawn around a transistor, as one sum. */
#ifndef CORRECT_CHIP_SURROUND_H
#define CORRECT_CHIP_SURROUND_H

#include <eda/gates.h>

enum { SUM_SIZE = 16 };

/* Equal sums are equal surroundings, seen with `flip` (EDA_FLIP_*) along the
   transistor's own L and W: SHA-256, cut to 16 bytes, of 128 bits of hashes of
   what is there, so that no two others of 10^9 are taken for one with a chance
   above 10^-20. */
typedef struct surround {
  uint8_t sum[SUM_SIZE];
  uint8_t flip;
} surround;

/* Of all gates of a window that start in its core: the shapes of all its layers
   within `radius` grid steps of the gate's box, its sizes, its type and what is
   written upon it. The window shows that much around them. Others are left as
   they are. `ways`: what is alike, 8: however it lies; 4: but for a swap of x
   and y; 1: as it is only. OPC_INVALID for a transistor that is too large. By
   all threads. [any] */
int surround_all(const opc_context *context, const eda_gates *window,
                 eda_box core, int32_t radius, int ways, surround *out,
                 opc_error *error);

/* Whether a box starts, with its low-low corner, in the core. [any] */
int surround_starts(eda_box core, eda_box b);

#endif
