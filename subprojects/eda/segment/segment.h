/* SPDX-License-Identifier: BSD-3-Clause */
/* Common declarations of this folder. Coordinates are in units of the mask
   grid. An edge or line "across d" has a constant coordinate d (EDA_X or EDA_Y)
   and extends in the other direction. */
#pragma once

#include <eda/memory.h>
#include <eda/segment.h>

/* Layers that decide the type of a transistor. */
enum { NWELL, PWELL, NIMPLANT, PIMPLANT, DOPINGS };
enum { LOW = 0, HIGH = 1 }; /* sides */

/* An edge of merged shapes. `side` is LOW if the interior is on the side of
   larger coordinates (a left or lower edge), otherwise HIGH. */
typedef struct edge {
  uint8_t across, side;
  int32_t at, low, high;   /* constant coordinate; ends */
  uint32_t polygon, point; /* from points[point] to the next point of the
                              polygon */
} edge;

/* All edges of a layer, sorted by across, side, at, low. The edges of one
   `across` and `side` start at edges[first[2 * across + side]]. */
typedef struct edge_index {
  edge *edges;
  size_t count;
  size_t first[5];
} edge_index;

/* A layer of the gates: its layout layer and its shapes. */
typedef struct source {
  const char *name;
  const char *from; /* layer in the layout */
  eda_shapes drawn;
  int drawn_at_all; /* whether the layout has shapes on `from` */
} source;

/* State of a segmentation. */
typedef struct segment {
  const opc_context *context;
  opc_error *error;
  const eda_layout *layout;
  int32_t top;
  const eda_segment_settings *settings;
  const eda_box *window; /* NULL: no window */
  eda_box bounds;        /* bounds of the layers of the layout */
  double grid;
  int32_t overhang, line_end; /* NOT_GIVEN: scaled by the length of each gate */
  int32_t reach;              /* EDA_SEGMENT_REACH, grid units */
  source *source;             /* poly, active, contact, then settings->also */
  size_t sources;
  eda_flat active;            /* unmerged, with placements */
  eda_shapes doping[DOPINGS]; /* merged */
  int has_doping[DOPINGS];    /* whether the layout has the layer */
  eda_shapes regions;         /* intersection of poly and active */
  edge_index index[2];        /* edges of poly and active */
  uint32_t *placement;        /* placement of each region */
  size_t moved; /* number of vertices of poly and active that snapping to the
                   grid moves */
  eda_segment_report report;
  eda_gates *gates;
} segment;

/* Value of overhang and line_end if the settings have none. Both then follow
   from the gate length, for two reasons. By design rules, a line end is about
   as long as the smallest gate of a process (line end / gate: 72 / 65, 130 /
   150, 220 / 280 and 600 / 600 nm). The relevant overhang of poly scales with
   the optical resolution, and so does the smallest gate length. */
enum { NOT_GIVEN = -1 };

/* Return the coordinate d of a side (LOW, HIGH) of a box. */
static inline int32_t box_side(const eda_box *b, int d, int side) {
  return d == EDA_X ? (side ? b->x1 : b->x0) : (side ? b->y1 : b->y0);
}

/* layers.c: compute the drawn and merged shapes of a layer in cell `top` and
   all cells below; both are empty on failure. For a window, return the drawn
   shapes that touch the window, and the merged shapes clipped to it. */
int segment_flatten(const eda_layout *layout, int32_t top, int32_t layer,
                    double grid, const eda_box *window, eda_flat *flat,
                    eda_shapes *merged, opc_error *error);

/* segment_set_layer sets a layer of `gates` and moves the shapes into it.
   segment_cut_plain adds one fragment for each edge, without a transistor. */
void segment_set_layer(eda_gates *gates, size_t layer, const char *name,
                       int corrected, eda_shapes *drawn);
void segment_cut_plain(eda_gates *gates, size_t layer);

/* segment.c: send a message or warning to the user if the settings have a
   receiver. */
OPC_PRINTF(3, 4)
void segment_log(const segment *s, int warning, const char *format, ...);

/* Functions that return int return an OPC_* code with *s->error filled. */

/* edges.c: segment_index builds s->index. segment_edge returns the edge across
   d at `at` on a side that covers [low, high], or NULL if none does. */
void segment_index(segment *s);
const edge *segment_edge(const edge_index *index, int d, int side, int32_t at,
                         int32_t low, int32_t high);

/* place.c: segment_locate finds the placement of active that contains each
   region. segment_find: which[n] receives, for each point, the number of the
   first of `shapes` that contains the point, or UINT32_MAX. Coordinates of
   points are doubled, so that midpoints are integers. If two shapes abut, the
   right or upper shape contains the common edge. */
typedef struct doubled {
  int64_t x, y;
} doubled;
void segment_locate(segment *s);
void segment_find(const doubled *points, size_t n, const eda_shapes *shapes,
                  uint32_t *which);

/* recognise.c: compute box, axis and type of each region, or the reason for its
   rejection. */
int segment_recognise(segment *s);

/* Relation of a region to a layer: untouched, inside, or partly covered.
   `state` has one entry for each region. */
enum { SEGMENT_OUTSIDE = 0, SEGMENT_INSIDE = 1, SEGMENT_PARTLY = 2 };
int segment_cover(segment *s, const eda_shapes *layer, uint8_t *state);

/* flavours.c: check the flavours of transistors (eda/gates.h) in the settings,
   and select the flavour of each gate. */
int segment_check_flavours(const eda_segment_settings *settings,
                           opc_error *error);
int segment_flavours(segment *s);

/* drawn.c: compute L and W of each gate as drawn, before snapping to the
   grid. */
int segment_drawn(segment *s);

/* cut.c: compute the fragments of poly and active, and the extension of poly
   beyond active. */
void segment_cut(segment *s);

/* space.c: compute the free space beside each gate. */
void segment_space(segment *s);

/* name.c: set instance, cell and number of each gate: "", "" and 0 for a window
   if settings->paths is 0. */
void segment_name(segment *s);

/* notes.c: parse the notes of each gate. */
int segment_notes(segment *s);

/* Return OPC_INVALID with the position of region i and the fault. */
int segment_refuse(segment *s, size_t i, const char *fault);

/* Return the path of a placement (free()), and its cell in *cell; -1 if the
   placement does not exist. */
char *segment_path(const segment *s, uint32_t placement, int32_t *cell);
