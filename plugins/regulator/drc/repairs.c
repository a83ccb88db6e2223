/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements checks of the sites on a printed image, and repair shapes added to
   the mask. A check evaluates the sign of the level set at a few points. The
   contour is located only at sites with a wrong sign. */
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

#include "drc.h"
#include "tuning.h"

enum { BLOCK = 256, POINTS = 3 * SIDES };

/* ---- points ---- */

/* Return 1 if the layer must print at the site. */
static int site_wants(const site *s) {
  return s->kind == SITE_ENCLOSURE || s->kind == SITE_LINE;
}

static int is_contact(const site *s) {
  return s->kind == SITE_ENCLOSURE || s->kind == SITE_CONTACT;
}

/* Return the distance from the site's box at which the image is checked, nm:
   the overlay error for contacts, else 0. */
static double site_margin(const drc *r, const site *s) {
  return is_contact(s) ? r->overlay : 0;
}

/* Compute the checked points of a site. Return their number. The points include
   the corners of a contact that the layer must not touch, but not the corners
   of a contact that the layer must cover, because corners print rounded. */
static int site_points(const drc *r, const site *s, double *x, double *y,
                       uint8_t *side) {
  double m = site_margin(r, s), grid = r->grid;
  double x0 = s->box.x0 * grid, x1 = s->box.x1 * grid;
  double y0 = s->box.y0 * grid, y1 = s->box.y1 * grid;
  double inset = s->kind == SITE_ENCLOSURE ? tuned.inset : 0;
  int n = 0, many = is_contact(s) ? 3 : 1;
  for (int k = 0; k < SIDES; k++) {
    if (!(s->sides & 1 << k)) continue;
    for (int i = 0; i < many; i++) {
      double t = many == 1 ? 0.5 : inset + i * (0.5 - inset);
      int flat = side_upright(k);
      x[n] = flat ? (k == LEFT ? x0 - m : x1 + m) : x0 + t * (x1 - x0);
      y[n] = flat ? y0 + t * (y1 - y0) : (k == BELOW ? y0 - m : y1 + m);
      side[n++] = (uint8_t)k;
    }
  }
  return n;
}

/* ---- checks ---- */

typedef struct check_run {
  drc *r;
  const eda_printed *p;
} check_run;

typedef struct points {
  double x[BLOCK * POINTS], y[BLOCK * POINTS], value[BLOCK * POINTS];
  uint8_t side[BLOCK * POINTS];
  uint32_t site[BLOCK * POINTS];
  size_t n;
} points;

static void sites_check_layer(const check_run *l, points *q, size_t first,
                              size_t last, size_t layer) {
  q->n = 0;
  for (size_t i = first; i < last; i++) {
    site *s = &l->r->sites[i];
    if (s->layer != layer) continue;
    s->failing = 0;
    int n = site_points(l->r, s, q->x + q->n, q->y + q->n, q->side + q->n);
    for (int k = 0; k < n; k++) q->site[q->n++] = (uint32_t)i;
  }
  if (!q->n) return;
  eda_field_sample(&l->p->print[layer], q->x, q->y, q->n, q->value);
  for (size_t k = 0; k < q->n; k++) {
    site *s = &l->r->sites[q->site[k]];
    if ((q->value[k] > 0) != site_wants(s))
      s->failing |= (uint8_t)(1 << q->side[k]);
  }
}

static void sites_check_block(void *data, size_t block) {
  const check_run *l = data;
  size_t first = block * BLOCK, last = first + BLOCK;
  points *q = eda_alloc(1, sizeof *q);
  if (last > l->r->n_sites) last = l->r->n_sites;
  for (size_t layer = 0; layer < l->r->layers; layer++)
    sites_check_layer(l, q, first, last, layer);
  free(q);
}

/* Return the distance from a side of the site's box outwards to the contour,
   nm: the smallest value of the checked points on the side. */
static double site_contour(const drc *r, const eda_printed *p, const site *s,
                           int side) {
  double x[POINTS], y[POINTS], least = INFINITY, m = site_margin(r, s);
  uint8_t of[POINTS];
  int n = site_points(r, s, x, y, of);
  int axis = side_upright(side) ? EDA_X : EDA_Y;
  double out = side == LEFT || side == BELOW ? -1 : 1;
  const eda_field *print = &p->print[s->layer];
  for (int k = 0; k < n; k++) {
    double value, d;
    if (of[k] != side) continue;
    eda_field_sample(print, &x[k], &y[k], 1, &value);
    int good = (value > 0) == site_wants(s);
    d = out * eda_field_edge(print, axis, x[k], y[k], tuned.reach);
    if (isnan(d)) d = good ? tuned.reach : -tuned.reach;
    /* If the sign is correct, the contour may be on either side of the point:
       search both. */
    least = fmin(least, m + (good ? fabs(d) : -fabs(d)));
  }
  return least;
}

