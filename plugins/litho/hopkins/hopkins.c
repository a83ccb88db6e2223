/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements litho.hopkins: partially coherent imaging by Hopkins' transmission
   cross coefficient T(f1, f2) (H. H. Hopkins, Proc. R. Soc. A 217, 1953), as a
   sum of coherent kernels (SOCS). The error on small patterns determines the
   number of kernels. */
#include <eda/litho.h>
#include <eda/memory.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

#include "cache.h"
#include "patterns.h"

/* ---- state ---- */

enum {
  CUTS = 256,
  /* Largest number of kernels that `error` selects; further kernels change
     images by 1e-5 only. The parameter `kernels` may be larger. */
  ALL = 600,
  /* Largest number of images of a listed source: points times images per point
     (vector_parts). Kernels of 300 images take 10 s; the time grows with the
     square of the number. */
  MOST_LISTED = 800
};

/* A truncation of the sum of kernels: the kernels that are used for one defocus
   and one requested error. */
typedef struct cut {
  double defocus; /* nm */
  double wanted;  /* requested error, relative to the clear field */
  int64_t fixed;  /* requested number of kernels; OPC_NO_INT: as many as the
                     error requires */
  double error;   /* measured error, relative to the clear field */
  kernels *kernels;
  cache_entry *entry; /* entry of the cache; NULL if the cut owns the kernels */
} cut;

typedef struct hopkins {
  const opc_host *host;
  optics optics;
  double wanted;
  int wanted_given;
  int64_t fixed;
  /* A truncation is added when an image needs it for the first time, the first
     one by `prepare`. Added elements of `cuts` do not change. The lock protects
     additions. */
  pthread_mutex_t lock;
  cut cuts[CUTS];
  size_t n_cuts;
} hopkins;

/* ---- work: images ---- */

static eda_scanner hopkins_scanner(const void *self) {
  return optics_scanner(&((const hopkins *)self)->optics);
}

static double hopkins_band(const void *self) {
  const hopkins *h = self;
  return (1 + optics_source_radius(&h->optics)) * h->optics.cutoff;
}

/* Return the grid spacing, nm: four samples per shortest period of the
   intensity, 32 nm at 193 nm, NA 0.75, and 44 nm at 248 nm, NA 0.7. At 193 nm,
   the interpolation between samples moves contours by 0.0015 nm. */
static double step_of(const hopkins *h) {
  return 32 * (0.75 / 193) / h->optics.cutoff;
}

/* Relative reduction of the intensity's band. At the end of the band, twice the
   cutoff, the spectrum of the intensity is 0, but that of truncated kernels is
   not. Without the reduction, rounding would decide whether a frequency at the
   end is included. The error would be large for a grating of the pitch
   wavelength / NA. */
static const double rim = 1e-9;

/* Compute the image of the mask of a layer, or of a binary mask. */
enum { BINARY = -1 };
static int hopkins_image_by(const hopkins *h, const kernels *k, int layer,
                            const eda_spectrum *mask, eda_field *out,
                            opc_error *error) {
  eda_kernels sum = {.count = k->count,
                     .weight = k->weight,
                     .band = k->radius * k->cutoff,
                     .intensity_band = 2 * (1 - rim) * k->cutoff,
                     .transfer = k->transfer,
                     .residuals = k->residuals,
                     .residual = k->filter,
                     .self = k,
                     .mirror = k->mirror};
  if (layer != BINARY)
    optics_amplitudes(&h->optics, layer, sum.offset, sum.scale);
  return eda_coherent_sum(h->host->context, mask, &sum, step_of(h), out, error);
}

/* ---- work: number of kernels ---- */

static double field_difference(const eda_field *a, const eda_field *b) {
  double worst = 0;
  size_t n = (size_t)a->nx * (size_t)a->ny;
  for (size_t i = 0; i < n; i++) {
    double d = fabs((double)a->coefficients[i] - b->coefficients[i]);
    if (isnan(d)) return d;
    worst = fmax(worst, d);
  }
  return worst;
}

/* Largest ratio of the error in layouts to the error in the patterns of
   patterns.h (README.md). */
static const double margin = 1.35;

