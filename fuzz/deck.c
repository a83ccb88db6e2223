/* SPDX-License-Identifier: BSD-3-Clause */
/* Fuzzes deck_write with a SPICE deck and a file that the deck includes. Each
   resulting line must be a title, a continuation or a known statement. */
#include <glib.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz.h"
#include "simulator/deck.h"

/* Return whether a line begins with a statement of the simulator's manual. The
   list is independent of the code under test. */
static int is_known(const char *line) {
  static const char *const begins[] = {
      ".model",  ".param",  ".subckt",  ".ends",  ".global", ".func",
      ".if",     ".elseif", ".else",    ".endif", ".save",   ".end",
      ".option", ".opt",    ".options", "+"};
  size_t n = strcspn(line, " (),='\"{\n");
  if (g_ascii_isalpha(*line)) return !strchr("AaNnUuYyPp", *line);
  for (size_t i = 0; i < G_N_ELEMENTS(begins); i++)
    if (strlen(begins[i]) == n && !g_ascii_strncasecmp(line, begins[i], n))
      return 1;
  return 0;
}

static void deck_check(const char *deck) {
  opc_error error;
  char *out = deck_write(deck, NULL, &error);
  if (!out) return;
  g_assert_true(g_str_has_prefix(out, "opcflow\n"));
  for (const char *at = out; *at; at = strchr(at, '\n') + 1)
    if (!is_known(at)) g_error("the deck has the unknown statement '%s'", at);
  for (const char *c = out; *c; c++)
    g_assert_true(*c == '\n' || (*c >= 32 && *c < 127 && *c != '`'));
  free(out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  g_autofree char *text = g_strndup((const char *)data, size);
  g_autofree char *deck =
      g_strdup_printf("title\n.include '%s'\n.end\n", fuzz_file(data, size));
  deck_check(text);
  deck_check(deck);
  return 0;
}
