/* SPDX-License-Identifier: BSD-3-Clause */
/* Processes that share work units: the processes of one run, started by mpirun,
   or independent processes with a common folder of results. The processes of
   one run are the ranks, counted from 0, which make the same calls in the same
   order. The object linked to MPI is loaded only for such a run. All functions
   are [main] (opcflow/plugin.h). */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

/* Independent work units. Each function receives `data`. */
typedef struct ranks_units {
  void *data;       /* passed to all functions */
  const char *name; /* name of a unit, for messages */
  size_t count;     /* number of units */

  /* Return the relative cost of unit i, equal in every rank. High costs start
     first. */
  double (*cost)(void *data, size_t i);

  /* Return whether this process already has the result of unit i. */
  int (*has)(void *data, size_t i);

  /* Compute unit i, unless this process has the result, and return the result,
     at most 2^30 bytes; NULL and *error on failure. */
  GBytes *(*get)(void *data, size_t i, opc_error *error);

  /* Receive the result of unit i. The bytes are aligned as by malloc. */
  int (*take)(void *data, size_t i, const void *bytes, size_t size,
              opc_error *error);

  /* Receive the number of finished units: of all ranks in ranks_group.share,
     otherwise those that this process has computed or received. */
  void (*done)(void *data, size_t n);

  /* Claim unit i for this process until `release`. Return 0 if another process
     has claimed the unit. Only for ranks_share_claimed. */
  int (*claim)(void *data, size_t i);
  void (*release)(void *data, size_t i);
} ranks_units;

/* The functions of a rank, which all ranks call in the same order. After the
   user stops the run, all functions return OPC_CANCELLED and do not wait for
   other ranks. */
typedef struct ranks_group {
  int rank, size; /* number of this rank; number of ranks */

  /* Wait until every rank calls this function with the same `what`. `code` and
     *error are the fault of this rank, or OPC_OK. A rank whose `what` differs
     from that of rank 0 has the fault OPC_FAILED. Returns OPC_OK if no rank has
     a fault; else every rank returns the fault of the lowest faulty rank. */
  int (*meet)(const char *what, int code, opc_error *error);

  /* Replace each of the n values by the least value of all ranks. */
  int (*least)(int64_t *values, size_t n, opc_error *error);

  /* Copy n bytes, fewer than 2^31, from rank `from` to all ranks. */
  int (*spread)(void *bytes, size_t n, int from, opc_error *error);

  /* Distribute units over the ranks: call get() once for each unit, and take()
     in every rank, in ascending order of i. A unit belongs to a rank that has
     the result, or else to the next free rank. A fault of get() ends the
     distribution; every rank returns the fault of the lowest faulty unit. A
     fault of take() is returned only in the rank that has the fault. */
  int (*share)(const ranks_units *units, opc_error *error);

  /* Wait for all ranks unless the run was stopped, and finalise MPI. */
  void (*end)(void);
} ranks_group;

/* Return whether mpirun or srun started several processes; *rank and *size
   receive the rank and the number of processes. Does not start MPI. */
gboolean ranks_launched(int *rank, int *size);

/* Load the shared object at `path` (NULL if opcflow is built without MPI) and
   join the group. Call once. `stopped` returns whether a stop is requested.
   NULL and OPC_NO_PLUGIN on failure. */
const ranks_group *ranks_load(const char *path, int (*stopped)(void),
                              opc_error *error);

/* Share units with all processes that claim the same units. Call get() for
   units that have no result and that this process can claim, and wait for the
   results of all other units. Call take() for all units in ascending order of
   i. Processes may start and end at any time; a single process computes all
   units. Returns the first error of get or take, or OPC_CANCELLED. */
int ranks_share_claimed(const ranks_units *units, const opc_context *context,
                        opc_error *error);

/* File name and exported function of the shared object. The function returns
   NULL if MPI does not support two threads. */
#define RANKS_OBJECT "opcflow-ranks.so"
#define RANKS_ENTRY "ranks_join"
typedef const ranks_group *(*ranks_entry)(int (*stopped)(void));
