/* SPDX-License-Identifier: BSD-3-Clause */
/* What the writers of layout files share: which cells, shapes and layers are
   written, in which order, and the life of the file. A format says how each of
   them looks in the file. */
#ifndef OPCFLOW_WRITE_WRITER_H
#define OPCFLOW_WRITE_WRITER_H

#include <eda/formats.h>
#include <eda/layout.h>
#include <opcflow/step.h>

/* A writer's functions get its instance, which begins with a `writer`. What a
   format cannot say they tell by writer_fail; what the file cannot be given is
   seen when it is closed. */
typedef struct write_format {
  const char *layer;  /* how a layer is written, for messages: "9/0" */
  size_t most_points; /* of a polygon */

  /* The name of layer k of a mask, where the flow gives none, in a buffer of 64
     bytes; `drawn`: of its shapes before they were corrected. */
  void (*name_layer)(const eda_gates *gates, size_t k, int drawn, char *name);

  /* Whether `layer` can be one of the file; if so, it is that of the polygons
     and texts that follow. */
  int (*set_layer)(void *self, const char *layer);

  /* The parts of the file, in this order; `unit` in nm. `layout` is NULL for a
     mask. */
  void (*begin)(void *self, const eda_layout *layout, double unit);
  void (*begin_cell)(void *self, int32_t cell, const char *name);
  void (*polygon)(void *self, const eda_point *points, size_t n);
  void (*text)(void *self, eda_point at, const char *text);
  void (*placement)(void *self, int32_t child, const char *child_name,
                    const eda_placement *placement, const char *name);
  void (*end_cell)(void *self);
  void (*end)(void *self);

  /* Free what these made, also after a failure. May be NULL. */
  void (*clear)(void *self);
} write_format;

typedef struct writer {
  const opc_host *host;
  const eda_layout *layout;
  const eda_mask *mask;
  int layout_given, mask_given;
  const char *name; /* of the file */
  opc_map layers;   /* name: what the file calls it */

  const write_format *format; /* set by writer_check */
  const char *path;
  FILE *file;
  const char *cell; /* the name of the one that is being written */
  opc_error *error;
  int failed; /* the code of the first failure */
} writer;

/* The parameters of a writer whose instance, a `state`, begins with `writer w`;
   `preset_name` is that of the file. */
#define WRITE_PARAMETERS(state, preset_name, layers_summary)                   \
  {                                                                            \
    OPC_PARAMETER_NAMED("layout", state, w.layout, .type = OPC_INPUT,          \
                        .choices = "layout", .summary = "The layout to write", \
                        .given = offsetof(state, w.layout_given)),             \
        OPC_PARAMETER_NAMED(                                                   \
            "mask", state, w.mask, .type = OPC_INPUT, .choices = "mask",       \
            .summary = "The mask to write, in place of a layout",              \
            .given = offsetof(state, w.mask_given)),                           \
        OPC_PARAMETER_NAMED("file", state, w.name, .type = OPC_OUTPUT,         \
                            .preset = (preset_name), .summary = "The file"),   \
        OPC_PARAMETER_NAMED("layers", state, w.layers, .type = OPC_MAP,        \
                            .summary = (layers_summary)),                      \
  }

/* For the plugin's check and its step's run. */
int writer_check(writer *w, const write_format *format, opc_error *error);
int writer_run(void *self, void **outputs, opc_error *error);

/* The file cannot hold what the layout has: OPC_FAILED. The first failure is
   kept, and what is written after it is dropped with the file. */
OPC_PRINTF(2, 3) void writer_fail(writer *w, const char *format, ...);

/* name_layer of formats whose layers are numbers. */
void writer_number_layer(const eda_gates *gates, size_t k, int drawn,
                         char *name);

/* from + n * step; 0 if it leaves the range of coordinates. */
int writer_along(eda_point from, uint64_t n, eda_point step, eda_point *to);

/* The decimal number of 14 digits that a product of two such is near to. */
double writer_decimal(double v);

#endif
