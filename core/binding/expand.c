/* SPDX-License-Identifier: BSD-3-Clause */
/* Expands lists, patterns and files into named layers (opcflow/inner.h). */
#include "core/binding/expand.h"

#include <base/file.h>
#include <base/list.h>
#include <base/match.h>
#include <string.h>

#include "core/binding/inner.h"
#include "core/binding/lookup.h"
#include "core/plugin/declaration.h"

enum {
  MOST = 100000, /* largest number of layers of an axis */
  DEEPEST = 4,   /* nested lists */
  LONGEST = 100  /* bytes of a layer's name, which is a folder name */
};

typedef struct expander {
  const char *axis; /* "cases" */
  opc_recipe *recipe;
  const opc_choice *choice;
  opc_registry *registry;
  opc_problems *problems;
  int depth; /* nesting depth of lists */
  GPtrArray *layers, *names, *variants;
  GHashTable *known; /* name -> opc_node * of the layer */
} expander;

/* An element of the value of an axis, which may expand into several layers. */
typedef struct item {
  const opc_node *node;
  const char *name;    /* of the layer; NULL if made from the values */
  const char *variant; /* "" if no variant applies */
  gboolean several;    /* some key has several values */
} item;

/* A layer under construction: a value for each of the first keys. */
typedef struct part {
  opc_node *map;  /* paths and values */
  GString *label; /* values of the keys with several values */
  char *star;     /* text matched by `*` in a file name, or NULL */
} part;

static void part_free(gpointer object) {
  part *p = object;
  opc_node_free(p->map);
  g_string_free(p->label, TRUE);
  g_free(p->star);
  g_free(p);
}

static part *part_copy(const part *from) {
  part *p = g_new(part, 1);
  *p = (part){opc_node_copy(from->map, NULL), g_string_new(from->label->str),
              g_strdup(from->star)};
  return p;
}

/* ---- paths ---- */

/* Result of open_probe: the parameter at a path, and the binding of the step,
   in a flow with a layer applied. */
typedef struct probe {
  opc_sweep *sweep;
  opc_flow *flow;
  opc_binding *step, *binding; /* NULL if not found */
  const opc_parameter *parameter;
} probe;

static void open_probe(const expander *e, const item *it, const opc_node *map,
                       const char *path, opc_problems *problems, probe *p) {
  g_autoptr(opc_problems) ignored = opc_problems_new();
  opc_choice choice = *e->choice;
  *p = (probe){.sweep = opc_sweep_none()};
  GPtrArray *one =
      g_ptr_array_new_with_free_func((GDestroyNotify)opc_node_free);
  char *name[] = {(char *)e->axis, NULL},
       *variant[] = {(char *)it->variant, NULL};
  g_ptr_array_add(one, opc_node_copy(map, NULL));
  opc_sweep_add_layers(p->sweep, e->axis, &map->at,
                       opc_source_layer(map->source, e->axis), one,
                       g_strdupv(name), g_strdupv(variant), ignored);
  choice.sweep = p->sweep;
  choice.point = 0;
  p->flow = opc_flow_make(e->recipe, &choice, e->registry, ignored);
  const opc_flow_step *step = opc_flow_find(p->flow, path);
  if (!step) return;
  p->step = opc_bind(e->registry, opc_node_get(p->flow->nodes, step->name),
                     step->name, &step->key->at, choice.bind, problems);
  if (!p->step) return;
  if (!problems->list->len)
    opc_inner_open(p->step, e->registry, choice.bind, problems);
  g_autoptr(GPtrArray) all = g_ptr_array_new();
  opc_binding_list(p->step, all);
  p->parameter = opc_parameter_at(all, path, &p->binding);
}

static void close_probe(probe *p) {
  opc_binding_free(p->step);
  opc_flow_free(p->flow);
  opc_sweep_free(p->sweep);
}

/* Return whether a value may be a pattern, or excludes values by a '!'. */
static gboolean is_pattern(const opc_node *node) {
  return node->type == OPC_NODE_TEXT &&
         (*node->text == '!' || strpbrk(node->text, "*?["));
}

