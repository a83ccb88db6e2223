/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements point lists and repetitions (SEMI P39, sections 7.6 and 7.7). */
#include <eda/memory.h>

#include "oasis.h"

static void add_point(oasis_points *points, oasis_vector p) {
  eda_grow(&points->p, &points->capacity, points->n + 1, sizeof p);
  points->p[points->n++] = p;
}

static oasis_vector offsets_add(oasis *o, oasis_vector a, oasis_vector b) {
  return (oasis_vector){oasis_length(o, a.x + b.x), oasis_length(o, a.y + b.y)};
}

/* ---- point lists ---- */

void oasis_read_points(oasis *o, oasis_points *points, int closed) {
  uint64_t type = oasis_uint(o), n = oasis_uint(o);
  if (type > 5) {
    oasis_refuse(o, "an unknown kind of point list");
    return;
  }
  oasis_vector at = {0, 0}, step = {0, 0};
  points->n = 0;
  add_point(points, at);
  for (uint64_t i = 0; i < n && !o->b.failed; i++) {
    oasis_vector d;
    if (type <= 1)
      d = oasis_delta1(o, (int)((i + type) % 2 == 0));
    else if (type == 2)
      d = oasis_delta2(o);
    else if (type == 3)
      d = oasis_delta3(o);
    else
      d = oasis_deltag(o);
    if (type == 5) d = step = offsets_add(o, step, d);
    at = offsets_add(o, at, d);
    if (!o->b.failed) add_point(points, at);
  }
  /* The last corner of a rectilinear polygon is not in the file. */
  if (closed && type <= 1 && !o->b.failed) {
    int horizontal = (int)((n + type) % 2 == 0);
    at = horizontal ? (oasis_vector){0, at.y} : (oasis_vector){at.x, 0};
    add_point(points, at);
  }
}

/* ---- repetitions ---- */

static uint64_t read_dimension(oasis *o) {
  uint64_t n = oasis_uint(o);
  if (n < (uint64_t)1 << 62) return n + 2;
  oasis_refuse(o, "a repetition of too many members");
  return 2;
}

static int64_t read_space(oasis *o) { return oasis_size(o, oasis_uint(o)); }

/* Return v times the common factor of the offsets of a repetition. */
static int64_t on_grid(oasis *o, int64_t v, int64_t grid) {
  int64_t product;
  if (__builtin_mul_overflow(v, grid, &product)) product = INT64_MAX;
  return oasis_length(o, product);
}

/* Read the offsets of repetition types 4 to 7 (along x or y), 10 and 11. */
static void read_offsets(oasis *o, uint64_t type, oasis_points *out) {
  uint64_t n = read_dimension(o);
  int64_t grid = type & 1 ? read_space(o) : 1;
  oasis_vector at = {0, 0};
  out->n = 0;
  if (!o->b.failed) add_point(out, at);
  for (uint64_t i = 1; i < n && !o->b.failed; i++) {
    oasis_vector d = {0, 0};
    if (type >= 10)
      d = oasis_deltag(o);
    else if (type <= 5)
      d.x = read_space(o);
    else
      d.y = read_space(o);
    d.x = on_grid(o, d.x, grid);
    d.y = on_grid(o, d.y, grid);
    at = offsets_add(o, at, d);
    if (!o->b.failed) add_point(out, at);
  }
}

/* A length beyond all coordinates; sums with this length do not overflow. */
#define BEYOND ((int64_t)1 << 40)

static void bounds_extend(oasis_repetition *r, int64_t x, int64_t y) {
  if (x < r->low.x) r->low.x = x;
  if (y < r->low.y) r->low.y = y;
  if (x > r->high.x) r->high.x = x;
  if (y > r->high.y) r->high.y = y;
}

/* Return (n - 1) * step, limited to -BEYOND .. BEYOND; BEYOND after an
   overflow. */
static int64_t last_offset(uint64_t n, int64_t step) {
  int64_t product;
  if (__builtin_mul_overflow((int64_t)n - 1, step, &product)) return BEYOND;
  return product > BEYOND ? BEYOND : product < -BEYOND ? -BEYOND : product;
}

static void repetition_bounds(oasis_repetition *r) {
  r->low = r->high = (oasis_vector){0, 0};
  for (size_t i = 0; !r->lattice && i < r->offsets.n; i++)
    bounds_extend(r, r->offsets.p[i].x, r->offsets.p[i].y);
  if (!r->lattice) return;
  int64_t cx = last_offset(r->columns, r->column.x),
          cy = last_offset(r->columns, r->column.y);
  int64_t rx = last_offset(r->rows, r->row.x),
          ry = last_offset(r->rows, r->row.y);
  bounds_extend(r, cx, cy);
  bounds_extend(r, rx, ry);
  bounds_extend(r, cx + rx, cy + ry);
}

void oasis_read_repetition(oasis *o) {
  oasis_repetition *r = &o->m.repetition;
  uint64_t type = oasis_uint(o);
  if (type > 11) oasis_refuse(o, "an unknown kind of repetition");
  if (o->b.failed) return;
  if (type == 0) {
    oasis_need(o, NULL, HAS_REPETITION);
    return;
  }
  r->columns = r->rows = 1;
  r->column = r->row = (oasis_vector){0, 0};
  r->lattice = type <= 3 || type == 8 || type == 9;
  if (type == 1 || type == 2 || type == 8 || type == 9)
    r->columns = read_dimension(o);
  if (type == 1 || type == 3 || type == 8) r->rows = read_dimension(o);
  if (type == 1 || type == 2) r->column.x = read_space(o);
  if (type == 1 || type == 3) r->row.y = read_space(o);
  if (type == 8 || type == 9) r->column = oasis_deltag(o);
  if (type == 8) r->row = oasis_deltag(o);
  if (!r->lattice) read_offsets(o, type, &r->offsets);
  if (o->b.failed) return;
  repetition_bounds(r);
  o->m.has |= HAS_REPETITION;
}

uint64_t oasis_members(const oasis *o, int repeated) {
  const oasis_repetition *r = &o->m.repetition;
  uint64_t n;
  if (!repeated) return 1;
  if (!r->lattice) return r->offsets.n;
  return __builtin_mul_overflow(r->columns, r->rows, &n) ? UINT64_MAX : n;
}

oasis_vector oasis_member(const oasis *o, int repeated, uint64_t i) {
  const oasis_repetition *r = &o->m.repetition;
  if (!repeated) return (oasis_vector){0, 0};
  if (!r->lattice) return r->offsets.p[i];
  int64_t c = (int64_t)(i % r->columns), k = (int64_t)(i / r->columns);
  return (oasis_vector){c * r->column.x + k * r->row.x,
                        c * r->column.y + k * r->row.y};
}
