/* SPDX-License-Identifier: BSD-3-Clause */
/* State of synthesizer.newton, and its update from simulated masks. */
#pragma once

#include <opcflow/plugin.h>

#include "jog.h"
#include "response.h"
#include "shape.h"
#include "trust.h"

typedef struct biases {
  int32_t l, w, jog;
  shape shape;
  int32_t aside; /* see eda_moves.aside */
} biases;

/* Targets. PLAIN: by `weight`; BALANCED: Ion and Ioff; FULL: Ion, Ioff and the
   gate area. */
enum { PLAIN, BALANCED, FULL, TARGETS };

/* Corrections of the rounding error of L: by a jog, by W, none. */
enum { JOG, WIDTH, NONE };

/* Reasons for the remaining deviation of a transistor. */
enum {
  WITHIN,
  GRID,
  BLOCKED,
  BIAS,
  NO_PRINT,
  OUTSIDE,
  MOVING,
  LEAKS,
  LEAKS_AT_BOUND,
  VERDICTS
};

/* State of a transistor. An error is log(printed / target); errors_size
   combines the errors of a transistor into their size. */
typedef struct transistor {
  biases now;            /* last simulated mask */
  int failed;            /* 1: `now` did not print; the fields below then
                            describe `valid` */
  biases valid;          /* last mask that printed */
  double x[MOVES];       /* moves of `valid`, grid steps; a jog is a fraction of
                            a step */
  point point;           /* measured point of the device curve */
  double error[ERRORS];  /* errors of `valid`; in the first iteration those
                            expected after the moves of line ends */
  double size;           /* size of the errors; INFINITY if no mask has
                            printed */
  ripple ripple;         /* ripple of the length along W; known while W
                            corrects Ioff, of a transistor that may move */
  double excess[ERRORS]; /* part of `error` that is expected of the ripple of
                            the next mask */
  double pull;           /* pull: error of Ion alone that requires the same move
                            of L as `error` */
  biases next;           /* requested mask */
  biases best;           /* mask with the least size so far */
  double best_size, best_error[ERRORS];
  double settled_size;      /* least size of the errors since the transistor
                               last moved */
  response response, first; /* current and initial response */
  trust trust;              /* trust region of the next L */
  int32_t print_limit[2];   /* largest outward moves, grid steps, of the LOW and
                               HIGH ends of the width at which the gate still
                               prints */
  int32_t outward_limit[2]; /* print_limit, also limited to the region where the
                               printed length does not leak */
  int32_t inward_limit[2];  /* least outward moves of both ends; 0 and less */
  int32_t free_end[2];      /* outward moves of both ends in the last mask that
                               the regulator allowed to be narrower */
  int32_t given;            /* grid steps by which bound_ends narrows W */
  int32_t end[2];           /* line ends of the last simulated mask */
  double uncertainty;       /* uncertainty of the next log Ion due to line ends,
                               shapes and neighbours */
  double noise;      /* part of `uncertainty` without the transistor's own
                        moves */
  uint8_t disturbed; /* 1: other causes than the transistor's own moves changed
                        the currents */
  uint8_t outside;   /* 1: currents of the best mask are extrapolated beyond
                        the device table */
  uint8_t tries;     /* moves since the best mask that did not improve it */
  uint8_t verdict;
} transistor;

typedef struct newton {
  const opc_host *host;
  int target;            /* PLAIN ... */
  double weight[ERRORS]; /* weights of errors in their size */
  double steer[ERRORS];  /* weights for the choice of L */
  double price;          /* reduction of the area deviation that justifies a
                            jog, % */
  const eda_gates *gates;
  parts *parts;                /* [count], division of each transistor along
                                  W */
  curve curve[2];              /* [type], slopes of wide transistors */
  double tolerance, ion_limit; /* % */
  double gain[MOVES];
  double max_bias, min_jog; /* nm */
  int fine;
  int64_t iterations;
  const char *goals_path;
  double mean;    /* mean size in the last iteration; while `rest` is 1, the
                     least mean since the stop */
  int settled;    /* 1: shapes and W are final; L alone corrects Ion */
  int reported;   /* 1: missing convergence was logged */
  int rest;       /* 1: newton_is_done was true in the last iteration */
  eda_goal *goal; /* [count], goal of each transistor */
  transistor *state;
  sides *sides;
  size_t count;
} newton;

int biases_equal(biases a, biases b);

/* Return `tolerance` as an error. */
double newton_tolerance(const newton *t);

/* Return `ion_limit` as an error. */
double newton_ion_limit(const newton *t);

/* Return the error below which the method may stop: `ion_limit` minus a reserve
   for moves of neighbours and the accurate simulation. */
double newton_stop(const newton *t);

/* Return the size of errors: the root of the weighted sum of squares. */
double errors_size(const newton *t, const double error[ERRORS]);

/* Return the parts of mask `b` of transistor i, with no end closer than the
   minimum to the jog. */
parts mask_parts(const newton *t, size_t i, biases b);

/* Return the effective change of L by mask `b` of transistor i, grid steps; a
   jog counts as a fraction of a step. */
double mask_length(const newton *t, size_t i, biases b);

/* Return the same, with the parts `of` that mask_parts has returned for `b`. */
double parts_length(const newton *t, size_t i, const parts *of, biases b);

/* Return the change of the printed length by a grid step of L, nm: the estimate
   for all transistors of a type. */
double length_gain(const transistor *s);

/* Return whether the line ends a and b, [2] each, differ significantly. */
int ends_moved(const eda_gates *g, const int32_t *a, const int32_t *b);

/* Return whether W moves to correct Ioff. */
int corrects_ioff(const newton *t);

/* Return whether parts of edges may move in this iteration. */
int newton_reshapes(const newton *t, const eda_feedback *f);

/* Set free[m] to 1 for each move m that the weights require, and to 0 for other
   moves. */
void moves_free(const newton *t, int free[MOVES]);

/* Return the largest W whose ends are within their limits, grid steps. */
double width_limit(const transistor *s);

/* Return the least W whose ends are within their limits, grid steps. */
double width_least(const transistor *s);

/* Return whether an end of the last mask is further in than its limit while W
   may move. */
int width_is_short(const newton *t, const transistor *s);

/* Return the shift of both ends of the width towards HIGH, grid steps, at a
   width bias `w`: if one end is at a limit, the other end moves further. */
int32_t width_aside(const transistor *s, int32_t w);

/* Update the state of all transistors from the simulated mask of `moves`. */
void newton_observe(newton *t, const eda_feedback *f, const eda_moves *moves);

/* Set the errors of transistor i to those predicted after the change of the
   ripple by mask `to`; the change of L and W is not included. */
void newton_foresee(newton *t, size_t i, biases to);

/* Compute the uncertainty of the next log Ion of each transistor. */
void newton_predict(newton *t, const eda_feedback *f);

/* Report transistors beyond the limit that could move after the last iteration,
   once, with the worst of them. */
void newton_log_unconverged(newton *t, int64_t print);