/* Return the parameter at a path if its values may be patterns (OPC_FILE or
   OPC_LISTED). Otherwise return NULL: all values are plain texts. */
static const opc_parameter *pattern_parameter(const expander *e, const item *it,
                                              const opc_node *map,
                                              const char *path) {
  g_autoptr(opc_problems) ignored = opc_problems_new();
  probe p;
  open_probe(e, it, map, path, ignored, &p);
  const opc_parameter *found = p.parameter;
  close_probe(&p);
  return found && (found->type == OPC_FILE || found->flags & OPC_LISTED) ? found
                                                                         : NULL;
}

/* ---- values listed by plugins ---- */

static void take_choice(void *data, const char *value) {
  g_ptr_array_add(data, g_strdup(value));
}

/* Return the values that the plugin lists for the parameter at `path`, with the
   layer `map` applied (char *, freed with the array). NULL and problems on
   failure. */
static GPtrArray *list_choices(const expander *e, const item *it,
                               const opc_node *map, const char *path) {
  static const opc_watch nowhere = {.data = NULL};
  g_autoptr(GPtrArray) list = g_ptr_array_new_with_free_func(g_free);
  guint before = e->problems->list->len;
  opc_error error = {0};
  probe p;
  open_probe(e, it, map, path, e->problems, &p);
  gboolean good = p.parameter && e->problems->list->len == before &&
                  opc_binding_create(p.step, &nowhere, NULL, e->problems);
  if (good) {
    const char *was = opc_binding_enter(p.binding);
    int code = opc_choices_of(p.binding->plugin)
                   ->list(p.binding->module.self, p.parameter->name,
                          take_choice, list, &error);
    opc_binding_leave(was);
    if (code)
      good = opc_binding_fail(p.binding, FALSE, code, &error, e->problems);
  }
  close_probe(&p);
  return good ? g_steal_pointer(&list) : NULL;
}

/* ---- one key ---- */

/* Return the number of alternatives of a value. */
static guint count_of(const opc_node *value) {
  return value->type == OPC_NODE_LIST ? value->items->len : 1;
}

static const opc_node *value_at(const opc_node *value, guint i) {
  return value->type == OPC_NODE_LIST ? value->items->pdata[i] : value;
}

static gboolean has_pattern(const opc_node *value) {
  for (guint i = 0; i < count_of(value); i++)
    if (is_pattern(value_at(value, i))) return TRUE;
  return FALSE;
}

/* Add all values of a key to `out`. If `parameter` is not NULL, patterns are
   replaced by the matching values of `parameter` in the flow with the partial
   layer `under` applied. Returns FALSE and adds problems on failure. */
static gboolean find_values(const expander *e, const item *it,
                            const part *under, const char *path,
                            const opc_node *value,
                            const opc_parameter *parameter, opc_values *out) {
  gboolean good = TRUE, file = parameter && parameter->type == OPC_FILE;
  g_autoptr(GPtrArray) list = NULL;
  if (parameter && !file) {
    list = list_choices(e, it, under->map, path);
    if (!list) return FALSE;
  }
  for (guint i = 0; i < count_of(value) && good; i++) {
    const opc_node *node = value_at(value, i);
    if (!parameter || !is_pattern(node)) {
      g_ptr_array_add(out->nodes, opc_node_copy(node, NULL));
      g_ptr_array_add(out->stars, g_strdup(""));
    } else if (*node->text == '!') {
      opc_values_remove(out, node->text + 1, file);
    } else if (!file) {
      good = opc_match_choices(node, list, out, e->problems);
    } else if (under->star) {
      good = opc_pair_file(node, under->star, out, e->problems);
    } else {
      good = opc_match_files(node, out, e->problems);
    }
  }
  if (good && !out->nodes->len)
    good =
        opc_wrong(e->problems, value, "all values of '%s' are excluded", path);
  return good;
}

/* ---- names ---- */

