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

int opc_field_diffuse(const opc_host *host, opc_field *field, double sigma,
                      opc_error *error);
int opc_field_resample(const opc_host *host, opc_field *field, double step,
                       opc_error *error);
int opc_field_samples(const opc_host *host, opc_field *field,
                      opc_error *error);
int opc_field_from_samples(const opc_host *host, opc_field *field,
                           opc_error *error);
void opc_field_gradient(const opc_field *field, const double *x,
                        const double *y, size_t n, double *value, double *dx,
                        double *dy);

#endif
