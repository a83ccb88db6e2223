/* SPDX-License-Identifier: BSD-3-Clause */
/* What the writers of layout files share: which cells, shapes and layers are
   written, in which order, and the life of the file. A format says how each of
   them looks in the file. Compiled into every writer. */
#ifndef OPCFLOW_WRITER_H
#define OPCFLOW_WRITER_H

#include <opcflow/opcflow.h>
#include <stdio.h>

typedef struct writer writer;

/* The layers of a mask, as the flow calls them. */
enum { MASK_LAYERS = 5 };
#define MASK_LAYER_LIST "poly, active, contact, poly_drawn and active_drawn"

typedef struct write_format {
  size_t size;        /* of the plugin's state, which begins with a writer */
  const char *name;   /* "GDSII" */
  const char *layer;  /* how a layer is written, for messages: "9/0" */
  size_t most_points; /* of a polygon */
  const char *mask[MASK_LAYERS]; /* layers of a mask, where not given */

  /* Whether `layer` can be one of the file; if so, it is that of the polygons
     and texts that follow. */
  int (*set_layer)(writer *w, const char *layer);

  /* The parts of the file, in this order; `unit` in nm. All return an OPC_*
     code; what the file cannot be given is seen when it is closed. `layout` is
     NULL for a mask. */
  int (*begin)(writer *w, const opc_layout *layout, double unit,
               opc_error *error);
  int (*begin_cell)(writer *w, int32_t cell, const char *name,
                    opc_error *error);
  int (*polygon)(writer *w, const opc_point *points, size_t n,
                 opc_error *error);
  int (*text)(writer *w, opc_point at, const char *text, opc_error *error);
  int (*placement)(writer *w, int32_t child, const char *child_name,
                   const opc_placement *placement, const char *name,
                   opc_error *error);
  int (*end_cell)(writer *w, opc_error *error);
  int (*end)(writer *w, opc_error *error);

  /* Free what these made, also after a failure. May be NULL. */
  void (*clear)(writer *w);
} write_format;

struct writer {
  const opc_host *host;
  const opc_value *values;
  const write_format *format;
  const char *path;
  FILE *file;
  const char *cell; /* the name of the one that is being written */
};

/* In the order of the parameters that every writer declares. */
enum { WRITE_LAYOUT, WRITE_MASK, WRITE_FILE, WRITE_LAYERS };

/* Their declaration; `preset` is the name of the file. */
#define WRITE_PARAMETERS(preset_name, layers_summary)       \
  {                                                         \
    [WRITE_LAYOUT] = {.name = "layout",                     \
                      .type = OPC_INPUT,                    \
                      .choices = "layout",                  \
                      .summary = "The layout to write"},    \
    [WRITE_MASK] = {.name = "mask",                         \
                    .type = OPC_INPUT,                      \
                    .choices = "mask",                      \
                    .summary =                              \
                        "The mask to write, in place of a " \
                        "layout"},                          \
    [WRITE_FILE] = {.name = "file",                         \
                    .type = OPC_OUTPUT,                     \
                    .preset = (preset_name),                \
                    .summary = "The file"},                 \
    [WRITE_LAYERS] = {                                      \
      .name = "layers",                                     \
      .type = OPC_MAP,                                      \
      .summary = (layers_summary)                           \
    }                                                       \
  }

/* For the plugin's create and destroy, and its step's run. */
void *writer_create(const opc_host *host, const opc_value *values,
                    const write_format *format, opc_error *error);
void writer_destroy(void *self);
int writer_run(void *self, void **outputs, opc_error *error);

/* from + n * step; 0 if it leaves the range of coordinates. */
int writer_along(opc_point from, uint64_t n, opc_point step, opc_point *to);

int writer_no_memory(const writer *w, opc_error *error);

/* The decimal number of 14 digits that a product of two such is near to. */
double writer_decimal(double v);

#endif
