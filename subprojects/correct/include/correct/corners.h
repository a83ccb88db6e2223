/* SPDX-License-Identifier: BSD-3-Clause */
/* A correction that is to stand several doses, foci and mask errors: each of
   one with each of the others is a corner.

   What the loop judges and synthesizers see of a transistor is then the
   weighted geometric mean of its currents and of its area over the corners.
   Where the logarithm of a current answers to a move alike at all corners, a
   mean that is as drawn is the least sum of squares of its logarithmic
   deviations. Unless that is free, it is so only for what transistors of a type
   do not have in common, and as far as nominal Ion stays within `ion_cost`.
   Flags, prints and line ends are those of the nominal print, and so are the
   figures of the result. */
#ifndef CORRECT_CORNERS_H
#define CORRECT_CORNERS_H

#include <eda/print.h>
#include <opcflow/plugin.h>

struct loop;

/* As the parameters say. */
typedef struct corners_wish {
  opc_reals dose, focus, mask_error; /* %, nm, nm */
  opc_reals weight;
  double ion_cost; /* %: what corners may make nominal Ion deviate, */
  int free;        /* unless this is set */
} corners_wish;

typedef struct corner {
  double dose, focus, mask_error;
  double weight; /* the sum of all is 1 */
  size_t exposure;
  eda_measurement measured;
} corner;

/* What needs images of its own: a focus and a mask error. */
typedef struct exposure {
  eda_printer *printer; /* the loop's, or `own` */
  eda_printer own;
  int32_t by;       /* all edges are moved out by so many grid steps */
  eda_shapes *mask; /* [layers], of that; NULL: the loop's */
} exposure;

typedef struct corners {
  corners_wish wish;
  size_t count, exposures; /* 0: there are none */
  corner *corner;
  exposure *exposure;
  eda_performance nominal; /* of the last print */
} corners;

/* Whether the wish can be. */
OPC_EXPORT int correct_corners_check(const corners_wish *wish,
                                     opc_error *error);

/* How many images of a layer each print takes, 1 if there are no corners. */
OPC_EXPORT size_t correct_corners_images(const corners_wish *wish);

/* The printer of the loop is prepared. */
OPC_EXPORT int correct_corners_begin(struct loop *loop, opc_error *error);
OPC_EXPORT void correct_corners_clear(struct loop *loop);

/* Print the loop's mask, those layers that are marked; with the fine model,
   after the loop's own printer has. */
OPC_EXPORT int correct_corners_print(struct loop *loop, const uint8_t *layers,
                                     opc_error *error);
OPC_EXPORT int correct_corners_refine(struct loop *loop, const uint8_t *layers,
                                      opc_error *error);

/* Measure at all corners: what the loop measured becomes `nominal`, and the
   mean of all what the loop has measured. */
OPC_EXPORT int correct_corners_measure(struct loop *loop, opc_error *error);

/* The table and metrics of all corners. */
OPC_EXPORT int correct_corners_report(const struct loop *loop,
                                      opc_error *error);

#define CORNERS_PARAMETERS(state)                                             \
  OPC_PARAMETER_NAMED("corners.dose", state, corners.dose, .type = OPC_REALS, \
                      .unit = "%", .preset = "[]",                            \
                      .summary = "correct for all of these doses"),           \
      OPC_PARAMETER_NAMED("corners.focus", state, corners.focus,              \
                          .type = OPC_REALS, .unit = "nm", .preset = "[]",    \
                          .summary =                                          \
                              "correct for all of these distances from the "  \
                              "focus of litho"),                              \
      OPC_PARAMETER_NAMED("corners.mask", state, corners.mask_error,          \
                          .type = OPC_REALS, .unit = "nm", .preset = "[]",    \
                          .summary =                                          \
                              "correct for masks whose edges have all "       \
                              "moved out by these"),                          \
      OPC_PARAMETER_NAMED("corners.weight", state, corners.weight,            \
                          .type = OPC_REALS, .preset = "[]",                  \
                          .summary =                                          \
                              "one for each corner, doses first, then foci, " \
                              "then masks; if not given, that of a normal "   \
                              "distribution whose sqrt(3) sigma the "         \
                              "outermost values are"),                        \
      OPC_PARAMETER_NAMED("corners.ion_cost", state, corners.ion_cost,        \
                          .type = OPC_REAL, .former = "corners.limit",        \
                          .flags = OPC_AT_LEAST, .unit = "%",                 \
                          .preset = "0.5 %",                                  \
                          .summary =                                          \
                              "Largest |deviation of nominal Ion| that the "  \
                              "corners may cost a transistor"),               \
      OPC_PARAMETER_NAMED("corners.free", state, corners.free,                \
                          .type = OPC_BOOL, .preset = "false",                \
                          .summary =                                          \
                              "no such limit: the mean over the corners "     \
                              "is to be as drawn")

#define CORNERS_METRICS                                                      \
  {"corners_ion_sd", "%", OPC_LOWER, 0.01,                                   \
   "standard deviation of Ion of the n- or the p-transistors, at the worst " \
   "corner"},                                                                \
      {"corners_ion_worst", "%", OPC_LOWER, 0.01,                            \
       "largest |Ion deviation| at any corner"},                             \
      {"corners_leakage", NULL, OPC_LOWER, 0.01,                             \
       "total Ioff over that as drawn, at the worst corner"},                \
  {                                                                          \
    "corners_failed", NULL, OPC_LOWER, 0,                                    \
        "transistors that do not print as one of their own at some corner"   \
  }

#endif
