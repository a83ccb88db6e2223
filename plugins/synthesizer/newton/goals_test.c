/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests goals (targets and weights) of single transistors, from a table and
   from the gates. */
#include <glib/gstdio.h>

#include "model_test.h"

static opc_module *with_bytes(const char *text, gssize size, char **path) {
  g_autofree char *yaml = NULL;
  g_file_set_contents(*path, text, size, NULL);
  yaml = g_strdup_printf("{ ion_limit: 0 %%, wishes: %s }", *path);
  return model_make(yaml);
}

static opc_module *with_goals(const char *text, char **path) {
  return with_bytes(text, -1, path);
}

/* Check that `begin` rejects the table with `message`. */
static void refused_goals(opc_module *bad, const char *message) {
  char *cell[] = {"cell"}, *none[] = {""};
  uint32_t number[] = {1};
  eda_gates gates = {
      .grid = 1, .count = 1, .cell = cell, .instance = none, .number = number};
  eda_feedback f = {.gates = &gates};
  const eda_synthesizer *s = bad->functions;
  opc_error error;
  g_assert_cmpint(s->begin(bad->self, &f, &error), ==, OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "wishes");
  g_assert_nonnull(strstr(error.message, message));
}

/* One transistor has a target of 2 % more Ion, one a larger tolerance, and one
   is excluded. */
static void test_goals(void) {
  g_autofree char *path =
      g_build_filename(g_get_tmp_dir(), "newton-wishes.csv", NULL);
  g_autoptr(opc_module) m = with_goals(
      "# slack\ntransistor, ion, "
      "weight\ncell:1,1.02\ncell:2,,0.01\ncell:3,,0\n",
      &path);
  model t = {.n = 4, .gain_l = 2.6, .gain_w = 1.05, .off_l = {3, 2, 7, -4}};
  model_run(m, &t);
  g_assert_cmpfloat_with_epsilon(t.ion[0], 2, 0.06);
  g_assert_cmpint(t.l[1], ==, 0);
  g_assert_cmpint(t.jog[1], ==, 0);
  g_assert_cmpint(t.l[2], ==, 0);
  const eda_synthesizer *s = m->functions;
  g_assert_true(isnan(s->target(m->self, 2)));
  g_assert_cmpfloat(fabs(t.ion[3]), <, 0.05);

  static const struct {
    const char *text, *message;
  } wrong[] = {
      {"weight\n1\n", ":1:1: missing column 'transistor'"},
      {"transistor,slack\n", ":1:12: unknown column 'slack'"},
      {"ion,transistor,ion\n", ":1:16: duplicate column: 'ion'"},
      {"transistor,weight\ncell:1,1\ncell:9,1\n",
       ":3:1: unknown transistor 'cell:9'"},
      {"transistor,weight\n"
       "cell:1,1,2\n",
       ":2:10: unexpected field: '2'"},
      {"transistor,weight\ncell:1,-1\n", ":2:8: no weight: '-1'"},
      {"transistor,ion\ncell:1,2 %\n",
       ":2:8: no multiple of a current from 0.1 to 10: '2 %'"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(wrong); i++) {
    g_autoptr(opc_module) bad = with_goals(wrong[i].text, &path);
    refused_goals(bad, wrong[i].message);
  }
  static const char cut[] = "transistor,weight\ncell:1,1\0\ncell:1,2\n";
  g_autoptr(opc_module) with_nul = with_bytes(cut, sizeof cut - 1, &path);
  refused_goals(with_nul, "is not a text file: byte 26 is 0");
  gssize size = (64 << 20) + 1;
  g_autofree char *blanks = g_strnfill((gsize)size, '\n');
  g_autoptr(opc_module) large = with_bytes(blanks, size, &path);
  refused_goals(large, "67108865 bytes, more than 64 MB");
  g_remove(path);
}

/* A goal of a length 4 nm larger: the law of the model reduces Ion, Ioff and
   area, and W stays as drawn. A goal for one figure keeps the other targets at
   the drawn values. */
static void test_longer(void) {
  g_autoptr(opc_module) m = make_any("{ target: balanced }");
  model t = {.n = 4, .gain_l = 2.6, .gain_w = 1.05, .off_l = {3, 2, 7, -4}};
  const double by = 4;
  const eda_goal longer = {
      1, {exp(-0.022 * by), exp(-0.3 * by), 1 + by / length}, 1};
  eda_goal all[] = {longer, longer, eda_goal_none, {1, {1, 0.8, 1}, 1}};
  goals = all;
  model_run(m, &t);
  goals = NULL;
  for (int i = 0; i < 2; i++) {
    g_assert_cmpfloat_with_epsilon(t.ion[i], 100 * expm1(-0.022 * by), 0.1);
    g_assert_cmpfloat_with_epsilon(log1p(t.ioff[i] / 100), -0.3 * by, 0.15);
    g_assert_cmpfloat_with_epsilon(t.area[i], 100 * by / length, 1);
  }
  g_assert_cmpfloat(fabs(t.ioff[2]), <, 15);
  g_assert_cmpfloat(fabs(t.ion[3]), <, 0.1);
  g_assert_cmpfloat_with_epsilon(t.ioff[3], -20, 5);
}

/* Values in the table replace those of the gates; empty cells do not. */
static void test_goals_of_gates(void) {
  static eda_goal all[] = {{1, {1.02, 1, 1}, 1},
                           {0, {1, 1, 1}, 1},
                           {1, {1, 1, 1}, 0},
                           {0, {1.05, 1, 1}, 1}};
  g_autofree char *path =
      g_build_filename(g_get_tmp_dir(), "newton-gates.csv", NULL);
  g_autoptr(opc_module) m =
      with_goals("transistor,ion,weight\ncell:2,,1\ncell:4,,1\n", &path);
  model t = {.n = 4, .gain_l = 2.6, .gain_w = 1.05, .off_l = {3, 2, 7, -4}};
  goals = all;
  model_run(m, &t);
  goals = NULL;
  const eda_synthesizer *f = m->functions;
  g_assert_cmpfloat(f->target(m->self, 0), ==, 1.02);
  g_assert_cmpfloat(f->target(m->self, 2), ==, 1);
  g_assert_cmpfloat_with_epsilon(t.ion[0], 2, 0.06);
  g_assert_cmpfloat(fabs(t.ion[1]), <, 0.06);
  g_assert_cmpfloat(fabs(t.ion[2]), <, 0.06);
  g_assert_cmpfloat_with_epsilon(t.ion[3], 5, 0.06);
  g_remove(path);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/newton/longer", test_longer);
  g_test_add_func("/newton/goals", test_goals);
  g_test_add_func("/newton/goals-of-gates", test_goals_of_gates);
  return g_test_run();
}
