/* SPDX-License-Identifier: BSD-3-Clause */
/* The fewest rectangles (T. Ohtsuki, "Minimum dissection of rectilinear
   regions", ISCAS 1982): each concave corner costs a cut, but a chord between
   two of them serves both. Of the chords as many are taken as do not touch each
   other: a largest independent set of a bipartite graph, from a largest
   matching. The horizontal ones of these are barriers to a line that sweeps
   over the polygon from left to right and cuts at all other corners. */
#include "partition.h"

#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

/* Points of a polygon that is done so, as the work is cubic, and holes among
   which one is looked for in each polygon. */
enum { MOST = 512, MOST_HOLES = 1000 };

/* `at` is its y if it is horizontal, and from .. to its extent along x. */
typedef struct chord {
  int32_t at, from, to;
} chord;

typedef struct interval {
  int32_t low, high, since; /* y, y, and x where it began */
} interval;

typedef struct work {
  eda_point p[MOST];
  uint8_t concave[MOST];
  int n;
  chord chord[2][MOST]; /* horizontal, vertical */
  int chords[2];
  int match[2][MOST]; /* the partner of each, -1 for none */
  uint8_t seen[2][MOST];
  int32_t x[MOST]; /* of vertical edges, sorted */
  int columns;
  interval open[MOST];
  int opens;
  int32_t y[2 * MOST];
} work;

/* ---- chords ---- */

static int32_t along(eda_point p, int way) { return way ? p.y : p.x; }
static int32_t across(eda_point p, int way) { return way ? p.x : p.y; }

static eda_point point(const work *w, int i) { return w->p[(i + w->n) % w->n]; }

/* Which way the line through a corner goes on into the polygon: away from its
   edge of that way. */
static int onwards(const work *w, int i, int way) {
  eda_point p = point(w, i), a = point(w, i - 1), b = point(w, i + 1);
  eda_point other = across(a, way) == across(p, way) ? a : b;
  return along(other, way) < along(p, way) ? 1 : -1;
}

/* Whether an edge stands in the way between two corners. */
static int blocked(const work *w, int32_t at, int32_t from, int32_t to,
                   int way) {
  for (int i = 0; i < w->n; i++) {
    eda_point a = point(w, i), b = point(w, i + 1);
    int32_t place = along(a, way), s = across(a, way), t = across(b, way);
    if (along(b, way) != place || place <= from || place >= to) continue;
    if ((s <= at && t >= at) || (t <= at && s >= at)) return 1;
  }
  return 0;
}

static void find_chords(work *w, int way) {
  w->chords[way] = 0;
  for (int i = 0; i < w->n; i++) {
    if (!w->concave[i] || onwards(w, i, way) < 0) continue;
    int32_t at = across(w->p[i], way), from = along(w->p[i], way);
    for (int k = 0; k < w->n; k++) {
      int32_t to = along(w->p[k], way);
      if (!w->concave[k] || across(w->p[k], way) != at || to <= from ||
          onwards(w, k, way) > 0 || blocked(w, at, from, to, way))
        continue;
      w->chord[way][w->chords[way]++] = (chord){at, from, to};
      break;
    }
  }
}

/* ---- those that do not touch ---- */

static int touch(const work *w, int h, int v) {
  chord a = w->chord[0][h], b = w->chord[1][v];
  return b.at >= a.from && b.at <= a.to && a.at >= b.from && a.at <= b.to;
}

/* A way to match one more horizontal chord. */
static int augment(work *w, int h) {
  for (int v = 0; v < w->chords[1]; v++) {
    if (w->seen[1][v] || !touch(w, h, v)) continue;
    w->seen[1][v] = 1;
    if (w->match[1][v] >= 0 && !augment(w, w->match[1][v])) continue;
    w->match[0][h] = v;
    w->match[1][v] = h;
    return 1;
  }
  return 0;
}

