/* SPDX-License-Identifier: BSD-3-Clause */
/* Spatial index: for each cell of a grid, row by row, the numbers of all boxes
   that touch the cell. */
#include <eda/index.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>

/* Limits that enlarge the cells: the largest number of cells divided by the
   number of boxes, for sparse boxes; the largest average number of cells that a
   box touches, for large boxes. */
enum { CELLS_OF_BOX = 4, PLACES_OF_BOX = 64 };

struct eda_index {
  eda_box *box;
  size_t n;
  eda_box extent; /* bounding box of all boxes */
  int64_t cell;
  int32_t columns, rows;
  uint32_t
      *start; /* index of the first item of each cell in `item`; [cells + 1] */
  uint32_t *item; /* numbers of boxes, ordered by cell */
};

static int is_empty(eda_box b) { return b.x0 > b.x1 || b.y0 > b.y1; }

/* Return the column or row that contains a coordinate. The first of n columns
   or rows begins at `first`. */
static int32_t cell_of(const eda_index *x, int32_t at, int32_t first,
                       int32_t n) {
  int64_t k = ((int64_t)at - first) / x->cell;
  return at < first ? 0 : (int32_t)MIN(k, n - 1);
}

static eda_box cells_of(const eda_index *x, eda_box b) {
  eda_box e = x->extent;
  return (eda_box){
      cell_of(x, b.x0, e.x0, x->columns), cell_of(x, b.y0, e.y0, x->rows),
      cell_of(x, b.x1, e.x0, x->columns), cell_of(x, b.y1, e.y0, x->rows)};
}

/* ---- construction ---- */

static void set_cell(eda_index *x, double size) {
  double width = (double)x->extent.x1 - x->extent.x0 + 1;
  double height = (double)x->extent.y1 - x->extent.y0 + 1;
  double most = CELLS_OF_BOX * (double)x->n + 1;
  while (ceil(width / size) * ceil(height / size) > most)
    size = ceil(size * 1.5);
  x->cell = (int64_t)size;
  x->columns = (int32_t)ceil(width / size);
  x->rows = (int32_t)ceil(height / size);
}

/* Return the total number of items: the sum, over all boxes, of the number of
   cells that a box touches. */
static uint64_t index_items(const eda_index *x) {
  uint64_t sum = 0;
  for (size_t i = 0; i < x->n; i++) {
    if (is_empty(x->box[i])) continue;
    eda_box c = cells_of(x, x->box[i]);
    sum += (uint64_t)(c.x1 - c.x0 + 1) * (uint64_t)(c.y1 - c.y0 + 1);
  }
  return sum;
}

/* If `item` is NULL, count the boxes of each cell in start[]. Otherwise store
   the boxes: start[k] advances from the first item of cell k to the first item
   of cell k + 1. */
static void index_fill(eda_index *x) {
  for (size_t i = 0; i < x->n; i++) {
    if (is_empty(x->box[i])) continue;
    eda_box c = cells_of(x, x->box[i]);
    for (int32_t row = c.y0; row <= c.y1; row++)
      for (int32_t column = c.x0; column <= c.x1; column++) {
        uint32_t *at =
            &x->start[(size_t)row * (size_t)x->columns + (size_t)column];
        if (x->item) x->item[*at] = (uint32_t)i;
        ++*at;
      }
  }
}

static void measure_extent(eda_index *x) {
  int any = 0;
  for (size_t i = 0; i < x->n; i++) {
    eda_box b = x->box[i], *e = &x->extent;
    if (is_empty(b)) continue;
    *e = !any++ ? b
                : (eda_box){MIN(e->x0, b.x0), MIN(e->y0, b.y0),
                            MAX(e->x1, b.x1), MAX(e->y1, b.y1)};
  }
}

eda_index *eda_index_new(const eda_box *boxes, size_t n, int32_t cell) {
  eda_index *x = eda_alloc(1, sizeof *x);
  x->n = n;
  x->box = eda_alloc(n, sizeof *x->box);
  for (size_t i = 0; i < n; i++) x->box[i] = boxes[i];
  measure_extent(x);
  double side = cell;
  if (cell <= 0)
    side = fmax(1, ceil(sqrt(((double)x->extent.x1 - x->extent.x0) *
                             ((double)x->extent.y1 - x->extent.y0) /
                             (double)MAX(n, 1))));
  set_cell(x, side);
  while (index_items(x) > PLACES_OF_BOX * (uint64_t)n)
    set_cell(x, 2.0 * x->cell);
  size_t cells = (size_t)x->columns * (size_t)x->rows;
  x->start = eda_alloc(cells + 1, sizeof *x->start);
  index_fill(x);
  uint32_t sum = 0;
  for (size_t k = 0; k <= cells; k++) {
    uint32_t here = x->start[k];
    x->start[k] = sum;
    sum += here;
  }
  x->item = eda_alloc(sum, sizeof *x->item);
  index_fill(x);
  for (size_t k = cells; k > 0; k--) x->start[k] = x->start[k - 1];
  x->start[0] = 0;
  return x;
}

void eda_index_free(eda_index *x) {
  if (!x) return;
  free(x->box);
  free(x->start);
  free(x->item);
  free(x);
}

/* ---- queries ---- */

static void enter_cell(eda_finder *f) {
  const eda_index *x = f->index;
  size_t k = (size_t)f->row * (size_t)x->columns + (size_t)f->column;
  f->left = x->extent.x0 + f->column * x->cell;
  f->below = x->extent.y0 + f->row * x->cell;
  f->at = x->start[k];
  f->end = x->start[k + 1];
}

eda_finder eda_index_find(const eda_index *index, eda_box window) {
  eda_finder f = {
      .index = index, .window = window, .cells = cells_of(index, window)};
  f.column = f.cells.x0;
  f.row = f.cells.y0;
  enter_cell(&f);
  return f;
}

int eda_index_next(eda_finder *f, uint32_t *number) {
  const eda_index *x = f->index;
  const eda_box w = f->window;
  for (;;) {
    while (f->at < f->end) {
      uint32_t i = x->item[f->at++];
      eda_box b = x->box[i];
      if (b.x0 > w.x1 || b.x1 < w.x0 || b.y0 > w.y1 || b.y1 < w.y0) continue;
      /* Skip a box that extends into a cell on the left or below: that cell has
         already returned the box. */
      if ((b.x0 < f->left && f->column > f->cells.x0) ||
          (b.y0 < f->below && f->row > f->cells.y0))
        continue;
      *number = i;
      return 1;
    }
    if (f->column < f->cells.x1) {
      f->column++;
    } else if (f->row < f->cells.y1) {
      f->column = f->cells.x0;
      f->row++;
    } else {
      return 0;
    }
    enter_cell(f);
  }
}
