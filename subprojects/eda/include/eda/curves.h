/* SPDX-License-Identifier: BSD-3-Clause */
/* The currents of wide transistors as functions of their length: the logarithm
   of a current is interpolated by Steffen's cubic, which is monotone where the
   table is. Beyond its ends that logarithm goes on in a straight line by the
   slope it has there, but by no less than half and no more than twice the mean
   slope of the table's outermost tenth, so that a flat or a rough end still
   tells longer from shorter. It does so down to a quarter of the shortest
   length, up to four times the longest, and over a factor of e^20 at most;
   lengths further out count as that. What comes from there is good for
   steering: the table knows nothing of it (docs/reference/devices.md has
   errors).

   A table of several widths has such curves for each. A rectangular transistor
   of width W between two of them has, by width, what lies between both in 1 / W
   in the logarithm: what its edges add or take is told apart from what grows
   with W. Narrower ones than the narrowest have its current by width. */
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
  /* Those of the file's next table; NULL: there is none. Since 0.6. */
  struct eda_curves *next;
} eda_curves;

/* A width among those of the table. */
typedef struct eda_curves_width {
  double width; /* nm */
  size_t low;   /* of the table's widths: it lies between this and the next */
  double part;  /* of the way, 0 to 1 */
  int is_wide;  /* as wide as the widest, or the table has one width only */
} eda_curves_width;

/* Read a device table into *curves, which is zeroed or was read before: then
   nothing happens. The table needs three lengths or more, and currents that
   fall with each; of a table of several widths only Ion of the widest needs
   to. What it lacks is told as an error of the parameter "devices".
   Zeroed again on failure. [main] */
OPC_EXPORT int eda_curves_read(eda_curves *curves, const char *path,
                               opc_error *error);
OPC_EXPORT void eda_curves_clear(eda_curves *curves);

/* All [any]. */
/* The curves of a flavour of transistors, NULL or "": of those without one.
   NULL if the file has no such table. */
OPC_EXPORT const eda_curves *eda_curves_of(const eda_curves *curves,
                                           const char *flavour);

/* log of the current per width, A/nm, at a length (nm). Of all that is within
   the table the bits do not depend on what is beyond. */
OPC_EXPORT double eda_curves_at(const eda_curves *curves, int type, int current,
                                double length);
/* The length whose current per width has that logarithm. */
OPC_EXPORT double eda_curves_length(const eda_curves *curves, int type,
                                    int current, double logarithm);

OPC_EXPORT eda_curves_width eda_curves_among(const eda_curves *curves,
                                             double width);
/* The same two of a rectangular transistor of a width. Where a current does not
   fall with every length several have it: the one nearest to `near`, nm, which
   is also given if no length about it has. */
OPC_EXPORT double eda_curves_narrow_at(const eda_curves *curves, int type,
                                       int current, double length,
                                       const eda_curves_width *width);
OPC_EXPORT double eda_curves_narrow_length(const eda_curves *curves, int type,
                                           int current, double logarithm,
                                           const eda_curves_width *width,
                                           double near);
/* The least share, over all lengths of the table, that a transistor of a width
   has of the current per width of a wide one: 1 if its edges add to it. */
OPC_EXPORT double eda_curves_least_share(const eda_curves *curves, int type,
                                         int current,
                                         const eda_curves_width *width);

OPC_EXPORT double eda_curves_shortest(const eda_curves *curves);
OPC_EXPORT double eda_curves_longest(const eda_curves *curves);
/* Of a table of several widths; else 0. */
OPC_EXPORT double eda_curves_narrowest(const eda_curves *curves);

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

/* exp of eda_curves_narrow_at, in the same way; not of a wide one. */
OPC_EXPORT void eda_curves_narrow_quick(const eda_curves *curves, int type,
                                        double length,
                                        const eda_curves_width *width,
                                        double current[EDA_CURRENTS]);

#ifdef __cplusplus
}
#endif
#endif
