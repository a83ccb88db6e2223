/* SPDX-License-Identifier: BSD-3-Clause */
/* Printable forms of texts, and the output and options of a command. The JSON
   forms are compared with the parser of JSON-GLib. */
#include <base/cli.h>
#include <base/shown.h>
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static void assert_shown(const char *text, const char *keep, const char *want) {
  g_autofree char *shown = opc_shown(text, keep);
  g_assert_cmpstr(shown, ==, want);
  g_assert_true(g_utf8_validate(shown, -1, NULL));
  g_autofree char *again = opc_shown(shown, "");
  if (!*keep) g_assert_cmpstr(again, ==, want);
}

static void test_text(void) {
  assert_shown("", "", "");
  assert_shown("plain 'text' \\ 1 \xC2\xB5m, \xE2\x82\xAC", "",
               "plain 'text' \\ 1 \xC2\xB5m, \xE2\x82\xAC");
  assert_shown("\033[31mred\007\177", "", "\\u{1b}[31mred\\u{7}\\u{7f}");
  assert_shown("one\nnote: all is well\r\t", "",
               "one\\nnote: all is well\\u{d}\\t");
  assert_shown("one\ntwo\t\r", "\n\t", "one\ntwo\t\\u{d}");
  assert_shown(
      "\xC2\x9B"
      "2J",
      "", "\\u{9b}2J"); /* CSI of eight bits */
  assert_shown(
      "\xE2\x80\xAE"
      "fdp",
      "", "\\u{202e}fdp"); /* right to left */
  assert_shown("a\xFF\xC3(\xED\xA0\x80", "", "a\\xff\\xc3(\\xed\\xa0\\x80");
  assert_shown("cut \xE2\x82", "", "cut \\xe2\\x82");
}

static void test_json(void) {
  static const char *const want[][2] = {
      {"\"a\xFF\"", "a\\xff"},
      {"\"\x1F\"", "\x1F"},
      {"\"\xC2\x9B\"", "\xC2\x9B"},
      {"\"\xF3\xA0\x80\x81\"", "\xF3\xA0\x80\x81"}, /* U+E0001 */
      {"\"\\n\xE2\x82\xAC\"", "\n\xE2\x82\xAC"}};
  for (size_t i = 0; i < G_N_ELEMENTS(want); i++) {
    g_autofree char *line = g_strdup_printf("[%s]\n", want[i][0]);
    g_autofree char *shown = opc_shown_json(line);
    for (const char *c = shown; *c; c++) g_assert_true(*c == '\n' || *c & 0xE0);
    g_autoptr(JsonParser) parser = json_parser_new();
    g_autoptr(GError) error = NULL;
    json_parser_load_from_data(parser, shown, -1, &error);
    g_assert_no_error(error);
    JsonArray *list = json_node_get_array(json_parser_get_root(parser));
    g_assert_cmpstr(json_array_get_string_element(list, 0), ==, want[i][1]);
  }
}

/* ---- commands ---- */

static gboolean flag;
static const char *text;
static GPtrArray *list;
static const cli_option options[] = {
    {"flag", "a flag", .flag = &flag},
    {"text", "a text", "TEXT", .text = &text},
    {"item", "several texts", "TEXT", .list = &list},
    {0}};

/* Read the options of a line until the first refused option. Return TRUE if
   none is refused. */
static gboolean take_options(const char *line) {
  static GStrv words; /* the values are parts of the words */
  const cli_option *const tables[] = {options, NULL};
  g_strfreev(words);
  words = g_strsplit(line, " ", -1);
  gboolean good = TRUE;
  for (guint i = 0; words[i] && good; i++)
    good = cli_take_option(tables, "try", g_strv_length(words), words, &i);
  return good;
}

/* Run `write` in a child process; return its output, a line "--", and its
   messages (g_free). */
