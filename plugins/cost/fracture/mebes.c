/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the MEBES model. Rectangles are cut at the borders of stripes and
   segments. Positions along x do not depend on the row of the array. The size
   of all copies of a rectangle is therefore the size of one row of copies times
   the number of stripes that a row overlaps, summed over all rows. */
#include "mebes.h"

/* Sizes of records in bytes. */
enum {
  SEGMENT_BEGINS = 4,
  STRIPE_ENDS = 2,
  RECTANGLE = 8,
  ARRAY = 6, /* record that precedes a repeated rectangle */
  FILE_ENDS = 2
};

static int64_t floor_div(int64_t a, int64_t b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

/* Return the number of intervals of `size` that overlap [from, to); interval
   borders are multiples of `size`. */
static int64_t count_intervals(int64_t from, int64_t to, int64_t size) {
  return floor_div(to - 1, size) - floor_div(from, size) + 1;
}

int64_t mebes_segments(eda_box e, const mebes_array *a) {
  int64_t width = (int64_t)e.x1 - e.x0 + (a->columns - 1) * a->step_x;
  return width > 0 ? count_intervals(0, width, MEBES_SEGMENT) : 1;
}

static int64_t mebes_stripes(eda_box e, const mebes_array *a) {
  int64_t height = (int64_t)e.y1 - e.y0 + (a->rows - 1) * a->step_y;
  return height > 0 ? count_intervals(0, height, MEBES_STRIPE) : 1;
}

/* Return the size of all copies of [x0, x1) in a row. Copies within a segment
   are one record, preceded by an array record if there are several. A copy that
   borders cut has one record per part. */
static int64_t row_bytes(int64_t x0, int64_t x1, const mebes_array *a) {
  int64_t bytes = 0;
  for (int64_t c = 0; c < a->columns;) {
    int64_t from = x0 + c * a->step_x, to = x1 + c * a->step_x;
    int64_t n = count_intervals(from, to, MEBES_SEGMENT);
    if (n > 1) {
      bytes += n * RECTANGLE;
      c++;
      continue;
    }
    int64_t border = (floor_div(from, MEBES_SEGMENT) + 1) * MEBES_SEGMENT;
    int64_t whole = (border - to) / a->step_x + 1;
    if (whole > a->columns - c) whole = a->columns - c;
    bytes += whole > 1 ? ARRAY + RECTANGLE : RECTANGLE;
    c += whole;
  }
  return bytes;
}

static int64_t rows_pieces(int64_t y0, int64_t y1, const mebes_array *a) {
  int64_t n = 0;
  for (int64_t r = 0; r < a->rows; r++)
    n += count_intervals(y0 + r * a->step_y, y1 + r * a->step_y, MEBES_STRIPE);
  return n;
}

int64_t mebes_bytes(const eda_box *boxes, size_t count, eda_box e,
                    const mebes_array *a) {
  int64_t bytes = mebes_segments(e, a) *
                      (SEGMENT_BEGINS + STRIPE_ENDS * mebes_stripes(e, a)) +
                  FILE_ENDS;
  for (size_t i = 0; i < count; i++) {
    eda_box b = boxes[i];
    bytes += row_bytes((int64_t)b.x0 - e.x0, (int64_t)b.x1 - e.x0, a) *
             rows_pieces((int64_t)b.y0 - e.y0, (int64_t)b.y1 - e.y0, a);
  }
  return MEBES_BLOCK + (bytes + MEBES_BLOCK - 1) / MEBES_BLOCK * MEBES_BLOCK;
}
