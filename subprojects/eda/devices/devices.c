/* SPDX-License-Identifier: BSD-3-Clause */
/* Reader of device tables, described in docs/reference/devices.md. All faults
   of a file are collected; the message has the first one and the number of
   others. */
#include <eda/devices.h>
#include <eda/memory.h>
#include <eda/words.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <yaml.h>

enum { LARGEST_FILE = 16 << 20 /* bytes */ };

typedef struct reader {
  eda_devices *devices; /* current table */
  eda_devices *first;   /* first table of the file */
  yaml_document_t document;
  GRegex *number; /* matches a number, its exponent, and a unit */
  unsigned faults;
  yaml_mark_t at; /* place of the first fault in the file */
  char *fault;
} reader;

/* ---- faults ---- */

static gboolean is_before(const yaml_mark_t *a, const yaml_mark_t *b) {
  return a->line < b->line || (a->line == b->line && a->column < b->column);
}

G_GNUC_PRINTF(3, 4)
static gboolean wrong(reader *r, const yaml_mark_t *at, const char *format,
                      ...) {
  if (r->faults++ && !is_before(at, &r->at)) return FALSE;
  va_list arguments;
  va_start(arguments, format);
  g_free(r->fault);
  r->fault = g_strdup_vprintf(format, arguments);
  r->at = *at;
  va_end(arguments);
  return FALSE;
}

/* Return the code and fill the error with the collected faults. */
static int end_read(reader *r, const char *path, opc_error *error) {
  if (!r->faults) return OPC_OK;
  char more[32] = "";
  if (r->faults > 1)
    g_snprintf(more, sizeof more, " (and %u more)", r->faults - 1);
  return opc_fail(error, OPC_INVALID, NULL, "%s:%zu:%zu: %s%s", path,
                  r->at.line + 1, r->at.column + 1, r->fault, more);
}

/* Return ", did you mean '...'?" for a similar word, or "". */
static char *similar_word(const char *word, const char *const *known) {
  const char *best = eda_nearest(word, known);
  return best ? g_strdup_printf(", did you mean '%s'?", best) : g_strdup("");
}

/* ---- pieces of the file ---- */

static yaml_node_t *node_of(reader *r, int index) {
  return yaml_document_get_node(&r->document, index);
}

static const char *text_of(const yaml_node_t *node) {
  return (const char *)node->data.scalar.value;
}

static const char *noun(const yaml_node_t *node) {
  return node->type == YAML_MAPPING_NODE    ? "a map"
         : node->type == YAML_SEQUENCE_NODE ? "a list"
                                            : "a text";
}

/* Return the value of a key, NULL if the map lacks the key. */
static yaml_node_t *look_up(reader *r, const yaml_node_t *map,
                            const char *key) {
  const yaml_node_pair_t *pair = map->data.mapping.pairs.start;
  for (; pair < map->data.mapping.pairs.top; pair++) {
    const yaml_node_t *k = node_of(r, pair->key);
    if (k->type == YAML_SCALAR_NODE && !strcmp(text_of(k), key))
      return node_of(r, pair->value);
  }
  return NULL;
}

/* Report duplicate keys, and keys missing in `known` (NULL-terminated). */
static void check_keys(reader *r, const yaml_node_t *map,
                       const char *const *known) {
  g_autoptr(GHashTable) seen = g_hash_table_new(g_str_hash, g_str_equal);
  const yaml_node_pair_t *pair = map->data.mapping.pairs.start;
  for (; pair < map->data.mapping.pairs.top; pair++) {
    yaml_node_t *key = node_of(r, pair->key);
    if (key->type != YAML_SCALAR_NODE) {
      wrong(r, &key->start_mark, "a key cannot be %s", noun(key));
      continue;
    }
    const yaml_node_t *first = g_hash_table_lookup(seen, text_of(key));
    if (first)
      wrong(r, &key->start_mark, "duplicate key '%s', first given in line %zu",
            text_of(key), first->start_mark.line + 1);
    else
      g_hash_table_insert(seen, (char *)text_of(key), key);
    if (g_strv_contains(known, text_of(key))) continue;
    g_autofree char *hint = similar_word(text_of(key), known);
    wrong(r, &key->start_mark, "unknown key '%s'%s", text_of(key), hint);
  }
}

