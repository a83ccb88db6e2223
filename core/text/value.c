/* SPDX-License-Identifier: BSD-3-Clause */
/* One converter for each type of parameter: it checks the text against the
   declaration, tells what is wrong with its place, and gives the value. */
#include "core/text/value.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/text/unit.h"
#include "core/text/suggest.h"

/* What every converter needs. */
typedef struct conversion {
  const opc_parameter *parameter;
  gboolean check_files;
  GPtrArray *owned;
  opc_problems *problems;
} conversion;

#define WRONG(c, node, ...) \
  (opc_problem_add((c)->problems, OPC_INVALID, &(node)->at, __VA_ARGS__), FALSE)

static void *own(const conversion *c, void *memory) {
  g_ptr_array_add(c->owned, memory);
  return memory;
}

/* ---- types ---- */

/* What a declaration calls a type, and the field that gets its value. */
static const struct {
  const char *name;
  size_t width;
} types[] = {
    [OPC_BOOL] = {"bool", sizeof(int)},
    [OPC_INT] = {"int", sizeof(int64_t)},
    [OPC_REAL] = {"real", sizeof(double)},
    [OPC_TEXT] = {"text", sizeof(char *)},
    [OPC_CHOICE] = {"choice", sizeof(int)},
    [OPC_FILE] = {"file", sizeof(char *)},
    [OPC_OUTPUT] = {"output", sizeof(char *)},
    [OPC_REALS] = {"reals", sizeof(opc_reals)},
    [OPC_MAP] = {"map", sizeof(opc_map)},
    [OPC_INPUT] = {"input", sizeof(void *)},
    [OPC_SLOT] = {"slot", sizeof(opc_module *)},
};

const char *opc_type_name(uint32_t type) {
  return type < G_N_ELEMENTS(types) ? types[type].name : NULL;
}

size_t opc_value_width(uint32_t type) {
  return type < G_N_ELEMENTS(types) ? types[type].width : 0;
}

char **opc_choice_list(const char *choices) {
  return g_strsplit(choices ? choices : "", "|", -1);
}

/* ---- words for messages ---- */

char *opc_value_noun(const opc_parameter *p) {
  const opc_unit *unit = p->unit ? opc_unit_find(p->unit) : NULL;
  switch (p->type) {
    case OPC_BOOL:
      return g_strdup("'true' or 'false'");
    case OPC_INT:
      return g_strdup("a whole number");
    case OPC_REAL:
      return unit ? g_strdup_printf("%s with its unit", opc_unit_noun(unit))
                  : g_strdup("a number");
    case OPC_CHOICE: {
      g_auto(GStrv) words = opc_choice_list(p->choices);
      g_autofree char *list = g_strjoinv("', '", words);
      return g_strdup_printf("one of '%s'", list);
    }
    case OPC_FILE:
    case OPC_OUTPUT:
      return g_strdup("a file name");
    case OPC_REALS:
      return g_strdup("a list of numbers");
    case OPC_MAP:
      return g_strdup("a map");
    case OPC_INPUT:
      return g_strdup("a reference such as '${step}'");
    case OPC_SLOT:
      return g_strdup_printf("a plugin, as '{ use: %s.NAME }'", p->choices);
    default:
      return g_strdup("a text");
  }
}

char *opc_number_text(double number) {
  char buffer[40];
  for (int digits = 15; digits <= 17; digits++) {
    char format[8];
    g_snprintf(format, sizeof format, "%%.%dg", digits);
    g_ascii_formatd(buffer, sizeof buffer, format, number);
    if (g_ascii_strtod(buffer, NULL) == number) break;
  }
  return g_strdup(buffer);
}

static char *with_unit(const opc_parameter *p, double number) {
  g_autofree char *text = opc_number_text(number);
  return p->unit ? g_strdup_printf("%s %s", text, p->unit) : g_strdup(text);
}

char *opc_bounds_text(const opc_parameter *p) {
  g_autofree char *low = with_unit(p, p->min), *high = with_unit(p, p->max);
  GString *text = g_string_new(NULL);
  if (p->flags & OPC_AT_LEAST) g_string_append_printf(text, ">= %s", low);
  if (p->flags & OPC_ABOVE) g_string_append_printf(text, "> %s", low);
  if (text->len && p->flags & (OPC_AT_MOST | OPC_BELOW))
    g_string_append(text, ", ");
  if (p->flags & OPC_AT_MOST) g_string_append_printf(text, "<= %s", high);
  if (p->flags & OPC_BELOW) g_string_append_printf(text, "< %s", high);
  return g_string_free(text, FALSE);
}

