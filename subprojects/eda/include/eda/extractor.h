/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "extractor": from the printed slices of a transistor to its
   performance. */
#ifndef EDA_EXTRACTOR_H
#define EDA_EXTRACTOR_H

#include <eda/gates.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The slices of `count` gates, `slices` each: slice s of gate i is
   [i * slices + s]. Lengths in nm. A slice of a gate that did not print has
   the length 0. */
typedef struct eda_slices {
  size_t count, slices;
  const uint8_t *type; /* of each gate: EDA_NMOS, EDA_PMOS */
  const double *width; /* of each slice */
  const double *length;
  const double *edge; /* distance of its middle from the nearer active
                         edge */
  /* The flavour of each gate (eda/gates.h), NULL where it has none; NULL: none
     has one. An extractor without devices of a flavour fails. Since 0.6. */
  const char *const *flavour;
} eda_slices;

/* A printed gate that is about to be sliced. */
typedef struct eda_printed_gate eda_printed_gate;
struct eda_printed_gate {
  uint8_t type;                       /* EDA_NMOS, EDA_PMOS */
  double design_length, design_width; /* nm */
  double width;                       /* printed, nm */
  /* How far the printed poly goes past the printed active, nm, on the LOW and
     HIGH side along W; INFINITY where it goes on. */
  double extension[2];
  /* The printed length (nm) at a fraction of the width, 0 where nothing
     prints. A place that was asked for costs nothing as the place of a
     slice. */
  double (*length)(const eda_printed_gate *gate, double place);
  /* The lengths at n places, which take less time together. */
  void (*lengths)(const eda_printed_gate *gate, size_t n, const double *place,
                  double *length);
  const void *data;    /* of who measures */
  const char *flavour; /* as of eda_slices; NULL: none. Since 0.6. */
};

typedef struct eda_extractor {
  /* Once: read the devices. [main] */
  int (*prepare)(void *self, opc_error *error);

  /* Where to slice: the places across the width, as fractions of it in
     increasing order, and the widths, as fractions that sum to 1. Belongs to
     the instance. */
  size_t (*slicing)(const void *self, const double **place,
                    const double **width);

  /* The performance of all gates in `in`, into the arrays of `out`, which has
     room for in->count; `outside` is zeroed before, and NULL where nobody asks
     for it. [any] */
  int (*extract)(const void *self, const eda_slices *in, eda_performance *out,
                 opc_error *error);

  /* NULL: every gate is sliced as `slicing` says. Where to slice
     this gate: as many places and widths as `slicing` has, by its rules. A
     slice may have the width 0. Drawn gates, too, are sliced so: their length
     is the same everywhere. [any] */
  void (*slice)(const void *self, const eda_printed_gate *gate, double *place,
                double *width);

  /* NULL: it knows no ends. The shortest and the longest length, nm, of a type
     that its figures hold for, after `prepare`: 1; 0 if there are none. [any]
   */
  int (*range)(const void *self, int type, double *shortest, double *longest);
} eda_extractor;

#ifdef __cplusplus
}
#endif
#endif
