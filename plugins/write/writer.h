/* SPDX-License-Identifier: BSD-3-Clause */
/* What the writers of layout files share: which cells, shapes and layers are
   written, in which order, and the life of the file. A format says how each of
   them looks in the file. */
#ifndef OPCFLOW_WRITE_WRITER_H
#define OPCFLOW_WRITE_WRITER_H

#include <eda/formats.h>
#include <eda/layout.h>
#include <opcflow/step.h>

/* A writer's functions get its instance, which begins with a `writer`; those
   that return int return an OPC_* code. What the file cannot be given is seen
   when it is closed. */
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
  int (*begin)(void *self, const eda_layout *layout, double unit,
               opc_error *error);
  int (*begin_cell)(void *self, int32_t cell, const char *name,
                    opc_error *error);
  void (*polygon)(void *self, const eda_point *points, size_t n);
  int (*text)(void *self, eda_point at, const char *text, opc_error *error);
  int (*placement)(void *self, int32_t child, const char *child_name,
                   const eda_placement *placement, const char *name,
                   opc_error *error);
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
} writer;

/* The parameters of a writer whose instance, a `state`, begins with `writer w`;
   `preset_name` is that of the file. */
#define WRITE_PARAMETERS(state, preset_name, layers_summary)   \
  {                                                            \
    {.name = "layout",                                         \
     .type = OPC_INPUT,                                        \
     .choices = "layout",                                      \
     .summary = "The layout to write",                         \
     OPC_FIELD(state, w.layout),                               \
     .given = offsetof(state, w.layout_given)},                \
        {.name = "mask",                                       \
         .type = OPC_INPUT,                                    \
         .choices = "mask",                                    \
         .summary = "The mask to write, in place of a layout", \
         OPC_FIELD(state, w.mask),                             \
         .given = offsetof(state, w.mask_given)},              \
        {.name = "file",                                       \
         .type = OPC_OUTPUT,                                   \
         .preset = (preset_name),                              \
         .summary = "The file",                                \
         OPC_FIELD(state, w.name)},                            \
        {.name = "layers",                                     \
         .type = OPC_MAP,                                      \
         .summary = (layers_summary),                          \
         OPC_FIELD(state, w.layers)},                          \
  }

/* For the plugin's check and its step's run. */
int writer_check(writer *w, const write_format *format, opc_error *error);
int writer_run(void *self, void **outputs, opc_error *error);

/* name_layer of formats whose layers are numbers. */
void writer_number_layer(const eda_gates *gates, size_t k, int drawn,
                         char *name);

/* from + n * step; 0 if it leaves the range of coordinates. */
int writer_along(eda_point from, uint64_t n, eda_point step, eda_point *to);

/* The decimal number of 14 digits that a product of two such is near to. */
double writer_decimal(double v);

#endif
