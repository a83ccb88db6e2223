/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the axes and points of a sweep, and of the steps that depend on an
   axis. */
#include "core/binding/sweep.h"

#include <string.h>

#include "core/binding/folder_test.h"

/* b depends on a, c on nothing. */
static const char text[] =
    "opcflow: 1\nsteps:\n"
    "  a: { use: test.numbers, size: 2 nm }\n"
    "  b: { use: test.numbers, size: 1 nm, add: ${a} }\n"
    "  c: { use: test.numbers, size: 1 nm }\n"
    "sweep:\n  b.size: [1 nm, 2 nm, 3 nm]\n  c.size: [4 nm, 5 nm]\n";

typedef struct grid {
  opc_problems *problems;
  opc_recipe *recipe;
  opc_sweep *sweep;
} grid;

static grid grid_new(const char *const *sets, const char *const *sweeps) {
  grid g = {.problems = opc_problems_new()};
  put_text("flow.yaml", text);
  g.recipe = opc_recipe_read("flow.yaml", g.problems);
  g.sweep = opc_sweep_new(g.recipe, sets, NULL, sweeps, g.problems);
  return g;
}

static void grid_free(grid *g) {
  opc_sweep_free(g->sweep);
  opc_recipe_free(g->recipe);
  opc_problems_free(g->problems);
}

/* Check the axes, as "path:number of values;", and the number of points. */
static void expect_axes(const grid *g, const char *expected, size_t points) {
  g_autoptr(GString) found = g_string_new(NULL);
  for (guint i = 0; i < g->sweep->axes->len; i++) {
    const opc_axis *axis = g->sweep->axes->pdata[i];
    g_string_append_printf(found, "%s:%u;", axis->info.path, axis->values->len);
  }
  g_autofree char *problems = opc_problems_text(g->problems);
  g_assert_cmpstr(problems, ==, "");
  g_assert_cmpstr(found->str, ==, expected);
  g_assert_cmpuint(g->sweep->points, ==, points);
}

static void test_axes(void) {
  grid g = grid_new(NULL, NULL);
  expect_axes(&g, "b.size:3;c.size:2;", 6);
  grid_free(&g);
  /* --set removes an axis; --sweep replaces one, or adds one. */
  const char *const sets[] = {"b.size=7 nm", NULL};
  g = grid_new(sets, NULL);
  expect_axes(&g, "c.size:2;", 2);
  grid_free(&g);
  const char *const sweeps[] = {"c.size=[1 nm, 2 nm, 3 nm]",
                                "a.size={ from: 1 nm, to: 3 nm, step: 1 nm }",
                                NULL};
  g = grid_new(sets, sweeps);
  expect_axes(&g, "c.size:3;a.size:3;", 9);
  grid_free(&g);
  g_autoptr(opc_sweep) none = opc_sweep_none();
  g_assert_cmpuint(none->points, ==, 1);
}

/* Nested maps are paths; a range is a value, not a path. */
static void test_laid_over(void) {
  static const opc_source source = {.name = (char *)"over"};
  static const char over[] =
      "{ c.size: [9 nm], a: { size: { from: 1 nm, to: 2 nm, step: 1 nm }, "
      "whole: [1, 2, 3] } }";
  grid g = grid_new(NULL, NULL);
  g_autoptr(opc_node) map =
      opc_node_parse(&source, over, strlen(over), g.problems);
  opc_sweep_lay_over(g.sweep, map, g.problems);
  expect_axes(&g, "b.size:3;c.size:1;a.size:2;a.whole:3;", 18);
  grid_free(&g);
}

/* The last axis varies fastest. */
static void test_points(void) {
  grid g = grid_new(NULL, NULL);
  for (size_t point = 0; point < 6; point++) {
    g_assert_cmpuint(opc_sweep_index(g.sweep, 0, point), ==, point / 2);
    g_assert_cmpuint(opc_sweep_index(g.sweep, 1, point), ==, point % 2);
  }
  g_assert_cmpuint(opc_sweep_point(g.sweep, 0, 2), ==, 4);
  g_assert_cmpuint(opc_sweep_point(g.sweep, 1, 1), ==, 1);
  grid_free(&g);
}

/* Steps run again if an axis changes them or one of their inputs. */
static void test_levels(void) {
  const char *const sets[] = {"b.size=1 nm", "c.size=1 nm", NULL};
  const char *const sweeps[] = {"a.size=[1 nm, 2 nm]", NULL};
  grid g = grid_new(sets, sweeps);
  const opc_axis *axis = g.sweep->axes->pdata[0];
  g_assert_true(opc_axis_touches(axis, g.recipe, "a"));
  g_assert_false(opc_axis_touches(axis, g.recipe, "b"));
  g_assert_false(opc_axis_touches(axis, g.recipe, "aa"));
  g_assert_cmpuint(opc_sweep_depth(g.sweep), ==, 1);
  const opc_choice choice = {.sweep = g.sweep, .sets = sets};
  opc_flow *flow =
      opc_flow_make(g.recipe, &choice, trial_registry(), g.problems);
  expect_axes(&g, "a.size:2;", 2);
  g_autofree unsigned *levels = opc_sweep_levels(g.sweep, flow);
  static const unsigned expected[] = {1, 1, 0};
  for (guint i = 0; i < flow->steps->len; i++) {
    const opc_flow_step *step = flow->steps->pdata[i];
    g_assert_cmpuint(levels[step->number], ==, expected[*step->name - 'a']);
  }
  g_assert_cmpuint(flow->steps->len, ==, 3);
  opc_flow_free(flow);
  grid_free(&g);
}

static void expect_fault(const char *sweep, const char *fault) {
  const char *const sweeps[] = {sweep, NULL};
  grid g = grid_new(NULL, sweeps);
  g_autofree char *found = opc_problems_text(g.problems);
  if (!strstr(found, fault)) g_error("'%s' is not in '%s'", fault, found);
  g_assert_cmpuint(g.sweep->axes->len, ==,
                   2 + (strstr(sweep, "whole") != NULL));
  grid_free(&g);
}

static void test_faults(void) {
  expect_fault("a.size", "--sweep");
  expect_fault("a.size=3 nm", "a sweep must be a list of values");
  expect_fault("a.size=[]", "a sweep must be a list of values");
  expect_fault("a.whole={ from: 1, to: 90000, step: 1 }",
               "the sweep has 540000 points, expected at most ");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  trial_begin();
  g_test_add_func("/sweep/axes", test_axes);
  g_test_add_func("/sweep/laid-over", test_laid_over);
  g_test_add_func("/sweep/points", test_points);
  g_test_add_func("/sweep/levels", test_levels);
  g_test_add_func("/sweep/faults", test_faults);
  return trial_end();
}
