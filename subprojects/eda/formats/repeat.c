/* SPDX-License-Identifier: BSD-3-Clause */
/* Shapes of one layer of a cell in an OASIS file. Equal shapes are written as
   one shape with a repetition. */
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

#include "formats/oasis.h"

/* Largest number of shapes among which equal shapes are searched, and of shapes
   of one repetition. */
enum { MANY = 1 << 19, MEMBERS = 1 << 16 };

static void shape_add(eda_oasis *out, const eda_point *points, size_t n) {
  eda_grow(&out->shapes, &out->capacity_shapes, out->n_shapes + 1,
           sizeof *out->shapes);
  eda_grow(&out->steps, &out->capacity_steps, out->n_steps + n,
           sizeof *out->steps);
  oasis_shape *s = &out->shapes[out->n_shapes++];
  *s = (oasis_shape){points[0], (uint32_t)n, out->n_steps};
  if (eda_is_box(points, n)) {
    eda_point a = points[0], b = points[2];
    eda_point low = {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y};
    s->at = low;
    s->n = 2;
    out->steps[out->n_steps++] =
        (oasis_step){(int64_t)(a.x < b.x ? b.x : a.x) - low.x,
                     (int64_t)(a.y < b.y ? b.y : a.y) - low.y};
    return;
  }
  for (size_t i = 1; i < n; i++)
    out->steps[out->n_steps++] = (oasis_step){
        (int64_t)points[i].x - points[0].x, (int64_t)points[i].y - points[0].y};
}

/* ---- order of shapes ---- */

static int compare_shape(const eda_oasis *out, const oasis_shape *a,
                         const oasis_shape *b) {
  if (a->n != b->n) return a->n < b->n ? -1 : 1;
  return memcmp(&out->steps[a->start], &out->steps[b->start],
                (a->n - 1) * sizeof *out->steps);
}

static int shape_compare(const void *first, const void *second, void *data) {
  const oasis_shape *a = first, *b = second;
  int order = compare_shape(data, a, b);
  if (order) return order;
  if (a->at.y != b->at.y) return a->at.y < b->at.y ? -1 : 1;
  return (a->at.x > b->at.x) - (a->at.x < b->at.x);
}

/* ---- repetitions ---- */

static int64_t dx(const oasis_shape *s) {
  return (int64_t)s[1].at.x - s[0].at.x;
}
static int64_t dy(const oasis_shape *s) {
  return (int64_t)s[1].at.y - s[0].at.y;
}

/* Return the number of leading shapes at constant steps; the first two shapes
   define the step. */
static size_t regular_shapes(const oasis_shape *s, size_t n) {
  size_t k = 1;
  while (k < n && dx(&s[k - 1]) == dx(s) && dy(&s[k - 1]) == dy(s)) k++;
  return k;
}

/* Return the number of leading rows of `columns` shapes at constant steps. */
static size_t regular_rows(const oasis_shape *s, size_t n, size_t columns) {
  size_t rows = 1;
  if (columns < 2 || n < 2 * columns) return 1;
  int64_t step = (int64_t)s[columns].at.y - s[0].at.y;
  for (; (rows + 1) * columns <= n; rows++) {
    const oasis_shape *row = &s[rows * columns];
    if (row->at.x != s->at.x ||
        row->at.y - (int64_t)s->at.y != (int64_t)rows * step ||
        regular_shapes(row, columns) < columns || dx(row) != dx(s) || dy(row))
      break;
  }
  return rows;
}

/* Choose a repetition for the first of n equal shapes. Return the number of
   shapes in the repetition; 1 means no repetition. *rows = 0 denotes a list. */
static size_t repetition_choose(const oasis_shape *s, size_t n, size_t *columns,
                                size_t *rows) {
  if (n > MEMBERS) n = MEMBERS;
  *rows = 1;
  *columns = regular_shapes(s, n);
  if (*columns == n || n == 1) return n;
  if (dy(s) == 0) {
    *rows = regular_rows(s, n, *columns);
    if (*rows > 1 && *rows * *columns * 2 >= n) return *rows * *columns;
  }
  *rows = 0; /* the positions are listed */
  return n;
}

