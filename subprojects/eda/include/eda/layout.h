/* SPDX-License-Identifier: BSD-3-Clause */
/* Hierarchical layouts, created by readers and traversed by writers. Data kind
   (opcflow/step.h) "layout": eda_layout. [any], [main]: opcflow/plugin.h. */
#pragma once

#include <eda/geometry.h>

OPC_C_BEGIN

/* A layout. */
typedef struct eda_layout eda_layout;

/* Placement of a cell: the cell is mirrored about the x axis if `mirror`,
   magnified, rotated counter-clockwise, moved by `origin`, and repeated in
   columns x rows. */
typedef struct eda_placement {
  eda_point origin;
  double magnification; /* > 0; 1: none */
  double angle;         /* degrees */
  uint32_t mirror;
  uint32_t columns, rows;          /* 1, 1: a single placement */
  eda_point column_step, row_step; /* displacement from a column to the next,
                                      from a row to the next */
} eda_placement;

/* Flat shapes of a layer: shapes of a cell and of all cells below, in
   coordinates of the cell. Each occurrence of a cell in the hierarchy is a
   placement and has a number; 0 is the top cell. Shape i is from placement
   number placement[i]; eda_layout_path returns the path of a placement. */
typedef struct eda_flat {
  eda_shapes shapes; /* unmerged, in units of the requested grid */
  uint32_t *placement;
  size_t vertices; /* number of vertices */
  size_t moved;    /* vertices moved by rounding to the grid */
  double worst;    /* largest movement of a vertex by rounding, nm */
} eda_flat;

/* Flat texts. Shape i of `at` has one point, the position of text i. */
typedef struct eda_flat_texts {
  eda_flat at;
  const char **text; /* owned by the layout */
  uint32_t *depth;   /* depth of the text's cell in the hierarchy; 0: top
                        cell */
} eda_flat_texts;

/* Cells and layers have names, and numbers from 0 in order of creation.
   Functions that change a layout are [main]; the others are [any] while no
   function changes the layout. Returned pointers belong to the layout.
   Coordinates are in database units. Functions with an argument `error` that
   return int32_t return -1 and *error on failure. Errors: OPC_INVALID for a
   missing cell or layer and for invalid arguments; OPC_FAILED if the layout has
   too many cells, layers, points or texts. */

/* Return an empty layout with `unit` > 0 nm per database unit; NULL and *error
   on failure. Readers scale a layout by `unit`, without rounding. */
OPC_EXPORT eda_layout *eda_layout_new(double unit, opc_error *error);
/* Free a layout (NULL: do nothing). */
OPC_EXPORT void eda_layout_free(void *layout);

/* Return the number of the cell or layer with this name, created if missing. */
OPC_EXPORT int32_t eda_layout_cell(eda_layout *layout, const char *name,
                                   opc_error *error);
OPC_EXPORT int32_t eda_layout_layer(eda_layout *layout, const char *name,
                                    opc_error *error);

/* eda_layout_add_polygon: add a polygon of n >= 3 points, which are copied; a
   rectangle is stored as a box. eda_layout_add_box: add a box, which may have
   no area (x0 <= x1, y0 <= y1). Return OPC_OK or an error code. */
OPC_EXPORT int eda_layout_add_polygon(eda_layout *layout, int32_t cell,
                                      int32_t layer, const eda_point *points,
                                      size_t n, opc_error *error);
OPC_EXPORT int eda_layout_add_box(eda_layout *layout, int32_t cell,
                                  int32_t layer, eda_box box, opc_error *error);
/* Add the outline of a path along n >= 1 points as one polygon with nonzero
   winding number inside. Corners are mitred; mitres of corners sharper than a
   right angle end at half a width. `ends`: 0 flush, 1 round (half a polygon of
   32 sides), 2 extended by half a width, 4 extended by `begin` and `end`.
   `width` >= 0; a path without area adds nothing. */
OPC_EXPORT int eda_layout_add_path(eda_layout *layout, int32_t cell,
                                   int32_t layer, const eda_point *points,
                                   size_t n, int32_t width, int ends,
                                   int32_t begin, int32_t end,
                                   opc_error *error);
/* Add a text, which is copied. */
OPC_EXPORT int eda_layout_add_text(eda_layout *layout, int32_t cell,
                                   int32_t layer, eda_point at,
                                   const char *text, opc_error *error);
/* Add an instance of the cell `child`, which may still be empty, to `cell`.
   `name` (NULL: none) is copied. */
OPC_EXPORT int eda_layout_add_instance(eda_layout *layout, int32_t cell,
                                       int32_t child,
                                       const eda_placement *placement,
                                       const char *name, opc_error *error);

