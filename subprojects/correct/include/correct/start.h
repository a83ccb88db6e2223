/* SPDX-License-Identifier: BSD-3-Clause */
/* What a correction begins with besides the drawn mask, and what another one
   can begin with after it. */
#ifndef CORRECT_START_H
#define CORRECT_START_H

#include <eda/gates.h>
#include <opcflow/plugin.h>

struct loop;

typedef struct loop_start {
  const eda_mask *mask; /* NULL: the drawn edges */
  /* %, if there is a mask: only transistors move whose |Ion deviation| is
     greater by more in the first print than it was `before` in the mask (thesis
     eq. 4.1), or that do not print; NAN: all do. */
  double max_diff;
} loop_start;

/* OPC_INVALID if that is no start for the gates. */
OPC_EXPORT int correct_start_check(const loop_start *start,
                                   const eda_gates *gates, opc_error *error);

/* The start was printed: who keeps his mask. */
OPC_EXPORT int correct_start_hold(struct loop *loop, opc_error *error);

/* What the regulator of the start has added beside a place where its print does
   not keep a rule, or taken away, is given up: it was for other neighbours. The
   rest stays, as a regulator sees what a print needs with it, and not what it
   would need without. */
OPC_EXPORT void correct_start_prune(struct loop *loop);

/* From what the optics' own print shows of Ion to what a fine one would, as far
   as that is known. */
OPC_EXPORT void correct_start_correct(const eda_moved *moved,
                                      eda_performance *printed);

/* The mask of a layer that moves make of the drawn edges. As of eda_boolean. */
OPC_EXPORT int correct_start_mask(const eda_gates *gates,
                                  const eda_moved *moved, size_t layer,
                                  eda_shapes *out, opc_error *error);

/* What `now` of a loop has moved; NULL if that is more than a start can have.
 */
OPC_EXPORT eda_moved *correct_moved_of(const struct loop *loop);

/* Thesis eq. 4.1 of transistor i of a mask that printed so, %; NAN if it does
   not print. */
OPC_EXPORT double correct_start_disturbance(const eda_mask *mask,
                                            const eda_performance *printed,
                                            const uint32_t *flags, size_t i);

#endif
