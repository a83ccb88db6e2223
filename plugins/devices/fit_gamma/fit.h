/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal interface of devices.fit_gamma: transistors with known currents, and
   least-squares fits of gamma to the relative errors of a current. */
#pragma once

#include <eda/curves.h>

/* ---- reference.c ---- */

enum { REFERENCE_NODES = 256 }; /* number of slices per transistor */

/* A transistor whose currents are known. */
typedef struct transistor {
  int type;
  double width;   /* width of the active, nm */
  double *length; /* from one active edge to the other, nm */
  size_t lengths;
  double current[EDA_CURRENTS]; /* A; NAN if the reference has no value */
  /* Slices: distance from the nearer active edge, nm, and current without
     gamma, A. */
  double edge[REFERENCE_NODES], part[EDA_CURRENTS][REFERENCE_NODES];
} transistor;

/* All transistors of a reference. */
typedef struct reference {
  size_t count;
  transistor *transistor;
} reference;

/* Read a file, a device table (.yaml) or a CSV file, and slice its transistors
   of mean lengths `from` to `to`, nm. The caller clears `out`, also after an
   error. */
int reference_read(const char *path, const eda_curves *table, double from,
                   double to, reference *out, opc_error *error);
/* Free the transistors. */
void reference_clear(reference *r);

/* ---- fit.c ---- */

/* Transistors of one type that have a given current. */
typedef struct sample {
  int type, current;
  size_t count;
  const transistor **transistor;
} sample;

/* Gamma at increasing distances from the edge, linear in between. An edge term,
   1 + amplitude exp(-edge / decay), is stored as dense points. */
typedef struct fitted {
  double amplitude, decay; /* NAN for a table */
  size_t points;
  double *edge, *gamma;
} fitted;

/* Select the transistors of a type whose current `current` is known; free the
   selection. */
void sample_init(sample *s, const reference *r, int type, int current);
void sample_clear(sample *s);

/* fit_edge: fit an exponential function of the distance from the active edge.
   fit_table: fit gamma at the distances edge[edges]. Return OPC_OK, or an error
   if there are too few transistors. fitted_clear: free the result. */
int fit_edge(const sample *s, fitted *out, opc_error *error);
int fit_table(const sample *s, const double *edge, size_t edges, fitted *out,
              opc_error *error);
void fitted_clear(fitted *f);

/* Return the deviation of a transistor's sliced current from the known current,
   %. If `f` is NULL, gamma is 1. */
double fit_residual(const sample *s, size_t i, const fitted *f);
