/* SPDX-License-Identifier: BSD-3-Clause */
/* State of the step `correct`, and its division of a layout. */
#pragma once

#include <opcflow/step.h>

#include <correct/assists.h>
#include <correct/classes.h>
#include <correct/corners.h>
#include <correct/search.h>
#include <correct/start.h>

/* Values of the parameter `divide`. */
enum { DIVIDE_AUTO, DIVIDE_WHOLE, DIVIDE_ENVIRONMENTS, DIVIDE_CELLS };

/* The instance; first the parameters. */
typedef struct correct {
  const opc_host *host;
  const eda_layout *layout;
  const eda_gates *gates;
  int divide, gates_given, layout_given;
  const char *top;
  opc_map also, flavours;
  double grid, overhang, line_end;
  double radius, window; /* nm */
  int64_t rounds;
  int verify;
  const char *neighbours;
  loop_start start;
  double max_diff; /* %, of cells; NAN: not given */
  correct_settings with;
  const opc_module *edges;
  corners_request corners;
  gate_srafs assists;
  sraf_search_state search;
  int trace;
  const char *transistors;

  double margin;  /* range of optical interaction of classes, nm */
  int prepared;   /* 1: the extractor is prepared */
  eda_gates *own; /* whole layout, segmented here; NULL: none */
  classes_source source;
} correct;

/* Return OPC_INVALID if settings exclude each other; divide_check also checks
   the inputs. */
int divide_check_settings(const correct *c, opc_error *error);
int divide_check(const correct *c, opc_error *error);

/* Forecast for a correction of these gates as a whole. */
typedef void divide_whole(const correct *c, const eda_gates *gates,
                          opc_forecast *out);

/* Decide how to divide c->layout, and log the decision. Either correct the
   layout by classes (*by_classes = 1) and put the mask into outputs[0], or set
   c->gates to the transistors of the whole layout. */
int divide_run(correct *c, divide_whole *whole, void **outputs, int *by_classes,
               opc_error *error);

/* Return the gates of the whole layout, which then belong to the caller. */
eda_gates *divide_take_gates(correct *c);

/* Implement the functions of opc_step for c->layout. */
int divide_forecast(correct *c, divide_whole *whole, opc_forecast *out,
                    opc_error *error);
int divide_sketch(correct *c, divide_whole *whole, void **outputs,
                  opc_error *error);
int divide_restore(correct *c, const char *folder, void **outputs,
                   opc_error *error);

#define DIVIDE_PARAMETERS(state)                                             \
  OPC_PARAMETER(                                                             \
      state, top, .type = OPC_TEXT,                                          \
      .summary = "Top cell (default: the only cell that no other places)"),  \
      EDA_SEGMENT_PARAMETERS(state),                                         \
      OPC_PARAMETER(                                                         \
          state, radius, .type = OPC_REAL, .flags = OPC_ABOVE, .unit = "nm", \
          .min = 0,                                                          \
          .summary =                                                         \
              "Distance within which equal shapes result in equal "          \
              "masks (default: range of an optical effect of 1e-3 of "       \
              "the clear field, 7.1 / bandwidth)"),                          \
      OPC_PARAMETER(state, window, .type = OPC_REAL, .flags = OPC_AT_LEAST,  \
                    .unit = "nm", .preset = "60 um", .min = 1000,            \
                    .summary =                                               \
                        "Side of a window of the search for "                \
                        "environments; larger windows take more "            \
                        "memory and less time"),                             \
      OPC_PARAMETER(state, rounds, .type = OPC_INT,                          \
                    .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "2",      \
                    .min = 0, .max = 20,                                     \
                    .summary =                                               \
                        "Largest number of rounds in which deviating "       \
                        "transistors are split from their classes"),         \
      OPC_PARAMETER(state, neighbours, .type = OPC_TEXT,                     \
                    .summary =                                               \
                        "Layer of the boxes in which cells abut: with "      \
                        "'divide: cells', each cell is corrected among "     \
                        "copies of itself, as in rows (default: alone)"),    \
      OPC_PARAMETER(state, verify, .type = OPC_BOOL, .preset = "true",       \
                    .summary =                                               \
                        "Simulate the mask of the layout; false, for "       \
                        "'divide: cells': keep the masks of the cells, "     \
                        "with their figures in the cells")

#define DIVIDE_METRICS                                                         \
  {"windows", NULL, OPC_NEUTRAL, 0, "windows of the search for environments"}, \
      {"classes", NULL, OPC_LOWER, 0,                                          \
       "different drawn environments within 'radius'"},                        \
      {"prints", NULL, OPC_LOWER, 0,                                           \
       "different masked environments within 'margin', each verified"},        \
      {"cells", NULL, OPC_NEUTRAL, 0, "different cells with transistors"},     \
      {"cells_corrected", NULL, OPC_NEUTRAL, 0,                                \
       "cells that the results store did not contain"},                        \
      {"outside_cells", NULL, OPC_LOWER, 0,                                    \
       "different environments of transistors that no cell contains"},         \
      {"disturbance_mean", "%", OPC_LOWER, 0.01,                               \
       "mean change of |Ion deviation| from the cell to the layout"},          \
      {"disturbance_max", "%", OPC_LOWER, 0.01,                                \
       "largest increase of |Ion deviation| from the cell to the layout"},     \
      {"disturbed", "%", OPC_LOWER, 0.1,                                       \
       "transistors whose |Ion deviation| is larger by at least 0.05 %"},      \
  {                                                                            \
    "sheets", NULL, OPC_LOWER, 0,                                              \
        "sheets of clips that were corrected or simulated"                     \
  }
