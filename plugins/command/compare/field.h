/* SPDX-License-Identifier: BSD-3-Clause */
/* The pairs of runs to compare, each with a base run, by case and method. */
#pragma once

#include <eda/runs.h>
#include <glib.h>
#include <opcflow/plugin.h>

typedef struct pair {
  const char *name;   /* of the case; "" without cases */
  const char *method; /* label of `other` */
  eda_run *base, *other;
} pair;

typedef struct field {
  const char *base;  /* label of the base of all pairs; "" if each method has
                        its own base */
  GArray *pairs;     /* pair, sorted by case, then method */
  GPtrArray *runs;   /* eda_run *, all runs */
  GPtrArray *labels; /* char *, labels of the runs */
  size_t cases, methods;
  int experiment;
  GPtrArray *owned; /* char * */
  GPtrArray *lists; /* eda_run_cases * */
} field;

/* Open the runs to compare. Accepted are two or more run folders, or variants
   of a flow (one file, and the variant names separated by commas). Also one
   experiment (the first method is the base), or two experiments (the first is
   the base, compared by case and method). Logs cases without a run by
   host->log. Call field_clear also after an error. */
int field_open(field *f, const opc_host *host, size_t n,
               const char *const *arguments, const char *variants,
               opc_error *error);
void field_clear(field *f);
