/* SPDX-License-Identifier: BSD-3-Clause */
/* State of the transistors in synthesizer.newton, and its update from simulated
   masks. */
#pragma once

#include <opcflow/plugin.h>

#include "jog.h"
#include "response.h"
#include "shape.h"
#include "trust.h"

typedef struct biases {
  int32_t l, w, jog;
  shape shape;
  int32_t aside; /* as eda_moves.aside */
} biases;

/* Targets: by the weights; Ion and Ioff by L and W; both and the area, with
   flat edges. */
enum { PLAIN, BALANCED, FULL, TARGETS };

/* State of a transistor. An error is the logarithm of printed over target;
   errors_size combines the errors of a transistor into one figure. */
typedef struct transistor {
  biases now;           /* mask measured last */
  int failed;           /* 1: that mask did not print; the following figures are
                           those of the last mask that did */
  biases valid;         /* last mask that printed */
  double x[MOVES];      /* moves of that mask in grid steps, the jog as a
                           fraction */
  point point;          /* point on the device curve */
  double error[ERRORS]; /* errors; in the first iteration those expected after
                           the line ends have moved */
  double size;          /* size of the errors; INFINITY if no mask has
                           printed */
  ripple ripple;        /* ripple of the length along W */
  double pull;          /* error of Ion that requires the same move of L */
  biases next;          /* requested mask */
  biases best;          /* mask of the least size so far */
  double best_size;
  double settled_size;      /* least size since the last move */
  response response, first; /* learnt and initial response */
  trust trust;              /* trust region of the next L */
  int32_t print_limit[2];   /* largest outward moves of the LOW and HIGH end of
                               the width, grid steps; the gate did not print
                               beyond */
  int32_t outward_limit[2]; /* the same, limited also to the region where the
                               poly is not thin */
  int32_t given;            /* grid steps of width that the ends lose in the
                               next mask */
  int32_t end[2];           /* line ends of the mask measured last */
  double uncertainty; /* uncertainty of the next log Ion, beyond that of the
                         response, caused by line ends and neighbours */
  uint8_t disturbed;  /* 1: causes other than its own moves changed the
                         transistor */
  uint8_t outside;    /* 1: the figures of the best mask are extrapolated beyond
                         the device table */
  uint8_t revert;     /* 1: the next mask is the best one */
  uint8_t verdict;
} transistor;

typedef struct newton {
  const opc_host *host;
  int target;            /* PLAIN ... */
  double weight[ERRORS]; /* weights in the size of errors */
  double steer[ERRORS];  /* weights for the L that compensates a W */
  double price;          /* % of the area that a jog has to save */
  const eda_gates *gates;
  parts *parts;                /* parts of each transistor */
  curve curve[2];              /* curve of wide transistors, by type */
  double tolerance, ion_limit; /* % */
  double gain[MOVES];
  double max_bias, min_jog; /* nm */
  int fine;
  int64_t iterations;
  const char *goals_path;
  double mean;    /* mean size of the last iteration; while all rest, the least
                     so far */
  int settled;    /* 1: shapes and W are final; L alone corrects Ion */
  int reported;   /* 1: the missing convergence is reported */
  int rest;       /* 1: nothing moved in the last iteration */
  eda_goal *goal; /* goal of each transistor */
  transistor *state;
  sides *sides;
  size_t count;
} newton;

int biases_equal(biases a, biases b);

/* Return `ion_limit` as an error. */
double newton_ion_limit(const newton *t);

/* Return the weighted size of errors; |error| for a single error of weight
   1. */
double errors_size(const newton *t, const double error[ERRORS]);

/* Return the parts of a mask of transistor i; the jog may have moved their
   ends. */
parts mask_parts(const newton *t, size_t i, biases b);

/* Return the length of a mask of transistor i in grid steps, the jog as a
   fraction. */
double mask_length(const newton *t, size_t i, biases b);

/* Return whether W and shapes move for Ioff. */
int corrects_ioff(const newton *t);

/* Return whether edges are flattened in this iteration. */
int newton_reshapes(const newton *t, const eda_feedback *f);

/* Set free[m] to 1 for each move that the weights use. */
void moves_free(const newton *t, int free[MOVES]);

/* Return the shift of the active of a transistor to HIGH for a width `w`: if
   one end is at its limit, the other end takes the remainder. */
int32_t width_aside(const transistor *s, int32_t w);

/* Update the state of all transistors from the simulated mask of `moves`. */
void newton_observe(newton *t, const eda_feedback *f, const eda_moves *moves);

/* Set the shape of the next mask of transistor i and predict the effect on its
   currents. */
void newton_reshape(newton *t, size_t i, const shape *to);

/* Compute the uncertainty of the next log Ion of each transistor. */
void newton_predict(newton *t, const eda_feedback *f);
