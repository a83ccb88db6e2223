/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines to subcircuits and their elements. */
#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "../netlist.h"

/* ---- pieces of a line ---- */

static int is_equals(const word *w) {
  return !w->quoted && w->text[0] == '=' && w->text[1] == '\0';
}

/* How many words come before the first NAME=VALUE. */
static size_t plain_words(const line *l) {
  for (size_t i = 0; i < l->words; i++)
    if (is_equals(&l->word[i])) return i ? i - 1 : 0;
  return l->words;
}

/* NAME = VALUE NAME = VALUE ... from word `from` on. */
static int read_settings(netlist *n, const line *l, size_t from, setting **out,
                         size_t *count) {
  size_t room = 0;
  for (size_t i = from; i < l->words; i += 3) {
    const word *w = &l->word[i];
    if (is_equals(w)) return netlist_refuse(n, w->at, "no name before '='");
    if (i + 1 >= l->words || !is_equals(&w[1]))
      return netlist_refuse(n, w->at, "'%.100s' is not followed by '='",
                            w->text);
    if (i + 2 >= l->words || is_equals(&w[2]))
      return netlist_refuse(n, w[1].at, "no value behind '='");
    if (!pool_grow(&n->pool, out, &room, *count + 1, sizeof **out))
      return netlist_no_memory(n);
    (*out)[(*count)++] = (setting){w->text, w[2].text, w[2].at};
  }
  return OPC_OK;
}

/* `count` words as names. */
static const char **names(netlist *n, const word *w, size_t count) {
  const char **list = pool_alloc(&n->pool, count, sizeof *list);
  for (size_t i = 0; list && i < count; i++) list[i] = w[i].text;
  return list;
}

/* ---- elements ---- */

/* What the flow says, else a .model card, else the name. */
int netlist_type(const netlist *n, const char *model) {
  static const struct {
    const char *part;
    int type;
  } usual[] = {{"nmos", OPC_NMOS}, {"pmos", OPC_PMOS}, {"nfet", OPC_NMOS},
               {"pfet", OPC_PMOS}, {"nch", OPC_NMOS},  {"pch", OPC_PMOS}};
  if (in_list(n->n_models, model)) return OPC_NMOS;
  if (in_list(n->p_models, model)) return OPC_PMOS;
  uint32_t *said = map_find(&n->type_of, model, strlen(model));
  if (said) return (int)*said;
  for (size_t i = 0; i < sizeof usual / sizeof *usual; i++)
    if (strcasestr(model, usual[i].part)) return usual[i].type;
  int first = tolower((unsigned char)model[0]);
  return first == 'n' ? OPC_NMOS : first == 'p' ? OPC_PMOS : -1;
}

static int fill_transistor(netlist *n, element *e) {
  int type = netlist_type(n, e->model);
  if (type < 0)
    return netlist_refuse(n, e->model_at,
                          "is model '%.100s' of n or of p type? say so with "
                          "'nmos' or 'pmos'",
                          e->model);
  e->type = (uint8_t)type;
  e->is_transistor = 1;
  return OPC_OK;
}

static element *new_element(netlist *n, subcircuit *s) {
  if (!pool_grow(&n->pool, &s->element, &s->room, s->elements + 1,
                 sizeof *s->element))
    return NULL;
  s->element[s->elements] = (element){0};
  return &s->element[s->elements++];
}

/* M or X: NAME NODES... MODEL [NAME=VALUE ...] */
static int read_element(netlist *n, subcircuit *s, const line *l) {
  int is_transistor = tolower((unsigned char)l->word[0].text[0]) == 'm';
  size_t plain = plain_words(l), nodes = plain - 2;
  element *e = new_element(n, s);
  if (!e) return netlist_no_memory(n);
  if (plain < 2 || (is_transistor && plain != 6))
    return netlist_refuse(
        n, l->word[0].at, "'%.100s' should have %s, and then a name",
        l->word[0].text, is_transistor ? "four nodes" : "its nodes");
  /* CDL: X1 a b / NAME */
  const word *last = &l->word[plain - 1];
  if (!is_transistor && nodes && !strcmp(last[-1].text, "/")) nodes--;
  e->name = l->word[0].text;
  e->at = l->word[0].at;
  e->model = last->text;
  e->model_at = last->at;
  e->nodes = nodes;
  e->node = names(n, l->word + 1, nodes);
  e->x = l->x;
  e->y = l->y;
  if (!e->node) return netlist_no_memory(n);
  if (read_settings(n, l, plain, &e->setting, &e->settings))
    return n->error->code;
  return is_transistor ? fill_transistor(n, e) : OPC_OK;
}

/* ---- cards ---- */

static int begin_subcircuit(netlist *n, parser *p, const line *l) {
  size_t plain = plain_words(l);
  if (p->current != UINT32_MAX)
    return netlist_refuse(n, l->word[0].at, ".subckt inside of '%.100s'",
                          n->subcircuit[p->current].name);
  if (plain < 2)
    return netlist_refuse(n, l->word[0].at, ".subckt without a name");
  const word *name = &l->word[1];
  uint32_t *number = map_add(&n->subcircuit_of, name->text);
  if (!number || !pool_grow(&n->pool, &n->subcircuit, &n->room_subcircuits,
                            n->subcircuits + 1, sizeof *n->subcircuit))
    return netlist_no_memory(n);
  if (*number != UINT32_MAX) {
    place before = n->subcircuit[*number].at;
    return netlist_refuse(n, name->at,
                          "there is a '%.100s' already, in line %u", name->text,
                          before.line);
  }
  *number = (uint32_t)n->subcircuits++;
  subcircuit *s = &n->subcircuit[p->current = *number];
  *s = (subcircuit){.name = name->text, .at = name->at, .ports = plain - 2};
  if (s->ports && !strcasecmp(l->word[plain - 1].text, "params:")) s->ports--;
  s->port = names(n, l->word + 2, s->ports);
  if (!s->port) return netlist_no_memory(n);
  return read_settings(n, l, plain, &s->setting, &s->settings);
}