/* Spectra and reference images of the patterns. A reference image without
   coefficients has not been computed yet. */
typedef struct trial {
  eda_spectrum mask[PATTERNS];
  eda_field whole[PATTERNS];
} trial;

static void trial_clear(trial *t) {
  for (int p = 0; p < PATTERNS; p++) {
    eda_field_clear(&t->whole[p]);
    eda_spectrum_clear(&t->mask[p]);
  }
}

/* Compute the spectra of the patterns. If T is not known in closed form, the
   sum of all kernels is the reference. */
static int trial_init(const hopkins *h, kernels *k, trial *t,
                      opc_error *error) {
  int code = OPC_OK;
  *t = (trial){0};
  if (!k->cross) k->keep(k, ALL);
  for (int p = 0; p < PATTERNS && !code; p++) {
    code = pattern_spectrum(k, p, &t->mask[p], error);
    if (!code && !k->cross)
      code = hopkins_image_by(h, k, BINARY, &t->mask[p], &t->whole[p], error);
  }
  return code;
}

/* Return 1 if no further kernels exist. The number may be one below the
   largest, because some kernels are added in pairs. */
static int kernels_are_all(const kernels *k) {
  return k->all || k->count + 1 >= ALL;
}

/* Measure the largest error of the kernels in use on the patterns. Stop at the
   first pattern whose error exceeds the requested error if more kernels can be
   added. */
static int cut_try(const hopkins *h, cut *c, trial *t, opc_error *error) {
  const kernels *k = c->kernels;
  int code = OPC_OK;
  c->error = 0;
  for (int p = 0; p < PATTERNS && !code; p++) {
    eda_field part = {0}, *whole = &t->whole[p];
    code = hopkins_image_by(h, k, BINARY, &t->mask[p], &part, error);
    if (!code && !whole->coefficients)
      pattern_image(k->context, k, &t->mask[p], &part, whole);
    double off = code ? 0 : margin * field_difference(whole, &part);
    if (!(off <= c->error)) c->error = off;
    eda_field_clear(&part);
    if (c->error > c->wanted && c->fixed < 0 && !kernels_are_all(k)) break;
  }
  return code;
}

/* Return the next number of kernels to try. The error decreases as 1 / number,
   or faster for small sources. The next number is therefore only 0.6 of the
   number estimated by this law. */
static size_t cut_more_kernels(const cut *c, size_t n) {
  double one = 2 + (double)n + (double)n / 6;
  double guess = 0.6 * (double)n * c->error / c->wanted;
  return (size_t)fmin(ALL, fmax(one, fmin(guess, 3 * (double)n)));
}

/* Choose approximately the smallest number of kernels whose images of all
   patterns deviate from the reference by at most the requested error. The
   reference is the image by T or, if T has no closed form, by all kernels. */
static int cut_choose(const hopkins *h, cut *c, opc_error *error) {
  kernels *k = c->kernels;
  trial t;
  int code = trial_init(h, k, &t, error);
  size_t n = c->fixed > 0 ? (size_t)c->fixed : 4;
  for (; !code; n = cut_more_kernels(c, n)) {
    k->keep(k, n);
    if ((code = cut_try(h, c, &t, error))) break;
    if (!isfinite(c->error))
      code = opc_fail(error, OPC_FAILED, NULL, "the kernels are not finite");
    if (c->fixed > 0 || c->error <= c->wanted || kernels_are_all(k)) break;
  }
  trial_clear(&t);
  return code;
}

/* ---- work: cuts ---- */

static int cut_make_kernels(const hopkins *h, cut *c, opc_error *error) {
  const optics *o = &h->optics;
  const opc_context *context = h->host->context;
  if (optics_is_radial(o)) {
    int real = c->defocus == 0 && optics_is_real(o) && optics_real_masks(o);
    /* Approximate error of a fixed number of kernels. */
    double wanted = c->fixed > 0 ? 0.01 / (double)c->fixed : c->wanted;
    c->kernels = radial_new(context, o, c->defocus, real, wanted);
  } else {
    c->kernels = plane_new(context, o, c->defocus, error);
    if (!c->kernels) return error->code;
  }
  int code = cut_choose(h, c, error);
  if (code) {
    c->kernels->free(c->kernels);
    c->kernels = NULL;
  }
  return code;
}

