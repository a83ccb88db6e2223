/* SPDX-License-Identifier: BSD-3-Clause */
/* Pieces (work units of a step, opcflow/pieces.h) computed in this process. */
#pragma once

#include <glib.h>
#include <opcflow/pieces.h>

/* Largest result of a piece, bytes; an MPI message has less than 2^31 bytes. */
enum { OPC_PIECE_MOST = 1 << 30 };

/* Compute piece i and return the result (g_bytes_unref). NULL and *error on
   failure; the message contains the name of the piece, if set. [main]: see
   opcflow/plugin.h. */
GBytes *opc_piece_work(const opc_pieces *pieces, size_t i, opc_error *error);

/* Pass the result of piece i to the step. [main] */
int opc_piece_take(const opc_pieces *pieces, size_t i, const void *bytes,
                   size_t size, opc_error *error);

/* Return a copy of a plugin's struct of `size` bytes, truncated or padded with
   zeros to the size of the host's struct. */
opc_pieces opc_pieces_copy(const opc_pieces *theirs, size_t size);

/* The service that stores no results and uses only this process. */
extern const opc_pieces_service opc_pieces_alone;
