/* SPDX-License-Identifier: BSD-3-Clause */
/* Correction for several doses, foci, mask errors and overlays. Each
   combination of them is a corner. An overlay displaces the image of active
   against poly.

   The loop and the synthesizers receive, for each transistor, weighted
   geometric means of Ion, Ioff and area over the corners. If a displacement
   changes log(Ion) equally at all corners, the sum of squared deviations of
   log(Ion) is smallest when the geometric mean equals the drawn Ion.

   Unless `free` is set, the mean difference between the corners and the nominal
   figure, over all transistors of a type, is not corrected. A change of dose
   would have the same effect as such a correction. The remaining difference of
   a transistor is scaled down so that nominal Ion changes by at most
   `ion_cost`. Flags, images and the final report refer to the nominal
   conditions; the history and the trace contain the means. Regulators receive
   the smallest extension over the nominal condition and all overlays. */
#pragma once

#include <eda/print.h>
#include <opcflow/plugin.h>

struct loop;

/* Parameters of the corners. */
typedef struct corners_request {
  opc_reals dose, focus, mask_error; /* values in %, nm and nm; empty: nominal
                                        only */
  opc_reals weight;
  opc_reals overlay_x, overlay_y; /* nm */
  double ion_cost; /* largest |deviation of nominal Ion| caused by corners, % */
  int free;        /* 1: no bound by ion_cost */
} corners_request;

/* A dose (%), a focus (nm), a mask error (nm), and a displacement of active
   against poly (nm), relative to the nominal conditions. */
typedef struct corner {
  double dose, focus, mask_error, overlay_x, overlay_y;
  double weight;   /* the sum over all corners is 1 */
  size_t exposure; /* index of the images in corners.exposure */
  eda_measurement measured;
} corner;

/* A combination of a focus and a mask error. Corners that differ only in dose
   and overlay share the images of an exposure. */
typedef struct exposure {
  eda_printer *printer; /* simulates the images: the loop's printer or `own` */
  eda_printer own;
  int32_t by;       /* outward displacement of all edges, in grid steps */
  eda_shapes *mask; /* [layers], displaced mask; NULL: the loop's mask */
} exposure;

/* All corners of a correction. */
typedef struct corners {
  corners_request request;
  size_t count, exposures; /* 0: no corners */
  corner *corner;
  exposure *exposure;
  eda_performance nominal; /* nominal performance of the last simulation */
  double *extension;       /* [2 * gates], smallest extension over the nominal
                              condition and the overlays, nm; NULL: no overlay */
} corners;

/* Return OPC_OK, or OPC_INVALID if a value, a weight or the number of corners
   is not valid; *error names the first such parameter. */
OPC_EXPORT int correct_corners_check(const corners_request *request,
                                     opc_error *error);

/* Return the number of corners; 0 if no list is given. */
OPC_EXPORT size_t correct_corners_count(const corners_request *request);

/* Return the number of images per layer and simulation; 1 without corners. */
OPC_EXPORT size_t correct_corners_images(const corners_request *request);

/* Allocate the corners and their printers. Prepare the loop's printer first. Do
   nothing without corners. Return OPC_INVALID for a layout without transistors,
   a mask error that is not a multiple of the mask grid, or a focus other than 0
   of a model with fixed focus. */
OPC_EXPORT int correct_corners_begin(struct loop *loop, opc_error *error);
/* Free the corners and their printers. */
OPC_EXPORT void correct_corners_clear(struct loop *loop);

/* Simulate layers of the loop's mask at all exposures except the nominal one.
   layers[k]: 1: simulate layer k. correct_corners_print uses the fast model,
   correct_corners_refine the accurate model. */
OPC_EXPORT int correct_corners_print(struct loop *loop, const uint8_t *layers,
                                     opc_error *error);
OPC_EXPORT int correct_corners_refine(struct loop *loop, const uint8_t *layers,
                                      opc_error *error);

