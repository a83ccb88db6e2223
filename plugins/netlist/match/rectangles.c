/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygons as rectangles, and rectangles by place. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "match.h"

static int put(job *j, rectangles *out, opc_box b, uint32_t group) {
  if (b.x0 >= b.x1 || b.y0 >= b.y1) return OPC_OK;
  if (!pool_grow(&j->pool, &out->all, &out->room, out->count + 1,
                 sizeof *out->all))
    return match_no_memory(j);
  out->all[out->count++] = (rectangle){b, group};
  return OPC_OK;
}

/* ---- cutting ---- */

/* A vertical edge: +1 upwards, -1 downwards. */
typedef struct edge {
  int32_t x, y0, y1;
  int winding;
} edge;

/* A rectangle that is still growing upwards. */
typedef struct strip {
  int32_t x0, x1, y0;
} strip;

static int by_bottom(const void *a, const void *b) {
  const edge *p = a, *q = b;
  if (p->y0 != q->y0) return p->y0 < q->y0 ? -1 : 1;
  return (p->x > q->x) - (p->x < q->x);
}

static int by_number(const void *a, const void *b) {
  int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;
  return (p > q) - (p < q);
}

typedef struct cutter {
  edge *edge;     /* by bottom */
  int32_t *level; /* all ordinates, increasing */
  size_t edges, levels;
  edge *active; /* those that cross the slab, by x */
  size_t n_active;
  strip *open, *next; /* the slab below, this one */
  size_t n_open, n_next;
} cutter;

static size_t collect(cutter *c, const opc_point *p, size_t n,
                      size_t *slanted) {
  for (size_t i = 0; i < n; i++) {
    opc_point a = p[i], b = p[i + 1 < n ? i + 1 : 0];
    c->level[i] = a.y;
    if (a.x != b.x && a.y != b.y) {
      *slanted = i;
      return 0;
    }
    if (a.y == b.y) continue;
    int up = b.y > a.y;
    c->edge[c->edges++] =
        (edge){a.x, up ? a.y : b.y, up ? b.y : a.y, up ? 1 : -1};
  }
  qsort(c->edge, c->edges, sizeof *c->edge, by_bottom);
  qsort(c->level, n, sizeof *c->level, by_number);
  for (size_t i = 0; i < n; i++)
    if (!i || c->level[i] != c->level[c->levels - 1])
      c->level[c->levels++] = c->level[i];
  return 1;
}

/* Drop what ends at y, put in what begins there, keep the order by x. */
static void step(cutter *c, int32_t y, size_t *entered) {
  size_t kept = 0;
  for (size_t i = 0; i < c->n_active; i++)
    if (c->active[i].y1 > y) c->active[kept++] = c->active[i];
  c->n_active = kept;
  for (; *entered < c->edges && c->edge[*entered].y0 == y; ++*entered) {
    size_t at = c->n_active++;
    while (at && c->active[at - 1].x > c->edge[*entered].x) {
      c->active[at] = c->active[at - 1];
      at--;
    }
    c->active[at] = c->edge[*entered];
  }
}

/* The strips of the slab above y; those that go on keep their bottom, others
   of the slab below are done. */
static int slab(job *j, cutter *c, int32_t y, uint32_t group, rectangles *out) {
  int winding = 0;
  c->n_next = 0;
  for (size_t i = 0; i < c->n_active; i++) {
    int before = winding;
    winding += c->active[i].winding;
    if (!before && winding)
      c->next[c->n_next++] = (strip){c->active[i].x, 0, y};
    else if (before && !winding)
      c->next[c->n_next - 1].x1 = c->active[i].x;
  }
  size_t k = 0;
  for (size_t i = 0; i < c->n_open; i++) {
    const strip *o = &c->open[i];
    while (k < c->n_next && c->next[k].x0 < o->x0) k++;
    if (k < c->n_next && c->next[k].x0 == o->x0 && c->next[k].x1 == o->x1) {
      c->next[k].y0 = o->y0;
      continue;
    }
    if (put(j, out, (opc_box){o->x0, o->y0, o->x1, y}, group))
      return j->error->code;
  }
  strip *swap = c->open;
  c->open = c->next;
  c->next = swap;
  c->n_open = c->n_next;
  return OPC_OK;
}

static int is_box(const opc_point *p, size_t n, opc_box *b) {
  if (n != 4) return 0;
  int first = p[0].x == p[1].x;
  if (first ? p[1].y != p[2].y || p[2].x != p[3].x || p[3].y != p[0].y
            : p[0].y != p[1].y || p[1].x != p[2].x || p[2].y != p[3].y ||
                  p[3].x != p[0].x)
    return 0;
  *b = (opc_box){
      p[0].x < p[2].x ? p[0].x : p[2].x, p[0].y < p[2].y ? p[0].y : p[2].y,
      p[0].x > p[2].x ? p[0].x : p[2].x, p[0].y > p[2].y ? p[0].y : p[2].y};
  return 1;
}

int match_cut(job *j, const opc_point *points, size_t n, uint32_t group,
              rectangles *out, size_t *slanted) {
  opc_box box;
  if (is_box(points, n, &box)) return put(j, out, box, group);
  cutter c = {.edge = calloc(n, sizeof(edge)),
              .level = calloc(n, sizeof(int32_t)),
              .active = calloc(n + 1, sizeof(edge)),
              .open = calloc(n + 1, sizeof(strip)),
              .next = calloc(n + 1, sizeof(strip))};
  int code = OPC_OK;
  size_t entered = 0;
  if (!c.edge || !c.level || !c.active || !c.open || !c.next)
    code = match_no_memory(j);
  else if (!collect(&c, points, n, slanted))
    code = -1;
  for (size_t k = 0; !code && k < c.levels; k++) {
    step(&c, c.level[k], &entered);
    code = slab(j, &c, c.level[k], group, out);
  }
  free(c.edge);
  free(c.level);
  free(c.active);
  free(c.open);
  free(c.next);
  return code;
}

