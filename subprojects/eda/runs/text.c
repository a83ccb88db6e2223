/* SPDX-License-Identifier: BSD-3-Clause */
/* Files of a run folder as texts and as node trees with source positions. */
#include "runs/text.h"

#include <errno.h>
#include <glib.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

enum {
  LARGEST_TREE = 16 << 20 /* largest size of a YAML or JSON file, bytes */
};

/* ---- texts ---- */

char *runs_text(const char *path, size_t most, opc_error *error) {
  struct stat about;
  g_autofree char *text = NULL;
  g_autoptr(GError) trouble = NULL;
  size_t size;
  const char *end;
  if (stat(path, &about))
    opc_fail(error, OPC_IO, NULL, "'%s': %s", path, g_strerror(errno));
  else if (!S_ISREG(about.st_mode))
    opc_fail(error, OPC_IO, NULL, "'%s': is not a regular file", path);
  else if ((uint64_t)about.st_size > most)
    opc_fail(error, OPC_INVALID, NULL,
             "'%s' has %jd bytes, expected at most %zu", path,
             (intmax_t)about.st_size, most);
  else if (!g_file_get_contents(path, &text, &size, &trouble))
    opc_fail(error, OPC_IO, NULL, "%s", trouble->message);
  else if (!g_utf8_validate(text, (gssize)size, &end))
    opc_fail(error, OPC_INVALID, NULL, "'%s': byte %zu is not UTF-8 text", path,
             (size_t)(end - text));
  else
    return g_steal_pointer(&text);
  return NULL;
}

/* ---- trees ---- */

int runs_tree_open(runs_tree *tree, const char *path, opc_error *error) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  *tree = (runs_tree){.source = opc_source_new(path, ""),
                      .text = runs_text(path, LARGEST_TREE, error)};
  if (!tree->text) return error->code;
  tree->roots = opc_node_parse_all(tree->source, tree->text, strlen(tree->text),
                                   problems);
  const opc_node *root = runs_root(tree);
  const opc_place start = {path, 1, 1};
  if (root && root->type != OPC_NODE_MAP)
    opc_problem_add(problems, OPC_INVALID, &start, "expected a map");
  if (!problems->list->len) return OPC_OK;
  const opc_problem *first = problems->list->pdata[0];
  return opc_fail(error, OPC_INVALID, NULL, "%s:%u:%u: damaged: %s", path,
                  first->at.line, first->at.column, first->message);
}

void runs_tree_close(runs_tree *tree) {
  if (tree->roots) g_ptr_array_free(tree->roots, TRUE);
  opc_source_free(tree->source);
  g_free(tree->text);
  *tree = (runs_tree){0};
}

const opc_node *runs_root(const runs_tree *tree) {
  return tree->roots->len ? tree->roots->pdata[0] : NULL;
}

const char *runs_word(const opc_node *node) {
  if (!node || node->type != OPC_NODE_TEXT) return NULL;
  return node->plain && !strcmp(node->text, "null") ? NULL : node->text;
}

double runs_number(const opc_node *node) {
  const char *text = runs_word(node);
  char *end = NULL;
  double value = text ? g_ascii_strtod(text, &end) : NAN;
  return !text || end == text || *end ? NAN : value;
}

int runs_fail(const opc_node *node, opc_error *error, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  g_autofree char *message = g_strdup_vprintf(format, arguments);
  va_end(arguments);
  return opc_fail(error, OPC_INVALID, NULL, "%s:%u:%u: %s", node->at.file,
                  node->at.line, node->at.column, message);
}
