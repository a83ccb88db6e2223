/* SPDX-License-Identifier: BSD-3-Clause */
/* What a comparison shows. */
#pragma once

#include "field.h"

enum { SORT_FILE, SORT_NAME, SORT_CHANGE, SORT_VERDICT };

enum { BETTER, WORSE, SAME, DIFFERS, MISSING, VERDICTS };
extern const char *const verdict_words[VERDICTS];

typedef struct comparison {
  const opc_host *host;
  int anyway, all, cases;
  const char *chosen, *fail_on, *variant; /* words with commas; NULL: none */
  int sort;
  field field;
  GArray *rows;      /* metric_row: all that were chosen */
  GArray *intervals; /* transistor_row */
} comparison;

/* For rows of a type, with `data` that is there also if no row is. */
#define ROWS(type) g_array_sized_new(FALSE, FALSE, sizeof(type), 1)

/* A metric of a pair. */
typedef struct metric_row {
  const char *name, *method, *metric, *unit, *better, *word;
  double tolerance, base, value, change;
  int verdict;
  size_t order;
} metric_row;

/* A figure of all transistors of a method's pairs. */
typedef struct transistor_row {
  const char *method, *figure, *word;
  int64_t n;
  double base, value, change, low, high;
  int64_t better, worse, same;
  int verdict;
} transistor_row;

/* Whether a list with commas has the metric: by its name, by what stands behind
   the last dot of that, or by a pattern with * and ?. */
int is_chosen(const char *list, const char *metric);

/* Fill c->rows. OPC_INVALID if a word chooses nothing. */
int metrics_collect(comparison *c, opc_error *error);
int metrics_publish(comparison *c, opc_error *error);

/* Over the cases of an experiment: means, wins, losses, ties. */
int cases_publish(comparison *c, opc_error *error);

int runs_publish(comparison *c, opc_error *error);
int parameters_publish(comparison *c, opc_error *error);
int transistors_publish(comparison *c, opc_error *error);
int masks_publish(comparison *c, opc_error *error);

/* A table's columns but the first, where all runs have the same there. */
int put_table(comparison *c, const char *name, size_t rows, size_t size,
              const opc_column *columns, size_t n, opc_error *error);
