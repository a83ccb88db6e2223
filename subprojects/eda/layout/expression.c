/* SPDX-License-Identifier: BSD-3-Clause */
/* Parser of layer expressions, by recursive descent:

     expression = product { ("+" | "-" | "^") product }
     product    = operand { "&" operand }
     operand    = "(" expression ")" | layer
                | ("grow" | "shrink") "(" expression "," length ")" */
#include "layout/expression.h"

#include <base/unit.h>
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

#define OPERATORS "+-^&(),"

/* Largest numbers of nested brackets and of operands, which limit the depth of
   recursions; longest growth, nm. */
enum { MOST_NESTED = 64, MOST_OPERANDS = 256, MOST_LENGTH = 1000000 };

typedef struct parser {
  const char *text, *at;
  int nested, operands;
  opc_error *error;
} parser;

void expression_free(expression *e) {
  if (!e) return;
  expression_free(e->a);
  expression_free(e->b);
  g_free(e->name);
  g_free(e->text);
  free(e);
}

static expression *parser_fail(parser *p, const char *expected) {
  int end = !*p->at;
  opc_fail(p->error, OPC_INVALID, NULL,
           "'%.200s': expected %s at character %zu, found %s%.*s%s", p->text,
           expected, (size_t)(p->at - p->text) + 1, end ? "the end" : "'",
           end ? 0 : 1, p->at, end ? "" : "'");
  return NULL;
}

static void skip_blanks(parser *p) {
  while (g_ascii_isspace(*p->at)) p->at++;
}

/* Skip blanks. If the character c follows, skip it and return 1; otherwise
   return 0. */
static int parser_accept(parser *p, char c) {
  skip_blanks(p);
  if (*p->at != c) return 0;
  p->at++;
  return 1;
}

static expression *expression_new(expression_kind kind, int op, expression *a,
                                  expression *b) {
  expression *e = eda_alloc(1, sizeof *e);
  e->kind = kind;
  e->op = op;
  e->layer = -1;
  e->a = a;
  e->b = b;
  return e;
}

static expression *parse_sum(parser *p);

/* Parse a positive length with its unit. Return 0 on failure. */
static double parse_length(parser *p) {
  skip_blanks(p);
  const char *start = p->at;
  size_t n = opc_number_length(start);
  p->at += n;
  skip_blanks(p);
  size_t letters = strcspn(p->at, OPERATORS " ");
  g_autofree char *name = g_strndup(p->at, letters);
  const opc_unit *unit = n ? opc_unit_find(name) : NULL;
  const opc_unit *nm = opc_unit_find("nm");
  p->at += letters;
  double length = unit && opc_unit_noun(unit) == opc_unit_noun(nm)
                      ? opc_number_in(start, n, unit, nm)
                      : 0;
  if (length > 0 && length < MOST_LENGTH) return length;
  p->at = start;
  parser_fail(p, "a length above 0 and below 1 mm with its unit (10 nm)");
  return 0;
}

/* Parse the arguments of grow or shrink after the opening bracket. */
static expression *parse_growth(parser *p, int sign) {
  expression *a = parse_sum(p);
  if (!a) return NULL;
  double length = 0;
  if (parser_accept(p, ','))
    length = parse_length(p);
  else
    parser_fail(p, "',' and a length");
  if (length > 0 && !parser_accept(p, ')')) {
    parser_fail(p, "')'");
    length = 0;
  }
  if (!(length > 0)) {
    expression_free(a);
    return NULL;
  }
  expression *e = expression_new(EXPRESSION_GROW, 0, a, NULL);
  e->length = sign * length;
  return e;
}

static expression *parse_brackets(parser *p) {
  expression *e = parse_sum(p);
  if (!e || parser_accept(p, ')')) return e;
  expression_free(e);
  return parser_fail(p, "')' or an operator");
}

static expression *parse_operand(parser *p) {
  skip_blanks(p);
  size_t n = strcspn(p->at, OPERATORS " \t\n");
  const char *word = p->at;
  if (++p->operands > MOST_OPERANDS)
    return parser_fail(p, "at most 256 operands");
  if (!n && *word != '(') return parser_fail(p, "a layer or '('");
  p->at += n;
  int growth = 0;
  if (n == 4 && !strncmp(word, "grow", n)) growth = 1;
  if (n == 6 && !strncmp(word, "shrink", n)) growth = -1;
  if ((n && !growth) || !parser_accept(p, '(')) {
    expression *e = expression_new(EXPRESSION_LAYER, 0, NULL, NULL);
    e->name = g_strndup(word, n);
    return e;
  }
  if (++p->nested > MOST_NESTED)
    return parser_fail(p, "at most 64 nested brackets");
  expression *e = growth ? parse_growth(p, growth) : parse_brackets(p);
  p->nested--;
  return e;
}

static expression *parse_product(parser *p) {
  expression *e = parse_operand(p);
  while (e && parser_accept(p, '&')) {
    expression *b = parse_operand(p);
    e = expression_new(EXPRESSION_BOOLEAN, EDA_AND, e, b);
    if (b) continue;
    expression_free(e);
    e = NULL;
  }
  return e;
}

/* If +, - or ^ follows, skip the operator and return its number, EDA_OR,
   EDA_NOT or EDA_XOR; otherwise return -1. */
static int sum_operator(parser *p) {
  if (parser_accept(p, '+')) return EDA_OR;
  if (parser_accept(p, '-')) return EDA_NOT;
  return parser_accept(p, '^') ? EDA_XOR : -1;
}

static expression *parse_sum(parser *p) {
  expression *e = parse_product(p);
  for (int op; e && (op = sum_operator(p)) >= 0;) {
    expression *b = parse_product(p);
    e = expression_new(EXPRESSION_BOOLEAN, op, e, b);
    if (b) continue;
    expression_free(e);
    e = NULL;
  }
  return e;
}

expression *expression_parse(const char *text, opc_error *error) {
  parser p = {.text = text, .at = text, .error = error};
  expression *e = parse_sum(&p);
  skip_blanks(&p);
  if (e && *p.at) {
    expression_free(e);
    return parser_fail(&p, "an operator or the end");
  }
  if (e) e->text = g_strdup(text);
  return e;
}

int eda_layer_is_expression(const char *text) {
  return strpbrk(text, OPERATORS " ") != NULL;
}

static void take_names(const expression *e,
                       void (*take)(void *data, const char *name), void *data) {
  if (e->name) take(data, e->name);
  if (e->a) take_names(e->a, take, data);
  if (e->b) take_names(e->b, take, data);
}

int eda_layer_names(const char *text,
                    void (*take)(void *data, const char *name), void *data,
                    opc_error *error) {
  expression *e = expression_parse(text, error);
  if (!e) return error->code;
  take_names(e, take, data);
  expression_free(e);
  return OPC_OK;
}

static void ignore_name(void *data, const char *name) {
  (void)data;
  (void)name;
}

int eda_layer_check(const char *text, opc_error *error) {
  return eda_layer_names(text, ignore_name, NULL, error);
}