/* All that alternating paths lead to from an unmatched horizontal one. */
static void visit(work *w, int h) {
  if (w->seen[0][h]) return;
  w->seen[0][h] = 1;
  for (int v = 0; v < w->chords[1]; v++) {
    if (w->seen[1][v] || !touch(w, h, v)) continue;
    w->seen[1][v] = 1;
    visit(w, w->match[1][v]); /* it has one, or the matching could grow */
  }
}

/* Keep the horizontal chords of a largest independent set. */
static void choose(work *w) {
  memset(w->match, -1, sizeof w->match);
  for (int h = 0; h < w->chords[0]; h++) {
    memset(w->seen, 0, sizeof w->seen);
    augment(w, h);
  }
  memset(w->seen, 0, sizeof w->seen);
  for (int h = 0; h < w->chords[0]; h++)
    if (w->match[0][h] < 0) visit(w, h);
  int kept = 0;
  for (int h = 0; h < w->chords[0]; h++)
    if (w->seen[0][h]) w->chord[0][kept++] = w->chord[0][h];
  w->chords[0] = kept;
}

/* ---- sweeping ---- */

static int by_value(const void *a, const void *b) {
  int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;
  return (p > q) - (p < q);
}

/* The y at which what is inside just right of x begins and ends, in pairs, cut
   by the chords that go on there. */
static int cross(work *w, int32_t x) {
  int n = 0;
  for (int i = 0; i < w->n; i++) {
    eda_point a = point(w, i), b = point(w, i + 1);
    if (a.y == b.y && (a.x <= x) != (b.x <= x)) w->y[n++] = a.y;
  }
  for (int h = 0; h < w->chords[0]; h++)
    if (w->chord[0][h].from <= x && w->chord[0][h].to > x) {
      w->y[n++] = w->chord[0][h].at; /* ends one, begins the next */
      w->y[n++] = w->chord[0][h].at;
    }
  qsort(w->y, (size_t)n, sizeof *w->y, by_value);
  return n;
}

static void sweep_to(work *w, int32_t x, eda_box_list *out) {
  int n = cross(w, x), kept = 0, k = 0;
  interval next[MOST];
  for (int i = 0; i < w->opens; i++) { /* both are in order of y */
    interval o = w->open[i];
    while (k < n && w->y[k] < o.low) k += 2;
    if (k < n && w->y[k] == o.low && w->y[k + 1] == o.high) continue;
    eda_box_list_add(out, (eda_box){o.since, o.low, x, o.high});
  }
  k = 0;
  for (int i = 0; i < n; i += 2) {
    while (k < w->opens && w->open[k].low < w->y[i]) k++;
    int goes_on = k < w->opens && w->open[k].low == w->y[i] &&
                  w->open[k].high == w->y[i + 1];
    next[kept++] =
        (interval){w->y[i], w->y[i + 1], goes_on ? w->open[k].since : x};
  }
  memcpy(w->open, next, (size_t)kept * sizeof *next);
  w->opens = kept;
}

static void sweep(work *w, eda_box_list *out) {
  w->columns = w->opens = 0;
  for (int i = 0; i < w->n; i++)
    if (point(w, i).x == point(w, i + 1).x) w->x[w->columns++] = w->p[i].x;
  qsort(w->x, (size_t)w->columns, sizeof *w->x, by_value);
  for (int i = 0; i < w->columns; i++)
    if (!i || w->x[i] != w->x[i - 1]) sweep_to(w, w->x[i], out);
}

/* Cut the polygon or, turned over, its mirror image. */
static void cut(work *w, const eda_point *p, int n, int turned,
                eda_box_list *out) {
  w->n = n;
  for (int i = 0; i < n; i++)
    w->p[i] = turned ? (eda_point){p[n - 1 - i].y, p[n - 1 - i].x} : p[i];
  for (int i = 0; i < n; i++) {
    eda_point a = point(w, i - 1), b = point(w, i), c = point(w, i + 1);
    w->concave[i] = ((int64_t)b.x - a.x) * ((int64_t)c.y - b.y) -
                        ((int64_t)b.y - a.y) * ((int64_t)c.x - b.x) <
                    0;
  }
  for (int way = 0; way < 2; way++) find_chords(w, way);
  choose(w);
  sweep(w, out);
}

