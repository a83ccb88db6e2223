/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the command in child processes: command lines, exit codes, and the
   output of the verbs. The program defines two verbs of its own. */
#include <glib/gstdio.h>
#include <math.h>
#include <store/files.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/cli/cli.h"
#include "core/cli/progress.h"

/* ---- verbs of this program ---- */

static const char *word;
static GPtrArray *items;
static gboolean flag;

static const cli_option try_options[] = {
    {"word", "a text", "TEXT", .text = &word},
    {"item", "several texts", "TEXT", .list = &items},
    {"flag", "a flag", .flag = &flag},
    {0}};

/* Print the options and arguments of the command line. */
static int try_run(const cli_verb *verb, const GPtrArray *arguments) {
  cli_print("%s word=%s flag=%d items=", verb->name, word ? word : "", flag);
  for (const char *const *i = cli_list(items); *i; i++) cli_print("%s;", *i);
  cli_print(" arguments=");
  for (guint i = 0; i < arguments->len; i++)
    cli_print("%s;", (char *)arguments->pdata[i]);
  cli_print(" line=");
  for (const char *const *w = cli_command_line(); *w; w++) cli_print("%s;", *w);
  return CLI_GOOD;
}

static const cli_verb try_it = {.name = "try",
                                .arguments = "A [B]",
                                .summary = "Print the command line",
                                .options = try_options,
                                .least = 1,
                                .most = 2,
                                .run = try_run};

/* Print a table, JSON, problems and progress. */
static int show_run(const cli_verb *verb, const GPtrArray *arguments) {
  static const char *const names[] = {"id", "summary"};
  static const char *const texts[] = {"a", "first", "long", "second\x1b"};
  const opc_place at = {"flow.yaml", 7, 3}, file = {"b.yaml", 0, 0};
  const opc_progress report = {2, 8, 0.25, "%"};
  g_autoptr(GPtrArray) cells = g_ptr_array_new();
  g_autoptr(opc_problems) problems = opc_problems_new();
  (void)verb, (void)arguments;
  for (int i = 0; i < 4; i++) g_ptr_array_add(cells, (char *)texts[i]);
  cli_print_rows(names, 2, cells);
  opc_problem_add(problems, OPC_IO, &file, "cannot be read");
  opc_problem_add(problems, OPC_IO, &at, "is wrong");
  opc_problem_add(problems, OPC_IO, NULL, "is lost");
  JsonObject *o = json_object_new();
  cli_add_texts(o, "texts", cells);
  cli_add_problems(o, problems);
  cli_print_object(o);
  cli_progress progress;
  cli_progress_start(&progress, OPC_LOG_INFO, TRUE);
  progress.shown = TRUE;
  cli_progress_point(&progress, 2, 5);
  cli_progress_step(&progress, "first", 1, 2);
  cli_progress_show(&progress, "first", &report);
  cli_progress_show(&progress, "first", &report); /* within the pause */
  cli_progress_log(&progress, "first", OPC_LOG_DEBUG, "below the level");
  cli_progress_log(&progress, "first", OPC_LOG_INFO, "some text");
  cli_progress_log(&progress, "first", OPC_LOG_WARNING, "a warning");
  cli_progress_end(&progress);
  return cli_problems(problems);
}

static const cli_verb show = {.name = "show",
                              .arguments = "",
                              .summary = "Print all kinds of output",
                              .run = show_run},
                      devel = {CLI_LINT}, hidden = {CLI_COMPLETE};

const cli_verb *const cli_verbs[] = {&cli_run,  &cli_check, &try_it,
                                     &show,     &devel,     &cli_version,
                                     &cli_help, &hidden,    NULL};

const cli_verb *cli_plugin_verb(const char *name, opc_error *error) {
  opc_fail(error, OPC_NO_PLUGIN, NULL, "the verb '%s' of a plugin", name);
  return NULL;
}

/* ---- help ---- */

static char *folder, *out, *err; /* output of the last command */

static void put_text(const char *name, const char *text) {
  g_assert_true(g_file_set_contents(name, text, -1, NULL));
}

static char *get_text(const char *name) {
  char *text = NULL;
  g_assert_true(g_file_get_contents(name, &text, NULL, NULL));
  return text;
}

/* Run the command in a child process with the words of `line`, in which '~'
   stands for a space; return the exit code. */
