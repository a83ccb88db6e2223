/* SPDX-License-Identifier: BSD-3-Clause */
/* Search for sign changes of a field from a point in both directions along a
   line. A search evaluates only the cells that it passes. */
#pragma once

#include "imaging/spline.h"

/* The field along a line parallel to an axis, a spline of one variable. */
typedef struct eda_line {
  double origin, step;
  int n; /* period, in steps */
  size_t stride;
  const float *row[EDA_SPLINE_TAPS];
  double weight[EDA_SPLINE_TAPS];
} eda_line;

/* A search along a line. */
typedef struct eda_line_search {
  const eda_line *line;
  double done;               /* covered distance from the start, in steps */
  double part;               /* part of a cell ahead */
  double found;              /* sign change found in the cell; NAN for none */
  double b[EDA_SPLINE_TAPS]; /* Bernstein coefficients of the part */
  double c[EDA_SPLINE_TAPS]; /* spline coefficients of the cell */
  int out, next;             /* direction, +-1; number of the next c */
} eda_line_search;

static inline double eda_node(const double *c) {
  return (c[0] + c[4] + 26 * (c[1] + c[3]) + 66 * c[2]) * (1 / 120.0);
}

/* Compute the Bernstein coefficients of a cell. Two adjacent cells have
   bit-identical coefficients at their common end. */
static inline void eda_bernstein(const double c[EDA_SPLINE_TAPS],
                                 double b[EDA_SPLINE_TAPS]) {
  b[0] = eda_node(c);
  b[1] = (8 * c[1] + 33 * c[2] + 18 * c[3] + c[4]) * (1 / 60.0);
  b[2] = (2 * c[1] + 15 * c[2] + 12 * c[3] + c[4]) * (1 / 30.0);
  b[3] = (c[1] + 12 * c[2] + 15 * c[3] + 2 * c[4]) * (1 / 30.0);
  b[4] = (c[1] + 18 * c[2] + 33 * c[3] + 8 * c[4]) * (1 / 60.0);
  b[5] = eda_node(c + 1);
}

/* Convert Bernstein coefficients to coefficients of powers of t. */
static inline void eda_powers(const double b[EDA_SPLINE_TAPS],
                              double a[EDA_SPLINE_TAPS]) {
  double d1 = b[1] - b[0], d2 = b[2] - b[1], d3 = b[3] - b[2], d4 = b[4] - b[3],
         d5 = b[5] - b[4];
  double e1 = d2 - d1, e2 = d3 - d2, e3 = d4 - d3, e4 = d5 - d4;
  double f1 = e2 - e1, f2 = e3 - e2, f3 = e4 - e3;
  double g1 = f2 - f1, g2 = f3 - f2;
  a[0] = b[0];
  a[1] = 5 * d1;
  a[2] = 10 * e1;
  a[3] = 10 * f1;
  a[4] = 5 * g1;
  a[5] = g2 - g1;
}

/* Return the value of the polynomial at t, and its slope there. */
static inline double eda_polynomial(const double a[EDA_SPLINE_TAPS], double t,
                                    double *slope) {
  *slope =
      a[1] + t * (2 * a[2] + t * (3 * a[3] + t * (4 * a[4] + t * 5 * a[5])));
  return a[0] + t * (a[1] + t * (a[2] + t * (a[3] + t * (a[4] + t * a[5]))));
}

/* Initialise a line along an axis; for EDA_X (0), along x at y = at. */
void eda_line_make(const eda_field *field, int axis, double at, eda_line *line);

/* Start two searches at `place`, towards smaller and larger coordinates. Return
   the value of the field there. */
double eda_line_start(const eda_line *line, double place, eda_line_search *down,
                      eda_line_search *up);

/* Search the part of a cell ahead. Return the distance from the start, nm, to
   the first sign change, beyond which the next call continues; or NAN, after
   which the next call searches the next cell. */
double eda_line_search_cell(eda_line_search *search);

/* Search for the next sign change. Return its distance from the start, nm, at
   most `limit`; NAN for none. */
double eda_line_search_to(eda_line_search *search, double limit);
