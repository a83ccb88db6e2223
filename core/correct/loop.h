/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of the correction loop: mask edges, prints, measurements. */
#ifndef OPCFLOW_CORE_LOOP_H
#define OPCFLOW_CORE_LOOP_H

#include <opcflow/opcflow.h>

/* What moves the mask of each gate, in grid steps (mask.h): length, width, and
   the line ends, [2 * i + side]. */
typedef struct opc_biases {
  int32_t *l, *w, *end;
} opc_biases;

/* ---- edges.c ---- */

/* Shapes with room for a layer's edges however they move: 2 points a
   fragment. 0 if there is no memory. */
int opc_edges_room(const opc_host *host, const opc_edges *edges,
                   opc_shapes *out);

/* The mask of a layer: its drawn polygons with every fragment moved by the
   biases of its gate. Writes the points and starts of `out` (from
   opc_edges_room); polygons keep their order. The shapes may overlap if the
   biases close a gap. */
void opc_edges_move(const opc_gates *gates, int layer,
                    const opc_biases *biases, opc_shapes *out);

/* ---- model.c ---- */

/* A litho model whose calls are checked. `fault` is its first failure, with
   the code OPC_OK if there was none. */
typedef struct opc_model {
  opc_module module;             /* to be called in place of `litho` */
  opc_plugin plugin;
  opc_litho operations;
  const opc_module *litho;
  opc_error fault;
  int failed;
} opc_model;

/* Stays where it is made: the module points into it. */
void opc_model_make(opc_model *model, const opc_module *litho);

/* ---- printer.c ---- */

typedef struct opc_printer {
  const opc_host *host;
  opc_model litho;
  const opc_module *resist;
  opc_frame frame;
  double grid;
  opc_field print[OPC_MASKS];    /* level sets, positive where it prints */
  uint32_t simulations;
} opc_printer;

/* Prepare both models. */
int opc_printer_prepare(opc_printer *printer, opc_error *error);

/* Print a layer's mask into printer->print[layer], replacing what is there. */
int opc_printer_print(opc_printer *printer, int layer,
                      const opc_shapes *mask, opc_error *error);
void opc_printer_clear(opc_printer *printer);

/* ---- measure.c ---- */

/* What is measured of the gates of a print. */
typedef struct opc_measurement {
  uint32_t *flags;           /* OPC_PRINT_* */
  double *extension;         /* [2 * i + side], nm; mask.h */
  opc_performance performance;
} opc_measurement;

/* Measure gates `first` up to `last` of a print, each through the slices of
   the extractor. Any thread, for ranges that do not overlap. */
int opc_measure(const opc_host *host, const opc_gates *gates,
                const opc_field print[OPC_MASKS], const opc_module *extract,
                size_t first, size_t last, opc_measurement *out,
                opc_error *error);

/* The performance of the gates as drawn. */
int opc_measure_drawn(const opc_gates *gates, const opc_module *extract,
                      opc_performance *out, opc_error *error);

/* ---- report.c ---- */

/* The tables and metrics of a finished correction. */
int opc_correct_report(const opc_host *host, const opc_mask *mask,
                       const opc_biases *biases, const double *extension,
                       const opc_module *synthesizer, opc_error *error);
int opc_correct_report_violations(const opc_host *host,
                                  const opc_gates *gates,
                                  const opc_violation *violations, size_t n,
                                  size_t total, opc_error *error);

/* 100 (a - b) / b: thesis eq. 3.1. */
static inline double opc_deviation(double a, double b) {
  return 100 * (a - b) / b;
}

#endif
