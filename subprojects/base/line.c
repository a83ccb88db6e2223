/* SPDX-License-Identifier: BSD-3-Clause */
/* A node as YAML on one line, quoted only where necessary. */
#include <base/node.h>
#include <string.h>

#define LETTERS G_CSET_a_2_z G_CSET_A_2_Z G_CSET_DIGITS "_-."

/* Return whether a text is plain YAML without special characters, so that
   quotes are unnecessary. */
static gboolean is_plain(const char *text) {
  size_t n = strlen(text);
  if (!n || text[n - 1] == ' ') return FALSE;
  if (n > 3 && !strncmp(text, "${", 2) && text[n - 1] == '}')
    return strspn(text + 2, LETTERS) == n - 3;
  if (!g_ascii_isalnum(*text) && *text != '/' && *text != '.' &&
      !(strchr("+-", *text) && g_ascii_isdigit(text[1])))
    return FALSE;
  return strspn(text, LETTERS " /%+^$") == n && !strstr(text, "...");
}

void opc_text_append(GString *out, const char *text) {
  if (is_plain(text)) {
    g_string_append(out, text);
    return;
  }
  g_string_append_c(out, '"');
  for (const char *c = text; *c; c = g_utf8_next_char(c)) {
    gunichar u = g_utf8_get_char(c);
    if (u == '"' || u == '\\')
      g_string_append_printf(out, "\\%c", (char)u);
    else if (u < 0x20 || (u >= 0x7F && u < 0xA0))
      g_string_append_printf(out, "\\x%02X", u);
    else if (u == 0x85 || u == 0x2028 || u == 0x2029 || u == 0xFEFF)
      g_string_append_printf(out, "\\u%04X", u);
    else
      g_string_append_unichar(out, u);
  }
  g_string_append_c(out, '"');
}

/* Append a text, list or map on one line. */
void opc_node_append(GString *out, const opc_node *node) {
  if (node->type == OPC_NODE_TEXT) {
    opc_text_append(out, node->text);
    return;
  }
  gboolean map = node->type == OPC_NODE_MAP;
  g_string_append(out, map ? "{ " : "[");
  for (guint i = 0; i < node->items->len; i++) {
    if (i) g_string_append(out, ", ");
    if (map) {
      opc_text_append(out, opc_node_key(node, i));
      g_string_append(out, ": ");
    }
    opc_node_append(out, node->items->pdata[i]);
  }
  g_string_append(out, map ? " }" : "]");
}

char *opc_node_line(const opc_node *node) {
  GString *out = g_string_new(NULL);
  opc_node_append(out, node);
  return g_string_free(out, FALSE);
}
