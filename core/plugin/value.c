/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the converters of parameter values, one for each type: each checks
   the text against the declaration, reports problems with their place, and
   returns the value. */
#include "core/plugin/value.h"

#include <base/file.h>
#include <base/range.h>
#include <base/suggest.h>
#include <base/unit.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Arguments of every converter. */
typedef struct conversion {
  const opc_parameter *parameter;
  gboolean check_files;
  GPtrArray *owned;
  opc_problems *problems;
} conversion;

#define WRONG(c, node, ...) opc_wrong((c)->problems, node, __VA_ARGS__)

static void *conversion_own(const conversion *c, void *memory) {
  g_ptr_array_add(c->owned, memory);
  return memory;
}

typedef gboolean converter(const conversion *c, const opc_node *node,
                           opc_setting *value);
static converter read_bool, read_int, read_real, read_text, read_choice,
    read_file, read_output, read_reals, read_map, read_input;

/* ---- types ---- */

/* For each type: its name in declarations, the noun for its values in messages,
   the width of its field in bytes, and the value of a missing parameter. */
static const struct {
  const char *name, *noun;
  size_t width;
  opc_field absent;
  converter *read;
} types[] = {
    [OPC_BOOL] =
        {"bool", "'true' or 'false'", sizeof(int), {.flag = -1}, read_bool},
    [OPC_INT] = {"int",
                 "a whole number",
                 sizeof(int64_t),
                 {.integer = OPC_NO_INT},
                 read_int},
    [OPC_REAL] = {"real", "a number", sizeof(double), {.real = NAN}, read_real},
    [OPC_TEXT] = {"text", "a text", sizeof(char *), {0}, read_text},
    [OPC_CHOICE] = {"choice", NULL, sizeof(int), {.flag = -1}, read_choice},
    [OPC_FILE] = {"file", "a file name", sizeof(char *), {0}, read_file},
    [OPC_OUTPUT] = {"output", "a file name", sizeof(char *), {0}, read_output},
    [OPC_REALS] =
        {"reals", "a list of numbers", sizeof(opc_reals), {0}, read_reals},
    [OPC_MAP] = {"map", "a map", sizeof(opc_map), {0}, read_map},
    [OPC_INPUT] = {"input",
                   "a reference as in '${step}'",
                   sizeof(void *),
                   {0},
                   read_input},
    [OPC_SLOT] = {"slot", NULL, sizeof(opc_module *), {0}, NULL},
};

const char *opc_type_name(uint32_t type) {
  return type < G_N_ELEMENTS(types) ? types[type].name : NULL;
}

size_t opc_setting_width(uint32_t type) {
  return type < G_N_ELEMENTS(types) ? types[type].width : 0;
}

opc_setting opc_setting_absent(const opc_parameter *p) {
  return (opc_setting){.field = types[p->type].absent};
}

/* ---- words for messages ---- */

char *opc_setting_noun(const opc_parameter *p) {
  const opc_unit *unit = p->unit ? opc_unit_find(p->unit) : NULL;
  g_auto(GStrv) words = opc_choice_list(p->choices);
  g_autofree char *list = g_strjoinv("', '", words);
  if (p->type == OPC_REAL && unit)
    return g_strdup_printf("%s with a unit", opc_unit_noun(unit));
  if (p->type == OPC_CHOICE) return g_strdup_printf("one of '%s'", list);
  if (p->type == OPC_SLOT)
    return g_strdup_printf("a plugin, as in '{ use: %s.NAME }'", p->choices);
  return g_strdup(types[p->type].noun);
}

char *opc_quantity_text(const opc_parameter *p, double number) {
  g_autofree char *text = opc_number_text(number);
  return p->unit ? g_strdup_printf("%s %s", text, p->unit) : g_strdup(text);
}

char *opc_bounds_text(const opc_parameter *p) {
  g_autofree char *low = opc_quantity_text(p, p->min),
                  *high = opc_quantity_text(p, p->max);
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
  g_autofree char *limit = opc_quantity_text(p, bound);
  return WRONG(c, node, "'%s' must be %s %s, found '%s'", p->name, rule, limit,
               node->text);
}

