/* SPDX-License-Identifier: BSD-3-Clause */
/* Bytes that shapes take in a layout file as our writers make it. */
#ifndef OPCFLOW_COST_BYTES_H
#define OPCFLOW_COST_BYTES_H

#include <eda/formats.h>

/* Of merged shapes, as elements of a GDSII file that write.gds makes. */
int gdsii_bytes(const eda_shapes *shapes, int64_t *bytes, opc_error *error);

/* The same, as compressed records of the layer LAYER/0 in an OASIS file that
   write.oasis makes, if no other layer shares their blocks. */
int oasis_bytes(const eda_shapes *shapes, uint32_t layer, int64_t *bytes,
                opc_error *error);

#endif
