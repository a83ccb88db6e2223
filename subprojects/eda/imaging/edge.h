/* SPDX-License-Identifier: BSD-3-Clause */
/* Searches for sign changes of a field from a point in both directions along a
   line. A search evaluates only the cells that it traverses. */
#pragma once

#include "imaging/spline.h"

/* The field on a line parallel to an axis: a spline of one variable. */
typedef struct eda_line {
  double origin, step; /* coordinate of node 0; distance of nodes; nm */
  int n;               /* period, in steps */
  /* Coefficient i of the line is the sum over k of weight[k] * row[k][i *
     stride]. */
  size_t stride;
  const float *row[EDA_SPLINE_TAPS];
  double weight[EDA_SPLINE_TAPS];
} eda_line;

/* A search along a line in one direction. */
typedef struct eda_line_search {
  const eda_line *line;
  double done; /* distance from the start to the unsearched part, in cells */
  double part; /* length of the unsearched part of the current cell, in cells */
  double found; /* position of a sign change in the unsearched part, 0 to 1;
                   NAN: none */
  double b[EDA_SPLINE_TAPS]; /* Bernstein coefficients of the unsearched part */
  double c[EDA_SPLINE_TAPS]; /* spline coefficients of the current cell */
  int out, next; /* direction, +1 or -1; number of the next coefficient */
} eda_line_search;

/* Return the value of a spline at the node of coefficient c[2]. */
static inline double eda_node(const double *c) {
  return (c[0] + c[4] + 26 * (c[1] + c[3]) + 66 * c[2]) * (1 / 120.0);
}

/* Compute the Bernstein coefficients of a cell. Adjacent cells have
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

/* Convert Bernstein coefficients to coefficients of the powers of t. */
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

/* Return the value of a polynomial at t, and its slope. */
static inline double eda_polynomial(const double a[EDA_SPLINE_TAPS], double t,
                                    double *slope) {
  *slope =
      a[1] + t * (2 * a[2] + t * (3 * a[3] + t * (4 * a[4] + t * 5 * a[5])));
  return a[0] + t * (a[1] + t * (a[2] + t * (a[3] + t * (a[4] + t * a[5]))));
}

/* Initialise a line parallel to an axis; for axis 0 (EDA_X), the line y =
   at. */
void eda_line_make(const eda_field *field, int axis, double at, eda_line *line);

/* Start searches from `place` towards smaller (`down`) and larger (`up`)
   coordinates. Return a number with the sign of the field at `place`. */
double eda_line_start(const eda_line *line, double place, eda_line_search *down,
                      eda_line_search *up);

/* Search for the next sign change up to the distance `limit`, nm. Return the
   distance from the start, nm; NAN if there is none. */
double eda_line_search_to(eda_line_search *search, double limit);
