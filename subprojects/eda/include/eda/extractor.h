/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "extractor": computes the performance of a transistor from its printed
   slices. */
#pragma once

#include <eda/gates.h>

OPC_C_BEGIN

/* The slices of `count` gates, `slices` each: slice s of gate i is at [i *
   slices + s]. Lengths in nm. Slices of a gate that did not print have length
   0. */
typedef struct eda_slices {
  size_t count, slices;
  const uint8_t *type; /* of each gate: EDA_NMOS, EDA_PMOS */
  const double *width; /* of each slice */
  const double *length;
  const double *edge; /* distance from the middle of the slice to the nearer
                         active edge */
  /* The flavour of each gate (eda/gates.h), NULL for a gate without flavour;
     NULL: no gate has one. An extractor without devices of a flavour fails.
     Since 0.6. */
  const char *const *flavour;
} eda_slices;

/* A printed gate before slicing. */
typedef struct eda_printed_gate eda_printed_gate;
struct eda_printed_gate {
  uint8_t type;                       /* EDA_NMOS, EDA_PMOS */
  double design_length, design_width; /* nm */
  double width;                       /* printed, nm */
  /* Extension of the printed poly past the printed active, nm, at the LOW and
     HIGH end along W; INFINITY where the poly continues. */
  double extension[2];
  /* Return the printed length (nm) at a fraction of the width, 0 where nothing
     prints. The result is reused if a slice is placed there. */
  double (*length)(const eda_printed_gate *gate, double place);
  /* Return the lengths at n places, faster than one by one. */
  void (*lengths)(const eda_printed_gate *gate, size_t n, const double *place,
                  double *length);
  const void *data;    /* private to the caller */
  const char *flavour; /* as in eda_slices; NULL: none. Since 0.6. */
};

typedef struct eda_extractor {
  /* Prepare once, for example read the devices. [main] */
  int (*prepare)(void *self, opc_error *error);

  /* Return the number of slices, their places as increasing fractions of the
     width, and their widths as fractions with the sum 1. The arrays belong to
     the instance. */
  size_t (*slicing)(const void *self, const double **place,
                    const double **width);

  /* Compute the performance of all gates of `in` into the arrays of `out`,
     which have in->count elements. `outside` is zeroed before the call, or NULL
     if not wanted. [any] */
  int (*extract)(const void *self, const eda_slices *in, eda_performance *out,
                 opc_error *error);

  /* Optional; NULL: every gate is sliced as `slicing` returns. Compute the
     slices of one gate: as many places and widths as `slicing` returns, by the
     same rules. A slice may have width 0. Drawn gates are sliced in the same
     way, with a constant length. [any] */
  void (*slice)(const void *self, const eda_printed_gate *gate, double *place,
                double *width);

  /* Optional; NULL: no limits known. Compute the shortest and longest length
     (nm) of a transistor type for which the figures are valid, after `prepare`.
     Return 1, or 0 if there are no limits. [any] */
  int (*range)(const void *self, int type, double *shortest, double *longest);
  OPC_MAY_GROW
} eda_extractor;

OPC_C_END
