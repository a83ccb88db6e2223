/* SPDX-License-Identifier: BSD-3-Clause */
/* Hierarchical layouts, created by readers and traversed by writers. Data kind
   "layout": an eda_layout, opaque. */
#pragma once

#include <eda/geometry.h>

OPC_C_BEGIN

typedef struct eda_layout eda_layout;

/* Placement of a cell: mirrored about the x axis, then magnified, rotated
   counter-clockwise and moved; then repeated in columns x rows. */
typedef struct eda_placement {
  eda_point origin;
  double magnification; /* > 0; 1: none */
  double angle;         /* degrees */
  uint32_t mirror;
  uint32_t columns, rows; /* 1, 1: a single placement */
  eda_point column_step, row_step;
} eda_placement;

/* Flat shapes and their origin. Shape i of `shapes` was drawn in the placement
   `placement[i]`, whose path eda_layout_path returns. */
typedef struct eda_flat {
  eda_shapes shapes; /* unmerged, in units of the requested grid */
  uint32_t *placement;
  size_t vertices; /* flat vertices of the layer */
  size_t moved;    /* number of vertices moved by rounding to the grid */
  double worst;    /* largest rounding, nm */
} eda_flat;

/* Flat texts: text i is at the only point of shape i. */
typedef struct eda_flat_texts {
  eda_flat at;
  const char **text; /* owned by the layout */
  uint32_t *depth;   /* depth of its cell below the top cell; 0: the top cell */
} eda_flat_texts;

/* Cells and layers have names, and numbers from 0 in order of creation.
   Functions that change a layout are [main]; the others are [any] while the
   layout is not changed. Returned pointers belong to the layout. Coordinates
   are in database units. Functions that return int32_t return -1 and *error on
   failure; a missing cell or layer is OPC_INVALID. */

/* Return an empty layout with `unit` nm per database unit, > 0; otherwise NULL.
   Reading at another scale sets another unit, so that no coordinate is
   rounded. */
OPC_EXPORT eda_layout *eda_layout_new(double unit, opc_error *error);
OPC_EXPORT void eda_layout_free(void *layout);

/* Return the number of the cell or layer with this name; create it if new. */
OPC_EXPORT int32_t eda_layout_cell(eda_layout *layout, const char *name,
                                   opc_error *error);
OPC_EXPORT int32_t eda_layout_layer(eda_layout *layout, const char *name,
                                    opc_error *error);

/* Add a polygon of n >= 3 points, which are copied; or a box, which may have no
   area, x0 <= x1 and y0 <= y1. */
OPC_EXPORT int eda_layout_add_polygon(eda_layout *layout, int32_t cell,
                                      int32_t layer, const eda_point *points,
                                      size_t n, opc_error *error);
OPC_EXPORT int eda_layout_add_box(eda_layout *layout, int32_t cell,
                                  int32_t layer, eda_box box, opc_error *error);
/* Add the outline of a path along n >= 1 points, a polygon whose winding number
   is not zero inside. Corners are mitred; corners sharper than a right angle
   are cut off at half a width. `ends`: 0 flush, 1 round (half a polygon of 32
   sides), 2 extended by half a width, 4 extended by begin and end. `width` >=
   0; a path without area adds nothing. */
OPC_EXPORT int eda_layout_add_path(eda_layout *layout, int32_t cell,
                                   int32_t layer, const eda_point *points,
                                   size_t n, int32_t width, int ends,
                                   int32_t begin, int32_t end,
                                   opc_error *error);
/* Add a text, which is copied. */
OPC_EXPORT int eda_layout_add_text(eda_layout *layout, int32_t cell,
                                   int32_t layer, eda_point at,
                                   const char *text, opc_error *error);
/* Add an instance. `name` (NULL: none) is copied. The child cell may still be
   empty. */
OPC_EXPORT int eda_layout_add_instance(eda_layout *layout, int32_t cell,
                                       int32_t child,
                                       const eda_placement *placement,
                                       const char *name, opc_error *error);

/* Return nm per database unit. */
OPC_EXPORT double eda_layout_unit(const eda_layout *layout);
OPC_EXPORT size_t eda_layout_cells(const eda_layout *layout);
OPC_EXPORT size_t eda_layout_layers(const eda_layout *layout);
OPC_EXPORT const char *eda_layout_cell_name(const eda_layout *layout,
                                            int32_t cell);
OPC_EXPORT const char *eda_layout_layer_name(const eda_layout *layout,
                                             int32_t layer);
/* Set the name of a layer in the file that the layout was read from, such as
   "66/20", which is copied; return that name, or the name of the layer if none
   was set. Writers use the names where a format does not allow the layer's own
   name. */
OPC_EXPORT void eda_layout_set_file_layer(eda_layout *layout, int32_t layer,
                                          const char *name);
OPC_EXPORT const char *eda_layout_file_layer(const eda_layout *layout,
                                             int32_t layer);
/* Return the number of the cell or layer, -1 if there is none. */
OPC_EXPORT int32_t eda_layout_find_cell(const eda_layout *layout,
                                        const char *name);
OPC_EXPORT int32_t eda_layout_find_layer(const eda_layout *layout,
                                         const char *name);