static char *output_of(void (*write)(void)) {
  char name[] = "/tmp/opcflow-XXXXXX";
  close(g_mkstemp(name));
  g_autofree char *second = g_strconcat(name, ".err", NULL);
  fflush(NULL);
  pid_t child = fork();
  if (!child) {
    if (!freopen(name, "w", stdout) || !freopen(second, "w", stderr)) _exit(99);
    cli_keep_output();
    write();
    exit(cli_is_written() ? 0 : 1);
  }
  int status;
  g_assert_cmpint(waitpid(child, &status, 0), ==, child);
  g_assert_cmpint(status, ==, 0);
  g_autofree char *out = NULL, *err = NULL;
  g_assert_true(g_file_get_contents(name, &out, NULL, NULL));
  g_assert_true(g_file_get_contents(second, &err, NULL, NULL));
  g_unlink(name);
  g_unlink(second);
  return g_strconcat(out, "--\n", err, NULL);
}

static void write_lines(void) {
  printf("of a plugin\n");
  cli_print("a\033\tb\n");
  cli_write("a\033\n");
  cli_print_options(options + 1);
  cli_message("warning", "x\ny");
  cli_message(NULL, "no %s", "kind");
  cli_flush();
  cli_return_output();
  printf("of a program\n");
  fflush(stdout);
  cli_be_silent();
  cli_print("never");
  cli_message("error", "never");
}

/* Standard output belongs to the command; plugins write to standard error. */
static void test_output(void) {
  g_autofree char *found = output_of(write_lines);
  g_assert_cmpstr(found, ==,
                  "a\\u{1b}\tb\na\033\n"
                  "  --text TEXT                   a text\n"
                  "  --item TEXT                   several texts\n"
                  "of a program\n--\nof a plugin\nwarning: x\\ny\nno kind\n");
}

static void write_refusals(void) {
  static const char *const lines[] = {"--flga",  "--zzzzzzz", "-flag", "x",
                                      "---flag", "--flag=1",  "--text"};
  for (size_t i = 0; i < G_N_ELEMENTS(lines); i++)
    if (take_options(lines[i])) cli_message(NULL, "%s is taken", lines[i]);
}

static void test_options(void) {
  g_assert_true(take_options("--item 1 --flag --text=a=b --item=2"));
  g_assert_true(flag);
  g_assert_cmpstr(text, ==, "a=b");
  for (int i = 0; i < 2; i++) {
    const char *const *items = cli_list(list);
    g_assert_cmpstr(items[0], ==, "1");
    g_assert_cmpstr(items[1], ==, "2");
    g_assert_null(items[2]);
  }
  g_assert_null(*cli_list(NULL));
  g_ptr_array_free(list, TRUE);
  g_autofree char *found = output_of(write_refusals);
  g_assert_cmpstr(
      found, ==,
      "--\nerror: unknown option '--flga' of 'try', did you mean '--flag'?\n"
      "error: unknown option '--zzzzzzz', see 'opcflow help try'\n"
      "error: unknown option '-flag' of 'try', did you mean '--flag'?\n"
      "error: unknown option 'x', see 'opcflow help try'\n"
      "error: unknown option '---flag' of 'try', did you mean '--flag'?\n"
      "error: option '--flag' takes no value\n"
      "error: option '--text' requires a value: TEXT\n");
}

static void write_width(void) {
  static const char *const widths[] = {"80", "0", "x"};
  for (size_t i = 0; i < G_N_ELEMENTS(widths); i++) {
    g_setenv("COLUMNS", widths[i], TRUE);
    cli_print("%zd\n", (ssize_t)cli_width());
  }
}

/* Without a positive COLUMNS, output to a file has no width. */
static void test_width(void) {
  g_autofree char *found = output_of(write_width);
  g_assert_cmpstr(found, ==, "80\n-1\n-1\n--\n");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/shown/text", test_text);
  g_test_add_func("/shown/json", test_json);
  g_test_add_func("/cli/output", test_output);
  g_test_add_func("/cli/options", test_options);
  g_test_add_func("/cli/width", test_width);
  return g_test_run();
}
