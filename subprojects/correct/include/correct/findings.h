/* SPDX-License-Identifier: BSD-3-Clause */
/* Findings and warnings of a correction, logged as text. */
#pragma once

#include <eda/extractor.h>
#include <opcflow/plugin.h>

#include <correct/guard.h>

/* Warn of drawn gates that are longer than wide, or whose size is near or
   beyond an end of the device table. Prepare the extractor before the call. */
OPC_EXPORT void correct_findings_of_drawing(const opc_host *host,
                                            const eda_gates *gates,
                                            const opc_module *extractor);

/* Log the transistors that do not print, and those whose figures are
   extrapolated beyond the device table. `before` are the flags of the mask as
   drawn; NULL: not simulated. */
OPC_EXPORT void correct_findings_of_print(const opc_host *host,
                                          const eda_gates *gates,
                                          const uint32_t *flags,
                                          const uint32_t *before);

/* Log the number of transistors worse than in the drawn mask and, if `held` is
   1, the number that the guard reverted. */
OPC_EXPORT void correct_findings_of_guard(const opc_host *host,
                                          const guard *guard, int held);
