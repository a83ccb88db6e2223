/* SPDX-License-Identifier: BSD-3-Clause */
/* Does a plugin keep the contract? Each check runs in a process of its own, so
   that a crash or an endless loop is a finding like any other. */
#pragma once

#include "core/binding/binding.h"

/* No sample file is of the form that a plugin wants. */
#define OPC_NO_SAMPLE G_MAXSIZE

typedef struct opc_lint {
  const char *path; /* of the shared object, ID.so */
  char *id;
  opc_registry *registry; /* for its kind and the plugins in its slots */
  const char *parameters; /* a map in flow syntax, over the made-up one */
  double seconds;         /* that a call may take */
  char *folder;           /* for sample files and output of plugins */
  int alive, janitor;  /* a pipe's end; who removes the folder when it ends */
  size_t sample;       /* the file that the plugin works with */
  GPtrArray *findings; /* char *: faults */
  GPtrArray *checked;  /* char *: names of checks */
  GPtrArray *notes;    /* char *: checks that were not made, and why */
} opc_lint;

typedef struct opc_inspection opc_inspection;

typedef struct opc_check {
  const char *name;
  gboolean works;      /* has a digest, if the kind says how to try it */
  const char *differs; /* the meaning of a digest that differs from the first */
  void (*work)(opc_inspection *in);
} opc_check;

/* All of them, the first about loading; the last has no name. */
extern const opc_check opc_checks[];

/* Run check i and write its report: lines of a letter and a text. F: a fault;
   N: a check that was not made, and why; D: the digest of the results; S: the
   number of the sample file; T: a sign of life; B: the plugin changed the
   process, which ends; E: the end. */
void opc_check_do(const opc_lint *lint, size_t i, int out);
