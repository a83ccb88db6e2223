/* SPDX-License-Identifier: BSD-3-Clause */
/* Small work on files and folders. */
#ifndef OPCFLOW_CORE_FILES_H
#define OPCFLOW_CORE_FILES_H

#include <glib.h>
#include <opcflow/plugin.h>

/* Remove a folder and all in it; links are removed, not followed. FALSE if
   something stayed. */
gboolean opc_remove_tree(const char *path);

/* The SHA-256 of a file, in hexadecimal (g_free); NULL and *error. */
char *opc_file_sha256(const char *path, opc_error *error);

/* Write a whole file; OPC_IO and *error. */
int opc_write_file(const char *path, const char *text, opc_error *error);

#endif
