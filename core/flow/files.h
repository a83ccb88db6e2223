/* SPDX-License-Identifier: BSD-3-Clause */
/* Small work on files and folders. Run folders are written under a name of
   their own and renamed when done. */
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

/* Whether the result may go to `target`: it is not there, or it is an earlier
   run (or empty) and `force` is set. OPC_IO and *error. */
int opc_folder_allowed(const char *target, gboolean force, opc_error *error);

/* Make the folder to write into, hidden beside `target`. NULL and *error. */
char *opc_folder_open(const char *target, opc_error *error);

/* Give `work` the name `target`, in place of an earlier run if `replace`, else
   TARGET-2, -3 ... if that is taken and `number`. The name it got (g_free),
   NULL and *error. */
char *opc_folder_close(const char *work, const char *target, gboolean replace,
                       gboolean number, opc_error *error);

#endif
