/* SPDX-License-Identifier: BSD-3-Clause */
/* From the layer and datatype numbers of a file to the layers of a layout. */
#ifndef OPCFLOW_GDS_LAYERS_H
#define OPCFLOW_GDS_LAYERS_H

#include <opcflow/opcflow.h>

typedef struct gds_role {
  uint32_t layer, datatype;
  int any;  /* every datatype */
  int seen; /* in the file */
} gds_role;

typedef struct gds_layer gds_layer;

typedef struct gds_layers {
  const opc_host *host;
  const opc_value *map; /* name: "L/D" or "L" */
  gds_role *roles;      /* one a pair of the map */
  void *tree;           /* tsearch: those of the file so far */
  gds_layer *list;
  const gds_layer *last;
} gds_layers;

/* Understand the map. */
int gds_layers_init(gds_layers *layers, const opc_host *host,
                    const opc_value *map, opc_error *error);
void gds_layers_clear(gds_layers *layers);

/* The layout's layer for numbers of the file, made if new; -1 and *error on
   failure. */
int32_t gds_layers_find(gds_layers *layers, opc_layout *layout, uint32_t layer,
                        uint32_t datatype, opc_error *error);

/* Once all is read: refuse names of layers that the file does not have. */
int gds_layers_check(const gds_layers *layers, const char *path,
                     opc_error *error);

#endif
