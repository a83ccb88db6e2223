/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of results in the store: which steps and work units run again after
   each change; keys of steps, and texts about their differences. */
#include "core/run/key.h"
#include "core/run/trial_test.h"

#define FLOW                                                            \
  "opcflow: 1\nname: chain\nsteps:\n"                                   \
  "  a: { use: test.numbers, size: 2 nm, input: in.txt, behave: find, " \
  "output: a.txt }\n"                                                   \
  "  b: { use: test.kept, number: 3, add: ${a}, file: b.txt }\n"        \
  "  c: { use: test.kept, number: 6, add: ${b} }\n"                     \
  "  d: { use: test.kept, number: 9, add: ${c} }\n"

/* Return the steps that ran, with the reasons (g_free). */
static char *ran(const trial *t) {
  GString *out = g_string_new(NULL);
  const GPtrArray *list = t->run->out.histories.list;
  for (guint i = 0; i < list->len; i++) {
    const opc_history *h = list->pdata[i];
    if (!h->reused) g_string_append_printf(out, "%s: %s\n", h->path, h->reason);
  }
  return g_string_free(out, FALSE);
}

/* Run a flow with the store. */
static void run_stored(trial *t, const char *text, const char *set) {
  opc_error error = {0};
  g_autoptr(opc_store) store = opc_store_open(&error);
  g_assert_cmpint(error.code, ==, OPC_OK);
  const char *const sets[] = {set, NULL};
  t->options =
      (opc_run_options){.output = "stored", .force = TRUE, .store = store};
  trial_run_good(t, text, sets);
}

static void expect_ran(const char *set, const char *steps) {
  trial t = {0};
  run_stored(&t, FLOW, set);
  g_autofree char *found = ran(&t);
  g_assert_cmpstr(found, ==, steps);
  trial_clear(&t);
}

/* Start with an empty store. */
static void forget(void) {
  opc_remove_tree("store");
  put_text("in.txt", "some input\n");
}

#define NEW                                                      \
  "a: not seen before\nb: not seen before\nc: not seen before\n" \
  "d: not seen before\n"

/* A reused run has the metrics, tables, files and findings of the first run. */
static void test_again(void) {
  forget();
  expect_ran(NULL, NEW);
  trial t = {0};
  run_stored(&t, FLOW, NULL);
  g_assert_cmpuint(t.run->out.histories.done, ==, 4);
  g_assert_cmpuint(t.run->out.histories.reused, ==, 4);
  /* a: 1 + 2 + 3; b: + 3 / 3; c: + 6 / 3; d: + 9 / 3 */
  g_assert_cmpfloat(trial_metric(&t, "a", "sum"), ==, 6);
  g_assert_cmpfloat(trial_metric(&t, "b", "sum"), ==, 7);
  g_assert_cmpfloat(trial_metric(&t, "c", "sum"), ==, 9);
  g_assert_cmpfloat(trial_metric(&t, "d", "sum"), ==, 12);
  g_autofree char *a = get_text("stored", "a.txt");
  g_autofree char *b = get_text("stored", "b.txt");
  g_autofree char *numbers = get_text("stored", "numbers.csv");
  g_assert_cmpstr(a, ==, "numbers\n");
  g_assert_cmpfloat(g_ascii_strtod(b, NULL), ==, 7);
  g_assert_cmpstr(numbers, ==,
                  "name,size (nm),count\r\nplain,6.00,1\r\n"
                  "\"with, comma\",0.00,-2\r\n\"with \"\"quotes\"\"\",,3\r\n");
  g_autofree char *d = get_text("stored", "d.kept.csv");
  g_assert_cmpstr(d, ==, "sum\r\n12\r\n");
  g_assert_nonnull(strstr(t.log->str, "a: 2 nm is odd\n"));
  g_assert_null(strstr(t.log->str, "ran"));
  g_assert_cmpuint(t.run->out.findings.list->len, ==, 1);
  trial_clear(&t);
}

/* After a change, the changed step and the steps that use its output run; the
   output of b is restored. */
static void test_changes(void) {
  forget();
  expect_ran(NULL, NEW);
  expect_ran("c.number=3",
             "a: step 'b' requires the output\n"
             "c: c.number changed from 6 to 3\nd: input d.add changed\n");
  expect_ran(NULL, "");
  expect_ran("b.wait=1", ""); /* OPC_NO_EFFECT */
  put_text("in.txt", "SOME input\n");
  expect_ran(NULL,
             "a: file in.txt (a.input) changed\nb: input b.add changed\n"
             "c: input c.add changed\nd: input d.add changed\n");
}

