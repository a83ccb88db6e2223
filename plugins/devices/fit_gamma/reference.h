/* SPDX-License-Identifier: BSD-3-Clause */
/* Transistors with known currents, and what plain slicing says of them. */
#ifndef FIT_GAMMA_REFERENCE_H
#define FIT_GAMMA_REFERENCE_H

#include "../../extract/curves.h"

enum { REFERENCE_NODES = 256 };   /* slices of each */

typedef struct transistor {
  int type;
  double width;                     /* nm */
  double *length;                   /* from one active edge to the other, nm */
  size_t lengths;
  double current[CURRENTS];         /* A; NAN where it is not given */
  /* Of its slices: the distance from the nearer edge, and the plain current. */
  double edge[REFERENCE_NODES], part[CURRENTS][REFERENCE_NODES];
} transistor;

typedef struct reference {
  size_t count;
  transistor *transistor;
} reference;

/* Read a file and slice its transistors. */
int reference_read(const opc_host *host, const char *path, const curves *table,
                   reference *out, opc_error *error);
void reference_clear(reference *r);

#endif
