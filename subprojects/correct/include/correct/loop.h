/* SPDX-License-Identifier: BSD-3-Clause */
/* The correction loop and its results. The loop simulates the mask and measures
   each transistor; synthesizers then displace edges, until they are done. */
#pragma once

#include <eda/print.h>

#include <correct/assists.h>
#include <correct/corners.h>
#include <correct/guard.h>
#include <correct/report.h>
#include <correct/search.h>
#include <correct/settings.h>
#include <correct/start.h>
#include <correct/trace.h>
#include <correct/trial.h>
#include <correct/verification.h>

/* Synthesizers (plugins that choose the mask displacements) of a loop: MAIN
   corrects the layers of transistors, EDGES the other layers. */
enum { MAIN, EDGES, DRIVERS };

/* A synthesizer in the loop. The arrays have an element for each layer, NULL or
   0 if the synthesizer did not dissect the layer into fragments. */
typedef struct driver {
  const opc_module *module; /* NULL: none */
  const double **epe;       /* edge placement errors of the fragments, nm */
  int32_t **shift;          /* displacements of the fragments, grid steps */
  size_t *fragments;
  int done; /* 1: the synthesizer needs no further simulation */
} driver;

/* State of a correction. correct_loop_init sets the fields up to `fine_change`,
   the module of MAIN and `printer`. The caller may change these fields and the
   module of EDGES before correct_loop_run; all other fields start as 0. */
typedef struct loop {
  const opc_host *host;
  const eda_gates *gates;
  const opc_module *extractor, *regulator;
  int64_t max_iterations;
  loop_start start;      /* earlier mask from which the loop starts */
  const eda_moved *base; /* displacements of the start; NULL: none */
  eda_boxes *begun; /* [2 * layers], shapes that the start adds to each layer,
                       then cut-outs of the start */
  uint8_t *still;   /* [gates], STILL_*: the transistor keeps its mask; 0: the
                       loop corrects the transistor; NULL: it corrects all, or
                       the choice has not been made yet */
  int prepared;     /* 1: the extractor is prepared */
  int traced;       /* 1: record each simulation in `trace` */
  int checked;      /* 1: the caller verifies the mask, so the only accurate
                       simulation is that after the first displacements */
  int hold;         /* 1: the guard reverts transistors worse than drawn */
  double ion_limit; /* largest |Ion deviation|, %, for the guard, the
                       verification and synthesizers without a limit */
  const double *rules; /* [EDA_RULES], mask rules, nm; NULL: unknown */
  double fine_change;  /* standard deviation of Ion, %, that image errors of
                          accurate simulations may cause; 0: one image error
                          for all layers (correct_fine_by_layer) */
  driver drivers[DRIVERS];
  eda_printer printer;
  uint8_t *driver_of;   /* [layers], MAIN or EDGES */
  pieces *pieces;       /* [layers], fragments of the edges */
  eda_shapes *polygons; /* [layers], polygons of the fragments */
  eda_shapes *mask;     /* [layers], polygons, added shapes and SRAFs, merged */
  sites *sites;         /* [layers], sites of dissected layers */
  trial now, next;      /* mask that was simulated last, and next mask */
  biases whole;         /* of correct_start_whole; only with a start */
  int32_t *unused;      /* biases that EDGES sets, which are ignored */
  eda_measurement measured;       /* measurement of `now`; with corners, the
                                     mean over the corners */
  eda_performance design, before; /* figures of the drawn shapes; figures of
                                     the simulated drawn mask */
  eda_measurement shown; /* measurement passed to synthesizers if `still` is
                            set */
  corners corners;
  gate_srafs assists;
  sraf_search_state search;
  summary summary; /* statistics of the last measurement */
  history history;
  guard guard;
  verification verification;
  trace trace;
  uint32_t *vetoes; /* [gates], EDA_VETO_* */
  uint32_t iterations;
  eda_field *drawn_print; /* [layers], simulated image of the drawn mask */
} loop;

/* Set up a loop for gates and settings. The caller may change fields before
   correct_loop_run, and must free the arrays with correct_loop_clear. Call on
   the main thread. */
OPC_EXPORT void correct_loop_init(loop *loop, const opc_host *host,
                                  const eda_gates *gates,
                                  const correct_settings *with);

/* Correct the mask until all synthesizers are done or after `max_iterations`,
   and verify the result by accurate simulations unless `fine` of the printer is
   0. Call once for each correct_loop_init, on the main thread. Return OPC_OK,
   OPC_CANCELLED or the error of a plugin. */
OPC_EXPORT int correct_loop_run(loop *loop, opc_error *error);

/* Copy the mask `next` to `now`, then simulate and measure `now`. Do not
   simulate layers whose mask is unchanged, unless `all` is 1. The regulator
   does not repair the mask, which the caller has chosen. */
OPC_EXPORT int correct_loop_print(loop *loop, int all, opc_error *error);

/* Simulate `now` with the accurate model and measure the result. Do not
   simulate layers that already have an accurate image. */
OPC_EXPORT int correct_loop_refine(loop *loop, opc_error *error);

/* Return the shapes that the loop's start added to a layer or, if `cutouts` is
   1, its cut-outs. */
OPC_EXPORT eda_boxes correct_loop_begun(const loop *l, size_t layer,
                                        int cutouts);

/* Return the last simulation in the form that regulators (plugins that enforce
   design rules) receive. The arrays belong to the loop. */
OPC_EXPORT eda_printed correct_loop_printed(const loop *loop);

/* Free the arrays of a loop after correct_loop_run, also after an error. */
OPC_EXPORT void correct_loop_clear(loop *loop);
