/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of changes applied to a flow: extending flows, variants, sweeps, --set,
   and parameters of a default plugin. */
#include <base/layers.h>
#include <glib/gstdio.h>
#include <store/files.h>
#include <string.h>

#include "core/binding/flow.h"
#include "core/binding/resolve.h"
#include "core/plugin/declaration.h"

/* ---- help ---- */

static opc_registry *registry(void) {
  static opc_registry *all;
  if (!all) {
    g_autofree char *plugins =
        g_build_filename(g_getenv("OPCFLOW_BUILD"), "tests", NULL);
    const char *folders[] = {plugins, NULL};
    all = opc_registry_new(folders);
  }
  return all;
}

static void write_file(const char *name, const char *text) {
  g_autofree char *folder = g_path_get_dirname(name);
  g_assert_cmpint(g_mkdir_with_parents(folder, 0777), ==, 0);
  g_assert_true(g_file_set_contents(name, text, -1, NULL));
}

/* A valid flow at a point of the sweep, with a variant or, if the name is "",
   without one. */
typedef struct made {
  opc_recipe *recipe;
  opc_sweep *sweep;
  opc_flow *flow;
} made;

static made layers_make(const char *path, const char *variant, size_t point,
                        const char *const *sets) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  made m = {.recipe = opc_recipe_read(path, problems)};
  g_autofree char *faults = opc_problems_text(problems);
  g_assert_cmpstr(faults, ==, "");
  m.sweep = opc_sweep_new(m.recipe, sets, NULL, NULL, problems);
  opc_choice choice = {.sweep = m.sweep, .point = point, .sets = sets};
  if (*variant && opc_recipe_has(m.recipe, variant, NULL, problems))
    choice.variant = variant;
  m.flow = opc_flow_make(m.recipe, &choice, registry(), problems);
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpstr(found, ==, "");
  return m;
}

static void made_free(made *m) {
  opc_flow_free(m->flow);
  opc_sweep_free(m->sweep);
  opc_recipe_free(m->recipe);
}

static const opc_binding *step_of(const opc_flow *flow, const char *name) {
  for (guint i = 0; i < flow->steps->len; i++) {
    const opc_flow_step *step = flow->steps->pdata[i];
    if (!strcmp(step->name, name)) return step->binding;
  }
  return NULL;
}

static const opc_setting *value_of(const opc_binding *b, const char *name) {
  int i = opc_parameter_find(b->plugin, name);
  g_assert_cmpint(i, >=, 0);
  return &b->values[i];
}

static double real_of(const made *m, const char *step, const char *name) {
  return value_of(step_of(m->flow, step), name)->field.real;
}

/* Check all problems that `check` reports of a flow and its variants. */
static void check_faults(const char *path, const char *expected) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_recipe) recipe = opc_recipe_read(path, problems);
  if (recipe) {
    g_autoptr(opc_sweep) sweep =
        opc_sweep_new(recipe, NULL, NULL, NULL, problems);
    opc_choice choice = {.sweep = sweep};
    opc_flow_check(recipe, &choice, registry(), NULL, problems);
    for (guint i = 0; i < recipe->variants->keys->len; i++) {
      choice.variant = opc_node_key(recipe->variants, i);
      opc_flow_check(recipe, &choice, registry(), NULL, problems);
    }
  }
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpstr(found, ==, expected);
}

static void check_text(const char *text, const char *expected) {
  write_file("flow.yaml", text);
  check_faults("flow.yaml", expected);
}

#define STEP "opcflow: 1\nsteps:\n  a: { use: test.numbers, size: 1 nm }\n"

/* ---- extends ---- */

