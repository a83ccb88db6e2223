/* SPDX-License-Identifier: BSD-3-Clause */
/* Pieces of a step's work in a run. */
#ifndef OPCFLOW_CORE_RUN_PIECES_H
#define OPCFLOW_CORE_RUN_PIECES_H

#include "core/run/run.h"

/* opc_host.pieces, of a run's hosts. */
int opc_pieces_run(const opc_host *host, const opc_pieces *pieces,
                   opc_error *error);

/* Drop the pieces of the step at work from the store: its result is kept. */
void opc_pieces_drop(opc_run *run);

#endif
