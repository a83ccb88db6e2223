/* SPDX-License-Identifier: BSD-3-Clause */
/* Files of a run folder as texts, and as trees of nodes with their places. */
#include "runs/text.h"

#include <errno.h>
#include <glib.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

enum {
  LARGEST_TREE = 16 << 20, /* bytes */
  DEEPEST = 64             /* same limit as for flows */
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

static int fail_parser(const runs_tree *tree, const yaml_parser_t *parser,
                       opc_error *error) {
  return opc_fail(
      error, OPC_INVALID, NULL, "%s:%zu:%zu: damaged: %s%s%s", tree->path,
      parser->problem_mark.line + 1, parser->problem_mark.column + 1,
      parser->problem ? parser->problem : "no such text",
      parser->context ? " " : "", parser->context ? parser->context : "");
}

/* Check the next event against limits that keep a small file from making a
   large or deep tree, and track the depth. */
static int check_event(const runs_tree *tree, yaml_parser_t *parser, int *depth,
                       yaml_event_type_t *type, opc_error *error) {
  yaml_event_t event;
  if (!yaml_parser_parse(parser, &event))
    return fail_parser(tree, parser, error);
  *type = event.type;
  *depth += (*type == YAML_SEQUENCE_START_EVENT) +
            (*type == YAML_MAPPING_START_EVENT) -
            (*type == YAML_SEQUENCE_END_EVENT) -
            (*type == YAML_MAPPING_END_EVENT);
  yaml_mark_t at = event.start_mark;
  yaml_event_delete(&event);
  const char *what = *type == YAML_ALIAS_EVENT ? "aliases cannot be used here"
                     : *depth > DEEPEST        ? "is nested too deep"
                                               : NULL;
  return what ? opc_fail(error, OPC_INVALID, NULL, "%s:%zu:%zu: damaged: %s",
                         tree->path, at.line + 1, at.column + 1, what)
              : OPC_OK;
}

/* Parse twice: check all events, then make the tree. */
static int read_document(runs_tree *tree, opc_error *error) {
  int code = OPC_OK, depth = 0;
  for (int pass = 0; pass < 2 && !code; pass++) {
    yaml_parser_t parser;
    yaml_event_type_t type = YAML_NO_EVENT;
    if (!yaml_parser_initialize(&parser)) g_error("out of memory");
    yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&parser, (const unsigned char *)tree->text,
                                 strlen(tree->text));
    while (!pass && !code && type != YAML_STREAM_END_EVENT)
      code = check_event(tree, &parser, &depth, &type, error);
    if (pass) tree->there = yaml_parser_load(&parser, &tree->document);
    if (pass && !tree->there) code = fail_parser(tree, &parser, error);
    yaml_parser_delete(&parser);
  }
  const yaml_node_t *root = runs_root(tree);
  if (!code && (!root || root->type != YAML_MAPPING_NODE))
    code = opc_fail(error, OPC_INVALID, NULL, "%s:1:1: damaged: expected a map",
                    tree->path);
  return code;
}

/* Return the text with braces of ${name} replaced by private characters;
   parameters.c restores them. ${name} needs no quotes in { } and [ ], where
   YAML would end the text at its brace. */
static char *hide_braces(const char *text) {
  g_autoptr(GRegex) reference =
      g_regex_new("\\$\\{([A-Za-z0-9_.-]*)\\}", 0, 0, NULL);
  return g_regex_replace(reference, text, -1, 0, "$\xEE\x80\x80\\1\xEE\x80\x81",
                         0, NULL);
}

int runs_tree_open(runs_tree *tree, const char *path, opc_error *error) {
  *tree = (runs_tree){.path = g_strdup(path)};
  g_autofree char *text = runs_text(path, LARGEST_TREE, error);
  if (!text) return error->code;
  tree->text = g_str_has_suffix(path, ".yaml") ? hide_braces(text)
                                               : g_steal_pointer(&text);
  return read_document(tree, error);
}

void runs_tree_close(runs_tree *tree) {
  if (tree->there) yaml_document_delete(&tree->document);
  g_free(tree->path);
  g_free(tree->text);
  *tree = (runs_tree){0};
}

yaml_node_t *runs_root(runs_tree *tree) {
  return tree->there ? yaml_document_get_root_node(&tree->document) : NULL;
}

yaml_node_t *runs_node(runs_tree *tree, int number) {
  return yaml_document_get_node(&tree->document, number);
}

yaml_node_t *runs_get(runs_tree *tree, const yaml_node_t *map,
                      const char *key) {
  if (!map || map->type != YAML_MAPPING_NODE) return NULL;
  const yaml_node_pair_t *pair = map->data.mapping.pairs.start;
  for (; pair < map->data.mapping.pairs.top; pair++) {
    const char *name = runs_word(runs_node(tree, pair->key));
    if (name && !strcmp(name, key)) return runs_node(tree, pair->value);
  }
  return NULL;
}

const char *runs_word(const yaml_node_t *node) {
  if (!node || node->type != YAML_SCALAR_NODE) return NULL;
  const char *text = (const char *)node->data.scalar.value;
  gboolean plain = node->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
  /* A text with a NUL byte, possible by an escape, is rejected. */
  if (strlen(text) != node->data.scalar.length) return NULL;
  return plain && !strcmp(text, "null") ? NULL : text;
}

double runs_number(const yaml_node_t *node) {
  const char *text = runs_word(node);
  char *end = NULL;
  double value = text ? g_ascii_strtod(text, &end) : NAN;
  return !text || end == text || *end ? NAN : value;
}

int runs_fail(const runs_tree *tree, const yaml_node_t *node, opc_error *error,
              const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  g_autofree char *said = g_strdup_vprintf(format, arguments);
  va_end(arguments);
  return opc_fail(error, OPC_INVALID, NULL, "%s:%zu:%zu: %s", tree->path,
                  node->start_mark.line + 1, node->start_mark.column + 1, said);
}
