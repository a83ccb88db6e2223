/* SPDX-License-Identifier: BSD-3-Clause */
/* Writing a flow with all its parameters. */
#include <string.h>

#include "core/flow/flow.h"
#include "core/flow/value.h"
#include "core/plugin/declaration.h"

enum { COMMENT_COLUMN = 44 };

/* ---- texts ---- */

/* Whether a text can stand without quotes: nothing in it means anything to
   YAML. */
static gboolean is_plain(const char *text) {
  static const char inner[] = "_./%+-^$";
  size_t n = strlen(text);
  if (!n || text[n - 1] == ' ') return FALSE;
  if (n > 3 && !strncmp(text, "${", 2) && text[n - 1] == '}')
    return strspn(text + 2,
                  "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                  "0123456789_-.") == n - 3;
  if (!g_ascii_isalnum(*text) && *text != '/' && *text != '.' &&
      !(strchr("+-", *text) && g_ascii_isdigit(text[1])))
    return FALSE;
  for (const char *c = text; *c; c++)
    if (!g_ascii_isalnum(*c) && *c != ' ' && !strchr(inner, *c)) return FALSE;
  return !strstr(text, "...");
}

static void append_text(GString *out, const char *text) {
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

/* A text, list or map on one line. */
static void append_node(GString *out, const opc_node *node) {
  if (node->type == OPC_NODE_TEXT) {
    append_text(out, node->text);
    return;
  }
  gboolean map = node->type == OPC_NODE_MAP;
  g_string_append(out, map ? "{ " : "[");
  for (guint i = 0; i < node->items->len; i++) {
    if (i) g_string_append(out, ", ");
    if (map) {
      append_text(out, ((opc_node *)node->keys->pdata[i])->text);
      g_string_append(out, ": ");
    }
    append_node(out, node->items->pdata[i]);
  }
  g_string_append(out, map ? " }" : "]");
}

/* Where the value that ends this line came from. */
static void end_line(GString *out, size_t line_start, const char *origin) {
  size_t length = out->len - line_start;
  int pad = length < COMMENT_COLUMN ? (int)(COMMENT_COLUMN - length) : 1;
  g_autofree char *shown = g_strescape(origin, NULL);
  g_string_append_printf(out, "%*s# %s\n", pad, "", shown);
}

static char *origin_text(const opc_node *node) {
  if (!node) return g_strdup("default");
  g_autofree char *place = opc_place_text(&node->at);
  const char *layer = node->source->layer;
  return layer ? g_strdup_printf("%s, %s", layer, place)
               : g_steal_pointer(&place);
}

/* ---- parameters ---- */

static void append_binding(GString *out, const opc_binding *b, int indent);

static void append_value(GString *out, const opc_binding *b, size_t i,
                         const char *name, int indent) {
  const opc_parameter *p = opc_parameter_at(b->plugin, i);
  g_autofree char *origin = origin_text(b->origin[i]);
  size_t start = out->len;
  g_string_append_printf(out, "%*s%s:", indent, "", name);
  if (b->slots[i]) {
    end_line(out, start, origin);
    append_binding(out, b->slots[i], indent + 2);
    return;
  }
  g_string_append_c(out, ' ');
  if (p->type == OPC_FILE) {
    g_autofree char *path = g_canonicalize_filename(b->values[i].text, NULL);
    append_text(out, path);
  } else if (b->origin[i]) {
    append_node(out, b->origin[i]);
  } else {
    opc_source source = {.name = NULL};
    g_autoptr(opc_problems) problems = opc_problems_new();
    g_autoptr(opc_node) preset = opc_preset_parse(p, &source, problems);
    append_node(out, preset);
  }
  end_line(out, start, origin);
}

/* All parameters whose names begin with `prefix`; a group stands where its
   first member does. As deep as names have dots. */
static void append_level(GString *out, const opc_binding *b, const char *prefix,
                         int indent) {
  g_autoptr(GHashTable) groups =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  for (size_t i = 0; i < b->plugin->n_parameters; i++) {
    const char *name = opc_parameter_at(b->plugin, i)->name;
    if (!g_str_has_prefix(name, prefix) || b->values[i].type == OPC_ABSENT)
      continue;
    const char *rest = name + strlen(prefix), *dot = strchr(rest, '.');
    if (!dot) {
      append_value(out, b, i, rest, indent);
      continue;
    }
    char *group = g_strndup(rest, (gsize)(dot - rest));
    g_autofree char *deeper = g_strdup_printf("%s%s.", prefix, group);
    g_autofree char *shown = g_strdup(group);
    if (!g_hash_table_add(groups, group)) continue;
    g_string_append_printf(out, "%*s%s:\n", indent, "", shown);
    append_level(out, b, deeper, indent + 2);
  }
}

static void append_binding(GString *out, const opc_binding *b, int indent) {
  g_string_append_printf(out, "%*suse: %s\n", indent, "", b->plugin->id);
  append_level(out, b, "", indent);
}

/* ---- the flow ---- */

char *opc_node_line(const opc_node *node) {
  GString *out = g_string_new(NULL);
  append_node(out, node);
  return g_string_free(out, FALSE);
}

const opc_parameter *opc_flow_parameter(const opc_flow *flow,
                                        const char *path) {
  const opc_binding *b = NULL;
  size_t n = strcspn(path, ".");
  for (guint i = 0; i < flow->steps->len; i++) {
    const opc_flow_step *step = flow->steps->pdata[i];
    if (strlen(step->name) == n && !strncmp(step->name, path, n))
      b = step->binding;
  }
  const char *rest = path[n] ? path + n + 1 : "";
  while (b) {
    int found = opc_parameter_find(b->plugin, rest);
    if (found >= 0) return opc_parameter_at(b->plugin, (size_t)found);
    const opc_binding *next = NULL;
    for (size_t i = 0; i < b->plugin->n_parameters && !next; i++) {
      const char *slot = opc_parameter_at(b->plugin, i)->name;
      size_t length = strlen(slot);
      if (!b->slots[i] || strncmp(slot, rest, length) || rest[length] != '.')
        continue;
      next = b->slots[i];
      rest += length + 1;
    }
    b = next;
  }
  return NULL;
}

static void append_swept(GString *out, const opc_parameter *p,
                         const opc_node *node) {
  if (!p || p->type != OPC_FILE || node->type != OPC_NODE_TEXT) {
    append_node(out, node);
    return;
  }
  const char *folder = node->source->folder;
  g_autofree char *path =
      g_build_filename(folder && *folder ? folder : ".", node->text, NULL);
  g_autofree char *whole = g_canonicalize_filename(
      g_path_is_absolute(node->text) ? node->text : path, NULL);
  append_text(out, whole);
}

/* Lists of values, also for what was a range. */
static void append_sweep(GString *out, const opc_flow *flow,
                         const opc_sweep *sweep) {
  g_string_append(out, "sweep:\n");
  for (guint a = 0; a < sweep->axes->len; a++) {
    const opc_axis *axis = sweep->axes->pdata[a];
    const opc_parameter *p = opc_flow_parameter(flow, axis->path);
    size_t start = out->len;
    g_string_append_printf(out, "  %s: [", axis->path);
    for (guint i = 0; i < axis->values->len; i++) {
      if (i) g_string_append(out, ", ");
      append_swept(out, p, axis->values->pdata[i]);
    }
    g_string_append_c(out, ']');
    g_autofree char *origin = opc_place_text(&axis->at);
    end_line(out, start, origin);
  }
}

char *opc_flow_resolved_sweep(const opc_flow *flow, const opc_sweep *sweep) {
  g_autofree char *text = opc_flow_resolved(flow);
  GString *out = g_string_new(text);
  append_sweep(out, flow, sweep);
  return g_string_free(out, FALSE);
}

char *opc_flow_resolved(const opc_flow *flow) {
  GString *out = g_string_new(
      "# The flow as it ran: every parameter, and where its value came from.\n"
      "opcflow: 1\nname: ");
  append_text(out, flow->name);
  g_string_append_c(out, '\n');
  if (flow->description) {
    g_string_append(out, "description: ");
    append_text(out, flow->description);
    g_string_append_c(out, '\n');
  }
  g_string_append(out, "steps:\n");
  for (guint i = 0; i < flow->steps->len; i++) {
    const opc_flow_step *step = flow->steps->pdata[i];
    size_t start = out->len;
    g_autofree char *origin = origin_text(step->key);
    g_string_append_printf(out, "  %s:", step->name);
    end_line(out, start, origin);
    append_binding(out, step->binding, 4);
  }
  return g_string_free(out, FALSE);
}