static void test_extends(void) {
  write_file("far/in.txt", "x");
  write_file("far/base.yaml",
             "opcflow: 1\nname: base\nsteps:\n"
             "  a: { use: test.numbers, size: 1 nm, share: 2 %, input: in.txt, "
             "names: { poly: 1/0, active: 2/0 } }\n"
             "  b: { use: test.numbers, size: 5 nm, add: ${a} }\n"
             "  c: { use: test.numbers, size: 7 nm, note: gone }\n");
  write_file("middle.yaml",
             "opcflow: 1\nextends: far/base.yaml\nsteps:\n"
             "  a: { size: 2 nm, names: { active: 3/0 }, anchor: { line: 66 nm "
             "} }\n");
  write_file("top.yaml",
             "opcflow: 1\nextends: middle.yaml\nsteps:\n"
             "  a: { share: ~ }\n  b: ~\n  c: { use: test.slotted }\n"
             "  d: { use: test.numbers, size: 9 nm, add: ${a} }\n");
  made m = layers_make("top.yaml", "", 0, NULL);
  g_assert_cmpstr(m.flow->name, ==, "top");
  g_assert_true(real_of(&m, "a", "size") == 2);
  g_assert_true(real_of(&m, "a", "share") == 0.5); /* the default again */
  g_assert_true(real_of(&m, "a", "anchor.line") == 66);
  const opc_setting *names = value_of(step_of(m.flow, "a"), "names");
  g_assert_cmpuint(names->field.map.count, ==, 2);
  g_assert_cmpstr(names->field.map.pairs[0].value, ==, "1/0");
  g_assert_cmpstr(names->field.map.pairs[1].value, ==, "3/0");
  g_assert_cmpstr(value_of(step_of(m.flow, "a"), "input")->field.text, ==,
                  "far/in.txt");
  g_assert_null(step_of(m.flow, "b"));
  g_assert_cmpstr(step_of(m.flow, "c")->plugin->id, ==, "test.slotted");
  g_autofree char *text = opc_flow_resolved(m.flow, NULL);
  g_assert_nonnull(strstr(text, "# middle.yaml:4:14\n"));
  g_assert_nonnull(strstr(text, "# far/base.yaml:4:58\n"));
  made_free(&m);
}

static void test_chains(void) {
  write_file("one.yaml", "opcflow: 1\nextends: deep/two.yaml\n");
  write_file("deep/two.yaml", "opcflow: 1\nextends: ../deep/../one.yaml\n");
  check_faults("one.yaml",
               "deep/two.yaml:2:10: flows extend each other in a cycle: "
               "one.yaml -> deep/two.yaml -> one.yaml");
  check_text("opcflow: 1\nextends: none.yaml\n",
             "flow.yaml:2:10: 'none.yaml': no such file");
  check_text("opcflow: 1\nextends: [a]\n",
             "flow.yaml:2:10: 'extends' must be the name of a flow file");
  write_file("bad.yaml", "opcflow: 1\nsteps:\n  a: { use: test.numbers }\n");
  check_text("opcflow: 1\nextends: bad.yaml\nsteps:\n  a: { shaer: 1 % }\n",
             "flow.yaml:4:8: unknown parameter 'shaer' of 'test.numbers', did "
             "you mean 'share'?\n"
             "bad.yaml:3:3: required parameter 'size' of "
             "'test.numbers' is missing");
  for (int i = 0; i < 20; i++) {
    g_autofree char *name = g_strdup_printf("chain%d.yaml", i);
    g_autofree char *text =
        g_strdup_printf("opcflow: 1\nextends: chain%d.yaml\n", i + 1);
    write_file(name, text);
  }
  check_faults("chain0.yaml",
               "chain15.yaml:2:10: more than 16 files in a chain of 'extends'");
}

static void test_removing(void) {
  write_file("base.yaml", STEP);
  check_text(
      "opcflow: 1\nextends: base.yaml\nsteps:\n  ax: ~\n"
      "  a: { siez: ~ }\n  ab: { size: 2 nm }\n",
      "flow.yaml:4:3: cannot remove 'ax', which does not "
      "exist\n"
      "flow.yaml:5:8: cannot remove 'siez', which does not exist, "
      "did you mean 'size'?\n"
      "flow.yaml:6:3: unknown step 'ab'");
  check_text("opcflow: 1\nextends: base.yaml\nsteps:\n  a: ~\n",
             "base.yaml:3:3: the flow has no steps");
  /* A quoted '~' is a text and removes nothing. */
  check_text(STEP "  b: { use: test.numbers, size: 1 nm, note: '~' }\n", "");
}

