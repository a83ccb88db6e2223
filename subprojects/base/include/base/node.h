/* SPDX-License-Identifier: BSD-3-Clause */
/* YAML as a tree in which everything knows its place. Only what a flow file
   needs: one document of maps, lists and texts. Duplicate keys, anchors,
   aliases and tags are refused, and what is nested too deep or too large. */
#ifndef OPC_BASE_NODE_H
#define OPC_BASE_NODE_H

#include <base/problem.h>

/* Where nodes came from. */
typedef struct opc_source {
  char *name;   /* for messages: "flow.yaml", "--set first.width" */
  char *folder; /* relative file names start here; NULL: of an argument, whose
                   nodes have no lines */
  char *layer;  /* "variant epe", "sweep"; NULL for the file as such */
} opc_source;

typedef enum { OPC_NODE_TEXT, OPC_NODE_LIST, OPC_NODE_MAP } opc_node_type;

typedef struct opc_node {
  opc_node_type type;
  const opc_source *source; /* outlives the node */
  opc_place at;
  char *text;       /* of a text */
  gboolean plain;   /* a text without quotes */
  GPtrArray *keys;  /* of a map: opc_node *, texts */
  GPtrArray *items; /* of a list or map: opc_node * */
} opc_node;

opc_source *opc_source_new(const char *name, const char *folder);
/* A part of a file that is laid over the rest under a name of its own. */
opc_source *opc_source_layer(const opc_source *file, const char *layer);
void opc_source_free(opc_source *source);

/* The tree of a text, whose first line is `line`; NULL and problems if it is
   not good. ${name} may stand in { } and [ ] without quotes. */
opc_node *opc_node_parse(const opc_source *source, const char *text,
                         size_t length, opc_problems *problems);

/* The tree of a file; its problems carry the name of `source`, those of the
   file as such the place `at`, which may be NULL. */
opc_node *opc_node_read(const opc_source *source, const char *path,
                        const opc_place *at, opc_problems *problems);

opc_node *opc_node_text_new(const opc_source *source, const char *text);
opc_node *opc_node_map_new(const opc_source *source, const opc_place *at);
/* A deep copy. `source`: whose the copies are; NULL: as in `node`. */
opc_node *opc_node_copy(const opc_node *node, const opc_source *source);
void opc_node_free(opc_node *node);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_node, opc_node_free)

/* The number of a key, -1 if it is not there; and its value, NULL if it is not
   there (or `map` is no map). */
int opc_node_find(const opc_node *map, const char *key);
opc_node *opc_node_get(const opc_node *map, const char *key);

/* The text of the key with that number. */
const char *opc_node_key(const opc_node *map, guint i);

/* Put a key that is not there at the end. Takes both. */
void opc_node_add(opc_node *map, opc_node *key, opc_node *value);

/* Whether all keys are among `words`, "a|b|c"; a problem of each that is not:
   "unknown key 'x'", `where`, and what may be meant. */
gboolean opc_node_check_keys(const opc_node *map, const char *words,
                             const char *where, opc_problems *problems);

/* A fault of a key that is not in a map: `before` 'key' `after`, and what may
   be meant. FALSE. */
gboolean opc_node_missing(const opc_node *map, const char *key,
                          const opc_place *at, const char *before,
                          const char *after, opc_problems *problems);

/* The file that a text names, as its source means it (g_free). */
char *opc_node_path(const opc_node *node);

/* "a map", "a list", "a text" */
const char *opc_node_noun(const opc_node *node);

/* A text, list or map on one line, as a flow would write it (g_free); and the
   same appended. */
char *opc_node_line(const opc_node *node);
void opc_node_append(GString *out, const opc_node *node);
void opc_text_append(GString *out, const char *text);

/* Whether it is `key:` with nothing behind. */
gboolean opc_node_is_empty(const opc_node *node);

/* Whether it is `~` or `null` without quotes. */
gboolean opc_node_is_null(const opc_node *node);

/* The words of "a|b|c", in order (g_strfreev). */
char **opc_choice_list(const char *choices);

/* A fault of what a node says. */
#define opc_wrong(problems, node, ...) \
  opc_problem_add(problems, OPC_INVALID, &(node)->at, __VA_ARGS__)

#endif
