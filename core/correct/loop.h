/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of the correction loop: mask edges, prints, measurements. */
#ifndef OPCFLOW_CORE_LOOP_H
#define OPCFLOW_CORE_LOOP_H

#include <opcflow/opcflow.h>

/* What moves the mask of each gate, in grid steps (mask.h): length, width, the
   line ends, [2 * i + side], and the jog. */
typedef struct opc_biases {
  int32_t *l, *w, *end, *jog;
} opc_biases;

/* ---- edges.c ---- */

/* The edges of a layer, cut into pieces. Polygon p has the pieces start[p] ..
   start[p+1]-1; piece i is drawn from from[i] to the from of the next one of
   its polygon, parallel to an axis, and the mask has it by[i] grid steps
   further out. */
typedef struct opc_pieces {
  size_t polygons, room;
  uint32_t *start;
  opc_point *from;
  int32_t *by;
} opc_pieces;

/* Room for the pieces of a layer's edges, whatever moves them; and for the
   pieces that a synthesizer cut, which are copied and not moved. 0 if there is
   no memory. */
int opc_pieces_of_edges(const opc_host *host, const opc_edges *edges,
                        opc_pieces *out);
int opc_pieces_of_cuts(const opc_host *host, const opc_cuts *cuts,
                       opc_pieces *out);
void opc_pieces_clear(const opc_host *host, opc_pieces *pieces);

/* The pieces of a layer's edges, moved by the biases of their gates. */
void opc_pieces_follow(const opc_gates *gates, int layer,
                       const opc_biases *biases, opc_pieces *out);

/* Shapes with room for what pieces make. 0 if there is no memory. */
int opc_pieces_shapes(const opc_host *host, const opc_pieces *pieces,
                      opc_shapes *out);

/* Boxes as polygons, n and then m more. 0 if there is no memory. */
int opc_pieces_boxes(const opc_host *host, const opc_box *box, size_t n,
                     const opc_box *more, size_t m, opc_shapes *out);

/* The polygons of moved pieces: no corner twice, none on a straight line. They
   keep their order; one of which nothing is left has no points. They may
   overlap if the moves close a gap. Writes the points and starts of `out`. */
void opc_pieces_build(const opc_pieces *pieces, opc_shapes *out);

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

/* A printer of all shapes of the gates, with a clear field of `margin` nm
   around them. Stays where it is made. */
void opc_printer_make(opc_printer *printer, const opc_host *host,
                      const opc_gates *gates, const opc_module *litho,
                      const opc_module *resist, double margin);

/* Prepare both models. */
int opc_printer_prepare(opc_printer *printer, opc_error *error);

/* Print the masks (merged) of the layers that are marked into printer->print,
   replacing what is there. */
int opc_printer_print(opc_printer *printer, const int layers[OPC_MASKS],
                      const opc_shapes mask[OPC_MASKS], opc_error *error);
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

/* ---- performance.c ---- */

/* Room for n gates, and freeing it. Making gives 0 if there is no memory. */
int opc_performance_make(const opc_host *host, size_t n, opc_performance *p);
void opc_performance_copy(opc_performance *to, const opc_performance *from);
void opc_performance_clear(const opc_host *host, opc_performance *p);
int opc_measurement_make(const opc_host *host, size_t n, opc_measurement *m);
void opc_measurement_clear(const opc_host *host, opc_measurement *m);

int opc_extract_prepare(const opc_module *extract, opc_error *error);

/* opc_measure of all gates, by all threads. */
int opc_measure_all(const opc_host *host, const opc_gates *gates,
                    const opc_field print[OPC_MASKS],
                    const opc_module *extract, opc_measurement *out,
                    opc_error *error);

/* Free an opc_mask: the release of a port. */
void opc_mask_release(void *mask);

/* ---- sites.c ---- */

/* Where the edge placement error of a layer's fragments is measured. */
typedef struct opc_sites {
  size_t count;
  double *place;             /* x, y of each, nm */
  uint8_t *axis;             /* of its normal: OPC_X, OPC_Y */
  int8_t *out;               /* +-1: outwards along it */
  double *epe;               /* nm; NAN where there is no edge near */
} opc_sites;

