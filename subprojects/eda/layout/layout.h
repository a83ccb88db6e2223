/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal representation of a layout.

   The shapes of a cell are stored in sheets, one for each layer. A small box is
   stored as a corner and a size (12 bytes), a larger box as two corners (16
   bytes), any other polygon as points. Shapes are not allocated
   individually. */
#pragma once

#include <eda/layout.h>
#include <eda/memory.h>
#include <glib.h>
#include <stdbool.h>

/* A box of at most UINT16_MAX units in each direction. */
typedef struct small_box {
  int32_t x, y;
  uint16_t width, height;
} small_box;

/* Shapes of one cell on one layer: small boxes, larger boxes, then polygons. */
typedef struct sheet {
  int32_t layer;
  small_box *small;
  size_t n_small, capacity_small;
  eda_box *boxes;
  size_t n_boxes, capacity_boxes;
  uint32_t *end; /* end of each polygon: polygon i has the points end[i - 1] (0
                    for i = 0) .. end[i] - 1 */
  size_t n_polygons, capacity_polygons;
  eda_point *points;
  size_t n_points, capacity_points;
  size_t first; /* number of the sheet's first polygon in the cell; valid if
                   `numbered` */
} sheet;

/* A text of a cell. */
typedef struct label {
  eda_point at;
  int32_t layer;
  uint32_t text; /* offset in eda_layout.strings */
} label;

/* A placed cell. */
typedef struct instance {
  eda_placement placement;
  int32_t child;
  uint32_t name; /* offset in eda_layout.strings; 0: no name */
} instance;

/* A cell. */
typedef struct cell {
  char *name;
  sheet *sheets;
  size_t n_sheets, capacity_sheets, last_sheet;
  GHashTable
      *sheet_of; /* layer to sheet index + 1; NULL if the cell has few sheets */
  label *labels;
  size_t n_labels, capacity_labels;
  instance *instances;
  size_t n_instances, capacity_instances;
  size_t polygons; /* number of polygons; valid if eda_layout.numbered is 1 */

  /* The next members are valid if eda_layout.ordered is 1. */
  uint64_t placements; /* 1 (the cell itself) + number of all placements below,
                          at most EDA_MANY; 0 if the cell and the cells below
                          have no shapes and texts */
  uint32_t *before;    /* number of the first placement of each instance,
                          counted from the cell */
  bool circular; /* the cell places itself, directly or through other cells */
} cell;

/* Limit of counted placements: one more than 32 bits can represent. */
#define EDA_MANY ((uint64_t)UINT32_MAX + 1)

/* A layout. */
struct eda_layout {
  double unit;
  cell *cells;
  size_t n_cells, capacity_cells;
  char **layers;
  size_t n_layers, capacity_layers;
  GHashTable *cell_of, *layer_of; /* name to number + 1 */
  GHashTable *file_layer;         /* layer number to name in the file */
  GHashTable *derived; /* number of a derived layer to its expression; protected
                          by `lock`; NULL if there are no derived layers */
  char *strings;
  size_t n_strings, capacity_strings;

  /* Members below are computed on the first request after a change, under the
     lock. */
  GMutex lock;
  int numbered;   /* 1: sheet.first and cell.polygons are valid; atomic */
  int ordered;    /* 1: `order` and the last members of `cell` are valid;
                     atomic */
  int32_t *order; /* cell numbers, children before parents */
  /* Layer number to extents of its shapes [0] and texts [1] (reach.h); NULL:
     not computed for any layer. */
  GHashTable *reach[2];
};

/* Return the number of boxes of a sheet, small boxes first. */
static inline size_t sheet_boxes(const sheet *s) {
  return s->n_small + s->n_boxes;
}

/* Return box i of a sheet. */
static inline eda_box sheet_box(const sheet *s, size_t i) {
  if (i >= s->n_small) return s->boxes[i - s->n_small];
  const small_box *b = &s->small[i];
  return (eda_box){b->x, b->y, b->x + b->width, b->y + b->height};
}

/* Return the number of members of an array instance. */
static inline uint64_t members(const instance *in) {
  return (uint64_t)in->placement.columns * in->placement.rows;
}

/* Return a + b * c, at most `limit`. */
static inline uint64_t add_product(uint64_t a, uint64_t b, uint64_t c,
                                   uint64_t limit) {
  uint64_t product;
  if (__builtin_mul_overflow(b, c, &product) || product > limit) return limit;
  return MIN(a + product, limit);
}

/* Set `ordered`, and compute all members that are valid if it is 1. [any] */
void eda_layout_order(const eda_layout *layout);

/* Set marked[] of `top` and of all cells below to 1. */
void eda_layout_mark(const eda_layout *layout, int32_t top, uint8_t *marked);

/* Return the sheet of a layer in a cell; NULL if the cell has no shapes on the
   layer. */
sheet *eda_layout_sheet(const cell *c, int32_t layer);

/* Compute the outline of a path (outline.c): one polygon (free()). If the path
   covers no area, *n_outline = 0 and *outline = NULL. */
int eda_path_outline(const eda_point *points, size_t n, int32_t width, int ends,
                     int32_t begin, int32_t end, eda_point **outline,
                     size_t *n_outline, opc_error *error);
