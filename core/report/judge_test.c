/* SPDX-License-Identifier: BSD-3-Clause */
/* Verdicts at the bounds of requirements, verdicts of points, and messages. */
#include "core/report/judge.h"

#include <math.h>

static const opc_metric metric = {.name = "largest", .unit = "%"};
static const opc_binding step = {.path = (char *)"mask"};

/* Return the verdicts of a flow with one requirement; NAN for a metric that was
   not measured. */
static GPtrArray *verdicts_of(double least, double most, gboolean open,
                              double value) {
  opc_requirement r = {.path = (char *)"mask.largest",
                       .at = {"flow.yaml", 3, 5},
                       .binding = &step,
                       .metric = &metric,
                       .least = least,
                       .most = most,
                       .open = open,
                       .text = (char *)"the text"};
  opc_flow flow = {.requirements = g_ptr_array_new()};
  g_autoptr(GArray) metrics =
      g_array_new(FALSE, FALSE, sizeof(opc_inner_metric));
  /* The same metric of another step does not count. */
  const opc_inner_metric measured[] = {
      {.path = "other", .metric = &metric, .value = 0.5},
      {.path = "mask", .metric = &metric, .value = value}};
  g_array_append_vals(metrics, measured, isnan(value) ? 1 : 2);
  g_ptr_array_add(flow.requirements, &r);
  GPtrArray *verdicts = opc_verdicts_new();
  opc_verdicts_judge(verdicts, &flow, metrics, NULL);
  g_ptr_array_free(flow.requirements, TRUE);
  return verdicts;
}

static void test_bounds(void) {
  static const struct {
    double least, most;
    gboolean open;
    double value;
    gboolean kept;
  } cases[] = {
      {-INFINITY, 1, FALSE, 1, TRUE},  {-INFINITY, 1, TRUE, 1, FALSE},
      {-INFINITY, 1, TRUE, 0.9, TRUE}, {-INFINITY, 1, FALSE, 1.1, FALSE},
      {1, INFINITY, FALSE, 1, TRUE},   {1, INFINITY, TRUE, 1, FALSE},
      {1, INFINITY, TRUE, 1.1, TRUE},  {1, INFINITY, FALSE, 0.9, FALSE},
      {0, 1, FALSE, 0.5, TRUE},        {0, 1, FALSE, NAN, FALSE},
      {0, 1, TRUE, NAN, FALSE}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(GPtrArray) v = verdicts_of(cases[i].least, cases[i].most,
                                         cases[i].open, cases[i].value);
    g_assert_cmpuint(v->len, ==, 1);
    const opc_verdict *one = v->pdata[0];
    g_assert_cmpint(one->kept, ==, cases[i].kept);
    g_assert_cmpstr(one->path, ==, "mask.largest");
    g_assert_cmpstr(one->unit, ==, "%");
    g_assert_true(isnan(cases[i].value) ? isnan(one->value)
                                        : one->value == cases[i].value);
  }
}

/* A rounded value that would keep the bound is written with all digits. */
static void test_messages(void) {
  static const struct {
    double value;
    const char *message;
  } cases[] = {
      {1.5, "flow.yaml:3:5: 'mask.largest' is 1.5 %, expected the text"},
      {1.23456789,
       "flow.yaml:3:5: 'mask.largest' is 1.23457 %, expected the "
       "text"},
      {1.0000001,
       "flow.yaml:3:5: 'mask.largest' is 1.0000001 %, expected the "
       "text"},
      {NAN, "flow.yaml:3:5: 'mask.largest' has no value, expected the text"},
      {1, ""}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autoptr(GPtrArray) v = verdicts_of(-INFINITY, 1, FALSE, cases[i].value);
    g_autoptr(opc_problems) problems = opc_problems_new();
    opc_verdicts_add_broken(v, problems);
    g_autofree char *text = opc_problems_text(problems);
    g_assert_cmpstr(text, ==, cases[i].message);
    g_assert_cmpint(opc_problems_code(problems), ==,
                    *text ? OPC_LIMIT : OPC_OK);
  }
}

/* Failed verdicts are copied with the number of their point, until the list has
   1000 verdicts. */
static void test_points(void) {
  g_autoptr(GPtrArray) kept = verdicts_of(0, 1, FALSE, 0.5);
  g_autoptr(GPtrArray) broken = verdicts_of(0, 1, FALSE, 2);
  g_autoptr(GPtrArray) all = opc_verdicts_new();
  opc_verdicts_take(all, kept, 1, "");
  g_assert_cmpuint(all->len, ==, 0);
  opc_verdicts_take(all, broken, 7, "inner.");
  g_autoptr(GPtrArray) outer = opc_verdicts_new();
  opc_verdicts_take(outer, all, 0, "outer.");
  g_assert_cmpuint(all->len, ==, 1);
  g_assert_cmpuint(outer->len, ==, 1);
  const opc_verdict *first = all->pdata[0], *second = outer->pdata[0];
  g_assert_cmpuint(first->point, ==, 7);
  g_assert_cmpstr(first->path, ==, "inner.mask.largest");
  g_assert_cmpuint(second->point, ==, 7);
  g_assert_cmpstr(second->path, ==, "outer.inner.mask.largest");
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_verdicts_add_broken(all, problems);
  g_autofree char *text = opc_problems_text(problems);
  g_assert_true(g_str_has_prefix(
      text, "flow.yaml:3:5: point 7: 'inner.mask.largest' is 2 %"));
  for (int i = 0; i < 1100; i++) opc_verdicts_take(all, broken, 1, "");
  g_assert_cmpuint(all->len, ==, 1000);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/judge/bounds", test_bounds);
  g_test_add_func("/judge/messages", test_messages);
  g_test_add_func("/judge/points", test_points);
  return g_test_run();
}
