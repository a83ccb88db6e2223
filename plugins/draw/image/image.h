/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of draw.image. */
#ifndef OPCFLOW_DRAW_IMAGE_H
#define OPCFLOW_DRAW_IMAGE_H

#include <eda/imaging.h>

#include "../view.h"

enum { IMAGE_MODELS = 4 };

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
  const char *group; /* of its parameters: "first" */
  char *label;
  const opc_module *litho, *resist;
  eda_field image, print; /* intensity, level set */
  double low, high;       /* intensity along its contours; NAN: none */
  image_distance distance;
  image_gates gates;
} image_model;

typedef struct image_run {
  const opc_host *host;
  view view;
  struct {
    const eda_mask *mask;
    const eda_gates *gates;
    const char *layer;
    double margin; /* of clear field around the layout, nm */
    struct {
      const char *label;
      const opc_module *litho, *resist;
    } model[IMAGE_MODELS];
  } asked; /* parameters */
  const eda_gates *gates;
  size_t layer;             /* which of theirs */
  const eda_shapes *shapes; /* of the mask of that layer */
  int corrected;            /* whether these are others than drawn */
  double brightest;         /* the end of the colour scale, clear field 1 */
  size_t n;
  image_model model[IMAGE_MODELS];
} image_run;

/* ---- distance.c ---- */

/* Low, high and distance of all models. */
int image_measure_contours(image_run *r, opc_error *error);

/* ---- report.c ---- */

/* Gates of all models, the table, the metrics. */
int image_report(image_run *r, opc_error *error);

/* ---- picture.c ---- */

int image_draw(image_run *r, opc_error *error);

#endif
