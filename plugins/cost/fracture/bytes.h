/* SPDX-License-Identifier: BSD-3-Clause */
/* File size of shapes in a layout file written by opcflow. */
#pragma once

#include <eda/formats.h>

/* Compute the number of bytes that merged shapes take in a GDSII file written
   by write.gds. Only the elements are counted, without headers. */
int gdsii_bytes(const eda_shapes *shapes, int64_t *bytes, opc_error *error);

/* Compute the number of bytes that merged shapes on layer LAYER/0 take in an
   OASIS file written by write.oasis, as compressed blocks that contain no other
   layer. */
int oasis_bytes(const eda_shapes *shapes, uint32_t layer, int64_t *bytes,
                opc_error *error);
