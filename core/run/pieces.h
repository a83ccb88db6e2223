/* SPDX-License-Identifier: BSD-3-Clause */
/* Pieces: the work units into which a step divides its work
   (opcflow/pieces.h). */
#pragma once

#include <opcflow/pieces.h>

#include "core/run/run.h"

/* The pieces service of a run's hosts. */
extern const opc_pieces_service opc_pieces_of_run;

/* Synchronize with the other ranks at `what`, as ranks_group.meet does. If this
   rank has no problem, add the problem of the lowest rank that has one. Returns
   FALSE if any rank has a problem. `ranks` may be NULL. */
gboolean opc_ranks_agree(const ranks_group *ranks, const char *what,
                         opc_problems *problems);

/* Remove the pieces of the running step from the store; call when the step's
   result is stored. */
void opc_pieces_drop(opc_run *run);
