/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow schema: converts the declarations of plugins to a JSON Schema. The
   file data/flow.schema.json has the part that does not depend on plugins. */
#include "tools/devel/schema.h"

#include <base/unit.h>
#include <store/files.h>
#include <string.h>

#include "core/cli/cli.h"
#include "core/plugin/declaration.h"
#include "core/plugin/value.h"
#include "core/report/json.h"
#include "tools/devel/opcflow-schema.h"
#include "tools/devel/verbs.h"

#define NUMBER "[+-]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+-]?[0-9]+)?"
#define REFERENCE "[A-Za-z0-9_][A-Za-z0-9_-]*(\\.[A-Za-z0-9_.-]+)?"

/* ---- trees as JSON ---- */

static JsonNode *text_json(const opc_node *node) {
  JsonNode *json = json_node_alloc();
  const char *text = node->text;
  size_t n = strlen(text);
  if (node->plain && (!strcmp(text, "true") || !strcmp(text, "false")))
    return json_node_init_boolean(json, *text == 't');
  if (opc_node_is_empty(node) || opc_node_is_null(node))
    return json_node_init_null(json);
  if (!node->plain || opc_number_length(text) != n)
    return json_node_init_string(json, text);
  if (strspn(text, "+-0123456789") == n && n < 18)
    return json_node_init_int(json, g_ascii_strtoll(text, NULL, 10));
  return json_node_init_double(json, g_ascii_strtod(text, NULL));
}

JsonNode *opc_node_json(const opc_node *node) {
  if (node->type == OPC_NODE_TEXT) return text_json(node);
  g_autoptr(JsonArray) array = json_array_new();
  g_autoptr(JsonObject) object = json_object_new();
  for (guint i = 0; i < node->items->len; i++) {
    JsonNode *item = opc_node_json(node->items->pdata[i]);
    if (node->keys)
      json_object_set_member(object, opc_node_key(node, i), item);
    else
      json_array_add_element(array, item);
  }
  return node->keys ? json_node_init_object(json_node_alloc(), object)
                    : json_node_init_array(json_node_alloc(), array);
}

/* ---- JSON objects ---- */

/* Return an object from YAML or JSON text. */
static JsonObject *piece(const char *text) {
  static const opc_source source = {.name = (char *)"schema"};
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) node =
      opc_node_parse(&source, text, strlen(text), problems);
  g_autoptr(JsonNode) json = opc_node_json(node);
  return json_node_dup_object(json);
}

static void set_text(JsonObject *o, const char *key, const char *text) {
  json_object_set_string_member(o, key, text);
}

/* Return the object `key` of `o`, created if missing. */
static JsonObject *object_member(JsonObject *o, const char *key) {
  if (!json_object_has_member(o, key))
    json_object_set_object_member(o, key, json_object_new());
  return json_object_get_object_member(o, key);
}

/* Return the list `key` of `o`, created if missing. */
static JsonArray *object_list(JsonObject *o, const char *key) {
  if (!json_object_has_member(o, key))
    json_object_set_array_member(o, key, json_array_new());
  return json_object_get_array_member(o, key);
}

static JsonObject *new_reference(const char *prefix, const char *name) {
  JsonObject *o = json_object_new();
  g_autofree char *target = g_strconcat("#/definitions/", prefix, name, NULL);
  set_text(o, "$ref", target);
  return o;
}

/* ---- values ---- */

/* Return the schema of a number with a unit of the dimension of `unit`, or of 0
   without a unit (not for temperatures). */
static JsonObject *number_with_unit(const char *unit) {
  int zero = opc_unit_shares_zero(opc_unit_find(unit));
  const char *noun = opc_unit_noun(opc_unit_find(unit));
  g_autoptr(GString) pattern = g_string_new("^" NUMBER " *(");
  g_autoptr(GPtrArray) names = opc_unit_names();
  const char *between = "";
  for (guint i = 0; i < names->len; i++) {
    const char *name = names->pdata[i];
    if (opc_unit_noun(opc_unit_find(name)) != noun) continue;
    g_autofree char *escaped = g_regex_escape_string(name, -1);
    g_string_append_printf(pattern, "%s%s", between, escaped);
    between = "|";
  }
  g_string_append(pattern, ")$");
  JsonObject *o =
      piece(zero ? "{ type: [string, number] }" : "{ type: string }");
  set_text(o, "pattern", pattern->str);
  if (!zero) return o;
  json_object_set_double_member(o, "minimum", 0);
  json_object_set_double_member(o, "maximum", 0);
  return o;
}

