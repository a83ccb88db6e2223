/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of lists of problems and findings, and of suggestions. */
#include <base/findings.h>
#include <base/problem.h>
#include <base/suggest.h>
#include <string.h>

/* ---- problems ---- */

static void problem_put(opc_problems *p, int code, const char *file,
                        unsigned line, unsigned column, const char *message) {
  const opc_place at = {file, line, column};
  g_assert_false(opc_problem_add(p, code, &at, "%s", message));
}

static void expect_text(opc_problems *p, const char *expected) {
  g_autofree char *text = opc_problems_text(p);
  g_assert_cmpstr(text, ==, expected);
}

/* Problems are sorted by the first problems of files, by line and by column;
   problems of one place keep their order. */
static void test_sorted(void) {
  g_autoptr(opc_problems) p = opc_problems_new();
  expect_text(p, "");
  g_assert_cmpint(opc_problems_code(p), ==, OPC_OK);
  problem_put(p, OPC_INVALID, "z", 7, 1, "first");
  problem_put(p, OPC_INVALID, "a", 2, 9, "second");
  problem_put(p, OPC_INVALID, "z", 2, 5, "third");
  problem_put(p, OPC_INVALID, "z", 2, 4, "fourth");
  problem_put(p, OPC_INVALID, "z", 2, 4, "fifth\n");
  problem_put(p, OPC_INVALID, "a", 0, 0, "whole");
  opc_problem_add(p, OPC_INVALID, NULL, "%d places", 0);
  expect_text(p,
              "z:2:4: fourth\nz:2:4: fifth\\n\nz:2:5: third\nz:7:1: first\n"
              "a: whole\na:2:9: second\n0 places");
}

static void test_codes(void) {
  g_autoptr(opc_problems) p = opc_problems_new();
  opc_error error = {.message = "as before"};
  g_assert_cmpint(opc_problems_error(p, &error), ==, OPC_OK);
  g_assert_cmpstr(error.message, ==, "as before");
  problem_put(p, OPC_IO, "f", 3, 1, "lost");
  g_assert_cmpint(opc_problems_error(p, &error), ==, OPC_IO);
  g_assert_cmpint(error.code, ==, OPC_IO);
  g_assert_cmpstr(error.message, ==, "f:3:1: lost");
  problem_put(p, OPC_IO, "f", 2, 1, "gone");
  g_assert_cmpint(opc_problems_error(p, &error), ==, OPC_IO);
  g_assert_cmpstr(error.message, ==, "f:2:1: gone (and 1 more)");
  problem_put(p, OPC_NO_PLUGIN, "f", 4, 1, "absent");
  g_assert_cmpint(opc_problems_code(p), ==, OPC_INVALID);
}

/* Only new problems are merged; a problem with the note is not new. */
static void test_merged(void) {
  g_autoptr(opc_problems) to = opc_problems_new(), from = opc_problems_new();
  problem_put(to, OPC_INVALID, "f", 1, 1, "equal");
  problem_put(to, OPC_INVALID, "f", 1, 2, "noted, at 3");
  problem_put(from, OPC_INVALID, "f", 1, 1, "equal");
  problem_put(from, OPC_INVALID, "f", 1, 2, "noted");
  problem_put(from, OPC_INVALID, "f", 1, 1, "other");
  problem_put(from, OPC_INVALID, "g", 1, 1, "equal");
  problem_put(from, OPC_INVALID, "f", 2, 1, "equal");
  problem_put(from, OPC_INVALID, "f", 1, 3, "equal");
  opc_problems_merge(to, from, ", at 3");
  expect_text(to,
              "f:1:1: equal\nf:1:1: other, at 3\nf:1:2: noted, at 3\n"
              "f:1:3: equal, at 3\nf:2:1: equal, at 3\ng:1:1: equal, at 3");
  opc_problems_merge(to, from, NULL);
  g_assert_cmpuint(to->list->len, ==, 11);
}

static void test_limits(void) {
  g_autoptr(opc_problems) p = opc_problems_new();
  g_autofree char *wide = g_strnfill(998, 'x');
  g_autofree char *text = g_strconcat(wide, "\xc3\xa9\xc3\xa9", NULL);
  problem_put(p, OPC_INVALID, "f", 1, 1, text);
  const opc_problem *first = p->list->pdata[0];
  g_assert_cmpuint(strlen(first->message), <=, 1000);
  g_assert_true(g_str_has_suffix(first->message, "x..."));
  g_assert_true(g_utf8_validate(first->message, -1, NULL));
  for (unsigned i = 1; i < 2000; i++) {
    g_assert_cmpint(opc_problems_full(p), ==, i >= 1000);
    problem_put(p, OPC_INVALID, "f", i, 1, "more");
  }
  g_assert_cmpuint(p->list->len, ==, 1000);
  const opc_problem *last = p->list->pdata[999];
  g_assert_cmpstr(last->message, ==, "further problems are not listed");
  g_assert_null(last->at.file);
}

