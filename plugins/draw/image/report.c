/* SPDX-License-Identifier: BSD-3-Clause */
/* The figures of draw.image: its gates, its table, its metrics. */
#include <eda/print.h>
#include <math.h>

#include "image.h"

/* ---- gates ---- */

static int in_window(const view *v, eda_box b) {
  double x = ((double)b.x0 + b.x1) / 2 * v->grid;
  double y = ((double)b.y0 + b.y1) / 2 * v->grid;
  return x >= v->x0 && x <= v->x1 && y >= v->y0 && y <= v->y1;
}

/* The gates whose middles lie in the window, along what the layer prints of
   them: poly the length, active the width. */
static image_gates measure_gates(const image_run *r, const image_model *m) {
  const eda_gates *g = r->gates;
  image_gates s = {0, 0, INFINITY, 0};
  double printed = 0;
  if (r->layer > EDA_ACTIVE) return (image_gates){NAN, NAN, NAN, 0};
  for (size_t i = 0; i < g->count; i++) {
    if (!in_window(&r->view, g->box[i])) continue;
    eda_section c = eda_gate_section(g, i, (int)r->layer, &m->print, &m->image);
    if (isnan(c.length)) {
      s.failed++;
      continue;
    }
    double drawn = r->layer == EDA_POLY ? g->length[i] : g->width[i];
    printed++;
    s.cd += c.length;
    s.ils += (c.low + c.high) / 2;
    s.nils = fmin(s.nils, drawn * fmin(c.low, c.high));
  }
  if (printed == 0) return (image_gates){NAN, NAN, NAN, s.failed};
  s.cd /= printed;
  s.ils /= printed;
  return s;
}

/* ---- table and metrics ---- */

static int table(const image_run *r, opc_error *error) {
  enum { NUMBERS = 10 };
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
  const opc_column columns[] = {
      {"model", NULL, OPC_TEXT, 0, label},
      {"rms", "nm", OPC_REAL, 3, number[0]},
      {"max", "nm", OPC_REAL, 3, number[1]},
      {"x", "nm", OPC_REAL, 1, number[2]},
      {"y", "nm", OPC_REAL, 1, number[3]},
      {"mean", "nm", OPC_REAL, 3, number[4]},
      {"intensity_low", NULL, OPC_REAL, 4, number[5]},
      {"intensity_high", NULL, OPC_REAL, 4, number[6]},
      {"cd", "nm", OPC_REAL, 3, number[7]},
      {"ils", "1/nm", OPC_REAL, 5, number[8]},
      {"nils", NULL, OPC_REAL, 3, number[9]},
      {"failed", NULL, OPC_INT, 0, failed}};
  return r->host->table(r->host, "models", OPC_TABLE_PRINT, r->n, columns,
                        sizeof columns / sizeof *columns, error);
}

int image_report(image_run *r, opc_error *error) {
  const opc_host *host = r->host;
  double rms = NAN, max = NAN;
  for (size_t k = 0; k < r->n; k++)
    r->model[k].gates = measure_gates(r, &r->model[k]);
  int code = table(r, error);
  for (size_t k = 1; k < r->n; k++) {
    rms = fmax(rms, r->model[k].distance.rms); /* what is not NAN */
    max = fmax(max, r->model[k].distance.max);
  }
  if (!code && !isnan(rms)) code = host->metric(host, "rms", rms, error);
  if (!code && !isnan(max)) code = host->metric(host, "max", max, error);
  return code;
}
