/* SPDX-License-Identifier: BSD-3-Clause */
/* Test helpers of readers: files of the corpus, and hostile files. */
#pragma once

#include <eda/layout.h>
#include <stdio.h>
#include <string.h>

#include "tests/data.h"
#include "tools/devel/testing.h"

/* Read a file by the reader `id` with the parameters `more` (", top: X" or "").
   Return NULL and *error if the file is rejected. */
static inline eda_layout *read_by(const char *id, const char *path,
                                  const char *more, opc_error *error) {
  g_autofree char *mapping = g_strdup_printf("{ file: '%s'%s }", path, more);
  g_autoptr(opc_module) module = opc_test_module(id, mapping, error);
  void *output = NULL;
  if (!module || opc_test_run(module, &output, error)) return NULL;
  return output;
}

/* Assert that any file results in a layout that can be flattened, or in an
   error with the path, in bounded time. */
static inline void assert_survives(const char *id, const char *path) {
  opc_error e = {0};
  eda_layout *layout = read_by(id, path, "", &e);
  if (!layout) {
    g_assert_cmpint(e.code, !=, 0);
    g_assert_nonnull(strstr(e.message, path));
    return;
  }
  int32_t top = eda_layout_top(layout, &e);
  for (size_t i = 0; i < eda_layout_layers(layout) && top >= 0; i++) {
    eda_flat flat;
    if (!eda_layout_flatten(layout, top, (int32_t)i, eda_layout_unit(layout),
                            &flat, &e))
      eda_flat_clear(&flat);
  }
  eda_layout_free(layout);
}

static inline void write_bytes(const char *path, const char *bytes, size_t n) {
  remove(path); /* some file systems flush a file that is rewritten */
  FILE *f = fopen(path, "wb");
  g_assert_nonnull(f);
  g_assert_cmpuint(fwrite(bytes, 1, n, f), ==, n);
  fclose(f);
}

/* Return the bytes of a file of the corpus (g_free), or skip the test. */
static inline char *corpus_file(const char *name, size_t *n) {
  g_autofree char *within = g_build_filename("gds-corpus", name, NULL);
  g_autofree char *path = find_data(within);
  char *bytes = NULL;
  if (path) g_assert_true(g_file_get_contents(path, &bytes, n, NULL));
  return bytes;
}
