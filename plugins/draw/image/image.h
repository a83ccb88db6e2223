/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of draw.image. */
#ifndef OPCFLOW_DRAW_IMAGE_H
#define OPCFLOW_DRAW_IMAGE_H

#include <opcflow/litho.h>

#include "../view.h"

enum { IMAGE_MODELS = 4, IMAGE_LABEL = 64 };

/* A model's contours against those of the first one; NAN where one of the two
   has none in the window. */
typedef struct image_distance {
  double mean; /* signed, positive where this model prints more, nm */
  double rms;  /* nm */
  double max;  /* nm */
  double x, y; /* where, nm */
} image_distance;

/* Gates in the window, cut through their middles; NAN if none prints. */
typedef struct image_gates {
  double cd;   /* mean printed length (of active: width), nm */
  double ils;  /* mean of |dI/dl| / I at both edges, 1/nm */
  double nils; /* drawn length times the least of them, the least gate's */
  int64_t failed;
} image_gates;

/* A pair of optics and resist, and what it made of the mask. */
typedef struct image_model {
  char label[IMAGE_LABEL];
  const opc_module *litho, *resist;
  opc_field image, print; /* intensity, level set */
  double low, high;       /* intensity along its contours; NAN: none */
  image_distance distance;
  image_gates gates;
} image_model;

typedef struct image_run {
  view view;
  const opc_gates *gates;
  int layer;              /* OPC_POLY, OPC_ACTIVE */
  const opc_shapes *mask; /* of that layer */
  int corrected;          /* whether it is another one than drawn */
  double margin;          /* of clear field around the layout, nm */
  double brightest;       /* the end of the colour scale, clear field 1 */
  size_t n;
  image_model model[IMAGE_MODELS];
} image_run;

/* ---- models.c ---- */

/* Calibrate all models and print the mask by each: image and print. */
int image_simulate(image_run *r, opc_error *error);

/* ---- distance.c ---- */

/* Low, high and distance of all models. */
int image_measure_contours(image_run *r, opc_error *error);

/* ---- report.c ---- */

/* Gates of all models, the table, the metrics. */
int image_report(image_run *r, opc_error *error);

/* ---- picture.c ---- */

int image_draw(image_run *r, int format, const char *path, opc_error *error);

#endif