/* Return the map `key` of `parent` with the keys `known`; NULL and a fault on
   failure. */
static const yaml_node_t *get_map(reader *r, const yaml_node_t *parent,
                                  const char *key, const char *const *known) {
  const yaml_node_t *node = look_up(r, parent, key);
  if (node && node->type == YAML_MAPPING_NODE) {
    check_keys(r, node, known);
    return node;
  }
  wrong(r, node ? &node->start_mark : &parent->start_mark,
        node ? "'%s' needs a map" : "missing '%s'", key);
  return NULL;
}

/* Return whether a value exists and is a text; `wanted` and `rest` form the
   noun for the fault. */
static gboolean is_text(reader *r, const yaml_node_t *node, const char *key,
                        const char *wanted, const char *rest) {
  if (node->type != YAML_SCALAR_NODE)
    return wrong(r, &node->start_mark, "'%s' requires %s%s, found %s", key,
                 wanted, rest, noun(node));
  if (*text_of(node) || node->data.scalar.style != YAML_PLAIN_SCALAR_STYLE)
    return TRUE;
  return wrong(r, &node->start_mark, "'%s' has no value", key);
}

/* ---- numbers ---- */

typedef struct unit {
  const char *name, *noun;
  int exponent; /* power of ten relative to the stored unit */
} unit;

static const char length[] = "a length", voltage[] = "a voltage",
                  current[] = "a current", temperature[] = "a temperature",
                  capacitance[] = "a capacitance";

static const unit units[] = {{"nm", length, 0},        {"um", length, 3},
                             {"\xC2\xB5m", length, 3}, /* micro sign */
                             {"\xCE\xBCm", length, 3}, /* Greek mu */
                             {"pm", length, -3},       {"angstrom", length, -1},
                             {"mm", length, 6},        {"m", length, 9},
                             {"V", voltage, 0},        {"mV", voltage, -3},
                             {"A", current, 0},        {"mA", current, -3},
                             {"uA", current, -6},      {"nA", current, -9},
                             {"pA", current, -12},     {"C", temperature, 0},
                             {"K", temperature, 0},    {"F", capacitance, 0},
                             {"pF", capacitance, -12}, {"fF", capacitance, -15},
                             {"aF", capacitance, -18}};

static const unit *find_unit(const char *name) {
  for (size_t i = 0; i < G_N_ELEMENTS(units); i++)
    if (!strcmp(units[i].name, name)) return &units[i];
  return NULL;
}

/* Return the unit of a text, of the dimension of `wanted`; NULL and a fault on
   failure. */
static const unit *check_unit(reader *r, const yaml_mark_t *at, const char *key,
                              const char *text, const char *number,
                              const char *name, const unit *wanted) {
  const unit *found = find_unit(name);
  if (found && found->noun == wanted->noun) return found;
  if (!*name) {
    wrong(r, at, "'%s' requires %s with a unit, e.g. '%s %s'", key,
          wanted->noun, number, wanted->name);
  } else if (found) {
    wrong(r, at, "'%s' requires %s, found '%s'", key, wanted->noun, text);
  } else {
    const char *names[G_N_ELEMENTS(units) + 1] = {NULL};
    for (size_t i = 0; i < G_N_ELEMENTS(units); i++) names[i] = units[i].name;
    g_autofree char *hint = similar_word(name, names);
    wrong(r, at, "unknown unit '%s' in '%s'%s", name, text, hint);
  }
  return NULL;
}

/* Read a number with its own unit, or with the unit `given` for a column, and
   convert to the unit named `in`. Powers of ten are applied before rounding. */
