/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements litho.abbe: partially coherent imaging after Abbe. Each source
   point s forms a coherent image through the pupil P(f + s), and the
   intensities are added (M. Born, E. Wolf, Principles of Optics, 10.6.2).
   Intensities of polarised light are also added over the components of the
   field. The only approximation is the sampling of the source. */
#include <eda/litho.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../optics.h"
#include "../vector.h"
#include "transform.h"

/* ---- state ---- */

typedef struct abbe {
  const opc_host *host;
  optics optics;
  int64_t points_across;
  int points_across_given;
  double *point;       /* x, y, weight: [point][3] */
  size_t count, parts; /* number of points; number of parts of polarised light
                          per point */
  double *weight;      /* [point][part] */
  int paired;          /* 1: point n - 1 - i is opposite to point i */
  double *twice;       /* twice `weight` */
} abbe;

static const double coarsest = 32; /* largest grid spacing of an image, nm */

/* The kernels of one batch: kernel s is part `first` + s of all parts of all
   source points, at one defocus. */
typedef struct view {
  const abbe *model;
  double defocus;
  size_t first; /* index of the first part of the batch */
  int real;     /* 1: the pupil is real */
} view;

/* Number of images that are added in single precision. Sums of batches are in
   double precision. Single precision throughout would cause an error of 3e-5 of
   the clear field for thousands of points. */
enum { BATCH = 128 };

/* ---- work ---- */

static void abbe_clear(void *self) {
  abbe *a = self;
  free(a->point);
  free(a->weight);
  free(a->twice);
  a->point = a->weight = a->twice = NULL;
}

/* Return 1 if point n - 1 - i is opposite to point i for all i. */
static int points_are_paired(const double *p, size_t n) {
  for (size_t i = 0; i < n; i++) {
    const double *a = p + 3 * i, *b = p + 3 * (n - 1 - i);
    if (fabs(a[0] + b[0]) + fabs(a[1] + b[1]) > 1e-9) return 0;
    if (fabs(a[2] - b[2]) > 1e-9 * a[2]) return 0;
  }
  return n % 2 == 0;
}

static int abbe_prepare(void *self, opc_error *error) {
  abbe *a = self;
  double spacing =
      2 * optics_source_radius(&a->optics) / (double)a->points_across;
  abbe_clear(a);
  a->point = optics_source_points(&a->optics, spacing, &a->count);
  if (!a->point)
    return opc_fail(error, OPC_INVALID, "points_across",
                    "the source is too thin for this number of points");
  vector_normalise(&a->optics, a->point, a->count);
  a->parts = vector_parts(&a->optics);
  size_t n = a->count * a->parts;
  a->weight = eda_alloc(n, sizeof *a->weight);
  a->twice = eda_alloc(n, sizeof *a->twice);
  for (size_t i = 0; i < n; i++) {
    a->weight[i] = a->point[3 * (i / a->parts) + 2];
    a->twice[i] = 2 * a->weight[i];
  }
  a->paired = points_are_paired(a->point, a->count);
  optics_warn(&a->optics, a->host);
  a->host->log(a->host, OPC_LOG_DEBUG, "litho.abbe: %zu source points%s",
               a->count, a->paired ? " in opposite pairs" : "");
  return OPC_OK;
}

static eda_scanner abbe_scanner(const void *self) {
  return optics_scanner(&((const abbe *)self)->optics);
}

static double abbe_band(const void *self) {
  const abbe *a = self;
  return (1 + optics_source_radius(&a->optics)) * a->optics.cutoff;
}

static int abbe_transform(const void *self, const eda_shapes *mask, double grid,
                          eda_frame frame, eda_spectrum *out,
                          opc_error *error) {
  const abbe *a = self;
  return transform_mask(a->host->context, mask, grid, frame, abbe_band(self),
                        out, error);
}

/* Fill a row of the transfer function of a pupil without phases: 1 on the chord
   that the row cuts from the pupil. */
static void view_transfer_chord(const view *v, const double *point,
                                const double *fx, double fy, size_t n,
                                float *out) {
  double cutoff = v->model->optics.cutoff, y = fy / cutoff + point[1];
  double half = y * y <= 1 ? sqrt(1 - y * y) : -INFINITY;
  double from = (-half - point[0]) * cutoff, to = (half - point[0]) * cutoff;
  for (size_t i = 0; i < n; i++) {
    out[2 * i] = fx[i] >= from && fx[i] <= to;
    out[2 * i + 1] = 0;
  }
}

