/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "extractor": computes the performance of a transistor from its printed
   slices. Kind, instance, [any], [main]: see opcflow/plugin.h. */
#pragma once

#include <eda/gates.h>

OPC_C_BEGIN

/* The slices of `count` gates: strips of the channel along L (the direction of
   the current), side by side along W. Slice s of gate i is at [i * slices + s].
   Lengths and widths in nm. The slices of a gate that does not print have
   length 0. */
typedef struct eda_slices {
  size_t count;         /* number of gates */
  size_t slices;        /* number of slices per gate */
  const uint8_t *type;  /* of each gate: EDA_NMOS, EDA_PMOS */
  const double *width;  /* of each slice, along W */
  const double *length; /* of each slice, along L */
  const double *edge;   /* distance from the middle of the slice to the nearer
                           active edge */
  /* Flavour of each gate (eda/gates.h), NULL for a gate without flavour. The
     array is NULL if no gate has a flavour. `extract` fails for a flavour
     without device table. Since 0.6. */
  const char *const *flavour;
} eda_slices;

/* A printed gate before slicing. */
typedef struct eda_printed_gate eda_printed_gate;
struct eda_printed_gate {
  uint8_t type;         /* EDA_NMOS, EDA_PMOS */
  double design_length; /* drawn L, nm */
  double design_width;  /* drawn W, nm */
  double width;         /* printed W, nm */
  /* Extension of the printed poly past the printed active, nm, at the LOW and
     HIGH end along W; INFINITY where the poly continues. */
  double extension[2];
  /* Return the printed length, nm, at the fraction `place` of the width; 0 if
     the poly does not print there in the middle of the drawn length. The caller
     reuses results for slices. */
  double (*length)(const eda_printed_gate *gate, double place);
  /* Write the printed lengths at n places; faster than n calls of `length`. */
  void (*lengths)(const eda_printed_gate *gate, size_t n, const double *place,
                  double *length);
  const void *data;    /* private to the caller */
  const char *flavour; /* as in eda_slices; NULL: none. Since 0.6. */
};

/* Functions of an extractor. */
typedef struct eda_extractor {
  /* Prepare the instance once, for example read the device tables. [main] */
  int (*prepare)(void *self, opc_error *error);

  /* Return the number of slices per gate. Set *place to the positions where
     lengths are measured: fractions of the gate width from 0 to 1, in ascending
     order; positions may be equal. Set *width to the widths of the slices:
     fractions of the gate width, >= 0, with the sum 1. The instance owns the
     arrays. */
  size_t (*slicing)(const void *self, const double **place,
                    const double **width);

  /* Compute the performance of all gates of `in` into the arrays of `out`,
     which have in->count elements. `outside` is zeroed or NULL. [any] */
  int (*extract)(const void *self, const eda_slices *in, eda_performance *out,
                 opc_error *error);

  /* Optional; NULL: all gates have the slices of `slicing`. Compute the slices
     of one gate: arrays of the same size and with the same rules as those of
     `slicing`. A slice may have width 0. Also called for drawn gates, whose
     `length` is constant. [any] */
  void (*slice)(const void *self, const eda_printed_gate *gate, double *place,
                double *width);

  /* Optional; NULL: unknown. Compute the shortest and longest length, nm, for
     which the figures of a transistor type are valid. Called after `prepare`.
     Return 1, or 0 if there are no limits. [any] */
  int (*range)(const void *self, int type, double *shortest, double *longest);

  /* Optional; NULL: unknown. Return the shortest length, nm, that the device
     model of a transistor type and flavour (NULL: none) covers; 0 if the
     extractor has no data of the flavour. Currents of shorter slices are
     extrapolated. Called after `prepare`. Since 0.9. [any] */
  double (*modelled)(const void *self, int type, const char *flavour);
  OPC_MAY_GROW
} eda_extractor;

OPC_C_END
