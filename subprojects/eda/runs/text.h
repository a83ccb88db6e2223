/* SPDX-License-Identifier: BSD-3-Clause */
/* Texts and node trees, shared by the readers of run folders. */
#pragma once

#include <base/node.h>
#include <eda/runs.h>

/* Return the content of a regular file (g_free): at most `most` bytes, UTF-8,
   without NUL bytes. On failure, return NULL and *error; for invalid UTF-8 the
   message contains the byte offset. */
char *runs_text(const char *path, size_t most, opc_error *error);

/* A JSON or YAML document with source positions; JSON is parsed as YAML. */
typedef struct runs_tree {
  opc_source *source;
  char *text;
  GPtrArray *roots; /* opc_node * */
} runs_tree;

/* Parse a document. Return OPC_OK, or a code and *error. Call runs_tree_close
   in either case. */
int runs_tree_open(runs_tree *tree, const char *path, opc_error *error);
void runs_tree_close(runs_tree *tree);

/* Return the root node, owned by the tree; NULL if the document is empty. */
const opc_node *runs_root(const runs_tree *tree);

/* runs_word: return the text of a node; NULL for NULL, null, lists and maps.
   runs_number: return the number in a node, NAN if there is none. */
const char *runs_word(const opc_node *node);
double runs_number(const opc_node *node);

/* Set *error to "path:line:column: MESSAGE" and return the code. */
int runs_fail(const opc_node *node, opc_error *error, const char *format, ...)
    OPC_PRINTF(3, 4);
