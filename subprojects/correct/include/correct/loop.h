/* SPDX-License-Identifier: BSD-3-Clause */
/* One correction: correct_loop_run, and what it leaves. */
#ifndef CORRECT_LOOP_H
#define CORRECT_LOOP_H

#include <eda/print.h>

#include <correct/assists.h>
#include <correct/corners.h>
#include <correct/guard.h>
#include <correct/proof.h>
#include <correct/report.h>
#include <correct/seek.h>
#include <correct/settings.h>
#include <correct/start.h>
#include <correct/trace.h>
#include <correct/trial.h>

/* Who moves a layer: the synthesizer of transistors, or the one of the edges
   of layers that no transistor moves. */
enum { MAIN, EDGES, DRIVERS };

/* A synthesizer in the loop. The arrays have what it sees of each layer: NULL
   and 0 where it cut none. */
typedef struct driver {
  const opc_module *module; /* NULL: none */
  const double **epe;
  int32_t **shift;
  size_t *fragments;
  int done;
} driver;

/* Arrays are by layer, of gates or of pieces, made once. Set those up to
   `ion_limit` that there are, the drivers' modules and `printer`; clear the
   rest.
 */
typedef struct loop {
  const opc_host *host;
  const eda_gates *gates;
  const opc_module *extractor, *regulator;
  int64_t max_iterations;
  loop_start start;      /* what it begins with besides the drawn edges */
  const eda_moved *base; /* its moves; NULL: there are none */
  eda_boxes *begun;      /* its patches, by layer, then its bites: those that
                            stay */
  uint8_t *still;        /* 1: that transistor keeps its mask; NULL: none does,
                            or it is not known yet */
  int prepared;          /* the extractor is */
  int traced;            /* each print into `trace` */
  int hold;              /* the guard takes back what is worse than drawn */
  double
      ion_limit;      /* %: largest allowed |Ion deviation|, for the guard, the
                         proof   and synthesizers that have no limit of their own */
  double fine_change; /* what correct_fine_by_layer takes */
  driver drivers[DRIVERS];
  eda_printer printer;
  uint8_t *driver_of;   /* MAIN or EDGES */
  pieces *pieces;       /* of the edges */
  eda_shapes *polygons; /* what they make */
  eda_shapes *mask;     /* that, patches and assists, merged */
  sites *sites;         /* of layers that are cut into fragments */
  trial now, next;      /* printed and measured; to try next */
  int32_t *unused;      /* biases that EDGES may write */
  eda_measurement measured;
  eda_performance design, before; /* as drawn: of the gates, of the print */
  eda_measurement shown; /* what synthesizers see if `still` is there */
  corners corners;
  gate_bars assists;
  sought_bars seek;
  summary summary; /* of what was measured */
  history history;
  guard guard;
  proof proof;
  trace trace;
  uint32_t *vetoes;
  uint32_t iterations;
  eda_field *drawn_print; /* of the drawn mask, as `before` has it */
} loop;

/* Set up a loop for these gates; a caller may change fields before
   correct_loop_run. correct_loop_clear frees it. [main] */
OPC_EXPORT void correct_loop_init(loop *loop, const opc_host *host,
                                  const eda_gates *gates,
                                  const correct_settings *with);
OPC_EXPORT int correct_loop_run(loop *loop, opc_error *error);

/* Print and measure the mask of `next`, which becomes `now`; only layers that
   changed, if not all. */
OPC_EXPORT int correct_loop_print(loop *loop, int all, opc_error *error);

/* Print `now` again with the fine model, and measure; only layers of which
   there is no fine print. */
OPC_EXPORT int correct_loop_refine(loop *loop, opc_error *error);

/* What is added to the mask that it begins with, or taken away. */
OPC_EXPORT eda_boxes correct_loop_begun(const loop *l, size_t layer, int bites);

/* The last print as a regulator sees it. */
OPC_EXPORT eda_printed correct_loop_printed(const loop *loop);

OPC_EXPORT void correct_loop_clear(loop *loop);

#endif
