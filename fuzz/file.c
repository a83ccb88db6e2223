/* SPDX-License-Identifier: BSD-3-Clause */
#include <glib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "fuzz/fuzz.h"

const char *fuzz_file(const uint8_t *data, size_t size) {
  static char path[64];
  static int file = -1;
  if (file < 0) {
    file = memfd_create("input", MFD_CLOEXEC);
    if (file < 0) g_error("no file in memory");
    g_snprintf(path, sizeof path, "/proc/self/fd/%d", file);
  }
  if (ftruncate(file, 0) || pwrite(file, data, size, 0) != (ssize_t)size)
    g_error("the file in memory cannot be written");
  return path;
}
