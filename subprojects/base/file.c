/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks of files and names without opening them. */
#include <base/file.h>
#include <errno.h>
#include <string.h>
#include <sys/stat.h>

const char *opc_file_fault(const char *path, size_t *size) {
  struct stat about;
  if (stat(path, &about))
    return errno == ENOENT ? "no such file" : g_strerror(errno);
  if (size) *size = (size_t)about.st_size;
  switch (about.st_mode & S_IFMT) {
    case S_IFREG:
      return NULL;
    case S_IFDIR:
      return "is a folder, not a regular file";
    case S_IFIFO:
      return "is a pipe, not a regular file";
    case S_IFSOCK:
      return "is a socket, not a regular file";
    default:
      return "is a device, not a regular file";
  }
}

gboolean opc_name_is_inside(const char *name) {
  if (!*name || *name == '/') return FALSE;
  g_auto(GStrv) parts = g_strsplit(name, "/", -1);
  for (guint i = 0; parts[i]; i++)
    if (!*parts[i] || !strcmp(parts[i], ".") || !strcmp(parts[i], ".."))
      return FALSE;
  return TRUE;
}
