/* SPDX-License-Identifier: BSD-3-Clause */
#include "layers.h"

#include <search.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct layer_node {
  uint64_t code;  /* layer << 32 | datatype */
  int32_t number; /* in the layout */
  layer_node *next;
};

static int compare(const void *a, const void *b) {
  uint64_t x = ((const layer_node *)a)->code, y = ((const layer_node *)b)->code;
  return (x > y) - (x < y);
}

int layer_map_init(layer_map *layers, const opc_host *host,
                   const opc_value *map, uint32_t most, opc_error *error) {
  *layers = (layer_map){.host = host, .map = map};
  layers->roles = host->alloc(host, map->count, sizeof *layers->roles);
  if (!layers->roles)
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < map->count; i++) {
    const opc_pair *pair = &map->pairs[i];
    layer_role *role = &layers->roles[i];
    layer_number other_form;
    if (!layer_number_parse(pair->value, most, &role->number, &role->any))
      return host->fail(host, error, OPC_INVALID, "layers",
                        "'%s': a layer is written 9/0, or 9 for every "
                        "datatype",
                        pair->value);
    if (layer_number_parse(pair->key, UINT32_MAX, &other_form, NULL))
      return host->fail(host, error, OPC_INVALID, "layers",
                        "'%s': not a name for a layer, as the layers without "
                        "one are called so",
                        pair->key);
    for (size_t j = 0; j < i; j++) {
      const layer_role *other = &layers->roles[j];
      if (other->number.layer == role->number.layer &&
          other->any == role->any &&
          other->number.datatype == role->number.datatype)
        return host->fail(host, error, OPC_INVALID, "layers",
                          "'%s': layer %s is '%s' already", pair->key,
                          pair->value, map->pairs[j].key);
    }
  }
  return OPC_OK;
}

void layer_map_clear(layer_map *layers) {
  while (layers->list) {
    layer_node *l = layers->list;
    layers->list = l->next;
    tdelete(l, &layers->tree, compare);
    free(l);
  }
  if (layers->roles) layers->host->free(layers->host, layers->roles);
  layers->roles = NULL;
}

/* The name for numbers of the file: of the pair with both, or else of the one
   for every datatype, or else "L/D". */
static const char *name_of(const layer_map *layers, uint32_t layer,
                           uint32_t datatype, char *buffer, size_t room) {
  for (int any = 0; any < 2; any++)
    for (size_t i = 0; i < layers->map->count; i++) {
      layer_role *role = &layers->roles[i];
      if (role->number.layer != layer || role->any != any ||
          (!any && role->number.datatype != datatype))
        continue;
      role->seen = 1;
      return layers->map->pairs[i].key;
    }
  snprintf(buffer, room, "%u/%u", (unsigned)layer, (unsigned)datatype);
  return buffer;
}

int32_t layer_map_find(layer_map *layers, opc_layout *layout, uint32_t layer,
                       uint32_t datatype, opc_error *error) {
  uint64_t code = (uint64_t)layer << 32 | datatype;
  if (layers->last && layers->last->code == code) return layers->last->number;
  layer_node key = {.code = code};
  void *found = tfind(&key, &layers->tree, compare);
  if (found) {
    layers->last = *(layer_node **)found;
    return layers->last->number;
  }
  char buffer[32];
  const char *name = name_of(layers, layer, datatype, buffer, sizeof buffer);
  int32_t number = layers->host->layout->layer(layout, name, error);
  if (number < 0) return -1;
  layer_node *l = malloc(sizeof *l);
  if (l) {
    *l = (layer_node){code, number, layers->list};
    if (tsearch(l, &layers->tree, compare)) {
      layers->list = l;
      layers->last = l;
      return number;
    }
    free(l);
  }
  layers->host->fail(layers->host, error, OPC_FAILED, NULL, "out of memory");
  return -1;
}

static int by_code(const void *a, const void *b) {
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

/* "1/0, 9/0, ...", as much as fits. */
static void list_layers(const layer_map *layers, char *text, size_t room) {
  size_t n = 0, used = 0;
  for (const layer_node *l = layers->list; l; l = l->next) n++;
  uint64_t *codes = malloc((n + 1) * sizeof *codes);
  text[0] = '\0';
  if (!codes) return;
  n = 0;
  for (const layer_node *l = layers->list; l; l = l->next) codes[n++] = l->code;
  qsort(codes, n, sizeof *codes, by_code);
  for (size_t i = 0; i < n && used + 26 < room; i++)
    used += (size_t)snprintf(text + used, room - used, "%s%u/%u", i ? ", " : "",
                             (unsigned)(codes[i] >> 32),
                             (unsigned)(codes[i] & UINT32_MAX));
  free(codes);
}

int layer_map_check(const layer_map *layers, const char *path,
                    opc_error *error) {
  for (size_t i = 0; i < layers->map->count; i++) {
    if (layers->roles[i].seen) continue;
    char there[400];
    list_layers(layers, there, sizeof there);
    return layers->host->fail(
        layers->host, error, OPC_INVALID, "layers",
        "'%s': there is no layer %s for '%s'; there are %s", path,
        layers->map->pairs[i].value, layers->map->pairs[i].key,
        there[0] ? there : "no layers at all");
  }
  return OPC_OK;
}
