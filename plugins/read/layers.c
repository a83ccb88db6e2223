/* SPDX-License-Identifier: BSD-3-Clause */
/* The layers of numbered formats; compiled into each of their readers. */
#include "layers.h"

#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

static int refuse_pair(const layer_map *layers, size_t i, opc_error *error) {
  const opc_pair *pairs = layers->r->layers.pairs;
  const layer_role *role = &layers->roles[i];
  for (size_t j = 0; j < i; j++) {
    const layer_role *other = &layers->roles[j];
    if (other->number.layer == role->number.layer && other->any == role->any &&
        other->number.datatype == role->number.datatype)
      return opc_fail(error, OPC_INVALID, "layers",
                      "'%s': layer %s is '%s' already", pairs[i].key,
                      pairs[i].value, pairs[j].key);
  }
  return OPC_OK;
}

int layer_map_init(layer_map *layers, const reader *r, uint32_t most,
                   opc_error *error) {
  size_t n = r->layers.count;
  *layers = (layer_map){
      .r = r,
      .roles = eda_alloc(n, sizeof(layer_role)),
      .nodes = g_hash_table_new_full(g_int64_hash, g_int64_equal, free, NULL)};
  for (size_t i = 0; i < n; i++) {
    const opc_pair *pair = &r->layers.pairs[i];
    layer_role *role = &layers->roles[i];
    eda_layer_number other_form;
    if (!eda_layer_number_read(pair->value, most, &role->number, &role->any))
      return opc_fail(error, OPC_INVALID, "layers",
                      "'%s': a layer is written 9/0, or 9 for every datatype",
                      pair->value);
    if (eda_layer_number_read(pair->key, UINT32_MAX, &other_form, NULL))
      return opc_fail(error, OPC_INVALID, "layers",
                      "'%s': not a name for a layer, as the layers without one "
                      "are called so",
                      pair->key);
    if (refuse_pair(layers, i, error)) return error->code;
  }
  return OPC_OK;
}

void layer_map_clear(layer_map *layers) {
  if (layers->nodes) g_hash_table_unref(layers->nodes);
  free(layers->roles);
  *layers = (layer_map){0};
}

int layer_map_try(const reader *r, uint32_t most, opc_error *error) {
  layer_map layers;
  int code = layer_map_init(&layers, r, most, error);
  layer_map_clear(&layers);
  return code;
}

/* The name for numbers of the file: of the pair with both, or else of the one
   for every datatype, or else "L/D". */
static const char *name_of(const layer_map *layers, uint32_t layer,
                           uint32_t datatype, char *buffer, size_t room) {
  const opc_map *map = &layers->r->layers;
  for (int any = 0; any < 2; any++)
    for (size_t i = 0; i < map->count; i++) {
      layer_role *role = &layers->roles[i];
      if (role->number.layer != layer || role->any != any ||
          (!any && role->number.datatype != datatype))
        continue;
      role->seen = 1;
      return map->pairs[i].key;
    }
  snprintf(buffer, room, "%u/%u", (unsigned)layer, (unsigned)datatype);
  return buffer;
}

int32_t layer_map_find(layer_map *layers, eda_layout *layout, uint32_t layer,
                       uint32_t datatype, opc_error *error) {
  uint64_t code = (uint64_t)layer << 32 | datatype;
  if (!layers->last || layers->last->code != code)
    layers->last = g_hash_table_lookup(layers->nodes, &code);
  if (layers->last) return layers->last->number;
  char buffer[32];
  const char *name = name_of(layers, layer, datatype, buffer, sizeof buffer);
  int32_t number = eda_layout_layer(layout, name, error);
  if (number < 0) return -1;
  layer_node *node = eda_alloc(1, sizeof *node);
  *node = (layer_node){code, number};
  g_hash_table_add(layers->nodes, node);
  layers->last = node;
  return number;
}

static int by_code(const void *a, const void *b) {
  const layer_node *const *x = a, *const *y = b;
  return ((*x)->code > (*y)->code) - ((*x)->code < (*y)->code);
}

/* "1/0, 9/0, ...", as much as fits. */
static void list_layers(const layer_map *layers, char *text, size_t room) {
  size_t used = 0;
  guint n;
  gpointer *nodes = g_hash_table_get_keys_as_array(layers->nodes, &n);
  text[0] = '\0';
  qsort(nodes, n, sizeof *nodes, by_code);
  for (guint i = 0; i < n && used + 26 < room; i++) {
    uint64_t code = ((const layer_node *)nodes[i])->code;
    used +=
        (size_t)snprintf(text + used, room - used, "%s%u/%u", i ? ", " : "",
                         (unsigned)(code >> 32), (unsigned)(code & UINT32_MAX));
  }
  g_free(nodes);
}

int layer_map_check(const layer_map *layers, opc_error *error) {
  const opc_map *map = &layers->r->layers;
  for (size_t i = 0; i < map->count; i++) {
    if (layers->roles[i].seen) continue;
    char there[400];
    list_layers(layers, there, sizeof there);
    return opc_fail(error, OPC_INVALID, "layers",
                    "'%s': there is no layer %s for '%s'; there are %s",
                    layers->r->file, map->pairs[i].value, map->pairs[i].key,
                    there[0] ? there : "no layers at all");
  }
  return OPC_OK;
}