static JsonObject *number(const opc_parameter *p) {
  if (p->unit) return number_with_unit(p->unit);
  JsonObject *o =
      piece(p->type == OPC_INT ? "{ type: integer }" : "{ type: number }");
  if (p->flags & OPC_AT_LEAST)
    json_object_set_double_member(o, "minimum", p->min);
  if (p->flags & OPC_ABOVE)
    json_object_set_double_member(o, "exclusiveMinimum", p->min);
  if (p->flags & OPC_AT_MOST)
    json_object_set_double_member(o, "maximum", p->max);
  if (p->flags & OPC_BELOW)
    json_object_set_double_member(o, "exclusiveMaximum", p->max);
  return o;
}

/* Return the schema of a text, including numbers and truth values of YAML. */
static JsonObject *any_text(void) {
  return piece("{ type: [string, number, boolean] }");
}

/* Return the schema of a choice. Words that YAML reads as numbers or truth
   values are also valid without quotes. */
static JsonObject *one_of_words(const char *choices) {
  JsonObject *o = json_object_new();
  g_auto(GStrv) words = opc_choice_list(choices);
  for (guint i = 0; words[i]; i++) {
    const opc_node plain = {
        .type = OPC_NODE_TEXT, .text = words[i], .plain = TRUE};
    g_autoptr(JsonNode) other = text_json(&plain);
    json_array_add_string_element(object_list(o, "enum"), words[i]);
    if (JSON_NODE_HOLDS_VALUE(other) &&
        json_node_get_value_type(other) != G_TYPE_STRING)
      json_array_add_element(object_list(o, "enum"), g_steal_pointer(&other));
  }
  return o;
}

static JsonObject *value_schema(const opc_parameter *p) {
  JsonObject *o;
  switch (p->type) {
    case OPC_BOOL:
      return piece("{ type: boolean }");
    case OPC_INT:
    case OPC_REAL:
      return number(p);
    case OPC_CHOICE:
      return one_of_words(p->choices);
    case OPC_REALS:
      o = piece("{ type: array }");
      json_object_set_object_member(o, "items", number(p));
      return o;
    case OPC_MAP:
      if (p->flags & OPC_INNER_AXIS)
        return piece("{ type: [ object, array ] }");
      o = piece("{ type: object }");
      if (!(p->flags & OPC_MAP_OF_ANY))
        json_object_set_object_member(o, "additionalProperties", any_text());
      if (p->choices)
        json_object_set_object_member(o, "propertyNames",
                                      one_of_words(p->choices));
      return o;
    case OPC_INPUT:
      return piece("{ type: string, pattern: '^\\$\\{" REFERENCE "\\}$' }");
    case OPC_SLOT: /* draft-07 ignores other members beside $ref */
      o = json_object_new();
      json_array_add_object_element(object_list(o, "allOf"),
                                    new_reference("any.", p->choices));
      return o;
    default:
      return any_text();
  }
}

/* ---- parameters ---- */

static char *description(const opc_parameter *p) {
  GString *text = g_string_new(p->summary);
  g_autofree char *bounds = opc_bounds_text(p);
  if (p->unit) g_string_append_printf(text, " (%s)", p->unit);
  if (*bounds) g_string_append_printf(text, "; %s", bounds);
  const char *otherwise = p->preset ? p->preset : p->follows;
  if (otherwise) g_string_append_printf(text, "; default: %s", otherwise);
  return g_string_free(text, FALSE);
}

static void set_default(JsonObject *o, const opc_parameter *p) {
  if (!p->preset) return;
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) node = opc_preset_parse(p, problems);
  if (!node) return;
  node->plain |= p->type == OPC_BOOL || p->type == OPC_INT ||
                 (p->type == OPC_REAL && !p->unit);
  json_object_set_member(o, "default", opc_node_json(node));
}

static JsonObject *parameter_schema(const opc_parameter *p) {
  JsonObject *o = value_schema(p);
  g_autofree char *text = description(p);
  set_text(o, "description", text);
  set_default(o, p);
  return o;
}

/* Return the schema of the map that contains a parameter: the schema of the
   plugin, or of the parameter's group. */
static JsonObject *parameter_home(JsonObject *plugin, const char *name,
                                  const char **last) {
  JsonObject *at = plugin;
  for (const char *dot; (dot = strchr(name, '.')); name = dot + 1) {
    g_autofree char *word = g_strndup(name, (size_t)(dot - name));
    at = object_member(object_member(at, "properties"), word);
    set_text(at, "type", "object");
    object_member(object_member(at, "patternProperties"), "\\.");
    json_object_set_boolean_member(at, "additionalProperties", FALSE);
  }
  *last = name;
  return at;
}

