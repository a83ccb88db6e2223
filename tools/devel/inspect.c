/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow inspect: prints the declaration of a plugin. */
#include <string.h>

#include "core/cli/cli.h"
#include "core/plugin/declaration.h"
#include "core/plugin/value.h"
#include "tools/devel/verbs.h"

static const char *const better[] = {"neutral", "lower", "higher"};

/* ---- as text ---- */

/* Add a row of `n` texts; NULL is printed as an empty cell. */
static void add_row(GPtrArray *cells, const char *const *texts, size_t n) {
  for (size_t i = 0; i < n; i++)
    g_ptr_array_add(cells, g_strdup(texts[i] ? texts[i] : ""));
}

static void print_cells(const char *const *names, size_t n,
                        const GPtrArray *cells) {
  if (!cells->len) return;
  cli_print("\n");
  cli_print_rows(names, n, cells);
}

static void print_parameters(const opc_plugin *plugin) {
  static const char *const names[] = {"parameter", "type",   "unit",
                                      "default",   "limits", "meaning"};
  g_autoptr(GPtrArray) cells = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = &plugin->parameters[i];
    g_autofree char *bounds = opc_bounds_text(p);
    const char *given = p->preset ? p->preset : p->follows ? p->follows : "-";
    const char *const row[] = {p->name,
                               opc_type_name(p->type),
                               p->unit,
                               p->flags & OPC_REQUIRED ? "required" : given,
                               p->choices ? p->choices : bounds,
                               p->summary};
    add_row(cells, row, 6);
  }
  print_cells(names, 6, cells);
}

static void print_metrics(const opc_plugin *plugin) {
  static const char *const names[] = {"metric", "unit", "better", "meaning"};
  g_autoptr(GPtrArray) cells = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; i < plugin->n_metrics; i++) {
    const opc_metric *m = &plugin->metrics[i];
    const char *const row[] = {m->name, m->unit,
                               m->better ? better[m->better] : "", m->summary};
    add_row(cells, row, 4);
  }
  print_cells(names, 4, cells);
}

static void print_outputs(const opc_plugin *plugin) {
  static const char *const names[] = {"output", "data"};
  g_autoptr(GPtrArray) cells = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; i < opc_port_count(plugin); i++) {
    const opc_port *port = opc_port_at(plugin, i);
    add_row(cells, (const char *const[]){port->name, port->kind}, 2);
  }
  print_cells(names, 2, cells);
}

/* Return an example for a parameter that has no default. */
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

/* Return TRUE if a parameter whose name begins with `prefix` is required. */
static gboolean is_needed(const opc_plugin *plugin, const char *prefix) {
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = &plugin->parameters[i];
    if (g_str_has_prefix(p->name, prefix) && p->flags & OPC_REQUIRED)
      return TRUE;
  }
  return FALSE;
}

/* Return whether a parameter before `end` has the first n bytes of its name. */
static gboolean group_is_printed(const opc_plugin *plugin, size_t end,
                                 size_t n) {
  for (size_t i = 0; i < end; i++)
    if (!strncmp(plugin->parameters[i].name, plugin->parameters[end].name, n))
      return TRUE;
  return FALSE;
}

/* Print the parameters and groups whose names begin with `prefix`. Optional
   parameters are printed as comments. */
static void print_level(const opc_plugin *plugin, const char *prefix,
                        int depth) {
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = &plugin->parameters[i];
    if (!g_str_has_prefix(p->name, prefix)) continue;
    const char *word = p->name + strlen(prefix), *dot = strchr(word, '.');
    size_t n = dot ? (size_t)(dot - p->name) + 1 : strlen(p->name);
    if (dot && group_is_printed(plugin, i, n)) continue;
    g_autofree char *name = g_strndup(p->name, n);
    g_autofree char *value = dot ? NULL : example_text(p);
    gboolean needed =
        dot ? is_needed(plugin, name) : (p->flags & OPC_REQUIRED) != 0;
    cli_print("%s%*s%.*s:%s%s\n", needed ? "  " : "  # ", depth, "",
              (int)strcspn(word, "."), word, dot ? "" : " ", dot ? "" : value);
    if (dot) print_level(plugin, name, depth + 2);
  }
}

/* Print a step with all parameters, in the syntax of a flow. */
static void print_stanza(const opc_plugin *plugin) {
  const char *dot = strrchr(plugin->id, '.');
  cli_print("\n%s:\n  use: %s\n", dot ? dot + 1 : plugin->id, plugin->id);
  print_level(plugin, "", 0);
}

