/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of tables as CSV and as text. */
#include "core/report/table.h"

#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

#include "core/report/json.h"

static const char *const names[] = {"plain", "comma, \"quote\"", "new\r\nline",
                                    ""};
static const double sizes[] = {65.004, -0.001, NAN, INFINITY};
static const int64_t counts[] = {1, -20, 300, -9007199254740993};
static const double exact[] = {0.1, 1e-300, 1.0 / 3, -7};

static opc_table *sample_table(void) {
  const opc_column columns[] = {{"name", NULL, OPC_TEXT, 0, names},
                                {"size", "nm", OPC_REAL, 2, sizes},
                                {"count", "", OPC_INT, 0, counts},
                                {"exact", "%", OPC_REAL, -1, exact}};
  opc_error error;
  opc_table *table =
      opc_table_new("sample", 0, 4, columns, 4, sizeof(opc_column), &error);
  g_assert_nonnull(table);
  return table;
}

/* Return the fields of all records, each record followed by NULL. This reader
   of RFC 4180 does not depend on the writer. */
static GPtrArray *read_csv(const char *text) {
  GPtrArray *fields = g_ptr_array_new_with_free_func(g_free);
  while (*text) {
    GString *field = g_string_new(NULL);
    gboolean quoted = *text == '"';
    text += quoted;
    while (*text) {
      if (quoted && text[0] == '"' && text[1] == '"')
        text++;
      else if (quoted && *text == '"')
        break;
      else if (!quoted && strchr(",\r", *text))
        break;
      g_string_append_c(field, *text++);
    }
    text += quoted;
    g_ptr_array_add(fields, g_string_free(field, FALSE));
    if (*text == ',') {
      text++;
      continue;
    }
    g_assert_true(g_str_has_prefix(text, "\r\n"));
    text += 2;
    g_ptr_array_add(fields, NULL);
  }
  return fields;
}

static void test_csv(void) {
  opc_table *table = sample_table();
  g_autofree char *csv = opc_table_csv(table);
  g_autoptr(GPtrArray) fields = read_csv(csv);
  static const char *const expected[] = {"name",
                                         "size (nm)",
                                         "count",
                                         "exact (%)",
                                         NULL,
                                         "plain",
                                         "65.00",
                                         "1",
                                         "0.1",
                                         NULL,
                                         "comma, \"quote\"",
                                         "0.00",
                                         "-20",
                                         "1e-300",
                                         NULL,
                                         "new\r\nline",
                                         "",
                                         "300",
                                         "0.3333333333333333",
                                         NULL,
                                         "",
                                         "inf",
                                         "-9007199254740993",
                                         "-7",
                                         NULL};
  g_assert_cmpuint(fields->len, ==, G_N_ELEMENTS(expected));
  for (guint i = 0; i < fields->len; i++)
    g_assert_cmpstr(fields->pdata[i], ==, expected[i]);
  opc_table_free(table);
}

static void test_text(void) {
  opc_table *table = sample_table();
  g_autofree char *text = opc_table_text(table, 0);
  g_assert_cmpstr(
      text, ==,
      "name            size (nm)              count           exact (%)\n"
      "plain               65.00                  1                 0.1\n"
      "comma, \"quote\"       0.00                -20              1e-300\n"
      "new  line                                300  0.3333333333333333\n"
      "                      inf  -9007199254740993                  -7\n");
  opc_table_free(table);
}

/* Numbers have six digits, whole numbers all digits, and columns with
   `decimals` that number of decimals. */
static void test_digits(void) {
  static const double some[] = {1.0 / 3, 123456789, 1.23456789e-12, INFINITY};
  const opc_column columns[] = {{"a", NULL, OPC_REAL, -1, some},
                                {"b", NULL, OPC_REAL, 3, some}};
  opc_error error;
  opc_table *table =
      opc_table_new("t", 0, 4, columns, 2, sizeof(opc_column), &error);
  g_autofree char *text = opc_table_text(table, 80);
  g_assert_cmpstr(text, ==,
                  "          a              b\n"
                  "   0.333333          0.333\n"
                  "  123456789  123456789.000\n"
                  "1.23457e-12          0.000\n"
                  "        inf            inf\n");
  opc_table_free(table);
}

