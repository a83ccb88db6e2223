/* SPDX-License-Identifier: BSD-3-Clause */
/* Response of the errors of a transistor to moves of the transistor's mask, and
   computation of the move that corrects the errors. */
#pragma once

#include <eda/synthesizer.h>

/* Errors: log(printed / target). Moves: L and W in grid steps; a jog is a
   fraction of a step of L. */
enum {
  ION = EDA_GOAL_ION,
  IOFF = EDA_GOAL_IOFF,
  AREA = EDA_GOAL_AREA,
  ERRORS = EDA_GOAL_TARGETS
};
enum { BY_L, BY_W, MOVES };

/* by: d error / d move, per grid step. doubt: relative uncertainty of `by`. */
typedef struct response {
  double by[ERRORS][MOVES], doubt[MOVES];
  double slope[2]; /* d log(I / W) / dL of Ion and Ioff, 1/nm, the device
                      slopes that `by` contains */
} response;

/* Slopes of wide transistors of one type, 1/nm: d log(I / W) / dL for both
   currents, and d log(area / W) / dL. */
typedef struct curve {
  double slope[ERRORS];
} curve;

/* A point of each device curve of a transistor, of Ion and of Ioff: equivalent
   length, nm, and log(I / W). All are NAN if unknown. */
typedef struct point {
  double length[2], drive[2];
} point;

point point_of(const eda_performance *p, size_t i);

/* Compute the slopes of both types from the currents and equivalent lengths of
   printed transistors. If no transistor of a type printed, the slopes are
   those of the Ion of a long channel, -1 / L. */
void curves_measure(const eda_feedback *f, curve out[2]);

/* Compute the errors of gate i. Return 0 and set the errors to 0 if the gate
   has no currents, or prints open, merged or in pieces. */
int errors_of(const eda_feedback *f, size_t i, const double target[ERRORS],
              double out[ERRORS]);

/* Change the errors of gate i to those expected after short line ends are
   repaired. */
void errors_with_line_ends(const eda_feedback *f, size_t i,
                           const curve *of_type, double error[ERRORS]);

/* Return the initial response of gate i. `gain`: d printed / d mask of each
   move. */
response response_first(const eda_gates *gates, size_t i, const curve *of_type,
                        const double gain[MOVES]);

/* Scale a response and the initial response to the slope of each device curve
   between two points. A slope remains if the points are less than `least` nm
   apart or the slope between them is not negative. */
void response_bend(response *r, response *first, point from, point to,
                   double least);

/* Update a response by Broyden's formula, weighted by the uncertainties. dx:
   move; de: change of the errors. Other causes change log Ion by `noise`
   (standard deviation). A change that differs from the prediction by more than
   tuned.odd_surprise standard deviations counts as one that differs by so many,
   because it has another cause. tuned.trust limits the ratio of the response to
   `first`. */
void response_learn(response *r, const response *first, const double dx[MOVES],
                    const double de[ERRORS], double noise);

/* Compute the move that minimizes the sum of weight[k] * error[k]^2 for a
   linear response. dx[m] is 0 where free[m] is 0. */
void response_solve(const response *r, const double error[ERRORS],
                    const double weight[ERRORS], const int free[MOVES],
                    double dx[MOVES]);