/* ---- variants ---- */

static const char variants[] = STEP
    "  b: { use: test.numbers, size: 5 nm, whole: 9, add: ${a} }\n"
    "variants:\n"
    "  dotted: { a.size: 2 nm, a.anchor.line: 70 nm }\n"
    "  nested: { a: { size: 3 nm, anchor: { pitch: 300 nm } }, b: ~ }\n"
    "  other: { b: { use: test.slotted }, b.rule.size: 61 nm }\n";

static void test_variants(void) {
  write_file("flow.yaml", variants);
  check_faults("flow.yaml", "");
  made m = layers_make("flow.yaml", "dotted", 0, NULL);
  g_assert_cmpstr(m.flow->name, ==, "flow-dotted");
  g_assert_true(real_of(&m, "a", "size") == 2);
  g_assert_true(real_of(&m, "a", "anchor.line") == 70);
  g_assert_true(real_of(&m, "b", "size") == 5);
  g_autofree char *text = opc_flow_resolved(m.flow, NULL);
  g_assert_nonnull(strstr(text, "# variant dotted, flow.yaml:6:21\n"));
  made_free(&m);
  const char *const sets[] = {"a.size=8 nm", NULL};
  m = layers_make("flow.yaml", "nested", 0, sets);
  g_assert_true(real_of(&m, "a", "size") == 8); /* --set overrides */
  g_assert_true(real_of(&m, "a", "anchor.pitch") == 300);
  g_assert_null(step_of(m.flow, "b"));
  made_free(&m);
  m = layers_make("flow.yaml", "other", 0, NULL);
  const opc_binding *rule = step_of(m.flow, "b")->slots[0];
  g_assert_true(value_of(rule, "size")->field.real == 61);
  made_free(&m);
}

/* A variant of the base flow, and a variant with the same name in the extending
   flow. */
static void test_inherited(void) {
  write_file("base.yaml", variants);
  write_file("flow.yaml",
             "opcflow: 1\nextends: base.yaml\nsteps:\n  a: { whole: 4 }\n"
             "variants:\n  dotted: { a.size: 6 nm }\n  other: ~\n");
  made m = layers_make("flow.yaml", "dotted", 0, NULL);
  g_assert_true(real_of(&m, "a", "size") == 6);
  g_assert_true(real_of(&m, "a", "anchor.line") == 70);
  g_assert_cmpint(value_of(step_of(m.flow, "a"), "whole")->field.integer, ==,
                  4);
  g_assert_cmpuint(m.recipe->variants->keys->len, ==, 2);
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_assert_false(opc_recipe_has(m.recipe, "netsed", NULL, problems));
  g_autofree char *found = opc_problems_text(problems);
  g_assert_cmpstr(found, ==,
                  "flow.yaml: unknown variant 'netsed', did you mean "
                  "'nested'?");
  made_free(&m);
}

static void test_wrong_variants(void) {
  check_text(
      STEP
      "variants:\n"
      "  x: { a.siez: 1 nm }\n"
      "  y: { aa.size: 1 nm }\n"
      "  z: { a.size: ~ }\n"
      "  all: {}\n"
      "  w: [1]\n"
      "  v: { a..b: 1 }\n",
      "flow.yaml:3:3: required parameter 'size' of 'test.numbers' is missing "
      "(variant 'z')\n"
      "flow.yaml:5:8: unknown parameter 'siez' of "
      "'test.numbers', did you mean 'size'? (variant 'x')\n"
      "flow.yaml:6:8: "
      "unknown step 'aa' (variant 'y')\n"
      "flow.yaml:8:3: the name of a variant "
      "must consist of letters, digits, '_' and '-' and must not be 'all' or "
      "'base', found 'all'\n"
      "flow.yaml:9:6: variant 'w' must be a map of at "
      "most 1000 parameters\n"
      "flow.yaml:10:8: 'a..b' is not a path, expected "
      "'step.parameter' (variant 'v')");
  /* A problem independent of the variant is reported once. */
  check_text(
      "opcflow: 1\nsteps:\n  a: { use: test.numbers, size: 1 V }\n"
      "variants: { x: { a.whole: 2 }, y: { a.whole: 3 } }\n",
      "flow.yaml:3:33: 'size' requires a length, found '1 V'");
}

