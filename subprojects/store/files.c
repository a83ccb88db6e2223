/* SPDX-License-Identifier: BSD-3-Clause */
/* Reading and writing of whole files; traversal and removal of folders. */
#include <store/files.h>

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <glib/gstdio.h>
#include <nettle/sha2.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int remove_entry(const char *path, const struct stat *about, int type,
                        struct FTW *level) {
  (void)about;
  (void)type;
  (void)level;
  return remove(path);
}

gboolean opc_remove_tree(const char *path) {
  return !nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS | FTW_MOUNT);
}

/* Return a descriptor of a regular file; -1 and *error on failure. Opening a
   pipe does not block. */
static int open_regular(const char *path, struct stat *about,
                        opc_error *error) {
  int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file >= 0 && !fstat(file, about) && S_ISREG(about->st_mode)) return file;
  opc_fail(error, OPC_IO, NULL, "'%s': %s", path,
           file < 0 ? g_strerror(errno) : "is not a regular file");
  if (file >= 0) close(file);
  return -1;
}

char *opc_file_sha256(const char *path, const opc_context *context,
                      opc_error *error) {
  struct stat about;
  int file = open_regular(path, &about, error);
  if (file < 0) return NULL;
  struct sha256_ctx sum;
  uint8_t buffer[65536];
  sha256_init(&sum);
  int code = OPC_OK;
  /* Read no more than the size of the file at the start, because another
     program might append without end. */
  for (off_t left = about.st_size; left > 0 && !code;) {
    ssize_t n = read(file, buffer, (size_t)MIN(left, (off_t)sizeof buffer));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0)
      code = opc_fail(error, OPC_IO, NULL, "'%s': %s", path, g_strerror(errno));
    else if (n == 0)
      code = opc_fail(error, OPC_IO, NULL,
                      "'%s': became shorter while it was read", path);
    else if (opc_cancelled(context))
      code = opc_fail(error, OPC_CANCELLED, NULL, "stopped");
    if (n > 0) sha256_update(&sum, (size_t)n, buffer);
    left -= n;
  }
  close(file);
  if (code) return NULL;
  uint8_t digest[SHA256_DIGEST_SIZE];
  char *text = g_malloc0(2 * sizeof digest + 1);
  sha256_digest(&sum, sizeof digest, digest);
  for (size_t i = 0; i < sizeof digest; i++)
    sprintf(text + 2 * i, "%02x", digest[i]);
  return text;
}

/* Write a text and close the file. Return 0 or an errno. */
static int put_text(int file, const char *text) {
  size_t left = strlen(text);
  int why = 0;
  while (left && !why) {
    ssize_t n = write(file, text, left);
    if (n < 0 && errno != EINTR) why = errno;
    if (n <= 0) continue;
    text += n;
    left -= (size_t)n;
  }
  if (close(file) && !why) why = errno;
  return why;
}

/* A file is written under a temporary name and then renamed, so that readers
   never see a part of a file. Devices and pipes (/dev/stdout) are written
   directly. */
int opc_write_file(const char *path, const char *text, opc_error *error) {
  struct stat about;
  gboolean plain = lstat(path, &about) || S_ISREG(about.st_mode);
  g_autofree char *fresh = g_strconcat(path, ".XXXXXX", NULL);
  int file = plain ? g_mkstemp_full(fresh, O_WRONLY | O_CLOEXEC, 0666)
                   : open(path, O_WRONLY | O_TRUNC | O_CLOEXEC);
  int why = file < 0 ? errno : put_text(file, text);
  if (plain && !why && rename(fresh, path)) why = errno;
  if (plain && why && file >= 0) unlink(fresh);
  if (!why) return OPC_OK;
  return opc_fail(error, OPC_IO, NULL, "'%s': %s", path, g_strerror(why));
}

/* ---- folders ---- */

static int by_name(gconstpointer a, gconstpointer b) {
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Visit all entries; `start` is the length of the path of the outermost
   folder. */
static int folder_visit(const char *folder, size_t start, opc_visit *visit,
                        void *data, opc_error *error) {
  GError *fault = NULL;
  GDir *dir = g_dir_open(folder, 0, &fault);
  if (!dir) {
    opc_fail(error, OPC_IO, NULL, "%s", fault->message);
    g_error_free(fault);
    return OPC_IO;
  }
  g_autoptr(GPtrArray) paths = g_ptr_array_new_with_free_func(g_free);
  for (const char *name; (name = g_dir_read_name(dir));)
    g_ptr_array_add(paths, g_build_filename(folder, name, NULL));
  g_dir_close(dir);
  g_ptr_array_sort(paths, by_name);
  int code = OPC_OK;
  for (guint i = 0; i < paths->len && !code; i++) {
    const char *path = paths->pdata[i];
    struct stat about;
    if (lstat(path, &about))
      return opc_fail(error, OPC_IO, NULL, "'%s': %s", path, g_strerror(errno));
    if (S_ISDIR(about.st_mode))
      code = folder_visit(path, start, visit, data, error);
    if (!code) code = visit(data, path, path + start, &about, error);
  }
  return code;
}

int opc_traverse(const char *folder, opc_visit *visit, void *data,
                 opc_error *error) {
  g_autofree char *whole = g_build_filename(folder, "x", NULL);
  return folder_visit(folder, strlen(whole) - 1, visit, data, error);
}

static int sync_by(int sync(int file), const char *path, opc_error *error) {
  int file = open(path, O_RDONLY | O_CLOEXEC);
  int why = file < 0 || sync(file) ? errno : 0;
  if (file >= 0) close(file);
  /* Some file systems and special files do not support syncing. */
  if (!why || why == EINVAL || why == EROFS) return OPC_OK;
  return opc_fail(error, OPC_IO, NULL, "'%s': %s", path, g_strerror(why));
}

int opc_sync(const char *path, opc_error *error) {
  return sync_by(fsync, path, error);
}

static gboolean is_ours(const struct stat *about) {
  return S_ISREG(about->st_mode) || S_ISDIR(about->st_mode);
}

static int sync_entry(void *unused, const char *path, const char *name,
                      const struct stat *about, opc_error *error) {
  (void)unused;
  (void)name;
  return is_ours(about) ? opc_sync(path, error) : OPC_OK;
}

static int count_entry(void *count, const char *path, const char *name,
                       const struct stat *about, opc_error *error) {
  (void)path, (void)name, (void)error;
  *(guint *)count += is_ours(about);
  return OPC_OK;
}

/* Largest number of files that are synced one by one. On ext4, syncing 800
   files takes 2 to 3 s, but syncing the whole file system takes 0.05 s. A sync
   of the whole file system also writes the data of other programs. */
enum { FEW = 50 };

int opc_sync_tree(const char *folder, opc_error *error) {
  guint count = 0;
  int code = opc_traverse(folder, count_entry, &count, error);
  if (code) return code;
  if (count > FEW) return sync_by(syncfs, folder, error);
  code = opc_traverse(folder, sync_entry, NULL, error);
  return code ? code : opc_sync(folder, error);
}
