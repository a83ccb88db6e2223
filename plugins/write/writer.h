/* SPDX-License-Identifier: BSD-3-Clause */
/* Common part of the writers of layouts: selection and order of cells, shapes
   and layers, and opening and closing of the file. A format defines the
   representation in the file. */
#pragma once

#include <eda/formats.h>
#include <eda/layout.h>
#include <opcflow/step.h>

/* Functions of a file format. `self` is the instance, which begins with a
   `writer`. Contents that a format cannot represent are reported by
   writer_fail; write errors are detected when the file is closed. */
typedef struct write_format {
  const char *layer;  /* example of a layer, for messages: "9/0" */
  size_t most_points; /* largest number of points of a polygon */

  /* Write the default name of layer k of a mask into `name`, 64 bytes. `drawn`
     1: the name of the layer with the drawn shapes of layer k. */
  void (*name_layer)(const eda_gates *gates, size_t k, int drawn, char *name);

  /* Set the layer of the following polygons and texts. Return 0 if `layer` is
     not valid in the format. */
  int (*set_layer)(void *self, const char *layer);

  /* Write the parts of the file, in the order of these members. `unit` is in
     nm; `layout` is NULL for a mask. `cell` and `child` are cells of the
     layout; the last argument of `placement` is the name of the instance, or
     NULL. */
  void (*begin)(void *self, const eda_layout *layout, double unit);
  void (*begin_cell)(void *self, int32_t cell, const char *name);
  void (*polygon)(void *self, const eda_point *points, size_t n);
  void (*text)(void *self, eda_point at, const char *text);
  void (*placement)(void *self, int32_t child, const char *child_name,
                    const eda_placement *placement, const char *name);
  void (*end_cell)(void *self);
  void (*end)(void *self);

  /* Free the data of the format, also after a failure. May be NULL. */
  void (*clear)(void *self);
} write_format;

/* First part of the instance of a writer. */
typedef struct writer {
  const opc_host *host;
  const eda_layout *layout;
  const eda_mask *mask;
  int layout_given, mask_given;
  const char *name; /* name of the output file */
  opc_map layers;   /* name of the layer -> layer in the file */

  const write_format *format; /* set by writer_check */
  const char *path;
  FILE *file;
  const char *cell; /* name of the cell being written */
  opc_error *error;
  int failed; /* code of the first failure */
} writer;

/* Parameters of a writer whose instance, a `state`, begins with `writer w`;
   `preset_name` is the default name of the file. */
#define WRITE_PARAMETERS(state, preset_name, layers_summary)                  \
  {                                                                           \
    OPC_PARAMETER_NAMED("layout", state, w.layout, .type = OPC_INPUT,         \
                        .choices = "layout", .summary = "Layout to write",    \
                        .given = offsetof(state, w.layout_given)),            \
        OPC_PARAMETER_NAMED("mask", state, w.mask, .type = OPC_INPUT,         \
                            .choices = "mask",                                \
                            .summary = "Mask to write, in place of a layout", \
                            .given = offsetof(state, w.mask_given)),          \
        OPC_PARAMETER_NAMED("file", state, w.name, .type = OPC_OUTPUT,        \
                            .preset = (preset_name),                          \
                            .summary = "File to write"),                      \
        OPC_PARAMETER_NAMED("layers", state, w.layers, .type = OPC_MAP,       \
                            .summary = (layers_summary)),                     \
  }

/* Serve as `check` of a writing plugin, and as `run` of the step. Return OPC_OK
   or an error. */
int writer_check(writer *w, const write_format *format, opc_error *error);
int writer_run(void *self, void **outputs, opc_error *error);

/* Serve as `forecast` of the step: check the names of the layers. No memory or
   work is estimated. */
int writer_forecast(void *self, opc_forecast *out, opc_error *error);

/* Fail with OPC_FAILED, because the format cannot represent the layout. The
   first failure is kept; the file is deleted. */
OPC_PRINTF(2, 3) void writer_fail(writer *w, const char *format, ...);

/* Serve as name_layer of formats with numbered layers. */
void writer_number_layer(const eda_gates *gates, size_t k, int drawn,
                         char *name);

/* Compute from + n * step. Return 0 beyond the range of coordinates. */
int writer_along(eda_point from, uint64_t n, eda_point step, eda_point *to);

/* Return the decimal number of 14 digits that is nearest to v, a product of
   decimal numbers. */
double writer_decimal(double v);
