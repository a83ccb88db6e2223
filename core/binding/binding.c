/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks the parameters of a plugin and of the plugins in its slots, creates
   the instances, and maps an error to its place in the flow. */
#include "core/binding/binding.h"

#include <base/layers.h>
#include <base/suggest.h>
#include <guard/guard.h>
#include <string.h>

#include "core/plugin/declaration.h"
#include "core/plugin/pieces.h"
#include "core/plugin/value.h"

/* Limit of nested slots, for a plugin that is the default of its own slot. */
enum { DEEPEST_SLOT = 16 };

/* State of a call of opc_bind. */
typedef struct binder {
  opc_registry *registry;
  opc_binding *binding;
  unsigned flags, depth;
  opc_problems *problems;
} binder;

static opc_binding *bind_use(const binder *like, const opc_node *map,
                             const char *kind, const char *path,
                             const opc_place *at);

/* ---- one value ---- */

static opc_node *parse_preset(const binder *b, const opc_parameter *p) {
  opc_node *node = opc_preset_parse(p, b->problems);
  if (node) g_ptr_array_add(b->binding->presets, node);
  return node;
}

/* Return the complete map of a slot. A map without `use` only changes
   parameters of the default plugin, and is merged over `preset`. */
static const opc_node *over_default(const binder *b, const opc_parameter *p,
                                    const opc_node *node) {
  if (!p->preset || opc_node_get(node, "use")) return node;
  opc_node *preset = parse_preset(b, p);
  if (!preset || preset->type != OPC_NODE_MAP) return node;
  opc_lay(preset, node, b->problems);
  return preset;
}

static void bind_slot(const binder *b, size_t i, const opc_node *node,
                      const opc_place *at) {
  opc_binding *binding = b->binding;
  const opc_parameter *p = &binding->plugin->parameters[i];
  g_autofree char *path = g_strdup_printf("%s.%s", binding->path, p->name);
  if (node->type != OPC_NODE_MAP) {
    g_autofree char *noun = opc_setting_noun(p);
    opc_wrong(b->problems, node, "'%s' needs %s", p->name, noun);
  } else if (b->depth == DEEPEST_SLOT) {
    opc_problem_add(b->problems, OPC_INVALID, at,
                    "slots are nested deeper than %d", DEEPEST_SLOT);
  } else {
    binder deeper = *b;
    deeper.depth++;
    node = over_default(b, p, node);
    opc_binding *slot = bind_use(&deeper, node, p->choices, path, at);
    binding->values[i].present = TRUE;
    binding->slots[i] = slot;
    if (slot) binding->values[i].field.object = &slot->module;
  }
}

static void bind_value(const binder *b, size_t i, const opc_node *node,
                       const opc_place *at) {
  opc_binding *binding = b->binding;
  const opc_parameter *p = &binding->plugin->parameters[i];
  if (p->type == OPC_SLOT)
    bind_slot(b, i, node, at);
  else
    opc_setting_convert(p, node, TRUE, binding->owned, b->problems,
                        &binding->values[i]);
}

static void bind_default(const binder *b, size_t i) {
  opc_binding *binding = b->binding;
  const opc_parameter *p = &binding->plugin->parameters[i];
  if (p->preset) {
    const opc_node *node = parse_preset(b, p);
    if (node) bind_value(b, i, node, &binding->at);
  } else if (p->flags & OPC_REQUIRED &&
             (p->type != OPC_INPUT || !(b->flags & OPC_BIND_NO_INPUTS)) &&
             (p->type != OPC_FILE || !(b->flags & OPC_BIND_NO_FILES))) {
    opc_wrong(b->problems, binding,
              "required parameter '%s' of '%s' is missing", p->name,
              binding->plugin->id);
  }
}

/* ---- the map ---- */

/* Return, for each parameter whose name or former name begins with `prefix`,
   the word that follows the prefix (up to the next dot). */
static GPtrArray *level_names(const opc_plugin *plugin, const char *prefix) {
  GPtrArray *names = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const char *name = plugin->parameters[i].name;
    if (!g_str_has_prefix(name, prefix)) name = plugin->parameters[i].former;
    if (!name || !g_str_has_prefix(name, prefix)) continue;
    name += strlen(prefix);
    g_ptr_array_add(names, g_strndup(name, strcspn(name, ".")));
  }
  return names;
}

