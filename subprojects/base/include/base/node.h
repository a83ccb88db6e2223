/* SPDX-License-Identifier: BSD-3-Clause */
/* YAML as a tree of nodes; each node has its place in the file. Flow files use
   a subset of YAML: one document of maps, lists and texts. Duplicate keys,
   anchors, aliases and tags are rejected; so are documents of more than 200,000
   nodes or 64 nested maps and lists, texts of more than 64 KiB, and files of
   more than 16 MiB. */
#pragma once

#include <base/problem.h>

/* Origin of nodes: a file, or an argument of the command. */
typedef struct opc_source {
  char *name;   /* for messages: "flow.yaml", "--set first.width" */
  char *folder; /* relative file names in the file are relative to this folder;
                   "": the working folder. NULL for an argument: as "", and
                   places of nodes have no line. */
  char *layer; /* part of the file that changes the rest of the file (layers.h):
                  "variant epe", "sweep"; NULL for the rest of the file */
} opc_source;

/* Type of a node. */
typedef enum { OPC_NODE_TEXT, OPC_NODE_LIST, OPC_NODE_MAP } opc_node_type;

/* A node of a tree. */
typedef struct opc_node {
  opc_node_type type;
  const opc_source *source; /* must outlive the node */
  opc_place at;             /* start of the node; at.file is not owned */
  char *text;               /* value of a text; NULL for a list or map */
  gboolean plain;           /* text without quotes */
  GPtrArray *keys; /* opc_node *: keys of a map, which are texts, in order; NULL
                      for a text or list. The node owns the keys. */
  GPtrArray *items; /* opc_node *: elements of a list, or values of a map
                       (items[i] is the value of keys[i]); NULL for a text. The
                       node owns the elements. */
} opc_node;

/* Return a source with copies of both texts; `folder` may be NULL. The caller
   frees the source with opc_source_free(). */
opc_source *opc_source_new(const char *name, const char *folder);
/* Return a source for a named layer of a file, such as a variant, with copies
   of the texts. The caller frees the source with opc_source_free(). */
opc_source *opc_source_layer(const opc_source *file, const char *layer);
/* Free a source (NULL: do nothing). */
void opc_source_free(opc_source *source);

/* Return the tree of `length` bytes of `text`; NULL and problems if the text is
   invalid. Unlike in YAML, ${name} needs no quotes in { } and [ ]. The caller
   frees the tree with opc_node_free(). */
opc_node *opc_node_parse(const opc_source *source, const char *text,
                         size_t length, opc_problems *problems);

/* Return the tree of the file at `path`; NULL and problems on failure. Problems
   of the contents have places in `source`. A problem of the whole file, such as
   a missing file, has the place `at`, where the user named the file; `at` may
   be NULL. The caller frees the tree with opc_node_free(). */
opc_node *opc_node_read(const opc_source *source, const char *path,
                        const opc_place *at, opc_problems *problems);

/* Return the trees of all documents in a text or a data file (opc_node *, freed
   with the array; the caller frees the array). The number of nodes is not
   limited. On failure, add problems and return an empty list. */
GPtrArray *opc_node_parse_all(const opc_source *source, const char *text,
                              size_t length, opc_problems *problems);
GPtrArray *opc_node_read_all(const opc_source *source, const char *path,
                             opc_problems *problems);

/* Return a new text, or a new empty map at a place of the source
   (opc_node_free). */
opc_node *opc_node_text_new(const opc_source *source, const char *text);
opc_node *opc_node_map_new(const opc_source *source, const opc_place *at);
/* Return a deep copy (opc_node_free), with the origin `source` or, if `source`
   is NULL, the origins of the copied nodes. */
opc_node *opc_node_copy(const opc_node *node, const opc_source *source);
/* Free a node and all nodes below (NULL: do nothing). The node must not be in
   another node. */
void opc_node_free(opc_node *node);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_node, opc_node_free)

/* Return the index of a key, -1 if missing. `map` must be a map. */
int opc_node_find(const opc_node *map, const char *key);
/* Return the value of a key, which stays in the map; NULL if the key is missing
   or if `map` is NULL or not a map. */
opc_node *opc_node_get(const opc_node *map, const char *key);

/* Return the text of the key with index i < map->keys->len. `map` must be a
   map. The text is valid while the key is in the map. */
const char *opc_node_key(const opc_node *map, guint i);

/* Append a key and its value. The map takes ownership of both nodes. `map` must
   be a map without this key, which is not checked, and `key` a text. */
void opc_node_add(opc_node *map, opc_node *key, opc_node *value);

/* Replace the equal key of a map and its value by copies of `key`, a text, and
   `value`; append the copies if the key is missing. */
void opc_node_put(opc_node *map, const opc_node *key, const opc_node *value);

/* Return whether all keys of a map are among `words`, "a|b|c". Otherwise add a
   problem for each unknown key: "unknown key 'x'", the text `where`, and a
   suggestion. */
gboolean opc_node_check_keys(const opc_node *map, const char *words,
                             const char *where, opc_problems *problems);

/* Add a problem for a key that is missing in a map: the text `before`, 'key',
   the text `after`, and a suggestion. Return FALSE. */
gboolean opc_node_missing(const opc_node *map, const char *key,
                          const opc_place *at, const char *before,
                          const char *after, opc_problems *problems);

/* Return the path of the file that a text names (g_free). A relative name is
   appended to the folder of the text's source, if the source has one; an
   absolute name is returned unchanged. `node` must be a text. */
char *opc_node_path(const opc_node *node);

/* Return "a map", "a list" or "a text". */
const char *opc_node_noun(const opc_node *node);

/* Return a node as YAML on one line, such as "{ a: 1, b: [x, "y: z"] }", with
   quotes only where necessary (g_free). */
char *opc_node_line(const opc_node *node);
/* Append that line of a node to `out`. */
void opc_node_append(GString *out, const opc_node *node);
/* Append a text to `out` as a value of YAML, quoted if necessary. */
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