/* Restored outputs are the stored ones: d continues from the stored c. */
static void test_restored(void) {
  forget();
  expect_ran(NULL, NEW);
  trial t = {0};
  run_stored(&t, FLOW, "d.number=30");
  g_autofree char *found = ran(&t);
  g_assert_cmpstr(found, ==,
                  "a: step 'b' requires the output\n"
                  "d: d.number changed from 9 to 30\n");
  g_assert_nonnull(strstr(t.log->str, "c: restored\n"));
  g_assert_cmpfloat(trial_metric(&t, "d", "sum"), ==, 19);
  trial_clear(&t);
}

/* Nothing of a failed step is stored, nor of a plugin that may return other
   results. */
static void test_not_stored(void) {
  static const char flow[] =
      "opcflow: 1\nsteps:\n  a: { use: test.fickle }\n"
      "  b: { use: test.kept, add: ${a} }\n";
  forget();
  for (int i = 0; i < 2; i++) {
    trial t = {0};
    run_stored(&t, flow, NULL);
    g_autofree char *found = ran(&t);
    g_assert_cmpstr(
        found, ==,
        "a: test.fickle does not promise equal results for equal inputs\n"
        "b: the step uses the output of step 'a', which is not stored\n");
    trial_clear(&t);
  }
}

/* ---- work units ---- */

/* Return the units that ran since the last call, such as "f0 f1 s0"
   (g_free). */
static char *units_done(void) {
  GString *out = g_string_new(NULL);
  g_autofree char *text = get_text(".", "journal");
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
  for (guint i = 0; *lines[i]; i++) {
    g_auto(GStrv) words = g_strsplit(lines[i], " ", -1);
    g_string_append_printf(out, "%c%s ", *words[0], words[1]);
  }
  put_text("journal", "");
  return g_string_free(out, FALSE);
}

/* Return the metric of test.pieces: two lists of `count` units with `size`
   numbers each, without an input. */
static double pieces_sum(int count, int size) {
  double total = 0;
  for (int list = 0; list < 2; list++) {
    double before = total += list, next = total;
    for (int i = 0; i < count; i++) {
      double taken = 0;
      for (int k = 0; k < size; k++) taken += 1 / (1.0 + i + k * 0.37 + before);
      next = next * 0.9 + taken;
    }
    total = next;
  }
  return total;
}

#define PIECES                                                              \
  "opcflow: 1\nsteps:\n  p: { use: test.pieces, count: 4, size: 2, at: 2, " \
  "journal: journal }\n"

/* After a fault in unit 2 of the second list, only the remaining units run. */
static void test_pieces(void) {
  forget();
  put_text("journal", "");
  opc_error error = {0};
  g_autoptr(opc_store) store = opc_store_open(&error);
  const char *const faulty[] = {"p.fault=work", NULL};
  trial t = {.options = {.output = "pieces", .store = store}};
  g_assert_cmpint(trial_run(&t, PIECES, faulty), ==, OPC_FAILED);
  trial_expect(&t,
               "flow.yaml:3:3: step 'p' (test.pieces): second 2: does not "
               "want to");
  trial_clear(&t);
  g_autofree char *first = units_done();
  g_assert_cmpstr(first, ==, "f0 f1 f2 f3 s0 s1 ");
  t.options = (opc_run_options){.output = "pieces", .store = store};
  trial_run_good(&t, PIECES, NULL);
  g_autofree char *second = units_done();
  g_assert_cmpstr(second, ==, "s2 s3 ");
  g_assert_cmpfloat_with_epsilon(trial_metric(&t, "p", "sum"), pieces_sum(4, 2),
                                 1e-12);
  trial_clear(&t);
}

/* Messages of a unit appear once, in the run that computes the unit and in the
   run that reuses the unit. Publication inside a unit is refused. */
static void test_unit_messages(void) {
  forget();
  put_text("journal", "");
  opc_error error = {0};
  g_autoptr(opc_store) store = opc_store_open(&error);
  const char *const publish[] = {"p.fault=publish", NULL};
  const char *const warn[] = {"p.fault=warn", NULL};
  trial t = {.options = {.output = "refused"}};
  g_assert_cmpint(trial_run(&t, PIECES, publish), ==, OPC_FAILED);
  g_autofree char *faults = opc_problems_text(t.problems);
  g_assert_nonnull(strstr(faults, "'sum' is published by a work unit"));
  trial_clear(&t);
  for (int i = 0; i < 2; i++) {
    t.options =
        (opc_run_options){.output = "warned", .force = TRUE, .store = store};
    trial_run_good(&t, PIECES, warn);
    g_auto(GStrv) parts = g_strsplit(t.log->str, "p: piece 2 is odd\n", -1);
    g_assert_cmpuint(g_strv_length(parts), ==, 2);
    g_assert_cmpuint(t.run->out.findings.list->len, ==, 1);
    trial_clear(&t);
  }
}

