/* SPDX-License-Identifier: BSD-3-Clause */
/* A look at a site is the sign of the print at a few points. Only where one is
   wrong, the contour is looked for. */
#include "repairs.h"

#include <math.h>
#include <stdlib.h>

enum { BLOCK = 256, POINTS = 3 * SIDES };

/* nm: how far contours are looked for, how long the patch of a line is on
   either side of its site. */
static const double reach = 150, half_patch = 40;

/* nm: a patch takes a corner along that is so near; how far the sides beside one
   that may not go further do so at once. */
static const double corner_of = 20, flank_step = 15;

void repairs_clear(repairs *r) {
  free(r->at);
  trims_clear(&r->trims);
  *r = (repairs){0};
}

static int upright(int side) { return side == LEFT || side == RIGHT; }

static opc_box widened(opc_box b, int32_t by) {
  return (opc_box){b.x0 - by, b.y0 - by, b.x1 + by, b.y1 + by};
}

/* ---- points ---- */

/* How far from the box the print is looked at, nm: contacts may lie as far off
   as the overlay. */
static double margin(const site *s, const limits *r) {
  return s->kind == SITE_ENCLOSURE || s->kind == SITE_CONTACT ? r->overlay : 0;
}

/* What must not be there is looked for at corners too, what must be there away
   from them: they are rounded. */
static int points_of(const site *s, const limits *r, double grid, double *x,
                     double *y, uint8_t *side) {
  double x0 = s->box.x0 * grid, x1 = s->box.x1 * grid, m = margin(s, r);
  double y0 = s->box.y0 * grid, y1 = s->box.y1 * grid;
  double inset = s->kind == SITE_ENCLOSURE ? 0.25 : 0;
  int n = 0, many = s->kind == SITE_ENCLOSURE || s->kind == SITE_CONTACT ? 3 : 1;
  for (int k = 0; k < SIDES; k++) {
    if (!(s->sides & 1 << k)) continue;
    for (int i = 0; i < many; i++) {
      double t = many == 1 ? 0.5 : inset + i * (0.5 - inset);
      int flat = upright(k);
      x[n] = flat ? (k == LEFT ? x0 - m : x1 + m) : x0 + t * (x1 - x0);
      y[n] = flat ? y0 + t * (y1 - y0) : (k == BELOW ? y0 - m : y1 + m);
      side[n++] = (uint8_t)k;
    }
  }
  return n;
}

/* Whether poly or active must print there. */
static int wanted(const site *s) {
  return s->kind == SITE_ENCLOSURE || s->kind == SITE_LINE;
}

/* ---- looking ---- */

typedef struct look {
  const opc_host *host;
  const opc_printed *p;
  const limits *rules;
  const sites *s;
  const repairs *r;
} look;

typedef struct points {
  double x[BLOCK * POINTS], y[BLOCK * POINTS], value[BLOCK * POINTS];
  uint8_t side[BLOCK * POINTS];
  uint32_t site[BLOCK * POINTS];
  size_t n;
} points;

static void look_at_layer(const look *l, points *q, size_t first, size_t last,
                          int layer) {
  q->n = 0;
  for (size_t i = first; i < last; i++) {
    site *s = &l->s->at[i];
    if (s->layer != layer) continue;
    s->failing = 0;
    int n = points_of(s, l->rules, l->p->gates->grid, q->x + q->n, q->y + q->n,
                      q->side + q->n);
    for (int k = 0; k < n; k++) q->site[q->n++] = (uint32_t)i;
  }
  if (!q->n) return;
  l->host->imaging->sample(&l->p->print[layer], q->x, q->y, q->n, q->value);
  for (size_t k = 0; k < q->n; k++) {
    site *s = &l->s->at[q->site[k]];
    if ((q->value[k] > 0) != wanted(s))
      s->failing |= (uint8_t)(1 << q->side[k]);
  }
}

static void look_at_block(void *data, size_t block) {
  const look *l = data;
  size_t first = block * BLOCK, last = first + BLOCK;
  points *q = malloc(sizeof *q);
  if (last > l->s->n) last = l->s->n;
  if (!q) {   /* all of the block fails: nothing is taken for good */
    for (size_t i = first; i < last; i++) l->s->at[i].failing = l->s->at[i].sides;
    return;
  }
  for (int layer = 0; layer < OPC_MASKS; layer++)
    look_at_layer(l, q, first, last, layer);
  free(q);
}

