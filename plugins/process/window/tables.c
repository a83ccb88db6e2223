/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes the tables and metrics of process.window. */
#include <eda/memory.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>

#include "window.h"

/* ---- lengths ---- */

window_summary window_summarise(const window *w, const window_print *p) {
  window_summary s = {0, INFINITY, -INFINITY, INFINITY, 0};
  size_t n = w->gates->count;
  double good = 0;
  for (size_t i = 0; i < n; i++) {
    eda_section c = p->cuts[i];
    double drawn = w->gates->length[i];
    double count = window_count(w, i);
    if (isnan(c.length)) {
      s.failed += count;
      continue;
    }
    good += count;
    s.mean += count * (c.length - drawn);
    s.min = fmin(s.min, c.length - drawn);
    s.max = fmax(s.max, c.length - drawn);
    s.nils = fmin(s.nils, drawn * fmin(c.low, c.high));
  }
  if (good == 0) return (window_summary){NAN, NAN, NAN, NAN, s.failed};
  s.mean /= good;
  return s;
}

static int window_table(const window *w, opc_error *error) {
  typedef struct row {
    double defocus, dose;
    window_summary s;
    int64_t failed;
  } row;
  size_t prints = w->focus.count * w->dose.count;
  row *rows = eda_alloc(prints, sizeof *rows);
  for (size_t k = 0; k < prints; k++) {
    size_t f = k / w->dose.count, d = k % w->dose.count;
    window_summary s = window_summarise(w, &w->print[k]);
    rows[k] =
        (row){w->focus.values[f], w->dose.values[d], s, (int64_t)s.failed};
  }
  const opc_column columns[] = {{"defocus", "nm", OPC_REAL, -1, &rows->defocus},
                                {"dose", "%", OPC_REAL, -1, &rows->dose},
                                {"mean", "nm", OPC_REAL, 2, &rows->s.mean},
                                {"min", "nm", OPC_REAL, 2, &rows->s.min},
                                {"max", "nm", OPC_REAL, 2, &rows->s.max},
                                {"nils", NULL, OPC_REAL, 3, &rows->s.nils},
                                {"failed", NULL, OPC_INT, 0, &rows->failed}};
  int code = opc_put_rows(w->host, "process_window", OPC_TABLE_PRINT, prints,
                          sizeof *rows, OPC_ARRAY(columns), error);
  free(rows);
  return code;
}

static double dose_latitude(const window *w, size_t focus) {
  return isnan(w->low[focus]) ? 0 : w->high[focus] - w->low[focus];
}

static int latitude_table(const window *w, opc_error *error) {
  double *range = eda_alloc(w->focus.count, sizeof *range);
  for (size_t f = 0; f < w->focus.count; f++) range[f] = dose_latitude(w, f);
  const opc_column columns[] = {
      {"defocus", "nm", OPC_REAL, -1, w->focus.values},
      {"lowest_dose", "%", OPC_REAL, 2, w->low},
      {"highest_dose", "%", OPC_REAL, 2, w->high},
      {"latitude", "%", OPC_REAL, 2, range}};
  int code = opc_put_table(w->host, "exposure_latitude", OPC_TABLE_PRINT,
                           w->focus.count, OPC_ARRAY(columns), error);
  free(range);
  return code;
}

