/* SPDX-License-Identifier: BSD-3-Clause */
/* Turns the declarations of plugins into a JSON Schema. */
#include "core/flow/schema.h"

#include <string.h>

#include "core/plugin/declaration.h"
#include "core/text/unit.h"
#include "core/text/value.h"

#define NUMBER "[+-]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+-]?[0-9]+)?"
#define NAME "[A-Za-z0-9_][A-Za-z0-9_-]*"
#define REFERENCE "^\\$\\{" NAME "(\\.[A-Za-z0-9_.-]+)?\\}$"

/* ---- small pieces ---- */

static void set_text(JsonObject *o, const char *key, const char *text) {
  json_object_set_string_member(o, key, text);
}

static JsonObject *new_type(const char *type) {
  JsonObject *o = json_object_new();
  set_text(o, "type", type);
  return o;
}

static JsonObject *new_pattern(const char *pattern) {
  JsonObject *o = new_type("string");
  set_text(o, "pattern", pattern);
  return o;
}

static JsonObject *new_reference(const char *prefix, const char *name) {
  JsonObject *o = json_object_new();
  g_autofree char *target = g_strconcat("#/definitions/", prefix, name, NULL);
  set_text(o, "$ref", target);
  return o;
}

/* The member `key` of `o`, an object, made if it is not there. */
static JsonObject *member(JsonObject *o, const char *key) {
  if (!json_object_has_member(o, key))
    json_object_set_object_member(o, key, json_object_new());
  return json_object_get_object_member(o, key);
}

/* ---- trees as JSON ---- */

static JsonNode *text_json(const opc_node *node) {
  JsonNode *json = json_node_new(JSON_NODE_VALUE);
  const char *text = node->text;
  size_t n = strlen(text);
  if (!node->plain) {
    json_node_set_string(json, text);
  } else if (!strcmp(text, "true") || !strcmp(text, "false")) {
    json_node_set_boolean(json, *text == 't');
  } else if (!*text || !strcmp(text, "null") || !strcmp(text, "~")) {
    json_node_free(json);
    return json_node_new(JSON_NODE_NULL);
  } else if (opc_number_length(text) != n) {
    json_node_set_string(json, text);
  } else if (strspn(text, "+-0123456789") == n && n < 18) {
    json_node_set_int(json, g_ascii_strtoll(text, NULL, 10));
  } else {
    json_node_set_double(json, g_ascii_strtod(text, NULL));
  }
  return json;
}

JsonNode *opc_node_json(const opc_node *node) {
  if (node->type == OPC_NODE_TEXT) return text_json(node);
  JsonNode *json;
  if (node->type == OPC_NODE_LIST) {
    JsonArray *array = json_array_new();
    for (guint i = 0; i < node->items->len; i++)
      json_array_add_element(array, opc_node_json(node->items->pdata[i]));
    json = json_node_new(JSON_NODE_ARRAY);
    json_node_take_array(json, array);
  } else {
    JsonObject *object = json_object_new();
    for (guint i = 0; i < node->items->len; i++) {
      const opc_node *key = node->keys->pdata[i];
      json_object_set_member(object, key->text,
                             opc_node_json(node->items->pdata[i]));
    }
    json = json_node_new(JSON_NODE_OBJECT);
    json_node_take_object(json, object);
  }
  return json;
}

/* ---- values ---- */

/* A number with any unit of the same dimension as `unit`. */
static JsonObject *number_with_unit(const char *unit) {
  const char *noun = opc_unit_noun(opc_unit_find(unit));
  g_autoptr(GString) pattern = g_string_new("^" NUMBER " *(");
  g_autoptr(GPtrArray) names = opc_unit_names();
  gboolean first = TRUE;
  for (guint i = 0; i < names->len; i++) {
    const char *name = names->pdata[i];
    if (opc_unit_noun(opc_unit_find(name)) != noun) continue;
    g_autofree char *escaped = g_regex_escape_string(name, -1);
    g_string_append_printf(pattern, "%s%s", first ? "" : "|", escaped);
    first = FALSE;
  }
  g_string_append(pattern, ")$");
  return new_pattern(pattern->str);
}