static void unknown_parameter(const binder *b, const opc_node *key,
                              const char *prefix, const char *name) {
  g_autoptr(GPtrArray) names = level_names(b->binding->plugin, prefix);
  if (!*prefix) g_ptr_array_add(names, g_strdup("use"));
  const char *nearest = opc_nearest(key->text, names);
  g_autofree char *suggestion =
      nearest ? g_strdup_printf(", did you mean '%s%s'?", prefix, nearest)
              : g_strdup("");
  opc_wrong(b->problems, key, "unknown parameter '%s' of '%s'%s", name,
            b->binding->plugin->id, suggestion);
}

/* Return the index of the parameter with the former name, -1 if missing. */
static int find_former(const binder *b, const opc_node *key, const char *name) {
  const opc_plugin *plugin = b->binding->plugin;
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = &plugin->parameters[i];
    g_auto(GStrv) names = opc_choice_list(p->former);
    if (!g_strv_contains((const char *const *)names, name)) continue;
    g_autofree char *place = opc_place_text(&key->at);
    g_ptr_array_add(
        b->binding->renamed,
        g_strdup_printf("%s: '%s' is now called '%s'", place, name, p->name));
    return (int)i;
  }
  return -1;
}

static void bind_map(const binder *b, const opc_node *map, const char *prefix);

/* Bind the keys of a map to the parameters PREFIX + KEY. The depth of recursion
   is the number of dots in parameter names. */
static void bind_group(const binder *b, const opc_node *map,
                       const char *prefix) {
  opc_binding *binding = b->binding;
  for (guint k = 0; k < map->keys->len && !opc_problems_full(b->problems);
       k++) {
    const opc_node *key = map->keys->pdata[k], *node = map->items->pdata[k];
    if (!*prefix && !strcmp(key->text, "use")) continue;
    g_autofree char *name = g_strconcat(prefix, key->text, NULL);
    g_autofree char *deeper = g_strconcat(name, ".", NULL);
    g_autoptr(GPtrArray) group = level_names(binding->plugin, deeper);
    int i = opc_parameter_find(binding->plugin, name);
    if (i < 0) i = find_former(b, key, name);
    if (i >= 0 && binding->origin[i]) {
      opc_wrong(b->problems, key,
                "'%s' is the former name of '%s', which is also set: remove "
                "one of them",
                name, binding->plugin->parameters[i].name);
    } else if (i >= 0) {
      binding->origin[i] = node;
      binding->values[i].given = TRUE;
      bind_value(b, (size_t)i, node, &key->at);
    } else if (!group->len) {
      unknown_parameter(b, key, prefix, name);
    } else if (node->type != OPC_NODE_MAP) {
      opc_wrong(
          b->problems, node,
          "'%s' is a group of parameters, expected a map as in '%s: { ... }'",
          name, key->text);
    } else {
      bind_map(b, node, deeper);
    }
  }
}

/* Bind a map; `anchor.line: V` and `anchor: { line: V }` are equivalent. */
static void bind_map(const binder *b, const opc_node *map, const char *prefix) {
  opc_node *undotted = opc_undot(map, FALSE, b->problems);
  g_ptr_array_add(b->binding->presets, undotted);
  bind_group(b, undotted, prefix);
}

/* Mark values equal to the default as not given. A resolved flow (resolve.h)
   sets all parameters, and must have the `given` fields of the original. */
static void forget_defaults(const binder *b) {
  opc_binding *binding = b->binding;
  for (size_t i = 0; i < binding->plugin->n_parameters; i++) {
    const opc_parameter *p = &binding->plugin->parameters[i];
    if (!binding->origin[i] || !p->preset || p->type == OPC_SLOT) continue;
    const opc_node *preset = parse_preset(b, p);
    g_autofree char *given = opc_node_line(binding->origin[i]);
    g_autofree char *written = preset ? opc_node_line(preset) : NULL;
    if (!g_strcmp0(given, written)) binding->values[i].given = FALSE;
  }
}

static opc_binding *bind_plugin(const binder *like, const opc_plugin *plugin,
                                const opc_node *map, const char *path,
                                const opc_place *at) {
  opc_binding *binding = g_new0(opc_binding, 1);
  size_t n = plugin->n_parameters;
  binder b = *like;
  b.binding = binding;
  binding->plugin = plugin;
  binding->path = g_strdup(path);
  binding->at = *at;
  binding->values = g_new0(opc_setting, n);
  binding->origin = g_new0(const opc_node *, n);
  binding->slots = g_new0(opc_binding *, n);
  binding->owned = g_ptr_array_new_with_free_func(g_free);
  binding->renamed = g_ptr_array_new_with_free_func(g_free);
  binding->presets =
      g_ptr_array_new_with_free_func((GDestroyNotify)opc_node_free);
  for (size_t i = 0; i < n; i++)
    binding->values[i] = opc_setting_absent(&plugin->parameters[i]);
  bind_map(&b, map, "");
  for (size_t i = 0; i < n; i++)
    if (!binding->values[i].given) bind_default(&b, i);
  forget_defaults(&b);
  return binding;
}