static int cut_table(const window *w, opc_error *error) {
  typedef struct row {
    double x, y, defocus, dose, drawn;
    eda_section cut;
    double nils;
    int64_t count;
  } row;
  const eda_gates *g = w->gates;
  size_t n = w->focus.count * w->dose.count * g->count;
  row *rows = eda_alloc(n, sizeof *rows);
  for (size_t k = 0; k < n; k++) {
    size_t i = k % g->count, place = k / g->count;
    eda_section cut = w->print[place].cuts[i];
    rows[k] = (row){((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid,
                    ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid,
                    w->focus.values[place / w->dose.count],
                    w->dose.values[place % w->dose.count],
                    g->length[i],
                    cut,
                    g->length[i] * fmin(cut.low, cut.high),
                    (int64_t)window_count(w, i)};
  }
  const opc_column columns[] = {
      {"x", "nm", OPC_REAL, -1, &rows->x},
      {"y", "nm", OPC_REAL, -1, &rows->y},
      {"defocus", "nm", OPC_REAL, -1, &rows->defocus},
      {"dose", "%", OPC_REAL, -1, &rows->dose},
      {"drawn", "nm", OPC_REAL, -1, &rows->drawn},
      {"printed", "nm", OPC_REAL, 3, &rows->cut.length},
      {"ils_low", "1/nm", OPC_REAL, 6, &rows->cut.low},
      {"ils_high", "1/nm", OPC_REAL, 6, &rows->cut.high},
      {"nils", NULL, OPC_REAL, 4, &rows->nils},
      {"count", NULL, OPC_INT, 0, &rows->count}};
  size_t used = sizeof columns / sizeof *columns - !w->count;
  int code = opc_put_rows(w->host, "cut_lines", 0, n, sizeof *rows, columns,
                          used, error);
  free(rows);
  return code;
}

/* ---- currents ---- */

typedef struct performance_row {
  double a, b; /* condition: defocus and dose, mask error and length, or overlay
                  in x and y */
  eda_spread p;
  int64_t failed, outside;
} performance_row;

static performance_row row_of(const window_print *print, double a, double b) {
  const eda_spread *p = &print->spread;
  return (performance_row){a, b, *p, (int64_t)p->failed, (int64_t)p->outside};
}

static int put_performance(const window *w, const char *name, opc_column a,
                           opc_column b, const performance_row *r, size_t n,
                           opc_error *error) {
  const opc_column all[] = {
      a,
      b,
      {"ion_n", "%", OPC_REAL, 3, &r->p.ion_mean[EDA_NMOS]},
      {"ion_p", "%", OPC_REAL, 3, &r->p.ion_mean[EDA_PMOS]},
      {"sd_n", "%", OPC_REAL, 3, &r->p.ion_sd[EDA_NMOS]},
      {"sd_p", "%", OPC_REAL, 3, &r->p.ion_sd[EDA_PMOS]},
      {"ion_worst", "%", OPC_REAL, 3, &r->p.ion_worst},
      {"leakage_n", NULL, OPC_REAL, 4, &r->p.leakage[EDA_NMOS]},
      {"leakage_p", NULL, OPC_REAL, 4, &r->p.leakage[EDA_PMOS]},
      {"leakage", NULL, OPC_REAL, 4, &r->p.leakage[2]},
      {"failed", NULL, OPC_INT, 0, &r->failed},
      {"outside", NULL, OPC_INT, 0, &r->outside}};
  return opc_put_rows(w->host, name, OPC_TABLE_PRINT, n, sizeof *r,
                      OPC_ARRAY(all), error);
}

static int performance_table(const window *w, opc_error *error) {
  size_t n = w->focus.count * w->dose.count;
  performance_row *r = eda_alloc(n, sizeof *r);
  for (size_t k = 0; k < n; k++)
    r[k] = row_of(&w->print[k], w->focus.values[k / w->dose.count],
                  w->dose.values[k % w->dose.count]);
  int code = put_performance(w, "performance_window",
                             (opc_column){"defocus", "nm", OPC_REAL, -1, &r->a},
                             (opc_column){"dose", "%", OPC_REAL, -1, &r->b}, r,
                             n, error);
  free(r);
  return code;
}

static int mask_error_table(const window *w, opc_error *error) {
  size_t n = w->mask_error.count;
  performance_row *r = eda_alloc(n, sizeof *r);
  for (size_t k = 0; k < n; k++) {
    double length = window_summarise(w, &w->wrong[k]).mean;
    r[k] = row_of(&w->wrong[k], w->mask_error.values[k], length);
  }
  const opc_column error_column = {"mask_error", "nm", OPC_REAL, -1, &r->a};
  const opc_column length = {"mean", "nm", OPC_REAL, 3, &r->b};
  const opc_column few[] = {error_column, length};
  int code = w->extractor ? put_performance(w, "mask_error", error_column,
                                            length, r, n, error)
                          : opc_put_rows(w->host, "mask_error", OPC_TABLE_PRINT,
                                         n, sizeof *r, OPC_ARRAY(few), error);
  free(r);
  return code;
}

static int overlays(const window *w, opc_error *error) {
  size_t n = window_overlays(w);
  double worst = 0, leakage = 0;
  performance_row *r = eda_alloc(n, sizeof *r);
  for (size_t k = 0; k < n; k++) {
    window_overlay at = window_overlay_at(w, k);
    r[k] = row_of(&w->shifted[k], at.x, at.y);
    worst = fmax(worst, fabs(r[k].p.ion_worst));
    leakage = fmax(leakage, r[k].p.leakage[2]);
  }
  int code = put_performance(
      w, "overlay", (opc_column){"overlay_x", "nm", OPC_REAL, -1, &r->a},
      (opc_column){"overlay_y", "nm", OPC_REAL, -1, &r->b}, r, n, error);
  free(r);
  const opc_metric_value values[] = {{"overlay_ion_worst", worst},
                                     {"overlay_leakage_max", leakage}};
  return code ? code : opc_put_metrics(w->host, OPC_ARRAY(values), error);
}

static int kept_table(const window *w, opc_error *error) {
  typedef struct row {
    double focus, ion, ioff, both;
  } row;
  size_t n = w->focus.count;
  row *r = eda_alloc(n, sizeof *r);
  for (size_t f = 0; f < n; f++)
    r[f] = (row){w->focus.values[f], window_kept_doses(w, WINDOW_ION, f),
                 window_kept_doses(w, WINDOW_IOFF, f),
                 window_kept_doses(w, WINDOW_BOTH, f)};
  const opc_column columns[] = {{"defocus", "nm", OPC_REAL, -1, &r->focus},
                                {"ion", "%", OPC_REAL, 2, &r->ion},
                                {"ioff", "%", OPC_REAL, 2, &r->ioff},
                                {"both", "%", OPC_REAL, 2, &r->both}};
  int code = opc_put_rows(w->host, "kept_doses", OPC_TABLE_PRINT, n, sizeof *r,
                          OPC_ARRAY(columns), error);
  free(r);
  return code;
}

/* Log the transistors whose slices are shorter than the device model covers, at
   the nominal condition. Return the largest number of such slices of all
   conditions. */
static double report_slices(const window *w) {
  double most = 0;
  for (size_t k = 0; k < w->focus.count * w->dose.count; k++)
    most = fmax(most, w->print[k].slices.below);
  const window_print *p = window_at(w, w->nominal_focus, w->nominal_dose);
  char text[400];
  eda_short_slices_text(&p->slices, text, sizeof text);
  if (*text) w->host->log(w->host, OPC_LOG_FINDING, "%s", text);
  return most;
}

static int publish_currents(const window *w, opc_error *error) {
  double sd = 0, worst = 0, leakage = 0, failed = 0, outside = 0;
  for (size_t k = 0; k < w->focus.count * w->dose.count; k++) {
    eda_spread p = w->print[k].spread;
    sd = fmax(sd, fmax(p.ion_sd[EDA_NMOS], p.ion_sd[EDA_PMOS]));
    worst = fmax(worst, fabs(p.ion_worst));
    leakage = fmax(leakage, p.leakage[2]);
    failed = fmax(failed, (double)p.failed);
    outside = fmax(outside, (double)p.outside);
  }
  int area = w->focus.count > 1 && w->dose.count > 1;
  const opc_metric_value values[] = {
      {area ? "ion_window" : NULL, window_kept_area(w, WINDOW_ION)},
      {area ? "ioff_window" : NULL, window_kept_area(w, WINDOW_IOFF)},
      {area ? "both_window" : NULL, window_kept_area(w, WINDOW_BOTH)},
      {"ion_sd_max", sd},
      {"ion_worst", worst},
      {"leakage_max", leakage},
      {"transistors_failed_max", failed},
      {"outside_max", outside},
      {"short_slices_max", report_slices(w)}};
  int code = performance_table(w, error);
  if (!code && w->dose.count > 1) code = kept_table(w, error);
  return code ? code : opc_put_metrics(w->host, OPC_ARRAY(values), error);
}

static int mask_errors(const window *w, opc_error *error) {
  window_response r = window_respond(w);
  const opc_metric_value values[] = {
      {isnan(r.meef_mean) ? NULL : "meef_mean", r.meef_mean},
      {isnan(r.meef_max) ? NULL : "meef_max", r.meef_max},
      {isnan(r.ion_mean) ? NULL : "ion_per_nm_mean", r.ion_mean},
      {isnan(r.ion_max) ? NULL : "ion_per_nm_max", r.ion_max}};
  int code = mask_error_table(w, error);
  return code ? code : opc_put_metrics(w->host, OPC_ARRAY(values), error);
}

/* ---- all tables ---- */

int window_report(const window *w, opc_error *error) {
  size_t prints = w->focus.count * w->dose.count;
  double most = 0, nils = INFINITY, failed = 0;
  for (size_t f = 0; f < w->focus.count; f++)
    most = fmax(most, dose_latitude(w, f));
  for (size_t k = 0; k < prints; k++) {
    window_summary s = window_summarise(w, &w->print[k]);
    nils = fmin(nils, s.nils); /* ignores NAN */
    failed = fmax(failed, s.failed);
  }
  double depth = isnan(w->depth_low) ? 0 : w->depth_high - w->depth_low;
  int code = window_table(w, error);
  if (!code) code = latitude_table(w, error);
  if (!code && w->cut_lines) code = cut_table(w, error);
  const opc_metric_value values[] = {{"exposure_latitude", most},
                                     {"depth_of_focus", depth},
                                     {isfinite(nils) ? "nils_min" : NULL, nils},
                                     {"failed_max", failed}};
  if (!code) code = opc_put_metrics(w->host, OPC_ARRAY(values), error);
  if (!code && w->extractor) code = publish_currents(w, error);
  if (!code && w->mask_error.count) code = mask_errors(w, error);
  return code || !window_overlays(w) ? code : overlays(w, error);
}
