/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements extractor.plain: a printed gate as slices in parallel, each with
   the current of a transistor of equal length (thesis eq. 2.1 to 2.4, after
   Poppe et al., "From poly line to transistor", SPIE 6156, 2006). */
#include "../slicer.h"

static const opc_parameter parameters[] = {SLICER_PARAMETERS};
static const eda_extractor functions = {.prepare = slicer_prepare,
                                        .slicing = slicer_slicing,
                                        .extract = slicer_extract,
                                        .slice = slicer_slice,
                                        .range = slicer_range,
                                        .modelled = slicer_modelled};
OPC_PLUGIN(
    slicer, .id = "extractor.plain", .kind = "extractor", .version = "0.2.0",
    .licence = "BSD-3-Clause",
    .summary = "plain gate slicing: transistors in parallel, one per slice",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    .check = slicer_check, .clear = slicer_clear, OPC_FUNCTIONS(functions));
