/* SPDX-License-Identifier: BSD-3-Clause */
/* Expressions of layers, such as "(66/20 + 33/43) - 33/42" (eda/layout.h). */
#pragma once

#include <eda/layout.h>
#include <glib.h>

typedef enum expression_kind {
  EXPRESSION_LAYER,
  EXPRESSION_BOOLEAN,
  EXPRESSION_GROW
} expression_kind;

typedef struct expression {
  expression_kind kind;
  int op;                   /* of a boolean: EDA_OR ... EDA_XOR */
  double length;            /* of a growth, nm; negative: shrink */
  char *text;               /* of the whole expression; NULL: a part */
  char *name;               /* of a layer */
  int32_t layer;            /* number of the layer, set by the owner */
  struct expression *a, *b; /* operands; `b` only of a boolean */
} expression;

/* Parse a text. Return NULL and *error with the position of the fault on
   failure. The caller calls expression_free. [any] */
expression *expression_parse(const char *text, opc_error *error);

/* Free an expression (NULL: do nothing). */
void expression_free(expression *e);