static int end_subcircuit(netlist *n, parser *p, const line *l) {
  if (p->current == UINT32_MAX)
    return netlist_refuse(n, l->word[0].at, ".ends without .subckt");
  const subcircuit *s = &n->subcircuit[p->current];
  if (l->words > 1 && !same_name(l->word[1].text, s->name))
    return netlist_refuse(n, l->word[1].at, ".ends of '%.100s' in '%.100s'",
                          l->word[1].text, s->name);
  p->current = UINT32_MAX;
  return OPC_OK;
}

static int read_parameters(netlist *n, const line *l) {
  setting *list = NULL;
  size_t count = 0;
  if (read_settings(n, l, 1, &list, &count)) return n->error->code;
  for (size_t i = 0; i < count; i++) {
    uint32_t *at = map_add(&n->setting_of, list[i].name);
    if (!at || !pool_grow(&n->pool, &n->setting, &n->room_settings,
                          n->settings + 1, sizeof *n->setting))
      return netlist_no_memory(n);
    *at = (uint32_t)n->settings; /* the last one counts */
    n->setting[n->settings++] = list[i];
  }
  return OPC_OK;
}

/* .option scale=1e-6; other options do not change what is connected. */
static int read_options(netlist *n, const line *l) {
  for (size_t i = 1; i + 2 < l->words; i++) {
    if (strcasecmp(l->word[i].text, "scale") || !is_equals(&l->word[i + 1]))
      continue;
    setting s = {"scale", l->word[i + 2].text, l->word[i + 2].at};
    if (netlist_value(n, NULL, &s, &n->unit)) return n->error->code;
    if (!(n->unit > 0))
      return netlist_refuse(n, s.at, "scale '%.100s' is not above 0", s.value);
  }
  return OPC_OK;
}

static int read_model(netlist *n, const line *l) {
  if (l->words < 3) return OPC_OK;
  const char *kind = l->word[2].text;
  int p = !strcasecmp(kind, "pmos");
  if (!p && strcasecmp(kind, "nmos")) return OPC_OK;
  uint32_t *type = map_add(&n->type_of, l->word[1].text);
  if (!type) return netlist_no_memory(n);
  *type = p ? OPC_PMOS : OPC_NMOS;
  return OPC_OK;
}

static int read_globals(netlist *n, const line *l) {
  for (size_t i = 1; i < l->words; i++) {
    uint32_t *at = map_add(&n->global_of, l->word[i].text);
    if (!at || !pool_grow(&n->pool, &n->global, &n->room_globals,
                          n->globals + 1, sizeof *n->global))
      return netlist_no_memory(n);
    if (*at != UINT32_MAX) continue;
    *at = (uint32_t)n->globals;
    n->global[n->globals++] = l->word[i].text;
  }
  return OPC_OK;
}

static int is_card(const line *l, const char *const *cards) {
  for (; *cards; cards++)
    if (!strcasecmp(l->word[0].text, *cards)) return 1;
  return 0;
}

static int read_card(netlist *n, parser *p, const line *l) {
  /* What a simulation is told, and not what is connected. */
  static const char *const skipped[] = {
      ".tran",  ".dc",   ".ac",      ".op",    ".print",   ".plot",    ".probe",
      ".meas",  ".save", ".measure", ".temp",  ".ic",      ".nodeset", ".title",
      ".noise", ".tf",   ".four",    ".width", ".csparam", NULL};
  static const char *const includes[] = {".include", ".inc", NULL};
  static const char *const options[] = {".option", ".options", ".opt", NULL};
  const char *card = l->word[0].text;
  if (!strcasecmp(card, ".subckt")) return begin_subcircuit(n, p, l);
  if (!strcasecmp(card, ".ends")) return end_subcircuit(n, p, l);
  if (!strcasecmp(card, ".param")) return read_parameters(n, l);
  if (!strcasecmp(card, ".model")) return read_model(n, l);
  if (!strcasecmp(card, ".global")) return read_globals(n, l);
  if (is_card(l, options)) return read_options(n, l);
  if (is_card(l, includes)) return netlist_include(n, p, l);
  if (!strcasecmp(card, ".control"))
    p->control = 1;
  else if (!strcasecmp(card, ".end"))
    p->ended = 1;
  else if (!is_card(l, skipped))
    return netlist_refuse(n, l->word[0].at, "unknown card '%.40s'", card);
  return OPC_OK;
}

int netlist_line(netlist *n, parser *p, line *l) {
  const word *first = &l->word[0];
  int letter = tolower((unsigned char)first->text[0]);
  if (p->control) {
    p->control = strcasecmp(first->text, ".endc") != 0;
    return OPC_OK;
  }
  if (letter == '.') return read_card(n, p, l);
  if (p->current == UINT32_MAX) {
    n->outside++;
    return OPC_OK;
  }
  if (letter == 'm' || letter == 'x')
    return read_element(n, &n->subcircuit[p->current], l);
  /* Capacitors and diodes connect nothing. */
  if (letter != 'c' && letter != 'd')
    return netlist_refuse(n, first->at,
                          "'%.100s' is neither a transistor nor a subcircuit's "
                          "instance",
                          first->text);
  n->left_out++;
  return OPC_OK;
}
