/* SPDX-License-Identifier: BSD-3-Clause */
/* Kinds "litho" and "resist": from a mask to the shapes it prints. */
#ifndef OPCFLOW_LITHO_H
#define OPCFLOW_LITHO_H

#include <opcflow/imaging.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct opc_litho {
  size_t size;               /* sizeof(opc_litho) */

  /* Once, before any image: kernels and the like. [main] */
  int (*prepare)(void *self, opc_error *error);

  /* Up to which frequency (1/nm) the mask matters; after prepare. [any] */
  double (*band)(const void *self);

  /* The intensity that the mask of a layer (OPC_POLY, ...) gives. The host
     releases *out. [any] */
  int (*image)(const void *self, int layer, const opc_spectrum *mask,
               opc_field *out, opc_error *error);

  /* The same away from the focus that the parameters say, by `defocus` nm.
     May be NULL: the model has one focus. [any] */
  int (*image_at)(const void *self, int layer, const opc_spectrum *mask,
                  double defocus, opc_field *out, opc_error *error);
} opc_litho;

typedef struct opc_resist {
  size_t size;               /* sizeof(opc_resist) */

  /* Once, before any print: calibrate each layer (OPC_POLY, OPC_ACTIVE)
     against the litho model it will be used with. [main] */
  int (*prepare)(void *self, const opc_module *litho, opc_error *error);

  /* Turn the intensity of a layer into its level set, in place: positive where
     the feature prints. The field may get another grid. [any] */
  int (*print)(const void *self, int layer, opc_field *field,
               opc_error *error);
} opc_resist;

#ifdef __cplusplus
}
#endif
#endif
