/* SPDX-License-Identifier: BSD-3-Clause */
/* Mask data for pictures drawn elsewhere: view.json. The format is described in
   the README.md of plugins/report. */
#pragma once

#include <eda/gates.h>
#include <glib.h>
#include <opcflow/plugin.h>

/* Limits of the written part of a layout, with their parameters. Basis: a
   transistor of a chip in SkyWater 130 takes 0.95 kB, and a page of 15 MB has
   space for 10 MB of pictures. With double the limit, the page of that chip of
   13,500 transistors had no pictures. */
typedef struct drawing_limits {
  int64_t whole, worst;
} drawing_limits;

#define DRAWING_PARAMETERS(state, member)                                     \
  OPC_PARAMETER_NAMED(                                                        \
      "whole", state, member.whole, .type = OPC_INT, .flags = OPC_AT_LEAST,   \
      .preset = "10000", .min = 0,                                            \
      .summary =                                                              \
          "Largest number of transistors with which all shapes are written; " \
          "above it, those near the worst transistors"),                      \
      OPC_PARAMETER_NAMED(                                                    \
          "worst", state, member.worst, .type = OPC_INT,                      \
          .flags = OPC_AT_LEAST, .preset = "500", .min = 1,                   \
          .summary = "Number of worst transistors above 'whole'")

/* Write the JSON object of a mask to a file. Errors have the parameter "mask"
   or "file". Returns OPC_OK or an error code. Call on the main thread. */
int drawing_file(const opc_context *context, const eda_mask *mask,
                 const drawing_limits *limits, const char *path,
                 opc_error *error);
