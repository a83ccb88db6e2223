/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of process.window. */
#pragma once

#include <eda/print.h>
#include <opcflow/follow.h>
#include <opcflow/step.h>

/* One print: arrays by gate. */
typedef struct window_print {
  eda_section *cuts;
  double *ion, *ioff; /* logarithms of printed over drawn; NAN: failed. NULL
                         without an extractor */
  eda_spread spread;  /* of the currents */
} window_print;

typedef struct window {
  const opc_host *host;
  const eda_mask *mask; /* parameters */
  const eda_gates *as_drawn;
  const opc_module *litho, *resist;
  const opc_module *extractor;  /* NULL: none */
  opc_reals dose, focus;        /* %, nm; increasing */
  opc_reals mask_error;         /* nm; increasing */
  double tolerance;             /* % of the drawn length */
  double ion_limit, ioff_limit; /* % */
  double margin;                /* nm */
  double foci[5];               /* nm: those that are not given */
  int cut_lines;
  const char *file;
  const eda_gates *gates;             /* that are measured */
  size_t nominal_dose, nominal_focus; /* those nearest to 0 */
  eda_performance design;             /* with an extractor */
  window_print *print;                /* [focus][dose] */
  window_print *wrong;                /* [mask_error], at the nominal place */
  double *low, *high; /* of each focus: doses within tolerance, %; NAN:
         none of the list is */
  double depth_low, depth_high; /* foci within tolerance at the nominal dose,
                                   nm; NAN: none */
} window;

static inline const window_print *window_at(const window *w, size_t focus,
                                            size_t dose) {
  return &w->print[focus * w->dose.count + dose];
}

/* ---- prints.c ---- */

/* Fill print and wrong. */
int window_expose(window *w, opc_error *error);

/* ---- limits.c ---- */

/* Fill low, high, depth_low and depth_high: the widest range of the list in
   which all gates are within the tolerance, on both sides up to where the
   first one leaves it, linear between the places of the list. */
void window_limits(window *w);

/* ---- performance.c ---- */

/* Limits that all transistors keep, any of them or both. */
enum { WINDOW_ION = 1, WINDOW_IOFF = 2, WINDOW_BOTH = 3 };

/* At a focus between number `focus` (at = 0) and the next (at = 1), the doses
   between number `dose` and the next at which all transistors keep the limits;
   0 if there are none. Logarithms of currents are linear between the places
   of the lists, along focus and along dose; what fails at one of the four keeps
   nothing. */
int window_keeps(const window *w, int limits, size_t focus, double at,
                 size_t dose, double *low, double *high);

/* The doses at a focus of the list that keep the limits, %; and the area of
   dose and focus that does, % nm. */
double window_kept_doses(const window *w, int limits, size_t focus);
double window_kept_area(const window *w, int limits);

/* How printed figures follow the mask, by least squares over mask_error. */
typedef struct window_response {
  double meef_mean, meef_max; /* nm of printed length per nm of mask length,
                                 which is two edges */
  double ion_mean, ion_max;   /* |% of Ion| per nm of each edge */
} window_response;

window_response window_respond(const window *w);

/* ---- tables.c ---- */

/* What the lengths of all gates are at one dose and focus. */
typedef struct window_summary {
  double mean, min, max; /* deviation from the drawn length, nm */
  double nils;           /* the least: drawn length times log slope */
  double failed;
} window_summary;

window_summary window_summarise(const window *w, const window_print *print);

/* All tables and metrics. */
int window_report(const window *w, opc_error *error);

/* ---- bossung.c ---- */

/* The picture. */
int window_draw(const window *w, opc_error *error);
