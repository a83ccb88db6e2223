/* SPDX-License-Identifier: BSD-3-Clause */
/* Rules of the mask itself: how narrow its shapes and the spaces between them
   are. */
#ifndef OPCFLOW_REGULATOR_MRC_H
#define OPCFLOW_REGULATOR_MRC_H

#include "bins.h"
#include "rules.h"

/* Places of merged shapes that are narrower than `width`, or closer together
   than `space` (nm, also within a polygon): edges that face each other with
   nothing between them, and corners that do so diagonally. 0 if there is no
   memory. */
int mrc_check(const opc_shapes *shapes, double grid, double width,
              double space, violations *out);

#endif
