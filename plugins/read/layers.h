/* SPDX-License-Identifier: BSD-3-Clause */
/* From the layer and datatype numbers of a file to the layers of a layout.
   Compiled into every reader of a numbered format. */
#ifndef OPCFLOW_READ_LAYERS_H
#define OPCFLOW_READ_LAYERS_H

#include <opcflow/opcflow.h>

#include "layer_number.h"

typedef struct layer_role {
  layer_number number;
  int any;  /* every datatype */
  int seen; /* in the file */
} layer_role;

typedef struct layer_node layer_node;

typedef struct layer_map {
  const opc_host *host;
  const opc_value *map; /* name: "L/D" or "L" */
  layer_role *roles;    /* one a pair of the map */
  void *tree;           /* tsearch: those of the file so far */
  layer_node *list;
  const layer_node *last;
} layer_map;

/* Understand the map; numbers up to `most`. */
int layer_map_init(layer_map *layers, const opc_host *host,
                   const opc_value *map, uint32_t most, opc_error *error);
void layer_map_clear(layer_map *layers);

/* The layout's layer for numbers of the file, made if new; -1 and *error on
   failure. */
int32_t layer_map_find(layer_map *layers, opc_layout *layout, uint32_t layer,
                       uint32_t datatype, opc_error *error);

/* Once all is read: refuse names of layers that the file does not have. */
int layer_map_check(const layer_map *layers, const char *path,
                    opc_error *error);

#endif
