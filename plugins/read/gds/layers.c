/* SPDX-License-Identifier: BSD-3-Clause */
#include "layers.h"

#include <search.h>
#include <stdlib.h>
#include <string.h>

#include "records.h"

struct gds_layer {
  uint32_t code;  /* layer << 16 | datatype */
  int32_t number; /* in the layout */
  gds_layer *next;
};

static int compare(const void *a, const void *b) {
  uint32_t x = ((const gds_layer *)a)->code, y = ((const gds_layer *)b)->code;
  return (x > y) - (x < y);
}

int gds_layers_init(gds_layers *layers, const opc_host *host,
                    const opc_value *map, opc_error *error) {
  *layers = (gds_layers){.host = host, .map = map};
  layers->roles = host->alloc(host, map->count, sizeof *layers->roles);
  if (!layers->roles)
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < map->count; i++) {
    const opc_pair *pair = &map->pairs[i];
    gds_role *role = &layers->roles[i];
    uint32_t layer, datatype;
    if (!gds_parse_layer(pair->value, &role->layer, &role->datatype,
                         &role->any))
      return host->fail(host, error, OPC_INVALID, "layers",
                        "'%s': a layer is written 9/0, or 9 for every "
                        "datatype",
                        pair->value);
    if (gds_parse_layer(pair->key, &layer, &datatype, NULL))
      return host->fail(host, error, OPC_INVALID, "layers",
                        "'%s': not a name for a layer, as the layers without "
                        "one are called so",
                        pair->key);
    for (size_t j = 0; j < i; j++) {
      const gds_role *other = &layers->roles[j];
      if (other->layer == role->layer && other->any == role->any &&
          other->datatype == role->datatype)
        return host->fail(host, error, OPC_INVALID, "layers",
                          "'%s': layer %s is '%s' already", pair->key,
                          pair->value, map->pairs[j].key);
    }
  }
  return OPC_OK;
}

void gds_layers_clear(gds_layers *layers) {
  while (layers->list) {
    gds_layer *l = layers->list;
    layers->list = l->next;
    tdelete(l, &layers->tree, compare);
    free(l);
  }
  if (layers->roles) layers->host->free(layers->host, layers->roles);
  layers->roles = NULL;
}

/* The name for numbers of the file: of the pair with both, or else of the one
   for every datatype, or else "L/D". */
static const char *name_of(const gds_layers *layers, uint32_t layer,
                           uint32_t datatype, char *buffer, size_t room) {
  for (int any = 0; any < 2; any++)
    for (size_t i = 0; i < layers->map->count; i++) {
      gds_role *role = &layers->roles[i];
      if (role->layer != layer || role->any != any ||
          (!any && role->datatype != datatype))
        continue;
      role->seen = 1;
      return layers->map->pairs[i].key;
    }
  snprintf(buffer, room, "%u/%u", (unsigned)layer, (unsigned)datatype);
  return buffer;
}

int32_t gds_layers_find(gds_layers *layers, opc_layout *layout, uint32_t layer,
                        uint32_t datatype, opc_error *error) {
  uint32_t code = layer << 16 | datatype;
  if (layers->last && layers->last->code == code) return layers->last->number;
  gds_layer key = {.code = code};
  void *found = tfind(&key, &layers->tree, compare);
  if (found) {
    layers->last = *(gds_layer **)found;
    return layers->last->number;
  }
  char buffer[32];
  const char *name = name_of(layers, layer, datatype, buffer, sizeof buffer);
  int32_t number = layers->host->layout->layer(layout, name, error);
  if (number < 0) return -1;
  gds_layer *l = malloc(sizeof *l);
  if (l) {
    *l = (gds_layer){code, number, layers->list};
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
  uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

/* "1/0, 9/0, ...", as much as fits. */
static void list_layers(const gds_layers *layers, char *text, size_t room) {
  size_t n = 0, used = 0;
  for (const gds_layer *l = layers->list; l; l = l->next) n++;
  uint32_t *codes = malloc((n + 1) * sizeof *codes);
  text[0] = '\0';
  if (!codes) return;
  n = 0;
  for (const gds_layer *l = layers->list; l; l = l->next) codes[n++] = l->code;
  qsort(codes, n, sizeof *codes, by_code);
  for (size_t i = 0; i < n && used + 20 < room; i++)
    used += (size_t)snprintf(text + used, room - used, "%s%u/%u", i ? ", " : "",
                             (unsigned)(codes[i] >> 16),
                             (unsigned)(codes[i] & 0xffff));
  free(codes);
}

int gds_layers_check(const gds_layers *layers, const char *path,
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
