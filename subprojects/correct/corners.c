/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements simulations at corners of dose, focus, mask error and overlay, and
   the means over the corners for each transistor. A dose scales an existing
   image, and an overlay displaces an existing image; a focus or a mask error
   requires an image of its own. */
#include <correct/corners.h>

#include <eda/memory.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>
#include <string.h>

#include <correct/loop.h>

enum { MAX_CORNERS = 100 };

/* Return the normal density, without its constant factor, for a sigma of
   1 / sqrt(3). The weights of [-1, 0, 1] are 0.15, 0.69, 0.15, close to 1/6,
   2/3, 1/6 of Gauss-Hermite quadrature with three nodes. */
static double normal_density(double x) { return exp(-1.5 * x * x); }

/* ---- the list of corners ---- */

static const opc_reals nominal_only = {(const double[]){0}, 1};

static opc_reals list_or_nominal(opc_reals given) {
  return given.count ? given : nominal_only;
}

size_t correct_corners_count(const corners_request *w) {
  if (!w->dose.count && !w->focus.count && !w->mask_error.count &&
      !w->overlay_x.count && !w->overlay_y.count)
    return 0;
  return list_or_nominal(w->dose).count * correct_corners_images(w) *
         list_or_nominal(w->overlay_x).count *
         list_or_nominal(w->overlay_y).count;
}

size_t correct_corners_images(const corners_request *w) {
  return list_or_nominal(w->focus).count * list_or_nominal(w->mask_error).count;
}

static double share_of(opc_reals values, size_t i) {
  double most = 0;
  for (size_t k = 0; k < values.count; k++)
    most = fmax(most, fabs(values.values[k]));
  return most > 0 ? normal_density(values.values[i] / most) : 1;
}

static int check_list(const char *name, opc_reals values, double above,
                      opc_error *error) {
  for (size_t i = 0; i < values.count; i++) {
    double v = values.values[i];
    if (!isfinite(v) || v <= above || v > 1e6)
      return opc_fail(error, OPC_INVALID, name,
                      "'%s' is %g, expected a value above %g, at most 1e6",
                      name, v, above);
    for (size_t k = 0; k < i; k++)
      if (values.values[k] == v)
        return opc_fail(error, OPC_INVALID, name, "'%s' contains %g twice",
                        name, v);
  }
  return OPC_OK;
}

int correct_corners_check(const corners_request *w, opc_error *error) {
  size_t n = correct_corners_count(w);
  double sum = 0;
  if (check_list("corners.dose", w->dose, -100, error) ||
      check_list("corners.focus", w->focus, -1e6, error) ||
      check_list("corners.mask", w->mask_error, -1e3, error) ||
      check_list("corners.overlay_x", w->overlay_x, -1e3, error) ||
      check_list("corners.overlay_y", w->overlay_y, -1e3, error))
    return error->code;
  if (n > MAX_CORNERS)
    return opc_fail(error, OPC_INVALID, "corners.dose",
                    "%zu corners (expected at most %d)", n, MAX_CORNERS);
  if (!w->weight.count) return OPC_OK;
  if (w->weight.count != n)
    return opc_fail(error, OPC_INVALID, "corners.weight",
                    "%zu weights for %zu corners, expected equal numbers",
                    w->weight.count, n);
  for (size_t i = 0; i < n; i++) {
    double v = w->weight.values[i];
    if (!(v >= 0) || v > 1e6)
      return opc_fail(error, OPC_INVALID, "corners.weight",
                      "weight %g, expected a finite number of at least 0", v);
    sum += v;
  }
  if (sum > 0) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "corners.weight", "all weights are 0");
}

