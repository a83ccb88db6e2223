/* SPDX-License-Identifier: BSD-3-Clause */
/* Interpolation of device tables (devices.h): currents as functions of the
   channel length and width. The first paragraph is about wide transistors. The
   logarithm of a current is interpolated by Steffen's monotone cubic (Astron.
   Astrophys. 239, 443, 1990). Beyond the table the logarithm continues as a
   straight line with the slope at the end of the table. The slope is limited to
   0.5 to 2 times the mean slope of the outermost tenth of the table. The
   current then changes with length even if the table has a flat or noisy end.
   The extrapolated current is constant below a quarter of the shortest length,
   above four times the longest length, and after a change by a factor of e^20.
   Use extrapolated values only to steer a correction (errors:
   docs/reference/devices.md).

   A table of several widths has such curves for each width. Between two widths,
   the logarithm of the current per width is interpolated linearly in 1 / W. The
   edges of the active contribute to this current in proportion to 1 / W.
   Transistors narrower than the narrowest width have the current per width of
   the narrowest width. [any], [main]: see opcflow/plugin.h. */
#pragma once

#include <eda/devices.h>
#include <math.h>

OPC_C_BEGIN

/* Currents, as indices of arrays. */
enum { EDA_ION = 0, EDA_IOFF = 1, EDA_CURRENTS = 2 };

/* A device table with its curves. */
typedef struct eda_curves {
  eda_devices *devices;
  /* Currents per width, A/nm, of wide transistors at equal steps from the
     shortest to the longest length, for fast approximate evaluation:
     [type][step * EDA_CURRENTS + current]. */
  double *quick[2];
  size_t steps;            /* number of steps */
  double per_nm;           /* steps per nm */
  struct eda_curve *exact; /* private to eda */
  /* Curves of the next table of the file; NULL for the last. Since 0.6. */
  struct eda_curves *next;
} eda_curves;

/* A width and its position among the widths of the table. */
typedef struct eda_curves_width {
  double width; /* nm */
  size_t low;   /* index of the next smaller width in the table */
  double part;  /* position between widths `low` and `low` + 1: 0 to 1, linear
                   in 1 / W */
  int is_wide;  /* 1: `width` >= widest width, or the table has one width */
} eda_curves_width;

/* Read a device table into *curves, which must be zeroed; return OPC_OK at once
   if *curves was read before. The table needs at least three lengths and
   currents that decrease with length; in a table of several widths only Ion of
   the widest must decrease. Errors name the parameter "devices"; on failure
   *curves is zeroed. [main] */
OPC_EXPORT int eda_curves_read(eda_curves *curves, const char *path,
                               opc_error *error);
/* Free a table and clear the struct. */
OPC_EXPORT void eda_curves_clear(eda_curves *curves);

/* All functions below are [any]. */
/* Return the curves of a transistor flavour (eda/gates.h; NULL or "": no
   flavour). Return NULL if the file has no table for the flavour. */
OPC_EXPORT const eda_curves *eda_curves_of(const eda_curves *curves,
                                           const char *flavour);

/* Return the natural logarithm of the current per width, A/nm, of a wide
   transistor at a length, nm. `current` is EDA_ION or EDA_IOFF. */
OPC_EXPORT double eda_curves_at(const eda_curves *curves, int type, int current,
                                double length);
/* Return the length at which the current per width of a wide transistor has
   this logarithm. */
OPC_EXPORT double eda_curves_length(const eda_curves *curves, int type,
                                    int current, double logarithm);

/* Return a width, nm, with its position among the widths of the table. Above
   the widest width, and in a table of one width, is_wide is 1. Below the
   narrowest width, the position is that of the narrowest width. */
OPC_EXPORT eda_curves_width eda_curves_among(const eda_curves *curves,
                                             double width);
/* Return the same as eda_curves_at and eda_curves_length, for the width from
   eda_curves_among. If several lengths have the same current, return the length
   nearest to `near`, nm; if none of them is within 200 nm of `near`, return
   `near`. */
OPC_EXPORT double eda_curves_narrow_at(const eda_curves *curves, int type,
                                       int current, double length,
                                       const eda_curves_width *width);
OPC_EXPORT double eda_curves_narrow_length(const eda_curves *curves, int type,
                                           int current, double logarithm,
                                           const eda_curves_width *width,
                                           double near);
/* For each length of the table, divide the current per width of a transistor of
   this width by the current per width of a wide transistor. Return the smallest
   of these ratios, at most 1. Between two widths of the table, the minima are
   interpolated linearly in 1 / W. */
OPC_EXPORT double eda_curves_least_share(const eda_curves *curves, int type,
                                         int current,
                                         const eda_curves_width *width);

/* Return the shortest and the longest length of the table, nm. */
OPC_EXPORT double eda_curves_shortest(const eda_curves *curves);
OPC_EXPORT double eda_curves_longest(const eda_curves *curves);
/* Return the shortest length that the model of a type covers, nm: at least the
   shortest length of the table. */
OPC_EXPORT double eda_curves_modelled(const eda_curves *curves, int type);
/* Return the narrowest width of a table of several widths, nm; otherwise 0. */
OPC_EXPORT double eda_curves_narrowest(const eda_curves *curves);

/* Compute both currents per width, A/nm: exp(eda_curves_at). Within the table
   the function is faster and has a relative error of 1e-5; beyond the table, it
   calls eda_curves_at. */
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

/* Compute both currents per width, A/nm, exp(eda_curves_narrow_at), in the same
   way; width->is_wide must be 0. */
OPC_EXPORT void eda_curves_narrow_quick(const eda_curves *curves, int type,
                                        double length,
                                        const eda_curves_width *width,
                                        double current[EDA_CURRENTS]);

OPC_C_END