/* Those of checked cuts. 0 if there is no memory. */
int opc_sites_make(const opc_host *host, const opc_cuts *cuts, opc_sites *out);
void opc_sites_measure(const opc_host *host, const opc_sites *sites,
                       const opc_field *print);
void opc_sites_clear(const opc_host *host, opc_sites *sites);

/* ---- report.c ---- */

/* How far a print is from the design. */
typedef struct opc_summary {
  double ion_mean, ion_max, ion_stdv;   /* of |deviation|, %; eq. 3.3 to 3.5 */
  double area_mean, area_max, ioff_mean;
  size_t gates, failed;
  double epe_mean, epe_max;             /* of |edge placement error|, nm */
  size_t sites, lost;                   /* lost: those without an edge near */
} opc_summary;

/* `sites` may be NULL, otherwise they are [OPC_MASKS]. */
opc_summary opc_summarize(const opc_gates *gates,
                          const opc_performance *design,
                          const opc_performance *printed,
                          const uint32_t *flags, const opc_sites *sites);

/* One line for each print of a loop. */
typedef struct opc_history opc_history;
opc_history *opc_history_new(void);
void opc_history_add(opc_history *history, const opc_summary *print,
                     uint32_t iteration, uint32_t simulations);
int opc_history_table(const opc_history *history, const opc_host *host,
                      opc_error *error);
void opc_history_free(opc_history *history);

/* What there is to tell of a mask that was printed. NULL for what there is
   not. */
typedef struct opc_report {
  const opc_mask *mask;
  const double *extension;
  const opc_sites *sites;            /* [OPC_MASKS] */
  const opc_biases *biases;
  const opc_module *synthesizer;
  const opc_mask *corrected;         /* the same one as its loop printed it */
} opc_report;

/* Its tables and metrics. */
int opc_report_mask(const opc_host *host, const opc_report *report,
                    opc_error *error);
int opc_report_violations(const opc_host *host, const opc_gates *gates,
                          const opc_violation *violations, size_t n,
                          size_t total, opc_error *error);

/* ---- loop.c ---- */

typedef struct opc_patches {
  opc_box *box;
  size_t count;
} opc_patches;

/* All that makes a mask of the drawn shapes. */
typedef struct opc_trial {
  opc_biases biases;
  int32_t *shift[OPC_MASKS];        /* of layers that are cut into fragments */
  opc_patches patches[OPC_MASKS];   /* of the regulator */
  opc_patches bites[OPC_MASKS];     /* what it takes away */
  opc_patches assists[OPC_MASKS];   /* of the synthesizer */
} opc_trial;

/* One correction. Arrays are of gates or of pieces, made once. Set the first
   five and `printer`; clear the rest. */
typedef struct opc_loop {
  const opc_host *host;
  const opc_gates *gates;
  const opc_module *extract, *synthesizer, *regulator;
  int max_iterations;
  opc_printer printer;
  opc_pieces pieces[OPC_MASKS];     /* of the edges */
  opc_shapes polygons[OPC_MASKS];   /* what they make */
  opc_shapes mask[OPC_MASKS];       /* that, patches and assists, merged */
  opc_sites sites[OPC_MASKS];       /* of layers that are cut into fragments */
  opc_trial now, next;              /* printed and measured; to try next */
  opc_measurement measured;
  opc_performance design, before;
  opc_summary summary;              /* of what was measured */
  opc_history *history;
  uint32_t *vetoes;
  uint32_t iterations;
} opc_loop;

int opc_loop_run(opc_loop *loop, opc_error *error);
opc_printed opc_loop_printed(const opc_loop *loop);
void opc_loop_clear(opc_loop *loop);

/* 100 (a - b) / b: thesis eq. 3.1. */
static inline double opc_deviation(double a, double b) {
  return 100 * (a - b) / b;
}

#endif
