/* SPDX-License-Identifier: BSD-3-Clause */
/* GDSII is counted; OASIS is written, by the code of its writer, and thrown
   away. */
#include "bytes.h"

#include <stdio.h>
#include <stdlib.h>

#include "../../write/oasis/groups.h"
#include "../../write/polygons.h"

/* Points of one polygon, as the writers cut them. */
enum { GDSII_POINTS = 8190, OASIS_POINTS = 1 << 20 };

/* BOUNDARY, LAYER, DATATYPE, XY with the first point twice, ENDEL. */
static int count_boundary(void *data, const opc_point *points, size_t n,
                          opc_error *error) {
  (void)points;
  (void)error;
  *(int64_t *)data += 4 + 6 + 6 + 4 + 8 * ((int64_t)n + 1) + 4;
  return OPC_OK;
}

int gdsii_bytes(const opc_host *host, const opc_shapes *shapes, int64_t *bytes,
                opc_error *error) {
  *bytes = 0;
  polygon_taker take = {count_boundary, bytes, GDSII_POINTS};
  return polygons_without_holes(host, shapes, &take, error);
}

typedef struct stream {
  const opc_host *host;
  pack out;
  groups shapes;
  layer_number layer;
} stream;

static int no_memory(const opc_host *host, opc_error *error) {
  return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
}

static int put_polygon(void *data, const opc_point *points, size_t n,
                       opc_error *error) {
  stream *s = data;
  if (groups_full(&s->shapes)) groups_put(&s->shapes, &s->out, s->layer);
  return groups_add(&s->shapes, points, n) && !s->out.failed
             ? OPC_OK
             : no_memory(s->host, error);
}

static int put_layer(stream *s, const opc_shapes *shapes, opc_error *error) {
  polygon_taker take = {put_polygon, s, OASIS_POINTS};
  if (polygons_without_holes(s->host, shapes, &take, error))
    return error->code;
  if (s->shapes.n) groups_put(&s->shapes, &s->out, s->layer);
  if (s->out.n) pack_block(&s->out);
  return s->out.failed ? no_memory(s->host, error) : OPC_OK;
}

int oasis_bytes(const opc_host *host, const opc_shapes *shapes, uint32_t layer,
                int64_t *bytes, opc_error *error) {
  char *memory = NULL;
  size_t size = 0;
  FILE *file = open_memstream(&memory, &size);
  if (!file) return no_memory(host, error);
  stream s = {.host = host, .layer = {.layer = layer}};
  int code = pack_begin(&s.out, host, file) ? put_layer(&s, shapes, error)
                                            : no_memory(host, error);
  *bytes = (int64_t)s.out.place;
  pack_clear(&s.out);
  groups_clear(&s.shapes);
  fclose(file);
  free(memory);
  return code;
}
