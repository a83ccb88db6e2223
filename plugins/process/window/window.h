/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of process.window. */
#ifndef OPCFLOW_PROCESS_WINDOW_H
#define OPCFLOW_PROCESS_WINDOW_H

#include <eda/print.h>
#include <opcflow/step.h>

typedef struct window {
  const opc_host *host;
  const eda_mask *mask; /* parameters */
  const eda_gates *as_drawn;
  const opc_module *litho, *resist;
  opc_reals dose, focus; /* %, nm; increasing */
  double tolerance;      /* % of the drawn length */
  double margin;         /* nm */
  int cut_lines;
  const char *file;
  const eda_gates *gates; /* that are measured */
  size_t nominal;         /* the dose nearest to 0 */
  eda_section *cuts;      /* [focus][dose][gate] */
  double *low, *high;     /* of each focus: doses within tolerance, %; NAN:
                             none of the list is */
  double depth_low, depth_high; /* foci within tolerance at the nominal dose,
                                   nm; NAN: none */
} window;

/* ---- window.c ---- */

/* What all gates have at one dose and focus. */
typedef struct window_summary {
  double mean, min, max; /* deviation from the drawn length, nm */
  double nils;           /* the least: drawn length times log slope */
  double failed;
} window_summary;

window_summary window_summarise(const window *w, size_t focus, size_t dose);

/* ---- limits.c ---- */

/* Fill low, high, depth_low and depth_high: the widest range of the list in
   which all gates are within the tolerance, on both sides up to where the
   first one leaves it, linear between the places of the list. */
void window_limits(window *w);

/* ---- bossung.c ---- */

/* The picture. */
int window_draw(const window *w, opc_error *error);

#endif
