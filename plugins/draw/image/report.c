/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the gate measurements, table and metrics of draw.image. */
#include <eda/print.h>
#include <math.h>
#include <opcflow/table.h>

#include "image.h"

/* ---- gates ---- */

/* Measure the gates whose centres are in the window: length in poly, width in
   active. */
static image_gates measure_gates(const image_run *r, const image_model *m) {
  const eda_gates *g = r->gates;
  image_gates s = {0, 0, INFINITY, 0};
  double printed = 0;
  if (r->layer > EDA_ACTIVE) return (image_gates){NAN, NAN, NAN, 0};
  for (size_t i = 0; i < g->count; i++) {
    double x = ((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid;
    double y = ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid;
    if (!view_contains(&r->view, x, y)) continue;
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

static int image_table(const image_run *r, opc_error *error) {
  const image_model *m = r->model;
  const opc_column columns[] = {{"model", NULL, OPC_TEXT, 0, &m->label},
                                {"rms", "nm", OPC_REAL, 3, &m->distance.rms},
                                {"max", "nm", OPC_REAL, 3, &m->distance.max},
                                {"x", "nm", OPC_REAL, 1, &m->distance.x},
                                {"y", "nm", OPC_REAL, 1, &m->distance.y},
                                {"mean", "nm", OPC_REAL, 3, &m->distance.mean},
                                {"intensity_low", NULL, OPC_REAL, 4, &m->low},
                                {"intensity_high", NULL, OPC_REAL, 4, &m->high},
                                {"cd", "nm", OPC_REAL, 3, &m->gates.cd},
                                {"ils", "1/nm", OPC_REAL, 5, &m->gates.ils},
                                {"nils", NULL, OPC_REAL, 3, &m->gates.nils},
                                {"failed", NULL, OPC_INT, 0, &m->gates.failed}};
  return opc_put_rows(r->host, "models", OPC_TABLE_PRINT, r->n, sizeof *m,
                      OPC_ARRAY(columns), error);
}

int image_report(image_run *r, opc_error *error) {
  double rms = NAN, max = NAN;
  for (size_t k = 0; k < r->n; k++)
    r->model[k].gates = measure_gates(r, &r->model[k]);
  for (size_t k = 1; k < r->n; k++) {
    rms = fmax(rms, r->model[k].distance.rms); /* fmax ignores NAN */
    max = fmax(max, r->model[k].distance.max);
  }
  const opc_metric_value values[] = {{isnan(rms) ? NULL : "rms", rms},
                                     {isnan(max) ? NULL : "max", max}};
  int code = image_table(r, error);
  return code ? code : opc_put_metrics(r->host, OPC_ARRAY(values), error);
}