/* Fill the transfer function of a pupil with phases. */
static void view_transfer_phases(const view *v, const double *point,
                                 const double *fx, double fy, size_t n,
                                 float *out) {
  const optics *o = &v->model->optics;
  for (size_t i = 0; i < n; i++) {
    double re, im;
    optics_pupil(o, v->defocus, fx[i] / o->cutoff + point[0],
                 fy / o->cutoff + point[1], &re, &im);
    out[2 * i] = (float)re;
    out[2 * i + 1] = (float)im;
  }
}

static void view_transfer(const void *self, size_t s, const double *fx,
                          double fy, size_t n, float *out) {
  const view *v = self;
  const optics *o = &v->model->optics;
  size_t part = (v->first + s) % v->model->parts;
  const double *point =
      v->model->point + 3 * ((v->first + s) / v->model->parts);
  if (v->real)
    view_transfer_chord(v, point, fx, fy, n, out);
  else
    view_transfer_phases(v, point, fx, fy, n, out);
  for (size_t i = 0; i < n && v->model->parts > 1; i++) {
    double factor[VECTOR_PARTS];
    if (out[2 * i] == 0 && out[2 * i + 1] == 0) continue;
    vector_factors(o, point, fx[i] / o->cutoff + point[0],
                   fy / o->cutoff + point[1], factor);
    out[2 * i] *= (float)factor[part];
    out[2 * i + 1] *= (float)factor[part];
  }
}

/* Add a coherent sum to *sum; allocate *sum if NULL. */
static int view_add_images(const view *v, const eda_spectrum *mask,
                           const eda_kernels *kernels, double **sum,
                           eda_field *out, opc_error *error) {
  /* Four samples for the shortest period of the intensity. */
  double step = fmin(coarsest, 0.25 / kernels->intensity_band);
  eda_field_clear(out);
  int code = eda_coherent_sum(v->model->host->context, mask, kernels, step, out,
                              error);
  if (code) return code;
  size_t n = (size_t)out->nx * (size_t)out->ny;
  if (!*sum) *sum = eda_alloc(n, sizeof **sum);
  for (size_t i = 0; i < n; i++) (*sum)[i] += (double)out->coefficients[i];
  return OPC_OK;
}

static int abbe_image_at(const void *self, int layer, const eda_spectrum *mask,
                         double defocus, eda_field *out, opc_error *error) {
  const abbe *a = self;
  view v = {a, defocus, 0, defocus == 0 && optics_is_real(&a->optics)};
  /* Opposite points form the same image if mask and pupil are real. */
  int half = a->paired && v.real && optics_real_masks(&a->optics);
  const double *weight = half ? a->twice : a->weight;
  double *sum = NULL;
  int code = OPC_OK;
  memset(out, 0, sizeof *out);
  size_t all = a->count * a->parts;
  for (v.first = half ? all / 2 : 0; v.first < all && !code; v.first += BATCH) {
    size_t left = all - v.first;
    eda_kernels kernels = {.count = left < BATCH ? left : BATCH,
                           .weight = weight + v.first,
                           .band = abbe_band(a),
                           .intensity_band = 2 * a->optics.cutoff,
                           .transfer = view_transfer,
                           .self = &v};
    optics_amplitudes(&a->optics, layer, kernels.offset, kernels.scale);
    code = view_add_images(&v, mask, &kernels, &sum, out, error);
  }
  size_t n = (size_t)out->nx * (size_t)out->ny;
  for (size_t i = 0; i < n && !code; i++) out->coefficients[i] = (float)sum[i];
  free(sum);
  if (code) eda_field_clear(out);
  return code;
}

static int abbe_image(const void *self, int layer, const eda_spectrum *mask,
                      eda_field *out, opc_error *error) {
  return abbe_image_at(self, layer, mask, 0, out, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPTICS_PARAMETERS(abbe),
    OPC_PARAMETER(abbe, points_across, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "60", .min = 2,
                  .max = 1000,
                  .summary = "number of points on the diameter of the source; "
                             "each source point requires one Fourier transform",
                  .given = offsetof(abbe, points_across_given)),
};

static int abbe_check(void *self, opc_error *error) {
  abbe *a = self;
  int code = optics_check(&a->optics, error);
  if (!code && a->optics.source == OPTICS_LIST && a->points_across_given)
    return opc_fail(error, OPC_INVALID, "points_across",
                    "'points_across' has no effect for a source 'points'");
  return code;
}

/* ---- entry ---- */

static const eda_litho functions = {.prepare = abbe_prepare,
                                    .band = abbe_band,
                                    .scanner = abbe_scanner,
                                    .image = abbe_image,
                                    .image_at = abbe_image_at,
                                    .transform = abbe_transform};
OPC_PLUGIN(abbe, .id = "litho.abbe", .kind = "litho", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary =
               "partially coherent imaging by source points, the reference for "
               "other models",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = abbe_check, .clear = abbe_clear,
           OPC_FUNCTIONS(functions));
