/* SPDX-License-Identifier: BSD-3-Clause */
/* Does a plugin keep the contract? Each check runs in a process of its own, so
   that a crash or an endless loop is a finding like any other. */
#ifndef OPCFLOW_CORE_LINT_H
#define OPCFLOW_CORE_LINT_H

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

opc_lint *opc_lint_new(const char *path, opc_registry *registry,
                       const char *parameters, double seconds);
void opc_lint_run(opc_lint *lint);
void opc_lint_free(opc_lint *lint);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_lint, opc_lint_free)

#endif
