/* SPDX-License-Identifier: BSD-3-Clause */
/* File size of shapes in a layout file written by opcflow. */
#pragma once

#include <eda/formats.h>

/* Compute the size of merged shapes as elements of a GDSII file by
   write.gds. */
int gdsii_bytes(const eda_shapes *shapes, int64_t *bytes, opc_error *error);

/* Compute the size of merged shapes as compressed records of layer LAYER/0 in
   an OASIS file by write.oasis, without other layers in their blocks. */
int oasis_bytes(const eda_shapes *shapes, uint32_t layer, int64_t *bytes,
                opc_error *error);
