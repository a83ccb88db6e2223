/* SPDX-License-Identifier: BSD-3-Clause */
/* Sub-resolution assist features (SRAF), here called scatter bars: rows beside
   edges with open space (C. A. Mack, Fundamental Principles of Optical
   Lithography, 2007, chapter 10). The scatter bars are too narrow to print and
   make the image of an isolated edge similar to that of a dense edge. [any],
   [main]: see opcflow/plugin.h. */
#pragma once

#include <eda/imaging.h>

OPC_C_BEGIN

/* Placement rules for scatter bars, in grid steps. */
typedef struct eda_sraf_rule {
  int32_t rows;            /* rows beside an edge; 0: none */
  int32_t width, distance; /* width of a scatter bar; distance from drawn
                              shapes */
  int32_t space;           /* spacing between scatter bars */
  int32_t min_length;      /* smallest length */
  int32_t overhang;        /* extension beyond the ends of the edge */
} eda_sraf_rule;

/* An edge that needs scatter bars, from `low` to `high` along the edge; `at` is
   the coordinate across the edge. */
typedef struct eda_sraf_edge {
  uint8_t upright;       /* 1: `at` is an x coordinate */
  int8_t sign;           /* side of the scatter bars: 1: larger coordinates; -1:
                            smaller */
  int32_t at, low, high; /* low <= high */
} eda_sraf_edge;

/* Place the scatter bars of all edges. *out must be empty; the caller frees
   `out->box`. Scatter bars keep `distance` from the `drawn` shapes (merged) and
   `space` from each other. Inner rows have priority over outer rows, then
   longer over shorter scatter bars. Scatter bars clipped to less than
   min_length are omitted. Errors: as eda_fracture. [any] */
OPC_EXPORT int eda_srafs_place(const eda_sraf_edge *edges, size_t n,
                               const eda_sraf_rule *rule,
                               const eda_shapes *drawn, eda_box_list *out,
                               opc_error *error);

/* Remove the scatter bars that print or nearly print: the level set on the
   scatter bar exceeds -margin. Return the number of removed scatter bars.
   Coordinates are in units of `grid` nm. [main] */
OPC_EXPORT size_t eda_srafs_drop(const opc_context *context,
                                 eda_box_list *srafs, const eda_field *print,
                                 double grid, double margin);

/* Limits for scatter bars placed by a gradient map; lengths in grid steps. */
typedef struct eda_sraf_limits {
  size_t most;                       /* largest number of scatter bars */
  double min_gain;                   /* smallest gain of a scatter bar, nm^2 */
  int32_t least_width, most_width;   /* smallest and largest width */
  int32_t least_length, most_length; /* smallest and largest length;
                                        least_length is at least least_width */
  int32_t distance, space; /* distance from drawn shapes (merged); spacing
                              between scatter bars */
} eda_sraf_limits;

/* Add to *srafs the rectangles with the largest gain that keep the spacing of
   `rule`. `map` contains values at nodes: the cost per nm^2 of a scatter bar
   (eda_coherent_gradient); the gain of a scatter bar is minus its total cost.
   The edges of scatter bars are midway between nodes, rounded to `grid` nm.
   Errors: see eda_fracture. [any] */
OPC_EXPORT int eda_srafs_search(const eda_field *map,
                                const eda_sraf_limits *rule,
                                const eda_shapes *drawn, double grid,
                                eda_box_list *srafs, opc_error *error);

/* Return the gain of a scatter bar on a map of eda_srafs_search, nm^2. [any] */
OPC_EXPORT double eda_srafs_gain(const eda_field *map, eda_box sraf,
                                 double grid);

/* Narrow the scatter bars that eda_srafs_drop would remove: move both long
   sides inwards by `by` grid steps. Remove scatter bars that are then narrower
   than `least`, and add their number to *dropped. Return the number of changed
   scatter bars. [main] */
OPC_EXPORT size_t eda_srafs_narrow(const opc_context *context,
                                   eda_box_list *srafs, const eda_field *print,
                                   double grid, double margin, int32_t by,
                                   int32_t least, size_t *dropped);

OPC_C_END