/* ---- sweeps ---- */

static void test_grid(void) {
  write_file("flow.yaml", STEP
             "sweep:\n  a.size: [2 nm, 3 nm]\n"
             "  a.share: { from: 0.1 %, to: 0.3 %, step: 0.1 % }\n");
  static const double expected[6][2] = {{2, 0.1}, {2, 0.2}, {2, 0.3},
                                        {3, 0.1}, {3, 0.2}, {3, 0.3}};
  for (size_t i = 0; i < 6; i++) {
    made m = layers_make("flow.yaml", "", i, NULL);
    g_assert_cmpuint(m.sweep->points, ==, 6);
    g_assert_true(real_of(&m, "a", "size") == expected[i][0]);
    g_assert_true(real_of(&m, "a", "share") == expected[i][1]);
    made_free(&m);
  }
  /* A parameter that --set fixes is not swept. */
  const char *const sets[] = {"a.size=4 nm", NULL};
  made m = layers_make("flow.yaml", "", 2, sets);
  g_assert_cmpuint(m.sweep->points, ==, 3);
  g_assert_true(real_of(&m, "a", "size") == 4);
  g_assert_true(real_of(&m, "a", "share") == 0.3);
  g_autofree char *text = opc_flow_resolved(m.flow, NULL);
  g_assert_nonnull(strstr(text, "# sweep, flow.yaml:6:12\n"));
  made_free(&m);
}

static void test_ranges(void) {
  write_file("flow.yaml", STEP
             "sweep: { a.size: { from: 20 nm, to: 0.008 um, step: -4 nm } "
             "}\n");
  made m = layers_make("flow.yaml", "", 3, NULL);
  g_assert_cmpuint(m.sweep->points, ==, 4);
  g_assert_true(real_of(&m, "a", "size") == 8);
  made_free(&m);
  check_text(STEP
             "sweep:\n"
             "  a.size: { from: 1 nm, to: 5 nm, step: -1 nm }\n"
             "  a.whole: { from: 1, to: 5, stpe: 1 }\n"
             "  a.share: { from: 1 %, to: 5 nm, step: 1 % }\n"
             "  a.plain: { from: 1, to: 2e6, step: 1 }\n"
             "  a.note: word\n"
             "  a: [1]\n"
             "  a.anchor.line: { from: 1 nn, to: 2 nm, step: 1 nm }\n"
             "  a.anchor.pitch: { from: 1 nm, to: 2 nm, step: 0.3 nm }\n",
             "flow.yaml:5:41: 'step' does not lead from '1 nm' to '5 "
             "nm'\n"
             "flow.yaml:6:12: a range must be '{ from: A, to: B, step: C "
             "}'\n"
             "flow.yaml:6:30: unknown key 'stpe' of a range, did you mean "
             "'step'?\n"
             "flow.yaml:7:29: 'to' must be of the same dimension as 'from', "
             "found '5 nm'\n"
             "flow.yaml:8:12: the range has 2000000 values, expected at "
             "most 100000\n"
             "flow.yaml:9:11: a sweep must be a list of values, or '{ "
             "from: A, to: B, step: C }'\n"
             "flow.yaml:10:3: 'a' is a step, but a sweep "
             "requires 'step.parameter'\n"
             "flow.yaml:11:26: unknown unit 'nn' in '1 "
             "nn', did you mean 'nm'?\n"
             "flow.yaml:12:49: 'step' does not lead from '1 "
             "nm' to '2 nm', but to 1.9 nm");
  check_text(
      STEP
      "sweep:\n"
      "  a.plain: { from: 1, to: 1000, step: 1 }\n"
      "  a.share: { from: 1 %, to: 1000 %, step: 1 % }\n",
      "flow.yaml:5:3: the sweep has 1000000 points, expected at most 100000");
  /* Each value is checked. */
  check_text(STEP "sweep: { a.size: [1 nm, 2 nm, 3 V], a.plain: [1, x] }\n",
             "flow.yaml:4:31: 'size' requires a length, found '3 V'\n"
             "flow.yaml:4:50: 'plain' requires a number, found 'x'");
}

