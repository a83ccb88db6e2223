/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal state of the OASIS writer. */
#pragma once

#include <eda/oasis.h>
#include <zlib.h>

/* A shape of the current layer. */
typedef struct oasis_shape {
  eda_point at;
  uint32_t n; /* number of points; 2 for a box, given by two opposite corners */
  size_t start; /* index in `steps` of the second point; steps are relative to
                   `at` */
} oasis_shape;

/* A displacement. */
typedef struct oasis_step {
  int64_t x, y;
} oasis_step;

/* The writer. */
struct eda_oasis {
  FILE *file;     /* NULL: bytes are only counted */
  uint64_t place; /* current offset in the file, bytes */
  uint32_t crc;   /* CRC-32 of all bytes written so far */
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
