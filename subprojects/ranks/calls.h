/* SPDX-License-Identifier: BSD-3-Clause */
/* Calls of MPI. All processes call mpi_least and mpi_spread in the same order.
   All functions are [main]: see opcflow/plugin.h. */
#pragma once

#include <opcflow/base.h>

/* Start MPI, once. `stopped` returns whether a stop is requested; *rank and
   *size receive the number of this process and the number of processes. Returns
   non-zero if MPI does not support two threads. mpi_end: end MPI. */
int mpi_start(int (*stopped)(void), int *rank, int *size);
void mpi_end(void);

/* Make all later calls return at once, without waiting for other ranks. Returns
   OPC_CANCELLED. */
int mpi_stop(opc_error *error);

/* Implement ranks_group.least and ranks_group.spread. */
int mpi_least(int64_t *values, size_t n, opc_error *error);
int mpi_spread(void *bytes, size_t n, int from, opc_error *error);

/* Add `by` to a counter that all ranks share; a thread of rank 0 holds the
   counter. Returns the previous value, or -1 if stopped. */
int64_t mpi_turn(int64_t by);

/* Set the counter to 0, in rank 0, while no rank calls mpi_turn. */
void mpi_restart(void);
