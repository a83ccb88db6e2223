/* SPDX-License-Identifier: BSD-3-Clause */
/* What synthesizer.newton knows of each transistor, and how prints teach it. */
#ifndef SYNTHESIZER_NEWTON_OBSERVE_H
#define SYNTHESIZER_NEWTON_OBSERVE_H

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

/* What is corrected: as the weights say; Ion and Ioff, by L and W; those and
   the area, by flat edges. */
enum { PLAIN, BALANCED, FULL, TARGETS };

/* An error is the logarithm of what is printed over what is wanted; the size of
   a transistor's errors is one figure for all three of them (size_of). */
typedef struct transistor {
  biases now;           /* of the mask that was measured last */
  int lost;             /* it did not print; what follows is of the last print
                           of it that did */
  biases good;          /* the mask */
  double x[MOVES];      /* its moves in grid steps, the jog as a part of one */
  point point;          /* on its device curve */
  double error[ERRORS]; /* its errors; at first as they will be once the line
                           ends have moved */
  double size;          /* of them; INFINITY if it never printed */
  ripple ripple;        /* of its length along W */
  double pull;          /* the error of Ion that asks for the same L */
  biases next;          /* that was asked for */
  biases best;          /* of the mask with the least size so far */
  double best_size;
  double rest_size;         /* the least size since its last move */
  response response, first; /* as learnt, and as estimated at first */
  trust trust;              /* how far its next L may go */
  int32_t room[2];          /* how far the LOW and the HIGH end of its width
                               may go out, grid steps: further out it is lost */
  int32_t furthest[2];      /* no further than there, nor where the poly is
                               thin */
  int32_t given;            /* what its ends give up in the next mask */
  int32_t end[2];           /* its line ends in the mask measured last */
  double surprise;   /* by how much the next print's log Ion may differ from
                        what the response says, as its line ends and its
                        neighbours have moved */
  uint8_t disturbed; /* the last print changed for reasons other than its
                        own moves */
  uint8_t outside;   /* the figures of the best mask come from beyond the ends
                        of the device table */
  uint8_t back;      /* its next mask is its best one */
  uint8_t verdict;
} transistor;

typedef struct newton {
  const opc_host *host;
  int target;            /* PLAIN ... */
  double weight[ERRORS]; /* of the size of errors */
  double steer[ERRORS];  /* for the L that goes with a W */
  double price;          /* % of the area that a jog has to save */
  const eda_gates *gates;
  parts *parts;                /* of each transistor */
  curve curve[2];              /* of wide transistors, by type */
  double tolerance, ion_limit; /* % */
  double gain[MOVES];
  double max_bias, min_jog; /* nm */
  int fine;
  int64_t iterations;
  const char *goals_path;
  double mean;    /* of all sizes at the print before; while all rest, the
                     least so far */
  int settled;    /* shapes and W stay; L goes on for Ion alone */
  int rest;       /* nothing was moved at the print before */
  eda_goal *goal; /* of each transistor */
  transistor *state;
  sides *sides;
  size_t count;
} newton;

int same(biases a, biases b);

/* `ion_limit` as an error. */
double ion_limit(const newton *t);

/* The weighted errors as one figure; it is |error| of one that weighs 1. */
double size_of(const newton *t, const double error[ERRORS]);

/* The parts of that mask of transistor i: its jog may have moved their ends. */
parts parts_of_mask(const newton *t, size_t i, biases b);

/* The length of that mask of transistor i, its jog as a part of a step. */
double length_in_steps(const newton *t, size_t i, biases b);

/* Whether W and shapes move for Ioff. */
int for_ioff(const newton *t);

/* Whether edges are made flatter after that print. */
int reshapes(const newton *t, const eda_feedback *f);

/* Which moves serve the weights at all. */
void free_moves(const newton *t, int free[MOVES]);

/* How far the active of a transistor goes to HIGH with that W: an end that may
   go no further out leaves the rest to the other one. */
int32_t aside_of(const transistor *s, int32_t w);

/* Take in what the mask of `moves` has printed, for all transistors. */
void observe(newton *t, const eda_feedback *f, const eda_moves *moves);

/* Take in that the next mask of transistor i will have that shape: what that
   does to its currents is foreseen. */
void reshape(newton *t, size_t i, const shape *to);

/* How much the next print may surprise each transistor. */
void foresee(newton *t, const eda_feedback *f);

#endif
