/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers with suffixes, and expressions of them and of parameters. */
#include "netlist/lines.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>


/* Steps of one expression with all parameters in it, and how deep they go. */
enum { MAX_STEPS = 10000, MAX_DEPTH = 64 };

/* ---- numbers ---- */

static double suffix(const char *s) {
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
  *out = strtod(text, &end) * suffix(end);
  while (isalpha((unsigned char)*end)) end++; /* the rest is its unit */
  return end;
}

/* ---- expressions ---- */

typedef struct reader {
  const eda_netlist *n;
  const eda_scope *in;
  const eda_assignment *whole;
  const char *s;
  int *steps;
  int depth;
} reader;

static int evaluate(const eda_netlist *n, const eda_scope *in, const eda_assignment *s, int *steps,
                    int depth, double *out);

static int refuse(reader *r, const char *what) {
  return lines_refuse(r->n->lines, r->whole->at, "%s in '%.200s'", what,
                        r->whole->value);
}

static void blanks(reader *r) {
  while (*r->s == ' ' || *r->s == '\t') r->s++;
}

static const eda_assignment *among(const eda_assignment *s, size_t n, const char *name) {
  for (size_t i = 0; i < n; i++)
    if (eda_same_name(s[i].name, name)) return &s[i];
  return NULL;
}

/* What a name means: set by the call, else by the subcircuit, else by .param.
   A call's value is meant where the call stands. */
static int parameter(reader *r, const char *name, double *out) {
  const eda_scope *in = r->in;
  const eda_assignment *s = NULL;
  if (in && in->call)
    if ((s = among(in->call->setting, in->call->settings, name)))
      return evaluate(r->n, in->caller, s, r->steps, r->depth + 1, out);
  if (in && (s = among(in->of->setting, in->of->settings, name)))
    return evaluate(r->n, in, s, r->steps, r->depth + 1, out);
  uint32_t *global = eda_names_find(&r->n->setting_of, name, strlen(name));
  if (global)
    return evaluate(r->n, NULL, &r->n->setting[*global], r->steps, r->depth + 1,
                    out);
  return lines_refuse(r->n->lines, r->whole->at, "unknown parameter '%.100s'", name);
}

static int sum(reader *r, double *out);

static int name(reader *r, double *out) {
  char text[128];
  size_t n = 0;
  while (isalnum((unsigned char)*r->s) || *r->s == '_') {
    if (n + 1 == sizeof text) return refuse(r, "a name is too long");
    text[n++] = *r->s++;
  }
  text[n] = '\0';
  return parameter(r, text, out);
}

static int primary(reader *r, double *out) {
  if (++*r->steps > MAX_STEPS || r->depth > MAX_DEPTH)
    return refuse(r, "parameters go too deep or in a circle");
  blanks(r);
  if (*r->s == '-' || *r->s == '+') {
    int minus = *r->s++ == '-';
    r->depth++;
    int code = primary(r, out);
    r->depth--;
    if (minus) *out = -*out;
    return code;
  }
  if (*r->s == '(') {
    r->s++;
    r->depth++;
    int code = sum(r, out);
    r->depth--;
    if (code) return code;
    if (*r->s != ')') return refuse(r, "a bracket is not closed");
    r->s++;
  } else if (isalpha((unsigned char)*r->s) || *r->s == '_') {
    int code = name(r, out);
    if (code) return code;
  } else {
    const char *end = netlist_number(r->s, out);
    if (!end) return refuse(r, "a number is missing");
    r->s = end;
  }
  blanks(r);
  return OPC_OK;
}

static int product(reader *r, double *out) {
  int code = primary(r, out);
  while (!code && ((*r->s == '*' && r->s[1] != '*') || *r->s == '/')) {
    int divide = *r->s++ == '/';
    double by = 0;
    code = primary(r, &by);
    *out = divide ? *out / by : *out * by;
  }
  return code;
}

static int sum(reader *r, double *out) {
  int code = product(r, out);
  while (!code && (*r->s == '+' || *r->s == '-')) {
    int minus = *r->s++ == '-';
    double more = 0;
    code = product(r, &more);
    *out += minus ? -more : more;
  }
  return code;
}

static int evaluate(const eda_netlist *n, const eda_scope *in, const eda_assignment *s, int *steps,
                    int depth, double *out) {
  reader r = {n, in, s, s->value, steps, depth};
  *out = 0;
  int code = sum(&r, out);
  if (code) return code;
  if (*r.s) return refuse(&r, "something that is no expression");
  if (!isfinite(*out)) return refuse(&r, "a number without bounds");
  return OPC_OK;
}

int netlist_value(const eda_netlist *n, const eda_scope *in, const eda_assignment *s, double *out) {
  int steps = 0;
  return evaluate(n, in, s, &steps, 0, out);
}
