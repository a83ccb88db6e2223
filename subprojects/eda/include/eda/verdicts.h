/* SPDX-License-Identifier: BSD-3-Clause */
/* Comparison of two correction methods on the same layouts (cases): changes of
   figures, confidence intervals, and a verdict in one sentence. Figures are
   numbers of a run, such as the deviations of Ion or the mask shots. [main]:
   see opcflow/plugin.h. */
#pragma once

#include <eda/median.h>
#include <eda/runs.h>

OPC_C_BEGIN

/* Compared figures, in the order in which the sentence (eda_verdict.text) names
   them. */
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

/* Verdict on a figure. */
enum {
  EDA_VERDICT_SAME, /* no significant difference */
  EDA_VERDICT_BETTER,
  EDA_VERDICT_WORSE,
  EDA_VERDICT_FEW /* too few cells for a confidence interval */
};

/* Change of a figure from a base method to another. Ion, Ioff and area are
   absolute deviations from the drawn transistor, %, with changes in percentage
   points. Changes of shots and seconds are relative to the base method, %.
   Seconds are the sum over the steps of a run; a reused result counts with the
   time of its computation. Other figures are counts. */
typedef struct eda_change {
  const char *name;   /* "ion" */
  const char *title;  /* "Ion" */
  const char *unit;   /* unit of changes: "points", "%" or "" */
  double base, value; /* values of both methods: means over all transistors, or
                         sums over all cases */
  double change;      /* change from `base` to `value` */
  eda_median median;  /* median of the changes: over median.n layout cells, each
                         with the mean change of its transistors, or over
                         median.n cases */
  int64_t n;          /* number of transistors or cases that both runs
                         have; 0: no pair has the figure. EDA_CHANGE_LOST: 1 if
                         a transistor does not print in a run, else 0 */
  int64_t better, worse, same; /* numbers of transistors or cases */
  int verdict;                 /* EDA_VERDICT_SAME ... */
  const char *word;            /* "same", "better", "worse", "too few" */
} eda_change;

/* Two runs of one case: of the base method and of the other method. */
typedef struct eda_run_pair {
  eda_run *base, *other;
} eda_run_pair;

/* Verdict on two methods. */
typedef struct eda_verdict {
  char *method, *against;
  eda_change changes[EDA_CHANGES]; /* changes from `against` to `method` */
  char *text; /* the sentence; begins with the method that is better in the
                 first decided figure, or with "no verdict on" */
} eda_verdict;

/* Compute the changes over n pairs of runs, one pair for each case; pairs with
   different transistors are omitted. Ion, Ioff and area are better or worse if
   the confidence interval over cells excludes 0 and the mean has changed in the
   same direction. Shots and seconds use the interval over cases. With too few
   cases for an interval, any change of the sum of shots decides, and a change
   of the sum of seconds above 10 %. For all other figures, any change of the
   sum decides. The caller calls eda_verdict_clear, also after a failure.
   Errors: as eda_run_table. [main] */
OPC_EXPORT int eda_verdict_init(eda_verdict *out, const char *method,
                                const char *against, size_t n,
                                const eda_run_pair *pairs, opc_error *error);
/* Free the texts and clear the struct. */
OPC_EXPORT void eda_verdict_clear(eda_verdict *v);

/* Return the *n verdicts of all pairs of methods, of each method against each
   preceding method; free them with eda_verdicts_free. The run folder of case c
   and method m is folders[c * n_methods + m], NULL for a failed run. Return
   NULL and *error if a folder cannot be read. [main] */
OPC_EXPORT eda_verdict *eda_verdicts_new(size_t n_cases, size_t n_methods,
                                         const char *const *methods,
                                         const char *const *folders, size_t *n,
                                         opc_error *error);
/* Free n verdicts (NULL: do nothing). */
OPC_EXPORT void eda_verdicts_free(eda_verdict *verdicts, size_t n);

/* Set *why to NULL if the transistors of two runs correspond one to one;
   otherwise to the reason, which the caller frees with free(). Errors: as
   eda_run_table. [main] */
OPC_EXPORT int eda_run_unlike(eda_run *base, eda_run *other, char **why,
                              opc_error *error);

OPC_C_END
