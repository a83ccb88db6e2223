/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements line ends: outward displacements, and widths of heads. */
#include <eda/memory.h>
#include <math.h>

#include "drc.h"
#include "tuning.h"

/* ---- limits ---- */

static int32_t grid_steps(double limit, double most, double grid) {
  return (int32_t)floor(fmax(0, fmin(most, limit)) / grid + 1e-9);
}

/* Compute the largest outward displacement of a line end. The line end may use
   the entire spacing to contacts, which do not move. The member `share` is
   half of the drawn spacing to poly, because a facing line end may move as far.
   The member `most` is the limit by contacts and max_growth. */
static void end_find_length(const drc *r, line_end *e) {
  double grid = r->grid;
  int32_t range = (int32_t)ceil((2 * r->max_growth + r->min_space) / grid) + 1;
  /* The window begins one step before the tip, to exclude the tip. */
  eda_box window =
      box_window(e->tip, e->side, 1, range, (int32_t)ceil(r->min_space / grid));
  double own =
      places_nearest(&r->edges[EDA_POLY], window, e->side, range - 1, NULL);
  double contact =
      places_nearest(&r->contacts, window, e->side, range - 1, NULL);
  e->most =
      grid_steps((contact + 1) * grid - r->min_space, r->max_growth, grid);
  e->share = e->limit =
      grid_steps(((own + 1) * grid - r->min_space) / 2, e->most * grid, grid);
}

/* Return the head's box: `by` beyond the tip and `wider` beyond each flank. */
static eda_box head_of(const line_end *e, int32_t by, int32_t wider) {
  eda_box b = box_window(e->tip, e->side, -e->start, by, 0);
  if (side_upright(e->side))
    b.y0 -= wider, b.y1 += wider;
  else
    b.x0 -= wider, b.x1 += wider;
  return b;
}

/* Compute the largest widening of the head. The head begins 2 overlays outside
   of the active and may use half of the spacing to poly. */
static void end_find_width(const drc *r, line_end *e, double most,
                           double extension) {
  double grid = r->grid, limit = most;
  int32_t space = (int32_t)ceil(r->min_space / grid);
  int32_t range = (int32_t)ceil((2 * most + r->min_space) / grid) + 1;
  e->requested = most;
  e->start = (int32_t)floor((extension - 2 * r->overlay) / grid);
  if (e->start * grid < r->min_mask_width) return;
  eda_box line = head_of(e, e->most, 0);
  for (int k = 0; k < 2; k++) {
    int flank = side_upright(e->side) ? BELOW + k : LEFT + k;
    eda_box window = box_window(line, flank, 1, range, space);
    double own =
        places_nearest(&r->edges[EDA_POLY], window, flank, range, NULL);
    double other = places_nearest(&r->contacts, window, flank, range, NULL);
    window = box_window(line, flank, 1, range, 0);
    other = fmin(other, places_nearest(&r->edges[EDA_ACTIVE], window, flank,
                                       range, NULL));
    limit = fmin(limit, fmin(((own + 1) * grid - r->min_space) / 2,
                             (other + 1) * grid - r->min_space));
  }
  e->widest = grid_steps(limit, most, grid);
}

void ends_find(drc *r) {
  const eda_gates *g = r->gates;
  const eda_edges *edges = &g->edges[EDA_POLY];
  r->ends = eda_alloc(2 * g->count, sizeof *r->ends);
  for (size_t i = 0; i < 2 * g->count; i++) {
    r->ends[i].side = -1;
    r->ends[i].most = r->ends[i].share = r->ends[i].limit =
        grid_steps(r->max_growth, r->max_growth, r->grid);
  }
  for (size_t p = 0; p < edges->polygons; p++)
    for (uint32_t i = edges->start[p]; i < edges->start[p + 1]; i++) {
      const eda_fragment *f = &edges->fragments[i];
      if (f->role != EDA_END_LOW && f->role != EDA_END_HIGH) continue;
      uint32_t next = i + 1 < edges->start[p + 1] ? i + 1 : edges->start[p];
      int high = f->role == EDA_END_HIGH;
      line_end *one = &r->ends[2 * (size_t)f->gate + (size_t)high];
      one->tip = box_between(f->from, edges->fragments[next].from);
      one->side = g->axis[f->gate] == EDA_Y ? (high ? RIGHT : LEFT)
                                            : (high ? ABOVE : BELOW);
      end_find_length(r, one);
      if (g->extension)
        end_find_width(r, one, r->max_head, g->extension[2 * f->gate + high]);
    }
}

/* ---- moves ---- */

/* Return 1 if nothing prints in front of the printed line end within
   tuned.ahead. */
