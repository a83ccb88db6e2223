/* SPDX-License-Identifier: BSD-3-Clause */
/* Findings and warnings of a correction, logged as text. */
#pragma once

#include <eda/extractor.h>
#include <eda/print.h>
#include <opcflow/plugin.h>

#include <correct/guard.h>

/* Warn if most drawn gates are longer than wide and have more different lengths
   than widths, which suggests exchanged layers. Warn if lengths are near or
   beyond an end of the device table, except those of gates with a flavour.
   Prepare the extractor before the call. */
OPC_EXPORT void correct_findings_of_drawing(const opc_host *host,
                                            const eda_gates *gates,
                                            const opc_module *extractor);

/* Log the transistors that do not print, and transistors whose figures are
   extrapolated beyond the device table. `count`: number of transistors that
   each gate represents; NULL: one. `before` contains the flags of the drawn
   mask; NULL: not simulated. */
OPC_EXPORT void correct_findings_of_print(const opc_host *host,
                                          const eda_gates *gates,
                                          const uint32_t *count,
                                          const uint32_t *flags,
                                          const uint32_t *before);

/* Add the slices of a flat mask to *sum. `mask` has the printed images.
   `count`: number of transistors that each gate represents; NULL: one. [main]
 */
OPC_EXPORT int correct_slices_add(const opc_host *host, const eda_mask *mask,
                                  const uint32_t *count,
                                  const opc_module *extractor,
                                  eda_short_slices *sum, opc_error *error);
/* Log a finding if slices are shorter than the device model covers, and publish
   the metric `short_slices`. [main] */
OPC_EXPORT int correct_slices_report(const opc_host *host,
                                     const eda_short_slices *sum,
                                     opc_error *error);

/* Add and report the slices of a flat mask; do nothing without transistors.
   [main] */
OPC_EXPORT int correct_findings_of_slices(const opc_host *host,
                                          const eda_mask *mask,
                                          const opc_module *extractor,
                                          opc_error *error);

/* Return a copy of a host that discards messages, for repeated simulations of
   the same models. The copy is valid as long as `host`. */
OPC_EXPORT opc_host correct_findings_discarded(const opc_host *host);

/* Log the number of transistors that are worse than with the drawn mask, and
   the number of reverted transistors. `held`: 1 if the guard was on. */
OPC_EXPORT void correct_findings_of_guard(const opc_host *host,
                                          const guard *guard, int held);
