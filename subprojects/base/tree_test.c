/* SPDX-License-Identifier: BSD-3-Clause */
/* Faults of YAML; layers, lists, ranges and labels of trees, without a flow. */
#include <base/layers.h>
#include <base/list.h>
#include <base/match.h>
#include <base/range.h>
#include <glib/gstdio.h>
#include <math.h>
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

/* Each case: a tree, a layer, and the result or the problems. */
static void expect_layers(const char *const (*cases)[3], size_t n,
                          void (*lay)(opc_node *, const opc_node *,
                                      opc_problems *)) {
  for (size_t i = 0; i < n; i++) {
    g_autoptr(opc_problems) problems = opc_problems_new();
    g_autoptr(opc_node) under = tree_parse(cases[i][0]);
    g_autoptr(opc_node) over = tree_parse(cases[i][1]);
    lay(under, over, problems);
    g_autofree char *text = opc_problems_text(problems);
    g_autofree char *line = opc_node_line(under);
    g_assert_cmpstr(*text ? text : line, ==, cases[i][2]);
  }
}

static void test_merge(void) {
  static const char *const cases[][3] = {
      {"{ a: 1, b: 2, c: 3 }", "{ b: ~ }", "{ a: 1, c: 3 }"},
      {"{ a: 1, b: 2, c: 3 }", "{ c: ~, a: ~, d: 5 }", "{ b: 2, d: 5 }"},
      {"{ a: { x: 1, y: { z: 2 } } }", "{ a: { y: { z: 3, w: 4 } } }",
       "{ a: { x: 1, y: { z: 3, w: 4 } } }"},
      {"{ a: { x: 1 } }", "{ a: 2 }", "{ a: 2 }"},
      {"{ a: 2 }", "{ a: { x: 1 } }", "{ a: { x: 1 } }"},
      {"{ a: { use: p, x: 1 } }", "{ a: { use: p, y: 2 } }",
       "{ a: { use: p, x: 1, y: 2 } }"},
      {"{ a: { use: p, x: 1 } }", "{ a: { use: q, y: 2 } }",
       "{ a: { use: q, y: 2 } }"},
      {"{ a: { x: 1 } }", "{ a: { use: q } }", "{ a: { use: q } }"},
      {"{ a.b: 1, c: 2 }", "{ a: { d: 3 } }", "{ a: { b: 1, d: 3 }, c: 2 }"},
      {"{ a: { b: 1 } }", "{ a.b: ~ }", "{ a: {  } }"},
      {"{ a.b: 1 }", "{ a.b: 2 }", "{ a.b: 2 }"},
      {"{ a: { b: { c: 1 } } }", "{ a.b.d: 2 }",
       "{ a: { b: { c: 1, d: 2 } } }"},
      {"{}", "{ a: ~ }", "test: cannot remove 'a', which does not exist"},
      {"{ poly: 1 }", "{ ploy: ~ }",
       "test: cannot remove 'ploy', which does not exist, did you mean "
       "'poly'?"},
      {"{}", "{ a: { b: ~ } }",
       "test: cannot remove 'b', which does not exist"}};
  expect_layers(cases, G_N_ELEMENTS(cases), opc_lay);
  static const char *const steps[][3] = {
      {"{}", "{ a: { x: 1 } }", "{ a: { x: 1 } }"},
      {"{ a: { use: p } }", "{ b: { use: q } }",
       "{ a: { use: p }, b: { use: q } }"},
      {"{ a: { use: p } }", "{ b: { x: 1 } }", "test: unknown step 'b'"},
      {"{ a: { use: p } }", "{ a: { b: { x: 1 } } }",
       "{ a: { use: p, b: { x: 1 } } }"}};
  expect_layers(steps, G_N_ELEMENTS(steps), opc_lay_steps);
}