static void put_repetition(eda_oasis *out, const oasis_shape *s, size_t covered,
                           size_t columns, size_t rows) {
  if (rows > 1) {
    eda_oasis_uint(out, 1);
    eda_oasis_uint(out, columns - 2);
    eda_oasis_uint(out, rows - 2);
    eda_oasis_uint(out, (uint64_t)dx(s));
    eda_oasis_uint(out, (uint64_t)((int64_t)s[columns].at.y - s->at.y));
  } else if (rows == 1) {
    eda_oasis_uint(out, 9);
    eda_oasis_uint(out, covered - 2);
    eda_oasis_delta(out, dx(s), dy(s));
  } else {
    eda_oasis_uint(out, 10);
    eda_oasis_uint(out, covered - 2);
    for (size_t i = 0; i + 1 < covered; i++)
      eda_oasis_delta(out, dx(s + i), dy(s + i));
  }
}

/* ---- records ---- */

/* Return whether horizontal and vertical edges alternate, starting with a
   horizontal edge if `first` is 1. The last point is then redundant in
   OASIS. */
static int by_turns(const oasis_step *d, uint32_t n, int first) {
  oasis_step a = {0, 0};
  if (n % 2) return 0;
  for (uint32_t i = 1; i <= n; i++) {
    oasis_step b = i < n ? d[i - 1] : (oasis_step){0, 0};
    int horizontal = (int)(i % 2) == first;
    if (horizontal ? b.y != a.y : b.x != a.x) return 0;
    a = b;
  }
  return 1;
}

static void put_points(eda_oasis *out, const oasis_step *d, uint32_t n) {
  int turns = by_turns(d, n, 1) ? 0 : by_turns(d, n, 0) ? 1 : -1;
  uint32_t count = turns < 0 ? n - 1 : n - 2;
  oasis_step a = {0, 0};
  eda_oasis_uint(out, turns < 0 ? 4 : (uint64_t)turns);
  eda_oasis_uint(out, count);
  for (uint32_t i = 0; i < count; a = d[i++]) {
    if (turns < 0)
      eda_oasis_delta(out, d[i].x - a.x, d[i].y - a.y);
    else
      eda_oasis_sint(out,
                     (i + (uint32_t)turns) % 2 ? d[i].y - a.y : d[i].x - a.x);
  }
}

static void put_shape(eda_oasis *out, const oasis_shape *s, int repeated) {
  const oasis_step *d = &out->steps[s->start];
  uint32_t more = repeated ? 4 : 0;
  int box = s->n == 2, square = box && d->x == d->y;
  eda_oasis_uint(out, box ? EDA_OASIS_RECTANGLE : EDA_OASIS_POLYGON);
  eda_oasis_byte(out, (!box ? 0x3b : square ? 0xdb : 0x7b) | more);
  eda_oasis_uint(out, out->layer.layer);
  eda_oasis_uint(out, out->layer.datatype);
  if (box) {
    eda_oasis_uint(out, (uint64_t)d->x);
    if (!square) eda_oasis_uint(out, (uint64_t)d->y);
  } else {
    put_points(out, d, s->n);
  }
  eda_oasis_sint(out, s->at.x);
  eda_oasis_sint(out, s->at.y);
}

void eda_oasis_end_shapes(eda_oasis *out) {
  if (out->n_shapes)
    qsort_r(out->shapes, out->n_shapes, sizeof *out->shapes, shape_compare,
            out);
  for (size_t i = 0; i < out->n_shapes;) {
    const oasis_shape *first = &out->shapes[i];
    size_t end = i + 1, columns, rows;
    while (end < out->n_shapes && !compare_shape(out, first, &out->shapes[end]))
      end++;
    while (i < end) {
      const oasis_shape *s = &out->shapes[i];
      size_t covered = repetition_choose(s, end - i, &columns, &rows);
      put_shape(out, s, covered > 1);
      if (covered > 1) put_repetition(out, s, covered, columns, rows);
      eda_oasis_end_record(out);
      i += covered;
    }
  }
  out->n_shapes = out->n_steps = 0;
}

void eda_oasis_polygon(eda_oasis *out, eda_layer_number layer,
                       const eda_point *points, size_t n) {
  if (layer.layer != out->layer.layer ||
      layer.datatype != out->layer.datatype || out->n_shapes >= MANY ||
      out->n_steps >= 4 * (size_t)MANY)
    eda_oasis_end_shapes(out);
  out->layer = layer;
  shape_add(out, points, n);
}
