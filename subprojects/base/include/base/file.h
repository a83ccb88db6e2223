/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks of files and names; paths of folders. [any]: see opcflow/base.h. */
#pragma once

#include <glib.h>

/* Return a reason why the file at `path` cannot be read as a regular file, such
   as "no such file" or "is a pipe, not a regular file"; NULL if readable. The
   file is not opened, because opening may block. *size receives the size in
   bytes; `size` may be NULL. */
const char *opc_file_fault(const char *path, size_t *size);

/* Return whether a relative file name stays inside its folder. */
gboolean opc_name_is_inside(const char *name);

/* Return the names in a folder, sorted (char *, freed with the array); NULL if
   the folder cannot be read. */
GPtrArray *opc_folder_names(const char *folder);

/* Return whether a name has only letters, digits, '_', '-' and (if `dots` is
   TRUE) dots. The first character must not be a dot or '-'. */
gboolean opc_is_name(const char *text, gboolean dots);

/* Return whether a name has lower_case words separated by dots:
   "model.wide". */
gboolean opc_is_id(const char *name);

/* Return the folder of the running executable (g_free); NULL if unknown. */
char *opc_executable_folder(void);

/* Return the path PREFIX/`in`/opcflow/`name` of an installed file or folder
   (g_free); NULL if the executable is not installed. The folder of the
   executable must be PREFIX followed by one of `places` ("/bin",
   NULL-terminated). Thus an installation can be moved. */
char *opc_installed(const char *const *places, const char *in,
                    const char *name);
