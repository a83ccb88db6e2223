/* SPDX-License-Identifier: BSD-3-Clause */
/* Pairs of transistors of two runs. */
#pragma once

#include "field.h"

/* Figures of a transistor after correction, from the table `gates`. */
enum { FIGURE_ION, FIGURE_IOFF, FIGURE_AREA, FIGURES };
extern const char *const figure_names[FIGURES];

typedef struct transistors {
  eda_table *base, *other; /* NULL: the run has no table */
  size_t n;
  size_t *row; /* for each row of `base`, the row in `other` */
  char *fault; /* why the transistors differ; NULL: they are the same */
} transistors;

/* Join the tables by name; drawn lengths and widths must be equal. Returns 0,
   or an error code with *error filled. Call transistors_clear in any case. */
int transistors_join(const pair *p, transistors *t, opc_error *error);
void transistors_clear(transistors *t);

/* Append to both arrays (double) the absolute deviation of the figure from the
   drawn value, in %, of each transistor with finite values in both runs. */
void transistors_add(const transistors *t, int figure, GArray *base,
                     GArray *other);
