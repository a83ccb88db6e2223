/* SPDX-License-Identifier: BSD-3-Clause */
#include "ends.h"

#include <math.h>
#include <stdlib.h>

/* nm. Line ends are made longer than they must be only where so much before them
   does not print: what moves later is not to join them. */
static const double ahead = 30, sought = 300;

/* How much further a line end prints for each nm that both of its flanks go out,
   against a nm that its tip does. */
static const double steep = 4;

/* Later the synthesizer would take the effect for that of its own moves. */
enum { WISHES_UNTIL = 3 };

void ends_clear(ends *e) {
  free(e->at);
  *e = (ends){0};
}

static int upright(int side) { return side == LEFT || side == RIGHT; }

/* ---- room ---- */

static int32_t steps(double room, double most, double grid) {
  return (int32_t)floor(fmax(0, fmin(most, room)) / grid + 1e-9);
}

/* How far it may go: half of what is free before it, as another line end may
   come from there; contacts that poly must not touch stay. */
static void find_length(line_end *e, const drawing *d, const limits *rules,
                        double grid) {
  int32_t range =
      (int32_t)ceil((2 * rules->max_growth + rules->min_space) / grid) + 1;
  /* From the next step on, without its own edge. */
  opc_box window = bins_window(e->tip, e->side, 1, range,
                               (int32_t)ceil(rules->min_space / grid));
  double own =
      bins_nearest(&d->edges[OPC_POLY], window, e->side, range - 1, NULL) + 1;
  double contact = bins_nearest(&d->contacts, window, e->side, range - 1, NULL) + 1;
  e->most = steps(fmin((own * grid - rules->min_space) / 2,
                       contact * grid - rules->min_space),
                  rules->max_growth, grid);
}

/* The head, as wide as it goes on each flank. */
static opc_box head_of(const line_end *e, int32_t by, int32_t wider) {
  opc_box b = bins_window(e->tip, e->side, -e->start, by, 0);
  if (upright(e->side)) b.y0 -= wider, b.y1 += wider;
  else b.x0 -= wider, b.x1 += wider;
  return b;
}

/* How wide its head may be: it begins clear of the active, and shares what is
   free beside it with what lies there. */
static void find_width(line_end *e, const drawing *d, const limits *rules,
                       double extension, double grid) {
  int32_t space = (int32_t)ceil(rules->min_space / grid);
  int32_t range = (int32_t)ceil((2 * rules->max_head + rules->min_space) / grid) + 1;
  e->start = (int32_t)floor((extension - 2 * rules->overlay) / grid);
  if (e->start * grid < rules->mask_width) return;
  opc_box line = head_of(e, e->most, 0);
  double room = rules->max_head;
  for (int k = 0; k < 2; k++) {
    int flank = upright(e->side) ? BELOW + k : LEFT + k;
    opc_box window = bins_window(line, flank, 1, range, space);
    double own = bins_nearest(&d->edges[OPC_POLY], window, flank, range, NULL) + 1;
    double other = bins_nearest(&d->contacts, window, flank, range, NULL) + 1;
    window = bins_window(line, flank, 1, range, 0);
    other = fmin(other, bins_nearest(&d->edges[OPC_ACTIVE], window, flank, range,
                                     NULL) + 1);
    room = fmin(room, fmin((own * grid - rules->min_space) / 2,
                           other * grid - rules->min_space));
  }
  e->widest = steps(room, rules->max_head, grid);
}

int ends_make(ends *e, const opc_gates *g, const drawing *d,
              const limits *rules) {
  const opc_edges *edges = &g->edges[OPC_POLY];
  e->n = 2 * g->count;
  e->at = calloc(e->n + 1, sizeof *e->at);
  if (!e->at) return 0;
  for (size_t i = 0; i < e->n; i++) {
    e->at[i].side = -1;
    e->at[i].most = steps(rules->max_growth, rules->max_growth, g->grid);
  }
  for (size_t p = 0; p < edges->polygons; p++)
    for (uint32_t i = edges->start[p]; i < edges->start[p + 1]; i++) {
      const opc_fragment *f = &edges->fragments[i];
      if (f->role != OPC_END_LOW && f->role != OPC_END_HIGH) continue;
      uint32_t next = i + 1 < edges->start[p + 1] ? i + 1 : edges->start[p];
      opc_point a = f->from, b = edges->fragments[next].from;
      int high = f->role == OPC_END_HIGH;
      line_end *one = &e->at[2 * (size_t)f->gate + (size_t)high];
      one->tip = (opc_box){a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y,
                           a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y};
      one->side = g->axis[f->gate] == OPC_Y ? (high ? RIGHT : LEFT)
                                            : (high ? ABOVE : BELOW);
      find_length(one, d, rules, g->grid);
      if (g->extension)
        find_width(one, d, rules, g->extension[2 * f->gate + high], g->grid);
    }
  return 1;
}