static JsonObject *plain_number(const opc_parameter *p, const char *type) {
  JsonObject *o = new_type(type);
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

static JsonObject *number(const opc_parameter *p) {
  return p->unit ? number_with_unit(p->unit) : plain_number(p, "number");
}

/* What is a text for a flow, whatever YAML takes it for. */
static JsonObject *any_text(void) {
  JsonObject *o = json_object_new();
  JsonArray *types = json_array_new();
  json_array_add_string_element(types, "string");
  json_array_add_string_element(types, "number");
  json_array_add_string_element(types, "boolean");
  json_object_set_array_member(o, "type", types);
  return o;
}

/* One of the words; one that YAML takes for a number or a truth value may be
   written without quotes, too. */
static JsonObject *one_of_words(const char *choices) {
  JsonObject *o = json_object_new();
  JsonArray *list = json_array_new();
  g_auto(GStrv) words = opc_choice_list(choices);
  for (guint i = 0; words[i]; i++) {
    json_array_add_string_element(list, words[i]);
    const opc_node plain = {
        .type = OPC_NODE_TEXT, .text = words[i], .plain = TRUE};
    JsonNode *other = text_json(&plain);
    if (JSON_NODE_HOLDS_VALUE(other) &&
        json_node_get_value_type(other) != G_TYPE_STRING)
      json_array_add_element(list, other);
    else
      json_node_free(other);
  }
  json_object_set_array_member(o, "enum", list);
  return o;
}

static JsonObject *list_of_numbers(const opc_parameter *p) {
  JsonObject *o = new_type("array");
  json_object_set_object_member(o, "items", number(p));
  return o;
}

static JsonObject *map_of_texts(const opc_parameter *p) {
  JsonObject *o = new_type("object");
  if (!(p->flags & OPC_MAP_OF_ANY))
    json_object_set_object_member(o, "additionalProperties", any_text());
  if (p->choices)
    json_object_set_object_member(o, "propertyNames", one_of_words(p->choices));
  return o;
}

static JsonObject *value_schema(const opc_parameter *p) {
  switch (p->type) {
    case OPC_BOOL:
      return new_type("boolean");
    case OPC_INT:
      return plain_number(p, "integer");
    case OPC_REAL:
      return number(p);
    case OPC_CHOICE:
      return one_of_words(p->choices);
    case OPC_REALS:
      return list_of_numbers(p);
    case OPC_MAP:
      return map_of_texts(p);
    case OPC_INPUT:
      return new_pattern(REFERENCE);
    case OPC_SLOT:
      return new_reference("any.", p->choices);
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
  if (p->preset) g_string_append_printf(text, "; default: %s", p->preset);
  return g_string_free(text, FALSE);
}

static void set_default(JsonObject *o, const opc_parameter *p) {
  static const opc_source source = {.name = (char *)"default"};
  if (!p->preset) return;
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_node) node = opc_preset_parse(p, &source, problems);
  if (!node) return;
  node->plain |= p->type == OPC_BOOL || p->type == OPC_INT ||
                 (p->type == OPC_REAL && !p->unit);
  json_object_set_member(o, "default", opc_node_json(node));
}

static JsonObject *parameter_schema(const opc_parameter *p) {
  JsonObject *o = value_schema(p);
  g_autofree char *text = description(p);
  if (json_object_has_member(o, "$ref")) {
    /* Beside a $ref nothing counts in draft-07. */
    JsonObject *whole = json_object_new();
    JsonArray *all = json_array_new();
    json_array_add_object_element(all, o);
    json_object_set_array_member(whole, "allOf", all);
    o = whole;
  }
  set_text(o, "description", text);
  set_default(o, p);
  return o;
}

/* The schema of the map that a parameter stands in: that of the plugin, or of
   its group. */
static JsonObject *home(JsonObject *plugin, const char *name,
                        const char **last) {
  JsonObject *at = plugin;
  for (const char *dot; (dot = strchr(name, '.')); name = dot + 1) {
    g_autofree char *word = g_strndup(name, (size_t)(dot - name));
    at = member(member(at, "properties"), word);
    set_text(at, "type", "object");
    json_object_set_boolean_member(at, "additionalProperties", FALSE);
  }
  *last = name;
  return at;
}

static JsonObject *plugin_schema(const opc_plugin *plugin) {
  JsonObject *o = new_type("object");
  set_text(o, "description", plugin->summary);
  JsonObject *use = json_object_new();
  set_text(use, "const", plugin->id);
  set_text(use, "description", plugin->summary);
  json_object_set_object_member(member(o, "properties"), "use", use);
  json_object_set_boolean_member(o, "additionalProperties", FALSE);
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = &plugin->parameters[i];
    const char *name;
    JsonObject *map = home(o, p->name, &name);
    json_object_set_object_member(member(map, "properties"), name,
                                  parameter_schema(p));
  }
  return o;
}

