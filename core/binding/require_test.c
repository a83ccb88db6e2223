/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of required ranges of metrics, and of the search for steps, bindings
   and metrics by their paths. */
#include "core/binding/require.h"

#include <math.h>
#include <string.h>

#include "core/binding/folder_test.h"
#include "core/binding/lookup.h"

/* Read a flow with the step `a` and this section `require`. */
static opc_flow *load(const char *require, opc_problems *problems) {
  g_autofree char *text = g_strdup_printf(
      "opcflow: 1\nsteps:\n  a: { use: test.numbers, size: 4 nm }\n"
      "require: %s\n",
      require);
  put_text("flow.yaml", text);
  return opc_flow_load("flow.yaml", NULL, trial_registry(), problems);
}

/* The bounds of a.sum, whose unit is nm, whose tolerance is 0.1 nm, and of
   which lower is better. */
static void test_bounds(void) {
  static const struct {
    const char *bound;
    double least, most;
    gboolean open;
    const char *text;
  } all[] = {{"3 nm", -INFINITY, 3, FALSE, "at most 3 nm"},
             {"<= 3 nm", -INFINITY, 3, FALSE, "at most 3 nm"},
             {"<3 nm", -INFINITY, 3, TRUE, "less than 3 nm"},
             {"'>= 0.002 um'", 2, INFINITY, FALSE, "at least 2 nm"},
             {"'> 2 nm'", 2, INFINITY, TRUE, "more than 2 nm"},
             {"= 2 nm", 1.9, 2.1, FALSE, "2 nm"},
             {"[1 nm, 5 nm]", 1, 5, FALSE, "from 1 nm to 5 nm"}};
  for (size_t i = 0; i < G_N_ELEMENTS(all); i++) {
    g_autofree char *text = g_strdup_printf("{ a.sum: %s }", all[i].bound);
    g_autoptr(opc_problems) problems = opc_problems_new();
    g_autoptr(opc_flow) flow = load(text, problems);
    g_autofree char *found = opc_problems_text(problems);
    g_assert_cmpstr(found, ==, "");
    g_assert_cmpuint(flow->requirements->len, ==, 1);
    const opc_requirement *r = flow->requirements->pdata[0];
    g_assert_cmpstr(r->path, ==, "a.sum");
    g_assert_cmpstr(r->metric->name, ==, "sum");
    g_assert_cmpstr(r->binding->path, ==, "a");
    g_assert_cmpstr(r->text, ==, all[i].text);
    g_assert_cmpint(r->open, ==, all[i].open);
    g_assert_true(r->least == all[i].least ||
                  fabs(r->least - all[i].least) < 1e-9);
    g_assert_true(r->most == all[i].most || fabs(r->most - all[i].most) < 1e-9);
  }
}

/* A nested map has the same requirements as paths with dots. */
static void test_nested(void) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow = load("\n  a:\n    sum: 3 nm", problems);
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpstr(found, ==, "");
  const opc_requirement *r = flow->requirements->pdata[0];
  g_assert_cmpstr(r->path, ==, "a.sum");
  g_assert_cmpuint(r->at.line, ==, 6);
  g_autoptr(opc_problems) others = opc_problems_new();
  g_autoptr(opc_flow) none = load("{}", others);
  g_assert_cmpuint(none->requirements->len, ==, 0);
}

/* Problems have a place and a suggestion. A valid requirement beside an invalid
   one is kept. */
static void test_faults(void) {
  static const struct {
    const char *require, *problem;
  } all[] = {
      {"3",
       "flow.yaml:4:10: 'require' must be a map, as in '{ STEP.METRIC: "
       "BOUND }'"},
      {"{ sum: 3 nm }",
       "flow.yaml:4:12: 'sum' does not name a metric, expected 'step.metric'"},
      {"{ a.sun: 3 nm }",
       "'a' (test.numbers) has no metric 'sun', did you "
       "mean 'sum'?"},
      {"{ b.sum: 3 nm }", "'b' does not exist in 'flow.yaml'"},
      {"{ a.sum: 3 V }", "flow.yaml:4:19: "},
      {"{ a.sum: [1 nm] }",
       "a range of 'a.sum' must be two numbers, as in "
       "'[FROM, TO]'"},
      {"{ a.sum: [1 nm, [2 nm]] }", "a range of 'a.sum' must be two numbers"},
      {"{ a.sum: [2 nm, 1 nm] }",
       "the range of 'a.sum' must start at the smaller number"},
      {"{ a.sum: [x, 1 nm] }", "flow.yaml:4:20: "}};
  for (size_t i = 0; i < G_N_ELEMENTS(all); i++) {
    g_autoptr(opc_problems) problems = opc_problems_new();
    g_autoptr(opc_flow) flow = load(all[i].require, problems);
    g_autofree char *found = opc_problems_text(problems);
    g_assert_nonnull(flow);
    if (!strstr(found, all[i].problem))
      g_error("'%s' is not in '%s'", all[i].problem, found);
    g_assert_cmpuint(flow->requirements->len, ==, 0);
  }
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow = load("{ a.none: 1, a.sum: 2 nm }", problems);
  g_assert_cmpuint(problems->list->len, ==, 1);
  g_assert_cmpuint(flow->requirements->len, ==, 1);
}

static void test_paths(void) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow = load("{}", problems);
  opc_error error = {0};
  g_assert_cmpstr(opc_flow_find(flow, "a.size")->name, ==, "a");
  g_assert_null(opc_flow_find(flow, "ab"));
  g_assert_null(opc_flow_find(flow, ""));
  g_assert_cmpstr(opc_flow_parameter(flow, "a.size")->name, ==, "size");
  g_assert_null(opc_flow_parameter(flow, "a.sizes"));
  g_assert_null(opc_flow_parameter(flow, "a"));
  g_assert_cmpstr(opc_flow_binding(flow, "a", &error)->plugin->id, ==,
                  "test.numbers");
  g_assert_null(opc_flow_binding(flow, "aa", &error));
  g_assert_nonnull(strstr(error.message, "'aa' does not exist in 'flow.yaml'"));
  const opc_binding *owner = NULL;
  g_assert_cmpstr(opc_flow_metric(flow, "a.sum", &owner, &error)->unit, ==,
                  "nm");
  g_assert_cmpstr(owner->path, ==, "a");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  trial_begin();
  g_test_add_func("/require/bounds", test_bounds);
  g_test_add_func("/require/nested", test_nested);
  g_test_add_func("/require/faults", test_faults);
  g_test_add_func("/require/paths", test_paths);
  return trial_end();
}
