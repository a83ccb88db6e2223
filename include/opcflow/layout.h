/* SPDX-License-Identifier: BSD-3-Clause */
/* Hierarchical layouts: what readers build and writers walk. Data kind
   "layout": an opc_layout, opaque. */
#ifndef OPCFLOW_LAYOUT_H
#define OPCFLOW_LAYOUT_H

#include <opcflow/geometry.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct opc_layout opc_layout;

/* Where a cell is placed: mirrored about the x axis first, then magnified,
   rotated counter-clockwise, moved; then repeated columns x rows times.
   Frozen. */
typedef struct opc_placement {
  opc_point origin;
  double magnification;      /* > 0; 1 for none */
  double angle;              /* degrees */
  uint32_t mirror;
  uint32_t columns, rows;    /* 1, 1 for a single one */
  opc_point column_step, row_step;
} opc_placement;

/* Where flat shapes came from. Shape i of `shapes` was drawn in the placement
   `placement[i]`, whose path opc_layout_service.path gives. */
typedef struct opc_flat {
  opc_shapes shapes;         /* unmerged, in units of the grid asked for */
  uint32_t *placement;
  size_t vertices;           /* of the layer, flat */
  size_t moved;              /* of these, how many the grid moved */
  double worst;              /* by how much at most, nm */
} opc_flat;

/* Flat texts, since 1.2: text i stands at the one point of shape i. */
typedef struct opc_flat_texts {
  opc_flat at;
  const char **text;         /* the layout's own */
  uint32_t *depth;           /* of its cell, below the top: 0 for those of that */
} opc_flat_texts;

/* Cells and layers are named and numbered from 0 in order of creation. All
   [main] for one layout while it is built; the getters are [any] once it is
   built. Pointers returned belong to the layout. Functions that return int32_t
   return -1 and *error on failure. */
struct opc_layout_service {
  size_t size;

  /* `unit`: nm per database unit, > 0. `scale` on reading is a factor on it,
     so that no coordinate is rounded by scaling. */
  opc_layout *(*create)(const opc_host *host, double unit, opc_error *error);
  void (*destroy)(opc_layout *layout);

  /* The number of the cell or layer of that name, made if new. */
  int32_t (*cell)(opc_layout *layout, const char *name, opc_error *error);
  int32_t (*layer)(opc_layout *layout, const char *name, opc_error *error);

  /* n >= 3 points, copied. */
  int (*add_polygon)(opc_layout *layout, int32_t cell, int32_t layer,
                     const opc_point *points, size_t n, opc_error *error);
  int (*add_box)(opc_layout *layout, int32_t cell, int32_t layer, opc_box box,
                 opc_error *error);
  /* The outline of a line along n >= 1 points, a polygon whose winding number
     is not zero inside; corners are mitred, those sharper than a right angle
     cut off at half a width. `ends`: 0 flush, 1 round (half a polygon of 32 sides),
     2 half a width longer, 4 by begin and end. `width` >= 0; nothing is drawn
     where there is no area. */
  int (*add_path)(opc_layout *layout, int32_t cell, int32_t layer,
                  const opc_point *points, size_t n, int32_t width, int ends,
                  int32_t begin, int32_t end, opc_error *error);
  int (*add_text)(opc_layout *layout, int32_t cell, int32_t layer,
                  opc_point at, const char *text, opc_error *error);
  /* `name` of the instance, NULL for none. The child may still be empty. */
  int (*add_instance)(opc_layout *layout, int32_t cell, int32_t child,
                      const opc_placement *placement, const char *name,
                      opc_error *error);

  double (*unit)(const opc_layout *layout);
  size_t (*cells)(const opc_layout *layout);
  size_t (*layers)(const opc_layout *layout);
  const char *(*cell_name)(const opc_layout *layout, int32_t cell);
  const char *(*layer_name)(const opc_layout *layout, int32_t layer);
  /* The number, -1 if there is none. */
  int32_t (*find_cell)(const opc_layout *layout, const char *name);
  int32_t (*find_layer)(const opc_layout *layout, const char *name);
  /* The only cell that no other one places; -1 and *error with their names if
     there are several or none, or if cells place each other in a circle. */
  int32_t (*top)(const opc_layout *layout, opc_error *error);

  /* What is drawn in a cell itself. Polygons of a cell are numbered from 0,
     layer by layer; *n points, and the layer. The points are valid until the
     same thread calls polygon again: boxes are stored as two corners. */
  size_t (*polygons)(const opc_layout *layout, int32_t cell);
  const opc_point *(*polygon)(const opc_layout *layout, int32_t cell, size_t i,
                              size_t *n, int32_t *layer);
  size_t (*texts)(const opc_layout *layout, int32_t cell);
  const char *(*text)(const opc_layout *layout, int32_t cell, size_t i,
                      opc_point *at, int32_t *layer);
  size_t (*instances)(const opc_layout *layout, int32_t cell);
  const char *(*instance)(const opc_layout *layout, int32_t cell, size_t i,
                          int32_t *child, opc_placement *placement);

  /* All shapes of a layer below `cell`, with every transform applied, on a
     grid of `grid` nm: a coordinate becomes floor(x * unit / grid + 1/2), so
     that equal lengths that move equally stay equal. Refuses more than 2^28
     shapes, coordinates beyond 2^30 and circles among the cells. */
  int (*flatten)(const opc_host *host, const opc_layout *layout, int32_t cell,
                 int32_t layer, double grid, opc_flat *out, opc_error *error);
  void (*release)(opc_flat *flat);

  /* The instances from `cell` down to placement number p of its flattening
     ("XU1/XI2", "" for the cell itself), in a buffer of `room` bytes; the
     number of the cell that is placed there. An unnamed instance is called
     after its cell and its number in the cell that places it, as `instance`
     counts ("NAND2_X1#3"); an array member gets [c,r]. Cut to fit the buffer;
     -1 if there is no such placement. */
  int32_t (*path)(const opc_layout *layout, int32_t cell, uint32_t p,
                  char *buffer, size_t room);

  /* Drop the cells that `cell` does not lead to. The others keep their order
     and get new numbers; layers keep theirs. */
  int (*keep)(opc_layout *layout, int32_t cell, opc_error *error);

  /* Since 1.2. All texts of a layer below `cell`, as flatten does it: places in
     steps of `grid` (nm). The texts belong to the layout, the rest goes with
     release_texts, which an empty or failed `out` takes as well. [any] */
  int (*flatten_texts)(const opc_host *host, const opc_layout *layout,
                       int32_t cell, int32_t layer, double grid,
                       opc_flat_texts *out, opc_error *error);
  void (*release_texts)(opc_flat_texts *texts);
};

#ifdef __cplusplus
}
#endif
#endif
