/* SPDX-License-Identifier: BSD-3-Clause */
/* Patterns of file names and of other values. */
#include <base/match.h>

#include <base/file.h>
#include <fnmatch.h>
#include <glob.h>
#include <string.h>

void opc_values_init(opc_values *v) {
  v->nodes = g_ptr_array_new_with_free_func((GDestroyNotify)opc_node_free);
  v->stars = g_ptr_array_new_with_free_func(g_free);
}

void opc_values_clear(opc_values *v) {
  g_ptr_array_free(v->nodes, TRUE);
  g_ptr_array_free(v->stars, TRUE);
}

static int find_text(const opc_values *v, const char *text) {
  for (guint i = 0; i < v->nodes->len; i++)
    if (!g_strcmp0(((const opc_node *)v->nodes->pdata[i])->text, text))
      return (int)i;
  return -1;
}

/* Add a text unless the list contains an equal text. */
static void add_text(opc_values *v, const opc_node *like, const char *text,
                     char *star) {
  if (find_text(v, text) >= 0) {
    g_free(star);
    return;
  }
  opc_node *node = opc_node_text_new(like->source, text);
  node->at = like->at;
  g_ptr_array_add(v->nodes, node);
  g_ptr_array_add(v->stars, star);
}

/* Files are compared by their names without folders. */
void opc_values_remove(opc_values *v, const char *pattern, gboolean files) {
  for (guint i = v->nodes->len; i-- > 0;) {
    const char *text = ((const opc_node *)v->nodes->pdata[i])->text;
    if (!text) continue;
    g_autofree char *base = files ? g_path_get_basename(text) : g_strdup(text);
    if (fnmatch(pattern, base, 0)) continue;
    g_ptr_array_remove_index(v->nodes, i);
    g_ptr_array_remove_index(v->stars, i);
  }
}

/* Return the part of a path that the star of a pattern matched (g_free); "" if
   the pattern has other wildcards. */
static char *star_of(const char *pattern, const char *path) {
  const char *star = strchr(pattern, '*');
  if (!star || strpbrk(star + 1, "*?[") ||
      strcspn(pattern, "?[") < (size_t)(star - pattern))
    return g_strdup("");
  size_t before = (size_t)(star - pattern), after = strlen(star + 1);
  return g_strndup(path + before, strlen(path) - before - after);
}

gboolean opc_match_files(const opc_node *node, opc_values *out,
                         opc_problems *problems) {
  g_autofree char *pattern = opc_node_path(node);
  glob_t found;
  int code = glob(pattern, 0, NULL, &found);
  for (size_t i = 0; !code && i < found.gl_pathc; i++) {
    g_autofree char *path = g_canonicalize_filename(found.gl_pathv[i], NULL);
    add_text(out, node, path, star_of(pattern, found.gl_pathv[i]));
  }
  if (!code) globfree(&found);
  return !code || opc_wrong(problems, node, "no file matches '%s'", pattern);
}

gboolean opc_pair_file(const opc_node *node, const char *star, opc_values *out,
                       opc_problems *problems) {
  g_autofree char *pattern = opc_node_path(node);
  g_auto(GStrv) pieces = g_strsplit(pattern, "*", -1);
  g_autofree char *path = g_strjoinv(star, pieces);
  const char *why = opc_file_fault(path, NULL);
  if (why)
    return opc_problem_add(problems, OPC_IO, &node->at, "'%s': %s", path, why);
  g_autofree char *whole = g_canonicalize_filename(path, NULL);
  add_text(out, node, whole, g_strdup(star));
  return TRUE;
}

gboolean opc_match_choices(const opc_node *node, const GPtrArray *list,
                           opc_values *out, opc_problems *problems) {
  gboolean any = FALSE;
  for (guint i = 0; i < list->len; i++) {
    if (fnmatch(node->text, list->pdata[i], 0)) continue;
    add_text(out, node, list->pdata[i], g_strdup(""));
    any = TRUE;
  }
  return any || opc_wrong(problems, node, "none of %u names matches '%s'",
                          list->len, node->text);
}

/* ---- names ---- */

/* Return the extension in a name, from the dot on; NULL if there is none. */
static char *find_extension(char *name) {
  char *dot = strrchr(name, '.');
  return dot && dot > name && *name != '$' && g_ascii_isalpha(dot[1]) ? dot
                                                                      : NULL;
}

/* Return the labels of the words of a map with `use`; "" unless one of the
   words names a file. */
static char *label_of_file(const opc_node *map) {
  g_autoptr(GString) all = g_string_new(NULL);
  gboolean any = FALSE;
  for (guint i = 0; i < map->items->len; i++) {
    const opc_node *value = map->items->pdata[i];
    if (value->type != OPC_NODE_TEXT || !strcmp(opc_node_key(map, i), "use") ||
        (!g_ascii_isalpha(*value->text) && !find_extension(value->text)))
      continue;
    any |= find_extension(value->text) != NULL;
    g_autofree char *label = opc_label(value);
    opc_label_add(all, label);
  }
  return g_strdup(any ? all->str : "");
}

char *opc_label(const opc_node *value) {
  const opc_node *use = opc_node_get(value, "use");
  const char *text = use                            ? use->text
                     : value->type == OPC_NODE_TEXT ? value->text
                                                    : NULL;
  if (!text || opc_node_is_null(value)) return g_strdup("");
  g_autofree char *file = use ? label_of_file(value) : g_strdup("");
  if (*file) return g_steal_pointer(&file);
  g_autofree char *base = g_path_get_basename(text);
  char *dot = find_extension(base);
  if (dot) {
    if (use)
      memmove(base, dot + 1, strlen(dot));
    else
      *dot = 0;
  }
  g_strcanon(base, G_CSET_a_2_z G_CSET_A_2_Z G_CSET_DIGITS "_-.", ' ');
  g_auto(GStrv) words = g_strsplit(g_strstrip(base), " ", -1);
  g_autofree char *joined = g_strjoinv("", words);
  return g_strdup(joined + strspn(joined, ".-"));
}

void opc_label_add(GString *to, const char *label) {
  if (!*label || !strcmp(to->str, label)) return;
  if (to->len) g_string_append_c(to, '-');
  g_string_append(to, label);
}

char *opc_label_of_map(const opc_node *map) {
  for (int any = 0; any < 2; any++)
    for (guint i = 0; i < map->items->len; i++) {
      const opc_node *value = map->items->pdata[i];
      g_autofree char *label = opc_label(value);
      if (*label && (any || value->type == OPC_NODE_TEXT))
        return g_steal_pointer(&label);
    }
  return g_strdup("");
}
