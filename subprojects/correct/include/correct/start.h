/* SPDX-License-Identifier: BSD-3-Clause */
/* Start of a correction from an earlier mask, and its inverse. */
#pragma once

#include <eda/gates.h>
#include <opcflow/plugin.h>

struct loop;

typedef struct loop_start {
  const eda_mask *mask; /* NULL: start from the drawn edges */
  /* Largest increase of |Ion deviation| (thesis eq. 4.1), %, from `before` of
     the mask to the first simulation, up to which a transistor keeps its mask.
     Transistors that do not print always move; NAN: all do. */
  double max_diff;
} loop_start;

/* Return OPC_INVALID if the start does not belong to the gates or has no
   displacements. */
OPC_EXPORT int correct_start_check(const loop_start *start,
                                   const eda_gates *gates, opc_error *error);

/* Select the transistors that keep their masks (loop.still) after the first
   simulation. */
OPC_EXPORT int correct_start_hold(struct loop *loop, opc_error *error);

/* Remove shapes that the start's regulator added or cut out near violations of
   the first simulation: they were made for other neighbours. All other shapes
   are kept, since a regulator cannot detect a fault that they already
   repair. */
OPC_EXPORT void correct_start_prune(struct loop *loop);

/* Correct Ion of a fast simulation towards that of an accurate one, by the
   ratios stored in `moved`. */
OPC_EXPORT void correct_start_correct(const eda_moved *moved,
                                      eda_performance *printed);

/* Compute the mask of a layer from the drawn edges and displacements. Returns
   the codes of eda_boolean. */
OPC_EXPORT int correct_start_mask(const eda_gates *gates,
                                  const eda_moved *moved, size_t layer,
                                  eda_shapes *out, opc_error *error);

/* Return the displacements of the loop's mask, or NULL if they cannot be the
   start of a correction. Free with eda_moved_free(). */
OPC_EXPORT eda_moved *correct_moved_of(const struct loop *loop);

/* Return the disturbance of transistor i by thesis eq. 4.1, %; NAN: it does not
   print. */
OPC_EXPORT double correct_start_disturbance(const eda_mask *mask,
                                            const eda_performance *printed,
                                            const uint32_t *flags, size_t i);
