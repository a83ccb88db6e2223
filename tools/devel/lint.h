/* SPDX-License-Identifier: BSD-3-Clause */
/* Does a plugin keep the contract? Each check runs in a process of its own, so
   that a crash or an endless loop is a finding like any other. */
#ifndef OPCFLOW_DEVEL_LINT_H
#define OPCFLOW_DEVEL_LINT_H

#include "core/binding/binding.h"

/* No sample file is of the form that a plugin wants. */
#define OPC_NO_SAMPLE G_MAXSIZE

typedef struct opc_lint {
  const char *path; /* of the shared object, ID.so */
  char *id;
  opc_registry *registry; /* for its kind and the plugins in its slots */
  const char *parameters; /* a map in flow syntax, over what is made up */
  double seconds;         /* that one check may take */
  char *folder;           /* for sample files and what plugins write */
  int alive, janitor;  /* a pipe's end; who removes the folder when it ends */
  size_t sample;       /* the file that the plugin works with */
  GPtrArray *findings; /* char *: what is wrong */
  GPtrArray *checked;  /* char *: what was looked at */
  GPtrArray *notes;    /* char *: what could not be, and why */
} opc_lint;

typedef struct opc_inspection opc_inspection;

typedef struct opc_check {
  const char *name;
  gboolean works;      /* gives a digest, if the kind says how to try it */
  const char *differs; /* what it means if that is not the first one */
  void (*work)(opc_inspection *in);
} opc_check;

/* All of them, the first about loading; the last has no name. */
extern const opc_check opc_checks[];

/* Do check i and write what it says: lines of a letter and a text. F: what is
   wrong; N: what could not be checked, and why; D: the digest of what the
   plugin gave; S: the number of the sample file that it works with; E: the
   end. */
void opc_check_do(const opc_lint *lint, size_t i, int out);

#endif
