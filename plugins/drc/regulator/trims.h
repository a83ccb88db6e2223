/* SPDX-License-Identifier: BSD-3-Clause */
/* Edges of poly that go back where the gap before them does not print: those
   that no transistor and no contact needs. */
#ifndef OPCFLOW_REGULATOR_TRIMS_H
#define OPCFLOW_REGULATOR_TRIMS_H

#include "sites.h"

typedef struct trim {
  opc_box wall;          /* a stretch of a drawn edge, flat; grid steps */
  int side;              /* of it, on which the gap lies */
  int32_t room, depth;   /* how far it may go back, and does */
  int32_t front;         /* half of the gap, which patches are to leave as well */
  uint32_t round;        /* when it last went back */
} trim;

typedef struct trims {
  trim *at;
  size_t n, most;
  int32_t (*pair)[2];    /* the two sides of a gap that has failed; -1: none */
  size_t pairs, most_pairs;
  uint32_t round;
} trims;

void trims_clear(trims *t);

/* A further print has been looked at. */
void trims_begin(trims *t);

/* Let both sides of a gap that fails go back a little, at most once a print.
   *moved tells whether one could. */
int trims_deepen(trims *t, const opc_host *host, const drawing *d,
                 const limits *rules, double grid, site *gap, int *moved,
                 opc_error *error);

/* Whether a side of the gap could still go back. */
int trims_could(const trims *t, const site *gap);

/* What they take away. 0 if there is no memory. */
int trims_bites(const trims *t, box_list *out);

#endif
