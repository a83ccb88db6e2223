/* SPDX-License-Identifier: BSD-3-Clause */
/* Processes that work together, as mpirun starts them: the ranks, from 0. All
   of them make the same calls in the same order. A process that is alone needs
   ranks_launched() only: the group comes from an object that is loaded. All
   functions are [main]. */
#pragma once

#include <glib.h>
#include <opcflow/base.h>

/* Units of work, none of which needs the result of another one. */
typedef struct ranks_units {
  void *data;
  const char *name; /* of one unit, for messages */
  size_t count;

  /* The cost of unit i in any unit, equal in every rank: the dearest units
     begin first. */
  double (*cost)(void *data, size_t i);

  /* Whether this rank can return the result of unit i without the work. */
  int (*has)(void *data, size_t i);

  /* Return the result of unit i, at most 2^30 bytes; NULL and *error. */
  GBytes *(*get)(void *data, size_t i, opc_error *error);

  /* Take the result of unit i. The bytes are aligned as by malloc. */
  int (*take)(void *data, size_t i, const void *bytes, size_t size,
              opc_error *error);

  /* Hear that n units are done, in this rank or in others. */
  void (*done)(void *data, size_t n);
} ranks_units;

/* All functions return OPC_CANCELLED once the user stopped the work; from then
   on, no rank waits for another one. */
typedef struct ranks_group {
  int rank, size;

  /* Wait until every rank calls this with the same `what`. Returns OPC_OK if
     no rank has a fault, else the fault of the lowest rank that has one, in
     every rank, with the rank's number and machine. `code` and *error are this
     rank's own fault. */
  int (*meet)(const char *what, int code, opc_error *error);

  /* Replace each of the n values by the least of all ranks' values. */
  int (*least)(int64_t *values, size_t n, opc_error *error);

  /* Copy n bytes, less than 2^31, of rank `from` to all ranks. */
  int (*spread)(void *bytes, size_t n, int from, opc_error *error);

  /* Share units out among the ranks: get() runs once for each unit, in the
     rank that is free first; take() runs in every rank, in order. The first
     fault ends it in every rank. */
  int (*share)(const ranks_units *units, opc_error *error);

  /* Wait for all ranks, unless the work was stopped, and end. */
  void (*end)(void);
} ranks_group;

/* Return whether mpirun or srun started several processes, and this one's
   number among them. Starts nothing. */
gboolean ranks_launched(int *rank, int *size);

/* Load the object at `path` (NULL: there is none) and join the group, once.
   `stopped` returns whether the user wants to stop. NULL and OPC_NO_PLUGIN if
   that is not possible. */
const ranks_group *ranks_load(const char *path, int (*stopped)(void),
                              opc_error *error);

/* The object's file, and the one function it exports. NULL: MPI does not start
   with two threads. */
#define RANKS_OBJECT "opcflow-ranks.so"
#define RANKS_ENTRY "ranks_join"
typedef const ranks_group *(*ranks_entry)(int (*stopped)(void));