static void repair_measure(void *data, size_t i) {
  const check_run *l = data;
  repair *one = &l->r->repairs[i];
  const site *s = &l->r->sites[one->site];
  for (int k = 0; k < SIDES && s->failing; k++)
    if (s->sides & 1 << k) one->value[k] = site_contour(l->r, l->p, s, k);
}

/* ---- check of all sites ---- */

void repairs_check(drc *r, const eda_printed *p) {
  check_run l = {r, p};
  opc_parallel(r->host->context, (r->n_sites + BLOCK - 1) / BLOCK,
               sites_check_block, &l);
  for (size_t i = 0; i < r->n_sites; i++) {
    site *s = &r->sites[i];
    if (!s->failing || s->repair >= 0 || !site_wants(s)) continue;
    eda_grow(&r->repairs, &r->repairs_capacity, r->n_repairs + 1,
             sizeof *r->repairs);
    repair *one = &r->repairs[r->n_repairs];
    *one = (repair){.site = (uint32_t)i};
    for (int k = 0; k < SIDES; k++)
      if (s->sides & 1 << k) repair_find_edge(r, s, one, k);
    s->repair = (int32_t)r->n_repairs++;
  }
  opc_parallel(r->host->context, r->n_repairs, repair_measure, &l);
}

/* ---- repairs ---- */

/* Return the value of a side that is compared with the limit. For a line, the
   total width is compared, so each side has half of the sum of both sides. */
static double repair_figure(const site *s, const repair *one, int side) {
  return s->kind == SITE_LINE
             ? (one->value[side] + one->value[side_opposite(side)]) / 2
             : one->value[side];
}

/* Displace the two sides adjacent to a side at its limit, which also displaces
   the corners, as long as the contour at the side improves. */
static void repair_grow_flanks(repair *one, int side, double grid) {
  int32_t step = (int32_t)ceil(tuned.flank_step / grid);
  double value = one->value[side], before = one->flanked[side];
  int helps = before == 0 || value > before;
  for (int k = side_upright(side) ? BELOW : LEFT, n = 0; n < 2; k++, n++) {
    int32_t left = one->limit[k] - one->grow[k];
    if (helps)
      one->grow[k] += left < step ? left : step;
    else
      one->limit[k] = one->grow[k];
  }
  one->flanked[side] = value;
}

static void repair_grow(const drc *r, const site *s, repair *one) {
  for (int k = 0; k < SIDES; k++) {
    double value = repair_figure(s, one, k), target = site_margin(r, s);
    if (!(s->sides & 1 << k) || !(value < target)) continue;
    int32_t to = rules_advance(&one->response[k], one->grow[k], value, target,
                               1, r->grid);
    if (to > one->limit[k]) to = one->limit[k];
    if (to > one->grow[k])
      one->grow[k] = to;
    else if (s->kind == SITE_ENCLOSURE)
      repair_grow_flanks(one, k, r->grid);
  }
}

/* Reduce by `step` the repair shapes that bridge the gap or touch the contact
   of site `wrong`, and limit their growth. A shape that displaces an entire
   edge is first shortened to the part in front of the contact or line that
   requires the shape. `facing`: 1: only shapes that face the site; 0: all
   shapes within `near`. Return 1 if a shape was found. */
static int shapes_reduce(drc *r, const eda_printed *p, const site *wrong,
                         int32_t near, int32_t step, int facing) {
  int32_t flank = (int32_t)(tuned.corner / r->grid);
  int found = 0;
  for (size_t i = 0; i < r->n_repairs; i++) {
    repair *one = &r->repairs[i];
    const site *of = &r->sites[one->site];
    if (of->layer != wrong->layer ||
        !eda_boxes_touch(eda_box_grown(of->box, 3 * near), wrong->box))
      continue;
    for (int k = 0; k < SIDES; k++) {
      if (!one->grow[k]) continue;
      eda_box added = repair_shape(r, p, one, k);
      if (!eda_boxes_touch(facing ? box_window(added, k, 0, near, flank)
                                  : eda_box_grown(added, near),
                           wrong->box))
        continue;
      found = 1;
      if (one->back[k] == r->round)
        continue; /* reduce a side at most once per
                     iteration */
      one->back[k] = r->round;
      if (one->whole[k]) {
        repair_keep_segment(r, of, one, k);
        continue;
      }
      int32_t by = one->grow[k] < step ? one->grow[k] : step;
      one->grow[k] -= by;
      one->limit[k] = one->grow[k] + by / 2;
    }
  }
  return found;
}

