/* SPDX-License-Identifier: BSD-3-Clause */
/* Paths of files in the source tree and in the test data, which are outside of
   the source tree. */
#pragma once

#include <glib.h>

/* Return the path of a file of the source tree (g_free). */
static inline char *source_path(const char *name) {
  const char *root = g_getenv("OPCFLOW_SOURCE");
  return g_build_filename(root ? root : ".", name, NULL);
}

/* Return the path of a file of the test data (g_free), in the folder
   OPCFLOW_TEST_DATA; by default, in shared/data beside the source tree. */
static inline char *data_path(const char *name) {
  const char *folder = g_getenv("OPCFLOW_TEST_DATA");
  g_autofree char *beside = source_path("../shared/data");
  return g_build_filename(folder ? folder : beside, name, NULL);
}

/* Return data_path(name). If the file or folder is missing, skip the running
   test and return NULL. */
static inline char *find_data(const char *name) {
  char *path = data_path(name);
  if (g_file_test(path, G_FILE_TEST_EXISTS)) return path;
  g_autofree char *reason = g_strdup_printf(
      "no test data '%s': set OPCFLOW_TEST_DATA to their folder", name);
  g_test_skip(reason);
  g_free(path);
  return NULL;
}
