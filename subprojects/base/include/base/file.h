/* SPDX-License-Identifier: BSD-3-Clause */
/* Files and names: checks before files are opened, folders, programs. [any] */
#pragma once

#include <glib.h>

/* Return why the file at `path` cannot be read as a regular file: "no such
   file", "is a pipe, not a regular file"; NULL if readable. The file is not
   opened, because opening may block. Write the file's size to *size unless
   NULL. */
const char *opc_file_fault(const char *path, size_t *size);

/* Return whether a relative file name stays inside its folder. */
gboolean opc_name_is_inside(const char *name);

/* Return the names in a folder, sorted (char *, freed with the array); NULL if
   the folder cannot be read. */
GPtrArray *opc_folder_names(const char *folder);

/* Return whether a name has letters, digits, '_', '-' and, if `dots`, dots, and
   begins with neither a dot nor '-'. */
gboolean opc_is_name(const char *text, gboolean dots);

/* Return whether a name has lower_case words with dots between: "model.wide".
 */
gboolean opc_is_id(const char *name);

/* Return the folder of the executable (g_free); NULL if there is none. */
char *opc_executable_folder(void);

/* Return the path of a file or folder in opcflow/ of the folder `in` of an
   installation (g_free); NULL if the executable is not installed. The path is
   relative to the folder of the executable, so that an installation can be
   moved. `places` are the possible ends of that folder, "/bin",
   NULL-terminated. */
char *opc_installed(const char *const *places, const char *in,
                    const char *name);
