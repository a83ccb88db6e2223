/* SPDX-License-Identifier: BSD-3-Clause */
/* The currents of wide transistors as functions of their length: the logarithm
   of a current is interpolated by Steffen's cubic, which is monotone where the
   table is. Beyond its ends that logarithm goes on in a straight line by the
   slope it has there, but by no less than half and no more than twice the mean
   slope of the table's outermost tenth, so that a flat or a rough end still
   tells longer from shorter. It does so down to a quarter of the shortest
   length, up to four times the longest, and over a factor of e^20 at most;
   lengths further out count as that. What comes from there is good for
   steering: the table knows nothing of it (docs/devices.md has errors). */
#ifndef EDA_CURVES_H
#define EDA_CURVES_H

#include <eda/devices.h>
#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { EDA_ION = 0, EDA_IOFF = 1, EDA_CURRENTS = 2 };

typedef struct eda_curves {
  eda_devices *devices;
  /* Currents per width, A/nm, at even steps from the shortest length on, for
     what need not be exact: [type][step * EDA_CURRENTS + current]. */
  double *quick[2];
  size_t steps;
  double per_nm;           /* steps */
  struct eda_curve *exact; /* eda's own */
} eda_curves;

/* Read a device table into *curves, which is zeroed or was read before: then
   nothing happens. The table needs three lengths or more, and currents that
   fall with each; what it lacks is told as an error of the parameter "devices".
   Zeroed again on failure. [main] */
OPC_EXPORT int eda_curves_read(eda_curves *curves, const char *path,
                               opc_error *error);
OPC_EXPORT void eda_curves_clear(eda_curves *curves);

/* All [any]. */
/* log of the current per width, A/nm, at a length (nm). Of all that is within
   the table the bits do not depend on what is beyond. */
OPC_EXPORT double eda_curves_at(const eda_curves *curves, int type, int current,
                                double length);
/* The length whose current per width has that logarithm. */
OPC_EXPORT double eda_curves_length(const eda_curves *curves, int type,
                                    int current, double logarithm);

OPC_EXPORT double eda_curves_shortest(const eda_curves *curves);
OPC_EXPORT double eda_curves_longest(const eda_curves *curves);

/* exp of eda_curves_at, of both currents: within 1e-5 of it for a fraction of
   the time, beyond the table exact and slower. */
static inline void eda_curves_quick(const eda_curves *curves, int type,
                                    double length,
                                    double current[EDA_CURRENTS]) {
  double x = (length - curves->devices->length[0]) * curves->per_nm;
  if (!(x >= 0 && x <= (double)curves->steps)) {
    for (int k = 0; k < EDA_CURRENTS; k++)
      current[k] = exp(eda_curves_at(curves, type, k, length));
    return;
  }
  int i = (int)x;
  const double *y = curves->quick[type] + EDA_CURRENTS * i;
  double part = x - i;
  for (int k = 0; k < EDA_CURRENTS; k++)
    current[k] = y[k] + part * (y[EDA_CURRENTS + k] - y[k]);
}

#ifdef __cplusplus
}
#endif
#endif
