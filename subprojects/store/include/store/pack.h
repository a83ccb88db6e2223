/* SPDX-License-Identifier: BSD-3-Clause */
/* Files as a value of the store, a(ayay) of names and contents, and back. */
#ifndef OPC_STORE_PACK_H
#define OPC_STORE_PACK_H

#include <glib.h>
#include <opcflow/base.h>

#define OPC_FILES_TYPE G_VARIANT_TYPE("a(ayay)")

/* Add the file at `path` to a list under `name`. Return FALSE if it cannot be
   read; a missing file is left out. */
gboolean opc_files_add(GVariantBuilder *files, const char *path,
                       const char *name);

/* Pack all files of a folder (floating); NULL if one cannot be read, or if they
   have more than `most` bytes. */
GVariant *opc_files_pack(const char *folder, guint64 most);

/* Write a copy of a packed file's contents. OPC_IO and *error. */
int opc_file_unpack(const char *path, GVariant *bytes, opc_error *error);

/* Write all packed files into a folder. OPC_IO and *error. */
int opc_files_unpack(GVariant *files, const char *folder, opc_error *error);

#endif
