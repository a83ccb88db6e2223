/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a flow file and the chain of files that it extends, and merges them.
   Each file overrides the file that it extends. */
#include "core/binding/recipe.h"

#include <base/file.h>
#include <base/layers.h>
#include <string.h>

enum {
  MOST_FILES = 16,   /* files in a chain of `extends` */
  MOST_STEPS = 1000, /* of a flow; also keys of a variant or a sweep */
  MOST_VARIANTS = 100
};

static const char letters[] = G_CSET_a_2_z G_CSET_A_2_Z G_CSET_DIGITS "_-.";

/* ---- the head of a file ---- */

static void check_version(const opc_node *root, opc_problems *problems) {
  const opc_node *version = opc_node_get(root, "opcflow");
  if (!version)
    opc_wrong(problems, root,
              "'opcflow: 1', the version of the format, is missing");
  else if (version->type != OPC_NODE_TEXT || strcmp(version->text, "1"))
    opc_wrong(problems, version,
              "'opcflow' must be 1, the version of the format");
}

/* Return the `name` in the file, or else the name of the file (g_free). */
static char *flow_name(const opc_node *root, const char *path,
                       opc_problems *problems) {
  const opc_node *name = opc_node_get(root, "name");
  if (name && name->type == OPC_NODE_TEXT && opc_is_name(name->text, TRUE))
    return g_strdup(name->text);
  if (name)
    opc_wrong(problems, name,
              "'name' must consist of letters, digits, '.', '_' and '-'");
  char *base = g_path_get_basename(path);
  char *dot = strrchr(base, '.');
  if (dot && dot > base) *dot = 0;
  g_strcanon(base, letters, '_');
  if (*base == '.' || *base == '-') *base = '_';
  return base;
}

static char *flow_description(const opc_node *root, opc_problems *problems) {
  const opc_node *text = opc_node_get(root, "description");
  if (!text) return NULL;
  if (text->type == OPC_NODE_TEXT) return g_strdup(text->text);
  opc_wrong(problems, text, "'description' must be a text, found %s",
            opc_node_noun(text));
  return NULL;
}

/* ---- files ---- */

/* Return the index of the file among the files read, -1 for a new file. */
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
  opc_wrong(problems, at, "flows extend each other in a cycle: %s%s", text->str,
            ((opc_source *)recipe->sources->pdata[first])->name);
}

/* Return the path that `extends` of the last file names (g_free); NULL and a
   problem on error. */
static char *next_file(const opc_recipe *recipe, const opc_node *extends,
                       opc_problems *problems) {
  if (extends->type != OPC_NODE_TEXT || !*extends->text ||
      opc_node_is_null(extends)) {
    opc_wrong(problems, extends, "'extends' must be the name of a flow file");
    return NULL;
  }
  char *path = opc_node_path(extends);
  int known = find_file(recipe, path);
  if (known < 0 && recipe->sources->len < MOST_FILES) return path;
  if (known >= 0)
    report_circle(recipe, (guint)known, extends, problems);
  else
    opc_wrong(problems, extends, "more than %d files in a chain of 'extends'",
              MOST_FILES);
  g_free(path);
  return NULL;
}

/* Read a file and, recursively, the files that it extends. Returns FALSE and
   adds a problem on failure. `from` is the value of `extends` that names this
   file (NULL for the first file); an unreadable file is reported at the place
   of `from`. */
static gboolean read_file(opc_recipe *recipe, const char *path,
                          const opc_node *from, opc_problems *problems) {
  g_autofree char *folder = g_path_get_dirname(path);
  opc_source *source = opc_source_new(path, strcmp(folder, ".") ? folder : "");
  g_ptr_array_add(recipe->sources, source);
  opc_node *root =
      opc_node_read(source, path, from ? &from->at : NULL, problems);
  if (!root) return FALSE;
  g_ptr_array_add(recipe->roots, root);
  if (root->type != OPC_NODE_MAP)
    return opc_wrong(problems, root, "a flow must be a map, found %s",
                     opc_node_noun(root));
  const opc_node *extends = opc_node_get(root, "extends");
  if (!extends) return TRUE;
  g_autofree char *next = next_file(recipe, extends, problems);
  return next && read_file(recipe, next, extends, problems);
}

/* ---- sections of files ---- */

/* Return the map `name` of a file; NULL if the map is missing or not valid. */
static const opc_node *recipe_section(const opc_node *root, const char *name,
                                      guint most, opc_problems *problems) {
  const opc_node *node = opc_node_get(root, name);
  const char *noun = strcmp(name, "sweep") ? name : "parameters";
  if (!node) return NULL;
  if (node->type != OPC_NODE_MAP || !node->items->len)
    opc_wrong(problems, node, "'%s' must be a map of %s", name, noun);
  else if (node->items->len > most)
    opc_wrong(problems, node, "more than %u %s", most, noun);
  else
    return node;
  return NULL;
}

static void take_steps(opc_recipe *recipe, const opc_node *root,
                       opc_problems *problems) {
  const opc_node *steps = recipe_section(root, "steps", MOST_STEPS, problems);
  if (!steps) return;
  if (!recipe->steps)
    recipe->steps = opc_node_map_new(steps->source, &steps->at);
  opc_lay_steps(recipe->steps, steps, problems);
}

static gboolean remove_key(opc_node *map, const char *key) {
  int i = opc_node_find(map, key);
  if (i < 0) return FALSE;
  g_ptr_array_remove_index(map->keys, (guint)i);
  g_ptr_array_remove_index(map->items, (guint)i);
  return TRUE;
}

/* Check that a file does not set a parameter in both forms (dotted and nested),
   then append the entries to the variant of the same name. */
