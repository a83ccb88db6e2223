/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulations from which the surrogate is fitted. A focus or a mask
   displacement of a layer requires an image; a dose or an overlay does not. The
   images of both layers are combined at random with each other, with doses and
   with overlays to points, at which the transistors are measured. Points for
   the fit are spread wider than the distribution; points that test the fit
   follow the distribution, on images of their own. */
#include <correct/fine.h>
#include <eda/check.h>
#include <eda/memory.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_qrng.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "variation.h"

/* Numbers of images of poly and of active: of the first fit, of each
   refinement, of the test of the fit, and the largest number of all. */
static const struct {
  size_t fit, more, test, most;
} plan[2] = {{20, 6, 6, 40}, {14, 3, 4, 30}};

/* Numbers of points of each image of poly, in the fit and in the test. The fit
   has about three points for each term of the surrogate. `spread`: standard
   deviation of the points of the fit, relative to that of the distribution. */
enum { POINTS_OF_IMAGE = 16, TESTS_OF_IMAGE = 8, LAYERS = 2 };
static const double spread = 1.7;

/* Steps of mask displacements per step of the mask grid. */
enum { FINER = 16 };

/* Largest share of the points of the fit at which a transistor may be open, %:
   the points are spread 1.7 times as wide as the conditions. */
static const double most_open = 5;

/* Range of the curves beyond the drawn lengths, and least length, nm. Beyond
   the range, the value at the end holds, so that the error of the surrogate
   would exceed its limit. */
static const double beyond = 30, least_length = 20;

/* Streams of random numbers, apart from those of the sampled chips. */
enum { STREAM_FIT = 1000, STREAM_TEST, STREAM_IMAGES };

typedef struct conditions {
  variation *v;
  eda_printer printer;
  eda_shapes shapes[LAYERS]; /* on the finer grid */
  image *active;             /* [plan.most], of fit and test */
  size_t actives;
  double (*point)[VARIABLES], (*test)[VARIABLES];
  float *value, *tested; /* of points and tests, as in surrogate_fit */
  float *currents;       /* of tests: ln over drawn, [(test * 2 + current) *
                            gates + gate] */
  eda_measurement measured;
  eda_field *print;
} conditions;

/* ---- images ---- */

static int shapes_finer(const eda_shapes *from, eda_shapes *to,
                        opc_error *error) {
  int code = eda_boolean(EDA_OR, from, NULL, to, error);
  for (size_t i = 0; !code && to->count && i < to->start[to->count]; i++) {
    to->points[i].x *= FINER;
    to->points[i].y *= FINER;
  }
  return code;
}

/* Simulate a layer at out->focus and out->mask, which is rounded to the finer
   grid. */
static int image_make(conditions *c, int layer, image *out, opc_error *error) {
  const variation *v = c->v;
  eda_printer *p = &c->printer;
  uint8_t *layers = eda_alloc(v->gates->layers, 1);
  eda_shapes *mask = eda_alloc(v->gates->layers, sizeof *mask);
  int32_t steps = (int32_t)lround(out->mask / p->grid);
  out->mask = steps * p->grid;
  p->defocus = out->focus;
  layers[layer] = 1;
  eda_field_clear(&p->image[layer]);
  p->is_fine[layer] = 0;
  int code = eda_shapes_grow(&c->shapes[layer], steps, &mask[layer], error);
  if (!code)
    code = p->fine > 0 ? eda_printer_refine(p, layers, mask, error)
                       : eda_printer_print(p, layers, mask, error);
  out->field = p->image[layer];
  p->image[layer] = (eda_field){0};
  eda_field_clear(&p->print[layer]);
  eda_shapes_clear(&mask[layer]);
  free(mask);
  free(layers);
  if (code || !opc_cancelled(v->host->context)) return code;
  return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
}

static double z_clamp(double z) {
  return fmax(-variation_range, fmin(variation_range, z));
}

/* Set the conditions of `n` images of a layer, in standard deviations: a
   space-filling sequence (Halton), mapped to a normal distribution. */
static void images_place(const variation *v, int layer, size_t skip,
                         double sigma, size_t n, image *out) {
  int focus = layer ? ACTIVE_FOCUS : POLY_FOCUS;
  gsl_qrng *q = gsl_qrng_alloc(gsl_qrng_halton, 2);
  double u[2];
  for (size_t i = 0; i < skip; i++) gsl_qrng_get(q, u);
  for (size_t i = 0; i < n; i++) {
    gsl_qrng_get(q, u);
    double z[2];
    for (int k = 0; k < 2; k++)
      z[k] = z_clamp(sigma * gsl_cdf_ugaussian_Pinv(u[k]));
    out[i] = (image){z[0] * v->sigma[focus],
                     z[1] * v->sigma[focus + 1],
                     {.coefficients = NULL}};
  }
  gsl_qrng_free(q);
}

