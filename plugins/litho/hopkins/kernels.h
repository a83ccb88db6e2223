/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernels of the transmission cross coefficient T(f1, f2): radial functions for
   a circular or annular source with a radial pupil, tables over the plane for
   all other optics. */
#pragma once

#include <eda/simd.h>
#include <stdlib.h>

#include "../vector.h"

/* Largest number of kernels that plane_new computes. */
enum { PLANE_MOST = 120 };

/* Kernels of a T, and the functions of their representation. */
typedef struct kernels kernels;
struct kernels {
  const opc_context *context;
  double cutoff;        /* cutoff frequency NA / wavelength, 1/nm */
  double radius;        /* T is 0 beyond this radius, in units of the cutoff */
  size_t count;         /* number of kernels in use, set by `keep` */
  int all;              /* 1: no further kernels exist */
  const double *weight; /* weight of each kernel in use */
  size_t residuals;     /* number of residual terms (eda_kernels) */

  /* Use the n strongest kernels, or all if fewer exist. [main] */
  void (*keep)(kernels *self, size_t n);
  /* Free the data that only `keep` uses. After this call, `keep` must not be
     called, and the optics and the context may be freed. NULL if not supported.
     [main] */
  void (*settle)(kernels *self);
  /* Members of eda_kernels, with the kernels as `self`. [any] */
  void (*transfer)(const void *self, size_t s, const double *fx, double fy,
                   size_t n, float *out);
  void (*filter)(const void *self, size_t residual, const double *fx, double fy,
                 size_t n, float *out);
  eda_mirrored (*mirror)(const void *self, size_t s); /* may be NULL */
  /* Return the exact T(f1, f2) for frequencies in units of the cutoff. NULL if
     T is known only as a sum of kernels. [any] */
  double (*cross)(const kernels *self, double x1, double y1, double x2,
                  double y2);
  void (*free)(kernels *self);
};

/* Return kernels of a circular or annular source and a pupil that depends on
   the radius only. `defocus`, nm, is added to optics.defocus. `real`: 1: the
   pupil and all masks are real. `error`: requested error, relative to the clear
   field; a smaller error takes more time. Free with kernels.free. */
kernels *radial_new(const opc_context *context, const optics *o, double defocus,
                    int real, double error);

/* Return at most PLANE_MOST kernels of any source and pupil. `defocus`, nm, is
   added to optics.defocus. On failure, return NULL and set *error. Free with
   kernels.free. */
kernels *plane_new(const opc_context *context, const optics *o, double defocus,
                   opc_error *error);
