/* SPDX-License-Identifier: BSD-3-Clause */
/* Plugins that damage the process in which they run. For each fault and each
   function, the command must name the plugin, keep the written files, and end
   with its documented exit code. No run with a fault may succeed or hang. */
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>

#include "tests/command.h"

/* ---- help ---- */

/* Run opcflow with words separated by spaces, for at most 20 s, with the fault
   `how` in the function `when` of the plugins; return the exit code. */
static int call_while(const char *line, const char *when, const char *how) {
  g_auto(GStrv) words = g_strsplit(line, " ", -1);
  g_autoptr(GPtrArray) argv = g_ptr_array_new();
  g_setenv("BAD_WHEN", when, TRUE);
  g_setenv("BAD_HOW", how, TRUE);
  g_ptr_array_add(argv, (char *)"timeout");
  g_ptr_array_add(argv, (char *)"--signal=KILL");
  g_ptr_array_add(argv, (char *)"20");
  g_ptr_array_add(argv, command);
  for (guint i = 0; words[i]; i++) g_ptr_array_add(argv, words[i]);
  g_ptr_array_add(argv, NULL);
  return program_spawn((const char *const *)argv->pdata);
}

/* Write a correction flow in which the plugin bad.KIND has the fault of the
   environment. */
static void write_correction(const char *kind) {
  static const char *const slots[] = {"litho", "resist", "extractor",
                                      "synthesizer", "regulator"};
  g_autoptr(GString) text = g_string_new("opcflow: 1\nsteps:\n");
  g_string_append_printf(
      text,
      "  layout:\n"
      "    { use: read.cif, file: %s/data/cells65/nand2.cif,\n"
      "      layers: { poly: CP, active: CA, contact: CC, nwell: CW } }\n"
      "  gates: { use: segment.transistors, layout: ${layout}, grid: 1 nm }\n"
      "  kept: { use: test.numbers, size: 1 nm }\n"
      "  mask:\n    use: correct\n    gates: ${gates}\n    margin: 3 um\n"
      "    min_space: 40 nm\n    min_mask_width: 40 nm\n    min_edge: 20 nm\n",
      g_getenv("OPCFLOW_SOURCE"));
  for (size_t i = 0; i < G_N_ELEMENTS(slots); i++)
    g_string_append_printf(text, "    %s: { use: bad.%s%s }\n", slots[i],
                           slots[i], strcmp(kind, slots[i]) ? "_none" : "");
  write_text("bad.yaml", text->str);
}

/* ---- faults ---- */

static const char ended[] = "plugin '%s' ended the process\n",
                  numbers[] =
                      "plugin '%s' changed the floating-point rounding, "
                      "flush-to-zero or trap mode\n";

/* A fault with the expected message; '%s' is the name of the plugin. */
typedef struct misuse {
  const char *how, *say;
} misuse;

static const misuse misuses[] = {
    {"exit", ended},
    {"quick_exit", ended},
    {"_exit", ended},
    {"_Exit", ended},
    {"thread_exit", ended},
    {"pthread_exit", "plugin '%s' ended the thread\n"},
    {"abort", "crashed in plugin '%s': aborted\n"},
    {"trap", "crashed in plugin '%s': trap\n"},
    {"segv", "crashed in plugin '%s': segmentation fault\n"},
    {"usr1", "crashed in plugin '%s': user signal 1\n"},
    {"pipe", "crashed in plugin '%s': broken pipe\n"},
    {"alarm", "crashed in plugin '%s': alarm\n"},
    {"profile", "crashed in plugin '%s': alarm\n"},
    {"timer", "plugin '%s' left an alarm set\n"},
    {"thread", "crashed in plugin '%s': segmentation fault\n"},
    {"overflow", "crashed in plugin '%s': segmentation fault\n"},
    {"handler", "plugin '%s' changed the handler of SIGSEGV\n"},
    {"deaf", "plugin '%s' changed the handler of SIGTERM\n"},
    {"block", "plugin '%s' changed the signal mask\n"},
    {"chdir", "plugin '%s' changed the working folder\n"},
    {"rounding", numbers},
    {"unmask", numbers},
#if defined(__x86_64__)
    {"flush", numbers},
#endif
    {"locale", "plugin '%s' changed the locale\n"},
    {"uselocale", "plugin '%s' changed the locale\n"},
    {"umask", "plugin '%s' changed the modes of new files\n"},
    {"stdin", "plugin '%s' closed or redirected standard input\n"},
    {"stdout", "plugin '%s' closed or redirected standard output\n"},
    {"stderr", "plugin '%s' closed or redirected standard error\n"},
    {"close", ""}, /* the message has no open stream left */
    {"fork", ended},
    {"execve", ended},
    {"execl", ended},
};