/* How far the contour lies outwards from a side of the site's box, nm: the
   least of its points. */
static double contour(const look *l, const site *s, int side) {
  double x[POINTS], y[POINTS], least = INFINITY, m = margin(s, l->rules);
  uint8_t of[POINTS];
  int n = points_of(s, l->rules, l->p->gates->grid, x, y, of);
  int axis = upright(side) ? OPC_X : OPC_Y;
  double out = side == LEFT || side == BELOW ? -1 : 1;
  const opc_field *print = &l->p->print[s->layer];
  for (int k = 0; k < n; k++) {
    double value, d;
    if (of[k] != side) continue;
    l->host->imaging->sample(print, &x[k], &y[k], 1, &value);
    d = out * l->host->imaging->edge(print, axis, x[k], y[k], reach);
    if (isnan(d)) d = (value > 0) == wanted(s) ? reach : -reach;
    /* The contour nearest to a good point may lie either way. */
    least = fmin(least, m + ((value > 0) == wanted(s) ? fabs(d) : -fabs(d)));
  }
  return least;
}

static void measure(void *data, size_t i) {
  const look *l = data;
  repair *r = &l->r->at[i];
  const site *s = &l->s->at[r->site];
  for (int k = 0; k < SIDES && s->failing; k++)
    if (s->sides & 1 << k) r->value[k] = contour(l, s, k);
}

/* ---- what can be mended ---- */

/* LEFT and RIGHT, BELOW and ABOVE. */
static int other_way(int side) { return side ^ 1; }

/* How far the width of a gate moves a corner outwards: half its bias, and an
   odd step on the HIGH side. */
static int32_t moved(const opc_printed *p, const opc_fragment *f) {
  if (!f) return 0;
  int32_t w = p->w[f->gate], low = w >> 1;
  return f->role == OPC_W_LOW ? low : w - low;
}

/* The patch on a side: the piece of the drawn edge as far out as it grows, and
   as far in as a mask may be narrow. Its ends go with the corners; where two
   patches meet in a corner, both cover it. */
static opc_box patch_of(const opc_printed *printed, const limits *rules,
                        const site *s, const repair *r, int side) {
  int32_t in = (int32_t)ceil(rules->mask_width / printed->gates->grid - 1e-9);
  int32_t out = r->edge[side] + r->grow[side];
  int low = upright(side) ? BELOW : LEFT, high = low + 1;
  opc_box b = s->box, p = bins_window(b, side, r->edge[side] - in, out, 0);
  int32_t b0 = upright(side) ? b.y0 : b.x0, b1 = upright(side) ? b.y1 : b.x1;
  int32_t from = r->from[side], to = r->to[side];
  int meets_low = from == b0 - r->edge[low], meets_high = to == b1 + r->edge[high];
  from -= moved(printed, r->corner[side][0]) + (meets_low ? r->grow[low] : 0);
  to += moved(printed, r->corner[side][1]) + (meets_high ? r->grow[high] : 0);
  if (upright(side)) p.y0 = from, p.y1 = to;
  else p.x0 = from, p.x1 = to;
  return p;
}

/* How far the mask may go past what is drawn on a side: what it faces may come
   as far, but shapes of the other layer and contacts stay. */
static int32_t room_of(const drawing *d, const limits *rules, const site *s,
                       const repair *r, int side, double grid) {
  int32_t beside = (int32_t)ceil(rules->min_space / grid);
  int32_t range =
      (int32_t)ceil((2 * rules->max_growth + rules->min_space) / grid) + 1;
  opc_box edge = bins_window(s->box, side, r->edge[side], r->edge[side], 0);
  if (upright(side)) edge.y0 = r->from[side], edge.y1 = r->to[side];
  else edge.x0 = r->from[side], edge.x1 = r->to[side];
  opc_box window = bins_window(edge, side, 1, range, beside);
  double own = bins_nearest(&d->edges[s->layer], window, side, range, NULL) + 1;
  window = bins_window(edge, side, 0, range, beside);
  double other =
      bins_nearest(&d->edges[!s->layer], window, side, range, NULL);
  if (s->layer == OPC_POLY)
    other = fmin(other, bins_nearest(&d->contacts, window, side, range, NULL));
  double most = fmin((own * grid - rules->min_space) / 2,
                     other * grid - rules->min_space);
  return (int32_t)floor(fmax(0, fmin(rules->max_growth, most)) / grid + 1e-9);
}

