/* SPDX-License-Identifier: BSD-3-Clause */
/* Common declarations of the OASIS writer. */
#pragma once

#include <eda/oasis.h>
#include <zlib.h>

/* A shape; steps are relative to its first point. */
typedef struct oasis_shape {
  eda_point at;
  uint32_t n;   /* number of points; 2 for the corners of a box */
  size_t start; /* first entry in `steps`, after the first point */
} oasis_shape;

typedef struct oasis_step {
  int64_t x, y;
} oasis_step;

struct eda_oasis {
  FILE *file;     /* NULL: none */
  uint64_t place; /* offset in the file */
  uint32_t crc;   /* of all bytes of the file so far */
  uint8_t *bytes; /* bytes of the current block */
  size_t n, capacity;
  uint8_t *packed;
  size_t packed_capacity;
  z_stream z;

  eda_layer_number layer; /* layer of the collected shapes */
  oasis_shape *shapes;
  size_t n_shapes, capacity_shapes;
  oasis_step *steps;
  size_t n_steps, capacity_steps;
};
