/* SPDX-License-Identifier: BSD-3-Clause */
#include "epe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* No more cells than a few for each item, however sparse they lie. */
enum { CELLS_PER_ITEM = 4 };

static void set_cell(epe_bins *b, size_t n, int32_t cell) {
  double w = (double)b->extent.x1 - b->extent.x0 + 1;
  double h = (double)b->extent.y1 - b->extent.y0 + 1;
  double most = CELLS_PER_ITEM * (double)n + 1;
  double size = cell > 0 ? cell : 1;
  while (ceil(w / size) * ceil(h / size) > most) size = ceil(size * 1.5);
  b->cell = (int64_t)size;
  b->columns = (int32_t)ceil(w / size);
  b->rows = (int32_t)ceil(h / size);
}

/* Count the cells of all boxes (items NULL) or put the items into them. */
static void spread(epe_bins *b, const opc_box *boxes, size_t n) {
  for (size_t i = 0; i < n; i++)
    for (int32_t r = epe_row(b, boxes[i].y0); r <= epe_row(b, boxes[i].y1); r++)
      for (int32_t c = epe_column(b, boxes[i].x0);
           c <= epe_column(b, boxes[i].x1); c++) {
        uint32_t *at = &b->start[(size_t)r * (size_t)b->columns + (size_t)c];
        if (b->items) b->items[*at] = (uint32_t)i;
        ++*at;
      }
}

int epe_bins_make(epe_bins *b, const opc_box *boxes, size_t n, int32_t cell) {
  *b = (epe_bins){.extent = {0, 0, 0, 0}};
  if (n) b->extent = boxes[0];
  for (size_t i = 1; i < n; i++) {
    if (boxes[i].x0 < b->extent.x0) b->extent.x0 = boxes[i].x0;
    if (boxes[i].y0 < b->extent.y0) b->extent.y0 = boxes[i].y0;
    if (boxes[i].x1 > b->extent.x1) b->extent.x1 = boxes[i].x1;
    if (boxes[i].y1 > b->extent.y1) b->extent.y1 = boxes[i].y1;
  }
  set_cell(b, n, cell);
  size_t cells = (size_t)b->columns * (size_t)b->rows;
  b->start = calloc(cells + 1, sizeof *b->start);
  if (!b->start) return 0;
  spread(b, boxes, n);
  uint32_t sum = 0;
  for (size_t k = 0; k <= cells; k++) {
    uint32_t here = b->start[k];
    b->start[k] = sum;
    sum += here;
  }
  b->items = calloc(sum ? sum : 1, sizeof *b->items);
  if (!b->items) return 0;
  spread(b, boxes, n);
  memmove(b->start + 1, b->start, cells * sizeof *b->start);
  b->start[0] = 0;
  return 1;
}

void epe_bins_clear(epe_bins *b) {
  free(b->start);
  free(b->items);
  *b = (epe_bins){.extent = {0, 0, 0, 0}};
}
