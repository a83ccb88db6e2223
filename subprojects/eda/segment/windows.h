/* SPDX-License-Identifier: BSD-3-Clause */
/* The parts of which segmenting is made, for a whole layout and for windows. */
#ifndef EDA_SEGMENT_WINDOWS_H
#define EDA_SEGMENT_WINDOWS_H

#include "segment/segment.h"

/* Nothing done yet; `window` may then be set. To be ended with segment_end,
   which gives the gates, NULL if the code is not OPC_OK. */
segment segment_new(const opc_context *context, const eda_layout *layout,
                    int32_t top, const eda_segment_settings *settings,
                    opc_error *error);
eda_gates *segment_end(segment *s, int code);

/* In this order: layers that are there, how far they go; their shapes; where
   poly lies over active; all the rest. Shapes and regions can be cleared and
   got again. */
int segment_begin(segment *s);
int segment_layers(segment *s);
int segment_regions(segment *s);
int segment_finish(segment *s);
void segment_clear_layers(segment *s);

#endif
