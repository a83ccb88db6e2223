/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files of this folder share. Coordinates are in units of the mask
   grid. Directions: something "across d" has a constant coordinate along d and
   extends along the other direction. */
#ifndef EDA_SEGMENT_SEGMENT_H
#define EDA_SEGMENT_SEGMENT_H

#include <eda/memory.h>
#include <eda/segment.h>

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

/* A layer of the gates: where it is drawn, and its shapes on their way there.
 */
typedef struct source {
  const char *name;
  const char *from; /* layer of the layout */
  eda_shapes drawn;
  int drawn_at_all; /* anywhere in the layout */
} source;

typedef struct segment {
  const opc_context *context;
  opc_error *error;
  const eda_layout *layout;
  int32_t top;
  const eda_segment_settings *settings;
  const eda_box *window; /* NULL: all is seen */
  eda_box bounds;        /* of the layout's layers */
  double grid;
  int32_t overhang, line_end; /* NOT_GIVEN: of each gate */
  int32_t reach;
  source *source; /* poly, active, contact, then those of `also` */
  size_t sources;
  eda_flat active;            /* as drawn, for where gates come from */
  eda_shapes doping[DOPINGS]; /* merged */
  int has_doping[DOPINGS];    /* whether the layout has that layer */
  eda_shapes regions;         /* poly and active together */
  edge_index index[2];        /* of poly and active */
  uint32_t *placement;        /* of each region */
  size_t moved;               /* vertices of poly and active, by the grid */
  eda_segment_report report;
  eda_gates *gates;
} segment;

/* What a length is that is not given. A line end is as long as a process's
   least gate or a little longer (its rules: 72 nm at 65, 130 at 150, 220 at
   280, 600 at 600), and how far poly beyond the active counts goes with what
   the optics resolve, of which the gate is half or less. */
enum { NOT_GIVEN = -1 };

static inline int32_t box_side(const eda_box *b, int d, int side) {
  return d == EDA_X ? (side ? b->x1 : b->x0) : (side ? b->y1 : b->y0);
}

/* cut.c: how far past the active gate i owns the edges of poly, and how far
   away a line end may be, in grid units. */
int32_t segment_overhang(const segment *s, size_t i);
int32_t segment_line_end(const segment *s, size_t i);

/* layers.c: a layer below a cell as drawn and merged, both empty on failure; of
   a window what touches it as drawn, and merged what lies in it. */
int segment_flatten(const eda_layout *layout, int32_t top, int32_t layer,
                    double grid, const eda_box *window, eda_flat *flat,
                    eda_shapes *merged, opc_error *error);

/* Make a layer of the gates, whose shapes go to them; one fragment an edge, of
   no transistor. */
void segment_set_layer(eda_gates *gates, size_t layer, const char *name,
                       int corrected, eda_shapes *drawn);
void segment_cut_plain(eda_gates *gates, size_t layer);

/* segment.c: a message for the user, if there is somebody to take it. */
OPC_PRINTF(3, 4)
void segment_tell(const segment *s, int warning, const char *format, ...);

/* Those that return int give an OPC_* code, with *s->error filled. */

/* edges.c: the index of poly and active; the edge that covers [low, high]
   across d at `at` on that side, NULL if none does alone. */
void segment_index(segment *s);
const edge *segment_edge(const edge_index *index, int d, int side, int32_t at,
                         int32_t low, int32_t high);

/* place.c: in which placement of the active layer each region lies; and the
   number of the first of `shapes` that contains each point, UINT32_MAX where
   none does. Coordinates of points are doubled, so that middles are integers;
   of two shapes that abut, the one to the right or above contains the edge. */
typedef struct doubled {
  int64_t x, y;
} doubled;
void segment_locate(segment *s);
void segment_find(const doubled *points, size_t n, const eda_shapes *shapes,
                  uint32_t *which);

/* recognise.c: box and axis of each region, or why it is no transistor; then
   its type. */
int segment_recognise(segment *s);

/* How a region lies with respect to a layer: neither touched, all within, or
   in part. `state` has one of each region. */
enum { SEGMENT_OUTSIDE = 0, SEGMENT_INSIDE = 1, SEGMENT_PARTLY = 2 };
int segment_cover(segment *s, const eda_shapes *layer, uint8_t *state);

/* flavours.c: which of the process's transistors each gate is. */
int segment_check_flavours(const eda_segment_settings *settings,
                           opc_error *error);
int segment_flavours(segment *s);

/* drawn.c: L and W of each gate as drawn, which the grid has moved. */
int segment_drawn(segment *s);

/* cut.c: the fragments of poly and active, and how far poly goes past active.
 */
void segment_cut(segment *s);

/* space.c: the free space beside each gate. */
void segment_space(segment *s);

/* name.c: instance, cell and number of each gate; of a window without paths
   none. */
void segment_name(segment *s);

/* notes.c: what is written upon each gate. */
int segment_notes(segment *s);

/* Refuse region i: OPC_INVALID with its place and the fault. */
int segment_refuse(segment *s, size_t i, const char *fault);

/* The path of a placement, freed with free(), and the cell that is there, -1
   for none. */
char *segment_path(const segment *s, uint32_t placement, int32_t *cell);

#endif
