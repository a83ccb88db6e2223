/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernels of the transmission cross coefficient T(f1, f2), whichever way they
   are found: radial functions for a circular or annular source in focus, tables
   over the plane for everything else. */
#ifndef OPCFLOW_HOPKINS_KERNELS_H
#define OPCFLOW_HOPKINS_KERNELS_H

#include <eda/simd.h>
#include <stdlib.h>

#include "../vector.h"

typedef struct kernels kernels;
struct kernels {
  const opc_context *context;
  double cutoff;        /* 1/nm */
  double radius;        /* T is zero beyond it, in units of the cutoff */
  size_t count;         /* systems that are used; by keep */
  int all;              /* there are no more */
  const double *weight; /* of each used one */
  size_t rests; /* incoherent systems that what is left out is put back by */

  /* Use at most n systems, the strongest. [main] */
  void (*keep)(kernels *self, size_t n);
  /* There will be no more `keep`, and optics and context may go: free what only
     that needs. NULL: cannot be done. [main] */
  void (*settle)(kernels *self);
  /* As eda_systems has them, `self` being the kernels. [any] */
  void (*transfer)(const void *self, size_t s, const double *fx, double fy,
                   size_t n, float *out);
  void (*filter)(const void *self, size_t rest, const double *fx, double fy,
                 size_t n, float *out);
  eda_mirrored (*mirror)(const void *self, size_t s); /* or NULL */
  /* T of frequencies in units of the cutoff, exact; NULL if it is not known
     other than by its kernels. [any] */
  double (*cross)(const kernels *self, double x1, double y1, double x2,
                  double y2);
  void (*free)(kernels *self);
};

/* A circular or annular source and a pupil that depends on the radius alone,
   `defocus` nm further out of focus than the optics say. `real`: so are the
   pupil and all masks. `error`: what is wanted, clear field 1; it takes longer
   if it is small. */
kernels *radial_new(const opc_context *context, const optics *o, double defocus,
                    int real, double error);

/* Any source and pupil, `defocus` nm further out of focus than the optics
   say. NULL and *error on failure. */
kernels *plane_new(const opc_context *context, const optics *o, double defocus,
                   opc_error *error);

#endif
