/* SPDX-License-Identifier: BSD-3-Clause */
/* Calls of modules of the kinds litho, resist, extractor, synthesizer and
   regulator, and checks of their results. Each check returns OPC_OK, or
   OPC_FAILED with the fault in *error; eda_blame then names the module at
   fault:

     const char *before = eda_enter(context, module, error);
     int code = functions->extract(module->self, &slices, &out, error);
     opc_leave(context, before);
     if (!code) code = eda_check_performance(gates, 0, flags, &out, error);
     return eda_blame(error, code, "extractor");

   All functions are [any]. */
#pragma once

#include <eda/extractor.h>
#include <eda/regulator.h>
#include <eda/resist.h>

OPC_C_BEGIN

/* Clear *error and call opc_enter for a call of the module. Return the value
   for opc_leave. */
OPC_EXPORT const char *eda_enter(const opc_context *context,
                                 const opc_module *module, opc_error *error);

/* Attribute an error to the module in a slot: put the name of the slot before
   that of the parameter. Replace an unknown code by OPC_FAILED and an empty
   message by a default one. Return the code. OPC_OK is returned unchanged. */
OPC_EXPORT int eda_blame(opc_error *error, int code, const char *slot);

/* Run tasks that may fail through opc_parallel. Return the error of the failed
   task with the lowest number. */
OPC_EXPORT int eda_try_all(const opc_context *context, size_t n,
                           int (*task)(void *data, size_t i, opc_error *error),
                           void *data, opc_error *error);

/* Check that a field has values, all finite, on exactly this frame. `what`
   names the field in the message. */
OPC_EXPORT int eda_check_field(const eda_field *field, const eda_frame *frame,
                               const char *what, opc_error *error);

/* Check the result of eda_extractor.slicing. */
OPC_EXPORT int eda_check_slicing(size_t n, const double *place,
                                 const double *width, opc_error *error);

/* Check the performance of the gates from `first` on: each figure is above 0,
   or 0 where `flags` (NULL: none) mark the printed gate as invalid; `outside`
   is 0, 1 or NULL. */
OPC_EXPORT int eda_check_performance(const eda_gates *gates, size_t first,
                                     const uint32_t *flags,
                                     const eda_performance *performance,
                                     opc_error *error);

/* Check the fragments into which a synthesizer dissects a layer, and its moves
   of the layers it dissected ([gates->layers] fragment counts; 0: none). */
OPC_EXPORT int eda_check_cuts(const eda_gates *gates, int layer,
                              const eda_cuts *cuts, opc_error *error);
OPC_EXPORT int eda_check_moves(const eda_gates *gates, const eda_moves *moves,
                               const size_t *fragments, opc_error *error);

OPC_EXPORT int eda_check_ruling(const eda_gates *gates,
                                const eda_ruling *ruling, opc_error *error);
OPC_EXPORT int eda_check_violations(const eda_violation *violations, size_t n,
                                    size_t gates, opc_error *error);

/* Call a module and check everything it returns. The module writes into copies
   between guard words, so that writes beyond an array are detected. Texts are
   copied permanently while the module is accountable for them, and must be
   UTF-8 of at most 200 bytes. Return OPC_OK and the results, or a code and
   *error for eda_blame; on failure only *done changes. */

/* Call eda_synthesizer.update; `fragments` as in eda_check_moves. */
OPC_EXPORT int eda_call_update(const opc_context *context,
                               const opc_module *synthesizer,
                               const eda_feedback *feedback,
                               const size_t *fragments, eda_moves *moves,
                               int *done, opc_error *error);

/* Call eda_synthesizer.verdict; *verdict is "" where the synthesizer has
   none. */
OPC_EXPORT int eda_call_verdict(const opc_context *context,
                                const opc_module *synthesizer, size_t gate,
                                const char **verdict, opc_error *error);

/* Call eda_extractor.extract, where out->outside may be NULL, and
   eda_extractor.slice, for [n] places followed by [n] widths. Figures are not
   checked (eda_check_performance), slices are. */
OPC_EXPORT int eda_call_extract(const opc_context *context,
                                const opc_module *extractor,
                                const eda_slices *slices, eda_performance *out,
                                opc_error *error);
OPC_EXPORT int eda_call_slice(const opc_context *context,
                              const opc_module *extractor,
                              const eda_printed_gate *gate, size_t n,
                              double *slicing, opc_error *error);

/* Call eda_resist.print, which replaces the intensity in *field. */
OPC_EXPORT int eda_call_print(const opc_context *context,
                              const opc_module *resist, int layer,
                              eda_field *field, opc_error *error);

/* Call eda_regulator.rule and read at most `most` of its violations; *count is
   the number of all. */
OPC_EXPORT int eda_call_rule(const opc_context *context,
                             const opc_module *regulator,
                             const eda_printed *printed, eda_ruling *ruling,
                             opc_error *error);
OPC_EXPORT int eda_call_violations(const opc_context *context,
                                   const opc_module *regulator,
                                   const eda_printed *printed,
                                   eda_violation *violations, size_t most,
                                   size_t *count, opc_error *error);

OPC_C_END