typedef struct corner {
  const drawing *d;
  int side;
  const opc_fragment *found;
} corner;

static void try_width(void *data, uint32_t i) {
  corner *c = data;
  opc_box e = c->d->widths.box[i];
  if (upright(c->side) ? e.y0 == e.y1 : e.x0 == e.x1) c->found = c->d->width[i];
}

/* What moves the corner at an end of the edge on `side`. */
static const opc_fragment *corner_at(const drawing *d, int side, int32_t x,
                                     int32_t y) {
  corner c = {d, side, NULL};
  bins_visit(&d->widths, (opc_box){x, y, x, y}, try_width, &c);
  return c.found;
}

/* What may be moved on a side. The whole edge that is drawn there makes no jog;
   where it has less room, only what the site needs of it is, and its corner if
   that is near. */
static void find_edge(const drawing *d, const limits *rules, const site *s,
                      repair *r, int side, double grid) {
  int32_t far = (int32_t)(2 * reach / grid), more = 0;
  opc_box edge = {0}, b = s->box;
  /* From one step inside, so as to see one at the side of the box. */
  r->edge[side] = bins_nearest(&d->edges[s->layer],
                               bins_window(b, side, -1, far, 0), side, far + 1,
                               &edge) - 1;
  if (s->kind == SITE_LINE) more = (int32_t)(half_patch / grid);
  r->from[side] = (upright(side) ? b.y0 : b.x0) - more;
  r->to[side] = (upright(side) ? b.y1 : b.x1) + more;
  r->room[side] = room_of(d, rules, s, r, side, grid);
  if (s->kind == SITE_LINE || r->edge[side] == far ||
      (upright(side) ? edge.x0 != edge.x1 : edge.y0 != edge.y1))
    return;
  int32_t near = (int32_t)(corner_of / grid);
  if (s->kind == SITE_ENCLOSURE) {
    int32_t low = upright(side) ? edge.y0 : edge.x0;
    int32_t high = upright(side) ? edge.y1 : edge.x1;
    if (r->from[side] - low <= near) r->from[side] = low;
    if (high - r->to[side] <= near) r->to[side] = high;
    r->room[side] = room_of(d, rules, s, r, side, grid);
  }
  repair whole = *r;
  whole.from[side] = upright(side) ? edge.y0 : edge.x0;
  whole.to[side] = upright(side) ? edge.y1 : edge.x1;
  whole.room[side] = room_of(d, rules, s, &whole, side, grid);
  if (whole.room[side] < r->room[side]) return;
  *r = whole;
  if (s->layer != OPC_ACTIVE) return;
  r->corner[side][0] = corner_at(d, side, edge.x0, edge.y0);
  r->corner[side][1] = corner_at(d, side, edge.x1, edge.y1);
}

static int add_repair(const opc_host *host, const drawing *d,
                      const limits *rules, double grid, sites *s, size_t i,
                      repairs *r, opc_error *error) {
  if (r->n == r->most) {
    size_t most = r->most ? 2 * r->most : 256;
    repair *more = realloc(r->at, most * sizeof *more);
    if (!more)
      return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    r->at = more;
    r->most = most;
  }
  repair *one = &r->at[r->n];
  *one = (repair){.site = (uint32_t)i};
  for (int k = 0; k < SIDES; k++)
    if (s->at[i].sides & 1 << k) find_edge(d, rules, &s->at[i], one, k, grid);
  s->at[i].repair = (int32_t)r->n++;
  return OPC_OK;
}

int repairs_look(const opc_host *host, const opc_printed *p, const limits *rules,
                 const drawing *d, sites *s, repairs *r, opc_error *error) {
  look l = {host, p, rules, s, r};
  host->parallel(host, (s->n + BLOCK - 1) / BLOCK, look_at_block, &l);
  for (size_t i = 0; i < s->n; i++) {
    if (!s->at[i].failing || s->at[i].repair >= 0 || !wanted(&s->at[i]))
      continue;
    int code =
        add_repair(host, d, rules, p->gates->grid, s, i, r, error);
    if (code) return code;
  }
  host->parallel(host, r->n, measure, &l);
  return OPC_OK;
}

