/* SPDX-License-Identifier: BSD-3-Clause */
#include "sites.h"

#include <math.h>
#include <stdlib.h>

/* nm. Lines are looked at so often along them: necks are as long as the
   resolution of the optics, some 100 nm. Corners are rounded within `rounding`
   of them. Lines that are wider than `wide`, and gaps, do not close. Gates
   further away than `near_gate` have no part in what is wrong. */
static const double pitch = 60, rounding = 100, wide = 250, near_gate = 200;

/* Sites along lines; they stand further apart where there would be more. */
enum { MOST_SITES = 1 << 19 };

void sites_clear(sites *s) {
  free(s->at);
  *s = (sites){0};
}

static void add(sites *s, site one) {
  if (s->n == s->room) {
    size_t room = s->room ? 2 * s->room : 1024;
    site *more = realloc(s->at, room * sizeof *more);
    if (!more) {
      s->failed = 1;
      return;
    }
    s->at = more;
    s->room = room;
  }
  one.repair = -1;
  s->at[s->n++] = one;
}

/* ---- the nearest gate ---- */

typedef struct nearest {
  const bins *gates;
  opc_box box;
  double distance;
  int32_t gate;
} nearest;

static double apart(int32_t a0, int32_t a1, int32_t b0, int32_t b1) {
  return fmax(fmax((double)b0 - a1, (double)a0 - b1), 0);
}

static void try_gate(void *data, uint32_t i) {
  nearest *n = data;
  opc_box g = n->gates->box[i];
  double d = hypot(apart(g.x0, g.x1, n->box.x0, n->box.x1),
                   apart(g.y0, g.y1, n->box.y0, n->box.y1));
  /* Of equal ones the first, in whichever order they come. */
  if (d > n->distance || (d == n->distance && n->gate < (int32_t)i)) return;
  n->distance = d;
  n->gate = (int32_t)i;
}

static int32_t nearest_gate(const drawing *d, opc_box box, double grid) {
  int32_t reach = (int32_t)(near_gate / grid);
  nearest n = {&d->gates, box, reach, INT32_MAX};
  bins_visit(&d->gates,
             (opc_box){box.x0 - reach, box.y0 - reach, box.x1 + reach,
                       box.y1 + reach},
             try_gate, &n);
  return n.gate == INT32_MAX ? -1 : n.gate;
}

/* ---- contacts ---- */

enum { OUTSIDE, PARTLY, WITHIN };

typedef struct overlap {
  const bins *common;
  opc_box box;
  int how;
} overlap;

static void try_common(void *data, uint32_t i) {
  overlap *o = data;
  opc_box c = o->common->box[i];
  if (c.x0 == o->box.x0 && c.y0 == o->box.y0 && c.x1 == o->box.x1 &&
      c.y1 == o->box.y1)
    o->how = WITHIN;
  else if (o->how == OUTSIDE && c.x0 < o->box.x1 && c.x1 > o->box.x0 &&
           c.y0 < o->box.y1 && c.y1 > o->box.y0)
    o->how = PARTLY;
}

static opc_box *bounds(const opc_shapes *s, size_t *n) {
  opc_box *out = malloc((s->count + 1) * sizeof *out);
  *n = s->count;
  for (size_t i = 0; out && i < s->count; i++) {
    opc_point p = s->points[s->start[i]];
    out[i] = (opc_box){p.x, p.y, p.x, p.y};
    for (uint32_t k = s->start[i] + 1; k < s->start[i + 1]; k++) {
      p = s->points[k];
      if (p.x < out[i].x0) out[i].x0 = p.x;
      if (p.x > out[i].x1) out[i].x1 = p.x;
      if (p.y < out[i].y0) out[i].y0 = p.y;
      if (p.y > out[i].y1) out[i].y1 = p.y;
    }
  }
  return out;
}

/* How each contact lies on a layer, in `how`. */
static int sort_contacts(const opc_host *host, const opc_gates *g, int layer,
                         const opc_box *box, int32_t side, uint8_t *how,
                         opc_error *error) {
  const opc_geometry_service *geometry = host->geometry;
  opc_shapes common = {0};
  bins b = {0};
  size_t n;
  int code = geometry->boolean(host, OPC_AND, &g->drawn[OPC_CONTACT],
                               &g->drawn[layer], &common, error);
  if (code) return code;
  opc_box *boxes = bounds(&common, &n);
  geometry->release(&common);
  if (!bins_make(&b, boxes, n, side))
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < g->drawn[OPC_CONTACT].count; i++) {
    overlap o = {&b, box[i], OUTSIDE};
    if (n) bins_visit(&b, box[i], try_common, &o);
    how[i] = (uint8_t)o.how;
  }
  bins_clear(&b);
  return OPC_OK;
}

