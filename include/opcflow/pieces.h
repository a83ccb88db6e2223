/* SPDX-License-Identifier: BSD-3-Clause */
/* Service "opcflow.pieces/1": distributes the work units of a step over
   processes. The processes were started by mpirun to run one flow together, or
   each runs the same flow with a common store of results. A work unit is a part
   of the work of a step that needs no result of another unit. */
#ifndef OPCFLOW_PIECES_H
#define OPCFLOW_PIECES_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

/* Byte string that receives the result of a work unit. [main]: see plugin.h. */
typedef struct opc_bytes opc_bytes;
struct opc_bytes {
  /* Append `size` bytes. */
  void (*add)(opc_bytes *bytes, const void *from, size_t size);
  OPC_MAY_GROW
};

/* A list of work units. Each unit is computed once, in one of the processes.
   Results with a key are kept and reused after an interrupted run. All
   functions are [main] and receive `data` as their first argument.

   The result of `work` must depend only on i, on the step's inputs and on
   earlier calls of `take`, and must be equal in every process. The host stores
   the warnings and findings of `work` together with the result, and logs them
   again before it calls `take`. `work` must not publish tables and metrics;
   publish them in `take` or later. */
typedef struct opc_pieces {
  void *data;       /* passed to all functions */
  const char *name; /* name of a unit: "window"; unique among the lists of a
                       step */
  size_t count;     /* number of units */

  /* Return a text that identifies the dependencies of unit i that the key of
     the step's result does not contain (docs/reference/flow.md). The text is
     valid until the next call. Units with equal name and text have equal
     results. If the text or this field is NULL, the result is not kept. */
  const char *(*key)(void *data, size_t i);

  /* Return the relative cost of unit i, equal in every process; units of high
     cost start first. NULL if all costs are equal. */
  double (*cost)(void *data, size_t i);

  /* Compute unit i and append the result to `out`, at most 2^30 bytes, in the
     native byte order. Returns 0, or an error code with *error filled. */
  int (*work)(void *data, size_t i, opc_bytes *out, opc_error *error);

  /* Receive the result of unit i, in every process, in ascending order of i.
     `bytes` is aligned as by malloc and valid until `take` returns. Returns 0,
     or an error code with *error filled. */
  int (*take)(void *data, size_t i, const void *bytes, size_t size,
              opc_error *error);

  /* Receive the number of units that all processes have finished, to report the
     progress by host->progress. May be NULL. */
  void (*done)(void *data, size_t done);
  OPC_MAY_GROW
} opc_pieces;

/* Name of the service, for opc_host.service. */
#define OPC_PIECES "opcflow.pieces/1"

/* Functions of the service. */
typedef struct opc_pieces_service {
  size_t size; /* size of this struct */

  /* Implement opc_do_pieces; `own_size` is sizeof(opc_pieces) in the plugin. */
  int (*run)(const opc_host *host, const opc_pieces *pieces, size_t own_size,
             opc_error *error);
  OPC_MAY_GROW
} opc_pieces_service;

/* Compute all work units and pass the results to `take`. Returns 0, or the
   first error of `work` or `take`. A step without the flag OPC_STEP_PIECES
   computes all units in its own process. A call of opc_do_pieces from inside
   `work` computes all units in the calling process and keeps no results.
   [main], while a step runs. */
OPC_UNUSED static int opc_do_pieces(const opc_host *host,
                                    const opc_pieces *shared,
                                    opc_error *error) {
  const opc_pieces_service *service =
      (const opc_pieces_service *)host->service(host, OPC_PIECES);
  if (!service)
    return opc_fail(error, OPC_FAILED, NULL, "the host has no %s", OPC_PIECES);
  return service->run(host, shared, sizeof *shared, error);
}

OPC_C_END
#endif