static int end_is_clear(const eda_printed *p, const line_end *e) {
  double grid = p->gates->grid, value;
  double x = (e->tip.x0 + e->tip.x1) / 2.0 * grid;
  double y = (e->tip.y0 + e->tip.y1) / 2.0 * grid;
  double *along = side_upright(e->side) ? &x : &y;
  double out = e->side == LEFT || e->side == BELOW ? -1 : 1;
  const eda_field *print = &p->print[EDA_POLY];
  *along -= out * e->start * grid; /* start inside the printed line */
  for (double d = 0; d < tuned.reach; d += grid, *along += out * grid) {
    eda_field_sample(print, &x, &y, 1, &value);
    if (value <= 0) break;
  }
  for (double d = 0; d < tuned.ahead; d += grid, *along += out * grid) {
    eda_field_sample(print, &x, &y, 1, &value);
    if (value > 0) return 0;
  }
  return 1;
}

/* Return the largest displacement that neighbours permit at present. A facing
   line end may move in the same iteration. Therefore a line end within its
   share may use at most two thirds of the spacing, and a line end beyond its
   share one third. */
static int32_t outward_limit(drc *r, const eda_printed *p, const line_end *e,
                             int32_t bias) {
  int32_t share = e->share < e->most ? e->share : e->most;
  eda_box now = box_window(e->tip, e->side, bias, bias, 0);
  if (e->side < 0 || bias >= e->most) return e->most;
  int32_t left = mask_spacing(r, p, now, e->side, 3 * (e->most - bias));
  if (bias >= share) return bias + left / 3;
  left -= left / 3;
  return bias + left < share ? bias + left : share;
}

/* Return the target of the printed extension: the required extension, or the
   desired extension if the required extension is reached and nothing prints in
   front of the line end. A request of the synthesizer is valid in all
   iterations, because the synthesizer expects the effect of its own requests.
   */
static double wanted_extension(const drc *r, const eda_printed *p, size_t end) {
  const line_end *one = &r->ends[end];
  double extension = p->extension[end], desired = r->min_extension;
  if (p->iteration < tuned.extend_until) desired = r->want_extension;
  if (p->want_extension) desired = fmax(desired, p->want_extension[end]);
  int may = extension >= r->min_extension && extension < desired && p->print &&
            one->side >= 0 && end_is_clear(p, one);
  return may ? desired : r->min_extension;
}

void ends_advance(drc *r, const eda_printed *p, size_t end, int32_t *bias) {
  line_end *one = &r->ends[end];
  double extension = p->extension[end], wanted = wanted_extension(r, p, end);
  int32_t before = *bias, wider = one->wider;
  if (p->want_head && p->want_head[end] > one->requested && one->side >= 0 &&
      p->gates->extension)
    end_find_width(r, one, p->want_head[end], p->gates->extension[end]);
  if (extension < wanted) {
    int32_t to =
        rules_advance(&one->length, before, extension, wanted, 1, r->grid);
    one->limit = outward_limit(r, p, one, before);
    if (to > one->limit) to = one->limit;
    if (to > before) {
      *bias = to;
    } else if (one->side >= 0) {
      to = rules_advance(&one->width, wider, extension, wanted, tuned.steep,
                         r->grid);
      one->wider = to > one->widest ? one->widest : to;
    }
  } else {
    one->length = (response){before, extension, 1};
  }
  if (one->wider == wider) one->width = (response){wider, extension, 1};
  one->by = *bias;
}

int ends_revert(drc *r, const site *wrong, int32_t *bias) {
  const eda_gates *g = r->gates;
  eda_box b = g->box[wrong->gate];
  int across = g->axis[wrong->gate] == EDA_Y;
  int32_t at = across ? wrong->box.x0 : wrong->box.y0;
  int32_t low = across ? b.x0 : b.y0, high = across ? b.x1 : b.y1;
  int32_t step = (int32_t)ceil(tuned.back / g->grid);
  if (at > low && at < high) return 0;
  size_t end = 2 * (size_t)wrong->gate + (at >= high);
  line_end *one = &r->ends[end];
  if (one->wider > 0) {
    one->wider -= one->wider < step ? one->wider : step;
    one->widest = one->wider;
    one->requested = INFINITY;
    return 1;
  }
  int32_t to = one->length.bias > step ? one->length.bias - step : 0;
  if (one->length.bias <= 0) return 0;
  one->most = to + (one->length.bias - to) / 2;
  if (bias[end] > to) bias[end] = to;
  one->by = bias[end];
  return 1;
}

void ends_add_heads(drc *r) {
  for (size_t i = 0; i < 2 * r->gates->count; i++) {
    const line_end *e = &r->ends[i];
    if (e->wider)
      eda_box_list_add(&r->added[EDA_POLY], head_of(e, e->by, e->wider));
  }
}

const char *ends_reason(const drc *r, size_t end) {
  const line_end *one = &r->ends[end];
  if (one->by < one->limit || one->wider < one->widest)
    return "extension: could still move";
  return one->by < grid_steps(r->max_growth, r->max_growth, r->grid)
             ? "extension; no space before the line end"
             : "extension; max_growth reached";
}
