/* SPDX-License-Identifier: BSD-3-Clause */
/* What the readers of run folders share. */
#pragma once

#include <eda/runs.h>
#include <yaml.h>

/* The text of a regular file of up to `most` bytes, UTF-8 without NUL bytes
   (g_free); NULL and *error, with the byte at fault. */
char *runs_text(const char *path, size_t most, opc_error *error);

/* A JSON or YAML document that knows its places; JSON is read as the YAML it
   is. */
typedef struct runs_tree {
  char *path, *text;
  yaml_document_t document;
  int there; /* whether there is a document */
} runs_tree;

/* OPC_OK, or *error. To be closed in any case. */
int runs_tree_open(runs_tree *tree, const char *path, opc_error *error);
void runs_tree_close(runs_tree *tree);

/* Nodes are the tree's own. NULL takes part everywhere: there is no such node.
 */
yaml_node_t *runs_root(runs_tree *tree);
yaml_node_t *runs_node(runs_tree *tree, int number);
yaml_node_t *runs_get(runs_tree *tree, const yaml_node_t *map, const char *key);

/* A text; NULL if it is none, or null. A number; NAN if it is none. */
const char *runs_word(const yaml_node_t *node);
double runs_number(const yaml_node_t *node);

/* "path:line:column: ...", the code. */
int runs_fail(const runs_tree *tree, const yaml_node_t *node, opc_error *error,
              const char *format, ...) OPC_PRINTF(4, 5);
