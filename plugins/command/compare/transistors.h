/* SPDX-License-Identifier: BSD-3-Clause */
/* The transistors of two runs, one by one. */
#pragma once

#include "field.h"

/* Figures of a transistor, as the table gates has them after correction. */
enum { FIGURE_ION, FIGURE_IOFF, FIGURE_AREA, FIGURES };
extern const char *const figure_names[FIGURES];

typedef struct transistors {
  eda_table *base, *other; /* NULL: one of them has no table */
  size_t n;
  size_t *row; /* of each one of the base, in `other` */
  char *fault; /* why they are not the same ones; NULL: they are */
} transistors;

/* Join them by name; they must be as long and as wide as drawn. To be cleared
   in any case. */
int transistors_join(const pair *p, transistors *t, opc_error *error);
void transistors_clear(transistors *t);

/* Of each transistor for which both have a finite one: how far the figure is
   from what was drawn, in %, without its sign. Added to both (double). */
void transistors_add(const transistors *t, int figure, GArray *base,
                     GArray *other);
