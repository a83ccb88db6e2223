/* SPDX-License-Identifier: BSD-3-Clause */
/* Effects of a step besides its outputs (files, tables, metrics and warnings),
   packed as a value of the store. */
#pragma once

#include "core/run/run.h"

extern const char opc_result_type[];

/* Return the effects of a finished step, with the tables of the run from index
   `tables` (floating reference); NULL if the effects cannot be stored. */
GVariant *opc_result_new(const opc_run *run, const opc_flow_step *step,
                         guint tables);

/* Publish the files, tables, metrics and warnings of a stored result, with the
   contents of the files from a descriptor. Returns OPC_OK or a code and
   *error. */
int opc_result_publish(opc_run *run, const opc_flow_step *step,
                       GVariant *result, int contents, opc_error *error);

/* opc_messages_pack: pack messages (may be NULL) as a(uss); return FALSE if a
   message is of another step. opc_messages_replay: log packed messages
   again. */
gboolean opc_messages_pack(GVariantBuilder *all, const GPtrArray *messages,
                           const opc_flow_step *step);
void opc_messages_replay(opc_run *run, const opc_flow_step *step,
                         GVariant *messages);