static char *name_of(const item *it, const part *p) {
  GString *name = g_string_new(it->name ? it->name : it->variant);
  if (it->several) opc_label_add(name, p->label->str);
  if (!name->len) {
    g_autofree char *label = opc_label_of_map(p->map);
    g_string_append(name, label);
  }
  return g_string_free(name, FALSE);
}

/* ---- layers ---- */

/* Report keys that `set` also changes: `set` is applied after the layers and
   would override the keys. */
static void check_fixed(const expander *e, const opc_node *map) {
  const opc_node *set = e->choice->over;
  for (guint i = 0; set && i < map->keys->len; i++)
    for (guint k = 0; k < set->keys->len; k++) {
      const opc_node *key = map->keys->pdata[i], *fixed = set->keys->pdata[k];
      size_t n = strlen(fixed->text);
      if (strncmp(key->text, fixed->text, n) || !strchr(".", key->text[n]))
        continue;
      g_autofree char *place = opc_place_text(&fixed->at);
      opc_wrong(e->problems, key, "'%s' is already fixed by 'set' at %s",
                key->text, place);
    }
}

static void add_layer(expander *e, const item *it, const part *p) {
  g_autofree char *name = name_of(it, p);
  const opc_node *other = g_hash_table_lookup(e->known, name);
  if (!opc_is_name(name, TRUE) || strlen(name) > LONGEST) {
    opc_wrong(e->problems, it->node,
              "'%s' cannot be the name of a folder: set 'name' to letters, "
              "digits, '_', '-' and '.', at most %d",
              name, LONGEST);
    return;
  }
  if (other) {
    g_autofree char *place = opc_place_text(&other->at);
    opc_wrong(e->problems, it->node,
              "two layers of '%s' have the name '%s', the other one is at %s: "
              "set 'name' of one",
              e->axis, name, place);
    return;
  }
  check_fixed(e, p->map);
  opc_node *layer = opc_node_copy(p->map, NULL);
  layer->at = it->node->at;
  g_ptr_array_add(e->layers, layer);
  g_ptr_array_add(e->variants, g_strdup(it->variant));
  g_hash_table_insert(e->known, g_strdup(name), layer);
  g_ptr_array_add(e->names, g_steal_pointer(&name));
}

/* Combine each partial layer with each value of a key; NULL on failure. */
static GPtrArray *parts_multiply(const expander *e, const item *it,
                                 GPtrArray *parts, const opc_node *key,
                                 const opc_node *value,
                                 const opc_parameter *parameter,
                                 gboolean *several) {
  g_autoptr(GPtrArray) out = g_ptr_array_new_with_free_func(part_free);
  gboolean good = TRUE;
  *several |= count_of(value) > 1 || parameter;
  for (guint i = 0; i < parts->len && good; i++) {
    opc_values v;
    opc_values_init(&v);
    good = find_values(e, it, parts->pdata[i], key->text, value, parameter, &v);
    if (good && out->len + v.nodes->len > MOST)
      good = opc_wrong(e->problems, value, "more than %d layers", MOST);
    for (guint k = 0; good && k < v.nodes->len; k++) {
      part *p = part_copy(parts->pdata[i]);
      const opc_node *node = v.nodes->pdata[k];
      g_autofree char *label = opc_label(node);
      opc_node_add(p->map, opc_node_copy(key, NULL), opc_node_copy(node, NULL));
      if (count_of(value) > 1 || parameter) opc_label_add(p->label, label);
      if (*(char *)v.stars->pdata[k] && !p->star)
        p->star = g_strdup(v.stars->pdata[k]);
      g_ptr_array_add(out, p);
    }
    opc_values_clear(&v);
  }
  return good ? g_steal_pointer(&out) : NULL;
}

/* Return a layer with the first value of each key, except of keys that begin
   with a pattern. Patterns are expanded with this layer applied. */
