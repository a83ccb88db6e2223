/* SPDX-License-Identifier: BSD-3-Clause */
/* Application of trees to other trees, and layers from a command line. */
#include <base/layers.h>

#include <string.h>

/* Largest number of words in a path, equal to the nesting of a file. */
enum { DEEPEST = 64 };

/* Common arguments of opc_lay(). */
typedef struct layer {
  opc_problems *problems;
  const opc_node *steps; /* map whose new entries need `use`, or NULL */
} layer;

static void lay_map(const layer *l, opc_node *under, const opc_node *over);

/* ---- one key ---- */

/* Copy a node. A map is applied to an empty map, so that a value `~` is
   reported: there is no key to remove. */
static opc_node *node_copy(const layer *l, const opc_node *node) {
  if (node->type != OPC_NODE_MAP) return opc_node_copy(node, NULL);
  opc_node *map = opc_node_map_new(node->source, &node->at);
  lay_map(l, map, node);
  return map;
}

/* Return whether the map `over` selects another plugin than the map `under`. */
static gboolean is_other(const opc_node *under, const opc_node *over) {
  const opc_node *new = opc_node_get(over, "use");
  const opc_node *old = opc_node_get(under, "use");
  return new && (!old || g_strcmp0(old->text, new->text));
}

static void add_key(const layer *l, opc_node *under, const opc_node *key,
                    const opc_node *value) {
  if (opc_node_is_null(value))
    opc_node_missing(under, key->text, &key->at, "cannot remove",
                     ", which does not exist", l->problems);
  else if (under == l->steps && !opc_node_get(value, "use"))
    opc_node_missing(under, key->text, &key->at, "unknown step", "",
                     l->problems);
  else
    opc_node_add(under, opc_node_copy(key, NULL), node_copy(l, value));
}

/* Apply `value` to a key that exists with the value *old. If the key is
   removed, *old_key and *old become NULL. */
static void lay_key(const layer *l, gpointer *old_key, gpointer *old,
                    const opc_node *key, const opc_node *value) {
  gboolean maps =
      ((opc_node *)*old)->type == OPC_NODE_MAP && value->type == OPC_NODE_MAP;
  if (maps && !is_other(*old, value)) {
    lay_map(l, *old, value);
    return;
  }
  gboolean stays = !opc_node_is_null(value);
  opc_node_free(*old_key);
  opc_node_free(*old);
  *old_key = stays ? opc_node_copy(key, NULL) : NULL;
  *old = stays ? node_copy(l, value) : NULL;
}

/* ---- keys with dots ---- */

static void map_put(opc_node *map, const opc_node *key, const char *path,
                    const opc_node *value, gboolean deep,
                    opc_problems *problems);

/* Copy all keys of a map into another map and make keys with dots nested maps,
   inside nested values only if `deep` is TRUE. */
static void put_all(opc_node *map, const opc_node *from, gboolean deep,
                    opc_problems *problems) {
  for (guint i = 0; i < from->keys->len; i++)
    map_put(map, from->keys->pdata[i], opc_node_key(from, i),
            from->items->pdata[i], deep, problems);
}

/* Insert a value. The depth of recursion is the sum of the dots in the path and
   the depth of the value. */
static void map_put(opc_node *map, const opc_node *key, const char *path,
                    const opc_node *value, gboolean deep,
                    opc_problems *problems) {
  size_t n = strcspn(path, ".");
  gboolean last = !path[n], is_map = value->type == OPC_NODE_MAP;
  g_autofree char *word = g_strndup(path, n);
  int i = opc_node_find(map, word);
  opc_node *there = i < 0 ? NULL : map->items->pdata[i];
  if (there && (there->type != OPC_NODE_MAP || (last && !is_map))) {
    const opc_node *first = map->keys->pdata[i];
    g_autofree char *place = opc_place_text(&first->at);
    opc_wrong(problems, key, "'%s' is given here and at %s", key->text, place);
    return;
  }
  gboolean whole = last && !(is_map && (deep || there));
  if (!there) {
    opc_node *name = opc_node_copy(key, NULL);
    g_free(name->text);
    name->text = g_steal_pointer(&word);
    there = whole
                ? opc_node_copy(value, NULL)
                : opc_node_map_new(value->source, last ? &value->at : &key->at);
    opc_node_add(map, name, there);
  }
  if (!last)
    map_put(there, key, path + n + 1, value, deep, problems);
  else if (!whole)
    put_all(there, value, deep, problems);
}

