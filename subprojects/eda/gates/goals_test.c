/* SPDX-License-Identifier: BSD-3-Clause */
/* Notes and tables of goals: values computed by hand, and the message of each
   fault. */
#include <eda/goals.h>
#include <glib.h>
#include <glib/gstdio.h>
#include <string.h>

static void assert_goal(const eda_goal *w, eda_goal want) {
  g_assert_cmpint(w->given, ==, want.given);
  g_assert_cmpfloat(w->weight, ==, want.weight);
  for (int k = 0; k < EDA_GOAL_TARGETS; k++)
    g_assert_cmpfloat(w->target[k], ==, want.target[k]);
}

static void test_good_notes(void) {
  static const struct {
    const char *note;
    eda_goal want;
  } good[] = {
      {"", {1, {1, 1, 1}, 0}},
      {" ", {1, {1, 1, 1}, 1}},
      {"weight=10", {10, {1, 1, 1}, 1}},
      {"ion=1.02,weight=0", {0, {1.02, 1, 1}, 1}},
      {"weight=1 \tion=1", {1, {1, 1, 1}, 1}},
      {"ion=0.9 ioff=0.4 area=1.08", {1, {0.9, 0.4, 1.08}, 1}},
      {"# critical path", {1, {1, 1, 1}, 0}},
      {"sta.slack=3ps", {1, {1, 1, 1}, 1}},
      {"weight=2 sta.slack=3ps", {2, {1, 1, 1}, 1}},
      {"my.own", {1, {1, 1, 1}, 1}},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(good); i++) {
    eda_goal w;
    g_assert_null(eda_goal_parse(good[i].note, &w));
    assert_goal(&w, good[i].want);
    g_assert_null(eda_goal_fault(&w));
  }
}

static void test_bad_notes(void) {
  static const struct {
    const char *note, *fault;
  } bad[] = {
      {"wieght=2", "unknown word 'wieght', did you mean 'weight'?"},
      {"iom=1.02", "unknown word 'iom', did you mean 'ion'?"},
      {"M1",
       "unknown word 'M1'; expected weight=..., ion=..., ioff=... or area=..."},
      {"a-longer-word-than-any",
       "unknown word 'a-longer-word-than-any'; expected weight=..., ion=..., "
       "ioff=... or area=..."},
      {"weight", "'weight' has no value, expected weight=..."},
      {"weight=", "'' is no weight"},
      {"weight=-1", "'-1' is no weight"},
      {"weight=1 weight=2", "'weight' is set twice"},
      {"ion=2%", "'2%' is no multiple of a current from 0.1 to 10"},
      {"ioof=0.5", "unknown word 'ioof', did you mean 'ioff'?"},
      {"ioff=0", "'0' is no multiple of Ioff from 0.001 to 1000"},
      {"area=11", "'11' is no multiple of an area from 0.1 to 10"},
      {"ion=nan", "'nan' is no multiple of a current from 0.1 to 10"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(bad); i++) {
    eda_goal w;
    g_autofree char *fault = eda_goal_parse(bad[i].note, &w);
    g_assert_cmpstr(fault, ==, bad[i].fault);
  }
}

/* The bounds of texts also apply to goals set by steps. */
static void test_bounds(void) {
  eda_goal w = eda_goal_none;
  w.weight = -1;
  g_assert_cmpstr(eda_goal_fault(&w), ==, "weight");
  w = eda_goal_none;
  w.target[EDA_GOAL_IOFF] = 2000;
  g_assert_cmpstr(eda_goal_fault(&w), ==,
                  "multiple of Ioff from 0.001 to 1000");
}

static int read_table(const char *text, eda_goal *out, opc_error *error) {
  char *cell[] = {"INV", "INV"}, *path[] = {"XU7", ""};
  uint32_t number[] = {1, 3};
  const eda_gates gates = {
      .count = 2, .cell = cell, .instance = path, .number = number};
  g_autofree char *file =
      g_build_filename(g_get_tmp_dir(), "eda-wishes.csv", NULL);
  g_assert_true(g_file_set_contents(file, text, -1, NULL));
  int code = eda_goals_read(file, &gates, out, error);
  g_remove(file);
  return code;
}

static void test_table(void) {
  opc_error error;
  eda_goal w[] = {{2, {1.5, 1, 1}, 1}, {1, {1, 1, 1}, 0}};
  g_assert_cmpint(
      read_table("transistor,weight,ioff\nXU7:1,3,\nINV:3,,0.5\n", w, &error),
      ==, OPC_OK);
  assert_goal(&w[0], (eda_goal){3, {1.5, 1, 1}, 1});
  assert_goal(&w[1], (eda_goal){1, {1, 0.5, 1}, 1});
  g_assert_cmpint(read_table("transistor,ion\nINV:3,20\n", w, &error), ==,
                  OPC_INVALID);
  g_assert_cmpstr(error.parameter, ==, "wishes");
  g_assert_nonnull(strstr(
      error.message, ":2:7: no multiple of a current from 0.1 to 10: '20'"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/goals/good-notes", test_good_notes);
  g_test_add_func("/goals/bad-notes", test_bad_notes);
  g_test_add_func("/goals/bounds", test_bounds);
  g_test_add_func("/goals/table", test_table);
  return g_test_run();
}
