/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks of files and file names before they are opened. [any] */
#ifndef OPC_BASE_FILE_H
#define OPC_BASE_FILE_H

#include <glib.h>

/* Return why the file at `path` cannot be read as a regular file: "no such
   file", "is a pipe, not a regular file"; NULL if it can. The file is not
   opened, because opening may block. Write its size to *size unless NULL. */
const char *opc_file_fault(const char *path, size_t *size);

/* Return whether a relative file name stays inside its folder. */
gboolean opc_name_is_inside(const char *name);

#endif