opc_node *opc_undot(const opc_node *map, gboolean deep,
                    opc_problems *problems) {
  opc_node *copy = opc_node_map_new(map->source, &map->at);
  put_all(copy, map, deep, problems);
  return copy;
}

/* Return whether the beginning of a dotted key of `map` is a key of `other`
   whose value is a map, such as "a.b: ..." in `map` and "a: { b: ... }" in
   `other`. */
static gboolean map_continues_key(const opc_node *map, const opc_node *other) {
  for (guint i = 0; i < map->keys->len; i++) {
    g_autofree char *path = g_strdup(opc_node_key(map, i));
    for (char *dot; (dot = strrchr(path, '.'));) {
      *dot = 0;
      const opc_node *value = opc_node_get(other, path);
      if (value && value->type == OPC_NODE_MAP) return TRUE;
    }
  }
  return FALSE;
}

/* Replace dotted keys by nested maps: in `under` itself, and in the returned
   copy of `over`. */
static opc_node *undot_both(opc_node *under, const opc_node *over,
                            opc_problems *problems) {
  opc_node *flat = opc_undot(under, FALSE, problems);
  GPtrArray *keys = under->keys, *items = under->items;
  under->keys = flat->keys;
  under->items = flat->items;
  flat->keys = keys;
  flat->items = items;
  opc_node_free(flat);
  return opc_undot(over, FALSE, problems);
}

/* ---- maps ---- */

/* Apply a map. The depth of recursion is the depth of the trees; the time is
   proportional to the size of the trees. */
static void lay_map(const layer *l, opc_node *under, const opc_node *over) {
  g_autoptr(opc_node) undotted = NULL;
  if (under != l->steps &&
      (map_continues_key(over, under) || map_continues_key(under, over)))
    undotted = undot_both(under, over, l->problems);
  if (undotted) over = undotted;
  /* Key of `over` -> index + 1, for keys that are not yet applied. */
  g_autoptr(GHashTable) left = g_hash_table_new(g_str_hash, g_str_equal);
  gpointer *keys = under->keys->pdata, *items = under->items->pdata;
  guint n = 0, before = under->keys->len;
  for (guint k = 0; k < over->keys->len; k++)
    g_hash_table_insert(left, (char *)opc_node_key(over, k),
                        GUINT_TO_POINTER(k + 1));
  for (guint i = 0; i < before; i++) {
    const char *name = opc_node_key(under, i);
    guint k = GPOINTER_TO_UINT(g_hash_table_lookup(left, name));
    g_hash_table_remove(left, name);
    if (k)
      lay_key(l, &keys[i], &items[i], over->keys->pdata[k - 1],
              over->items->pdata[k - 1]);
    if (!items[i]) continue;
    keys[n] = keys[i];
    items[n++] = items[i];
  }
  for (guint i = n; i < before; i++) keys[i] = items[i] = NULL;
  g_ptr_array_set_size(under->keys, (gint)n);
  g_ptr_array_set_size(under->items, (gint)n);
  for (guint k = 0; k < over->keys->len && !opc_problems_full(l->problems); k++)
    if (g_hash_table_contains(left, opc_node_key(over, k)))
      add_key(l, under, over->keys->pdata[k], over->items->pdata[k]);
}

void opc_lay(opc_node *under, const opc_node *over, opc_problems *problems) {
  const layer l = {problems, NULL};
  lay_map(&l, under, over);
}

/* If no steps exist, all steps are new and need no `use`. */
void opc_lay_steps(opc_node *steps, const opc_node *over,
                   opc_problems *problems) {
  const layer l = {problems, steps->keys->len ? steps : NULL};
  lay_map(&l, steps, over);
}

/* ---- paths ---- */

