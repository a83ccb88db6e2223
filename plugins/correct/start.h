/* SPDX-License-Identifier: BSD-3-Clause */
/* What a correction begins with besides the drawn mask, and what another one
   can begin with after it. */
#ifndef CORRECT_START_H
#define CORRECT_START_H

#include <eda/gates.h>
#include <opcflow/plugin.h>

struct loop;

typedef struct start {
  const eda_moved *base; /* the mask's own; NULL: as drawn */
  uint8_t
      *still; /* 1: that transistor keeps its mask (free); NULL: none does */
} start;

/* From a mask of these gates, or NULL. `max_diff`, %: only transistors move
   whose |Ion deviation| has grown by more from before to after, thesis eq. 4.1,
   or that do not print; NAN: all do. OPC_INVALID if the mask is no start. */
int start_from(const opc_host *host, const eda_gates *gates,
               const eda_mask *mask, double max_diff, start *out,
               opc_error *error);

/* The mask of a layer that moves make of the drawn edges. As of eda_boolean. */
int start_mask(const eda_gates *gates, const eda_moved *moved, size_t layer,
               eda_shapes *out, opc_error *error);

/* What `now` of a loop has moved; NULL if that is more than a start can have.
 */
eda_moved *moved_of(const struct loop *loop);

/* Thesis eq. 4.1 of transistor i, %; NAN if it does not print. */
double start_disturbance(const eda_mask *mask, size_t i);

#endif
