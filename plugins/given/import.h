/* SPDX-License-Identifier: BSD-3-Clause */
/* Import of the shapes of a mask from a layout, with checks that position and
   size of the shapes match the drawn layout of the gates. */
#pragma once

#include <eda/gates.h>
#include <eda/layout.h>
#include <opcflow/plugin.h>

/* Layout of a mask, and the gates that it must match. */
typedef struct import {
  const opc_host *host;
  const eda_gates *gates;
  const eda_layout *layout;
  const char *top; /* cell of the mask. NULL stands for the cell with the name
                      of the gates or, without such a cell, the only top
                      cell. */
  opc_map layers;  /* key: layer of the gates; value: layer of the layout */
  double margin;   /* simulated margin around the drawing, nm */
} import;

/* Read the shapes of all corrected layers into mask->shapes, which must be
   empty. Shapes are merged on the grid of the gates. Layers that the map does
   not name are as drawn. Publishes the number of vertices off the grid as the
   metric snapped, and the largest distance to the grid, nm, as snapped_worst.
 */
int import_shapes(const import *import, eda_mask *mask, opc_error *error);
