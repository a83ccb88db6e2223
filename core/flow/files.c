/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/flow/files.h"

#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <string.h>

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