int match_subtract(job *j, const rectangle *from, const opc_box *boxes,
                   size_t n, rectangles *out) {
  opc_box left = from->box;
  for (size_t i = 0; i < n; i++) {
    int64_t dx, dy;
    match_overlap(left, boxes[i], &dx, &dy);
    if (dx <= 0 || dy <= 0) continue;
    /* What is beside this box goes through the others; no piece is cut twice
       by the same one. */
    opc_box b = {left.x0 > boxes[i].x0 ? left.x0 : boxes[i].x0,
                 left.y0 > boxes[i].y0 ? left.y0 : boxes[i].y0,
                 left.x1 < boxes[i].x1 ? left.x1 : boxes[i].x1,
                 left.y1 < boxes[i].y1 ? left.y1 : boxes[i].y1};
    opc_box pieces[4] = {{left.x0, left.y0, b.x0, left.y1},
                         {b.x1, left.y0, left.x1, left.y1},
                         {b.x0, left.y0, b.x1, b.y0},
                         {b.x0, b.y1, b.x1, left.y1}};
    for (int k = 0; k < 4; k++) {
      rectangle piece = {pieces[k], from->group};
      if (piece.box.x0 >= piece.box.x1 || piece.box.y0 >= piece.box.y1)
        continue;
      if (match_subtract(j, &piece, boxes + i + 1, n - i - 1, out))
        return j->error->code;
    }
    return OPC_OK;
  }
  return put(j, out, left, from->group);
}

/* ---- by place ---- */

static int32_t bin(double v, double from, double side, int32_t n) {
  double k = floor((v - from) / side);
  return k < 0 ? 0 : k >= n ? n - 1 : (int32_t)k;
}

typedef struct span {
  int32_t i0, i1, j0, j1;
} span;

static span bins_of(const bins *b, opc_box box) {
  return (span){
      bin(box.x0, b->x0, b->side, b->nx), bin(box.x1, b->x0, b->side, b->nx),
      bin(box.y0, b->y0, b->side, b->ny), bin(box.y1, b->y0, b->side, b->ny)};
}

/* Bins of about one rectangle each; wider ones where rectangles are so long
   that they would be in too many. */
static uint64_t lay_out(bins *b, double width, double height) {
  size_t n = b->of->count;
  for (b->side = fmax(1, sqrt(width * height / (double)n));; b->side *= 2) {
    double nx = width / b->side + 1, ny = height / b->side + 1;
    if (nx * ny > 4 * (double)n + 64) continue;
    b->nx = (int32_t)nx;
    b->ny = (int32_t)ny;
    uint64_t entries = 0;
    for (size_t i = 0; i < n; i++) {
      span s = bins_of(b, b->of->all[i].box);
      entries += (uint64_t)(s.i1 - s.i0 + 1) * (uint64_t)(s.j1 - s.j0 + 1);
    }
    if (entries <= 32 * (uint64_t)n + 64 || (b->nx == 1 && b->ny == 1))
      return entries;
  }
}

int match_bins(job *j, const rectangles *of, bins *b) {
  *b = (bins){.of = of};
  if (!of->count) return OPC_OK;
  opc_box all = of->all[0].box;
  for (size_t i = 1; i < of->count; i++) {
    opc_box r = of->all[i].box;
    if (r.x0 < all.x0) all.x0 = r.x0;
    if (r.y0 < all.y0) all.y0 = r.y0;
    if (r.x1 > all.x1) all.x1 = r.x1;
    if (r.y1 > all.y1) all.y1 = r.y1;
  }
  b->x0 = all.x0;
  b->y0 = all.y0;
  uint64_t entries =
      lay_out(b, (double)all.x1 - all.x0, (double)all.y1 - all.y0);
  size_t n = (size_t)b->nx * (size_t)b->ny;
  b->start = pool_alloc(&j->pool, n + 2, sizeof *b->start);
  b->item = pool_alloc(&j->pool, entries, sizeof *b->item);
  if (!b->start || !b->item || entries > UINT32_MAX) return match_no_memory(j);
  for (int fill = 0; fill < 2; fill++) {
    for (size_t i = 0; i < of->count; i++) {
      span s = bins_of(b, of->all[i].box);
      for (int32_t y = s.j0; y <= s.j1; y++)
        for (int32_t x = s.i0; x <= s.i1; x++) {
          size_t k = (size_t)y * (size_t)b->nx + (size_t)x;
          if (fill)
            b->item[b->start[k + 1]++] = (uint32_t)i;
          else
            b->start[k + 2]++;
        }
    }
    /* Bin k begins at start[k + 1] while it is filled, then at start[k]. */
    for (size_t k = 0; !fill && k < n; k++) b->start[k + 2] += b->start[k + 1];
  }
  return OPC_OK;
}

void match_query(const bins *b, opc_box box,
                 void (*found)(void *data, uint32_t i), void *data) {
  if (!b->nx) return;
  span s = bins_of(b, box);
  for (int32_t y = s.j0; y <= s.j1; y++)
    for (int32_t x = s.i0; x <= s.i1; x++) {
      size_t k = (size_t)y * (size_t)b->nx + (size_t)x;
      for (uint32_t i = b->start[k]; i < b->start[k + 1]; i++) {
        int64_t dx, dy;
        match_overlap(box, b->of->all[b->item[i]].box, &dx, &dy);
        if (dx >= 0 && dy >= 0) found(data, b->item[i]);
      }
    }
}
