/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the minimum partition into rectangles (T. Ohtsuki, "Minimum
   dissection of rectilinear regions", ISCAS 1982). Each concave corner requires
   a cut, but a chord between two concave corners serves both. The largest set
   of disjoint chords is selected: a maximum independent set of a bipartite
   graph, computed from a maximum matching.
   Each remaining corner is cut along x or y, which results in the same number
   of rectangles. A direction without slivers is preferred, then the shorter
   cut. Chords that cut off slivers are not used; an additional rectangle costs
   less. */
#include "partition.h"

#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

/* Largest number of points of a polygon, because the time is cubic, and largest
   number of holes that are searched for each polygon. */
enum { MOST = 512, MOST_HOLES = 1000 };

/* A cut. If horizontal, `at` is the y, and the cut extends from x = `from` to x
   = `to`. If vertical, x and y are exchanged. */
typedef struct chord {
  int32_t at, from, to;
} chord;

enum { EDGE = 1, CUT = 2 }; /* kinds of a cell's borders */

typedef struct work {
  eda_point p[MOST];
  uint8_t concave[MOST];
  int n;
  chord chord[2][MOST]; /* horizontal, vertical */
  int chords[2];
  int match[2][MOST]; /* partner of each chord, or -1 */
  uint8_t seen[2][MOST];
  int32_t line[2][MOST]; /* sorted x of vertical edges, y of horizontal edges */
  int lines[2];
  /* Cells between these lines: kinds of the left and lower borders. */
  uint8_t left[MOST / 2][MOST / 2], below[MOST / 2][MOST / 2];
  uint8_t done[MOST / 2][MOST / 2];
} work;

/* ---- chords ---- */

static int32_t coordinate_along(eda_point p, int axis) {
  return axis ? p.y : p.x;
}
static int32_t coordinate_across(eda_point p, int axis) {
  return axis ? p.x : p.y;
}

static eda_point corner_at(const work *w, int i) {
  return w->p[(i + w->n) % w->n];
}

/* Return the sign of the direction in which a line along `axis` through a
   corner enters the polygon: opposite to the edge along that axis. */
static int inward_sign(const work *w, int i, int axis) {
  eda_point p = corner_at(w, i), a = corner_at(w, i - 1),
            b = corner_at(w, i + 1);
  eda_point other =
      coordinate_across(a, axis) == coordinate_across(p, axis) ? a : b;
  return coordinate_along(other, axis) < coordinate_along(p, axis) ? 1 : -1;
}

/* Return 1 if an edge crosses the line between two corners. */
static int is_blocked(const work *w, int32_t at, int32_t from, int32_t to,
                      int axis) {
  for (int i = 0; i < w->n; i++) {
    eda_point a = corner_at(w, i), b = corner_at(w, i + 1);
    int32_t place = coordinate_along(a, axis), s = coordinate_across(a, axis),
            t = coordinate_across(b, axis);
    if (coordinate_along(b, axis) != place || place <= from || place >= to)
      continue;
    if ((s <= at && t >= at) || (t <= at && s >= at)) return 1;
  }
  return 0;
}

static void find_chords(work *w, int axis) {
  w->chords[axis] = 0;
  for (int i = 0; i < w->n; i++) {
    if (!w->concave[i] || inward_sign(w, i, axis) < 0) continue;
    int32_t at = coordinate_across(w->p[i], axis),
            from = coordinate_along(w->p[i], axis);
    for (int k = 0; k < w->n; k++) {
      int32_t to = coordinate_along(w->p[k], axis);
      if (!w->concave[k] || coordinate_across(w->p[k], axis) != at ||
          to <= from || inward_sign(w, k, axis) > 0 ||
          is_blocked(w, at, from, to, axis))
        continue;
      w->chord[axis][w->chords[axis]++] = (chord){at, from, to};
      break;
    }
  }
}

/* ---- slivers ---- */

static int32_t distance_beside(chord c, int32_t at, int32_t from, int32_t to,
                               int32_t least) {
  int32_t d = at > c.at ? at - c.at : c.at - at;
  int32_t low = from < to ? from : to, high = from < to ? to : from;
  return d > 0 && d < least && low < c.to && high > c.from ? d : least;
}

/* Return the distance of a cut from the nearest parallel edge or earlier cut
   (the first `cuts` cuts), limited to `sliver`. */
static int32_t cut_thickness(const work *w, chord c, int axis, int cuts,
                             int32_t sliver) {
  for (int k = 0; k < w->n; k++) {
    eda_point a = corner_at(w, k), b = corner_at(w, k + 1);
    if (coordinate_across(a, axis) == coordinate_across(b, axis))
      sliver = distance_beside(c, coordinate_across(a, axis),
                               coordinate_along(a, axis),
                               coordinate_along(b, axis), sliver);
  }
  for (int k = 0; k < cuts; k++) {
    chord o = w->chord[axis][k];
    sliver = distance_beside(c, o.at, o.from, o.to, sliver);
  }
  return sliver;
}

/* Keep the chords that do not cut off slivers. */
static void drop_thin(work *w, int32_t sliver) {
  uint8_t thin[2][MOST];
  for (int axis = 0; axis < 2; axis++)
    for (int i = 0; i < w->chords[axis]; i++)
      thin[axis][i] =
          cut_thickness(w, w->chord[axis][i], axis, 0, sliver) < sliver;
  for (int axis = 0; axis < 2; axis++) {
    int kept = 0;
    for (int i = 0; i < w->chords[axis]; i++)
      if (!thin[axis][i]) w->chord[axis][kept++] = w->chord[axis][i];
    w->chords[axis] = kept;
  }
}

/* ---- independent chords ---- */

static int chords_touch(const work *w, int h, int v) {
  chord a = w->chord[0][h], b = w->chord[1][v];
  return b.at >= a.from && b.at <= a.to && a.at >= b.from && a.at <= b.to;
}

/* Find an augmenting path for a horizontal chord. Returns 1 on success. */
static int match_augment(work *w, int h) {
  for (int v = 0; v < w->chords[1]; v++) {
    if (w->seen[1][v] || !chords_touch(w, h, v)) continue;
    w->seen[1][v] = 1;
    if (w->match[1][v] >= 0 && !match_augment(w, w->match[1][v])) continue;
    w->match[0][h] = v;
    w->match[1][v] = h;
    return 1;
  }
  return 0;
}

/* Mark the chords reachable by alternating paths from an unmatched chord h. */
static void match_visit(work *w, int h) {
  if (w->seen[0][h]) return;
  w->seen[0][h] = 1;
  for (int v = 0; v < w->chords[1]; v++) {
    if (w->seen[1][v] || !chords_touch(w, h, v)) continue;
    w->seen[1][v] = 1;
    match_visit(w, w->match[1][v]); /* the chord is matched, because the
                                       matching is maximum */
  }
}

/* Keep the chords of a maximum independent set. */
static void choose_chords(work *w) {
  memset(w->match, -1, sizeof w->match);
  for (int h = 0; h < w->chords[0]; h++) {
    memset(w->seen, 0, sizeof w->seen);
    match_augment(w, h);
  }
  memset(w->seen, 0, sizeof w->seen);
  for (int h = 0; h < w->chords[0]; h++)
    if (w->match[0][h] < 0) match_visit(w, h);
  for (int axis = 0; axis < 2; axis++) {
    int kept = 0;
    for (int i = 0; i < w->chords[axis]; i++)
      if (w->seen[axis][i] == !axis) w->chord[axis][kept++] = w->chord[axis][i];
    w->chords[axis] = kept;
  }
}

/* ---- remaining corners ---- */

static int is_served(const work *w, int i) {
  for (int axis = 0; axis < 2; axis++)
    for (int k = 0; k < w->chords[axis]; k++) {
      chord c = w->chord[axis][k];
      int32_t at = coordinate_along(w->p[i], axis);
      if (c.at == coordinate_across(w->p[i], axis) &&
          (c.from == at || c.to == at))
        return 1;
    }
  return 0;
}

/* Return the cut from a corner to the next edge or cut. */
static chord cut_from(const work *w, int i, int axis) {
  int32_t at = coordinate_across(w->p[i], axis),
          from = coordinate_along(w->p[i], axis);
  int sign = inward_sign(w, i, axis);
  int64_t found = INT64_MAX;
  for (int k = 0; k < w->n; k++) {
    eda_point a = corner_at(w, k), b = corner_at(w, k + 1);
    int32_t s = coordinate_across(a, axis), t = coordinate_across(b, axis);
    int64_t d = sign * ((int64_t)coordinate_along(a, axis) - from);
    if (coordinate_along(b, axis) != coordinate_along(a, axis) || d <= 0 ||
        d >= found)
      continue;
    if ((s <= at && t >= at) || (t <= at && s >= at)) found = d;
  }
  for (int k = 0; k < w->chords[!axis]; k++) {
    chord c = w->chord[!axis][k];
    int64_t d = sign * ((int64_t)c.at - from);
    if (d > 0 && d < found && c.from <= at && c.to >= at) found = d;
  }
  int32_t end = (int32_t)(from + sign * found);
  return sign > 0 ? (chord){at, from, end} : (chord){at, end, from};
}

static void cut_corners(work *w, int32_t sliver) {
  for (int i = 0; i < w->n; i++) {
    if (!w->concave[i] || is_served(w, i)) continue;
    chord c[2];
    int32_t thick[2];
    for (int axis = 0; axis < 2; axis++) {
      c[axis] = cut_from(w, i, axis);
      thick[axis] = cut_thickness(w, c[axis], axis, w->chords[axis], sliver);
    }
    int upright = thick[1] != thick[0]
                      ? thick[1] > thick[0]
                      : c[1].to - c[1].from < c[0].to - c[0].from;
    w->chord[upright][w->chords[upright]++] = c[upright];
  }
}

/* ---- from cuts to rectangles ---- */

static void find_lines(work *w) {
  for (int axis = 0; axis < 2; axis++) {
    int32_t *line = w->line[axis];
    int n = 0, kept = 0;
    for (int i = 0; i < w->n; i++)
      if (coordinate_along(corner_at(w, i), axis) ==
          coordinate_along(corner_at(w, i + 1), axis))
        line[n++] = coordinate_along(corner_at(w, i), axis);
    qsort(line, (size_t)n, sizeof *line, eda_int32s_rise);
    for (int i = 0; i < n; i++)
      if (!i || line[i] != line[i - 1]) line[kept++] = line[i];
    w->lines[axis] = kept;
  }
}

static int number_of(const work *w, int axis, int32_t value) {
  const int32_t *line = w->line[axis];
  return (int)((const int32_t *)bsearch(&value, line, (size_t)w->lines[axis],
                                        sizeof *line, eda_int32s_rise) -
               line);
}

/* Mark an edge or a cut as the border of the adjacent cells. */
static void put_wall(work *w, int axis, chord c, uint8_t what) {
  int at = number_of(w, !axis, c.at);
  int from = number_of(w, axis, c.from), to = number_of(w, axis, c.to);
  for (int i = from; i < to; i++)
    if (axis)
      w->left[i][at] |= what;
    else
      w->below[at][i] |= what;
}

static void put_walls(work *w) {
  int columns = w->lines[0], rows = w->lines[1];
  for (int j = 0; j < rows; j++) {
    memset(w->left[j], 0, (size_t)columns);
    memset(w->below[j], 0, (size_t)columns);
    memset(w->done[j], 0, (size_t)columns);
  }
  for (int i = 0; i < w->n; i++) {
    eda_point a = corner_at(w, i), b = corner_at(w, i + 1);
    int axis = a.x == b.x;
    int32_t s = coordinate_along(a, axis), t = coordinate_along(b, axis);
    put_wall(w, axis,
             (chord){coordinate_across(a, axis), s < t ? s : t, s < t ? t : s},
             EDGE);
  }
  for (int axis = 0; axis < 2; axis++)
    for (int i = 0; i < w->chords[axis]; i++)
      put_wall(w, axis, w->chord[axis][i], CUT);
}

/* Append the rectangle whose lower left cell is (i, j). */
static void take_rectangle(work *w, int i, int j, eda_box_list *out) {
  int right = i + 1, top = j + 1;
  while (!w->left[j][right]) right++;
  while (!w->below[top][i]) top++;
  for (int y = j; y < top; y++) memset(w->done[y] + i, 1, (size_t)(right - i));
  eda_box_list_add(out, (eda_box){w->line[0][i], w->line[1][j],
                                  w->line[0][right], w->line[1][top]});
}

static void take_all(work *w, eda_box_list *out) {
  for (int j = 0; j + 1 < w->lines[1]; j++) {
    int inside = 0;
    for (int i = 0; i + 1 < w->lines[0]; i++) {
      inside ^= w->left[j][i] & EDGE;
      if (inside && !w->done[j][i]) take_rectangle(w, i, j, out);
    }
  }
}

static void cut_polygon(work *w, const eda_point *p, int n, int32_t sliver,
                        eda_box_list *out) {
  w->n = n;
  memcpy(w->p, p, (size_t)n * sizeof *p);
  for (int i = 0; i < n; i++) {
    eda_point a = corner_at(w, i - 1), b = corner_at(w, i),
              c = corner_at(w, i + 1);
    w->concave[i] = ((int64_t)b.x - a.x) * ((int64_t)c.y - b.y) -
                        ((int64_t)b.y - a.y) * ((int64_t)c.x - b.x) <
                    0;
  }
  for (int axis = 0; axis < 2; axis++) find_chords(w, axis);
  drop_thin(w, sliver);
  choose_chords(w);
  cut_corners(w, sliver);
  find_lines(w);
  put_walls(w);
  take_all(w, out);
}

/* ---- all polygons ---- */

/* Return 1 for a rectilinear polygon without holes, within the limits. */
static int is_plain(const eda_shapes *s, size_t i, const eda_box *holes,
                    size_t n_holes) {
  uint32_t first = s->start[i], end = s->start[i + 1];
  if (end - first > MOST || n_holes > MOST_HOLES || (s->hole && s->hole[i]))
    return 0;
  for (uint32_t k = first; k < end; k++) {
    eda_point a = s->points[k], b = s->points[k + 1 < end ? k + 1 : first];
    if (a.x != b.x && a.y != b.y) return 0; /* rejected by eda_fracture */
  }
  eda_box b = n_holes ? eda_shape_box(s, i) : (eda_box){0};
  for (size_t h = 0; h < n_holes; h++)
    if (holes[h].x0 >= b.x0 && holes[h].x1 <= b.x1 && holes[h].y0 >= b.y0 &&
        holes[h].y1 <= b.y1)
      return 0;
  return 1;
}

/* Partition the plain polygons, and collect the other polygons in `rest`. */
static void cut_plain(const eda_shapes *s, int32_t sliver, eda_shapes *rest,
                      eda_box_list *out) {
  work *w = eda_alloc(1, sizeof *w);
  eda_box *holes = eda_alloc(s->count, sizeof *holes);
  size_t n_holes = 0;
  for (size_t i = 0; s->hole && i < s->count; i++)
    if (s->hole[i]) holes[n_holes++] = eda_shape_box(s, i);
  for (size_t i = 0; i < s->count; i++) {
    uint32_t n = s->start[i + 1] - s->start[i];
    const eda_point *p = s->points + s->start[i];
    if (is_plain(s, i, holes, n_holes)) {
      cut_polygon(w, p, (int)n, sliver, out);
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

int partition(const eda_shapes *s, int32_t sliver, eda_box **boxes,
              size_t *count, opc_error *error) {
  size_t points = s->count ? s->start[s->count] : 0, n = 0;
  eda_shapes rest = {.start = eda_alloc(s->count + 1, sizeof *rest.start),
                     .points = eda_alloc(points, sizeof *rest.points),
                     .hole = eda_alloc(s->count, 1)};
  eda_box_list out = {0};
  eda_box *others = NULL;
  cut_plain(s, sliver, &rest, &out);
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
