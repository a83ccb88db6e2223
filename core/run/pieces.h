/* SPDX-License-Identifier: BSD-3-Clause */
/* Pieces of a step's work in a run. */
#pragma once

#include <opcflow/pieces.h>

#include "core/run/run.h"

/* The service of a run's hosts. */
extern const opc_pieces_service opc_pieces_of_run;

/* Meet the other ranks at `what`, as ranks_group.meet does, with this rank's
   faults in a list: if there is none, the fault of the lowest rank that has one
   is added. FALSE if there is any. `ranks` may be NULL. */
gboolean opc_ranks_agree(const ranks_group *ranks, const char *what,
                         opc_problems *problems);

/* Drop the pieces of the step at work from the store: its result is kept. */
void opc_pieces_drop(opc_run *run);
