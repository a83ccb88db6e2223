/* SPDX-License-Identifier: BSD-3-Clause */
/* From the moves of a layer's edges to the polygons of its mask. */
#ifndef CORRECT_EDGES_H
#define CORRECT_EDGES_H

#include <eda/gates.h>
#include <eda/synthesizer.h>

/* What moves the mask of each gate, in grid steps (synthesizer.h): width, that
   aside, length, the jog, the line ends, [2 * i + side], and parts of the
   length, [EDA_PARTS * i + k]. They lie one after the other: first what moves
   active, then what moves poly. */
typedef struct biases {
  int32_t *w, *aside, *l, *jog, *end;
  eda_part *part;
  /* What they come upon: where the mask's edges lie if all of them are 0. NULL:
     where they are drawn. */
  const eda_moved *base;
} biases;

/* The edges of a layer, cut into pieces. Polygon p has the pieces start[p] ..
   start[p+1]-1; piece i is drawn from from[i] to the from of the next one of
   its polygon, parallel to an axis, and the mask has it by[i] grid steps
   further out. */
typedef struct pieces {
  size_t polygons, room;
  uint32_t *start;
  eda_point *from;
  int32_t *by;
} pieces;

/* Room for the pieces of a layer's edges, whatever moves them, upon a base if
   there is one; or the pieces that a synthesizer cut, not moved. */
OPC_EXPORT void correct_pieces_of_edges(const eda_edges *edges, int base,
                                        pieces *out);
OPC_EXPORT void correct_pieces_of_cuts(const eda_cuts *cuts, pieces *out);
OPC_EXPORT void correct_pieces_clear(pieces *pieces);

/* The pieces of a layer's edges, moved by the biases of their gates. */
OPC_EXPORT void correct_pieces_follow(const eda_gates *gates, size_t layer,
                                      const biases *biases, pieces *out);

/* Room for the polygons that pieces make. */
OPC_EXPORT void correct_pieces_room(const pieces *pieces, eda_shapes *out);

/* The polygons of moved pieces, in their order: no corner twice, none on a
   straight line. A polygon of which nothing is left has no points. They may
   overlap if the moves close a gap. Writes the points and starts of `out`. */
OPC_EXPORT void correct_pieces_build(const pieces *pieces, eda_shapes *out);

typedef struct boxes_lists {
  const eda_boxes *list;
  size_t count;
} boxes_lists;

/* All boxes as polygons. */
OPC_EXPORT void correct_shapes_of_boxes(boxes_lists boxes, eda_shapes *out);

/* The mask of a layer: its polygons with what is added to them, less the bites.
   It is merged, as what overlaps is not twice as dark. As of eda_boolean. */
OPC_EXPORT int correct_mask_merge(const eda_shapes *polygons, boxes_lists added,
                                  boxes_lists bites, eda_shapes *out,
                                  opc_error *error);

#endif
