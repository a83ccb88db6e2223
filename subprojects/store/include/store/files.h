/* SPDX-License-Identifier: BSD-3-Clause */
/* Operations on files and folders. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>
#include <sys/stat.h>

/* Remove a folder with all contents; links are removed, not followed. Return
   FALSE if an entry could not be removed. */
gboolean opc_remove_tree(const char *path);

/* Return the SHA-256 (hexadecimal) of a regular file (g_free), up to the size
   that the file had when opened. NULL and *error on failure; OPC_CANCELLED if
   the user stops the calculation. `context` may be NULL. */
char *opc_file_sha256(const char *path, const opc_context *context,
                      opc_error *error);

/* Write a whole file and replace an existing one. On failure, return OPC_IO and
 *error; an existing regular file is then unchanged. A link, device or pipe is
   written in place. */
int opc_write_file(const char *path, const char *text, opc_error *error);

/* Function called for each entry of a folder. `name` is the path relative to
   the traversed folder. A return value other than OPC_OK ends the traversal. */
typedef int opc_visit(void *data, const char *path, const char *name,
                      const struct stat *about, opc_error *error);

/* Visit all entries of a folder and its subfolders, sorted by name, each folder
   after its contents. Links are not followed. Return the last code of `visit`,
   or OPC_IO and *error. */
int opc_traverse(const char *folder, opc_visit *visit, void *data,
                 opc_error *error);

/* Flush a file, or the directory entries of a folder, to the disk. Return
   OPC_IO and *error on failure. */
int opc_sync(const char *path, opc_error *error);

/* Flush a folder and all its contents to the disk; for more than 50 entries,
   the whole file system. Return OPC_IO and *error on failure. */
int opc_sync_tree(const char *folder, opc_error *error);
