/* SPDX-License-Identifier: BSD-3-Clause */
/* Reader of .model cards for netlists with changed DLC. Rejects cards in which
   DLC would change more than the gate capacitance. */
#include "netlist/lines.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct card_reader {
  lines lines;
  const char *name, *kind;
  eda_card *out;
} card_reader;

static int equals_at(const line *l, size_t i) {
  return i < l->words && is_equals(&l->word[i]);
}

/* Read a parameter. DLC sets out->dlc (nm); LINT sets out->dlc if the card has
   no DLC. Store all parameters except DLC as text. has[0]: LEVEL found; has[1]:
   DLC found. */
static int card_take_parameter(card_reader *r, const word *key,
                               const word *value, int *has) {
  eda_card *m = r->out;
  double number = 0;
  int is_dlc = eda_same_name(key->text, "dlc"),
      is_lint = eda_same_name(key->text, "lint");
  int is_level = eda_same_name(key->text, "level");
  if (is_dlc || is_lint || is_level) {
    const char *end = netlist_number(value->text, &number);
    if (!end || *end)
      return lines_refuse(&r->lines, value->at, "'%.100s' is not a number",
                          value->text);
    if (!isfinite(number * 1e9))
      return lines_refuse(&r->lines, value->at, "'%.100s' is too large",
                          value->text);
  }
  /* Only BSIM3 (8, 49) and BSIM4 (14, 54) have DLC. */
  if (is_level && number != 8 && number != 49 && number != 14 && number != 54)
    return lines_refuse(
        &r->lines, value->at,
        "a model of level %g has no DLC, expected level 8, 49, 14 or 54",
        number);
  has[0] |= is_level;
  if (is_dlc || (is_lint && !has[1])) m->dlc = number * 1e9;
  has[1] |= is_dlc;
  if (is_dlc) return OPC_OK;
  m->key[m->count] = key->text;
  m->value[m->count++] = value->text;
  return OPC_OK;
}

/* Write the value of a parameter, or `preset` if the card does not have the
   parameter, to *out. Return 0 if the text is not a number. */
static int number_of(const eda_card *m, const char *key, double preset,
                     double *out) {
  *out = preset;
  for (size_t i = 0; i < m->count; i++) {
    if (!eda_same_name(m->key[i], key)) continue;
    const char *end = netlist_number(m->value[i], out);
    if (!end || *end || !isfinite(*out)) return 0;
  }
  return 1;
}

static int has_key(const eda_card *m, const char *key) {
  for (size_t i = 0; i < m->count; i++)
    if (eda_same_name(m->key[i], key)) return 1;
  return 0;
}

/* Return the oxide capacitance of the model, F/m^2; 0 if the card does not
   determine the capacitance by a simple formula. */
