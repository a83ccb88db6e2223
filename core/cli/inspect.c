/* SPDX-License-Identifier: BSD-3-Clause */
#include <string.h>

#include "core/cli/cli.h"
#include "core/flow/table.h"
#include "core/flow/value.h"
#include "core/plugin/declaration.h"

static const char *const better[] = {"", "lower", "higher"};

/* ---- as text ---- */

/* What a value may be, beside its type: bounds or choices. */
static char *limits_text(const opc_parameter *p) {
  return p->choices ? g_strdup(p->choices) : opc_bounds_text(p);
}

static const char *default_text(const opc_parameter *p) {
  if (p->flags & OPC_REQUIRED) return "required";
  return p->preset ? p->preset : "-";
}

/* Rows of texts, one after another; each is freed with the table. */
static void print_rows(const char *const *names, size_t n,
                       const GPtrArray *cells) {
  size_t rows = cells->len / n;
  g_autofree const char **data = g_new0(const char *, n *rows + 1);
  g_autofree opc_column *columns = g_new0(opc_column, n);
  for (size_t i = 0; i < n; i++) {
    columns[i] = (opc_column){names[i], NULL, OPC_TEXT, 0, data + i * rows};
    for (size_t row = 0; row < rows; row++)
      data[i * rows + row] = cells->pdata[row * n + i];
  }
  opc_error error;
  opc_table *table = opc_table_new("rows", 0, rows, columns, n, &error);
  g_autofree char *text = opc_table_text(table);
  opc_table_free(table);
  cli_print("\n%s", text);
}

static void print_parameters(const opc_plugin *plugin) {
  static const char *const names[] = {"parameter", "type",   "unit",
                                      "default",   "limits", "what it is"};
  g_autoptr(GPtrArray) cells = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = opc_parameter_at(plugin, i);
    g_ptr_array_add(cells, g_strdup(p->name));
    g_ptr_array_add(cells, g_strdup(opc_type_name(p->type)));
    g_ptr_array_add(cells, g_strdup(p->unit ? p->unit : ""));
    g_ptr_array_add(cells, g_strdup(default_text(p)));
    g_ptr_array_add(cells, limits_text(p));
    g_ptr_array_add(cells, g_strdup(p->summary));
  }
  if (cells->len) print_rows(names, 6, cells);
}

static void print_metrics(const opc_plugin *plugin) {
  static const char *const names[] = {"metric", "unit", "better", "what it is"};
  g_autoptr(GPtrArray) cells = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; i < plugin->n_metrics; i++) {
    const opc_metric *m = opc_metric_at(plugin, i);
    g_ptr_array_add(cells, g_strdup(m->name));
    g_ptr_array_add(cells, g_strdup(m->unit ? m->unit : ""));
    g_ptr_array_add(cells, g_strdup(better[m->better]));
    g_ptr_array_add(cells, g_strdup(m->summary));
  }
  if (cells->len) print_rows(names, 4, cells);
}

static void print_outputs(const opc_plugin *plugin) {
  static const char *const names[] = {"output", "data"};
  g_autoptr(GPtrArray) cells = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; i < opc_port_count(plugin); i++) {
    g_ptr_array_add(cells, g_strdup(opc_port_at(plugin, i)->name));
    g_ptr_array_add(cells, g_strdup(opc_port_at(plugin, i)->kind));
  }
  if (cells->len) print_rows(names, 2, cells);
}

/* What to write for a parameter that has no default. */
static char *example_text(const opc_parameter *p) {
  if (p->preset) return *p->preset ? g_strdup(p->preset) : g_strdup("''");
  switch (p->type) {
    case OPC_INPUT:
      return g_strdup_printf("${%s}", p->choices);
    case OPC_SLOT:
      return g_strdup_printf("{ use: %s.NAME }", p->choices);
    case OPC_REALS:
      return g_strdup("[ ... ]");
    case OPC_MAP:
      return g_strdup("{ ... }");
    case OPC_REAL:
      return g_strdup_printf("...%s%s", p->unit ? " " : "",
                             p->unit ? p->unit : "");
    default:
      return g_strdup("...");
  }
}

/* Whether a parameter whose name begins with `prefix` must be given. */
static gboolean is_needed(const opc_plugin *plugin, const char *prefix) {
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = opc_parameter_at(plugin, i);
    if (g_str_has_prefix(p->name, prefix) && p->flags & OPC_REQUIRED)
      return TRUE;
  }
  return FALSE;
}

/* The names of the groups that parameter i is in and the one before is not. */
static void print_groups(const opc_plugin *plugin, size_t i) {
  const char *name = opc_parameter_at(plugin, i)->name;
  const char *before = i ? opc_parameter_at(plugin, i - 1)->name : "";
  int depth = 1;
  const char *word = name;
  for (const char *dot; (dot = strchr(word, '.')); word = dot + 1, depth++) {
    size_t n = (size_t)(dot - name) + 1;
    if (!strncmp(name, before, n)) continue;
    g_autofree char *prefix = g_strndup(name, n);
    cli_print("%s%*s%.*s:\n", is_needed(plugin, prefix) ? "  " : "  # ",
              2 * depth - 2, "", (int)(dot - word), word);
  }
}

/* What to paste into a flow: the parameters that must be given, the others as
   comments. */
static void print_stanza(const opc_plugin *plugin) {
  const char *dot = strrchr(plugin->id, '.');
  cli_print("\n%s:\n  use: %s\n", dot ? dot + 1 : plugin->id, plugin->id);
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = opc_parameter_at(plugin, i);
    g_autofree char *value = example_text(p);
    g_auto(GStrv) words = g_strsplit(p->name, ".", -1);
    guint n = g_strv_length(words);
    print_groups(plugin, i);
    cli_print("%s%*s%s: %s\n", p->flags & OPC_REQUIRED ? "  " : "  # ",
              2 * (int)n - 2, "", words[n - 1], value);
  }
}