static gboolean check_path(char **words, const char *path, const opc_place *at,
                           opc_problems *problems) {
  guint n = g_strv_length(words);
  gboolean good = n > 0 && n <= DEEPEST;
  for (guint i = 0; i < n; i++) good &= *words[i] != 0;
  if (!good)
    opc_problem_add(problems, OPC_INVALID, at,
                    n > DEEPEST
                        ? "'%s' is deeper than 64"
                        : "'%s' is not a path, expected 'step.parameter'",
                    path);
  return good;
}

/* Return the nested maps of a path; NULL and a problem if the path is
   invalid. */
static opc_node *path_tree(const char *path, const opc_place *key,
                           const opc_node *value, opc_problems *problems) {
  g_auto(GStrv) words = g_strsplit(path, ".", DEEPEST + 1);
  if (!check_path(words, path, key, problems)) return NULL;
  opc_node *tree = opc_node_copy(value, NULL);
  for (guint i = g_strv_length(words); i-- > 0;) {
    opc_node *map = opc_node_map_new(value->source, key);
    opc_node *word = opc_node_text_new(value->source, words[i]);
    word->at = *key;
    opc_node_add(map, word, tree);
    tree = map;
  }
  return tree;
}

void opc_lay_at(opc_node *steps, const char *path, const opc_place *key,
                const opc_node *value, opc_problems *problems) {
  g_autoptr(opc_node) tree = path_tree(path, key, value, problems);
  if (tree) opc_lay_steps(steps, tree, problems);
}

void opc_lay_demands(opc_node *demands, const char *path, const opc_place *key,
                     const opc_node *value, opc_problems *problems) {
  g_autoptr(opc_node) undotted = value->type == OPC_NODE_MAP
                                     ? opc_undot(value, TRUE, problems)
                                     : opc_node_copy(value, NULL);
  g_autoptr(opc_node) tree = path_tree(path, key, undotted, problems);
  if (tree) opc_lay(demands, tree, problems);
}

/* ---- the command line ---- */

/* Return whether the shell has replaced an unquoted ~ by the path of the home
   folder. No value can be that path. */
static gboolean is_expanded(const char *text) {
  const char *home = g_getenv("HOME");
  return home && *home == '/' && home[1] && !strcmp(text, home);
}

/* Parse a value; the problems have no line number. */
static opc_node *parse_value(const char *text, const opc_source *source,
                             opc_problems *problems) {
  g_autoptr(opc_problems) found = opc_problems_new();
  const opc_place at = {source->name, 0, 0};
  opc_node *value = NULL;
  if (is_expanded(text))
    opc_problem_add(problems, OPC_INVALID, &at,
                    "the shell turned ~ into '%s': quote it, or write '%s/' "
                    "for the folder",
                    text, text);
  else if (*text)
    value = opc_node_parse(source, text, strlen(text), found);
  else
    opc_problem_add(problems, OPC_INVALID, &at, "has no value");
  for (guint i = 0; i < found->list->len; i++)
    opc_problem_add(problems, OPC_INVALID, &at, "%s",
                    ((opc_problem *)found->list->pdata[i])->message);
  return value;
}

opc_node *opc_argument_parse(const char *option, const char *text, char **path,
                             opc_source **source, opc_problems *problems) {
  const char *equals = strchr(text, '=');
  *path = equals ? g_strndup(text, (gsize)(equals - text)) : g_strdup(text);
  g_autofree char *name = g_strdup_printf("%s %s", option, *path);
  *source = opc_source_new(name, NULL);
  const opc_place at = {(*source)->name, 0, 0};
  if (!g_utf8_validate(*path, -1, NULL)) {
    opc_problem_add(problems, OPC_INVALID, &at, "the name is not UTF-8 text");
    return NULL;
  }
  opc_node *value = equals ? parse_value(equals + 1, *source, problems) : NULL;
  /* A path without a dot is a step, which can be removed (~) or changed by a
     map, but has no value. */
  gboolean good = equals && **path;
  if (good && value && !strchr(*path, '.'))
    good = value->type == OPC_NODE_MAP || opc_node_is_null(value);
  if (good || (equals && is_expanded(equals + 1))) return value;
  opc_problem_add(problems, OPC_INVALID, &at,
                  "expected the form 'step.parameter=value'");
  opc_node_free(value);
  return NULL;
}
