/* SPDX-License-Identifier: BSD-3-Clause */
/* Printable forms of texts. The JSON forms are compared with the parser of
   JSON-GLib. */
#include <base/shown.h>
#include <json-glib/json-glib.h>

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

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/shown/text", test_text);
  g_test_add_func("/shown/json", test_json);
  return g_test_run();
}