/* In a table that is too wide, constant columns are printed once and the other
   columns in blocks; no cell is lost. */
static void test_narrow(void) {
  static const char *const who[] = {"nand2", "nor2"}, *const none[] = {"", ""},
                           *const kind[] = {"n", "n"};
  static const int64_t a[] = {1, 2}, b[] = {30000, 4}, c[] = {5, 6};
  const opc_column columns[] = {
      {"kind", NULL, OPC_TEXT, 0, kind}, {"name", NULL, OPC_TEXT, 0, who},
      {"first", "nm", OPC_INT, 0, a},    {"print", NULL, OPC_TEXT, 0, none},
      {"second", NULL, OPC_INT, 0, b},   {"third", "%", OPC_INT, 0, c}};
  static const struct {
    size_t width;
    const char *text;
  } cases[] = {
      {49,
       "kind  name   first (nm)  print  second  third (%)\n"
       "n     nand2           1          30000          5\n"
       "n     nor2            2              4          6\n"},
      {36,
       "name   first (nm)  second  third (%)\n"
       "nand2           1   30000          5\n"
       "nor2            2       4          6\n"
       "in all rows: kind n, print (nothing)\n"},
      {26,
       "name        nand2  nor2\n"
       "first (nm)      1     2\n"
       "second      30000     4\n"
       "third (%)       5     6\n"
       "in all rows: kind n,\n"
       "  print (nothing)\n"},
      {22,
       "name   first (nm)\n"
       "nand2           1\n"
       "nor2            2\n"
       "\n"
       "name   second\n"
       "nand2   30000\n"
       "nor2        4\n"
       "\n"
       "name   third (%)\n"
       "nand2          5\n"
       "nor2           6\n"
       "in all rows: kind n,\n"
       "  print (nothing)\n"},
      {1,
       "name   first (nm)\n"
       "nand2           1\n"
       "nor2            2\n"
       "\n"
       "name   second\n"
       "nand2   30000\n"
       "nor2        4\n"
       "\n"
       "name   third (%)\n"
       "nand2          5\n"
       "nor2           6\n"
       "in all rows: kind n,\n"
       "  print (nothing)\n"},
  };
  opc_error error;
  opc_table *table =
      opc_table_new("t", 0, 2, columns, 6, sizeof(opc_column), &error);
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *text = opc_table_text(table, cases[i].width);
    g_assert_cmpstr(text, ==, cases[i].text);
  }
  opc_table_free(table);
}

/* Blocks repeat as many of the first columns as are needed to distinguish the
   rows. */
static void test_keys(void) {
  static const char *const run[] = {"x", "x", "y", "y"},
                           *const metric[] = {"ion", "off", "ion", "off"},
                           *const note[] = {"what is to be seen", "", "", "z"};
  static const int64_t a[] = {1, 2, 3, 4};
  const opc_column columns[] = {{"run", NULL, OPC_TEXT, 0, run},
                                {"metric", NULL, OPC_TEXT, 0, metric},
                                {"note", NULL, OPC_TEXT, 0, note},
                                {"a", NULL, OPC_INT, 0, a}};
  opc_error error;
  opc_table *table =
      opc_table_new("t", 0, 4, columns, 4, sizeof(opc_column), &error);
  g_autofree char *text = opc_table_text(table, 30);
  g_assert_cmpstr(text, ==,
                  "run  metric  note\n"
                  "x    ion     what is to be seen\n"
                  "x    off     \n"
                  "y    ion     \n"
                  "y    off     z\n"
                  "\n"
                  "run  metric  a\n"
                  "x    ion     1\n"
                  "x    off     2\n"
                  "y    ion     3\n"
                  "y    off     4\n");
  opc_table_free(table);
}

