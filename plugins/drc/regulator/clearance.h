/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef OPCFLOW_REGULATOR_CLEARANCE_H
#define OPCFLOW_REGULATOR_CLEARANCE_H

#include <opcflow/gates.h>

/* How far each line end of the drawn poly may be seen to be free, up to
   `range`: out[2 * i + side] is the distance, in grid steps, from the line end
   of gate i outwards to the next drawn poly, counting poly that passes within
   `beside` grid steps of the line's flanks; `range` if there is none nearer or
   no line end. Returns 0 if there is no memory. */
int opc_line_end_clearance(const opc_gates *gates, int32_t range,
                           int32_t beside, int32_t *out);

#endif
