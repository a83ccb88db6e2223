/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind "litho": from a mask to the intensity it gives. */
#ifndef EDA_LITHO_H
#define EDA_LITHO_H

#include <eda/imaging.h>
#include <eda/natural.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct eda_litho {
  /* Once, before any image: kernels and the like. [main] */
  int (*prepare)(void *self, opc_error *error);

  /* Up to which frequency (1/nm) the mask matters. Asked before prepare, too,
     for a forecast: 0 if it is not known yet. [any] */
  double (*band)(const void *self);

  /* The intensity that the mask of a layer gives; `layer` is its number
     (EDA_POLY, ...). The caller clears *out. [any] */
  int (*image)(const void *self, int layer, const eda_spectrum *mask,
               eda_field *out, opc_error *error);

  /* The same away from the focus that the parameters say, by `defocus` nm.
     May be NULL: the model has one focus. [any] */
  int (*image_at)(const void *self, int layer, const eda_spectrum *mask,
                  double defocus, eda_field *out, opc_error *error);

  /* The struct grows at its end only; what was there stays where it is.

     The image within `wanted` (clear field 1, at most that far off) of what the
     model gives with all it has, `defocus` nm from the focus that the
     parameters say, on the grid of `image`. What it needs for that is found
     when it is first asked for. If all it has does not reach it, the log says
     so. May be NULL: `image` and `image_at` are as good as the model gets.
     [any] */
  int (*image_fine)(const void *self, int layer, const eda_spectrum *mask,
                    double defocus, double wanted, eda_field *out,
                    opc_error *error);

  /* The spectrum of a mask (merged, in units of `grid` nm) up to the model's
     band, made its own way. May be NULL: eda_mask_spectrum does it. The caller
     clears *out. [any] */
  int (*transform)(const void *self, const eda_shapes *mask, double grid,
                   eda_frame frame, eda_spectrum *out, opc_error *error);

  /* How the integral of weight * intensity, `defocus` nm from the focus that
     the parameters say, changes with the shapes of the mask, on the grid of
     `weight`, as eda_coherent_gradient has it. May be NULL: the model cannot
     tell. The caller clears *out. [any] */
  int (*gradient)(const void *self, int layer, const eda_spectrum *mask,
                  double defocus, const eda_field *weight, eda_field *out,
                  opc_error *error);

  /* The scanner, from which lengths follow that a flow leaves open; asked
     before prepare, too. May be NULL: the model does not know. Since 0.7.
     [any] */
  eda_scanner (*scanner)(const void *self);
} eda_litho;

/* The spectrum of a mask as a model wants it, by its own `transform` or by
   eda_mask_spectrum. [any] */
OPC_EXPORT int eda_litho_spectrum(const opc_context *context,
                                  const opc_module *litho,
                                  const eda_shapes *mask, double grid,
                                  eda_frame frame, eda_spectrum *out,
                                  opc_error *error);

#ifdef __cplusplus
}
#endif
#endif