/* Set c->kernels to kernels of the cache; compute the kernels if they are not
   in the cache. Only kernels of radial optics without Zernike terms are cached.
 */
static int cut_get_kernels(const hopkins *h, cut *c, opc_error *error) {
  const optics *o = &h->optics;
  if (!optics_is_radial(o) || o->zernike.count)
    return cut_make_kernels(h, c, error);
  cache_key key;
  memset(&key, 0, sizeof key);
  key.wavelength = o->wavelength;
  key.na = o->na;
  key.index = o->index;
  key.resist_index = o->polarisation == OPTICS_SCALAR ? 0 : o->resist_index;
  key.sigma = o->sigma;
  key.sigma_in = o->source == OPTICS_ANNULAR ? o->sigma_in : 0;
  key.defocus = o->defocus;
  key.aside = c->defocus;
  key.wanted = c->wanted;
  key.fixed = c->fixed;
  key.source = o->source;
  key.polarisation = o->polarisation;
  key.real = optics_real_masks(o);
  c->entry = cache_find(&key);
  if (!c->entry) {
    int code = cut_make_kernels(h, c, error);
    if (code) return code;
    c->kernels->settle(c->kernels);
    c->entry = cache_add(&key, c->kernels, c->error);
  }
  c->kernels = cache_kernels(c->entry, &c->error);
  return OPC_OK;
}

/* If a step requests an error, warn only of kernels whose error is more than
   this multiple of the request: steps request a smaller error than they need.
   If the flow sets the parameter `error`, the multiple is 1. Empirical value.
 */
static const double nearly = 2;

static void cut_log(const hopkins *h, const cut *c) {
  char focus[48] = "";
  if (c->defocus != 0)
    (void)snprintf(focus, sizeof focus, ", defocus %g nm", c->defocus);
  h->host->log(h->host, OPC_LOG_INFO,
               "litho.hopkins: %zu kernels and the residual%s, error %.1e of "
               "the clear field",
               c->kernels->count, focus, c->error);
  int meant = h->wanted_given && c->wanted == h->wanted;
  if (c->fixed < 0 && c->error > c->wanted)
    h->host->log(
        h->host,
        meant || c->error > nearly * c->wanted ? OPC_LOG_WARNING : OPC_LOG_INFO,
        "litho.hopkins: all %zu kernels leave an error of %.1e, more than the "
        "requested %.1e%s",
        c->kernels->count, c->error, c->wanted, focus);
  if (optics_is_radial(&h->optics) || h->n_cuts) return;
  if (h->optics.source == OPTICS_LIST)
    h->host->log(
        h->host, OPC_LOG_WARNING,
        "litho.hopkins: the rims of the pupils of single source points are "
        "blurred, which the reported error does not include: 0.6 %% of the "
        "clear field for six points in a frame of 3.2 um, 2 to 3 %% in a frame "
        "of 0.8 um; use litho.abbe for sharp pupils");
  else
    h->host->log(
        h->host, OPC_LOG_INFO,
        "litho.hopkins: tables blur the rims of the pupils, which the reported "
        "error does not include: 0.2 to 0.4 %% of the clear field");
}

/* Add kernels for a defocus and an error. The caller holds the lock or is the
   only user of the instance. Return NULL on failure. */
static const cut *cut_add(hopkins *h, double defocus, double wanted,
                          int64_t fixed, opc_error *error) {
  if (h->n_cuts == CUTS) {
    opc_fail(error, OPC_INVALID, NULL,
             "more than %d combinations of defocus and error were requested",
             CUTS);
    return NULL;
  }
  cut *c = &h->cuts[h->n_cuts];
  *c = (cut){.defocus = defocus, .wanted = wanted, .fixed = fixed};
  if (cut_get_kernels(h, c, error)) return NULL;
  cut_log(h, c);
  h->n_cuts++;
  return c;
}

/* Return the kernels for exactly this request. Kernels with a smaller error are
   not used, because results would then depend on the order of requests. */
