/* SPDX-License-Identifier: BSD-3-Clause */
/* Parser of netlist lines: subcircuits, elements and control statements. */
#include "netlist/lines.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

/* ---- parts of a line ---- */

/* Return the number of words before the first NAME=VALUE pair. */
static size_t plain_words(const line *l) {
  for (size_t i = 0; i < l->words; i++)
    if (is_equals(&l->word[i])) return i ? i - 1 : 0;
  return l->words;
}

/* Read NAME=VALUE pairs from word `from` to the end of the line. */
static int read_settings(eda_netlist *n, const line *l, size_t from,
                         eda_assignment **out, size_t *count) {
  size_t capacity = 0;
  for (size_t i = from; i < l->words; i += 3) {
    const word *w = &l->word[i];
    if (is_equals(w))
      return lines_refuse(n->lines, w->at, "no name before '='");
    if (i + 1 >= l->words || !is_equals(&w[1]))
      return lines_refuse(n->lines, w->at, "'%.100s' is not followed by '='",
                          w->text);
    if (i + 2 >= l->words || is_equals(&w[2]))
      return lines_refuse(n->lines, w[1].at, "no value after '='");
    eda_pool_grow(&n->pool, out, &capacity, *count + 1, sizeof **out);
    (*out)[(*count)++] = (eda_assignment){w->text, w[2].text, w[2].at};
  }
  return OPC_OK;
}

/* Return `count` words as names. */
static const char **words_names(eda_netlist *n, const word *w, size_t count) {
  const char **list = eda_pool_alloc(&n->pool, count, sizeof *list);
  for (size_t i = 0; i < count; i++) list[i] = w[i].text;
  return list;
}

/* ---- elements ---- */

/* Find the type in the lists n_models and p_models of the caller, else in the
   .model cards, else by known parts of the name, else by its first letter. */
int netlist_type(const eda_netlist *n, const char *model) {
  static const struct {
    const char *part;
    int type;
  } usual[] = {{"nmos", EDA_NMOS}, {"pmos", EDA_PMOS}, {"nfet", EDA_NMOS},
               {"pfet", EDA_PMOS}, {"nch", EDA_NMOS},  {"pch", EDA_PMOS}};
  if (eda_in_list(n->n_models, model)) return EDA_NMOS;
  if (eda_in_list(n->p_models, model)) return EDA_PMOS;
  uint32_t *known = eda_names_find(&n->type_of, model);
  if (known) return (int)*known;
  for (size_t i = 0; i < sizeof usual / sizeof *usual; i++)
    if (strcasestr(model, usual[i].part)) return usual[i].type;
  int first = tolower((unsigned char)model[0]);
  return first == 'n' ? EDA_NMOS : first == 'p' ? EDA_PMOS : -1;
}

static int fill_transistor(eda_netlist *n, eda_element *e) {
  int type = netlist_type(n, e->model);
  if (type < 0)
    return lines_refuse(n->lines, e->model_at,
                        "the type of model '%.100s' is unknown: name the model "
                        "in 'nmos' or 'pmos'",
                        e->model);
  e->type = (uint8_t)type;
  e->is_transistor = 1;
  return OPC_OK;
}

/* Read an M or X element: NAME NODES... MODEL [NAME=VALUE ...] */
static int read_element(eda_netlist *n, eda_subcircuit *s, const line *l) {
  int is_transistor = tolower((unsigned char)l->word[0].text[0]) == 'm';
  size_t plain = plain_words(l), nodes = plain - 2;
  eda_pool_grow(&n->pool, &s->element, &s->capacity, s->elements + 1,
                sizeof *s->element);
  eda_element *e = &s->element[s->elements++];
  if (plain < 2 || (is_transistor && plain != 6))
    return lines_refuse(
        n->lines, l->word[0].at, "'%.100s' must have %s, followed by a name",
        l->word[0].text, is_transistor ? "four nodes" : "its nodes");
  /* CDL notation: X1 a b / NAME */
  const word *last = &l->word[plain - 1];
  if (!is_transistor && nodes && !strcmp(last[-1].text, "/")) nodes--;
  e->name = l->word[0].text;
  e->at = l->word[0].at;
  e->model = last->text;
  e->model_at = last->at;
  e->nodes = nodes;
  e->node = words_names(n, l->word + 1, nodes);
  e->x = l->x;
  e->y = l->y;
  if (read_settings(n, l, plain, &e->setting, &e->settings))
    return n->error->code;
  return is_transistor ? fill_transistor(n, e) : OPC_OK;
}

