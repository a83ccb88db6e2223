/* SPDX-License-Identifier: BSD-3-Clause */
/* Steps of segmentation, shared by whole layouts and windows. */
#pragma once

#include "segment/segment.h"

/* Return a new segmentation; `window` may then be set. segment_end frees it and
   returns the gates, NULL if the code is not OPC_OK. */
segment segment_new(const opc_context *context, const eda_layout *layout,
                    int32_t top, const eda_segment_settings *settings,
                    opc_error *error);
eda_gates *segment_end(segment *s, int code);

/* Run the steps in this order: existing layers and their bounds; shapes;
   intersections of poly and active; everything else. Shapes and regions may be
   cleared and computed again. */
int segment_begin(segment *s);
int segment_layers(segment *s);
int segment_regions(segment *s);
int segment_finish(segment *s);
void segment_clear_layers(segment *s);
