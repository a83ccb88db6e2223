/* SPDX-License-Identifier: BSD-3-Clause */
/* Sub-resolution assist features (SRAF) by rules: rows of scatter bars beside
   edges with open space (C. A. Mack, Fundamental Principles of Optical
   Lithography, 2007, chapter 10). The scatter bars are too narrow to print and
   make an isolated edge print more like a dense edge. */
#pragma once

#include <eda/imaging.h>

OPC_C_BEGIN

/* Placement rules for scatter bars, in grid steps. */
typedef struct eda_sraf_rule {
  int32_t rows;            /* rows beside an edge; 0: none */
  int32_t width, distance; /* width of a bar; distance from drawn shapes */
  int32_t space;           /* spacing between scatter bars */
  int32_t min_length;
  int32_t overhang; /* overhang past the ends of the edge */
} eda_sraf_rule;

/* An edge that needs scatter bars: from `low` to `high` along the edge, at the
   coordinate `at` of the other direction. */
typedef struct eda_sraf_edge {
  uint8_t upright;       /* 1: `at` is an x coordinate */
  int8_t sign;           /* 1: the outside has larger coordinates; -1:
                            smaller */
  int32_t at, low, high; /* low <= high */
} eda_sraf_edge;

/* Place the scatter bars of all edges. *out must be empty; the caller frees
   `out->box`. Scatter bars keep `distance` from the `drawn` shapes (merged) and
   `space` from each other. First rows take precedence over later rows, then
   long scatter bars over short ones. Scatter bars that are clipped below
   min_length are omitted. Return OPC_INVALID under the conditions of
   eda_fracture. [any] */
OPC_EXPORT int eda_srafs_place(const eda_sraf_edge *edges, size_t n,
                               const eda_sraf_rule *rule,
                               const eda_shapes *drawn, eda_box_list *out,
                               opc_error *error);

/* Remove the scatter bars that print, or whose level set comes within `margin`
   of printing. Return the number of removed scatter bars. Coordinates are in
   units of `grid` nm. [main] */
OPC_EXPORT size_t eda_srafs_drop(const opc_context *context,
                                 eda_box_list *srafs, const eda_field *print,
                                 double grid, double margin);

/* Limits for scatter bars placed by a gradient map; lengths in grid steps. */
typedef struct eda_sraf_limits {
  size_t most;                       /* largest number of scatter bars */
  double min_gain;                   /* smallest gain of a bar, nm^2 */
  int32_t least_width, most_width;   /* width of a bar */
  int32_t least_length, most_length; /* length; at least least_width */
  int32_t distance, space; /* distance from drawn shapes (merged); spacing
                              between scatter bars */
} eda_sraf_limits;

/* Add to *scatter bars the rectangles with the largest gain that keep their
   spacing from the existing scatter bars. `map` holds the cost of one nm^2 of
   bar at each node (see eda_coherent_gradient); the gain of a bar is minus the
   sum of its costs. Bar edges are located between nodes, rounded to the grid of
   `grid` nm. Return OPC_INVALID under the conditions of eda_fracture. [any] */
OPC_EXPORT int eda_srafs_search(const eda_field *map,
                                const eda_sraf_limits *rule,
                                const eda_shapes *drawn, double grid,
                                eda_box_list *srafs, opc_error *error);

/* Return the gain of a bar on such a map, nm^2. [any] */
OPC_EXPORT double eda_srafs_gain(const eda_field *map, eda_box sraf,
                                 double grid);

/* Remove `by` grid steps from both long sides of the scatter bars that print,
   or whose level set comes within `margin` of printing. Scatter bars narrower
   than `least` are removed and counted in *dropped. Return the number of
   changed scatter bars. [main] */
OPC_EXPORT size_t eda_srafs_narrow(const opc_context *context,
                                   eda_box_list *srafs, const eda_field *print,
                                   double grid, double margin, int32_t by,
                                   int32_t least, size_t *dropped);

OPC_C_END
