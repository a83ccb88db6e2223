/* SPDX-License-Identifier: BSD-3-Clause */
/* The currents of wide transistors against their length: the logarithm of a
   current is interpolated by Steffen's cubic, which is monotone where the table
   is. A length beyond the table counts as its end. */
#ifndef EXTRACT_CURVES_H
#define EXTRACT_CURVES_H

#include <gsl/gsl_interp.h>
#include <opcflow/devices.h>

enum { ION, IOFF, CURRENTS };

typedef struct curves {
  opc_devices *devices;
  double *logarithm[2][CURRENTS];   /* of the currents, [type][current] */
  gsl_interp *curve[2][CURRENTS];   /* of these, against length */
  /* Currents at even steps, for what need not be exact. */
  double *quick[2];          /* [type][step * CURRENTS + current] */
  size_t steps;
  double per_nm;             /* steps */
} curves;

/* Read a device table; nothing if it was read. */
int curves_load(curves *c, const opc_host *host, const char *path,
                opc_error *error);
void curves_clear(curves *c, const opc_host *host);

/* log of the current per width, A/nm, at a length (nm). */
double curves_at(const curves *c, int type, int current, double length);
/* The length whose current per width has that logarithm. */
double curves_length(const curves *c, int type, int current, double logarithm);

double curves_shortest(const curves *c);
double curves_longest(const curves *c);

/* exp of curves_at within 1e-6 of it, of both currents, for a fraction of the
   time. */
static inline void curves_quick(const curves *c, int type, double length,
                                double current[CURRENTS]) {
  double x = (length - c->devices->length[0]) * c->per_nm;
  double last = (double)c->steps;
  x = x > 0 ? x : 0;
  x = x < last ? x : last;
  int i = (int)x;
  const double *y = c->quick[type] + CURRENTS * i;
  double part = x - i;
  for (int k = 0; k < CURRENTS; k++)
    current[k] = y[k] + part * (y[CURRENTS + k] - y[k]);
}

#endif