static void list_corners(corners *c) {
  opc_reals dose = list_or_nominal(c->request.dose),
            focus = list_or_nominal(c->request.focus),
            mask = list_or_nominal(c->request.mask_error),
            x = list_or_nominal(c->request.overlay_x),
            y = list_or_nominal(c->request.overlay_y);
  double sum = 0;
  for (size_t k = 0; k < c->count; k++) {
    size_t d = k % dose.count, e = k / dose.count % c->exposures;
    size_t f = e % focus.count, m = e / focus.count;
    size_t o = k / dose.count / c->exposures, i = o % x.count, j = o / x.count;
    corner *one = &c->corner[k];
    one->dose = dose.values[d];
    one->focus = focus.values[f];
    one->mask_error = mask.values[m];
    one->overlay_x = x.values[i];
    one->overlay_y = y.values[j];
    one->exposure = e;
    one->weight = c->request.weight.count
                      ? c->request.weight.values[k]
                      : share_of(dose, d) * share_of(focus, f) *
                            share_of(mask, m) * share_of(x, i) * share_of(y, j);
    sum += one->weight;
  }
  for (size_t k = 0; k < c->count; k++) c->corner[k].weight /= sum;
}

/* ---- exposures ---- */

static int begin_exposure(loop *l, exposure *e, const corner *first,
                          opc_error *error) {
  double grid = l->gates->grid, steps = first->mask_error / grid;
  if (fabs(steps - round(steps)) > 1e-6)
    return opc_fail(error, OPC_INVALID, "corners.mask",
                    "%g nm is no multiple of the mask grid of %g nm",
                    first->mask_error, grid);
  if (first->focus != 0 && !l->printer.litho.functions.image_at)
    return opc_fail(error, OPC_INVALID, "corners.focus",
                    "'%s' has one focus only: remove 'corners.focus'",
                    l->printer.litho.litho->id);
  e->by = (int32_t)lround(steps);
  e->printer = &l->printer;
  if (first->focus == 0 && e->by == 0) return OPC_OK;
  e->printer = &e->own;
  eda_printer_init(&e->own, l->host->context, l->gates, l->printer.litho.litho,
                   l->printer.resist, 0);
  e->own.frame = l->printer.frame;
  e->own.fine = l->printer.fine;
  e->own.defocus = first->focus;
  e->own.keeps = 1;
  if (e->by) e->mask = eda_alloc(l->gates->layers, sizeof *e->mask);
  return OPC_OK;
}

int correct_corners_begin(loop *l, opc_error *error) {
  corners *c = &l->corners;
  size_t n = l->gates->count;
  int code = OPC_OK;
  c->count = correct_corners_count(&c->request);
  if (!c->count) return OPC_OK;
  if (!n)
    return opc_fail(error, OPC_INVALID, "corners.dose",
                    "corners require transistors, found none");
  c->exposures = correct_corners_images(&c->request);
  c->corner = eda_alloc(c->count, sizeof *c->corner);
  c->exposure = eda_alloc(c->exposures, sizeof *c->exposure);
  l->printer.keeps = 1;
  list_corners(c);
  eda_performance_init(&c->nominal, n);
  if (c->request.overlay_x.count || c->request.overlay_y.count)
    c->extension = eda_alloc(2 * n, sizeof *c->extension);
  for (size_t k = 0; k < c->count; k++)
    eda_measurement_init(&c->corner[k].measured, n);
  for (size_t e = 0; e < c->exposures && !code; e++)
    code = begin_exposure(
        l, &c->exposure[e],
        &c->corner[e * list_or_nominal(c->request.dose).count], error);
  return code;
}

void correct_corners_clear(loop *l) {
  corners *c = &l->corners;
  for (size_t e = 0; e < c->exposures; e++) {
    exposure *one = &c->exposure[e];
    for (size_t k = 0; one->mask && k < l->gates->layers; k++)
      eda_shapes_clear(&one->mask[k]);
    free(one->mask);
    if (one->printer == &one->own) eda_printer_clear(&one->own);
  }
  for (size_t k = 0; k < c->count; k++)
    eda_measurement_clear(&c->corner[k].measured);
  free(c->corner);
  free(c->exposure);
  free(c->extension);
  eda_performance_clear(&c->nominal);
}

static int move_edges(loop *l, exposure *e, const uint8_t *layers,
                      opc_error *error) {
  int code = OPC_OK;
  for (size_t k = 0; e->mask && k < l->gates->layers && !code; k++) {
    if (!layers[k]) continue;
    eda_shapes_clear(&e->mask[k]);
    code = eda_shapes_grow(&l->mask[k], e->by, &e->mask[k], error);
  }
  return code;
}

