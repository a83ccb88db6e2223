/* SPDX-License-Identifier: BSD-3-Clause */
/* Line ends: how far they go out, and how wide their heads are. */
#ifndef OPCFLOW_REGULATOR_ENDS_H
#define OPCFLOW_REGULATOR_ENDS_H

#include "sites.h"

/* Of line end [2 * i + side]. Lengths in grid steps. */
typedef struct line_end {
  opc_box tip;             /* as drawn, flat */
  int side;                /* that it faces; -1: the gate has none */
  int32_t most, by;        /* how far it may go out, and was sent */
  int32_t start;           /* of its head, inwards of the tip */
  int32_t widest, wider;   /* the same on each flank */
  response length, width;
} line_end;

typedef struct ends {
  line_end *at;
  size_t n;
} ends;

/* 0 if there is no memory. */
int ends_make(ends *e, const opc_gates *gates, const drawing *d,
              const limits *rules);
void ends_clear(ends *e);

/* Send a line end further out if the print wants it, or else make it wider.
   `bias` is where it is. */
void ends_advance(ends *e, const opc_host *host, const opc_printed *p,
                  const limits *rules, size_t end, int32_t *bias);

/* What must not print lies before a line end of the nearest gate: it goes back,
   and stays there. Whether it could. */
int ends_back(ends *e, const opc_printed *p, const site *wrong, int32_t *bias);

/* The patches of all heads. 0 if there is no memory. */
int ends_heads(const ends *e, box_list *out);

/* Why the print of a line end is too short. */
const char *ends_reason(const ends *e, const limits *rules, double grid,
                        size_t end);

#endif
