/* SPDX-License-Identifier: BSD-3-Clause */
/* Construction of trees from events of libyaml, and access to them. */
#include <base/file.h>
#include <base/node.h>
#include <base/suggest.h>
#include <string.h>
#include <yaml.h>

enum {
  DEEPEST = 64,
  MOST_NODES = 200000,
  LARGEST_FILE = 16 << 20, /* bytes */
  LONGEST_TEXT = 1 << 16,  /* bytes */
};

/* Placeholders for the braces of ${name} during parsing, because a brace would
   end the text in { }. The characters are in the private area of Unicode and
   one column wide, like the braces. */
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
  node->at = at && source->folder ? *at : (opc_place){source->name, 0, 0};
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

/* The depth of recursion is the depth of the tree. */
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

void opc_node_free(opc_node *node) {
  if (!node) return;
  g_free(node->text);
  if (node->keys) g_ptr_array_free(node->keys, TRUE);
  if (node->items) g_ptr_array_free(node->items, TRUE);
  g_free(node);
}

const char *opc_node_key(const opc_node *map, guint i) {
  return ((const opc_node *)map->keys->pdata[i])->text;
}

int opc_node_find(const opc_node *map, const char *key) {
  for (guint i = 0; i < map->keys->len; i++)
    if (!strcmp(opc_node_key(map, i), key)) return (int)i;
  return -1;
}

opc_node *opc_node_get(const opc_node *map, const char *key) {
  if (!map || map->type != OPC_NODE_MAP) return NULL;
  int i = opc_node_find(map, key);
  return i < 0 ? NULL : map->items->pdata[i];
}

void opc_node_add(opc_node *map, opc_node *key, opc_node *value) {
  g_ptr_array_add(map->keys, key);
  g_ptr_array_add(map->items, value);
}

char **opc_choice_list(const char *choices) {
  return g_strsplit(choices ? choices : "", "|", -1);
}

gboolean opc_node_check_keys(const opc_node *map, const char *words,
                             const char *where, opc_problems *problems) {
  g_auto(GStrv) known = opc_choice_list(words);
  gboolean good = TRUE;
  for (guint i = 0; i < map->keys->len && !opc_problems_full(problems); i++) {
    const opc_node *key = map->keys->pdata[i];
    if (g_strv_contains((const char *const *)known, key->text)) continue;
    g_autofree char *suggestion = opc_suggestion_of(key->text, known);
    good = opc_wrong(problems, key, "unknown key '%s'%s%s", key->text, where,
                     suggestion);
  }
  return good;
}

gboolean opc_node_missing(const opc_node *map, const char *key,
                          const opc_place *at, const char *before,
                          const char *after, opc_problems *problems) {
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (guint i = 0; i < map->keys->len; i++)
    g_ptr_array_add(names, (char *)opc_node_key(map, i));
  g_autofree char *suggestion = opc_suggestion(key, names);
  return opc_problem_add(problems, OPC_INVALID, at, "%s '%s'%s%s", before, key,
                         after, suggestion);
}

char *opc_node_path(const opc_node *node) {
  const char *folder = node->source->folder;
  return g_path_is_absolute(node->text) || !folder || !*folder
             ? g_strdup(node->text)
             : g_build_filename(folder, node->text, NULL);
}

const char *opc_node_noun(const opc_node *node) {
  static const char *const nouns[] = {"a text", "a list", "a map"};
  return nouns[node->type];
}

gboolean opc_node_is_empty(const opc_node *node) {
  return node->type == OPC_NODE_TEXT && node->plain && !*node->text;
}

gboolean opc_node_is_null(const opc_node *node) {
  return node->type == OPC_NODE_TEXT && node->plain &&
         (!strcmp(node->text, "~") || !strcmp(node->text, "null"));
}

/* ---- references within { } ---- */

static char *hide_braces(const char *text, size_t length) {
  static GRegex *reference;
  if (!reference)
    reference = g_regex_new("\\$\\{([A-Za-z0-9_.-]*)\\}", 0, 0, NULL);
  return g_regex_replace(reference, text, (gssize)length, 0,
                         "$" OPEN "\\1" CLOSE, 0, NULL);
}

