/* SPDX-License-Identifier: BSD-3-Clause */
/* How the optics see what is turned or mirrored. */
#ifndef CORRECT_WAYS_H
#define CORRECT_WAYS_H

#include <eda/litho.h>

/* In how many of the ways in which a shape can lie a prepared model's images of
   both layers lie alike: in all 8, in the 4 without a swap of x and y, or in 1.
   [main] */
OPC_EXPORT int correct_ways_find(const opc_context *context,
                                 const opc_module *litho, int *ways,
                                 opc_error *error);

#endif