static const cut *cut_find(hopkins *h, double defocus, double wanted,
                           int64_t fixed, opc_error *error) {
  const cut *found = NULL;
  if (!(wanted > 0)) {
    opc_fail(error, OPC_INVALID, NULL,
             "the requested error of an image is %g, not above 0", wanted);
    return NULL;
  }
  pthread_mutex_lock(&h->lock);
  for (size_t i = 0; i < h->n_cuts && !found; i++) {
    const cut *c = &h->cuts[i];
    if (c->defocus == defocus && c->wanted == wanted && c->fixed == fixed)
      found = c;
  }
  if (!found) found = cut_add(h, defocus, wanted, fixed, error);
  pthread_mutex_unlock(&h->lock);
  return found;
}

static int hopkins_prepare(void *self, opc_error *error) {
  hopkins *h = self;
  if (h->n_cuts) return OPC_OK;
  optics_warn(&h->optics, h->host);
  const cut *c = cut_add(h, 0, h->wanted, h->fixed, error);
  if (!c) return error->code;
  int code =
      h->host->metric(h->host, "kernels", (double)c->kernels->count, error);
  if (!code) code = h->host->metric(h->host, "error", c->error, error);
  if (!code) code = h->host->metric(h->host, "grid", step_of(h), error);
  return code;
}

static int hopkins_image(const void *self, int layer, const eda_spectrum *mask,
                         eda_field *out, opc_error *error) {
  const hopkins *h = self;
  return hopkins_image_by(h, h->cuts[0].kernels, layer, mask, out, error);
}

static int hopkins_image_at(const void *self, int layer,
                            const eda_spectrum *mask, double defocus,
                            eda_field *out, opc_error *error) {
  hopkins *h = (hopkins *)self; /* the lock guards the changes */
  const cut *c = cut_find(h, defocus, h->wanted, h->fixed, error);
  return c ? hopkins_image_by(h, c->kernels, layer, mask, out, error)
           : error->code;
}

/* Compute the image of a mask of lines directly from T. `mask` is the spectrum
   of the binary mask. */
static int hopkins_image_lines(const hopkins *h, int layer,
                               const eda_spectrum *mask, eda_field *out,
                               opc_error *error) {
  const kernels *k = h->cuts[0].kernels;
  int code =
      hopkins_image_by(h, k, layer, mask, out, error); /* sets the grid */
  if (code) return code;
  size_t n = 2 * (size_t)mask->columns;
  double offset[2] = {0}, scale[2] = {1};
  optics_amplitudes(&h->optics, layer, offset, scale);
  eda_spectrum of_light = *mask;
  of_light.data = eda_alloc(n, sizeof *of_light.data);
  for (size_t i = 0; i < n; i++)
    of_light.data[i] = (float)scale[0] * mask->data[i];
  of_light.data[0] += (float)offset[0];
  pattern_lines(h->host->context, k, &of_light, out);
  free(of_light.data);
  return OPC_OK;
}

static int hopkins_image_fine(const void *self, int layer,
                              const eda_spectrum *mask, double defocus,
                              double wanted, eda_field *out, opc_error *error) {
  hopkins *h = (hopkins *)self; /* the lock guards the changes */
  const kernels *k = h->cuts[0].kernels;
  if (defocus == 0 && k->cross && pattern_is_lines(k, mask))
    return hopkins_image_lines(h, layer, mask, out, error);
  /* An accurate image must not have a larger error than the fast image. */
  double own = h->fixed > 0 ? h->cuts[0].error : h->wanted;
  const cut *c = &h->cuts[0];
  if (defocus != 0 || c->error > wanted)
    c = cut_find(h, defocus, fmin(wanted, own), OPC_NO_INT, error);
  return c ? hopkins_image_by(h, c->kernels, layer, mask, out, error)
           : error->code;
}

/* ---- work: other optics ---- */

static void hopkins_clear(void *self) {
  hopkins *h = self;
  for (size_t i = 0; i < h->n_cuts; i++)
    if (h->cuts[i].entry)
      cache_release(h->cuts[i].entry);
    else
      h->cuts[i].kernels->free(h->cuts[i].kernels);
  pthread_mutex_destroy(&h->lock);
}

