/* SPDX-License-Identifier: BSD-3-Clause */
/* Hierarchical layouts: what readers build and writers walk. Data kind
   "layout": an eda_layout, opaque. */
#ifndef EDA_LAYOUT_H
#define EDA_LAYOUT_H

#include <eda/geometry.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct eda_layout eda_layout;

/* Where a cell is placed: mirrored about the x axis first, then magnified,
   rotated counter-clockwise, moved; then repeated columns x rows times.
   */
typedef struct eda_placement {
  eda_point origin;
  double magnification; /* > 0; 1 for none */
  double angle;         /* degrees */
  uint32_t mirror;
  uint32_t columns, rows; /* 1, 1 for a single one */
  eda_point column_step, row_step;
} eda_placement;

/* Where flat shapes came from. Shape i of `shapes` was drawn in the placement
   `placement[i]`, whose path eda_layout_path gives. */
typedef struct eda_flat {
  eda_shapes shapes; /* unmerged, in units of the grid asked for */
  uint32_t *placement;
  size_t vertices; /* of the layer, flat */
  size_t moved;    /* of these, how many the grid moved */
  double worst;    /* by how much at most, nm */
} eda_flat;

/* Flat texts: text i stands at the one point of shape i. */
typedef struct eda_flat_texts {
  eda_flat at;
  const char **text; /* the layout's own */
  uint32_t *depth;   /* of its cell, below the top: 0 for those of that */
} eda_flat_texts;

/* Cells and layers are named and numbered from 0 in order of creation. All
   functions that change a layout are [main], the others [any] while it is not
   changed. Pointers that are returned belong to the layout. Coordinates are in
   its database unit. Functions that return int32_t return -1 and *error on
   failure; a cell or layer that is not there gives OPC_INVALID. */

/* An empty layout of `unit` nm per database unit, > 0, else NULL. Reading at
   another scale is another unit, so that no coordinate is rounded. */
OPC_EXPORT eda_layout *eda_layout_new(double unit, opc_error *error);
OPC_EXPORT void eda_layout_free(void *layout);

/* The number of the cell or layer of that name, made if new. */
OPC_EXPORT int32_t eda_layout_cell(eda_layout *layout, const char *name,
                                   opc_error *error);
OPC_EXPORT int32_t eda_layout_layer(eda_layout *layout, const char *name,
                                    opc_error *error);

/* n >= 3 points, copied. Boxes may be empty of area, x0 <= x1 and y0 <= y1. */
OPC_EXPORT int eda_layout_add_polygon(eda_layout *layout, int32_t cell,
                                      int32_t layer, const eda_point *points,
                                      size_t n, opc_error *error);
OPC_EXPORT int eda_layout_add_box(eda_layout *layout, int32_t cell,
                                  int32_t layer, eda_box box, opc_error *error);
/* The outline of a line along n >= 1 points, a polygon whose winding number
   is not zero inside; corners are mitred, those sharper than a right angle
   cut off at half a width. `ends`: 0 flush, 1 round (half a polygon of 32
   sides), 2 half a width longer, 4 by begin and end. `width` >= 0; nothing is
   drawn where there is no area. */
OPC_EXPORT int eda_layout_add_path(eda_layout *layout, int32_t cell,
                                   int32_t layer, const eda_point *points,
                                   size_t n, int32_t width, int ends,
                                   int32_t begin, int32_t end,
                                   opc_error *error);
/* The text is copied. */
OPC_EXPORT int eda_layout_add_text(eda_layout *layout, int32_t cell,
                                   int32_t layer, eda_point at,
                                   const char *text, opc_error *error);
/* `name` of the instance, NULL for none, is copied. The child may still be
   empty. */
OPC_EXPORT int eda_layout_add_instance(eda_layout *layout, int32_t cell,
                                       int32_t child,
                                       const eda_placement *placement,
                                       const char *name, opc_error *error);

/* nm per database unit. */
OPC_EXPORT double eda_layout_unit(const eda_layout *layout);
OPC_EXPORT size_t eda_layout_cells(const eda_layout *layout);
OPC_EXPORT size_t eda_layout_layers(const eda_layout *layout);
OPC_EXPORT const char *eda_layout_cell_name(const eda_layout *layout,
                                            int32_t cell);
OPC_EXPORT const char *eda_layout_layer_name(const eda_layout *layout,
                                             int32_t layer);
/* The number, -1 if there is none. */
OPC_EXPORT int32_t eda_layout_find_cell(const eda_layout *layout,
                                        const char *name);
OPC_EXPORT int32_t eda_layout_find_layer(const eda_layout *layout,
                                         const char *name);
/* The only cell that no other one places; -1 and *error with their names if
   there are several or none, or if cells place each other in a circle. */
OPC_EXPORT int32_t eda_layout_top(const eda_layout *layout, opc_error *error);

/* What is drawn in a cell itself. Polygons of a cell are numbered from 0,
   layer by layer; *n points, and the layer. The points are valid until the
   same thread calls polygon again: boxes are stored as two corners. */
