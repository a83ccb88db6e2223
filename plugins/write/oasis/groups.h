/* SPDX-License-Identifier: BSD-3-Clause */
/* The shapes of one layer of a cell, equal ones put together as repetitions. */
#ifndef OPCFLOW_OASIS_GROUPS_H
#define OPCFLOW_OASIS_GROUPS_H

#include "../../read/layer_number.h"
#include "pack.h"

/* A shape, by its first point. */
typedef struct group_shape {
  opc_point at;
  uint32_t n;   /* points; 2 for a box, whose corners they are */
  size_t start; /* in `points`: those after the first, from it */
} group_shape;

typedef struct group_step {
  int64_t x, y;
} group_step;

typedef struct groups {
  group_shape *shapes;
  size_t n, room;
  group_step *points;
  size_t n_points, room_points;
} groups;

/* Add a shape; 0 without memory. */
int groups_add(groups *g, const opc_point *points, size_t n);
/* Whether it is time to write, for there are many. */
int groups_full(const groups *g);
/* Write all and forget them. */
void groups_put(groups *g, pack *p, layer_number layer);
void groups_clear(groups *g);

#endif