/* Contacts that lie wholly on a layer must be covered by it; those that do not
   touch poly must stay so. Those that lie partly on a layer are drawn to. */
static int add_contacts(drawing *d, const opc_host *host, const opc_gates *g,
                        int32_t side, sites *s, opc_error *error) {
  size_t n, apart_from_poly = 0, on_poly = 0;
  opc_box *box = bounds(&g->drawn[OPC_CONTACT], &n);
  opc_box *free_ones = malloc((n + 1) * sizeof *free_ones);
  opc_box *pads = malloc((n + 1) * sizeof *pads);
  uint8_t *how = calloc(OPC_MASKS * n + 1, 1);
  int code = box && free_ones && pads && how
                 ? OPC_OK
                 : host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  for (int layer = 0; layer < OPC_MASKS && !code; layer++)
    code = sort_contacts(host, g, layer, box, side, how + (size_t)layer * n,
                         error);
  for (size_t i = 0; i < n && !code; i++) {
    site one = {.box = box[i], .gate = nearest_gate(d, box[i], g->grid),
                .kind = SITE_ENCLOSURE, .sides = (1 << SIDES) - 1};
    for (int layer = 0; layer < OPC_MASKS; layer++) {
      one.layer = (uint8_t)layer;
      if (how[(size_t)layer * n + i] == WITHIN) add(s, one);
    }
    if (how[(size_t)OPC_POLY * n + i] == WITHIN) pads[on_poly++] = box[i];
    if (how[(size_t)OPC_POLY * n + i] != OUTSIDE) continue;
    one.layer = OPC_POLY;
    one.kind = SITE_CONTACT;
    add(s, one);
    free_ones[apart_from_poly++] = box[i];
  }
  free(box);
  free(how);
  if (code) {
    free(free_ones);
    free(pads);
    return code;
  }
  return (bins_make(&d->contacts, free_ones, apart_from_poly, side) &
          bins_make(&d->pads, pads, on_poly, side))
             ? OPC_OK
             : host->fail(host, error, OPC_FAILED, NULL, "out of memory");
}

/* ---- lines and gaps ---- */

/* An edge of drawn poly, and which way it faces. */
typedef struct wall {
  opc_point a, b;
  int inwards;           /* the side that poly lies on */
  int convex[2];         /* its corners */
} wall;

static int64_t turn(opc_point a, opc_point b, opc_point c) {
  return ((int64_t)b.x - a.x) * ((int64_t)c.y - b.y) -
         ((int64_t)b.y - a.y) * ((int64_t)c.x - b.x);
}

static wall wall_of(const opc_shapes *s, size_t p, uint32_t i) {
  uint32_t from = s->start[p], n = s->start[p + 1] - from, k = i - from;
  opc_point before = s->points[from + (k + n - 1) % n];
  opc_point a = s->points[i], b = s->points[from + (k + 1) % n];
  opc_point after = s->points[from + (k + 2) % n];
  return (wall){
      .a = a,
      .b = b,
      .inwards = b.x > a.x ? ABOVE : b.x < a.x ? BELOW : b.y > a.y ? LEFT : RIGHT,
      .convex = {turn(before, a, b) > 0, turn(a, b, after) > 0}};
}

static opc_point along(const wall *w, double t, double length) {
  return (opc_point){
      w->a.x + (int32_t)lround(((double)w->b.x - w->a.x) * t / length),
      w->a.y + (int32_t)lround(((double)w->b.y - w->a.y) * t / length)};
}

/* Half a line's width, or a gap's, away from the wall. */
static opc_point away(opc_point p, int side, int32_t d) {
  return side == ABOVE ? (opc_point){p.x, p.y + d} : (opc_point){p.x + d, p.y};
}

static void add_line(const drawing *d, const limits *r, double grid,
                     opc_point middle, int side, sites *s) {
  int32_t half = (int32_t)(r->min_width / 2 / grid);
  opc_box box = {middle.x, middle.y, middle.x, middle.y};
  if (bins_inside(&d->gates, middle)) return;   /* gates are measured */
  if (side == ABOVE) box.y0 -= half, box.y1 += half;
  else box.x0 -= half, box.x1 += half;
  add(s, (site){.box = box, .gate = nearest_gate(d, box, grid),
                .kind = SITE_LINE, .layer = OPC_POLY,
                .sides = side == ABOVE ? 1 << BELOW | 1 << ABOVE
                                       : 1 << LEFT | 1 << RIGHT});
}

static void add_gap(const drawing *d, double grid, int layer, opc_point middle,
                    int side, sites *s) {
  opc_box box = {middle.x, middle.y, middle.x, middle.y};
  add(s, (site){.box = box, .gate = nearest_gate(d, box, grid),
                .kind = SITE_GAP, .layer = (uint8_t)layer,
                .sides = side == ABOVE ? 1 << BELOW : 1 << LEFT});
}