static opc_binding *bind_use(const binder *like, const opc_node *map,
                             const char *kind, const char *path,
                             const opc_place *at) {
  const opc_node *use = opc_node_get(map, "use");
  const opc_plugin *plugin;
  opc_error error = {0};
  if (!use)
    opc_problem_add(like->problems, OPC_INVALID, at,
                    "'use' is missing: name the plugin of '%s'", path);
  else if (use->type != OPC_NODE_TEXT || !*use->text)
    opc_wrong(like->problems, use, "'use' must be the id of a plugin");
  else if (!(plugin = opc_registry_find(like->registry, use->text, &error)))
    opc_problem_add(like->problems, error.code, &use->at, "%s", error.message);
  else if (strcmp(plugin->kind, kind) != 0)
    opc_wrong(like->problems, use,
              "'%s' is a plugin of the kind '%s', expected '%s'", plugin->id,
              plugin->kind, kind);
  else
    return bind_plugin(like, plugin, map, path, at);
  return NULL;
}

opc_binding *opc_bind(opc_registry *registry, const opc_node *map,
                      const char *path, const opc_place *at, unsigned flags,
                      opc_problems *problems) {
  const binder b = {.registry = registry, .flags = flags, .problems = problems};
  return bind_use(&b, map, OPC_KIND_STEP, path, at);
}

opc_binding *opc_bind_plugin(opc_registry *registry, const opc_plugin *plugin,
                             const opc_node *map, const char *path,
                             const opc_place *at, unsigned flags,
                             opc_problems *problems) {
  const binder b = {.registry = registry, .flags = flags, .problems = problems};
  return bind_plugin(&b, plugin, map, path, at);
}

/* ---- instances ---- */

char *opc_binding_label(const opc_binding *b) {
  gboolean top = !strchr(b->path, '.');
  return g_strdup_printf("%s%s'%s' (%s)", top ? b->plugin->kind : "",
                         top ? " " : "", b->path, b->plugin->id);
}

/* Allocate the instance and store all parameters but inputs. */
static void binding_fill(opc_binding *b) {
  b->module = (opc_module){.functions = b->plugin->functions,
                           .self = g_malloc0(b->plugin->instance_size),
                           .id = b->plugin->id};
  *(const opc_host **)b->module.self = b->host;
  for (size_t i = 0; i < b->plugin->n_parameters; i++)
    opc_setting_store(&b->plugin->parameters[i], &b->values[i], b->module.self);
}

const char *opc_binding_enter(const opc_binding *b) {
  g_autofree char *label = opc_binding_label(b);
  g_autofree char *place = opc_place_text(&b->at);
  g_autofree char *where =
      g_strdup_printf("%s%s%s", place, *place ? ": " : "", label);
  guard_where(where, GUARD_CRASH_RUNNING);
  return guard_enter(b->plugin->id);
}

void opc_binding_leave(const char *before) {
  guard_leave(before);
  guard_where(NULL, 0);
}

void opc_binding_set(opc_binding *b, size_t i, const void *object) {
  b->values[i].field.object = object;
  opc_setting_store(&b->plugin->parameters[i], &b->values[i], b->module.self);
}

const void *opc_binding_service(const opc_host *host, const char *name) {
  const opc_binding *b = host->data;
  if (!strcmp(name, OPC_DESCRIPTOR)) return b ? b->plugin : NULL;
  if (!strcmp(name, OPC_INNER))
    return b && b->inner ? b->nested->service : NULL;
  return strcmp(name, OPC_PIECES) ? NULL : &opc_pieces_alone;
}