static void assert_exit(int got, int want, const char *id, const char *say) {
  char **parts = g_strsplit(say, "%s", -1);
  g_autofree char *text = g_strjoinv(id, parts);
  g_strfreev(parts);
  g_test_message("%s: %d, %s", g_getenv("BAD_HOW"), got, err);
  if (got != want || !strstr(err, text))
    g_error("%s in %s of %s: exit code %d, want %d; '%s' is not in:\n%s",
            g_getenv("BAD_HOW"), g_getenv("BAD_WHEN"), id, got, want, text,
            err);
}

/* Check that the output of the previous step is kept. */
static void expect_kept(void) {
  g_assert_true(is_there("x.failed/numbers.csv"));
  g_assert_false(is_there("x"));
  g_assert_true(opc_remove_tree("x.failed"));
}

/* ---- plugins of the correction ---- */

static void try_correction(const char *kind, const char *when, const char *how,
                           const char *say) {
  g_autofree char *id = g_strconcat("bad.", kind, NULL);
  write_correction(kind);
  /* One thread is used: with several threads, the message may name another
     faulty plugin. */
  assert_exit(call_while("run bad.yaml --output x --threads 1", when, how), 4,
              id, say);
  expect_kept();
}

/* Test all faults in the main function of a kind; every sixth under the
   sanitizer, because steps, verbs and loaded files have all of them. */
static void try_ways(const char *kind, const char *when) {
#ifdef __SANITIZE_ADDRESS__
  const size_t step = 6;
#else
  const size_t step = 1;
#endif
  for (size_t i = 0; i < G_N_ELEMENTS(misuses); i += step)
    try_correction(kind, when, misuses[i].how, misuses[i].say);
}

static void test_litho(void) { try_ways("litho", "image"); }
static void test_resist(void) { try_ways("resist", "print"); }
static void test_extractor(void) { try_ways("extractor", "extract"); }
static void test_synthesizer(void) { try_ways("synthesizer", "update"); }
static void test_regulator(void) { try_ways("regulator", "rule"); }

/* Faults in the other functions. */
static void test_elsewhere(void) {
  static const struct {
    const char *kind, *when;
  } others[] = {{"litho", "prepare"},       {"litho", "band"},
                {"resist", "prepare"},      {"extractor", "prepare"},
                {"extractor", "slicing"},   {"synthesizer", "begin"},
                {"synthesizer", "verdict"}, {"regulator", "violations"}};
  for (size_t i = 0; i < G_N_ELEMENTS(others); i++) {
    try_correction(others[i].kind, others[i].when, "exit", ended);
    try_correction(others[i].kind, others[i].when, "rounding", numbers);
    try_correction(others[i].kind, others[i].when, "chdir",
                   "plugin '%s' changed the working folder\n");
  }
}

/* ---- arrays and texts ---- */

static void test_arrays(void) {
  static const struct {
    const char *kind, *how, *say;
  } faults[] = {
      {"resist", "overrun", "writes beyond the array of level sets"},
      {"extractor", "overrun", "writes beyond the array of figures"},
      {"extractor", "underrun", "writes before the array of figures"},
      {"synthesizer", "overrun", "writes beyond the array of jogs"},
      {"synthesizer", "underrun", "writes before the array of moves of L"},
      {"synthesizer", "assists", "writes beyond the array of assists"},
      {"synthesizer", "endless",
       "a verdict is not a text of at most 200 bytes"},
      {"synthesizer", "bytes", "a verdict is not UTF-8: byte 2 is 0xff"},
      {"regulator", "overrun", "writes beyond the array of vetoes"},
      {"regulator", "underrun", "writes before the array of line ends"},
      {"regulator", "overrun violations",
       "writes beyond the array of violations"},
      {"regulator", "endless", "a rule is not a text of at most 200 bytes"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(faults); i++) {
    const char *kind = faults[i].kind;
    g_autofree char *say = g_strdup_printf(
        "step 'mask' (correct), %s (%%s): %s\n", kind, faults[i].say);
    try_correction(kind, "", faults[i].how, say);
  }
}

/* Guard words detect the same writes with and without guard pages. */
static void test_words(void) {
  g_setenv("OPCFLOW_GUARD", "words", TRUE);
  test_arrays();
  g_setenv("OPCFLOW_GUARD", "pages", TRUE);
}

/* With guard pages, a write far beyond an array, or to an array of an earlier
   call, is a crash of the plugin. */
static void test_pages(void) {
  static const char *const kinds[] = {"resist", "extractor", "synthesizer",
                                      "regulator"};
  static const char *const faults[] = {"far", "before", "kept"};
#ifdef __SANITIZE_ADDRESS__
  g_test_skip("the sanitizer speaks first");
  return;
#endif
  for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++)
    for (size_t j = 0; j < G_N_ELEMENTS(faults); j++) {
      /* No page precedes the level sets, which litho models allocate. */
      if (i || strcmp(faults[j], "before") != 0)
        try_correction(kinds[i], "", faults[j],
                       "crashed in plugin '%s': segmentation fault\n");
    }
}

