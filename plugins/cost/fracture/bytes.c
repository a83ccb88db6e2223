/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements file sizes: computed from the points for GDSII, measured with the
   writer's encoder for OASIS. */
#include "bytes.h"

#include <eda/oasis.h>

/* Largest numbers of points of a polygon, equal to those of the writers. */
enum { GDSII_POINTS = 8190, OASIS_POINTS = 1 << 20 };

/* Add the size of BOUNDARY, LAYER, DATATYPE, XY with the first point repeated,
   and ENDEL. */
static int count_boundary(void *data, const eda_point *points, size_t n,
                          opc_error *error) {
  (void)points;
  (void)error;
  *(int64_t *)data += 4 + 6 + 6 + 4 + 8 * ((int64_t)n + 1) + 4;
  return OPC_OK;
}

int gdsii_bytes(const eda_shapes *shapes, int64_t *bytes, opc_error *error) {
  const eda_polygon_taker take = {count_boundary, bytes, GDSII_POINTS};
  *bytes = 0;
  return eda_polygons_without_holes(shapes, &take, error);
}

typedef struct stream {
  eda_oasis *out;
  eda_layer_number layer;
} stream;

static int put_polygon(void *data, const eda_point *points, size_t n,
                       opc_error *error) {
  stream *s = data;
  (void)error;
  eda_oasis_polygon(s->out, s->layer, points, n);
  return OPC_OK;
}

int oasis_bytes(const eda_shapes *shapes, uint32_t layer, int64_t *bytes,
                opc_error *error) {
  stream s = {.out = eda_oasis_new(NULL), .layer = {.layer = layer}};
  const eda_polygon_taker take = {put_polygon, &s, OASIS_POINTS};
  int code = eda_polygons_without_holes(shapes, &take, error);
  if (!code) eda_oasis_end_shapes(s.out);
  if (!code && eda_oasis_collected(s.out)) eda_oasis_end_block(s.out);
  *bytes = (int64_t)eda_oasis_place(s.out);
  eda_oasis_free(s.out);
  return code;
}
