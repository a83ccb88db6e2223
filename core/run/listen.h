/* SPDX-License-Identifier: BSD-3-Clause */
/* What the instances of a run say. */
#pragma once

#include "core/run/run.h"

/* Keep the findings of its instances from now on, and pass all messages on to
   `told` (NULL: nobody). */
void opc_listen(opc_run *run, const opc_watch *told);

/* Stop: instances that outlive the run report to nobody. */
void opc_listen_end(opc_run *run);

/* Begin a step: its warnings are kept for its result. */
void opc_listen_step(opc_run *run);

/* Begin a piece of work: warnings and findings of the step are set aside until
   it ends. The second returns them (opc_said *, freed with the array). */
void opc_listen_piece(opc_run *run);
GPtrArray *opc_listen_piece_end(opc_run *run);

/* Take the findings of another run. */
void opc_listen_take(opc_run *run, const opc_run *from);