/* Repair a site where the layer must not print. Reduce the repair shapes that
   face the site; if there are none, trim poly edges; if that is not possible,
   reduce all repair shapes nearby. */
static void site_clear(drc *r, const eda_printed *p, site *wrong) {
  int32_t near = (int32_t)(tuned.reach / r->grid);
  int32_t step = (int32_t)ceil(tuned.back / r->grid);
  if (shapes_reduce(r, p, wrong, near, step, 1) || wrong->layer != EDA_POLY)
    return;
  if (wrong->kind == SITE_GAP && trims_deepen(r, wrong)) return;
  shapes_reduce(r, p, wrong, near, step, 0);
}

/* Extend the repair shapes of a contact that touch `place`, around a short
   edge. */
static void shapes_extend(const drc *r, const eda_printed *p, repair *one,
                          size_t layer, eda_box place,
                          const eda_rule_fault *edge) {
  const site *of = &r->sites[one->site];
  if (of->layer != layer || of->kind != SITE_ENCLOSURE) return;
  for (int k = 0; k < SIDES; k++)
    if (one->grow[k] && eda_boxes_touch(repair_shape(r, p, one, k), place))
      repair_extend(r, p, one, k, edge);
}

/* Extend the repair shapes that end at edges below min_edge. */
static void edges_repair(drc *r, const eda_printed *p, size_t layer,
                         const mrc_faults *found) {
  places sites;
  int32_t far = (int32_t)(2 * tuned.reach / r->grid);
  if (!found->n || !r->n_repairs) return;
  eda_box *box = eda_alloc(r->n_repairs, sizeof *box);
  for (size_t i = 0; i < r->n_repairs; i++)
    box[i] = r->sites[r->repairs[i].site].box;
  places_init(&sites, box, r->n_repairs, 2 * tuned.reach, r->grid);
  for (size_t i = 0; i < found->n; i++) {
    const eda_rule_fault *fault = &found->fault[i];
    int32_t x = (int32_t)lround(fault->x / r->grid);
    int32_t y = (int32_t)lround(fault->y / r->grid);
    int32_t half = (int32_t)ceil(fault->value / 2 / r->grid) + 1;
    eda_box place = eda_box_grown((eda_box){x, y, x, y}, half);
    if (fault->rule != EDA_RULE_EDGE) continue;
    eda_finder f = eda_index_find(sites.index, eda_box_grown(place, far));
    for (uint32_t k; eda_index_next(&f, &k);)
      shapes_extend(r, p, &r->repairs[k], layer, place, fault);
  }
  places_clear(&sites);
}

/* Repair widths and spaces of the mask. Discard smoothings at the violations.
   If two repair shapes are too close to each other, reduce each by half of the
   missing space. */
static void mask_repair(drc *r, const eda_printed *p, size_t layer,
                        const mrc_faults *found) {
  int32_t near = (int32_t)ceil(r->min_space / r->grid);
  const eda_rule_fault *fault = found->fault;
  for (size_t i = 0; i < found->n; i++) {
    double value = fault[i].value;
    int32_t x = (int32_t)lround(fault[i].x / r->grid);
    int32_t y = (int32_t)lround(fault[i].y / r->grid);
    site place = {.box = {x, y, x, y}, .layer = (uint16_t)layer};
    int32_t step = (int32_t)ceil((r->min_space - value) / 2 / r->grid);
    if (fault[i].rule == EDA_RULE_EDGE) continue;
    if (r->round < tuned.smooth_until)
      smooth_drop(r, layer,
                  eda_box_grown(place.box, (int32_t)ceil(value / r->grid)));
    if (fault[i].rule == EDA_RULE_SPACE)
      shapes_reduce(r, p, &place, near, step, 1);
  }
}

void repairs_grow(drc *r, const eda_printed *p) {
  mrc_faults *faults = eda_alloc(r->layers, sizeof *faults);
  r->round++;
  for (size_t layer = 0; layer < r->layers; layer++)
    faults[layer].wanted = r->added[layer].count || r->cutouts[layer].count;
  mrc_find(r, p->shapes, r->min_edge, faults);
  for (size_t layer = 0; layer < r->layers; layer++) {
    mask_repair(r, p, layer, &faults[layer]);
    edges_repair(r, p, layer, &faults[layer]);
    free(faults[layer].fault);
  }
  free(faults);
  for (size_t i = 0; i < r->n_sites; i++)
    if (r->sites[i].failing && !site_wants(&r->sites[i]))
      site_clear(r, p, &r->sites[i]);
  for (size_t i = 0; i < r->n_repairs; i++) {
    const site *s = &r->sites[r->repairs[i].site];
    if (!s->failing ||
        (s->kind == SITE_LINE && s->layer == EDA_POLY && trims_revert(r, s)))
      continue;
    repair_grow(r, s, &r->repairs[i]);
  }
}

