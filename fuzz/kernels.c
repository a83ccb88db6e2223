/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes kernel sets. An input is the text of weights, a zero byte, and the
   data of each kernel. */
#include <glib/gstdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fuzz/fuzz.h"
#include "plugins/litho/kernels/files.h"

enum { MOST_FILES = 8 }; /* number of files fh0.bin, fh1.bin ... */

static char *folder, *text;

static void clean_up(void) {
  for (int i = 0; i < MOST_FILES; i++) {
    g_autofree char *name = g_strdup_printf("%s/fh%d.bin", folder, i);
    g_unlink(name);
  }
  g_unlink(text);
  g_rmdir(folder);
  g_free(text);
  g_free(folder);
}

static void link_to(const char *path, const char *name) {
  if (symlink(path, name)) g_error("no link '%s'", name);
}

/* Create a folder with links to the files in memory. */
static void set_up(const char *weights, const char *kernel) {
  folder = g_dir_make_tmp("opcflow-fuzz-XXXXXX", NULL);
  if (!folder) g_error("no folder");
  text = g_build_filename(folder, "scales.txt", NULL);
  link_to(weights, text);
  for (int i = 0; i < MOST_FILES; i++) {
    g_autofree char *name = g_strdup_printf("%s/fh%d.bin", folder, i);
    link_to(kernel, name);
  }
  atexit(clean_up);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const uint8_t *zero = size ? memchr(data, 0, size) : NULL;
  size_t n = zero ? (size_t)(zero - data) : size, rest = zero ? n + 1 : size;
  const char *weights = fuzz_file(data, n);
  const char *kernel = fuzz_second_file(data + rest, size - rest);
  if (!folder) set_up(weights, kernel);
  opc_error error = {0};
  kernel_set set;
  if (!kernel_set_read(text, 0, &set, &error)) kernel_set_clear(&set);
  return 0;
}
