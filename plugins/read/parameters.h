/* SPDX-License-Identifier: BSD-3-Clause */
/* What every reader of layouts is told. */
#ifndef OPCFLOW_READ_PARAMETERS_H
#define OPCFLOW_READ_PARAMETERS_H

#include <opcflow/plugin.h>

enum { FILE_NAME, LAYERS, SCALE, TOP };

/* The array's content, with what the file and the map of layers are. */
#define READ_PARAMETERS(file_summary, layers_summary)                         \
  [FILE_NAME] = {.name = "file", .type = OPC_FILE, .flags = OPC_REQUIRED,     \
                 .summary = (file_summary)},                                  \
  [LAYERS] = {.name = "layers", .type = OPC_MAP, .summary = (layers_summary)}, \
  [SCALE] = {.name = "scale", .type = OPC_REAL, .flags = OPC_ABOVE,           \
             .preset = "1", .min = 0,                                         \
             .summary = "A factor on the unit of the file"},                  \
  [TOP] = {.name = "top", .type = OPC_TEXT,                                   \
           .summary = "The top cell; those it does not lead to are dropped"}

#endif
