/* SPDX-License-Identifier: BSD-3-Clause */
/* Which shape contains a point: the first one in their order. Points lie in
   rows, sorted along each; a shape looks at those within its bounding box and
   takes what it contains out of the rows. So it is found which placement drew
   the active below each region: whose shape contains its middle. */
#include <stdlib.h>

#include "segment.h"

/* Coordinates are doubled. */
typedef struct spot {
  int64_t x, y;
  size_t row;
  uint32_t number;
} spot;

typedef struct rows {
  spot *spots;    /* by row, then x */
  uint32_t *free; /* free[k]: from k on, the first spot still there (or a
                     way to it); count is the end */
  size_t *first;  /* of each row */
  size_t count, rows;
  int64_t low, height;
} rows;

static int by_row(const void *a, const void *b) {
  const spot *p = a, *q = b;
  if (p->row != q->row) return p->row < q->row ? -1 : 1;
  if (p->x != q->x) return p->x < q->x ? -1 : 1;
  return (p->number > q->number) - (p->number < q->number);
}

static size_t first_free(rows *r, size_t k) {
  while (r->free[k] != k) {
    r->free[k] = r->free[r->free[k]];
    k = r->free[k];
  }
  return k;
}

static size_t row_of(const rows *r, int64_t y) {
  if (y < r->low) return 0;
  size_t row = (size_t)((y - r->low) / r->height);
  return row < r->rows ? row : r->rows - 1;
}

static int prepare(segment *s, rows *r, const doubled *points, size_t n) {
  r->count = n;
  r->rows = 1;
  while (r->rows * r->rows < n) r->rows++;
  r->spots = s->host->alloc(s->host, n, sizeof *r->spots);
  r->free = s->host->alloc(s->host, n + 1, sizeof *r->free);
  r->first = s->host->alloc(s->host, r->rows + 1, sizeof *r->first);
  if (!r->spots || !r->free || !r->first) return segment_no_memory(s);
  int64_t high = INT64_MIN;
  r->low = INT64_MAX;
  for (size_t i = 0; i < n; i++) {
    r->spots[i] = (spot){points[i].x, points[i].y, 0, (uint32_t)i};
    if (r->spots[i].y < r->low) r->low = r->spots[i].y;
    if (r->spots[i].y > high) high = r->spots[i].y;
  }
  r->height = (high - r->low) / (int64_t)r->rows + 1;
  for (size_t i = 0; i < n; i++) r->spots[i].row = row_of(r, r->spots[i].y);
  qsort(r->spots, n, sizeof *r->spots, by_row);
  for (size_t k = 0; k <= n; k++) r->free[k] = (uint32_t)k;
  for (size_t row = 0, k = 0; row <= r->rows; row++) {
    while (k < n && r->spots[k].row < row) k++;
    r->first[row] = k;
  }
  return OPC_OK;
}

/* Each place lies in exactly one of shapes that abut. */
static int contains(const opc_point *p, uint32_t n, const spot *at) {
  int wind = 0;
  for (uint32_t i = 0; i < n; i++) {
    opc_point a = p[i], b = p[i + 1 < n ? i + 1 : 0];
    if (2 * (int64_t)a.x > at->x) continue;
    if (2 * (int64_t)a.y <= at->y && 2 * (int64_t)b.y > at->y) wind++;
    if (2 * (int64_t)b.y <= at->y && 2 * (int64_t)a.y > at->y) wind--;
  }
  return wind != 0;
}

static size_t find_x(const rows *r, size_t from, size_t to, int64_t x) {
  while (from < to) {
    size_t middle = from + (to - from) / 2;
    if (r->spots[middle].x < x)
      from = middle + 1;
    else
      to = middle;
  }
  return from;
}

static void claim(rows *r, const opc_point *p, uint32_t n, uint32_t shape,
                  uint32_t *which) {
  opc_box box = {INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN};
  for (uint32_t i = 0; i < n; i++) {
    if (p[i].x < box.x0) box.x0 = p[i].x;
    if (p[i].y < box.y0) box.y0 = p[i].y;
    if (p[i].x > box.x1) box.x1 = p[i].x;
    if (p[i].y > box.y1) box.y1 = p[i].y;
  }
  if (n == 0 || 2 * (int64_t)box.y1 < r->low) return;
  size_t last = row_of(r, 2 * (int64_t)box.y1);
  for (size_t row = row_of(r, 2 * (int64_t)box.y0); row <= last; row++) {
    size_t k = find_x(r, r->first[row], r->first[row + 1], 2 * (int64_t)box.x0);
    for (k = first_free(r, k); k < r->first[row + 1]; k = first_free(r, k)) {
      const spot *at = &r->spots[k];
      if (at->x > 2 * (int64_t)box.x1) break;
      if (contains(p, n, at)) {
        which[at->number] = shape;
        r->free[k] = (uint32_t)(k + 1);
      } else {
        k++;
      }
    }
  }
}

int segment_find(segment *s, const doubled *points, size_t n,
                 const opc_shapes *shapes, uint32_t *which) {
  rows r = {0};
  for (size_t i = 0; i < n; i++) which[i] = UINT32_MAX;
  int code = n ? prepare(s, &r, points, n) : OPC_OK;
  for (size_t i = 0; !code && n && i < shapes->count; i++)
    claim(&r, shapes->points + shapes->start[i],
          shapes->start[i + 1] - shapes->start[i], (uint32_t)i, which);
  s->host->free(s->host, r.spots);
  s->host->free(s->host, r.free);
  s->host->free(s->host, r.first);
  return code;
}

/* The middle of a box. Anything else (to be refused) is told by its first
   corner, which has its interior above and to the right. */
static doubled middle_of(const opc_shapes *regions, size_t i) {
  const opc_point *p = regions->points + regions->start[i];
  uint32_t n = regions->start[i + 1] - regions->start[i];
  if (n != 4) return (doubled){2 * (int64_t)p->x, 2 * (int64_t)p->y};
  return (doubled){(int64_t)p[0].x + p[2].x, (int64_t)p[0].y + p[2].y};
}

int segment_locate(segment *s) {
  size_t n = s->regions.count;
  doubled *points = s->host->alloc(s->host, n, sizeof *points);
  s->placement = s->host->alloc(s->host, n, sizeof *s->placement);
  int code = points && s->placement ? OPC_OK : segment_no_memory(s);
  for (size_t i = 0; !code && i < n; i++) points[i] = middle_of(&s->regions, i);
  if (!code)
    code = segment_find(s, points, n, &s->active.shapes, s->placement);
  for (size_t i = 0; !code && i < n; i++)
    if (s->placement[i] != UINT32_MAX)
      s->placement[i] = s->active.placement[s->placement[i]];
  s->host->free(s->host, points);
  return code;
}