/* Compute an image by a temporary instance with the other optics. The kernels
   of radial optics without Zernike terms stay in the cache for the next call;
   other kernels are computed in each call. */
static int hopkins_image_optics(const void *self, int layer,
                                const eda_spectrum *mask, double na,
                                double sigma, double defocus, double wanted,
                                eda_field *out, opc_error *error) {
  const hopkins *h = self;
  if (na <= 0 || sigma <= 0 || sigma > 1)
    return opc_fail(error, OPC_INVALID, na <= 0 ? "na" : "sigma",
                    "NA must be above 0 and sigma above 0 and at most 1, found "
                    "%g and %g",
                    na, sigma);
  hopkins *other = eda_alloc(1, sizeof *other);
  other->host = h->host;
  other->optics = h->optics;
  other->wanted = wanted;
  if (!isnan(na)) other->optics.na = na;
  if (!isnan(sigma)) {
    other->optics.sigma = sigma;
    other->optics.given[OPTICS_SIGMA] = 1;
  }
  pthread_mutex_init(&other->lock, NULL);
  int code = optics_check(&other->optics, error);
  if (!code) {
    const cut *c = cut_find(other, defocus, wanted, OPC_NO_INT, error);
    code = c ? hopkins_image_by(other, c->kernels, layer, mask, out, error)
             : error->code;
  }
  hopkins_clear(other);
  free(other);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPTICS_PARAMETERS(hopkins),
    OPC_PARAMETER_NAMED(
        "error", hopkins, wanted, .type = OPC_REAL,
        .flags = OPC_AT_LEAST | OPC_BELOW, .preset = "1.5e-3", .min = 5e-5,
        .max = 0.1,
        .summary = "largest error of the intensity by "
                   "truncation of kernels, relative to the clear field",
        .given = offsetof(hopkins, wanted_given)),
    OPC_PARAMETER_NAMED("kernels", hopkins, fixed, .type = OPC_INT,
                        .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = 1,
                        .max = 2000,
                        .summary = "fixed number of kernels instead of the "
                                   "number that `error` requires"),
};

static const opc_metric metrics[] = {
    {"kernels", NULL, OPC_NEUTRAL, 0,
     "number of coherent kernels of the fast image"},
    {"error", NULL, OPC_LOWER, 1e-5,
     "measured truncation error, relative to the clear field"},
    {"grid", "nm", OPC_LOWER, 1e-3, "largest grid spacing of an image"},
};

static int hopkins_check(void *self, opc_error *error) {
  hopkins *h = self;
  pthread_mutex_init(&h->lock, NULL);
  int code = optics_check(&h->optics, error);
  if (!code && h->wanted_given && h->fixed > 0)
    code = opc_fail(error, OPC_INVALID, "kernels",
                    "'kernels' and 'error' exclude each other: set the number "
                    "of kernels, or the error that determines the number");
  if (!code && h->fixed > PLANE_MOST && !optics_is_radial(&h->optics))
    code = opc_fail(error, OPC_INVALID, "kernels",
                    "'kernels' is %lld, expected at most %d for this source "
                    "and pupil",
                    (long long)h->fixed, PLANE_MOST);
  size_t listed = h->optics.points.count / 3, parts = vector_parts(&h->optics);
  if (code || listed * parts <= MOST_LISTED) return code;
  return opc_fail(
      error, OPC_INVALID, "points",
      "'points' has %zu points, more than %zu: kernels are computed from %zu "
      "images per point; use litho.abbe for more points",
      listed, MOST_LISTED / parts, parts);
}

/* ---- entry ---- */

static const eda_litho functions = {.prepare = hopkins_prepare,
                                    .band = hopkins_band,
                                    .scanner = hopkins_scanner,
                                    .image = hopkins_image,
                                    .image_at = hopkins_image_at,
                                    .image_fine = hopkins_image_fine,
                                    .image_optics = hopkins_image_optics};
OPC_PLUGIN(hopkins, .id = "litho.hopkins", .kind = "litho", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "partially coherent imaging by Hopkins kernels",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = hopkins_check, .clear = hopkins_clear,
           OPC_FUNCTIONS(functions));
