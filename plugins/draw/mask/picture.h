/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of draw.mask. */
#ifndef OPCFLOW_DRAW_PICTURE_H
#define OPCFLOW_DRAW_PICTURE_H

#include "../legend.h"

typedef struct picture {
  view view;
  const opc_mask *mask;
  double range; /* the deviation at the ends of the scale, % */
} picture;

/* ---- mask.c ---- */

/* 100 (a - b) / b of the drive current of a transistor, thesis eq. 3.1; NAN
   where it has none. */
double picture_deviation(const opc_performance *p, const opc_mask *mask,
                         size_t gate);

/* Whether it does not print as a transistor of its own; notes on its print are no
   failure. */
int picture_fails(const opc_mask *mask, size_t gate);

/* ---- the parts of a view, of a `picture` ---- */

/* shapes.c: everything in the window. */
int picture_shapes(const void *data, opc_error *error);

/* legend.c: what stands above and below the window, from `top` on; returns its
   height. Only measured if `draw` is 0. */
double picture_title(const void *data, double top, int draw);
double picture_legend(const void *data, double top, int draw);

#endif
