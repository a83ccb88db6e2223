/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>

#include "window.h"

enum { BLOCK = 64 };

/* How far beyond the drawn gate its print is looked for, and in which steps:
   no line is stepped over. nm. */
static const double reach = 300, stride = 5;

typedef struct work {
  const opc_host *host;
  const opc_gates *gates;
  const opc_field *print, *image;
  window_cut *cuts;
} work;

/* A line through the middle of a gate. */
typedef struct line {
  const work *w;
  double x, y; /* the middle */
  int axis;
} line;

static double level(const line *l, double place) {
  double x = l->x + (l->axis == OPC_X ? place : 0), v;
  double y = l->y + (l->axis == OPC_X ? 0 : place);
  l->w->host->imaging->sample(l->w->print, &x, &y, 1, &v);
  return v;
}

/* Where the print ends, from the middle in the direction of `sign`; 0 if it
   does not before `limit`. */
static int find_edge(const line *l, double sign, double limit, double *place) {
  double in = 0, out = 0;
  while (out < limit) {
    out = fmin(in + stride, limit);
    if (!(level(l, sign * out) > 0)) break;
    in = out;
  }
  if (in >= limit) return 0;
  for (int i = 0; i < 40; i++) {
    double middle = (in + out) / 2;
    if (level(l, sign * middle) > 0)
      in = middle;
    else
      out = middle;
  }
  *place = sign * (in + out) / 2;
  return 1;
}

static double log_slope(const line *l, double place) {
  double x = l->x + (l->axis == OPC_X ? place : 0), value, dx, dy;
  double y = l->y + (l->axis == OPC_X ? 0 : place);
  l->w->host->imaging->gradient(l->w->image, &x, &y, 1, &value, &dx, &dy);
  return fabs(l->axis == OPC_X ? dx : dy) / value;
}

static window_cut cut(const work *w, size_t i) {
  const opc_gates *g = w->gates;
  opc_box b = g->box[i];
  line l = {.w = w,
            .x = ((double)b.x0 + b.x1) / 2 * g->grid,
            .y = ((double)b.y0 + b.y1) / 2 * g->grid,
            .axis = g->axis[i]};
  window_cut c = {NAN, NAN, NAN};
  double low, high, half = g->length[i] / 2;
  if (!(level(&l, 0) > 0) ||
      !find_edge(&l, -1, half + fmin(reach, g->room[2 * i] / 2), &low) ||
      !find_edge(&l, 1, half + fmin(reach, g->room[2 * i + 1] / 2), &high))
    return c;
  c.length = high - low;
  c.low = log_slope(&l, low);
  c.high = log_slope(&l, high);
  return c;
}

static void cut_block(void *data, size_t block) {
  const work *w = data;
  size_t last = (block + 1) * BLOCK;
  if (last > w->gates->count) last = w->gates->count;
  for (size_t i = block * BLOCK; i < last; i++) w->cuts[i] = cut(w, i);
}

void window_cuts(const opc_host *host, const opc_gates *gates,
                 const opc_field *print, const opc_field *image,
                 window_cut *cuts) {
  work w = {host, gates, print, image, cuts};
  host->parallel(host, (gates->count + BLOCK - 1) / BLOCK, cut_block, &w);
}
