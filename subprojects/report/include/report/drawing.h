/* SPDX-License-Identifier: BSD-3-Clause */
/* Mask data for pictures that another program draws: view.json. The format is
   described in the README.md of plugins/report. */
#pragma once

#include <eda/gates.h>
#include <glib.h>
#include <opcflow/plugin.h>

/* Limits of the written part of a layout, and the parameters that set the
   limits. A page of 15 MB has space for 10 MB of pictures, and a transistor of
   a chip in SkyWater 130 takes 0.95 kB, so that 10,000 transistors fit. */
typedef struct drawing_limits {
  int64_t whole, worst;
} drawing_limits;

#define DRAWING_PARAMETERS(state, member)                                      \
  OPC_PARAMETER_NAMED(                                                         \
      "whole", state, member.whole, .type = OPC_INT, .flags = OPC_AT_LEAST,    \
      .preset = "10000", .min = 0,                                             \
      .summary =                                                               \
          "Largest number of transistors of a layout that is written whole; "  \
          "of larger layouts, only shapes near the worst transistors"),        \
      OPC_PARAMETER_NAMED("worst", state, member.worst, .type = OPC_INT,       \
                          .flags = OPC_AT_LEAST, .preset = "500", .min = 1,    \
                          .summary =                                           \
                              "Number of worst transistors near which shapes " \
                              "are written, in layouts above 'whole'")

/* Write the JSON object of a mask to a file. An empty layout is an error of the
   parameter "mask", an unwritable file of "file"; other errors are those of
   eda_contours and of the simulation of classes. Return OPC_OK or an error
   code. Call on the main thread. */
int drawing_file(const opc_context *context, const eda_mask *mask,
                 const drawing_limits *limits, const char *path,
                 opc_error *error);
