/* SPDX-License-Identifier: BSD-3-Clause */
/* Representation of a layout; for the files of this folder only.

   The shapes of a cell are stored in sheets, one for each layer. A small box is
   stored as a corner and a size (12 bytes), another box as two corners (16
   bytes), another polygon as points. No shape has an allocation of its own. */
#pragma once

#include <eda/layout.h>
#include <eda/memory.h>
#include <glib.h>
#include <stdbool.h>

/* A box of at most UINT16_MAX in each direction. */
typedef struct small_box {
  int32_t x, y;
  uint16_t width, height;
} small_box;

/* Shapes of one cell on one layer, in this order. */
typedef struct sheet {
  int32_t layer;
  small_box *small;
  size_t n_small, capacity_small;
  eda_box *boxes;
  size_t n_boxes, capacity_boxes;
  uint32_t *end; /* polygon i ends before points[end[i]] */
  size_t n_polygons, capacity_polygons;
  eda_point *points;
  size_t n_points, capacity_points;
  size_t first; /* number of its first polygon in the cell; see `numbered` */
} sheet;

typedef struct label {
  eda_point at;
  int32_t layer;
  uint32_t text; /* offset in the strings of the layout */
} label;

typedef struct instance {
  eda_placement placement;
  int32_t child;
  uint32_t name; /* offset in the strings of the layout, 0 for none */
} instance;

typedef struct cell {
  char *name;
  sheet *sheets;
  size_t n_sheets, capacity_sheets, last_sheet;
  GHashTable *sheet_of; /* layer to index + 1; NULL for few sheets */
  label *labels;
  size_t n_labels, capacity_labels;
  instance *instances;
  size_t n_instances, capacity_instances;
  size_t polygons; /* valid if numbered */

  /* Valid if ordered. placements: of the cell and all cells below, at most
     EDA_MANY; 0 if none has shapes. before[i]: number of the first placement of
     instance i. */
  uint64_t placements;
  uint32_t *before;
  bool circular; /* contains itself */
} cell;

/* More placements than 32 bits can number. */
#define EDA_MANY ((uint64_t)UINT32_MAX + 1)

struct eda_layout {
  double unit;
  cell *cells;
  size_t n_cells, capacity_cells;
  char **layers;
  size_t n_layers, capacity_layers;
  GHashTable *cell_of, *layer_of; /* name to number + 1 */
  GHashTable *file_layer;         /* layer to its name in the file */
  char *strings;
  size_t n_strings, capacity_strings;

  /* Computed on first request after a change, under the lock. */
  GMutex lock;
  int numbered, ordered; /* atomic */
  int32_t *order;        /* children before parents; valid if ordered */
  /* Extents by layer (reach.h): [0] of shapes, [1] of texts; NULL: none yet. */
  GHashTable *reach[2];
};

/* Return the number of boxes of a sheet; small boxes come first. */
static inline size_t sheet_boxes(const sheet *s) {
  return s->n_small + s->n_boxes;
}

static inline eda_box sheet_box(const sheet *s, size_t i) {
  if (i >= s->n_small) return s->boxes[i - s->n_small];
  const small_box *b = &s->small[i];
  return (eda_box){b->x, b->y, b->x + b->width, b->y + b->height};
}

/* Return the number of members of an array. */
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

/* Compute the fields that `ordered` marks as valid. [any] */
void eda_layout_order(const eda_layout *layout);

/* Return the sheet of a cell for a layer, NULL if none exists. */
sheet *eda_layout_sheet(const cell *c, int32_t layer);

/* Compute the outline of a path (outline.c), one polygon in an array that the
   caller frees; *n = 0 and *outline = NULL if the path covers no area. */
int eda_path_outline(const eda_point *points, size_t n, int32_t width, int ends,
                     int32_t begin, int32_t end, eda_point **outline,
                     size_t *n_outline, opc_error *error);