static gboolean read_number(reader *r, const yaml_node_t *node, const char *key,
                            const char *given, const char *in,
                            gboolean positive, double *out) {
  const unit *wanted = find_unit(in);
  const yaml_mark_t *at = &node->start_mark;
  if (!is_text(r, node, key, wanted->noun, " with a unit")) return FALSE;
  g_autofree char *text =
      g_strjoin(given ? " " : NULL, text_of(node), given, NULL);
  g_autoptr(GMatchInfo) match = NULL;
  if (!g_regex_match(r->number, text, 0, &match))
    return wrong(r, at, "'%s' requires %s with a unit, found '%s'", key,
                 wanted->noun, text);
  g_autofree char *number = g_match_info_fetch(match, 1);
  g_autofree char *digits = g_match_info_fetch(match, 2);
  g_autofree char *exponent = g_match_info_fetch(match, 3);
  g_autofree char *name = g_match_info_fetch(match, 4);
  const unit *from = check_unit(r, at, key, text, number, name, wanted);
  if (!from) return FALSE;
  long power =
      from->exponent + CLAMP(strtol(exponent, NULL, 10), -1000000, 1000000);
  g_autofree char *whole = g_strdup_printf("%se%ld", digits, power);
  *out = g_ascii_strtod(whole, NULL);
  if (!isfinite(*out))
    return wrong(r, at, "'%s' is too large: '%s'", key, text);
  if (positive && !(*out > 0))
    return wrong(r, at, "'%s' must be above 0 %s, found '%s'", key, in, text);
  return TRUE;
}

/* Read the items of a list, each above 0, to *out, and advance *out. */
static gboolean read_items(reader *r, const yaml_node_t *list, const char *key,
                           const char *given, const char *in, double **out) {
  const yaml_node_item_t *item = list->data.sequence.items.start;
  gboolean good = TRUE;
  for (; item < list->data.sequence.items.top; item++)
    good &= read_number(r, node_of(r, *item), key, given, in, TRUE, (*out)++);
  return good;
}

static size_t items(const yaml_node_t *list) {
  return (size_t)(list->data.sequence.items.top -
                  list->data.sequence.items.start);
}

static gboolean is_list(const yaml_node_t *node) {
  return node && node->type == YAML_SEQUENCE_NODE;
}

/* Return the list of values of `{ unit: nm, values: [...] }` and its unit; NULL
   and a fault on failure. */
static const yaml_node_t *get_list(reader *r, const yaml_node_t *parent,
                                   const char *key, const char *in,
                                   const char **given) {
  static const char *const known[] = {"unit", "values", NULL};
  const yaml_node_t *map = get_map(r, parent, key, known);
  if (!map) return NULL;
  const yaml_node_t *of = look_up(r, map, "unit");
  const yaml_node_t *list = look_up(r, map, "values");
  if (of && of->type == YAML_SCALAR_NODE && is_list(list)) {
    *given = text_of(of);
    return list;
  }
  wrong(r, &map->start_mark, "'%s' must be '{ unit: %s, values: [...] }'", key,
        in);
  return NULL;
}

/* Return the values of a column in the unit `in`, each above 0; NULL and a
   fault on failure. The unit of the column is appended to each number before
   parsing. */
static double *get_column(reader *r, const yaml_node_t *parent, const char *key,
                          const char *in, size_t *count) {
  const char *given;
  const yaml_node_t *list = get_list(r, parent, key, in, &given);
  if (!list) return NULL;
  *count = items(list);
  double *column = eda_alloc(*count, sizeof *column), *to = column;
  if (read_items(r, list, key, given, in, &to)) return column;
  free(column);
  return NULL;
}

/* Return the values of a list of rows, each with `columns` numbers. */
static double *get_rows(reader *r, const yaml_node_t *parent, const char *key,
                        const char *in, size_t rows, size_t columns) {
  const char *given;
  const yaml_node_t *list = get_list(r, parent, key, in, &given);
  if (!list) return NULL;
  if (items(list) != rows) {
    wrong(r, &list->start_mark,
          "'%s' has %zu lists, expected %zu as in 'width'", key, items(list),
          rows);
    return NULL;
  }
  double *all = eda_alloc(rows * columns, sizeof *all), *to = all;
  gboolean good = TRUE;
  for (size_t i = 0; i < rows && good; i++) {
    const yaml_node_t *row = node_of(r, list->data.sequence.items.start[i]);
    if (!is_list(row) || items(row) != columns)
      good = wrong(r, &row->start_mark,
                   "'%s' must be a list of %zu values for each width", key,
                   columns);
    else
      good = read_items(r, row, key, given, in, &to);
  }
  if (good) return all;
  free(all);
  return NULL;
}

/* ---- the table ---- */