/* Each case: a tree, a path, a value, and the result or the problem. */
static void test_paths(void) {
  static const opc_place key = {"key", 3, 4};
  g_autofree char *deep = g_strnfill(129, '.'), *deeper = g_strnfill(131, '.');
  for (size_t i = 0; i < 131; i += 2) {
    if (i < 129) deep[i] = 'a';
    deeper[i] = 'a';
  }
  /* 65 and 66 words; the deepest has 64. */
  deep[127] = 0;
  deeper[129] = 0;
  const struct {
    const char *tree, *path, *value, *want;
  } cases[] = {
      {"{ a: { use: p } }", "a.x", "5", "{ a: { use: p, x: 5 } }"},
      {"{ a: { use: p } }", "a.x.y", "[1]", "{ a: { use: p, x: { y: [1] } } }"},
      {"{ a: { x: 1 } }", "a", "~", "{  }"},
      {"{ a: { x: 1 } }", "a.x", "~", "{ a: {  } }"},
      {"{ a: { x: 1 } }", "b.x", "1", "key:3:4: unknown step 'b'"},
      {"{}", "", "1", "key:3:4: '' is not a path, expected 'step.parameter'"},
      {"{}", "a..b", "1",
       "key:3:4: 'a..b' is not a path, expected 'step.parameter'"},
      {"{}", "a.", "1",
       "key:3:4: 'a.' is not a path, expected 'step.parameter'"},
      {"{}", deep, "1", NULL},
      {"{}", deeper, "1", "*' is deeper than 64"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_problems) problems = opc_problems_new();
    g_autoptr(opc_node) tree = tree_parse(cases[i].tree);
    g_autoptr(opc_node) value = tree_parse(cases[i].value);
    opc_lay_at(tree, cases[i].path, &key, value, problems);
    g_autofree char *text = opc_problems_text(problems);
    g_autofree char *line = opc_node_line(tree);
    if (!cases[i].want)
      g_assert_cmpstr(text, ==, "");
    else if (!g_pattern_match_simple(cases[i].want, *text ? text : line))
      g_error("%zu: %s %s", i, text, line);
  }
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) demands =
      tree_parse("{ require: { s: { ion: at most 1 } } }");
  g_autoptr(opc_node) map = tree_parse("{ s.ioff: at most 2, t.x.y: 3 }");
  g_autoptr(opc_node) text = tree_parse("at most 3");
  opc_lay_demands(demands, "require", &key, map, problems);
  opc_lay_demands(demands, "require.s.ion", &key, text, problems);
  g_autofree char *line = opc_node_line(demands);
  g_assert_cmpstr(line, ==,
                  "{ require: { s: { ion: at most 3, ioff: at most 2 }, t: { "
                  "x: { y: 3 } } } }");
  g_assert_cmpuint(problems->list->len, ==, 0);
}

/* Each case: an argument, its path, and its value or the problems. */
static void test_arguments(void) {
  static const char form[] = "expected the form 'step.parameter=value'";
  static const char *const cases[][3] = {
      {"a.x=5 nm", "a.x", "5 nm"},
      {"a.x=b=c", "a.x", "\"b=c\""},
      {"a.x=[1, 2]", "a.x", "[1, 2]"},
      {"a={ x: 1 }", "a", "{ x: 1 }"},
      {"a=~", "a", "\"~\""},
      {"a.x=/home/u/", "a.x", "/home/u/"},
      {"a=1", "a", form},
      {"a=[1]", "a", form},
      {"=1", "", form},
      {"a.x", "a.x", form},
      {"a.x=", "a.x", "has no value"},
      {"a.x=[1", "a.x", "not YAML: '[' is not closed: *"},
      {"a.x=/home/u", "a.x",
       "the shell turned ~ into '/home/u': quote it, or write '/home/u/' for "
       "the folder"},
      {"a=/home/u", "a", "the shell turned ~ into '/home/u': *"},
      {"a\xff.x=1", "a\xff.x", "the name is not UTF-8 text"}};
  g_setenv("HOME", "/home/u", TRUE);
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_problems) problems = opc_problems_new();
    g_autofree char *path = NULL;
    opc_source *from = NULL;
    opc_node *value =
        opc_argument_parse("--set", cases[i][0], &path, &from, problems);
    g_assert_cmpstr(path, ==, cases[i][1]);
    g_autofree char *name = g_strconcat("--set ", cases[i][1], NULL);
    g_assert_cmpstr(from->name, ==, name);
    g_autofree char *line = value ? opc_node_line(value) : NULL;
    const GPtrArray *list = problems->list;
    g_assert_cmpuint(list->len, ==, value ? 0 : 1);
    const char *is =
        value ? line : ((const opc_problem *)list->pdata[0])->message;
    if (!g_pattern_match_simple(cases[i][2], is)) g_error("%zu: %s", i, is);
    opc_node_free(value);
    opc_source_free(from);
  }
}

/* Each case: a text, the unit given for it, the unit in which it is read, and
   the number or the problem. */
