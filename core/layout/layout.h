/* SPDX-License-Identifier: BSD-3-Clause */
/* How a layout is stored; for the files of this folder only.

   The shapes of a cell lie in sheets, one a layer: small boxes as a corner and
   a size (12 bytes each), other boxes as two corners (16 bytes), other polygons
   with their points one after another. Nothing is allocated for a single
   shape. */
#ifndef OPCFLOW_CORE_LAYOUT_H
#define OPCFLOW_CORE_LAYOUT_H

#include <glib.h>
#include <stdbool.h>

#include "core/plugin/host.h"

/* A box of at most UINT16_MAX each way: nearly all there are. */
typedef struct small_box {
  int32_t x, y;
  uint16_t width, height;
} small_box;

/* What one cell draws on one layer, in this order. */
typedef struct sheet {
  int32_t layer;
  small_box *small;
  size_t n_small, room_small;
  opc_box *boxes;
  size_t n_boxes, room_boxes;
  uint32_t *end; /* polygon i ends before points[end[i]] */
  size_t n_polygons, room_polygons;
  opc_point *points;
  size_t n_points, room_points;
  size_t first; /* number in the cell of its first polygon: numbered */
} sheet;

typedef struct label {
  opc_point at;
  int32_t layer;
  uint32_t text; /* offset in the layout's strings */
} label;

typedef struct instance {
  opc_placement placement;
  int32_t child;
  uint32_t name; /* offset in the layout's strings, 0 for none */
} instance;

typedef struct cell {
  char *name;
  sheet *sheets;
  size_t n_sheets, room_sheets, last_sheet;
  GHashTable *sheet_of; /* layer to index + 1; once there are many */
  label *labels;
  size_t n_labels, room_labels;
  instance *instances;
  size_t n_instances, room_instances;
  size_t polygons; /* numbered */

  /* All of these: ordered. Placements below it with itself, 0 if nothing is
     drawn there at all, at most OPC_MANY; before[i] is the number of the first
     one of instance i. */
  uint64_t placements;
  uint32_t *before;
  bool circular; /* leads to a circle of cells */
} cell;

/* More placements than can be numbered. */
#define OPC_MANY ((uint64_t)UINT32_MAX + 1)

struct opc_layout {
  double unit;
  cell *cells;
  size_t n_cells, room_cells;
  char **layers;
  size_t n_layers, room_layers;
  GHashTable *cell_of, *layer_of; /* name to number + 1 */
  char *strings;
  size_t n_strings, room_strings;

  /* Derived on the first question after a change, under the lock. */
  GMutex lock;
  int numbered, ordered; /* atomic */
  int32_t *order;        /* children before parents: ordered */
};

/* Room for `need` elements of `size` bytes in *array, which has *room; false if
   there is no memory. */
bool opc_grow(void *array, size_t *room, size_t need, size_t size);

/* All boxes of a sheet, small ones first. */
static inline size_t sheet_boxes(const sheet *s) {
  return s->n_small + s->n_boxes;
}

static inline opc_box sheet_box(const sheet *s, size_t i) {
  if (i >= s->n_small) return s->boxes[i - s->n_small];
  const small_box *b = &s->small[i];
  return (opc_box){b->x, b->y, b->x + b->width, b->y + b->height};
}

/* Fill what `ordered` promises. [any] */
int opc_layout_order(const opc_layout *layout, opc_error *error);

/* The sheet of a cell for a layer, NULL if it has none. */
sheet *opc_layout_sheet(const cell *c, int32_t layer);

/* The outline of a path (outline.c), one polygon in a fresh array that the
   caller frees; *n = 0 and *outline = NULL where it covers no area. */
int opc_path_outline(const opc_point *points, size_t n, int32_t width, int ends,
                     int32_t begin, int32_t end, opc_point **outline,
                     size_t *n_outline, opc_error *error);

/* Functions of the service that stand in flatten.c. */
int32_t opc_layout_top(const opc_layout *layout, opc_error *error);
int opc_layout_flatten(const opc_host *host, const opc_layout *layout,
                       int32_t top, int32_t layer, double grid, opc_flat *out,
                       opc_error *error);
void opc_layout_release(opc_flat *flat);
int opc_layout_flatten_texts(const opc_host *host, const opc_layout *layout,
                             int32_t top, int32_t layer, double grid,
                             opc_flat_texts *out, opc_error *error);
void opc_layout_release_texts(opc_flat_texts *texts);
int32_t opc_layout_path(const opc_layout *layout, int32_t top, uint32_t p,
                        char *buffer, size_t room);

#endif