static void test_markdown(void) {
  opc_table *table = sample_table();
  g_autofree char *text = opc_table_markdown(table);
  g_assert_true(g_str_has_prefix(
      text,
      "| name | size (nm) | count | exact (%) |\n|---|--:|--:|--:|\n"
      "| plain | 65.00 | 1 | 0.1 |\n"));
  opc_table_free(table);
  static const char *const bad[] = {"a|b\nc"};
  const opc_column column = {"x", NULL, OPC_TEXT, 0, bad};
  opc_error error;
  table = opc_table_new("t", 0, 1, &column, 1, sizeof(opc_column), &error);
  g_autofree char *escaped = opc_table_markdown(table);
  g_assert_cmpstr(escaped, ==, "| x |\n|---|\n| a\\|b c |\n");
  opc_table_free(table);
}

static void test_json(void) {
  opc_table *table = sample_table();
  g_autofree char *text = opc_json_text(opc_table_json(table));
  g_autoptr(JsonNode) node = json_from_string(text, NULL);
  JsonObject *object = json_node_get_object(node);
  JsonArray *columns = json_object_get_array_member(object, "columns");
  static const char *const heads[][2] = {
      {"name", NULL}, {"size", "nm"}, {"count", ""}, {"exact", "%"}};
  for (guint i = 0; i < 4; i++) {
    JsonObject *head = json_array_get_object_element(columns, i);
    g_assert_cmpstr(json_object_get_string_member(head, "name"), ==,
                    heads[i][0]);
    g_assert_cmpstr(json_object_get_string_member(head, "unit"), ==,
                    heads[i][1]);
  }
  JsonArray *rows = json_object_get_array_member(object, "rows");
  g_assert_cmpuint(json_array_get_length(rows), ==, 4);
  for (guint i = 0; i < 4; i++) {
    JsonArray *row = json_array_get_array_element(rows, i);
    g_assert_cmpstr(json_array_get_string_element(row, 0), ==, names[i]);
    g_assert_true(json_array_get_null_element(row, 1) == !isfinite(sizes[i]));
    g_assert_cmpint(json_array_get_int_element(row, 2), ==, counts[i]);
    g_assert_true(json_array_get_double_element(row, 3) == exact[i]);
  }
  opc_table_free(table);
}

static void test_unsound(void) {
  opc_error error;
  const opc_column nameless = {NULL, NULL, OPC_REAL, 0, sizes};
  const opc_column empty = {"x", NULL, OPC_REAL, 0, NULL};
  const opc_column odd = {"x", NULL, OPC_BOOL, 0, sizes};
  g_assert_null(
      opc_table_new("t", 0, 1, &nameless, 1, sizeof(opc_column), &error));
  g_assert_null(
      opc_table_new("t", 0, 1, &empty, 1, sizeof(opc_column), &error));
  g_assert_null(opc_table_new("t", 0, 1, &odd, 1, sizeof(opc_column), &error));
  g_assert_cmpstr(error.message, ==, "table 't': column 1 is not valid");
  opc_table *none =
      opc_table_new("t", 0, 0, &empty, 1, sizeof(opc_column), &error);
  g_autofree char *csv = opc_table_csv(none);
  g_assert_cmpstr(csv, ==, "x\r\n");
  opc_table_free(none);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/table/csv", test_csv);
  g_test_add_func("/table/text", test_text);
  g_test_add_func("/table/digits", test_digits);
  g_test_add_func("/table/narrow", test_narrow);
  g_test_add_func("/table/keys", test_keys);
  g_test_add_func("/table/markdown", test_markdown);
  g_test_add_func("/table/json", test_json);
  g_test_add_func("/table/unsound", test_unsound);
  return g_test_run();
}