static void add_word(JsonObject *o, const char *word) {
  if (!json_object_has_member(o, "required"))
    json_object_set_array_member(o, "required", json_array_new());
  JsonArray *list = json_object_get_array_member(o, "required");
  for (guint i = 0; i < json_array_get_length(list); i++)
    if (!strcmp(json_array_get_string_element(list, i), word)) return;
  json_array_add_string_element(list, word);
}

/* What must be there: `use`, the required parameters, the groups they are in.
 */
static JsonObject *needs(const opc_plugin *plugin) {
  JsonObject *o = json_object_new();
  add_word(o, "use");
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = &plugin->parameters[i];
    if (!(p->flags & OPC_REQUIRED) || p->preset) continue;
    JsonObject *at = o;
    const char *name = p->name;
    for (const char *dot; (dot = strchr(name, '.')); name = dot + 1) {
      g_autofree char *word = g_strndup(name, (size_t)(dot - name));
      add_word(at, word);
      at = member(member(at, "properties"), word);
    }
    add_word(at, name);
  }
  return o;
}

/* ---- plugins of a kind ---- */

static JsonObject *whole_plugin(const opc_plugin *plugin) {
  JsonObject *o = json_object_new();
  JsonArray *all = json_array_new();
  json_array_add_object_element(all, new_reference("", plugin->id));
  json_array_add_object_element(all, needs(plugin));
  json_object_set_array_member(o, "allOf", all);
  return o;
}

static JsonObject *kind_schema(const GPtrArray *plugins, const char *kind) {
  JsonObject *o = json_object_new();
  JsonArray *list = json_array_new();
  for (guint i = 0; i < plugins->len; i++) {
    const opc_plugin *plugin = plugins->pdata[i];
    if (!strcmp(plugin->kind, kind))
      json_array_add_object_element(list, whole_plugin(plugin));
  }
  /* oneOf must not be empty. */
  if (json_array_get_length(list)) {
    json_object_set_array_member(o, "oneOf", list);
  } else {
    json_array_unref(list);
    json_object_set_object_member(o, "not", json_object_new());
  }
  return o;
}

/* ---- the file ---- */

static JsonObject *map_or_nothing(void) {
  JsonObject *o = json_object_new();
  JsonArray *types = json_array_new();
  json_array_add_string_element(types, "object");
  json_array_add_string_element(types, "null");
  json_object_set_array_member(o, "type", types);
  return o;
}

static JsonObject *steps_schema(gboolean whole) {
  JsonObject *o = new_type("object");
  if (whole) json_object_set_int_member(o, "minProperties", 1);
  json_object_set_object_member(o, "propertyNames", new_pattern("^" NAME "$"));
  json_object_set_object_member(
      o, "additionalProperties",
      whole ? new_reference("any.", OPC_KIND_STEP) : map_or_nothing());
  return o;
}