/* ---- keys with dots ---- */

/* Dotted paths to groups and slots, in every layer, applied before and after
   nested maps. */
static void test_dots(void) {
  write_file("base.yaml",
             "opcflow: 1\nsteps:\n"
             "  a: { use: test.numbers, size: 1 nm, anchor.line: 60 nm, "
             "names.poly: 1/0 }\n"
             "  b: { use: test.numbers, size: 1 nm, anchor: { line: 61 nm, "
             "pitch: 201 nm } }\n"
             "  s: { use: test.slotted, rule.size: 30 nm }\n");
  write_file("flow.yaml",
             "opcflow: 1\nextends: base.yaml\nsteps:\n"
             "  a: { anchor: { pitch: 202 nm } }\n"
             "  b: { anchor.pitch: 203 nm, anchor.line: ~ }\n"
             "variants: { x: { a: { anchor.line: 62 nm }, s: { rule: { "
             "size: 31 nm } } } }\n");
  made m = layers_make("flow.yaml", "", 0, NULL);
  g_assert_true(real_of(&m, "a", "anchor.line") == 60);
  g_assert_true(real_of(&m, "a", "anchor.pitch") == 202);
  g_assert_true(real_of(&m, "b", "anchor.line") == 65); /* the default */
  g_assert_true(real_of(&m, "b", "anchor.pitch") == 203);
  g_assert_cmpstr(value_of(step_of(m.flow, "a"), "names")->field.map.pairs->key,
                  ==, "poly");
  const opc_binding *model = step_of(m.flow, "s")->slots[0];
  g_assert_true(value_of(model, "size")->field.real == 30);
  g_autofree char *text = opc_flow_resolved(m.flow, NULL);
  g_assert_nonnull(strstr(text, "# base.yaml:3:52\n"));
  made_free(&m);
  const char *const sets[] = {"a.anchor.line=63 nm", NULL};
  m = layers_make("flow.yaml", "x", 0, sets);
  g_assert_true(real_of(&m, "a", "anchor.line") == 63);
  g_assert_true(real_of(&m, "a", "anchor.pitch") == 202);
  model = step_of(m.flow, "s")->slots[0];
  g_assert_true(value_of(model, "size")->field.real == 31);
  made_free(&m);
}

static void test_wrong_dots(void) {
  check_text(
      "opcflow: 1\nsteps:\n"
      "  a: { use: test.numbers, size: 1 nm, anchor: { line: 60 nm },\n"
      "       anchor.line: 61 nm }\n"
      "  b: { use: test.numbers, size: 1 nm, anchor.lien: 61 nm }\n"
      "  c: { use: test.numbers, size: 1 nm, size.line: 61 nm }\n",
      "flow.yaml:4:8: 'anchor.line' is given here and at "
      "flow.yaml:3:49\n"
      "flow.yaml:5:39: unknown parameter 'anchor.lien' of "
      "'test.numbers', did you mean 'anchor.line'?\n"
      "flow.yaml:6:39: 'size.line' is given here and at flow.yaml:6:27");
}

static void test_byte_order_mark(void) {
  check_text("\xEF\xBB\xBF" STEP, "");
  check_text(
      "\xEF\xBB\xBF"
      "opcflow: 2\nsteps: {}\n",
      "flow.yaml:1:10: 'opcflow' must be 1, the version of the "
      "format\n"
      "flow.yaml:2:8: 'steps' must be a map of steps");
  check_text("\xEF\xBB\xBF", "flow.yaml:1:1: the file is empty");
}

/* ---- slots with a default ---- */

