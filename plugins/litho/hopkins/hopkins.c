/* SPDX-License-Identifier: BSD-3-Clause */
/* litho.hopkins: scalar partially coherent imaging by Hopkins' transmission
   cross coefficient, T(f1, f2) (H. H. Hopkins, Proc. R. Soc. A 217, 1953), as a
   sum of coherent systems. How many are needed for the error asked for is
   measured, on a small pattern, against all of them. */
#include <eda/litho.h>
#include <math.h>
#include <pthread.h>

#include "kernels.h"
#include "patterns.h"

/* ---- state ---- */

enum {
  FOCI = 16,
  ALL = 600, /* systems that stand for all */
  /* Finding kernels takes 10 s for 300 points, by the square of their number;
     other sources are cut into 400. */
  MOST_LISTED = 800
};

typedef struct hopkins {
  const opc_host *host;
  optics optics;
  double wanted; /* error, clear field 1 */
  int64_t fixed; /* systems; OPC_NO_INT: as the error needs */
  double error;  /* measured */
  kernels *focus;
  /* Kernels away from the focus, made when first asked for. */
  pthread_mutex_t lock;
  struct {
    double defocus;
    kernels *kernels;
  } foci[FOCI];
  size_t n_foci;
} hopkins;

/* ---- work: images ---- */

static double band(const void *self) {
  const hopkins *h = self;
  return (1 + optics_source_radius(&h->optics)) * h->optics.cutoff;
}

/* Four samples of the spline for the shortest period of the intensity, nm. */
static double step_of(const hopkins *h) {
  return fmin(32, 0.25 / (2 * h->optics.cutoff));
}

/* What the rest is filtered by: D. */
static void residual(const void *self, const double *fx, double fy, size_t n,
                     float *out) {
  const kernels *kept = self;
  for (size_t i = 0; i < n; i++) {
    double shift = sqrt(fx[i] * fx[i] + fy * fy) / kept->cutoff;
    double place = shift * SHIFTS / 2;
    int k = place < SHIFTS ? (int)place : SHIFTS;
    const float *d = kept->d_table + k;
    out[i] = d[0] + (float)(place - k) * (d[1] - d[0]);
  }
}

/* The image of a layer's mask, or of a binary one. */
enum { BINARY = -1 };
static int image_by(const hopkins *h, const kernels *k, int layer,
                    const eda_spectrum *mask, eda_field *out,
                    opc_error *error) {
  eda_systems systems = {.count = k->count,
                         .weight = k->weight,
                         .band = k->radius * k->cutoff,
                         .intensity_band = 2 * k->cutoff,
                         .transfer = k->transfer,
                         .residual = residual,
                         .self = k,
                         .mirror = k->mirror};
  if (layer != BINARY)
    optics_amplitudes(&h->optics, layer, systems.offset, systems.scale);
  return eda_coherent_sum(h->host->context, mask, &systems, step_of(h), out,
                          error);
}

/* ---- work: how many systems ---- */

static double difference(const eda_field *a, const eda_field *b) {
  double worst = 0;
  size_t n = (size_t)a->nx * (size_t)a->ny;
  for (size_t i = 0; i < n; i++) {
    double d = fabs((double)a->coefficients[i] - b->coefficients[i]);
    if (isnan(d)) return d;
    worst = fmax(worst, d);
  }
  return worst;
}

/* Layouts show errors up to so much larger than the patterns. */
static const double margin = 1.1;

/* The patterns' spectra and true images; some coefficients may be NULL yet. */
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

/* Where T is not known, all systems together stand for it. */
static int trial_init(const hopkins *h, kernels *k, trial *t,
                      opc_error *error) {
  int code = OPC_OK;
  *t = (trial){0};
  if (!k->cross) k->keep(k, ALL);
  for (int p = 0; p < PATTERNS && !code; p++) {
    code = pattern_spectrum(k, p, &t->mask[p], error);
    if (!code && !k->cross)
      code = image_by(h, k, BINARY, &t->mask[p], &t->whole[p], error);
  }
  return code;
}

/* The largest error that the kernels as they are kept make. */
static int try_kernels(hopkins *h, const kernels *k, trial *t,
                       opc_error *error) {
  int code = OPC_OK;
  h->error = 0;
  for (int p = 0; p < PATTERNS && !code; p++) {
    eda_field part = {0}, *whole = &t->whole[p];
    code = image_by(h, k, BINARY, &t->mask[p], &part, error);
    if (!code && !whole->coefficients)
      pattern_image(k, &t->mask[p], &part, whole);
    double off = code ? 0 : margin * difference(whole, &part);
    if (!(off <= h->error)) h->error = off;
    eda_field_clear(&part);
    if (h->error > h->wanted && h->fixed < 0 && !k->all) break;
  }
  return code;
}

/* The fewest systems whose images of all patterns are within the error of those
   of T itself or, where that is not known, of all systems. */
static int choose(hopkins *h, kernels *k, opc_error *error) {
  trial t;
  int code = trial_init(h, k, &t, error);
  for (size_t n = h->fixed > 0 ? (size_t)h->fixed : 4; !code; n += 2 + n / 6) {
    k->keep(k, n);
    if ((code = try_kernels(h, k, &t, error))) break;
    if (!isfinite(h->error))
      code = opc_fail(error, OPC_FAILED, NULL, "the kernels are not finite");
    if (h->fixed > 0 || h->error <= h->wanted || k->all) break;
  }
  trial_clear(&t);
  return code;
}