static char *show_braces(const char *text) {
  GString *out = g_string_new(text);
  g_string_replace(out, OPEN, "{", 0);
  g_string_replace(out, CLOSE, "}", 0);
  return g_string_free(out, FALSE);
}

/* ---- building ---- */

typedef struct builder {
  const opc_source *source;
  const char *text;
  opc_problems *problems;
  yaml_parser_t parser;
  size_t nodes, most;
} builder;

static opc_place place_of(const builder *b, yaml_mark_t mark) {
  return (opc_place){b->source->name, (unsigned)mark.line + 1,
                     (unsigned)mark.column + 1};
}

/* Return the start of line `line`, counted from 0. */
static const char *line_start(const char *text, size_t line) {
  for (; text && line; line--) {
    text = strchr(text, '\n');
    if (text) text++;
  }
  return text;
}

/* Return the length of "KEY:" at the beginning of a line if a value follows
   without a space, as in "use:write.gds"; else 0. Texts like "x:/y" and "x::y"
   may be meant as values and return 0. */
static size_t joined_key(const char *line) {
  size_t n = 0;
  while (g_ascii_isalnum(line[n]) || line[n] == '_' || line[n] == '.') n++;
  return n && line[n] == ':' &&
                 (g_ascii_isalnum(line[n + 1]) ||
                  (line[n + 1] && strchr("$'\"{[", line[n + 1])))
             ? n + 1
             : 0;
}

/* Report a key without a space after the colon in the line in which libyaml
   found the fault, or in the line before. Return FALSE if there is none. */
static gboolean find_joined_key(const builder *b) {
  enum { LINES = 2 };
  size_t last = b->parser.problem_mark.line;
  for (size_t k = 0; k < LINES && k <= last; k++) {
    const char *line = line_start(b->text, last - k);
    if (!line) continue;
    size_t indent = strspn(line, " -"), n = joined_key(line + indent);
    if (!n) continue;
    opc_place at = {b->source->name, (unsigned)(last - k) + 1,
                    (unsigned)(indent + n)};
    opc_problem_add(b->problems, OPC_INVALID, &at,
                    "not YAML: no space after the colon of '%.*s'", (int)n,
                    line + indent);
    return TRUE;
  }
  return FALSE;
}

/* Report a fault that libyaml found. The place is the open bracket if a bracket
   is not closed. Return FALSE. */
static gboolean event_fails(const builder *b) {
  const yaml_parser_t *parser = &b->parser;
  opc_place at = place_of(b, parser->problem_mark);
  const char *fault = parser->problem ? parser->problem : "out of memory";
  const char *context = parser->context ? parser->context : "";
  gboolean map = strstr(context, "flow mapping") != NULL;
  if ((map || strstr(context, "flow sequence")) &&
      g_str_has_prefix(fault, "did not find expected ',' or")) {
    opc_place open = place_of(b, parser->context_mark);
    return opc_problem_add(b->problems, OPC_INVALID, &open,
                           "not YAML: '%s' is not closed: no ',' or '%s' "
                           "before line %u, column %u",
                           map ? "{" : "[", map ? "}" : "]", at.line,
                           at.column);
  }
  if (find_joined_key(b)) return FALSE;
  if (!strcmp(fault, "found character that cannot start any token"))
    fault = "found a tab or a character that cannot begin a value";
  return opc_problem_add(b->problems, OPC_INVALID, &at, "not YAML: %s%s%s",
                         fault, *context ? " " : "", context);
}

static gboolean next_event(builder *b, yaml_event_t *event) {
  return yaml_parser_parse(&b->parser, event) || event_fails(b);
}

/* Return why an event is no valid node; NULL if valid. */
static char *event_fault(const builder *b, const yaml_event_t *event,
                         opc_node_type type, unsigned depth, gboolean is_key) {
  /* The structs of texts, lists and maps start with equal members. */
  const char *anchor = (const char *)event->data.scalar.anchor;
  const char *tag = (const char *)event->data.scalar.tag;
  size_t length = event->data.scalar.length;
  if (anchor)
    return g_strdup_printf("anchors and aliases ('&%s') cannot be used here",
                           anchor);
  if (tag) return g_strdup_printf("tags ('%s') cannot be used here", tag);
  if (type != OPC_NODE_TEXT && depth == DEEPEST)
    return g_strdup_printf("nested deeper than %d", DEEPEST);
  if (type == OPC_NODE_TEXT && memchr(event->data.scalar.value, 0, length))
    return g_strdup("a text with a NUL byte");
  if (type == OPC_NODE_TEXT && length > LONGEST_TEXT)
    return g_strdup_printf("a text of more than %d bytes", LONGEST_TEXT);
  if (b->nodes >= b->most)
    return g_strdup_printf("more than %zu values", b->most);
  if (type != OPC_NODE_TEXT && is_key)
    return g_strdup_printf("a key cannot be a %s",
                           type == OPC_NODE_MAP ? "map" : "list");
  return NULL;
}

