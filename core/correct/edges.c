/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/correct/loop.h"

#include <string.h>

/* ---- room ---- */

static int make_room(const opc_host *host, size_t polygons, size_t pieces,
                     opc_pieces *out) {
  out->polygons = polygons;
  out->room = pieces;
  out->start = host->alloc(host, polygons + 1, sizeof *out->start);
  out->from = host->alloc(host, pieces, sizeof *out->from);
  out->by = host->alloc(host, pieces, sizeof *out->by);
  return out->start && out->from && out->by;
}

int opc_pieces_of_edges(const opc_host *host, const opc_edges *edges,
                        opc_pieces *out) {
  size_t n = edges->polygons ? edges->start[edges->polygons] : 0, jogs = 0;
  for (size_t i = 0; i < n; i++)
    jogs += edges->fragments[i].role == OPC_L_LOW ||
            edges->fragments[i].role == OPC_L_HIGH;
  return make_room(host, edges->polygons, n + jogs, out);
}

int opc_pieces_of_cuts(const opc_host *host, const opc_cuts *cuts,
                       opc_pieces *out) {
  size_t n = cuts->start[cuts->polygons];
  if (!make_room(host, cuts->polygons, n, out)) return 0;
  memcpy(out->start, cuts->start, (cuts->polygons + 1) * sizeof *out->start);
  memcpy(out->from, cuts->from, n * sizeof *out->from);
  return 1;
}

void opc_pieces_clear(const opc_host *host, opc_pieces *pieces) {
  host->free(host, pieces->start);
  host->free(host, pieces->from);
  host->free(host, pieces->by);
  *pieces = (opc_pieces){0};
}

int opc_pieces_shapes(const opc_host *host, const opc_pieces *pieces,
                      opc_shapes *out) {
  *out = (opc_shapes){.count = pieces->polygons};
  out->start = host->alloc(host, pieces->polygons + 1, sizeof *out->start);
  out->points = host->alloc(host, 2 * pieces->room, sizeof *out->points);
  return out->start && out->points;
}

