/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of process.window. */
#ifndef OPCFLOW_PROCESS_WINDOW_H
#define OPCFLOW_PROCESS_WINDOW_H

#include <opcflow/gates.h>

/* ---- cuts.c ---- */

/* A gate's poly along its L axis at the middle of its W, in one print. */
typedef struct window_cut {
  double length;    /* printed, nm; NAN: open or merged with a neighbour */
  double low, high; /* image log slope |dI/dl| / I at its edges, 1/nm */
} window_cut;

/* The cuts of all gates: `print` the level set, `image` the intensity that it
   comes from. */
void window_cuts(const opc_host *host, const opc_gates *gates,
                 const opc_field *print, const opc_field *image,
                 window_cut *cuts);

/* ---- results ---- */

typedef struct window_results {
  const opc_gates *gates;
  size_t doses, foci;
  const double *dose, *focus;   /* %, nm; increasing */
  size_t nominal;               /* the dose nearest to 0 */
  double tolerance;             /* % of the drawn length */
  window_cut *cuts;             /* [focus][dose][gate] */
  double *low, *high;           /* of each focus: doses within tolerance, %;
                                   NAN: none of the list is */
  double depth_low, depth_high; /* foci within tolerance at the nominal dose,
                                   nm; NAN: none */
} window_results;

/* The cut's length less the drawn one, % of it; NAN if there is none. */
double window_deviation(const window_results *r, size_t focus, size_t dose,
                        size_t gate);

/* ---- limits.c ---- */

/* Fill low, high, depth_low and depth_high: the widest range of the list in
   which all gates are within the tolerance, on both sides up to where the
   first one leaves it, linear between the places of the list. */
void window_limits(window_results *r);

/* ---- bossung.c ---- */

/* The picture, as .png, .svg or .pdf by `format` (paper.h). */
int window_draw(const opc_host *host, const window_results *r, int format,
                const char *path, opc_error *error);

#endif