static void test_default_slot(void) {
  write_file("flow.yaml", "opcflow: 1\nsteps:\n  s: { use: test.slotted }\n");
  made m = layers_make("flow.yaml", "", 0, NULL);
  g_assert_true(value_of(step_of(m.flow, "s")->slots[0], "size")->field.real ==
                60);
  g_autofree char *text = opc_flow_resolved(m.flow, NULL);
  g_assert_nonnull(
      strstr(text, "      size: 60 nm                           # default\n"));
  made_free(&m);
  const char *const sets[] = {"s.rule.size=64 nm", NULL};
  m = layers_make("flow.yaml", "", 0, sets);
  g_assert_true(value_of(step_of(m.flow, "s")->slots[0], "size")->field.real ==
                64);
  made_free(&m);
  /* A `use`, even of the same plugin, discards the earlier parameters. */
  const char *const uses[] = {"s.rule.use=bad.none", NULL};
  m = layers_make("flow.yaml", "", 0, uses);
  g_assert_true(value_of(step_of(m.flow, "s")->slots[0], "size")->field.real ==
                65);
  made_free(&m);
  check_text(
      "opcflow: 1\nsteps:\n  s: { use: test.slotted, rule: { siez: 1 nm "
      "} }\n",
      "flow.yaml:3:35: unknown parameter 'siez' of 'bad.none', did you "
      "mean 'size'?");
}

/* ---- --set ---- */

static void test_sets(void) {
  write_file("flow.yaml", variants);
  const char *const sets[] = {"b=~", "a.use=test.slotted",
                              "a.rule={ size: 63 nm }", NULL};
  made m = layers_make("flow.yaml", "", 0, sets);
  g_assert_null(step_of(m.flow, "b"));
  const opc_binding *a = step_of(m.flow, "a");
  g_assert_true(value_of(a->slots[0], "size")->field.real == 63);
  made_free(&m);
}

/* The resolved flow at a point of a variant resolves to itself. */
static void test_again(void) {
  write_file("base.yaml", variants);
  write_file("flow.yaml",
             "opcflow: 1\nextends: base.yaml\n"
             "sweep: { a.share: [1 %, 2 %] }\n");
  const char *const sets[] = {"b.note=yes", NULL};
  made m = layers_make("flow.yaml", "dotted", 1, sets);
  g_autofree char *text = opc_flow_resolved(m.flow, NULL);
  write_file("other/again.yaml", text);
  made n = layers_make("other/again.yaml", "", 0, NULL);
  g_assert_cmpuint(n.sweep->points, ==, 1);
  g_autofree char *second = opc_flow_resolved(n.flow, NULL);
  g_autoptr(GRegex) comment = g_regex_new(" +#.*", 0, 0, NULL);
  g_autofree char *bare =
      g_regex_replace_literal(comment, text, -1, 0, "", 0, NULL);
  g_autofree char *bare_second =
      g_regex_replace_literal(comment, second, -1, 0, "", 0, NULL);
  g_assert_cmpstr(bare, ==, bare_second);
  g_assert_nonnull(strstr(bare, "share: 2 %\n"));
  g_assert_nonnull(strstr(text, "# --set b.note\n"));
  /* A given value that equals the default counts as not given. */
  g_assert_cmpuint(value_of(step_of(n.flow, "a"), "plain")->given, ==, 0);
  g_assert_cmpuint(value_of(step_of(n.flow, "a"), "list")->given, ==, 0);
  g_assert_cmpuint(value_of(step_of(n.flow, "a"), "share")->given, ==, 1);
  made_free(&n);
  made_free(&m);
}

/* ---- bounds ---- */