/* ---- mending ---- */

/* A line must be wide enough, not also in the middle. */
static double print_at(const site *s, const repair *r, int side) {
  return s->kind == SITE_LINE
             ? (r->value[side] + r->value[other_way(side)]) / 2
             : r->value[side];
}

/* A side that may not go further out prints further if its corners do: as long as
   that brings a tenth of what is missing, as it disturbs what is near. */
static void grow_flanks(repair *r, int side, double target, double grid) {
  int32_t step = (int32_t)ceil(flank_step / grid);
  double value = r->value[side], before = r->flanked[side];
  int helps = before == 0 || value - before > (target - value) / 10;
  for (int k = upright(side) ? BELOW : LEFT, n = 0; n < 2; k++, n++) {
    int32_t left = r->room[k] - r->grow[k];
    if (helps) r->grow[k] += left < step ? left : step;
    else r->room[k] = r->grow[k];
  }
  r->flanked[side] = value;
}

static void grow(const limits *rules, const site *s, repair *r, double grid) {
  for (int k = 0; k < SIDES; k++) {
    double value = print_at(s, r, k), target = margin(s, rules);
    if (!(s->sides & 1 << k) || !(value < target)) continue;
    int32_t to = rules_advance(&r->response[k], r->grow[k], value,
                               target, 1, grid);
    if (to > r->room[k]) to = r->room[k];
    if (to > r->grow[k]) r->grow[k] = to;
    else if (s->kind == SITE_ENCLOSURE) grow_flanks(r, k, target, grid);
  }
}

/* Whether the boxes touch or overlap. */
static int meet(opc_box a, opc_box b) {
  return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1;
}

/* Patches that close a gap, or touch a contact, go back and stay there: those
   that face it, or all that are near. Whether there were any. */
static int take_back(const opc_printed *p, const limits *rules,
                     const sites *s, const site *wrong, int facing,
                     repairs *r) {
  double grid = p->gates->grid;
  int32_t near = (int32_t)(reach / grid), step = (int32_t)ceil(rules_back / grid);
  int32_t flank = (int32_t)(corner_of / grid);
  int found = 0;
  for (size_t i = 0; i < r->n; i++) {
    repair *one = &r->at[i];
    const site *of = &s->at[one->site];
    if (of->layer != wrong->layer ||
        !meet(widened(of->box, 3 * near), wrong->box))
      continue;
    for (int k = 0; k < SIDES; k++) {
      if (!one->grow[k]) continue;
      opc_box patch = patch_of(p, rules, of, one, k);
      if (!meet(facing ? bins_window(patch, k, 0, near, flank)
                       : widened(patch, near), wrong->box))
        continue;
      found = 1;
      if (one->back[k] == r->trims.round) continue;   /* once a print */
      one->grow[k] -= one->grow[k] < step ? one->grow[k] : step;
      one->room[k] = one->grow[k];
      one->back[k] = r->trims.round;
    }
  }
  return found;
}

/* What must not print: patches before it go back, or else edges of poly as
   drawn, or else what is near. */
static int clear_away(const opc_host *host, const opc_printed *p,
                      const limits *rules, const drawing *d, sites *s,
                      site *wrong, repairs *r, opc_error *error) {
  int moved = take_back(p, rules, s, wrong, 1, r), code = OPC_OK;
  if (!moved && wrong->kind == SITE_GAP && wrong->layer == OPC_POLY)
    code = trims_deepen(&r->trims, host, d, rules, p->gates->grid, wrong, &moved,
                        error);
  if (!moved && !code && wrong->layer == OPC_POLY)
    take_back(p, rules, s, wrong, 0, r);
  return code;
}

int repairs_grow(const opc_host *host, const opc_printed *p, const limits *rules,
                 const drawing *d, sites *s, repairs *r, opc_error *error) {
  trims_begin(&r->trims);
  for (size_t i = 0; i < s->n; i++) {
    if (!s->at[i].failing || wanted(&s->at[i])) continue;
    int code = clear_away(host, p, rules, d, s, &s->at[i], r, error);
    if (code) return code;
  }
  for (size_t i = 0; i < r->n; i++) {
    const site *one = &s->at[r->at[i].site];
    if (one->failing) grow(rules, one, &r->at[i], p->gates->grid);
  }
  return OPC_OK;
}

