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

/* Bars that a map asks for, lengths in grid steps. */
typedef struct eda_bar_seek {
  size_t most;                       /* bars in all */
  double worth;                      /* what one gains at least, nm^2 */
  int32_t least_width, most_width;   /* of a bar */
  int32_t least_length, most_length; /* as least_width at least */
  int32_t distance, space; /* from drawn shapes (merged); between bars */
} eda_bar_seek;

/* Add to *bars, which keep clear of those that are there, the rectangles that
   gain most: what a nm^2 of bar costs at a place is what `map` has at its nodes
   (as eda_coherent_gradient gives it), and the gain of a bar is minus the sum.
   Their edges lie between nodes, rounded to the grid of `grid` nm. OPC_INVALID
   as of eda_fracture. [any] */
OPC_EXPORT int eda_bars_seek(const eda_field *map, const eda_bar_seek *rule,
                             const eda_shapes *drawn, double grid,
                             eda_box_list *bars, opc_error *error);

/* What a bar gains on such a map, nm^2. [any] */
OPC_EXPORT double eda_bars_gain(const eda_field *map, eda_box bar, double grid);

/* Take `by` grid steps from both long sides of the bars that print, or come
   nearer to it than `margin` of the level set; those that become narrower than
   `least` are dropped. How many have changed; *dropped grows. [main] */
OPC_EXPORT size_t eda_bars_narrow(const opc_context *context,
                                  eda_box_list *bars, const eda_field *print,
                                  double grid, double margin, int32_t by,
                                  int32_t least, size_t *dropped);

#ifdef __cplusplus
}
#endif
#endif
