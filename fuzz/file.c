/* SPDX-License-Identifier: BSD-3-Clause */
/* Files in memory for the fuzzers. */
#include <glib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "fuzz/fuzz.h"

typedef struct memory_file {
  char path[64];
  int file; /* 0 before the first use */
} memory_file;

static const char *memory_file_put(memory_file *m, const uint8_t *data,
                                   size_t size) {
  if (!m->file) {
    m->file = memfd_create("input", MFD_CLOEXEC);
    if (m->file < 0) g_error("no file in memory");
    g_snprintf(m->path, sizeof m->path, "/proc/self/fd/%d", m->file);
  }
  if (ftruncate(m->file, 0) || pwrite(m->file, data, size, 0) != (ssize_t)size)
    g_error("the file in memory cannot be written");
  return m->path;
}

const char *fuzz_file(const uint8_t *data, size_t size) {
  static memory_file m;
  return memory_file_put(&m, data, size);
}

const char *fuzz_second_file(const uint8_t *data, size_t size) {
  static memory_file m;
  return memory_file_put(&m, data, size);
}