static opc_node *plain_layer(const opc_node *map) {
  opc_node *plain = opc_node_map_new(map->source, &map->at);
  for (guint i = 0; i < map->items->len; i++) {
    const opc_node *value = map->items->pdata[i];
    if (count_of(value) && !is_pattern(value_at(value, 0)))
      opc_node_add(plain, opc_node_copy(map->keys->pdata[i], NULL),
                   opc_node_copy(value_at(value, 0), NULL));
  }
  return plain;
}

/* Add all combinations of the values of a map of paths. Patterns of OPC_LISTED
   parameters are expanded last, because the values listed by a plugin depend on
   other parameters. */
static void expand_map(expander *e, item *it, const opc_node *map) {
  g_autoptr(opc_node) plain = plain_layer(map);
  g_autoptr(GPtrArray) parts = g_ptr_array_new_with_free_func(part_free);
  g_autofree const opc_parameter **of =
      g_new0(const opc_parameter *, map->items->len + 1);
  part *first = g_new0(part, 1);
  first->map = opc_node_map_new(map->source, &map->at);
  first->label = g_string_new(NULL);
  g_ptr_array_add(parts, first);
  for (guint i = 0; i < map->items->len; i++)
    if (has_pattern(map->items->pdata[i]))
      of[i] = pattern_parameter(e, it, plain, opc_node_key(map, i));
  for (int listed = 0; listed < 2; listed++)
    for (guint i = 0; parts && i < map->items->len; i++) {
      if ((of[i] && of[i]->type != OPC_FILE) != listed) continue;
      GPtrArray *more =
          parts_multiply(e, it, parts, map->keys->pdata[i],
                         map->items->pdata[i], of[i], &it->several);
      g_ptr_array_free(parts, TRUE);
      parts = more;
    }
  for (guint i = 0; parts && i < parts->len; i++)
    add_layer(e, it, parts->pdata[i]);
}

/* ---- elements ---- */

static void expand_node(expander *e, const char *name, const opc_node *node);

static const char *take_variant(const expander *e, const opc_node *node) {
  if (node->type != OPC_NODE_TEXT) {
    opc_wrong(e->problems, node, "'variant' must be a name, found %s",
              opc_node_noun(node));
    return NULL;
  }
  if (opc_node_is_null(node) || !strcmp(node->text, "base")) return "";
  return opc_recipe_has(e->recipe, node->text, &node->at, e->problems)
             ? node->text
             : NULL;
}

/* Set a value in a map; the key gets the place of `like`. */
static void node_put_like(opc_node *map, const char *key, const opc_node *like,
                          const opc_node *value) {
  g_autoptr(opc_node) name = opc_node_text_new(like->source, key);
  name->at = like->at;
  opc_node_put(map, name, value);
}

/* Expand an element of the list file that `map` names by its key `list`. The
   other keys of `map` apply to all elements that do not set these keys. */
static void expand_element(expander *e, const char *name, const opc_node *map,
                           const opc_node *key, const opc_node *element) {
  g_autoptr(opc_node) whole = opc_node_map_new(element->source, &element->at);
  for (guint i = 0; i < map->items->len; i++)
    if (strcmp(opc_node_key(map, i), "list") != 0)
      opc_node_put(whole, map->keys->pdata[i], map->items->pdata[i]);
  if (key) node_put_like(whole, "name", key, key);
  if (element->type == OPC_NODE_TEXT)
    node_put_like(whole, "variant", element, element);
  for (guint i = 0; element->type == OPC_NODE_MAP && i < element->items->len;
       i++)
    opc_node_put(whole, element->keys->pdata[i], element->items->pdata[i]);
  if (element->type == OPC_NODE_LIST)
    opc_wrong(e->problems, element, "a list must not contain a list");
  else
    expand_node(e, name, whole);
}