/* ---- control statements ---- */

static int begin_subcircuit(eda_netlist *n, const line *l) {
  size_t plain = plain_words(l);
  if (n->current != UINT32_MAX)
    return lines_refuse(n->lines, l->word[0].at, ".subckt inside of '%.100s'",
                        n->subcircuit[n->current].name);
  if (plain < 2)
    return lines_refuse(n->lines, l->word[0].at, ".subckt without a name");
  const word *name = &l->word[1];
  uint32_t *number = eda_names_add(&n->subcircuit_of, name->text);
  eda_pool_grow(&n->pool, &n->subcircuit, &n->capacity_subcircuits,
                n->subcircuits + 1, sizeof *n->subcircuit);
  if (*number != UINT32_MAX) {
    eda_place before = n->subcircuit[*number].at;
    return lines_refuse(n->lines, name->at,
                        "'%.100s' is already defined in line %u", name->text,
                        before.line);
  }
  *number = (uint32_t)n->subcircuits++;
  eda_subcircuit *s = &n->subcircuit[n->current = *number];
  *s = (eda_subcircuit){.name = name->text, .at = name->at, .ports = plain - 2};
  if (s->ports && !strcasecmp(l->word[plain - 1].text, "params:")) s->ports--;
  s->port = words_names(n, l->word + 2, s->ports);
  return read_settings(n, l, plain, &s->setting, &s->settings);
}

static int end_subcircuit(eda_netlist *n, const line *l) {
  if (n->current == UINT32_MAX)
    return lines_refuse(n->lines, l->word[0].at, ".ends without .subckt");
  const eda_subcircuit *s = &n->subcircuit[n->current];
  if (l->words > 1 && !eda_same_name(l->word[1].text, s->name))
    return lines_refuse(n->lines, l->word[1].at,
                        ".ends of '%.100s' in '%.100s'", l->word[1].text,
                        s->name);
  n->current = UINT32_MAX;
  return OPC_OK;
}

static int read_parameters(eda_netlist *n, const line *l) {
  eda_assignment *list = NULL;
  size_t count = 0;
  if (read_settings(n, l, 1, &list, &count)) return n->error->code;
  for (size_t i = 0; i < count; i++) {
    /* The last definition of a parameter applies. */
    *eda_names_add(&n->setting_of, list[i].name) = (uint32_t)n->settings;
    eda_pool_grow(&n->pool, &n->setting, &n->capacity_settings, n->settings + 1,
                  sizeof *n->setting);
    n->setting[n->settings++] = list[i];
  }
  return OPC_OK;
}

/* Read .option scale (m per unit of W and L). Ignore other options, which do
   not affect connections. */
static int read_options(eda_netlist *n, const line *l) {
  for (size_t i = 1; i + 2 < l->words; i++) {
    if (strcasecmp(l->word[i].text, "scale") || !is_equals(&l->word[i + 1]))
      continue;
    eda_assignment s = {"scale", l->word[i + 2].text, l->word[i + 2].at};
    if (netlist_value(n, NULL, &s, &n->unit)) return n->error->code;
    if (!(n->unit > 0))
      return lines_refuse(n->lines, s.at, "scale '%.100s' is not above 0",
                          s.value);
  }
  return OPC_OK;
}

