/* SPDX-License-Identifier: BSD-3-Clause */
/* State of the step `calibrate`: gauges, model and fit. Lengths in nm. */
#pragma once

#include <eda/print.h>
#include <opcflow/step.h>

/* Parameters of the model. A gauge of the active layer uses ACTIVE_THRESHOLD,
   gauges of all other layers THRESHOLD. NA and SIGMA are NAN if the flow sets
   no range: the values of the litho model then apply. */
enum {
  THRESHOLD,
  ACTIVE_THRESHOLD,
  DIFFUSION,
  DEFOCUS,
  NA,
  SIGMA,
  BIAS,
  BIAS_DENSITY,
  TERMS
};

/* Names of the parameters, and their units (NULL for a number without unit). */
extern const char *const term_name[TERMS], *const term_unit[TERMS];

enum { MASKS = 4 }; /* largest number of masks in a calibration */

/* ---- gauges ---- */

/* A measured width: that of the line (`space` 0) or the space (1) that contains
   the point (x, y), along `axis`. */
typedef struct gauge {
  int32_t mask, layer, axis, space;
  double x, y, width, sd;
  double density; /* part of the area around the gauge that shapes cover */
  size_t group;   /* gauges of a group are left out together */
} gauge;

/* Read gauges of the masks from a CSV file (README). Return OPC_OK or an
   error. */
int gauges_read(const char *path, const eda_mask *const *masks, size_t n_masks,
                gauge **out, size_t *count, opc_error *error);

/* Drawn sizes of the transistors that are gauges: length of poly and width of
   active, or one of both. */
enum { DRAWN_BOTH, DRAWN_LENGTHS, DRAWN_WIDTHS };

/* Make gauges from the transistors of all masks: the drawn sizes `drawn`
   (DRAWN_*), at the middle of each gate. A transistor is a group. */
void gauges_of_gates(const eda_mask *const *masks, size_t n_masks, int drawn,
                     gauge **out, size_t *count);

/* ---- model ---- */

/* Parameters of the optics. Images are simulated at nodes of these parameters,
   and interpolated between the nodes. */
enum { ALONG_NA, ALONG_SIGMA, ALONG_FOCUS, AXES };
enum { NODES = 7 }; /* largest number of nodes of a parameter */

typedef struct model {
  const opc_host *host;
  const eda_mask *const *masks;
  size_t n_masks;
  const opc_module *optics; /* of the slot `litho` */
  double margin;            /* clear field around the masks, nm */
  double image_error; /* largest error of the images, relative to the clear
                         field */
  gauge *gauges;
  size_t count;

  /* Set by model_prepare. */
  eda_model litho;
  size_t n[AXES], nodes; /* nodes of each parameter, and their product */
  double node[AXES][NODES];
  /* [layers * nodes] of each mask; empty for layers without gauges */
  eda_field *image[MASKS];
} model;

/* Simulate the layers with gauges at nodes of the ranges `from` to `to` of the
   optics. [main] */
int model_prepare(model *m, const double from[TERMS], const double to[TERMS],
                  opc_error *error);
void model_clear(model *m);

/* Set gauge.density of all gauges: the average of the mask's shapes, weighted
   by a Gaussian with the standard deviation `range`, nm. [main] */
int model_densities(model *m, double range, opc_error *error);

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
  const eda_mask *given[MASKS]; /* inputs; NULL: not given */
  const eda_mask *mask[MASKS];  /* the n_masks given masks */
  size_t n_masks;
  const char *path;
  const opc_module *litho;
  opc_reals range[TERMS];
  int64_t starts, folds;
  int loss, leave, drawn;
  double margin, image_error, density_range;
  gauge *gauges;
  size_t count;
  model model;
  fitting fit;
  fitted best;
  double *start_cost;               /* [starts] */
  double *residual, *left, *weight; /* [count]: fitted minus measured width;
                                     the same with the gauge left out */
  double interpolation; /* rms of widths by interpolated images minus widths by
                           images at the estimates, nm; NAN: no interpolation */
} calibrate;

/* Publish tables, metrics and findings. */
int calibrate_report(calibrate *c, opc_error *error);
