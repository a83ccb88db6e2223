/* SPDX-License-Identifier: BSD-3-Clause */
/* The rules of the mask itself, of any method's mask. */
#ifndef CORRECT_RULES_H
#define CORRECT_RULES_H

#include <eda/gates.h>
#include <eda/rules.h>
#include <opcflow/plugin.h>

/* Tell where the masks of corrected layers, [gates->layers], do not keep rules:
   the table `mask_rules` and the metrics mask_violations and mask_RULE. */
int rules_report(const opc_host *host, const eda_gates *gates,
                 const eda_shapes *mask, const double limit[EDA_RULES],
                 opc_error *error);

#endif
