/* SPDX-License-Identifier: BSD-3-Clause */
/* State of the step `calibrate`: gauges, model and fit. Lengths in nm. */
#pragma once

#include <eda/print.h>
#include <opcflow/step.h>

/* Parameters of the model. A gauge of the active layer uses ACTIVE_THRESHOLD,
   gauges of all other layers THRESHOLD. */
enum { THRESHOLD, ACTIVE_THRESHOLD, DIFFUSION, DEFOCUS, BIAS, TERMS };

/* Names of the parameters, and their units (NULL for a number without unit). */
extern const char *const term_name[TERMS], *const term_unit[TERMS];

/* ---- gauges ---- */

/* A measured width: that of the line (`space` 0) or the space (1) that contains
   the point (x, y), along `axis`. */
typedef struct gauge {
  int32_t layer, axis, space;
  double x, y, width, sd;
  size_t group; /* gauges of a group are left out together */
} gauge;

/* Read gauges from a CSV file (README). Return OPC_OK or an error. */
int gauges_read(const char *path, const eda_gates *gates, gauge **out,
                size_t *count, opc_error *error);

/* Make gauges from transistors: length of poly and width of active, at the
   middle of each gate, as drawn. A transistor is a group. */
void gauges_of_gates(const eda_gates *gates, gauge **out, size_t *count);

/* ---- model ---- */

enum { NODES = 7 }; /* foci between which images are interpolated */

typedef struct model {
  const opc_host *host;
  eda_model litho;
  size_t layers, nodes;
  double node[NODES]; /* defocus, nm */
  eda_field *image;   /* [layers * nodes]; empty for layers without gauges */
  const gauge *gauges;
  size_t count;
} model;

/* Simulate the layers with gauges at nodes of the defocus range focus[0] to
   focus[1], nm. `error_of_image`: largest error of the images, relative to the
   clear field. [main] */
int model_prepare(model *m, const eda_mask *mask, const opc_module *litho,
                  double margin, double error_of_image, const double focus[2],
                  opc_error *error);
void model_clear(model *m);

/* Compute the printed width of each gauge. A feature that does not print has
   the width 0. [main] */
int model_widths(const model *m, const double p[TERMS], double *width,
                 opc_error *error);

/* ---- fit ---- */

/* Result of a fit. `low` and `high` limit the 95 % interval. */
typedef struct fitted {
  double value[TERMS], sd[TERMS], low[TERMS], high[TERMS];
  double correlation[TERMS][TERMS];
  uint8_t at_bound[TERMS], open[TERMS]; /* open: not determined by the gauges */
  double weak[TERMS]; /* direction that the gauges determine least, in parts
                         of the ranges */
  double cost;        /* sum of |errors| in standard deviations */
} fitted;

typedef struct fitting {
  model *model;
  double from[TERMS], to[TERMS]; /* range; equal if the parameter is fixed */
  uint8_t is_free[TERMS];
  double robust; /* Huber's constant, in standard deviations; INFINITY: least
                    squares */
  uint8_t *use;  /* [gauges]: 0 for gauges that the fit leaves out */
  double *width, *weight; /* [gauges]: printed width, and robust weight of the
                             last fit */
} fitting;

/* Fit from the values `start` (Levenberg and Marquardt, GSL, with iterated
   weights; P. J. Huber, 1964). Set value and cost. [main] */
int fit_run(fitting *f, const double start[TERMS], fitted *out,
            opc_error *error);

/* Compute standard deviations, intervals and correlations of a fit. [main] */
int fit_intervals(fitting *f, fitted *out, opc_error *error);

/* ---- step ---- */

typedef struct calibrate {
  const opc_host *host;
  const eda_mask *mask;
  const char *path;
  const opc_module *litho;
  opc_reals range[TERMS];
  int64_t starts, folds;
  int loss;
  double margin, image_error;
  gauge *gauges;
  size_t count;
  model model;
  fitting fit;
  fitted best;
  double *start_cost;               /* [starts] */
  double *residual, *left, *weight; /* [count]: fitted minus measured width;
                                     the same with the gauge left out */
} calibrate;

/* Publish tables, metrics and findings. */
int calibrate_report(calibrate *c, opc_error *error);
