/* SPDX-License-Identifier: BSD-3-Clause */
/* Rule-based sub-resolution assist features (SRAF): scatter bars in the poly
   mask along the sides of each gate, wherever the spacing rules permit. */
#pragma once

#include <eda/gates.h>
#include <eda/srafs.h>
#include <opcflow/plugin.h>

struct loop; /* loop.h */

/* Parameters and scatter bars of a correction (struct loop, correct/loop.h);
   lengths in nm. */
typedef struct gate_srafs {
  int64_t rows; /* number of rows; 0: no scatter bars */
  double width, distance, space;
  double min_length, overhang;
  double margin; /* smallest distance of the intensity from the printing
                    threshold, relative to the clear field */
  eda_box_list srafs;
  size_t dropped; /* number of removed scatter bars */
} gate_srafs;

/* Return a length in grid steps, at most 1e6. */
int32_t correct_steps(const eda_gates *gates, double nm);

/* Place the scatter bars of all gates in the loop's next mask. Call after
   `begin` of the synthesizers. Returns OPC_OK, or OPC_INVALID if the
   synthesizer dissects the poly layer or a scatter bar is narrower than the
   mask grid. */
OPC_EXPORT int correct_assists_begin(struct loop *loop, opc_error *error);
/* Free the scatter bars. */
OPC_EXPORT void correct_assists_clear(struct loop *loop);

/* Return OPC_INVALID if a scatter bar of the loop's next mask, placed by any
   plugin, extends beyond the simulation frame. */
OPC_EXPORT int correct_assists_check(const struct loop *loop, opc_error *error);

/* Remove permanently the scatter bars of correct_assists_begin that print or
   nearly print in the last simulation: the intensity is less than `margin` from
   the printing threshold, or beyond the threshold. */
OPC_EXPORT void correct_assists_watch(struct loop *loop);

/* Publish the metrics "assists" and "assists_dropped". */
OPC_EXPORT int correct_assists_report(const struct loop *loop,
                                      opc_error *error);

/* Declare the parameters of the field `assists` of the step `state`. */
#define ASSISTS_LENGTH(state, name_, member, from_, text)                    \
  OPC_PARAMETER_NAMED(name_, state, assists.member, .type = OPC_REAL,        \
                      .flags = OPC_AT_LEAST, .unit = "nm", .follows = from_, \
                      .min = 0, .summary = text)
#define ASSISTS_PARAMETERS(state)                                              \
  OPC_PARAMETER_NAMED(                                                         \
      "assist", state, assists.rows, .type = OPC_INT,                          \
      .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "0", .max = 4,            \
      .summary = "Number of rows of scatter bars beside each side of a gate"), \
      ASSISTS_LENGTH(state, "assist_width", width, "0.155 lambda/NA",          \
                     "Width of a scatter bar"),                                \
      ASSISTS_LENGTH(state, "assist_distance", distance, "0.7 lambda/NA",      \
                     "Distance from drawn shapes to the first row"),           \
      ASSISTS_LENGTH(state, "assist_space", space, "0.311 lambda/NA",          \
                     "Space between scatter bars"),                            \
      ASSISTS_LENGTH(state, "assist_min_length", min_length,                   \
                     "0.389 lambda/NA", "Smallest length of a scatter bar"),   \
      ASSISTS_LENGTH(                                                          \
          state, "assist_overhang", overhang, "0.389 lambda/NA",               \
          "Extension of a scatter bar beyond each end of its gate"),           \
      OPC_PARAMETER_NAMED(                                                     \
          "assist_margin", state, assists.margin, .type = OPC_REAL,            \
          .flags = OPC_AT_LEAST, .preset = "0.02", .min = 0,                   \
          .summary =                                                           \
              "Smallest distance of the intensity from the printing "          \
              "threshold, relative to the clear field; scatter bars "          \
              "below it are removed")
