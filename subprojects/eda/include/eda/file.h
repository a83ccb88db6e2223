/* SPDX-License-Identifier: BSD-3-Clause */
/* Files that plugins write. [any]: opcflow/plugin.h. */
#pragma once

#include <opcflow/base.h>
#include <stdio.h>

OPC_C_BEGIN

/* Close a written file. `file`: stream, or NULL if fopen() has just failed.
   `path`, `parameter`: for the message; `parameter` may be NULL. Return OPC_OK,
   or OPC_IO and *error if the file could not be opened, written or closed; a
   file that could be opened then remains. [any] */
OPC_EXPORT int eda_file_close(FILE *file, const char *path,
                              const char *parameter, opc_error *error);

OPC_C_END
