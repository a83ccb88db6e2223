/* SPDX-License-Identifier: BSD-3-Clause */
/* Files and their names, before they are opened. [any] */
#ifndef OPC_BASE_FILE_H
#define OPC_BASE_FILE_H

#include <glib.h>

/* Return why the file at `path` cannot be read from its beginning to an end:
   "no such file", "is a pipe, not a regular file"; NULL if it can. Nothing is
   opened, as that may block. *size, which may be NULL, gets the file's size. */
const char *opc_file_fault(const char *path, size_t *size);

/* Return whether a file name stays inside the folder that it is relative to. */
gboolean opc_name_is_inside(const char *name);

#endif