/* Return the only cell that no other cell places. Return -1 and *error with the
   names if there are several or none, or if cells place each other in a
   cycle. */
OPC_EXPORT int32_t eda_layout_top(const eda_layout *layout, opc_error *error);

/* Access the polygons of a cell itself, numbered from 0, layer by layer: *n
   points, and the layer. The points are valid until the same thread calls
   polygon again, because boxes are stored as two corners. */
OPC_EXPORT size_t eda_layout_polygons(const eda_layout *layout, int32_t cell);
OPC_EXPORT const eda_point *eda_layout_polygon(const eda_layout *layout,
                                               int32_t cell, size_t i,
                                               size_t *n, int32_t *layer);
/* Access text i of a cell itself, its position and its layer. */
OPC_EXPORT size_t eda_layout_texts(const eda_layout *layout, int32_t cell);
OPC_EXPORT const char *eda_layout_text(const eda_layout *layout, int32_t cell,
                                       size_t i, eda_point *at, int32_t *layer);
/* Access instance i of a cell itself: its name (NULL: none), the placed cell
   and the placement. */
OPC_EXPORT size_t eda_layout_instances(const eda_layout *layout, int32_t cell);
OPC_EXPORT const char *eda_layout_instance(const eda_layout *layout,
                                           int32_t cell, size_t i,
                                           int32_t *child,
                                           eda_placement *placement);

/* Flatten all shapes of a layer below `cell` on a grid of `grid` nm, with all
   transforms. A coordinate becomes floor(x * unit / grid + 1/2), so equal
   lengths with equal displacements remain equal. Return OPC_INVALID for more
   than 2^28 shapes, or more placements than 8 for each shape plus 2^19, for
   coordinates beyond 2^30 and for cycles of cells. The caller clears *out,
   which is empty on failure. */
OPC_EXPORT int eda_layout_flatten(const eda_layout *layout, int32_t cell,
                                  int32_t layer, double grid, eda_flat *out,
                                  opc_error *error);
/* Flatten the shapes whose bounding box touches a window, edges and corners
   included: equal to the result of eda_layout_flatten, in the same order. The
   work is proportional to the content of the window; the first call for a layer
   traverses all cells once. NULL: all shapes. The window is in units of the
   grid. Shapes outside the window are not visited and may exceed the limits of
   flattening. [any] */
OPC_EXPORT int eda_layout_flatten_window(const eda_layout *layout, int32_t cell,
                                         int32_t layer, double grid,
                                         const eda_box *window, eda_flat *out,
                                         opc_error *error);
/* Compute the bounding box of all shapes of a layer below `cell`, in units of
   the grid, from the boxes of cells; for angles that are not right the box is
   larger than necessary. Empty if nothing is drawn. Return OPC_INVALID beyond
   2^30 and for cycles. [any] */
OPC_EXPORT int eda_layout_bounds(const eda_layout *layout, int32_t cell,
                                 int32_t layer, double grid, eda_box *box,
                                 opc_error *error);
/* Return the bytes that flattening needs, without flattening; for forecasts. 0
   for cycles of cells, which flattening refuses. */
OPC_EXPORT double eda_layout_flat_bytes(const eda_layout *layout, int32_t cell,
                                        int32_t layer);
OPC_EXPORT void eda_flat_clear(eda_flat *flat);

/* Write the path of instances from `cell` to placement number p of its
   flattening ("XU1/XI2", "" for the cell itself) to a buffer of `room` bytes;
   return the number of the placed cell. An unnamed instance is named by its
   cell and its number in the parent cell, as `instance` counts ("NAND2_X1#3");
   members of arrays get [c,r]. The path is truncated to the buffer. Return -1
   if there is no such placement. */
OPC_EXPORT int32_t eda_layout_path(const eda_layout *layout, int32_t cell,
                                   uint32_t p, char *buffer, size_t room);

/* Remove the cells that `cell` does not use. The others keep their order and
   get new numbers; layers keep theirs. */
OPC_EXPORT int eda_layout_keep(eda_layout *layout, int32_t cell,
                               opc_error *error);

/* Flatten all texts of a layer below `cell` in the same way; positions in steps
   of `grid` nm. The texts belong to the layout; the caller clears the rest. */
OPC_EXPORT int eda_layout_flatten_texts(const eda_layout *layout, int32_t cell,
                                        int32_t layer, double grid,
                                        eda_flat_texts *out, opc_error *error);
/* Flatten the texts within a window, edges included; see
   eda_layout_flatten_window. */
OPC_EXPORT int eda_layout_flatten_texts_window(
    const eda_layout *layout, int32_t cell, int32_t layer, double grid,
    const eda_box *window, eda_flat_texts *out, opc_error *error);
OPC_EXPORT void eda_flat_texts_clear(eda_flat_texts *texts);

/* Check an object of the data kind "layout"; eda_layout_free is the release
   function of an output. */
OPC_EXPORT int eda_layout_check(const void *layout, opc_error *error);

/* Initialise an opc_port (opcflow/step.h). */
#define EDA_PORT_LAYOUT(port)                                  \
  {                                                            \
    .name = port, .kind = "layout", .check = eda_layout_check, \
    .release = eda_layout_free                                 \
  }

OPC_C_END
