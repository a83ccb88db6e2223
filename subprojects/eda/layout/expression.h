/* SPDX-License-Identifier: BSD-3-Clause */
/* Expressions of layers, such as "(66/20 + 33/43) - 33/42" (eda/layout.h). */
#pragma once

#include <eda/layout.h>
#include <glib.h>

/* Kinds of nodes of an expression. */
typedef enum expression_kind {
  EXPRESSION_LAYER,
  EXPRESSION_BOOLEAN,
  EXPRESSION_GROW
} expression_kind;

/* A node of an expression, with its operands. */
typedef struct expression {
  expression_kind kind;
  int op;        /* BOOLEAN: EDA_OR ... EDA_XOR */
  double length; /* GROW: growth, nm; negative: shrink */
  char *text;    /* text of the whole expression; NULL in operands */
  char *name;    /* LAYER: name */
  int32_t layer; /* LAYER: number, -1 until the owner of the expression sets
                    the number */
  struct expression *a, *b; /* operands of BOOLEAN; `a`: operand of GROW */
} expression;

/* Parse a text. Return NULL and *error with the position of the fault on
   failure. The caller calls expression_free. [any] */
expression *expression_parse(const char *text, opc_error *error);

/* Free an expression (NULL: do nothing). */
void expression_free(expression *e);
