/* SPDX-License-Identifier: BSD-3-Clause */
/* litho.abbe: scalar partially coherent imaging after Abbe: each point s of
   the source makes a coherent image of its own, through the pupil P(f + s),
   and the intensities are added (M. Born, E. Wolf, Principles of Optics,
   10.6.2). Nothing is decomposed or cut off; the source's points are the only
   approximation. */
#include <eda/litho.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

#include "../optics.h"
#include "transform.h"

/* ---- state ---- */

typedef struct abbe {
  const opc_host *host;
  optics optics;
  int64_t points_across;
  int points_across_given;
  double *point; /* x, y and weight of each */
  double *weight;
  size_t count;
} abbe;

static const double coarsest = 32; /* grid of an image, nm */

/* The model at one focus. */
typedef struct view {
  const abbe *model;
  double defocus;
} view;

/* ---- work ---- */

static void clear(void *self) {
  abbe *a = self;
  free(a->point);
  free(a->weight);
  a->point = a->weight = NULL;
}

static int prepare(void *self, opc_error *error) {
  abbe *a = self;
  double spacing =
      2 * optics_source_radius(&a->optics) / (double)a->points_across;
  clear(a);
  a->point = optics_source_points(&a->optics, spacing, &a->count);
  if (!a->point)
    return opc_fail(error, OPC_INVALID, "points_across",
                    "the source is too thin for its points");
  a->weight = eda_alloc(a->count, sizeof *a->weight);
  for (size_t i = 0; i < a->count; i++) a->weight[i] = a->point[3 * i + 2];
  a->host->log(a->host, OPC_LOG_DEBUG, "litho.abbe: %zu source points",
               a->count);
  return OPC_OK;
}

static double band(const void *self) {
  const abbe *a = self;
  return (1 + optics_source_radius(&a->optics)) * a->optics.cutoff;
}

static int transform(const void *self, const eda_shapes *mask, double grid,
                     eda_frame frame, eda_spectrum *out, opc_error *error) {
  const abbe *a = self;
  return transform_mask(a->host->context, mask, grid, frame, band(self), out,
                        error);
}

static void transfer(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out) {
  const view *v = self;
  const optics *o = &v->model->optics;
  const double *point = v->model->point + 3 * s;
  for (size_t i = 0; i < n; i++) {
    double re, im;
    optics_pupil(o, v->defocus, fx[i] / o->cutoff + point[0],
                 fy / o->cutoff + point[1], &re, &im);
    out[2 * i] = (float)re;
    out[2 * i + 1] = (float)im;
  }
}

static int image_at(const void *self, int layer, const eda_spectrum *mask,
                    double defocus, eda_field *out, opc_error *error) {
  const abbe *a = self;
  view v = {a, defocus};
  eda_systems systems = {.count = a->count,
                         .weight = a->weight,
                         .band = band(a),
                         .intensity_band = 2 * a->optics.cutoff,
                         .transfer = transfer,
                         .self = &v};
  optics_amplitudes(&a->optics, layer, systems.offset, systems.scale);
  /* Four samples to the finest period there can be. */
  double step = fmin(coarsest, 0.25 / systems.intensity_band);
  return eda_coherent_sum(a->host->context, mask, &systems, step, out, error);
}

static int image(const void *self, int layer, const eda_spectrum *mask,
                 eda_field *out, opc_error *error) {
  return image_at(self, layer, mask, 0, out, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPTICS_PARAMETERS(abbe),
    OPC_PARAMETER(abbe, points_across, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "36", .min = 2,
                  .max = 1000,
                  .summary = "points on the diameter of the source, one "
                             "Fourier transform for each of its area",
                  .given = offsetof(abbe, points_across_given)),
};

static int check(void *self, opc_error *error) {
  abbe *a = self;
  int code = optics_check(&a->optics, error);
  if (!code && a->optics.source == OPTICS_LIST && a->points_across_given)
    return opc_fail(error, OPC_INVALID, "points_across",
                    "'points_across' means nothing for a source 'points'");
  return code;
}

/* ---- entry ---- */

static const eda_litho functions = {.prepare = prepare,
                                    .band = band,
                                    .image = image,
                                    .image_at = image_at,
                                    .transform = transform};
OPC_PLUGIN(abbe, .id = "litho.abbe", .kind = "litho", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary =
               "partially coherent imaging by source points, the "
               "reference of other models",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = check, .clear = clear,
           OPC_FUNCTIONS(functions));
