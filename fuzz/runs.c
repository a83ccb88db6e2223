/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes run folders in which one file has arbitrary content: manifest,
   metrics, resolved flow, a table, or the table of an experiment. */
#include <eda/runs.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <stdlib.h>

#include "fuzz/fuzz.h"

static const char *const files[] = {"manifest.json", "metrics.json",
                                    "flow.yaml", "experiment.csv"};
static const char *const good[] = {
    "{ \"opcflow\": \"0.2.0\", \"result\": \"complete\" }", "{}",
    "opcflow: 1\nname: a\nsteps: {}\n", "a\n"};

static char *folder;

static void file_put(const char *file, const void *text, gssize size) {
  g_autofree char *path = g_build_filename(folder, file, NULL);
  if (!g_file_set_contents_full(path, text, size, G_FILE_SET_CONTENTS_NONE,
                                0666, NULL))
    g_error("a file cannot be written");
}

static void read_all(void) {
  opc_error error;
  eda_run *run = eda_run_open(folder, &error);
  eda_table *table = run ? eda_run_table(run, "experiment", &error) : NULL;
  for (size_t i = 0; table && i < eda_table_columns(table); i++)
    eda_table_numbers(table, i);
  eda_run_free(run);
  eda_run_cases_free(eda_run_cases_open(folder, &error));
}

static void folder_clear(void) {
  for (int i = 0; i < 4; i++) {
    g_autofree char *path = g_build_filename(folder, files[i], NULL);
    g_unlink(path);
  }
  g_rmdir(folder);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (!folder) {
    folder = g_dir_make_tmp("fuzz-XXXXXX", NULL);
    for (int i = 0; i < 4; i++) file_put(files[i], good[i], -1);
    atexit(folder_clear);
  }
  /* The first byte selects the file. */
  int which = size ? data[0] % 4 : 0;
  file_put(files[which], data + (size > 0), (gssize)size - (size > 0));
  read_all();
  file_put(files[which], good[which], -1);
  return 0;
}
