/* SPDX-License-Identifier: BSD-3-Clause */
/* Faults of YAML; layers, lists, ranges and labels of trees, without a flow. */
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

/* Check the problems of a text of `length` bytes; -1: up to the zero. */
static void expect_faults(const char *text, gssize length,
                          const char *expected) {
  static const opc_source file = {.name = (char *)"a.yaml",
                                  .folder = (char *)""};
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) tree = opc_node_parse(
      &file, text, length < 0 ? strlen(text) : (size_t)length, problems);
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpstr(found, ==, expected);
  g_assert_true(!tree == !!*expected);
}

static void test_not_yaml(void) {
  static const char *const cases[][2] = {
      {"", "a.yaml:1:1: the file is empty"},
      {"# only this\n", "a.yaml:1:1: the file is empty"},
      {"a: [1\n",
       "a.yaml:1:4: not YAML: '[' is not closed: no ',' or ']' before line 2, "
       "column 1"},
      {"c: 1\nb:\n  a: { use: x\n  b: {}\n",
       "a.yaml:3:6: not YAML: '{' is not closed: no ',' or '}' before line 4, "
       "column 4"},
      {"c: 1\na:\n    use:x.y\n    size: 1 nm\n",
       "a.yaml:3:8: not YAML: no space after the colon of 'use:'"},
      {"c: 1\na:\n    use: a\n    x: y: z\n",
       "a.yaml:4:9: not YAML: mapping values are not allowed in this context"},
      {"c: 1\n\tb: {}\n",
       "a.yaml:2:1: not YAML: found a tab character that violates indentation "
       "while scanning a plain scalar"},
      {"c: 1\nb:\n\ta: {}\n",
       "a.yaml:3:1: not YAML: found a tab or a character that cannot begin a "
       "value while scanning for the next token"},
      {"caf\xE9: 1\n", "a.yaml:1:4: not YAML: not UTF-8 text"},
      {"a: 1\nb: \x01\n", "a.yaml:2:4: not YAML: the character U+0001"},
      {"\xEF\xBB\xBFx: \xEE\x80\x80",
       "a.yaml:1:4: not YAML: the character U+E000"},
      {"a: 1\n---\na: 1\n", "a.yaml:2:1: a second document"},
      {"[a]: b\n", "a.yaml:1:1: a key cannot be a list"},
      {"a: \"\\0\"\n", "a.yaml:1:4: a text with a NUL byte"},
      {"a: !!int 3\n",
       "a.yaml:1:4: tags ('tag:yaml.org,2002:int') cannot be used here"},
      {"a: &x [1]\nb: *x\n",
       "a.yaml:1:4: anchors and aliases ('&x') cannot be used here"},
      {"a: *x\n", "a.yaml:1:4: anchors and aliases ('*x') cannot be used here"},
      {"a: 1\nb: 2\na: 3\n",
       "a.yaml:3:1: duplicate key 'a', first given in line 1"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    expect_faults(cases[i][0], -1, cases[i][1]);
  expect_faults("a: \0b\n", 6, "a.yaml:1:4: not YAML: a NUL byte");
}

/* Texts at each limit of node.h, and one beyond the limit. */
static void test_limits(void) {
  for (size_t more = 0; more < 2; more++) {
    g_autofree char *open = g_strnfill(63 + more, '[');
    g_autofree char *close = g_strnfill(63 + more, ']');
    g_autofree char *deep = g_strdup_printf("a: %s%s", open, close);
    expect_faults(deep, -1, more ? "a.yaml:1:67: nested deeper than 64" : "");
    g_autofree char *word = g_strnfill((1 << 16) + more, 'x');
    g_autofree char *large = g_strconcat("a: ", word, NULL);
    expect_faults(large, -1,
                  more ? "a.yaml:1:4: a text of more than 65536 bytes" : "");
    GString *many = g_string_new("a: [");
    for (size_t i = 3; i < 200000 + more; i++) g_string_append(many, "1,");
    g_string_append(many, "]\n");
    expect_faults(many->str, -1,
                  more ? "a.yaml:1:399999: more than 200000 values" : "");
    g_string_free(many, TRUE);
  }
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
  g_test_add_func("/tree/not-yaml", test_not_yaml);
  g_test_add_func("/tree/limits", test_limits);
  g_test_add_func("/tree/layers", test_layers);
  g_test_add_func("/tree/ranges", test_ranges);
  g_test_add_func("/tree/numbers", test_numbers);
  g_test_add_func("/tree/list", test_list);
  g_test_add_func("/tree/labels", test_labels);
  int code = g_test_run();
  g_rmdir(folder);
  return code;
}
