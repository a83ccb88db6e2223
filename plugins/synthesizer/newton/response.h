/* SPDX-License-Identifier: BSD-3-Clause */
/* Response of the errors of a transistor to moves of its mask, and the
   resulting correction. */
#pragma once

#include <eda/synthesizer.h>

/* Errors: logarithms of printed over target. Moves: L (with a jog, a fraction
   of a grid step) and W, in grid steps. */
enum {
  ION = EDA_GOAL_ION,
  IOFF = EDA_GOAL_IOFF,
  AREA = EDA_GOAL_AREA,
  ERRORS = EDA_GOAL_TARGETS
};
enum { BY_L, BY_W, MOVES };

/* Response to the moves. `doubt` is the relative uncertainty for each move. */
typedef struct response {
  double by[ERRORS][MOVES], doubt[MOVES];
  double slope; /* slope of the device curve, d log(I / W) / dL, of that
                   response */
} response;

/* Response of wide transistors of a type: d log(I / W) / dL, 1/nm, and d L / d
   mask L from the first simulations. */
typedef struct curve {
  double slope[ERRORS];
} curve;

/* A point of the device curve of a transistor: equivalent length, nm, and log(I
   / W); NAN without one. */
typedef struct point {
  double length, drive;
} point;

point point_of(const eda_performance *p, size_t i);

/* Compute the slopes of the device curves of both types from the equivalent
   lengths of printed transistors; without valid ones, Ion ~ 1 / L. */
void curves_measure(const eda_feedback *f, curve out[2]);

/* Compute the log errors of gate i. Return 0 and no errors if the gate has no
   performance, or prints open, merged or in pieces. */
int errors_of(const eda_feedback *f, size_t i, const double target[ERRORS],
              double out[ERRORS]);

/* Compute the errors expected once line ends that print short have grown. */
void errors_with_line_ends(const eda_feedback *f, size_t i,
                           const curve *of_type, double error[ERRORS]);

/* Return the response of gate i before any move. `gain` is d printed / d mask
   of each move. */
response response_first(const eda_gates *gates, size_t i, const curve *of_type,
                        const double gain[MOVES]);

/* Adapt a response and its first estimate to lengths between two points of the
   device curve, which is not straight. Nothing changes if the points are less
   than `least` (nm) apart or the slope between them does not fall. */
void response_bend(response *r, response *first, point from, point to,
                   double least);

/* Update a response by Broyden's formula, weighted by the uncertainties: after
   a move by dx the errors changed by de, with an uncertainty of `noise` from
   other causes. The response stays near `first`. */
void response_learn(response *r, const response *first, const double dx[MOVES],
                    const double de[ERRORS], double noise);

/* Compute the move that minimizes the sum of weight[k] * error[k]^2 for a
   linear response, without moves m with free[m] = 0. */
void response_solve(const response *r, const double error[ERRORS],
                    const double weight[ERRORS], const int free[MOVES],
                    double dx[MOVES]);