gboolean opc_binding_create(opc_binding *b, const opc_watch *watch,
                            const opc_host *like, opc_problems *problems) {
  gboolean good = TRUE;
  for (size_t i = 0; i < b->plugin->n_parameters; i++)
    if (b->slots[i])
      good &= opc_binding_create(b->slots[i], watch, like, problems);
  if (!good) return FALSE;
  b->run = like ? like->data : NULL;
  b->host = opc_host_new(b->path, watch, like);
  b->host->data = b;
  if (!like || !like->service) b->host->service = opc_binding_service;
  for (guint i = 0; i < b->renamed->len; i++)
    b->host->log(b->host, OPC_LOG_WARNING, "%s", (char *)b->renamed->pdata[i]);
  binding_fill(b);
  opc_error error = {0};
  const char *before = opc_binding_enter(b);
  int code = b->inner ? b->nested->check(b->inner, &error) : OPC_OK;
  if (!code && b->plugin->check)
    code = b->plugin->check(b->module.self, &error);
  opc_binding_leave(before);
  return !code || opc_binding_fail(b, FALSE, code, &error, problems);
}

void opc_binding_free(opc_binding *b) {
  if (!b) return;
  if (b->module.self) {
    const char *before = guard_enter(b->plugin->id);
    if (b->plugin->clear) b->plugin->clear(b->module.self);
    guard_leave(before);
    g_free(b->module.self);
  }
  if (b->inner) b->nested->free(b->inner);
  for (size_t i = 0; i < b->plugin->n_parameters; i++)
    opc_binding_free(b->slots[i]);
  if (b->host) opc_host_free(b->host);
  g_free(b->path);
  g_free(b->values);
  g_free(b->origin);
  g_free(b->slots);
  g_ptr_array_free(b->owned, TRUE);
  g_ptr_array_free(b->presets, TRUE);
  g_ptr_array_free(b->renamed, TRUE);
  g_free(b);
}

/* ---- places of errors ---- */

const opc_place *opc_binding_origin(const opc_binding *b, size_t i) {
  return b->origin[i] ? &b->origin[i]->at : &b->at;
}

/* Return the place of a parameter of this instance or of an instance in its
   slots; append the slots on the path to `trail`. */
static const opc_place *find_parameter(const opc_binding *b, const char *name,
                                       GString *trail) {
  int i = opc_parameter_find(b->plugin, name);
  if (i >= 0) {
    if (b->slots[i])
      g_string_append_printf(trail, ", %s (%s)", name, b->slots[i]->plugin->id);
    return opc_binding_origin(b, (size_t)i);
  }
  for (size_t s = 0; s < b->plugin->n_parameters; s++) {
    const char *slot = b->plugin->parameters[s].name;
    const char *rest = g_str_has_prefix(name, slot) ? name + strlen(slot) : "";
    if (b->plugin->parameters[s].type == OPC_MAP && b->origin[s] &&
        *rest == '.') {
      int key = opc_node_find(b->origin[s], rest + 1);
      return key < 0 ? &b->origin[s]->at
                     : &((opc_node *)b->origin[s]->keys->pdata[key])->at;
    }
    if (!b->slots[s]) continue;
    size_t length = trail->len;
    g_string_append_printf(trail, ", %s (%s)", slot, b->slots[s]->plugin->id);
    const opc_place *place =
        *rest == '.' ? find_parameter(b->slots[s], rest + 1, trail) : NULL;
    if (!place) place = find_parameter(b->slots[s], name, trail);
    if (place) return place;
    /* The slot's plugin has no parameter of this name. */
    if (*rest == '.') return opc_binding_origin(b, s);
    g_string_truncate(trail, length);
  }
  return NULL;
}

const opc_place *opc_binding_place(const opc_binding *b,
                                   const char *parameter) {
  g_autoptr(GString) trail = g_string_new(NULL);
  const opc_place *place =
      *parameter ? find_parameter(b, parameter, trail) : NULL;
  return place ? place : &b->at;
}

gboolean opc_binding_fail(const opc_binding *b, gboolean run, int code,
                          opc_error *error, opc_problems *problems) {
  g_autofree char *label = opc_binding_label(b);
  g_autoptr(GString) trail = g_string_new(NULL);
  error->message[sizeof error->message - 1] = 0;
  error->parameter[sizeof error->parameter - 1] = 0;
  if (!*error->message) strcpy(error->message, "no error message");
  if (code < OPC_INVALID || code > OPC_CANCELLED) code = OPC_FAILED;
  if (run && *error->parameter) find_parameter(b, error->parameter, trail);
  return opc_problem_add(problems, code, opc_binding_place(b, error->parameter),
                         "%s%s: %s", label, trail->str, error->message);
}

void opc_binding_list(const opc_binding *b, GPtrArray *list) {
  for (size_t i = 0; i < b->plugin->n_parameters; i++)
    if (b->slots[i]) opc_binding_list(b->slots[i], list);
  g_ptr_array_add(list, (opc_binding *)b);
}