/* Check that the values of a column rise; `what` names them in the fault. */
static void check_rise(reader *r, const yaml_node_t *root, const char *key,
                       const char *what, const double *x, size_t n) {
  const yaml_node_t *list = look_up(r, look_up(r, root, key), "values");
  for (size_t i = 1; i < n; i++) {
    const yaml_node_t *item = node_of(r, list->data.sequence.items.start[i]);
    if (x[i] <= x[i - 1])
      wrong(r, &item->start_mark, "%s must increase: '%s'", what,
            text_of(item));
  }
}

static void read_lengths(reader *r, const yaml_node_t *root) {
  eda_devices *d = r->devices;
  double *lengths = get_column(r, root, "length", "nm", &d->count);
  if (!lengths) return;
  const yaml_node_t *list = look_up(r, look_up(r, root, "length"), "values");
  if (d->count < 2)
    wrong(r, &list->start_mark, "'length' must have at least two values");
  check_rise(r, root, "length", "lengths", lengths, d->count);
  d->length = lengths;
}

/* Read the widths; the last one is the wide one. */
static void read_widths(reader *r, const yaml_node_t *root) {
  eda_devices *d = r->devices;
  const yaml_node_t *node = look_up(r, root, "width");
  size_t count = 0;
  if (!node) wrong(r, &root->start_mark, "missing 'width'");
  if (!node) return;
  if (node->type != YAML_MAPPING_NODE) {
    read_number(r, node, "width", NULL, "nm", TRUE, &d->width);
    return;
  }
  double *widths = get_column(r, root, "width", "nm", &count);
  if (!widths) return;
  if (count < 2)
    wrong(r, &node->start_mark,
          "a list of widths must have at least two values");
  check_rise(r, root, "width", "widths", widths, count);
  if (count) d->width = widths[count - 1];
  d->narrow = count > 1 ? count - 1 : 0;
  d->narrow_width = widths;
}

/* Return a quantity of one type, in the unit `in`, at all lengths. */
static double *read_row(reader *r, const yaml_node_t *map, const char *key,
                        const char *in) {
  const eda_devices *d = r->devices;
  size_t count = 0;
  double *row = get_column(r, map, key, in, &count);
  if (row && d->length && count != d->count)
    wrong(r, &look_up(r, map, key)->start_mark,
          "'%s' has %zu values, expected %zu as in 'length'", key, count,
          d->count);
  for (size_t j = 0; row && d->width > 0 && j < count; j++) row[j] /= d->width;
  return row;
}

/* Return a quantity at all lengths for the wide width, and write those of the
   narrow widths. */
static double *read_rows(reader *r, const yaml_node_t *map, const char *key,
                         const char *in, double **narrow) {
  const eda_devices *d = r->devices;
  if (!d->length) return NULL; /* already reported */
  double *all = get_rows(r, map, key, in, d->narrow + 1, d->count);
  if (!all) return NULL;
  double *wide = eda_alloc(d->count, sizeof *wide);
  for (size_t i = 0; i < d->narrow * d->count; i++)
    all[i] /= d->narrow_width[i / d->count];
  for (size_t i = 0; i < d->count; i++)
    wide[i] = all[d->narrow * d->count + i] / d->width;
  *narrow = all;
  return wide;
}

/* Read all quantities of one type, per width. */
static void read_type(reader *r, const yaml_node_t *root, const char *key,
                      int type) {
  static const char *const known[] = {"ion", "ioff", "cgate", NULL};
  eda_devices *d = r->devices;
  double **wide[] = {&d->ion[type], &d->ioff[type], &d->cgate[type]};
  double **narrow[] = {&d->narrow_ion[type], &d->narrow_ioff[type],
                       &d->narrow_cgate[type]};
  const yaml_node_t *map = get_map(r, root, key, known);
  for (int i = 0; map && i < 3; i++) {
    const char *in = i < 2 ? "A" : "F";
    if (i == 2 && !look_up(r, map, known[i])) continue; /* optional */
    *wide[i] = d->narrow ? read_rows(r, map, known[i], in, narrow[i])
                         : read_row(r, map, known[i], in);
  }
}

/* Check for exchanged columns: the off-current is less than the on-current,
   except for much too short lengths. */