/* Measure all corners. corners.nominal receives the nominal performance, and
   the loop's performance is replaced by the mean over the corners. */
OPC_EXPORT int correct_corners_measure(struct loop *loop, opc_error *error);

/* Return the extensions that regulators receive, [2 * gates], nm: of the last
   measurement, or with overlays corners.extension. */
OPC_EXPORT const double *correct_corners_extension(const struct loop *loop);

/* Publish the tables "corners" and "all_corners" and CORNERS_METRICS. */
OPC_EXPORT int correct_corners_report(const struct loop *loop,
                                      opc_error *error);

/* Declare the parameters of the field `corners` of the step `state`. */
#define CORNERS_PARAMETERS(state)                                              \
  OPC_PARAMETER_NAMED("corners.dose", state, corners.dose, .type = OPC_REALS,  \
                      .unit = "%", .preset = "[]",                             \
                      .summary = "Doses to correct for, all at once"),         \
      OPC_PARAMETER_NAMED("corners.focus", state, corners.focus,               \
                          .type = OPC_REALS, .unit = "nm", .preset = "[]",     \
                          .summary =                                           \
                              "Defocus values to correct for, relative to "    \
                              "the focus of litho"),                           \
      OPC_PARAMETER_NAMED(                                                     \
          "corners.mask", state, corners.mask_error, .type = OPC_REALS,        \
          .unit = "nm", .preset = "[]",                                        \
          .summary =                                                           \
              "Outward displacements of all mask edges to correct for"),       \
      OPC_PARAMETER_NAMED(                                                     \
          "corners.overlay_x", state, corners.overlay_x, .type = OPC_REALS,    \
          .unit = "nm", .preset = "[]",                                        \
          .summary =                                                           \
              "Displacements of active against poly along x to correct for"),  \
      OPC_PARAMETER_NAMED(                                                     \
          "corners.overlay_y", state, corners.overlay_y, .type = OPC_REALS,    \
          .unit = "nm", .preset = "[]",                                        \
          .summary =                                                           \
              "Displacements of active against poly along y to correct for"),  \
      OPC_PARAMETER_NAMED(                                                     \
          "corners.weight", state, corners.weight, .type = OPC_REALS,          \
          .preset = "[]",                                                      \
          .summary =                                                           \
              "Weights of the corners: doses vary fastest, then foci, masks, " \
              "overlays in x and in y (default: normal distribution with the " \
              "outermost values at sqrt(3) sigma)"),                           \
      OPC_PARAMETER_NAMED(                                                     \
          "corners.ion_cost", state, corners.ion_cost, .type = OPC_REAL,       \
          .former = "corners.limit", .flags = OPC_AT_LEAST, .unit = "%",       \
          .preset = "0.5 %",                                                   \
          .summary =                                                           \
              "Largest |deviation of nominal Ion| of a "                       \
              "transistor that the correction at corners may cause"),          \
      OPC_PARAMETER_NAMED("corners.free", state, corners.free,                 \
                          .type = OPC_BOOL, .preset = "false",                 \
                          .summary =                                           \
                              "Correct the whole mean over the corners, "      \
                              "without the bound ion_cost")

/* Declare the metrics of correct_corners_report. */
#define CORNERS_METRICS                                                      \
  {"corners_ion_sd", "%", OPC_LOWER, 0.01,                                   \
   "standard deviation of Ion of the n- or the p-transistors, at the worst " \
   "corner"},                                                                \
      {"corners_ion_worst", "%", OPC_LOWER, 0.01,                            \
       "largest |Ion deviation| at any corner"},                             \
      {"corners_leakage", NULL, OPC_LOWER, 0.01,                             \
       "ratio of total Ioff to drawn total Ioff, at the worst corner"},      \
  {                                                                          \
    "corners_failed", NULL, OPC_LOWER, 0,                                    \
        "transistors that do not print as one transistor at some corner"     \
  }