/* Look from each wall to the right and up: through poly for lines, and from
   poly outwards for gaps, so that each is found once. */
static void add_wall(const drawing *d, const limits *r, double grid, double step,
                     int layer, const wall *w, sites *s) {
  int line = w->inwards == ABOVE || w->inwards == RIGHT;
  if (line && layer != OPC_POLY) return;
  int side = w->inwards == ABOVE || w->inwards == BELOW ? ABOVE : RIGHT;
  double length = fabs((double)w->b.x - w->a.x) + fabs((double)w->b.y - w->a.y);
  double corner = rounding / grid, skip[2];
  for (int i = 0; i < 2; i++) skip[i] = w->convex[i] == line ? corner : 0;
  double seen = length - skip[0] - skip[1];
  if (!(seen > 0)) return;
  int32_t range = (int32_t)(wide / grid), n = (int32_t)ceil(seen / step);
  for (int32_t i = 0; i < n; i++) {
    opc_point p = along(w, skip[0] + (i + 0.5) * seen / n, length);
    opc_box dot = {p.x, p.y, p.x, p.y};
    int32_t across =
        bins_nearest(&d->edges[layer], bins_window(dot, side, 1, range, 1),
                     side, range, NULL) + 1;
    if (across >= range) continue;
    opc_point middle = away(p, side, across / 2);
    if (line) add_line(d, r, grid, middle, side, s);
    else add_gap(d, grid, layer, middle, side, s);
  }
}

static void add_lines(const drawing *d, const opc_gates *g, const limits *r,
                      int layer, sites *s) {
  const opc_shapes *drawn = &g->drawn[layer];
  double total = 0;
  for (size_t i = 0; i < d->edges[layer].n; i++) {
    opc_box e = d->edges[layer].box[i];
    total += (double)e.x1 - e.x0 + ((double)e.y1 - e.y0);
  }
  double step = fmax(pitch / g->grid, total / MOST_SITES);
  for (size_t p = 0; p < drawn->count; p++)
    for (uint32_t i = drawn->start[p]; i < drawn->start[p + 1]; i++) {
      wall w = wall_of(drawn, p, i);
      add_wall(d, r, g->grid, step, layer, &w, s);
    }
}

/* ---- all ---- */

static int add_widths(drawing *d, const opc_gates *g, int32_t side) {
  const opc_edges *e = &g->edges[OPC_ACTIVE];
  size_t all = e->polygons ? e->start[e->polygons] : 0, n = 0;
  opc_box *box = malloc((all + 1) * sizeof *box);
  d->width = malloc((all + 1) * sizeof(const opc_fragment *));
  for (size_t p = 0; box && d->width && p < e->polygons; p++)
    for (uint32_t i = e->start[p]; i < e->start[p + 1]; i++) {
      const opc_fragment *f = &e->fragments[i];
      if (f->role != OPC_W_LOW && f->role != OPC_W_HIGH) continue;
      uint32_t next = i + 1 < e->start[p + 1] ? i + 1 : e->start[p];
      opc_point a = f->from, b = e->fragments[next].from;
      box[n] = (opc_box){a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y,
                         a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y};
      d->width[n++] = f;
    }
  return bins_make(&d->widths, box, n, side) && d->width;
}

void drawing_clear(drawing *d) {
  free(d->width);
  bins_clear(&d->widths);
  for (int layer = 0; layer < OPC_MASKS; layer++) bins_clear(&d->edges[layer]);
  bins_clear(&d->gates);
  bins_clear(&d->contacts);
  bins_clear(&d->pads);
  *d = (drawing){0};
}

int drawing_make(drawing *d, const opc_host *host, const opc_gates *g,
                 const limits *r, sites *s, opc_error *error) {
  int32_t side = (int32_t)(300 / g->grid) + 1;
  int good = 1;
  *d = (drawing){0};
  for (int layer = 0; layer < OPC_MASKS && good; layer++) {
    size_t n;
    opc_box *edges = bins_edges(&g->drawn[layer], &n);
    good = bins_make(&d->edges[layer], edges, n, side);
  }
  opc_box *boxes = malloc((g->count + 1) * sizeof *boxes);
  for (size_t i = 0; boxes && i < g->count; i++) boxes[i] = g->box[i];
  good = bins_make(&d->gates, boxes, g->count, side) && good;
  good = good && add_widths(d, g, side);
  if (!good) return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  int code = add_contacts(d, host, g, side, s, error);
  if (code) return code;
  for (int layer = 0; layer < OPC_MASKS; layer++) add_lines(d, g, r, layer, s);
  return s->failed
             ? host->fail(host, error, OPC_FAILED, NULL, "out of memory")
             : OPC_OK;
}
