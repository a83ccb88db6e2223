/* SPDX-License-Identifier: BSD-3-Clause */
/* Listing, checking and pruning of a library of two cells made by
   library.build. */
#include <glib/gstdio.h>
#include <math.h>
#include <opcflow/command.h>
#include <sqlite3.h>

#include "tests/library.h"

static int library(const char *more, opc_error *error, const char *first, ...) {
  g_autofree char *path = library_database();
  g_autofree char *map = g_strdup_printf("{ database: '%s'%s }", path, more);
  const char *words[8] = {first};
  size_t n = first != NULL;
  va_list list;
  va_start(list, first);
  while (n && n < G_N_ELEMENTS(words) &&
         (words[n] = va_arg(list, const char *)))
    n++;
  va_end(list);
  *error = (opc_error){0};
  opc_test_forget();
  g_autoptr(opc_module) m = opc_test_module("command.library", map, error);
  if (!m) return error->code;
  const opc_command *command = m->functions;
  return command->run(m->self, n, words, error);
}

/* Figures of the cells, from the metrics of library.build. */
static double built[2];

static void build(const char *more) {
  opc_error error;
  ran r;
  eda_layout *circuit = library_circuit();
  ran sheet = sheet_of(circuit, "{}");
  ran gates = segment(sheet.out);
  if (build_library(&r, sheet.out, gates.out, more, &error))
    g_error("%s", error.message);
  for (size_t i = 0; i < 2; i++)
    built[i] = opc_test_number("cells", "ion_max", i);
  ran_clear(&r);
  ran_clear(&gates);
  ran_clear(&sheet);
  eda_layout_free(circuit);
}

static void make_anew(void) {
  g_autofree char *path = library_database();
  (void)g_remove(path);
  build("");
}

static size_t listed(const char *more, const char *pattern) {
  opc_error error;
  if (library(more, &error, "list", pattern, NULL))
    g_error("%s", error.message);
  return opc_test_rows("cells");
}

static void test_list(void) {
  static const char *const names[] = {"long", "wide"};
  make_anew();
  g_assert_cmpuint(listed("", NULL), ==, 2);
  for (size_t i = 0; i < 2; i++) {
    g_assert_cmpstr(opc_test_text("cells", "cell", i), ==, names[i]);
    g_assert_cmpstr(opc_test_text("cells", "method", i), ==,
                    "synthesizer.newton");
    g_assert_cmpstr(opc_test_text("cells", "state", i), ==, "sound");
    g_assert_cmpfloat(opc_test_number("cells", "transistors", i), ==, 1);
    g_assert_true(opc_test_number("cells", "ion_max", i) == built[i]);
  }
  g_assert_cmpuint(listed("", "w*"), ==, 1);
  g_assert_cmpstr(opc_test_text("cells", "cell", 0), ==, "wide");
  g_assert_cmpuint(listed("", "none"), ==, 0);
  g_assert_cmpuint(listed(", settings: not-a-sum", NULL), ==, 0);
}

/* Execute a statement on the database; return the first text of the result, or
   NULL. */
static char *ask(const char *statement) {
  g_autofree char *path = library_database();
  char *out = NULL;
  sqlite3 *db;
  sqlite3_stmt *s;
  g_assert_cmpint(sqlite3_open(path, &db), ==, SQLITE_OK);
  g_assert_cmpint(sqlite3_prepare_v2(db, statement, -1, &s, NULL), ==,
                  SQLITE_OK);
  int step = sqlite3_step(s);
  if (step == SQLITE_ROW)
    out = g_strdup((const char *)sqlite3_column_text(s, 0));
  else
    g_assert_cmpint(step, ==, SQLITE_DONE);
  g_assert_cmpint(sqlite3_finalize(s), ==, SQLITE_OK);
  g_assert_cmpint(sqlite3_close(db), ==, SQLITE_OK);
  return out;
}

