/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/correct/loop.h"

#include <string.h>

int opc_edges_room(const opc_host *host, const opc_edges *edges,
                   opc_shapes *out) {
  size_t fragments = edges->polygons ? edges->start[edges->polygons] : 0;
  *out = (opc_shapes){.count = edges->polygons};
  out->start = host->alloc(host, edges->polygons + 1, sizeof *out->start);
  out->points = host->alloc(host, 2 * fragments, sizeof *out->points);
  return out->start && out->points;
}

/* How far a fragment moves outwards. The HIGH side takes the odd step. */
static int32_t move_of(const opc_fragment *f, const opc_biases *b) {
  int32_t low;
  switch (f->role) {
    case OPC_L_LOW:
    case OPC_L_HIGH:
      low = b->l[f->gate] >> 1;
      return f->role == OPC_L_LOW ? low : b->l[f->gate] - low;
    case OPC_W_LOW:
    case OPC_W_HIGH:
      low = b->w[f->gate] >> 1;
      return f->role == OPC_W_LOW ? low : b->w[f->gate] - low;
    case OPC_END_LOW: return b->end[2 * f->gate];
    case OPC_END_HIGH: return b->end[2 * f->gate + 1];
    default: return 0;
  }
}

/* A fragment after its move: the line it lies on. */
typedef struct moved {
  int horizontal;
  int32_t line;   /* its y if horizontal, else its x */
} moved;

static moved move(const opc_fragment *f, const opc_fragment *next,
                  const opc_biases *b) {
  int32_t by = move_of(f, b);
  if (f->from.y == next->from.y)   /* outwards is down when going right */
    return (moved){1, f->from.y + (next->from.x > f->from.x ? -by : by)};
  return (moved){0, f->from.x + (next->from.y > f->from.y ? by : -by)};
}

void opc_edges_move(const opc_gates *gates, int layer,
                    const opc_biases *biases, opc_shapes *out) {
  const opc_edges *e = &gates->edges[layer];
  uint32_t n = 0;
  for (size_t p = 0; p < e->polygons; p++) {
    const opc_fragment *f = e->fragments + e->start[p];
    uint32_t count = e->start[p + 1] - e->start[p];
    out->start[p] = n;
    if (!count) continue;
    moved before = move(&f[count - 1], &f[0], biases);
    for (uint32_t i = 0; i < count; i++) {
      moved m = move(&f[i], &f[(i + 1) % count], biases);
      if (m.horizontal != before.horizontal) {
        out->points[n++] = m.horizontal ? (opc_point){before.line, m.line}
                                        : (opc_point){m.line, before.line};
      } else if (m.line != before.line) {   /* a jog */
        int32_t at = m.horizontal ? f[i].from.x : f[i].from.y;
        for (int k = 0; k < 2; k++) {
          int32_t line = k ? m.line : before.line;
          out->points[n++] =
              m.horizontal ? (opc_point){at, line} : (opc_point){line, at};
        }
      }
      before = m;
    }
  }
  out->start[e->polygons] = n;
  out->count = e->polygons;
  out->hole = gates->drawn[layer].hole;
}
