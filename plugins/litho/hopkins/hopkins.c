/* SPDX-License-Identifier: BSD-3-Clause */
/* litho.hopkins: scalar partially coherent imaging by Hopkins' transmission
   cross coefficient, T(f1, f2) (H. H. Hopkins, Proc. R. Soc. A 217, 1953), as a
   sum of coherent systems. How many are needed for the error asked for is
   measured, on a small pattern, against all of them. */
#include "kernels.h"
#include "patterns.h"

#include <opcflow/litho.h>

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

enum {
  FOCI = 16,
  ALL = 600   /* systems that stand for all */
};

typedef struct hopkins {
  const opc_host *host;
  optics optics;
  double wanted;             /* error, clear field 1 */
  size_t fixed;              /* systems; 0: as many as the error needs */
  double error;              /* measured */
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

/* The image of a layer's mask, or of a binary one. */
enum { BINARY = -1 };
static int image_by(const hopkins *h, const kernels *k, int layer,
                    const opc_spectrum *mask, opc_field *out,
                    opc_error *error) {
  opc_systems systems = {.size = sizeof systems,
                         .count = k->count,
                         .weight = k->weight,
                         .band = k->radius * k->cutoff,
                         .intensity_band = 2 * k->cutoff,
                         .transfer = k->transfer,
                         .residual = k->has_residual ? k->residual : NULL,
                         .self = k,
                         .mirror = k->mirror};
  if (layer != BINARY)
    optics_amplitudes(&h->optics, layer, systems.offset, systems.scale);
  return h->host->imaging->coherent_sum(h->host, mask, &systems, step_of(h), out,
                                        error);
}

/* ---- work: how many systems ---- */

static double difference(const opc_field *a, const opc_field *b) {
  double worst = 0;
  size_t n = (size_t)a->nx * (size_t)a->ny;
  for (size_t i = 0; i < n; i++) {
    double d = fabs((double)a->coefficients[i] - b->coefficients[i]);
    if (isnan(d)) return d;
    worst = fmax(worst, d);
  }
  return worst;
}

static int use(const hopkins *h, kernels *k, size_t n, opc_error *error) {
  if (k->keep(k, n)) return OPC_OK;
  return h->host->fail(h->host, error, OPC_FAILED, NULL, "out of memory");
}

/* Layouts show errors up to so much larger than the patterns. */
static const double margin = 1.1;

/* The patterns' spectra and true images; some coefficients may be NULL yet. */
typedef struct trial {
  opc_spectrum mask[PATTERNS];
  opc_field whole[PATTERNS];
} trial;

static void end_trial(const hopkins *h, trial *t) {
  for (int p = 0; p < PATTERNS; p++) {
    h->host->imaging->release_field(h->host, &t->whole[p]);
    h->host->imaging->release_spectrum(h->host, &t->mask[p]);
  }
}

/* Where T is not known, all systems together stand for it. */
static int begin_trial(const hopkins *h, kernels *k, trial *t, opc_error *error) {
  int code = k->cross ? OPC_OK : use(h, k, ALL, error);
  for (int p = 0; p < PATTERNS && !code; p++) {
    code = pattern_spectrum(k, p, &t->mask[p], error);
    if (!code && !k->cross)
      code = image_by(h, k, BINARY, &t->mask[p], &t->whole[p], error);
  }
  return code;
}

/* The largest error that the kernels as they are kept make. */
static int try_kernels(hopkins *h, const kernels *k, trial *t, opc_error *error) {
  int code = OPC_OK;
  h->error = 0;
  for (int p = 0; p < PATTERNS && !code; p++) {
    opc_field part = {0}, *whole = &t->whole[p];
    code = image_by(h, k, BINARY, &t->mask[p], &part, error);
    if (!code && !whole->coefficients)
      code = pattern_image(k, &t->mask[p], &part, whole, error);
    double off = code ? 0 : margin * difference(whole, &part);
    if (!(off <= h->error)) h->error = off;
    h->host->imaging->release_field(h->host, &part);
    if (h->error > h->wanted && !h->fixed && !k->all) break;
  }
  return code;
}

/* The fewest systems whose images of all patterns are within the error of those
   of T itself or, where that is not known, of all systems. */
static int choose(hopkins *h, kernels *k, opc_error *error) {
  trial t = {0};
  int code = begin_trial(h, k, &t, error);
  for (size_t n = h->fixed ? h->fixed : 4; !code; n += 2 + n / 6) {
    if ((code = use(h, k, n, error))) break;
    if ((code = try_kernels(h, k, &t, error))) break;
    if (!isfinite(h->error))
      code = h->host->fail(h->host, error, OPC_FAILED, NULL,
                           "the kernels are not finite");
    if (h->fixed || h->error <= h->wanted || k->all) break;
  }
  end_trial(h, &t);
  return code;
}

/* ---- work: foci ---- */

static kernels *make_kernels(hopkins *h, double defocus, opc_error *error) {
  const optics *o = &h->optics;
  kernels *k;
  if (optics_is_radial(o)) {
    int real = defocus == 0 && optics_is_real(o) && optics_real_mask(o, 0) &&
               optics_real_mask(o, 1);
    /* So many systems reach about so much. */
    double wanted = h->fixed ? 0.04 / (double)h->fixed : h->wanted;
    k = radial_kernels(h->host, o, defocus, real, wanted);
    if (!k) h->host->fail(h->host, error, OPC_FAILED, NULL, "out of memory");
  } else {
    k = plane_kernels(h->host, o, defocus, error);
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
               "litho.hopkins: %zu systems%s, error %.1e of the clear field",
               h->focus->count, h->focus->has_residual ? " and the rest" : "",
               h->error);
  int code = h->host->metric(h->host, "systems", (double)h->focus->count, error);
  if (!code) code = h->host->metric(h->host, "error", h->error, error);
  if (!code) code = h->host->metric(h->host, "grid", step_of(h), error);
  if (code) return code;
  if (!h->fixed && h->error > h->wanted)
    h->host->log(h->host, OPC_LOG_WARNING,
                 "litho.hopkins: all %zu systems give an error of %.1e, more "
                 "than the %.1e asked for",
                 h->focus->count, h->error, h->wanted);
  return OPC_OK;
}

static int image(const void *self, int layer, const opc_spectrum *mask,
                 opc_field *out, opc_error *error) {
  const hopkins *h = self;
  return image_by(h, h->focus, layer, mask, out, error);
}

/* The kernels for a focus; h->lock is held. */
static kernels *find_focus(hopkins *h, double defocus, opc_error *error) {
  for (size_t i = 0; i < h->n_foci; i++)
    if (h->foci[i].defocus == defocus) return h->foci[i].kernels;
  if (h->n_foci == FOCI) {
    h->host->fail(h->host, error, OPC_INVALID, NULL,
                  "more than %d values of defocus", FOCI);
    return NULL;
  }
  kernels *k = make_kernels(h, defocus, error);
  if (!k) return NULL;
  h->foci[h->n_foci].defocus = defocus;
  h->foci[h->n_foci++].kernels = k;
  return k;
}

static int image_at(const void *self, int layer, const opc_spectrum *mask,
                    double defocus, opc_field *out, opc_error *error) {
  if (defocus == 0) return image(self, layer, mask, out, error);
  hopkins *h = (hopkins *)self;   /* what changes is under the lock */
  pthread_mutex_lock(&h->lock);
  const kernels *k = find_focus(h, defocus, error);
  pthread_mutex_unlock(&h->lock);
  return k ? image_by(h, k, layer, mask, out, error) : error->code;
}

/* ---- parameters ---- */

enum { ERROR = OPTICS_COUNT, KERNELS };

static const opc_parameter parameters[] = {
    OPTICS_PARAMETERS,
    [ERROR] = {.name = "error", .type = OPC_REAL, .flags = OPC_AT_LEAST | OPC_BELOW,
               .preset = "1.5e-3", .min = 1e-4, .max = 0.1,
               .summary = "largest error of the intensity, clear field 1, that "
                          "leaving out kernels may make"},
    [KERNELS] = {.name = "kernels", .type = OPC_INT,
                 .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = 1, .max = 2000,
                 .summary = "so many coherent systems instead of as many as "
                            "the error needs"},
};

static const opc_metric metrics[] = {
    {.name = "systems", .summary = "coherent systems that are summed up"},
    {.name = "error", .better = OPC_LOWER, .tolerance = 1e-5,
     .summary = "measured error of leaving out the others, clear field 1"},
    {.name = "grid", .unit = "nm", .better = OPC_LOWER, .tolerance = 1e-3,
     .summary = "largest step of an image's grid"},
};

static void destroy(void *self) {
  hopkins *h = self;
  if (h->focus) h->focus->free(h->focus);
  for (size_t i = 0; i < h->n_foci; i++)
    h->foci[i].kernels->free(h->foci[i].kernels);
  pthread_mutex_destroy(&h->lock);
  free(h);
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  hopkins *h = calloc(1, sizeof *h);
  if (!h) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  h->host = host;
  h->wanted = values[ERROR].real;
  if (values[KERNELS].type != OPC_ABSENT)
    h->fixed = (size_t)values[KERNELS].integer;
  if (!optics_create(host, values, &h->optics, error)) {
    free(h);
    return NULL;
  }
  pthread_mutex_init(&h->lock, NULL);
  return h;
}

/* ---- entry ---- */

static const opc_litho operations = {.size = sizeof operations,
                                     .prepare = prepare,
                                     .band = band,
                                     .image = image,
                                     .image_at = image_at};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) {
  static const opc_plugin plugin = {
      .size = sizeof plugin,
      .abi_major = OPC_ABI_MAJOR,
      .abi_minor = OPC_ABI_MINOR,
      .id = "litho.hopkins",
      .version = "0.2.0",
      .licence = "BSD-3-Clause",
      .summary = "partially coherent imaging by Hopkins kernels",
      .kind = OPC_KIND_LITHO,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      OPC_METRICS(metrics),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
