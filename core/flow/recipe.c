/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/flow/recipe.h"

#include <string.h>

#include "core/flow/layers.h"
#include "core/text/suggest.h"

enum {
  MOST_FILES = 16,   /* that extend each other */
  MOST_STEPS = 1000, /* also of keys in a variant or a sweep */
  MOST_VARIANTS = 100
};

#define WRONG(problems, node, ...) \
  opc_problem_add(problems, OPC_INVALID, &(node)->at, __VA_ARGS__)

gboolean opc_is_name(const char *text, gboolean dots) {
  if (!g_ascii_isalnum(*text) && *text != '_') return FALSE;
  for (; *text; text++)
    if (!g_ascii_isalnum(*text) && *text != '_' && *text != '-' &&
        !(dots && *text == '.'))
      return FALSE;
  return TRUE;
}

/* ---- the head of a file ---- */

static void check_keys(const opc_node *root, opc_problems *problems) {
  static const char *const known[] = {"opcflow", "name",  "description",
                                      "extends", "steps", "variants",
                                      "sweep",   NULL};
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (guint i = 0; known[i]; i++) g_ptr_array_add(names, (char *)known[i]);
  for (guint i = 0; i < root->keys->len && !opc_problems_full(problems); i++) {
    const opc_node *key = root->keys->pdata[i];
    if (g_strv_contains(known, key->text)) continue;
    g_autofree char *suggestion = opc_suggestion(key->text, names);
    WRONG(problems, key, "unknown key '%s'%s", key->text, suggestion);
  }
}

static void check_version(const opc_node *root, opc_problems *problems) {
  const opc_node *version = opc_node_get(root, "opcflow");
  if (!version)
    WRONG(problems, root, "missing 'opcflow: 1', the version of the format");
  else if (version->type != OPC_NODE_TEXT || strcmp(version->text, "1"))
    WRONG(problems, version, "'opcflow' must be 1, the version of the format");
}

/* The name that the file gives itself, or what it is called. */
static char *flow_name(const opc_node *root, const char *path,
                       opc_problems *problems) {
  const opc_node *name = opc_node_get(root, "name");
  if (name && name->type == OPC_NODE_TEXT && opc_is_name(name->text, TRUE))
    return g_strdup(name->text);
  if (name)
    WRONG(problems, name,
          "'name' is made of letters, digits, '.', '_' and '-'");
  char *base = g_path_get_basename(path);
  char *dot = strrchr(base, '.');
  if (dot && dot > base) *dot = 0;
  for (char *c = base; *c; c++)
    if (!g_ascii_isalnum(*c) && !strchr("._-", *c)) *c = '_';
  if (*base == '.' || *base == '-') *base = '_';
  return base;
}

static char *flow_description(const opc_node *root, opc_problems *problems) {
  const opc_node *text = opc_node_get(root, "description");
  if (!text) return NULL;
  if (text->type == OPC_NODE_TEXT) return g_strdup(text->text);
  WRONG(problems, text, "'description' needs a text, not %s",
        opc_node_noun(text));
  return NULL;
}

/* ---- files ---- */

/* FALSE and a problem: at `from`, which extends it, where there is one. */
static gboolean read_file(opc_recipe *recipe, const char *path,
                          const opc_node *from, opc_problems *problems) {
  g_autofree char *folder = g_path_get_dirname(path);
  opc_source *source = opc_source_new(path, strcmp(folder, ".") ? folder : "");
  g_ptr_array_add(recipe->sources, source);
  g_autoptr(opc_problems) found = opc_problems_new();
  opc_node *root = opc_node_read(source, path, found);
  for (guint i = 0; i < found->list->len; i++) {
    const opc_problem *p = found->list->pdata[i];
    const opc_place at = {p->file, p->line, p->column};
    opc_problem_add(problems, p->code, !p->file && from ? &from->at : &at, "%s",
                    p->message);
  }
  if (!root) return FALSE;
  g_ptr_array_add(recipe->roots, root);
  if (root->type == OPC_NODE_MAP) return TRUE;
  WRONG(problems, root, "a flow is a map, not %s", opc_node_noun(root));
  return FALSE;
}

/* The number of the file among those read, -1 if it is not there. */
static int find_file(const opc_recipe *recipe, const char *path) {
  g_autofree char *real = realpath(path, NULL);
  for (guint i = 0; real && i < recipe->sources->len; i++) {
    const opc_source *source = recipe->sources->pdata[i];
    g_autofree char *other = realpath(source->name, NULL);
    if (!g_strcmp0(real, other)) return (int)i;
  }
  return -1;
}