int correct_corners_print(loop *l, const uint8_t *layers, opc_error *error) {
  int code = OPC_OK;
  for (size_t k = 0; k < l->corners.exposures && !code; k++) {
    exposure *e = &l->corners.exposure[k];
    if (e->printer == &l->printer) continue;
    code = move_edges(l, e, layers, error);
    if (!code)
      code = eda_printer_print(e->printer, layers, e->mask ? e->mask : l->mask,
                               error);
    l->printer.simulations += e->printer->simulations;
    e->printer->simulations = 0;
  }
  return code;
}

int correct_corners_refine(loop *l, const uint8_t *layers, opc_error *error) {
  int code = OPC_OK;
  for (size_t k = 0; k < l->corners.exposures && !code; k++) {
    exposure *e = &l->corners.exposure[k];
    if (e->printer == &l->printer) continue;
    memcpy(e->own.fine_of, l->printer.fine_of,
           l->gates->layers * sizeof *e->own.fine_of);
    code = eda_printer_refine(e->printer, layers, e->mask ? e->mask : l->mask,
                              error);
    l->printer.fine_simulations += e->printer->fine_simulations;
    e->printer->fine_simulations = 0;
  }
  return code;
}

/* ---- means over corners ---- */

static int is_good(const eda_measurement *m, size_t i) {
  return !eda_print_failed(m->flags[i]);
}

static int measure_corner(loop *l, corner *c, eda_field *print,
                          opc_error *error) {
  const eda_printer *printer = l->corners.exposure[c->exposure].printer;
  int code = OPC_OK;
  for (int k = 0; k <= EDA_ACTIVE && !code; k++)
    code = eda_printer_at_dose(printer, k, 1 + c->dose / 100, &print[k], error);
  if (!code) eda_field_shift(&print[EDA_ACTIVE], c->overlay_x, c->overlay_y);
  if (!code)
    code = eda_measure(l->host->context, l->gates, print, l->extractor,
                       &c->measured, error);
  for (int k = 0; k <= EDA_ACTIVE; k++) eda_field_clear(&print[k]);
  return code;
}

enum { ION, IOFF, LEQ_ION, LEQ_IOFF, WEQ, AREA, FIGURES };

static int is_ratio(size_t k) { return k == ION || k == IOFF || k == AREA; }

/* Return a figure, or the logarithm of a figure that is compared as a ratio. */
static double figure_of(const eda_performance *p, size_t k, size_t i) {
  double v = (&p->ion)[k][i];
  return is_ratio(k) ? log(v) : v;
}

/* Return the weighted mean of a figure over the corners at which the transistor
   prints, minus the nominal figure; 0 if the transistor prints at no corner.
   Both are logarithms for figures compared as ratios. */
static double pull_of(const corners *c, const eda_performance *nominal,
                      size_t k, size_t i) {
  double sum = 0, weight = 0;
  for (size_t j = 0; j < c->count; j++) {
    const corner *one = &c->corner[j];
    const eda_performance *p = &one->measured.performance;
    if (!is_good(&one->measured, i) || !((&p->ion)[k][i] > 0)) continue;
    sum += one->weight * figure_of(p, k, i);
    weight += one->weight;
  }
  double pull = sum / weight - figure_of(nominal, k, i);
  return isfinite(pull) ? pull : 0;
}

/* Subtract from the differences their mean over all transistors of a type,
   because a change of dose would have the same effect. Scale each remaining
   difference so that nominal Ion deviates by at most `ion_cost`. */
