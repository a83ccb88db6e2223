/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/flow/layers.h"

#include <string.h>

#include "core/text/suggest.h"

/* Of a path: as many words as a file may nest. */
enum { DEEPEST = 64 };

/* What all of one lay() needs. */
typedef struct layer {
  const opc_source *source;
  opc_problems *problems;
  const opc_node *steps; /* the map whose new entries need `use`, or NULL */
} layer;

static void lay_map(const layer *l, opc_node *under, const opc_node *over);

/* ---- one key ---- */

static char *suggestion_for(const char *word, const opc_node *map) {
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (guint i = 0; i < map->keys->len; i++)
    if (map->items->pdata[i])
      g_ptr_array_add(names, ((opc_node *)map->keys->pdata[i])->text);
  return opc_suggestion(word, names);
}

/* Maps are laid over nothing: what they want to remove cannot be there. */
static opc_node *copy(const layer *l, const opc_node *node) {
  if (node->type != OPC_NODE_MAP) return opc_node_copy(node, l->source);
  const opc_source *source = l->source ? l->source : node->source;
  opc_place at = node->at;
  at.file = source->name;
  opc_node *map = opc_node_map_new(source, &at);
  lay_map(l, map, node);
  return map;
}

/* Whether a map is about another plugin than the one below. */
static gboolean is_other(const opc_node *under, const opc_node *over) {
  const opc_node *new = opc_node_get(over, "use");
  const opc_node *old = opc_node_get(under, "use");
  if (!new) return FALSE;
  return !old || g_strcmp0(old->text, new->text);
}

/* What stands at `i` goes; its place stays until lay_map has seen all. */
static void clear(opc_node *map, guint i) {
  opc_node_free(map->keys->pdata[i]);
  opc_node_free(map->items->pdata[i]);
  map->keys->pdata[i] = map->items->pdata[i] = NULL;
}

/* A key that is not below, where it must be. */
static void report(const layer *l, const opc_node *under, const opc_node *key,
                   const char *before, const char *after) {
  g_autofree char *suggestion = suggestion_for(key->text, under);
  opc_place at = key->at;
  if (l->source) at.file = l->source->name;
  opc_problem_add(l->problems, OPC_INVALID, &at, "%s '%s'%s%s", before,
                  key->text, after, suggestion);
}

static void add_key(const layer *l, opc_node *under, const opc_node *key,
                    const opc_node *value) {
  if (opc_node_is_null(value))
    report(l, under, key, "there is no", " to remove");
  else if (under == l->steps && !opc_node_get(value, "use"))
    report(l, under, key, "unknown step", "");
  else
    opc_node_add(under, opc_node_copy(key, l->source), copy(l, value));
}

/* `i`: where the key is below, -1 if it is not. */
static void lay_key(const layer *l, opc_node *under, int i, const opc_node *key,
                    const opc_node *value) {
  gboolean removes = opc_node_is_null(value);
  if (i < 0) {
    add_key(l, under, key, value);
    return;
  }
  opc_node *old = under->items->pdata[i];
  gboolean merges = old->type == OPC_NODE_MAP && value->type == OPC_NODE_MAP;
  if (merges && !is_other(old, value)) {
    lay_map(l, old, value);
    return;
  }
  clear(under, (guint)i);
  if (removes) return;
  under->keys->pdata[i] = opc_node_copy(key, l->source);
  under->items->pdata[i] = copy(l, value);
}

/* ---- maps ---- */

/* Close the gaps of what was removed. */
static void compact(opc_node *map) {
  guint n = 0;
  for (guint i = 0; i < map->items->len; i++) {
    if (!map->items->pdata[i]) continue;
    map->keys->pdata[n] = map->keys->pdata[i];
    map->items->pdata[n++] = map->items->pdata[i];
  }
  for (guint i = n; i < map->items->len; i++)
    map->keys->pdata[i] = map->items->pdata[i] = NULL;
  g_ptr_array_set_size(map->keys, (gint)n);
  g_ptr_array_set_size(map->items, (gint)n);
}

