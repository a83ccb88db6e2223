/* SPDX-License-Identifier: BSD-3-Clause */
/* Construction of the mask polygons of a layer from edge displacements. */
#pragma once

#include <eda/gates.h>
#include <eda/synthesizer.h>

/* Displacements of all gates, in grid steps (see eda_moves). For gate i: w[i]
   and l[i] are the biases of width and length; aside[i] is the shift of the
   active along the width; jog[i] is the length of a jog. Line ends are end[2 *
   i + side]; parts of the width are part[EDA_PARTS * i + k]. The arrays are
   contiguous: first w and aside of active, then the arrays of poly. */
typedef struct biases {
  int32_t *w, *aside, *l, *jog, *end;
  eda_part *part;
  /* Displacements of an earlier correction, which are added; NULL: none. */
  const eda_moved *base;
} biases;

/* Write w, aside and l of `out` so that these alone displace both active edges,
   and both poly edges together, of all gates as `from` with its base does. */
OPC_EXPORT void correct_biases_add_base(const biases *from, size_t gates,
                                        biases *out);

/* Edges of a layer, dissected into fragments. Polygon p consists of fragments
   start[p] to start[p+1]-1. Fragment i, parallel to an axis, extends from
   from[i] to the start of the polygon's next fragment. The outward displacement
   of fragment i is by[i] grid steps. */
typedef struct pieces {
  size_t polygons, capacity;
  uint32_t *start;
  eda_point *from;
  int32_t *by;
} pieces;

/* Allocate fragments. correct_pieces_of_edges allocates as many fragments as
   the displacements of a layer's gates can require; `base`: 1: also those of an
   earlier correction. correct_pieces_of_cuts copies the fragments of a
   synthesizer and sets their displacements to 0. */
OPC_EXPORT void correct_pieces_of_edges(const eda_edges *edges, int base,
                                        pieces *out);
OPC_EXPORT void correct_pieces_of_cuts(const eda_cuts *cuts, pieces *out);
/* Free the fragments. */
OPC_EXPORT void correct_pieces_clear(pieces *pieces);

/* Set the fragments of a layer's edges and displace them by the biases of their
   gates. */
OPC_EXPORT void correct_pieces_follow(const eda_gates *gates, size_t layer,
                                      const biases *biases, pieces *out);

/* Allocate the polygons that correct_pieces_build writes. */
OPC_EXPORT void correct_pieces_alloc(const pieces *pieces, eda_shapes *out);

/* Write the polygons of displaced fragments to the points and starts of `out`,
   in the order of `pieces`, without repeated or collinear corners. A polygon
   that vanishes has no points. Polygons overlap if displacements close a gap.
 */
OPC_EXPORT void correct_pieces_build(const pieces *pieces, eda_shapes *out);

/* Several lists of boxes. */
typedef struct boxes_lists {
  const eda_boxes *list;
  size_t count;
} boxes_lists;

/* Write all boxes of the lists as rectangles. The caller frees `out`. */
OPC_EXPORT void correct_shapes_of_boxes(boxes_lists boxes, eda_shapes *out);

/* Compute the mask of a layer: polygons and added boxes, minus the cut-outs, as
   merged polygons. Returns the codes of eda_boolean. */
OPC_EXPORT int correct_mask_merge(const eda_shapes *polygons, boxes_lists added,
                                  boxes_lists cutouts, eda_shapes *out,
                                  opc_error *error);
