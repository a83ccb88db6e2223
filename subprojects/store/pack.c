/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists files for values of the store, and writes stored files. */
#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <store/files.h>
#include <store/pack.h>
#include <unistd.h>

gboolean opc_files_add(GVariantBuilder *all, const char *path,
                       const char *name) {
  struct stat about;
  if (lstat(path, &about)) return errno == ENOENT;
  if (!S_ISREG(about.st_mode)) return FALSE;
  g_variant_builder_add(all, "(^ayt)", name, (guint64)about.st_size);
  return TRUE;
}

static int list_entry(void *files, const char *path, const char *name,
                      const struct stat *about, opc_error *error) {
  if (S_ISDIR(about->st_mode)) return OPC_OK;
  return opc_files_add(files, path, name)
             ? OPC_OK
             : opc_fail(error, OPC_IO, NULL, "'%s'", path);
}

GVariant *opc_files_list(const char *folder) {
  GVariantBuilder files;
  opc_error none;
  g_variant_builder_init(&files, OPC_FILES_TYPE);
  int code = opc_traverse(folder, list_entry, &files, &none);
  if (!code) return g_variant_builder_end(&files);
  g_variant_builder_clear(&files);
  return NULL;
}

guint64 opc_files_bytes(GVariant *files) {
  GVariantIter all;
  guint64 bytes = 0, size;
  g_variant_iter_init(&all, files);
  while (g_variant_iter_next(&all, "(^&ayt)", NULL, &size)) bytes += size;
  return bytes;
}

/* Copy `size` bytes. Return 0 or an errno. */
static int copy_bytes(int to, int from, guint64 size) {
  char buffer[65536];
  while (size) {
    ssize_t n = read(from, buffer, MIN(size, sizeof buffer));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n ? errno : EIO;
    size -= (guint64)n;
    for (ssize_t done = 0, part; done < n; done += MAX(part, 0)) {
      part = write(to, buffer + done, (size_t)(n - done));
      if (part < 0 && errno != EINTR) return errno;
    }
  }
  return 0;
}

/* The file is a copy: later changes of the file do not affect the store. */
int opc_file_unpack(const char *path, int contents, guint64 size,
                    opc_error *error) {
  int to =
      open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
  int why = to < 0 ? errno : copy_bytes(to, contents, size);
  if (to >= 0 && close(to) && !why) why = errno;
  if (!why) return OPC_OK;
  return opc_fail(error, OPC_IO, NULL, "'%s': %s", path, g_strerror(why));
}

int opc_files_unpack(GVariant *files, int contents, const char *folder,
                     opc_error *error) {
  GVariantIter all;
  const char *name;
  guint64 size;
  int code = OPC_OK;
  g_variant_iter_init(&all, files);
  while (!code && g_variant_iter_next(&all, "(^&ayt)", &name, &size)) {
    g_autofree char *path = g_build_filename(folder, name, NULL);
    g_autofree char *parent = g_path_get_dirname(path);
    (void)g_mkdir_with_parents(parent, 0777);
    code = opc_file_unpack(path, contents, size, error);
  }
  return code;
}
