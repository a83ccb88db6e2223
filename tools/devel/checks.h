/* SPDX-License-Identifier: BSD-3-Clause */
/* The checks of `opcflow lint`, each for a process of its own. */
#ifndef OPCFLOW_CORE_CHECKS_H
#define OPCFLOW_CORE_CHECKS_H

#include "tools/devel/lint.h"

typedef struct opc_check {
  const char *name;
  gboolean works;      /* gives a digest, if the kind says how to try it */
  const char *differs; /* what it means if that is not the first one */
} opc_check;

/* All of them, the first about loading; the last has no name. */
extern const opc_check opc_checks[];

/* Do check i and write what it says: lines of a letter and a text. F: what is
   wrong; N: what could not be checked, and why; D: the digest of what the
   plugin gave; S: the number of the sample file that it works with; E: the
   end. */
void opc_check_do(const opc_lint *lint, size_t i, int out);

#endif