OPC_EXPORT size_t eda_layout_polygons(const eda_layout *layout, int32_t cell);
OPC_EXPORT const eda_point *eda_layout_polygon(const eda_layout *layout,
                                               int32_t cell, size_t i,
                                               size_t *n, int32_t *layer);
/* Text i of a cell itself, where it stands and its layer. */
OPC_EXPORT size_t eda_layout_texts(const eda_layout *layout, int32_t cell);
OPC_EXPORT const char *eda_layout_text(const eda_layout *layout, int32_t cell,
                                       size_t i, eda_point *at, int32_t *layer);
/* Instance i of a cell itself: its name (NULL for none), what it places and
   how. */
OPC_EXPORT size_t eda_layout_instances(const eda_layout *layout, int32_t cell);
OPC_EXPORT const char *eda_layout_instance(const eda_layout *layout,
                                           int32_t cell, size_t i,
                                           int32_t *child,
                                           eda_placement *placement);

/* All shapes of a layer below `cell`, with every transform applied, on a
   grid of `grid` nm: a coordinate becomes floor(x * unit / grid + 1/2), so
   that equal lengths that move equally stay equal. OPC_INVALID for more than
   2^28 shapes or 8 placements for each and 2^19 more, coordinates beyond 2^30
   and circles among the cells. *out is the caller's, who clears it; it is empty
   on failure. */
OPC_EXPORT int eda_layout_flatten(const eda_layout *layout, int32_t cell,
                                  int32_t layer, double grid, eda_flat *out,
                                  opc_error *error);
/* Of these the shapes whose bounding box touches a window, be it in an edge or
   a corner: the same, in the same order. Only what may touch it is gone
   through, so that it costs what is there and not what the layout has; the
   first question about a layer goes through all cells once. NULL: all shapes.
   The window is in units of the grid. Shapes that lie outside are not looked
   at: they may be more, and further away, than what can be flattened. [any] */
OPC_EXPORT int eda_layout_flatten_window(const eda_layout *layout, int32_t cell,
                                         int32_t layer, double grid,
                                         const eda_box *window, eda_flat *out,
                                         opc_error *error);
/* The box around all shapes of a layer below `cell`, in units of the grid, by
   the boxes of cells; where angles are not right, those are larger than what is
   drawn in them. Empty if nothing is drawn. OPC_INVALID beyond 2^30 and for
   circles. [any] */
OPC_EXPORT int eda_layout_bounds(const eda_layout *layout, int32_t cell,
                                 int32_t layer, double grid, eda_box *box,
                                 opc_error *error);
/* The bytes that flattening all takes, without doing it; for a step's forecast.
   Of cells in a circle 0: flattening refuses them. */
OPC_EXPORT double eda_layout_flat_bytes(const eda_layout *layout, int32_t cell,
                                        int32_t layer);
OPC_EXPORT void eda_flat_clear(eda_flat *flat);

/* The instances from `cell` down to placement number p of its flattening
   ("XU1/XI2", "" for the cell itself), in a buffer of `room` bytes; the
   number of the cell that is placed there. An unnamed instance is called
   after its cell and its number in the cell that places it, as `instance`
   counts ("NAND2_X1#3"); an array member gets [c,r]. Cut to fit the buffer;
   -1 if there is no such placement. */
OPC_EXPORT int32_t eda_layout_path(const eda_layout *layout, int32_t cell,
                                   uint32_t p, char *buffer, size_t room);

/* Drop the cells that `cell` does not lead to. The others keep their order
   and get new numbers; layers keep theirs. */
OPC_EXPORT int eda_layout_keep(eda_layout *layout, int32_t cell,
                               opc_error *error);

/* All texts of a layer below `cell`, in the same way: places in steps of `grid`
   nm. The texts belong to the layout, the rest is the caller's, who clears
   it. */
OPC_EXPORT int eda_layout_flatten_texts(const eda_layout *layout, int32_t cell,
                                        int32_t layer, double grid,
                                        eda_flat_texts *out, opc_error *error);
/* Those within a window, edges included; as eda_layout_flatten_window. */
OPC_EXPORT int eda_layout_flatten_texts_window(
    const eda_layout *layout, int32_t cell, int32_t layer, double grid,
    const eda_box *window, eda_flat_texts *out, opc_error *error);
OPC_EXPORT void eda_flat_texts_clear(eda_flat_texts *texts);

/* Whether an object of the data kind "layout" is there; eda_layout_free as the
   release of a port. */
OPC_EXPORT int eda_layout_check(const void *layout, opc_error *error);

/* For the initialiser of an opc_port (opcflow/step.h). */
#define EDA_PORT_LAYOUT(port)                                  \
  {                                                            \
    .name = port, .kind = "layout", .check = eda_layout_check, \
    .release = eda_layout_free                                 \
  }

#ifdef __cplusplus
}
#endif
#endif
