/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/text/node.h"

#include <string.h>
#include <sys/stat.h>
#include <yaml.h>

enum {
  DEEPEST = 64,
  MOST_NODES = 200000,
  LARGEST_FILE = 16 << 20, /* bytes */
  LONGEST_TEXT = 1 << 16,  /* bytes */
};

/* Stand for the braces of ${name} while libyaml reads: in { } they would end
   the text. Private characters, one column wide as the braces are. */
#define OPEN "\xEE\x80\x80"  /* U+E000 */
#define CLOSE "\xEE\x80\x81" /* U+E001 */

opc_source *opc_source_new(const char *name, const char *folder) {
  opc_source *source = g_new0(opc_source, 1);
  source->name = g_strdup(name);
  source->folder = g_strdup(folder);
  return source;
}

opc_source *opc_source_layer(const opc_source *file, const char *layer) {
  opc_source *source = opc_source_new(file->name, file->folder);
  source->layer = g_strdup(layer);
  return source;
}

void opc_source_free(opc_source *source) {
  if (!source) return;
  g_free(source->layer);
  g_free(source->name);
  g_free(source->folder);
  g_free(source);
}

/* ---- nodes ---- */

static opc_node *node_new(opc_node_type type, const opc_source *source,
                          const opc_place *at) {
  opc_node *node = g_new0(opc_node, 1);
  node->type = type;
  node->source = source;
  node->at = at ? *at : (opc_place){source->name, 0, 0};
  if (type == OPC_NODE_MAP)
    node->keys = g_ptr_array_new_with_free_func((GDestroyNotify)opc_node_free);
  if (type != OPC_NODE_TEXT)
    node->items = g_ptr_array_new_with_free_func((GDestroyNotify)opc_node_free);
  return node;
}

opc_node *opc_node_text_new(const opc_source *source, const char *text) {
  opc_node *node = node_new(OPC_NODE_TEXT, source, NULL);
  node->text = g_strdup(text);
  return node;
}

opc_node *opc_node_map_new(const opc_source *source, const opc_place *at) {
  return node_new(OPC_NODE_MAP, source, at);
}

/* These three go as deep as the tree: DEEPEST, and what is laid over it. */

opc_node *opc_node_copy(const opc_node *node, const opc_source *source) {
  opc_place at = node->at;
  if (source) at.file = source->name;
  opc_node *copy = node_new(node->type, source ? source : node->source, &at);
  copy->text = g_strdup(node->text);
  copy->plain = node->plain;
  for (guint i = 0; node->items && i < node->items->len; i++) {
    if (node->keys)
      g_ptr_array_add(copy->keys, opc_node_copy(node->keys->pdata[i], source));
    g_ptr_array_add(copy->items, opc_node_copy(node->items->pdata[i], source));
  }
  return copy;
}

void opc_node_forget_lines(opc_node *node) {
  node->at.line = node->at.column = 0;
  for (guint i = 0; node->keys && i < node->keys->len; i++)
    opc_node_forget_lines(node->keys->pdata[i]);
  for (guint i = 0; node->items && i < node->items->len; i++)
    opc_node_forget_lines(node->items->pdata[i]);
}

void opc_node_free(opc_node *node) {
  if (!node) return;
  g_free(node->text);
  if (node->keys) g_ptr_array_free(node->keys, TRUE);
  if (node->items) g_ptr_array_free(node->items, TRUE);
  g_free(node);
}

opc_node *opc_node_get(const opc_node *map, const char *key) {
  if (!map || map->type != OPC_NODE_MAP) return NULL;
  for (guint i = 0; i < map->keys->len; i++)
    if (!strcmp(((opc_node *)map->keys->pdata[i])->text, key))
      return map->items->pdata[i];
  return NULL;
}

void opc_node_add(opc_node *map, opc_node *key, opc_node *value) {
  g_ptr_array_add(map->keys, key);
  g_ptr_array_add(map->items, value);
}

const char *opc_node_noun(const opc_node *node) {
  switch (node->type) {
    case OPC_NODE_MAP:
      return "a map";
    case OPC_NODE_LIST:
      return "a list";
    default:
      return "a text";
  }
}

gboolean opc_node_is_empty(const opc_node *node) {
  return node->type == OPC_NODE_TEXT && node->plain && !*node->text;
}

gboolean opc_node_is_null(const opc_node *node) {
  return node->type == OPC_NODE_TEXT && node->plain &&
         (!strcmp(node->text, "~") || !strcmp(node->text, "null"));
}

/* ---- references within { } ---- */

static gboolean name_byte(char c) {
  return g_ascii_isalnum(c) || c == '_' || c == '-' || c == '.';
}

static char *hide_braces(const char *text, size_t length) {
  GString *out = g_string_sized_new(length + 64);
  for (size_t i = 0; i < length;) {
    size_t j = i + 2;
    if (text[i] == '$' && i + 1 < length && text[i + 1] == '{') {
      while (j < length && name_byte(text[j])) j++;
      if (j < length && text[j] == '}') {
        g_string_append(out, "$" OPEN);
        g_string_append_len(out, text + i + 2, (gssize)(j - i - 2));
        g_string_append(out, CLOSE);
        i = j + 1;
        continue;
      }
    }
    g_string_append_c(out, text[i++]);
  }
  return g_string_free(out, FALSE);
}

