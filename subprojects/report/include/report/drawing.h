/* SPDX-License-Identifier: BSD-3-Clause */
/* A mask as data for a picture that is drawn elsewhere: view.json. README.md of
   this family tells its form. */
#ifndef OPCFLOW_REPORT_DRAWING_H
#define OPCFLOW_REPORT_DRAWING_H

#include <eda/gates.h>
#include <glib.h>
#include <opcflow/plugin.h>

/* How much of a layout is written: a member of an instance, and its parameters.
   Source of the numbers: a transistor of a chip of SkyWater 130 takes 0.95 kB,
   and a page of 15 MB has room for 10 MB of pictures. At double, that chip of
   13,500 transistors had a page without any. */
typedef struct drawing_limits {
  int64_t whole, worst;
} drawing_limits;

#define DRAWING_PARAMETERS(state, member)                                   \
  OPC_PARAMETER_NAMED("whole", state, member.whole, .type = OPC_INT,        \
                      .flags = OPC_AT_LEAST, .preset = "10000", .min = 0,   \
                      .summary =                                            \
                          "Up to so many transistors all shapes are "       \
                          "kept, of more those near the worst"),            \
      OPC_PARAMETER_NAMED("worst", state, member.worst, .type = OPC_INT,    \
                          .flags = OPC_AT_LEAST, .preset = "500", .min = 1, \
                          .summary = "So many of the worst then")

/* Append the JSON object of a mask. Errors are those of the parameter "mask";
   [main]. */
int drawing_write(const opc_context *context, const eda_mask *mask,
                  const drawing_limits *limits, GString *out, opc_error *error);

/* The same into a file. */
int drawing_file(const opc_context *context, const eda_mask *mask,
                 const drawing_limits *limits, const char *path,
                 opc_error *error);

#endif
