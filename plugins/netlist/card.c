/* SPDX-License-Identifier: BSD-3-Clause */
#include "card.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist.h"

/* Whose lines netlist_line gets. */
typedef struct card_reader {
  netlist n; /* the first member */
  const char *name, *kind;
  netlist_model *out;
} card_reader;

static int is_equals(const line *l, size_t i) {
  return i < l->words && !l->word[i].quoted && !strcmp(l->word[i].text, "=");
}

/* What is kept of a parameter: dlc and lint are looked at. */
static int take(card_reader *r, const word *key, const word *value, int *has) {
  netlist_model *m = r->out;
  double number = 0;
  int is_dlc = same_name(key->text, "dlc"),
      is_lint = same_name(key->text, "lint");
  int is_level = same_name(key->text, "level");
  if (is_dlc || is_lint || is_level) {
    const char *end = netlist_number(value->text, &number);
    if (!end || *end)
      return netlist_refuse(&r->n, value->at, "'%.100s' is not a number",
                            value->text);
  }
  /* BSIM3 and BSIM4 know DLC. */
  if (is_level && number != 8 && number != 49 && number != 14 && number != 54)
    return netlist_refuse(&r->n, value->at,
                          "a model of level %g has no DLC: 8, 49, 14 and 54 do",
                          number);
  has[0] |= is_level;
  if (is_dlc || (is_lint && !has[1])) m->dlc = number * 1e9;
  has[1] |= is_dlc;
  if (is_dlc) return OPC_OK;
  m->key[m->count] = key->text;
  m->value[m->count++] = value->text;
  return OPC_OK;
}

static int read_model(card_reader *r, const line *l) {
  netlist_model *m = r->out;
  int has[2] = {0, 0};
  if (m->name)
    return netlist_refuse(&r->n, l->word[1].at, "there is a '%.100s' already",
                          m->name);
  if (!same_name(l->word[2].text, r->kind))
    return netlist_refuse(&r->n, l->word[2].at, "model '%.100s' is no %s",
                          l->word[1].text, r->kind);
  *m = (netlist_model){.name = l->word[1].text, .kind = l->word[2].text};
  m->key = pool_alloc(&r->n.pool, l->words, sizeof *m->key);
  m->value = pool_alloc(&r->n.pool, l->words, sizeof *m->value);
  if (!m->key || !m->value) return netlist_no_memory(&r->n);
  for (size_t i = 3; i < l->words; i += 3) {
    const word *key = &l->word[i];
    if (is_equals(l, i) || !is_equals(l, i + 1) || i + 2 >= l->words ||
        is_equals(l, i + 2))
      return netlist_refuse(&r->n, key->at, "'%.100s' is no NAME=VALUE",
                            key->text);
    if (take(r, key, &key[2], has)) return r->n.error->code;
  }
  if (has[0]) return OPC_OK;
  return netlist_refuse(&r->n, l->word[0].at, "model '%.100s' has no level",
                        m->name);
}

int netlist_line(netlist *n, parser *p, line *l) {
  card_reader *r = (card_reader *)n;
  const char *card = l->word[0].text;
  if (!strcasecmp(card, ".include") || !strcasecmp(card, ".inc"))
    return netlist_include(n, p, l);
  if (strcasecmp(card, ".model") || l->words < 3 ||
      !same_name(l->word[1].text, r->name))
    return OPC_OK;
  return read_model(r, l);
}

int netlist_model_read(const opc_host *host, pool *p, const char *path,
                       const char *name, int type, netlist_model *out,
                       opc_error *error) {
  card_reader r = {.n = {.host = host, .error = error, .pool = *p},
                   .name = name,
                   .kind = type == OPC_PMOS ? "pmos" : "nmos",
                   .out = out};
  *out = (netlist_model){0};
  int code = netlist_read(&r.n, path);
  *p = r.n.pool;
  if (!code && !out->name)
    code = host->fail(host, error, OPC_INVALID, NULL,
                      "'%.300s' has no model '%.100s'", path, name);
  return code;
}
