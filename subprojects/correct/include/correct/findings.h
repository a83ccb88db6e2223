/* SPDX-License-Identifier: BSD-3-Clause */
/* What nobody may miss of a correction, said in words. */
#ifndef CORRECT_FINDINGS_H
#define CORRECT_FINDINGS_H

#include <eda/extractor.h>
#include <opcflow/plugin.h>

#include <correct/guard.h>

/* What a layout's drawn gates look like before anything is printed: longer than
   wide, near the ends of the device table or beyond (the extractor has been
   prepared). Warnings, with the likely cause. */
OPC_EXPORT void correct_findings_of_drawing(const opc_host *host,
                                            const eda_gates *gates,
                                            const opc_module *extractor);

/* What of a print is no transistor, and what figures are not to be trusted.
   `before` are the flags of the mask as drawn (NULL: it was not printed). */
OPC_EXPORT void correct_findings_of_print(const opc_host *host,
                                          const eda_gates *gates,
                                          const uint32_t *flags,
                                          const uint32_t *before);

/* What the guard has held, or would have. */
OPC_EXPORT void correct_findings_of_guard(const opc_host *host,
                                          const guard *guard, int held);

#endif
