/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines through a field that are walked along, from a place outwards, to where
   the field changes its sign. Only what is walked over is looked at. */
#ifndef OPCFLOW_CORE_EDGE_H
#define OPCFLOW_CORE_EDGE_H

#include "core/imaging/spline.h"

/* A line parallel to an axis, as a spline in one variable. */
typedef struct opc_line {
  double origin, step;
  int n;                                  /* its period, in steps */
  size_t stride;
  const float *row[OPC_SPLINE_TAPS];
  double weight[OPC_SPLINE_TAPS];
} opc_line;

/* A walk along a line. */
typedef struct opc_walk {
  const opc_line *line;
  double done;                            /* in steps from the start, */
  double part;                            /* and the part of a cell ahead */
  double found;                           /* a change in it; NAN */
  double b[OPC_SPLINE_TAPS];              /* its Bernstein coefficients, */
  double c[OPC_SPLINE_TAPS];              /* and the spline's of the cell */
  int out, next;                          /* +-1, the number of the next c */
} opc_walk;

static inline double opc_node(const double *c) {
  return (c[0] + c[4] + 26 * (c[1] + c[3]) + 66 * c[2]) * (1 / 120.0);
}

/* The Bernstein coefficients of a cell. Those of its ends are the same
   expression in both cells that meet there, to the last bit. */
static inline void opc_bernstein(const double c[OPC_SPLINE_TAPS],
                                 double b[OPC_SPLINE_TAPS]) {
  b[0] = opc_node(c);
  b[1] = (8 * c[1] + 33 * c[2] + 18 * c[3] + c[4]) * (1 / 60.0);
  b[2] = (2 * c[1] + 15 * c[2] + 12 * c[3] + c[4]) * (1 / 30.0);
  b[3] = (c[1] + 12 * c[2] + 15 * c[3] + 2 * c[4]) * (1 / 30.0);
  b[4] = (c[1] + 18 * c[2] + 33 * c[3] + 8 * c[4]) * (1 / 60.0);
  b[5] = opc_node(c + 1);
}

/* axis OPC_X (0): along x at y = at. */
void opc_line_make(const opc_field *field, int axis, double at, opc_line *line);

/* Two walks, towards smaller and larger coordinates. Gives the value there. */
double opc_line_start(const opc_line *line, double place, opc_walk *down,
                      opc_walk *up);

/* Look at the part of a cell that is ahead: the distance from the start, nm,
   of its first change of sign, which is behind it the next time; or NAN, and the
   walk is at the next cell. */
double opc_walk_on(opc_walk *walk);

/* Walk to the next change of sign: its distance from the start, if that is at
   most `limit` nm; NAN. */
double opc_walk_to(opc_walk *walk, double limit);

/* opc_imaging_service.edge */
double opc_field_edge(const opc_field *field, int axis, double x, double y,
                      double reach);

#endif