/* Both ways give as few; the one with the shorter cuts leaves less slivers. */
static void cut_well(work *w, const eda_point *p, int n, eda_box_list *out) {
  size_t before = out->count, first;
  int64_t around[2] = {0, 0};
  cut(w, p, n, 0, out);
  first = out->count;
  cut(w, p, n, 1, out);
  for (size_t i = before; i < out->count; i++) {
    eda_box b = out->box[i];
    around[i >= first] += (int64_t)b.x1 - b.x0 + ((int64_t)b.y1 - b.y0);
  }
  if (around[1] < around[0])
    for (size_t i = first; i < out->count; i++) {
      eda_box b = out->box[i];
      out->box[before + i - first] = (eda_box){b.y0, b.x0, b.y1, b.x1};
    }
  out->count = first;
}

/* ---- all polygons ---- */

static eda_box bounds(const eda_shapes *s, size_t i) {
  return eda_bounds(s->points + s->start[i], s->start[i + 1] - s->start[i]);
}

/* A polygon that no hole may lie in, upright, and small enough. */
static int is_plain(const eda_shapes *s, size_t i, const eda_box *holes,
                    size_t n_holes) {
  uint32_t first = s->start[i], end = s->start[i + 1];
  if (end - first > MOST || n_holes > MOST_HOLES || (s->hole && s->hole[i]))
    return 0;
  for (uint32_t k = first; k < end; k++) {
    eda_point a = s->points[k], b = s->points[k + 1 < end ? k + 1 : first];
    if (a.x != b.x && a.y != b.y) return 0; /* for `fracture` to refuse */
  }
  eda_box b = n_holes ? bounds(s, i) : (eda_box){0};
  for (size_t h = 0; h < n_holes; h++)
    if (holes[h].x0 >= b.x0 && holes[h].x1 <= b.x1 && holes[h].y0 >= b.y0 &&
        holes[h].y1 <= b.y1)
      return 0;
  return 1;
}

/* Cut the plain polygons; the others are gathered in `rest`. */
static void cut_plain(const eda_shapes *s, eda_shapes *rest,
                      eda_box_list *out) {
  work *w = eda_alloc(1, sizeof *w);
  eda_box *holes = eda_alloc(s->count, sizeof *holes);
  size_t n_holes = 0;
  for (size_t i = 0; s->hole && i < s->count; i++)
    if (s->hole[i]) holes[n_holes++] = bounds(s, i);
  for (size_t i = 0; i < s->count; i++) {
    uint32_t n = s->start[i + 1] - s->start[i];
    const eda_point *p = s->points + s->start[i];
    if (is_plain(s, i, holes, n_holes)) {
      cut_well(w, p, (int)n, out);
      continue;
    }
    memcpy(rest->points + rest->start[rest->count], p, n * sizeof *p);
    rest->hole[rest->count] = s->hole && s->hole[i];
    rest->count++;
    rest->start[rest->count] = rest->start[rest->count - 1] + n;
  }
  free(w);
  free(holes);
}

int partition(const eda_shapes *s, eda_box **boxes, size_t *count,
              opc_error *error) {
  size_t points = s->count ? s->start[s->count] : 0, n = 0;
  eda_shapes rest = {.start = eda_alloc(s->count + 1, sizeof *rest.start),
                     .points = eda_alloc(points, sizeof *rest.points),
                     .hole = eda_alloc(s->count, 1)};
  eda_box_list out = {0};
  eda_box *others = NULL;
  cut_plain(s, &rest, &out);
  int code = eda_fracture(&rest, &others, &n, error);
  for (size_t i = 0; i < n && !code; i++) eda_box_list_add(&out, others[i]);
  free(others);
  eda_shapes_clear(&rest);
  if (code) {
    free(out.box);
    out = (eda_box_list){0};
  }
  *boxes = out.box;
  *count = out.count;
  return code;
}
