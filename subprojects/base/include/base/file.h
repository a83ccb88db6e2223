/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks of files and names; paths of folders. [any]: see opcflow/base.h. */
#pragma once

#include <glib.h>

/* Return the reason why `path` does not name a regular file, such as "no such
   file" or "is a pipe, not a regular file"; NULL if `path` names a regular
   file. The file is not opened, because opening may block, and permissions are
   not checked. *size receives the size in bytes unless stat() fails; `size` may
   be NULL. */
const char *opc_file_fault(const char *path, size_t *size);

/* Return whether a name is a relative path without empty parts, "." and "..".
   Such a path stays inside its folder. */
gboolean opc_name_is_inside(const char *name);

/* Return the names in a folder, sorted (char *, freed with the array); NULL if
   the folder cannot be read. */
GPtrArray *opc_folder_names(const char *folder);

/* Return whether a name has at least one character, and only ASCII letters,
   digits, '_', '-' and (if `dots` is TRUE) dots. The first character must not
   be a dot or '-'. */
gboolean opc_is_name(const char *text, gboolean dots);

/* Return whether a name has words separated by dots: "model.wide". A word is a
   lower-case letter, then lower-case letters, digits and '_'. */
gboolean opc_is_id(const char *name);

/* Return the folder of the running executable (g_free); NULL if unknown. */
char *opc_executable_folder(void);

/* Return the path PREFIX/`in`/opcflow/`name` of an installed file or folder
   (g_free). The folder of the running executable must be PREFIX followed by one
   of `places`, a NULL-terminated array of paths such as "/bin"; otherwise
   return NULL. A moved installation still finds these files. If `in` is
   absolute, return `in`/opcflow/`name`. */
char *opc_installed(const char *const *places, const char *in,
                    const char *name);
