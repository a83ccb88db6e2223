/* SPDX-License-Identifier: BSD-3-Clause */
/* The shapes of a mask from a layout, and whether they can be that of these
   gates. */
#ifndef GIVEN_TAKE_H
#define GIVEN_TAKE_H

#include <eda/gates.h>
#include <eda/layout.h>
#include <opcflow/plugin.h>

typedef struct take {
  const opc_host *host;
  const eda_gates *gates;
  const eda_layout *layout;
  const char *top; /* NULL: the cell that is called as the gates are, or the
                      only one that no other places */
  opc_map layers;  /* layer of the gates: layer of the layout */
  double margin;   /* nm around the drawing that is printed */
} take;

/* Shapes of all corrected layers, merged, on the grid of the gates, into empty
   mask->shapes; layers that the map does not name are as drawn. Tells of what
   the grid moved: the metrics snapped and snapped_worst. */
int take_shapes(const take *take, eda_mask *mask, opc_error *error);

#endif
