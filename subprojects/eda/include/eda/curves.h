/* SPDX-License-Identifier: BSD-3-Clause */
/* The currents of wide transistors as functions of length. The logarithm of a
   current is interpolated by Steffen's cubic, which is monotone where the table
   is. Beyond the table the logarithm continues as a straight line with the
   slope at the end. The slope is limited to between half and twice the mean
   slope of the outermost tenth of the table, so that a flat or rough end still
   distinguishes lengths. The extrapolation ends at a quarter of the shortest
   length, at four times the longest, and at a factor of e^20; lengths further
   out return the value there. Extrapolated values serve to steer a correction;
   the table does not support them (docs/reference/devices.md states errors).

   A table of several widths has such curves for each width. For a rectangular
   transistor between two widths, the logarithm of the current per width is
   interpolated linearly in 1 / W. This separates the contribution of the edges
   from that of the width. Transistors narrower than the narrowest width have
   its current per width. */
#pragma once

#include <eda/devices.h>
#include <math.h>

OPC_C_BEGIN

enum { EDA_ION = 0, EDA_IOFF = 1, EDA_CURRENTS = 2 };

typedef struct eda_curves {
  eda_devices *devices;
  /* Currents per width, A/nm, at equal steps from the shortest length on, for
     fast approximate evaluation: [type][step * EDA_CURRENTS + current]. */
  double *quick[2];
  size_t steps;
  double per_nm;           /* steps per nm */
  struct eda_curve *exact; /* private to eda */
  /* Curves of the file's next table; NULL: none. Since 0.6. */
  struct eda_curves *next;
} eda_curves;

/* A width and its position among those of the table. */
typedef struct eda_curves_width {
  double width; /* nm */
  size_t low;   /* index of the table's width below */
  double part;  /* fraction of the way to the next width, 0 to 1 */
  int is_wide;  /* at least the widest width, or the table has one width only */
} eda_curves_width;

/* Read a device table into *curves. *curves is zeroed, or was read before, in
   which case nothing happens. The table needs at least three lengths and
   currents that decrease with length; in a table of several widths only Ion of
   the widest must decrease. Faults are reported as errors of the parameter
   "devices"; on failure *curves is zeroed. [main] */
OPC_EXPORT int eda_curves_read(eda_curves *curves, const char *path,
                               opc_error *error);
OPC_EXPORT void eda_curves_clear(eda_curves *curves);

/* All functions below are [any]. */
/* Return the curves of a flavour of transistors; NULL or "": transistors
   without flavour. Return NULL if the file has no such table. */
OPC_EXPORT const eda_curves *eda_curves_of(const eda_curves *curves,
                                           const char *flavour);

/* Return the logarithm of the current per width, A/nm, at a length (nm). Values
   within the table do not depend on the extrapolation. */
OPC_EXPORT double eda_curves_at(const eda_curves *curves, int type, int current,
                                double length);
/* Return the length whose current per width has this logarithm. */
OPC_EXPORT double eda_curves_length(const eda_curves *curves, int type,
                                    int current, double logarithm);

OPC_EXPORT eda_curves_width eda_curves_among(const eda_curves *curves,
                                             double width);
/* Evaluate the current and its inverse for a rectangular transistor of a width.
   If a current is not monotone, several lengths have the same current: the
   result is the one nearest to `near`, nm. If no length nearby has the current,
   return `near`. */
OPC_EXPORT double eda_curves_narrow_at(const eda_curves *curves, int type,
                                       int current, double length,
                                       const eda_curves_width *width);
OPC_EXPORT double eda_curves_narrow_length(const eda_curves *curves, int type,
                                           int current, double logarithm,
                                           const eda_curves_width *width,
                                           double near);
/* Return the smallest ratio, over all lengths of the table, of the current per
   width of a transistor of this width to that of a wide one; 1 if its edges add
   current. */
OPC_EXPORT double eda_curves_least_share(const eda_curves *curves, int type,
                                         int current,
                                         const eda_curves_width *width);

OPC_EXPORT double eda_curves_shortest(const eda_curves *curves);
OPC_EXPORT double eda_curves_longest(const eda_curves *curves);
/* Return the narrowest width of a table of several widths, nm; otherwise 0. */
OPC_EXPORT double eda_curves_narrowest(const eda_curves *curves);

/* Compute exp of eda_curves_at for both currents, within 1e-5, in a fraction of
   the time; beyond the table exact and slower. */
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

/* Compute exp of eda_curves_narrow_at in the same way; not for wide
   transistors. */
OPC_EXPORT void eda_curves_narrow_quick(const eda_curves *curves, int type,
                                        double length,
                                        const eda_curves_width *width,
                                        double current[EDA_CURRENTS]);

OPC_C_END
