/* SPDX-License-Identifier: BSD-3-Clause */
/* litho.abbe: scalar partially coherent imaging after Abbe: each point s of
   the source makes a coherent image of its own, through the pupil P(f + s),
   and the intensities are added (M. Born, E. Wolf, Principles of Optics,
   10.6.2). Nothing is decomposed or cut off; the source's points are the only
   approximation. */
#include "../optics/optics.h"

#include <opcflow/litho.h>

#include <math.h>
#include <stdlib.h>

/* ---- state ---- */

typedef struct abbe {
  const opc_host *host;
  optics optics;
  double spacing; /* of the source's points, pupil's radius 1 */
  double *point;  /* x, y and weight of each */
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

static int prepare(void *self, opc_error *error) {
  abbe *a = self;
  free(a->point);
  free(a->weight);
  a->weight = NULL;
  a->point = optics_source_points(&a->optics, a->spacing, &a->count);
  if (a->point) a->weight = malloc(a->count * sizeof *a->weight);
  if (!a->weight)
    return a->host->fail(a->host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < a->count; i++) a->weight[i] = a->point[3 * i + 2];
  a->host->log(a->host, OPC_LOG_DEBUG, "litho.abbe: %zu source points",
               a->count);
  return OPC_OK;
}

static double band(const void *self) {
  const abbe *a = self;
  return (1 + optics_source_radius(&a->optics)) * a->optics.cutoff;
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

static int image_at(const void *self, int layer, const opc_spectrum *mask,
                    double defocus, opc_field *out, opc_error *error) {
  const abbe *a = self;
  view v = {a, defocus};
  opc_systems systems = {.size = sizeof systems,
                         .count = a->count,
                         .weight = a->weight,
                         .band = band(a),
                         .intensity_band = 2 * a->optics.cutoff,
                         .transfer = transfer,
                         .self = &v};
  optics_amplitudes(&a->optics, layer, systems.offset, systems.scale);
  /* Four samples to the finest period there can be. */
  double step = fmin(coarsest, 0.25 / systems.intensity_band);
  return a->host->imaging->coherent_sum(a->host, mask, &systems, step, out,
                                        error);
}

static int image(const void *self, int layer, const opc_spectrum *mask,
                 opc_field *out, opc_error *error) {
  return image_at(self, layer, mask, 0, out, error);
}

/* ---- parameters ---- */

enum { POINTS_ACROSS = OPTICS_COUNT, PARAMETERS };

static const opc_parameter parameters[PARAMETERS] = {
    OPTICS_PARAMETERS,
    [POINTS_ACROSS] = {.name = "points_across",
                       .type = OPC_INT,
                       .flags = OPC_AT_LEAST | OPC_AT_MOST,
                       .preset = "36",
                       .min = 2,
                       .max = 1000,
                       .summary = "points on the diameter of the source, one "
                                  "Fourier transform for each of its area"},
};

static void destroy(void *self) {
  abbe *a = self;
  free(a->point);
  free(a->weight);
  free(a);
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  abbe *a = calloc(1, sizeof *a);
  if (!a) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  a->host = host;
  if (!optics_create(host, values, &a->optics, error)) {
    free(a);
    return NULL;
  }
  const opc_value *across = &values[POINTS_ACROSS];
  if (a->optics.source == OPTICS_LIST && across->given) {
    host->fail(host, error, OPC_INVALID, "points_across",
               "'points_across' means nothing for a source 'points'");
    free(a);
    return NULL;
  }
  a->spacing = 2 * optics_source_radius(&a->optics) / (double)across->integer;
  return a;
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
      .id = "litho.abbe",
      .version = "0.1.0",
      .licence = "BSD-3-Clause",
      .summary =
          "partially coherent imaging by source points, the reference "
          "of other models",
      .kind = OPC_KIND_LITHO,
      .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
      OPC_PARAMETERS(parameters),
      .create = create,
      .destroy = destroy,
      .operations = &operations,
  };
  return &plugin;
}
