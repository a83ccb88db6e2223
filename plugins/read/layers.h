/* SPDX-License-Identifier: BSD-3-Clause */
/* From the layer and datatype numbers of a file to the layers of a layout. */
#ifndef OPCFLOW_READ_LAYERS_H
#define OPCFLOW_READ_LAYERS_H

#include <eda/formats.h>
#include <glib.h>

#include "reader.h"

typedef struct layer_role {
  eda_layer_number number;
  int any;  /* every datatype */
  int seen; /* in the file */
} layer_role;

/* A layer of the file. */
typedef struct layer_node {
  uint64_t code;  /* layer << 32 | datatype, the key */
  int32_t number; /* in the layout */
} layer_node;

typedef struct layer_map {
  const reader *r;
  layer_role *roles; /* one a pair of the map */
  GHashTable *nodes; /* those of the file so far */
  const layer_node *last;
} layer_map;

/* Understand the map of layers; numbers up to `most`. */
int layer_map_init(layer_map *layers, const reader *r, uint32_t most,
                   opc_error *error);
void layer_map_clear(layer_map *layers);

/* The layout's layer for numbers of the file, made if new; -1 and *error on
   failure. */
int32_t layer_map_find(layer_map *layers, eda_layout *layout, uint32_t layer,
                       uint32_t datatype, opc_error *error);

/* Once all is read: refuse names of layers that the file does not have. */
int layer_map_check(const layer_map *layers, opc_error *error);

/* For the `check` of a reader: whether the map can be understood. */
int layer_map_try(const reader *r, uint32_t most, opc_error *error);

#endif