/* ---- work: foci ---- */

static kernels *make_kernels(hopkins *h, double defocus, opc_error *error) {
  const optics *o = &h->optics;
  const opc_context *context = h->host->context;
  kernels *k;
  if (optics_is_radial(o)) {
    int real = defocus == 0 && optics_is_real(o) && optics_real_masks(o);
    /* So many systems reach about so much. */
    double wanted = h->fixed > 0 ? 0.04 / (double)h->fixed : h->wanted;
    k = radial_new(context, o, defocus, real, wanted);
  } else {
    k = plane_new(context, o, defocus, error);
  }
  if (k && choose(h, k, error)) {
    k->free(k);
    k = NULL;
  }
  return k;
}

static int prepare(void *self, opc_error *error) {
  hopkins *h = self;
  if (h->focus) return OPC_OK;
  h->focus = make_kernels(h, 0, error);
  if (!h->focus) return error->code;
  h->host->log(h->host, OPC_LOG_INFO,
               "litho.hopkins: %zu systems and the rest, error %.1e of the "
               "clear field",
               h->focus->count, h->error);
  int code =
      h->host->metric(h->host, "systems", (double)h->focus->count, error);
  if (!code) code = h->host->metric(h->host, "error", h->error, error);
  if (!code) code = h->host->metric(h->host, "grid", step_of(h), error);
  if (code) return code;
  if (h->fixed < 0 && h->error > h->wanted)
    h->host->log(h->host, OPC_LOG_WARNING,
                 "litho.hopkins: all %zu systems give an error of %.1e, more "
                 "than the %.1e asked for",
                 h->focus->count, h->error, h->wanted);
  return OPC_OK;
}

static int image(const void *self, int layer, const eda_spectrum *mask,
                 eda_field *out, opc_error *error) {
  const hopkins *h = self;
  return image_by(h, h->focus, layer, mask, out, error);
}

/* The kernels for a focus; h->lock is held. */
static kernels *find_focus(hopkins *h, double defocus, opc_error *error) {
  for (size_t i = 0; i < h->n_foci; i++)
    if (h->foci[i].defocus == defocus) return h->foci[i].kernels;
  if (h->n_foci == FOCI) {
    opc_fail(error, OPC_INVALID, NULL, "more than %d values of defocus", FOCI);
    return NULL;
  }
  kernels *k = make_kernels(h, defocus, error);
  if (!k) return NULL;
  h->foci[h->n_foci].defocus = defocus;
  h->foci[h->n_foci++].kernels = k;
  return k;
}

static int image_at(const void *self, int layer, const eda_spectrum *mask,
                    double defocus, eda_field *out, opc_error *error) {
  if (defocus == 0) return image(self, layer, mask, out, error);
  hopkins *h = (hopkins *)self; /* what changes is under the lock */
  pthread_mutex_lock(&h->lock);
  const kernels *k = find_focus(h, defocus, error);
  pthread_mutex_unlock(&h->lock);
  return k ? image_by(h, k, layer, mask, out, error) : error->code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPTICS_PARAMETERS(hopkins),
    OPC_PARAMETER_NAMED(
        "error", hopkins, wanted, .type = OPC_REAL,
        .flags = OPC_AT_LEAST | OPC_BELOW, .preset = "1.5e-3", .min = 1e-4,
        .max = 0.1,
        .summary = "largest error of the intensity, clear field 1, that "
                   "leaving out kernels may make"),
    OPC_PARAMETER_NAMED(
        "kernels", hopkins, fixed, .type = OPC_INT,
        .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = 1, .max = 2000,
        .summary =
            "so many coherent systems instead of as many as the error needs"),
};

static const opc_metric metrics[] = {
    {"systems", NULL, OPC_NEUTRAL, 0, "coherent systems that are summed up"},
    {"error", NULL, OPC_LOWER, 1e-5,
     "measured error of leaving out the others, clear field 1"},
    {"grid", "nm", OPC_LOWER, 1e-3, "largest step of an image's grid"},
};

static int check(void *self, opc_error *error) {
  hopkins *h = self;
  pthread_mutex_init(&h->lock, NULL);
  int code = optics_check(&h->optics, error);
  size_t listed = h->optics.points.count / 3;
  if (code || listed <= MOST_LISTED) return code;
  return opc_fail(error, OPC_INVALID, "points",
                  "'points' has %zu points, more than %d: kernels are found "
                  "among as many images; litho.abbe takes any number",
                  listed, MOST_LISTED);
}

static void clear(void *self) {
  hopkins *h = self;
  if (h->focus) h->focus->free(h->focus);
  for (size_t i = 0; i < h->n_foci; i++)
    h->foci[i].kernels->free(h->foci[i].kernels);
  pthread_mutex_destroy(&h->lock);
}

/* ---- entry ---- */

static const eda_litho functions = {
    .prepare = prepare, .band = band, .image = image, .image_at = image_at};
OPC_PLUGIN(hopkins, .id = "litho.hopkins", .kind = "litho", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "partially coherent imaging by Hopkins kernels",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics), .check = check,
           .clear = clear, OPC_FUNCTIONS(functions));
