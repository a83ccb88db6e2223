/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "litho": computes the intensity of a mask. Kind, instance, [any],
   [main]: see opcflow/plugin.h. */
#pragma once

#include <eda/imaging.h>
#include <eda/natural.h>

OPC_C_BEGIN

/* Functions of a litho model. `image` is the fast model; `image_fine` is the
   accurate model, with a stated error. */
typedef struct eda_litho {
  /* Prepare the instance before any image, for example compute kernels.
     [main] */
  int (*prepare)(void *self, opc_error *error);

  /* Return the highest spatial frequency of masks, 1/nm, that the model uses.
     0: not yet known; the function is also called before `prepare`. [any] */
  double (*band)(const void *self);

  /* Compute the intensity of a mask, relative to the clear field, into *out.
     `mask`: spectrum of the mask of layer number `layer` (EDA_POLY, ...). The
     caller clears *out (eda_field_clear). [any] */
  int (*image)(const void *self, int layer, const eda_spectrum *mask,
               eda_field *out, opc_error *error);

  /* Optional. Compute the image at a defocus of `defocus` nm from the focus
     given by the parameters. NULL: the model has one focus. [any] */
  int (*image_at)(const void *self, int layer, const eda_spectrum *mask,
                  double defocus, eda_field *out, opc_error *error);

  /* Optional. As `image_at`, with a difference of at most `wanted` (clear
     field: 1) from the most accurate image of the model, on the grid of
     `image`. The first call computes further kernels. A model that cannot reach
     `wanted` logs a warning. NULL: `image` and `image_at` are the most
     accurate. [any] */
  int (*image_fine)(const void *self, int layer, const eda_spectrum *mask,
                    double defocus, double wanted, eda_field *out,
                    opc_error *error);

  /* Optional. Compute the spectrum of a mask (merged, in units of `grid` nm) up
     to the model's band. NULL: the caller uses eda_mask_spectrum. The caller
     clears *out. [any] */
  int (*transform)(const void *self, const eda_shapes *mask, double grid,
                   eda_frame frame, eda_spectrum *out, opc_error *error);

  /* Optional. Compute the gradient of the integral of weight * intensity,
     `defocus` nm from the focus given by the parameters, with respect to the
     mask's shapes, on the grid of `weight`; see eda_coherent_gradient. NULL:
     not supported. The caller clears *out. [any] */
  int (*gradient)(const void *self, int layer, const eda_spectrum *mask,
                  double defocus, const eda_field *weight, eda_field *out,
                  opc_error *error);

  /* Optional. Return the scanner, from which defaults of lengths are derived
     (natural.h); also called before `prepare`. NULL: unknown. Since 0.7.
     [any] */
  eda_scanner (*scanner)(const void *self);

  /* Optional; NULL if the model does not support other optics. Compute an image
     as `image_fine` does, with the numerical aperture `na` and the radius of
     the source `sigma` in place of the parameters. A value NAN stands for the
     value of the parameter. The band of `mask` is at least (1 + sigma) na /
     wavelength. The function does not need `prepare`. Since 0.9. [any] */
  int (*image_optics)(const void *self, int layer, const eda_spectrum *mask,
                      double na, double sigma, double defocus, double wanted,
                      eda_field *out, opc_error *error);
  OPC_MAY_GROW
} eda_litho;

/* Compute the spectrum of a mask for a model, by its `transform` or by
   eda_mask_spectrum. [any] */
OPC_EXPORT int eda_litho_spectrum(const opc_context *context,
                                  const opc_module *litho,
                                  const eda_shapes *mask, double grid,
                                  eda_frame frame, eda_spectrum *out,
                                  opc_error *error);

OPC_C_END
