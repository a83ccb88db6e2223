/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the effect of a jog. The optics smooth moves of an edge along W,
   so the effect of a move of a part of an edge is the integral of a smoothed
   window. */
#include "jog.h"

#include <glib.h>
#include <math.h>

#include "tuning.h"

/* ---- the normal distribution ---- */

/* Values at z = k / NODES_PER_UNIT - FAR: the density, its integral, and the
   integral of that. Cubic interpolation by values and slopes is accurate to
   1e-8 in the last one. Beyond FAR, both are constant to 1e-8. */
enum { FAR = 6, NODES_PER_UNIT = 24, NODES = 2 * FAR * NODES_PER_UNIT + 1 };
typedef struct node {
  double density, distribution, ramp;
} node;

static const node *normal_table(void) {
  static node table[NODES];
  static gsize ready;
  if (g_once_init_enter(&ready)) {
    for (int k = 0; k < NODES; k++) {
      double z = (double)k / NODES_PER_UNIT - FAR;
      node *n = &table[k];
      n->density = exp(-z * z / 2) / sqrt(2 * M_PI);
      n->distribution = 0.5 * erfc(-z * M_SQRT1_2);
      n->ramp = z * n->distribution + n->density;
    }
    g_once_init_leave(&ready, 1);
  }
  return table;
}

/* Return the cubic with the values a, b and the slopes da, db at the ends of an
   interval of 1 / NODES_PER_UNIT, at its part t. */
static double cubic(double a, double da, double b, double db, double t) {
  const double step = 1.0 / NODES_PER_UNIT, u = 1 - t;
  return u * u * (a * (1 + 2 * t) + t * step * da) +
         t * t * (b * (3 - 2 * t) - u * step * db);
}

double normal_distribution(double z) {
  if (!(fabs(z) < FAR)) return z > 0;
  double at = (z + FAR) * NODES_PER_UNIT, first = floor(at);
  const node *n = normal_table() + (int)first;
  return cubic(n->distribution, n->density, n[1].distribution, n[1].density,
               at - first);
}

/* Return the integral of normal_distribution from -infinity to z. */
static double normal_ramp(double z) {
  if (!(fabs(z) < FAR)) return z > 0 ? z : 0;
  double at = (z + FAR) * NODES_PER_UNIT, first = floor(at);
  const node *n = normal_table() + (int)first;
  return cubic(n->ramp, n->distribution, n[1].ramp, n[1].distribution,
               at - first);
}

/* ---- the effect of an edge ---- */

/* Return the distance beyond the end of the gate, grid steps, at which the
   effect of the edges has fallen to half. `extension`: length of the poly past
   the active, grid steps; `blur`: grid steps. */
static double extension_effect(double extension, double blur) {
  return extension < tuned.short_end * blur ? blur * tuned.past_end
                                            : -blur / tuned.before_end;
}

/* Return the effect on the gate of a grid step of the edge up to `at`. */
static double edge_weight(const sides *s, double at) {
  return s->blur * (normal_ramp((at - s->low) / s->blur) -
                    normal_ramp((at - s->high) / s->blur));
}

void sides_weigh(sides *s) {
  for (int side = 0; side < 2; side++) {
    s->before[side] = edge_weight(s, s->from[side]);
    s->all[side] = edge_weight(s, s->to[side]) - s->before[side];
  }
}

void sides_find(const eda_gates *g, sides *out) {
  const eda_edges *e = &g->edges[EDA_POLY];
  for (size_t i = 0; i < g->count; i++) {
    eda_box b = g->box[i];
    int32_t width = g->axis[i] == EDA_X ? b.y1 - b.y0 : b.x1 - b.x0;
    double steps = fmin(tuned.blur / g->grid, width);
    out[i].blur = tuned.blur / g->grid;
    out[i].low = -extension_effect(g->extension[2 * i] / g->grid, steps);
    out[i].high =
        width + extension_effect(g->extension[2 * i + 1] / g->grid, steps);
  }
  for (size_t p = 0; p < e->polygons; p++)
    for (uint32_t i = e->start[p]; i < e->start[p + 1]; i++) {
      const eda_fragment *f = &e->fragments[i];
      if (f->role != EDA_L_LOW && f->role != EDA_L_HIGH) continue;
      const eda_fragment *next =
          &e->fragments[i + 1 < e->start[p + 1] ? i + 1 : e->start[p]];
      int upright = g->axis[f->gate] == EDA_X, side = f->role == EDA_L_HIGH;
      eda_box box = g->box[f->gate];
      int32_t a = upright ? f->from.y - box.y0 : f->from.x - box.x0;
      int32_t b = upright ? next->from.y - box.y0 : next->from.x - box.x0;
      out[f->gate].from[side] = a < b ? a : b;
      out[f->gate].to[side] = a < b ? b : a;
    }
  for (size_t i = 0; i < g->count; i++) sides_weigh(&out[i]);
}

/* Return the effect of a jog relative to a step of the whole edge. */
static double edge_share(const sides *s, int side, int32_t jog) {
  if (jog <= 0 || !(s->all[side] > 0)) return 0;
  if (jog >= s->to[side] - s->from[side]) return 1;
  return (edge_weight(s, s->from[side] + jog) - s->before[side]) / s->all[side];
}

double length_share(const sides *s, double to) {
  double sum = 0;
  for (int side = 0; side < 2; side++) {
    double all = s->all[side], at = fmin(fmax(to, s->from[side]), s->to[side]);
    sum += all > 0 ? (edge_weight(s, at) - s->before[side]) / all / 2 : 0;
  }
  return sum;
}

int length_side(int32_t l) { return !(l & 1); }

double length_value(const sides *s, length x) {
  return x.l + edge_share(s, length_side(x.l), x.jog);
}

double length_jog(const sides *s, length x) {
  int side = length_side(x.l);
  int has = x.jog > 0 && x.jog < s->to[side] - s->from[side];
  return has ? s->from[side] + x.jog : NAN;
}

length length_nearest(const sides *s, double value, int32_t least) {
  length x = {(int32_t)floor(value), 0};
  int side = length_side(x.l);
  int32_t whole = s->to[side] - s->from[side];
  int32_t low = least < whole / 2 ? least : whole / 2, high = whole - low;
  double part = value - x.l;
  while (high - low > 1) {
    int32_t middle = low + (high - low) / 2;
    if (edge_share(s, side, middle) < part)
      low = middle;
    else
      high = middle;
  }
  double below = edge_share(s, side, low), above = edge_share(s, side, high);
  x.jog = part - below < above - part ? low : high;
  double off = fabs(edge_share(s, side, x.jog) - part);
  if (part <= off) return (length){x.l, 0};
  return 1 - part <= off ? (length){x.l + 1, 0} : x;
}
