/* SPDX-License-Identifier: BSD-3-Clause */
/* The runs to compare, in pairs: for each case and method, a run and the base
   run to which it is compared. */
#pragma once

#include <eda/runs.h>
#include <glib.h>
#include <opcflow/plugin.h>

/* A run and its base run. */
typedef struct pair {
  const char *name;   /* name of the case; "" without cases */
  const char *method; /* label of `other` */
  eda_run *base, *other;
} pair;

/* All runs of a comparison. */
typedef struct field {
  const char *base;  /* label of the common base run; "" if each method has a
                        separate base run */
  GArray *pairs;     /* pair, sorted by case, then method */
  GPtrArray *runs;   /* eda_run *, all runs */
  GPtrArray *labels; /* char *, labels of the runs */
  size_t cases, methods; /* numbers of cases and of methods in `pairs` */
  int experiment;        /* 1: the arguments are experiments */
  GPtrArray *owned;      /* char *, texts that are freed with the field */
  GPtrArray *lists;      /* eda_run_cases *, the opened experiments */
} field;

/* Open the runs to compare. The arguments are one of:
     - two or more run folders; the first run is the base of all others;
     - a flow file, with `variants`, names separated by commas; the latest run
   of the first variant is the base;
     - an experiment; in each case, the run of the first method is the base;
     - two experiments; each run of the second has as its base the run of the
       same case and method of the first.
   Logs cases without a run by host->log. Call field_clear also after an
   error. */
int field_open(field *f, const opc_host *host, size_t n,
               const char *const *arguments, const char *variants,
               opc_error *error);
void field_clear(field *f);