static int command(const char *line) {
  char *whole = g_strconcat("opcflow ", line, NULL);
  static GStrv words; /* static: the child exits without freeing memory */
  words = g_strsplit(g_strchomp(whole), " ", -1);
  g_free(whole);
  for (guint i = 0; words[i]; i++) g_strdelimit(words[i], "~", ' ');
  fflush(NULL);
  pid_t child = fork();
  g_assert_cmpint(child, >=, 0);
  if (!child) {
    if (!freopen("out", "w", stdout) || !freopen("err", "w", stderr)) _exit(99);
    /* The command replaces elements of the array. */
    guint n = g_strv_length(words);
    char **copy = g_memdup2(words, (n + 1) * sizeof *words);
    exit(cli_main((int)n, copy));
  }
  int status;
  g_assert_cmpint(waitpid(child, &status, 0), ==, child);
  g_assert_true(WIFEXITED(status));
  g_clear_pointer(&words, g_strfreev);
  g_free(out);
  g_free(err);
  out = get_text("out");
  err = get_text("err");
  return WEXITSTATUS(status);
}

static void expect(const char *line, int code, const char *output,
                   const char *errors) {
  int found = command(line);
  g_assert_cmpstr(err, ==, errors);
  g_assert_cmpstr(out, ==, output);
  g_assert_cmpint(found, ==, code);
}

static void expect_in(const char *text, const char *part) {
  if (!strstr(text, part)) g_error("'%s' is not in '%s'", part, text);
}

/* ---- command lines ---- */

static void test_exit_codes(void) {
  g_assert_cmpint(cli_exit_code(OPC_OK), ==, 0);
  g_assert_cmpint(cli_exit_code(OPC_LIMIT), ==, 1);
  g_assert_cmpint(cli_exit_code(OPC_INVALID), ==, 2);
  g_assert_cmpint(cli_exit_code(OPC_NO_PLUGIN), ==, 3);
  g_assert_cmpint(cli_exit_code(OPC_FAILED), ==, 4);
  g_assert_cmpint(cli_exit_code(OPC_CANCELLED), ==, 4);
  g_assert_cmpint(cli_exit_code(OPC_IO), ==, 5);
}

static void test_verbs(void) {
  expect("", 2, "", "error: no verb given, see 'opcflow help'\n");
  expect("--wide", 2, "", "error: no verb given, see 'opcflow help'\n");
  expect("chekc", 2, "",
         "error: unknown verb 'chekc', did you mean 'check'?\n");
  expect("zzzzzz", 2, "", "error: unknown verb 'zzzzzz', see 'opcflow help'\n");
  expect("echo", 3, "", "error: the verb 'echo' of a plugin\n");
  expect("--version", 0, "opcflow " OPC_VERSION " (plugin interface 0.8)\n",
         "");
  expect("version --json", 0,
         "{\n  \"opcflow\" : \"" OPC_VERSION
         "\",\n  \"interface_major\" : 0,\n  \"interface_minor\" : 8\n}\n",
         "");
  expect("try --version", 0, "opcflow-try (opcflow) " OPC_VERSION "\n", "");
  g_assert_cmpint(command("lint x"), ==, 3);
  expect_in(err, "error: cannot run 'lint': the program opcflow-devel ");
}

static void test_arguments(void) {
  expect("try x", 0, "try word= flag=0 items= arguments=x; line=opcflow;try;x;",
         "");
  expect("--flag try x y --word=a~b --item 1 --item=2", 0,
         "try word=a b flag=1 items=1;2; arguments=x;y; "
         "line=opcflow;try;--flag;x;y;--word=a b;--item;1;--item=2;",
         "");
  expect("--plugin-path /nowhere try x -- --flag", 0,
         "try word= flag=0 items= arguments=x;--flag; "
         "line=opcflow;try;--plugin-path;/nowhere;x;--;--flag;",
         "");
  expect("try -", 0, "try word= flag=0 items= arguments=-; line=opcflow;try;-;",
         "");
  expect("try", 2, "", "error: 'try' requires A [B], see 'opcflow help try'\n");
  expect("try x y z", 2, "",
         "error: 'try' does not take 'z', see 'opcflow help try'\n");
  g_assert_cmpint(command("try x --wrod a"), ==, 2);
  expect_in(err, "--wrod");
  expect_in(err, "--word");
  g_assert_cmpint(command("try x --word"), ==, 2);
  expect_in(err, "--word");
}