static void check_currents(reader *r, const yaml_node_t *root, const char *key,
                           int type) {
  const eda_devices *d = r->devices;
  if (r->faults || d->ioff[type][d->count - 1] < d->ion[type][d->count - 1])
    return;
  const yaml_node_t *ioff = look_up(r, look_up(r, root, key), "ioff");
  const yaml_node_t *last = look_up(r, ioff, "values");
  while (is_list(last)) last = node_of(r, last->data.sequence.items.top[-1]);
  wrong(r, &last->start_mark, "'ioff' at %g nm is not below 'ion'",
        d->length[d->count - 1]);
}

static void read_version(reader *r, const yaml_node_t *node, const char *key) {
  if (!is_text(r, node, key, "a whole number", "")) return;
  const char *text = text_of(node), *digits = text + (*text == '-');
  if (!*digits || strspn(digits, "0123456789") != strlen(digits))
    wrong(r, &node->start_mark, "'%s' must be a whole number, found '%s'", key,
          text);
  else if (strtoll(text, NULL, 10) != 1)
    wrong(r, &node->start_mark, "'%s' must be at %s 1, found '%s'", key,
          strtoll(text, NULL, 10) < 1 ? "least" : "most", text);
}

/* Check that tables after the first one name their flavour. */
static void check_flavour(reader *r, const yaml_node_t *root) {
  const eda_devices *d = r->devices, *other = r->first;
  const yaml_node_t *node = look_up(r, root, "flavour");
  if (!node && d != other)
    wrong(r, &root->start_mark,
          "'flavour' is missing, required for all tables after the first");
  if (!node || !d->flavour) return;
  if (d == other)
    wrong(r, &node->start_mark, "the first table must not have a 'flavour'");
  for (; other != d; other = other->next)
    if (other->flavour && !strcmp(other->flavour, d->flavour))
      wrong(r, &node->start_mark, "a second table of flavour '%s'", d->flavour);
}

/* Read everything except columns. */
static void read_head(reader *r, const yaml_node_t *root) {
  eda_devices *d = r->devices;
  double ignored;
  const struct {
    const char *key;
    char **text; /* receives a text; NULL: none */
    const char *unit;
    double *number; /* or receives a number in this unit */
    gboolean optional;
  } entries[] = {
      {"name", .text = &d->name},
      {"flavour", .text = &d->flavour, .optional = 1},
      {"supply", .unit = "V", .number = &d->supply},
      {"temperature", .unit = "C", .number = &ignored, .optional = 1},
      {"source", .optional = 1},
      {"extended", .optional = 1},
      {"ion", .optional = 1},
      {"ioff", .optional = 1},
      {"cgate", .optional = 1}};
  for (size_t i = 0; i < G_N_ELEMENTS(entries); i++) {
    const char *key = entries[i].key, *in = entries[i].unit;
    const yaml_node_t *node = look_up(r, root, key);
    if (!node && !entries[i].optional)
      wrong(r, &root->start_mark, "missing '%s'", key);
    if (!node) continue;
    if (in)
      read_number(r, node, key, NULL, in, !entries[i].optional,
                  entries[i].number);
    else if (is_text(r, node, key, "a text", "") && entries[i].text)
      *entries[i].text = g_strdup(text_of(node));
  }
}

static void read_table(reader *r, const yaml_node_t *root) {
  static const char *const known[] = {
      "opcflow-devices", "name",     "flavour", "source", "supply",
      "temperature",     "width",    "length",  "ion",    "ioff",
      "cgate",           "extended", "nmos",    "pmos",   NULL};
  if (root->type != YAML_MAPPING_NODE) {
    wrong(r, &root->start_mark, "a device table must be a map, found %s",
          noun(root));
    return;
  }
  check_keys(r, root, known);
  const yaml_node_t *version = look_up(r, root, known[0]);
  if (version)
    read_version(r, version, known[0]);
  else
    wrong(r, &root->start_mark, "missing '%s'", known[0]);
  read_head(r, root);
  check_flavour(r, root);
  read_widths(r, root);
  read_lengths(r, root);
  read_type(r, root, "nmos", EDA_NMOS);
  read_type(r, root, "pmos", EDA_PMOS);
  check_currents(r, root, "nmos", EDA_NMOS);
  check_currents(r, root, "pmos", EDA_PMOS);
  if (!r->faults &&
      !r->devices->cgate[EDA_NMOS] != !r->devices->cgate[EDA_PMOS])
    wrong(r, &root->start_mark, "only one type has 'cgate'");
}

