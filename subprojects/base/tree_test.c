/* SPDX-License-Identifier: BSD-3-Clause */
/* Layers, lists, ranges and labels of trees, without a flow. */
#include <base/layers.h>
#include <base/list.h>
#include <base/match.h>
#include <base/range.h>
#include <glib/gstdio.h>
#include <string.h>

static const opc_source source = {.name = (char *)"test"};

static opc_node *tree_parse(const char *text) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_node *node = opc_node_parse(&source, text, strlen(text), problems);
  g_assert_cmpuint(problems->list->len, ==, 0);
  return node;
}

static void test_layers(void) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) under =
      tree_parse("{ a: { x: 1, y: 2 }, b: [1, 2], c: 3 }");
  g_autoptr(opc_node) over = tree_parse("{ a.x: 5, b: [3], c: ~, d: 4 }");
  opc_lay(under, over, problems);
  g_autofree char *line = opc_node_line(under);
  g_assert_cmpstr(line, ==, "{ a: { x: 5, y: 2 }, b: [3], d: 4 }");
  g_assert_cmpuint(problems->list->len, ==, 0);
  opc_lay(under, over, problems);
  g_assert_cmpuint(problems->list->len, ==, 1);
}

static char *values_of(const char *text, opc_problems *problems) {
  g_autoptr(opc_node) range = tree_parse(text);
  g_autoptr(GPtrArray) values = opc_range_values(range, &source, problems);
  GString *all = g_string_new(NULL);
  for (guint i = 0; i < values->len; i++)
    g_string_append_printf(all, "%s;",
                           ((const opc_node *)values->pdata[i])->text);
  return g_string_free(all, FALSE);
}

static void test_ranges(void) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autofree char *plain =
      values_of("{ from: 0.1, to: 0.3, step: 0.1 }", problems);
  g_assert_cmpstr(plain, ==, "0.1;0.2;0.3;");
  g_autofree char *down =
      values_of("{ from: 1 um, to: 900 nm, step: -50 nm }", problems);
  g_assert_cmpstr(down, ==, "1 um;0.95 um;0.9 um;");
  g_assert_cmpuint(problems->list->len, ==, 0);
  g_autofree char *never = values_of("{ from: 1, to: 2, step: 0.3 }", problems);
  g_autofree char *mixed =
      values_of("{ from: 1 nm, to: 2 V, step: 1 nm }", problems);
  g_assert_cmpstr(never, ==, "");
  g_assert_cmpstr(mixed, ==, "");
  g_assert_cmpuint(problems->list->len, ==, 2);
}

static void test_numbers(void) {
  static const struct {
    const char *list, *unit;
    gboolean numeric;
  } cases[] = {{"[1, 2]", NULL, TRUE},
               {"[1 nm, 2 nm]", "nm", TRUE},
               {"[1 nm, 2]", NULL, FALSE},
               {"[1 x, 2 x]", NULL, FALSE},
               {"[a]", NULL, FALSE}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_node) list = tree_parse(cases[i].list);
    const char *unit;
    g_autofree double *values = opc_range_numbers(list->items, &unit);
    g_assert_cmpint(values != NULL, ==, cases[i].numeric);
    g_assert_cmpstr(unit, ==, cases[i].unit);
    if (values) g_assert_cmpfloat(values[1], ==, 2);
  }
}

static void test_list(void) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  const opc_place at = {"test", 1, 1};
  g_assert_true(g_file_set_contents(
      "list.csv", "a,b\r\n1,\"x, \"\"y\"\"\"\n,2\n", -1, NULL));
  g_autoptr(opc_node) list = opc_list_read(&source, "list.csv", &at, problems);
  g_autofree char *line = opc_node_line(list);
  g_assert_cmpstr(line, ==, "[{ a: 1, b: \"x, \\\"y\\\"\" }, { b: 2 }]");
  g_assert_true(g_file_set_contents("list.csv", "a,b\n1\n", -1, NULL));
  g_assert_null(opc_list_read(&source, "list.csv", &at, problems));
  g_assert_cmpuint(problems->list->len, ==, 1);
  g_unlink("list.csv");
}

static void test_labels(void) {
  static const char *const cases[][2] = {{"lists/one.txt", "one"},
                                         {"{ use: kind.name }", "name"},
                                         {"{ use: a.b, word: c, n: 1.5 }", "b"},
                                         {"{ use: a.b, f: ../x.y, n: 1.5, "
                                          "top: C, of: '${d.e}' }",
                                          "x-C"},
                                         {"65 nm", "65nm"},
                                         {"[1]", ""},
                                         {"~", ""}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_node) value = tree_parse(cases[i][0]);
    g_autofree char *label = opc_label(value);
    g_assert_cmpstr(label, ==, cases[i][1]);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_autofree char *folder = g_dir_make_tmp(NULL, NULL);
  g_assert_false(g_chdir(folder));
  g_test_add_func("/tree/layers", test_layers);
  g_test_add_func("/tree/ranges", test_ranges);
  g_test_add_func("/tree/numbers", test_numbers);
  g_test_add_func("/tree/list", test_list);
  g_test_add_func("/tree/labels", test_labels);
  int code = g_test_run();
  g_rmdir(folder);
  return code;
}
