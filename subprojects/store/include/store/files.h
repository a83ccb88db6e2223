/* SPDX-License-Identifier: BSD-3-Clause */
/* Operations on files and folders. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>
#include <sys/stat.h>

/* Remove a folder with all contents; links are removed, not followed. Return
   FALSE if an entry could not be removed. */
gboolean opc_remove_tree(const char *path);

/* Return the SHA-256 of a regular file, up to the size at opening, in
   hexadecimal (g_free); NULL and *error on failure, OPC_CANCELLED if the user
   stops the calculation. `context` may be NULL. */
char *opc_file_sha256(const char *path, const opc_context *context,
                      opc_error *error);

/* Write a whole file, replacing an existing one, which stays on failure. Return
   OPC_IO and *error then. */
int opc_write_file(const char *path, const char *text, opc_error *error);

/* Function called for each entry of a folder: its path, and its name relative
   to the traversed folder. Return a code other than OPC_OK to end the
   traversal. */
typedef int opc_visit(void *data, const char *path, const char *name,
                      const struct stat *about, opc_error *error);

/* Visit all entries of a folder sorted by name, a folder after its contents;
   links are not followed. Return the code of `visit`, or OPC_IO and *error. */
int opc_walk(const char *folder, opc_visit *visit, void *data,
             opc_error *error);

/* Flush a file, or the names in a folder, to the disk. Return OPC_IO and *error
   on failure. */
int opc_sync(const char *path, opc_error *error);

/* Flush a folder with all contents. */
int opc_sync_tree(const char *folder, opc_error *error);