static void test_quantities(void) {
  static const struct {
    const char *text, *given, *to;
    double number;
    const char *problem;
  } cases[] = {
      {"5", NULL, NULL, 5, NULL},
      {"-2.5e3", NULL, NULL, -2500, NULL},
      {"2 um", NULL, "nm", 2000, NULL},
      {"2um", NULL, "nm", 2000, NULL},
      {"3", "um", "nm", 3000, NULL},
      {"0", NULL, "nm", 0, NULL},
      {"25 C", NULL, "K", 298.15, NULL},
      {"x", NULL, NULL, 0, "'w' requires a number, found 'x'"},
      {"x", NULL, "nm", 0, "'w' requires a length with a unit, found 'x'"},
      {"5 nm", NULL, NULL, 0,
       "'w' must be a number without a unit, found '5 nm'"},
      {"5", NULL, "nm", 0, "'w' requires a length with a unit, e.g. '5 nm'"},
      {"0", NULL, "K", 0, "'w' requires a temperature with a unit, e.g. '0 K'"},
      {"5 V", NULL, "nm", 0, "'w' requires a length, found '5 V'"},
      {"5 nn", NULL, "nm", 0, "unknown unit 'nn' in '5 nn'*"},
      {"1 nm", "um", "nm", 0, "unknown unit 'nm um' in '1 nm um'*"},
      {"1e999", NULL, NULL, 0, "'w' is too large: '1e999'"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(opc_problems) problems = opc_problems_new();
    g_autoptr(opc_node) node = tree_parse(cases[i].text);
    double number = NAN;
    gboolean good = opc_quantity_read(node, cases[i].given, cases[i].to, "w",
                                      &number, problems);
    g_assert_cmpint(good, ==, !cases[i].problem);
    if (good) g_assert_cmpfloat_with_epsilon(number, cases[i].number, 1e-9);
    const GPtrArray *list = problems->list;
    if (!good &&
        !g_pattern_match_simple(cases[i].problem,
                                ((const opc_problem *)list->pdata[0])->message))
      g_error("%zu: %s", i, ((const opc_problem *)list->pdata[0])->message);
  }
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
  static const char *const bad[][2] = {
      {"{ from: 1, to: 2, step: 0.3 }",
       "'step' does not lead from '1' to '2', but to 1.9"},
      {"{ from: 1 um, to: 2 um, step: 300 nm }",
       "'step' does not lead from '1 um' to '2 um', but to 1.9 um"},
      {"{ from: 1, to: 2, step: -1 }", "'step' does not lead from '1' to '2'"},
      {"{ from: 1, to: 2, step: 0 }", "'step' does not lead from '1' to '2'"},
      {"{ from: 1, to: 100001, step: 1 }",
       "the range has 100001 values, expected at most 100000"},
      {"{ from: 1 nm, to: 2 V, step: 1 nm }",
       "'to' must be of the same dimension as 'from', found '2 V'"},
      {"{ from: 1 nm, to: 2, step: 1 nm }",
       "'to' must be of the same dimension as 'from', found '2'"},
      {"{ from: 1, to: 2, step: 1 nm }",
       "'step' must be of the same dimension as 'from', found '1 nm'"},
      {"{ from: 1 q, to: 2, step: 1 }", "unknown unit 'q' in '1 q'"},
      {"{ from: x, to: 2, step: 1 }", "'from' of a range must be a number"},
      {"{ from: 1, to: [2], step: 1 }", "'to' of a range must be a number"},
      {"{ from: 1, to: 1e999, step: 1 }",
       "'to' of a range is too large: '1e999'"},
      {"{ from: 1, to: 2 }", "a range must be '{ from: A, to: B, step: C }'"}};
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
    g_autoptr(opc_problems) found = opc_problems_new();
    g_autofree char *none = values_of(bad[i][0], found);
    g_assert_cmpstr(none, ==, "");
    g_assert_cmpuint(found->list->len, ==, 1);
    g_assert_cmpstr(((const opc_problem *)found->list->pdata[0])->message, ==,
                    bad[i][1]);
  }
  g_autofree char *most =
      values_of("{ from: 1, to: 100000, step: 1 }", problems);
  g_assert_true(g_str_has_suffix(most, ";100000;"));
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
  g_test_add_func("/tree/merge", test_merge);
  g_test_add_func("/tree/paths", test_paths);
  g_test_add_func("/tree/arguments", test_arguments);
  g_test_add_func("/tree/quantities", test_quantities);
  g_test_add_func("/tree/ranges", test_ranges);
  g_test_add_func("/tree/numbers", test_numbers);
  g_test_add_func("/tree/list", test_list);
  g_test_add_func("/tree/labels", test_labels);
  int code = g_test_run();
  g_rmdir(folder);
  return code;
}
