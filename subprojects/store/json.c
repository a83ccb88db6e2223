/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes JSON with numbers in their shortest exact form. */
#include <base/shown.h>
#include <base/unit.h>
#include <store/json.h>
#include <string.h>

/* Write the numbers of a JSON text in their shortest exact form. The function
   also repairs numbers that json-glib 1.6 writes as "1e-07.0", which is not
   JSON. */
static char *shorten_numbers(const char *text) {
  GString *out = g_string_sized_new(strlen(text));
  gboolean quoted = FALSE;
  while (*text) {
    size_t n = quoted ? 0 : opc_number_length(text);
    if (n && strcspn(text, ".e") < n) {
      g_autofree char *number = opc_number_text(g_ascii_strtod(text, NULL));
      g_string_append(out, number);
      if (!strpbrk(number, ".e")) g_string_append(out, ".0");
      text += n;
      if (!strncmp(text, ".0", 2)) text += 2;
      continue;
    }
    n = MAX(n, 1);
    if (*text == '"') quoted = !quoted;
    if (quoted && *text == '\\') n = 2;
    g_string_append_len(out, text, (gssize)n);
    text += n;
  }
  return g_string_free(out, FALSE);
}

char *opc_json_text(JsonNode *node) {
  g_autofree char *text = json_to_string(node, TRUE);
  json_node_unref(node);
  g_autofree char *better = shorten_numbers(text);
  g_autofree char *shown = opc_shown_json(better);
  return g_strconcat(shown, "\n", NULL);
}