/* ---- numbers ---- */

static gboolean check_bounds(const conversion *c, const opc_node *node,
                             double value) {
  const opc_parameter *p = c->parameter;
  const char *rule = NULL;
  double bound = p->min;
  if (p->flags & OPC_AT_LEAST && !(value >= p->min)) rule = "at least";
  if (p->flags & OPC_ABOVE && !(value > p->min)) rule = "above";
  if (!rule) bound = p->max;
  if (p->flags & OPC_AT_MOST && !(value <= p->max)) rule = "at most";
  if (p->flags & OPC_BELOW && !(value < p->max)) rule = "below";
  if (!rule) return TRUE;
  g_autofree char *limit = with_unit(p, bound);
  return WRONG(c, node, "'%s' must be %s %s, not '%s'", p->name, rule, limit,
               node->text);
}

static gboolean need_text(const conversion *c, const opc_node *node) {
  const opc_parameter *p = c->parameter;
  if (opc_node_is_empty(node))
    return WRONG(c, node, "'%s' has no value", p->name);
  if (node->type == OPC_NODE_TEXT) return TRUE;
  g_autofree char *noun = opc_value_noun(p);
  return WRONG(c, node, "'%s' needs %s, not %s", p->name, noun,
               opc_node_noun(node));
}

static gboolean unknown_unit(const conversion *c, const opc_node *node,
                             const char *name) {
  g_autoptr(GPtrArray) names = opc_unit_names();
  g_autofree char *suggestion = opc_suggestion(name, names);
  return WRONG(c, node, "unknown unit '%s' in '%s'%s", name, node->text,
               suggestion);
}

/* The unit behind the number against the declared one. */
static gboolean check_unit(const conversion *c, const opc_node *node,
                           size_t length, const char *name,
                           const opc_unit **from, const opc_unit **to) {
  const opc_parameter *p = c->parameter;
  *to = p->unit ? opc_unit_find(p->unit) : NULL;
  *from = *name ? opc_unit_find(name) : NULL;
  if (!*to && *name)
    return WRONG(c, node, "'%s' takes a plain number, not '%s'", p->name,
                 node->text);
  if (!*to) return TRUE;
  if (!*name)
    return WRONG(c, node, "'%s' needs %s with its unit, e.g. '%.*s %s'",
                 p->name, opc_unit_noun(*to), (int)length, node->text, p->unit);
  if (!*from) return unknown_unit(c, node, name);
  if (opc_unit_noun(*from) != opc_unit_noun(*to))
    return WRONG(c, node, "'%s' needs %s, not '%s'", p->name,
                 opc_unit_noun(*to), node->text);
  return TRUE;
}

static gboolean read_real(const conversion *c, const opc_node *node,
                          double *real) {
  if (!need_text(c, node)) return FALSE;
  const opc_parameter *p = c->parameter;
  size_t length = opc_number_length(node->text);
  if (!length) {
    const opc_unit *unit = p->unit ? opc_unit_find(p->unit) : NULL;
    return WRONG(c, node, "'%s' needs %s%s, not '%s'", p->name,
                 unit ? opc_unit_noun(unit) : "a number",
                 unit ? " with its unit" : "", node->text);
  }
  const char *name = node->text + length;
  while (*name == ' ') name++;
  const opc_unit *from, *to;
  if (!check_unit(c, node, length, name, &from, &to)) return FALSE;
  *real = opc_number_in(node->text, length, from, to);
  if (!isfinite(*real))
    return WRONG(c, node, "'%s' is too large: '%s'", p->name, node->text);
  return check_bounds(c, node, *real);
}

static gboolean read_int(const conversion *c, const opc_node *node,
                         int64_t *integer) {
  if (!need_text(c, node)) return FALSE;
  const char *text = node->text, *digits = text + (*text == '-');
  if (!*digits || strspn(digits, "0123456789") != strlen(digits))
    return WRONG(c, node, "'%s' needs a whole number, not '%s'",
                 c->parameter->name, text);
  errno = 0;
  *integer = g_ascii_strtoll(text, NULL, 10);
  if (errno)
    return WRONG(c, node, "'%s' is too large: '%s'", c->parameter->name, text);
  return check_bounds(c, node, (double)*integer);
}