/* ---- findings ---- */

static void test_findings(void) {
  opc_findings f;
  opc_findings_init(&f);
  opc_findings_add(&f, 0, "mask", "too wide");
  opc_findings_add(&f, 3, "mask", "too wide");
  opc_findings_add(&f, 0, "mask", "too wide");
  opc_findings_add(&f, 0, "mask.litho", "too wide");
  g_assert_cmpuint(f.list->len, ==, 3);
  for (int i = 0; i < 99; i++) {
    g_autofree char *text = g_strdup_printf("number %d", i);
    opc_findings_add(&f, 0, "a", text);
  }
  g_assert_cmpuint(f.list->len, ==, 100);
  g_assert_cmpuint(f.more, ==, 2);
  g_autoptr(GPtrArray) lines = opc_findings_lines(&f);
  g_assert_cmpuint(lines->len, ==, 101);
  g_assert_cmpstr(lines->pdata[0], ==, "mask: too wide");
  g_assert_cmpstr(lines->pdata[1], ==, "point 3: mask: too wide");
  g_assert_cmpstr(lines->pdata[2], ==, "mask.litho: too wide");
  g_assert_cmpstr(lines->pdata[100], ==, "and 2 more findings");
  opc_findings_clear(&f);
}

/* ---- suggestions ---- */

static void test_distances(void) {
  static const struct {
    const char *a, *b;
    unsigned distance;
  } all[] = {
      {"", "", 0},           {"abc", "abc", 0}, {"abc", "", 3},
      {"abc", "abd", 1},     {"abc", "ab", 1},  {"ab", "aXb", 1},
      {"litho", "ltiho", 1}, {"ca", "abc", 3},  {"kitten", "sitting", 3}};
  for (size_t i = 0; i < G_N_ELEMENTS(all); i++) {
    g_assert_cmpuint(opc_edit_distance(all[i].a, all[i].b), ==,
                     all[i].distance);
    g_assert_cmpuint(opc_edit_distance(all[i].b, all[i].a), ==,
                     all[i].distance);
  }
}

/* Check the text of a suggestion; `expected`: NULL for no suggestion. */
static void expect_suggestion(const char *found, const char *expected) {
  g_autofree char *text =
      expected ? g_strdup_printf(", did you mean '%s'?", expected)
               : g_strdup("");
  g_assert_cmpstr(found, ==, text);
}

static void expect_nearest(const char *word, char *const *words,
                           const char *expected) {
  g_autofree char *found = opc_suggestion_of(word, words);
  expect_suggestion(found, expected);
}

static void test_nearest(void) {
  static char *const words[] = {(char *)"dose", (char *)"defocus",
                                (char *)"sigma", (char *)"NA", NULL};
  expect_nearest("does", words, "dose");
  expect_nearest("DOSE", words, "dose");
  expect_nearest("na", words, "NA");
  expect_nearest("defoocs", words, "defocus");
  expect_nearest("sgm", words, NULL); /* the distance is 2, the limit 1 */
  expect_nearest("xy", words, NULL);
  expect_nearest("", words, NULL);
}

static void expect_id(const char *id, const char *expected) {
  static const char *const ids[] = {"write.gds", "read.gds", "read.oasis",
                                    "segment.transistors", "correct"};
  g_autoptr(GPtrArray) list = g_ptr_array_new();
  for (size_t i = 0; i < G_N_ELEMENTS(ids); i++)
    g_ptr_array_add(list, (char *)ids[i]);
  g_autofree char *found = opc_suggestion_of_id(id, list);
  expect_suggestion(found, expected);
}

static void test_ids(void) {
  expect_id("gds.read", "read.gds");
  expect_id("reader.gds", "read.gds");
  expect_id("wrote.gds", "write.gds");
  expect_id("read.oassis", "read.oasis");
  expect_id("corect", "correct");
  expect_id("transistor", "segment.transistors");
  expect_id("gds", "write.gds");
  expect_id("nothing.like", NULL);
  expect_id("nothing", NULL);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/problem/sorted", test_sorted);
  g_test_add_func("/problem/codes", test_codes);
  g_test_add_func("/problem/merged", test_merged);
  g_test_add_func("/problem/limits", test_limits);
  g_test_add_func("/problem/findings", test_findings);
  g_test_add_func("/problem/distances", test_distances);
  g_test_add_func("/problem/nearest", test_nearest);
  g_test_add_func("/problem/ids", test_ids);
  return g_test_run();
}
