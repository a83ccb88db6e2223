/* SPDX-License-Identifier: BSD-3-Clause */
/* Processes that run a flow together, as mpirun starts them: the ranks, from 0.
   All go through the same steps; what they must agree on they meet for, all in
   the same order. All functions are [main]. */
#ifndef OPCFLOW_CORE_RANKS_H
#define OPCFLOW_CORE_RANKS_H

#include <base/problem.h>

typedef struct opc_ranks opc_ranks;

/* The rank and number of processes that mpirun or srun says there are; FALSE if
   it is one, or none says so. Nothing is started for that. */
gboolean opc_ranks_told(int *rank, int *size);

/* Meet the others, once. `stopped`: whether the user wants to stop; whoever
   waits then waits no longer, OPC_CANCELLED, and no more meeting is possible.
   NULL and *error: OPC_NO_PLUGIN if this build is without MPI. */
opc_ranks *opc_ranks_start(int (*stopped)(void), opc_error *error);

/* Wait until all are here; unless it was stopped. NULL is fine. */
void opc_ranks_end(opc_ranks *ranks);

/* 0 for NULL, which is alone. */
int opc_ranks_own(const opc_ranks *ranks);

/* All are here, at the same place with the same `what`, and none had a fault:
   OPC_OK; otherwise that of the lowest rank that has one, in every rank, with
   who it is. `code` and *error are this rank's own. NULL gives these. */
int opc_ranks_meet(opc_ranks *ranks, const char *what, int code,
                   opc_error *error);

/* The same with what is wrong in a list: if there is nothing here, the fault
   of the lowest rank that has one is added. FALSE if there is any now. */
gboolean opc_ranks_agree(opc_ranks *ranks, const char *what,
                         opc_problems *problems);

/* The least of all ranks' values, of each of n. */
int opc_ranks_least(opc_ranks *ranks, gint64 *values, gsize n,
                    opc_error *error);

/* What rank `from` has there, below 2^31 bytes, to all. */
int opc_ranks_spread(opc_ranks *ranks, void *bytes, gsize n, int from,
                     opc_error *error);

/* A number that all share, as it was before `by` was added; -1: stopped. */
gint64 opc_ranks_turn(opc_ranks *ranks, gint64 by);

/* That is 0 again after the next meeting, or opc_ranks_least. */
void opc_ranks_restart(opc_ranks *ranks);

#endif