static char *show_braces(const char *text, size_t length) {
  GString *out = g_string_sized_new(length + 1);
  for (size_t i = 0; i < length;) {
    if (length - i >= 3 && !memcmp(text + i, OPEN, 3)) {
      g_string_append_c(out, '{');
      i += 3;
    } else if (length - i >= 3 && !memcmp(text + i, CLOSE, 3)) {
      g_string_append_c(out, '}');
      i += 3;
    } else {
      g_string_append_c(out, text[i++]);
    }
  }
  return g_string_free(out, FALSE);
}

/* ---- building ---- */

typedef struct builder {
  const opc_source *source;
  opc_problems *problems;
  opc_node *root;
  opc_node *open[DEEPEST];   /* the maps and lists we are in */
  opc_node *key[DEEPEST];    /* of each: the key that waits for its value */
  GHashTable *seen[DEEPEST]; /* of each map: key text -> key node */
  unsigned depth;
  size_t nodes;
  unsigned documents;
  gboolean failed; /* no use going on */
} builder;

static opc_place place_of(const builder *b, yaml_mark_t mark) {
  return (opc_place){b->source->name, (unsigned)mark.line + 1,
                     (unsigned)mark.column + 1};
}

#define STOP(b, at, ...)                                          \
  do {                                                            \
    opc_problem_add((b)->problems, OPC_INVALID, at, __VA_ARGS__); \
    (b)->failed = TRUE;                                           \
  } while (0)

static void refuse_extras(builder *b, const opc_place *at,
                          const yaml_char_t *anchor, const yaml_char_t *tag) {
  if (anchor)
    STOP(b, at, "anchors and aliases ('&%s') cannot be used here",
         (const char *)anchor);
  else if (tag)
    STOP(b, at, "tags ('%s') cannot be used here", (const char *)tag);
}

static void add_key(builder *b, opc_node *node) {
  unsigned top = b->depth - 1;
  const opc_node *first = g_hash_table_lookup(b->seen[top], node->text);
  if (first)
    opc_problem_add(b->problems, OPC_INVALID, &node->at,
                    "duplicate key '%s', first given in line %u", node->text,
                    first->at.line);
  else
    g_hash_table_insert(b->seen[top], node->text, node);
  b->key[top] = node;
}

/* Put a finished text or a just opened map or list where it belongs. Takes the
   node, whatever happens. */
static void place_node(builder *b, opc_node *node) {
  if (++b->nodes > MOST_NODES) {
    STOP(b, &node->at, "more than %d values", MOST_NODES);
    opc_node_free(node);
    return;
  }
  if (!b->depth) {
    b->root = node;
    return;
  }
  unsigned top = b->depth - 1;
  opc_node *parent = b->open[top];
  if (parent->type == OPC_NODE_LIST) {
    g_ptr_array_add(parent->items, node);
  } else if (b->key[top]) {
    g_ptr_array_add(parent->keys, b->key[top]);
    g_ptr_array_add(parent->items, node);
    b->key[top] = NULL;
  } else if (node->type != OPC_NODE_TEXT) {
    STOP(b, &node->at, "a key cannot be %s", opc_node_noun(node));
    opc_node_free(node);
  } else {
    add_key(b, node);
  }
}

static void open_node(builder *b, opc_node_type type, const opc_place *at) {
  if (b->depth == DEEPEST) {
    STOP(b, at, "nested deeper than %d", DEEPEST);
    return;
  }
  opc_node *node = node_new(type, b->source, at);
  place_node(b, node);
  if (b->failed) return;
  b->open[b->depth] = node;
  b->key[b->depth] = NULL;
  b->seen[b->depth] = g_hash_table_new(g_str_hash, g_str_equal);
  b->depth++;
}

static void close_node(builder *b) {
  b->depth--;
  g_hash_table_destroy(b->seen[b->depth]);
}

static void add_text(builder *b, const yaml_event_t *event,
                     const opc_place *at) {
  const char *value = (const char *)event->data.scalar.value;
  size_t length = event->data.scalar.length;
  if (memchr(value, 0, length)) {
    STOP(b, at, "a text with a NUL byte");
    return;
  }
  if (length > LONGEST_TEXT) {
    STOP(b, at, "a text of more than %d bytes", LONGEST_TEXT);
    return;
  }
  opc_node *node = node_new(OPC_NODE_TEXT, b->source, at);
  node->text = show_braces(value, length);
  node->plain = event->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
  place_node(b, node);
}