int repairs_patches(const opc_printed *p, const limits *rules, const sites *s,
                    const repairs *r, box_list patch[OPC_MASKS]) {
  int good = 1;
  for (size_t i = 0; i < r->n; i++) {
    const site *one = &s->at[r->at[i].site];
    for (int k = 0; k < SIDES && good; k++)
      if (r->at[i].grow[k])
        good = boxes_add(&patch[one->layer],
                         patch_of(p, rules, one, &r->at[i], k));
  }
  return good;
}

/* ---- telling ---- */

enum { UNDONE, NEIGHBOUR, GROWTH, REASONS };

static const char *const enclosure[REASONS] = {
    "enclosure: could still move", "enclosure: too near a neighbour",
    "enclosure: max_growth reached"};
static const char *const pinching[REASONS] = {
    "pinching: could still move", "pinching: too near a neighbour",
    "pinching: max_growth reached"};

static int reason(const repair *r, int side, const limits *rules, double grid) {
  int32_t most = (int32_t)floor(rules->max_growth / grid + 1e-9);
  if (r->grow[side] < r->room[side]) return UNDONE;
  return r->room[side] < most ? NEIGHBOUR : GROWTH;
}

static opc_violation at_site(const site *s, double grid) {
  return (opc_violation){.gate = s->gate,
                         .x = ((double)s->box.x0 + s->box.x1) / 2 * grid,
                         .y = ((double)s->box.y0 + s->box.y1) / 2 * grid};
}

static void report_enclosure(const site *s, const repair *r,
                             const limits *rules, double grid,
                             violations *out) {
  opc_violation v = at_site(s, grid);
  int worst = -1;
  for (int k = 0; k < SIDES; k++)
    if (s->failing & 1 << k && (worst < 0 || r->value[k] < r->value[worst]))
      worst = k;
  int flank = upright(worst) ? BELOW : LEFT;
  int undone = r->grow[flank] < r->room[flank] ||
               r->grow[flank + 1] < r->room[flank + 1];
  v.rule = enclosure[undone ? UNDONE : reason(r, worst, rules, grid)];
  v.value = r->value[worst];
  v.limit = rules->overlay;
  violations_add(out, v);
}

static void report_line(const site *s, const repair *r, const limits *rules,
                        double grid, violations *out) {
  opc_violation v = at_site(s, grid);
  int low = s->sides & 1 << LEFT ? LEFT : BELOW;
  double width = ((double)s->box.x1 - s->box.x0 + ((double)s->box.y1 - s->box.y0)) *
                     grid + r->value[low] + r->value[low + 1];
  /* As wide as it must be, but off its middle: good. */
  if (width >= rules->min_width) return;
  v.value = fmax(0, width);
  v.limit = rules->min_width;
  int a = reason(r, low, rules, grid), b = reason(r, low + 1, rules, grid);
  v.rule = pinching[a == UNDONE || b == UNDONE ? UNDONE
                    : a == GROWTH && b == GROWTH ? GROWTH : NEIGHBOUR];
  violations_add(out, v);
}

void repairs_report(const opc_host *host, const opc_printed *p,
                    const limits *rules, const sites *s, const repairs *r,
                    violations *out) {
  double grid = p->gates->grid;
  look l = {host, p, rules, s, r};
  for (size_t i = 0; i < s->n; i++) {
    const site *one = &s->at[i];
    if (!one->failing) continue;
    if (wanted(one) && one->kind == SITE_ENCLOSURE)
      report_enclosure(one, &r->at[one->repair], rules, grid, out);
    if (one->kind == SITE_LINE)
      report_line(one, &r->at[one->repair], rules, grid, out);
    if (wanted(one)) continue;
    opc_violation v = at_site(one, grid);
    v.rule = one->kind != SITE_GAP     ? "bridging: contact"
             : one->layer == OPC_ACTIVE ? "bridging: active"
             : trims_could(&r->trims, one)
                 ? "bridging: poly: could still move"
                 : "bridging: poly: drawn too near for its edges to go back";
    if (one->kind == SITE_CONTACT) {
      v.value = INFINITY;
      for (int k = 0; k < SIDES; k++)
        if (one->failing & 1 << k) v.value = fmin(v.value, contour(&l, one, k));
      v.limit = rules->overlay;
    }
    violations_add(out, v);
  }
}