static gboolean read_items(builder *b, opc_node *node, unsigned depth);

/* Read the node that an event starts, NULL if none. Return FALSE to stop
   parsing. The depth of recursion is the depth of the tree. */
static gboolean read_node(builder *b, const yaml_event_t *event, unsigned depth,
                          gboolean is_key, opc_node **out) {
  opc_place at = place_of(b, event->start_mark);
  opc_node_type type = OPC_NODE_TEXT;
  *out = NULL;
  if (event->type == YAML_ALIAS_EVENT)
    return opc_problem_add(b->problems, OPC_INVALID, &at,
                           "anchors and aliases ('*%s') cannot be used here",
                           (const char *)event->data.alias.anchor);
  if (event->type == YAML_SEQUENCE_START_EVENT)
    type = OPC_NODE_LIST;
  else if (event->type == YAML_MAPPING_START_EVENT)
    type = OPC_NODE_MAP;
  else if (event->type != YAML_SCALAR_EVENT)
    return TRUE;
  g_autofree char *fault = event_fault(b, event, type, depth, is_key);
  if (fault) return opc_problem_add(b->problems, OPC_INVALID, &at, "%s", fault);
  b->nodes++;
  *out = node_new(type, b->source, &at);
  if (type != OPC_NODE_TEXT) return read_items(b, *out, depth + 1);
  (*out)->text = show_braces((const char *)event->data.scalar.value);
  (*out)->plain = event->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
  return TRUE;
}

/* Report a duplicate key. `lines` holds the first place of each key. */
static void check_key(const builder *b, GHashTable *lines, const opc_node *key,
                      const opc_place *at) {
  guint first = GPOINTER_TO_UINT(g_hash_table_lookup(lines, key->text));
  if (first)
    opc_problem_add(b->problems, OPC_INVALID, at,
                    "duplicate key '%s', first given in line %u", key->text,
                    first);
  else
    g_hash_table_insert(lines, key->text, GUINT_TO_POINTER(at->line));
}

/* Read the contents of a list or map up to the end. */
static gboolean read_items(builder *b, opc_node *node, unsigned depth) {
  g_autoptr(GHashTable) lines = g_hash_table_new(g_str_hash, g_str_equal);
  opc_node *key = NULL, *item = NULL;
  gboolean good;
  do {
    yaml_event_t event;
    good = next_event(b, &event);
    if (!good) break;
    opc_place at = place_of(b, event.start_mark);
    gboolean is_key = node->keys && !key;
    good = read_node(b, &event, depth, is_key, &item);
    if (item && is_key) {
      check_key(b, lines, item, &at);
      key = item;
    } else if (item) {
      if (key) g_ptr_array_add(node->keys, g_steal_pointer(&key));
      g_ptr_array_add(node->items, item);
    }
    yaml_event_delete(&event);
  } while (good && item);
  opc_node_free(key);
  return good;
}

/* Return whether YAML allows a character. The two placeholders are not
   allowed. */
static gboolean is_yaml(gunichar c) {
  if (c < 0x20) return c == '\t' || c == '\n' || c == '\r';
  if (c < 0xA0) return c < 0x7F || c == 0x85;
  return c != 0xE000 && c != 0xE001 && c != 0xFFFE && c != 0xFFFF;
}

/* Report invalid bytes with their place, because libyaml reports no place. */
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

/* Append the documents of a stream to `roots`. Stop at the first problem, and
   at a second document if only `one` is allowed. */
