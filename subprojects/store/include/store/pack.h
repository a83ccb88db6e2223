/* SPDX-License-Identifier: BSD-3-Clause */
/* Files of a value of the store: a list of names and sizes is part of the
   value, and the contents follow the value (store/store.h). */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

/* Type of a list: name and size in bytes of each file. */
#define OPC_FILES_TYPE G_VARIANT_TYPE("a(ayt)")

/* Add the file at `path` to a list under `name`, a path relative to a folder; a
   missing file is skipped. Return FALSE if the path is no regular file. */
gboolean opc_files_add(GVariantBuilder *files, const char *path,
                       const char *name);

/* Return a list of all files of a folder (floating reference); NULL if an entry
   cannot be listed. */
GVariant *opc_files_list(const char *folder);

/* Return the size of all files of a list together, bytes. */
guint64 opc_files_bytes(GVariant *files);

/* Write the next `size` bytes of the descriptor `contents` to a file at `path`.
   Return OPC_IO and *error on failure. */
int opc_file_unpack(const char *path, int contents, guint64 size,
                    opc_error *error);

/* Write all files of a list into a folder, with the contents from the
   descriptor `contents`. Return OPC_IO and *error on failure. */
int opc_files_unpack(GVariant *files, int contents, const char *folder,
                     opc_error *error);