/* A crash while the host reads a returned text or array is attributed to the
   plugin that returned it. */
static void test_dangling(void) {
  static const char *const faults[][2] = {
      {"litho", "dangling"},       {"resist", "dangling"},
      {"synthesizer", "dangling"}, {"synthesizer", "dangling assists"},
      {"regulator", "dangling"},   {"regulator", "dangling shapes"}};
  for (size_t i = 0; i < G_N_ELEMENTS(faults); i++)
    try_correction(faults[i][0], "", faults[i][1],
                   "crashed in plugin '%s': segmentation fault\n");
}

/* A plugin damages the heap; another plugin crashes when it frees the block at
   the end of the run. The message lists the first plugin. */
static void test_heap(void) {
#ifdef __SANITIZE_ADDRESS__
  g_test_skip("the sanitizer reports the fault first");
  return;
#endif
  write_correction("synthesizer");
  assert_exit(
      call_while("run bad.yaml --output x", "", "heap"), 4,
      "segment.transistors",
      "crashed in plugin '%s': aborted\nnote: plugins called before may "
      "have damaged the memory: ");
  g_assert_nonnull(strstr(err, "'bad.synthesizer'"));
  expect_kept();
}

/* A returned array that is not on the heap is attributed to the plugin. */
static void test_static(void) {
#ifdef __SANITIZE_ADDRESS__
  g_test_skip("the sanitizer reports the fault first");
  return;
#endif
  try_correction("litho", "", "static", "crashed in plugin '%s': aborted\n");
}

/* ---- concurrent plugins ---- */

/* A change of the process state may be caused by any running plugin. The
   message names several plugins, among them the faulty one. */
static void test_beside(void) {
  static const char *const kinds[][2] = {
      {"litho", "image"}, {"resist", "print"}, {"extractor", "extract"}};
  for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++)
    for (int again = 0; again < 4; again++) {
      g_autofree char *id = g_strdup_printf("'bad.%s'", kinds[i][0]);
      write_correction(kinds[i][0]);
      assert_exit(call_while("run bad.yaml --output x --threads 4", kinds[i][1],
                             "chdir slowly"),
                  4, id, " changed the working folder\n");
      g_assert_nonnull(strstr(err, id));
      expect_kept();
    }
}

/* ---- steps, verbs, kinds ---- */

static JsonNode *json_parse(const char *text) {
  g_autoptr(JsonParser) parser = json_parser_new();
  g_autoptr(GError) error = NULL;
  g_assert_true(g_utf8_validate(text, -1, NULL));
  json_parser_load_from_data(parser, text, -1, &error);
  g_assert_no_error(error);
  return json_parser_steal_root(parser);
}

static void try_step(const char *verb, const char *when, const char *how,
                     int code, const char *say) {
  write_text("step.yaml", "opcflow: 1\nsteps:\n  a: { use: bad.step }\n");
  assert_exit(call_while(verb, when, how), code, "bad.step", say);
  g_assert_false(is_there("runs/step"));
  g_assert_false(is_there("runs/step.failed"));
}

