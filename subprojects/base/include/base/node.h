/* SPDX-License-Identifier: BSD-3-Clause */
/* YAML as a tree of nodes with their places. Flow files use a subset of YAML:
   one document of maps, lists and texts. Duplicate keys, anchors, aliases,
   tags, deep nesting and large documents are rejected. */
#pragma once

#include <base/problem.h>

/* Origin of nodes. */
typedef struct opc_source {
  char *name;   /* for messages: "flow.yaml", "--set first.width" */
  char *folder; /* folder of relative file names; NULL if the source is an
                   argument of the command and has no line numbers */
  char *layer;  /* "variant epe", "sweep"; NULL for the file itself */
} opc_source;

/* Type of a node. */
typedef enum { OPC_NODE_TEXT, OPC_NODE_LIST, OPC_NODE_MAP } opc_node_type;

/* A node of a tree. */
typedef struct opc_node {
  opc_node_type type;
  const opc_source *source; /* must outlive the node */
  opc_place at;
  char *text;       /* value of a text */
  gboolean plain;   /* text without quotes */
  GPtrArray *keys;  /* opc_node * of a map: texts */
  GPtrArray *items; /* opc_node * of a list or map */
} opc_node;

/* Return a source with copies of both texts (opc_source_free). */
opc_source *opc_source_new(const char *name, const char *folder);
/* Return a source for a named layer of a file, such as a variant. */
opc_source *opc_source_layer(const opc_source *file, const char *layer);
/* Free a source. */
void opc_source_free(opc_source *source);

/* Return the tree of a text; NULL and problems if the text is invalid. Unlike
   in YAML, ${name} needs no quotes in { } and [ ]. */
opc_node *opc_node_parse(const opc_source *source, const char *text,
                         size_t length, opc_problems *problems);

/* Return the tree of a file; NULL and problems on failure. Problems name
   `source`; problems of the whole file have the place `at` (or NULL). */
opc_node *opc_node_read(const opc_source *source, const char *path,
                        const opc_place *at, opc_problems *problems);

/* Return the trees of all documents in a text or a data file (opc_node *, freed
   with the array). The number of nodes is not limited. On failure, add problems
   and return an empty list. */
GPtrArray *opc_node_parse_all(const opc_source *source, const char *text,
                              size_t length, opc_problems *problems);
GPtrArray *opc_node_read_all(const opc_source *source, const char *path,
                             opc_problems *problems);

/* Return a new text, or a new empty map at a place of the source
   (opc_node_free). */
opc_node *opc_node_text_new(const opc_source *source, const char *text);
opc_node *opc_node_map_new(const opc_source *source, const opc_place *at);
/* Return a deep copy, with the origin `source` or, if `source` is NULL, the
   origin of `node`. */
opc_node *opc_node_copy(const opc_node *node, const opc_source *source);
/* Free a node and all nodes below. */
void opc_node_free(opc_node *node);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_node, opc_node_free)

/* opc_node_find: return the index of a key, -1 if missing. opc_node_get: return
   the value of a key, NULL if missing or if `map` is not a map. */
int opc_node_find(const opc_node *map, const char *key);
opc_node *opc_node_get(const opc_node *map, const char *key);

/* Return the text of the key with index i. */
const char *opc_node_key(const opc_node *map, guint i);

/* Append a key that does not exist yet. Takes ownership of both nodes. */
void opc_node_add(opc_node *map, opc_node *key, opc_node *value);

/* Replace the equal key and its value by copies of `key` and `value`; append
   the copies if the key is missing. */
void opc_node_put(opc_node *map, const opc_node *key, const opc_node *value);

/* Return whether all keys are among `words`, "a|b|c". Otherwise add a problem
   for each unknown key: "unknown key 'x'", the text `where`, and a
   suggestion. */
gboolean opc_node_check_keys(const opc_node *map, const char *words,
                             const char *where, opc_problems *problems);

/* Add a problem for a key that is missing in a map: the text `before`, 'key',
   the text `after`, and a suggestion. Return FALSE. */
gboolean opc_node_missing(const opc_node *map, const char *key,
                          const opc_place *at, const char *before,
                          const char *after, opc_problems *problems);

/* Return the path of the file that a text names (g_free), relative to the
   folder of the text's source. */
char *opc_node_path(const opc_node *node);

/* Return "a map", "a list" or "a text". */
const char *opc_node_noun(const opc_node *node);

/* Return a node or a text as one line in the syntax of flows (g_free), or
   append the line to `out`. */
char *opc_node_line(const opc_node *node);
void opc_node_append(GString *out, const opc_node *node);
void opc_text_append(GString *out, const char *text);

/* Return whether a node is an empty value: no text after `key:`. */
gboolean opc_node_is_empty(const opc_node *node);

/* Return whether a node is `~` or `null` without quotes. */
gboolean opc_node_is_null(const opc_node *node);

/* Return the words of "a|b|c", in order (g_strfreev). */
char **opc_choice_list(const char *choices);

/* Add a problem at the place of a node. */
#define opc_wrong(problems, node, ...) \
  opc_problem_add(problems, OPC_INVALID, &(node)->at, __VA_ARGS__)
