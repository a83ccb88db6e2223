/* SPDX-License-Identifier: BSD-3-Clause */
/* Rows and tables of a comparison. */
#pragma once

#include <eda/verdicts.h>

#include "field.h"

/* Order of the rows: as in the files, by name, by size of the change, by
   verdict. */
enum { SORT_FILE, SORT_NAME, SORT_CHANGE, SORT_VERDICT };

/* Verdict on a metric. */
enum { BETTER, WORSE, SAME, DIFFERS, MISSING, VERDICTS };

/* State of the command. */
typedef struct comparison {
  const opc_host *host;
  int anyway, all, cases; /* options of the command (compare.c) */
  const char *chosen, *fail_on,
      *variant; /* options: words separated by commas, or NULL */
  int sort;     /* SORT_FILE ... */
  field field;
  GArray *rows;         /* metric_row, all selected metrics */
  GArray *intervals;    /* transistor_row */
  GPtrArray *sentences; /* char *, a verdict for each method */
} comparison;

/* Allocate an array of rows of a type; `data` is never NULL. */
#define ROWS(type) g_array_sized_new(FALSE, FALSE, sizeof(type), 1)

/* A metric of a pair of runs. `better` is the better direction, `word` the
   verdict as a word, `order` the order in which rows with equal keys are
   sorted. */
typedef struct metric_row {
  const char *name, *method, *metric, *unit, *better, *word;
  double tolerance, base, value, change;
  int verdict;
  size_t order;
} metric_row;

/* Change of a figure (Ion, Ioff or area) of all transistors in the pairs of a
   method. */
typedef struct transistor_row {
  const char *method;
  eda_change c;
} transistor_row;

/* Return whether a comma-separated list selects the metric: by full name, by
   the part after the last dot, or by a pattern with * and ?. */
int is_chosen(const char *list, const char *metric);

/* Fill c->rows, OPC_INVALID if a word selects no metric; publish the table of
   the metrics. Return the status. */
int metrics_collect(comparison *c, opc_error *error);
int metrics_publish(comparison *c, opc_error *error);

/* Publish statistics over the cases of an experiment: means, wins, losses,
   ties. Returns the status. */
int cases_publish(comparison *c, opc_error *error);

/* Publish the table of the runs; of the parameters that differ between runs; of
   the changes of transistors. Return the status. */
int runs_publish(comparison *c, opc_error *error);
int parameters_publish(comparison *c, opc_error *error);
int transistors_publish(comparison *c, opc_error *error);

/* Publish the verdicts that transistors_publish found; publish the differences
   of the mask files (masks.h). Return the status. */
int verdicts_publish(comparison *c, opc_error *error);
int masks_publish(comparison *c, opc_error *error);

/* Publish a table; the leading columns (case, method) are omitted if equal in
   all rows. Returns the status. */
int put_table(comparison *c, const char *name, size_t rows, size_t size,
              const opc_column *columns, size_t n, opc_error *error);