static double oxide_capacitance(const eda_card *m, double level) {
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

/* Add CGSO and CGDO to a card that lacks them. The simulator would compute the
   two overlap capacitances from DLC if the card has a DLC, otherwise from XJ.
   Explicit values do not change with DLC. */
static int keep_overlaps(card_reader *r, const line *l, int has_dlc) {
  static const char *const names[2][2] = {{"cgso", "cgsl"}, {"cgdo", "cgdl"}};
  eda_card *m = r->out;
  double level, xj, less;
  if (!number_of(m, "level", 0, &level)) level = 0;
  for (int k = 0; k < 2; k++) {
    if (has_key(m, names[k][0])) continue;
    double cox = oxide_capacitance(m, level);
    if (!(cox > 0) || !number_of(m, "xj", 1.5e-7, &xj) ||
        !number_of(m, names[k][1], 0, &less))
      return lines_refuse(&r->lines, l->word[0].at,
                          "model '%.100s' has no %s, without which a DLC would "
                          "change other properties",
                          m->name, names[k][0]);
    double overlap =
        has_dlc && m->dlc > 0 ? m->dlc * 1e-9 * cox - less : 0.6 * xj * cox;
    if (!isfinite(overlap))
      return lines_refuse(&r->lines, l->word[0].at,
                          "%s of model '%.100s' would not be finite",
                          names[k][0], m->name);
    char text[32];
    int n = snprintf(text, sizeof text, "%.9g", overlap);
    m->key[m->count] = names[k][0];
    m->value[m->count++] = eda_pool_text(r->lines.pool, text, (size_t)n);
  }
  return OPC_OK;
}

static int read_model(card_reader *r, const line *l) {
  eda_card *m = r->out;
  int has[2] = {0, 0};
  if (m->name)
    return lines_refuse(&r->lines, l->word[1].at, "'%.100s' is already defined",
                        m->name);
  if (!eda_same_name(l->word[2].text, r->kind))
    return lines_refuse(&r->lines, l->word[2].at,
                        "model '%.100s' is not of the type %s", l->word[1].text,
                        r->kind);
  *m = (eda_card){.name = l->word[1].text, .kind = l->word[2].text};
  /* Capacity for CGSO and CGDO, which may be added. */
  m->key = eda_pool_alloc(r->lines.pool, l->words + 2, sizeof *m->key);
  m->value = eda_pool_alloc(r->lines.pool, l->words + 2, sizeof *m->value);
  for (size_t i = 3; i < l->words; i += 3) {
    const word *key = &l->word[i];
    if (equals_at(l, i) || !equals_at(l, i + 1) || i + 2 >= l->words ||
        equals_at(l, i + 2))
      return lines_refuse(&r->lines, key->at,
                          "'%.100s' is not of the form NAME=VALUE", key->text);
    if (card_take_parameter(r, key, &key[2], has)) return r->lines.error->code;
  }
  if (has[0]) return keep_overlaps(r, l, has[1]);
  return lines_refuse(&r->lines, l->word[0].at, "model '%.100s' has no level",
                      m->name);
}

static int take_line(void *data, const line *l) {
  card_reader *r = data;
  if (lines_is_include(l)) return lines_include(&r->lines, l);
  if (strcasecmp(l->word[0].text, ".model") || l->words < 3 ||
      !eda_same_name(l->word[1].text, r->name))
    return OPC_OK;
  return read_model(r, l);
}

int eda_card_read(eda_pool *pool, const char *path, const char *name, int type,
                  eda_card *out, opc_error *error) {
  card_reader r = {.lines = {.error = error, .pool = pool, .take = take_line},
                   .name = name,
                   .kind = type == EDA_PMOS ? "pmos" : "nmos",
                   .out = out};
  r.lines.data = &r;
  r.lines.root = lines_folder(pool, path);
  *out = (eda_card){0};
  int code = lines_read(&r.lines, path);
  if (!code && !out->name)
    code = opc_fail(error, OPC_INVALID, NULL, "'%.300s' has no model '%.100s'",
                    path, name);
  return code;
}

int eda_cards_read(eda_pool *pool, const char *const files[2],
                   const char *const names[2], int read, const char *paths[2],
                   eda_card card[2], opc_error *error) {
  for (int i = 0; i < 2; i++) {
    const char *parameter = i ? "pmos_models" : "models";
    paths[i] = NULL;
    if (!files[i]) continue;
    char *path = realpath(files[i], NULL);
    if (!path)
      return opc_fail(error, OPC_IO, parameter, "cannot read '%s': %s",
                      files[i], strerror(errno));
    paths[i] = eda_pool_text(pool, path, strlen(path));
    free(path);
    if (strpbrk(paths[i], "\"\n"))
      return opc_fail(error, OPC_INVALID, parameter,
                      "'%s': the simulator cannot open a file name with a "
                      "quote or line break",
                      files[i]);
  }
  for (int type = 0; type < 2 && read; type++)
    if (eda_card_read(pool, paths[type == EDA_PMOS && paths[1]], names[type],
                      type, &card[type], error))
      return error->code;
  return OPC_OK;
}

static int is_plain(const char *value) {
  return !strpbrk(value, "+*/() ") ||
         strspn(value, "+-.0123456789eE") == strlen(value);
}

void eda_card_write(FILE *out, const eda_card *m, const char *name,
                    double dlc) {
  fprintf(out, ".model %s %s dlc=%.9ge-9", name, m->kind, dlc);
  for (size_t i = 0; i < m->count; i++) {
    const char *quote = is_plain(m->value[i]) ? "" : "'";
    fprintf(out, "%s%s=%s%s%s", i % 6 ? " " : "\n+ ", m->key[i], quote,
            m->value[i], quote);
  }
  fprintf(out, "\n");
}
