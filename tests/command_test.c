/* SPDX-License-Identifier: BSD-3-Clause */
/* The opcflow command: exit codes, output, run folders. */
#include <fcntl.h>
#include <gio/gio.h>
#include <json-glib/json-glib.h>
#include <pty.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/command.h"

/* ---- verbs that only print ---- */

static void test_usage(void) {
  g_assert_cmpint(opcflow_call("rnu"), ==, 2);
  g_assert_cmpstr(err, ==, "error: unknown verb 'rnu', did you mean 'run'?\n");
  g_assert_cmpint(opcflow_call("run"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "error: 'run' requires FLOW, see 'opcflow help run'\n");
  g_assert_cmpint(opcflow_call("run two.yaml --jsno"), ==, 2);
  g_assert_cmpstr(
      err, ==,
      "error: unknown option '--jsno' of 'run', did you mean '--json'?\n");
  g_assert_cmpint(opcflow_call("run two.yaml --threads=many"), ==, 2);
  g_assert_cmpint(opcflow_call("run two.yaml --set"), ==, 2);
  g_assert_cmpint(opcflow_call("check two.yaml three.yaml"), ==, 2);
  g_assert_cmpstr(out, ==, "");
  g_assert_cmpint(opcflow_call("help"), ==, 0);
  g_assert_cmpint(opcflow_call("help run"), ==, 0);
  g_assert_nonnull(strstr(out, "--threads N"));
  g_assert_cmpint(opcflow_call("--version"), ==, 0);
  g_assert_cmpstr(out, ==, "opcflow " OPC_VERSION " (plugin interface 0.8)\n");
}

static void test_echo(void) {
  g_assert_cmpint(opcflow_call("version --json"), ==, 0);
  g_autoptr(JsonNode) version = json_from_string(out, NULL);
  g_assert_cmpstr(
      json_object_get_string_member(json_node_get_object(version), "opcflow"),
      ==, OPC_VERSION);
  g_assert_cmpint(opcflow_call("inspect test.numbers --json"), ==, 0);
  g_autoptr(JsonNode) about = json_from_string(out, NULL);
  g_assert_cmpuint(json_array_get_length(json_object_get_array_member(
                       json_node_get_object(about), "parameters")),
                   ==, 17); /* including `timeout` */
  g_assert_cmpint(opcflow_call("inspect test.number"), ==, 3);
  g_assert_cmpstr(err, ==,
                  "error: unknown plugin 'test.number', did you mean "
                  "'test.numbers'?\n");
  g_assert_cmpint(opcflow_call("inspect bad.major"), ==, 3);
  g_assert_nonnull(strstr(err, "built for plugin interface 9.8, this is 0.8"));
}

/* The text printed by inspect is a valid flow if the missing values are set. */
static void test_stanza(void) {
  g_assert_cmpint(opcflow_call("inspect test.numbers"), ==, 0);
  const char *stanza = strstr(out, "\nnumbers:\n");
  g_assert_nonnull(stanza);
  g_assert_nonnull(strstr(stanza, "  size: ... nm\n"));
  g_assert_nonnull(strstr(stanza,
                          "  # anchor:\n  #   line: 65 nm\n"
                          "  #   pitch: 250 nm\n"));
  /* Parameters of a group need not be adjacent in the declaration. */
  g_assert_cmpint(opcflow_call("inspect resist.threshold"), ==, 0);
  const char *group = strstr(out, "\n  # anchor:\n");
  g_assert_nonnull(group);
  g_assert_null(strstr(group + 1, "\n  # anchor:\n"));
}

static void test_check(void) {
  g_assert_cmpint(opcflow_call("check two.yaml"), ==, 0);
  g_assert_cmpstr(out, ==, "");
  g_assert_cmpstr(err, ==, "");
  g_assert_cmpint(opcflow_call("check two.yaml --set a.size=3"), ==, 2);
  g_assert_cmpstr(
      err, ==,
      "--set a.size: 'size' requires a length with a unit, e.g. '3 nm'\n");
  g_assert_cmpint(opcflow_call("check two.yaml --set a.plain=13"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "--set a.plain: step 'a' (test.numbers): 13 is not "
                  "welcome\n");
  g_assert_cmpint(opcflow_call("check two.yaml --set a.use=test.none"), ==, 3);
  g_assert_cmpint(opcflow_call("check two.yaml --set a.use=bad.instance"), ==,
                  3);
  g_assert_cmpint(opcflow_call("check two.yaml --set a.input=none"), ==, 5);
  g_assert_cmpint(opcflow_call("check none.yaml"), ==, 5);
  g_assert_cmpstr(err, ==, "error: 'none.yaml': no such file\n");
}

/* Light steps run during a check, so that later steps have inputs for
   forecasts. */
static void test_forecast(void) {
  write_text("wants.yaml",
             "opcflow: 1\nsteps:\n"
             "  a: { use: test.light }\n"
             "  b: { use: test.heavy, from: ${a}, memory: 2e-3 }\n"
             "  c: { use: test.heavy, from: ${b} }\n"
             "variants:\n  big: { b.memory: 1e9 }\n  bad: { b.memory: -1 }\n");
  g_assert_cmpint(opcflow_call("check wants.yaml"), ==, 2);
  g_assert_cmpstr(out, ==,
                  "a: 1 sums\nb: 2 sums, 2 MB\n"
                  "big/a: 1 sums\nbig/b: 2 sums, 1000000000.0 GB\n"
                  "bad/a: 1 sums\nbad/b: 2 sums\n");
  g_assert_true(g_str_has_prefix(err,
                                 "warning: a: ran with 1\n"
                                 "wants.yaml:4:3: step 'b' (test.heavy): "
                                 "requires 1000000000.0 GB of memory "
                                 "for 2 sums, but "));
  g_assert_nonnull(strstr(err, " left, enough for "));
  g_assert_nonnull(strstr(err,
                          " %; less with a smaller 'memory' (variant 'big')"
                          "\nwants.yaml:8:20: step 'b' (test.heavy): less than "
                          "nothing (variant 'bad')\n"));
  g_assert_null(strstr(err, "ran with 2"));
  g_assert_cmpint(opcflow_call("check wants.yaml --quick"), ==, 0);
  g_assert_cmpstr(out, ==, "");
  write_text("little.yaml",
             "opcflow: 1\nsteps:\n"
             "  a: { use: test.light }\n"
             "  b: { use: test.heavy, from: ${a}, memory: 1e-5 }\n");
  g_assert_cmpint(opcflow_call("check little.yaml"), ==, 0);
  g_assert_cmpstr(out, ==, "a: 1 sums\nb: 2 sums, less than 1 MB\n");
  g_assert_cmpint(opcflow_call("check wants.yaml --json --set b.memory=3"), ==,
                  0);
  g_assert_nonnull(strstr(out, "\"work\" : \"2 sums\""));
  g_assert_nonnull(strstr(out, "\"memory\" : 3000000000.0"));
  g_assert_cmpint(opcflow_call("run wants.yaml --output wants"), ==, 0);
  g_assert_nonnull(strstr(err, "ran with 4"));
  g_assert_true(opc_remove_tree("wants"));
  g_assert_cmpint(opcflow_call("run wants.yaml --variant big"), ==, 4);
  g_assert_nonnull(strstr(err, "requires 1000000000.0 GB of memory"));
  g_assert_null(strstr(err, "ran with 2"));
}

/* A plugin folder in which every user can write is reported. */
static void test_open_folder(void) {
  for (int open = 0; open < 2; open++) {
    g_assert_cmpint(g_mkdir_with_parents("shared", 0755), ==, 0);
    g_assert_cmpint(chmod("shared", open ? 0757 : 0755), ==, 0);
    g_assert_cmpint(opcflow_call("check little.yaml --plugin-path shared"), ==,
                    0);
    g_assert_cmpint(strstr(err,
                           "warning: every user can write to the plugin "
                           "folder 'shared' (mode 757)") != NULL,
                    ==, open);
  }
}

/* ---- verbs of plugins ---- */

static JsonObject *member(JsonNode *node, const char *name) {
  return json_object_get_object_member(json_node_get_object(node), name);
}

/* Options correspond to the parameters, and published data is printed. */
static void test_verb(void) {
  g_assert_cmpint(
      opcflow_call("echo a b~c --max-cases 3 --sizes [1~nm,0.002~um]"), ==, 0);
  g_assert_cmpstr(out, ==,
                  "words\nword  length\na          1\nb c        3\n\n"
                  "metric  value  unit\nsum     3      nm\n");
  g_assert_cmpstr(err, ==, "echo: 2 words, second, 3 cases\n");
  g_assert_cmpint(opcflow_call("echo --mode=first --quiet"), ==, 0);
  g_assert_cmpstr(err, ==, "");
  g_assert_cmpint(opcflow_call("echo --no-quiet --title it's:~here -- --x"), ==,
                  0);
  g_assert_cmpstr(err, ==, "echo: it's: here: 1 words, second, 2 cases\n");
  g_assert_cmpint(opcflow_call("echo --json a"), ==, 0);
  g_autoptr(JsonNode) json = json_from_string(out, NULL);
  JsonObject *sum =
      json_object_get_object_member(member(json, "metrics"), "sum");
  g_assert_true(json_object_get_double_member(sum, "value") == 0);
  g_assert_cmpstr(json_object_get_string_member(sum, "unit"), ==, "nm");
  JsonObject *all = json_node_get_object(json);
  JsonArray *tables = json_object_get_array_member(all, "tables");
  g_assert_cmpuint(json_array_get_length(tables), ==, 1);
  JsonObject *message = json_array_get_object_element(
      json_object_get_array_member(all, "messages"), 0);
  g_assert_cmpstr(json_object_get_string_member(message, "level"), ==, "info");
  g_assert_false(json_object_has_member(all, "problems"));
}

static void test_verb_help(void) {
  g_assert_cmpint(opcflow_call("help"), ==, 0);
  g_assert_nonnull(strstr(strstr(out, "\nVerbs of plugins:\n"), "\n  echo "));
  g_assert_cmpint(opcflow_call("help echo"), ==, 0);
  g_autofree char *help = g_strdup(out);
  g_assert_true(
      g_str_has_prefix(help, "Usage: opcflow echo WORD ... [OPTIONS]\n"));
  static const char *const lines[] = {
      "  --max-cases NUMBER            largest number; default: 2; >= 1\n",
      "  --mode first|second           a word; default: second\n",
      "  --quiet                       say nothing; default: false\n",
      "  --no-quiet                    not --quiet\n",
      "  --json                        print the result as JSON\n"};
  for (size_t i = 0; i < G_N_ELEMENTS(lines); i++)
    if (!strstr(help, lines[i])) g_assert_cmpstr(help, ==, lines[i]);
  g_assert_cmpint(opcflow_call("echo --help"), ==, 0);
  g_assert_cmpstr(out, ==, help);
  g_assert_cmpint(opcflow_call("echo --version"), ==, 0);
  g_assert_cmpstr(out, ==, "opcflow-echo (opcflow) " OPC_VERSION "\n");
}

static void test_verb_faults(void) {
  g_assert_cmpint(opcflow_call("ehco"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "error: unknown verb 'ehco', did you mean 'echo'?\n");
  g_assert_cmpint(opcflow_call("echo --max-case 3"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "error: unknown option '--max-case' of 'echo', did you mean "
                  "'--max-cases'?\n");
  g_assert_cmpint(opcflow_call("echo --max-cases 0 --mode third"), ==, 2);
  g_assert_cmpstr(
      err, ==,
      "--max-cases: 'max_cases' must be at least 1, found '0'\n--mode: 'mode' "
      "must be one of 'first', 'second', found 'third'\n");
  g_assert_cmpint(opcflow_call("echo --max-cases 13"), ==, 2);
  g_assert_cmpstr(err, ==,
                  "--max-cases: command 'echo' (command.echo): 13 is not "
                  "welcome\n");
  g_assert_cmpint(opcflow_call("echo limit --max-cases 3"), ==, 1);
  g_assert_cmpstr(err, ==,
                  "echo: 1 words, second, 3 cases\n"
                  "--max-cases: too much\n");
  g_assert_cmpint(opcflow_call("echo --json limit"), ==, 1);
  g_autoptr(JsonNode) json = json_from_string(out, NULL);
  JsonArray *problems =
      json_object_get_array_member(json_node_get_object(json), "problems");
  g_assert_cmpint(json_object_get_int_member(
                      json_array_get_object_element(problems, 0), "exit"),
                  ==, 1);
  g_assert_cmpint(opcflow_call("echo crash"), ==, 4);
  g_assert_nonnull(strstr(err,
                          "command 'echo' (command.echo): crashed in plugin "
                          "'command.echo': aborted\n"));
}

/* Output files are written to the current folder and never overwrite a file. */
static void test_verb_files(void) {
  g_assert_cmpint(opcflow_call("echo --output deep/written.txt one two"), ==,
                  0);
  g_autofree char *text = read_text("deep/written.txt");
  g_assert_cmpstr(text, ==, "one\ntwo\n");
  g_assert_cmpint(opcflow_call("echo --output deep/written.txt one two"), ==,
                  5);
  g_assert_nonnull(strstr(err, "'deep/written.txt' exists\n"));
  g_assert_cmpint(opcflow_call("echo --output ../written.txt"), ==, 2);
}

/* ---- runs ---- */

static void test_run(void) {
  g_assert_cmpint(opcflow_call("run two.yaml --output one --threads 3"), ==, 0);
  g_assert_cmpstr(err, ==, "");
  g_assert_true(g_str_has_prefix(out,
                                 "a.numbers\n"
                                 "name           size (nm)  count\n"
                                 "plain              69.00      1\n"));
  const char *last = strstr(out, "\none: ");
  g_assert_nonnull(last);
  g_autofree char *csv = read_text("one/numbers.csv");
  g_assert_cmpstr(csv, ==,
                  "name,size (nm),count\r\nplain,69.00,1\r\n"
                  "\"with, comma\",0.00,-2\r\n\"with \"\"quotes\"\"\",,3\r\n");
  g_assert_true(is_there("one/b.numbers.csv"));
  g_assert_true(is_there("one/deep/er/out.txt"));
  g_assert_cmpuint(entries("one"), ==, 6);
}

/* The manifest has the hash of the input file, and all other entries. */
static void test_manifest(void) {
  g_assert_cmpint(opcflow_call("run two.yaml --output written"), ==, 0);
  g_autofree char *text = read_text("written/manifest.json");
  g_autoptr(JsonNode) node = json_from_string(text, NULL);
  JsonObject *manifest = json_node_get_object(node);
  JsonArray *inputs = json_object_get_array_member(manifest, "inputs");
  g_assert_cmpuint(json_array_get_length(inputs), ==, 2);
  g_autofree char *sum =
      g_compute_checksum_for_string(G_CHECKSUM_SHA256, "some input\n", -1);
  g_assert_cmpstr(json_object_get_string_member(
                      json_array_get_object_element(inputs, 1), "sha256"),
                  ==, sum);
  JsonArray *plugins = json_object_get_array_member(manifest, "plugins");
  g_assert_cmpuint(json_array_get_length(plugins), ==, 1);
  JsonArray *words = json_object_get_array_member(manifest, "command");
  g_assert_cmpstr(json_array_get_string_element(words, 2), ==, "two.yaml");
  g_autofree char *metrics = read_text("written/metrics.json");
  g_autoptr(JsonNode) root = json_from_string(metrics, NULL);
  JsonObject *sum_of_b = json_object_get_object_member(
      json_object_get_object_member(json_node_get_object(root), "b"), "sum");
  g_assert_true(json_object_get_double_member(sum_of_b, "value") == 75);
  g_assert_cmpstr(json_object_get_string_member(sum_of_b, "better"), ==,
                  "lower");
}

/* The resolved flow produces the same results, also from another folder. */
static void test_again(void) {
  g_assert_cmpint(opcflow_call("run two.yaml --output first --set b.size=4~nm"),
                  ==, 0);
  g_assert_cmpint(opcflow_call("run first/flow.yaml --output second"), ==, 0);
  g_autofree char *one = read_text("first/b.numbers.csv");
  g_autofree char *two = read_text("second/b.numbers.csv");
  g_assert_cmpstr(one, ==, two);
  g_assert_nonnull(strstr(one, "plain,77.00,1\r\n"));
}

static void test_json(void) {
  g_assert_cmpint(opcflow_call("run two.yaml --json --output json"), ==, 0);
  g_autoptr(JsonNode) node = json_from_string(out, NULL);
  JsonObject *result = json_node_get_object(node);
  g_assert_cmpstr(json_object_get_string_member(result, "folder"), ==, "json");
  g_assert_cmpuint(
      json_array_get_length(json_object_get_array_member(result, "tables")), ==,
      2);
  g_assert_cmpint(opcflow_call("run two.yaml --quiet --output quiet"), ==, 0);
  g_assert_cmpstr(out, ==, "");
}

static void test_folders(void) {
  g_assert_cmpint(opcflow_call("run two.yaml"), ==, 0);
  g_assert_cmpint(opcflow_call("run two.yaml"), ==, 0);
  g_assert_cmpint(opcflow_call("run two.yaml"), ==, 0);
  g_assert_true(is_there("runs/two/flow.yaml"));
  g_assert_true(is_there("runs/two-2/flow.yaml"));
  g_assert_true(is_there("runs/two-3/flow.yaml"));
  g_assert_cmpint(opcflow_call("run two.yaml --output runs/two"), ==, 5);
  g_assert_cmpstr(
      err, ==,
      "error: 'runs/two' already exists: use --force to replace the folder\n");
  g_assert_cmpint(opcflow_call("run two.yaml --output runs/two/ --force"), ==,
                  0);
  /* --force replaces run folders only. */
  g_assert_cmpint(g_mkdir("precious", 0777), ==, 0);
  write_text("precious/mine.txt", "");
  g_assert_cmpint(opcflow_call("run two.yaml --output precious --force"), ==,
                  5);
  g_assert_cmpstr(err, ==,
                  "error: 'precious' is not replaced, because the folder has "
                  "no readable manifest.json of a run\n");
  g_assert_true(is_there("precious/mine.txt"));
  g_assert_cmpuint(entries("runs"), ==, 3);
}

static void test_failures(void) {
  g_assert_cmpint(opcflow_call("run two.yaml --output f/x --set b.behave=fail"),
                  ==, 4);
  g_assert_cmpstr(err, ==,
                  "two.yaml:4:33: step 'b' (test.numbers): 2 nm is not "
                  "possible\n"
                  "note: files written so far are in 'f/x.failed'\n");
  g_assert_true(is_there("f/x.failed/numbers.csv"));
  g_assert_cmpint(opcflow_call("run two.yaml --output f/x --set b.behave=nan"),
                  ==, 4);
  g_assert_nonnull(strstr(
      err, "metric 'sum' of 'test.numbers' is nan, expected a finite number"));
  g_assert_true(is_there("f/x.failed-2/numbers.csv"));
  g_assert_cmpint(
      opcflow_call("run two.yaml --output f/x --set b.behave=limit"), ==, 1);
  g_assert_cmpint(
      opcflow_call("run two.yaml --output f/x --set b.behave=leave"), ==, 2);
  g_assert_nonnull(strstr(err, "'../out' is outside of the run folder"));
  g_assert_cmpuint(entries("f"), ==, 4);
  /* A run that wrote no file leaves no folder. */
  write_text("bare.yaml",
             "opcflow: 1\nsteps:\n  a: { use: test.numbers, size: 1 nm, "
             "behave: fail }\n");
  g_assert_cmpint(opcflow_call("run bare.yaml --output f/bare"), ==, 4);
  g_assert_cmpuint(entries("f"), ==, 4);
}

/* Two steps with the same output file are refused. */
static void test_taken(void) {
  g_assert_cmpint(
      opcflow_call(
          "run two.yaml --output taken --set b.output=deep/er/out.txt"),
      ==, 2);
  g_assert_cmpstr(err, ==,
                  "--set b.output: step 'b' (test.numbers): 'output' is "
                  "'deep/er/out.txt', but 'a' already writes "
                  "'deep/er/out.txt'\n");
}

/* ---- the command line ---- */

/* An unquoted ~ as expanded by a shell. */
static void test_tilde(void) {
  g_setenv("HOME", folder, TRUE);
  const char *const paths[] = {"b", "b.note"};
  for (size_t i = 0; i < G_N_ELEMENTS(paths); i++) {
    g_autofree char *line =
        g_strdup_printf("check two.yaml --set %s=%s", paths[i], folder);
    g_autofree char *message = g_strdup_printf(
        "--set %s: the shell turned ~ into '%s': quote it, or write '%s/' for "
        "the folder\n",
        paths[i], folder, folder);
    g_assert_cmpint(opcflow_call(line), ==, 2);
    g_assert_cmpstr(err, ==, message);
  }
  g_assert_cmpint(opcflow_call("check two.yaml --set b=null"), ==, 0);
}

static void test_log(void) {
  g_assert_cmpint(opcflow_call("run two.yaml --output log-debug --log debug"),
                  ==, 0);
  g_assert_nonnull(strstr(err, "b: debug: 2 numbers\n"));
  g_assert_cmpint(opcflow_call("run two.yaml --output log-info"), ==, 0);
  g_assert_cmpstr(err, ==, "");
  g_assert_cmpint(opcflow_call("run two.yaml --output log-steps --log steps"),
                  ==, 0);
  g_assert_cmpstr(err, ==, "");
  g_assert_cmpint(
      opcflow_call("run two.yaml --output log-warning --log warning --set "
                   "b.behave=find"),
      ==, 0);
  g_assert_nonnull(strstr(err, "warning: b: 2 nm is odd\n"));
  g_assert_cmpint(opcflow_call("run two.yaml --log loud"), ==, 2);
  g_assert_cmpstr(
      err, ==,
      "error: '--log' must be debug, info, steps or warning, found 'loud'\n");
}

/* ---- signals and terminals ---- */

/* Interrupt a run whose second step waits. */
static void run_interrupt(const char *option, const char *value) {
  const char *argv[] = {command, "run",  "two.yaml", "--output",
                        "i/x",   option, value,      NULL};
  g_autoptr(GError) fault = NULL;
  g_autoptr(GSubprocess) process = g_subprocess_newv(
      argv,
      G_SUBPROCESS_FLAGS_STDOUT_SILENCE | G_SUBPROCESS_FLAGS_STDERR_SILENCE,
      &fault);
  g_assert_no_error(fault);
  /* The second step waits after the first step has written its table. */
  for (int i = 0; i < 500 && !entries("i"); i++) g_usleep(10000);
  g_assert_cmpuint(entries("i"), ==, 1);
  g_usleep(100000);
  g_subprocess_send_signal(process, SIGINT);
  g_assert_true(g_subprocess_wait(process, NULL, &fault));
  g_assert_true(g_subprocess_get_if_exited(process));
  g_assert_cmpint(g_subprocess_get_exit_status(process), ==, 130);
  g_assert_cmpuint(entries("i"), ==, 0);
}

static void test_interrupt(void) {
  run_interrupt("--set", "b.behave=wait");
  run_interrupt("--sweep", "b.behave=[well,wait,well]");
}

/* Run opcflow WORDS on a pseudo-terminal, check the exit code, and return the
   output. If the system has no pseudo-terminal, skip the test and return
   NULL. */
static char *say_on_terminal(const char *words, const char *no_colour,
                             int code) {
  int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  if (terminal < 0) {
    g_test_skip("the system has no pseudo-terminals");
    return NULL;
  }
  close(terminal);
  g_auto(GStrv) environment = g_get_environ();
  environment = g_environ_setenv(environment, "TERM", "xterm", TRUE);
  environment = g_environ_setenv(environment, "NO_COLOR", no_colour, TRUE);
  g_autofree char *line = g_strconcat("opcflow ", words, NULL);
  g_auto(GStrv) argv = g_strsplit(line, " ", -1);
  pid_t pid = forkpty(&terminal, NULL, NULL, NULL);
  g_assert_cmpint(pid, >=, 0);
  if (!pid) {
    execve(command, argv, environment);
    _exit(1);
  }
  GString *output = g_string_new(NULL);
  char bytes[256];
  ssize_t n;
  while ((n = read(terminal, bytes, sizeof bytes)) > 0)
    g_string_append_len(output, bytes, n);
  close(terminal);
  int status;
  g_assert_cmpint(waitpid(pid, &status, 0), ==, pid);
  g_assert_cmpint(WEXITSTATUS(status), ==, code);
  return g_string_free(output, FALSE);
}

static void test_colour(void) {
  g_autofree char *coloured = say_on_terminal("run none.yaml", "", 5);
  g_autofree char *plain = say_on_terminal("run none.yaml", "1", 5);
  if (!coloured || !plain) return;
  g_assert_nonnull(strstr(coloured, "\033[31merror:\033[0m 'none.yaml'"));
  g_assert_cmpstr(plain, ==, "error: 'none.yaml': no such file\r\n");
  g_assert_null(strchr(plain, '\033'));
}

/* One line, updated in place, shows the progress of each step and point. All
   points share the first step. */
static void test_progress(void) {
  gint64 start = g_get_monotonic_time();
  g_autofree char *output = say_on_terminal(
      "run two.yaml --set b.behave=echo --sweep b.size=[3nm,4nm]", "1", 0);
  if (!output) return;
  double whole = (double)(g_get_monotonic_time() - start) / G_USEC_PER_SEC;
#define AGAIN "\r\033[K"
  const char *a = strstr(output, AGAIN "[1/2] a" AGAIN);
  const char *b = a ? strstr(a, AGAIN "point 1/2 [2/2] b" AGAIN) : NULL;
  if (!b || !strstr(b, AGAIN "point 2/2 [2/2] b" AGAIN)) g_error("%s", output);
  /* The first of 1,201 points takes at least 0.2 s, and less than the whole
     command. The estimated remaining time is 1,200 times as long. */
  const char *first = strstr(b, "b  1/1201  worst 0.5 nm  ");
  int minutes, seconds;
  if (!first || sscanf(first + 25, "%d:%d left", &minutes, &seconds) != 2)
    g_error("%s", output);
  g_assert_cmpint(60 * minutes + seconds, >=, 240);
  g_assert_cmpfloat(60 * minutes + seconds, <, 1200 * whole);
  g_assert_cmpint(seconds, <, 60);
  g_assert_null(strstr(output, "2/1201"));
  g_assert_nonnull(strstr(first, "b  3  worst 0.25" AGAIN));
  g_autofree char *one = say_on_terminal("run two.yaml", "1", 0);
  g_assert_nonnull(strstr(one, AGAIN "[1/2] a" AGAIN "[2/2] b" AGAIN));
  g_autofree char *quiet = say_on_terminal("run two.yaml --quiet", "1", 0);
  g_assert_null(strstr(quiet, "[1/2]"));
}

/* Run opcflow by a shell and return the exit code. */
static int shell(const char *words) {
  g_autofree char *line = g_strdup_printf("%s %s", command, words);
  return program_spawn((const char *const[]){"/bin/sh", "-c", line, NULL});
}

static void test_full(void) {
  if (is_there("/dev/full"))
    g_assert_cmpint(shell("help > /dev/full"), ==, 5);
  else
    g_test_skip("does not exist /dev/full");
}

/* A plugin is not blamed for closed standard streams, and no file receives
   their descriptors. */
static void test_closed(void) {
  g_assert_cmpint(shell("run two.yaml --output closed >&-"), ==, 5);
  g_assert_true(is_there("closed/manifest.json"));
  g_assert_cmpint(shell("run two.yaml --output closed2 2>&-"), ==, 0);
  g_assert_cmpint(shell("run two.yaml --output closed3 <&- 2>&-"), ==, 0);
  g_assert_cmpint(shell("run two.yaml --output closed4 --quiet <&- >&- 2>&-"),
                  ==, 0);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  set_up(FALSE);
  write_two();
  g_test_add_func("/command/usage", test_usage);
  g_test_add_func("/command/echo", test_echo);
  g_test_add_func("/command/stanza", test_stanza);
  g_test_add_func("/command/check", test_check);
  g_test_add_func("/command/forecast", test_forecast);
  g_test_add_func("/command/open_folder", test_open_folder);
  g_test_add_func("/command/verb", test_verb);
  g_test_add_func("/command/verb-help", test_verb_help);
  g_test_add_func("/command/verb-faults", test_verb_faults);
  g_test_add_func("/command/verb-files", test_verb_files);
  g_test_add_func("/command/run", test_run);
  g_test_add_func("/command/manifest", test_manifest);
  g_test_add_func("/command/again", test_again);
  g_test_add_func("/command/json", test_json);
  g_test_add_func("/command/folders", test_folders);
  g_test_add_func("/command/failures", test_failures);
  g_test_add_func("/command/taken", test_taken);
  g_test_add_func("/command/tilde", test_tilde);
  g_test_add_func("/command/log", test_log);
  g_test_add_func("/command/interrupt", test_interrupt);
  g_test_add_func("/command/colour", test_colour);
  g_test_add_func("/command/progress", test_progress);
  g_test_add_func("/command/full", test_full);
  g_test_add_func("/command/closed", test_closed);
  return run_all();
}
