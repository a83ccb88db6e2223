/* SPDX-License-Identifier: BSD-3-Clause */
/* Values selected by a pattern: files with matching names, the file that
   belongs to one of them, or listed values. */
#pragma once

#include <base/node.h>

/* The values of a key in one layer; each text occurs once. */
typedef struct opc_values {
  GPtrArray *nodes; /* opc_node * */
  GPtrArray *stars; /* char *, part of each that matched the star; "": none */
} opc_values;

void opc_values_init(opc_values *v);
void opc_values_clear(opc_values *v);

/* Remove the values that match a pattern; for files, the name without the
   folder is matched. */
void opc_values_remove(opc_values *v, const char *pattern, gboolean files);

/* Add the values that match the pattern of a node: files, the single file whose
   star is `star`, or entries of a list (char *). Return FALSE and a problem if
   none matches. */
gboolean opc_match_files(const opc_node *node, opc_values *out,
                         opc_problems *problems);
gboolean opc_pair_file(const opc_node *node, const char *star, opc_values *out,
                       opc_problems *problems);
gboolean opc_match_choices(const opc_node *node, const GPtrArray *list,
                           opc_values *out, opc_problems *problems);

/* Return a word for a value: the name of a file without folder and ending, the
   plugin of a map with `use`, or the text; "" for other values. The second
   returns the word of the first text in a map, or of the first value that has a
   word (g_free). The third appends a word unless it equals the last one. */
char *opc_label(const opc_node *value);
char *opc_label_of_map(const opc_node *map);
void opc_label_add(GString *to, const char *label);