static void test_bounds(void) {
  g_autofree char *long_text = g_strnfill(65537, 'x');
  g_autofree char *text = g_strdup_printf(STEP "  b: { use: %s }\n", long_text);
  check_text(text, "flow.yaml:4:13: a text of more than 65536 bytes");
  GString *many = g_string_new("opcflow: 1\nsteps:\n");
  for (int i = 0; i < 1001; i++)
    g_string_append_printf(many, "  s%d: { use: test.slotted }\n", i);
  check_text(many->str, "flow.yaml:3:3: more than 1000 steps");
  g_string_assign(many, STEP "variants: { v: { a");
  for (int i = 0; i < 64; i++) g_string_append(many, ".b");
  g_string_append(many, ": 1 } }\n");
  write_file("flow.yaml", many->str);
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_recipe) recipe = opc_recipe_read("flow.yaml", problems);
  const opc_choice choice = {.variant = opc_node_key(recipe->variants, 0)};
  opc_flow_check(recipe, &choice, registry(), NULL, problems);
  g_autofree char *found = opc_problems_text(problems);
  g_assert_nonnull(strstr(found, "is deeper than 64"));
  /* The number of reported problems is limited. */
  g_string_assign(many, "opcflow: 1\nsteps:\n  a:\n");
  for (int i = 0; i < 2000; i++)
    g_string_append_printf(many, "    p%d: 1\n", i);
  g_string_append(many, "    use: test.numbers\n    size: 1 nm\n");
  write_file("flow.yaml", many->str);
  g_autoptr(opc_problems) lots = opc_problems_new();
  g_autoptr(opc_flow) flow = opc_flow_load("flow.yaml", NULL, registry(), lots);
  g_assert_cmpuint(lots->list->len, ==, 1000);
  check_text("opcflow: 1\nname: \"\x07\"\n",
             "flow.yaml:2:8: not YAML: the character U+0007");
  g_string_free(many, TRUE);
}

/* The first 999 values of an axis and the last value are checked. */
static void test_long_axis(void) {
  static const struct {
    int at; /* index of the value that is no length, of 1010 */
    const char *problem;
  } cases[] = {{998, "'y'"}, {999, NULL}, {1008, NULL}, {1009, "'y'"}};
  for (size_t k = 0; k < G_N_ELEMENTS(cases); k++) {
    g_autoptr(GString) text = g_string_new(STEP "sweep:\n  a.size: [");
    for (int i = 0; i < 1010; i++)
      g_string_append(text, i == cases[k].at ? "y, " : "2 nm, ");
    g_string_append(text, "]\n");
    write_file("flow.yaml", text->str);
    g_autoptr(opc_problems) problems = opc_problems_new();
    g_autoptr(opc_recipe) recipe = opc_recipe_read("flow.yaml", problems);
    g_assert_nonnull(recipe);
    g_autoptr(opc_sweep) sweep =
        opc_sweep_new(recipe, NULL, NULL, NULL, problems);
    const opc_choice choice = {.sweep = sweep};
    opc_flow_check(recipe, &choice, registry(), NULL, problems);
    g_assert_cmpuint(problems->list->len, ==, cases[k].problem ? 1 : 0);
    g_autofree char *found = opc_problems_text(problems);
    if (cases[k].problem) g_assert_nonnull(strstr(found, cases[k].problem));
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_autofree char *folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_assert_cmpint(g_chdir(folder), ==, 0);
  g_test_add_func("/layers/extends", test_extends);
  g_test_add_func("/layers/chains", test_chains);
  g_test_add_func("/layers/removing", test_removing);
  g_test_add_func("/layers/variants", test_variants);
  g_test_add_func("/layers/long-axis", test_long_axis);
  g_test_add_func("/layers/inherited", test_inherited);
  g_test_add_func("/layers/wrong-variants", test_wrong_variants);
  g_test_add_func("/layers/grid", test_grid);
  g_test_add_func("/layers/ranges", test_ranges);
  g_test_add_func("/layers/dots", test_dots);
  g_test_add_func("/layers/wrong-dots", test_wrong_dots);
  g_test_add_func("/layers/byte-order-mark", test_byte_order_mark);
  g_test_add_func("/layers/default-slot", test_default_slot);
  g_test_add_func("/layers/sets", test_sets);
  g_test_add_func("/layers/again", test_again);
  g_test_add_func("/layers/bounds", test_bounds);
  int failed = g_test_run();
  g_assert_cmpint(g_chdir("/"), ==, 0);
  opc_remove_tree(folder);
  opc_registry_free(registry());
  return failed;
}
