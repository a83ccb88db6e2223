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
  double *quick[2][CURRENTS];
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

/* exp of curves_at within 1e-6 of it, for a fraction of the time. */
static inline double curves_quick(const curves *c, int type, int current,
                                  double length) {
  double x = (length - c->devices->length[0]) * c->per_nm;
  const double *y = c->quick[type][current];
  if (!(x > 0)) return y[0];
  if (x >= (double)c->steps) return y[c->steps];
  size_t i = (size_t)x;
  return y[i] + (x - (double)i) * (y[i + 1] - y[i]);
}

#endif
