/* SPDX-License-Identifier: BSD-3-Clause */
/* Records of corrected transistors. A work unit corrects the representatives of
   some classes (one transistor of each class) and writes a record of each.
   correction_take adds the mask of a record to the chip (eda/chip.h), which has
   the masks of all classes. */
#pragma once

#include <correct/loop.h>

#include "work.h"

/* Record of a corrected transistor, followed by its parts and boxes. */
typedef struct corrected {
  uint32_t place, unused; /* number of the transistor, as passed to
                             correction_put; unused: explicit padding */
  eda_chip_mask mask;
  drawn_print before;
  double off; /* |Ion deviation| with `mask`, %; INFINITY: none */
} corrected;

/* Host of a loop on a part of the layout. Progress is scaled to the phase.
   Messages become debug messages, because users do not know the parts. */
typedef struct inner {
  opc_host host;
  work *work;
  size_t done, count; /* finished parts; number of parts */
} inner;

/* Set up the host of a loop; *out must not move in memory. `done`: number of
   finished parts; `count`: number of parts. */
void correction_host(work *work, size_t done, size_t count, inner *out);

/* Append the records of the gates i of a loop with place[i] != UINT32_MAX.
   Return OPC_INVALID if the mask does not consist of displacements of
   transistors. Call on the main thread. */
int correction_put(const work *work, const loop *loop, const uint32_t *place,
                   opc_bytes *out, opc_error *error);

/* Read the record at `at`. Return the next record, or `end`. */
const char *correction_next(const char *at, corrected *out);

/* Read the header before the records at `at`, and add the numbers of
   simulations in the header to those of `work`; `work` may be NULL. Return the
   first record. */
const char *correction_begin(work *work, const char *at);

/* Add the mask of the record at `at` to the chip. Return its number. */
uint32_t correction_take(work *work, const char *at);

/* Correct the representatives of the classes k with mask[k] == UINT32_MAX in
   place, and set mask[k]. */
int correct_in_place(work *work, uint32_t *mask, opc_error *error);
