/* SPDX-License-Identifier: BSD-3-Clause */
/* What ranks.c asks of MPI, which stands in an object of its own: it is loaded
   by processes that were started together, and by no others. */
#ifndef OPCFLOW_CORE_MPI_H
#define OPCFLOW_CORE_MPI_H

#include <stddef.h>
#include <stdint.h>

/* Of this process and all. Calls of `least` and `spread` come in the same order
   in every process. What waits asks `stopped` now and then, and gives -1 if it
   says yes: after that, nothing but the process's end works. [main] */
typedef struct opc_mpi {
  int rank, size;

  /* The least of all processes' values, of each of n. */
  int (*least)(int64_t *values, size_t n);

  /* What process `from` has there, below 2^31 bytes, to all. */
  int (*spread)(void *bytes, size_t n, int from);

  /* A number that all share: as it was before `by` was added. Served by the
     first process, beside its work. */
  int64_t (*turn)(int64_t by);

  /* In the first process, while nobody takes turns: that is 0 again. */
  void (*restart)(void);

  /* All are here: the end. */
  void (*end)(void);
} opc_mpi;

/* Start; NULL if MPI cannot be used so. Once. */
typedef const opc_mpi *(*opc_mpi_entry)(int (*stopped)(void));
#define OPC_MPI_ENTRY "opcflow_mpi"
#define OPC_MPI_OBJECT "opcflow-mpi.so"

#endif
