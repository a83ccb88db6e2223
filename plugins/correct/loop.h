/* SPDX-License-Identifier: BSD-3-Clause */
/* One correction: loop_run, and what it leaves. */
#ifndef CORRECT_LOOP_H
#define CORRECT_LOOP_H

#include <eda/print.h>

#include "report.h"

/* All that makes a mask of the drawn shapes; arrays by layer but `biases`. */
typedef struct trial {
  biases biases;
  int32_t **shift;    /* of layers that a synthesizer cut; else NULL */
  eda_boxes *patches; /* of the regulator */
  eda_boxes *bites;   /* what it takes away */
  eda_boxes *assists; /* of the synthesizers */
} trial;

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

/* Arrays are by layer, of gates or of pieces, made once. Set the first four,
   the drivers' modules and `printer`; clear the rest. */
typedef struct loop {
  const opc_host *host;
  const eda_gates *gates;
  const opc_module *extractor, *regulator;
  int64_t max_iterations;
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
  eda_performance design, before;
  summary summary; /* of what was measured */
  history history;
  uint32_t *vetoes;
  uint32_t iterations;
} loop;

int loop_run(loop *loop, opc_error *error);
eda_printed loop_printed(const loop *loop);
void loop_clear(loop *loop);

#endif
