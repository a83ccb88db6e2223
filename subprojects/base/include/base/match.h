/* SPDX-License-Identifier: BSD-3-Clause */
/* Values that a pattern stands for: files whose names it is like, the file that
   belongs to one of these, or others that are listed. */
#pragma once

#include <base/node.h>

/* The values of a key in one layer; each text is there once. */
typedef struct opc_values {
  GPtrArray *nodes; /* opc_node * */
  GPtrArray *stars; /* char *, of each: what the star stood for; "": none */
} opc_values;

void opc_values_init(opc_values *v);
void opc_values_clear(opc_values *v);

/* Take away what is like a pattern; of files, by the name without the
   folder. */
void opc_values_remove(opc_values *v, const char *pattern, gboolean files);

/* Add what the pattern of a node stands for: files, the one file whose star is
   `star`, or some of a list (char *). FALSE and a problem if there is none. */
gboolean opc_match_files(const opc_node *node, opc_values *out,
                         opc_problems *problems);
gboolean opc_pair_file(const opc_node *node, const char *star, opc_values *out,
                       opc_problems *problems);
gboolean opc_match_choices(const opc_node *node, const GPtrArray *list,
                           opc_values *out, opc_problems *problems);

/* Return a word for a value: the name of a file without folder and ending, the
   plugin of a map with `use`, or the text; "" for other values. The second
   returns that of the first text in a map, or else of the first value that has
   one (g_free). The third appends a word that is not the last one there. */
char *opc_label(const opc_node *value);
char *opc_label_of_map(const opc_node *map);
void opc_label_add(GString *to, const char *label);
