/* SPDX-License-Identifier: BSD-3-Clause */
#include "groups.h"

#include <stdlib.h>
#include <string.h>

#include "../../read/oasis/records.h"

/* Shapes that are compared with each other, members of one repetition. */
enum { MANY = 1 << 19, MEMBERS = 1 << 16 };

static int grow(void *array, size_t *room, size_t need, size_t size) {
  if (need <= *room) return 1;
  size_t wanted = need + need / 2 + 256;
  void *memory = realloc(*(void **)array, wanted * size);
  if (!memory) return 0;
  *(void **)array = memory;
  *room = wanted;
  return 1;
}

void groups_clear(groups *g) {
  free(g->shapes);
  free(g->points);
  *g = (groups){0};
}

int groups_full(const groups *g) {
  return g->n >= MANY || g->n_points >= 4 * (size_t)MANY;
}

static int is_box(const opc_point *p, size_t n) {
  return n == 4 && ((p[0].x == p[1].x && p[1].y == p[2].y && p[2].x == p[3].x &&
                     p[3].y == p[0].y) ||
                    (p[0].y == p[1].y && p[1].x == p[2].x && p[2].y == p[3].y &&
                     p[3].x == p[0].x));
}

int groups_add(groups *g, const opc_point *points, size_t n) {
  if (!grow(&g->shapes, &g->room, g->n + 1, sizeof *g->shapes) ||
      !grow(&g->points, &g->room_points, g->n_points + n, sizeof *g->points))
    return 0;
  group_shape *s = &g->shapes[g->n++];
  *s = (group_shape){points[0], (uint32_t)n, g->n_points};
  if (is_box(points, n)) {
    opc_point a = points[0], b = points[2];
    opc_point low = {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y};
    s->at = low;
    s->n = 2;
    g->points[g->n_points++] =
        (group_step){(int64_t)(a.x < b.x ? b.x : a.x) - low.x,
                     (int64_t)(a.y < b.y ? b.y : a.y) - low.y};
    return 1;
  }
  for (size_t i = 1; i < n; i++)
    g->points[g->n_points++] = (group_step){(int64_t)points[i].x - points[0].x,
                                            (int64_t)points[i].y - points[0].y};
  return 1;
}

/* ---- equal shapes side by side ---- */

static int compare_shape(const groups *g, const group_shape *a,
                         const group_shape *b) {
  if (a->n != b->n) return a->n < b->n ? -1 : 1;
  return memcmp(&g->points[a->start], &g->points[b->start],
                (a->n - 1) * sizeof *g->points);
}

static int compare(const void *first, const void *second, void *data) {
  const group_shape *a = first, *b = second;
  int order = compare_shape(data, a, b);
  if (order) return order;
  if (a->at.y != b->at.y) return a->at.y < b->at.y ? -1 : 1;
  return (a->at.x > b->at.x) - (a->at.x < b->at.x);
}

/* ---- repetitions ---- */

static int64_t dx(const group_shape *s) {
  return (int64_t)s[1].at.x - s[0].at.x;
}
static int64_t dy(const group_shape *s) {
  return (int64_t)s[1].at.y - s[0].at.y;
}

/* How many of the n shapes are one regular row (or column), the step being
   that of the first two. */
static size_t regular(const group_shape *s, size_t n) {
  size_t k = 1;
  while (k < n && dx(&s[k - 1]) == dx(s) && dy(&s[k - 1]) == dy(s)) k++;
  return k;
}

/* How many rows like the first one of `columns` follow each other, with the
   same step. */
static size_t regular_rows(const group_shape *s, size_t n, size_t columns) {
  size_t rows = 1;
  if (columns < 2 || n < 2 * columns) return 1;
  int64_t step = (int64_t)s[columns].at.y - s[0].at.y;
  for (; (rows + 1) * columns <= n; rows++) {
    const group_shape *row = &s[rows * columns];
    if (row->at.x != s->at.x ||
        row->at.y - (int64_t)s->at.y != (int64_t)rows * step ||
        regular(row, columns) < columns || dx(row) != dx(s) || dy(row))
      break;
  }
  return rows;
}

/* Write the repetition of the first shapes of n equal ones; how many it
   covers. One alone has none. */