static void print_text(const opc_plugin *plugin, const char *path) {
  cli_print("%s %s, %s: %s\n", plugin->id, plugin->version, plugin->kind,
            plugin->summary);
  cli_print("%s; %s%s%s\n", path, plugin->licence,
            plugin->flags & OPC_DETERMINISTIC ? "; deterministic" : "",
            plugin->flags & OPC_REENTRANT ? "; reentrant" : "");
  print_parameters(plugin);
  print_metrics(plugin);
  print_outputs(plugin);
  if (strcmp(plugin->kind, OPC_KIND_COMMAND) != 0 &&
      strcmp(plugin->kind, OPC_KIND_KIND) != 0)
    print_stanza(plugin);
}

/* ---- as JSON ---- */

static JsonObject *parameter_json(const opc_parameter *p) {
  JsonObject *o = json_object_new();
  json_object_set_string_member(o, "name", p->name);
  json_object_set_string_member(o, "type", opc_type_name(p->type));
  json_object_set_string_member(o, "unit", p->unit);
  json_object_set_string_member(o, "default", p->preset);
  if (p->follows) json_object_set_string_member(o, "follows", p->follows);
  json_object_set_boolean_member(o, "required", p->flags & OPC_REQUIRED);
  if (p->flags & OPC_AT_LEAST)
    json_object_set_double_member(o, "at_least", p->min);
  if (p->flags & OPC_ABOVE) json_object_set_double_member(o, "above", p->min);
  if (p->flags & OPC_AT_MOST)
    json_object_set_double_member(o, "at_most", p->max);
  if (p->flags & OPC_BELOW) json_object_set_double_member(o, "below", p->max);
  json_object_set_boolean_member(o, "changes_result",
                                 !(p->flags & OPC_NO_EFFECT));
  g_auto(GStrv) words = p->choices ? opc_choice_list(p->choices) : NULL;
  JsonArray *choices = json_array_new();
  for (guint i = 0; words && words[i]; i++)
    json_array_add_string_element(choices, words[i]);
  json_object_set_array_member(o, "choices", choices);
  json_object_set_string_member(o, "summary", p->summary);
  return o;
}

static JsonObject *metric_json(const opc_metric *m) {
  JsonObject *o = json_object_new();
  json_object_set_string_member(o, "name", m->name);
  json_object_set_string_member(o, "unit", m->unit);
  json_object_set_string_member(o, "better", better[m->better]);
  json_object_set_double_member(o, "tolerance", m->tolerance);
  json_object_set_string_member(o, "summary", m->summary);
  return o;
}

static void print_json(const opc_plugin *plugin, const char *path) {
  JsonObject *o = json_object_new();
  json_object_set_string_member(o, "id", plugin->id);
  json_object_set_string_member(o, "version", plugin->version);
  json_object_set_string_member(o, "licence", plugin->licence);
  json_object_set_string_member(o, "summary", plugin->summary);
  json_object_set_string_member(o, "kind", plugin->kind);
  json_object_set_string_member(o, "path", path);
  json_object_set_boolean_member(o, "deterministic",
                                 plugin->flags & OPC_DETERMINISTIC);
  json_object_set_boolean_member(o, "reentrant", plugin->flags & OPC_REENTRANT);
  JsonArray *list = json_array_new();
  for (size_t i = 0; i < plugin->n_parameters; i++)
    json_array_add_object_element(list, parameter_json(&plugin->parameters[i]));
  json_object_set_array_member(o, "parameters", list);
  list = json_array_new();
  for (size_t i = 0; i < plugin->n_metrics; i++)
    json_array_add_object_element(list, metric_json(&plugin->metrics[i]));
  json_object_set_array_member(o, "metrics", list);
  list = json_array_new();
  for (size_t i = 0; i < opc_port_count(plugin); i++) {
    JsonObject *port = json_object_new();
    json_object_set_string_member(port, "name", opc_port_at(plugin, i)->name);
    json_object_set_string_member(port, "data", opc_port_at(plugin, i)->kind);
    json_array_add_object_element(list, port);
  }
  json_object_set_array_member(o, "outputs", list);
  cli_print_object(o);
}

/* ---- entry ---- */

static gboolean json;

static const cli_option options[] = {
    {"json", "print the result as JSON", .flag = &json}, {0}};

static int inspect_run(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb;
  opc_error error = {0};
  const opc_plugin *plugin =
      opc_registry_find(cli_registry(), arguments->pdata[0], &error);
  if (!plugin) return cli_fail(&error);
  const char *path = opc_registry_path(cli_registry(), plugin);
  if (json)
    print_json(plugin, path);
  else
    print_text(plugin, path);
  return CLI_GOOD;
}

const cli_verb devel_inspect = {CLI_INSPECT, .options = options, .least = 1,
                                .most = 1, .run = inspect_run};
