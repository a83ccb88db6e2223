/* SPDX-License-Identifier: BSD-3-Clause */
/* Boxes (edges are flat ones) in the squares of a grid, so that a window meets
   only what is near. */
#ifndef OPCFLOW_REGULATOR_BINS_H
#define OPCFLOW_REGULATOR_BINS_H

#include <opcflow/geometry.h>

typedef struct bins {
  opc_box extent;
  int32_t side;           /* of a square */
  int32_t nx, ny;
  uint32_t *start;        /* nx * ny + 1, into `item` */
  uint32_t *item;         /* numbers of boxes, by square */
  opc_box *box;
  size_t n;
} bins;

/* Takes over `box` (from malloc), also on failure. 0 if there is no memory. */
int bins_make(bins *b, opc_box *box, size_t n, int32_t side);
void bins_clear(bins *b);

/* Call visit(data, i) once for each box that touches or overlaps `window`. */
void bins_visit(const bins *b, opc_box window,
                void (*visit)(void *data, uint32_t i), void *data);

/* All edges of the shapes as flat boxes, in the order of their points. NULL if
   there is no memory. */
opc_box *bins_edges(const opc_shapes *shapes, size_t *n);

/* The sides of a box, and of what is looked for from there. */
enum { LEFT, RIGHT, BELOW, ABOVE, SIDES };

/* The window that lies outwards from a side, from `from` steps on to `to`,
   `beside` wider on both flanks. */
opc_box bins_window(opc_box box, int side, int32_t from, int32_t to,
                    int32_t beside);

/* How far from the near edge of `window` the nearest box is that it overlaps
   inside, going to `side`, and which (may be NULL); `none` if there is none
   nearer. */
int32_t bins_nearest(const bins *b, opc_box window, int side, int32_t none,
                     opc_box *which);

/* Whether the point lies strictly inside a box. */
int bins_inside(const bins *b, opc_point p);

#endif
