/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of patterns of files and words, and of labels. */
#include <base/match.h>
#include <glib/gstdio.h>
#include <string.h>

static const opc_source source = {.name = (char *)"test"};

/* Return the texts and stars of a list: "text|star;" for each (g_free). The
   text of a path is its name without folders. */
static char *values_text(const opc_values *v) {
  GString *all = g_string_new(NULL);
  for (guint i = 0; i < v->nodes->len; i++) {
    const opc_node *node = v->nodes->pdata[i];
    g_autofree char *base = g_path_get_basename(node->text);
    g_string_append_printf(all, "%s|%s;", base, (char *)v->stars->pdata[i]);
  }
  return g_string_free(all, FALSE);
}

/* Add the values of a pattern by one of three functions: 'f' files, 'p' the
   file with `star`, 'c' choices. Check the list, or the problem. */
static void expect_added(opc_values *v, char how, const char *pattern,
                         const char *star, const char *expected) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) node = opc_node_text_new(&source, pattern);
  static const char *const words[] = {"dpb", "pb", "epe"};
  g_autoptr(GPtrArray) list = g_ptr_array_new();
  for (size_t i = 0; i < G_N_ELEMENTS(words); i++)
    g_ptr_array_add(list, (char *)words[i]);
  gboolean good = how == 'f'   ? opc_match_files(node, v, problems)
                  : how == 'p' ? opc_pair_file(node, star, v, problems)
                               : opc_match_choices(node, list, v, problems);
  g_autofree char *found = good ? values_text(v) : opc_problems_text(problems);
  if (!strstr(found, expected) || (good && strcmp(found, expected) != 0))
    g_error("%s: '%s' is not '%s'", pattern, found, expected);
  g_assert_cmpuint(problems->list->len, ==, !good);
}

static void test_files(void) {
  g_autofree char *folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_autofree char *before = g_get_current_dir();
  static const char *const names[] = {"a.gds", "b.gds", "b.cif"};
  g_assert_cmpint(g_chdir(folder), ==, 0);
  for (size_t i = 0; i < G_N_ELEMENTS(names); i++)
    g_assert_true(g_file_set_contents(names[i], "", 0, NULL));
  opc_values v;
  opc_values_init(&v);
  expect_added(&v, 'f', "*.gds", NULL, "a.gds|a;b.gds|b;");
  const opc_node *first = v.nodes->pdata[0];
  g_assert_true(g_path_is_absolute(first->text));
  /* A file that is already in the list is not added again. */
  expect_added(&v, 'f', "b.*", NULL, "a.gds|a;b.gds|b;b.cif|cif;");
  expect_added(&v, 'f', "*.oas", NULL, "no file matches '*.oas'");
  expect_added(&v, 'p', "*.cif", "b", "a.gds|a;b.gds|b;b.cif|cif;");
  expect_added(&v, 'p', "*.cif", "a", "'a.cif': no such file");
  opc_values_remove(&v, "b.*", TRUE);
  expect_added(&v, 'f', "?.c?f", NULL, "a.gds|a;b.cif|;");
  opc_values_remove(&v, "b.*", FALSE); /* compares absolute paths */
  g_assert_cmpuint(v.nodes->len, ==, 2);
  expect_added(&v, 'p', "*.gds", "b", "a.gds|a;b.cif|;b.gds|b;");
  opc_values_clear(&v);
  for (size_t i = 0; i < G_N_ELEMENTS(names); i++)
    g_assert_cmpint(g_remove(names[i]), ==, 0);
  g_assert_cmpint(g_chdir(before), ==, 0);
  g_assert_cmpint(g_rmdir(folder), ==, 0);
}

static void test_choices(void) {
  opc_values v;
  opc_values_init(&v);
  expect_added(&v, 'c', "*pb", NULL, "dpb|;pb|;");
  expect_added(&v, 'c', "?p?", NULL, "dpb|;pb|;epe|;");
  expect_added(&v, 'c', "x*", NULL, "none of 3 names matches 'x*'");
  opc_values_remove(&v, "*pb", FALSE);
  expect_added(&v, 'c', "epe", NULL, "epe|;");
  opc_values_clear(&v);
}

static void expect_label(const char *text, const char *expected,
                         const char *of_map) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) node =
      *text == '{' ? opc_node_parse(&source, text, strlen(text), problems)
                   : opc_node_text_new(&source, text);
  g_assert_cmpuint(problems->list->len, ==, 0);
  g_autofree char *label = opc_label(node);
  g_assert_cmpstr(label, ==, expected);
  if (!of_map) return;
  g_autofree char *whole = opc_label_of_map(node);
  g_assert_cmpstr(whole, ==, of_map);
}

static void test_labels(void) {
  expect_label("folder/cell_1.gds", "cell_1", NULL);
  expect_label("3 nm", "3nm", NULL);
  expect_label("0.5", "0.5", NULL);
  expect_label("-4 %", "4", NULL);
  expect_label("${a.b}", "a.b", NULL);
  expect_label("{ use: synthesizer.dpb, step: 3 }", "dpb", "synthesizer");
  expect_label("{ use: read.gds, file: x/nand2.gds, scale: 2 }", "nand2",
               "read");
  expect_label("{ use: given, mask: fast, file: a.gds }", "fast-a", "given");
  expect_label("{ a: {}, b: 3 nm }", "", "3nm");
  expect_label("{ a: { use: x.y } }", "", "y");
  expect_label("{ a: {} }", "", "");
  g_autoptr(GString) all = g_string_new(NULL);
  opc_label_add(all, "");
  opc_label_add(all, "a");
  opc_label_add(all, "a");
  opc_label_add(all, "b");
  g_assert_cmpstr(all->str, ==, "a-b");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/match/files", test_files);
  g_test_add_func("/match/choices", test_choices);
  g_test_add_func("/match/labels", test_labels);
  return g_test_run();
}
