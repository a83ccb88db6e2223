/* SPDX-License-Identifier: BSD-3-Clause */
/* Common declarations of the readers of run folders. */
#pragma once

#include <eda/runs.h>
#include <yaml.h>

/* Return the text of a regular file of up to `most` bytes, UTF-8 without NUL
   bytes (g_free); NULL and *error, with the offset of an invalid byte, on
   failure. */
char *runs_text(const char *path, size_t most, opc_error *error);

/* A JSON or YAML document with the places of its nodes; JSON is read as
   YAML. */
typedef struct runs_tree {
  char *path, *text;
  yaml_document_t document;
  int there; /* the document exists */
} runs_tree;

/* Open a document. Return OPC_OK, or a code and *error. Close the tree in any
   case. */
int runs_tree_open(runs_tree *tree, const char *path, opc_error *error);
void runs_tree_close(runs_tree *tree);

/* Access nodes, which the tree owns. NULL means no such node and is accepted
   everywhere. */
yaml_node_t *runs_root(runs_tree *tree);
yaml_node_t *runs_node(runs_tree *tree, int number);
yaml_node_t *runs_get(runs_tree *tree, const yaml_node_t *map, const char *key);

/* Return a text, NULL for other nodes and null; or a number, NAN for other
   nodes. */
const char *runs_word(const yaml_node_t *node);
double runs_number(const yaml_node_t *node);

/* Fill *error with "path:line:column: ..." and return its code. */
int runs_fail(const runs_tree *tree, const yaml_node_t *node, opc_error *error,
              const char *format, ...) OPC_PRINTF(4, 5);
