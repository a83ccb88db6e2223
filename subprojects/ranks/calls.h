/* SPDX-License-Identifier: BSD-3-Clause */
/* The calls of MPI. Calls of mpi_least and mpi_spread come in the same order in
   every process. [main] */
#pragma once

#include <opcflow/base.h>

/* Start, once; non-zero if MPI cannot be used with two threads. */
int mpi_start(int (*stopped)(void), int *rank, int *size);
void mpi_end(void);

/* From now on no rank is waited for. Returns OPC_CANCELLED. */
int mpi_stop(opc_error *error);

/* As of ranks_group. */
int mpi_least(int64_t *values, size_t n, opc_error *error);
int mpi_spread(void *bytes, size_t n, int from, opc_error *error);

/* Add to a number that all processes share; returns the number before, or -1:
   stopped. The first process serves it, beside its work. */
int64_t mpi_turn(int64_t by);

/* Set the number to 0, in the first process, while nobody takes turns. */
void mpi_restart(void);
