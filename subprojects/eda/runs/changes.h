/* SPDX-License-Identifier: BSD-3-Clause */
/* Pairs of equal transistors of two runs, and changes of their figures by
   cell. */
#pragma once

#include <eda/median.h>
#include <eda/runs.h>
#include <glib.h>

/* Figures of a transistor after correction, in gates.csv. */
enum { FIGURE_ION, FIGURE_IOFF, FIGURE_AREA, FIGURES };

/* Pairs of transistors of two runs. */
typedef struct transistors {
  eda_table *base,
      *other; /* owned by the runs; NULL: a run has no transistor table */
  size_t n;
  size_t *row;      /* row of `other` for each pair */
  size_t *base_row; /* row of `base` for each pair; NULL: equal to the pair */
  double *count;    /* number of transistors of each pair; NULL: 1 */
  char *fault; /* description of the first difference between the transistors;
                  NULL: none */
} transistors;

/* Join the transistor tables of two runs. If both runs have the table of a step
   that uses the plugin `verify`, join these tables, otherwise the tables
   `gates`. If a step also wrote a table of all transistors (its parameter
   `transistors`), use that table instead. Rows are joined by the name of the
   transistor. If a table has a row for each class of equivalent transistors,
   rows are joined by the position of the transistor that represents the class.
   Differing names or drawn sizes set t->fault. Return OPC_OK, or a code and
   *error. Call transistors_clear in either case. */
int transistors_join(eda_run *base, eda_run *other, transistors *t,
                     opc_error *error);
void transistors_clear(transistors *t);

/* Changes of a figure from base runs to other runs, summed over all pairs of
   runs of two methods. The figure is the absolute deviation from the drawn
   transistor, %. A transistor counts only if both runs have a finite value. */
typedef struct changes {
  double base, value; /* sums of the figure over the transistors */
  int64_t n, better, worse;
  int64_t lost_base, lost; /* transistors without a finite value in the base
                              run, and in the other run */
  GHashTable *index;       /* cell name -> (index in `cells`) + 1 */
  GArray *cells;           /* elements: a type private to changes.c */
} changes;

/* Return changes without pairs; add the changes of a figure (FIGURE_ION ...) of
   all pairs; free the changes. */
changes changes_new(void);
void changes_add(changes *c, const transistors *t, int figure);
void changes_clear(changes *c);

/* Return the median over all cells of the cell's mean change. Instances of a
   cell have similar changes, so only cells are independent values. Cells with
   equal names in several layouts count as one cell. */
eda_median changes_median(const changes *c);
