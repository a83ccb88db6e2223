/* SPDX-License-Identifier: BSD-3-Clause */
/* Printable forms of unprintable characters. */
#include <base/shown.h>
#include <glib.h>
#include <string.h>

static void append_text(GString *out, gunichar c) {
  if (c == '\n' || c == '\t')
    g_string_append(out, c == '\n' ? "\\n" : "\\t");
  else
    g_string_append_printf(out, "\\u{%x}", c);
}

/* Append an escape; characters beyond 16 bits become surrogate pairs. */
static void append_json(GString *out, gunichar c) {
  if (c < 0x10000)
    g_string_append_printf(out, "\\u%04x", c);
  else
    g_string_append_printf(out, "\\u%04x\\u%04x", 0xD7C0 + (c >> 10),
                           0xDC00 + (c & 0x3FF));
}

/* Return a printable copy; `escape` precedes an invalid byte. */
static char *text_printable(const char *text, const char *keep,
                            const char *escape,
                            void (*append)(GString *, gunichar)) {
  GString *out = g_string_sized_new(strlen(text));
  while (*text) {
    gunichar c = g_utf8_get_char_validated(text, -1);
    if (c > 0x10FFFF) {
      g_string_append(out, escape);
      g_string_append_printf(out, "x%02x", (guchar)*text++);
      continue;
    }
    if (g_unichar_isprint(c) || (c < 128 && strchr(keep, (int)c)))
      g_string_append_unichar(out, c);
    else
      append(out, c);
    text = g_utf8_next_char(text);
  }
  return g_string_free(out, FALSE);
}

char *opc_shown(const char *text, const char *keep) {
  return text_printable(text, keep, "\\", append_text);
}

char *opc_shown_json(const char *json) {
  return text_printable(json, "\n", "\\\\", append_json);
}

void opc_show_in_place(char *text, size_t size) {
  const char *end;
  text[size - 1] = 0;
  g_utf8_validate(text, -1, &end);
  text[end - text] = 0;
  g_strdelimit(text, "\n\r\t\033", ' ');
}
