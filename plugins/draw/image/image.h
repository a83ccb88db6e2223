/* SPDX-License-Identifier: BSD-3-Clause */
/* Declarations shared by the files of draw.image. */
#pragma once

#include <eda/imaging.h>

#include "../view.h"

/* Largest number of models in a picture. */
enum { IMAGE_MODELS = 4 };

/* Distance of a model's contours from the contours of the first model; NAN if
   either model has no contour in the window. */
typedef struct image_distance {
  double mean; /* signed mean, positive where this model prints more, nm */
  double rms;  /* nm */
  double max;  /* nm */
  double x, y; /* position of the largest distance, nm */
} image_distance;

/* Means over the gates in the window, measured at their centres; NAN if no gate
   prints. */
typedef struct image_gates {
  double cd;   /* mean printed length; for active, mean printed width; nm */
  double ils;  /* image log slope: mean of |dI/dl| / I at both edges, 1/nm */
  double nils; /* smallest product of drawn length and log slope (NILS) */
  int64_t failed;
} image_gates;

/* A pair of optics and resist with its results. */
typedef struct image_model {
  const char *group; /* name of the parameter group: "first" */
  char *label;
  const opc_module *litho, *resist;
  eda_field image, print; /* intensity, level set */
  double low, high; /* range of the intensity along the contours; NAN without
                       contours */
  image_distance distance;
  image_gates gates;
} image_model;

/* The instance of draw.image. */
typedef struct image_run {
  const opc_host *host;
  view view;
  struct {
    const eda_mask *mask;
    const eda_gates *gates;
    const char *layer;
    double margin; /* clear field around the layout, nm */
    struct {
      const char *label;
      const opc_module *litho, *resist;
    } model[IMAGE_MODELS];
  } asked; /* parameters */
  eda_mask
      *part; /* for a mask by classes, the flat mask of the window; or NULL */
  const eda_gates *gates;
  size_t layer;             /* layer of the gates */
  const eda_shapes *shapes; /* mask of that layer */
  int corrected;            /* 1: the mask differs from the drawn shapes */
  double brightest; /* end of the colour scale, relative to the clear field */
  size_t n;
  image_model model[IMAGE_MODELS];
} image_run;

/* ---- distance.c ---- */

/* Compute low, high and distance of all models. Returns OPC_OK or an error
   code. */
int image_measure_contours(image_run *r, opc_error *error);

/* ---- report.c ---- */

/* Measure the gates of all models and write the table and metrics. Returns
   OPC_OK or an error code. */
int image_report(image_run *r, opc_error *error);

/* ---- picture.c ---- */

/* Draw the picture. */
int image_draw(image_run *r, opc_error *error);