/* ---- moving ---- */

/* Whether nothing prints within `ahead` of the printed line end. */
static int is_clear(const opc_host *host, const opc_printed *p,
                    const line_end *e) {
  double grid = p->gates->grid, value;
  double x = (e->tip.x0 + e->tip.x1) / 2.0 * grid;
  double y = (e->tip.y0 + e->tip.y1) / 2.0 * grid;
  double *along = upright(e->side) ? &x : &y;
  double out = e->side == LEFT || e->side == BELOW ? -1 : 1;
  const opc_field *print = &p->print[OPC_POLY];
  *along -= out * e->start * grid;   /* where the line does print */
  for (double d = 0; d < sought; d += 5, *along += out * 5) {
    host->imaging->sample(print, &x, &y, 1, &value);
    if (value <= 0) break;
  }
  for (double d = 0; d < ahead; d += 5, *along += out * 5) {
    host->imaging->sample(print, &x, &y, 1, &value);
    if (value > 0) return 0;
  }
  return 1;
}

void ends_advance(ends *e, const opc_host *host, const opc_printed *p,
                  const limits *rules, size_t end, int32_t *bias) {
  line_end *one = &e->at[end];
  double grid = p->gates->grid, extension = p->extension[end];
  double wanted = rules->min_extension;
  int32_t before = *bias, wider = one->wider;
  if (extension >= wanted && extension < rules->want_extension &&
      p->iteration < WISHES_UNTIL && host && one->side >= 0 &&
      is_clear(host, p, one))
    wanted = rules->want_extension;
  if (extension < wanted) {
    int32_t to = rules_advance(&one->length, before, extension, wanted, 1, grid);
    if (to > one->most) to = one->most;
    if (to > before) {
      *bias = to;
    } else if (one->side >= 0) {
      to = rules_advance(&one->width, wider, extension, wanted, steep, grid);
      one->wider = to > one->widest ? one->widest : to;
    }
  } else {
    one->length = (response){before, extension, 1};
  }
  if (one->wider == wider) one->width = (response){wider, extension, 1};
  one->by = *bias;
}

int ends_back(ends *e, const opc_printed *p, const site *wrong,
              int32_t *bias) {
  const opc_gates *g = p->gates;
  opc_box b = g->box[wrong->gate];
  int across = g->axis[wrong->gate] == OPC_Y;
  int32_t at = across ? wrong->box.x0 : wrong->box.y0;
  int32_t low = across ? b.x0 : b.y0, high = across ? b.x1 : b.y1;
  int32_t step = (int32_t)ceil(rules_back / g->grid);
  if (at > low && at < high) return 0;
  size_t end = 2 * (size_t)wrong->gate + (at >= high);
  line_end *one = &e->at[end];
  if (one->wider > 0) {
    one->wider -= one->wider < step ? one->wider : step;
    one->widest = one->wider;
    return 1;
  }
  int32_t to = one->length.bias - step;
  if (one->length.bias <= 0) return 0;
  one->most = to > 0 ? to : 0;
  if (bias[end] > one->most) bias[end] = one->most;
  one->by = bias[end];
  return 1;
}

int ends_heads(const ends *e, box_list *out) {
  int good = 1;
  for (size_t i = 0; i < e->n && good; i++)
    if (e->at[i].wider)
      good = boxes_add(out, head_of(&e->at[i], e->at[i].by, e->at[i].wider));
  return good;
}

const char *ends_reason(const ends *e, const limits *rules, double grid,
                        size_t end) {
  const line_end *one = &e->at[end];
  if (one->by < one->most || one->wider < one->widest)
    return "extension: could still move";
  return one->most < steps(rules->max_growth, rules->max_growth, grid)
             ? "extension: no room before the line end"
             : "extension: max_growth reached";
}
