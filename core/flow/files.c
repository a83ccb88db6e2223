/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and writes whole files; makes, renames and removes folders. */
#include "core/flow/files.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_RUNS = 100000 };

static int remove_entry(const char *path, const struct stat *about, int type,
                        struct FTW *walk) {
  (void)about;
  (void)type;
  (void)walk;
  return remove(path);
}

gboolean opc_remove_tree(const char *path) {
  return !nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS | FTW_MOUNT);
}

char *opc_file_sha256(const char *path, opc_error *error) {
  FILE *file = fopen(path, "rb");
  if (!file) {
    opc_fail(error, OPC_IO, NULL, "'%s': %s", path, g_strerror(errno));
    return NULL;
  }
  g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
  guchar buffer[65536];
  size_t n;
  while ((n = fread(buffer, 1, sizeof buffer, file)) > 0)
    g_checksum_update(sum, buffer, (gssize)n);
  char *text = g_strdup(g_checksum_get_string(sum));
  if (ferror(file)) {
    opc_fail(error, OPC_IO, NULL, "'%s': cannot be read", path);
    g_clear_pointer(&text, g_free);
  }
  fclose(file);
  return text;
}

int opc_write_file(const char *path, const char *text, opc_error *error) {
  FILE *file = fopen(path, "wb");
  gboolean good = file && fwrite(text, 1, strlen(text), file) == strlen(text);
  int why = errno;
  if (file && fclose(file)) {
    why = errno;
    good = FALSE;
  }
  if (good) return OPC_OK;
  return opc_fail(error, OPC_IO, NULL, "'%s': %s", path, g_strerror(why));
}

/* ---- run folders ---- */

static gboolean is_there(const char *path) {
  struct stat about;
  return !lstat(path, &about);
}

/* Only what a run left is ever replaced. */
static gboolean is_run(const char *path) {
  g_autofree char *manifest = g_build_filename(path, "manifest.json", NULL);
  g_autofree char *flow = g_build_filename(path, "flow.yaml", NULL);
  if (is_there(manifest) && is_there(flow)) return TRUE;
  GDir *dir = g_dir_open(path, 0, NULL);
  gboolean empty = dir && !g_dir_read_name(dir);
  if (dir) g_dir_close(dir);
  return empty;
}

int opc_folder_allowed(const char *target, gboolean force, opc_error *error) {
  if (!is_there(target)) return OPC_OK;
  if (!force)
    return opc_fail(error, OPC_IO, NULL,
                    "'%s': already exists, --force replaces it", target);
  if (is_run(target)) return OPC_OK;
  return opc_fail(error, OPC_IO, NULL,
                  "'%s': is not the folder of a run, and is not replaced",
                  target);
}

char *opc_folder_open(const char *target, opc_error *error) {
  g_autofree char *parent = g_path_get_dirname(target);
  g_autofree char *name = g_path_get_basename(target);
  if (g_mkdir_with_parents(parent, 0777)) {
    opc_fail(error, OPC_IO, NULL, "'%s': %s", parent, g_strerror(errno));
    return NULL;
  }
  g_autofree char *hidden = g_strdup_printf(".%s.XXXXXX", name);
  char *work = g_build_filename(parent, hidden, NULL);
  if (!g_mkdtemp_full(work, 0777)) {
    opc_fail(error, OPC_IO, NULL, "'%s': %s", parent, g_strerror(errno));
    g_clear_pointer(&work, g_free);
  }
  return work;
}

/* Rename, but never onto something. */
static int move(const char *from, const char *to) {
  if (!renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE)) return 0;
  if (errno != EINVAL && errno != ENOSYS) return -1;
  if (is_there(to)) {
    errno = EEXIST;
    return -1;
  }
  return rename(from, to);
}

/* The earlier run goes aside first, and away when the new one is there. */
static int replace_run(const char *work, const char *target) {
  g_autofree char *aside = g_strdup_printf("%s.old", work);
  if (move(target, aside)) return -1;
  if (move(work, target)) {
    int why = errno;
    move(aside, target);
    errno = why;
    return -1;
  }
  opc_remove_tree(aside);
  return 0;
}

char *opc_folder_close(const char *work, const char *target, gboolean replace,
                       gboolean number, opc_error *error) {
  if (replace && is_there(target) && is_run(target) &&
      !replace_run(work, target))
    return g_strdup(target);
  for (int i = 1; i < MOST_RUNS; i++) {
    g_autofree char *name =
        i == 1 ? g_strdup(target) : g_strdup_printf("%s-%d", target, i);
    if (!move(work, name)) return g_steal_pointer(&name);
    if (!number || errno != EEXIST) break;
  }
  opc_fail(error, OPC_IO, NULL, "'%s': %s", target, g_strerror(errno));
  return NULL;
}
