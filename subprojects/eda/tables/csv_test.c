/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables with columns in any order, and each fault with its line and column. */
#include <eda/csv.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

enum { TYPE, WIDTH, NOTE, COLUMNS };
static const eda_csv_column columns[COLUMNS] = {
    [TYPE] = {.name = "type"},
    [WIDTH] = {.name = "w", .unit = "nm"},
    [NOTE] = {.name = "note", .optional = 1},
};

static eda_csv *read_bytes(const char *text, gssize size, uint32_t flags,
                           opc_error *error) {
  g_autoptr(GError) trouble = NULL;
  char *path = NULL;
  int file = g_file_open_tmp("csv-XXXXXX", &path, &trouble);
  g_assert_no_error(trouble);
  g_assert_true(g_close(file, NULL));
  g_assert_true(g_file_set_contents(path, text, size, NULL));
  eda_csv *csv = eda_csv_read(path, "table", columns, COLUMNS, flags, error);
  g_unlink(path);
  g_free(path);
  return csv;
}

static eda_csv *read_text(const char *text, uint32_t flags) {
  opc_error error = {0};
  eda_csv *csv = read_bytes(text, -1, flags, &error);
  g_test_message("%s", error.message);
  g_assert_nonnull(csv);
  return csv;
}

static void test_good(void) {
  opc_error error;
  eda_csv *csv = read_text(
      "# a comment\r\n\n  # another\n w (nm) ,type\r\n 3.5 , n,\n4e2,pmos", 0);
  g_assert_cmpuint(eda_csv_rows(csv), ==, 2);
  g_assert_true(eda_csv_has(csv, WIDTH));
  g_assert_false(eda_csv_has(csv, NOTE));
  g_assert_cmpstr(eda_csv_text(csv, 1, NOTE), ==, "");
  g_assert_cmpstr(eda_csv_text(csv, 0, WIDTH), ==, "3.5");
  double width;
  int type;
  g_assert_false(eda_csv_number(csv, 1, WIDTH, 0, &width, &error));
  g_assert_cmpfloat(width, ==, 400);
  g_assert_false(eda_csv_type(csv, 0, TYPE, &type, &error));
  g_assert_cmpint(type, ==, EDA_NMOS);
  g_assert_false(eda_csv_type(csv, 1, TYPE, &type, &error));
  g_assert_cmpint(type, ==, EDA_PMOS);
  eda_csv_free(csv);
}

static void test_others(void) {
  eda_csv *csv = read_text("x,type,y (V),w,note\n,n,2,3,\n,p", EDA_CSV_OTHERS);
  g_assert_cmpstr(eda_csv_text(csv, 0, WIDTH), ==, "3");
  g_assert_cmpstr(eda_csv_text(csv, 1, TYPE), ==, "p");
  g_assert_cmpstr(eda_csv_text(csv, 1, WIDTH), ==, "");
  eda_csv_free(csv);
  static const char *const empty[] = {"", "\n# nothing", "type,w"};
  for (size_t i = 0; i < G_N_ELEMENTS(empty); i++) {
    csv = read_text(empty[i], EDA_CSV_EMPTY);
    g_assert_cmpuint(eda_csv_rows(csv), ==, 0);
    eda_csv_free(csv);
  }
}

static void test_bad_files(void) {
  static const struct {
    const char *text, *why;
  } cases[] = {
      {"", "' has no rows"},
      {"# only this\n", "' has no rows"},
      {"type,w\n", "' has no rows"},
      {"\ntype,q\n", ":2:6: unknown column 'q'"},
      {"type,w (um)\n", ":1:6: wrong unit: 'w (um)'"},
      {"type (nm),w\n", ":1:1: wrong unit: 'type (nm)'"},
      {"type,w, w\n", ":1:9: duplicate column: 'w'"},
      {"w\n1", ":1:1: missing column 'type'"},
      {"type,w\n"
       "n,1\n"
       "n,2,\nn,1, 3\n",
       ":4:6: unexpected field: '3'"},
  };
  opc_error error;
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_assert_null(read_bytes(cases[i].text, -1, 0, &error));
    g_test_message("%s", error.message);
    g_assert_nonnull(strstr(error.message, cases[i].why));
    g_assert_cmpint(error.code, ==, OPC_INVALID);
    g_assert_cmpstr(error.parameter, ==, "table");
  }
  g_assert_null(read_bytes("type,w\n\0", 8, 0, &error));
  g_assert_nonnull(strstr(error.message, "is not a text file: byte 7 is 0"));
  g_assert_null(
      eda_csv_read("/nowhere/at/all", "table", columns, COLUMNS, 0, &error));
  g_assert_cmpint(error.code, ==, OPC_IO);
}

static void test_bad_fields(void) {
  static const struct {
    const char *row, *why;
  } cases[] = {
      {"x,1", ":2:1: neither 'n' nor 'p': 'x'"},
      {"n, z", ":2:4: not a number: 'z'"},
      {"n,1e999", ":2:3: not a number: '1e999'"},
      {"n,nan", ":2:3: not a number: 'nan'"},
      {"n,2 3", ":2:3: not a number: '2 3'"},
      {"n,", ":2:3: not a number: ''"},
      {"n", ":2:2: not a number: ''"},
      {"n,2", ":2:3: not above 2: '2'"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *text = g_strconcat("type,w\n", cases[i].row, NULL);
    eda_csv *csv = read_text(text, 0);
    opc_error error;
    double width;
    int type;
    g_assert_true(eda_csv_type(csv, 0, TYPE, &type, &error) ||
                  eda_csv_number(csv, 0, WIDTH, 2, &width, &error));
    g_test_message("%s", error.message);
    g_assert_nonnull(strstr(error.message, cases[i].why));
    g_assert_true(eda_csv_fail(csv, 0, NOTE, "no note", &error));
    g_assert_nonnull(strstr(error.message, ":2:1: no note ''"));
    eda_csv_free(csv);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/csv/good", test_good);
  g_test_add_func("/csv/others", test_others);
  g_test_add_func("/csv/bad-files", test_bad_files);
  g_test_add_func("/csv/bad-fields", test_bad_fields);
  return g_test_run();
}
