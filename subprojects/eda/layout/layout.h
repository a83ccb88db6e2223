/* SPDX-License-Identifier: BSD-3-Clause */
/* How a layout is stored; for the files of this folder only.

   The shapes of a cell lie in sheets, one a layer: small boxes as a corner and
   a size (12 bytes each), other boxes as two corners (16 bytes), other polygons
   with their points one after another. Nothing is allocated for a single
   shape. */
#ifndef EDA_LAYOUT_LAYOUT_H
#define EDA_LAYOUT_LAYOUT_H

#include <eda/layout.h>
#include <eda/memory.h>
#include <glib.h>
#include <stdbool.h>

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
  eda_box *boxes;
  size_t n_boxes, room_boxes;
  uint32_t *end; /* polygon i ends before points[end[i]] */
  size_t n_polygons, room_polygons;
  eda_point *points;
  size_t n_points, room_points;
  size_t first; /* number in the cell of its first polygon: numbered */
} sheet;

typedef struct label {
  eda_point at;
  int32_t layer;
  uint32_t text; /* offset in the layout's strings */
} label;

typedef struct instance {
  eda_placement placement;
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
     drawn there at all, at most EDA_MANY; before[i] is the number of the first
     one of instance i. */
  uint64_t placements;
  uint32_t *before;
  bool circular; /* leads to a circle of cells */
} cell;

/* More placements than can be numbered. */
#define EDA_MANY ((uint64_t)UINT32_MAX + 1)

struct eda_layout {
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
  /* By layer, what a question about a window has found out (reach.h): of
     shapes, of texts. NULL: nothing yet. */
  GHashTable *reach[2];
};

/* All boxes of a sheet, small ones first. */
static inline size_t sheet_boxes(const sheet *s) {
  return s->n_small + s->n_boxes;
}

static inline eda_box sheet_box(const sheet *s, size_t i) {
  if (i >= s->n_small) return s->boxes[i - s->n_small];
  const small_box *b = &s->small[i];
  return (eda_box){b->x, b->y, b->x + b->width, b->y + b->height};
}

/* Placements of an array. */
static inline uint64_t members(const instance *in) {
  return (uint64_t)in->placement.columns * in->placement.rows;
}

/* a + b * c, at most `limit` */
static inline uint64_t add_product(uint64_t a, uint64_t b, uint64_t c,
                                   uint64_t limit) {
  uint64_t product;
  if (__builtin_mul_overflow(b, c, &product) || product > limit) return limit;
  return MIN(a + product, limit);
}

/* Fill what `ordered` promises. [any] */
void eda_layout_order(const eda_layout *layout);

/* The sheet of a cell for a layer, NULL if it has none. */
sheet *eda_layout_sheet(const cell *c, int32_t layer);

/* The outline of a path (outline.c), one polygon in a fresh array that the
   caller frees; *n = 0 and *outline = NULL where it covers no area. */
int eda_path_outline(const eda_point *points, size_t n, int32_t width, int ends,
                     int32_t begin, int32_t end, eda_point **outline,
                     size_t *n_outline, opc_error *error);

#endif