static void read_documents(builder *b, gboolean one, GPtrArray *roots) {
  yaml_event_t event;
  for (gboolean going = TRUE; going && next_event(b, &event);) {
    opc_place at = place_of(b, event.start_mark);
    opc_node *root = NULL;
    going = event.type != YAML_STREAM_END_EVENT;
    if (one && roots->len && event.type == YAML_DOCUMENT_START_EVENT)
      going =
          opc_problem_add(b->problems, OPC_INVALID, &at, "a second document");
    else
      going &= read_node(b, &event, 0, FALSE, &root);
    if (root) g_ptr_array_add(roots, root);
    yaml_event_delete(&event);
  }
}

/* Byte order mark, which some editors write at the start of UTF-8 files. */
static const char byte_order_mark[] = "\xEF\xBB\xBF";

/* Return the documents of a text of at most `most` nodes; an empty list after
   problems. */
static GPtrArray *documents_parse(const opc_source *source, const char *text,
                                  size_t length, size_t most, gboolean one,
                                  opc_problems *problems) {
  GPtrArray *roots =
      g_ptr_array_new_with_free_func((GDestroyNotify)opc_node_free);
  if (length >= 3 && !memcmp(text, byte_order_mark, 3)) {
    text += 3;
    length -= 3;
  }
  if (!check_bytes(source, text, length, problems)) return roots;
  g_autofree char *hidden = hide_braces(text, length);
  builder b = {
      .source = source, .text = hidden, .problems = problems, .most = most};
  guint before = problems->list->len;
  if (!yaml_parser_initialize(&b.parser)) g_error("out of memory");
  yaml_parser_set_encoding(&b.parser, YAML_UTF8_ENCODING);
  yaml_parser_set_input_string(&b.parser, (const unsigned char *)hidden,
                               strlen(hidden));
  read_documents(&b, one, roots);
  const opc_place at = {source->name, 1, 1};
  yaml_parser_delete(&b.parser);
  if (problems->list->len > before)
    g_ptr_array_set_size(roots, 0);
  else if (!roots->len)
    opc_problem_add(problems, OPC_INVALID, &at, "the file is empty");
  return roots;
}

opc_node *opc_node_parse(const opc_source *source, const char *text,
                         size_t length, opc_problems *problems) {
  g_autoptr(GPtrArray) roots =
      documents_parse(source, text, length, MOST_NODES, TRUE, problems);
  return roots->len ? g_ptr_array_steal_index(roots, 0) : NULL;
}

GPtrArray *opc_node_parse_all(const opc_source *source, const char *text,
                              size_t length, opc_problems *problems) {
  return documents_parse(source, text, length, SIZE_MAX, FALSE, problems);
}

/* Return the text of a file (g_free); NULL and a problem on failure. */
static char *read_text(const char *path, const opc_place *at, gsize *length,
                       opc_problems *problems) {
  g_autoptr(GError) fault = NULL;
  char *text = NULL;
  const char *why = opc_file_fault(path, length);
  if (why)
    opc_problem_add(problems, OPC_IO, at, "'%s': %s", path, why);
  else if (*length > LARGEST_FILE)
    opc_problem_add(problems, OPC_INVALID, at, "'%s': larger than %d bytes",
                    path, LARGEST_FILE);
  else if (!g_file_get_contents(path, &text, length, &fault))
    opc_problem_add(problems, OPC_IO, at, "'%s': %s", path, fault->message);
  return text;
}

opc_node *opc_node_read(const opc_source *source, const char *path,
                        const opc_place *at, opc_problems *problems) {
  gsize length = 0;
  g_autofree char *text = read_text(path, at, &length, problems);
  return text ? opc_node_parse(source, text, length, problems) : NULL;
}

GPtrArray *opc_node_read_all(const opc_source *source, const char *path,
                             opc_problems *problems) {
  gsize length = 0;
  g_autofree char *text = read_text(path, NULL, &length, problems);
  return text ? opc_node_parse_all(source, text, length, problems)
              : g_ptr_array_new();
}

void opc_node_put(opc_node *map, const opc_node *key, const opc_node *value) {
  int i = opc_node_find(map, key->text);
  opc_node *name = opc_node_copy(key, NULL), *copy = opc_node_copy(value, NULL);
  if (i < 0) {
    opc_node_add(map, name, copy);
    return;
  }
  opc_node_free(map->keys->pdata[i]);
  opc_node_free(map->items->pdata[i]);
  map->keys->pdata[i] = name;
  map->items->pdata[i] = copy;
}