static size_t choose(const group_shape *s, size_t n, size_t *columns,
                     size_t *rows) {
  if (n > MEMBERS) n = MEMBERS;
  *rows = 1;
  *columns = regular(s, n);
  if (*columns == n || n == 1) return n;
  if (dy(s) == 0) {
    *rows = regular_rows(s, n, *columns);
    if (*rows > 1 && *rows * *columns * 2 >= n) return *rows * *columns;
  }
  *rows = 0; /* a list */
  return n;
}

static void put_repetition(pack *p, const group_shape *s, size_t covered,
                           size_t columns, size_t rows) {
  if (rows > 1) {
    pack_uint(p, 1);
    pack_uint(p, columns - 2);
    pack_uint(p, rows - 2);
    pack_uint(p, (uint64_t)dx(s));
    pack_uint(p, (uint64_t)((int64_t)s[columns].at.y - s->at.y));
  } else if (rows == 1) {
    pack_uint(p, 9);
    pack_uint(p, covered - 2);
    pack_delta(p, dx(s), dy(s));
  } else {
    pack_uint(p, 10);
    pack_uint(p, covered - 2);
    for (size_t i = 0; i + 1 < covered; i++)
      pack_delta(p, dx(s + i), dy(s + i));
  }
}

/* ---- records ---- */

/* Whether edges are horizontal and vertical by turns, the first one horizontal
   if `first`: then the last point need not be said. */
static int by_turns(const group_step *d, uint32_t n, int first) {
  group_step a = {0, 0};
  if (n % 2) return 0;
  for (uint32_t i = 1; i <= n; i++) {
    group_step b = i < n ? d[i - 1] : (group_step){0, 0};
    int horizontal = (int)(i % 2) == first;
    if (horizontal ? b.y != a.y : b.x != a.x) return 0;
    a = b;
  }
  return 1;
}

static void put_points(pack *p, const group_step *d, uint32_t n) {
  int turns = by_turns(d, n, 1) ? 0 : by_turns(d, n, 0) ? 1 : -1;
  uint32_t count = turns < 0 ? n - 1 : n - 2;
  group_step a = {0, 0};
  pack_uint(p, turns < 0 ? 4 : (uint64_t)turns);
  pack_uint(p, count);
  for (uint32_t i = 0; i < count; a = d[i++]) {
    if (turns < 0)
      pack_delta(p, d[i].x - a.x, d[i].y - a.y);
    else
      pack_sint(p, (i + (uint32_t)turns) % 2 ? d[i].y - a.y : d[i].x - a.x);
  }
}

static void put_shape(const groups *g, pack *p, const group_shape *s,
                      layer_number layer, int repeated) {
  const group_step *d = &g->points[s->start];
  uint32_t more = repeated ? 4 : 0;
  if (s->n == 2) {
    int square = d->x == d->y;
    pack_uint(p, OASIS_RECTANGLE);
    pack_byte(p, (square ? 0xdb : 0x7b) | more);
    pack_uint(p, layer.layer);
    pack_uint(p, layer.datatype);
    pack_uint(p, (uint64_t)d->x);
    if (!square) pack_uint(p, (uint64_t)d->y);
  } else {
    pack_uint(p, OASIS_POLYGON);
    pack_byte(p, 0x3b | more);
    pack_uint(p, layer.layer);
    pack_uint(p, layer.datatype);
    put_points(p, d, s->n);
  }
  pack_sint(p, s->at.x);
  pack_sint(p, s->at.y);
}

void groups_put(groups *g, pack *p, layer_number layer) {
  qsort_r(g->shapes, g->n, sizeof *g->shapes, compare, g);
  for (size_t i = 0; i < g->n;) {
    size_t end = i + 1, columns, rows;
    while (end < g->n && !compare_shape(g, &g->shapes[i], &g->shapes[end]))
      end++;
    while (i < end) {
      const group_shape *s = &g->shapes[i];
      size_t covered = choose(s, end - i, &columns, &rows);
      put_shape(g, p, s, layer, covered > 1);
      if (covered > 1) put_repetition(p, s, covered, columns, rows);
      pack_record(p);
      i += covered;
    }
  }
  g->n = g->n_points = 0;
}
