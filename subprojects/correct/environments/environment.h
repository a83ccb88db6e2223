/* SPDX-License-Identifier: BSD-3-Clause */
/* Checksums of the drawn environment of transistors. */
#pragma once

#include <eda/gates.h>

/* Length of a checksum, bytes. */
enum { SUM_SIZE = 16 };

/* Checksum of an environment, mirrored by `flip` (EDA_FLIP_*) along the
   transistor's L and W. The checksum is a SHA-256 of two 64-bit hash sums,
   truncated to 16 bytes. The probability of a collision among 10^9 environments
   is below 10^-20. */
typedef struct environment {
  uint8_t sum[SUM_SIZE];
  uint8_t flip;
} environment;

/* Compute the environments of those gates of a window whose box has its lower
   left corner in `core`, the part of the window that this call covers. An
   environment consists of the shapes of all layers within `radius` grid steps
   of the gate's box, and of the gate's type, flavour, sizes and goal. The axis
   of the gate is a part unless all 8 orientations are equivalent. The window
   must contain these shapes. `out`, [gates], is not changed for other gates.
   `orientations`: number of equivalent orientations: 8, 4 (no exchange of x and
   y) or 1. Returns OPC_INVALID if a transistor is too large. Uses all threads;
   callable from any thread. */
int environments_find(const opc_context *context, const eda_gates *window,
                      eda_box core, int32_t radius, int orientations,
                      environment *out, opc_error *error);

/* Add the hashes of a number to two sums. The sums do not depend on the order
   of the numbers; if both sums (128 bits) are equal, the sets of numbers are
   taken as equal. Callable from any thread. */
void environment_add(uint64_t sum[2], uint64_t number);

/* Return 1 if the lower left corner of a box is in the core. Callable from any
   thread. */
int environment_starts(eda_box core, eda_box b);