void repairs_add_shapes(drc *r, const eda_printed *p) {
  for (size_t i = 0; i < r->n_repairs; i++) {
    const repair *one = &r->repairs[i];
    for (int k = 0; k < SIDES; k++) {
      eda_box b = repair_shape(r, p, one, k);
      /* Skip a shape whose ends have passed each other. */
      if (one->grow[k] && b.x0 < b.x1 && b.y0 < b.y1)
        eda_box_list_add(&r->added[r->sites[one->site].layer], b);
    }
  }
}

/* ---- report ---- */

enum { UNDONE, NEIGHBOUR, GROWTH, REASONS };

static const char *const enclosure[REASONS] = {
    "enclosure: could still move", "enclosure; too near a neighbour",
    "enclosure; max_growth reached"};
static const char *const pinching[REASONS] = {"pinching: could still move",
                                              "pinching; too near a neighbour",
                                              "pinching; max_growth reached"};

static int repair_reason(const drc *r, const repair *one, int side) {
  int32_t most = (int32_t)floor(r->max_growth / r->grid + 1e-9);
  if (one->grow[side] < one->limit[side]) return UNDONE;
  return one->limit[side] < most ? NEIGHBOUR : GROWTH;
}

static void report_enclosure(const drc *r, const site *s, eda_violation v,
                             violations *out) {
  const repair *one = &r->repairs[s->repair];
  int worst = -1;
  for (int k = 0; k < SIDES; k++)
    if (s->failing & 1 << k && (worst < 0 || one->value[k] < one->value[worst]))
      worst = k;
  int flank = side_upright(worst) ? BELOW : LEFT;
  int reverted = one->grow[flank] < one->limit[flank] ||
                 one->grow[flank + 1] < one->limit[flank + 1];
  v.rule = enclosure[reverted ? UNDONE : repair_reason(r, one, worst)];
  v.value = one->value[worst];
  v.limit = r->overlay;
  violations_add(out, v);
}

static void report_line(const drc *r, const site *s, eda_violation v,
                        violations *out) {
  const repair *one = &r->repairs[s->repair];
  int low = s->sides & 1 << LEFT ? LEFT : BELOW;
  double box = (double)s->box.x1 - s->box.x0 + ((double)s->box.y1 - s->box.y0);
  double width = box * r->grid + one->value[low] + one->value[low + 1];
  /* A line that prints wide enough but displaced from the drawn centre is no
     violation. */
  if (width >= r->min_width) return;
  v.value = fmax(0, width);
  v.limit = r->min_width;
  int a = repair_reason(r, one, low), b = repair_reason(r, one, low + 1);
  v.rule = pinching[a == UNDONE || b == UNDONE   ? UNDONE
                    : a == GROWTH && b == GROWTH ? GROWTH
                                                 : NEIGHBOUR];
  violations_add(out, v);
}

static void report_bridging(const drc *r, const eda_printed *p, const site *s,
                            eda_violation v, violations *out) {
  v.rule = s->kind != SITE_GAP    ? "bridging: contact"
           : s->layer != EDA_POLY ? r->bridging[s->layer]
           : trims_can_deepen(r, s)
               ? "bridging: poly: could still move"
               : "bridging: poly; drawn too close to trim its edges";
  if (s->kind == SITE_CONTACT) {
    v.value = INFINITY;
    for (int k = 0; k < SIDES; k++)
      if (s->failing & 1 << k)
        v.value = fmin(v.value, site_contour(r, p, s, k));
    v.limit = r->overlay;
  }
  violations_add(out, v);
}

void repairs_report(const drc *r, const eda_printed *p, violations *out) {
  for (size_t i = 0; i < r->n_sites; i++) {
    const site *s = &r->sites[i];
    eda_violation v = {.gate = s->gate,
                       .x = ((double)s->box.x0 + s->box.x1) / 2 * r->grid,
                       .y = ((double)s->box.y0 + s->box.y1) / 2 * r->grid};
    if (!s->failing) continue;
    if (s->kind == SITE_ENCLOSURE)
      report_enclosure(r, s, v, out);
    else if (s->kind == SITE_LINE)
      report_line(r, s, v, out);
    else
      report_bridging(r, p, s, v, out);
  }
}
