/* SPDX-License-Identifier: BSD-3-Clause */
/* Calling modules of the kinds litho, resist, extractor, synthesizer and
   regulator, and checks of what they hand back. Each check gives OPC_OK, or
   OPC_FAILED and *error, which says what is wrong; eda_blame then says whose
   error it is:

     const char *before = eda_enter(context, module, error);
     int code = functions->extract(module->self, &slices, &out, error);
     opc_leave(context, before);
     if (!code) code = eda_check_performance(gates, 0, flags, &out, error);
     return eda_blame(error, code, "extractor");

   All [any]. */
#ifndef EDA_CHECK_H
#define EDA_CHECK_H

#include <eda/extractor.h>
#include <eda/regulator.h>
#include <eda/resist.h>

#ifdef __cplusplus
extern "C" {
#endif

/* opc_enter for a call of that module, with *error emptied. */
OPC_EXPORT const char *eda_enter(const opc_context *context,
                                 const opc_module *module, opc_error *error);

/* Put an error down to the module in a slot: its parameter gets the name of the
   slot before it, a code that is none becomes OPC_FAILED, a missing message one
   that says so. Returns the code; nothing happens if that is OPC_OK. */
OPC_EXPORT int eda_blame(opc_error *error, int code, const char *slot);

/* opc_parallel for tasks that may fail: the error of the first one, by its
   number, that did. */
OPC_EXPORT int eda_try_all(const opc_context *context, size_t n,
                           int (*task)(void *data, size_t i, opc_error *error),
                           void *data, opc_error *error);

/* A field that has values, all finite, in that very frame; `what` is its name
   in the message. */
OPC_EXPORT int eda_check_field(const eda_field *field, const eda_frame *frame,
                               const char *what, opc_error *error);

/* What eda_extractor.slicing gave. */
OPC_EXPORT int eda_check_slicing(size_t n, const double *place,
                                 const double *width, opc_error *error);

/* Performance of the gates from `first` on: above 0, or 0 where `flags` (NULL:
   none) says that the print is bad; `outside` 0 or 1, or NULL. */
OPC_EXPORT int eda_check_performance(const eda_gates *gates, size_t first,
                                     const uint32_t *flags,
                                     const eda_performance *performance,
                                     opc_error *error);

/* Of a synthesizer: what it cuts a layer into, and its moves, where it cut
   layers into so many fragments ([gates->layers]; 0: none). */
OPC_EXPORT int eda_check_cuts(const eda_gates *gates, int layer,
                              const eda_cuts *cuts, opc_error *error);
OPC_EXPORT int eda_check_moves(const eda_gates *gates, const eda_moves *moves,
                               const size_t *fragments, opc_error *error);

OPC_EXPORT int eda_check_ruling(const eda_gates *gates,
                                const eda_ruling *ruling, opc_error *error);
OPC_EXPORT int eda_check_violations(const eda_violation *violations, size_t n,
                                    size_t gates, opc_error *error);

/* Calls of modules with all that is checked of them. They write into copies
   between guard words, and who writes beyond them is found; texts are copied
   for ever while the module is to blame for them, and must be UTF-8 of at most
   200 bytes. OPC_OK and what it gave, or a code and *error, for eda_blame, with
   nothing changed but *done. */

/* eda_synthesizer.update; `fragments` as for eda_check_moves. */
OPC_EXPORT int eda_call_update(const opc_context *context,
                               const opc_module *synthesizer,
                               const eda_feedback *feedback,
                               const size_t *fragments, eda_moves *moves,
                               int *done, opc_error *error);

/* eda_synthesizer.verdict; "" for none. */
OPC_EXPORT int eda_call_verdict(const opc_context *context,
                                const opc_module *synthesizer, size_t gate,
                                const char **verdict, opc_error *error);

/* eda_regulator.rule, and violations: no more than `most` of all *count. */
OPC_EXPORT int eda_call_rule(const opc_context *context,
                             const opc_module *regulator,
                             const eda_printed *printed, eda_ruling *ruling,
                             opc_error *error);
OPC_EXPORT int eda_call_violations(const opc_context *context,
                                   const opc_module *regulator,
                                   const eda_printed *printed,
                                   eda_violation *violations, size_t most,
                                   size_t *count, opc_error *error);

#ifdef __cplusplus
}
#endif
#endif