static void test_help(void) {
  g_assert_cmpint(command("help"), ==, 0);
  expect_in(out, "Usage: opcflow VERB ...\n");
  expect_in(out, "Print the command line");
  expect_in(out, "\nVerbs of plugins:\n");
  expect_in(out, "  echo ");
  expect_in(out, "\n'opcflow help VERB' prints the options of a verb.\n");
  g_assert_null(strstr(out, "complete"));
  static const char *const lines[] = {"help try", "try --help"};
  for (int i = 0; i < 2; i++) {
    g_assert_cmpint(command(lines[i]), ==, 0);
    g_assert_true(g_str_has_prefix(
        out,
        "Usage: opcflow try A [B] [OPTIONS]\n\nPrint the command line.\n"));
    expect_in(out, "--item TEXT");
    expect_in(out, "--plugin-path DIR");
  }
  expect("help tyr", 2, "", "error: unknown verb 'tyr', did you mean 'try'?\n");
}

/* Unprintable characters are escaped; problems are in the order of files and
   places, and those without a file are marked as errors. */
static void test_output(void) {
  g_setenv("COLUMNS", "80", TRUE);
  g_assert_cmpint(command("show"), ==, 5);
  g_assert_true(g_str_has_prefix(out, "id    summary\n"));
  expect_in(out, "\nlong  second\\u{1b}\n");
  g_autoptr(JsonNode) root = json_from_string(strstr(out, "{\n"), NULL);
  g_assert_nonnull(root);
  JsonObject *o = json_node_get_object(root);
  JsonArray *texts = json_object_get_array_member(o, "texts");
  JsonArray *list = json_object_get_array_member(o, "problems");
  g_assert_cmpstr(json_array_get_string_element(texts, 1), ==, "first");
  g_assert_cmpuint(json_array_get_length(list), ==, 3);
  for (guint i = 0; i < 3; i++) {
    JsonObject *one = json_array_get_object_element(list, i);
    g_assert_cmpint(json_object_get_int_member(one, "exit"), ==, 5);
    gboolean placed = json_object_has_member(one, "line");
    g_assert_true(
        placed ==
        !strcmp(json_object_get_string_member(one, "message"), "is wrong"));
    if (placed) g_assert_cmpint(json_object_get_int_member(one, "line"), ==, 7);
  }
  expect_in(err, "\nflow.yaml:7:3: is wrong\n");
  expect_in(err, "b.yaml: cannot be read\n");
  expect_in(err, "error: is lost\n");
  expect_in(err, "\r\033[Kpoint 2/5 [1/2] first");
  expect_in(err, "[1/2] first  2/8  worst 0.25 %");
  expect_in(err, "0:00 left");
  expect_in(err, "first: some text\n");
  expect_in(err, "warning: first: a warning\n");
  g_assert_null(strstr(err, "below the level"));
  g_auto(GStrv) shown = g_strsplit(err, "2/8", -1);
  g_assert_cmpuint(g_strv_length(shown), ==, 2);
}

/* ---- check ---- */

#define FLOW                                                \
  "opcflow: 1\nname: sums\nsteps:\n"                        \
  "  a: { use: test.numbers, size: 2 nm, behave: quiet }\n" \
  "  b: { use: test.kept, number: 3, add: ${a} }\n"         \
  "variants:\n  more: { b.number: 9 }\n  most: { b.number: 12 }\n"

static void test_check(void) {
  put_text("flow.yaml", FLOW);
  expect("check", 0, "", "");
  expect("check flow.yaml --variant more --set a.size=3~nm", 0, "", "");
  expect("check flow.yaml --set a.size=3~V --variant base", 2, "",
         "--set a.size: 'size' requires a length, found '3 V'\n");
  g_assert_cmpint(command("check flow.yaml --variant mroe"), ==, 2);
  expect_in(err, "did you mean 'more'?");
  g_assert_cmpint(command("check gone.yaml"), ==, 5);
  put_text("bad.yaml", "opcflow: 1\nsteps:\n  a: { use: test.nubmers }\n");
  g_assert_cmpint(command("check bad.yaml"), ==, 3);
  g_assert_true(g_str_has_prefix(err, "bad.yaml:3:13: "));
  expect_in(err, "did you mean 'test.numbers'?");
}