static JsonObject *plugin_schema(const opc_plugin *plugin) {
  JsonObject *o = piece(
      "{ type: object, description: '', properties: "
      "{ use: {} }, patternProperties: { '\\.': {} }, additionalProperties: "
      "false }");
  JsonObject *use = object_member(object_member(o, "properties"), "use");
  set_text(o, "description", plugin->summary);
  set_text(use, "const", plugin->id);
  set_text(use, "description", plugin->summary);
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = &plugin->parameters[i];
    const char *name;
    JsonObject *map = parameter_home(o, p->name, &name);
    json_object_set_object_member(object_member(map, "properties"), name,
                                  parameter_schema(p));
  }
  return o;
}

/* Return the required keys: `use` and the required parameters. Parameters in
   groups are excluded, because their names may be written with dots. */
static JsonObject *required_keys(const opc_plugin *plugin) {
  JsonObject *o = piece("{ required: [use] }");
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = &plugin->parameters[i];
    if (p->flags & OPC_REQUIRED && !p->preset && !strchr(p->name, '.'))
      json_array_add_string_element(object_list(o, "required"), p->name);
  }
  return o;
}

/* ---- schema ---- */

/* Return the schema of any plugin of a kind; an empty oneOf is not valid. */
static JsonObject *kind_schema(const GPtrArray *plugins, const char *kind) {
  JsonObject *o = json_object_new();
  for (guint i = 0; i < plugins->len; i++) {
    const opc_plugin *plugin = plugins->pdata[i];
    if (strcmp(plugin->kind, kind) != 0) continue;
    JsonObject *one = json_object_new();
    json_array_add_object_element(object_list(one, "allOf"),
                                  new_reference("", plugin->id));
    json_array_add_object_element(object_list(one, "allOf"),
                                  required_keys(plugin));
    json_array_add_object_element(object_list(o, "oneOf"), one);
  }
  if (!json_object_has_member(o, "oneOf")) object_member(o, "not");
  return o;
}

/* Return the kinds that a flow may use: steps, and the kinds of slots. */
static GHashTable *used_kinds(const GPtrArray *plugins) {
  GHashTable *kinds = g_hash_table_new(g_str_hash, g_str_equal);
  g_hash_table_add(kinds, (char *)OPC_KIND_STEP);
  for (guint i = 0; i < plugins->len; i++) {
    const opc_plugin *plugin = plugins->pdata[i];
    for (size_t k = 0; k < plugin->n_parameters; k++)
      if (plugin->parameters[k].type == OPC_SLOT)
        g_hash_table_add(kinds, (char *)plugin->parameters[k].choices);
  }
  return kinds;
}

JsonNode *opc_flow_schema(const GPtrArray *plugins) {
  g_autoptr(GBytes) fixed = g_resource_lookup_data(
      opc_schema_get_resource(), "/opcflow/flow.schema.json", 0, NULL);
  g_autoptr(JsonObject) root = piece(g_bytes_get_data(fixed, NULL));
  JsonObject *definitions = object_member(root, "definitions");
  for (guint i = 0; i < plugins->len; i++) {
    const opc_plugin *plugin = plugins->pdata[i];
    json_object_set_object_member(definitions, plugin->id,
                                  plugin_schema(plugin));
  }
  g_autoptr(GHashTable) kinds = used_kinds(plugins);
  g_autoptr(GList) names =
      g_list_sort(g_hash_table_get_keys(kinds), (GCompareFunc)strcmp);
  for (const GList *at = names; at; at = at->next) {
    g_autofree char *name = g_strconcat("any.", at->data, NULL);
    json_object_set_object_member(definitions, name,
                                  kind_schema(plugins, at->data));
  }
  return json_node_init_object(json_node_alloc(), root);
}

/* ---- the verb ---- */

/* Return all plugins that can be loaded, by id: const opc_plugin *. */
static GPtrArray *usable_plugins(void) {
  GPtrArray *plugins = g_ptr_array_new();
  g_autoptr(GPtrArray) list =
      opc_registry_usable(cli_registry(), "", CLI_PATIENCE);
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    opc_error error;
    const opc_plugin *plugin = opc_registry_find(cli_registry(), c->id, &error);
    if (plugin) g_ptr_array_add(plugins, (void *)plugin);
  }
  return plugins;
}

static const char *output;

static const cli_option options[] = {
    {"output", "default: standard output", "FILE", .text = &output}, {0}};

static int schema_run(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb, (void)arguments;
  g_autoptr(GPtrArray) plugins = usable_plugins();
  g_autofree char *text = opc_json_text(opc_flow_schema(plugins));
  opc_error error = {0};
  if (output && opc_write_file(output, text, &error)) return cli_fail(&error);
  if (!output) cli_print("%s", text);
  return CLI_GOOD;
}

const cli_verb devel_schema = {CLI_SCHEMA, .options = options,
                               .run = schema_run};
