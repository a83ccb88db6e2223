/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers with suffixes, and expressions of numbers and parameters. */
#include "netlist/lines.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Largest number of evaluation steps, and largest nesting depth, of an
   expression including the parameters in the expression. */
enum { MAX_STEPS = 10000, MAX_DEPTH = 64 };

/* ---- numbers ---- */

static double unit_suffix(const char *s) {
  static const struct {
    const char *text;
    double factor;
  } known[] = {{"meg", 1e6}, {"mil", 25.4e-6}, {"t", 1e12}, {"g", 1e9},
               {"k", 1e3},   {"m", 1e-3},      {"u", 1e-6}, {"n", 1e-9},
               {"p", 1e-12}, {"f", 1e-15},     {"a", 1e-18}};
  for (size_t i = 0; i < sizeof known / sizeof *known; i++)
    if (!strncasecmp(s, known[i].text, strlen(known[i].text)))
      return known[i].factor;
  return 1;
}

const char *netlist_number(const char *text, double *out) {
  const char *s = text + (*text == '+' || *text == '-');
  if (!isdigit((unsigned char)*s) &&
      !(*s == '.' && isdigit((unsigned char)s[1])))
    return NULL;
  if (*s == '0' && (s[1] == 'x' || s[1] == 'X')) return NULL;
  char *end;
  *out = strtod(text, &end) * unit_suffix(end);
  while (isalpha((unsigned char)*end)) end++; /* skip the unit */
  return end;
}

/* ---- expressions ---- */

/* Reader of an expression. After a fault, `code` is set and the remaining text
   has no effect. */
typedef struct reader {
  const eda_netlist *n;
  const eda_scope *in;
  const eda_assignment *whole;
  const char *s;
  int *steps; /* shared with readers of the parameters */
  int depth, code;
} reader;

static double parse_sum(reader *r);

/* Report a fault, unless the reader has already reported one. Return 0. */
static double value_refuse(reader *r, const char *what) {
  if (!r->code)
    r->code = lines_refuse(r->n->lines, r->whole->at, "%s in '%.200s'", what,
                           r->whole->value);
  return 0;
}

static double value_evaluate(reader *r) {
  double value = parse_sum(r);
  if (*r->s) value_refuse(r, "not an expression");
  if (!isfinite(value)) value_refuse(r, "a number is not finite");
  return value;
}

static void skip_blanks(reader *r) {
  while (*r->s == ' ' || *r->s == '\t') r->s++;
}

static const eda_assignment *find_assignment(const eda_assignment *s, size_t n,
                                             const char *name) {
  for (size_t i = 0; i < n; i++)
    if (eda_same_name(s[i].name, name)) return &s[i];
  return NULL;
}

/* Return the value of a parameter. The order of precedence is: the instance,
   the defaults of the subcircuit, .param. Values of an instance are evaluated
   in the scope that contains the instance. */
static double parameter_value(reader *r, const char *name) {
  const eda_scope *in = r->in, *meant = in ? in->caller : NULL;
  const eda_assignment *s = NULL;
  if (in && in->call)
    s = find_assignment(in->call->setting, in->call->settings, name);
  if (!s && in) {
    meant = in;
    s = find_assignment(in->of->setting, in->of->settings, name);
  }
  uint32_t *global = s ? NULL : eda_names_find(&r->n->setting_of, name);
  if (global) {
    meant = NULL;
    s = &r->n->setting[*global];
  }
  if (!s) {
    r->code = lines_refuse(r->n->lines, r->whole->at,
                           "unknown parameter '%.100s'", name);
    return 0;
  }
  reader of = {r->n, meant, s, s->value, r->steps, r->depth + 1, OPC_OK};
  double value = value_evaluate(&of);
  r->code = of.code;
  return value;
}

static double value_named(reader *r) {
  char text[128];
  size_t n = 0;
  while (isalnum((unsigned char)*r->s) || *r->s == '_') {
    if (n + 1 == sizeof text) return value_refuse(r, "a name is too long");
    text[n++] = *r->s++;
  }
  text[n] = '\0';
  return parameter_value(r, text);
}

static double parse_primary(reader *r) {
  double value;
  if (r->code) return 0;
  if (++*r->steps > MAX_STEPS || r->depth > MAX_DEPTH)
    return value_refuse(
        r, "parameters are nested too deep or depend on each other in a cycle");
  skip_blanks(r);
  if (*r->s == '-' || *r->s == '+') {
    int minus = *r->s++ == '-';
    r->depth++;
    value = parse_primary(r);
    r->depth--;
    return minus ? -value : value;
  }
  if (*r->s == '(') {
    r->s++;
    r->depth++;
    value = parse_sum(r);
    r->depth--;
    if (*r->s != ')') return value_refuse(r, "a bracket is not closed");
    r->s++;
  } else if (isalpha((unsigned char)*r->s) || *r->s == '_') {
    value = value_named(r);
  } else {
    const char *end = netlist_number(r->s, &value);
    if (!end) return value_refuse(r, "a number is missing");
    r->s = end;
  }
  skip_blanks(r);
  return value;
}

static double parse_product(reader *r) {
  double value = parse_primary(r);
  while (!r->code && ((*r->s == '*' && r->s[1] != '*') || *r->s == '/'))
    value =
        *r->s++ == '/' ? value / parse_primary(r) : value * parse_primary(r);
  return value;
}

static double parse_sum(reader *r) {
  double value = parse_product(r);
  while (!r->code && (*r->s == '+' || *r->s == '-'))
    value =
        *r->s++ == '-' ? value - parse_product(r) : value + parse_product(r);
  return value;
}

int netlist_value(const eda_netlist *n, const eda_scope *in,
                  const eda_assignment *s, double *out) {
  int steps = 0;
  reader r = {n, in, s, s->value, &steps, 0, OPC_OK};
  *out = value_evaluate(&r);
  return r.code;
}