/* Forecasts of all variants; files that a flow leaves open are no faults. */
static void test_forecasts(void) {
  put_text("wants.yaml",
           "opcflow: 1\nsteps:\n  a: { use: test.light, memory: 1e-3 }\n"
           "  b: { use: test.heavy, from: ${a} }\n"
           "variants:\n  big: { b.memory: 2e-3 }\n");
  expect("check wants.yaml", 0,
         "a: 1 sums, 1 MB\nb: 2 sums\n"
         "big/a: 1 sums, 1 MB\nbig/b: 2 sums, 2 MB\n",
         "warning: a: ran with 1\n"); /* once for both variants */
  expect("check wants.yaml --quick", 0, "", "");
  g_assert_cmpint(command("check wants.yaml --json"), ==, 0);
  g_autoptr(JsonNode) root = json_from_string(out, NULL);
  JsonObject *o = json_node_get_object(root);
  JsonArray *list = json_object_get_array_member(o, "forecast");
  g_assert_true(json_object_get_boolean_member(o, "valid"));
  g_assert_cmpuint(json_array_get_length(list), ==, 4);
  JsonObject *last = json_array_get_object_element(list, 3);
  g_assert_cmpstr(json_object_get_string_member(last, "variant"), ==, "big");
  g_assert_cmpfloat(json_object_get_double_member(last, "memory"), ==, 2e6);
  g_autofree char *build = g_strdup(g_getenv("OPCFLOW_BUILD"));
  g_autofree char *line =
      g_strdup_printf("check open.yaml --plugin-path %s/plugins", build);
  put_text("open.yaml",
           "opcflow: 1\nsteps:\n  layout: { use: read.cif, layers: { poly: CP "
           "} }\n");
  g_assert_cmpint(command(line), ==, 0);
  g_assert_true(g_str_has_prefix(out, "requires --set layout.file=FILE, "));
}

/* ---- run ---- */

static double metric_of(JsonNode *root, const char *step) {
  JsonObject *o = json_node_get_object(root);
  o = json_object_get_object_member(o, "metrics");
  o = json_object_get_object_member(o, step);
  return json_object_get_double_member(json_object_get_object_member(o, "sum"),
                                       "value");
}

static void test_run(void) {
  put_text("flow.yaml", FLOW);
  g_assert_cmpint(command("run --output plain"), ==, 0);
  g_assert_true(g_str_has_prefix(out, "plain: "));
  g_assert_true(g_str_has_suffix(out, " s\n"));
  g_assert_cmpstr(err, ==, "");
  g_assert_cmpint(command("run --output told --set a.behave=well"), ==, 0);
  g_assert_true(g_str_has_prefix(out, "a.numbers\n"));
  expect_in(out, "with, comma");
  g_assert_cmpint(command("run --json --output json --threads 1"), ==, 0);
  g_autoptr(JsonNode) root = json_from_string(out, NULL);
  /* a: 1 + 2 + 3; b: + 3 / 3 */
  g_assert_cmpfloat(metric_of(root, "b"), ==, 7);
  expect("run --quiet --output quiet", 0, "", "");
  g_assert_cmpint(command("run --output debug --log debug"), ==, 0);
  expect_in(err, "a: debug: 2 numbers\n");
  expect_in(err, "b: ran\n");
}

static void test_run_usage(void) {
  put_text("flow.yaml", FLOW);
  expect("run --force", 2, "",
         "error: '--force' requires '--output', the run folder to replace\n");
  expect("run --log loud", 2, "",
         "error: '--log' must be debug, info, steps or warning, found "
         "'loud'\n");
  static const char *const threads[] = {"0", "-1", "x", "4097", "1x"};
  for (size_t i = 0; i < G_N_ELEMENTS(threads); i++) {
    g_autofree char *line = g_strconcat("run --threads ", threads[i], NULL);
    g_autofree char *text = g_strdup_printf(
        "error: '--threads' must be a number from 1 to 4096, found '%s'\n",
        threads[i]);
    expect(line, 2, "", text);
  }
  g_assert_cmpint(g_remove("flow.yaml"), ==, 0);
  expect("run", 2, "", "error: 'run' requires FLOW, see 'opcflow help run'\n");
}

static void test_threads(void) {
  unsigned before = opc_threads();
  g_assert_cmpint(cli_set_threads(NULL), ==, -1);
  g_assert_cmpuint(opc_threads(), ==, before);
  g_assert_cmpint(cli_set_threads("3"), ==, -1);
  g_assert_cmpuint(opc_threads(), ==, 3);
}

/* The exit code names the kind of the problem; files of the finished steps are
   reported. */