static void test_step(void) {
  for (size_t i = 0; i < G_N_ELEMENTS(misuses); i++)
    try_step("run step.yaml", "run", misuses[i].how, 4, misuses[i].say);
  static const char *const places[] = {"check", "output", "release"};
  for (size_t i = 0; i < G_N_ELEMENTS(places); i++) {
    try_step("run step.yaml", places[i], "exit", 4, ended);
    try_step("run step.yaml", places[i], "umask", 4,
             "plugin '%s' changed the modes of new files\n");
  }
  try_step("check step.yaml", "check", "exit", 4, ended);
  try_step("check step.yaml", "forecast", "exit", 4, ended);
  try_step("run step.yaml", "forecast", "chdir", 4,
           "plugin '%s' changed the working folder\n");
  try_step("run step.yaml", "", "endless error", 4, "xxxx");
  try_step("check step.yaml", "", "endless", 0, "");
  g_assert_nonnull(strstr(out, "xxxx"));
  try_step("check step.yaml --json", "", "bytes", 0, "");
  g_autoptr(JsonNode) check = json_parse(out);
  try_step("run step.yaml", "run", "err", 4, ended);
  /* A plugin does not change the exit code of the command. */
  try_step("run step.yaml", "run", "atexit", 4, "(bad.step): no error message");
  assert_exit(call_while("run step.yaml --output z", "run", "atexit crash"), 4,
              "", "crashed while the command ended: segmentation fault\n");
  g_assert_true(opc_remove_tree("z"));
  try_step("run step.yaml", "", "memory", 4, "crashed in plugin '%s': trap\n");
  try_step("run step.yaml", "", "thread later", 4,
           "crashed in plugin '%s': segmentation fault\n");
  try_step("run step.yaml", "", "dangling log", 4,
           "crashed in plugin '%s': segmentation fault\n");
}

static void test_verb(void) {
  for (size_t i = 0; i < G_N_ELEMENTS(misuses); i++)
    assert_exit(call_while("bad", "run", misuses[i].how), 4, "command.bad",
                misuses[i].say);
}

/* Faults while a plugin of any kind is loaded. */
static void test_loading(void) {
  for (size_t i = 0; i < G_N_ELEMENTS(misuses); i++) {
    assert_exit(call_while("inspect kind.bad", "construct", misuses[i].how), 3,
                "kind.bad", misuses[i].say);
    assert_exit(call_while("inspect bad.none", "load", misuses[i].how), 3,
                "bad.none", misuses[i].say);
  }
}

/* ---- output of faulty plugins ---- */

/* Output of plugins does not reach the standard output of the command. */
static void test_output(void) {
  write_correction("synthesizer");
  g_assert_cmpint(
      call_while("run bad.yaml --output x --json", "update", "print"), ==, 0);
  g_assert_nonnull(strstr(err, "not JSON\n"));
  g_autoptr(JsonNode) run = json_parse(out);
  g_assert_true(json_object_has_member(json_node_get_object(run), "metrics"));
  g_assert_true(opc_remove_tree("x"));
  g_assert_cmpint(call_while("inspect bad.none --json", "construct", "print"),
                  ==, 0);
  g_autoptr(JsonNode) seen = json_parse(out);
  g_assert_cmpstr(
      json_object_get_string_member(json_node_get_object(seen), "id"), ==,
      "bad.none");
  g_assert_cmpint(call_while("bad --json", "run", "print"), ==, 0);
  g_autoptr(JsonNode) verb = json_parse(out);
  g_assert_true(json_object_has_member(json_node_get_object(verb), "tables"));
}

/* Texts of plugins cannot control the terminal or forge messages. */
static void test_texts(void) {
  const char *shown = "\\u{1b}[2Jgone\\nerror: not \\xff\n";
  try_step("run step.yaml", "", "escape", 4, shown);
  g_assert_null(strchr(err, '\033'));
  try_step("run step.yaml --json", "", "escape", 4, shown);
  g_autoptr(JsonNode) run = json_parse(out);
  call_while("run step.yaml --output y", "", "escaped log");
  g_assert_nonnull(strstr(err, shown));
  g_assert_null(strchr(err, '\033'));
  g_assert_true(opc_remove_tree("y"));
  write_correction("synthesizer");
  g_assert_cmpint(call_while("run bad.yaml --output x", "", "escape"), ==, 0);
  g_assert_nonnull(strstr(out, "\\u{1b}[2J"));
  g_assert_null(strchr(out, '\033'));
  g_assert_true(opc_remove_tree("x"));
}

/* File names that are not valid UTF-8. */
static void test_names(void) {
  write_text("\xFF\033[1m.yaml", "opcflow: 1\nsteps: {}\n");
  g_assert_cmpint(call_while("check \xFF\033[1m.yaml --json", "", ""), ==, 2);
  g_autoptr(JsonNode) check = json_parse(out);
  g_assert_cmpstr(
      json_object_get_string_member(json_node_get_object(check), "flow"), ==,
      "\\xff\033[1m.yaml");
  g_assert_true(g_str_has_prefix(err, "\\xff\\u{1b}[1m.yaml:"));
}

