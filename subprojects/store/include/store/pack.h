/* SPDX-License-Identifier: BSD-3-Clause */
/* Files packed into one value of the store: an array of names and contents. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

#define OPC_FILES_TYPE G_VARIANT_TYPE("a(ayay)")

/* Add the file at `path` to a list under `name`; a missing file is skipped.
   Return FALSE if the file cannot be read. */
gboolean opc_files_add(GVariantBuilder *files, const char *path,
                       const char *name);

/* Return all files of a folder as one floating value; NULL if a file cannot be
   read or all files exceed `most` bytes. */
GVariant *opc_files_pack(const char *folder, guint64 most);

/* Write the contents of a packed file to `path`. Return OPC_IO and *error on
   failure. */
int opc_file_unpack(const char *path, GVariant *bytes, opc_error *error);

/* Write all packed files into a folder. Return OPC_IO and *error on failure. */
int opc_files_unpack(GVariant *files, const char *folder, opc_error *error);
