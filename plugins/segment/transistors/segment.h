/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files of segment.transistors share. Coordinates are in units of the
   mask grid. Directions: something "across d" has a constant coordinate along
   d and extends along the other direction. */
#ifndef OPCFLOW_SEGMENT_H
#define OPCFLOW_SEGMENT_H

#include <opcflow/gates.h>
#include <opcflow/layout.h>

enum { NWELL, PWELL, NIMPLANT, PIMPLANT, DOPINGS };
enum { LOW = 0, HIGH = 1 }; /* sides */

/* An edge of merged shapes, across `across`, on the `side` of the interior. */
typedef struct edge {
  uint8_t across, side;
  int32_t at, low, high;   /* its constant coordinate; its ends */
  uint32_t polygon, point; /* from points[point] to the next of the polygon */
} edge;

/* All edges of a layer, sorted by across, side, at, low: those of
   [across][side] are edges[first[2 * across + side]] and on. */
typedef struct edge_index {
  edge *edges;
  size_t count;
  size_t first[5];
} edge_index;

/* The output: the gates and what only release needs. */
typedef struct owned_gates {
  opc_gates gates; /* the first member */
  const opc_host *host;
  char *names; /* all instance paths */
} owned_gates;

typedef struct segment {
  const opc_host *host;
  opc_error *error;
  const opc_layout *layout;
  int32_t top;
  double grid;
  int32_t overhang, line_end;
  opc_flat active;            /* as drawn, for where gates come from */
  opc_shapes doping[DOPINGS]; /* merged */
  int has_doping[DOPINGS];    /* whether the layout has that layer */
  opc_shapes regions;         /* poly and active together */
  edge_index index[OPC_MASKS];
  uint32_t *placement; /* of each region */
  opc_gates *gates;    /* of *owned */
  owned_gates *owned;
} segment;

static inline int32_t box_side(const opc_box *b, int d, int side) {
  return d == OPC_X ? (side ? b->x1 : b->x0) : (side ? b->y1 : b->y0);
}

/* Each returns an OPC_* code, with *s->error filled. */

/* edges.c: the index of both layers; the edge that covers [low, high] across d
   at `at` on that side, NULL if none does alone. */
int segment_index(segment *s);
const edge *segment_edge(const edge_index *index, int d, int side, int32_t at,
                         int32_t low, int32_t high);

/* place.c: in which placement of the active layer each region lies; and the
   number of the first of `shapes` that contains each point, UINT32_MAX where
   none does. Coordinates of points are doubled, so that middles are integers;
   of two shapes that abut, the one to the right or above contains the edge. */
typedef struct doubled {
  int64_t x, y;
} doubled;
int segment_locate(segment *s);
int segment_find(segment *s, const doubled *points, size_t n,
                 const opc_shapes *shapes, uint32_t *which);

/* recognise.c: box and axis of each region, or why it is no transistor; then
   its type. */
int segment_recognise(segment *s);

/* cut.c: the fragments of both layers, and how far poly goes past active. */
int segment_cut(segment *s);

/* room.c: the free room beside each gate. */
int segment_room(segment *s);

/* name.c: instance, cell and number of each gate. */
int segment_name(segment *s);

/* notes.c: what is written upon each gate. */
int segment_notes(segment *s);

static inline int segment_no_memory(segment *s) {
  s->host->fail(s->host, s->error, OPC_FAILED, NULL, "out of memory");
  return OPC_FAILED;
}

/* Refuse region i: OPC_INVALID with its place and the fault. */
int segment_refuse(segment *s, size_t i, const char *fault);

/* The path of a placement, allocated; NULL if there is no memory. */
char *segment_path(const segment *s, uint32_t placement, int32_t *cell);

#endif