static void expand_list(expander *e, const char *name, const opc_node *map,
                        const opc_node *file) {
  if (file->type != OPC_NODE_TEXT || e->depth == DEEPEST) {
    opc_wrong(e->problems, file,
              file->type == OPC_NODE_TEXT ? "lists are nested deeper than %d"
                                          : "'list' must be the name of a file",
              DEEPEST);
    return;
  }
  g_autofree char *path = opc_node_path(file);
  g_autofree char *folder = g_path_get_dirname(path);
  opc_source *source = opc_source_new(path, strcmp(folder, ".") ? folder : "");
  g_autoptr(opc_node) list =
      opc_list_read(source, path, &file->at, e->problems);
  g_ptr_array_add(e->recipe->sources, source);
  if (!list) return;
  if (list->type == OPC_NODE_TEXT || !list->items->len) {
    opc_wrong(e->problems, list, "the list '%s' has no elements", path);
    return;
  }
  e->depth++;
  for (guint i = 0; i < list->items->len && !opc_problems_full(e->problems);
       i++)
    expand_element(e, name, map, list->keys ? list->keys->pdata[i] : NULL,
                   list->items->pdata[i]);
  e->depth--;
}

/* Expand a map of paths and the keywords `list`, `variant` and `name`. */
static void expand_words(expander *e, const char *name, const opc_node *node) {
  const opc_node *list = opc_node_get(node, "list");
  if (list) {
    expand_list(e, name, node, list);
    return;
  }
  item it = {node, name, "", FALSE};
  g_autoptr(opc_node) map = opc_node_map_new(node->source, &node->at);
  for (guint i = 0; i < node->items->len; i++) {
    const opc_node *key = node->keys->pdata[i], *value = node->items->pdata[i];
    if (!strcmp(key->text, "variant")) {
      it.variant = take_variant(e, value);
    } else if (strcmp(key->text, "name") != 0) {
      opc_node_add(map, opc_node_copy(key, NULL), opc_node_copy(value, NULL));
    } else if (value->type == OPC_NODE_TEXT) {
      it.name = value->text;
    } else {
      opc_wrong(e->problems, value, "'name' must be a text");
      return;
    }
  }
  if (it.variant) expand_map(e, &it, map);
}

/* Expand an element. `name` is the name of the layer; if NULL, the element
   determines the name. */
static void expand_node(expander *e, const char *name, const opc_node *node) {
  if (node->type == OPC_NODE_MAP) {
    expand_words(e, name, node);
  } else if (node->type == OPC_NODE_TEXT) {
    item it = {node, name ? name : node->text, take_variant(e, node), FALSE};
    g_autoptr(opc_node) none = opc_node_map_new(node->source, &node->at);
    if (it.variant) expand_map(e, &it, none);
  } else {
    opc_wrong(e->problems, node,
              "a layer of '%s' must be a variant or a map, found a list",
              e->axis);
  }
}

/* ---- the axis ---- */

static char **take_texts(GPtrArray *texts) {
  g_ptr_array_add(texts, NULL);
  return (char **)g_ptr_array_free(texts, FALSE);
}

void opc_expand(opc_sweep *sweep, const char *name, const opc_node *node,
                opc_recipe *recipe, const opc_choice *choice,
                opc_registry *registry, opc_problems *problems) {
  guint before = problems->list->len;
  expander e = {
      .axis = name,
      .recipe = recipe,
      .choice = choice,
      .registry = registry,
      .problems = problems,
      .layers = g_ptr_array_new_with_free_func((GDestroyNotify)opc_node_free),
      .names = g_ptr_array_new(),
      .variants = g_ptr_array_new(),
      .known = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL)};
  for (guint i = 0; i < node->items->len && !opc_problems_full(problems); i++)
    expand_node(&e, node->keys ? opc_node_key(node, i) : NULL,
                node->items->pdata[i]);
  g_hash_table_destroy(e.known);
  if (!e.layers->len && problems->list->len == before)
    opc_wrong(problems, node, "'%s' is empty", name);
  char **names = take_texts(e.names), **variants = take_texts(e.variants);
  if (e.layers->len) {
    opc_sweep_add_layers(sweep, name, &node->at,
                         opc_source_layer(node->source, name), e.layers, names,
                         variants, problems);
    return;
  }
  g_ptr_array_free(e.layers, TRUE);
  g_strfreev(names);
  g_strfreev(variants);
}
