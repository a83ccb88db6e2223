/* SPDX-License-Identifier: BSD-3-Clause */
/* Reconstruction of the outlines and holes of merged shapes from their vertical
   edges. On each horizontal line, the ends of vertical edges are paired from
   left to right: a horizontal edge connects both ends of a pair. The pairs
   therefore determine the successor of each vertical edge. Takes O(n). */
#include <glib.h>
#include <string.h>

#include "geometry/scan.h"

typedef struct trace {
  const eda_wall *walls;
  size_t n;
  uint32_t *next;      /* number of the wall that follows each wall */
  eda_event *contours; /* lowest, then leftmost point of each contour (major: y,
                          minor: x); payload: number of the wall there */
  size_t n_contours;
} trace;

/* Return the y at which a wall starts. Contours have the interior on their
   left, so a wall with the interior to the right runs downwards. */
static int32_t tail_y(const eda_wall *w) { return w->left ? w->y1 : w->y0; }
static int32_t head_y(const eda_wall *w) { return w->left ? w->y0 : w->y1; }

static void link_pair(trace *t, uint32_t p, uint32_t q) {
  uint32_t a = p >> 1, b = q >> 1;
  int p_is_head = (int)(p & 1) != t->walls[a].left;
  if (p_is_head)
    t->next[a] = b;
  else
    t->next[b] = a;
}

/* If two walls meet end to end at one point, two shapes or holes touch there in
   a corner. Order the ends of both walls so that each horizontal edge is
   connected to the wall that bounds the same interior. Touching shapes then
   stay separate. */
static void order_corner(const trace *t, eda_event *lower) {
  if (lower[0].major != lower[1].major || lower[0].minor != lower[1].minor)
    return;
  if (!t->walls[lower->payload >> 1].left) return;
  eda_event swap = lower[0];
  lower[0] = lower[1];
  lower[1] = swap;
}

static void link_walls(trace *t) {
  size_t ends = 2 * t->n;
  eda_event *events = g_new(eda_event, ends + 1);
  t->next = g_new(uint32_t, t->n + 1);
  for (size_t i = 0; i < t->n; i++) {
    const eda_wall *w = &t->walls[i];
    uint32_t x = eda_bias(w->x), payload = (uint32_t)i << 1;
    events[2 * i] = (eda_event){eda_bias(w->y0), x, payload};
    events[2 * i + 1] = (eda_event){eda_bias(w->y1), x, payload | 1};
  }
  eda_sort(events, ends, EDA_MAJOR);
  /* Only the second end of a pair and the first end of the next pair can be at
     the same point. */
  for (size_t i = 1; i + 1 < ends; i += 2) order_corner(t, &events[i]);
  for (size_t i = 0; i + 1 < ends; i += 2)
    link_pair(t, events[i].payload, events[i + 1].payload);
  g_free(events);
}

/* Find the lowest, then leftmost point of each contour. Sort the contours by
   this point. */
static void find_contours(trace *t) {
  uint8_t *seen = g_new0(uint8_t, t->n + 1);
  /* A contour has at least two walls. */
  t->contours = g_new(eda_event, t->n / 2 + 1);
  for (size_t first = 0; first < t->n; first++) {
    if (seen[first]) continue;
    uint32_t best = (uint32_t)first;
    for (uint32_t i = best; !seen[i]; i = t->next[i]) {
      const eda_wall *w = &t->walls[i], *b = &t->walls[best];
      seen[i] = 1;
      if (w->y0 < b->y0 || (w->y0 == b->y0 && w->x < b->x)) best = i;
    }
    const eda_wall *b = &t->walls[best];
    t->contours[t->n_contours++] =
        (eda_event){eda_bias(b->y0), eda_bias(b->x), best};
  }
  eda_sort(t->contours, t->n_contours, EDA_MINOR);
  eda_sort(t->contours, t->n_contours, EDA_MAJOR);
  g_free(seen);
}

static void write_contour(const trace *t, size_t c, eda_shapes *out) {
  uint32_t first = t->contours[c].payload, i = first;
  int hole = !t->walls[first].left;
  uint32_t n = out->start[c];
  do {
    const eda_wall *w = &t->walls[i];
    out->points[n++] = (eda_point){w->x, tail_y(w)};
    out->points[n++] = (eda_point){w->x, head_y(w)};
    i = t->next[i];
  } while (i != first);
  if (!hole) {
    /* Start an outline with its lowest point, the end of the first wall. */
    eda_point *p = &out->points[out->start[c]];
    size_t rest = n - out->start[c] - 1;
    eda_point tail = p[0];
    memmove(p, p + 1, rest * sizeof *p);
    p[rest] = tail;
  }
  out->hole[c] = (uint8_t)hole;
  out->start[c + 1] = n;
}

void eda_trace(const eda_wall *walls, size_t n, eda_shapes *out) {
  *out = (eda_shapes){0};
  if (n == 0) return;
  trace t = {.walls = walls, .n = n};
  link_walls(&t);
  find_contours(&t);
  out->start = g_new0(uint32_t, t.n_contours + 1);
  out->points = g_new(eda_point, 2 * n);
  out->hole = g_new(uint8_t, t.n_contours);
  out->count = t.n_contours;
  for (size_t c = 0; c < t.n_contours; c++) write_contour(&t, c, out);
  g_free(t.next);
  g_free(t.contours);
}
