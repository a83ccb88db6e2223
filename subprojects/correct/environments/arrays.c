/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements arrays: first rows along x, then equal rows along y. A row or
   column continues while the distance equals that of its first two elements.
   The arrays found equal the arrays of the drawn layout, except if two arrays
   touch. */
#include "arrays.h"

#include <eda/memory.h>
#include <stdlib.h>

typedef struct line {
  put first;
  uint32_t columns;
  int32_t step;
} line;

static int compare_numbers(int64_t a, int64_t b) { return (a > b) - (a < b); }

static int by_row(const void *a, const void *b) {
  const put *p = a, *q = b;
  int c = compare_numbers(p->cell, q->cell);
  if (!c) c = compare_numbers(p->orientation, q->orientation);
  if (!c) c = compare_numbers(p->at.y, q->at.y);
  return c ? c : compare_numbers(p->at.x, q->at.x);
}

static int compare_lines(const line *p, const line *q) {
  int c = compare_numbers(p->first.cell, q->first.cell);
  if (!c) c = compare_numbers(p->first.orientation, q->first.orientation);
  if (!c) c = compare_numbers(p->first.at.x, q->first.at.x);
  if (!c) c = compare_numbers(p->columns, q->columns);
  return c ? c : compare_numbers(p->step, q->step);
}

static int by_column(const void *a, const void *b) {
  const line *p = a, *q = b;
  int c = compare_lines(p, q);
  return c ? c : compare_numbers(p->first.at.y, q->first.at.y);
}

static line *find_lines(put *puts, size_t n, size_t *count) {
  line *lines = eda_alloc(n, sizeof *lines);
  size_t k = 0;
  if (n) qsort(puts, n, sizeof *puts, by_row);
  for (size_t i = 0; i < n;) {
    const put *p = &puts[i];
    line l = {*p, 1, 0};
    size_t next = i + 1;
    while (
        next < n && puts[next].cell == p->cell &&
        puts[next].orientation == p->orientation &&
        puts[next].at.y == p->at.y &&
        (l.columns == 1 || puts[next].at.x - puts[next - 1].at.x == l.step)) {
      l.step = puts[next].at.x - puts[next - 1].at.x;
      l.columns++;
      next++;
    }
    lines[k++] = l;
    i = next;
  }
  if (k) qsort(lines, k, sizeof *lines, by_column);
  *count = k;
  return lines;
}

int arrays_place(eda_layout *layout, int32_t top, const int32_t *cell,
                 put *puts, size_t n, size_t *arrays, opc_error *error) {
  size_t count;
  line *lines = find_lines(puts, n, &count);
  int code = OPC_OK;
  *arrays = 0;
  for (size_t i = 0; i < count && !code;) {
    const line *l = &lines[i];
    uint32_t rows = 1;
    int32_t step = 0;
    size_t next = i + 1;
    while (next < count && !compare_lines(l, &lines[next]) &&
           (rows == 1 ||
            lines[next].first.at.y - lines[next - 1].first.at.y == step)) {
      step = lines[next].first.at.y - lines[next - 1].first.at.y;
      rows++;
      next++;
    }
    const eda_placement p = {.origin = l->first.at,
                             .magnification = 1,
                             .angle = 90.0 * (l->first.orientation % 4),
                             .mirror = l->first.orientation / 4,
                             .columns = l->columns,
                             .rows = rows,
                             .column_step = {l->step, 0},
                             .row_step = {0, step}};
    code = eda_layout_add_instance(layout, top, cell[l->first.cell], &p, NULL,
                                   error);
    ++*arrays;
    i = next;
  }
  free(lines);
  return code;
}
