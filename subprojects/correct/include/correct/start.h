/* SPDX-License-Identifier: BSD-3-Clause */
/* Start of a correction from an earlier mask, and conversion of a corrected
   mask to such a start. */
#pragma once

#include <eda/gates.h>
#include <eda/regulator.h>
#include <opcflow/plugin.h>

#include <correct/trial.h>

struct loop;

/* Start of a loop. */
typedef struct loop_start {
  const eda_mask *mask; /* NULL: start from the drawn edges */
  /* Displacements of the transistors that may be corrected, for a synthesizer
     that continues from them (EDA_SYNTHESIZER_CONTINUES), instead of those of
     `mask`; 0 for all other transistors. Orientations (`flip`) and added shapes
     are not used. NULL: no displacements. */
  const eda_moved *from;
  /* [gates], with `from`: a transistor with loop.still = 1 keeps its mask until
     its |Ion deviation| in a simulation exceeds this value, %, or until it
     violates a rule in the first simulation; INFINITY: always. NULL: loop.still
     does not change. */
  const double *limit;
  /* [2 * layers], with `limit`: numbers of the transistors to which the shapes
     belong that `mask` adds to a layer, then to which its cut-outs belong. The
     loop removes the shapes of a transistor that it begins to correct, and the
     regulator repairs the mask anew. Changed by the loop. */
  uint32_t **owner;
} loop_start;

/* Return OPC_INVALID if the mask is by classes, belongs to other gates or has
   no displacements. */
OPC_EXPORT int correct_start_check(const loop_start *start,
                                   const eda_gates *gates, opc_error *error);

/* Set the base, the begun shapes and the next mask of a loop to those of its
   start. */
OPC_EXPORT void correct_start_begin(struct loop *loop);

/* Return w, aside and l of the simulated mask from the drawn edges, for
   regulators: the loop's biases and, with a start, its base. The arrays belong
   to the loop, and change with the next call. */
OPC_EXPORT const biases *correct_start_whole(const struct loop *loop);

/* Values of loop.still. STILL_BEGUN: the transistor keeps the mask of the
   start. STILL_WITHIN: the loop has corrected the transistor, which is within
   its limit and keeps its displacements while it is. */
enum { STILL_BEGUN = 1, STILL_WITHIN };

/* With `limit`, select the transistors that the last simulation requires to
   correct. With `violations`, these are the transistors that violate a rule of
   the regulator in the first simulation, otherwise those beyond `limit`; others
   keep their present masks. */
OPC_EXPORT void correct_start_open(struct loop *loop, int violations);
/* Return 1 if the loop has a `limit` and all transistors keep their masks. */
OPC_EXPORT int correct_start_is_done(const struct loop *loop);

/* Set the next displacements of transistors that keep their masks: those of the
   start, or the present ones, except line ends and displacements that the
   regulator vetoes. With `limit`, a transistor whose line ends the regulator
   displaces no longer keeps the mask of the start. */
OPC_EXPORT void correct_start_keep(struct loop *loop);

/* With `limit`, select the transistors whose shapes in a layer touch a shape
   that the regulator adds or cuts out. Both together can violate mask
   rules. */
OPC_EXPORT void correct_start_open_touched(struct loop *loop, size_t layer,
                                           const eda_ruling *by);

/* Set the displacements of gate i to those from which the loop starts; with
   `ends`, also those of its line ends. correct_start_reset_ends: only those of
   its line ends. */
OPC_EXPORT void correct_start_reset(const loop_start *start, biases *biases,
                                    size_t i, int ends);
OPC_EXPORT void correct_start_reset_ends(const loop_start *start,
                                         biases *biases, size_t i);

/* Remove the shapes that the earlier regulator added or cut out near violations
   of the first simulation, because these shapes were made for other neighbours.
   Keep all other shapes, because the regulator cannot detect a fault that a
   shape already repairs. */
OPC_EXPORT void correct_start_prune(struct loop *loop);

/* Multiply Ion of a fast simulation by exp(-moved->seen), to approximate the
   Ion of an accurate simulation. The factor is the ratio of accurate to fast
   Ion in the earlier correction. */
OPC_EXPORT void correct_start_correct(const eda_moved *moved,
                                      eda_performance *printed);

/* Write the polygons of a layer's displaced edges, without added shapes and
   cut-outs. The caller frees `out`. */
OPC_EXPORT void correct_start_polygons(const eda_gates *gates,
                                       const eda_moved *moved, size_t layer,
                                       eda_shapes *out);

/* Compute the mask of a layer from the drawn edges and displacements. Returns
   the codes of eda_boolean. */
OPC_EXPORT int correct_start_mask(const eda_gates *gates,
                                  const eda_moved *moved, size_t layer,
                                  eda_shapes *out, opc_error *error);

/* Compute the masks of all corrected layers of a new mask from mask->moved. */
OPC_EXPORT int correct_start_shapes(eda_mask *mask, opc_error *error);

/* Return the displacements of the loop's mask, or NULL if eda_moved cannot
   represent them. Free with eda_moved_free(). */
OPC_EXPORT eda_moved *correct_moved_of(const struct loop *loop);
