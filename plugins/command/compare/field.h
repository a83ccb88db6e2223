/* SPDX-License-Identifier: BSD-3-Clause */
/* What is held against what: runs of one base each, by case and method. */
#pragma once

#include <eda/runs.h>
#include <glib.h>
#include <opcflow/plugin.h>

typedef struct pair {
  const char *name;   /* of the case; "" where there are none */
  const char *method; /* the label of `other` */
  eda_run *base, *other;
} pair;

typedef struct field {
  const char *base;  /* the label of what all is held against; "" for that of
                        each method */
  GArray *pairs;     /* pair, by case, then method */
  GPtrArray *runs;   /* eda_run *: all of them */
  GPtrArray *labels; /* char *: of the runs */
  size_t cases, methods;
  int experiment;
  GPtrArray *owned; /* char * */
  GPtrArray *lists; /* eda_run_cases * */
} field;

/* Run folders (two or more), variants of a flow (one file, and their names with
   commas between them), one experiment (its first method is the base), or two
   (the first is the base, case by case, method by method). What has no run is
   told by host->log. To be cleared in any case. */
int field_open(field *f, const opc_host *host, size_t n,
               const char *const *arguments, const char *variants,
               opc_error *error);
void field_clear(field *f);