static void add_variant(opc_recipe *recipe, const opc_node *key,
                        const opc_node *value, opc_problems *problems) {
  opc_node_free(opc_undot(value, FALSE, problems));
  g_autofree char *layer = g_strdup_printf("variant %s", key->text);
  opc_source *source = opc_source_layer(value->source, layer);
  g_ptr_array_add(recipe->sources, source);
  opc_node *variant = opc_node_get(recipe->variants, key->text);
  if (!variant) {
    variant = opc_node_map_new(source, &value->at);
    opc_node_add(recipe->variants, opc_node_copy(key, NULL), variant);
  }
  for (guint i = 0; i < value->keys->len; i++)
    opc_node_add(variant, opc_node_copy(value->keys->pdata[i], source),
                 opc_node_copy(value->items->pdata[i], source));
}

static void take_variants(opc_recipe *recipe, const opc_node *root,
                          opc_problems *problems) {
  const opc_node *all =
      recipe_section(root, "variants", MOST_VARIANTS, problems);
  for (guint i = 0; all && i < all->items->len; i++) {
    const opc_node *key = all->keys->pdata[i], *value = all->items->pdata[i];
    if (!opc_is_name(key->text, FALSE) || !strcmp(key->text, "all") ||
        !strcmp(key->text, "base")) {
      opc_wrong(problems, key,
                "the name of a variant must consist of letters, digits, '_' "
                "and '-' and must not be 'all' or 'base', found '%s'",
                key->text);
    } else if (opc_node_is_null(value)) {
      if (!remove_key(recipe->variants, key->text))
        opc_node_missing(recipe->variants, key->text, &key->at,
                         "'variants' is empty", " to remove", problems);
    } else if (value->type != OPC_NODE_MAP || value->items->len > MOST_STEPS) {
      opc_wrong(problems, value,
                "variant '%s' must be a map of at most %d parameters",
                key->text, MOST_STEPS);
    } else {
      add_variant(recipe, key, value, problems);
    }
  }
}

static void take_demands(opc_recipe *recipe, const opc_node *root,
                         opc_problems *problems) {
  int i = opc_node_find(root, "require");
  if (i < 0) return;
  const opc_node *key = root->keys->pdata[i];
  opc_lay_demands(recipe->demands, "require", &key->at, root->items->pdata[i],
                  problems);
}

/* Merge a sweep: an axis that exists keeps its position and gets new values. */
static void take_sweep(opc_recipe *recipe, const opc_node *root,
                       opc_problems *problems) {
  opc_node *sweep = recipe->sweep;
  const opc_node *all = opc_node_get(root, "sweep");
  gboolean none = all && opc_node_is_null(all);
  while (none && sweep->keys->len) remove_key(sweep, opc_node_key(sweep, 0));
  all = none ? NULL : recipe_section(root, "sweep", MOST_STEPS, problems);
  for (guint i = 0; all && i < all->items->len; i++) {
    const opc_node *key = all->keys->pdata[i], *value = all->items->pdata[i];
    if (opc_node_is_null(value)) {
      if (!remove_key(sweep, key->text))
        opc_wrong(problems, key, "the sweep has no '%s' to remove", key->text);
    } else {
      opc_node_put(sweep, key, value);
    }
  }
}

/* ---- recipes ---- */

opc_recipe *opc_recipe_read(const char *path, opc_problems *problems) {
  g_autoptr(opc_recipe) recipe = g_new0(opc_recipe, 1);
  recipe->path = g_strdup(path);
  recipe->sources =
      g_ptr_array_new_with_free_func((GDestroyNotify)opc_source_free);
  recipe->roots = g_ptr_array_new_with_free_func((GDestroyNotify)opc_node_free);
  if (!read_file(recipe, path, NULL, problems)) return NULL;
  const opc_node *root = recipe->roots->pdata[0];
  recipe->variants = opc_node_map_new(root->source, NULL);
  recipe->sweep = opc_node_map_new(root->source, NULL);
  recipe->demands = opc_node_map_new(root->source, NULL);
  recipe->name = flow_name(root, path, problems);
  recipe->description = flow_description(root, problems);
  for (guint i = recipe->roots->len; i-- > 0;) {
    const opc_node *file = recipe->roots->pdata[i];
    opc_node_check_keys(
        file, "opcflow|name|description|extends|steps|variants|sweep|require",
        "", problems);
    check_version(file, problems);
    take_steps(recipe, file, problems);
    take_variants(recipe, file, problems);
    take_sweep(recipe, file, problems);
    take_demands(recipe, file, problems);
  }
  if (!recipe->steps && !opc_node_get(root, "steps"))
    opc_wrong(problems, root, "missing 'steps'");
  else if (recipe->steps && recipe->steps->items->len > MOST_STEPS)
    opc_wrong(problems, recipe->steps, "more than %d steps", MOST_STEPS);
  return g_steal_pointer(&recipe);
}

void opc_recipe_free(opc_recipe *recipe) {
  if (!recipe) return;
  opc_node_free(recipe->steps);
  opc_node_free(recipe->variants);
  opc_node_free(recipe->sweep);
  opc_node_free(recipe->demands);
  g_ptr_array_free(recipe->roots, TRUE);
  g_ptr_array_free(recipe->sources, TRUE);
  g_free(recipe->path);
  g_free(recipe->name);
  g_free(recipe->description);
  g_free(recipe);
}

gboolean opc_recipe_has(const opc_recipe *recipe, const char *variant,
                        const opc_place *at, opc_problems *problems) {
  const opc_place file = {recipe->path, 0, 0};
  return opc_node_find(recipe->variants, variant) >= 0 ||
         opc_node_missing(recipe->variants, variant, at ? at : &file,
                          "unknown variant", "", problems);
}
