/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of opc_imaging_functions; include/opcflow/imaging.h documents
   them. */
#ifndef OPCFLOW_CORE_IMAGING_H
#define OPCFLOW_CORE_IMAGING_H

#include <opcflow/imaging.h>

int opc_mask_spectrum(const opc_host *host, const opc_shapes *shapes,
                      double grid, opc_frame frame, double band,
                      opc_spectrum *out, opc_error *error);
int opc_coherent_sum(const opc_host *host, const opc_spectrum *mask,
                     const opc_systems *systems, double step, opc_field *out,
                     opc_error *error);
int opc_contours(const opc_host *host, const opc_field *field,
                 opc_frame window, double step, double **points,
                 uint32_t **start, size_t *count, opc_error *error);

#endif