static gboolean read_bool(const conversion *c, const opc_node *node,
                          int64_t *integer) {
  if (!need_text(c, node)) return FALSE;
  *integer = !strcmp(node->text, "true");
  if (*integer || !strcmp(node->text, "false")) return TRUE;
  return WRONG(c, node, "'%s' is 'true' or 'false', not '%s'",
               c->parameter->name, node->text);
}

static gboolean read_reals(const conversion *c, const opc_node *node,
                           opc_value *value) {
  const opc_parameter *p = c->parameter;
  if (node->type != OPC_NODE_LIST)
    return WRONG(c, node, "'%s' needs a list, as '[%s, ...]'", p->name,
                 p->unit ? "1 nm" : "1");
  guint n = node->items->len;
  double *reals = own(c, g_new0(double, MAX(n, 1)));
  gboolean good = TRUE;
  for (guint i = 0; i < n; i++)
    good &= read_real(c, node->items->pdata[i], &reals[i]);
  value->reals = (opc_reals){reals, n};
  return good;
}

/* ---- words ---- */

static gboolean read_choice(const conversion *c, const opc_node *node,
                            opc_value *value) {
  if (!need_text(c, node)) return FALSE;
  const opc_parameter *p = c->parameter;
  g_auto(GStrv) words = opc_choice_list(p->choices);
  g_autoptr(GPtrArray) list = g_ptr_array_new();
  for (guint i = 0; words[i]; i++) {
    if (!strcmp(words[i], node->text)) {
      value->integer = i;
      value->text = own(c, g_strdup(node->text));
      return TRUE;
    }
    g_ptr_array_add(list, words[i]);
  }
  const char *nearest = opc_nearest(node->text, list);
  if (nearest)
    return WRONG(c, node, "'%s' cannot be '%s', did you mean '%s'?", p->name,
                 node->text, nearest);
  g_autofree char *noun = opc_value_noun(p);
  return WRONG(c, node, "'%s' is %s, not '%s'", p->name, noun, node->text);
}

static gboolean check_key(const conversion *c, const opc_node *key) {
  if (!c->parameter->choices) return TRUE;
  g_auto(GStrv) words = opc_choice_list(c->parameter->choices);
  if (g_strv_contains((const char *const *)words, key->text)) return TRUE;
  g_autoptr(GPtrArray) list = g_ptr_array_new();
  for (guint i = 0; words[i]; i++) g_ptr_array_add(list, words[i]);
  g_autofree char *suggestion = opc_suggestion(key->text, list);
  return WRONG(c, key, "unknown key '%s' in '%s'%s", key->text,
               c->parameter->name, suggestion);
}

static gboolean read_map(const conversion *c, const opc_node *node,
                         opc_value *value) {
  const opc_parameter *p = c->parameter;
  if (node->type != OPC_NODE_MAP)
    return WRONG(c, node, "'%s' needs a map, as '{ key: value }'", p->name);
  guint n = node->items->len;
  opc_pair *pairs = own(c, g_new0(opc_pair, MAX(n, 1)));
  gboolean good = TRUE;
  for (guint i = 0; i < n; i++) {
    const opc_node *key = node->keys->pdata[i], *item = node->items->pdata[i];
    good &= check_key(c, key);
    gboolean any = (p->flags & OPC_MAP_OF_ANY) != 0;
    if ((item->type != OPC_NODE_TEXT && !any) || opc_node_is_empty(item)) {
      good = WRONG(c, item, "'%s' of '%s' needs a %s", key->text, p->name,
                   any ? "value" : "text");
      continue;
    }
    pairs[i].key = own(c, g_strdup(key->text));
    pairs[i].value = own(c, item->type == OPC_NODE_TEXT ? g_strdup(item->text)
                                                        : opc_node_line(item));
  }
  value->map = (opc_map){pairs, n};
  return good;
}

/* ---- files and references ---- */

gboolean opc_name_is_inside(const char *name) {
  if (!*name || *name == '/') return FALSE;
  g_auto(GStrv) parts = g_strsplit(name, "/", -1);
  for (guint i = 0; parts[i]; i++)
    if (!*parts[i] || !strcmp(parts[i], ".") || !strcmp(parts[i], ".."))
      return FALSE;
  return TRUE;
}

