/* SPDX-License-Identifier: BSD-3-Clause */
/* Pairs of transistors of two runs, and changes of their figures by cell. */
#pragma once

#include <eda/median.h>
#include <eda/runs.h>
#include <glib.h>

/* Figures of a transistor after correction. */
enum { FIGURE_ION, FIGURE_IOFF, FIGURE_AREA, FIGURES };

typedef struct transistors {
  eda_table *base, *other; /* NULL: the run has no table */
  size_t n;
  size_t *row; /* for each row of `base`, the row in `other` */
  char *fault; /* why the transistors differ; NULL: they are the same */
} transistors;

/* Join the tables of the verification (of a step `verify` in both runs), or
   else `gates`, by name; drawn lengths and widths must be equal. Returns 0, or
   an error code with *error filled. Call transistors_clear in any case. */
int transistors_join(eda_run *base, eda_run *other, transistors *t,
                     opc_error *error);
void transistors_clear(transistors *t);

/* Changes of a figure from the base runs to the others, over all pairs of a
   method: absolute deviations from the drawn value, in %. Transistors without
   finite values in both runs are left out. */
typedef struct changes {
  double base, value; /* sums over the transistors */
  int64_t n, better, worse;
  int64_t lost_base, lost; /* transistors without a finite value */
  GHashTable *index;       /* cell -> its place in `cells`, plus 1 */
  GArray *cells;           /* of a type private to changes.c */
} changes;

changes changes_new(void);
void changes_add(changes *c, const transistors *t, int figure);
void changes_clear(changes *c);

/* Return the median over the cells of the mean change of a cell. Transistors of
   one cell are similar in all its placements, so cells are the independent
   values. Cells of equal name in several layouts are one cell. */
eda_median changes_median(const changes *c);
