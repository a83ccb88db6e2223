/* SPDX-License-Identifier: BSD-3-Clause */
/* Small work on files and folders. */
#ifndef OPC_STORE_FILES_H
#define OPC_STORE_FILES_H

#include <glib.h>
#include <opcflow/base.h>
#include <sys/stat.h>

/* Remove a folder and all in it; links are removed, not followed. FALSE if
   something stayed. */
gboolean opc_remove_tree(const char *path);

/* The SHA-256 of a regular file, as long as it is when it is opened, in
   hexadecimal (g_free); NULL and *error, OPC_CANCELLED if the user stops it.
   `context` may be NULL. */
char *opc_file_sha256(const char *path, const opc_context *context,
                      opc_error *error);

/* Write a whole file, in place of one that is there; if it fails, that one
   stays. OPC_IO and *error. */
int opc_write_file(const char *path, const char *text, opc_error *error);

/* What is done with an entry of a folder: its path, and its name in the folder
   that is walked. An OPC_* code other than OPC_OK ends the walk. */
typedef int opc_visit(void *data, const char *path, const char *name,
                      const struct stat *about, opc_error *error);

/* Visit all in a folder, by name, a folder after what is in it; links are not
   followed. What `visit` gave, or OPC_IO and *error. */
int opc_walk(const char *folder, opc_visit *visit, void *data,
             opc_error *error);

/* See to it that a file, or the names in a folder, outlive a loss of power;
   OPC_IO and *error. */
int opc_sync(const char *path, opc_error *error);

/* The same for a folder and all in it. */
int opc_sync_tree(const char *folder, opc_error *error);

#endif
