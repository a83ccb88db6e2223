/* SPDX-License-Identifier: BSD-3-Clause */
/* Assist features by rules: rows of bars beside edges with open space (C. A.
   Mack, Fundamental Principles of Optical Lithography, 2007, chapter 10). They
   are too narrow to print by themselves and make an isolated edge print more
   like a dense one. */
#ifndef EDA_BARS_H
#define EDA_BARS_H

#include <eda/imaging.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Where bars are placed, in grid steps. */
typedef struct eda_bar_rule {
  int32_t rows;            /* beside an edge; 0: none */
  int32_t width, distance; /* of a bar; from drawn shapes */
  int32_t space;           /* between bars */
  int32_t min_length;
  int32_t overhang; /* past the ends of the edge */
} eda_bar_rule;

/* An edge that is to have bars: from `low` to `high` along it, at the
   coordinate `at` of the other direction. */
typedef struct eda_bar_edge {
  uint8_t upright;       /* 1: `at` is an x */
  int8_t sign;           /* 1: the outside has larger coordinates; -1 */
  int32_t at, low, high; /* low <= high */
} eda_bar_edge;

/* The bars of all edges into *out, which is empty before and freed by the
   caller (`box`). They keep `distance` off the `drawn` shapes (merged) and
   `space` off each other, first rows before others, then long ones first; what
   is cut shorter than min_length is left out. OPC_INVALID as of eda_fracture.
   [any] */
OPC_EXPORT int eda_bars_place(const eda_bar_edge *edges, size_t n,
                              const eda_bar_rule *rule, const eda_shapes *drawn,
                              eda_box_list *out, opc_error *error);

/* Drop the bars that print, or come nearer to it than `margin` of the level
   set; how many. Units of `grid` nm. [main] */
OPC_EXPORT size_t eda_bars_drop(const opc_context *context, eda_box_list *bars,
                                const eda_field *print, double grid,
                                double margin);

#ifdef __cplusplus
}
#endif
#endif
