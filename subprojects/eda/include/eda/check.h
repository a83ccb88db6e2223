/* SPDX-License-Identifier: BSD-3-Clause */
/* Calls of modules of the kinds litho, resist, extractor, synthesizer and
   regulator, and checks of the results. A module (opc_module, base.h) is an
   instance of a plugin with its functions. Each check returns OPC_OK, or
   OPC_FAILED and a description in *error. eda_blame then adds the slot, which
   is the parameter of a step that selects the module:

     const char *before = eda_enter(context, module, error);
     int code = functions->extract(module->self, &slices, &out, error);
     opc_leave(context, before);
     if (!code) code = eda_check_performance(gates, 0, flags, &out, error);
     return eda_blame(error, code, "extractor");

   All functions are [any] (opcflow/plugin.h). */
#pragma once

#include <eda/extractor.h>
#include <eda/regulator.h>
#include <eda/resist.h>

OPC_C_BEGIN

/* Clear *error and call opc_enter, which attributes a crash to the module.
   Return the value that the caller passes to opc_leave. */
OPC_EXPORT const char *eda_enter(const opc_context *context,
                                 const opc_module *module, opc_error *error);

/* Attribute an error to the module in a slot: change error->parameter from
   PARAMETER to SLOT.PARAMETER, an unknown code to OPC_FAILED, and an empty
   message to a default message. Return the code. For OPC_OK do nothing. */
OPC_EXPORT int eda_blame(opc_error *error, int code, const char *slot);

/* Run task(data, i) for all i < n by opc_parallel. Return OPC_OK, or the code
   and *error of the failed task with the smallest i. */
OPC_EXPORT int eda_try_all(const opc_context *context, size_t n,
                           int (*task)(void *data, size_t i, opc_error *error),
                           void *data, opc_error *error);

/* Check that a field has nodes, finite values and exactly the frame `frame`.
   `what` names the field in the message ("level set"). */
OPC_EXPORT int eda_check_field(const eda_field *field, const eda_frame *frame,
                               const char *what, opc_error *error);

/* Check n slices, as returned by eda_extractor.slicing. */
OPC_EXPORT int eda_check_slicing(size_t n, const double *place,
                                 const double *width, opc_error *error);

/* Check the performance of performance->count gates; element 0 is gate number
   `first`. Each figure must be above 0; 0 is allowed for gates whose flags[]
   report a failure (eda_print_failed; NULL: no failures). Elements of `outside`
   must be 0 or 1. */
OPC_EXPORT int eda_check_performance(const eda_gates *gates, size_t first,
                                     const uint32_t *flags,
                                     const eda_performance *performance,
                                     opc_error *error);

/* eda_check_cuts: check the fragments that a synthesizer defines for a layer.
   eda_check_moves: check the moves of a synthesizer; fragments[gates->layers]:
   number of the fragments of each layer. */
OPC_EXPORT int eda_check_cuts(const eda_gates *gates, int layer,
                              const eda_cuts *cuts, opc_error *error);
OPC_EXPORT int eda_check_moves(const eda_gates *gates, const eda_moves *moves,
                               const size_t *fragments, opc_error *error);

/* eda_check_ruling: check the vetoes and line ends that a regulator returns.
   eda_check_violations: check n violations; `gates`: number of transistors. */
OPC_EXPORT int eda_check_ruling(const eda_gates *gates,
                                const eda_ruling *ruling, opc_error *error);
OPC_EXPORT int eda_check_violations(const eda_violation *violations, size_t n,
                                    size_t gates, opc_error *error);

/* The functions below call a module and check all results. The module writes to
   copies of the arrays. Known words before and after each copy detect writes
   beyond the array. Texts must be UTF-8 of at most 200 bytes; they are copied
   and never freed. Return OPC_OK and the results, or a code and *error for
   eda_blame. On failure, *done, *verdict and *field are undefined, and other
   results are unchanged. */

/* Call eda_synthesizer.update; `fragments` as in eda_check_moves. */
OPC_EXPORT int eda_call_update(const opc_context *context,
                               const opc_module *synthesizer,
                               const eda_feedback *feedback,
                               const size_t *fragments, eda_moves *moves,
                               int *done, opc_error *error);

/* Call eda_synthesizer.verdict; *verdict is "" if the synthesizer has no
   verdict for the gate. */
OPC_EXPORT int eda_call_verdict(const opc_context *context,
                                const opc_module *synthesizer, size_t gate,
                                const char **verdict, opc_error *error);

/* eda_call_extract: call eda_extractor.extract; out->outside may be NULL, and
   the caller checks the figures by eda_check_performance. eda_call_slice: call
   eda_extractor.slice; slicing[2 * n] receives n places, then n widths, which
   are checked. */
OPC_EXPORT int eda_call_extract(const opc_context *context,
                                const opc_module *extractor,
                                const eda_slices *slices, eda_performance *out,
                                opc_error *error);
OPC_EXPORT int eda_call_slice(const opc_context *context,
                              const opc_module *extractor,
                              const eda_printed_gate *gate, size_t n,
                              double *slicing, opc_error *error);

/* Call eda_resist.print. Before the call, *field has the intensity; afterwards,
 *field has the level set. */
OPC_EXPORT int eda_call_print(const opc_context *context,
                              const opc_module *resist, int layer,
                              eda_field *field, opc_error *error);

/* eda_call_rule: call eda_regulator.rule, or smooth if `smooth` is 1; a
   regulator without `smooth` is an error of the caller. eda_call_violations:
   call eda_regulator.violations, which writes at most `most` violations; *count
   is the number of all violations. */
OPC_EXPORT int eda_call_rule(const opc_context *context,
                             const opc_module *regulator,
                             const eda_printed *printed, int smooth,
                             eda_ruling *ruling, opc_error *error);
OPC_EXPORT int eda_call_violations(const opc_context *context,
                                   const opc_module *regulator,
                                   const eda_printed *printed,
                                   eda_violation *violations, size_t most,
                                   size_t *count, opc_error *error);

OPC_C_END
