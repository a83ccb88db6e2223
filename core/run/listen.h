/* SPDX-License-Identifier: BSD-3-Clause */
/* Messages and findings of the instances of a run. */
#pragma once

#include "core/run/run.h"

/* Keep the findings of the run's instances from now on and pass all messages to
   `to` (NULL: none). */
void opc_listen(opc_run *run, const opc_watch *to);

/* Detach the instances that outlive the run: their messages are dropped. */
void opc_listen_end(opc_run *run);

/* Begin a step: warnings are kept for the stored result. */
void opc_listen_step(opc_run *run);

/* Begin a piece of work: warnings and findings are kept apart until the end of
   the piece. The second function ends the piece and returns both (opc_said *,
   freed with the array). */
void opc_listen_piece(opc_run *run);
GPtrArray *opc_listen_piece_end(opc_run *run);

/* Copy the findings of another run. */
void opc_listen_take(opc_run *run, const opc_run *from);