/* As deep as the trees; in time proportional to them. */
static void lay_map(const layer *l, opc_node *under, const opc_node *over) {
  g_autoptr(GHashTable) index = g_hash_table_new(g_str_hash, g_str_equal);
  g_autoptr(GPtrArray) names = g_ptr_array_new_with_free_func(g_free);
  for (guint i = 0; i < under->keys->len; i++) {
    char *name = g_strdup(((opc_node *)under->keys->pdata[i])->text);
    g_ptr_array_add(names, name);
    g_hash_table_insert(index, name, GINT_TO_POINTER(i + 1));
  }
  for (guint k = 0; k < over->keys->len && !opc_problems_full(l->problems);
       k++) {
    const opc_node *key = over->keys->pdata[k];
    int i = GPOINTER_TO_INT(g_hash_table_lookup(index, key->text)) - 1;
    lay_key(l, under, i, key, over->items->pdata[k]);
  }
  compact(under);
}

void opc_lay(opc_node *under, const opc_node *over, const opc_source *source,
             opc_problems *problems) {
  const layer l = {source, problems, NULL};
  lay_map(&l, under, over);
}

/* Where there are no steps yet, all are new. */
void opc_lay_steps(opc_node *steps, const opc_node *over,
                   const opc_source *source, opc_problems *problems) {
  const layer l = {source, problems, steps->keys->len ? steps : NULL};
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
                    n > DEEPEST ? "'%s' is deeper than 64"
                                : "'%s' is no path, as 'step.parameter'",
                    path);
  return good;
}

void opc_lay_at(opc_node *steps, const char *path, const opc_place *key,
                const opc_node *value, const opc_source *source,
                opc_problems *problems) {
  g_auto(GStrv) words = g_strsplit(path, ".", DEEPEST + 1);
  const opc_source *whose = source ? source : value->source;
  opc_place at = *key;
  if (source) at.file = source->name;
  if (!check_path(words, path, &at, problems)) return;
  opc_node *tree = opc_node_copy(value, source);
  for (guint i = g_strv_length(words); i-- > 0;) {
    opc_node *map = opc_node_map_new(whose, &at);
    opc_node *word = opc_node_text_new(whose, words[i]);
    word->at = at;
    opc_node_add(map, word, tree);
    tree = map;
  }
  opc_lay_steps(steps, tree, source, problems);
  opc_node_free(tree);
}

/* ---- the command line ---- */

static opc_node *parse_value(const char *text, const opc_source *source,
                             opc_problems *problems) {
  g_autoptr(opc_problems) found = opc_problems_new();
  const opc_place at = {source->name, 0, 0};
  if (!*text) {
    opc_problem_add(problems, OPC_INVALID, &at, "has no value");
    return NULL;
  }
  opc_node *value = opc_node_parse(source, text, strlen(text), found);
  for (guint i = 0; i < found->list->len; i++)
    opc_problem_add(problems, OPC_INVALID, &at, "%s",
                    ((opc_problem *)found->list->pdata[i])->message);
  if (value) opc_node_forget_lines(value);
  return value;
}

opc_node *opc_argument_parse(const char *option, const char *text, char **path,
                             opc_source **source, opc_problems *problems) {
  const char *equals = strchr(text, '=');
  *path = equals ? g_strndup(text, (gsize)(equals - text)) : g_strdup(text);
  g_autofree char *name = g_strdup_printf("%s %s", option, *path);
  *source = opc_source_new(name, NULL);
  opc_node *value = equals ? parse_value(equals + 1, *source, problems) : NULL;
  /* A whole step can be removed or changed, but is no value. */
  gboolean good = equals && **path;
  if (good && value && !strchr(*path, '.'))
    good = value->type == OPC_NODE_MAP || opc_node_is_null(value);
  if (good) return value;
  const opc_place at = {(*source)->name, 0, 0};
  opc_problem_add(problems, OPC_INVALID, &at,
                  "needs the form 'step.parameter=value'");
  opc_node_free(value);
  return NULL;
}

void opc_lay_set(opc_node *steps, const char *set, GPtrArray *sources,
                 opc_problems *problems) {
  g_autofree char *path = NULL;
  opc_source *source;
  g_autoptr(opc_node) value =
      opc_argument_parse("--set", set, &path, &source, problems);
  g_ptr_array_add(sources, source);
  const opc_place at = {source->name, 0, 0};
  if (value) opc_lay_at(steps, path, &at, value, source, problems);
}
