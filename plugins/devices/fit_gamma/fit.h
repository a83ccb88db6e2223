/* SPDX-License-Identifier: BSD-3-Clause */
/* gamma from reference transistors, by least squares of the relative errors of
   a current. */
#ifndef FIT_GAMMA_FIT_H
#define FIT_GAMMA_FIT_H

#include "reference.h"

/* Of the transistors of one type that have one of the currents. */
typedef struct sample {
  const reference *reference;
  int type, current;
  size_t count;
  const transistor **transistor;
} sample;

/* gamma at increasing distances from the edge, linear between. For an edge
   term, 1 + amplitude exp(-edge / decay), these lie close. */
typedef struct fitted {
  double amplitude, decay;   /* NAN for a table */
  size_t points;
  double *edge, *gamma;
} fitted;

int sample_make(const opc_host *host, const reference *r, int type, int current,
                sample *out, opc_error *error);
void sample_clear(sample *s);

int fit_edge(const opc_host *host, const sample *s, fitted *out,
             opc_error *error);
int fit_table(const opc_host *host, const sample *s, const double *edge,
              size_t edges, fitted *out, opc_error *error);
void fitted_clear(fitted *f);

/* The deviation of the sliced current of a transistor from that given, %;
   f NULL: plain slicing. */
double fit_residual(const sample *s, size_t i, const fitted *f);

#endif
