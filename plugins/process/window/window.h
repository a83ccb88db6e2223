/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal interface of process.window: simulation of a mask at doses, foci,
   mask errors and overlays. */
#pragma once

#include <eda/print.h>
#include <opcflow/follow.h>
#include <opcflow/step.h>

/* Simulated result at one condition; arrays by gate. */
typedef struct window_print {
  eda_section *cuts;
  double *ion, *ioff; /* ln of printed over drawn current; NAN if the gate
                         failed. Without an extractor, both are NULL */
  eda_spread_sums sums;
  eda_spread spread;       /* spread of the currents, from `sums` */
  eda_short_slices slices; /* of all transistors that print */
} window_print;

/* The instance of the step. */
typedef struct window {
  const opc_host *host;
  const eda_mask *mask; /* parameters */
  const eda_gates *as_drawn;
  const opc_module *litho, *resist;
  const opc_module *extractor;  /* may be NULL */
  opc_reals dose, focus;        /* %, nm; increasing */
  opc_reals mask_error;         /* nm; increasing */
  opc_reals overlay[2];         /* of active along x and y, nm; increasing */
  double tolerance;             /* % of the drawn length */
  double ion_limit, ioff_limit; /* % */
  double margin;                /* nm */
  double foci[5];               /* default values of `focus`, nm */
  int cut_lines;
  const char *file;
  const eda_gates *gates; /* measured gates */
  /* [gates], number of transistors that a gate represents (a class). If NULL,
     each gate represents one transistor. */
  const uint32_t *count;
  size_t nominal_dose, nominal_focus; /* indices of the values nearest to 0 */
  window_print *print;                /* [focus][dose] */
  window_print *wrong;   /* [mask_error], at nominal dose and focus */
  window_print *shifted; /* [window_overlays], at nominal dose and focus */
  double *low, *high; /* range of doses within tolerance, %, per focus; NAN if
                         no dose is within tolerance */
  /* Range of foci within tolerance at the nominal dose, nm; NAN if no focus is
     within tolerance. */
  double depth_low, depth_high;
} window;

/* Return the result at a focus and a dose. */
static inline const window_print *window_at(const window *w, size_t focus,
                                            size_t dose) {
  return &w->print[focus * w->dose.count + dose];
}

/* A displacement of the image of active against poly, nm. */
typedef struct window_overlay {
  double x, y;
} window_overlay;

/* Return the number of overlays: combinations of both lists, in which an empty
   list counts as the single value 0. Return 0 if both lists are empty.
   window_overlay_at: return overlay k; x varies fastest. */
static inline size_t window_overlays(const window *w) {
  size_t x = w->overlay[0].count, y = w->overlay[1].count;
  return x && y ? x * y : x + y;
}

/* Return overlay k of all combinations along x and y. */
static inline window_overlay window_overlay_at(const window *w, size_t k) {
  opc_reals x = w->overlay[0], y = w->overlay[1];
  window_overlay at = {0, 0};
  if (x.count) at.x = x.values[k % x.count];
  if (y.count) at.y = y.values[x.count ? k / x.count : k];
  return at;
}

/* Return the number of transistors that gate i represents. */
static inline double window_count(const window *w, size_t i) {
  return w->count ? w->count[i] : 1;
}

/* ---- prints.c ---- */

/* Simulate all conditions; fill `print`, `wrong` and `shifted`. */
int window_expose(window *w, opc_error *error);

/* ---- limits.c ---- */

/* Set low, high, depth_low and depth_high: the widest range of conditions in
   which all gates are within tolerance. Each end of the range is the point
   where the first gate leaves the tolerance, by linear interpolation. */
void window_limits(window *w);

/* ---- performance.c ---- */

/* Limits that all transistors must meet. */
enum { WINDOW_ION = 1, WINDOW_IOFF = 2, WINDOW_BOTH = 3 };

/* Compute the range of doses, %, between indices `dose` and `dose` + 1 in which
   all transistors meet the limits. The focus is between index `focus` (`at` =
   0) and `focus` + 1 (`at` = 1). Return 0 if the range is empty. Logarithms of
   currents are interpolated linearly in focus and dose; a gate that fails at
   any of the four conditions meets no limit. */
int window_keeps(const window *w, int limits, size_t focus, double at,
                 size_t dose, double *low, double *high);

/* window_kept_doses: return the width of the range of doses, %, that meet the
   limits at a focus of the list. window_kept_area: return the area of dose and
   focus that meets the limits, % nm. */
double window_kept_doses(const window *w, int limits, size_t focus);
double window_kept_area(const window *w, int limits);

/* Response of printed quantities to mask errors, fitted by least squares over
   `mask_error`. */
typedef struct window_response {
  double meef_mean, meef_max; /* nm of printed length per nm of mask length (two
                                 edges) */
  double ion_mean, ion_max;   /* |% of Ion| per nm of edge displacement */
} window_response;

/* Compute the responses. */
window_response window_respond(const window *w);

/* ---- tables.c ---- */

/* Statistics of the lengths of all gates at one dose and focus. */
typedef struct window_summary {
  double mean, min, max; /* deviation from the drawn length, nm */
  double nils;           /* smallest drawn length times image log slope */
  double failed;
} window_summary;

/* Summarise the result at one condition. */
window_summary window_summarise(const window *w, const window_print *print);

/* Write all tables and metrics. */
int window_report(const window *w, opc_error *error);

/* ---- bossung.c ---- */

/* Draw the charts. */
int window_draw(const window *w, opc_error *error);
