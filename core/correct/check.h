/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks of what plugins hand back. Each gives OPC_OK, or OPC_FAILED and
 *error. */
#ifndef OPCFLOW_CORE_CHECK_H
#define OPCFLOW_CORE_CHECK_H

#include <opcflow/opcflow.h>

/* opc_enter (guard.h) for a call of that module, with *error empty. */
const char *opc_call(const opc_module *module, opc_error *error);

/* Put an error down to the plugin in a slot: its parameter gets the name of the
   slot before it, a code that is none becomes OPC_FAILED, a missing message one
   that says so. Returns the code; nothing happens if that is OPC_OK. */
int opc_blame(opc_error *error, int code, const char *slot);

/* A field that has values, all finite, in that very frame; `what` is its name
   in the message. */
int opc_check_field(const opc_field *field, const opc_frame *frame,
                    const char *what, opc_error *error);

/* What opc_extract.slicing gave. */
int opc_check_slicing(size_t n, const double *place, const double *width,
                      opc_error *error);

/* Performance of the gates from `first` on: above 0, or 0 where `flags` (NULL:
   none) says that the print is bad. */
int opc_check_performance(const opc_gates *gates, size_t first,
                          const uint32_t *flags,
                          const opc_performance *performance, opc_error *error);

/* Of a synthesizer: what it cuts a layer into, and its moves, where it cut
   layers into so many fragments (0: none). */
int opc_check_cuts(const opc_gates *gates, int layer, const opc_cuts *cuts,
                   opc_error *error);
int opc_check_moves(const opc_moves *moves, size_t gates,
                    const size_t fragments[OPC_MASKS], opc_error *error);

int opc_check_ruling(const opc_ruling *ruling, size_t gates, opc_error *error);
int opc_check_violations(const opc_violation *violations, size_t n,
                         size_t gates, opc_error *error);

/* Outputs of steps: the data kinds "gates" and "mask". */
int opc_check_gates(const opc_gates *gates, opc_error *error);
int opc_check_mask(const opc_mask *mask, opc_error *error);

#endif
