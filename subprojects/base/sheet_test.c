/* SPDX-License-Identifier: BSD-3-Clause */
#include <base/sheet.h>
#include <string.h>

static opc_sheet *sample_sheet(void) {
  static const char *const cells[] = {"name", "size",   "a,\"b\"",
                                      "7",    "c|d\ne", "12"};
  opc_sheet *s = opc_sheet_new(2);
  s->left[0] = TRUE;
  for (size_t i = 0; i < G_N_ELEMENTS(cells); i++)
    g_ptr_array_add(s->cells, g_strdup(cells[i]));
  return s;
}

static void test_csv(void) {
  g_autoptr(opc_sheet) s = sample_sheet();
  g_autofree char *csv = opc_sheet_csv(s);
  g_assert_cmpstr(csv, ==,
                  "name,size\r\n\"a,\"\"b\"\"\",7\r\n\"c|d\ne\",12\r\n");
  g_autoptr(opc_sheet) none = opc_sheet_new(0);
  g_autofree char *nothing = opc_sheet_csv(none);
  g_assert_cmpstr(nothing, ==, "");
}

/* Cells that a spreadsheet would execute are marked, and read back unchanged;
   quantities are not marked. */
static void test_marks(void) {
  static const char *const cells[][2] = {
      {"=1+1", "'=1+1"},
      {"+cmd|' /C'!A0", "'+cmd|' /C'!A0"},
      {"-2+3", "'-2+3"},
      {"@SUM(A1)", "'@SUM(A1)"},
      {"'a", "''a"},
      {"a\tb\\\x1b[0m", "'a\\x09b\\\\\\x1b[0m"},
      {"-3.5e-7", "-3.5e-7"},
      {"-3 %", "-3 %"},
      {"+20 nm", "+20 nm"},
      {"-inf", "-inf"},
      {"-", "-"},
      {"a=b\\x41", "a=b\\x41"},
      {"=\\x41,", "\"'=\\\\x41,\""}};
  for (size_t i = 0; i < G_N_ELEMENTS(cells); i++) {
    g_autoptr(opc_sheet) s = opc_sheet_new(1);
    g_ptr_array_add(s->cells, g_strdup(cells[i][0]));
    g_autofree char *csv = opc_sheet_csv(s);
    g_autofree char *expected = g_strconcat(cells[i][1], "\r\n", NULL);
    g_assert_cmpstr(csv, ==, expected);
    gboolean quoted = *csv == '"';
    g_autofree char *cell =
        g_strndup(csv + quoted, strlen(csv) - 2 - 2 * (gsize)quoted);
    opc_cell_unmark(cell);
    g_assert_cmpstr(cell, ==, cells[i][0]);
  }
}

static void test_text(void) {
  g_autoptr(opc_sheet) s = sample_sheet();
  g_autofree char *text = opc_sheet_text(s, 0);
  g_assert_cmpstr(text, ==,
                  "name   size\n"
                  "a,\"b\"     7\n"
                  "c|d e    12\n");
  g_autofree char *markdown = opc_sheet_markdown(s);
  g_assert_cmpstr(markdown, ==,
                  "| name | size |\n|---|--:|\n"
                  "| a,\"b\" | 7 |\n| c\\|d e | 12 |\n");
}

/* Check the text of a table with the columns name, unit or first, and a
   number. The cells are separated by blanks. */
static void expect_wide(const char *cells, size_t width, const char *expected) {
  g_auto(GStrv) words = g_strsplit(cells, " ", -1);
  g_autoptr(opc_sheet) s = opc_sheet_new(3);
  s->left[0] = TRUE;
  s->left[1] = g_str_equal(words[1], "unit");
  for (char **w = words; *w; w++) g_ptr_array_add(s->cells, g_strdup(*w));
  g_autofree char *text = opc_sheet_text(s, width);
  g_assert_cmpstr(text, ==, expected);
}

/* A table that is too wide is printed without constant columns, transposed, or
   in blocks that repeat the columns that identify a row. */
static void test_wide(void) {
  static const char units[] = "name unit ion a nm 1 bb nm 22";
  expect_wide(units, 15, "name  unit  ion\na     nm      1\nbb    nm     22\n");
  expect_wide(units, 14,
              "name  ion\na       1\nbb     22\nin all rows: unit nm\n");
  static const char one[] = "name first second a 1 4";
  expect_wide(one, 18, "name    a\nfirst   1\nsecond  4\n");
  static const char blocks[] = "name first second a 1 4 b 2 5 c 3 6";
  expect_wide(blocks, 18,
              "name  first\na         1\nb         2\nc         3\n\n"
              "name  second\na          4\nb          5\nc          6\n");
  /* The names are equal in two rows, so that the units identify rows, too. */
  static const char keys[] = "name unit drain-current a nm 1 a um 2 b nm 3";
  expect_wide(keys, 24,
              "name  unit  drain-current\na     nm                1\n"
              "a     um                2\nb     nm                3\n");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/sheet/csv", test_csv);
  g_test_add_func("/sheet/marks", test_marks);
  g_test_add_func("/sheet/text", test_text);
  g_test_add_func("/sheet/wide", test_wide);
  return g_test_run();
}
