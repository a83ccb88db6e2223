/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs of an experiment, read from the table experiment.csv. */
#include <glib.h>
#include <math.h>
#include <string.h>

#include "runs/text.h"

struct eda_run_cases {
  eda_table *table;
  GArray *all;      /* eda_run_case */
  GPtrArray *paths; /* folders, char * */
};

enum { CASE, METHOD, FOLDER, RESULT, SECONDS, COLUMNS };
static const char *const names[COLUMNS] = {"case", "method", "folder", "result",
                                           "seconds"};

static char *table_path(const char *folder) {
  return g_build_filename(folder, "experiment.csv", NULL);
}

int eda_run_is_experiment(const char *folder) {
  g_autofree char *path = table_path(folder);
  return g_file_test(path, G_FILE_TEST_IS_REGULAR);
}

/* Return whether a relative path stays within its folder. */
static gboolean is_inside(const char *path) {
  g_auto(GStrv) parts = g_strsplit(path, "/", -1);
  return !g_path_is_absolute(path) &&
         !g_strv_contains((const char *const *)parts, "..");
}

static int read_row(eda_run_cases *c, const char *folder, const int at[COLUMNS],
                    size_t row, GHashTable *seen, opc_error *error) {
  eda_table *t = c->table;
  const char *cell[COLUMNS];
  for (int i = 0; i < COLUMNS; i++)
    cell[i] = eda_table_text(t, row, (size_t)at[i]);
  for (int i = CASE; i <= METHOD; i++)
    if (!*cell[i])
      return eda_table_fail(t, row, (size_t)at[i], "is empty:", error);
  if (!is_inside(cell[FOLDER]))
    return eda_table_fail(t, row, (size_t)at[FOLDER],
                          "path outside of the folder:", error);
  /* A line feed before a carriage return separates the names in the key. Names
     of cases and methods have no line breaks. */
  if (!g_hash_table_add(seen,
                        g_strdup_printf("%s\n\r%s", cell[CASE], cell[METHOD])))
    return eda_table_fail(t, row, (size_t)at[METHOD],
                          "duplicate method of this case:", error);
  const double *seconds = eda_table_numbers(t, (size_t)at[SECONDS]);
  eda_run_case one = {.name = cell[CASE],
                      .method = cell[METHOD],
                      .result = cell[RESULT],
                      .seconds = seconds ? seconds[row] : NAN};
  if (*cell[FOLDER]) {
    one.folder = g_build_filename(folder, cell[FOLDER], NULL);
    g_ptr_array_add(c->paths, (char *)one.folder);
  }
  g_array_append_val(c->all, one);
  return OPC_OK;
}

static int read_rows(eda_run_cases *c, const char *folder, const char *path,
                     opc_error *error) {
  g_autoptr(GHashTable) seen =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  int at[COLUMNS], code = OPC_OK;
  c->table = eda_table_read(path, error);
  if (!c->table) return error->code;
  for (int i = 0; i < COLUMNS; i++) {
    at[i] = eda_table_find(c->table, names[i]);
    if (at[i] < 0)
      return opc_fail(error, OPC_INVALID, NULL,
                      "%s:1:1: column '%s' is missing", path, names[i]);
  }
  for (size_t row = 0; row < eda_table_rows(c->table) && !code; row++)
    code = read_row(c, folder, at, row, seen, error);
  return code;
}

eda_run_cases *eda_run_cases_open(const char *folder, opc_error *error) {
  g_autofree char *path = table_path(folder);
  eda_run_cases *c = g_new0(eda_run_cases, 1);
  c->all = g_array_new(FALSE, FALSE, sizeof(eda_run_case));
  c->paths = g_ptr_array_new_with_free_func(g_free);
  if (!read_rows(c, folder, path, error)) return c;
  eda_run_cases_free(c);
  return NULL;
}

void eda_run_cases_free(eda_run_cases *c) {
  if (!c) return;
  eda_table_free(c->table);
  g_array_free(c->all, TRUE);
  g_ptr_array_free(c->paths, TRUE);
  g_free(c);
}

const eda_run_case *eda_run_cases_all(const eda_run_cases *c, size_t *n) {
  *n = c->all->len;
  return (const eda_run_case *)(void *)c->all->data;
}
