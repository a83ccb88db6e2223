/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files that write OASIS share. */
#pragma once

#include <eda/oasis.h>
#include <zlib.h>

/* A shape, by its first point. */
typedef struct oasis_shape {
  eda_point at;
  uint32_t n;   /* points; 2 for a box, whose corners they are */
  size_t start; /* in `steps`: those after the first, from it */
} oasis_shape;

typedef struct oasis_step {
  int64_t x, y;
} oasis_step;

struct eda_oasis {
  FILE *file;     /* NULL: none */
  uint64_t place; /* in the file */
  uint32_t crc;   /* of all that is there */
  uint8_t *bytes; /* of the block that is being collected */
  size_t n, room;
  uint8_t *packed;
  size_t packed_room;
  z_stream z;

  eda_layer_number layer; /* of the shapes that are gathered */
  oasis_shape *shapes;
  size_t n_shapes, room_shapes;
  oasis_step *steps;
  size_t n_steps, room_steps;
};
