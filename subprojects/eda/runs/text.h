/* SPDX-License-Identifier: BSD-3-Clause */
/* Common declarations of the readers of run folders. */
#pragma once

#include <base/node.h>
#include <eda/runs.h>

/* Return the text of a regular file of up to `most` bytes, UTF-8 without NUL
   bytes (g_free); NULL and *error, with the offset of an invalid byte, on
   failure. */
char *runs_text(const char *path, size_t most, opc_error *error);

/* A JSON or YAML document with the places of its nodes; JSON is read as
   YAML. */
typedef struct runs_tree {
  opc_source *source;
  char *text;
  GPtrArray *roots; /* opc_node * */
} runs_tree;

/* Open a document. Return OPC_OK, or a code and *error. Close the tree in any
   case. */
int runs_tree_open(runs_tree *tree, const char *path, opc_error *error);
void runs_tree_close(runs_tree *tree);

/* Return the root, which the tree owns. */
const opc_node *runs_root(const runs_tree *tree);

/* Return a text, NULL for other nodes and null; or a number, NAN for other
   nodes. NULL is accepted. */
const char *runs_word(const opc_node *node);
double runs_number(const opc_node *node);

/* Fill *error with "path:line:column: ..." and return its code. */
int runs_fail(const opc_node *node, opc_error *error, const char *format, ...)
    OPC_PRINTF(3, 4);
