/* SPDX-License-Identifier: BSD-3-Clause */
/* Sorted edges of poly and active, to find the edge that contains a side of a
   gate. */
#include <stdlib.h>

#include "segment/segment.h"

static int by_place(const void *a, const void *b) {
  const edge *p = a, *q = b;
  if (p->across != q->across) return p->across < q->across ? -1 : 1;
  if (p->side != q->side) return p->side < q->side ? -1 : 1;
  if (p->at != q->at) return p->at < q->at ? -1 : 1;
  return (p->low > q->low) - (p->low < q->low);
}

static edge make_edge(eda_point a, eda_point b, uint32_t polygon,
                      uint32_t point) {
  edge e = {.polygon = polygon, .point = point};
  int32_t from, to;
  if (a.x == b.x) { /* edges run downwards on the left side of the interior, and
                       upwards on the right side */
    e.across = EDA_X;
    e.side = a.y > b.y ? LOW : HIGH;
    e.at = a.x;
    from = a.y;
    to = b.y;
  } else {
    e.across = EDA_Y;
    e.side = a.x < b.x ? LOW : HIGH;
    e.at = a.y;
    from = a.x;
    to = b.x;
  }
  e.low = from < to ? from : to;
  e.high = from < to ? to : from;
  return e;
}

static void index_layer(segment *s, int layer) {
  const eda_shapes *drawn = &s->gates->drawn[layer];
  edge_index *x = &s->index[layer];
  x->count = drawn->count ? drawn->start[drawn->count] : 0;
  x->edges = eda_alloc(x->count, sizeof *x->edges);
  for (size_t p = 0; p < drawn->count; p++)
    for (uint32_t i = drawn->start[p]; i < drawn->start[p + 1]; i++) {
      uint32_t next = i + 1 < drawn->start[p + 1] ? i + 1 : drawn->start[p];
      x->edges[i] =
          make_edge(drawn->points[i], drawn->points[next], (uint32_t)p, i);
    }
  qsort(x->edges, x->count, sizeof *x->edges, by_place);
  size_t at = 0;
  for (size_t k = 0; k < 4; k++) {
    x->first[k] = at;
    while (at < x->count && 2u * x->edges[at].across + x->edges[at].side == k)
      at++;
  }
  x->first[4] = at;
}

void segment_index(segment *s) {
  index_layer(s, EDA_POLY);
  index_layer(s, EDA_ACTIVE);
}

const edge *segment_edge(const edge_index *index, int d, int side, int32_t at,
                         int32_t low, int32_t high) {
  size_t from = index->first[2 * d + side], to = index->first[2 * d + side + 1];
  /* Find the last edge that starts at or before `low`. */
  while (from < to) {
    size_t middle = from + (to - from) / 2;
    const edge *e = &index->edges[middle];
    if (e->at < at || (e->at == at && e->low <= low))
      from = middle + 1;
    else
      to = middle;
  }
  if (from == index->first[2 * d + side]) return NULL;
  const edge *e = &index->edges[from - 1];
  return e->at == at && e->high >= high ? e : NULL;
}
