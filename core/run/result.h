/* SPDX-License-Identifier: BSD-3-Clause */
/* What a step did beside its outputs, as a value of the store. */
#pragma once

#include "core/run/run.h"

extern const char opc_result_type[];

/* Pack the step that ended, with the tables of the run from number `tables`;
   NULL if it cannot be kept. Floating. */
GVariant *opc_result_new(const opc_run *run, const opc_flow_step *step,
                         guint tables);

/* Publish all of it again: files, tables, metrics, warnings. */
int opc_result_publish(opc_run *run, const opc_flow_step *step,
                       GVariant *result, opc_error *error);

/* Pack messages (NULL: none) as a(uss), and repeat them. The first is FALSE if
   another step said some of them. */
gboolean opc_said_pack(GVariantBuilder *all, const GPtrArray *said,
                       const opc_flow_step *step);
void opc_said_again(opc_run *run, const opc_flow_step *step, GVariant *said);