static void read_model(eda_netlist *n, const line *l) {
  if (l->words < 3) return;
  const char *kind = l->word[2].text;
  int p = !strcasecmp(kind, "pmos");
  if (p || !strcasecmp(kind, "nmos"))
    *eda_names_add(&n->type_of, l->word[1].text) = p ? EDA_PMOS : EDA_NMOS;
}

static void read_globals(eda_netlist *n, const line *l) {
  for (size_t i = 1; i < l->words; i++) {
    uint32_t *at = eda_names_add(&n->global_of, l->word[i].text);
    if (*at != UINT32_MAX) continue;
    eda_pool_grow(&n->pool, &n->global, &n->capacity_globals, n->globals + 1,
                  sizeof *n->global);
    *at = (uint32_t)n->globals;
    n->global[n->globals++] = l->word[i].text;
  }
}

static int is_card(const line *l, const char *const *cards) {
  for (; *cards; cards++)
    if (!strcasecmp(l->word[0].text, *cards)) return 1;
  return 0;
}

static int read_card(eda_netlist *n, const line *l) {
  /* Statements that control simulation and do not affect connections. */
  static const char *const skipped[] = {
      ".tran",  ".dc",   ".ac",      ".op",    ".print",   ".plot",    ".probe",
      ".meas",  ".save", ".measure", ".temp",  ".ic",      ".nodeset", ".title",
      ".noise", ".tf",   ".four",    ".width", ".csparam", NULL};
  static const char *const options[] = {".option", ".options", ".opt", NULL};
  const char *card = l->word[0].text;
  if (!strcasecmp(card, ".subckt")) return begin_subcircuit(n, l);
  if (!strcasecmp(card, ".ends")) return end_subcircuit(n, l);
  if (!strcasecmp(card, ".param")) return read_parameters(n, l);
  if (is_card(l, options)) return read_options(n, l);
  if (lines_is_include(l)) return lines_include(n->lines, l);
  if (!strcasecmp(card, ".model"))
    read_model(n, l);
  else if (!strcasecmp(card, ".global"))
    read_globals(n, l);
  else if (!strcasecmp(card, ".control"))
    n->control = 1;
  else if (!strcasecmp(card, ".end"))
    n->lines->ended = 1;
  else if (!is_card(l, skipped))
    return lines_refuse(n->lines, l->word[0].at, "unknown card '%.40s'", card);
  return OPC_OK;
}

static int take_line(void *data, const line *l) {
  eda_netlist *n = data;
  const word *first = &l->word[0];
  int letter = tolower((unsigned char)first->text[0]);
  if (n->control) {
    n->control = strcasecmp(first->text, ".endc") != 0;
    return OPC_OK;
  }
  if (letter == '.') return read_card(n, l);
  if (n->current == UINT32_MAX) return OPC_OK;
  if (letter == 'm' || letter == 'x')
    return read_element(n, &n->subcircuit[n->current], l);
  /* Ignore capacitors and diodes. */
  if (letter != 'c' && letter != 'd')
    return lines_refuse(n->lines, first->at,
                        "'%.100s' is neither a transistor nor a subcircuit's "
                        "instance",
                        first->text);
  n->left_out++;
  return OPC_OK;
}

int eda_netlist_read(eda_netlist *n, const char *path) {
  n->lines = eda_pool_alloc(&n->pool, 1, sizeof *n->lines);
  *n->lines = (lines){
      .error = n->error, .pool = &n->pool, .take = take_line, .data = n};
  n->current = UINT32_MAX;
  n->unit = 1;
  n->subcircuit_of.pool = n->type_of.pool = n->global_of.pool =
      n->setting_of.pool = &n->pool;
  int code = lines_read(n->lines, path);
  if (!code && n->current != UINT32_MAX) {
    const eda_subcircuit *s = &n->subcircuit[n->current];
    code = lines_refuse(n->lines, s->at, "'%.100s' has no .ends", s->name);
  }
  return code;
}

void eda_netlist_clear(eda_netlist *n) { eda_pool_clear(&n->pool); }