static void report_circle(const opc_recipe *recipe, guint first,
                          const opc_node *at, opc_problems *problems) {
  g_autoptr(GString) text = g_string_new(NULL);
  for (guint i = first; i < recipe->sources->len; i++)
    g_string_append_printf(text, "%s -> ",
                           ((opc_source *)recipe->sources->pdata[i])->name);
  WRONG(problems, at, "flows that extend each other: %s%s", text->str,
        ((opc_source *)recipe->sources->pdata[first])->name);
}

/* What the last file read extends: its path (g_free), NULL if there is nothing
   more to read. */
static char *next_file(const opc_recipe *recipe, const opc_node *extends,
                       opc_problems *problems) {
  if (extends->type != OPC_NODE_TEXT || !*extends->text ||
      opc_node_is_null(extends)) {
    WRONG(problems, extends, "'extends' needs the name of a flow file");
    return NULL;
  }
  const char *folder = extends->source->folder;
  char *path = g_path_is_absolute(extends->text) || !*folder
                   ? g_strdup(extends->text)
                   : g_build_filename(folder, extends->text, NULL);
  int known = find_file(recipe, path);
  if (known < 0 && recipe->sources->len < MOST_FILES) return path;
  if (known >= 0)
    report_circle(recipe, (guint)known, extends, problems);
  else
    WRONG(problems, extends, "more than %d flows extend each other",
          MOST_FILES);
  g_free(path);
  return NULL;
}

/* Read the file and what it extends. */
static gboolean read_chain(opc_recipe *recipe, opc_problems *problems) {
  g_autofree char *path = g_strdup(recipe->path);
  const opc_node *from = NULL;
  while (path) {
    if (!read_file(recipe, path, from, problems)) return FALSE;
    const opc_node *root = recipe->roots->pdata[recipe->roots->len - 1];
    from = opc_node_get(root, "extends");
    g_free(path);
    path = from ? next_file(recipe, from, problems) : NULL;
    if (from && !path) return FALSE;
  }
  return TRUE;
}

/* ---- what is in them ---- */

/* The map of that name in a file, NULL if it is not there or not good. */
static const opc_node *section(const opc_node *root, const char *name,
                               guint most, opc_problems *problems) {
  const opc_node *node = opc_node_get(root, name);
  if (!node) return NULL;
  if (node->type != OPC_NODE_MAP || !node->items->len)
    WRONG(problems, node, "'%s' needs a map of %s", name,
          strcmp(name, "sweep") ? name : "parameters");
  else if (node->items->len > most)
    WRONG(problems, node, "more than %u %s", most,
          strcmp(name, "sweep") ? name : "parameters");
  else
    return node;
  return NULL;
}

static void take_steps(opc_recipe *recipe, const opc_node *root,
                       opc_problems *problems) {
  const opc_node *steps = section(root, "steps", MOST_STEPS, problems);
  if (!steps) return;
  if (!recipe->steps)
    recipe->steps = opc_node_map_new(steps->source, &steps->at);
  opc_lay_steps(recipe->steps, steps, NULL, problems);
}

static guint find_variant(const opc_recipe *recipe, const char *name) {
  guint i;
  for (i = 0; i < recipe->variants->len; i++)
    if (!strcmp(((opc_variant *)recipe->variants->pdata[i])->name, name)) break;
  return i;
}

static char *suggest_variant(const opc_recipe *recipe, const char *name) {
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (guint i = 0; i < recipe->variants->len; i++)
    g_ptr_array_add(names,
                    (char *)((opc_variant *)recipe->variants->pdata[i])->name);
  return opc_suggestion(name, names);
}

static void remove_variant(opc_recipe *recipe, const opc_node *key,
                           opc_problems *problems) {
  guint i = find_variant(recipe, key->text);
  if (i < recipe->variants->len) {
    g_ptr_array_remove_index(recipe->variants, i);
    return;
  }
  g_autofree char *suggestion = suggest_variant(recipe, key->text);
  WRONG(problems, key, "there is no variant '%s' to remove%s", key->text,
        suggestion);
}

static void add_variant(opc_recipe *recipe, const opc_node *key,
                        const opc_node *value) {
  guint i = find_variant(recipe, key->text);
  if (i == recipe->variants->len) {
    opc_variant *variant = g_new0(opc_variant, 1);
    variant->name = key->text;
    variant->key = key;
    variant->parts = g_ptr_array_new();
    g_ptr_array_add(recipe->variants, variant);
  }
  g_ptr_array_add(((opc_variant *)recipe->variants->pdata[i])->parts,
                  (opc_node *)value);
}

