/* SPDX-License-Identifier: BSD-3-Clause */
/* Pieces of a step's work: one, or all of them, in this process. */
#pragma once

#include <glib.h>
#include <opcflow/pieces.h>

/* The most bytes that a piece may give: what one message of MPI can count. */
enum { OPC_PIECE_MOST = 1 << 30 };

/* Do piece i and return its result (g_bytes_unref); NULL and *error, whose
   message begins with the piece if pieces have a name. [main] */
GBytes *opc_piece_work(const opc_pieces *pieces, size_t i, opc_error *error);

/* Hand that back. [main] */
int opc_piece_take(const opc_pieces *pieces, size_t i, const void *bytes,
                   size_t size, opc_error *error);

/* What a plugin passed, as a struct of the kernel's size. */
opc_pieces opc_pieces_copy(const opc_pieces *theirs, size_t size);

/* The service where nothing is kept and nobody shares. */
extern const opc_pieces_service opc_pieces_alone;