/* ---- endless loops ---- */

/* Check that one signal ends a hanging run within a second. */
static void try_hang(const char *flow, int number, const char *want) {
  g_autoptr(GSubprocess) process = start_loop(flow);
  g_autofree char *message = NULL;
  GError *fault = NULL;
  gint64 asked = g_get_monotonic_time();
  g_subprocess_send_signal(process, number);
  g_subprocess_communicate_utf8(process, NULL, NULL, NULL, &message, &fault);
  g_assert_no_error(fault);
  double seconds = (double)(g_get_monotonic_time() - asked) * 1e-6;
  g_test_message("%.2f s: %s", seconds, message);
  g_assert_cmpfloat(seconds, <, 1);
  g_assert_true(g_subprocess_get_if_exited(process));
  g_assert_cmpint(g_subprocess_get_exit_status(process), ==, 130);
  g_assert_nonnull(strstr(message, want));
}

static void test_hangs(void) {
  static const char *const kinds[][2] = {
      {"litho", "image"},        {"resist", "print"},
      {"extractor", "extract"},  {"synthesizer", "begin"},
      {"synthesizer", "update"}, {"regulator", "rule"}};
  g_setenv("BAD_HOW", "hang", TRUE);
  for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++) {
    write_correction(kinds[i][0]);
    g_setenv("BAD_WHEN", kinds[i][1], TRUE);
    g_autofree char *want =
        g_strdup_printf("stopped in plugin 'bad.%s'\n", kinds[i][0]);
    try_hang("bad.yaml", i % 2 ? SIGINT : SIGTERM, want);
    expect_kept();
  }
  /* The message does not name a thread that waits for the hanging thread. */
  g_setenv("BAD_HOW", "hang aside", TRUE);
  g_setenv("BAD_WHEN", "image", TRUE);
  write_correction("litho");
  try_hang("bad.yaml", SIGTERM, "stopped in plugin 'bad.litho'\n");
  expect_kept();
  g_setenv("BAD_HOW", "hang", TRUE);
  write_text("step.yaml", "opcflow: 1\nsteps:\n  a: { use: bad.step }\n");
  g_setenv("BAD_WHEN", "run", TRUE);
  try_hang("step.yaml", SIGTERM, "stopped in plugin 'bad.step'\n");
  g_setenv("BAD_WHEN", "release", TRUE);
  try_hang("step.yaml", SIGTERM, "stopped in plugin 'bad.step'\n");
}

/* The message about a signal from another process names no plugin. */
static void test_foreign(void) {
  write_text("step.yaml", "opcflow: 1\nsteps:\n  a: { use: bad.step }\n");
  g_setenv("BAD_HOW", "hang", TRUE);
  g_setenv("BAD_WHEN", "run", TRUE);
  g_autoptr(GSubprocess) process = start_loop("step.yaml");
  g_autofree char *message = NULL;
  g_subprocess_send_signal(process, SIGSEGV);
  g_subprocess_communicate_utf8(process, NULL, NULL, NULL, &message, NULL);
  g_assert_true(g_subprocess_get_if_signaled(process));
  g_assert_cmpstr(message, ==, "");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  set_up(TRUE);
  g_test_add_func("/evil/litho", test_litho);
  g_test_add_func("/evil/resist", test_resist);
  g_test_add_func("/evil/extractor", test_extractor);
  g_test_add_func("/evil/synthesizer", test_synthesizer);
  g_test_add_func("/evil/regulator", test_regulator);
  g_test_add_func("/evil/elsewhere", test_elsewhere);
  g_test_add_func("/evil/arrays", test_arrays);
  g_test_add_func("/evil/words", test_words);
  g_test_add_func("/evil/pages", test_pages);
  g_test_add_func("/evil/dangling", test_dangling);
  g_test_add_func("/evil/heap", test_heap);
  g_test_add_func("/evil/static", test_static);
  g_test_add_func("/evil/beside", test_beside);
  g_test_add_func("/evil/step", test_step);
  g_test_add_func("/evil/verb", test_verb);
  g_test_add_func("/evil/loading", test_loading);
  g_test_add_func("/evil/output", test_output);
  g_test_add_func("/evil/texts", test_texts);
  g_test_add_func("/evil/names", test_names);
  g_test_add_func("/evil/hangs", test_hangs);
  g_test_add_func("/evil/foreign", test_foreign);
  return run_all();
}
