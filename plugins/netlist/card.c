/* SPDX-License-Identifier: BSD-3-Clause */
#include "card.h"

#include <math.h>
#include <stdio.h>
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
    if (!isfinite(number * 1e9))
      return netlist_refuse(&r->n, value->at, "'%.100s' is too large",
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

/* A parameter's number, or what the model has without it; 0 if it is none. */
static int number_of(const netlist_model *m, const char *key, double preset,
                     double *out) {
  *out = preset;
  for (size_t i = 0; i < m->count; i++) {
    if (!same_name(m->key[i], key)) continue;
    const char *end = netlist_number(m->value[i], out);
    if (!end || *end || !isfinite(*out)) return 0;
  }
  return 1;
}

static int has_key(const netlist_model *m, const char *key) {
  for (size_t i = 0; i < m->count; i++)
    if (same_name(m->key[i], key)) return 1;
  return 0;
}

/* F/m^2, by the model's own constants; 0 where it is not that simple. */
static double oxide_capacitance(const netlist_model *m, double level) {
  double tox, epsrox, mtrlmod;
  if (level == 8 || level == 49)
    return number_of(m, "tox", 150e-10, &tox) ? 3.453133e-11 / tox : 0;
  if (!number_of(m, "toxe", 30e-10, &tox) ||
      !number_of(m, "epsrox", 3.9, &epsrox) ||
      !number_of(m, "mtrlmod", 0, &mtrlmod) || mtrlmod != 0 ||
      (has_key(m, "toxp") && !has_key(m, "toxe")))
    return 0;
  return epsrox * 8.85418e-12 / tox;
}

/* A model without CGSO and CGDO derives them from XJ; once a DLC is written
   into its card, from that. They stay what they were if they are written, too. */
static int keep_overlaps(card_reader *r, const line *l, int has_dlc) {
  static const char *const names[2][2] = {{"cgso", "cgsl"}, {"cgdo", "cgdl"}};
  netlist_model *m = r->out;
  double level, xj, less;
  if (!number_of(m, "level", 0, &level)) level = 0;
  for (int k = 0; k < 2; k++) {
    if (has_key(m, names[k][0])) continue;
    double cox = oxide_capacitance(m, level);
    if (!(cox > 0) || !number_of(m, "xj", 1.5e-7, &xj) ||
        !number_of(m, names[k][1], 0, &less))
      return netlist_refuse(&r->n, l->word[0].at,
                            "model '%.100s' has no %s: with a DLC it would be "
                            "another",
                            m->name, names[k][0]);
    double overlap = has_dlc && m->dlc > 0 ? m->dlc * 1e-9 * cox - less
                                           : 0.6 * xj * cox;
    if (!isfinite(overlap))
      return netlist_refuse(&r->n, l->word[0].at,
                            "%s of model '%.100s' would not be finite",
                            names[k][0], m->name);
    char text[32];
    int n = snprintf(text, sizeof text, "%.9g", overlap);
    m->key[m->count] = names[k][0];
    m->value[m->count] = pool_text(&r->n.pool, text, (size_t)n);
    if (!m->value[m->count++]) return netlist_no_memory(&r->n);
  }
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
  /* Two more may come. */
  m->key = pool_alloc(&r->n.pool, l->words + 2, sizeof *m->key);
  m->value = pool_alloc(&r->n.pool, l->words + 2, sizeof *m->value);
  if (!m->key || !m->value) return netlist_no_memory(&r->n);
  for (size_t i = 3; i < l->words; i += 3) {
    const word *key = &l->word[i];
    if (is_equals(l, i) || !is_equals(l, i + 1) || i + 2 >= l->words ||
        is_equals(l, i + 2))
      return netlist_refuse(&r->n, key->at, "'%.100s' is no NAME=VALUE",
                            key->text);
    if (take(r, key, &key[2], has)) return r->n.error->code;
  }
  if (has[0]) return keep_overlaps(r, l, has[1]);
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