static void bound_pulls(const loop *l, double (*pull)[FIGURES]) {
  double sum[2][FIGURES] = {{0}}, count[2] = {0};
  double most = log1p(l->corners.request.ion_cost / 100);
  const uint8_t *type = l->gates->type;
  for (size_t i = 0; i < l->gates->count; i++) {
    if (!is_good(&l->measured, i)) continue;
    count[type[i]]++;
    for (size_t k = 0; k < FIGURES; k++) sum[type[i]][k] += pull[i][k];
  }
  for (size_t i = 0; i < l->gates->count; i++) {
    if (!is_good(&l->measured, i)) continue;
    for (size_t k = 0; k < FIGURES; k++)
      pull[i][k] -= sum[type[i]][k] / count[type[i]];
    double part = fmin(1, most / fabs(pull[i][ION]));
    for (size_t k = 0; k < FIGURES; k++) pull[i][k] *= part;
  }
}

/* Replace the measurement by the mean over the corners. A transistor that does
   not print at the nominal corner keeps its figures. */
static void corners_combine(loop *l) {
  const corners *c = &l->corners;
  eda_performance *out = &l->measured.performance;
  double(*pull)[FIGURES] = eda_alloc(l->gates->count, sizeof *pull);
  for (size_t i = 0; i < out->count; i++)
    for (size_t k = 0; k < FIGURES && is_good(&l->measured, i); k++)
      pull[i][k] = pull_of(c, &c->nominal, k, i);
  if (!c->request.free) bound_pulls(l, pull);
  for (size_t i = 0; i < out->count; i++)
    for (size_t k = 0; k < FIGURES && is_good(&l->measured, i); k++) {
      double *v = &(&out->ion)[k][i];
      *v = is_ratio(k) ? *v * exp(pull[i][k]) : *v + pull[i][k];
    }
  free(pull);
}

/* Set the smallest extension of each line end over the nominal condition and
   the overlays at nominal dose, focus and mask. */
static void corners_extend(loop *l) {
  corners *c = &l->corners;
  size_t n = 2 * l->gates->count;
  if (!c->extension) return;
  memcpy(c->extension, l->measured.extension, n * sizeof *c->extension);
  for (size_t k = 0; k < c->count; k++) {
    const corner *one = &c->corner[k];
    if (one->dose != 0 || one->focus != 0 || one->mask_error != 0) continue;
    for (size_t i = 0; i < n; i++)
      c->extension[i] = fmin(c->extension[i], one->measured.extension[i]);
  }
}

const double *correct_corners_extension(const loop *l) {
  return l->corners.extension ? l->corners.extension : l->measured.extension;
}

int correct_corners_measure(loop *l, opc_error *error) {
  corners *c = &l->corners;
  if (!c->count) return OPC_OK;
  eda_field *print = eda_alloc(l->gates->layers, sizeof *print);
  int code = OPC_OK;
  for (size_t k = 0; k < c->count && !code; k++)
    code = measure_corner(l, &c->corner[k], print, error);
  free(print);
  if (code) return code;
  eda_performance_copy(&c->nominal, &l->measured.performance);
  corners_combine(l);
  corners_extend(l);
  return OPC_OK;
}

/* ---- report ---- */

typedef struct row {
  double dose, focus, mask_error, overlay_x, overlay_y, weight;
  eda_spread s;
  int64_t failed, outside;
} row;

static row row_of(const loop *l, const corner *c) {
  eda_spread s = eda_spread_of(l->gates, &l->design, &c->measured.performance,
                               c->measured.flags);
  return (row){
      c->dose,   c->focus, c->mask_error,     c->overlay_x,      c->overlay_y,
      c->weight, s,        (int64_t)s.failed, (int64_t)s.outside};
}

