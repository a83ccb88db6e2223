/* SPDX-License-Identifier: BSD-3-Clause */
/* Work of a step that processes share. */
#ifndef OPCFLOW_PIECES_H
#define OPCFLOW_PIECES_H

#include <opcflow/plugin.h>

OPC_C_BEGIN

/* What a piece of work gives, byte after byte: `add` copies. [main] */
typedef struct opc_bytes opc_bytes;
struct opc_bytes {
  void (*add)(opc_bytes *bytes, const void *from, size_t size);
  OPC_MAY_GROW
};

/* Work in pieces of which none needs another's result: each is done once, here
   or, where several processes run the flow together, in one of them; each
   result that is kept is there again after a run that was killed. All functions
   are [main], and get `data`.

   `work` must do the same in every process: it follows from what the step was
   given, from earlier calls of `take`, and from i alone. It publishes nothing;
   what it warns of or finds is kept with its result and said before that is
   taken. So figures, tables and metrics come from `take` or after it. */
typedef struct opc_pieces {
  void *data;
  const char *name; /* what one is: "window"; differs between lists of a step */
  size_t count;

  /* What piece i depends on beyond what the step's own result does
     (docs/reference/flow.md tells what that is), as a text; valid until the
     next call. NULL, also the function: it is not kept. Pieces of a name and
     key are the same. */
  const char *(*key)(void *data, size_t i);

  /* What it will cost, in any unit: the dearest begin first. The same in every
     process. NULL: all cost alike. */
  double (*cost)(void *data, size_t i);

  /* Do piece i, and add its result to `out`: 2^30 bytes at most, for processes
     of this machine's kind. */
  int (*work)(void *data, size_t i, opc_bytes *out, opc_error *error);

  /* Take the result of piece i, in every process, in the order of i. `bytes` is
     aligned as by malloc, and goes when it returns. */
  int (*take)(void *data, size_t i, const void *bytes, size_t size,
              opc_error *error);

  /* So many are done, wherever: for host->progress. NULL: not of interest. */
  void (*done)(void *data, size_t done);
  OPC_MAY_GROW
} opc_pieces;

#define OPC_PIECES "opcflow.pieces/1"

typedef struct opc_pieces_service {
  size_t size; /* of this struct */

  /* As opc_do_pieces; `own_size` is that of an opc_pieces. */
  int (*run)(const opc_host *host, const opc_pieces *pieces, size_t own_size,
             opc_error *error);
  OPC_MAY_GROW
} opc_pieces_service;

/* Have all pieces done and taken. The first fault of `work` or `take` ends it.
   A step whose flags have no OPC_STEP_PIECES does them alone. [main], while a
   step runs; in a piece, too: then here, and nothing is kept. */
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
