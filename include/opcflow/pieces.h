/* SPDX-License-Identifier: BSD-3-Clause */
/* Service "opcflow.pieces/1": work units that are distributed over
   processes. */
#ifndef OPCFLOW_PIECES_H
#define OPCFLOW_PIECES_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

/* Result of a work unit, a growing byte string: `add` appends a copy. [main] */
typedef struct opc_bytes opc_bytes;
struct opc_bytes {
  void (*add)(opc_bytes *bytes, const void *from, size_t size);
  OPC_MAY_GROW
};

/* A list of independent work units. Each unit is computed once: here or, if
   several processes run the flow together, in one of them. Results with a key
   are kept and reused after an interrupted run. All functions are [main] and
   get `data`.

   `work` must be a deterministic function of the step's inputs, of earlier
   calls of `take`, and of i, in every process. `work` publishes nothing;
   warnings and findings that it logs are kept with the result and logged before
   the result is taken. Publish figures, tables and metrics in `take` or
   later. */
typedef struct opc_pieces {
  void *data;
  const char *name; /* name of a unit: "window"; unique among the lists of a
                       step */
  size_t count;

  /* Return a text with all that unit i depends on beyond the dependencies of
     the step's own result (docs/reference/flow.md); valid until the next call.
     NULL, also for the function pointer: the result is not kept. Units of equal
     name and key are identical. */
  const char *(*key)(void *data, size_t i);

  /* Return the expected cost of unit i, in any unit of measure; units of
     highest cost start first. Must be the same in every process. NULL: equal
     costs. */
  double (*cost)(void *data, size_t i);

  /* Compute unit i and append the result to `out`, at most 2^30 bytes, in the
     native byte order. Returns 0, or an error code with *error filled. */
  int (*work)(void *data, size_t i, opc_bytes *out, opc_error *error);

  /* Receive the result of unit i, in every process, in ascending order of i.
     `bytes` is aligned as by malloc and valid until `take` returns. Returns 0,
     or an error code with *error filled. */
  int (*take)(void *data, size_t i, const void *bytes, size_t size,
              opc_error *error);

  /* Receive the number of finished units, over all processes, for
     host->progress. NULL: not needed. */
  void (*done)(void *data, size_t done);
  OPC_MAY_GROW
} opc_pieces;

#define OPC_PIECES "opcflow.pieces/1"

typedef struct opc_pieces_service {
  size_t size; /* of this struct */

  /* Implements opc_do_pieces; `own_size` is sizeof(opc_pieces) in the
     plugin. */
  int (*run)(const opc_host *host, const opc_pieces *pieces, size_t own_size,
             opc_error *error);
  OPC_MAY_GROW
} opc_pieces_service;

/* Compute all work units and pass the results to `take`. Returns 0, or the
   first error of `work` or `take`. A step without the flag OPC_STEP_PIECES
   computes all units in its own process. Nested calls, from `work`, compute in
   the calling process and keep no results. [main], while a step runs. */
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
