/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef OPCFLOW_REGULATOR_CLEARANCE_H
#define OPCFLOW_REGULATOR_CLEARANCE_H

#include <opcflow/gates.h>

#include "bins.h"

/* How far each line end of the drawn poly may be seen to be free, up to
   `range`: out[2 * i + side] is the distance, in grid steps, from the line end
   of gate i outwards to the next drawn poly, counting poly that passes within
   `beside` grid steps of the line's flanks; `range` if there is none nearer or
   no line end. `poly` holds the drawn edges. */
void line_end_clearance(const opc_gates *gates, const bins *poly,
                        int32_t range, int32_t beside, int32_t *out);

#endif