/* A table for each cell, named by cell and key. */
static void test_show(void) {
  opc_error error;
  make_anew();
  g_autofree char *key = ask("SELECT key FROM cell WHERE cell = 'wide'");
  g_autofree char *table = g_strdup_printf("wide_%.10s", key);
  g_assert_cmpint(library("", &error, "show", "w*", NULL), ==, OPC_OK);
  g_assert_cmpuint(opc_test_rows(table), ==, 1);
  g_assert_cmpstr(opc_test_text(table, "type", 0), ==, "n");
  g_assert_cmpfloat(opc_test_number(table, "l", 0), ==, 65);
  g_assert_cmpfloat(opc_test_number(table, "w", 0), ==, 450);
  g_assert_cmpfloat(fabs(opc_test_number(table, "ion", 0)), ==, built[1]);
  g_assert_cmpint(library("", &error, "show", NULL), ==, OPC_INVALID);
  g_assert_cmpstr(error.message, ==, "name the cells to show");
}

/* All rows of a cell but the latest are superseded. */
static void test_superseded(void) {
  opc_error error;
  make_anew();
  build(", max_iterations: 1");
  g_assert_cmpuint(listed("", NULL), ==, 4);
  g_assert_cmpint(library("", &error, "prune", NULL), ==, OPC_OK);
  g_assert_cmpuint(listed("", NULL), ==, 4);
  g_assert_cmpint(library(", superseded: true", &error, "prune", "long", NULL),
                  ==, OPC_OK);
  g_assert_nonnull(strstr(opc_test_log(), "1 cells removed"));
  g_assert_cmpuint(listed("", "long"), ==, 1);
  g_assert_cmpuint(listed("", "wide"), ==, 2);
  g_assert_cmpint(library(", superseded: true", &error, "prune", NULL), ==,
                  OPC_OK);
  g_assert_cmpuint(listed("", "long"), ==, 1);
  g_assert_cmpuint(listed("", "wide"), ==, 1);
  g_assert_cmpint(library("", &error, "prune", "wide", NULL), ==, OPC_OK);
  g_assert_cmpuint(listed("", NULL), ==, 1);
}

/* A cell with truncated data is reported and pruned. */
static void test_damaged(void) {
  opc_error error;
  make_anew();
  g_assert_cmpint(library("", &error, "check", NULL), ==, OPC_OK);
  g_assert_nonnull(strstr(opc_test_log(), "2 cells are valid"));
  g_free(
      ask("UPDATE cell SET data = substr(data, 1, 100) WHERE cell = "
          "'long'"));
  g_assert_cmpint(library("", &error, "check", NULL), ==, OPC_IO);
  g_assert_nonnull(strstr(error.message, "1 of 2 cells are damaged"));
  g_assert_cmpuint(listed("", "long"), ==, 1);
  g_assert_cmpstr(opc_test_text("cells", "state", 0), ==, "damaged");
  g_assert_cmpint(library("", &error, "prune", NULL), ==, OPC_OK);
  g_assert_cmpuint(listed("", NULL), ==, 1);
  g_assert_cmpint(library("", &error, "check", NULL), ==, OPC_OK);
}

static void test_refused(void) {
  g_autofree char *path = library_database();
  opc_error error;
  g_assert_cmpint(library("", &error, NULL), ==, OPC_INVALID);
  g_assert_cmpint(library("", &error, "lst", NULL), ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "list, show, check or prune"));
  (void)g_remove(path);
  g_assert_cmpint(library("", &error, "list", NULL), ==, OPC_IO);
  g_assert_false(g_file_test(path, G_FILE_TEST_EXISTS));
  g_assert_true(g_file_set_contents(path, "nonsense, enough of it", -1, NULL));
  g_assert_cmpint(library("", &error, "list", NULL), ==, OPC_INVALID);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/command.library/list", test_list);
  g_test_add_func("/command.library/show", test_show);
  g_test_add_func("/command.library/superseded", test_superseded);
  g_test_add_func("/command.library/damaged", test_damaged);
  g_test_add_func("/command.library/refused", test_refused);
  return g_test_run();
}