/* ---- points ---- */

static int has_currents(const eda_performance *p, size_t i) {
  return p->ion[i] > 0 && p->ioff[i] > 0;
}

static int gate_fail(const variation *v, size_t i, double part,
                     opc_error *error) {
  const eda_gates *g = v->gates;
  return opc_fail(
      error, OPC_FAILED, NULL,
      "transistor %s:%u at (%g, %g) nm does not print at %.3g %% of "
      "the conditions of the fit (at most %g %% are allowed): "
      "reduce the standard deviations",
      eda_gates_owner(g, i), (unsigned)g->number[i],
      ((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid,
      ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid, part, most_open);
}

/* Check that each transistor prints at sufficiently many points. */
static int points_check(const conditions *c, opc_error *error) {
  const variation *v = c->v;
  size_t n = v->gates->count;
  for (size_t i = 0; i < n; i++) {
    size_t open = 0;
    for (size_t p = 0; p < v->points; p++)
      open += isnan(c->value[p * FIGURES * n + i]) != 0;
    double part = 100 * (double)open / (double)v->points;
    if (part > most_open) return gate_fail(v, i, part, error);
  }
  return OPC_OK;
}

/* Write the figures of a point and, unless `current` is NULL, the currents. */
static void figures_write(conditions *c, float *out, float *current) {
  variation *v = c->v;
  const eda_gates *g = v->gates;
  const eda_performance *p = &c->measured.performance, *d = &v->design;
  size_t n = g->count;
  for (size_t i = 0; i < n; i++) {
    double on = p->leq_ion[i], w = log(p->weq[i] / g->width[i]), off;
    if (!has_currents(p, i)) {
      for (size_t k = 0; k < FIGURES; k++) out[k * n + i] = NAN;
      if (current) current[ION * n + i] = current[IOFF * n + i] = NAN;
      v->open++;
      continue;
    }
    off = curves_length(&v->leakage, i, IOFF, log(p->ioff[i] / d->ioff[i]) - w);
    out[LENGTH * n + i] = (float)(on - g->length[i]);
    out[LENGTH_OFF * n + i] = (float)(off - g->length[i]);
    out[LOG_LENGTH * n + i] = (float)log(on / g->length[i]);
    out[WIDTH * n + i] = (float)w;
    out[AREA * n + i] = (float)log(p->area[i] / d->area[i]);
    if (current) current[ION * n + i] = (float)log(p->ion[i] / d->ion[i]);
    if (current) current[IOFF * n + i] = (float)log(p->ioff[i] / d->ioff[i]);
    v->failed += eda_print_failed(c->measured.flags[i]) != 0;
    v->outside += (c->measured.flags[i] & EDA_PRINT_OUTSIDE) != 0;
  }
}

/* Slices of all gates at the nominal condition. */
typedef struct nominal_slices {
  variation *v;
  size_t slices;
  double *width, *length; /* [gate * slices + slice] */
} nominal_slices;

static int nominal_visit(void *data, size_t first, const eda_slices *in,
                         opc_error *error) {
  const nominal_slices *n = data;
  variation *v = n->v;
  size_t bytes = in->count * in->slices * sizeof(double);
  memcpy(n->width + first * in->slices, in->width, bytes);
  memcpy(n->length + first * in->slices, in->length, bytes);
  const double *of[] = {NULL, v->gates->length};
  curves *to[] = {&v->curves, &v->leakage};
  int code = OPC_OK;
  for (int k = 0; k < 2 && !code; k++)
    code = curves_fill(to[k], v->host->context, v->with.extractor, first, in,
                       &v->design, v->gates->width, of[k], error);
  return code;
}

/* Measure the transistors at a point z. `visit`: receives the slices, or
   NULL. */
static int point_measure(conditions *c, const image *poly, const image *active,
                         const double z[VARIABLES], nominal_slices *visit,
                         opc_error *error) {
  variation *v = c->v;
  const image *of[LAYERS] = {poly, active};
  const double dose[LAYERS] = {z[POLY_DOSE], z[ACTIVE_DOSE]};
  int code = OPC_OK;
  for (int k = 0; k < LAYERS && !code; k++) {
    c->print[k] = eda_field_scaled(&of[k]->field, 1 + dose[k] / 100);
    code = eda_printer_develop(&c->printer, k, &c->print[k], error);
  }
  eda_field_shift(&c->print[EDA_ACTIVE], z[OVERLAY_X], z[OVERLAY_Y]);
  if (!code)
    code = eda_measure_slices(v->host->context, v->gates, c->print,
                              v->with.extractor, visit ? nominal_visit : NULL,
                              visit, &c->measured, error);
  for (int k = 0; k < LAYERS; k++) eda_field_clear(&c->print[k]);
  return code;
}

/* Measure `n` points of an image of poly, with images of active from `first` to
   first + count - 1. Write their variables, over the ends of the ranges, and
   their figures. */
static int points_of_image(conditions *c, const image *poly, size_t first,
                           size_t count, size_t n, uint32_t stream,
                           double sigma, size_t at, double (*u)[VARIABLES],
                           float *value, float *current, opc_error *error) {
  variation *v = c->v;
  size_t gates = v->gates->count;
  int code = OPC_OK;
  for (size_t k = 0; k < n && !code; k++) {
    double z[VARIABLES];
    const image *active = &c->active[first + (at + k) % count];
    for (int i = 0; i < VARIABLES; i++)
      z[i] = v->sigma[i] *
             z_clamp(sigma * normal_at(0, stream, at + k, (uint32_t)i));
    z[POLY_FOCUS] = poly->focus;
    z[POLY_MASK] = poly->mask;
    z[ACTIVE_FOCUS] = active->focus;
    z[ACTIVE_MASK] = active->mask;
    for (int i = 0; i < VARIABLES; i++)
      u[at + k][i] =
          v->sigma[i] > 0 ? z[i] / (variation_range * v->sigma[i]) : 0;
    code = point_measure(c, poly, active, z, NULL, error);
    if (!code)
      figures_write(c, value + (at + k) * FIGURES * gates,
                    current ? current + (at + k) * CURRENTS * gates : NULL);
  }
  return code;
}

/* ---- the fit ---- */

static int active_images(conditions *c, size_t skip, double sigma, size_t n,
                         opc_error *error) {
  int code = OPC_OK;
  image *some = c->active + c->actives;
  images_place(c->v, EDA_ACTIVE, skip, sigma, n, some);
  for (size_t i = 0; i < n && !code; i++) {
    code = image_make(c, EDA_ACTIVE, &some[i], error);
    c->actives++;
  }
  return code;
}

typedef struct batch {
  size_t skip, images; /* of poly: position in the sequence, number */
  size_t first, count; /* images of active */
  size_t points;       /* of each image of poly */
  uint32_t stream;
  double sigma;
} batch;

static int batch_run(conditions *c, const batch *b, size_t *at,
                     double (*u)[VARIABLES], float *value, float *current,
                     opc_error *error) {
  variation *v = c->v;
  image *poly = eda_alloc(b->images, sizeof *poly);
  int code = OPC_OK;
  images_place(v, EDA_POLY, b->skip, b->sigma, b->images, poly);
  for (size_t i = 0; i < b->images && !code; i++) {
    opc_progress progress = {.done = (double)v->images[EDA_POLY]++,
                             .total = (double)plan[EDA_POLY].most,
                             .worst = NAN};
    v->host->progress(v->host, &progress);
    code = image_make(c, EDA_POLY, &poly[i], error);
    if (!code)
      code =
          points_of_image(c, &poly[i], b->first, b->count, b->points, b->stream,
                          b->sigma, *at, u, value, current, error);
    *at += b->points;
    eda_field_clear(&poly[i].field);
  }
  free(poly);
  return code;
}

/* Compute the effect of line edges and mismatch of a gate. */
static void rough_gate(void *data, size_t i) {
  const nominal_slices *n = ((void **)data)[0];
  const roughness_moments *m = ((void **)data)[1];
  const variation *v = n->v;
  roughness_of_gate(&v->rough, m, i, n->slices, n->width + i * n->slices,
                    n->length + i * n->slices, v->effect + i * KNOTS);
  mismatch_add(&v->mismatch, v->gates->length[i] * v->gates->width[i],
               v->effect + i * KNOTS);
}

/* Measure the nominal condition: curves, nominal lengths, and the effect of
   line edges. */
static int measure_nominal(conditions *c, opc_error *error) {
  static const double nominal[VARIABLES] = {0};
  variation *v = c->v;
  const eda_extractor *model = v->with.extractor->functions;
  size_t gates = v->gates->count;
  const double *place, *part;
  image images[LAYERS] = {{0}};
  nominal_slices n = {.v = v};
  double low = INFINITY, high = 0;
  n.slices = model->slicing(v->with.extractor->self, &place, &part);
  n.width = eda_alloc(2 * gates * n.slices, sizeof *n.width);
  n.length = n.width + gates * n.slices;
  for (size_t i = 0; i < gates; i++) {
    low = fmin(low, fmax(least_length, v->gates->length[i] - beyond));
    high = fmax(high, v->gates->length[i] + beyond);
  }
  curves_init(&v->curves, gates, low, high);
  curves_init(&v->leakage, gates, low, high);
  int code = OPC_OK;
  for (int k = 0; k < LAYERS && !code; k++) {
    code = image_make(c, k, &images[k], error);
    v->images[k]++;
  }
  if (!code)
    code = point_measure(c, &images[0], &images[1], nominal, &n, error);
  for (int k = 0; k < LAYERS; k++) eda_field_clear(&images[k].field);
  if (!code) {
    roughness_moments m;
    void *both[] = {&n, &m};
    for (size_t i = 0; i < gates && !code; i++) {
      v->nominal[i] = c->measured.performance.leq_ion[i];
      if (!has_currents(&c->measured.performance, i))
        code = gate_fail(v, i, 100, error);
    }
    curves_share(&v->curves);
    curves_share(&v->leakage);
    roughness_moments_init(&m, &v->rough, &v->curves, v->host->context);
    opc_parallel(v->host->context, gates, rough_gate, both);
    roughness_moments_clear(&m);
  }
  free(n.width);
  return code;
}

/* ---- error ---- */

static void error_add(surrogate_error *e, int k, double d) {
  e->rms[k] += d * d;
  e->max[k] = fmax(e->max[k], fabs(d));
}

/* Compute the error of the surrogate at the points that were left out. */
static surrogate_error error_of(const conditions *c) {
  const variation *v = c->v;
  const surrogate *s = &v->surrogate;
  surrogate_error e = {{0}, {0}};
  size_t n = v->gates->count;
  double count = 0;
  double *features = eda_alloc(s->terms, sizeof *features);
  for (size_t p = 0; p < v->left_out; p++) {
    surrogate_features(s, c->test[p], features);
    const float *current = c->currents + p * CURRENTS * n;
    for (size_t i = 0; i < n; i++) {
      double x[FIGURES], off[FIGURES], log[CURRENTS];
      if (isnan(current[i])) continue;
      count++;
      for (int k = 0; k < FIGURES; k++) {
        size_t at = (p * FIGURES + (size_t)k) * n + i;
        x[k] = surrogate_at(s, features, k, i);
        off[k] = x[k] - (double)c->tested[at];
      }
      for (int q = 0; q < CURRENTS; q++)
        log[q] = x[WIDTH] - (double)current[(size_t)q * n + i] +
                 curves_at(q ? &v->leakage : &v->curves, i, q,
                           v->gates->length[i] + x[q ? LENGTH_OFF : LENGTH]);
      error_add(&e, ERROR_ION, 100 * log[ION]);
      error_add(&e, ERROR_IOFF, log[IOFF] * M_LOG10E);
      error_add(&e, ERROR_LENGTH, off[LENGTH]);
      error_add(&e, ERROR_WIDTH, 100 * off[WIDTH]);
      error_add(&e, ERROR_AREA, 100 * off[AREA]);
    }
  }
  for (int k = 0; k < ERRORS; k++) e.rms[k] = sqrt(e.rms[k] / count);
  free(features);
  return e;
}

static int error_is_small(const variation *v) {
  return v->error.rms[ERROR_ION] <= v->ion_error &&
         v->error.rms[ERROR_IOFF] <= v->ioff_error &&
         v->error.rms[ERROR_LENGTH] <= v->length_error;
}

static int conditions_respond(conditions *c, opc_error *error) {
  variation *v = c->v;
  size_t tests = plan[0].test, first = 0, last = plan[1].test, poly = 0;
  batch test = {1000, tests, 0, plan[1].test, TESTS_OF_IMAGE, STREAM_TEST, 1};
  batch fit = {20, plan[0].fit, 0, 0, POINTS_OF_IMAGE, STREAM_FIT, spread};
  int code = measure_nominal(c, error);
  if (!code) code = active_images(c, 1000, 1, plan[1].test, error);
  if (!code)
    code = batch_run(c, &test, &v->left_out, c->test, c->tested, c->currents,
                     error);
  size_t more = plan[1].fit;
  while (!code) {
    code = active_images(c, 20 + first, spread, more, error);
    first += more;
    fit.first = last;
    fit.count = first;
    fit.skip = 20 + poly;
    if (!code)
      code = batch_run(c, &fit, &v->points, c->point, c->value, NULL, error);
    if (!code) code = points_check(c, error);
    poly += fit.images;
    if (!code)
      code =
          surrogate_fit(&v->surrogate, v->host->context, v->points,
                        (const double(*)[VARIABLES])c->point, c->value, error);
    if (code) break;
    v->error = error_of(c);
    v->host->log(v->host, OPC_LOG_INFO,
                 "variation: %zu images of poly and %zu of active; error of "
                 "Ion %.3f %%, log10 Ioff %.4f, L %.3f nm",
                 v->images[EDA_POLY], c->actives + 1, v->error.rms[ERROR_ION],
                 v->error.rms[ERROR_IOFF], v->error.rms[ERROR_LENGTH]);
    if (error_is_small(v)) break;
    fit.images = plan[0].more;
    more = plan[1].more;
    if (v->images[EDA_POLY] + fit.images > plan[0].most)
      code = opc_fail(
          error, OPC_FAILED, NULL,
          "after %zu images of poly, the error of the surrogate is %.3g %% of "
          "Ion, %.3g of log10 Ioff and %.3g nm of L (limits 'ion_error' %g %%, "
          "'ioff_error' %g, 'length_error' %g nm): reduce the standard "
          "deviations, or accept a larger error",
          v->images[EDA_POLY], v->error.rms[ERROR_ION],
          v->error.rms[ERROR_IOFF], v->error.rms[ERROR_LENGTH], v->ion_error,
          v->ioff_error, v->length_error);
  }
  v->images[EDA_ACTIVE] = c->actives + 1;
  return code;
}

/* ---- set-up ---- */

static int conditions_prepare(conditions *c, opc_error *error) {
  variation *v = c->v;
  const opc_context *context = v->host->context;
  eda_printer *p = &c->printer;
  int code = eda_printer_prepare(p, error);
  if (!code) code = eda_extractor_prepare(context, v->with.extractor, error);
  if (!code)
    code = eda_measure_drawn(context, v->gates, v->with.extractor, &v->design,
                             error);
  if (!code)
    code = correct_fine_by_drawn(
        p, v->host, v->gates, v->with.extractor,
        correct_fine_change(v->with.fine_text, v->with.ion_limit), error);
  if (!code && !p->litho.functions.image_at &&
      (v->sigma[POLY_FOCUS] > 0 || v->sigma[ACTIVE_FOCUS] > 0))
    return opc_fail(error, OPC_INVALID, "focus",
                    "'%s' has one focus only: set 'focus: 0 nm'",
                    v->with.litho->id);
  p->grid /= FINER;
  for (int k = 0; k < LAYERS && !code; k++)
    code = shapes_finer(
        v->gates->corrected[k] ? &v->mask->shapes[k] : &v->gates->drawn[k],
        &c->shapes[k], error);
  return code;
}

int variation_respond(variation *v, opc_error *error) {
  size_t n = v->gates->count, points = plan[0].most * POINTS_OF_IMAGE;
  size_t tests = plan[0].test * TESTS_OF_IMAGE;
  int used[VARIABLES];
  conditions c = {.v = v};
  for (int i = 0; i < VARIABLES; i++) used[i] = v->sigma[i] > 0;
  surrogate_init(&v->surrogate, used, n);
  c.active = eda_alloc(plan[1].most, sizeof *c.active);
  c.print = eda_alloc(v->gates->layers, sizeof *c.print);
  c.point = eda_alloc(points, sizeof *c.point);
  c.test = eda_alloc(tests, sizeof *c.test);
  c.value = eda_alloc(points * FIGURES * n, sizeof *c.value);
  c.tested = eda_alloc(tests * FIGURES * n, sizeof *c.tested);
  c.currents = eda_alloc(tests * CURRENTS * n, sizeof *c.currents);
  v->effect = eda_alloc(n * KNOTS, sizeof *v->effect);
  v->nominal = eda_alloc(n, sizeof *v->nominal);
  eda_measurement_init(&c.measured, n);
  eda_performance_init(&v->design, n);
  eda_printer_init(&c.printer, v->host->context, v->gates, v->with.litho,
                   v->with.resist, v->with.margin);
  c.printer.fine = v->with.fine;
  c.printer.keeps = 1;
  int code = conditions_prepare(&c, error);
  if (!code) code = conditions_respond(&c, error);
  for (size_t i = 0; i < c.actives; i++) eda_field_clear(&c.active[i].field);
  for (int k = 0; k < LAYERS; k++) eda_shapes_clear(&c.shapes[k]);
  eda_printer_clear(&c.printer);
  eda_measurement_clear(&c.measured);
  free(c.active);
  free(c.print);
  free(c.point);
  free(c.test);
  free(c.value);
  free(c.tested);
  free(c.currents);
  return code;
}
