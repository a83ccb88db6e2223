/* SPDX-License-Identifier: BSD-3-Clause */
/* Outline of a path.

   The path is traversed forwards and backwards, and each traversal adds the
   right side of the path. The result is the union of a rectangle for each
   segment and a wedge at each outer corner. The winding number is at least 1
   inside the path and 0 elsewhere, even if the path crosses itself. An inner
   corner is mitred only if the mitre is inside both segments; otherwise the
   outline passes through the point of the path. */
#include <math.h>
#include <stdlib.h>

#include "layout/layout.h"

enum { ARC = 16 }; /* edges of a semicircular end */

typedef struct vector {
  double x, y;
} vector;

/* One traversal of a path. */
typedef struct outline_pass {
  const vector *points;
  size_t n;
  double half;        /* half of the path width */
  double first, last; /* extension beyond the first and last point */
  bool round;         /* the last end is round */
  bool back;          /* backward traversal */
} outline_pass;

typedef struct outline {
  eda_point *points;
  size_t n;
  bool outside; /* 1: a coordinate exceeds 32 bits */
} outline;

static void outline_put(outline *out, double x, double y) {
  x = floor(x + 0.5);
  y = floor(y + 0.5);
  if (fabs(x) > INT32_MAX || fabs(y) > INT32_MAX) {
    out->outside = true;
    return;
  }
  out->points[out->n++] = (eda_point){(int32_t)x, (int32_t)y};
}

/* Add the point at + along * d + half * (unit normal of d to the right). */
static void put_beside(outline *out, vector at, vector d, double along,
                       double half) {
  outline_put(out, at.x + along * d.x + half * d.y,
              at.y + along * d.y - half * d.x);
}

static vector segment_direction(vector a, vector b, double *length) {
  *length = hypot(b.x - a.x, b.y - a.y);
  return (vector){(b.x - a.x) / *length, (b.y - a.y) / *length};
}

/* Add the right side of a corner at `at` between segments of directions d and
   e. `shorter` is the length of the shorter segment. */
static void put_corner(outline *out, const outline_pass *w, vector at, vector d,
                       vector e, double shorter) {
  double h = w->half;
  double cross = d.x * e.y - d.y * e.x, dot = d.x * e.x + d.y * e.y;
  double mitre = h * fabs(cross) / (1 + dot); /* length of the mitre, h tan(turn
                                                 / 2); may be infinite */
  if (cross > 0 || (cross == 0 && !w->back)) {
    if (dot > -1e-9) {
      put_beside(out, at, d, mitre, h);
    } else {
      put_beside(out, at, d, h, h);
      put_beside(out, at, e, -h, h);
    }
  } else if (mitre <= shorter) {
    put_beside(out, at, d, -mitre, h);
  } else {
    put_beside(out, at, d, 0, h);
    outline_put(out, at.x, at.y);
    put_beside(out, at, e, 0, h);
  }
}

static void put_outline_pass(outline *out, const outline_pass *w) {
  double length;
  vector d = segment_direction(w->points[0], w->points[1], &length);
  put_beside(out, w->points[0], d, -w->first, w->half);
  for (size_t i = 1; i + 1 < w->n; i++) {
    double next;
    vector e = segment_direction(w->points[i], w->points[i + 1], &next);
    put_corner(out, w, w->points[i], d, e, fmin(length, next));
    d = e;
    length = next;
  }
  vector end = w->points[w->n - 1];
  put_beside(out, end, d, w->last, w->half);
  for (int i = 1; w->round && i < ARC; i++)
    put_beside(out, end, d, w->half * sin(G_PI * i / ARC),
               w->half * cos(G_PI * i / ARC));
}

/* Copy the points except repeated points and points within straight lines.
   Return the number of copied points. */
static size_t points_clean(const eda_point *points, size_t n, vector *out) {
  size_t m = 0;
  for (size_t i = 0; i < n; i++) {
    vector p = {points[i].x, points[i].y};
    if (m && out[m - 1].x == p.x && out[m - 1].y == p.y) continue;
    if (m >= 2) {
      vector d = {out[m - 1].x - out[m - 2].x, out[m - 1].y - out[m - 2].y};
      vector e = {p.x - out[m - 1].x, p.y - out[m - 1].y};
      if (d.x * e.y == d.y * e.x && d.x * e.x + d.y * e.y > 0) m--;
    }
    out[m++] = p;
  }
  return m;
}

static void points_reverse(vector *points, size_t n) {
  for (size_t i = 0; i < n / 2; i++) {
    vector kept = points[i];
    points[i] = points[n - 1 - i];
    points[n - 1 - i] = kept;
  }
}

/* Compute the extensions of both ends. A negative extension is limited to the
   length of the segment. Return false if nothing of the path remains. */
static bool path_reach(const vector *points, size_t n, double half, int ends,
                       double *begin, double *end) {
  if (ends == 0 || ends == 1) *begin = *end = 0;
  if (ends == 2) *begin = *end = half;
  double first, last;
  segment_direction(points[0], points[1], &first);
  segment_direction(points[n - 2], points[n - 1], &last);
  *begin = fmax(*begin, -first);
  *end = fmax(*end, -last);
  return n > 2 || first + *begin + *end > 0;
}

/* Add the outline of a path of one point, as if the path were parallel to x. */
static void put_dot(outline *out, vector at, double half, int ends,
                    double begin, double end) {
  if (ends == 1) {
    for (int i = 0; i < 2 * ARC; i++)
      outline_put(out, at.x + half * cos(G_PI * i / ARC),
                  at.y + half * sin(G_PI * i / ARC));
    return;
  }
  if (ends == 0) return;
  if (ends == 2) begin = end = half;
  if (begin + end <= 0) return;
  vector d = {1, 0};
  put_beside(out, at, d, -begin, half);
  put_beside(out, at, d, end, half);
  put_beside(out, at, d, end, -half);
  put_beside(out, at, d, -begin, -half);
}

int eda_path_outline(const eda_point *points, size_t n, int32_t width, int ends,
                     int32_t begin, int32_t end, eda_point **outline_points,
                     size_t *n_outline, opc_error *error) {
  *outline_points = NULL;
  *n_outline = 0;
  if (n == 0 || width < 0 ||
      !(ends == 0 || ends == 1 || ends == 2 || ends == 4))
    return opc_fail(error, OPC_INVALID, NULL,
                    "a path of %zu points, width %d and ends %d is not "
                    "possible",
                    n, width, ends);
  if (width == 0) return OPC_OK;
  vector *path = g_new(vector, n);
  outline out = {.points = g_new(eda_point, 6 * n + 4 * (size_t)ARC)};
  size_t m = points_clean(points, n, path);
  double half = width / 2.0, first = begin, last = end;
  if (m == 1) {
    put_dot(&out, path[0], half, ends, first, last);
  } else if (path_reach(path, m, half, ends, &first, &last)) {
    put_outline_pass(
        &out, &(outline_pass){path, m, half, first, last, ends == 1, false});
    points_reverse(path, m);
    put_outline_pass(
        &out, &(outline_pass){path, m, half, last, first, ends == 1, true});
  }
  free(path);
  if (out.outside) {
    free(out.points);
    return opc_fail(error, OPC_INVALID, NULL,
                    "the outline of a path at (%d, %d) leaves the range of "
                    "coordinates",
                    points[0].x, points[0].y);
  }
  if (out.n == 0) {
    free(out.points);
    return OPC_OK;
  }
  *outline_points = out.points;
  *n_outline = out.n;
  return OPC_OK;
}