static int put_rows(const loop *l, const row *r, opc_error *error) {
  const opc_column columns[] = {
      {"dose", "%", OPC_REAL, -1, &r->dose},
      {"focus", "nm", OPC_REAL, -1, &r->focus},
      {"mask", "nm", OPC_REAL, -1, &r->mask_error},
      {"overlay_x", "nm", OPC_REAL, -1, &r->overlay_x},
      {"overlay_y", "nm", OPC_REAL, -1, &r->overlay_y},
      {"weight", NULL, OPC_REAL, 4, &r->weight},
      {"ion_n", "%", OPC_REAL, 3, &r->s.ion_mean[EDA_NMOS]},
      {"ion_p", "%", OPC_REAL, 3, &r->s.ion_mean[EDA_PMOS]},
      {"sd_n", "%", OPC_REAL, 3, &r->s.ion_sd[EDA_NMOS]},
      {"sd_p", "%", OPC_REAL, 3, &r->s.ion_sd[EDA_PMOS]},
      {"ion_worst", "%", OPC_REAL, 3, &r->s.ion_worst},
      {"leakage_n", NULL, OPC_REAL, 4, &r->s.leakage[EDA_NMOS]},
      {"leakage_p", NULL, OPC_REAL, 4, &r->s.leakage[EDA_PMOS]},
      {"leakage", NULL, OPC_REAL, 4, &r->s.leakage[2]},
      {"failed", NULL, OPC_INT, 0, &r->failed},
      {"outside", NULL, OPC_INT, 0, &r->outside}};
  return opc_put_rows(l->host, "corners", OPC_TABLE_PRINT, l->corners.count,
                      sizeof *r, OPC_ARRAY(columns), error);
}

/* Write the table and metrics over all corners: weighted means and worst
   cases. */
static int put_all(const loop *l, const row *r, opc_error *error) {
  const corners *c = &l->corners;
  double mean = 0, sd = 0, worst = 0, leakage = 0, most = 0, failed = 0;
  for (size_t k = 0; k < c->count; k++) {
    const eda_spread *s = &r[k].s;
    mean += c->corner[k].weight * s->ion_mean[2];
    leakage += c->corner[k].weight * s->leakage[2];
    sd = fmax(sd, fmax(s->ion_sd[EDA_NMOS], s->ion_sd[EDA_PMOS]));
    worst = fmax(worst, fabs(s->ion_worst));
    most = fmax(most, s->leakage[2]);
  }
  for (size_t i = 0; i < l->gates->count; i++) {
    int bad = 0;
    for (size_t k = 0; k < c->count; k++)
      bad |= !is_good(&c->corner[k].measured, i);
    failed += bad;
  }
  int64_t transistors = (int64_t)failed;
  const opc_column columns[] = {{"ion_mean", "%", OPC_REAL, 3, &mean},
                                {"ion_sd_max", "%", OPC_REAL, 3, &sd},
                                {"ion_worst", "%", OPC_REAL, 3, &worst},
                                {"leakage_mean", NULL, OPC_REAL, 4, &leakage},
                                {"leakage_max", NULL, OPC_REAL, 4, &most},
                                {"failed", NULL, OPC_INT, 0, &transistors}};
  const opc_metric_value values[] = {{"corners_ion_sd", sd},
                                     {"corners_ion_worst", worst},
                                     {"corners_leakage", most},
                                     {"corners_failed", failed}};
  int code = opc_put_table(l->host, "all_corners", OPC_TABLE_PRINT, 1,
                           OPC_ARRAY(columns), error);
  return code ? code : opc_put_metrics(l->host, OPC_ARRAY(values), error);
}

/* Warn of transistors that do not print at a corner. Their means exclude that
   corner. */
static void corners_log_failed(const loop *l, const row *r) {
  size_t n = l->gates->count, at = 0;
  int64_t most = 0;
  for (size_t k = 0; k < l->corners.count; k++) {
    if (r[k].failed <= most) continue;
    most = r[k].failed;
    at = k;
  }
  if (most)
    l->host->log(
        l->host, OPC_LOG_WARNING,
        "corners: %d of %zu transistors do not print at %g %% dose, %g nm "
        "focus, %g nm mask, overlay (%g, %g) nm, and are ignored there: see "
        "corners.csv",
        (int)most, n, r[at].dose, r[at].focus, r[at].mask_error,
        r[at].overlay_x, r[at].overlay_y);
}

int correct_corners_report(const loop *l, opc_error *error) {
  const corners *c = &l->corners;
  if (!c->count) return OPC_OK;
  row *r = eda_alloc(c->count, sizeof *r);
  for (size_t k = 0; k < c->count; k++) r[k] = row_of(l, &c->corner[k]);
  corners_log_failed(l, r);
  int code = put_rows(l, r, error);
  if (!code) code = put_all(l, r, error);
  free(r);
  return code;
}