static gboolean need_text(const conversion *c, const opc_node *node) {
  const opc_parameter *p = c->parameter;
  if (opc_node_is_empty(node))
    return WRONG(c, node, "'%s' has no value", p->name);
  if (node->type == OPC_NODE_TEXT) return TRUE;
  g_autofree char *noun = opc_setting_noun(p);
  return WRONG(c, node, "'%s' requires %s, found %s", p->name, noun,
               opc_node_noun(node));
}

static gboolean node_number(const conversion *c, const opc_node *node,
                            double *real) {
  const opc_parameter *p = c->parameter;
  return opc_quantity_read(node, NULL, p->unit, p->name, real, c->problems) &&
         check_bounds(c, node, *real);
}

static gboolean read_real(const conversion *c, const opc_node *node,
                          opc_setting *value) {
  return node_number(c, node, &value->field.real);
}

static gboolean read_reals(const conversion *c, const opc_node *node,
                           opc_setting *value) {
  const opc_parameter *p = c->parameter;
  if (node->type != OPC_NODE_LIST)
    return WRONG(c, node, "'%s' must be a list, as in '[1%s%s, ...]'", p->name,
                 p->unit ? " " : "", p->unit ? p->unit : "");
  guint n = node->items->len;
  double *reals = conversion_own(c, g_new0(double, MAX(n, 1)));
  gboolean good = TRUE;
  for (guint i = 0; i < n; i++)
    good &= need_text(c, node->items->pdata[i]) &&
            node_number(c, node->items->pdata[i], &reals[i]);
  value->field.reals = (opc_reals){reals, n};
  return good;
}

static gboolean read_int(const conversion *c, const opc_node *node,
                         opc_setting *value) {
  const char *text = node->text, *digits = text + (*text == '-');
  if (!*digits || strspn(digits, "0123456789") != strlen(digits))
    return WRONG(c, node, "'%s' must be a whole number, found '%s'",
                 c->parameter->name, text);
  errno = 0;
  value->field.integer = g_ascii_strtoll(text, NULL, 10);
  if (errno)
    return WRONG(c, node, "'%s' is too large: '%s'", c->parameter->name, text);
  return check_bounds(c, node, (double)value->field.integer);
}

/* ---- words ---- */

static gboolean read_bool(const conversion *c, const opc_node *node,
                          opc_setting *value) {
  value->field.flag = !strcmp(node->text, "true");
  if (value->field.flag || !strcmp(node->text, "false")) return TRUE;
  return WRONG(c, node, "'%s' must be 'true' or 'false', found '%s'",
               c->parameter->name, node->text);
}

static gboolean read_text(const conversion *c, const opc_node *node,
                          opc_setting *value) {
  value->field.text = conversion_own(c, g_strdup(node->text));
  return TRUE;
}

static gboolean read_choice(const conversion *c, const opc_node *node,
                            opc_setting *value) {
  const opc_parameter *p = c->parameter;
  g_auto(GStrv) words = opc_choice_list(p->choices);
  int i = 0;
  while (words[i] && strcmp(words[i], node->text) != 0) i++;
  value->field.flag = i;
  if (words[i]) return TRUE;
  g_autofree char *suggestion = opc_suggestion_of(node->text, words);
  if (*suggestion)
    return WRONG(c, node, "'%s' cannot be '%s'%s", p->name, node->text,
                 suggestion);
  g_autofree char *noun = opc_setting_noun(p);
  return WRONG(c, node, "'%s' must be %s, found '%s'", p->name, noun,
               node->text);
}