static void take_event(builder *b, const yaml_event_t *event) {
  opc_place at = place_of(b, event->start_mark);
  switch (event->type) {
    case YAML_DOCUMENT_START_EVENT:
      if (b->documents++) STOP(b, &at, "a second document");
      break;
    case YAML_ALIAS_EVENT:
      STOP(b, &at, "anchors and aliases ('*%s') cannot be used here",
           (const char *)event->data.alias.anchor);
      break;
    case YAML_SCALAR_EVENT:
      refuse_extras(b, &at, event->data.scalar.anchor, event->data.scalar.tag);
      if (!b->failed) add_text(b, event, &at);
      break;
    case YAML_SEQUENCE_START_EVENT:
      refuse_extras(b, &at, event->data.sequence_start.anchor,
                    event->data.sequence_start.tag);
      if (!b->failed) open_node(b, OPC_NODE_LIST, &at);
      break;
    case YAML_MAPPING_START_EVENT:
      refuse_extras(b, &at, event->data.mapping_start.anchor,
                    event->data.mapping_start.tag);
      if (!b->failed) open_node(b, OPC_NODE_MAP, &at);
      break;
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
      close_node(b);
      break;
    default:
      break;
  }
}

static void parser_problem(builder *b, const yaml_parser_t *parser) {
  opc_place at = place_of(b, parser->problem_mark);
  const char *fault = parser->problem ? parser->problem : "out of memory";
  if (!strcmp(fault, "found character that cannot start any token"))
    fault = "found a tab or a character that cannot begin a value";
  if (parser->context)
    STOP(b, &at, "not YAML: %s %s", fault, parser->context);
  else
    STOP(b, &at, "not YAML: %s", fault);
}

static opc_node *builder_finish(builder *b, guint problems_before) {
  while (b->depth) {
    opc_node_free(b->key[b->depth - 1]);
    close_node(b);
  }
  if (b->problems->list->len > problems_before) {
    opc_node_free(b->root);
    b->root = NULL;
  } else if (!b->root) {
    opc_place at = {b->source->name, 1, 1};
    opc_problem_add(b->problems, OPC_INVALID, &at, "there is nothing in it");
  }
  return b->root;
}

/* What YAML takes, less the two that stand for braces here. */
static gboolean is_yaml(gunichar c) {
  if (c < 0x20) return c == '\t' || c == '\n' || c == '\r';
  if (c < 0xA0) return c < 0x7F || c == 0x85;
  return c != 0xE000 && c != 0xE001 && c != 0xFFFE && c != 0xFFFF;
}

/* libyaml would refuse such bytes without telling the place. */
static gboolean check_bytes(const opc_source *source, const char *text,
                            size_t length, opc_problems *problems) {
  const char *end = text;
  gboolean good = g_utf8_validate_len(text, length, &end);
  opc_place at = {source->name, 1, 1};
  const char *c = text;
  for (; c < end && is_yaml(g_utf8_get_char(c)); c = g_utf8_next_char(c)) {
    if (*c == '\n') {
      at.line++;
      at.column = 1;
    } else {
      at.column++;
    }
  }
  if (c < end)
    opc_problem_add(problems, OPC_INVALID, &at,
                    "not YAML: the character U+%04X", g_utf8_get_char(c));
  else if (!good && !*c && (size_t)(c - text) < length)
    opc_problem_add(problems, OPC_INVALID, &at, "not YAML: a NUL byte");
  else if (!good)
    opc_problem_add(problems, OPC_INVALID, &at, "not YAML: not UTF-8 text");
  return good && c == end;
}

opc_node *opc_node_parse(const opc_source *source, const char *text,
                         size_t length, opc_problems *problems) {
  if (!check_bytes(source, text, length, problems)) return NULL;
  g_autofree char *hidden = hide_braces(text, length);
  builder b = {.source = source, .problems = problems};
  guint before = problems->list->len;
  yaml_parser_t parser;
  if (!yaml_parser_initialize(&parser)) {
    STOP(&b, NULL, "out of memory");
    return NULL;
  }
  yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
  yaml_parser_set_input_string(&parser, (const unsigned char *)hidden,
                               strlen(hidden));
  for (gboolean done = FALSE; !done && !b.failed;) {
    yaml_event_t event;
    if (!yaml_parser_parse(&parser, &event)) {
      parser_problem(&b, &parser);
      break;
    }
    done = event.type == YAML_STREAM_END_EVENT;
    take_event(&b, &event);
    yaml_event_delete(&event);
  }
  yaml_parser_delete(&parser);
  return builder_finish(&b, before);
}

opc_node *opc_node_read(const opc_source *source, const char *path,
                        opc_problems *problems) {
  g_autoptr(GError) fault = NULL;
  g_autofree char *text = NULL;
  gsize length = 0;
  opc_place at = {NULL, 0, 0};
  struct stat about = {0};
  if (!stat(path, &about) && !S_ISREG(about.st_mode)) {
    opc_problem_add(problems, OPC_IO, &at, "'%s': not a file", path);
    return NULL;
  }
  if (about.st_size > LARGEST_FILE) {
    opc_problem_add(problems, OPC_INVALID, &at, "'%s': larger than %d bytes",
                    path, LARGEST_FILE);
    return NULL;
  }
  if (!g_file_get_contents(path, &text, &length, &fault)) {
    const char *why = g_error_matches(fault, G_FILE_ERROR, G_FILE_ERROR_NOENT)
                          ? "no such file"
                          : fault->message;
    opc_problem_add(problems, OPC_IO, &at, "'%s': %s", path, why);
    return NULL;
  }
  return opc_node_parse(source, text, length, problems);
}