int opc_pieces_boxes(const opc_host *host, const opc_box *box, size_t n,
                     const opc_box *more, size_t m, opc_shapes *out) {
  size_t all = n + m;
  *out = (opc_shapes){.count = all};
  out->start = host->alloc(host, all + 1, sizeof *out->start);
  out->points = host->alloc(host, 4 * all, sizeof *out->points);
  for (size_t i = 0; i < all && out->start && out->points; i++) {
    opc_box b = i < n ? box[i] : more[i - n];
    const opc_point corners[] = {
        {b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
    memcpy(out->points + 4 * i, corners, sizeof corners);
    out->start[i + 1] = (uint32_t)(4 * i + 4);
  }
  return out->start && out->points;
}

/* ---- from the biases of gates to pieces ---- */

/* What a gate's width is measured along. */
static int32_t along_w(const opc_gates *g, int32_t gate, opc_point p) {
  return g->axis[gate] == OPC_X ? p.y : p.x;
}

/* How far a fragment moves outwards. The HIGH side takes the odd step. */
static int32_t move_of(const opc_fragment *f, const opc_biases *b) {
  int32_t all, low;
  switch (f->role) {
    case OPC_L_LOW:
    case OPC_L_HIGH:
      all = b->l[f->gate];
      low = all >> 1;
      return f->role == OPC_L_LOW ? low : all - low;
    case OPC_W_LOW:
    case OPC_W_HIGH:
      all = b->w[f->gate];
      low = all >> 1;
      return f->role == OPC_W_LOW ? low : all - low;
    case OPC_END_LOW: return b->end[2 * f->gate];
    case OPC_END_HIGH: return b->end[2 * f->gate + 1];
    default: return 0;
  }
}

static void put(opc_pieces *out, uint32_t *n, opc_point from, int32_t by) {
  out->from[*n] = from;
  out->by[(*n)++] = by;
}

/* The side that a step more of length would move. */
static int takes_jog(const opc_fragment *f, const opc_biases *b) {
  int32_t odd = b->l[f->gate] & 1;
  return f->role == (odd ? OPC_L_LOW : OPC_L_HIGH) && b->jog[f->gate] > 0;
}

/* A side along L of which so much, from its LOW end along W, lies one step
   further out. */
static void put_jog(const opc_gates *g, const opc_fragment *f, opc_point next,
                    int32_t jog_length, int32_t by, opc_pieces *out,
                    uint32_t *n) {
  int32_t from = along_w(g, f->gate, f->from), to = along_w(g, f->gate, next);
  int rising = to > from;
  int32_t high = rising ? to : from, at = (rising ? from : to) + jog_length;
  opc_point jog = g->axis[f->gate] == OPC_X ? (opc_point){f->from.x, at}
                                            : (opc_point){at, f->from.y};
  if (at >= high) {
    put(out, n, f->from, by + 1);
  } else {
    put(out, n, f->from, by + rising);
    put(out, n, jog, by + !rising);
  }
}

void opc_pieces_follow(const opc_gates *g, int layer, const opc_biases *b,
                       opc_pieces *out) {
  const opc_edges *e = &g->edges[layer];
  uint32_t n = 0;
  for (size_t p = 0; p < e->polygons; p++) {
    const opc_fragment *f = e->fragments + e->start[p];
    uint32_t count = e->start[p + 1] - e->start[p];
    out->start[p] = n;
    for (uint32_t i = 0; i < count; i++) {
      int32_t by = move_of(&f[i], b);
      if (f[i].role != OPC_FIXED && takes_jog(&f[i], b))
        put_jog(g, &f[i], f[(i + 1) % count].from, b->jog[f[i].gate], by, out,
                &n);
      else
        put(out, &n, f[i].from, by);
    }
  }
  out->start[e->polygons] = n;
}

/* ---- from pieces to polygons ---- */

/* A piece after its move: the line it lies on. */
typedef struct moved {
  int horizontal;
  int32_t line;   /* its y if horizontal, else its x */
} moved;

static moved move(opc_point from, opc_point next, int32_t by) {
  if (from.y == next.y)   /* outwards is down when going right */
    return (moved){1, from.y + (next.x > from.x ? -by : by)};
  return (moved){0, from.x + (next.y > from.y ? by : -by)};
}

/* Whether b is no corner between a and c: repeated, or on their line. */
static int is_idle(opc_point a, opc_point b, opc_point c) {
  return (a.x == b.x && b.x == c.x) || (a.y == b.y && b.y == c.y);
}

/* Append a corner to a polygon of n. */
static uint32_t corner(opc_point *polygon, uint32_t n, opc_point p) {
  while (n > 1 && is_idle(polygon[n - 2], polygon[n - 1], p)) n--;
  if (n == 1 && polygon[0].x == p.x && polygon[0].y == p.y) n = 0;
  polygon[n] = p;
  return n + 1;
}

/* What is left of a polygon when its end is joined to its beginning. */
static uint32_t join(opc_point *polygon, uint32_t n) {
  uint32_t first = 0;
  for (int found = 1; found && n - first > 2;) {
    found = 1;
    if (is_idle(polygon[n - 2], polygon[n - 1], polygon[first])) n--;
    else if (is_idle(polygon[n - 1], polygon[first], polygon[first + 1])) first++;
    else found = 0;
  }
  if (n - first < 4) return 0;
  for (uint32_t i = first; i < n; i++) polygon[i - first] = polygon[i];
  return n - first;
}

static uint32_t build(const opc_point *from, const int32_t *by, uint32_t count,
                      opc_point *polygon) {
  uint32_t n = 0;
  moved before = move(from[count - 1], from[0], by[count - 1]);
  for (uint32_t i = 0; i < count; i++) {
    moved m = move(from[i], from[(i + 1) % count], by[i]);
    if (m.horizontal != before.horizontal) {
      n = corner(polygon, n, m.horizontal ? (opc_point){before.line, m.line}
                                          : (opc_point){m.line, before.line});
    } else if (m.line != before.line) {   /* a jog */
      int32_t at = m.horizontal ? from[i].x : from[i].y;
      for (int k = 0; k < 2; k++) {
        int32_t line = k ? m.line : before.line;
        n = corner(polygon, n, m.horizontal ? (opc_point){at, line}
                                            : (opc_point){line, at});
      }
    }
    before = m;
  }
  return join(polygon, n);
}

void opc_pieces_build(const opc_pieces *pieces, opc_shapes *out) {
  uint32_t n = 0;
  for (size_t p = 0; p < pieces->polygons; p++) {
    uint32_t first = pieces->start[p], count = pieces->start[p + 1] - first;
    out->start[p] = n;
    if (count)
      n += build(pieces->from + first, pieces->by + first, count,
                 out->points + n);
  }
  out->start[pieces->polygons] = n;
  out->count = pieces->polygons;
}
