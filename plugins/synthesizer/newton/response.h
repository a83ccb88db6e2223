/* SPDX-License-Identifier: BSD-3-Clause */
/* How a transistor's errors answer to its mask, and the correction that
   follows. */
#ifndef SYNTHESIZER_NEWTON_RESPONSE_H
#define SYNTHESIZER_NEWTON_RESPONSE_H

#include <eda/synthesizer.h>

/* Errors: logarithms of printed over drawn. Moves: L (with a jog, a fraction of
   a grid step) and W, in grid steps. */
enum {
  ION = EDA_GOAL_ION,
  IOFF = EDA_GOAL_IOFF,
  AREA = EDA_GOAL_AREA,
  ERRORS = EDA_GOAL_TARGETS
};
enum { BY_L, BY_W, MOVES };

/* `doubt` is how well each move's response is known, as a part of it. */
typedef struct response {
  double by[ERRORS][MOVES], doubt[MOVES];
  double slope; /* of the device curve, d log(I / W) / dL, where that holds */
} response;

/* What wide transistors of a type do: d log(I / W) / dL, 1/nm, and d L / d mask
   L as the first prints have it. */
typedef struct curve {
  double slope[ERRORS];
} curve;

/* A point of a transistor's device curve: its equivalent length, nm, and
   log(I / W) there; NAN if it has none. */
typedef struct point {
  double length, drive;
} point;

point point_of(const eda_performance *p, size_t i);

/* The slopes of the device curves of both types, from the printed transistors'
   equivalent lengths; without prints that tell, Ion ~ 1 / L. */
void curves_from(const eda_feedback *f, curve out[2]);

/* Log errors of gate i; 0 and no errors if it has no performance, or prints
   open, merged or in pieces. */
int errors_of(const eda_feedback *f, size_t i, const double target[ERRORS],
              double out[ERRORS]);

/* What errors_of will be once line ends that print short have grown. */
void with_line_ends(const eda_feedback *f, size_t i, const curve *of_type,
                    double error[ERRORS]);

/* The response of gate i before it was ever moved. `gain` is d printed / d mask
   of each move. */
response first_response(const eda_gates *gates, size_t i, const curve *of_type,
                        const double gain[MOVES]);

/* Let a response and its first estimate hold for lengths between the two
   points of the device curve, which bends. If they are less than `least` (nm)
   apart, or tell no slope that falls, nothing changes. */
void bend(response *r, response *first, point from, point to, double least);

/* Broyden's update, weighted by how well each response is known: after a move
   by dx the errors changed by de, of which `noise` may come from elsewhere. The
   response stays near `first`. */
void learn(response *r, const response *first, const double dx[MOVES],
           const double de[ERRORS], double noise);

/* The move that makes sum of weight[k] * error[k]^2 least for a linear
   response; a move with free[m] = 0 is not used. */
void solve(const response *r, const double error[ERRORS],
           const double weight[ERRORS], const int free[MOVES],
           double dx[MOVES]);

#endif
