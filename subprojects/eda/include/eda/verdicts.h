/* SPDX-License-Identifier: BSD-3-Clause */
/* Differences of two methods on the same layouts, with intervals and a verdict
   in one sentence. */
#pragma once

#include <eda/median.h>
#include <eda/runs.h>

OPC_C_BEGIN

/* Figures that methods are compared by, in the order of the sentence. */
enum {
  EDA_CHANGE_LOST, /* transistors that do not print */
  EDA_CHANGE_ION,
  EDA_CHANGE_IOFF,
  EDA_CHANGE_AREA,
  EDA_CHANGE_SHOTS,
  EDA_CHANGE_VIOLATIONS,
  EDA_CHANGE_SECONDS,
  EDA_CHANGES
};

enum {
  EDA_VERDICT_SAME, /* no clear difference */
  EDA_VERDICT_BETTER,
  EDA_VERDICT_WORSE,
  EDA_VERDICT_FEW /* too few cells or cases */
};

/* Change of a figure from one method to another. Ion, Ioff and area are
   absolute deviations from drawn in %, and a change is in points. Shots and
   seconds change by a share of the first method's, in %. Others are numbers. */
typedef struct eda_change {
  const char *name;   /* "ion" */
  const char *title;  /* "Ion" */
  const char *unit;   /* of the changes: "points", "%" or "" */
  double base, value; /* means over all transistors, or sums over all cases */
  double change;      /* from base to value */
  eda_median median;  /* of the changes in median.n cells or cases */
  int64_t n;          /* transistors or cases; 0: no run has the figure */
  int64_t better, worse, same; /* of these */
  int verdict;                 /* EDA_VERDICT_SAME ... */
  const char *word;            /* "same", "better", "worse", "too few" */
} eda_change;

typedef struct eda_run_pair {
  eda_run *base, *other;
} eda_run_pair;

typedef struct eda_verdict {
  char *method, *against;
  eda_change changes[EDA_CHANGES]; /* from `against` to `method` */
  char *text; /* the sentence; the better method is named first */
} eda_verdict;

/* Fill *out with the changes over n pairs of runs, one for each case. Pairs
   with different transistors are left out. A figure of transistors is better or
   worse if the interval over the cells and the change of the mean are on one
   side. Shots and seconds are judged in the same way over the cases; with too
   few cases, a change of the sum decides (of seconds one above 10 %). The sums
   decide for violations and transistors that do not print. Call
   eda_verdict_clear in any case. Errors as in eda_run_table. [main] */
OPC_EXPORT int eda_verdict_init(eda_verdict *out, const char *method,
                                const char *against, size_t n,
                                const eda_run_pair *pairs, opc_error *error);
OPC_EXPORT void eda_verdict_clear(eda_verdict *v);

/* Return the verdicts of all pairs of methods, *n of them. The run folder of
   case c by method m is folders[c * n_methods + m], NULL for a failed run.
   Returns NULL and *error if a folder cannot be read. Free with
   eda_verdicts_free. [main] */
OPC_EXPORT eda_verdict *eda_verdicts_new(size_t n_cases, size_t n_methods,
                                         const char *const *methods,
                                         const char *const *folders, size_t *n,
                                         opc_error *error);
OPC_EXPORT void eda_verdicts_free(eda_verdict *verdicts, size_t n);

/* Set *why to the reason for which the transistors of two runs cannot be
   compared one by one, in memory from malloc; NULL if they can. Errors as in
   eda_run_table. [main] */
OPC_EXPORT int eda_run_unlike(eda_run *base, eda_run *other, char **why,
                              opc_error *error);

OPC_C_END
