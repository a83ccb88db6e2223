/* SPDX-License-Identifier: BSD-3-Clause */
/* Does a plugin keep the contract? Each check runs in a process of its own, so
   that a crash or an endless loop is a finding like any other. */
#ifndef OPCFLOW_CORE_LINT_H
#define OPCFLOW_CORE_LINT_H

#include "core/flow/binding.h"

typedef struct opc_lint {
  const char *path; /* of the shared object, ID.so */
  char *id;
  opc_registry *registry; /* for the plugins in its slots */
  const char *parameters; /* a map in flow syntax, over what is made up */
  double seconds;         /* that one check may take */
  GPtrArray *findings;    /* char *: what is wrong */
  GPtrArray *notes;       /* char *: what could not be checked, and why */
} opc_lint;

opc_lint *opc_lint_new(const char *path, opc_registry *registry,
                       const char *parameters, double seconds);
void opc_lint_run(opc_lint *lint);
void opc_lint_free(opc_lint *lint);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_lint, opc_lint_free)

/* ---- exports.c ---- */

/* The names that a shared object exports, sorted (char *); NULL and *reason
   (g_free) if it cannot be read. */
GPtrArray *opc_exports(const char *path, char **reason);

/* ---- exercise.c ---- */

/* Where a check writes what it finds; ends the check's process if called with
   what cannot be gone on from. */
typedef struct opc_inspector {
  int out;
  GChecksum *digest; /* of all that the plugin gave */
} opc_inspector;

void opc_find(opc_inspector *inspector, const char *format, ...)
    OPC_PRINTF(2, 3);
void opc_note(opc_inspector *inspector, const char *format, ...)
    OPC_PRINTF(2, 3);

/* Call the operations of an instance with small inputs of their kind, check
   what they give and add it to the digest. */
void opc_exercise(opc_inspector *inspector, const opc_module *module);

#endif