/* ---- the file ---- */

/* Return where the parser stopped. For invalid bytes the parser knows the
   offset, but no line. */
static yaml_mark_t parser_place(const yaml_parser_t *parser, const char *text) {
  yaml_mark_t at = parser->problem_mark;
  if (parser->error != YAML_READER_ERROR) return at;
  at = (yaml_mark_t){0};
  for (size_t i = 0; i < parser->problem_offset; i++) {
    at.column = text[i] == '\n' ? 0 : at.column + 1;
    at.line += text[i] == '\n';
  }
  return at;
}

/* Read the next document of the file. Return TRUE and its root, or NULL at the
   end. */
static gboolean next_document(reader *r, yaml_parser_t *parser,
                              const char *text, const yaml_node_t **root) {
  if (yaml_parser_load(parser, &r->document)) {
    *root = yaml_document_get_root_node(&r->document);
    return TRUE;
  }
  yaml_mark_t at = parser_place(parser, text);
  return wrong(r, &at, "not YAML: %s%s%s", parser->problem,
               parser->context ? " " : "",
               parser->context ? parser->context : "");
}

static void read_text(reader *r, const char *text, size_t n) {
  yaml_parser_t parser;
  const yaml_node_t *root = NULL;
  yaml_parser_initialize(&parser);
  yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
  yaml_parser_set_input_string(&parser, (const unsigned char *)text, n);
  for (eda_devices **to = &r->first; next_document(r, &parser, text, &root);
       to = &(*to)->next) {
    if (!root) break;
    r->devices = *to = eda_alloc(1, sizeof **to);
    read_table(r, root);
    yaml_document_delete(&r->document);
  }
  yaml_document_delete(&r->document);
  if (!r->first && !r->faults) wrong(r, &(yaml_mark_t){0}, "the file is empty");
  yaml_parser_delete(&parser);
}

static char *read_file(const char *path, size_t *n, opc_error *error) {
  g_autoptr(GError) failure = NULL;
  char *text = NULL;
  struct stat about = {0};
  if (!stat(path, &about) && !S_ISREG(about.st_mode))
    opc_fail(error, OPC_IO, NULL, "'%s': is not a regular file", path);
  else if (about.st_size > LARGEST_FILE)
    opc_fail(error, OPC_INVALID, NULL, "'%s': larger than %d bytes", path,
             LARGEST_FILE);
  else if (!g_file_get_contents(path, &text, n, &failure))
    opc_fail(error, OPC_IO, NULL, "'%s': %s", path,
             g_error_matches(failure, G_FILE_ERROR, G_FILE_ERROR_NOENT)
                 ? "no such file"
                 : failure->message);
  return text;
}

eda_devices *eda_devices_read(const char *path, opc_error *error) {
  size_t n;
  g_autofree char *text = read_file(path, &n, error);
  if (!text) return NULL;
  reader r = {0};
  r.number = g_regex_new(
      "^(([+-]?(?:[0-9]+\\.?[0-9]*|\\.[0-9]+))(?:[eE]([+-]?[0-9]+))?) *(.*)$",
      G_REGEX_DOTALL | G_REGEX_RAW, 0, NULL);
  read_text(&r, text, n);
  int code = end_read(&r, path, error);
  g_regex_unref(r.number);
  g_free(r.fault);
  if (!code) return r.first;
  eda_devices_free(r.first);
  return NULL;
}

static void free_table(eda_devices *d) {
  for (int type = 0; type < 2; type++) {
    free(d->ion[type]);
    free(d->ioff[type]);
    free(d->narrow_ion[type]);
    free(d->narrow_ioff[type]);
    free(d->cgate[type]);
    free(d->narrow_cgate[type]);
  }
  free(d->narrow_width);
  free(d->length);
  free(d->name);
  free(d->flavour);
  free(d);
}

void eda_devices_free(eda_devices *d) {
  while (d) {
    eda_devices *next = d->next;
    free_table(d);
    d = next;
  }
}