static void print_text(const opc_plugin *plugin, const char *path) {
  cli_print("%s %s, %s: %s\n", plugin->id, plugin->version,
            opc_kind_name(plugin->kind), plugin->summary);
  cli_print("%s; %s%s%s\n", path ? path : "built in", plugin->licence,
            plugin->flags & OPC_DETERMINISTIC ? "; deterministic" : "",
            plugin->flags & OPC_REENTRANT ? "; reentrant" : "");
  print_parameters(plugin);
  print_metrics(plugin);
  print_outputs(plugin);
  print_stanza(plugin);
}

/* ---- as JSON ---- */

static void set_text(JsonBuilder *b, const char *key, const char *text) {
  json_builder_set_member_name(b, key);
  if (text)
    json_builder_add_string_value(b, text);
  else
    json_builder_add_null_value(b);
}

static void set_flag(JsonBuilder *b, const char *key, gboolean value) {
  json_builder_set_member_name(b, key);
  json_builder_add_boolean_value(b, value);
}

static void set_real(JsonBuilder *b, const char *key, double value) {
  json_builder_set_member_name(b, key);
  json_builder_add_double_value(b, value);
}

static void add_parameter(JsonBuilder *b, const opc_parameter *p) {
  json_builder_begin_object(b);
  set_text(b, "name", p->name);
  set_text(b, "type", opc_type_name(p->type));
  set_text(b, "unit", p->unit);
  set_text(b, "default", p->preset);
  set_flag(b, "required", (p->flags & OPC_REQUIRED) != 0);
  if (p->flags & OPC_AT_LEAST) set_real(b, "at_least", p->min);
  if (p->flags & OPC_ABOVE) set_real(b, "above", p->min);
  if (p->flags & OPC_AT_MOST) set_real(b, "at_most", p->max);
  if (p->flags & OPC_BELOW) set_real(b, "below", p->max);
  set_flag(b, "changes_result", !(p->flags & OPC_NO_EFFECT));
  json_builder_set_member_name(b, "choices");
  json_builder_begin_array(b);
  g_auto(GStrv) words = p->choices ? opc_choice_list(p->choices) : NULL;
  for (guint i = 0; words && words[i]; i++)
    json_builder_add_string_value(b, words[i]);
  json_builder_end_array(b);
  set_text(b, "summary", p->summary);
  json_builder_end_object(b);
}

static void add_metric(JsonBuilder *b, const opc_metric *m) {
  json_builder_begin_object(b);
  set_text(b, "name", m->name);
  set_text(b, "unit", m->unit);
  set_text(b, "better", m->better ? better[m->better] : "neutral");
  set_real(b, "tolerance", m->tolerance);
  set_text(b, "summary", m->summary);
  json_builder_end_object(b);
}

static void print_json(const opc_plugin *plugin, const char *path) {
  JsonBuilder *b = json_builder_new();
  json_builder_begin_object(b);
  set_text(b, "id", plugin->id);
  set_text(b, "version", plugin->version);
  set_text(b, "licence", plugin->licence);
  set_text(b, "summary", plugin->summary);
  set_text(b, "kind", opc_kind_name(plugin->kind));
  set_text(b, "path", path);
  set_flag(b, "deterministic", (plugin->flags & OPC_DETERMINISTIC) != 0);
  set_flag(b, "reentrant", (plugin->flags & OPC_REENTRANT) != 0);
  json_builder_set_member_name(b, "parameters");
  json_builder_begin_array(b);
  for (size_t i = 0; i < plugin->n_parameters; i++)
    add_parameter(b, opc_parameter_at(plugin, i));
  json_builder_end_array(b);
  json_builder_set_member_name(b, "metrics");
  json_builder_begin_array(b);
  for (size_t i = 0; i < plugin->n_metrics; i++)
    add_metric(b, opc_metric_at(plugin, i));
  json_builder_end_array(b);
  json_builder_set_member_name(b, "outputs");
  json_builder_begin_array(b);
  for (size_t i = 0; i < opc_port_count(plugin); i++) {
    json_builder_begin_object(b);
    set_text(b, "name", opc_port_at(plugin, i)->name);
    set_text(b, "data", opc_port_at(plugin, i)->kind);
    json_builder_end_object(b);
  }
  json_builder_end_array(b);
  json_builder_end_object(b);
  cli_print_json(json_builder_get_root(b));
  g_object_unref(b);
}

/* ---- entry ---- */

static int run(const cli_verb *verb, int argc, char **argv) {
  gboolean json = FALSE;
  const cli_option options[] = {{"json", NULL, "as JSON", &json, NULL, NULL},
                                {0}};
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  int code = cli_parse(verb, argc, argv, options, 1, 1, rest);
  if (code >= 0) return code;
  g_autoptr(opc_registry) registry = opc_registry_new(cli_plugin_path());
  opc_error error = {0};
  const opc_plugin *plugin =
      opc_registry_find(registry, rest->pdata[0], &error);
  if (!plugin) {
    cli_message("error", "%s", error.message);
    return cli_exit_code(error.code);
  }
  const char *path = opc_registry_path(registry, plugin);
  if (json)
    print_json(plugin, path);
  else
    print_text(plugin, path);
  return CLI_GOOD;
}

const cli_verb cli_inspect = {.name = "inspect",
                              .arguments = "ID",
                              .summary = "Tell all about a plugin",
                              .run = run};
