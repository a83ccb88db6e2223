/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes a flow with all its parameters. */
#include <string.h>

#include "core/binding/lookup.h"
#include "core/binding/resolve.h"
#include "core/plugin/value.h"

enum { COMMENT_COLUMN = 44 };

/* Append the origin of the value as a comment at the end of the line. */
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

/* Append a value; names of files become absolute. `p` may be NULL. */
static void append_node(GString *out, const opc_parameter *p,
                        const opc_node *node) {
  if (!p || p->type != OPC_FILE || node->type != OPC_NODE_TEXT) {
    opc_node_append(out, node);
    return;
  }
  g_autofree char *path = opc_node_path(node);
  g_autofree char *whole = g_canonicalize_filename(path, NULL);
  opc_text_append(out, whole);
}

static void append_binding(GString *out, const opc_binding *b, int indent);

static void append_value(GString *out, const opc_binding *b, size_t i,
                         const char *name, int indent) {
  const opc_parameter *p = &b->plugin->parameters[i];
  g_autofree char *origin = origin_text(b->origin[i]);
  size_t start = out->len;
  g_string_append_printf(out, "%*s%s:", indent, "", name);
  if (b->slots[i]) {
    end_line(out, start, origin);
    append_binding(out, b->slots[i], indent + 2);
    return;
  }
  g_string_append_c(out, ' ');
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) preset =
      b->origin[i] ? NULL : opc_preset_parse(p, problems);
  append_node(out, p, preset ? preset : b->origin[i]);
  end_line(out, start, origin);
}

/* Append all parameters whose names begin with `prefix`; a group is written at
   the first member. The depth of recursion is the number of dots in names. */
static void append_level(GString *out, const opc_binding *b, const char *prefix,
                         int indent) {
  g_autoptr(GHashTable) groups =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  for (size_t i = 0; i < b->plugin->n_parameters; i++) {
    const char *name = b->plugin->parameters[i].name;
    if (!g_str_has_prefix(name, prefix) || !b->values[i].present) continue;
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

/* Append the axes as lists of values; ranges are expanded. */
static void append_sweep(GString *out, const opc_flow *flow,
                         const opc_sweep *sweep) {
  g_string_append(out, "sweep:\n");
  for (guint a = 0; a < sweep->axes->len; a++) {
    const opc_axis *axis = sweep->axes->pdata[a];
    const opc_parameter *p = opc_flow_parameter(flow, axis->info.path);
    size_t start = out->len;
    g_string_append_printf(out, "  %s: [", axis->info.path);
    for (guint i = 0; i < axis->values->len; i++) {
      if (i) g_string_append(out, ", ");
      append_node(out, p, axis->values->pdata[i]);
    }
    g_string_append_c(out, ']');
    g_autofree char *origin = opc_place_text(&axis->at);
    end_line(out, start, origin);
  }
}

static void append_requirements(GString *out, const opc_flow *flow) {
  if (flow->requirements->len) g_string_append(out, "require:\n");
  for (guint i = 0; i < flow->requirements->len; i++) {
    const opc_requirement *r = flow->requirements->pdata[i];
    g_autofree char *origin = origin_text(r->value);
    size_t start = out->len;
    g_string_append_printf(out, "  %s: ", r->path);
    opc_node_append(out, r->value);
    end_line(out, start, origin);
  }
}

char *opc_flow_resolved(const opc_flow *flow, const opc_sweep *sweep) {
  GString *out = g_string_new(
      "# The flow of this run: every parameter, with the source of the "
      "value.\n"
      "opcflow: 1\nname: ");
  opc_text_append(out, flow->name);
  g_string_append_c(out, '\n');
  if (flow->recipe->description) {
    g_string_append(out, "description: ");
    opc_text_append(out, flow->recipe->description);
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
  append_requirements(out, flow);
  if (sweep) append_sweep(out, flow, sweep);
  return g_string_free(out, FALSE);
}
