/* SPDX-License-Identifier: BSD-3-Clause */
/* Data kinds "experiment" and "settings": copies and refusals. Suggestions for
   mistyped words. */
#include <eda/experiment.h>
#include <eda/settings.h>
#include <eda/words.h>
#include <glib.h>
#include <string.h>

/* Copies are independent of the texts of the caller. */
static void test_experiment(void) {
  char names[6][4] = {"c1", "c2", "c3", "m1", "m2", "f"};
  const char *cases[] = {names[0], names[1], names[2]},
             *methods[] = {names[3], names[4]},
             *folders[] = {"/1", "/2", "/3", "/4", NULL, names[5]};
  opc_error error;
  eda_experiment *e = eda_experiment_new(3, cases, 2, methods, folders);
  memset(names, 'x', sizeof names);
  g_assert_cmpuint(e->n_cases, ==, 3);
  g_assert_cmpuint(e->n_methods, ==, 2);
  g_assert_cmpstr(e->cases[0], ==, "c1");
  g_assert_cmpstr(e->cases[2], ==, "c3");
  g_assert_cmpstr(e->methods[1], ==, "m2");
  g_assert_cmpstr(e->folders[3], ==, "/4");
  g_assert_null(e->folders[4]);
  g_assert_cmpstr(e->folders[5], ==, "f");
  g_assert_cmpint(eda_experiment_check(e, &error), ==, OPC_OK);
  eda_experiment_free(e);
  eda_experiment_free(NULL);
}

static void expect_bad_experiment(const eda_experiment *e, const char *want) {
  opc_error error;
  g_assert_cmpint(eda_experiment_check(e, &error), ==, OPC_FAILED);
  g_assert_cmpstr(error.message, ==, want);
}

static void test_bad_experiments(void) {
  static const char *const names[] = {"a", "", NULL, "d"};
  static const char unnamed[] =
      "a case or a method of the experiment has no name";
  opc_error error;
  eda_experiment e = {1, 1, names, names + 3, names};
  g_assert_cmpint(eda_experiment_check(&e, &error), ==, OPC_OK);
  e.n_cases = 2;
  expect_bad_experiment(&e, unnamed);
  e.n_cases = 1;
  e.methods = names + 2;
  expect_bad_experiment(&e, unnamed);
  e.n_methods = 0;
  expect_bad_experiment(&e,
                        "an experiment has 1 cases and 0 methods, expected at "
                        "least one of each");
  for (int k = 0; k < 4; k++) {
    e = (eda_experiment){k > 0, 1, k == 1 ? NULL : names, k == 2 ? NULL : names,
                         k == 3 ? NULL : names};
    g_assert_cmpint(eda_experiment_check(&e, &error), ==, OPC_FAILED);
    g_assert_nonnull(strstr(error.message, "expected at least one of each"));
  }
}

/* Return settings of 2 * 3 combinations, the second parameter without unit and
   numbers. */
static eda_settings *settings_make(void) {
  static const double lengths[] = {60, 90};
  static const char *const texts[] = {"60 nm", "90 nm", "on", "off", "auto"};
  static const double figure[] = {6, 5, 4, 3, 2, 9};
  eda_settings *s = eda_settings_new(2);
  eda_settings_parameter(s, 0, "mask.length", "nm", 2, lengths, texts);
  eda_settings_parameter(s, 1, "mask.mode", NULL, 3, NULL, texts + 2);
  eda_settings_figure(s, "error", "%", figure, 4);
  return s;
}

static void test_settings(void) {
  opc_error error;
  eda_settings *s = settings_make();
  const eda_setting *p = s->parameters;
  g_assert_cmpuint(s->n_parameters, ==, 2);
  g_assert_cmpuint(s->count, ==, 6);
  g_assert_cmpuint(s->best, ==, 4);
  g_assert_cmpfloat(s->figure[0], ==, 6);
  g_assert_cmpfloat(s->figure[5], ==, 9);
  g_assert_cmpstr(s->name, ==, "error");
  g_assert_cmpstr(s->unit, ==, "%");
  g_assert_cmpstr(p[0].name, ==, "mask.length");
  g_assert_cmpstr(p[0].unit, ==, "nm");
  g_assert_cmpuint(p[0].count, ==, 2);
  g_assert_cmpfloat(p[0].values[1], ==, 90);
  g_assert_cmpstr(p[0].texts[1], ==, "90 nm");
  g_assert_null(p[0].texts[2]);
  g_assert_null(p[1].unit);
  g_assert_null(p[1].values);
  g_assert_cmpuint(p[1].count, ==, 3);
  g_assert_cmpstr(p[1].texts[0], ==, "on");
  g_assert_cmpstr(p[1].texts[2], ==, "auto");
  g_assert_cmpint(eda_settings_check(s, &error), ==, OPC_OK);
  eda_settings_free(s);
  eda_settings_free(NULL);
}

static void test_bad_settings(void) {
  static const char unnamed[] =
      "parameter 2 of the settings has no name or no values";
  opc_error error;
  eda_settings *s = settings_make();
  eda_setting *p = (eda_setting *)&s->parameters[1], good = *p;
  eda_settings whole = *s;
#define REFUSED(change, words)                                    \
  change;                                                         \
  g_assert_cmpint(eda_settings_check(s, &error), ==, OPC_FAILED); \
  g_assert_cmpstr(error.message, ==, words);                      \
  *p = good;                                                      \
  *s = whole
  REFUSED(p->name = NULL, unnamed);
  REFUSED(p->texts = NULL, unnamed);
  REFUSED(p->count = 0, unnamed);
  REFUSED(p->count = 2,
          "figure or its name missing, or 6 values for 4 combinations, best: "
          "number 5");
  REFUSED(s->best = 6,
          "figure or its name missing, or 6 values for 6 combinations, best: "
          "number 7");
  REFUSED(s->figure = NULL,
          "figure or its name missing, or 6 values for 6 combinations, best: "
          "number 5");
  REFUSED(s->name = NULL,
          "figure or its name missing, or 6 values for 6 combinations, best: "
          "number 5");
  s->best = 5;
  g_assert_cmpint(eda_settings_check(s, &error), ==, OPC_OK);
  eda_settings_free(s);
}

static void test_words(void) {
  static const char *const known[] = {"poly", "active", "metal1", "metal2",
                                      NULL};
  g_assert_cmpstr(eda_nearest("PLOY", known), ==, "poly");
  g_assert_cmpstr(eda_nearest("metal", known), ==, "metal1");
  g_assert_cmpstr(eda_nearest("metl2", known), ==, "metal2");
  g_assert_null(eda_nearest("nwell", known));
  g_assert_null(eda_nearest("poly", known + 4));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/kinds/experiment", test_experiment);
  g_test_add_func("/kinds/bad-experiments", test_bad_experiments);
  g_test_add_func("/kinds/settings", test_settings);
  g_test_add_func("/kinds/bad-settings", test_bad_settings);
  g_test_add_func("/kinds/words", test_words);
  return g_test_run();
}