static void take_variants(opc_recipe *recipe, const opc_node *root,
                          opc_problems *problems) {
  const opc_node *all = section(root, "variants", MOST_VARIANTS, problems);
  for (guint i = 0; all && i < all->items->len; i++) {
    const opc_node *key = all->keys->pdata[i], *value = all->items->pdata[i];
    if (!opc_is_name(key->text, FALSE) || !strcmp(key->text, "all") ||
        !strcmp(key->text, "base"))
      WRONG(problems, key,
            "a variant needs a name of letters, digits, '_' and '-', other "
            "than 'all' and 'base', not '%s'",
            key->text);
    else if (opc_node_is_null(value))
      remove_variant(recipe, key, problems);
    else if (value->type != OPC_NODE_MAP || value->items->len > MOST_STEPS)
      WRONG(problems, value,
            "the variant '%s' needs a map of at most %d parameters", key->text,
            MOST_STEPS);
    else
      add_variant(recipe, key, value);
  }
}

static void take_sweep(opc_recipe *recipe, const opc_node *root,
                       opc_problems *problems) {
  if (opc_node_get(root, "sweep") &&
      opc_node_is_null(opc_node_get(root, "sweep"))) {
    g_array_set_size(recipe->sweep, 0);
    return;
  }
  const opc_node *all = section(root, "sweep", MOST_STEPS, problems);
  for (guint i = 0; all && i < all->items->len; i++) {
    const opc_entry entry = {all->keys->pdata[i], all->items->pdata[i]};
    guint k = 0;
    while (k < recipe->sweep->len &&
           strcmp(g_array_index(recipe->sweep, opc_entry, k).key->text,
                  entry.key->text))
      k++;
    gboolean known = k < recipe->sweep->len;
    if (opc_node_is_null(entry.value)) {
      if (known)
        g_array_remove_index(recipe->sweep, k);
      else
        WRONG(problems, entry.key, "there is no '%s' to remove",
              entry.key->text);
    } else if (known) {
      g_array_index(recipe->sweep, opc_entry, k) = entry;
    } else {
      g_array_append_val(recipe->sweep, entry);
    }
  }
}

/* ---- the whole ---- */

static void variant_free(gpointer item) {
  opc_variant *variant = item;
  g_ptr_array_free(variant->parts, TRUE);
  g_free(variant);
}

opc_recipe *opc_recipe_read(const char *path, opc_problems *problems) {
  g_autoptr(opc_recipe) recipe = g_new0(opc_recipe, 1);
  recipe->path = g_strdup(path);
  recipe->sources =
      g_ptr_array_new_with_free_func((GDestroyNotify)opc_source_free);
  recipe->roots = g_ptr_array_new_with_free_func((GDestroyNotify)opc_node_free);
  recipe->variants = g_ptr_array_new_with_free_func(variant_free);
  recipe->sweep = g_array_new(FALSE, FALSE, sizeof(opc_entry));
  if (!read_chain(recipe, problems)) return NULL;
  const opc_node *root = recipe->roots->pdata[0];
  recipe->name = flow_name(root, path, problems);
  recipe->description = flow_description(root, problems);
  for (guint i = recipe->roots->len; i-- > 0;) {
    check_keys(recipe->roots->pdata[i], problems);
    check_version(recipe->roots->pdata[i], problems);
    take_steps(recipe, recipe->roots->pdata[i], problems);
    take_variants(recipe, recipe->roots->pdata[i], problems);
    take_sweep(recipe, recipe->roots->pdata[i], problems);
  }
  if (!recipe->steps && !opc_node_get(root, "steps"))
    WRONG(problems, root, "missing 'steps'");
  else if (recipe->steps && recipe->steps->items->len > MOST_STEPS)
    WRONG(problems, recipe->steps, "more than %d steps", MOST_STEPS);
  return g_steal_pointer(&recipe);
}

void opc_recipe_free(opc_recipe *recipe) {
  if (!recipe) return;
  opc_node_free(recipe->steps);
  g_ptr_array_free(recipe->variants, TRUE);
  g_array_free(recipe->sweep, TRUE);
  g_ptr_array_free(recipe->roots, TRUE);
  g_ptr_array_free(recipe->sources, TRUE);
  g_free(recipe->path);
  g_free(recipe->name);
  g_free(recipe->description);
  g_free(recipe);
}

const opc_variant *opc_recipe_variant(const opc_recipe *recipe,
                                      const char *name,
                                      opc_problems *problems) {
  guint i = find_variant(recipe, name);
  if (i < recipe->variants->len) return recipe->variants->pdata[i];
  g_autofree char *suggestion = suggest_variant(recipe, name);
  const opc_place at = {recipe->path, 0, 0};
  opc_problem_add(problems, OPC_INVALID, &at, "unknown variant '%s'%s", name,
                  suggestion);
  return NULL;
}
