/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of instances of bindings outside runs: creation and checks, services,
   and the places and texts of errors. */
#include "core/binding/binding.h"

#include <guard/guard.h>
#include <opcflow/loader.h>
#include <opcflow/pieces.h>
#include <string.h>

#include "core/binding/folder_test.h"
#include "core/binding/lookup.h"
#include "core/plugin/declaration.h"

/* Two steps; the slot of `b` has a plugin with parameters. */
#define FLOW                                \
  "opcflow: 1\nsteps:\n"                    \
  "  a: { use: test.numbers, size: 4 nm,\n" \
  "    plain: %s }\n"                       \
  "  b: { use: test.slotted,\n"             \
  "    rule: { use: bad.none,\n"            \
  "      size: 50 nm } }\n"

static opc_flow *load(const char *plain) {
  g_autofree char *text = g_strdup_printf(FLOW, plain);
  return trial_load(text);
}

static opc_binding *binding_of(const opc_flow *flow, const char *path) {
  opc_error error = {0};
  const opc_binding *b = opc_flow_binding(flow, path, &error);
  if (!b) g_error("%s", error.message);
  return (opc_binding *)b;
}

static void test_create(void) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow = load("12");
  opc_binding *a = binding_of(flow, "a"), *b = binding_of(flow, "b");
  g_assert_true(opc_binding_create(a, NULL, NULL, problems));
  g_assert_true(opc_binding_create(b, NULL, NULL, problems));
  g_assert_cmpuint(problems->list->len, ==, 0);
  /* The host and the parameters are in the instance. */
  g_assert_true(*(const opc_host **)a->module.self == a->host);
  int i = opc_parameter_find(a->plugin, "plain");
  const double *plain =
      (const void *)((char *)a->module.self + a->plugin->parameters[i].offset);
  g_assert_cmpfloat(*plain, ==, 12);
  opc_binding *rule = binding_of(flow, "b.rule");
  g_assert_nonnull(rule->module.self);
  g_assert_true(a->host->service(a->host, OPC_DESCRIPTOR) == a->plugin);
  g_assert_nonnull(a->host->service(a->host, OPC_PIECES));
  g_assert_null(a->host->service(a->host, OPC_INNER));
  g_assert_null(a->host->service(a->host, "opcflow.none/1"));
  g_autoptr(GPtrArray) all = opc_flow_bindings(flow);
  g_assert_cmpuint(all->len, ==, 3);
  g_assert_true(all->pdata[1] == rule && all->pdata[2] == b);
}

/* A check that fails has the place of its parameter and the name of the
   step. */
static void test_check(void) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_flow *flow = load("13");
  g_assert_false(
      opc_binding_create(binding_of(flow, "a"), NULL, NULL, problems));
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpstr(found, ==,
                  "flow.yaml:4:12: step 'a' (test.numbers): 13 is not welcome");
  g_assert_null(guard_inside()); /* the call of the plugin has ended */
  opc_flow_free(flow);
  g_assert_null(guard_inside());
}

static void test_labels(void) {
  g_autoptr(opc_flow) flow = load("1");
  g_autofree char *step = opc_binding_label(binding_of(flow, "a"));
  g_autofree char *slot = opc_binding_label(binding_of(flow, "b.rule"));
  g_assert_cmpstr(step, ==, "step 'a' (test.numbers)");
  g_assert_cmpstr(slot, ==, "'b.rule' (bad.none)");
}

static void test_places(void) {
  g_autoptr(opc_flow) flow = load("1");
  const opc_binding *a = binding_of(flow, "a"), *b = binding_of(flow, "b");
  g_assert_cmpuint(opc_binding_place(a, "plain")->line, ==, 4);
  g_assert_cmpuint(opc_binding_place(a, "size")->line, ==, 3);
  g_assert_cmpuint(opc_binding_place(a, "")->line, ==, 3);
  g_assert_cmpuint(opc_binding_place(a, "none")->line, ==, 3);
  g_assert_cmpuint(opc_binding_place(b, "rule")->line, ==, 6);
  g_assert_cmpuint(opc_binding_place(b, "rule.size")->line, ==, 7);
  g_assert_cmpuint(opc_binding_place(b, "size")->line, ==, 7);
  g_assert_cmpuint(opc_binding_place(b, "rule.none")->line, ==, 6);
  /* A parameter that is not set has the place of the step. */
  int i = opc_parameter_find(a->plugin, "whole");
  g_assert_true(opc_binding_origin(a, (size_t)i) == &a->at);
}

/* Texts of errors of a run name the plugins in the slots. */
static void test_fail(void) {
  static const struct {
    const char *parameter, *message, *text;
    gboolean run;
    int code, expected;
  } all[] = {
      {"rule.size", "too wide",
       "flow.yaml:7:13: step 'b' (test.slotted), rule (bad.none): too wide",
       TRUE, OPC_INVALID, OPC_INVALID},
      {"rule.size", "too wide",
       "flow.yaml:7:13: step 'b' (test.slotted): too wide", FALSE, OPC_IO,
       OPC_IO},
      {"", "", "flow.yaml:5:3: step 'b' (test.slotted): no error message", TRUE,
       42, OPC_FAILED}};
  g_autoptr(opc_flow) flow = load("1");
  const opc_binding *b = binding_of(flow, "b");
  for (size_t i = 0; i < G_N_ELEMENTS(all); i++) {
    g_autoptr(opc_problems) problems = opc_problems_new();
    opc_error error = {0};
    g_strlcpy(error.parameter, all[i].parameter, sizeof error.parameter);
    g_strlcpy(error.message, all[i].message, sizeof error.message);
    g_assert_false(
        opc_binding_fail(b, all[i].run, all[i].code, &error, problems));
    g_autofree char *found = opc_problems_text(problems);
    g_assert_cmpstr(found, ==, all[i].text);
    g_assert_cmpint(opc_problems_code(problems), ==, all[i].expected);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  trial_begin();
  g_test_add_func("/binding/create", test_create);
  g_test_add_func("/binding/check", test_check);
  g_test_add_func("/binding/labels", test_labels);
  g_test_add_func("/binding/places", test_places);
  g_test_add_func("/binding/fail", test_fail);
  return trial_end();
}
