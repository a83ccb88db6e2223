/* SPDX-License-Identifier: BSD-3-Clause */
/* Messages and findings of the instances of a run. */
#pragma once

#include "core/run/run.h"

/* Start to keep the findings of the run's instances and to pass all messages to
   `to` (may be NULL). */
void opc_listen(opc_run *run, const opc_watch *to);

/* Detach the instances that outlive the run: their messages are dropped. */
void opc_listen_end(opc_run *run);

/* Begin a step: warnings are kept for the stored result. */
void opc_listen_step(opc_run *run);

/* opc_listen_piece: from now on, keep warnings and findings of a piece
   separately. opc_listen_piece_end: end the piece and return the messages
   (opc_message *, freed with the array). */
void opc_listen_piece(opc_run *run);
GPtrArray *opc_listen_piece_end(opc_run *run);

/* Copy the findings of another run. */
void opc_listen_take(opc_run *run, const opc_run *from);