static gboolean read_map(const conversion *c, const opc_node *node,
                         opc_setting *value) {
  const opc_parameter *p = c->parameter;
  gboolean any = (p->flags & OPC_MAP_OF_ANY) != 0, good = TRUE;
  gboolean list = p->flags & OPC_INNER_AXIS && node->type == OPC_NODE_LIST;
  if (node->type != OPC_NODE_MAP && !list)
    return WRONG(c, node, "'%s' must be a map, as in '{ key: value }'",
                 p->name);
  g_autofree char *where = g_strdup_printf(" in '%s'", p->name);
  if (p->choices && !list)
    good = opc_node_check_keys(node, p->choices, where, c->problems);
  guint n = node->items->len;
  opc_pair *pairs = conversion_own(c, g_new0(opc_pair, MAX(n, 1)));
  for (guint i = 0; i < n; i++) {
    const opc_node *item = node->items->pdata[i];
    g_autofree char *key =
        list ? g_strdup_printf("%u", i + 1) : g_strdup(opc_node_key(node, i));
    if ((item->type != OPC_NODE_TEXT && !any) || opc_node_is_empty(item)) {
      good = WRONG(c, item, "'%s' of '%s' needs a %s", key, p->name,
                   any ? "value" : "text");
      continue;
    }
    pairs[i].key = conversion_own(c, g_strdup(key));
    pairs[i].value =
        conversion_own(c, item->type == OPC_NODE_TEXT ? g_strdup(item->text)
                                                      : opc_node_line(item));
  }
  value->field.map = (opc_map){pairs, n};
  return good;
}

/* ---- files and references ---- */

static gboolean read_file(const conversion *c, const opc_node *node,
                          opc_setting *value) {
  const char *path = value->field.text = conversion_own(c, opc_node_path(node));
  if (!c->check_files) return TRUE;
  const char *why = opc_file_fault(path, NULL);
  if (!why && access(path, R_OK)) why = g_strerror(errno);
  return !why ||
         opc_problem_add(c->problems, OPC_IO, &node->at, "'%s': %s", path, why);
}

static gboolean read_output(const conversion *c, const opc_node *node,
                            opc_setting *value) {
  read_text(c, node, value);
  if (opc_name_is_inside(node->text)) return TRUE;
  return WRONG(c, node,
               "'%s' must name a file inside the run folder, found '%s'",
               c->parameter->name, node->text);
}

static gboolean read_input(const conversion *c, const opc_node *node,
                           opc_setting *value) {
  const char *text = node->text;
  size_t n = strlen(text);
  if (n < 4 || strncmp(text, "${", 2) || text[n - 1] != '}')
    return WRONG(c, node, "'%s' must be a reference to a step, as in '${%s}'",
                 c->parameter->name, *text ? text : "step");
  value->reference = conversion_own(c, g_strndup(text + 2, n - 3));
  return TRUE;
}

/* ---- all types ---- */

/* Return whether values of the parameter are written as a list or a map. */
static gboolean is_structured(const opc_parameter *p) {
  return p->type == OPC_REALS || p->type == OPC_MAP || p->type == OPC_SLOT;
}

gboolean opc_setting_convert(const opc_parameter *parameter,
                             const opc_node *node, gboolean check_files,
                             GPtrArray *owned, opc_problems *problems,
                             opc_setting *value) {
  const conversion c = {parameter, check_files, owned, problems};
  value->present = TRUE;
  if (!is_structured(parameter) && !need_text(&c, node)) return FALSE;
  return types[parameter->type].read(&c, node, value);
}

opc_node *opc_preset_parse(const opc_parameter *parameter,
                           opc_problems *problems) {
  static const opc_source source = {.name = (char *)"default"};
  const char *text = parameter->preset;
  if (is_structured(parameter))
    return opc_node_parse(&source, text, strlen(text), problems);
  /* Keep the type text: an empty preset is a text, not a missing value. */
  return opc_node_text_new(&source, text);
}

void opc_setting_store(const opc_parameter *parameter, const opc_setting *value,
                       void *instance) {
  memcpy((char *)instance + parameter->offset, &value->field,
         types[parameter->type].width);
  if (parameter->given)
    *(int *)((char *)instance + parameter->given) = value->given;
}