static void test_run_failures(void) {
  put_text("flow.yaml", FLOW);
  g_assert_cmpint(command("run --output failed --set a.behave=fail"), ==, 4);
  expect_in(err, "2 nm is not possible");
  g_assert_cmpint(
      command("run --output failed --set b.file=x --set a.behave=limit"), ==,
      1);
  g_assert_cmpint(command("run --output kept --json --set require.b.sum=5"), ==,
                  1);
  expect_in(err, "expected at most 5");
  g_autoptr(JsonNode) root = json_from_string(out, NULL);
  g_assert_true(json_object_has_member(json_node_get_object(root), "problems"));
  g_assert_cmpfloat(metric_of(root, "b"), ==, 7);
  g_assert_cmpint(command("run --json --set a.size=3"), ==, 2);
  expect_in(out, "\"exit\" : 2");
  put_text("two.yaml",
           "opcflow: 1\nsteps:\n  b: { use: test.kept, file: b.txt }\n"
           "  a: { use: test.numbers, size: 1 nm, behave: fail }\n");
  g_assert_cmpint(command("run two.yaml --output two"), ==, 4);
  expect_in(err, "note: files written so far are in 'two.failed'\n");
  g_assert_cmpint(command("run flow.yaml --output o --set a.behave=find"), ==,
                  0);
  g_assert_true(g_str_has_suffix(err, "finding: a: 2 nm is odd\n"));
}

static void test_variants(void) {
  put_text("flow.yaml", FLOW);
  g_assert_cmpint(
      command("run --variant all --variant base --output all --json"), ==, 0);
  g_autoptr(JsonNode) root = json_from_string(out, NULL);
  JsonArray *list = json_node_get_array(root);
  static const double sums[] = {9, 10, 7}; /* 6 + 9 / 3, 6 + 12 / 3, 6 + 1 */
  static const char *const names[] = {"all/more", "all/most", "all/base"};
  g_assert_cmpuint(json_array_get_length(list), ==, 3);
  for (guint i = 0; i < 3; i++) {
    JsonObject *one = json_array_get_object_element(list, i);
    g_assert_cmpstr(json_object_get_string_member(one, "folder"), ==, names[i]);
    g_assert_cmpfloat(metric_of(json_array_get_element(list, i), "b"), ==,
                      sums[i]);
  }
  g_assert_cmpint(command("run --variant more --variant most --output text "
                          "--set a.behave=find"),
                  ==, 0);
  g_assert_true(g_str_has_prefix(out, "variant more\n\n"));
  expect_in(out, "\nvariant most\n\n");
  expect_in(err, "finding: a: 2 nm is odd (variant 'more')\n");
  put_text("none.yaml", "opcflow: 1\nsteps:\n  b: { use: test.kept }\n");
  g_assert_cmpint(command("run none.yaml --variant all"), ==, 2);
  expect_in(err, "none.yaml: has no variants\n");
}

/* The table has the swept parameter and the metrics that vary. */
static void test_sweep(void) {
  put_text("flow.yaml", FLOW);
  g_setenv("COLUMNS", "200", TRUE);
  g_assert_cmpint(command("run --output sweep --set a.behave=well --sweep "
                          "b.number=[3,~9,~9]"),
                  ==, 0);
  expect_in(out, "\n\npoint  b.number  b.sum\n    1         3      7\n");
  g_assert_null(strstr(out, "a.sum"));
  g_assert_cmpint(command("run --output points --sweep a.behave=[well,~fail]"),
                  ==, 4);
  expect_in(out, "2 nm is not possible");
  expect_in(err, "error: 1 of 2 points failed\n");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_autofree char *plugins =
      g_build_filename(g_getenv("OPCFLOW_BUILD"), "tests", NULL);
  g_setenv("OPCFLOW_PLUGIN_PATH", plugins, TRUE);
  folder = g_dir_make_tmp("opcflow-XXXXXX", NULL);
  g_assert_cmpint(g_chdir(folder), ==, 0);
  g_test_add_func("/cli/exit-codes", test_exit_codes);
  g_test_add_func("/cli/verbs", test_verbs);
  g_test_add_func("/cli/arguments", test_arguments);
  g_test_add_func("/cli/help", test_help);
  g_test_add_func("/cli/output", test_output);
  g_test_add_func("/cli/check", test_check);
  g_test_add_func("/cli/forecasts", test_forecasts);
  g_test_add_func("/cli/run", test_run);
  g_test_add_func("/cli/run-usage", test_run_usage);
  g_test_add_func("/cli/threads", test_threads);
  g_test_add_func("/cli/run-failures", test_run_failures);
  g_test_add_func("/cli/variants", test_variants);
  g_test_add_func("/cli/sweep", test_sweep);
  int code = g_test_run();
  g_assert_cmpint(g_chdir("/"), ==, 0);
  opc_remove_tree(folder);
  g_free(folder);
  g_free(out);
  g_free(err);
  return code;
}
