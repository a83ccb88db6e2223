/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>

#include "../../process/window/window.h"
#include "image.h"

/* ---- gates ---- */

/* The gates whose middles lie in the window, along what the layer prints of
   them: poly the length, active the width. */
typedef struct cut_gates {
  opc_gates gates;
  window_cut *cuts;
} cut_gates;

static void release(const opc_host *host, cut_gates *c) {
  host->free(host, c->gates.box);
  host->free(host, c->gates.axis);
  host->free(host, c->gates.length);
  host->free(host, c->gates.room);
  host->free(host, c->cuts);
}

static int inside(const view *v, opc_box b) {
  double x = ((double)b.x0 + b.x1) / 2 * v->grid;
  double y = ((double)b.y0 + b.y1) / 2 * v->grid;
  return x >= v->x0 && x <= v->x1 && y >= v->y0 && y <= v->y1;
}

static int choose_gates(const image_run *r, cut_gates *out, opc_error *error) {
  const opc_host *host = r->view.host;
  const opc_gates *all = r->gates;
  opc_gates *g = &out->gates;
  *out = (cut_gates){.gates = {.size = sizeof *g, .grid = all->grid}};
  g->box = host->alloc(host, all->count + 1, sizeof *g->box);
  g->axis = host->alloc(host, all->count + 1, sizeof *g->axis);
  g->length = host->alloc(host, all->count + 1, sizeof *g->length);
  g->room = host->alloc(host, 2 * all->count + 1, sizeof *g->room);
  out->cuts = host->alloc(host, all->count + 1, sizeof *out->cuts);
  if (!g->box || !g->axis || !g->length || !g->room || !out->cuts)
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < all->count; i++) {
    if (!inside(&r->view, all->box[i])) continue;
    size_t k = g->count++;
    int poly = r->layer == OPC_POLY;
    g->box[k] = all->box[i];
    g->axis[k] = poly == (all->axis[i] == OPC_X) ? OPC_X : OPC_Y;
    g->length[k] = poly ? all->length[i] : all->width[i];
    for (size_t side = 0; side < 2; side++)
      g->room[2 * k + side] = poly ? all->room[2 * i + side] : INFINITY;
  }
  return OPC_OK;
}

static image_gates summarise(const cut_gates *c) {
  image_gates s = {0, 0, INFINITY, 0};
  size_t n = c->gates.count;
  for (size_t i = 0; i < n; i++) {
    window_cut cut = c->cuts[i];
    if (isnan(cut.length)) {
      s.failed++;
      continue;
    }
    s.cd += cut.length;
    s.ils += (cut.low + cut.high) / 2;
    s.nils = fmin(s.nils, c->gates.length[i] * fmin(cut.low, cut.high));
  }
  double printed = (double)n - (double)s.failed;
  if (printed == 0) return (image_gates){NAN, NAN, NAN, s.failed};
  s.cd /= printed;
  s.ils /= printed;
  return s;
}

static int measure_gates(image_run *r, opc_error *error) {
  cut_gates c;
  int code = choose_gates(r, &c, error);
  for (size_t k = 0; k < r->n && !code; k++) {
    image_model *m = &r->model[k];
    window_cuts(r->view.host, &c.gates, &m->print, &m->image, c.cuts);
    m->gates = summarise(&c);
  }
  release(r->view.host, &c);
  return code;
}

/* ---- table and metrics ---- */

static int table(const image_run *r, opc_error *error) {
  enum { NUMBERS = 10 };
  static const struct {
    const char *name, *unit;
    int32_t decimals;
  } heads[NUMBERS] = {{"rms", "nm", 3},
                      {"max", "nm", 3},
                      {"x", "nm", 1},
                      {"y", "nm", 1},
                      {"mean", "nm", 3},
                      {"intensity_low", NULL, 4},
                      {"intensity_high", NULL, 4},
                      {"cd", "nm", 3},
                      {"ils", "1/nm", 5},
                      {"nils", NULL, 3}};
  const char *label[IMAGE_MODELS];
  int64_t failed[IMAGE_MODELS];
  double number[NUMBERS][IMAGE_MODELS];
  for (size_t k = 0; k < r->n; k++) {
    const image_model *m = &r->model[k];
    image_distance d = m->distance;
    image_gates g = m->gates;
    const double row[NUMBERS] = {d.rms,  d.max,   d.x,  d.y,   d.mean,
                                 m->low, m->high, g.cd, g.ils, g.nils};
    for (size_t q = 0; q < NUMBERS; q++) number[q][k] = row[q];
    label[k] = m->label;
    failed[k] = g.failed;
  }
  opc_column columns[NUMBERS + 2] = {{"model", NULL, OPC_TEXT, 0, label}};
  for (size_t q = 0; q < NUMBERS; q++)
    columns[q + 1] = (opc_column){heads[q].name, heads[q].unit, OPC_REAL,
                                  heads[q].decimals, number[q]};
  columns[NUMBERS + 1] = (opc_column){"failed", NULL, OPC_INT, 0, failed};
  const opc_host *host = r->view.host;
  return host->table(host, "models", OPC_TABLE_PRINT, r->n, columns,
                     NUMBERS + 2, error);
}

int image_report(image_run *r, opc_error *error) {
  const opc_host *host = r->view.host;
  double rms = NAN, max = NAN;
  int code = measure_gates(r, error);
  if (!code) code = table(r, error);
  for (size_t k = 1; k < r->n; k++) {
    rms = fmax(rms, r->model[k].distance.rms); /* what is not NAN */
    max = fmax(max, r->model[k].distance.max);
  }
  if (!code && !isnan(rms)) code = host->metric(host, "rms", rms, error);
  if (!code && !isnan(max)) code = host->metric(host, "max", max, error);
  return code;
}