static gboolean read_file(const conversion *c, const opc_node *node,
                          opc_value *value) {
  if (!need_text(c, node)) return FALSE;
  const char *folder = node->source->folder;
  char *path = g_path_is_absolute(node->text) || !folder || !*folder
                   ? g_strdup(node->text)
                   : g_build_filename(folder, node->text, NULL);
  value->text = own(c, path);
  if (!c->check_files) return TRUE;
  struct stat about;
  const char *why = NULL;
  if (stat(path, &about))
    why = errno == ENOENT ? "no such file" : g_strerror(errno);
  else if (S_ISDIR(about.st_mode))
    why = "is a folder";
  else if (access(path, R_OK))
    why = g_strerror(errno);
  if (!why) return TRUE;
  opc_problem_add(c->problems, OPC_IO, &node->at, "'%s': %s", path, why);
  return FALSE;
}

static gboolean read_output(const conversion *c, const opc_node *node,
                            opc_value *value) {
  if (!need_text(c, node)) return FALSE;
  value->text = own(c, g_strdup(node->text));
  if (opc_name_is_inside(node->text)) return TRUE;
  return WRONG(c, node, "'%s' must name a file inside the run folder, not '%s'",
               c->parameter->name, node->text);
}

static gboolean read_input(const conversion *c, const opc_node *node,
                           opc_value *value) {
  if (!need_text(c, node)) return FALSE;
  const char *text = node->text;
  size_t n = strlen(text);
  if (n < 4 || strncmp(text, "${", 2) || text[n - 1] != '}')
    return WRONG(c, node, "'%s' needs a reference to a step, as '${%s}'",
                 c->parameter->name, *text ? text : "step");
  value->text = own(c, g_strndup(text + 2, n - 3));
  return TRUE;
}

/* ---- all types ---- */

gboolean opc_value_convert(const opc_parameter *parameter, const opc_node *node,
                           gboolean check_files, GPtrArray *owned,
                           opc_problems *problems, opc_value *value) {
  const conversion c = {parameter, check_files, owned, problems};
  value->present = TRUE;
  switch (parameter->type) {
    case OPC_BOOL:
      return read_bool(&c, node, &value->integer);
    case OPC_INT:
      return read_int(&c, node, &value->integer);
    case OPC_REAL:
      return read_real(&c, node, &value->real);
    case OPC_TEXT:
      if (!need_text(&c, node)) return FALSE;
      value->text = own(&c, g_strdup(node->text));
      return TRUE;
    case OPC_CHOICE:
      return read_choice(&c, node, value);
    case OPC_FILE:
      return read_file(&c, node, value);
    case OPC_OUTPUT:
      return read_output(&c, node, value);
    case OPC_REALS:
      return read_reals(&c, node, value);
    case OPC_MAP:
      return read_map(&c, node, value);
    case OPC_INPUT:
      return read_input(&c, node, value);
    default:
      return FALSE;
  }
}

opc_node *opc_preset_parse(const opc_parameter *parameter,
                           const opc_source *source, opc_problems *problems) {
  const char *text = parameter->preset;
  switch (parameter->type) {
    case OPC_REALS:
    case OPC_MAP:
    case OPC_SLOT:
      return opc_node_parse(source, text, strlen(text), problems);
    default: {
      opc_node *node = opc_node_text_new(source, text);
      /* An empty preset is an empty text, not a missing value. */
      node->plain = FALSE;
      return node;
    }
  }
}

/* ---- into the instance ---- */

void opc_value_store(const opc_parameter *parameter, const opc_value *value,
                     void *instance) {
  char *field = (char *)instance + parameter->offset;
  gboolean is = value->present;
  switch (parameter->type) {
    case OPC_BOOL:
    case OPC_CHOICE:
      *(int *)field = is ? (int)value->integer : -1;
      break;
    case OPC_INT:
      *(int64_t *)field = is ? value->integer : OPC_NO_INT;
      break;
    case OPC_REAL:
      *(double *)field = is ? value->real : NAN;
      break;
    case OPC_REALS:
      *(opc_reals *)field = value->reals;
      break;
    case OPC_MAP:
      *(opc_map *)field = value->map;
      break;
    case OPC_INPUT:
    case OPC_SLOT:
      *(const void **)field = value->object;
      break;
    default:
      *(const char **)field = is ? value->text : NULL;
  }
  if (parameter->given)
    *(int *)((char *)instance + parameter->given) = value->given;
}
