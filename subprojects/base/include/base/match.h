/* SPDX-License-Identifier: BSD-3-Clause */
/* Values selected by a pattern with a star: file names or listed values. */
#pragma once

#include <base/node.h>

/* Values of a key in one layer (layers.h). The functions below add no text
   twice. The list owns its elements. */
typedef struct opc_values {
  GPtrArray *nodes; /* opc_node * */
  GPtrArray *stars; /* char *, for each node: part of its text that matched the
                       star, or "" */
} opc_values;

/* opc_values_init: initialise an empty list. opc_values_clear: free the
   elements. */
void opc_values_init(opc_values *v);
void opc_values_clear(opc_values *v);

/* Remove the texts that match a pattern (fnmatch); other values stay. If
   `files` is TRUE, texts are paths, and their names without folders are
   compared. */
void opc_values_remove(opc_values *v, const char *pattern, gboolean files);

/* Add the values that match the pattern of a node, which must be a text.
   opc_match_files: the
   absolute paths of all matching files. opc_pair_file: the absolute path of the
   file with `star` in place of each star of the pattern. opc_match_choices: the
   matching entries of `list` (char *). If nothing matches, add a problem and
   return FALSE. */
gboolean opc_match_files(const opc_node *node, opc_values *out,
                         opc_problems *problems);
gboolean opc_pair_file(const opc_node *node, const char *star, opc_values *out,
                       opc_problems *problems);
gboolean opc_match_choices(const opc_node *node, const GPtrArray *list,
                           opc_values *out, opc_problems *problems);

/* opc_label: return a label for a value: the name of a file without folder and
   extension, or the text; "" for other values. Characters other than letters,
   digits, '_', '-' and '.' are removed. The label of a map with `use` consists
   of the labels of its file names and words. Without a file name, the label is
   the last part of the plugin's id. opc_label_of_map: return the label of the
   first text in a map, otherwise of the first value that has a label. The
   caller frees the labels with g_free(). opc_label_add: append '-' and a label
   to `to`, unless the label is empty or equals the whole text of `to`; the
   first label has no '-'. */
char *opc_label(const opc_node *value);
char *opc_label_of_map(const opc_node *map);
void opc_label_add(GString *to, const char *label);