/* A map by name whose values are maps or lists; null takes away what the flow
   that is extended has. */
static JsonObject *map_of(const char *type) {
  JsonObject *o = json_object_new(), *each = json_object_new();
  for (int i = 0; i < 2; i++) {
    JsonArray *types = json_array_new();
    json_array_add_string_element(types, i ? type : "object");
    json_array_add_string_element(types, "null");
    json_object_set_array_member(i ? each : o, "type", types);
  }
  json_object_set_object_member(o, "additionalProperties", each);
  return o;
}

/* What extends another flow may say any part of a step, or take it away. */
static void set_condition(JsonObject *root) {
  JsonObject *condition = json_object_new(), *then = json_object_new(),
             *otherwise = json_object_new();
  add_word(condition, "extends");
  json_object_set_object_member(member(then, "properties"), "steps",
                                steps_schema(FALSE));
  json_object_set_object_member(member(otherwise, "properties"), "steps",
                                steps_schema(TRUE));
  add_word(otherwise, "steps");
  json_object_set_object_member(root, "if", condition);
  json_object_set_object_member(root, "then", then);
  json_object_set_object_member(root, "else", otherwise);
}

static JsonObject *with_description(JsonObject *o, const char *text) {
  set_text(o, "description", text);
  return o;
}

static void set_head(JsonObject *root) {
  JsonObject *keys = member(root, "properties");
  JsonObject *version = json_object_new();
  json_object_set_int_member(version, "const", 1);
  json_object_set_object_member(
      keys, "opcflow", with_description(version, "The version of the format"));
  json_object_set_object_member(
      keys, "name",
      with_description(new_pattern("^[A-Za-z0-9_][A-Za-z0-9._-]*$"),
                       "The name of the run folder"));
  json_object_set_object_member(
      keys, "description",
      with_description(any_text(), "What the flow is for"));
  json_object_set_object_member(
      keys, "extends",
      with_description(new_type("string"), "The flow that this one changes"));
  json_object_set_object_member(
      keys, "variants",
      with_description(map_of("object"), "Changes of the flow, by name"));
  json_object_set_object_member(
      keys, "sweep",
      with_description(map_of("array"),
                       "Parameters with the values that each takes"));
  json_object_set_object_member(
      keys, "steps", with_description(json_object_new(), "What runs, by name"));
}

/* The kinds that may stand in a flow: steps, and what slots want. */
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

static gint compare_names(gconstpointer a, gconstpointer b) {
  return strcmp(a, b);
}

JsonNode *opc_flow_schema(const GPtrArray *plugins) {
  JsonObject *root = json_object_new();
  set_text(root, "$schema", "http://json-schema.org/draft-07/schema#");
  set_text(root, "title", "opcflow flow");
  set_text(root, "type", "object");
  add_word(root, "opcflow");
  set_head(root);
  json_object_set_boolean_member(root, "additionalProperties", FALSE);
  set_condition(root);
  JsonObject *definitions = member(root, "definitions");
  for (guint i = 0; i < plugins->len; i++) {
    const opc_plugin *plugin = plugins->pdata[i];
    json_object_set_object_member(definitions, plugin->id,
                                  plugin_schema(plugin));
  }
  g_autoptr(GHashTable) kinds = used_kinds(plugins);
  g_autoptr(GList) names =
      g_list_sort(g_hash_table_get_keys(kinds), compare_names);
  for (const GList *at = names; at; at = at->next) {
    g_autofree char *name = g_strconcat("any.", at->data, NULL);
    json_object_set_object_member(definitions, name,
                                  kind_schema(plugins, at->data));
  }
  JsonNode *node = json_node_new(JSON_NODE_OBJECT);
  json_node_take_object(node, root);
  return node;
}