/* Copy a cell of another layout with the same unit, and all cells below. Layers
   are joined by name. A cell whose name exists is named NAME$2 and so on.
   Return the number of the copy; -1 and *error if the units or the definitions
   of a derived layer (eda_layout_derive) differ. [main] */
OPC_EXPORT int32_t eda_layout_import(eda_layout *to, const eda_layout *from,
                                     int32_t cell, opc_error *error);

/* Return a property of a layout. eda_layout_unit: length of a database unit,
   nm. eda_layout_cells, eda_layout_layers: number of cells or layers.
   eda_layout_cell_name, eda_layout_layer_name: name of a cell or layer. */
OPC_EXPORT double eda_layout_unit(const eda_layout *layout);
OPC_EXPORT size_t eda_layout_cells(const eda_layout *layout);
OPC_EXPORT size_t eda_layout_layers(const eda_layout *layout);
OPC_EXPORT const char *eda_layout_cell_name(const eda_layout *layout,
                                            int32_t cell);
OPC_EXPORT const char *eda_layout_layer_name(const eda_layout *layout,
                                             int32_t layer);
/* eda_layout_set_file_layer: set the name of a layer in the file from which the
   layout was read, such as "66/20"; the name is copied. eda_layout_file_layer:
   return this name, or the name of the layer if none was set. Writers use it if
   their format does not allow the layer's own name. */
OPC_EXPORT void eda_layout_set_file_layer(eda_layout *layout, int32_t layer,
                                          const char *name);
OPC_EXPORT const char *eda_layout_file_layer(const eda_layout *layout,
                                             int32_t layer);
/* Return the number of the cell or layer, -1 if there is none. The name of a
   layer may be an expression (eda_layout_select). */
OPC_EXPORT int32_t eda_layout_find_cell(const eda_layout *layout,
                                        const char *name);
OPC_EXPORT int32_t eda_layout_find_layer(const eda_layout *layout,
                                         const char *name);
/* Layer expressions combine layers of any cells in the hierarchy:

     a + b            union                  grow(a, 10 nm)    larger by 10 nm
     a - b            a without b            shrink(a, 10 nm)  smaller by 10 nm
     a & b            intersection           (a + b) - c       brackets
     a ^ b            either, not both

   `&` binds more tightly than `+`, `-` and `^`, which apply from left to right.
   A layer is a name of the layout or of its file ("poly", "66/20"). The shapes
   of a derived layer are computed when the layer is flattened, as boxes; in a
   window, they cover the same points as those of the whole layout. Each box has
   the placement of a shape that covers the box. Layers are tried in the order
   of the expression, without layers that are subtracted. The placement is 0,
   the top cell, if no shape of these layers covers the box. A derived layer has
   no polygons in eda_layout_polygon. */

/* Define the layer `name` as an expression. Return OPC_INVALID for an invalid
   text, with the position of the fault, for a missing layer and for a layer
   that contains itself. [main] */
OPC_EXPORT int eda_layout_derive(eda_layout *layout, const char *name,
                                 const char *text, opc_error *error);
/* Return the number of the layer whose name in the layout or in its file is
   `text`. If there is none and `text` is an expression, return the number of
   the derived layer of this expression. Return -1 and *error on failure.
   [any] */
OPC_EXPORT int32_t eda_layout_select(const eda_layout *layout, const char *text,
                                     opc_error *error);
/* Return whether a layer is an expression. [any] */
OPC_EXPORT int eda_layout_is_derived(const eda_layout *layout, int32_t layer);
/* eda_layer_is_expression: return whether a text has the form of an expression,
   with operators, brackets or blanks. eda_layer_check: check the text of an
   expression; return OPC_OK, or OPC_INVALID and *error with the position of the
   fault. [any] */
OPC_EXPORT int eda_layer_is_expression(const char *text);
OPC_EXPORT int eda_layer_check(const char *text, opc_error *error);
/* Call `take` with the name of each layer in an expression, from left to right.
   Return as eda_layer_check. [any] */
OPC_EXPORT int eda_layer_names(const char *text,
                               void (*take)(void *data, const char *name),
                               void *data, opc_error *error);

/* Return the top cell: the only cell that no other cell places. Return -1 and
 *error if there are several or none, or if placements form a cycle. */
OPC_EXPORT int32_t eda_layout_top(const eda_layout *layout, opc_error *error);

/* eda_layout_polygons: return the number of polygons of a cell, without those
   of placed cells. eda_layout_polygon: return polygon i with *n points and its
   layer. Polygons are ordered by layer. The points are valid until the thread
   calls eda_layout_polygon again. */
OPC_EXPORT size_t eda_layout_polygons(const eda_layout *layout, int32_t cell);
OPC_EXPORT const eda_point *eda_layout_polygon(const eda_layout *layout,
                                               int32_t cell, size_t i,
                                               size_t *n, int32_t *layer);