/* ---- keys ---- */

static void test_difference(void) {
  static const struct {
    char about;
    const char *path, *before, *now, *text;
  } cases[] = {
      {'c', "", "x86", "x86", "opcflow was rebuilt"},
      {'c', "", "x86", "arm", "the processor is different: arm"},
      {'p', "slot", NULL, "new.id", "s.slot is new: new.id"},
      {'p', "slot", "old.id", NULL, "s.slot was removed"},
      {'p', "slot", "old.id", "new.id", "s.slot changed from old.id to new.id"},
      {'p', "", "an.id", "an.id", "plugin an.id was rebuilt"},
      {'f', "file", "x", "x", "file x (s.file) changed"},
      {'f', "file", "x", "y", "s.file changed from x to y"},
      {'f', "file", NULL, "y", "s.file changed from nothing to y"},
      {'f', "file", "x", NULL, "s.file changed from x to nothing"},
      {'v', "size", "1 nm", "2 nm", "s.size changed from 1 nm to 2 nm"},
      {'v', "size", "1 nm", "1 nm",
       "s.size was set or unset, with the same value 1 nm"},
      {'s', "add", "sum", "sum", "input s.add changed"},
      {'i', "", "", "", "the inner flow changed"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *text = opc_key_difference(
        "s", cases[i].about, cases[i].path, cases[i].before, cases[i].now);
    g_assert_cmpstr(text, ==, cases[i].text);
  }
}

/* Return the key of the step `a` of a flow (g_free). */
static char *key_of(const char *step) {
  g_autofree char *text =
      g_strdup_printf("opcflow: 1\nsteps:\n  a: %s\n", step);
  put_text("flow.yaml", text);
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow =
      opc_flow_load("flow.yaml", NULL, trial_registry(), problems);
  g_autofree char *faults = opc_problems_text(problems);
  g_assert_cmpstr(faults, ==, "");
  opc_error error = {0};
  g_autoptr(opc_store) store = opc_store_open(&error);
  opc_key key = {0};
  opc_flow_keys(flow, store, &key);
  char *sum = g_strdup(key.sum);
  if (sum) g_assert_true(opc_key_is_unchanged(&key, store));
  opc_key_clear(&key);
  return sum;
}

/* Equal values in other words have the same key; each of the listed changes has
   its own key. */
static void test_keys(void) {
#define STEP "{ use: test.numbers, size: 2 nm"
  static const char *const equal[] = {
      STEP " }", "{ size: 0.002 um, use: test.numbers }",
      STEP ", list: [0.001 um, 2 nm] }", STEP ", word: second, flag: false }"};
  static const char *const others[] = {
      STEP ", whole: 2 }",
      STEP ", share: 1 % }",
      STEP ", list: [2 nm, 1 nm] }",
      STEP ", list: [] }",
      STEP ", word: third }",
      STEP ", flag: true }",
      STEP ", note: x }",
      STEP ", names: { poly: a, active: b } }",
      STEP ", names: { poly: b, active: a } }",
      STEP ", names: { poly: 'a\" \"b' } }",
      STEP ", input: in.txt }",
      STEP ", output: x }",
      "{ use: test.kept }",
  };
  put_text("in.txt", "some input\n");
  g_autofree char *truth = key_of(equal[0]);
  g_assert_nonnull(truth);
  for (size_t i = 1; i < G_N_ELEMENTS(equal); i++) {
    g_autofree char *key = key_of(equal[i]);
    g_assert_cmpstr(key, ==, truth);
  }
  g_autoptr(GHashTable) seen =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  g_hash_table_add(seen, g_strdup(truth));
  for (size_t i = 0; i < G_N_ELEMENTS(others); i++)
    if (!g_hash_table_add(seen, key_of(others[i])))
      g_error("'%s' has the key of another step", others[i]);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  trial_begin();
  g_autofree char *store = g_build_filename(trial_folder, "store", NULL);
  g_setenv("OPCFLOW_STORE", store, TRUE);
  g_test_add_func("/stored/again", test_again);
  g_test_add_func("/stored/changes", test_changes);
  g_test_add_func("/stored/restored", test_restored);
  g_test_add_func("/stored/not-stored", test_not_stored);
  g_test_add_func("/stored/pieces", test_pieces);
  g_test_add_func("/stored/unit-messages", test_unit_messages);
  g_test_add_func("/stored/difference", test_difference);
  g_test_add_func("/stored/keys", test_keys);
  return trial_end();
}