/* eda_layout_texts: return the number of texts of a cell. eda_layout_text:
   return text i with its position and layer. */
OPC_EXPORT size_t eda_layout_texts(const eda_layout *layout, int32_t cell);
OPC_EXPORT const char *eda_layout_text(const eda_layout *layout, int32_t cell,
                                       size_t i, eda_point *at, int32_t *layer);
/* eda_layout_instances: return the number of cells that a cell places.
   eda_layout_instance: return the name of instance i (NULL: none), and set the
   placed cell and the placement. */
OPC_EXPORT size_t eda_layout_instances(const eda_layout *layout, int32_t cell);
OPC_EXPORT const char *eda_layout_instance(const eda_layout *layout,
                                           int32_t cell, size_t i,
                                           int32_t *child,
                                           eda_placement *placement);

/* Flatten the shapes of a layer in `cell` and all cells below. A coordinate x
   becomes floor(x * unit / grid + 1/2), `grid` in nm; a value less than 1e-6
   below a half is also rounded up. Return OPC_INVALID for more than 2^28 shapes
   or 2^30 points, for more than 2^19 + 8 * (number of shapes) placements, for
   coordinates beyond 2^30, for a grid that is not above 0, and for cycles of
   cells. The caller clears *out, which is empty on failure. */
OPC_EXPORT int eda_layout_flatten(const eda_layout *layout, int32_t cell,
                                  int32_t layer, double grid, eda_flat *out,
                                  opc_error *error);
/* As eda_layout_flatten, only for shapes whose bounding box touches `window`,
   in grid units (NULL: all shapes), in the same order. The time is proportional
   to the content of the window; the first call for a layer traverses all cells.
   The limits of eda_layout_flatten apply to the content of the window only.
   [any] */
OPC_EXPORT int eda_layout_flatten_window(const eda_layout *layout, int32_t cell,
                                         int32_t layer, double grid,
                                         const eda_box *window, eda_flat *out,
                                         opc_error *error);
/* Compute the bounding box of all shapes of a layer in `cell` and below, in
   grid units; empty without shapes. The box may be larger if cells are rotated
   by angles other than multiples of 90 degrees. Return OPC_INVALID beyond 2^30
   and for cycles. [any] */
OPC_EXPORT int eda_layout_bounds(const eda_layout *layout, int32_t cell,
                                 int32_t layer, double grid, eda_box *box,
                                 opc_error *error);
/* Return the number of bytes that eda_layout_flatten will allocate; 0 for
   cycles of cells. */
OPC_EXPORT double eda_layout_flat_bytes(const eda_layout *layout, int32_t cell,
                                        int32_t layer);
/* Free the arrays and clear the struct. */
OPC_EXPORT void eda_flat_clear(eda_flat *flat);

/* Write the path of placement p (eda_flat.placement) below `cell`, such as
   "XU1/XI2" ("" for `cell`), to a buffer of `capacity` bytes, truncated if
   longer. Unnamed instance i of a parent cell is written as CELL#i
   ("NAND2_X1#3"), a member of an array with [column,row]. Return the number of
   the placed cell, or -1 if placement p does not exist. */
OPC_EXPORT int32_t eda_layout_path(const eda_layout *layout, int32_t cell,
                                   uint32_t p, char *buffer, size_t capacity);

/* Remove the cells that are not in the hierarchy of `cell`. The other cells
   keep their order and get new numbers; layers keep their numbers. */
OPC_EXPORT int eda_layout_keep(eda_layout *layout, int32_t cell,
                               opc_error *error);

/* Flatten the texts of a layer as eda_layout_flatten. The strings belong to the
   layout; the caller calls eda_flat_texts_clear. */
OPC_EXPORT int eda_layout_flatten_texts(const eda_layout *layout, int32_t cell,
                                        int32_t layer, double grid,
                                        eda_flat_texts *out, opc_error *error);
/* Flatten the texts in a window, as eda_layout_flatten_window. */
OPC_EXPORT int eda_layout_flatten_texts_window(
    const eda_layout *layout, int32_t cell, int32_t layer, double grid,
    const eda_box *window, eda_flat_texts *out, opc_error *error);
/* Free the arrays and clear the struct. */
OPC_EXPORT void eda_flat_texts_clear(eda_flat_texts *texts);

/* Check function of an output; its release function is eda_layout_free. */
OPC_EXPORT int eda_layout_check(const void *layout, opc_error *error);

/* Initialise an opc_port (opcflow/step.h). */
#define EDA_PORT_LAYOUT(port)                                  \
  {                                                            \
    .name = port, .kind = "layout", .check = eda_layout_check, \
    .release = eda_layout_free                                 \
  }

OPC_C_END
